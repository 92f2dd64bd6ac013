// From what was added up for a splat to a step of Adam (Kingma and Ba, 2015) on all that is learned of it: one thread
// each. What densification asks about it is added up on the way: how hard its place in the picture is pulled at, in how
// many pictures it was drawn, its weight there, and its largest size. Sizes are kept within limits, and where there is
// noise, splats that are nearly transparent move along their own axes. Splats that are not seen have gradients of 0.
//: include learned
//: if HALF
//: include moments
//: end

@group(0) @binding(0) var<uniform> learning: Learning;
@group(0) @binding(1) var<storage, read_write> learned: array<vec4f>;
//: if HALF
@group(0) @binding(2) var<storage, read_write> first_moments: array<vec2u>;
@group(0) @binding(3) var<storage, read_write> second_moments: array<vec2u>;
//: else
@group(0) @binding(2) var<storage, read_write> first_moments: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> second_moments: array<vec4f>;
//: end
@group(0) @binding(4) var<storage, read> places: array<u32>;
@group(0) @binding(5) var<storage, read> totals: array<vec4f>;
@group(0) @binding(6) var<storage, read> radii: array<f32>;
@group(0) @binding(7) var<storage, read> weights: array<f32>;
@group(0) @binding(8) var<storage, read_write> seen: array<vec4f>;

fn hashed(v: vec3u) -> vec3u {
    // M. Jarzynski and M. Olano, "Hash functions for GPU rendering", JCGT 9 (2020): pcg3d.
    var h = v * 1664525u + 1013904223u;
    h.x += h.y * h.z;
    h.y += h.z * h.x;
    h.z += h.x * h.y;
    h ^= h >> vec3u(16u);
    h.x += h.y * h.z;
    h.y += h.z * h.x;
    h.z += h.x * h.y;
    return h;
}

// What is learned after the step.
fn adam(place: u32, old: vec4f, slope: vec4f, step: vec4f) -> vec4f {
    let g = learning.other.z * slope;
//: if HALF
    let before = first_value(from_words(first_moments[place]));
    let before2 = second_value(from_words(second_moments[place]));
//: else
    let before = first_moments[place];
    let before2 = second_moments[place];
//: end
    let first = before + learning.adam.x * (g - before);
    let second = learning.adam.y * before2 + learning.adam.z * g * g;
//: if HALF
    let dither = hashed(vec3u(place, learning.part.w, 2u + learning.part.x)).xy;
    first_moments[place] = in_words(first_code(first));
    second_moments[place] = in_words(second_code(second, vec4u(dither, dither >> vec2u(16u))));
//: else
    first_moments[place] = first;
    second_moments[place] = second;
//: end
    let new_value = old - step * (first / (sqrt(second) * learning.adam.w + learning.other.x));
    learned[place] = new_value;
    return new_value;
}

// Three normal numbers (Box and Muller, 1958).
fn noise_of(i: u32) -> vec3f {
    let a = hashed(vec3u(i, learning.part.w, 0u));
    let b = hashed(vec3u(i, learning.part.w, 1u));
    let to_share = 1.0 / 4294967296.0;
    let far = sqrt(-2.0 * log((vec2f(f32(a.x), f32(a.y)) + 0.5) * to_share));
    let turn = 2.0 * PI * vec2f(f32(a.z), f32(b.x)) * to_share;
    return vec3f(far.x * cos(turn.x), far.x * sin(turn.x), far.y * cos(turn.y));
}

