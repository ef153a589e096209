// SPDX-License-Identifier: MIT OR Apache-2.0
//! False colour for views other than light: a value to 8-bit sRGB. In f32, as `shaders/film/false_colour.wgsl`, which
//! has the same functions. The maps are curves of constant speed in CIELAB (CIE 1976), so that equal steps of the
//! scaled value are equal steps of colour, and lightness is linear in it (Kovesi 2015: what makes fine structure
//! legible).

use super::srgb_encode;
use crate::scene::View;

/// The colour of a value that is NaN: a grey that no map comes near.
pub const NO_VALUE: [f32; 3] = [0.5; 3];

/// The place of a view's value along its map, before the `ends` of the map are put to 0 and 1.
fn scaled(view: View, value: f32) -> f32 {
    match view {
        View::Redshift | View::Deflection | View::Steps | View::OpticalDepth | View::Intensity => {
            value.max(LEAST).log2()
        }
        // sqrt(2 M / r), the speed of matter that falls from rest at infinity: -g_tt crowds below 1.
        View::Metric => 1.0 - (1.0 - value.min(1.0)).sqrt(),
        View::Order | View::Light => value,
    }
}

/// The least argument of a logarithm; smaller values have the first colour by far.
const LEAST: f32 = 1e-9;

/// The values of a view that become the first and the last colour; what lies beyond takes those colours.
pub fn range(view: View) -> (f32, f32) {
    use std::f32::consts::PI;
    match view {
        // No shift in the middle. Disks without spin have 0.45 .. 1.5.
        View::Redshift => (1.0 / 3.0, 3.0),
        // Captured, sky, the direct image and the next two; all further images look like the last.
        View::Order => (-2.0, 3.0),
        View::Deflection => (PI / 64.0, PI),
        View::Steps => (8.0, 512.0),
        // From matter that is hardly seen to a surface.
        View::OpticalDepth => (1.0 / 64.0, 16.0),
        // Matter of density 1 along 64 M at rest has 64.
        View::Intensity => (1.0 / 64.0, 64.0),
        View::Light | View::Metric => (0.0, 1.0),
    }
}

/// The range as the shader needs it: `scaled` of the first colour's value, and 1 / (the last one's - the first one's).
pub fn ends(view: View) -> (f32, f32) {
    let (first, last) = range(view);
    let low = scaled(view, first);
    (low, 1.0 / (scaled(view, last) - low))
}

/// sRGB-encoded colour of a value of `view`, whose `ends` are (`low`, `scale`).
pub fn false_colour(view: View, (low, scale): (f32, f32), value: f32) -> [f32; 3] {
    if value.is_nan() {
        return NO_VALUE;
    }
    let share = ((scaled(view, value) - low) * scale).clamp(0.0, 1.0);
    lab_encoded(if view == View::Redshift { diverging(share) } else { sequential(share) })
}

/// CIELAB from dark blue over purple, red and orange to light yellow: a helix about an axis beside the grey one (after
/// Green 2011, whose cubehelix lies in RGB), as long as the gamut of sRGB allows.
fn sequential(share: f32) -> [f32; 3] {
    let turn = 4.76 + 3.78 * share;
    [15.0 + 76.0 * share, 11.0 + 56.0 * turn.cos(), 21.0 + 56.0 * turn.sin()]
}

/// CIELAB from red over a light grey, at 1/2, to blue: straight, of constant hue, equally steep on both sides
/// (Moreland 2009).
fn diverging(share: f32) -> [f32; 3] {
    let arm = 2.0 * share - 1.0;
    // Chroma 62 at the ends, at the hues 290 and 33 degrees.
    let [a, b] = if arm > 0.0 { [21.21, -58.26] } else { [52.0, 33.77] };
    let distance = arm.abs();
    [95.0 - 57.0 * distance, a * distance, b * distance]
}

