// What a pass of the radix sort goes by, and the keys that it reads.
struct Pass {
    n: u32,
    n_threads: u32,
    shift: u32,
}

@group(0) @binding(0) var<uniform> pass_: Pass;
@group(0) @binding(1) var<storage, read> keys: array<u32>;
