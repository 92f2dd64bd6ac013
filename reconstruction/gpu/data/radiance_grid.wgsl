// Rays of pixels that panes mirror, and the radiance grid that they march through, as training has them: float32
// values, and places along rays from a list. See light/ray_table.py, light/glass_light.py and light/radiance_grid.py.
struct Mirrors {
    eye: vec4f,                 // of the camera, rescaled; 1 over the half side that places are rescaled by
    inner: vec4f,               // middle of the grid's inner box, along its own axes; shortest side of a cell
    over: vec4f,                // 1 over its half sides; what is around it, of these
    turn: vec4f,                // cosine and sine of its heading; density of a ramp of 1; whether all rays begin alike
    counts: vec4u,              // vertices along x, y and z; pixels along the picture of what is far away
    rays: vec4u,                // along each side of a pixel, places along a ray, seed; slots of cells
}

struct Ray {
    place: vec3f,               // rescaled, in the box's axes
    way: vec3f,                 // unit, in the box's axes
    from_camera: vec3f,         // unit, ENU
    normal: vec3f,
    length: f32,                // of the normal before it was made unit
    off_middle: vec2f,          // of the pane, -1 to 1
    along: f32,
    is_inside: bool,
}

fn hashed_share(number: u32, which: u32) -> f32 {
    var h = number * 747796405u + which * 2891336453u + mirrors.rays.z * 277803737u + 1u;
    h = ((h >> ((h >> 28u) + 4u)) ^ h) * 277803737u;
    h = (h >> 22u) ^ h;
    h = ((h >> ((h >> 28u) + 4u)) ^ h) * 277803737u;
    return (f32((h >> 22u) ^ h) + 0.5) / 4294967296.0;
}

fn in_box(v: vec3f) -> vec3f {
    return vec3f(mirrors.turn.x * v.x - mirrors.turn.y * v.y, mirrors.turn.y * v.x + mirrors.turn.x * v.y, v.z);
}

fn out_of_box(v: vec3f) -> vec3f {
    return vec3f(mirrors.turn.x * v.x + mirrors.turn.y * v.y, mirrors.turn.x * v.y - mirrors.turn.y * v.x, v.z);
}

// The k-th of a pixel's rays: through the middle of its square, or anywhere in it where there is a seed.
fn mirrored_ray(pane: u32, pixel: vec2u, number: u32, k: u32) -> Ray {
    let a = textureLoad(panes, texel(6u * pane), 0);
    let b = textureLoad(panes, texel(6u * pane + 1u), 0);
    let c = textureLoad(panes, texel(6u * pane + 2u), 0);
    let e = textureLoad(panes, texel(6u * pane + 3u), 0);
    let f = textureLoad(panes, texel(6u * pane + 4u), 0);
    let bows = textureLoad(panes, texel(6u * pane + 5u), 0).xy;
    let side = mirrors.rays.x;
    let ray = number * side * side + k;
    let within = select(vec2f(0.5), vec2f(hashed_share(ray, 0u), hashed_share(ray, 1u)), mirrors.rays.z != 0u);
    let offset = (vec2f(f32(k % side), f32(k / side)) + within) / f32(side) - 0.5;
    let slope = (vec2f(pixel) + 0.5 + offset - view.lens.zw) / view.lens.xy;
    var r: Ray;
    r.from_camera = in_world(normalize(vec3f(slope, 1.0)));
    let distance = a.w / max(-dot(r.from_camera, a.xyz), LEAST_COSINE);
    let shares = vec2f(b.w, c.w) + distance * vec2f(dot(b.xyz, r.from_camera), dot(c.xyz, r.from_camera));
    r.is_inside = all(shares >= vec2f(0.0)) && all(shares <= vec2f(1.0));
    r.off_middle = 2.0 * clamp(shares, vec2f(0.0), vec2f(1.0)) - 1.0;
    let lean = vec2f(e.w, f.w) + bows * r.off_middle;
    let leaning = a.xyz + lean.x * e.xyz + lean.y * f.xyz;
    r.length = max(length(leaning), SHORTEST_NORMAL);
    r.normal = leaning / r.length;
    r.along = dot(r.from_camera, r.normal);
    r.place = in_box(mirrors.eye.xyz + distance * mirrors.eye.w * r.from_camera);
    r.way = in_box(r.from_camera - 2.0 * r.along * r.normal);
    return r;
}

// Share of a step by which a ray's places are further on: spread evenly.
fn start_of(number: u32, k: u32) -> f32 {
    return select(hashed_share(number * mirrors.rays.x * mirrors.rays.x + k, 2u), 0.5, mirrors.turn.w > 0.0);
}

