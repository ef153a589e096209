//! False colour for views other than light: a value to 8-bit sRGB. In f32, as `shaders/film.wgsl`.

use crate::scene::View;

/// What a value that is NaN looks like.
pub const NO_VALUE: [f32; 3] = [0.5; 3];

/// The values of a view that become the first and the last colour; what lies beyond takes those colours.
pub fn range(view: View) -> (f32, f32) {
    match view {
        View::Light => (0.0, 1.0),
        // No shift in the middle.
        View::Redshift => (0.0, 2.0),
        View::Order => (-2.0, 4.0),
        View::Deflection => (0.0, std::f32::consts::PI),
        View::Steps => (0.0, 200.0),
        View::Metric => (0.0, 1.0),
    }
}

/// sRGB-encoded colour of `share`, 0 .. 1 along the range: a polynomial in s = 2 share - 1, degree 7, fitted by least squares to
/// viridis (S. van der Walt and N. Smith 2015, CC0), a colour map of uniform perceptual steps; within 3 / 255 of it.
pub fn false_colour(share: f32) -> [f32; 3] {
    const COEFFICIENTS: [[f32; 3]; 8] = [
        [0.122859, 0.565404, 0.547807],
        [-0.093959, 0.467181, -0.098045],
        [0.731407, -0.006731, -0.220599],
        [1.150665, 0.011892, -0.238708],
        [-0.142943, -0.175859, -0.507857],
        [-1.206411, -0.080524, -0.039970],
        [-0.084876, 0.072525, 0.410502],
        [0.519528, 0.052835, 0.283648],
    ];
    if share.is_nan() {
        return NO_VALUE;
    }
    let s = 2.0 * share.clamp(0.0, 1.0) - 1.0;
    let horner = |c: usize| COEFFICIENTS.iter().rev().fold(0.0, |sum, row| sum * s + row[c]);
    [0, 1, 2].map(|c| horner(c).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Entries 0, 64, 128, 191 and 255 of matplotlib 3's table.
    #[test]
    fn looks_like_viridis() {
        let table = [
            (0.0, [68.0, 1.0, 84.0]),
            (64.0, [59.0, 82.0, 139.0]),
            (128.0, [33.0, 145.0, 140.0]),
            (191.0, [92.0, 200.0, 99.0]),
            (255.0, [253.0, 231.0, 37.0]),
        ];
        for (index, rgb) in table {
            let colour = false_colour(index / 255.0);
            for c in 0..3 {
                assert!((colour[c] * 255.0 - rgb[c]).abs() < 4.0, "{index}: {colour:?}");
            }
        }
    }

    #[test]
    fn lightness_rises_and_no_value_is_grey() {
        let lightness = |share| {
            let [r, g, b] = false_colour(share);
            0.3 * r + 0.6 * g + 0.1 * b
        };
        for i in 0..64 {
            assert!(lightness(i as f32 / 64.0) < lightness((i + 1) as f32 / 64.0));
        }
        assert_eq!(false_colour(f32::NAN), NO_VALUE);
        assert_eq!(false_colour(f32::INFINITY), false_colour(1.0));
        assert_eq!(false_colour(-3.0), false_colour(0.0));
    }
}
