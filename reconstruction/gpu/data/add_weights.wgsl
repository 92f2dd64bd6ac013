// Each splat's weight in the picture: the sum of those in its patches, which follow each other, added to what other
// windows found. One thread each, in a fixed order.
//: include view

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<storage, read> order: array<u32>;
@group(0) @binding(2) var<storage, read> first_patches: array<u32>;
@group(0) @binding(3) var<storage, read> weights: array<f32>;
@group(0) @binding(4) var<storage, read_write> totals: array<f32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
        @builtin(local_invocation_index) lane: u32) {
    let k = (group.x + group.y * groups.x) * 64u + lane;
    if (k >= view.size.z) { return; }
    var total = 0.0;
    for (var at = first_patches[k]; at < first_patches[k + 1u]; at++) { total += weights[at]; }
    totals[order[k]] += total;
}