// -1 to 1 stays; what is beyond, up to infinity, goes on to 1 + outer.
fn contracted(v: vec3f) -> vec3f {
    let size = max(abs(v), vec3f(1.0));
    return select(sign(v) * (1.0 + mirrors.over.w * (1.0 - 1.0 / size)), v, abs(v) <= vec3f(1.0));
}

fn contracted_slope(v: vec3f) -> vec3f {
    return select(mirrors.over.w / (v * v), vec3f(1.0), abs(v) <= vec3f(1.0));
}

// 0 up to -1, raw from 1 on, a parabola in between; and its slope.
fn ramp(raw: f32) -> vec2f {
    if (raw >= 1.0) { return vec2f(raw, 1.0); }
    let above = max(0.5 * (raw + 1.0), 0.0);
    return vec2f(above * above, above);
}

struct Line { start: vec3f, way: vec3f }

// Along it the inner box is -1 to 1.
fn line_of(r: Ray) -> Line {
    return Line((r.place - mirrors.inner.xyz) * mirrors.over.xyz, r.way * mirrors.over.xyz);
}

fn scale_of_cells() -> vec3f {
    return 0.5 / (1.0 + mirrors.over.w) * (vec3f(mirrors.counts.xyz) - 1.0);
}

// Where a ray is in the grid, counted in cells.
fn place_in_grid(line: Line, time: f32) -> vec3f {
    return (contracted(line.start + time * line.way) + (1.0 + mirrors.over.w)) * scale_of_cells();
}

fn first_vertex(at: vec3f) -> vec3u {
    return vec3u(clamp(vec3i(at), vec3i(0), vec3i(mirrors.counts.xyz) - 2));
}

fn number_of_vertex(v: vec3u) -> u32 {
    return (v.z * mirrors.counts.y + v.y) * mirrors.counts.x + v.x;
}

fn skip_at(v: vec3u) -> u32 {
    let number = (v.z * (mirrors.counts.y - 1u) + v.y) * (mirrors.counts.x - 1u) + v.x;
    return (skips[number / 4u] >> (8u * (number % 4u))) & 255u;
}

// Of the place after one in an empty cell, from which something is `skip` cells away at least.
fn next_place(number: u32, skip: u32) -> u32 {
    let reach = textureLoad(times, texel(number), 0).x + f32(skip - 1u) * mirrors.inner.w;
    var next = number + 1u;
    while (next < mirrors.rays.y && textureLoad(times, texel(next), 0).x < reach) { next += 1u; }
    return next;
}

fn vertex(v: vec3u, x: u32, y: u32, z: u32) -> vec4f {
    return textureLoad(cells, texel(number_of_vertex(v + vec3u(x, y, z))), 0);
}

// Pixels of the picture of what is far away around a direction: an octahedron folded out.
struct FarAround { numbers: vec4u, shares: vec4f, column: f32, row: f32 }

fn wrapped(column: i32, row: i32) -> u32 {
    let side = i32(mirrors.counts.w);
    var x = column;
    var y = row;
    if (x < 0 || x >= side) {
        x = select(side - 1, 0, x < 0);
        y = side - 1 - y;
    }
    if (y < 0 || y >= side) {
        y = select(side - 1, 0, y < 0);
        x = side - 1 - x;
    }
    return u32(y * side + x);
}

fn far_around(d: vec3f) -> FarAround {
    var place = d.xy / (abs(d.x) + abs(d.y) + abs(d.z));
    if (d.z < 0.0) { place = (1.0 - abs(place.yx)) * select(vec2f(-1.0), vec2f(1.0), place >= vec2f(0.0)); }
    let half_side = 0.5 * f32(mirrors.counts.w);
    let at = place * half_side + half_side - 0.5;
    let corner = floor(at);
    let share = at - corner;
    let column = i32(corner.x);
    let row = i32(corner.y);
    return FarAround(
        vec4u(wrapped(column, row), wrapped(column + 1, row), wrapped(column, row + 1), wrapped(column + 1, row + 1)),
        vec4f((1.0 - share.x) * (1.0 - share.y), share.x * (1.0 - share.y), (1.0 - share.x) * share.y,
            share.x * share.y),
        share.x, share.y);
}

fn far_root(number: u32) -> vec3f {
    return textureLoad(far, texel(number), 0).xyz;
}

fn root_of_far(a: FarAround) -> vec3f {
    return a.shares.x * far_root(a.numbers.x) + a.shares.y * far_root(a.numbers.y)
        + (a.shares.z * far_root(a.numbers.z) + a.shares.w * far_root(a.numbers.w));
}
