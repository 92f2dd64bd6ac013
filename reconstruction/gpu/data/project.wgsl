// Splats as a camera sees them: one thread each. The formulas are those of splats/rasterising/projection.py, arranged
// so that float32 loses nothing near edge-on. With r = (x / z, y / z, 1) and the unit axes t_u, t_v, n of a disc in
// camera axes, det J = fx fy s_u s_v (n . r) / z^2, and its plane's D = 1 + (n_x x' / fx + n_y y' / fy) / (n . r) at
// pixels (x', y') from the middle: no difference of large numbers is left. The camera's place is taken off the means in
// two parts, so that errors grow with the distance to the camera and not with that to the origin. A depth's bits, less
// those of the nearest, are the key by which splats are sorted; NOT_DRAWN where a splat is not seen.
//: include view
//: include geometry

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var parameters: texture_2d<f32>;
@group(0) @binding(2) var geometry: texture_storage_2d<rgba32float, write>;
@group(0) @binding(3) var<storage, read_write> keys: array<u32>;
@group(0) @binding(4) var<storage, read_write> order: array<u32>;
@group(0) @binding(5) var<storage, read_write> radii: array<f32>;

fn put(i: u32, quad: u32, values: vec4f) {
    textureStore(geometry, texel(GEOMETRY_QUADS * i + quad), values);
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

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
        @builtin(local_invocation_index) lane: u32) {
    let i = (group.x + group.y * groups.x) * 64u + lane;
    if (i >= view.size.z) { return; }
    keys[i] = NOT_DRAWN;
    order[i] = i;
    radii[i] = 0.0;
    let given = parameters_of(i);
    if (!is_drawable(given, view.limits.x, view.limits.y)) { return; }
    let seen = see(given);
    let drawn = drawn_from(seen, given.opacity);
    let near = view.limits.x;
    let z = seen.middle.z;
    let middle = view.lens.xy * seen.across + view.lens.zw + given.offset;
    if (max(abs(middle.x), abs(middle.y)) > WIDEST_PX) { return; }
    let reach = sqrt(max(2.0 * log(drawn.opacity / view.limits.y), 0.0));
    let steepness = length(drawn.slopes);
    var box = vec4f(0.0);
    var outline = vec4f(0.0, 0.0, NOTHING, 0.0);
    var shear = 0.0;
    if (drawn.has_disc) {
        outline = vec4f(0.0, 0.0, WIDEST_PX, WIDEST_PX);
        if (z * (1.0 - reach * steepness) < near) {
            box = clipped_box(drawn.jacobian, drawn.slopes, z, reach, near);
        } else {
            // The extremes of a circle's projection are the roots of a quadratic in its dual conic.
            let j = drawn.jacobian;
            let q = drawn.slopes;
            let share = reach * reach / (1.0 - reach * reach * dot(q, q));
            let x = -share * dot(j.x, q);
            let y = -share * dot(j.y, q);
            let xx = x * x + share * dot(j.x, j.x);
            let yy = y * y + share * dot(j.y, j.y);
            let half = vec2f(sqrt(xx), sqrt(yy));
            box = vec4f(x - half.x, x + half.x, y - half.y, y + half.y);
            if (2.0 * max(half.x, half.y) < LARGEST_OUTLINE_PX) {
                shear = (x * y + share * dot(j.x, j.y)) / yy;
                let in_row = sqrt(max(xx - shear * shear * yy, 0.0));
                outline = vec4f(x, y, half.y * (1.0 + ROUNDING) + SLACK_PX, in_row * (1.0 + ROUNDING) + SLACK_PX);
            }
        }
    }
    let dot_px = view.filters.y * reach;
    box = vec4f(min(box.x, -dot_px), max(box.y, dot_px), min(box.z, -dot_px), max(box.w, dot_px));
    // Pixels whose middles lie in the box, half-open.
    let size = vec2f(view.size.xy);
    let low = clamp(middle + box.xz - 0.5 - SLACK_PX, vec2f(-1.0), size + 1.0);
    let high = clamp(middle + box.yw - 0.5 + SLACK_PX, vec2f(-2.0), size + 1.0);
    let first = max(ceil(low), vec2f(0.0));
    let behind = min(floor(high) + 1.0, size);
    if (!(first.x < behind.x && first.y < behind.y)) { return; }
    let change = min(max(view.reaches.x * steepness, view.filters.w) * LIMITS_WIDENED, MOST_CHANGE);
    let nearest = z / near - 1.0;
    let lowest = -change / (1.0 + change);
    let highest = select(nearest, min(change / (1.0 - change), nearest), change < 1.0);
    let is_solid = SOLID == 1u;
    put(i, 0u, vec4f(middle, z, drawn.opacity));
    put(i, 1u, drawn.over_area);
    put(i, 2u, vec4f(drawn.plane, select(lowest, 0.0, is_solid), select(highest, 0.0, is_solid)));
    put(i, 3u, outline);
    put(i, 4u, vec4f(shear, (dot_px + SLACK_PX) * (dot_px + SLACK_PX), first.x, behind.x));
    put(i, 5u, vec4f(first.y, behind.y, 0.0, 0.0));
    radii[i] = 0.5 * max(box.y - box.x, box.w - box.z);
    keys[i] = min(bitcast<u32>(z) - bitcast<u32>(near), NOT_DRAWN - 1u);
}
