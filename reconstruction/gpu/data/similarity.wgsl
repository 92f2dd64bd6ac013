// Sums along columns, and from them the similarity of each window, added up, with its derivatives by the means of a, aa
// and ab.
//: include similarity_window
//: include fixed_sums

@group(0) @binding(0) var<uniform> sizes: Sizes;
@group(0) @binding(1) var moments: texture_2d<f32>;
@group(0) @binding(2) var derivatives: texture_storage_2d<rgba32float, write>;
@group(0) @binding(3) var<storage, read_write> sums: array<atomic<u32>>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
        @builtin(local_invocation_index) lane: u32) {
    let thread = (group.x + group.y * groups.x) * 64u + lane;
    let column = thread % sizes.inner;
    let top = thread / sizes.inner * RUN;
    if (top >= sizes.rows) { return; }
    let n = sizes.height * sizes.inner;
//: for o in FOUR
    var a$o = vec3f(0.0);
    var b$o = vec3f(0.0);
    var aa$o = vec3f(0.0);
    var bb$o = vec3f(0.0);
    var ab$o = vec3f(0.0);
//: end
//: for t in TAPS
    {
        let place = min(top + $tu, sizes.height - 1u) * sizes.inner + column;
        let a = textureLoad(moments, texel(place), 0).xyz;
        let b = textureLoad(moments, texel(n + place), 0).xyz;
        let aa = textureLoad(moments, texel(2u * n + place), 0).xyz;
        let bb = textureLoad(moments, texel(3u * n + place), 0).xyz;
        let ab = textureLoad(moments, texel(4u * n + place), 0).xyz;
//: for o in FOUR
        {
            let w = WINDOW[3u + $tu - $ou];
            a$o += w * a;
            b$o += w * b;
            aa$o += w * aa;
            bb$o += w * bb;
            ab$o += w * ab;
        }
//: end
    }
//: end
    let n_windows = sizes.rows * sizes.inner;
    var total = 0.0;
//: for o in FOUR
    if (top + $ou < sizes.rows) {
        // Rounding leaves variances of flat windows below 0, and covariances above what variances allow.
        let variances = max(aa$o - a$o * a$o, vec3f(0.0)) + max(bb$o - b$o * b$o, vec3f(0.0));
        let twice = clamp(2.0 * (ab$o - a$o * b$o), -variances, variances);
        let a = a$o + MIDDLE;
        let b = b$o + MIDDLE;
        let under = a * a + b * b + C1;
        let bottom = variances + C2;
        let light = (2.0 * a * b + C1) / under;
        let contrast = (twice + C2) / bottom;
        let value = light * contrast;
        total += dot(value, vec3f(1.0));
        let by_aa = -value / bottom;
        let by_ab = 2.0 * light / bottom;
        let by_a = 2.0 * (b * contrast - a * value) / under - by_ab * b$o - 2.0 * by_aa * a$o;
        let place = (top + $ou) * sizes.inner + column;
        textureStore(derivatives, texel(place), vec4f(by_a, 0.0));
        textureStore(derivatives, texel(n_windows + place), vec4f(by_aa, 0.0));
        textureStore(derivatives, texel(2u * n_windows + place), vec4f(by_ab, 0.0));
    }
//: end
    add_fixed(SIMILAR, total);
}
