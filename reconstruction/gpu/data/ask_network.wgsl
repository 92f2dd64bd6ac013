// The Reflection MLP for a list of rays: see network.wgsl.
//: include network

@compute @workgroup_size(256)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
        @builtin(local_invocation_index) lane: u32) {
    ask(group.x + group.y * groups.x, lane);
}
