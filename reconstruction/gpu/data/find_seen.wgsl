// Which splats a picture can touch: one thread each, 1 or 0. It is what project.wgsl would find, with some slack, so
// that none is missed. Running sums of it are the splats' places in the list of those that are seen.
//: include view
//: include geometry
//: include touched
//: include learned

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> learning: Learning;
@group(0) @binding(2) var<storage, read> learned: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> places: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
        @builtin(local_invocation_index) lane: u32) {
    let at = (group.x + group.y * groups.x) * 64u + lane;
    let n = learning.part.y;
    if (at >= n) { return; }
    let given = learned_parameters(learned[at], learned[n + at], learned[2u * n + at]);
    places[learning.part.x + at] = select(0u, 1u, touched_by(given, SLACK).is_any);
}
