// SPDX-License-Identifier: MIT OR Apache-2.0
//! White balance: the matrix that makes the light of a chosen colour white. In f64, once a frame. Knows no pixels.
//!
//! A blackbody's chromaticity is that of Planck's law through the CIE 1931 observer, as everywhere in this library,
//! rather than of a formula fitted to it (Kim et al. 2002, Krystek 1985). So a disk of a temperature turns grey when
//! the balance is set to it. The step from a light's white to D65 is Bradford's (K. M. Lam 1985; ICC.1:2022, annex E).

use crate::image::primaries;
use crate::physics::blackbody::radiance_xyz;
use crate::scene::Grade;

/// The distance from the Planckian locus, Duv, of a tint of 1: about three times the 0.006 that ANSI C78.377 lets lamps
/// have.
const TINT_DUV: f64 = 0.02;
/// The temperature at which the locus passes the white of Rec. 709, K: its direction there is that of a tint without a
/// temperature.
const NEAR_WHITE: f64 = 6504.0;
/// D65 in CIE 1931 x and y, the white of Rec. 709.
const D65: [f64; 2] = [0.3127, 0.329];
/// The least Z of a white whose Y is 1. Tints of warm lights may lie beyond the yellows that there are; there, this
/// keeps the factor on blue below 26.
const LEAST_Z: f64 = 0.07;

/// CIE 1960 u and v.
fn uv([x, y, z]: [f64; 3]) -> [f64; 2] {
    let sum = x + 15.0 * y + 3.0 * z;
    [4.0 * x / sum, 6.0 * y / sum]
}

/// CIE XYZ, Y being 1, of the light that is to become white: on the Planckian locus at the temperature, and from there
/// by `TINT_DUV` of the tint along the normal of the locus in the CIE 1960 diagram, above it for a tint above 0, where
/// light is green (Y. Ohno, LEUKOS 10, 2014). The picture then turns magenta.
fn white(grade: &Grade) -> [f64; 3] {
    let temperature = if grade.white_balance > 0.0 { grade.white_balance } else { NEAR_WHITE };
    let [u, v] = match grade.white_balance > 0.0 {
        true => uv(radiance_xyz(temperature)),
        false => uv([D65[0], D65[1], 1.0 - D65[0] - D65[1]]),
    };
    let (cooler, hotter) = (uv(radiance_xyz(0.999 * temperature)), uv(radiance_xyz(1.001 * temperature)));
    // Along the locus u falls with the temperature: turned by a quarter this points up.
    let (du, dv) = (hotter[0] - cooler[0], hotter[1] - cooler[1]);
    let step = TINT_DUV * grade.tint / du.hypot(dv);
    let (u, v) = (u + step * dv, v - step * du);
    [1.5 * u / v, 1.0, ((4.0 - u - 10.0 * v) / (2.0 * v)).max(LEAST_Z)]
}

