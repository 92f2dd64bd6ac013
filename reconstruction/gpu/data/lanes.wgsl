// What the lanes of a group tell each other: by subgroup operations where the device has subgroups of GROUP lanes or
// more, else by shared memory and barriers. A group is a workgroup; all its lanes call these functions together.
//: if SUBGROUPS
fn vote(is_so: bool) -> u32 {
    return subgroupBallot(is_so).x;
}

fn number_of(value: u32, lane: u32) -> u32 {
    return subgroupShuffle(value, lane);
}

fn sum_of(value: f32) -> f32 {
    var sum = value;
//: for s in STEPS
    sum += subgroupShuffleXor(sum, $su);
//: end
    return sum;
}

fn most_of(value: u32) -> u32 {
    var most = value;
//: for s in STEPS
    most = max(most, subgroupShuffleXor(most, $su));
//: end
    return most;
}

fn kept(low: vec4f, high: vec4f, is_high: bool, step: u32) -> vec4f {
    return select(low, high, is_high) + subgroupShuffleXor(select(high, low, is_high), step);
}

// Sums of eight quads over all lanes: lane l of the first eight gets that of quad l. Each step halves what is held.
fn scattered(q0: vec4f, q1: vec4f, q2: vec4f, q3: vec4f, q4: vec4f, q5: vec4f, q6: vec4f, q7: vec4f,
             lane: u32) -> vec4f {
    let four = (lane & 4u) != 0u;
    let two = (lane & 2u) != 0u;
    let a0 = kept(q0, q4, four, 4u);
    let a1 = kept(q1, q5, four, 4u);
    let a2 = kept(q2, q6, four, 4u);
    let a3 = kept(q3, q7, four, 4u);
    var sum = kept(kept(a0, a2, two, 2u), kept(a1, a3, two, 2u), (lane & 1u) != 0u, 1u);
//: for s in WIDE_STEPS
    sum += subgroupShuffleXor(sum, $su);
//: end
    return sum;
}
//: else
var<workgroup> votes: atomic<u32>;
var<workgroup> voted: u32;
var<workgroup> numbers_of_lanes: array<u32, GROUP>;
var<workgroup> sums_of_lanes: array<f32, GROUP>;
var<workgroup> quads_of_lanes: array<vec4f, 8u * GROUP>;

fn vote(is_so: bool, lane: u32) -> u32 {
    if (lane == 0u) { atomicStore(&votes, 0u); }
    workgroupBarrier();
    if (is_so) { atomicOr(&votes, 1u << lane); }
    workgroupBarrier();
    if (lane == 0u) { voted = atomicLoad(&votes); }
    return workgroupUniformLoad(&voted);
}

fn sum_of(value: f32, lane: u32) -> f32 {
    workgroupBarrier();
    sums_of_lanes[lane] = value;
    workgroupBarrier();
    var sum = 0.0;
    for (var other = 0u; other < GROUP; other++) { sum += sums_of_lanes[other]; }
    return sum;
}

fn most_of(value: u32, lane: u32) -> u32 {
    numbers_of_lanes[lane] = value;
    workgroupBarrier();
    if (lane == 0u) {
        voted = 0u;
        for (var other = 0u; other < GROUP; other++) { voted = max(voted, numbers_of_lanes[other]); }
    }
    return workgroupUniformLoad(&voted);
}

fn scattered(q0: vec4f, q1: vec4f, q2: vec4f, q3: vec4f, q4: vec4f, q5: vec4f, q6: vec4f, q7: vec4f,
             lane: u32) -> vec4f {
    workgroupBarrier();
//: for q in EIGHT
    quads_of_lanes[$qu * GROUP + lane] = q$q;
//: end
    workgroupBarrier();
    var sum = vec4f(0.0);
    if (lane < 8u) {
        for (var other = 0u; other < GROUP; other++) { sum += quads_of_lanes[lane * GROUP + other]; }
    }
    return sum;
}
//: end
