// From a splat's parameters to what is drawn of it, shared by the way there and the way back: see project.wgsl.
//: include parameters

struct Jacobian {
    x: vec2f,                   // change of the column with u and v
    y: vec2f,                   // and of the row
}

struct Seen {
    middle: vec3f,              // in camera axes
    across: vec2f,              // x / z and y / z
    bounded: vec2f,             // the same, within the limits of an ellipsoid's Jacobian
    length: f32,                // of the quaternion; 0 where it says nothing
    unit: vec4f,
    first: vec3f,               // unit axes in camera axes
    second: vec3f,
    third: vec3f,
    sizes: vec3f,               // scales over z
    a_u: vec2f,                 // first and second axis as seen from the camera, without scale: a disc's Jacobian
    a_v: vec2f,                 //   is fx s_u a_u.x and so on
    facing: f32,                // n . r
    jacobian: Jacobian,
    slopes: vec2f,
    row_x: vec3f,               // of an ellipsoid's J W R S
    row_y: vec3f,
}

struct Drawn {
    over_area: vec4f,           // J (xu, xv, yu, yv) over its determinant
    plane: vec2f,               // e and f
    slopes: vec2f,
    jacobian: Jacobian,
    opacity: f32,
    share: f32,                 // of what is drawn that is the splat's own
    has_disc: bool,
}

fn in_camera(v: vec3f) -> vec3f {
    return vec3f(dot(view.rows[0].xyz, v), dot(view.rows[1].xyz, v), dot(view.rows[2].xyz, v));
}

// By their bits: compilers may take comparisons with what is no number for granted.
fn is_finite(v: f32) -> bool {
    return (bitcast<u32>(v) & 0x7f800000u) != 0x7f800000u;
}

fn is_drawable(p: Parameters, near: f32, least: f32) -> bool {
    let is_number = is_finite(p.mean.x) && is_finite(p.mean.y) && is_finite(p.mean.z) && is_finite(p.opacity)
        && is_finite(p.quat.x) && is_finite(p.quat.y) && is_finite(p.quat.z) && is_finite(p.quat.w)
        && is_finite(p.scales.x) && is_finite(p.scales.y) && is_finite(p.scales.z);
    let smallest = min(p.scales.x, p.scales.y);
    let from_camera = (p.mean - view.place.xyz) - view.rest.xyz;
    return is_number && dot(view.rows[2].xyz, from_camera) > near && p.opacity >= least
        && (SOLID == 0u && smallest > 0.0 || SOLID == 1u && min(smallest, p.scales.z) > 0.0);
}

fn see(p: Parameters) -> Seen {
    var s: Seen;
    s.middle = in_camera((p.mean - view.place.xyz) - view.rest.xyz);
    let over_z = 1.0 / s.middle.z;
    s.across = s.middle.xy * over_z;
    s.bounded = clamp(s.across, view.slopes.xz, view.slopes.yw);
    // Divided by the largest first: squares of very long and very short ones leave the range of float32.
    let largest = max(max(abs(p.quat.x), abs(p.quat.y)), max(abs(p.quat.z), abs(p.quat.w)));
    s.length = 0.0;
    s.unit = vec4f(1.0, 0.0, 0.0, 0.0);
    if (largest > LEAST_NORM) {
        let scaled = p.quat / largest;
        let norm = sqrt(dot(scaled, scaled));
        s.length = norm * largest;
        s.unit = scaled / norm;
    }
    let w = s.unit.x;
    let x = s.unit.y;
    let y = s.unit.z;
    let z = s.unit.w;
    s.first = in_camera(vec3f(1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)));
    s.second = in_camera(vec3f(2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)));
    s.third = in_camera(vec3f(2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)));
    s.sizes = p.scales * over_z;
    let focal = view.lens.xy;
    if (SOLID == 1u) {
        s.row_x = focal.x * s.sizes * (vec3f(s.first.x, s.second.x, s.third.x)
            - s.bounded.x * vec3f(s.first.z, s.second.z, s.third.z));
        s.row_y = focal.y * s.sizes * (vec3f(s.first.y, s.second.y, s.third.y)
            - s.bounded.y * vec3f(s.first.z, s.second.z, s.third.z));
    } else {
        s.a_u = s.first.xy - s.across * s.first.z;
        s.a_v = s.second.xy - s.across * s.second.z;
        s.facing = s.third.x * s.across.x + s.third.y * s.across.y + s.third.z;
        let size = s.sizes.xy;
        s.jacobian = Jacobian(focal.x * size * vec2f(s.a_u.x, s.a_v.x), focal.y * size * vec2f(s.a_u.y, s.a_v.y));
        s.slopes = s.sizes.xy * vec2f(s.first.z, s.second.z);
    }
    return s;
}

