// Splats as a camera sees them: one thread each. The formulas are those of splats/rasterising/projection.py, arranged
// so that float32 loses nothing near edge-on. With r = (x / z, y / z, 1) and the unit axes t_u, t_v, n of a disc in
// camera axes, det J = fx fy s_u s_v (n . r) / z^2, and its plane's D = 1 + (n_x x' / fx + n_y y' / fy) / (n . r) at
// pixels (x', y') from the middle: no difference of large numbers is left. The camera's place is taken off the means in
// two parts, so that errors grow with the distance to the camera and not with that to the origin. A depth's bits, less
// those of the nearest, are the key by which splats are sorted; NOT_DRAWN where a splat is not seen.
//: include view
//: include geometry
//: include touched
//: include given_parameters

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var parameters: texture_2d<f32>;
@group(0) @binding(2) var geometry: texture_storage_2d<rgba32float, write>;
@group(0) @binding(3) var<storage, read_write> keys: array<u32>;
@group(0) @binding(4) var<storage, read_write> order: array<u32>;
@group(0) @binding(5) var<storage, read_write> radii: array<f32>;

fn put(i: u32, quad: u32, values: vec4f) {
    textureStore(geometry, texel(GEOMETRY_QUADS * i + quad), values);
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
    let t = touched_by(given, 0.0);
    if (!t.is_any) { return; }
    let near = view.limits.x;
    let z = t.seen.middle.z;
    let steepness = length(t.drawn.slopes);
    let change = min(max(view.reaches.x * steepness, view.filters.w) * LIMITS_WIDENED, MOST_CHANGE);
    let nearest = z / near - 1.0;
    let lowest = -change / (1.0 + change);
    let highest = select(nearest, min(change / (1.0 - change), nearest), change < 1.0);
    let is_solid = SOLID == 1u;
    put(i, 0u, vec4f(t.middle, z, t.drawn.opacity));
    put(i, 1u, t.drawn.over_area);
    put(i, 2u, vec4f(t.drawn.plane, select(lowest, 0.0, is_solid), select(highest, 0.0, is_solid)));
    put(i, 3u, t.outline);
    put(i, 4u, vec4f(t.shear, (t.dot_px + SLACK_PX) * (t.dot_px + SLACK_PX), t.first.x, t.behind.x));
    put(i, 5u, vec4f(t.first.y, t.behind.y, 0.0, 0.0));
    radii[i] = 0.5 * max(t.box.y - t.box.x, t.box.w - t.box.z);
    keys[i] = min(bitcast<u32>(z) - bitcast<u32>(near), NOT_DRAWN - 1u);
}
