// The pixels that a splat can touch, as a box of them: what project.wgsl writes down, and what find_seen.wgsl asks
// first. With some `slack` the box is larger by about that share, and by as much of a pixel: it holds the one without
// even where compilers round otherwise.
struct Touched {
    seen: Seen,
    drawn: Drawn,
    middle: vec2f,              // pixels
    box: vec4f,                 // left, right, top, bottom from the middle
    outline: vec4f,             // of the ellipse, if it is one: its middle, half its height, half its width in a row
    shear: f32,
    dot_px: f32,
    first: vec2f,               // pixel, and the one behind the last
    behind: vec2f,
    is_any: bool,
}

// Box (left, right, top, bottom from the middle) of the part of a disc that is not nearer than near: a polygon of
// twelve corners around it, cut off there.
fn clipped_box(j: Jacobian, slopes: vec2f, depth: f32, reach: f32, near: f32) -> vec4f {
    var box = vec4f(0.0);
    let out = reach / cos(PI / 12.0);
    for (var corner = 0u; corner < 12u; corner++) {
        let first = 2.0 * PI * f32(corner) / 12.0;
        let second = 2.0 * PI * f32(corner + 1u) / 12.0;
        let at = out * vec2f(cos(first), sin(first));
        let along = out * vec2f(cos(second), sin(second)) - at;
        let here = depth * (1.0 + dot(slopes, at)) - near;
        let change = depth * dot(slopes, along);
        for (var end = 0u; end < 2u; end++) {
            var share = 0.0;
            if (end == 0u) {
                if (here < 0.0) { continue; }
            } else {
                if ((here < 0.0) == (here + change < 0.0)) { continue; }
                share = -here / change;
            }
            let uv = at + share * along;
            let w = 1.0 + dot(slopes, uv);
            let x = dot(j.x, uv) / w;
            let y = dot(j.y, uv) / w;
            box = vec4f(min(box.x, x), max(box.y, x), min(box.z, y), max(box.w, y));
        }
    }
    return box;
}

fn touched_by(given: Parameters, slack: f32) -> Touched {
    var t: Touched;
    let near = view.limits.x * (1.0 - slack);
    let least = view.limits.y * (1.0 - slack);
    if (!is_drawable(given, near, least)) { return t; }
    t.seen = see(given);
    t.drawn = drawn_from(t.seen, given.opacity);
    let z = t.seen.middle.z;
    t.middle = view.lens.xy * t.seen.across + view.lens.zw + given.offset;
    if (max(abs(t.middle.x), abs(t.middle.y)) > WIDEST_PX) { return t; }
    let reach = sqrt(max(2.0 * log(t.drawn.opacity / least), 0.0)) * (1.0 + slack);
    let steepness = length(t.drawn.slopes);
    var box = vec4f(0.0);
    t.outline = vec4f(0.0, 0.0, NOTHING, 0.0);
    if (t.drawn.has_disc) {
        t.outline = vec4f(0.0, 0.0, WIDEST_PX, WIDEST_PX);
        if (z * (1.0 - reach * steepness) < view.limits.x * (1.0 + slack)) {
            box = clipped_box(t.drawn.jacobian, t.drawn.slopes, z, reach, near);
        } else {
            // The extremes of a circle's projection are the roots of a quadratic in its dual conic.
            let j = t.drawn.jacobian;
            let q = t.drawn.slopes;
            let share = reach * reach / (1.0 - reach * reach * dot(q, q));
            let x = -share * dot(j.x, q);
            let y = -share * dot(j.y, q);
            let xx = x * x + share * dot(j.x, j.x);
            let yy = y * y + share * dot(j.y, j.y);
            let half = vec2f(sqrt(xx), sqrt(yy));
            box = vec4f(x - half.x, x + half.x, y - half.y, y + half.y);
            if (2.0 * max(half.x, half.y) < LARGEST_OUTLINE_PX) {
                t.shear = (x * y + share * dot(j.x, j.y)) / yy;
                let in_row = sqrt(max(xx - t.shear * t.shear * yy, 0.0));
                t.outline = vec4f(x, y, half.y * (1.0 + ROUNDING) + SLACK_PX, in_row * (1.0 + ROUNDING) + SLACK_PX);
            }
        }
    }
    t.dot_px = view.filters.y * reach;
    t.box = vec4f(min(box.x, -t.dot_px), max(box.y, t.dot_px), min(box.z, -t.dot_px), max(box.w, t.dot_px));
    // Pixels whose middles lie in the box, half-open.
    let size = vec2f(view.size.xy);
    let low = clamp(t.middle + t.box.xz - 0.5 - (SLACK_PX + slack), vec2f(-1.0), size + 1.0);
    let high = clamp(t.middle + t.box.yw - 0.5 + (SLACK_PX + slack), vec2f(-2.0), size + 1.0);
    t.first = max(ceil(low), vec2f(0.0));
    t.behind = min(floor(high) + 1.0, size);
    t.is_any = t.first.x < t.behind.x && t.first.y < t.behind.y;
    // What leaves the range of float32 is left to the projection itself.
    if (slack > 0.0 && !is_finite(dot(abs(t.box), vec4f(1.0)) + steepness)) { t.is_any = true; }
    return t;
}
