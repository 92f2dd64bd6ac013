// The surface that a picture's depths show, in camera axes: the places that a pixel's neighbours see span a plane.
// Differences of places come from those of rays and depths, so that nothing large is taken off something large.
struct Surface {
    normal: vec3f,              // unit, turned to the camera; 0 where the plane has no extent
    across: vec3f,
    down: vec3f,
    sign: f32,
    length: f32,
    is_known: bool,
}

fn depth_at(column: i32, row: i32) -> f32 {
    return textureLoad(bodies, texel(u32(row) * view.size.x + u32(column)), 0).w;
}

fn ray_at(column: i32, row: i32) -> vec3f {
    return vec3f((vec2f(f32(column), f32(row)) + 0.5 - view.lens.zw) / view.lens.xy, 1.0);
}

fn surface_at(column: i32, row: i32) -> Surface {
    var s = Surface(vec3f(0.0), vec3f(0.0), vec3f(0.0), 1.0, 1.0, false);
    if (column < 1 || row < 1 || column > i32(view.size.x) - 2 || row > i32(view.size.y) - 2) { return s; }
    let left = depth_at(column - 1, row);
    let right = depth_at(column + 1, row);
    let above = depth_at(column, row - 1);
    let below = depth_at(column, row + 1);
    s.is_known = min(min(left, right), min(above, below)) > 0.0;
    if (!s.is_known) { return s; }
    let ray = ray_at(column, row);
    s.across = (right - left) * ray + (right + left) * vec3f(1.0 / view.lens.x, 0.0, 0.0);
    s.down = (below - above) * ray + (below + above) * vec3f(0.0, 1.0 / view.lens.y, 0.0);
    let found = cross(s.down, s.across);
    let square = dot(found, found);
    if (square < SHORTEST) { return s; }
    s.length = sqrt(square);
    s.sign = select(1.0, -1.0, dot(found, ray) > 0.0);
    s.normal = s.sign * found / s.length;
    return s;
}

fn blended_normal(column: i32, row: i32) -> vec3f {
    let n = textureLoad(bodies, texel(u32(row) * view.size.x + u32(column)), 0).xyz;
    return vec3f(dot(view.rows[0].xyz, n), dot(view.rows[1].xyz, n), dot(view.rows[2].xyz, n));
}

// Whether the mesh says what the normal is.
fn has_reference(number: u32) -> bool {
    let word = truth[number];
    return (word & FACADE) != 0u && any(reference[number].xyz != vec3f(0.0));
}
