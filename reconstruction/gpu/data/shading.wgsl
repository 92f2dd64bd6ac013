// What kernels that shade pictures know of the camera, of a window of the picture, and of its pixels.
struct Shading {
    eye: vec3f,             // in the model's frame, metres
    rays: f32,              // mirrored through each pixel, along each side of it
    right: vec3f,
    corner_square: f32,     // squared tangent off the optical axis where vignetting is full
    down: vec3f,
    corner_loss: f32,       // share of the light that it takes there
    forward: vec3f,
    most_lost: f32,         // and takes at most
    focal: vec2f,           // pixels
    middle: vec2f,          // where the optical axis is, pixels
    gain: vec3f,            // exposure
    width: u32,             // of the picture
    corner: vec2u,          // first column and row of the window
    window: vec2u,          // its columns and rows
    start: u32,             // first of its pixels that are shaded now, and how many
    count: u32,
}
@group(0) @binding(0) var<uniform> view: Shading;
@group(0) @binding(1) var<storage, read> channels: array<vec4f>;   // of each pixel of the window: (1 - R) c, R; R F0
@group(0) @binding(2) var<storage, read> pane_numbers: array<u32>; // of each pixel of the picture, + 1; 0 for none

// Number of the pane that mirrors at a pixel of the window, + 1; 0 where none does.
fn pane_at(i: u32) -> u32 {
    let at = place_of(i);
    return select(0u, pane_numbers[at.y * view.width + at.x], channels[2u * i].a > LEAST_REFLECTIVITY);
}

fn place_of(i: u32) -> vec2u {
    return view.corner + vec2u(i % view.window.x, i / view.window.x);
}

fn off_axis(at: vec2u) -> vec2f {
    return vec2f(at) + 0.5 - view.middle;
}
