// The way back along rows, and the gradient of each pixel: `factor` times that of the sum of all similarities.
//: include similarity_window

struct Factor { sizes: Sizes, factor: f32 }

@group(0) @binding(0) var<uniform> given: Factor;
@group(0) @binding(1) var spread: texture_2d<f32>;
@group(0) @binding(2) var found: texture_2d<f32>;
@group(0) @binding(3) var<storage, read> truth: array<u32>;
@group(0) @binding(4) var<storage, read_write> of_found: array<vec4f>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
        @builtin(local_invocation_index) lane: u32) {
    let thread = (group.x + group.y * groups.x) * 64u + lane;
    let sizes = given.sizes;
    let across = (sizes.width + RUN - 1u) / RUN;
    let row = thread / across;
    if (row >= sizes.height) { return; }
    let left = thread % across * RUN;
    let n = sizes.height * sizes.inner;
//: for o in FOUR
    var a$o = vec3f(0.0);
    var aa$o = vec3f(0.0);
    var ab$o = vec3f(0.0);
//: end
//: for t in TAPS
    if (left + $tu >= 10u && left + $tu - 10u < sizes.inner) {
        let place = row * sizes.inner + left + $tu - 10u;
        let a = textureLoad(spread, texel(place), 0).xyz;
        let aa = textureLoad(spread, texel(n + place), 0).xyz;
        let ab = textureLoad(spread, texel(2u * n + place), 0).xyz;
//: for o in FOUR
        {
            let w = WINDOW[3u + $tu - $ou];
            a$o += w * a;
            aa$o += w * aa;
            ab$o += w * ab;
        }
//: end
    }
//: end
//: for o in FOUR
    if (left + $ou < sizes.width) {
        let place = row * sizes.width + left + $ou;
        let a = textureLoad(found, texel(place), 0).xyz - MIDDLE;
        let b = unpacked(truth[place]) - MIDDLE;
        of_found[place] = vec4f(given.factor * (a$o + 2.0 * a * aa$o + b * ab$o), 0.0);
    }
//: end
}
