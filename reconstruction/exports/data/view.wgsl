// What all programs of the page share: the camera, and the curve between light and display values.
//
// Places are metres, ENU less the model's origin; pixels are counted from the middle of the whole picture.
struct View {
  eye: vec3f,
  focal: f32,       // pixels
  right: vec3f,
  blur: f32,        // variance of the splats' low-pass, square pixels
  down: vec3f,
  antialiased: f32, // 1 where what the low-pass makes larger is as much more transparent
  forward: vec3f,
  before: f32,      // above 0: of what lies on no pane and before this depth, how much it hides
  size: vec2f,      // of the target, pixels
  shift: vec2f,     // of its middle from the middle of the whole picture, pixels
  sight: vec2f,     // size of the whole picture, pixels
  rays: f32,        // mirrored through each pixel, along each side of it
  mirrors: f32,     // 1 where panes mirror, 0 while the light that they mirror is not there yet
  colour_low: f32,  // range that 8 bits of colour stand for, display values
  colour_step: f32,
  degree: f32,      // of harmonics
  mark_width: f32,  // pixels
}
@group(0) @binding(0) var<uniform> view: View;

fn seen(place: vec3f) -> vec3f {
  let towards = place - view.eye;
  return vec3f(dot(towards, view.right), dot(towards, view.down), dot(towards, view.forward));
}

fn on_screen(p: vec3f) -> vec4f {
  let near = 0.05;
  let at = view.focal * p.xy - view.shift * p.z;
  return vec4f(2.0 * at.x / view.size.x, -2.0 * at.y / view.size.y, p.z - near, p.z);
}

// Linear light of display values (IEC 61966-2-1): 0 below 0, and above 1 along the curve's last slope, as
// `reconstruction.splats.harmonic_colour.light_of_display` has it.
fn light_of(display: vec3f) -> vec3f {
  let c = clamp(display, vec3f(0.0), vec3f(1.0));
  let curved = select(c / 12.92, pow((c + 0.055) / 1.055, vec3f(2.4)), c > vec3f(0.04045));
  return curved + max(display - 1.0, vec3f(0.0)) * (2.4 / 1.055);
}

fn display_of(light: vec3f) -> vec3f {
  let c = clamp(light, vec3f(0.0), vec3f(1.0));
  return select(12.92 * c, 1.055 * pow(c, vec3f(1.0 / 2.4)) - 0.055, c > vec3f(0.0031308));
}

// Three corners of a triangle that covers the target.
fn corner_of_all(number: u32) -> vec4f {
  return vec4f(vec2f(f32(number & 1u), f32(number >> 1u)) * 4.0 - 1.0, 0.0, 1.0);
}
