// The Reflection MLP (`reconstruction.light.reflection_mlp`): light by place and direction, for lists of rays. A
// workgroup takes some quads of rays, whose features and units lie in shared memory, a vec4f for the four of them. Each
// lane adds up two units of the next layer for one quad, so that a weight is read once for four rays. Weights are half
// floats, a pair in a word, row by row of what goes in; biases and the last layer are floats.
struct Network {
    width: u32,         // of a layer, even
    layers: u32,
    position: u32,      // orders of the features
    direction: u32,
    middle: u32,        // the layer that is given features again
    has_skip: u32,      // whether those of the position are given there
    is_staged: u32,     // whether those of the direction are given there, and not at the start
    quads: u32,         // of rays in a workgroup
}
@group(0) @binding(26) var<uniform> network: Network;
@group(0) @binding(27) var<storage, read> weights: array<u32>;
@group(0) @binding(28) var<storage, read> listed: array<vec4f>;     // place and direction of each ray
@group(0) @binding(29) var<storage, read> n_listed: array<u32>;
@group(0) @binding(30) var<storage, read_write> given: array<f32>;   // light, four numbers each

const LANES = 256u;
var<workgroup> units: array<vec4f, 1024>; // of each quad features, then units of the layer before

// Sine and cosine of turns in -0.5 to 0.5, to the last bits: WGSL's own may be wrong by 5e-4.
struct Waves { sine: vec4f, cosine: vec4f }

fn waves(turns: vec4f) -> Waves {
    let quarters = round(4.0 * turns);
    let a = 6.2831853 * (turns - 0.25 * quarters);
    let aa = a * a;
    let s = a * (1.0 + aa * (-1.0 / 6.0 + aa * (1.0 / 120.0 + aa * (-1.0 / 5040.0 + aa / 362880.0))));
    let c = 1.0 + aa * (-0.5 + aa * (1.0 / 24.0 + aa * (-1.0 / 720.0 + aa * (1.0 / 40320.0 - aa / 3628800.0))));
    let number = vec4u(vec4i(quarters) + 4) & vec4u(3u);
    let is_odd = (number & vec4u(1u)) == vec4u(1u);
    let sine = select(s, c, is_odd);
    let cosine = select(c, s, is_odd);
    let is_below = number >= vec4u(2u);
    let is_left = ((number + 1u) & vec4u(2u)) == vec4u(2u);
    return Waves(select(sine, -sine, is_below), select(cosine, -cosine, is_left));
}

// Whole turns are taken away first, which is exact: see `fourier_features`.
fn put_features(first: u32, n: u32, stride: u32, lane: u32) {
    let of_position = 3u * network.position;
    let of_each = of_position + 3u * network.direction;
    for (var task = lane; task < of_each * network.quads; task += LANES) {
        let quad = task / of_each;
        let angle = task % of_each;
        let is_direction = angle >= of_position;
        let own = select(angle, angle - of_position, is_direction);
        let k = own / 3u;
        let axis = own % 3u;
        var values = vec4f();
        for (var r = 0u; r < 4u; r++) {
            values[r] = listed[2u * min(first + 4u * quad + r, n - 1u) + u32(is_direction)][axis];
        }
        let half_turns = values * (0.5 * f32(1u << k));
        let found = waves(half_turns - round(half_turns));
        let at = stride * quad + select(0u, 2u * of_position, is_direction) + 6u * k + axis;
        units[at] = found.sine;
        units[at + 3u] = found.cosine;
    }
}

struct Pair { a: vec4f, b: vec4f }

// Products of a run of units with their rows of weights, added to a pair of sums.
fn with_products(sums: Pair, start: u32, n: u32, words: u32) -> Pair {
    var a = sums.a;
    var b = sums.b;
    for (var k = 0u; k < n; k++) {
        let w = unpack2x16float(weights[words + k * (network.width / 2u)]);
        a += w.x * units[start + k];
        b += w.y * units[start + k];
    }
    return Pair(a, b);
}

fn ask(group: u32, lane: u32) {
    let n = n_listed[0];
    let first = 4u * network.quads * group;
    if (first >= n) { return; }
    let width = network.width;
    let of_position = 6u * network.position;
    let n_features = of_position + 6u * network.direction;
    let stride = n_features + width;
    put_features(first, n, stride, lane);
    workgroupBarrier();
    let quad = lane / (width / 2u);
    let pair = lane % (width / 2u);
    let is_busy = quad < network.quads;
    let own = stride * quad;
    let place = own + n_features + 2u * pair;
    var at = 0u;
    for (var layer = 0u; layer < network.layers; layer++) {
        var start = n_features;
        var run = width;
        if (layer == 0u) {
            start = 0u;
            run = select(n_features, of_position, network.is_staged == 1u);
        }
        var again = 0u;
        var n_again = 0u;
        if (layer == network.middle) {
            again = select(of_position, 0u, network.has_skip == 1u);
            n_again = select(of_position, n_features, network.is_staged == 1u) - again;
        }
        let biases = at + (run + n_again) * width / 2u;
        var sums = Pair(vec4f(0.0), vec4f(0.0));
        if (is_busy) {
            sums.a += bitcast<f32>(weights[biases + 2u * pair]);
            sums.b += bitcast<f32>(weights[biases + 2u * pair + 1u]);
            sums = with_products(sums, own + start, run, at + pair);
            sums = with_products(sums, own + again, n_again, at + run * width / 2u + pair);
        }
        workgroupBarrier();
        if (is_busy) {
            units[place] = max(sums.a, vec4f(0.0));
            units[place + 1u] = max(sums.b, vec4f(0.0));
        }
        workgroupBarrier();
        at = biases + width;
    }
    // A lane for each colour of each quad.
    let answered = lane / 3u;
    if (answered < network.quads) {
        let colour = lane % 3u;
        var logits = vec4f(bitcast<f32>(weights[at + 3u * width + colour]));
        for (var k = 0u; k < width; k++) {
            logits += bitcast<f32>(weights[at + colour * width + k]) * units[stride * answered + n_features + k];
        }
        let light = 1.0 / (1.0 + exp(-logits));
        for (var r = 0u; r < 4u; r++) {
            let ray = first + 4u * answered + r;
            if (ray < n) { given[4u * ray + colour] = light[r]; }
        }
    }
}
