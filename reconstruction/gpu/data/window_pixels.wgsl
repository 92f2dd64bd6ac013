// Pixels of the window, of the place-th one its column and row.
fn pixel_of(place: u32) -> vec2u {
    let window = view.bins.xy * BIN;
    let width = min(view.size.x - window.x, view.bins.z * BIN);
    return vec2u(place % width, place / width) + window;
}

fn pixels_of_window() -> u32 {
    let window = view.bins.xy * BIN;
    return min(view.size.x - window.x, view.bins.z * BIN) * min(view.size.y - window.y, view.bins.w * BIN);
}

fn slope_at(pixel: vec2u) -> vec2f {
    return (vec2f(pixel) + 0.5 - view.lens.zw) / view.lens.xy;
}

fn in_world(v: vec3f) -> vec3f {
    return view.rows[0].xyz * v.x + view.rows[1].xyz * v.y + view.rows[2].xyz * v.z;
}
