// The sums of splats, shaded with what panes mirror (mirrored.wgsl), and the sky behind them.
@group(0) @binding(16) var sky: texture_2d<f32>;   // linear light of all directions
@group(0) @binding(18) var own_light: texture_2d<f32>;
@group(0) @binding(19) var own_mirrored: texture_2d<f32>;
@group(0) @binding(20) var own_reflectivity: texture_2d<f32>;
@group(0) @binding(21) var pane_numbers: texture_2d<u32>; // + 1, 0 for none
@group(0) @binding(25) var<storage, read> firsts: array<u32>; // of each pixel's answers, where a network is asked
@group(0) @binding(31) var<storage, read_write> rays: array<vec4f>;
@group(0) @binding(32) var<storage, read_write> n_rays: array<atomic<u32>>;
@group(0) @binding(33) var<storage, read_write> first_rays: array<u32>; // `firsts`, as they are written
@group(0) @binding(34) var<uniform> strip: vec4u;                       // first of the pixels to be shaded, and how many

// Whose plane mirrors: the pane's that the middle of the pixel shows, else one that shows beside it, since of a pixel
// that glass and frame share, the splats say how much mirrors, but not where to.
fn pane_at(at: vec2i) -> u32 {
  let here = textureLoad(pane_numbers, at, 0).r;
  if (here > 0u) { return here; }
  let last = vec2i(textureDimensions(pane_numbers)) - 1;
  var beside = array<vec2i, 4>(vec2i(-1, 0), vec2i(1, 0), vec2i(0, -1), vec2i(0, 1));
  var found = 0u;
  for (var i = 0; i < 4; i++) {
    let place = at + beside[i];
    if (any(place < vec2i(0)) || any(place > last)) { continue; }
    found = max(found, textureLoad(pane_numbers, place, 0).r);
  }
  return found;
}

fn off_axis(at: vec2i) -> vec2f { return vec2f(at) + 0.5 - 0.5 * view.size + view.shift; }

// Mirrored rays of a strip's pixels, one after the other, for a network to be asked.
@compute @workgroup_size(64)
fn list_rays(@builtin(global_invocation_id) id: vec3u) {
  if (id.x >= strip.y) { return; }
  let place = strip.x + id.x;
  let width = u32(view.size.x);
  let at = vec2i(vec2u(place % width, place / width));
  let number = pane_at(at);
  if (number == 0u || textureLoad(own_reflectivity, at, 0).r <= LEAST_REFLECTIVITY) { return; }
  let n = u32(view.rays * view.rays);
  let first = atomicAdd(&n_rays[0], n);
  first_rays[place] = first;
  for (var k = 0u; k < n; k++) {
    let ray = mirror(number - 1u, off_axis(at), i32(k));
    rays[2u * (first + k)] = vec4f(ray.place, 0.0);
    rays[2u * (first + k) + 1u] = vec4f(ray.direction, 0.0);
  }
}

@compute @workgroup_size(256)
fn ask_network(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) { ask(group.x, lane); }

@vertex
fn shade_corner(@builtin(vertex_index) number: u32) -> @builtin(position) vec4f { return corner_of_all(number); }

@fragment
fn shade_pixel(@builtin(position) position: vec4f) -> @location(0) vec4f {
  let at = vec2i(position.xy);
  let pixel = off_axis(at);
  let own = textureLoad(own_light, at, 0);
  var sum = own.rgb;
  let reflectivity = textureLoad(own_reflectivity, at, 0).r;
  let number = pane_at(at);
  if (view.mirrors > 0.0 && number > 0u && reflectivity > LEAST_REFLECTIVITY) {
    let f0 = textureLoad(own_mirrored, at, 0).rgb;
    var first = 0u;
    if (light.kind == OF_NETWORK) { first = firsts[u32(at.y) * u32(view.size.x) + u32(at.x)]; }
    let mirrored = mirrored_by(number - 1u, pixel, first);
    sum += reflectance(f0, reflectivity, mirrored.cosine) * mirrored.light;
  }
  if (1.0 - own.a > SKY_SEEN) {
    let d = normalize(view.forward + (pixel.x * view.right + pixel.y * view.down) / view.focal);
    // The sky's columns begin in the south (`reconstruction.splats.sky`).
    sum += (1.0 - own.a) * textureSampleLevel(sky, around, map_place(d) + vec2f(0.5, 0.0), 0.0).rgb;
  }
  return vec4f(sum, 1.0);
}
