fn texel(number: u32) -> vec2u {
    return vec2u(number % TEXELS_A_ROW, number / TEXELS_A_ROW);
}
