// The way back through light_pixels.wgsl: from the gradients of colours, normals and depths to those of the blended
// channels, as blend_back.wgsl reads them; and to those of exposure, vignetting, the sky and mirrored light, which
// takes the place of the light itself. All are those of the loss times the number of pixels.
//: include view
//: include picture
//: include fixed_sums

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> picture: Picture;
@group(0) @binding(2) var sky: texture_2d<f32>;
@group(0) @binding(3) var wanted: texture_storage_2d<rgba32float, write>;
@group(0) @binding(4) var<storage, read> blended: array<vec4f>;
@group(0) @binding(5) var<storage, read> truth: array<u32>;
@group(0) @binding(6) var<storage, read_write> mirrored: array<vec4f>;
@group(0) @binding(7) var found: texture_2d<f32>;
@group(0) @binding(8) var<storage, read> of_found: array<vec4f>;
@group(0) @binding(9) var<storage, read> of_bodies: array<vec4f>;
@group(0) @binding(10) var<storage, read_write> sums: array<atomic<u32>>;

fn add_to_sky(at: u32, amount: vec3f) {
    add_fixed(SKY + 3u * at, amount.x);
    add_fixed(SKY + 3u * at + 1u, amount.y);
    add_fixed(SKY + 3u * at + 2u, amount.z);
}

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
        @builtin(local_invocation_index) lane: u32) {
    let first = (group.x + group.y * groups.x) * 64u + lane;
    var of_gain = vec3f(0.0);
    var of_corner = 0.0;
    let of_large = picture.weights.y / (f32(atomicLoad(&sums[N_LARGE])) + 1e-6);
    for (var place = first; place < pixels_of_window(); place += groups.x * groups.y * 64u) {
        let pixel = pixel_of(place);
        let number = pixel.y * view.size.x + pixel.x;
        let body = body_of(place);
        let slope = slope_at(pixel);
        let here = textureLoad(found, texel(number), 0);
        var light = body.own;
//: if GLASS
        let mirror = mirrored[number];
        let is_mirror = mirror.w >= 0.0 && body.reflectivity > LEAST_REFLECTIVITY;
        let grazing = 1.0 - min(mirror.w, 1.0);
        let fourth = grazing * grazing * grazing * grazing;
        let fresnel = body.base + (body.reflectivity - body.base) * (fourth * grazing);
        if (is_mirror) { light += fresnel * mirror.xyz; }
//: end
        let open = 1.0 - here.w;
        var around = Around(vec4u(0u), 0.0, 0.0);
        var behind = vec3f(0.0);
        if (open > SEEN) {
            around = sky_around(in_world(normalize(vec3f(slope, 1.0))));
            behind = sky_light(around);
            light += open * behind;
        }
        let left = vignetting(slope);
        let exposed = left * picture.gain.xyz * light;
        let word = truth[number];
        let photo = colour_of(word);
        let off = here.xyz - photo;
        let is_large = (word & FACADE) != 0u && picture.size.w != 0u && dot(abs(off), vec3f(1.0)) > picture.lens.w;
        let of_error = picture.weights.x + select(0.0, of_large, is_large);
        let compared = is_compared(display_of(exposed), photo, word);
        let of_exposed = select(vec3f(0.0), (of_found[number].xyz + of_error * sign(off)) * display_slope(exposed),
            compared);
        let of_light = left * picture.gain.xyz * of_exposed;
        of_gain += left * light * of_exposed;
        let off_axis = dot(slope, slope) / picture.lens.x;
        if (picture.gain.w * off_axis <= picture.lens.y) {
            of_corner -= off_axis * dot(picture.gain.xyz * light, of_exposed);
        }
        let of_body = of_bodies[number];
        var of_alpha = of_body.w;
        if (open > SEEN) {
            of_alpha -= dot(of_light, behind);
            let share = open * of_light;
            add_to_sky(around.texels.x, (1.0 - around.right) * (1.0 - around.lower) * share);
            add_to_sky(around.texels.y, around.right * (1.0 - around.lower) * share);
            add_to_sky(around.texels.z, (1.0 - around.right) * around.lower * share);
            add_to_sky(around.texels.w, around.right * around.lower * share);
        }
        let row = (N_QUADS + 1u) * place;
//: if GLASS
        var of_reflectivity = 0.0;
        var of_base = vec3f(0.0);
        var of_mirrored = vec4f(0.0);
        if (is_mirror) {
            let by_fresnel = of_light * mirror.xyz;
            of_base = (1.0 - fourth * grazing) * by_fresnel;
            of_reflectivity = fourth * grazing * dot(by_fresnel, vec3f(1.0));
            of_mirrored = vec4f(fresnel * of_light,
                select(0.0, -5.0 * fourth * dot(by_fresnel, body.reflectivity - body.base), mirror.w <= 1.0));
        }
        mirrored[number] = of_mirrored;
        textureStore(wanted, texel(row), vec4f(of_light, of_reflectivity));
        textureStore(wanted, texel(row + 1u), vec4f(of_base, of_body.x));
        textureStore(wanted, texel(row + 2u), vec4f(of_body.yz, 0.0, 0.0));
//: else
        textureStore(wanted, texel(row), vec4f(of_light, of_body.x));
        textureStore(wanted, texel(row + 1u), vec4f(of_body.yz, 0.0, 0.0));
//: end
        textureStore(wanted, texel(row + N_QUADS), vec4f(of_alpha, of_found[number].w, 0.0, 0.0));
    }
    add_fixed(OF_GAIN, of_gain.x);
    add_fixed(OF_GAIN + 1u, of_gain.y);
    add_fixed(OF_GAIN + 2u, of_gain.z);
    add_fixed(OF_CORNER, of_corner);
}
