// The way back through march.wgsl: gradients of cells, of what is far away, and of how panes lean and are bowed. With c
// the light and s the density at a place, a step t long, and B the light that comes from behind it, the slope by s is
// t (T' c - B) for the share T' that is let through up to its end; B is the whole less what came before. Added up in
// whole numbers, so that any order of threads gives the same.
//: include view
//: include window_pixels
//: include radiance_grid
//: include grid_bindings
//: include fixed_sums
@group(0) @binding(9) var<storage, read> mirrored: array<vec4f>;    // gradients of light and cosine
@group(0) @binding(10) var<storage, read> kept: array<vec4f>;
@group(0) @binding(11) var<storage, read_write> sums: array<atomic<u32>>;

const OF_CELLS = 1u;            // behind the word IS_BAD, four slots a vertex; then three a far pixel, four a pane

fn add_to_vertex(v: vec3u, x: u32, y: u32, z: u32, amount: vec4f) {
    let slot = OF_CELLS + 4u * number_of_vertex(v + vec3u(x, y, z));
    add_fixed(slot, amount.x);
    add_fixed(slot + 1u, amount.y);
    add_fixed(slot + 2u, amount.z);
    add_fixed(slot + 3u, amount.w);
}

fn add_to_far(number: u32, amount: vec3f) {
    let slot = OF_CELLS + mirrors.rays.w + 3u * number;
    add_fixed(slot, amount.x);
    add_fixed(slot + 1u, amount.y);
    add_fixed(slot + 2u, amount.z);
}

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
        @builtin(local_invocation_index) lane: u32) {
    let place = (group.x + group.y * groups.x) * 64u + lane;
    if (place >= pixels_of_window()) { return; }
    let pixel = pixel_of(place);
    let number = pixel.y * view.size.x + pixel.x;
    let pane = pane_numbers[number];
    if (pane == 0u || blended[N_QUADS * place].w <= LEAST_REFLECTIVITY) { return; }
    var n_inside = 0.0;
    for (var k = 0u; k < N_RAYS; k++) {
        n_inside += select(0.0, 1.0, mirrored_ray(pane - 1u, pixel, number, k).is_inside);
    }
    let scale = scale_of_cells();
    var of_tilts = vec2f(0.0);
    var of_bows = vec2f(0.0);
    for (var k = 0u; k < N_RAYS; k++) {
        let ray = mirrored_ray(pane - 1u, pixel, number, k);
        if (n_inside > 0.0 && !ray.is_inside) { continue; }
        let g = mirrored[number] / select(f32(N_RAYS), n_inside, n_inside > 0.0);
        let whole = kept[number * N_RAYS + k];
        let line = line_of(ray);
        let start = start_of(number, k);
        var behind = dot(g.xyz, whole.xyz);
        var through = 1.0;
        var of_way = vec3f(0.0);
        var at_time = 0u;
        while (at_time < mirrors.rays.y) {
            let time = textureLoad(times, texel(at_time), 0);
            let here = time.x + start * time.y;
            let at = place_in_grid(line, here);
            let v = first_vertex(at);
            let skip = skip_at(v);
            if (skip > 0u) {
                at_time = next_place(at_time, skip);
                continue;
            }
            at_time += 1u;
            let w = at - vec3f(v);
            let u = 1.0 - w;
            let c000 = vertex(v, 0u, 0u, 0u);
            let c100 = vertex(v, 1u, 0u, 0u);
            let c010 = vertex(v, 0u, 1u, 0u);
            let c110 = vertex(v, 1u, 1u, 0u);
            let c001 = vertex(v, 0u, 0u, 1u);
            let c101 = vertex(v, 1u, 0u, 1u);
            let c011 = vertex(v, 0u, 1u, 1u);
            let c111 = vertex(v, 1u, 1u, 1u);
            let value = mix(mix(mix(c000, c100, w.x), mix(c010, c110, w.x), w.y),
                mix(mix(c001, c101, w.x), mix(c011, c111, w.x), w.y), w.z);
            let raw = DENSITY_SCALE * value.x;
            if (raw <= -1.0) { continue; }
            let density = ramp(raw);
            let share = through * (1.0 - exp(-density.x * mirrors.turn.z * time.y));
            let of_here = dot(g.xyz, value.yzw * value.yzw);
            through -= share;
            behind -= share * of_here;
            let by_density = DENSITY_SCALE * mirrors.turn.z * time.y * density.y;
            let amount = vec4f(by_density * (through * of_here - behind), 2.0 * share * value.yzw * g.xyz);
            add_to_vertex(v, 0u, 0u, 0u, u.x * u.y * u.z * amount);
            add_to_vertex(v, 1u, 0u, 0u, w.x * u.y * u.z * amount);
            add_to_vertex(v, 0u, 1u, 0u, u.x * w.y * u.z * amount);
            add_to_vertex(v, 1u, 1u, 0u, w.x * w.y * u.z * amount);
            add_to_vertex(v, 0u, 0u, 1u, u.x * u.y * w.z * amount);
            add_to_vertex(v, 1u, 0u, 1u, w.x * u.y * w.z * amount);
            add_to_vertex(v, 0u, 1u, 1u, u.x * w.y * w.z * amount);
            add_to_vertex(v, 1u, 1u, 1u, w.x * w.y * w.z * amount);
            let by_x = mix(mix(c100 - c000, c110 - c010, w.y), mix(c101 - c001, c111 - c011, w.y), w.z);
            let by_y = mix(mix(c010 - c000, c110 - c100, w.x), mix(c011 - c001, c111 - c101, w.x), w.z);
            let by_z = mix(mix(c001 - c000, c101 - c100, w.x), mix(c011 - c010, c111 - c110, w.x), w.y);
            let rise = vec3f(dot(by_x, amount), dot(by_y, amount), dot(by_z, amount));
            of_way += here * rise * scale * mirrors.over.xyz * contracted_slope(line.start + here * line.way);
            if (through < OPAQUE) { break; }
        }
        let far_pixels = far_around(ray.way);
        let root = root_of_far(far_pixels);
        let of_root = 2.0 * whole.w * g.xyz * root;
        add_to_far(far_pixels.numbers.x, far_pixels.shares.x * of_root);
        add_to_far(far_pixels.numbers.y, far_pixels.shares.y * of_root);
        add_to_far(far_pixels.numbers.z, far_pixels.shares.z * of_root);
        add_to_far(far_pixels.numbers.w, far_pixels.shares.w * of_root);
        of_way += far_slope(ray.way, far_pixels, of_root);
        // From the direction in the box's axes to the normal, d - 2 (d . n) n, and the cosine |d . n|.
        let of_mirrored = out_of_box(of_way);
        var of_along = -2.0 * dot(of_mirrored, ray.normal);
        if (abs(ray.along) <= 1.0) { of_along += g.w * sign(ray.along); }
        let of_unit = of_along * ray.from_camera - 2.0 * ray.along * of_mirrored;
        let of_normal = (of_unit - dot(of_unit, ray.normal) * ray.normal) / ray.length;
        let e = textureLoad(panes, texel(6u * (pane - 1u) + 3u), 0).xyz;
        let f = textureLoad(panes, texel(6u * (pane - 1u) + 4u), 0).xyz;
        let of_lean = vec2f(dot(of_normal, e), dot(of_normal, f));
        of_tilts += of_lean;
        of_bows += of_lean * ray.off_middle;
    }
    let slot = OF_CELLS + mirrors.rays.w + 3u * mirrors.counts.w * mirrors.counts.w + 4u * (pane - 1u);
    add_fixed(slot, of_tilts.x);
    add_fixed(slot + 1u, of_tilts.y);
    add_fixed(slot + 2u, of_bows.x);
    add_fixed(slot + 3u, of_bows.y);
}

// Gradient by a direction of what has gradients `of_root` by the square root of light there.
fn far_slope(d: vec3f, a: FarAround, of_root: vec3f) -> vec3f {
    let v0 = far_root(a.numbers.x);
    let v1 = far_root(a.numbers.y);
    let v2 = far_root(a.numbers.z);
    let v3 = far_root(a.numbers.w);
    let half_side = 0.5 * f32(mirrors.counts.w);
    var by_u = half_side * dot(of_root, (v1 - v0) * (1.0 - a.row) + (v3 - v2) * a.row);
    var by_v = half_side * dot(of_root, (v2 - v0) * (1.0 - a.column) + (v3 - v1) * a.column);
    let size = abs(d.x) + abs(d.y) + abs(d.z);
    let signs = select(vec3f(-1.0), vec3f(1.0), d >= vec3f(0.0));
    if (d.z < 0.0) {
        let swapped = -signs.x * signs.y * vec2f(by_v, by_u);
        by_u = swapped.x;
        by_v = swapped.y;
    }
    let along = by_u * d.x / size + by_v * d.y / size;
    return vec3f(by_u - along * signs.x, by_v - along * signs.y, -along * signs.z) / size;
}
