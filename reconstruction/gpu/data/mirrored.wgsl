// Panes as mirrors (paper Eqs. 19 to 21): each pixel's ray meets its pane's plane, is mirrored by the pane's normal,
// which leans and is bowed a little, and marches through the radiance grid; what is left of its light comes from far
// away. Where the model has an environment map, all light does; a network says it by place and direction
// (network.wgsl).
//
// The window and web pages share this. Who includes it declares `view`: eye, right, down, forward, focal length in
// pixels, and how many rays go through a pixel along each of its sides.
//
// The formulas are those of `reconstruction.light`: `ray_table` (rays and planes), `glass_light` (tilts, bows, several
// rays for a pixel), `radiance_grid` (the march), `environment_map`, and `joint_model` (the sum). Cost: some tens of
// places for each ray, as empty cells are leapt over.
struct Light {
  middle: vec3f,    // of the cube that places are rescaled by, metres
  half_side: f32,
  inner: vec3f,     // middle of the grid's inner box, along its own axes, rescaled as all that follows
  cell: f32,        // shortest side of a cell
  over: vec3f,      // 1 over the inner box's half sides
  outer: f32,       // what is around it, of its half sides
  turn: vec2f,      // cosine and sine of the box's heading
  reach: f32,       // up to which steps are equally long
  unit: f32,        // density of a ramp of 1
  far_side: f32,    // pixels of the square picture of what is far away, without its rim
  far_times: f32,   // times `reach`, to where rays are followed
  density_scale: f32,
  opaque_share: f32,
  kind: f32,        // OF_GRID, OF_MAP or OF_NETWORK
}
@group(0) @binding(10) var<uniform> light: Light;

struct Pane {
  corner: vec4f, // first corner, metres; lean along the lower edge, radians
  normal: vec4f, // outward, unit; lean upwards
  right: vec4f,  // lower edge over its squared length; bow along it, radians at the pane's edges
  up: vec4f,     // left edge, the same
}
@group(0) @binding(11) var<storage, read> panes: array<Pane>;
@group(0) @binding(12) var cells: texture_3d<f32>; // density, and square roots of light
@group(0) @binding(13) var skips: texture_3d<u32>; // cells that a ray may leap
@group(0) @binding(14) var far: texture_2d<f32>;   // square roots of light by direction, an octahedron folded out;
                                                   // or an environment map's pictures, whose sum is logits of light
@group(0) @binding(15) var between: sampler;       // linear, clamped
@group(0) @binding(17) var around: sampler;        // linear, round without a seam
@group(0) @binding(24) var<storage, read> answers: array<vec4f>; // of a network, by ray

const OF_GRID = 0.0;
const OF_MAP = 1.0;
const OF_NETWORK = 2.0;
const LEAST_COSINE = 1e-3;
const LEAST_REFLECTIVITY = 1e-3;
const SKY_SEEN = 1.0 / 512.0;

// -1 to 1 stays; what is beyond, up to infinity, goes on to 1 + `outer` on either side.
fn contracted(place: vec3f) -> vec3f {
  let size = max(abs(place), vec3f(1.0));
  return select(sign(place) * (1.0 + light.outer * (1.0 - 1.0 / size)), place, abs(place) <= vec3f(1.0));
}

fn ramp(raw: f32) -> f32 {
  if (raw >= 1.0) { return raw; }
  let above = max(0.5 * (raw + 1.0), 0.0);
  return above * above;
}

fn in_box(enu: vec3f) -> vec3f {
  return vec3f(light.turn.x * enu.x - light.turn.y * enu.y, light.turn.y * enu.x + light.turn.x * enu.y, enu.z);
}

fn far_light(d: vec3f) -> vec3f {
  var place = d.xy / (abs(d.x) + abs(d.y) + abs(d.z));
  if (d.z < 0.0) {
    place = (1.0 - abs(place.yx)) * select(vec2f(-1.0), vec2f(1.0), place >= vec2f(0.0));
  }
  let at = ((place + 1.0) * 0.5 * light.far_side + 1.0) / (light.far_side + 2.0);
  let root = textureSampleLevel(far, between, at, 0.0).rgb;
  return root * root;
}

// Light that comes along a ray from a rescaled place, ENU; the direction is unit.
fn marched(place: vec3f, direction: vec3f) -> vec3f {
  let turned_direction = in_box(direction);
  let p = (in_box(place) - light.inner) * light.over;
  let q = turned_direction * light.over;
  let counts = vec3f(textureDimensions(cells));
  let last = vec3i(textureDimensions(skips)) - 1;
  let scale = 0.5 / (1.0 + light.outer) * (counts - 1.0);
  let end = light.far_times * light.reach;
  var through = 1.0;
  var found = vec3f(0.0);
  var time = 0.0;
  while (time < end) {
    let step = light.cell * max(1.0, time / light.reach);
    let at = (contracted(p + (time + 0.5 * step) * q) + (1.0 + light.outer)) * scale;
    let leap = textureLoad(skips, clamp(vec3i(at), vec3i(0), last), 0).r;
    time += step;
    if (leap > 0u) {
      let goal = time - step + f32(leap - 1u) * light.cell;
      while (time < goal && time < end) { time += light.cell * max(1.0, time / light.reach); }
      continue;
    }
    let value = textureSampleLevel(cells, between, (at + 0.5) / counts, 0.0);
    let raw = light.density_scale * value.x;
    if (raw <= -1.0) { continue; }
    let share = through * (1.0 - exp(-ramp(raw) * light.unit * step));
    found += share * value.yzw * value.yzw;
    through -= share;
    if (through < light.opaque_share) { break; }
  }
  return found + through * far_light(turned_direction);
}

