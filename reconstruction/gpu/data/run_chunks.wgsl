// Running sums, downwards: each thread replaces CHUNK numbers by what stands before each of them, beginning with what
// stands before all of them. The total is written behind the last number.
@group(0) @binding(0) var<uniform> n: vec4u;
@group(0) @binding(1) var<storage, read_write> values: array<u32>;
@group(0) @binding(2) var<storage, read> before: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
        @builtin(local_invocation_index) lane: u32) {
    let thread = (group.x + group.y * groups.x) * 64u + lane;
    let start = thread * CHUNK;
    if (start >= max(n.x, 1u)) { return; }
    var total = select(before[thread], 0u, n.y == 1u);
    let end = min(start + CHUNK, n.x);
    for (var k = start; k < end; k++) {
        let value = values[k];
        values[k] = total;
        total += value;
    }
    if (end == n.x) { values[end] = total; }
}
