// One sample of one tile. The traced rectangle is the tile and one pixel around it, for the derivatives.
struct Pass {
    // Of the traced rectangle's top-left pixel in the full frame.
    origin: vec2<i32>,
    // Of the traced rectangle.
    size: vec2<u32>,
    // Of this sample in its pixel, 0 .. 1.
    offset: vec2<f32>,
    // Of this sample among all.
    weight: f32,
    // 1: begins a new sum.
    first: u32,
}
