// What is drawn of a splat, in the model's frame and metres.
struct Parameters {
    mean: vec3f,
    opacity: f32,
    quat: vec4f,                // w, x, y, z, of any length
    scales: vec3f,
    offset: vec2f,
}
