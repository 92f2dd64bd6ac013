// The totals of two running sums, side by side, for one look from outside.
@group(0) @binding(0) var<uniform> n: vec4u;
@group(0) @binding(1) var<storage, read> first: array<u32>;
@group(0) @binding(2) var<storage, read> second: array<u32>;
@group(0) @binding(3) var<storage, read_write> totals: array<u32>;

@compute @workgroup_size(1)
fn main() {
    totals[0] = first[n.x];
    totals[1] = second[n.x];
}
