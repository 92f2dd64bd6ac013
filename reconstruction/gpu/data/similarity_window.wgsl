// Structural similarity (Wang et al., 2004): what its kernels share. The window is separable, so sums over it are made
// along rows and then along columns; a thread makes RUN neighbouring ones, whose inputs overlap. Values are counted
// from the middle of their range: variances are differences of squares, which lose the less the smaller these are.
struct Sizes { width: u32, height: u32, inner: u32, rows: u32 } // windows in a row, and rows of windows

const MIDDLE = 0.5;
const RUN = 4u;
const WINDOW = array<f32, 17>(0.0, 0.0, 0.0, W_0, W_1, W_2, W_3, W_4, W_5, W_4, W_3, W_2, W_1, W_0, 0.0, 0.0, 0.0);

//: include texels

fn unpacked(word: u32) -> vec3f {
    return vec3f(f32(word & 255u), f32((word >> 8u) & 255u), f32((word >> 16u) & 255u)) / 255.0;
}
