// Parameters as they lie in a table, four texels a splat.
fn parameters_of(i: u32) -> Parameters {
    let a = textureLoad(parameters, texel(4u * i), 0);
    let b = textureLoad(parameters, texel(4u * i + 1u), 0);
    let c = textureLoad(parameters, texel(4u * i + 2u), 0);
    let d = textureLoad(parameters, texel(4u * i + 3u), 0);
    return Parameters(a.xyz, a.w, b, c.xyz, d.xy);
}
