// SPDX-License-Identifier: MIT OR Apache-2.0
//! Twins of emit/half: the blocks of half resolution, and whether they tell a pixel.

use super::inputs::Inputs;
use super::{Group, ROUNDING, SAME, twin};
use crate::emit::half::{TOLERANCE, bend, block_place, depth_is_even, first_block, light_is_even};

/// Pixels, from before the frame to the end of the largest one.
fn push_pixel(i: &mut Inputs) -> i32 {
    let pixel = i.random.below(1 << 20) as i32 - 4;
    i.push_word(pixel as u32);
    pixel
}

/// `count` bends of values up to `most`, about as large as they may be, and `values` of those.
fn push_bends(i: &mut Inputs, count: usize, values: usize, most: f64) {
    let sizes = (0..values).map(|_| i.random.log(1e-3 * most, most)).collect::<Vec<_>>();
    let least = sizes.iter().copied().fold(most, f64::min);
    for _ in 0..count {
        i.even(0.0, 1.1 * TOLERANCE * (least + 1e-3));
    }
    sizes.into_iter().for_each(|size| {
        i.push(size);
    });
}

pub fn group() -> Group {
    let file = "emit/half";
    let twins = vec![
        twin(
            file,
            "first_block",
            "out1(f32(first_block(i32(word(0u)))));",
            |i| {
                push_pixel(i);
            },
            |i, o| o.put(f64::from(first_block(i.word(0) as i32))),
            SAME,
        ),
        twin(
            file,
            "block_place",
            "out1(block_place(i32(word(0u)), in1(1u)));",
            |i| {
                push_pixel(i);
                i.even(-1.0, 2.0);
            },
            |i, o| o.put(block_place(i.word(0) as i32, i.x(1))),
            ROUNDING,
        ),
        twin(
            file,
            "bend",
            "out4(bend(in4(0u), in4(4u), in4(8u), in4(12u)));",
            |i| i.evens(16, 0.0, 1.0),
            |i, o| o.all((0..4).map(|c| bend([0, 4, 8, 12].map(|k| i.x(k + c)))), 1.0),
            ROUNDING,
        ),
        twin(
            file,
            "light_is_even",
            "out_flag(light_is_even(in4(0u), in2(4u), in1(6u), in1(7u)));",
            |i| {
                push_bends(i, 4, 2, 1.0);
                i.log(1e-3, 0.1);
                i.even(0.01, 0.1);
            },
            |i, o| o.flag(light_is_even(i.v4(0).to_array(), i.v2(4).to_array(), i.x(6), i.x(7))),
            SAME,
        ),
        twin(
            file,
            "depth_is_even",
            "out_flag(depth_is_even(in2(0u), in2(2u), in1(4u)));",
            |i| {
                push_bends(i, 2, 2, 4.0);
                i.even(0.01, 0.1);
            },
            |i, o| o.flag(depth_is_even(i.v2(0).to_array(), i.v2(2).to_array(), i.x(4))),
            SAME,
        ),
    ];
    Group { name: "half resolution", head: "#import emit/half\n".into(), twins, images: Vec::new, tables: Vec::new }
}
