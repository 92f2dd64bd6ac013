// Sums that come out the same bit by bit in whatever order threads add to them: whole numbers of 64 bits, 2^-32 each,
// in two words. The lower word says by what it was before whether it overflowed.
const FIXED_WORDS = 2u;
const MOST_FIXED = 1e9;

fn add_fixed(slot: u32, value: f32) {
    let size = abs(value);
    if (size == 0.0) { return; }
    if (!(size < MOST_FIXED)) {
        atomicStore(&sums[IS_BAD], 1u);
        return;
    }
    let whole = floor(size);
    let low = u32((size - whole) * 4294967296.0);
    var high = u32(whole);
    if (value > 0.0) {
        let before = atomicAdd(&sums[FIXED_WORDS * slot], low);
        if (before + low < before) { high += 1u; }
        if (high != 0u) { atomicAdd(&sums[FIXED_WORDS * slot + 1u], high); }
    } else {
        let before = atomicSub(&sums[FIXED_WORDS * slot], low);
        if (before < low) { high += 1u; }
        if (high != 0u) { atomicSub(&sums[FIXED_WORDS * slot + 1u], high); }
    }
}
