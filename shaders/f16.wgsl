// Numbers rounded to what f16 tells apart, to even: storing them in a texture of f16 changes nothing, whatever way the driver rounds.

// Of 0 <= v <= 65504. Below 6e-5, where f16 has fewer digits, the driver rounds.
fn rounded_to_f16(v: vec4<f32>) -> vec4<f32> {
    let bits = bitcast<vec4<u32>>(v);
    return bitcast<vec4<f32>>((bits + 0xfffu + ((bits >> vec4<u32>(13u)) & vec4<u32>(1u))) & vec4<u32>(0xffffe000u));
}