fn area_of(s: Seen) -> f32 {
    return view.lens.x * view.lens.y * s.sizes.x * s.sizes.y * s.facing;
}

// sqrt(a^2 + b^2 w), whose squares may leave the range of float32.
fn root_of(a: f32, b: f32, w: f32) -> f32 {
    let beside = b * sqrt(w);
    let larger = max(max(abs(a), beside), SMALLEST);
    return larger * sqrt((a / larger) * (a / larger) + (beside / larger) * (beside / larger));
}

fn shown(opacity: f32, share: f32) -> f32 {
    return min(opacity, max(opacity * share, view.reaches.z));
}

// What a disc that is blurred has of its own plane, and whether that is all.
struct Plane {
    likely: vec2f,              // -C^-1 J q
    own: vec2f,                 // of the plane, times the facing
    over: f32,
    is_flat: bool,
}

fn plane_of(s: Seen, xx: f32, xy: f32, yy: f32, root: f32) -> Plane {
    let own = s.third.xy / view.lens.xy;
    let along = vec2f(dot(s.jacobian.x, s.slopes), dot(s.jacobian.y, s.slopes));
    let likely = vec2f(xy * along.y - yy * along.x, xy * along.x - xx * along.y) / root / root;
    let steepest = view.reaches.y;
    let steepness2 = dot(own, own);
    if (steepest * steepest * s.facing * s.facing >= steepness2 && abs(s.facing) >= LEAST_FACING) {
        return Plane(likely, own, 1.0 / s.facing, true);
    }
    return Plane(likely, own, steepest * steepest * s.facing / max(steepness2, LEAST_FACING * LEAST_FACING), false);
}

fn drawn_from(s: Seen, opacity: f32) -> Drawn {
    var d: Drawn;
    d.share = 1.0;
    d.has_disc = true;
    let blur = view.filters.z;
    if (SOLID == 1u || ANTIALIASED == 1u) {
        var xx = 0.0;
        var xy = 0.0;
        var yy = 0.0;
        var area = 0.0;
        if (SOLID == 1u) {
            xx = dot(s.row_x, s.row_x);
            xy = dot(s.row_x, s.row_y);
            yy = dot(s.row_y, s.row_y);
            area = length(cross(s.row_x, s.row_y));
        } else {
            xx = dot(s.jacobian.x, s.jacobian.x);
            xy = dot(s.jacobian.x, s.jacobian.y);
            yy = dot(s.jacobian.y, s.jacobian.y);
            area = area_of(s);
        }
        let root = root_of(area, blur, xx + yy + blur * blur);
        xx += blur * blur;
        yy += blur * blur;
        let upper = sqrt(xx);
        let beside = xy / upper;
        let lower = root / upper;
        d.jacobian = Jacobian(vec2f(upper, 0.0), vec2f(beside, lower));
        d.over_area = vec4f(1.0 / lower, 0.0, beside / root, 1.0 / upper);
        if (ANTIALIASED == 1u) { d.share = abs(area) / root; }
        if (SOLID == 0u) {
            let plane = plane_of(s, xx, xy, yy, root);
            d.plane = plane.over * plane.own;
            if (!plane.is_flat) { d.plane += (1.0 - plane.over * s.facing) * plane.likely; }
            d.slopes = vec2f(-upper * d.plane.x - beside * d.plane.y, -lower * d.plane.y);
        }
    } else {
        d.jacobian = s.jacobian;
        d.slopes = s.slopes;
        d.has_disc = abs(area_of(s)) >= view.reaches.w;
        if (d.has_disc) {
            let over = 1.0 / s.facing;
            let by_u = over / (view.lens.xy * s.sizes.x);
            let by_v = over / (view.lens.xy * s.sizes.y);
            d.over_area = vec4f(s.a_u.x * by_v.y, s.a_v.x * by_u.y, s.a_u.y * by_v.x, s.a_v.y * by_u.x);
            d.plane = over * s.third.xy / view.lens.xy;
        } else {
            d.over_area = vec4f(EDGE_ON_JACOBIAN, 0.0, 0.0, EDGE_ON_JACOBIAN);
        }
    }
    d.opacity = shown(opacity, d.share);
    return d;
}
