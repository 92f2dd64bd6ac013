// Splats, blended from far to near into three pictures: (1 - R) c, R F0 and R, each with the opacity beside it.
//
// Eq. 19, I = (1 - R) c + R F L, is linear in these three, so what is blended is the sum over surfaces that each is
// shaded for itself (see `reconstruction.training.model.joint_model`); `mirrors.wgsl` shades the sums. A splat has two
// colours by direction: the one of the plain page, with mirrored light baked in, and for those on panes their own, c.
@group(0) @binding(1) var<storage, read> words: array<vec4u>;  // two for each splat, as `web.py` packs them
@group(0) @binding(2) var<storage, read> rest: array<u32>;     // bytes of harmonics from degree 1 on
@group(0) @binding(3) var<storage, read> rows: array<u32>;     // where a splat's own values are, + 1; 0 for none
@group(0) @binding(4) var<storage, read> glass: array<u32>;    // own values: colour and R, F0, bytes of harmonics
@group(0) @binding(5) var<storage, read> tints: array<u32>;    // by pane + 1
@group(0) @binding(6) var<storage, read_write> shown: array<vec4u>;
@group(0) @binding(7) var<uniform> steps: array<vec4f, 8>;     // of the harmonics' bytes: the page's, then own ones
@group(0) @binding(8) var<storage, read> looks: array<vec4u>;  // `shown`, as the next pass reads it
@group(0) @binding(9) var<storage, read> order: array<u32>;    // from far to near

struct Harmonics { own: bool, first: u32 }

fn signed_byte(from_: Harmonics, number: u32) -> f32 {
  let place = from_.first + number / 4u;
  var word = 0u;
  if (from_.own) { word = glass[place]; } else { word = rest[place]; }
  return f32(i32(word << (24u - 8u * (number & 3u))) >> 24u);
}

fn coefficient(from_: Harmonics, k: u32) -> vec3f {
  let row = k / 4u + select(0u, 4u, from_.own);
  let bytes = vec3f(signed_byte(from_, 3u * k), signed_byte(from_, 3u * k + 1u), signed_byte(from_, 3u * k + 2u));
  return bytes * steps[row][k & 3u];
}

fn by_direction(from_: Harmonics, d: vec3f) -> vec3f {
  let x = d.x; let y = d.y; let z = d.z;
  var c = vec3f(0.0);
  if (view.degree < 0.5) { return c; }
  c = 0.4886025 * (-y * coefficient(from_, 0u) + z * coefficient(from_, 1u) - x * coefficient(from_, 2u));
  if (view.degree < 1.5) { return c; }
  let xx = x * x; let yy = y * y; let zz = z * z;
  c += 1.0925484 * (x * y * coefficient(from_, 3u) - y * z * coefficient(from_, 4u) - x * z * coefficient(from_, 6u))
    + 0.3153916 * (3.0 * zz - 1.0) * coefficient(from_, 5u) + 0.5462742 * (xx - yy) * coefficient(from_, 7u);
  if (view.degree < 2.5) { return c; }
  return c - 0.5900436 * (y * (3.0 * xx - yy) * coefficient(from_, 8u) + x * (xx - 3.0 * yy) * coefficient(from_, 14u))
    + 2.8906114 * x * y * z * coefficient(from_, 9u) + 1.4453057 * z * (xx - yy) * coefficient(from_, 13u)
    - 0.4570458 * (5.0 * zz - 1.0) * (y * coefficient(from_, 10u) + x * coefficient(from_, 12u))
    + 0.3731763 * z * (5.0 * zz - 3.0) * coefficient(from_, 11u);
}

fn bytes_of(word: u32) -> vec4f {
  return unpack4x8unorm(word);
}

