// From blended channels to what a display shows: own light, mirrored light by Schlick's Fresnel term, the sky behind,
// then vignetting, exposure and sRGB's curve (Eqs. 18 to 21). Written are the colours that are compared with the photo,
// which are the photo's own where nothing is compared, with alpha; and normals with depths, -1 where no surface is.
// Errors are added up on the way. Threads take every so many pixels of the window.
//: include view
//: include picture
//: include fixed_sums

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> picture: Picture;
@group(0) @binding(2) var sky: texture_2d<f32>;
@group(0) @binding(3) var<storage, read> blended: array<vec4f>;
@group(0) @binding(4) var<storage, read> states: array<vec4f>;
@group(0) @binding(5) var<storage, read> truth: array<u32>;
@group(0) @binding(6) var<storage, read> mirrored: array<vec4f>;
@group(0) @binding(7) var found: texture_storage_2d<rgba32float, write>;
@group(0) @binding(8) var bodies: texture_storage_2d<rgba32float, write>;
@group(0) @binding(9) var<storage, read_write> sums: array<atomic<u32>>;
//: if LOOKED_AT
@group(0) @binding(10) var<storage, read_write> looked_at: array<vec4f>;
//: end

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
        @builtin(local_invocation_index) lane: u32) {
    let first = (group.x + group.y * groups.x) * 64u + lane;
    var error = 0.0;
    var large = 0.0;
    var n_large = 0u;
    for (var place = first; place < pixels_of_window(); place += groups.x * groups.y * 64u) {
        let pixel = pixel_of(place);
        let number = pixel.y * view.size.x + pixel.x;
        let body = body_of(place);
        let state = states[place];
        let slope = slope_at(pixel);
        var light = body.own;
//: if GLASS
        let mirror = mirrored[number];
        if (mirror.w >= 0.0 && body.reflectivity > LEAST_REFLECTIVITY) {
            let grazing = 1.0 - min(mirror.w, 1.0);
            let fifth = grazing * grazing * grazing * grazing * grazing;
            light += (body.base + (body.reflectivity - body.base) * fifth) * mirror.xyz;
        }
//: end
        let open = 1.0 - state.x;
        if (open > SEEN) { light += open * sky_light(sky_around(in_world(normalize(vec3f(slope, 1.0))))); }
        let display = display_of(vignetting(slope) * picture.gain.xyz * light);
        let word = truth[number];
        let wanted = colour_of(word);
        let compared = select(wanted, display, is_compared(display, wanted, word));
        textureStore(found, texel(number), vec4f(compared, state.x));
        textureStore(bodies, texel(number),
            vec4f(body.normal, select(-1.0, state.y / state.x, state.x > CLOSED)));
//: if LOOKED_AT
        looked_at[number] = vec4f(display, select(BEYOND, state.y / state.x, state.x > 0.5));
//: end
        let off = dot(abs(compared - wanted), vec3f(1.0));
        error += off;
        if (picture.size.w != 0u && (word & FACADE) != 0u && off > picture.lens.w) {
            large += off;
            n_large += 1u;
        }
    }
    add_fixed(ERRORS, error);
    add_fixed(LARGE, large);
    if (n_large > 0u) { atomicAdd(&sums[N_LARGE], n_large); }
}
