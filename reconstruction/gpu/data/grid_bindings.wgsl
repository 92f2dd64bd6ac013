// What kernels read that march mirrored rays.
@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> mirrors: Mirrors;
@group(0) @binding(2) var panes: texture_2d<f32>;
@group(0) @binding(3) var times: texture_2d<f32>;       // and steps
@group(0) @binding(4) var cells: texture_2d<f32>;       // density, and square roots of light, x first
@group(0) @binding(5) var far: texture_2d<f32>;         // square roots of light
@group(0) @binding(6) var<storage, read> skips: array<u32>; // four cells in a word: how far away something is
@group(0) @binding(7) var<storage, read> pane_numbers: array<u32>; // of each pixel of the picture, + 1; 0 for none
@group(0) @binding(8) var<storage, read> blended: array<vec4f>;