// Once a place of the camera and not once a corner: harmonics cost more than all the rest.
@compute @workgroup_size(256)
fn colour_splats(@builtin(global_invocation_id) id: vec3u) {
  let i = id.x;
  if (i >= arrayLength(&shown)) { return; }
  let a = words[2u * i];
  let b = words[2u * i + 1u];
  let towards = bitcast<vec3f>(a.xyz) - view.eye;
  let direction = towards / max(length(towards), 1e-6);
  var words_of_degree = array<u32, 4>(0u, 3u, 6u, 12u);
  let n_rest = words_of_degree[u32(view.degree)];
  var from_ = Harmonics(false, i * n_rest);
  var flat_colour = bytes_of(b.w).rgb;
  var reflectivity = 0.0;
  var f0 = vec3f(0.0);
  let row = rows[i];
  if (row > 0u && view.mirrors > 0.0) {
    let at = (row - 1u) * (n_rest + 2u);
    from_ = Harmonics(true, at + 2u);
    let own = bytes_of(glass[at]);
    flat_colour = own.rgb;
    reflectivity = own.a;
    f0 = bytes_of(glass[at + 1u]).rgb;
  }
  var colour = view.colour_low + view.colour_step * flat_colour + by_direction(from_, direction);
  let tint = bytes_of(tints[b.z >> 16u]);
  if (tint.a > 0.0) {
    let within = clamp(colour, vec3f(0.0), vec3f(1.0));
    colour = mix(within, tint.rgb * (0.65 + 0.5 * dot(within, vec3f(0.3, 0.59, 0.11))), tint.a);
    reflectivity *= 1.0 - tint.a;
  }
  let light = (1.0 - reflectivity) * light_of(colour);
  let mirrored = reflectivity * f0;
  shown[i] = vec4u(pack2x16float(light.rg), pack2x16float(vec2f(light.b, reflectivity)),
    pack2x16float(mirrored.rg), pack2x16float(vec2f(mirrored.b, 0.0)));
}

struct Splat {
  @builtin(position) position: vec4f,
  @location(0) place: vec2f, // in standard deviations
  @location(1) @interpolate(flat) light: vec4f,    // (1 - R) c, opacity
  @location(2) @interpolate(flat) mirrored: vec4f, // R F0, R
}

// How a place in standard deviations moves on the screen, the relative change of the depth with it, and the share of
// the opacity that the low-pass leaves.
struct Outline { onto: mat2x2f, slopes: vec2f, share: f32 }

// Discs as a ray meets them (Huang et al., 2024), blurred as `reconstruction.splats.rasterising.projection` does it.
fn disc(p: vec3f, u: vec3f, v: vec3f) -> Outline {
  let q = vec2f(u.z, v.z) / p.z;
  let ju = view.focal * (u.xy - p.xy * q.x) / p.z;
  let jv = view.focal * (v.xy - p.xy * q.y) / p.z;
  let area = ju.x * jv.y - jv.x * ju.y;
  let square = area * area + view.blur * (dot(ju, ju) + dot(jv, jv) + view.blur);
  let xx = ju.x * ju.x + jv.x * jv.x + view.blur;
  let xy = ju.x * ju.y + jv.x * jv.y;
  let yy = ju.y * ju.y + jv.y * jv.y + view.blur;
  let along = ju * q.x + jv * q.y;
  let likely = vec2f(xy * along.y - yy * along.x, xy * along.x - xx * along.y) / square;
  let plane = vec2f(ju.y * q.y - jv.y * q.x, jv.x * q.x - ju.x * q.y);
  let tiny = 1e-18;
  let steepest = 5.6712818 / view.focal; // of a plane at 80 degrees
  let limit = steepest * steepest;
  let steep = dot(plane, plane);
  var over = limit * area / max(steep, tiny);
  if (limit * area * area >= steep && abs(area) > tiny) { over = 1.0 / area; }
  let tilt = (1.0 - over * area) * likely + over * plane;
  let right = sqrt(xx);
  let beside = xy / right;
  let lower = sqrt(square) / right;
  return Outline(mat2x2f(right, beside, 0.0, lower), -vec2f(right * tilt.x + beside * tilt.y, lower * tilt.y),
    abs(area) / sqrt(square));
}

// Ellipsoids projected to ellipses (Zwicker et al., 2001; Kerbl et al., 2023).
fn ellipsoid(p: vec3f, axes: mat3x3f) -> Outline {
  let limit = 1.3 * 0.5 * view.sight / view.focal;
  let tangent = clamp(p.xy / p.z, -limit, limit);
  var xx = 0.0;
  var xy = 0.0;
  var yy = 0.0;
  for (var i = 0; i < 3; i++) {
    let t = view.focal / p.z * (axes[i].xy - tangent * axes[i].z);
    xx += t.x * t.x;
    xy += t.x * t.y;
    yy += t.y * t.y;
  }
  let sharp = xx * yy - xy * xy;
  xx += view.blur;
  yy += view.blur;
  let middle = 0.5 * (xx + yy);
  let half_ = 0.5 * (xx - yy);
  let far = sqrt(half_ * half_ + xy * xy);
  let angle = 0.5 * atan2(xy, select(half_, 1.0, far < 1e-6));
  let long_ = vec2f(cos(angle), sin(angle));
  let lengths = sqrt(vec2f(middle + far, max(middle - far, 0.5 * view.blur)));
  return Outline(mat2x2f(lengths.x * long_, lengths.y * vec2f(-long_.y, long_.x)), vec2f(0.0),
    sqrt(clamp(sharp / (xx * yy - xy * xy), 0.0, 1.0)));
}

