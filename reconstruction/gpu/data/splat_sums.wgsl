// Over all splats that are seen: whether a gradient is no number, and what a small motion of the camera would change,
// which is the opposite of all splats moving: the sum of -g, of -(r x g) for places r from the camera, and of what
// turns them.
// Threads take every so many splats.
//: include learned
//: include fixed_sums

@group(0) @binding(0) var<uniform> learning: Learning;
@group(0) @binding(1) var<storage, read> learned: array<vec4f>;
@group(0) @binding(2) var<storage, read> places: array<u32>;
@group(0) @binding(3) var<storage, read> totals: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> sums: array<atomic<u32>>;

fn is_bad(v: vec4f) -> bool {
    let bits = bitcast<vec4u>(v) & vec4u(0x7fffffffu);
    return any(bits >= vec4u(LARGEST_BITS));
}

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
        @builtin(local_invocation_index) lane: u32) {
    let first = (group.x + group.y * groups.x) * 64u + lane;
    let n = learning.part.y;
    let stride = groups.x * groups.y * 64u;
    var shift = vec3f(0.0);
    var turn = vec3f(0.0);
    var bad = false;
    for (var at = first; at < n; at += stride) {
        let place = places[learning.part.x + at];
        if (place == places[learning.part.x + at + 1u]) { continue; }
        let row = 8u * (place - learning.rows.x);
        let g = totals[row + GRADIENTS];
        let of_quat = totals[row + GRADIENTS + 1u];
        bad = bad || is_bad(g) || is_bad(of_quat) || is_bad(totals[row + GRADIENTS + 2u]);
//: for q in QUADS
        bad = bad || is_bad(totals[row + $qu]);
//: end
//: if MOVES
        let r = learned[at].xyz - learning.eye.xyz;
        let quat = learned[n + at];
        shift -= g.xyz;
        turn += 0.5 * (of_quat.x * quat.yzw - quat.x * of_quat.yzw - cross(quat.yzw, of_quat.yzw)) - cross(r, g.xyz);
//: end
    }
    if (bad) { atomicStore(&sums[IS_BAD], 1u); }
//: if MOVES
    add_fixed(OF_MOVE, shift.x);
    add_fixed(OF_MOVE + 1u, shift.y);
    add_fixed(OF_MOVE + 2u, shift.z);
    add_fixed(OF_MOVE + 3u, turn.x);
    add_fixed(OF_MOVE + 4u, turn.y);
    add_fixed(OF_MOVE + 5u, turn.z);
//: end
}
