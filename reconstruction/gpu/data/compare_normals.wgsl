// How far blended normals are from those of the surface that depths show (Eq. 26), and from the mesh's (Eq. 23), added
// up with how many count. Threads take every so many pixels.
//: include view
//: include picture_flags
//: include surface
//: include fixed_sums

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var found: texture_2d<f32>;
@group(0) @binding(2) var bodies: texture_2d<f32>;
@group(0) @binding(3) var<storage, read> truth: array<u32>;
@group(0) @binding(4) var<storage, read> reference: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> sums: array<atomic<u32>>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
        @builtin(local_invocation_index) lane: u32) {
    let first = (group.x + group.y * groups.x) * 64u + lane;
    var off = 0.0;
    var from_mesh = 0.0;
    var n_known = 0u;
    var n_mesh = 0u;
    for (var number = first; number < view.size.x * view.size.y; number += groups.x * groups.y * 64u) {
        let column = i32(number % view.size.x);
        let row = i32(number / view.size.x);
        let s = surface_at(column, row);
        if (s.is_known) {
            off += textureLoad(found, texel(number), 0).w - dot(blended_normal(column, row), s.normal);
            n_known += 1u;
        }
//: if MESH
        if (has_reference(number)) {
            from_mesh += dot(abs(textureLoad(bodies, texel(number), 0).xyz - reference[number].xyz), vec3f(1.0));
            n_mesh += 1u;
        }
//: end
    }
    add_fixed(OFF_NORMALS, off);
    add_fixed(OFF_MESH, from_mesh);
    if (n_known > 0u) { atomicAdd(&sums[N_KNOWN], n_known); }
    if (n_mesh > 0u) { atomicAdd(&sums[N_MESH], n_mesh); }
}
