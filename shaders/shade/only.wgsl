// SPDX-License-Identifier: MIT OR Apache-2.0
// Develops the light of a pixel at once, where the pixel has but one sample.

#requires fn write_pixel(id: vec2<u32>, radiance: vec4<f32>)

fn take_light(id: vec2<u32>, light: vec4<f32>) {
    write_pixel(id, light);
}
