// From what was added up for a splat to the gradients of its parameters: one thread each. The formulas are those of
// project.wgsl and geometry.wgsl, taken backwards line by line. With IN_PLACE gradients take the last quads of the sums
// that they come from, else they have a buffer of their own.
//: include view
//: include geometry
//: include given_parameters

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var parameters: texture_2d<f32>;
@group(0) @binding(2) var<storage, read> radii: array<f32>;
//: if IN_PLACE
@group(0) @binding(3) var<storage, read_write> totals: array<vec4f>;

fn put(at: u32, quad: u32, values: vec4f) {
    totals[8u * at + GRADIENTS + quad] = values;
}
//: else
@group(0) @binding(3) var<storage, read> totals: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> gradients: array<vec4f>;

fn put(at: u32, quad: u32, values: vec4f) {
    gradients[4u * at + quad] = values;
}
//: end

fn in_world(v: vec3f) -> vec3f {
    return view.rows[0].xyz * v.x + view.rows[1].xyz * v.y + view.rows[2].xyz * v.z;
}

// Gradients of what `see` found.
struct OfSeen {
    across: vec2f,
    first: vec3f,
    second: vec3f,
    third: vec3f,
    sizes: vec3f,
}

fn of_axes(s: Seen, of_u: vec2f, of_v: vec2f) -> OfSeen {
    var g: OfSeen;
    g.first = vec3f(of_u, -dot(s.across, of_u));
    g.second = vec3f(of_v, -dot(s.across, of_v));
    g.across = -s.first.z * of_u - s.second.z * of_v;
    return g;
}

fn with_facing(s: Seen, before: OfSeen, of_facing: f32) -> OfSeen {
    var g = before;
    g.third += of_facing * vec3f(s.across, 1.0);
    g.across += of_facing * s.third.xy;
    return g;
}

// Discs as they are: J / a and e, f by the axes, the facing and the sizes.
fn through_disc(s: Seen, d: Drawn, j: vec4f, e: vec2f) -> OfSeen {
    let over = 1.0 / s.facing;
    let by_u = over / (view.lens.xy * s.sizes.x);
    let by_v = over / (view.lens.xy * s.sizes.y);
    var g = of_axes(s, vec2f(j.x * by_v.y, j.z * by_v.x), vec2f(j.y * by_u.y, j.w * by_u.x));
    g.sizes = vec3f(-(j.y * d.over_area.y + j.w * d.over_area.w) / s.sizes.x,
        -(j.x * d.over_area.x + j.z * d.over_area.z) / s.sizes.y, 0.0);
    g.third = vec3f(over * e / view.lens.xy, 0.0);
    return with_facing(s, g, -over * (dot(j, d.over_area) + dot(e, d.plane)));
}

// 1 less the square of the share that is a splat's own, from the sum of the two variances, one of them blurred.
fn unshared(root: f32, both: f32) -> f32 {
    let beside = view.filters.z * sqrt(both) / root;
    return beside * beside;
}

