// Weighted sums along rows of found and photo a and b: of a, b, aa, bb and ab.
//: include similarity_window

@group(0) @binding(0) var<uniform> sizes: Sizes;
@group(0) @binding(1) var found: texture_2d<f32>;
@group(0) @binding(2) var<storage, read> truth: array<u32>;
@group(0) @binding(3) var moments: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
        @builtin(local_invocation_index) lane: u32) {
    let thread = (group.x + group.y * groups.x) * 64u + lane;
    let across = (sizes.inner + RUN - 1u) / RUN;
    let row = thread / across;
    if (row >= sizes.height) { return; }
    let left = thread % across * RUN;
//: for o in FOUR
    var a$o = vec3f(0.0);
    var b$o = vec3f(0.0);
    var aa$o = vec3f(0.0);
    var bb$o = vec3f(0.0);
    var ab$o = vec3f(0.0);
//: end
//: for t in TAPS
    {
        let place = row * sizes.width + min(left + $tu, sizes.width - 1u);
        let a = textureLoad(found, texel(place), 0).xyz - MIDDLE;
        let b = unpacked(truth[place]) - MIDDLE;
//: for o in FOUR
        {
            let w = WINDOW[3u + $tu - $ou];
            a$o += w * a;
            b$o += w * b;
            aa$o += w * (a * a);
            bb$o += w * (b * b);
            ab$o += w * (a * b);
        }
//: end
    }
//: end
    let n = sizes.height * sizes.inner;
//: for o in FOUR
    if (left + $ou < sizes.inner) {
        let place = row * sizes.inner + left + $ou;
        textureStore(moments, texel(place), vec4f(a$o, 0.0));
        textureStore(moments, texel(n + place), vec4f(b$o, 0.0));
        textureStore(moments, texel(2u * n + place), vec4f(aa$o, 0.0));
        textureStore(moments, texel(3u * n + place), vec4f(bb$o, 0.0));
        textureStore(moments, texel(4u * n + place), vec4f(ab$o, 0.0));
    }
//: end
}
