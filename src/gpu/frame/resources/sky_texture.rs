// SPDX-License-Identifier: MIT OR Apache-2.0
//! A sky map as a texture, and where in it its levels are.

use crate::gpu::device::texture::Texture;

/// A map on the device.
pub struct MapTexture {
    pub texture: Texture,
    /// Size of its finest level.
    pub finest: [u32; 2],
}

/// The height of the texture of a map whose finest level has this size.
pub(in crate::gpu) fn texture_height([width, height]: [u32; 2]) -> u32 {
    if width > 1 { height + (height / 2).max(1) } else { height }
}

/// Where level `number` begins. Each is at most half as wide as the one before, so that it ends before the next begins.
pub(in crate::gpu) fn level_place([width, height]: [u32; 2], number: u32) -> [u32; 2] {
    if number == 0 { [0, 0] } else { [width - (width >> (number - 1)), height] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_do_not_overlap() {
        for size in [[1, 1], [2, 1], [7, 7], [64, 32], [301, 299], [16384, 8192]] {
            let map_levels = 32 - u32::leading_zeros(size[0]);
            let mut end = 0;
            for number in 1..map_levels {
                let [left, top] = level_place(size, number);
                let [width, height] = size.map(|side: u32| (side >> number).max(1));
                assert!(left >= end && top >= size[1] && top + height <= texture_height(size), "{size:?} {number}");
                end = left + width;
                assert!(end <= size[0], "{size:?} {number}");
            }
        }
    }
}
