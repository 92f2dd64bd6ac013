// How many bins of the window, and how many of their patches, each splat reaches: one thread each, nearest first.
//: include view
//: include reach

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var geometry: texture_2d<f32>;
@group(0) @binding(2) var<storage, read> order: array<u32>;
@group(0) @binding(3) var<storage, read> keys: array<u32>;
@group(0) @binding(4) var<storage, read_write> pairs: array<u32>;
@group(0) @binding(5) var<storage, read_write> patches: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
        @builtin(local_invocation_index) lane: u32) {
    let k = (group.x + group.y * groups.x) * 64u + lane;
    if (k >= view.size.z) { return; }
    var n_pairs = 0u;
    var n_patches = 0u;
    if (keys[k] != NOT_DRAWN) {
        let o = outline_of(order[k]);
        let first = max(i32(o.rows.x) / i32(BIN), i32(view.bins.y));
        let behind = min((i32(o.rows.y) - 1) / i32(BIN) + 1, i32(view.bins.y + view.bins.w));
        let window = vec2i(i32(view.bins.x), i32(view.bins.x + view.bins.z)) * i32(ACROSS);
        for (var row = first; row < behind; row++) {
            var left = window.y;
            var right = window.x;
            for (var patch_row = row * i32(DOWN); patch_row < (row + 1) * i32(DOWN); patch_row++) {
                let reached = patches_in_row(o, patch_row);
                let from_column = max(reached.x, window.x);
                let to_column = min(reached.y, window.y);
                if (from_column < to_column) {
                    n_patches += u32(to_column - from_column);
                    left = min(left, from_column);
                    right = max(right, to_column);
                }
            }
            if (left < right) { n_pairs += u32((right - 1) / i32(ACROSS) - left / i32(ACROSS) + 1); }
        }
    }
    pairs[k] = n_pairs;
    patches[k] = n_patches;
}
