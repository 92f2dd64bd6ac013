// What kernels of pixels know of a picture's exposure and losses. Sums are counted in slots of 64 bits, see
// fixed_sums.wgsl, and in words: IS_BAD, and how many pixels count for a loss that is a mean over some.
struct Picture {
    gain: vec4f,                // of red, green and blue; what vignetting takes in the corners
    lens: vec4f,                // squared tangent to the corners, most that vignetting takes, white, large error
    weights: vec4f,             // of the mean error, of large errors, and of normals by depth and by the mesh
    size: vec4u,                // width, height, rows of the sky, whether there are large errors
}

//: include picture_flags

fn colour_of(word: u32) -> vec3f {
    return vec3f(f32(word & 255u), f32((word >> 8u) & 255u), f32((word >> 16u) & 255u)) / 255.0;
}

//: include window_pixels

// Values of a display, above 1 along the curve's last slope.
fn display_of(light: vec3f) -> vec3f {
    let above = max(light, vec3f(0.0));
    let curved = 1.055 * pow(clamp(above, vec3f(DARKEST), vec3f(1.0)), vec3f(1.0 / 2.4)) - 0.055;
    let beyond = max(above - 1.0, vec3f(0.0)) * (1.055 / 2.4);
    return select(curved + beyond, 12.92 * above, above <= vec3f(DARKEST));
}

fn display_slope(light: vec3f) -> vec3f {
    let curved = (1.055 / 2.4) * pow(clamp(light, vec3f(DARKEST), vec3f(1.0)), vec3f(1.0 / 2.4 - 1.0));
    return select(curved, select(vec3f(0.0), vec3f(12.92), light >= vec3f(0.0)), light <= vec3f(DARKEST));
}

fn vignetting(slope: vec2f) -> f32 {
    return 1.0 - min(picture.gain.w * dot(slope, slope) / picture.lens.x, picture.lens.y);
}

// The four texels of the sky around a direction: see splats/sky.py.
struct Around { texels: vec4u, right: f32, lower: f32 }

fn sky_around(d: vec3f) -> Around {
    let square = d.x * d.x + d.y * d.y;
    var turns = 0.0;
    var level = sqrt(LEAST_LEVEL);
    if (square >= LEAST_LEVEL) {
        turns = atan2(d.x, d.y) / (2.0 * PI);
        level = sqrt(square);
    }
    let height = picture.size.z;
    let width = 2u * height;
    let x = turns * f32(width) + 0.5 * f32(width) - 0.5;
    let y = clamp((0.5 - atan2(d.z, level) / PI) * f32(height) - 0.5, 0.0, f32(height) - 1.0);
    let left = floor(x);
    let top = min(floor(y), f32(height) - 2.0);
    let column = u32(i32(left) + i32(width)) % width;
    let beside = (column + 1u) % width;
    let above = u32(top) * width;
    let below = above + width;
    return Around(vec4u(above + column, above + beside, below + column, below + beside), x - left, y - top);
}

fn sky_light(a: Around) -> vec3f {
    let upper = mix(textureLoad(sky, texel(a.texels.x), 0).xyz, textureLoad(sky, texel(a.texels.y), 0).xyz, a.right);
    let lower = mix(textureLoad(sky, texel(a.texels.z), 0).xyz, textureLoad(sky, texel(a.texels.w), 0).xyz, a.right);
    return mix(upper, lower, a.lower);
}

// Channels as they were blended.
struct Body { own: vec3f, reflectivity: f32, base: vec3f, normal: vec3f }

fn body_of(place: u32) -> Body {
    let a = blended[N_QUADS * place];
    let b = blended[N_QUADS * place + 1u];
//: if GLASS
    let c = blended[N_QUADS * place + 2u];
    return Body(a.xyz, a.w, b.xyz, vec3f(b.w, c.xy));
//: else
    return Body(a.xyz, 0.0, vec3f(0.0), vec3f(a.w, b.xy));
//: end
}

// Where a photo is overexposed, what is brighter than it shows is no error; and what it does not show is none.
fn is_compared(found: vec3f, truth: vec3f, word: u32) -> vec3<bool> {
    let is_shown = vec3<bool>((word & SHOWN) != 0u);
    return is_shown & !((truth >= vec3f(picture.lens.z)) & (found > truth));
}
