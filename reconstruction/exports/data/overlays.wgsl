// What is drawn over the model: panes without splats, marks of defects, outlines; and the picture as display values.
@group(0) @binding(22) var<storage, read> pane_tints: array<u32>; // by pane + 1
@group(0) @binding(23) var drawn: texture_2d<f32>;                // linear light

struct PaneCorner {
  @builtin(position) position: vec4f,
  @location(0) @interpolate(flat) number: u32,
  @location(1) @interpolate(flat) tint: vec4f,
}

// `number`: the pane's + 1, negative where splats show it.
@vertex
fn pane_corner(@location(0) place: vec3f, @location(1) number: f32) -> PaneCorner {
  let pane = u32(abs(number));
  let found = unpack4x8unorm(pane_tints[pane]);
  var tint = select(vec4f(0.5, 0.6, 0.7, 0.35), vec4f(found.rgb, 0.75), found.a > 0.0);
  if (number < 0.0) { tint = vec4f(0.0); }
  return PaneCorner(on_screen(seen(place)), pane, tint);
}

@fragment
fn pane_number(corner: PaneCorner) -> @location(0) u32 { return corner.number; }

@fragment
fn pane_pixel(corner: PaneCorner) -> @location(0) vec4f {
  return vec4f(light_of(corner.tint.rgb) * corner.tint.a, corner.tint.a);
}

struct LineCorner {
  @builtin(position) position: vec4f,
  @location(0) across: f32, // pixels
  @location(1) @interpolate(flat) width: f32,
  @location(2) @interpolate(flat) colour: vec4f,
}

// Thick lines: an instance for each edge.
@vertex
fn line_corner(@builtin(vertex_index) corner: u32, @location(0) first: vec3f, @location(1) second: vec3f,
    @location(2) colour: vec4f, @location(3) width: f32) -> LineCorner {
  var out: LineCorner;
  out.position = vec4f(0.0, 0.0, 2.0, 1.0);
  var a = seen(first);
  var b = seen(second);
  let near = 0.06;
  if (a.z < near && b.z < near) { return out; }
  if (a.z < near) { a = mix(b, a, (b.z - near) / (b.z - a.z)); }
  if (b.z < near) { b = mix(a, b, (a.z - near) / (a.z - b.z)); }
  let u = a.xy / a.z * view.focal;
  let v = b.xy / b.z * view.focal;
  let d = normalize(v - u + vec2f(1e-6, 0.0));
  let side = select(1.0, -1.0, (corner & 1u) == 0u);
  let half_ = 0.5 * width + 1.0;
  let end = select(v + d * 0.5 * width, u - d * 0.5 * width, (corner >> 1u) == 0u);
  let at = end + side * half_ * vec2f(-d.y, d.x);
  out.position = vec4f(2.0 * at.x / view.size.x, -2.0 * at.y / view.size.y, 0.0, 1.0);
  out.across = side * half_;
  out.width = width;
  out.colour = colour;
  return out;
}

@fragment
fn line_pixel(line: LineCorner) -> @location(0) vec4f {
  let alpha = line.colour.a * clamp(0.5 * line.width + 0.5 - abs(line.across), 0.0, 1.0);
  return vec4f(light_of(line.colour.rgb) * alpha, alpha);
}

struct MarkCorner {
  @builtin(position) position: vec4f,
  @location(0) off: vec2f, // pixels
  @location(1) @interpolate(flat) colour: vec4f,
}

// A square around each mark; colours of alpha 0 are hollow.
@vertex
fn mark_corner(@builtin(vertex_index) corner: u32, @location(0) place: vec3f, @location(1) normal: vec3f,
    @location(2) colour: vec4f) -> MarkCorner {
  var out: MarkCorner;
  out.position = vec4f(0.0, 0.0, 2.0, 1.0);
  out.colour = colour;
  out.off = (vec2f(f32(corner & 1u), f32(corner >> 1u)) - 0.5) * view.mark_width;
  let p = seen(place);
  if (dot(view.eye - place, normal) > 0.0 && p.z > 0.1) {
    let at = on_screen(p);
    let before = on_screen(p * 0.97 - vec3f(0.0, 0.0, 0.05)); // its own pane must not cut it
    let moved = at.xy / at.w + vec2f(2.0, -2.0) * out.off / view.size;
    out.position = vec4f(moved, clamp(before.z / max(before.w, 0.01), 0.0, 1.0), 1.0);
  }
  return out;
}

@fragment
fn mark_pixel(mark: MarkCorner) -> @location(0) vec4f {
  let r = length(mark.off);
  let half_ = 0.5 * view.mark_width;
  let alpha = clamp(half_ - r, 0.0, 1.0);
  let inside = clamp(half_ - 2.0 - r, 0.0, 1.0);
  var middle = mark.colour.rgb;
  if (mark.colour.a <= 0.5) { middle = mix(vec3f(1.0), middle, clamp(r - half_ + 5.0, 0.0, 1.0)); }
  let ring = mix(vec3f(1.0), vec3f(0.08), clamp(r - half_ + 1.5, 0.0, 1.0) * 0.6);
  return vec4f(light_of(mix(ring, middle, inside)) * alpha, alpha);
}

@vertex
fn show_corner(@builtin(vertex_index) number: u32) -> @builtin(position) vec4f { return corner_of_all(number); }

@fragment
fn show_pixel(@builtin(position) position: vec4f) -> @location(0) vec4f {
  return vec4f(display_of(textureLoad(drawn, vec2i(position.xy), 0).rgb), 1.0);
}