// Discs that are blurred, and the share that is their own.
fn through_blur(s: Seen, d: Drawn, j: vec4f, e: vec2f, of_share: f32) -> OfSeen {
    let blur = view.filters.z;
    let xx0 = dot(s.jacobian.x, s.jacobian.x);
    let xy = dot(s.jacobian.x, s.jacobian.y);
    let yy0 = dot(s.jacobian.y, s.jacobian.y);
    let area = area_of(s);
    let root = root_of(area, blur, xx0 + yy0 + blur * blur);
    let xx = xx0 + blur * blur;
    let yy = yy0 + blur * blur;
    let upper = sqrt(xx);
    let plane = plane_of(s, xx, xy, yy, root);
    var of_facing = 0.0;
    var of_own = plane.over * e;
    var of_xx = 0.0;
    var of_xy = 0.0;
    var of_yy = 0.0;
    var of_root = 0.0;
    var along = vec2f(0.0);
    var of_along = vec2f(0.0);
    if (plane.is_flat) {
        of_facing -= plane.over * dot(e, d.plane);
    } else {
        // over = k facing, k = steepest^2 / |own|^2, and the rest 1 - over facing.
        let steepness2 = dot(plane.own, plane.own);
        let rest = 1.0 - plane.over * s.facing;
        let of_rest = dot(e, plane.likely);
        let of_over = dot(plane.own, e) - s.facing * of_rest;
        of_facing -= plane.over * of_rest;
        if (steepness2 > LEAST_FACING * LEAST_FACING) {
            of_facing += view.reaches.y * view.reaches.y / steepness2 * of_over;
            of_own -= 2.0 * plane.over / steepness2 * of_over * plane.own;
        }
        along = vec2f(dot(s.jacobian.x, s.slopes), dot(s.jacobian.y, s.slopes));
        let by = rest * e / root / root;
        of_xy = by.x * along.y + by.y * along.x;
        of_yy = -by.x * along.x;
        of_xx = -by.y * along.y;
        of_along = vec2f(by.y * xy - by.x * yy, by.x * xy - by.y * xx);
        of_root = -2.0 * rest * of_rest / root;
    }
    let by_xu = j.x * upper / root;
    let by_yv = j.w / upper;
    let of_beside = j.z / (upper * root);
    of_xy += of_beside;
    of_xx += 0.5 / xx * (by_xu - by_yv - of_beside * xy);
    of_root -= (by_xu + of_beside * xy) / root;
    let of_area = of_root * (area / root) + of_share * sign(area) * unshared(root, xx0 + yy) / root;
    let by_blur = 0.5 * (of_root - of_share * d.share / root) * blur * blur / root;
    of_xx += by_blur;
    of_yy += by_blur;
    let of_x = 2.0 * of_xx * s.jacobian.x + of_xy * s.jacobian.y + of_along.x * s.slopes;
    let of_y = 2.0 * of_yy * s.jacobian.y + of_xy * s.jacobian.x + of_along.y * s.slopes;
    let of_slopes = of_along.x * s.jacobian.x + of_along.y * s.jacobian.y;
    // The Jacobian is f s a, the slopes s t_z, and the area fx fy s_u s_v times the facing.
    let size = s.sizes.xy;
    var g = of_axes(s, view.lens.xy * size.x * vec2f(of_x.x, of_y.x), view.lens.xy * size.y * vec2f(of_x.y, of_y.y));
    g.first.z += size.x * of_slopes.x;
    g.second.z += size.y * of_slopes.y;
    g.third = vec3f(of_own / view.lens.xy, 0.0);
    let of_sizes = view.lens.x * of_x * vec2f(s.a_u.x, s.a_v.x) + view.lens.y * of_y * vec2f(s.a_u.y, s.a_v.y)
        + of_slopes * vec2f(s.first.z, s.second.z) + of_area * area / size;
    g.sizes = vec3f(of_sizes, 0.0);
    return with_facing(s, g, of_facing + of_area * view.lens.x * view.lens.y * size.x * size.y);
}