// Where a picture of all directions shows one: turns clockwise from north, and 0 at the zenith to 1 at the nadir. A
// unit direction: east, north, up.
fn map_place(d: vec3f) -> vec2f {
  let north = select(1.0, d.y, abs(d.x) + abs(d.y) > 1e-6);
  return vec2f(atan2(d.x, north) / 6.2831853, 0.5 - asin(clamp(d.z, -1.0, 1.0)) / 3.1415927);
}

// Light that comes along a ray to a pane from a model that is asked here and now; networks have been asked before.
fn arriving(ray: Ray) -> vec3f {
  if (light.kind == OF_GRID) { return marched(ray.place, ray.direction); }
  let at = map_place(ray.direction);
  var logits = vec3f(0.0);
  for (var level = 0u; level < textureNumLevels(far); level++) {
    logits += textureSampleLevel(far, around, at, f32(level)).rgb;
  }
  return 1.0 / (1.0 + exp(-logits));
}

// A ray through a part of a pixel, mirrored: from where on the pane, rescaled, and where to; the cosine of its angle of
// incidence; and whether it meets the pane inside its edges.
struct Ray { place: vec3f, direction: vec3f, cosine: f32, is_inside: bool }

// `k` counts the squares of a pixel; pixels are counted from where the optical axis is.
fn mirror(number: u32, pixel: vec2f, k: i32) -> Ray {
  let pane = panes[number];
  let lower = normalize(pane.right.xyz);
  let upward = cross(pane.normal.xyz, lower);
  let height = dot(view.eye - pane.corner.xyz, pane.normal.xyz);
  let side = i32(view.rays);
  let offset = (vec2f(f32(k % side), f32(k / side)) + 0.5) / view.rays - 0.5;
  let tangent = (pixel + offset) / view.focal;
  let d = normalize(view.forward + tangent.x * view.right + tangent.y * view.down);
  let met = view.eye + height / max(-dot(d, pane.normal.xyz), LEAST_COSINE) * d;
  let shares = vec2f(dot(pane.right.xyz, met - pane.corner.xyz), dot(pane.up.xyz, met - pane.corner.xyz));
  let off_middle = 2.0 * clamp(shares, vec2f(0.0), vec2f(1.0)) - 1.0;
  let lean = vec2f(pane.corner.w, pane.normal.w) + vec2f(pane.right.w, pane.up.w) * off_middle;
  let normal = normalize(pane.normal.xyz + lean.x * lower + lean.y * upward);
  let along = dot(d, normal);
  let is_inside = all(shares >= vec2f(0.0)) && all(shares <= vec2f(1.0));
  return Ray((met - light.middle) / light.half_side, d - 2.0 * along * normal, min(abs(along), 1.0), is_inside);
}

struct Mirrored { light: vec3f, cosine: f32 }

// What a pane shows of its surroundings to a pixel, on average over the rays that meet it inside its edges; where none
// does, over all of them, as if the pane went on. `first`: of the pixel's answers, where a network was asked.
fn mirrored_by(number: u32, pixel: vec2f, first: u32) -> Mirrored {
  let side = i32(view.rays);
  var inside = Mirrored(vec3f(0.0), 0.0);
  var every = Mirrored(vec3f(0.0), 0.0);
  var n_inside = 0.0;
  for (var k = 0; k < side * side; k++) {
    let ray = mirror(number, pixel, k);
    var found: vec3f;
    if (light.kind == OF_NETWORK) { found = answers[first + u32(k)].rgb; } else { found = arriving(ray); }
    every = Mirrored(every.light + found, every.cosine + ray.cosine);
    if (ray.is_inside) {
      inside = Mirrored(inside.light + found, inside.cosine + ray.cosine);
      n_inside += 1.0;
    }
  }
  if (n_inside > 0.0) { return Mirrored(inside.light / n_inside, inside.cosine / n_inside); }
  let n = view.rays * view.rays;
  return Mirrored(every.light / n, every.cosine / n);
}

// Of a share R of the surface, and R F0 in the place of F0, Schlick's term is R F (Eq. 21).
fn reflectance(of_share: vec3f, share: f32, cosine: f32) -> vec3f {
  let grazing = 1.0 - clamp(cosine, 0.0, 1.0);
  let square = grazing * grazing;
  return of_share + (share - of_share) * (square * square * grazing);
}
