// SPDX-License-Identifier: MIT OR Apache-2.0
// The outputs that hosts ask for beside a picture, and the places of a tile's pixels in what they are written to. Knows
// no records.

#import constants

struct Outputs {
    // Columns that take chart directions to scene axes; w of the first: M in scene lengths.
    scene_x: vec4<f32>,
    scene_y: vec4<f32>,
    scene_z: vec4<f32>,
    // For each output: OUTPUT_*; the crossing that it is of; its numbers a pixel; 0.
    wanted: array<vec4<u32>, MOST_OUTPUTS>,
    // For each output: the tile's first number and the numbers from row to row, in buffers; its first column and row,
    // in images.
    places: array<vec4<u32>, MOST_OUTPUTS>,
    count: u32,
    // 0: nobody asks for the sky's direction.
    asks_sky: u32,
    // How many crossings of a ray are asked for: those of the disk's numbers, all for the light that it lets pass.
    crossings: u32,
    padding: u32,
}

@group(2) @binding(0) var<uniform> outputs: Outputs;
