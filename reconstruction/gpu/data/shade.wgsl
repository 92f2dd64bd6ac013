// The picture of a model from the sums of its splats: what panes mirror, the sky, the lens and the display's curve, as
// `joint_model` has them. One thread a pixel of a window; written are bytes of red, green and blue, and depths, -1
// where nothing is.
//: include shading
//: include mirrored

@group(0) @binding(16) var sky: texture_2d<f32>;    // linear light of all directions
@group(0) @binding(18) var<storage, read> states: array<vec4f>;
@group(0) @binding(25) var<storage, read> firsts: array<u32>; // of each pixel's answers, where a network is asked
@group(0) @binding(34) var<storage, read_write> shown: array<u32>;
@group(0) @binding(35) var<storage, read_write> depths: array<f32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
        @builtin(local_invocation_index) lane: u32) {
    let thread = (group.x + group.y * groups.x) * 64u + lane;
    if (thread >= view.count) { return; }
    let i = view.start + thread;
    let at = place_of(i);
    let pixel = off_axis(at);
    let own = channels[2u * i];
    let state = states[i];
    var sum = own.rgb;
    let number = pane_at(i);
    if (number > 0u) {
        var first = 0u;
        if (light.kind == OF_NETWORK) { first = firsts[i]; }
        let mirrored = mirrored_by(number - 1u, pixel, first);
        sum += reflectance(channels[2u * i + 1u].rgb, own.a, mirrored.cosine) * mirrored.light;
    }
    let tangent = pixel / view.focal;
    if (1.0 - state.x > SKY_SEEN) {
        let d = normalize(view.forward + tangent.x * view.right + tangent.y * view.down);
        // The sky's columns begin in the south (`reconstruction.splats.sky`).
        sum += (1.0 - state.x) * textureSampleLevel(sky, around, map_place(d) + vec2f(0.5, 0.0), 0.0).rgb;
    }
    let lost = min(view.corner_loss * dot(tangent, tangent) / view.corner_square, view.most_lost);
    let c = clamp((1.0 - lost) * view.gain * sum, vec3f(0.0), vec3f(1.0));
    let display = select(12.92 * c, 1.055 * pow(c, vec3f(1.0 / 2.4)) - 0.055, c > vec3f(0.0031308));
    let place = at.y * view.width + at.x;
    shown[place] = pack4x8unorm(vec4f(display, 1.0));
    depths[place] = select(-1.0, state.y / max(state.x, 0.5), state.x > 0.5);
}
