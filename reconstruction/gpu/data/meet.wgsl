// Where a pixel's ray meets a splat, and what the splat covers there; see splats/rasterising/projection.py.
struct Splat {
    middle: vec2f,              // pixels
    depth: f32,
    opacity: f32,
    over_area: vec4f,           // J (xu, xv, yu, yv) over its determinant
    plane: vec2f,               // e and f
    lowest: f32,                // limits of t
    highest: f32,
}

struct Meeting {
    from_middle: vec2f,
    n_u: f32,                   // u and v times D
    n_v: f32,
    over_d: f32,
    disc: f32,                  // u^2 + v^2
    is_within: bool,            // whether t is within its limits
    is_disc: bool,              // whether the disc counts, and not the low-pass filter
    alpha: f32,
}

fn meet(s: Splat, pixel: vec2f) -> Meeting {
    var m: Meeting;
    let from_middle = pixel - s.middle;
    m.from_middle = from_middle;
    m.n_u = from_middle.x * s.over_area.w - from_middle.y * s.over_area.y;
    m.n_v = from_middle.y * s.over_area.x - from_middle.x * s.over_area.z;
    let t = dot(from_middle, s.plane);
    let within = clamp(t, s.lowest, s.highest);
    m.is_within = t == within;
    m.over_d = 1.0 / (1.0 + within);
    // What is far outside would be infinite, and infinity times 0 no number.
    m.disc = min((m.n_u * m.n_u + m.n_v * m.n_v) * (m.over_d * m.over_d), FAR_PX);
    let low = dot(from_middle, from_middle) * view.filters.x;
    m.is_disc = m.is_within && m.disc <= low;
    let alpha = min(s.opacity * exp(-0.5 * select(low, m.disc, m.is_disc)), view.limits.z);
    m.alpha = select(0.0, alpha, alpha >= view.limits.y);
    return m;
}
