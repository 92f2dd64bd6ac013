// Radix sort, the first of its three parts: each thread counts the digits of KEYS_A_THREAD keys that follow each other.
// Counts are laid out digit by digit, so that their running sum says where each thread's keys of a digit go; keys of a
// thread keep their order, so that equal ones do. No part needs a barrier or shared memory.
//: include pass_of_keys
@group(0) @binding(2) var<storage, read_write> counts: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
        @builtin(local_invocation_index) lane: u32) {
    let thread = (group.x + group.y * groups.x) * 64u + lane;
    if (thread >= pass_.n_threads) { return; }
    var found: array<u32, DIGITS>;
    let end = min((thread + 1u) * KEYS_A_THREAD, pass_.n);
    for (var k = thread * KEYS_A_THREAD; k < end; k++) {
        found[(keys[k] >> pass_.shift) & (DIGITS - 1u)] += 1u;
    }
    for (var digit = 0u; digit < DIGITS; digit++) {
        counts[digit * pass_.n_threads + thread] = found[digit];
    }
}
