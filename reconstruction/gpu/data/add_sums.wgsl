// Adds up each splat's rows of sums, which follow each other patch by patch, to what other windows found, if any: one
// thread each, in a fixed order, so that the same splats have the same gradients bit by bit.
//: include view

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<storage, read> order: array<u32>;
@group(0) @binding(2) var<storage, read> first_patches: array<u32>;
@group(0) @binding(3) var sums: texture_2d<f32>;
@group(0) @binding(4) var<storage, read_write> totals: array<vec4f>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
        @builtin(local_invocation_index) lane: u32) {
    let k = (group.x + group.y * groups.x) * 64u + lane;
    if (k >= view.size.z) { return; }
    let i = order[k];
    let first = first_patches[k];
    let behind = first_patches[k + 1u];
    if (first == behind || i < view.part.x || i - view.part.x >= view.part.y) { return; }
    let place = (i - view.part.x) * 8u;
//: for q in EIGHT
    var total$q = totals[place + $qu];
//: end
    for (var at = first; at < behind; at++) {
//: for q in EIGHT
        total$q += textureLoad(sums, texel(at * 8u + $qu), 0);
//: end
    }
//: for q in EIGHT
    totals[place + $qu] = total$q;
//: end
}
