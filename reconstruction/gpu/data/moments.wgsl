// Adam's moments in 16 bits a number, two of them in a word: floating point with six bits of exponent, from 2^-50 to
// 2^14, so that no scale lies beside them. What is less is 0, what is more the largest. The first moment has a sign and
// nine bits of mantissa, and is rounded to the nearest: it forgets a tenth in each step, and the error with it. Of the
// second the root is kept, without a sign and with ten bits. It forgets a two-thousandth in each step, half a bit, and
// that would be lost or doubled: it is rounded up or down at random, by `dither`, with the right mean.
const LEAST_BITS = 77u << 23u;

fn first_code(v: vec4f) -> vec4u {
    let bits = bitcast<vec4u>(v);
    let size = max((bits & vec4u(0x7fffffffu)) + 0x2000u, vec4u(LEAST_BITS)) - LEAST_BITS;
    return min(size >> vec4u(14u), vec4u(0x7fffu)) | ((bits >> vec4u(16u)) & vec4u(0x8000u));
}

fn first_value(code: vec4u) -> vec4f {
    let size = code & vec4u(0x7fffu);
    let bits = select((size << vec4u(14u)) + LEAST_BITS, vec4u(0u), size == vec4u(0u));
    return bitcast<vec4f>(bits | ((code & vec4u(0x8000u)) << vec4u(16u)));
}

fn second_code(v: vec4f, dither: vec4u) -> vec4u {
    let size = max(bitcast<vec4u>(sqrt(v)) + (dither & vec4u(0x1fffu)), vec4u(LEAST_BITS)) - LEAST_BITS;
    return min(size >> vec4u(13u), vec4u(0xffffu));
}

fn second_value(code: vec4u) -> vec4f {
    let root = bitcast<vec4f>(select((code << vec4u(13u)) + LEAST_BITS, vec4u(0u), code == vec4u(0u)));
    return root * root;
}

fn in_words(code: vec4u) -> vec2u {
    return code.xz | (code.yw << vec2u(16u));
}

fn from_words(words: vec2u) -> vec4u {
    return vec4u(words.x & 0xffffu, words.x >> 16u, words.y & 0xffffu, words.y >> 16u);
}
