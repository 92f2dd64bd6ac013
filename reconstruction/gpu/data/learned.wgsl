// What is learned of splats, as it lies in a card's memory: quad after quad, each of all splats of a part, so that
// threads side by side read numbers side by side.
//   0: mean, logit of the opacity          1: rotation w, x, y, z
//   2: logarithms of the scales, logit of the reflectivity
//   3: logits of the base reflectance, 1 where a splat is glass
//   4 to 15: harmonics, red, green and blue of each
//: include parameters
struct Learning {
    eye: vec4f,                 // of the camera in the model's frame, metres
    part: vec4u,                // of the splats: first, number; harmonics that are used; seed of the noise
    rows: vec4u,                // of totals: which of the seen splats has the first
    shape_rates: vec4f,         // steps of means, rotations, sizes, opacities: rates over 1 - beta1^t
    colour_rates: vec4f,        // of the first harmonic, the others, reflectivity, base reflectance
    adam: vec4f,                // 1 - beta1, beta2, 1 - beta2, 1 / sqrt(1 - beta2^t)
    other: vec4f,               // epsilon, share of the steps of glass, factor of all gradients, of screen gradients
    limits: vec4f,              // least and most logarithm of a size, that of longest over shortest; noise
    pulls: vec4f,               // what opacities and sizes are pulled down by; standard deviations of a box; has_seen
}

const GLASS_QUAD = 3u;
const FIRST_HARMONICS = 4u;

fn sigmoid(x: f32) -> f32 { return 1.0 / (1.0 + exp(-x)); }
fn sigmoids(x: vec3f) -> vec3f { return 1.0 / (1.0 + exp(-x)); }

fn learned_parameters(place: vec4f, quat: vec4f, sizes: vec4f) -> Parameters {
    return Parameters(place.xyz, sigmoid(place.w), quat,
        select(vec3f(exp(sizes.xy), 0.0), exp(sizes.xyz), SOLID == 1u), vec2f(0.0));
}

const DARKEST = 0.0031308;

// Linear light of display values, see splats/harmonic_colour.py.
fn light_of(value: vec3f) -> vec3f {
    let curved = pow((clamp(value, vec3f(12.92 * DARKEST), vec3f(1.0)) + 0.055) / 1.055, vec3f(2.4));
    let beyond = max(value - 1.0, vec3f(0.0)) * (2.4 / 1.055);
    return select(curved + beyond, max(value, vec3f(0.0)) / 12.92, value <= vec3f(12.92 * DARKEST));
}

fn light_slope(value: vec3f) -> vec3f {
    let curved = (2.4 / 1.055) * pow((clamp(value, vec3f(12.92 * DARKEST), vec3f(1.0)) + 0.055) / 1.055, vec3f(1.4));
    let straight = select(vec3f(0.0), vec3f(1.0 / 12.92), value >= vec3f(0.0));
    return select(curved, straight, value <= vec3f(12.92 * DARKEST));
}

// Real spherical harmonics up to degree 3, in the order of light/harmonics.py.
const H0 = sqrt(1.0 / (4.0 * PI));
const H1 = sqrt(3.0 / (4.0 * PI));
const H2 = sqrt(15.0 / (4.0 * PI));
const H20 = sqrt(5.0 / (16.0 * PI));
const H22 = sqrt(15.0 / (16.0 * PI));
const H33 = sqrt(35.0 / (32.0 * PI));
const H32 = sqrt(105.0 / (4.0 * PI));
const H31 = sqrt(21.0 / (32.0 * PI));
const H30 = sqrt(7.0 / (16.0 * PI));
const H34 = sqrt(105.0 / (16.0 * PI));

struct Harmonics { a: vec4f, b: vec4f, c: vec4f, d: vec4f }

// Those up to a degree, and 0 in the place of the others.
fn used(y: Harmonics, n_used: u32) -> Harmonics {
    var found = y;
    if (n_used < 16u) {
        found.c = vec4f(y.c.x, 0.0, 0.0, 0.0);
        found.d = vec4f(0.0);
    }
    if (n_used < 9u) {
        found.b = vec4f(0.0);
        found.c = vec4f(0.0);
    }
    if (n_used < 4u) { found.a = vec4f(y.a.x, 0.0, 0.0, 0.0); }
    return found;
}

