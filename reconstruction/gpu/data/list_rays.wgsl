// Mirrored rays of a window's pixels, one after the other in a list, for a network to be asked: one thread a pixel.
//: include shading
//: include mirrored

@group(0) @binding(31) var<storage, read_write> rays: array<vec4f>;
@group(0) @binding(32) var<storage, read_write> n_rays: array<atomic<u32>>;
@group(0) @binding(33) var<storage, read_write> firsts: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
        @builtin(local_invocation_index) lane: u32) {
    let thread = (group.x + group.y * groups.x) * 64u + lane;
    if (thread >= view.count) { return; }
    let i = view.start + thread;
    let number = pane_at(i);
    if (number == 0u) { return; }
    let n = u32(view.rays * view.rays);
    let first = atomicAdd(&n_rays[0], n);
    firsts[i] = first;
    for (var k = 0u; k < n; k++) {
        let ray = mirror(number - 1u, off_axis(place_of(i)), i32(k));
        rays[2u * (first + k)] = vec4f(ray.place, 0.0);
        rays[2u * (first + k) + 1u] = vec4f(ray.direction, 0.0);
    }
}
