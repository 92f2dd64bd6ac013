// Splats to a picture: a group of lanes blends a patch of PATCH_COLUMNS x PATCH_ROWS pixels front to back, four pixels
// below each other in each lane. The splats of the patch's bin are looked at GROUP at once, a lane each, which tells
// those that reach the patch; then all lanes take these one after the other. A patch ends where none of its pixels
// takes any more. Written are the blended channels, and of each pixel alpha, depth, what still shines through, and the
// place in the list behind the last splat that counted; of each splat in each patch its weight.
//: include view
//: include lanes
//: include meet

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var geometry: texture_2d<f32>;
@group(0) @binding(2) var features: texture_2d<f32>;
@group(0) @binding(3) var pair_texels: texture_2d<u32>;
@group(0) @binding(4) var<storage, read> numbers: array<u32>;
@group(0) @binding(5) var<storage, read> starts: array<u32>;
@group(0) @binding(6) var<storage, read_write> picture: array<vec4f>;
@group(0) @binding(7) var<storage, read_write> states: array<vec4f>;
@group(0) @binding(8) var<storage, read_write> weights: array<f32>;

@compute @workgroup_size(GROUP)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
        @builtin(local_invocation_index) lane: u32) {
    let task = group.x + group.y * groups.x;
    let bin = task / PATCHES;
    let patch_ = task % PATCHES;
    if (bin >= view.bins.z * view.bins.w) { return; }
    let corner = vec2u(bin % view.bins.z + view.bins.x, bin / view.bins.z + view.bins.y) * BIN
        + vec2u(patch_ % ACROSS * PATCH_COLUMNS, patch_ / ACROSS * PATCH_ROWS);
    let column = corner.x + lane % PATCH_COLUMNS;
    let row = corner.y + lane / PATCH_COLUMNS * 4u;
    let first = starts[bin];
    let end = starts[bin + 1u];
    let least_through = view.limits.w;
//: for p in PIXELS
    let pixel$p = vec2f(f32(column), f32(row + $pu)) + 0.5;
    var open$p = column < view.size.x && row + $pu < view.size.y;
    var through$p = 1.0;
    var depth$p = 0.0;
    var last$p = end;
//: for q in QUADS
    var sum$p_$q = vec4f(0.0);
//: end
//: end
    for (var base = first; base < end; base += GROUP) {
        let k = base + lane;
        var pair = vec4u(0u);
        if (k < end) { pair = textureLoad(pair_texels, texel(numbers[k]), 0); }
        let is_reached = ((pair.z >> patch_) & 1u) == 1u;
        var mine = 0.0;
//: include load_lane
        while (todo != 0u) {
            let from_lane = firstTrailingBit(todo);
            todo &= todo - 1u;
//: if SUBGROUPS
            let a = subgroupShuffle(g0, from_lane);
            let b = subgroupShuffle(g1, from_lane);
            let c = subgroupShuffle(g2, from_lane);
//: for q in QUADS
            let f$q = subgroupShuffle(mine$q, from_lane);
//: end
//: else
            let i = textureLoad(pair_texels, texel(numbers[base + from_lane]), 0).x;
            let a = textureLoad(geometry, texel(GEOMETRY_QUADS * i), 0);
            let b = textureLoad(geometry, texel(GEOMETRY_QUADS * i + 1u), 0);
            let c = textureLoad(geometry, texel(GEOMETRY_QUADS * i + 2u), 0);
//: for q in QUADS
            let f$q = textureLoad(features, texel(N_QUADS * i + $qu), 0);
//: end
//: end
            let splat = Splat(a.xy, a.z, a.w, b, c.xy, c.z, c.w);
            var total = 0.0;
//: for p in PIXELS
            let m$p = meet(splat, pixel$p);
            let alpha$p = select(0.0, m$p.alpha, open$p);
            let weight$p = through$p * alpha$p;
            through$p *= 1.0 - alpha$p;
            depth$p += weight$p * (splat.depth * m$p.over_d);
            total += weight$p;
            if (open$p && through$p < least_through) {
                open$p = false;
                last$p = base + from_lane + 1u;
            }
//: for q in QUADS
            sum$p_$q += weight$p * f$q;
//: end
//: end
//: if SUBGROUPS
            let of_all = sum_of(total);
//: else
            let of_all = sum_of(total, lane);
//: end
            mine = select(mine, of_all, lane == from_lane);
        }
        if (is_reached) {
            weights[pair.y + countOneBits(pair.z & ((1u << patch_) - 1u))] = mine;
        }
        let is_open = open0 || open1 || open2 || open3;
//: if SUBGROUPS
        if (vote(is_open) == 0u) { break; }
//: else
        if (vote(is_open, lane) == 0u) { break; }
//: end
    }
    let window = view.bins.xy * BIN;
    let width = min(view.size.x - window.x, view.bins.z * BIN);
//: for p in PIXELS
    if (column < view.size.x && row + $pu < view.size.y) {
        let place = (row + $pu - window.y) * width + column - window.x;
        states[place] = vec4f(1.0 - through$p, depth$p, through$p, bitcast<f32>(last$p));
//: for q in QUADS
        picture[place * N_QUADS + $qu] = sum$p_$q;
//: end
    }
//: end
}
