// The way back through blend.wgsl: the splats of a patch back to front. What shone through in front of a splat is what
// shines through behind it over 1 - alpha, which is at least a hundredth: a rounding error a splat, and never a small
// difference. With w = T alpha, the change of the result with alpha is T gain - behind / (1 - alpha), `behind` being
// the gain of all that lies behind. Each splat has a row of eight quads in each patch: of up to five quads of channels,
// of J and e, f over the area, of its middle, depth, and of the logarithm of alpha. Rows are written down, to be
// added up in a fixed order; without DETERMINISTIC they are added at once by compare-and-swap, in any order.
//: include view
//: include lanes
//: include meet

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var geometry: texture_2d<f32>;
@group(0) @binding(2) var features: texture_2d<f32>;
@group(0) @binding(3) var pair_texels: texture_2d<u32>;
@group(0) @binding(4) var<storage, read> numbers: array<u32>;
@group(0) @binding(5) var<storage, read> starts: array<u32>;
@group(0) @binding(6) var<storage, read> states: array<vec4f>;
@group(0) @binding(7) var wanted: texture_2d<f32>;
//: if DETERMINISTIC
@group(0) @binding(8) var<storage, read_write> sums: array<vec4f>;
//: else
@group(0) @binding(8) var<storage, read_write> totals: array<atomic<u32>>;

fn add(place: u32, value: f32) {
    if (value == 0.0) { return; }
    var before = atomicLoad(&totals[place]);
    loop {
        let tried = atomicCompareExchangeWeak(&totals[place], before, bitcast<u32>(bitcast<f32>(before) + value));
        if (tried.exchanged) { break; }
        before = tried.old_value;
    }
}
//: end

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
    let window = view.bins.xy * BIN;
    let width = min(view.size.x - window.x, view.bins.z * BIN);
    var lasts = first;
//: for p in PIXELS
    let pixel$p = vec2f(f32(column), f32(row + $pu)) + 0.5;
    var through$p = 1.0;
    var last$p = first;
    var behind$p = 0.0;
    var of_alpha$p = 0.0;
    var of_depth$p = 0.0;
//: for q in QUADS
    var of$p_$q = vec4f(0.0);
//: end
    if (column < view.size.x && row + $pu < view.size.y) {
        let place = (row + $pu - window.y) * width + column - window.x;
        let state = states[place];
        through$p = state.z;
        last$p = bitcast<u32>(state.w);
        lasts = max(lasts, last$p);
        let more = textureLoad(wanted, texel((N_QUADS + 1u) * place + N_QUADS), 0);
        of_alpha$p = more.x;
        of_depth$p = more.y;
//: for q in QUADS
        of$p_$q = textureLoad(wanted, texel((N_QUADS + 1u) * place + $qu), 0);
//: end
    }
//: end
//: if SUBGROUPS
    let stop = most_of(lasts);
//: else
    let stop = most_of(lasts, lane);
//: end
//: if DETERMINISTIC
    // What the patch ended in front of is not come to below.
    for (var k = stop + lane; k < end; k += GROUP) {
        let pair = textureLoad(pair_texels, texel(numbers[k]), 0);
        if (((pair.z >> patch_) & 1u) == 1u) {
            let at_row = pair.y + countOneBits(pair.z & ((1u << patch_) - 1u));
//: for q in EIGHT
            sums[at_row * 8u + $qu] = vec4f(0.0);
//: end
        }
    }
//: end
    let n_batches = (stop - first + GROUP - 1u) / GROUP;
    for (var batch = n_batches; batch > 0u; batch--) {
        let base = first + (batch - 1u) * GROUP;
        let k = base + lane;
        var pair = vec4u(0u);
        if (k < stop) { pair = textureLoad(pair_texels, texel(numbers[k]), 0); }
        let is_reached = ((pair.z >> patch_) & 1u) == 1u;
        let my_row = pair.y + countOneBits(pair.z & ((1u << patch_) - 1u));
//: include load_lane
        while (todo != 0u) {
            let from_lane = firstLeadingBit(todo);
            todo ^= 1u << from_lane;
//: if SUBGROUPS
            let i = number_of(pair.x, from_lane);
            let at_row = number_of(my_row, from_lane);
            let a = subgroupShuffle(g0, from_lane);
            let b = subgroupShuffle(g1, from_lane);
            let c = subgroupShuffle(g2, from_lane);
//: for q in QUADS
            let f$q = subgroupShuffle(mine$q, from_lane);
//: end
//: else
            let from_pair = textureLoad(pair_texels, texel(numbers[base + from_lane]), 0);
            let i = from_pair.x;
            let at_row = from_pair.y + countOneBits(from_pair.z & ((1u << patch_) - 1u));
            let a = textureLoad(geometry, texel(GEOMETRY_QUADS * i), 0);
            let b = textureLoad(geometry, texel(GEOMETRY_QUADS * i + 1u), 0);
            let c = textureLoad(geometry, texel(GEOMETRY_QUADS * i + 2u), 0);
//: for q in QUADS
            let f$q = textureLoad(features, texel(N_QUADS * i + $qu), 0);
//: end
//: end
            let splat = Splat(a.xy, a.z, a.w, b, c.xy, c.z, c.w);
            let number = base + from_lane;
//: for q in EIGHT
            var v$q = vec4f(0.0);
//: end
//: for p in PIXELS
            {
                let m = meet(splat, pixel$p);
                let alpha = select(0.0, m.alpha, number < last$p);
                let before = through$p / (1.0 - alpha);
                let weight = before * alpha;
                let depth = splat.depth * m.over_d;
                var gain = of_alpha$p + depth * of_depth$p;
//: for q in QUADS
                gain += dot(f$q, of$p_$q);
                v$q += weight * of$p_$q;
//: end
                let of_opacity = before * gain - behind$p / (1.0 - alpha);
                behind$p += weight * gain;
                through$p = before;
                // With the exponent e of alpha = o exp(-e / 2), the change with ln alpha is -2 times that with e.
                let of_log = select(0.0, of_opacity * alpha, alpha > 0.0 && alpha < view.limits.z);
                let of_disc = select(0.0, of_log, m.is_disc);
                let of_low = (of_log - of_disc) * view.filters.x;
                let of_z = weight * of_depth$p;
                let of_t = select(0.0, (of_disc * m.disc - of_z * depth) * m.over_d, m.is_within);
                let of_squares = of_disc * (m.over_d * m.over_d);
                let u = m.n_u * of_squares;
                let v = m.n_v * of_squares;
                let d = m.from_middle;
                v5 += vec4f(-(d.y * v), d.y * u, d.x * v, -(d.x * u));
                v6 += vec4f(d.x * of_t, d.y * of_t,
                    u * splat.over_area.w - v * splat.over_area.z - of_t * splat.plane.x + d.x * of_low,
                    v * splat.over_area.x - u * splat.over_area.y - of_t * splat.plane.y + d.y * of_low);
                v7 += vec4f(of_z * m.over_d, of_log, 0.0, 0.0);
            }
//: end
            let sum = scattered(v0, v1, v2, v3, v4, v5, v6, v7, lane);
            if (lane < 8u) {
//: if DETERMINISTIC
                sums[at_row * 8u + lane] = sum;
//: else
                if (i >= view.part.x && i - view.part.x < view.part.y) {
                    let place = (i - view.part.x) * 32u + lane * 4u;
                    add(place, sum.x);
                    add(place + 1u, sum.y);
                    add(place + 2u, sum.z);
                    add(place + 3u, sum.w);
                }
//: end
            }
        }
    }
}
