// SPDX-License-Identifier: MIT OR Apache-2.0
//! Colour maps: the luminance of developed light to a colour, as radio astronomers show their images. In f32, as
//! `shaders/film/colour_map.wgsl`, which has the same functions. Knows nothing of pixels and formats.

use crate::physics::blackbody;

/// Y of linear Rec. 709.
pub(crate) const LUMINANCE: [f32; 3] =
    [blackbody::LUMINANCE[0] as f32, blackbody::LUMINANCE[1] as f32, blackbody::LUMINANCE[2] as f32];

/// The luminance of light.
#[inline(always)]
pub fn luminance(rgb: [f32; 3]) -> f32 {
    LUMINANCE[0] * rgb[0] + LUMINANCE[1] * rgb[1] + LUMINANCE[2] * rgb[2]
}

/// The sRGB-encoded colour of `share` in [0, 1]: the map afmhot of gnuplot (palette functions 34, 35, 36) and
/// matplotlib, in which the Event Horizon Telescope publishes: 2 s, 2 s - 1/2, 2 s - 1, each within [0, 1].
#[inline(always)]
pub fn afmhot(share: f32) -> [f32; 3] {
    [0.0, 0.5, 1.0].map(|low| (2.0 * share - low).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows 0, 32, 64, 128, 192 and 255 of matplotlib's afmhot, whose share is row / 255.
    #[test]
    fn afmhot_is_matplotlib_s() {
        let rows: [(u8, [f32; 3]); 6] = [
            (0, [0.0, 0.0, 0.0]),
            (32, [0.250_980_4, 0.0, 0.0]),
            (64, [0.501_960_8, 0.001_960_8, 0.0]),
            (128, [1.0, 0.503_921_6, 0.003_921_6]),
            (192, [1.0, 1.0, 0.505_882_4]),
            (255, [1.0, 1.0, 1.0]),
        ];
        for (row, colour) in rows {
            let ours = afmhot(f32::from(row) / 255.0);
            assert!((0..3).all(|c| (ours[c] - colour[c]).abs() < 1e-5), "{row}: {ours:?}");
        }
    }

    #[test]
    fn luminance_of_white_is_1() {
        assert!((luminance([1.0; 3]) - 1.0).abs() < 1e-4, "{}", luminance([1.0; 3]));
    }
}
