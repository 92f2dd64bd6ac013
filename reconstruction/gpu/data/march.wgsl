// Light that panes mirror to the pixels of a window, with the cosine of its angle of incidence, -1 where nothing is
// mirrored: the mean over the rays of a pixel that meet the pane inside its edges, or over all where none does. One
// thread for each pixel; its rays' light is kept, with what comes from far away, for the way back.
//: include view
//: include window_pixels
//: include radiance_grid
//: include grid_bindings
@group(0) @binding(9) var<storage, read_write> mirrored: array<vec4f>;
@group(0) @binding(10) var<storage, read_write> kept: array<vec4f>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
        @builtin(local_invocation_index) lane: u32) {
    let place = (group.x + group.y * groups.x) * 64u + lane;
    if (place >= pixels_of_window()) { return; }
    let pixel = pixel_of(place);
    let number = pixel.y * view.size.x + pixel.x;
    let pane = pane_numbers[number];
    mirrored[number] = vec4f(0.0, 0.0, 0.0, -1.0);
    if (pane == 0u || blended[N_QUADS * place].w <= LEAST_REFLECTIVITY) { return; }
    var inside = vec4f(0.0);
    var all_of_them = vec4f(0.0);
    var n_inside = 0.0;
    for (var k = 0u; k < N_RAYS; k++) {
        let ray = mirrored_ray(pane - 1u, pixel, number, k);
        let line = line_of(ray);
        let start = start_of(number, k);
        var through = 1.0;
        var light = vec3f(0.0);
        var at_time = 0u;
        while (at_time < mirrors.rays.y) {
            let time = textureLoad(times, texel(at_time), 0);
            let at = place_in_grid(line, time.x + start * time.y);
            let v = first_vertex(at);
            let skip = skip_at(v);
            if (skip > 0u) {
                at_time = next_place(at_time, skip);
                continue;
            }
            at_time += 1u;
            let w = at - vec3f(v);
            let value = mix(mix(mix(vertex(v, 0u, 0u, 0u), vertex(v, 1u, 0u, 0u), w.x),
                    mix(vertex(v, 0u, 1u, 0u), vertex(v, 1u, 1u, 0u), w.x), w.y),
                mix(mix(vertex(v, 0u, 0u, 1u), vertex(v, 1u, 0u, 1u), w.x),
                    mix(vertex(v, 0u, 1u, 1u), vertex(v, 1u, 1u, 1u), w.x), w.y), w.z);
            let raw = DENSITY_SCALE * value.x;
            if (raw <= -1.0) { continue; }
            let share = through * (1.0 - exp(-ramp(raw).x * mirrors.turn.z * time.y));
            light += share * value.yzw * value.yzw;
            through -= share;
            if (through < OPAQUE) { break; }
        }
        let root = root_of_far(far_around(ray.way));
        light += through * root * root;
        kept[number * N_RAYS + k] = vec4f(light, through);
        let found = vec4f(light, min(abs(ray.along), 1.0));
        all_of_them += found;
        if (ray.is_inside) {
            inside += found;
            n_inside += 1.0;
        }
    }
    mirrored[number] = select(all_of_them / f32(N_RAYS), inside / max(n_inside, 1.0), n_inside > 0.0);
}
