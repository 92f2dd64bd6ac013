// Radix sort, the last of its three parts: each thread brings its keys, and the numbers that belong to them, to where
// the running sum of the counts says.
//: include pass_of_keys
@group(0) @binding(2) var<storage, read> numbers: array<u32>;
@group(0) @binding(3) var<storage, read> places: array<u32>;
@group(0) @binding(4) var<storage, read_write> moved_keys: array<u32>;
@group(0) @binding(5) var<storage, read_write> moved_numbers: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
        @builtin(local_invocation_index) lane: u32) {
    let thread = (group.x + group.y * groups.x) * 64u + lane;
    if (thread >= pass_.n_threads) { return; }
    var next: array<u32, DIGITS>;
    for (var digit = 0u; digit < DIGITS; digit++) {
        next[digit] = places[digit * pass_.n_threads + thread];
    }
    let end = min((thread + 1u) * KEYS_A_THREAD, pass_.n);
    for (var k = thread * KEYS_A_THREAD; k < end; k++) {
        let key = keys[k];
        let digit = (key >> pass_.shift) & (DIGITS - 1u);
        let place = next[digit];
        next[digit] = place + 1u;
        moved_keys[place] = key;
        moved_numbers[place] = numbers[k];
    }
}
