// The way back, first along columns: derivatives of windows to the rows that they cover.
//: include similarity_window

@group(0) @binding(0) var<uniform> sizes: Sizes;
@group(0) @binding(1) var derivatives: texture_2d<f32>;
@group(0) @binding(2) var spread: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
        @builtin(local_invocation_index) lane: u32) {
    let thread = (group.x + group.y * groups.x) * 64u + lane;
    let column = thread % sizes.inner;
    let top = thread / sizes.inner * RUN;
    if (top >= sizes.height) { return; }
    let n_windows = sizes.rows * sizes.inner;
//: for o in FOUR
    var a$o = vec3f(0.0);
    var aa$o = vec3f(0.0);
    var ab$o = vec3f(0.0);
//: end
//: for t in TAPS
    if (top + $tu >= 10u && top + $tu - 10u < sizes.rows) {
        let place = (top + $tu - 10u) * sizes.inner + column;
        let a = textureLoad(derivatives, texel(place), 0).xyz;
        let aa = textureLoad(derivatives, texel(n_windows + place), 0).xyz;
        let ab = textureLoad(derivatives, texel(2u * n_windows + place), 0).xyz;
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
    let n = sizes.height * sizes.inner;
//: for o in FOUR
    if (top + $ou < sizes.height) {
        let place = (top + $ou) * sizes.inner + column;
        textureStore(spread, texel(place), vec4f(a$o, 0.0));
        textureStore(spread, texel(n + place), vec4f(aa$o, 0.0));
        textureStore(spread, texel(2u * n + place), vec4f(ab$o, 0.0));
    }
//: end
}
