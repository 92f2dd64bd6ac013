// Running sums, upwards: each thread adds up CHUNK numbers that follow each other. Repeated until one thread is enough.
@group(0) @binding(0) var<uniform> n: vec4u;
@group(0) @binding(1) var<storage, read> values: array<u32>;
@group(0) @binding(2) var<storage, read_write> sums: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
        @builtin(local_invocation_index) lane: u32) {
    let thread = (group.x + group.y * groups.x) * 64u + lane;
    let start = thread * CHUNK;
    if (start >= n.x) { return; }
    var total = 0u;
    for (var k = start; k < min(start + CHUNK, n.x); k++) { total += values[k]; }
    sums[thread] = total;
}