/// CIELAB (white: Rec. 709's) to sRGB codes, 0 .. 1.
fn lab_encoded([lightness, a, b]: [f32; 3]) -> [f32; 3] {
    let y = (lightness + 16.0) / 116.0;
    let [x, y, z] = [y + a / 500.0, y, y - b / 200.0].map(|t| {
        let linear = (t - 16.0 / 116.0) * (108.0 / 841.0);
        if t > 6.0 / 29.0 { t * t * t } else { linear }
    });
    // XYZ over the white's to linear Rec. 709: `physics::blackbody`'s matrix, its columns times the white; rows sum to
    // 1.
    [
        3.080_399 * x - 1.537_383_2 * y - 0.543_015_9 * z,
        -0.921_223_4 * x + 1.875_967_5 * y + 0.045_255_9 * z,
        0.052_873_9 * x - 0.203_977 * y + 1.151_103 * z,
    ]
    .map(|v| srgb_encode(v.clamp(0.0, 1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(view: View, value: f32) -> [f32; 3] {
        false_colour(view, ends(view), value)
    }

    const VIEWS: [View; 7] =
        [View::Redshift, View::Order, View::Deflection, View::Steps, View::Metric, View::OpticalDepth, View::Intensity];

    /// CIELAB of codes 0 .. 1, by the definitions of IEC 61966-2-1 and CIE 15 and the primaries' own matrix; in f64.
    fn lab(rgb: [f32; 3]) -> [f64; 3] {
        let linear = rgb.map(f64::from).map(|c| if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) });
        let rows = [
            [0.412_390_799, 0.357_584_339, 0.180_480_788],
            [0.212_639_006, 0.715_168_679, 0.072_192_315],
            [0.019_330_819, 0.119_194_780, 0.950_532_152],
        ];
        let [x, y, z] = rows.map(|row| {
            let white: f64 = row.iter().sum();
            let t = (0..3).map(|i| row[i] * linear[i]).sum::<f64>() / white;
            if t > (6.0_f64 / 29.0).powi(3) { t.cbrt() } else { t * 841.0 / 108.0 + 16.0 / 116.0 }
        });
        [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
    }

    /// CIE 1976.
    fn difference(a: [f64; 3], b: [f64; 3]) -> f64 {
        (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
    }

    /// The value that is `share` of the way from a view's first colour to its last.
    fn value_at(view: View, share: f32) -> f32 {
        let (first, last) = range(view);
        match view {
            View::Metric => 1.0 - (1.0 - share).powi(2),
            View::Order => first + share * (last - first),
            _ => first * (last / first).powf(share),
        }
    }

    fn colours(view: View, count: u32) -> Vec<[f64; 3]> {
        (0..=count).map(|i| lab(shown(view, value_at(view, i as f32 / count as f32)))).collect()
    }

    /// Lightness rises (of REDSHIFT: to the middle, and falls from there), by equal steps, and so does colour; in 8
    /// bits too.
    #[test]
    fn steps_are_uniform() {
        for view in VIEWS {
            let count = 40;
            let all = colours(view, count);
            let (mut lightness, mut colour) = (Vec::new(), Vec::new());
            for (i, pair) in all.windows(2).enumerate() {
                let falls = view == View::Redshift && 2 * i >= count as usize;
                let rise = (pair[1][0] - pair[0][0]) * if falls { -1.0 } else { 1.0 };
                assert!(rise > 0.0, "{view:?} {i}: lightness goes by {rise}");
                lightness.push(rise);
                colour.push(difference(pair[0], pair[1]));
            }
            for steps in [lightness, colour] {
                let mean = steps.iter().sum::<f64>() / steps.len() as f64;
                let worst = steps.iter().map(|s| (s / mean - 1.0).abs()).fold(0.0, f64::max);
                assert!(mean > 1.0 && worst < 0.02, "{view:?}: steps of {mean}, off by {worst}");
            }
        }
    }

    #[test]
    fn maps_end_and_pass_where_they_should() {
        let hue = |[_, a, b]: [f64; 3]| b.atan2(a).to_degrees().rem_euclid(360.0);
        let chroma = |[_, a, b]: [f64; 3]| a.hypot(b);
        let [red, none, blue] = [1.0 / 3.0, 1.0, 3.0].map(|g| lab(shown(View::Redshift, g)));
        assert!((none[0] - 95.0).abs() < 0.1 && chroma(none) < 0.1, "g = 1: {none:?}");
        assert!((20.0..45.0).contains(&hue(red)) && (280.0..300.0).contains(&hue(blue)), "{red:?} {blue:?}");
        assert!(chroma(red) > 60.0 && chroma(blue) > 60.0);
        // g and 1 / g are equally far from no shift.
        for g in [1.1, 1.5, 2.5] {
            let [a, b] = [g, 1.0 / g].map(|g| difference(none, lab(shown(View::Redshift, g))));
            assert!((a / b - 1.0).abs() < 0.01, "{g}: {a} {b}");
        }
        for view in VIEWS {
            let (first, last) = range(view);
            assert_eq!(shown(view, f32::INFINITY), shown(view, last), "{view:?}");
            assert_eq!(shown(view, f32::NEG_INFINITY), shown(view, first), "{view:?}");
            assert!(first == 0.0 || shown(view, 0.0) == shown(view, first) || view == View::Order);
        }
    }

    /// Captured, sky, the images, and no value: nothing could be taken for another.
    #[test]
    fn orders_are_distinct_steps() {
        let all = [-2.0, -1.0, 0.0, 1.0, 2.0, 3.0, f32::NAN].map(|order| lab(shown(View::Order, order)));
        for (i, a) in all.iter().enumerate() {
            for b in &all[..i] {
                assert!(difference(*a, *b) > 30.0, "{a:?} {b:?}");
            }
        }
        assert!(all[0][0] < 20.0 && all[1][0] < 35.0, "captured is dark, the sky dim: {all:?}");
        assert_eq!(shown(View::Order, 15.0), shown(View::Order, 3.0));
    }

    #[test]
    fn no_value_is_like_nothing_else() {
        for view in VIEWS {
            assert_eq!(shown(view, f32::NAN), NO_VALUE);
            let nearest = colours(view, 200).into_iter().map(|c| difference(c, lab(NO_VALUE)));
            assert!(nearest.fold(f64::INFINITY, f64::min) > 30.0, "{view:?}");
        }
    }

    /// Inside the gamut: nothing was cut off, which would bend the map.
    #[test]
    fn maps_stay_within_the_gamut() {
        for view in VIEWS {
            for i in 0..=1000 {
                let rgb = shown(view, value_at(view, i as f32 / 1000.0));
                assert!(rgb.iter().all(|v| *v > 0.0 && *v < 1.0), "{view:?} {i}: {rgb:?}");
            }
        }
    }
}