fn turned(q: vec4f) -> mat3x3f {
  let w = q.x; let x = q.y; let y = q.z; let z = q.w;
  return mat3x3f(
    1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y),
    2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x),
    2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y));
}

fn in_camera(axis: vec3f) -> vec3f {
  return vec3f(dot(axis, view.right), dot(axis, view.down), dot(axis, view.forward));
}

@vertex
fn splat_corner(@builtin(vertex_index) corner: u32, @builtin(instance_index) instance: u32) -> Splat {
  var out: Splat;
  out.position = vec4f(0.0, 0.0, 2.0, 1.0); // outside: not drawn
  let index = order[instance];
  let a = words[2u * index];
  let p = seen(bitcast<vec3f>(a.xyz));
  if (p.z < 0.2) { return out; }
  let b = words[2u * index + 1u];
  if (view.before > 0.0 && ((b.z >> 16u) > 0u || p.z > view.before)) { return out; }
  var opacity = f32(b.w >> 24u) / 255.0;
  if (opacity < 1.0 / 255.0) { return out; }

  let q = vec4f(unpack2x16float(a.w), unpack2x16float(b.x));
  let axes = turned(q / max(length(q), 1e-6));
  let sizes = vec3f(unpack2x16float(b.y), unpack2x16float(b.z & 0xffffu).x);
  var outline: Outline;
  let thinnest = 4e-6; // metres: what is thinner is a disc
  if (sizes.z < thinnest) {
    outline = disc(p, sizes.x * in_camera(axes[0]), sizes.y * in_camera(axes[1]));
  } else {
    let largest = 3.4 * (view.focal / p.z * max(sizes.x, max(sizes.y, sizes.z))
      * (1.0 + length(0.65 * view.sight / view.focal)) + 1.0);
    if (any(abs(view.focal * p.xy / p.z) > 0.5 * view.sight + largest)) { return out; }
    outline = ellipsoid(p, mat3x3f(sizes.x * in_camera(axes[0]), sizes.y * in_camera(axes[1]), sizes.z * in_camera(axes[2])));
  }
  // Small ones do not vanish from afar.
  if (view.antialiased > 0.0) { opacity = min(opacity, max(opacity * outline.share, 2.0 / 255.0)); }
  let reach = sqrt(2.0 * log(255.0 * opacity));
  let place = (vec2f(f32(corner & 1u), f32(corner >> 1u)) * 2.0 - 1.0) * reach;
  // In one plane, so that what lies between the corners is where a ray meets it.
  let depth = 1.0 + dot(outline.slopes, place);
  let at = (view.focal * p.xy / p.z - view.shift) * depth + outline.onto * place;
  let near = 0.1;
  out.position = vec4f(2.0 * at.x / view.size.x, -2.0 * at.y / view.size.y, depth - near / p.z, depth);
  out.place = place;
  let look = looks[index];
  let second = unpack2x16float(look.y);
  out.light = vec4f(unpack2x16float(look.x), second.x, opacity);
  out.mirrored = vec4f(unpack2x16float(look.z), unpack2x16float(look.w).x, second.y);
  return out;
}

struct Blended {
  @location(0) light: vec4f,        // (1 - R) c, opacity
  @location(1) mirrored: vec4f,     // R F0, opacity
  @location(2) reflectivity: vec4f, // R in the first, opacity in the last
}

@fragment
fn splat_pixel(splat: Splat) -> Blended {
  let alpha = min(0.99, splat.light.a * exp(-0.5 * dot(splat.place, splat.place)));
  if (alpha < 1.0 / 255.0) { discard; }
  return Blended(vec4f(splat.light.rgb * alpha, alpha), vec4f(splat.mirrored.rgb * alpha, alpha),
    vec4f(splat.mirrored.a * alpha, 0.0, 0.0, alpha));
}
