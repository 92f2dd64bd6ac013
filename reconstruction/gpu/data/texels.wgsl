// Where in a table, a texture as wide as TEXELS_A_ROW, a texel is.
fn texel(number: u32) -> vec2u {
    return vec2u(number % TEXELS_A_ROW, number / TEXELS_A_ROW);
}