fn kept_within(sizes: vec3f) -> vec3f {
    var kept = clamp(sizes, vec3f(learning.limits.x), vec3f(learning.limits.y));
//: if SOLID
    let longest = max(max(kept.x, kept.y), kept.z);
    let raised = max(kept, vec3f(longest - learning.limits.z));
    // The shortest one stays: flat ones are what surfaces are made of.
    if (kept.x <= kept.y && kept.x <= kept.z) { return vec3f(kept.x, raised.yz); }
    if (kept.y <= kept.z) { return vec3f(raised.x, kept.y, raised.z); }
    return vec3f(raised.xy, kept.z);
//: else
    let least = max(kept.x, kept.y) - learning.limits.z;
    return vec3f(max(kept.xy, vec2f(least)), 0.0);
//: end
}

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
        @builtin(local_invocation_index) lane: u32) {
    let at = (group.x + group.y * groups.x) * 64u + lane;
    let n = learning.part.y;
    if (at >= n) { return; }
    let i = learning.part.x + at;
    let place = learned[at];
    let quat = learned[n + at];
    let sizes = learned[2u * n + at];
    let base = learned[GLASS_QUAD * n + at];
//: for j in FOUR
    let a$j = learned[(FIRST_HARMONICS + 3u * $ju) * n + at];
    let b$j = learned[(FIRST_HARMONICS + 3u * $ju + 1u) * n + at];
    let c$j = learned[(FIRST_HARMONICS + 3u * $ju + 2u) * n + at];
//: end
    let to_splat = direction_to(place.xyz);
    let y = harmonics(to_splat.way, learning.part.z);
    var value = vec3f(0.5);
    value += y.a.x * a0.xyz + y.a.y * vec3f(a0.w, b0.xy) + y.a.z * vec3f(b0.zw, c0.x) + y.a.w * c0.yzw;
    value += y.b.x * a1.xyz + y.b.y * vec3f(a1.w, b1.xy) + y.b.z * vec3f(b1.zw, c1.x) + y.b.w * c1.yzw;
    value += y.c.x * a2.xyz + y.c.y * vec3f(a2.w, b2.xy) + y.c.z * vec3f(b2.zw, c2.x) + y.c.w * c2.yzw;
    value += y.d.x * a3.xyz + y.d.y * vec3f(a3.w, b3.xy) + y.d.z * vec3f(b3.zw, c3.x) + y.d.w * c3.yzw;
    let row = places[i];
    let is_seen = places[i + 1u] != row;
    let sums = 8u * (row - learning.rows.x);
    var t0 = vec4f(0.0);
    var t1 = vec4f(0.0);
//: if GLASS
    var t2 = vec4f(0.0);
//: end
    var g0 = vec4f(0.0);
    var g1 = vec4f(0.0);
    var g2 = vec4f(0.0);
    var g3 = vec4f(0.0);
    var radius = 0.0;
    var weight = 0.0;
    if (is_seen) {
        t0 = totals[sums];
        t1 = totals[sums + 1u];
//: if GLASS
        t2 = totals[sums + 2u];
//: end
        g0 = totals[sums + GRADIENTS];
        g1 = totals[sums + GRADIENTS + 1u];
        g2 = totals[sums + GRADIENTS + 2u];
        g3 = totals[sums + GRADIENTS + 3u];
        radius = radii[row];
        weight = weights[row];
    }
    var of_light = t0.xyz;
    var of_reflectivity = 0.0;
    var of_base = vec3f(0.0);
//: if GLASS
    let of_normal = vec3f(t1.w, t2.xy);
    let share = sigmoid(sizes.w);
    let r = share * base.w;
    let f0 = sigmoids(base.xyz);
    of_reflectivity = base.w * share * (1.0 - share) * (t0.w - dot(light_of(value), t0.xyz) + dot(f0, t1.xyz));
    of_base = r * t1.xyz * f0 * (1.0 - f0);
    of_light *= 1.0 - r;
//: else
    let of_normal = vec3f(t0.w, t1.xy);
//: end
    let g = of_light * light_slope(value);
    // Harmonics depend on the direction, and the direction on the place.
    let pulls = Harmonics(
        vec4f(dot(a0.xyz, g), dot(vec3f(a0.w, b0.xy), g), dot(vec3f(b0.zw, c0.x), g), dot(c0.yzw, g)),
        vec4f(dot(a1.xyz, g), dot(vec3f(a1.w, b1.xy), g), dot(vec3f(b1.zw, c1.x), g), dot(c1.yzw, g)),
        vec4f(dot(a2.xyz, g), dot(vec3f(a2.w, b2.xy), g), dot(vec3f(b2.zw, c2.x), g), dot(c2.yzw, g)),
        vec4f(dot(a3.xyz, g), dot(vec3f(a3.w, b3.xy), g), dot(vec3f(b3.zw, c3.x), g), dot(c3.yzw, g)));
    var of_mean = g0.xyz;
    if (learning.part.z > 1u && to_splat.length > NEAREST_M) {
        let by = slope_of_harmonics(to_splat.way, used(pulls, learning.part.z));
        of_mean += (by - dot(by, to_splat.way) * to_splat.way) / to_splat.length;
    }
    // The normal is a column of the rotation, which is quadratic in the quaternion over its squared length.
    let turn = turn_to_third(sizes.xyz);
    let q = product(quat, turn);
    let normal = normal_of(q, place.xyz - learning.eye.xyz);
    let along = dot(of_normal, normal.n);
    let h = normal.sign * of_normal;
    let of_turned = 2.0 * normal.over * vec4f(
        h.x * q.z - h.y * q.y + h.z * q.x - along * q.x,
        h.x * q.w - h.y * q.x - h.z * q.y - along * q.y,
        h.x * q.x + h.y * q.w - h.z * q.z - along * q.z,
        h.x * q.y + h.y * q.z + h.z * q.w - along * q.w);
    let of_quat = g1 + product(of_turned, vec4f(turn.x, -turn.yzw));
    let opacity = sigmoid(place.w);
    let slope = opacity * (1.0 - opacity);
    let scales = exp(sizes.xyz);
    // Pulls of the strategy are of the loss itself, and all else of so many times as much.
    let of_opacity = slope * (g0.w + learning.pulls.x);
    var of_sizes = scales * (g2.xyz + learning.pulls.y);
    if (SOLID == 0u) { of_sizes.z = 0.0; }
    let of_glass = select(1.0, learning.other.y, base.w > 0.0);
    let shape = learning.shape_rates;
    let colour = learning.colour_rates;
    let moved = adam(at, place, vec4f(of_mean, of_opacity), vec4f(vec3f(shape.x * of_glass), shape.w));
    let turned = adam(n + at, quat, of_quat, vec4f(shape.y * of_glass));
    var sized = adam(2u * n + at, sizes, vec4f(of_sizes, of_reflectivity), vec4f(vec3f(shape.z), colour.z));
    adam(GLASS_QUAD * n + at, base, vec4f(of_base, 0.0), vec4f(vec3f(colour.w), 0.0));
    let all_details = vec4f(colour.y);
    adam(4u * n + at, a0, vec4f(y.a.x * g, y.a.y * g.x), vec4f(vec3f(colour.x), colour.y));
    adam(5u * n + at, b0, vec4f(y.a.y * g.yz, y.a.z * g.xy), all_details);
    adam(6u * n + at, c0, vec4f(y.a.z * g.z, y.a.w * g), all_details);
    adam(7u * n + at, a1, vec4f(y.b.x * g, y.b.y * g.x), all_details);
    adam(8u * n + at, b1, vec4f(y.b.y * g.yz, y.b.z * g.xy), all_details);
    adam(9u * n + at, c1, vec4f(y.b.z * g.z, y.b.w * g), all_details);
    adam(10u * n + at, a2, vec4f(y.c.x * g, y.c.y * g.x), all_details);
    adam(11u * n + at, b2, vec4f(y.c.y * g.yz, y.c.z * g.xy), all_details);
    adam(12u * n + at, c2, vec4f(y.c.z * g.z, y.c.w * g), all_details);
    adam(13u * n + at, a3, vec4f(y.d.x * g, y.d.y * g.x), all_details);
    adam(14u * n + at, b3, vec4f(y.d.y * g.yz, y.d.z * g.xy), all_details);
    adam(15u * n + at, c3, vec4f(y.d.z * g.z, y.d.w * g), all_details);
    sized = vec4f(kept_within(sized.xyz), sized.w);
    learned[2u * n + at] = sized;
    let gate = sigmoid(GATE_SLOPE * (GATE_AT - sigmoid(moved.w)));
    if (learning.limits.w > 0.0 && gate > LEAST_GATE) {
        let unit = turned / max(length(turned), LEAST_NORM);
        let s = learning.limits.w * gate * noise_of(i) * exp(sized.xyz);
        let w = unit.x;
        let v = unit.yzw;
        let step = select(vec3f(s.xy, 0.0), s, SOLID == 1u);
        learned[at] = vec4f(moved.xyz + step + 2.0 * cross(v, cross(v, step) + w * step), moved.w);
    }
    let old = seen[at];
    let more = vec4f(old.x + learning.other.w * length(g3.xy), old.y + select(0.0, 1.0, radius > 0.0),
        old.z + weight, max(old.w, radius / learning.pulls.z));
    seen[at] = select(old, more, learning.pulls.w > 0.0);
}
