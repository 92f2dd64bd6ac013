// From what is learned of splats to what is drawn of those that are seen: one thread each. Written are the table of
// parameters that project.wgsl reads, and that of features: light by harmonics, of glass (1 - R) c with R and R F0, and
// the normal.
//: include texels
//: include learned

@group(0) @binding(0) var<uniform> learning: Learning;
@group(0) @binding(1) var<storage, read> learned: array<vec4f>;
@group(0) @binding(2) var<storage, read> places: array<u32>;
@group(0) @binding(3) var parameters: texture_storage_2d<rgba32float, write>;
@group(0) @binding(4) var features: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
        @builtin(local_invocation_index) lane: u32) {
    let at = (group.x + group.y * groups.x) * 64u + lane;
    let n = learning.part.y;
    if (at >= n) { return; }
    let i = places[learning.part.x + at];
    if (i == places[learning.part.x + at + 1u]) { return; }
    let place = learned[at];
    let quat = learned[n + at];
    let sizes = learned[2u * n + at];
    let p = learned_parameters(place, quat, sizes);
    textureStore(parameters, texel(4u * i), vec4f(p.mean, p.opacity));
    textureStore(parameters, texel(4u * i + 1u), p.quat);
    textureStore(parameters, texel(4u * i + 2u), vec4f(p.scales, 0.0));
    textureStore(parameters, texel(4u * i + 3u), vec4f(p.offset, 0.0, 0.0));
    let to_splat = direction_to(place.xyz);
    let y = harmonics(to_splat.way, learning.part.z);
    var value = vec3f(0.5);
//: for j in FOUR
    let a$j = learned[(FIRST_HARMONICS + 3u * $ju) * n + at];
    let b$j = learned[(FIRST_HARMONICS + 3u * $ju + 1u) * n + at];
    let c$j = learned[(FIRST_HARMONICS + 3u * $ju + 2u) * n + at];
//: end
    value += y.a.x * a0.xyz + y.a.y * vec3f(a0.w, b0.xy) + y.a.z * vec3f(b0.zw, c0.x) + y.a.w * c0.yzw;
    value += y.b.x * a1.xyz + y.b.y * vec3f(a1.w, b1.xy) + y.b.z * vec3f(b1.zw, c1.x) + y.b.w * c1.yzw;
    value += y.c.x * a2.xyz + y.c.y * vec3f(a2.w, b2.xy) + y.c.z * vec3f(b2.zw, c2.x) + y.c.w * c2.yzw;
    value += y.d.x * a3.xyz + y.d.y * vec3f(a3.w, b3.xy) + y.d.z * vec3f(b3.zw, c3.x) + y.d.w * c3.yzw;
    var light = light_of(value);
    let normal = normal_of(product(quat, turn_to_third(sizes.xyz)), place.xyz - learning.eye.xyz).n;
//: if GLASS
    let base = learned[GLASS_QUAD * n + at];
    let reflectivity = sigmoid(sizes.w) * base.w;
    textureStore(features, texel(N_QUADS * i), vec4f((1.0 - reflectivity) * light, reflectivity));
    textureStore(features, texel(N_QUADS * i + 1u), vec4f(reflectivity * sigmoids(base.xyz), normal.x));
    textureStore(features, texel(N_QUADS * i + 2u), vec4f(normal.yz, 0.0, 0.0));
//: else
    textureStore(features, texel(N_QUADS * i), vec4f(light, normal.x));
    textureStore(features, texel(N_QUADS * i + 1u), vec4f(normal.yz, 0.0, 0.0));
//: end
}