fn harmonics(v: vec3f, n_used: u32) -> Harmonics {
    let s = v * v;
    var y = Harmonics(vec4f(H0, H1 * v.y, H1 * v.z, H1 * v.x), vec4f(0.0), vec4f(0.0), vec4f(0.0));
    y.b = vec4f(H2 * v.x * v.y, H2 * v.y * v.z, H20 * (3.0 * s.z - 1.0), H2 * v.x * v.z);
    y.c = vec4f(H22 * (s.x - s.y), H33 * v.y * (3.0 * s.x - s.y), H32 * v.x * v.y * v.z, H31 * v.y * (5.0 * s.z - 1.0));
    y.d = vec4f(H30 * v.z * (5.0 * s.z - 3.0), H31 * v.x * (5.0 * s.z - 1.0), H34 * v.z * (s.x - s.y),
        H33 * v.x * (s.x - 3.0 * s.y));
    return used(y, n_used);
}

// Change of the sum of w_k Y_k with x, y and z, each taken as free; unused weights are 0.
fn slope_of_harmonics(v: vec3f, w: Harmonics) -> vec3f {
    let s = v * v;
    let five = 5.0 * s.z - 1.0;
    let xy6 = 6.0 * v.x * v.y;
    let apart = 3.0 * (s.x - s.y);
    var g = H1 * vec3f(w.a.w, w.a.y, w.a.z);
    g.x += H2 * (v.y * w.b.x + v.z * w.b.w) + 2.0 * H22 * v.x * w.c.x;
    g.y += H2 * (v.x * w.b.x + v.z * w.b.y) - 2.0 * H22 * v.y * w.c.x;
    g.z += H2 * (v.y * w.b.y + v.x * w.b.w) + 6.0 * H20 * v.z * w.b.z;
    g.x += H33 * (xy6 * w.c.y + apart * w.d.w) + H32 * v.y * v.z * w.c.z + H31 * five * w.d.y
        + 2.0 * H34 * v.x * v.z * w.d.z;
    g.y += H33 * (apart * w.c.y - xy6 * w.d.w) + H32 * v.x * v.z * w.c.z + H31 * five * w.c.w
        - 2.0 * H34 * v.y * v.z * w.d.z;
    g.z += H32 * v.x * v.y * w.c.z + H31 * 10.0 * v.z * (v.y * w.c.w + v.x * w.d.y)
        + H30 * (15.0 * s.z - 3.0) * w.d.x + H34 * (s.x - s.y) * w.d.z;
    return g;
}

struct Direction { way: vec3f, length: f32 }

fn direction_to(mean: vec3f) -> Direction {
    let towards = mean - learning.eye.xyz;
    let size = max(length(towards), NEAREST_M);
    return Direction(towards / size, size);
}

fn product(a: vec4f, b: vec4f) -> vec4f {
    return vec4f(a.x * b.x - dot(a.yzw, b.yzw), a.x * b.yzw + b.x * a.yzw + cross(a.yzw, b.yzw));
}

// Of an ellipsoid, the turn (w, x, y, z) after which its shortest axis is the third: see splats/splats.py.
fn turn_to_third(sizes: vec3f) -> vec4f {
    if (SOLID == 0u || (sizes.z < sizes.x && sizes.z < sizes.y)) { return vec4f(1.0, 0.0, 0.0, 0.0); }
    return select(vec4f(0.5, 0.5, 0.5, 0.5), vec4f(0.5, -0.5, -0.5, -0.5), sizes.y < sizes.x);
}

// Normal of a rotation by its third column, turned to the camera by `sign`, and 1 over the squared length; of a
// rotation that says nothing (0, 0, 1) and 0.
struct Normal { n: vec3f, sign: f32, over: f32 }

fn normal_of(q: vec4f, from_camera: vec3f) -> Normal {
    let square = dot(q, q);
    var found = Normal(vec3f(0.0, 0.0, 1.0), 1.0, 0.0);
    if (square > LEAST_SQUARE) {
        found.over = 1.0 / square;
        found.n = found.over * vec3f(2.0 * (q.y * q.w + q.x * q.z), 2.0 * (q.z * q.w - q.x * q.y),
            q.x * q.x - q.y * q.y - q.z * q.z + q.w * q.w);
    }
    if (dot(found.n, from_camera) > 0.0) { found.sign = -1.0; }
    found.n *= found.sign;
    return found;
}
