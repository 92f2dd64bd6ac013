// What splats look like from a place: (1 - R) c, R and R F0 of each, as `joint_model` blends them; one thread each.
// The harmonics are those of `reconstruction.light.harmonics`, c is linear light (`harmonic_colour`).
@group(0) @binding(0) var<uniform> eye: vec4f;              // in the model's frame, metres; number of splats
@group(0) @binding(1) var parameters: texture_2d<f32>;      // as project.wgsl reads them
@group(0) @binding(2) var looks: texture_2d<f32>;           // F0 and R, then 48 coefficients of colour, of each
@group(0) @binding(3) var features: texture_storage_2d<rgba32float, write>;

fn texel(number: u32) -> vec2u {
    return vec2u(number % TEXELS_A_ROW, number / TEXELS_A_ROW);
}

fn light_of(display: vec3f) -> vec3f {
    let c = clamp(display, vec3f(0.0), vec3f(1.0));
    let curved = select(c / 12.92, pow((c + 0.055) / 1.055, vec3f(2.4)), c > vec3f(0.04045));
    return curved + max(display - 1.0, vec3f(0.0)) * (2.4 / 1.055);
}

// Three coefficients of each harmonic lie behind each other, four numbers in a texel.
fn coefficients(i: u32, four: u32) -> array<vec3f, 4> {
    let a = textureLoad(looks, texel(13u * i + 1u + 3u * four), 0);
    let b = textureLoad(looks, texel(13u * i + 2u + 3u * four), 0);
    let c = textureLoad(looks, texel(13u * i + 3u + 3u * four), 0);
    return array<vec3f, 4>(a.xyz, vec3f(a.w, b.xy), vec3f(b.zw, c.x), c.yzw);
}

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
        @builtin(local_invocation_index) lane: u32) {
    let i = (group.x + group.y * groups.x) * 64u + lane;
    if (i >= u32(eye.w)) { return; }
    let towards = textureLoad(parameters, texel(4u * i), 0).xyz - eye.xyz;
    let d = towards / max(length(towards), 1e-6);
    let x = d.x;
    let y = d.y;
    let z = d.z;
    let xx = x * x;
    let yy = y * y;
    let zz = z * z;
    let s0 = coefficients(i, 0u);
    let s1 = coefficients(i, 1u);
    let s2 = coefficients(i, 2u);
    let s3 = coefficients(i, 3u);
    let colour = 0.5 + 0.28209479 * s0[0] + 0.48860251 * (y * s0[1] + z * s0[2] + x * s0[3])
        + 1.0925484 * (x * y * s1[0] + y * z * s1[1] + x * z * s1[3]) + 0.31539157 * (3.0 * zz - 1.0) * s1[2]
        + 0.54627422 * (xx - yy) * s2[0]
        + 0.59004359 * (y * (3.0 * xx - yy) * s2[1] + x * (xx - 3.0 * yy) * s3[3])
        + 2.8906114 * x * y * z * s2[2] + 0.45704580 * (5.0 * zz - 1.0) * (y * s2[3] + x * s3[1])
        + 0.37317633 * z * (5.0 * zz - 3.0) * s3[0] + 1.4453057 * z * (xx - yy) * s3[2];
    let own = textureLoad(looks, texel(13u * i), 0);
    textureStore(features, texel(2u * i), vec4f((1.0 - own.w) * light_of(colour), own.w));
    textureStore(features, texel(2u * i + 1u), vec4f(own.w * own.xyz, 0.0));
}
