// Writes down the bins that splats reach, splat by splat, nearest first: one thread each. What belongs to a pair of
// splat and bin is a texel: the splat, its first row of sums, and the mask of its patches there. Pairs keep their
// numbers while they are sorted by bin, so what is added up for a splat stays in one piece. Bins are counted in the
// window.
//: include view
//: include reach

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var geometry: texture_2d<f32>;
@group(0) @binding(2) var<storage, read> order: array<u32>;
@group(0) @binding(3) var<storage, read> keys: array<u32>;
@group(0) @binding(4) var<storage, read> first_pairs: array<u32>;
@group(0) @binding(5) var<storage, read> first_patches: array<u32>;
@group(0) @binding(6) var pair_texels: texture_storage_2d<rgba32uint, write>;
@group(0) @binding(7) var<storage, read_write> pair_bins: array<u32>;
@group(0) @binding(8) var<storage, read_write> pair_numbers: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
        @builtin(local_invocation_index) lane: u32) {
    let k = (group.x + group.y * groups.x) * 64u + lane;
    if (k >= view.size.z || keys[k] == NOT_DRAWN) { return; }
    let i = order[k];
    let o = outline_of(i);
    var pair = first_pairs[k];
    var sums = first_patches[k];
    let first = max(i32(o.rows.x) / i32(BIN), i32(view.bins.y));
    let behind = min((i32(o.rows.y) - 1) / i32(BIN) + 1, i32(view.bins.y + view.bins.w));
    let window = vec2i(i32(view.bins.x), i32(view.bins.x + view.bins.z)) * i32(ACROSS);
    for (var row = first; row < behind; row++) {
        var left = window.y;
        var right = window.x;
        var lefts: array<i32, DOWN>;
        var rights: array<i32, DOWN>;
        for (var down = 0u; down < DOWN; down++) {
            let reached = patches_in_row(o, row * i32(DOWN) + i32(down));
            lefts[down] = max(reached.x, window.x);
            rights[down] = min(reached.y, window.y);
            if (lefts[down] < rights[down]) {
                left = min(left, lefts[down]);
                right = max(right, rights[down]);
            }
        }
        if (left >= right) { continue; }
        for (var column = left / i32(ACROSS); column <= (right - 1) / i32(ACROSS); column++) {
            var mask = 0u;
            for (var down = 0u; down < DOWN; down++) {
                for (var across = 0u; across < ACROSS; across++) {
                    let patch_column = column * i32(ACROSS) + i32(across);
                    if (lefts[down] <= patch_column && patch_column < rights[down]) {
                        mask |= 1u << (down * ACROSS + across);
                    }
                }
            }
            textureStore(pair_texels, texel(pair), vec4u(i, sums, mask, 0u));
            pair_bins[pair] = u32(row - i32(view.bins.y)) * view.bins.z + u32(column) - view.bins.x;
            pair_numbers[pair] = pair;
            sums += countOneBits(mask);
            pair += 1u;
        }
    }
}
