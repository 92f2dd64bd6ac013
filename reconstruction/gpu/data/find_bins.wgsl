// Where each bin's pairs begin, once pairs are sorted by bin: one thread for each pair, and one more. Bins without
// pairs begin where the next one does.
@group(0) @binding(0) var<uniform> n: vec4u;        // pairs, bins
@group(0) @binding(1) var<storage, read> bins: array<u32>;
@group(0) @binding(2) var<storage, read_write> starts: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
        @builtin(local_invocation_index) lane: u32) {
    let k = (group.x + group.y * groups.x) * 64u + lane;
    if (k > n.x) { return; }
    var first = 0u;
    var last = n.y;
    if (k > 0u) { first = bins[k - 1u] + 1u; }
    if (k < n.x) { last = bins[k]; }
    for (var bin = first; bin <= last; bin++) { starts[bin] = k; }
}
