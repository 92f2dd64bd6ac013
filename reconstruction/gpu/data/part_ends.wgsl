// Running sums where parts of so many numbers begin, and the total, side by side for one look from outside.
@group(0) @binding(0) var<uniform> n: vec4u;        // numbers, of a part, parts and one more
@group(0) @binding(1) var<storage, read> sums: array<u32>;
@group(0) @binding(2) var<storage, read_write> found: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
        @builtin(local_invocation_index) lane: u32) {
    let k = (group.x + group.y * groups.x) * 64u + lane;
    if (k < n.z) { found[k] = sums[min(k * n.y, n.x)]; }
}
