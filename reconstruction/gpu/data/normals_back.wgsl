// Gradients of compare_normals.wgsl times the number of pixels: of blended normals and alpha, which are written, and of
// depths, which join those of the colours. A pixel's depth moves the planes of its four neighbours, so each pixel asks
// these: no thread adds to what another writes.
//: include view
//: include picture_flags
//: include surface

struct Weights { by_depth: f32, by_mesh: f32 }

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> weights: Weights;
@group(0) @binding(2) var found: texture_2d<f32>;
@group(0) @binding(3) var bodies: texture_2d<f32>;
@group(0) @binding(4) var<storage, read> truth: array<u32>;
@group(0) @binding(5) var<storage, read> reference: array<vec4f>;
@group(0) @binding(6) var<storage, read> sums: array<u32>;
@group(0) @binding(7) var<storage, read_write> of_found: array<vec4f>;
@group(0) @binding(8) var<storage, read_write> of_bodies: array<vec4f>;

// What the plane at a pixel asks of the place on its right and of that below; the others get the opposite.
struct Pulls { right: vec3f, below: vec3f }

fn pulls_at(column: i32, row: i32) -> Pulls {
    let s = surface_at(column, row);
    if (!s.is_known || all(s.normal == vec3f(0.0))) { return Pulls(vec3f(0.0), vec3f(0.0)); }
    let of_normal = -blended_normal(column, row);
    let of_cross = s.sign * (of_normal - s.normal * dot(s.normal, of_normal)) / s.length;
    return Pulls(cross(of_cross, s.down), cross(s.across, of_cross));
}

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
        @builtin(local_invocation_index) lane: u32) {
    let number = (group.x + group.y * groups.x) * 64u + lane;
    if (number >= view.size.x * view.size.y) { return; }
    let column = i32(number % view.size.x);
    let row = i32(number / view.size.x);
    var of_normal = vec3f(0.0);
    var of_alpha = 0.0;
    var of_depth = 0.0;
//: if DEPTH
    {
        let each = weights.by_depth / max(f32(sums[N_KNOWN]), 1.0);
        let s = surface_at(column, row);
        if (s.is_known) {
            let n = s.normal;
            of_normal = -each * (view.rows[0].xyz * n.x + view.rows[1].xyz * n.y + view.rows[2].xyz * n.z);
            of_alpha = each;
        }
        let depth = depth_at(column, row);
        if (depth > 0.0) {
            let of_place = pulls_at(column - 1, row).right - pulls_at(column + 1, row).right
                + pulls_at(column, row - 1).below - pulls_at(column, row + 1).below;
            let over = each * dot(of_place, ray_at(column, row)) / textureLoad(found, texel(number), 0).w;
            of_depth = over;
            of_alpha -= over * depth;
        }
    }
//: end
//: if MESH
    if (has_reference(number)) {
        let off = textureLoad(bodies, texel(number), 0).xyz - reference[number].xyz;
        of_normal += weights.by_mesh / f32(sums[N_MESH]) * sign(off);
    }
//: end
    of_bodies[number] = vec4f(of_normal, of_alpha);
    of_found[number].w = of_depth;
}