// Ellipsoids: J over its area is sqrt(xx) / root, xy / (sqrt(xx) root), 1 / sqrt(xx).
fn through_ellipsoid(s: Seen, d: Drawn, j: vec4f, of_share: f32) -> OfSeen {
    let blur = view.filters.z;
    let xx0 = dot(s.row_x, s.row_x);
    let xy = dot(s.row_x, s.row_y);
    let yy0 = dot(s.row_y, s.row_y);
    let normal = cross(s.row_x, s.row_y);
    let area = length(normal);
    let root = root_of(area, blur, xx0 + yy0 + blur * blur);
    let xx = xx0 + blur * blur;
    let upper = sqrt(xx);
    let by_xu = j.x * upper / root;
    let by_yv = j.w / upper;
    let of_xy = j.z / (upper * root);
    let of_root = -(by_xu + of_xy * xy) / root;
    let by_blur = 0.5 * (of_root - of_share * d.share / root) * blur * blur / root;
    let of_xx = 0.5 / xx * (by_xu - by_yv - of_xy * xy) + by_blur;
    let of_area = of_root * (area / root) + of_share * unshared(root, xx + yy0) / root;
    let unit = normal / max(area, SMALLEST);
    let of_x = 2.0 * of_xx * s.row_x + of_xy * s.row_y + of_area * cross(s.row_y, unit);
    let of_y = 2.0 * by_blur * s.row_y + of_xy * s.row_x + of_area * cross(unit, s.row_x);
    let zs = vec3f(s.first.z, s.second.z, s.third.z);
    let in_x = view.lens.x * of_x;
    let in_y = view.lens.y * of_y;
    let in_z = -s.bounded.x * in_x - s.bounded.y * in_y;
    var g: OfSeen;
    g.first = s.sizes.x * vec3f(in_x.x, in_y.x, in_z.x);
    g.second = s.sizes.y * vec3f(in_x.y, in_y.y, in_z.y);
    g.third = s.sizes.z * vec3f(in_x.z, in_y.z, in_z.z);
    g.sizes = in_x * vec3f(s.first.x, s.second.x, s.third.x) + in_y * vec3f(s.first.y, s.second.y, s.third.y)
        + in_z * zs;
    let of_bounded = -vec2f(dot(in_x * s.sizes, zs), dot(in_y * s.sizes, zs));
    g.across = select(vec2f(0.0), of_bounded, s.bounded == s.across);
    return g;
}

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
        @builtin(local_invocation_index) lane: u32) {
    let at = (group.x + group.y * groups.x) * 64u + lane;
    if (at >= view.part.y) { return; }
    let i = view.part.x + at;
    if (radii[i] == 0.0) {
//: for q in FOUR
        put(at, $qu, vec4f(0.0));
//: end
        return;
    }
    let given = parameters_of(i);
    let s = see(given);
    let d = drawn_from(s, given.opacity);
    let j = totals[8u * at + 5u];
    let mixed = totals[8u * at + 6u];
    let last = totals[8u * at + 7u];
    let e = mixed.xy;
    let of_middle = mixed.zw;
    let of_shown = last.y / d.opacity;
    let is_share = given.opacity * d.share > view.reaches.z;
    var of_opacity = of_shown;
    var of_share = 0.0;
    if (ANTIALIASED == 1u) {
        of_opacity *= select(select(0.0, 1.0, given.opacity <= view.reaches.z), d.share, is_share);
        of_share = select(0.0, of_shown * given.opacity, is_share);
    }
    var g: OfSeen;
    if (SOLID == 1u) {
        g = through_ellipsoid(s, d, j, of_share);
    } else if (ANTIALIASED == 1u) {
        g = through_blur(s, d, j, e, of_share);
    } else if (d.has_disc) {
        g = through_disc(s, d, j, e);
    }
    // Sizes are over z, and x / z and y / z are what the middle's pixel comes from.
    let over_z = 1.0 / s.middle.z;
    let across = g.across + view.lens.xy * of_middle;
    let of_scales = g.sizes * over_z;
    let of_z = last.x - over_z * (dot(across, s.across) + dot(g.sizes, s.sizes));
    let of_mean = in_world(vec3f(across * over_z, of_z));
    // From the three columns of the rotation to the quaternion of any length.
    let a = in_world(g.first);
    let b = in_world(g.second);
    let c = in_world(g.third);
    let w = s.unit.x;
    let x = s.unit.y;
    let y = s.unit.z;
    let z = s.unit.w;
    let of_unit = 2.0 * vec4f(
        z * a.y - y * a.z - z * b.x + x * b.z + y * c.x - x * c.y,
        y * a.y + z * a.z + y * b.x - 2.0 * x * b.y + w * b.z + z * c.x - w * c.y - 2.0 * x * c.z,
        x * a.y - 2.0 * y * a.x - w * a.z + x * b.x + z * b.z + w * c.x + z * c.y - 2.0 * y * c.z,
        w * a.y - 2.0 * z * a.x + x * a.z - w * b.x - 2.0 * z * b.y + y * b.z + x * c.x + y * c.y);
    var of_quat = vec4f(0.0);
    if (s.length > 0.0) { of_quat = (of_unit - s.unit * dot(s.unit, of_unit)) / s.length; }
    put(at, 0u, vec4f(of_mean, of_opacity));
    put(at, 1u, of_quat);
    put(at, 2u, vec4f(of_scales, 0.0));
    put(at, 3u, vec4f(of_middle, 0.0, 0.0));
}
