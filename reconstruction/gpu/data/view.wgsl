// What all kernels know of the picture: one uniform block, written anew for each picture and window of bins. Splats lie
// in textures, texel by texel, as wide as TEXELS_A_ROW: bindings of buffers end at 128 MiB on older cards, and textures
// are read faster.
//: include texels
struct View {
    rows: array<vec4f, 3>,      // of the rotation from the model's frame to camera axes
    place: vec4f,               // of the camera in the model's frame, as float32 has it, metres
    rest: vec4f,                // and what float32 leaves of it
    lens: vec4f,                // fx, fy, cx, cy, pixels
    slopes: vec4f,              // limits of x / z and y / z in an ellipsoid's Jacobian: least and most of each
    limits: vec4f,              // nearest depth, least and most alpha, what a pixel has left when it ends
    filters: vec4f,             // 1 / sigma^2 and sigma of the low-pass filter, sigma of a blur, least change of depth
    reaches: vec4f,             // of an opaque splat, steepest plane, least opacity that is left, least area
    size: vec4u,                // width and height, pixels; splats; splats in front of the camera
    bins: vec4u,                // of the window that is drawn: first column and row, columns and rows
    part: vec4u,                // of the splats whose gradients are added up: first, number
}
