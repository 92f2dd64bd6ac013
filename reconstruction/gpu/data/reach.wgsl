// Which patches of PATCH_COLUMNS x PATCH_ROWS pixels a splat reaches, by its outline: an ellipse whose rows move
// sideways by the shear, the low-pass filter's circle about the middle, and the box of both. A bin is BIN x BIN pixels,
// and its patches are the bits of a mask, row by row.
struct Outline {
    middle: vec2f,
    ellipse: vec4f,             // its middle from the splat's, half its height, half the width of its middle row
    shear: f32,
    dot2: f32,                  // squared radius of the circle
    columns: vec2f,             // of the box, half-open
    rows: vec2f,
}

fn outline_of(i: u32) -> Outline {
    let a = textureLoad(geometry, texel(GEOMETRY_QUADS * i), 0);
    let b = textureLoad(geometry, texel(GEOMETRY_QUADS * i + 3u), 0);
    let c = textureLoad(geometry, texel(GEOMETRY_QUADS * i + 4u), 0);
    let d = textureLoad(geometry, texel(GEOMETRY_QUADS * i + 5u), 0);
    return Outline(a.xy, b, c.x, c.y, c.zw, d.xy);
}

// Patches of a row of patches, half-open, counted from the picture's left.
fn patches_in_row(o: Outline, row: i32) -> vec2i {
    let top = max(f32(row * i32(PATCH_ROWS)), o.rows.x);
    let last = min(f32(row * i32(PATCH_ROWS)) + f32(PATCH_ROWS), o.rows.y) - 1.0;
    if (last < top) { return vec2i(0, 0); }
    let low = top + 0.5 - o.middle.y;
    let high = last + 0.5 - o.middle.y;
    var left = FAR_PX;
    var right = -FAR_PX;
    let half = o.ellipse.z;
    let from_low = max(low - o.ellipse.y, -half);
    let to_high = min(high - o.ellipse.y, half);
    if (from_low <= to_high) {
        // Its widest place lies where the shear and the circle's narrowing are equal.
        let lean = o.shear * half;
        let widest = half * lean / max(length(vec2f(o.ellipse.w, lean)), SMALLEST);
        let at_right = clamp(widest, from_low, to_high);
        let at_left = clamp(-widest, from_low, to_high);
        let share_right = at_right / half;
        let share_left = at_left / half;
        right = o.ellipse.x + o.shear * at_right + o.ellipse.w * sqrt(max(1.0 - share_right * share_right, 0.0));
        left = o.ellipse.x + o.shear * at_left - o.ellipse.w * sqrt(max(1.0 - share_left * share_left, 0.0));
    }
    let nearest = clamp(0.0, low, high);
    let inside = o.dot2 - nearest * nearest;
    if (inside >= 0.0) {
        left = min(left, -sqrt(inside));
        right = max(right, sqrt(inside));
    }
    if (left > right) { return vec2i(0, 0); }
    let first = max(ceil(o.middle.x + left - 0.5 - SLACK_PX), o.columns.x);
    let behind = min(floor(o.middle.x + right - 0.5 + SLACK_PX) + 1.0, o.columns.y);
    if (!(first < behind)) { return vec2i(0, 0); }
    return vec2i(i32(first) / i32(PATCH_COLUMNS), (i32(behind) - 1) / i32(PATCH_COLUMNS) + 1);
}
