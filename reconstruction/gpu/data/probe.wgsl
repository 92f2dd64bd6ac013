// Of how many lanes the subgroups are that a workgroup of LANES runs in.
@group(0) @binding(0) var<storage, read_write> found: array<u32>;

@compute @workgroup_size(LANES)
fn main(@builtin(subgroup_size) lanes: u32) {
    found[0] = lanes;
}