/// The matrix for linear Rec. 709, by columns; `None`: light stays as it is.
pub fn matrix(grade: &Grade) -> Option<[[f64; 3]; 3]> {
    let is_off = grade.white_balance == 0.0 && grade.tint == 0.0;
    if is_off { None } else { primaries::white_balance(white(grade)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::blackbody::{LUMINANCE, linear_rgb};

    fn times(m: [[f64; 3]; 3], [r, g, b]: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|row| m[0][row] * r + m[1][row] * g + m[2][row] * b)
    }

    fn luminance(rgb: [f64; 3]) -> f64 {
        (0..3).map(|c| LUMINANCE[c] * rgb[c]).sum()
    }

    /// CIE XYZ -> linear Rec. 709, to the digits that IEC 61966-2-1 amendment 1 gives.
    fn rec709([x, y, z]: [f64; 3]) -> [f64; 3] {
        [
            3.240_969_94 * x - 1.537_383_18 * y - 0.498_610_76 * z,
            -0.969_243_64 * x + 1.875_967_50 * y + 0.041_555_06 * z,
            0.055_630_08 * x - 0.203_976_96 * y + 1.056_971_51 * z,
        ]
    }

    #[test]
    fn the_chosen_light_becomes_neutral_and_keeps_its_luminance() {
        for temperature in [1667.0, 2000.0, 2856.0, 4000.0, 5003.0, 6504.0, 10_000.0, 25_000.0] {
            let grade = Grade { white_balance: temperature, ..Grade::default() };
            let light = linear_rgb(temperature);
            let light = light.map(|v| v / luminance(light));
            let shown = times(matrix(&grade).unwrap(), light);
            assert!(shown.iter().all(|v| (v - 1.0).abs() < 1e-6), "{temperature} K: {light:?} becomes {shown:?}");
            for tint in [-1.0, -0.3, 0.2, 1.0] {
                let grade = Grade { tint, ..grade };
                let white = white(&grade);
                let shown = times(matrix(&grade).unwrap(), rec709(white));
                assert!(shown.iter().all(|v| (v - 1.0).abs() < 1e-6), "{temperature} K, {tint}: {shown:?}");
            }
        }
    }

    /// The chromaticity of a tinted light, and its distance from the locus, by ways of their own.
    #[test]
    fn a_tint_is_a_distance_from_the_locus() {
        for (temperature, tint) in [(3200.0, 0.5), (4000.0, -1.0), (5600.0, 1.0), (6504.0, 0.4), (20_000.0, -0.7)] {
            let white = white(&Grade { white_balance: temperature, tint, ..Grade::default() });
            let [u, v] = uv(white);
            let nearest = (-2000..=2000)
                .map(|i| temperature * (1.0 + f64::from(i) * 1e-5))
                .map(|t| {
                    let [pu, pv] = uv(radiance_xyz(t));
                    ((u - pu).hypot(v - pv), v - pv, t)
                })
                .min_by(|a, b| a.0.total_cmp(&b.0))
                .unwrap();
            let duv = nearest.0.copysign(nearest.1);
            assert!((duv - 0.02 * tint).abs() < 2e-6, "{temperature} K, {tint}: Duv {duv} at {} K", nearest.2);
            assert!((nearest.2 / temperature - 1.0).abs() < 2e-3, "{temperature} K, {tint}: at {} K", nearest.2);
        }
    }

    /// CIE illuminant A (CIE 15:2018: 0.44758, 0.40745) is a blackbody of 2855.5 K, to a few of these digits.
    #[test]
    fn illuminant_a_becomes_neutral() {
        let light = rec709([0.44758 / 0.40745, 1.0, 0.14497 / 0.40745]);
        let shown = times(matrix(&Grade { white_balance: 2855.5, ..Grade::default() }).unwrap(), light);
        assert!(shown.iter().all(|v| (v - 1.0).abs() < 1e-3), "{shown:?}");
    }

    #[test]
    fn warm_settings_cool_the_picture_and_tints_above_0_make_it_magenta() {
        let shown = |white_balance: f64, tint: f64| {
            times(matrix(&Grade { white_balance, tint, ..Grade::default() }).unwrap(), [1.0; 3])
        };
        let (warm, cold) = (shown(3000.0, 0.0), shown(12_000.0, 0.0));
        assert!(warm[2] > warm[0] + 0.5 && cold[0] > cold[2] + 0.2, "{warm:?} {cold:?}");
        for white_balance in [0.0, 3200.0, 6504.0, 25_000.0] {
            let without = if white_balance == 0.0 { [1.0; 3] } else { shown(white_balance, 0.0) };
            let (more, less) = (shown(white_balance, 0.5), shown(white_balance, -0.5));
            let green = |rgb: [f64; 3]| 2.0 * rgb[1] - rgb[0] - rgb[2];
            assert!(green(more) < green(without) - 0.05, "{white_balance}: {more:?} from {without:?}");
            assert!(green(less) > green(without) + 0.05, "{white_balance}: {less:?} from {without:?}");
        }
        assert_eq!(matrix(&Grade::default()), None);
    }

    /// Without jumps, and within bounds that f32 likes.
    #[test]
    fn every_setting_has_a_matrix_and_near_ones_have_near_matrices() {
        let entries = |white_balance: f64, tint: f64| {
            matrix(&Grade { white_balance, tint, ..Grade::default() }).map(|m| m.as_flattened().to_vec())
        };
        for k in 0..=100 {
            let temperature = 1667.0 * (25_000.0_f64 / 1667.0).powf(f64::from(k) / 100.0).min(25_000.0 / 1667.0);
            for i in -50..=50 {
                let tint = f64::from(i) / 50.0;
                let here = entries(temperature, tint).unwrap_or_else(|| panic!("{temperature} K, {tint}"));
                let near = entries((temperature * 1.0001).min(25_000.0), tint).unwrap();
                assert!(here.iter().all(|v| v.abs() < 26.0), "{temperature} K, {tint}: {here:?}");
                let most = here.iter().zip(&near).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
                let greatest = here.iter().fold(1.0_f64, |greatest, v| greatest.max(v.abs()));
                assert!(most < 3e-3 * greatest, "{temperature} K, {tint}: {most}");
            }
        }
    }
}
