//! The tone maps: linear Rec. 709 scene light, 1.0 being a bright surface, to linear display light in [0, 1].
//! In f32, as `shaders/film/film.wgsl`, which has the same functions. Knows nothing of pixels and formats.

/// Brighter light is taken as this: far above every curve's white, and its square is finite.
pub const MAX_SCENE_LIGHT: f32 = 65504.0;

/// No tone map: what is brighter than white becomes white. As the other two, of `rgb` with every component in
/// [0, MAX_SCENE_LIGHT], to [0, 1]; 0 stays 0 (AgX: below 1e-9).
#[inline(always)]
pub fn clip(rgb: [f32; 3]) -> [f32; 3] {
    rgb.map(|v| v.clamp(0.0, 1.0))
}

/// A 3 x 3 matrix whose rows sum to 1, so that grey stays grey to the last bit: given by what each component takes
/// from the other two, in their order.
type Balanced = [[f32; 2]; 3];

#[inline(always)]
fn balanced(m: Balanced, [r, g, b]: [f32; 3]) -> [f32; 3] {
    [
        r + m[0][0] * (g - r) + m[0][1] * (b - r),
        g + m[1][0] * (r - g) + m[1][1] * (b - g),
        b + m[2][0] * (r - b) + m[2][1] * (g - b),
    ]
}

/// Linear Rec. 709 -> ACES AP1 with the RRT's desaturation; and the way back with the ODT's (Hill).
pub(crate) const ACES_IN: Balanced = [[0.35458, 0.04823], [0.076, 0.01566], [0.0284, 0.13383]];
pub(crate) const ACES_OUT: Balanced = [[-0.53108, -0.07367], [-0.10208, -0.00605], [-0.00327, -0.07276]];

/// ACES 1.0 RRT and sRGB ODT as fitted by Stephen Hill (2015; published with M. Pettineo's BakingLab, and kept by many
/// engines): a rational curve between two matrices. Unlike a curve per channel alone it lets bright saturated light go
/// to white.
#[inline(always)]
pub fn aces(rgb: [f32; 3]) -> [f32; 3] {
    let curve = |v: f32| (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.432951) + 0.238081);
    balanced(ACES_OUT, balanced(ACES_IN, rgb).map(curve)).map(|v| v.clamp(0.0, 1.0))
}

/// Troy Sobotka's AgX inset, and its inverse.
pub(crate) const AGX_IN: Balanced = [[0.0784336, 0.0792237], [0.0423282, 0.0791661], [0.0423757, 0.0784336]];
pub(crate) const AGX_OUT: Balanced = [[-0.0980332, -0.0990408], [-0.0529035, -0.0989508], [-0.0529776, -0.0980332]];
/// Stops about middle grey, 0.18, that the curve spans: -10 .. +6.5, in log2 of light.
pub(crate) const AGX_LOW: f32 = -12.473931;
pub(crate) const AGX_SPAN: f32 = 16.5;
/// Middle grey on that axis, 10 / 16.5, where the curve passes through one half.
pub(crate) const AGX_PIVOT: f32 = 0.606_060_6;

/// |s| of the sigmoid below and above the pivot.
pub(crate) const AGX_TOE: f32 = 0.5122774;
pub(crate) const AGX_SHOULDER: f32 = 0.5414642;

/// AgX, base look (T. Sobotka, AgX-S2O3, 2022): inset, log2, a sigmoid, outset; the result is for a display of gamma
/// 2.2. The sigmoid is Jed Smith's: y = 1/2 + s h(2 (x - pivot) / s), h(t) = t / (1 + t^p)^(1/p), with slope 2 at the
/// pivot, p = 3 below it and 3.25 above; s, negative below, makes it end in 0 and 1: s = ((2 w)^-p ((4 w)^p -
/// 1))^(-1/p), w = the pivot's distance to that end.
pub fn agx(rgb: [f32; 3]) -> [f32; 3] {
    let curve = |v: f32| agx_sigmoid(((v.max(1e-10).log2() - AGX_LOW) / AGX_SPAN).clamp(0.0, 1.0));
    balanced(AGX_OUT, balanced(AGX_IN, rgb).map(curve)).map(|v| v.clamp(0.0, 1.0).powf(2.2))
}

fn agx_sigmoid(x: f32) -> f32 {
    let (scale, power) = if x < AGX_PIVOT { (-AGX_TOE, 3.0) } else { (AGX_SHOULDER, 3.25) };
    let t = (2.0 * (x - AGX_PIVOT) / scale).max(0.0);
    (0.5 + scale * t / (1.0 + t.powf(power)).powf(1.0 / power)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::ToneMap;

    fn tone_map(kind: ToneMap, rgb: [f32; 3]) -> [f32; 3] {
        match kind {
            ToneMap::None => clip(rgb),
            ToneMap::Aces => aces(rgb),
            ToneMap::Agx => agx(rgb),
        }
    }

    const ALL: [ToneMap; 3] = [ToneMap::None, ToneMap::Aces, ToneMap::Agx];

    #[test]
    fn curves_are_monotonic_from_black_to_white_and_keep_grey() {
        for kind in ALL {
            assert!(tone_map(kind, [0.0; 3]).iter().all(|&v| (0.0..1e-9).contains(&v)), "{kind:?}");
            assert_eq!(tone_map(kind, [MAX_SCENE_LIGHT; 3]), [1.0; 3], "{kind:?}");
            let mut before = 0.0;
            for i in 0..4000 {
                let v = 2.0_f32.powf(i as f32 * 0.008 - 16.0);
                let [r, g, b] = tone_map(kind, [v; 3]);
                assert!(r == g && g == b, "{kind:?} tints {v}");
                assert!((before..=1.0).contains(&r), "{kind:?} at {v}: {r} after {before}");
                before = r;
            }
        }
    }

    #[test]
    fn saturated_light_stays_in_range_and_goes_to_white() {
        for kind in [ToneMap::Aces, ToneMap::Agx] {
            for rgb in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.5, 0.0]] {
                for scale in [1e-4, 0.01, 1.0, 100.0, 6e4_f32] {
                    let out = tone_map(kind, rgb.map(|v| v * scale));
                    assert!(out.iter().all(|v| (0.0..=1.0).contains(v)), "{kind:?} {rgb:?} {scale}: {out:?}");
                }
                let bright = tone_map(kind, rgb.map(|v| v * 6e4));
                assert!(bright.iter().all(|&v| v > 0.4), "{kind:?} {rgb:?}: {bright:?}");
            }
        }
    }

    /// Middle grey: Hill's fit by hand, 0.18 (0.18 + 0.0245786) - 9.0537e-5 over 0.18 (0.18 0.983729 + 0.432951) +
    /// 0.238081; AgX: one half on a display of gamma 2.2.
    #[test]
    fn middle_grey_is_where_the_sources_put_it() {
        assert!((tone_map(ToneMap::Aces, [0.18; 3])[0] - 0.105_591_2).abs() < 1e-5);
        assert!((tone_map(ToneMap::Agx, [0.18; 3])[0] - 0.5_f32.powf(2.2)).abs() < 1e-5);
    }

    #[test]
    fn agx_constants_are_those_of_its_formulas() {
        let scale = |w: f64, p: f64| ((2.0 * w).powf(-p) * ((4.0 * w).powf(p) - 1.0)).powf(-1.0 / p);
        let pivot = 10.0 / 16.5;
        assert!((f64::from(AGX_PIVOT) - pivot).abs() < 1e-7);
        assert!((f64::from(AGX_LOW) - (0.18_f64.log2() - 10.0)).abs() < 1e-6);
        assert!((scale(pivot, 3.0) - f64::from(AGX_TOE)).abs() < 1e-7);
        assert!((scale(1.0 - pivot, 3.25) - f64::from(AGX_SHOULDER)).abs() < 1e-7);
        for rgb in [[1.0, 0.2, 0.1], [0.0, 0.7, 0.3]] {
            let back = balanced(AGX_OUT, balanced(AGX_IN, rgb));
            assert!((0..3).all(|i| (back[i] - rgb[i]).abs() < 1e-6), "{rgb:?} {back:?}");
        }
    }

    /// Stephen Hill's own numbers (BakingLab, ACES.hlsl), in f64: whole matrices, whose rows he rounded to a sum
    /// within 1e-5 of 1.
    #[test]
    fn aces_is_hill_s_fit() {
        let input = [[0.59719, 0.35458, 0.04823], [0.07600, 0.90834, 0.01566], [0.02840, 0.13383, 0.83777]];
        let output = [[1.60475, -0.53108, -0.07367], [-0.10208, 1.10813, -0.00605], [-0.00327, -0.07276, 1.07602]];
        let product = |m: [[f64; 3]; 3], v: [f64; 3]| m.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2]);
        let fit = |v: f64| (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081);
        for rgb in [[0.18, 0.18, 0.18], [1.0, 0.2, 0.05], [0.01, 0.5, 3.0], [12.0, 7.0, 4.0], [0.0, 0.0, 0.3]] {
            let published = product(output, product(input, rgb).map(fit)).map(|v| v.clamp(0.0, 1.0));
            let ours = aces(rgb.map(|v| v as f32));
            assert!(
                (0..3).all(|i| (f64::from(ours[i]) - published[i]).abs() < 2e-5),
                "{rgb:?}: {ours:?}, {published:?}"
            );
        }
    }

    /// AgX's base curve against Benjamin Wrensch's polynomial for it (Minimal AgX, 2023), fitted to Sobotka's table
    /// with an error of 0.0019 (root mean square): we are within 0.003 of it.
    #[test]
    fn agx_is_sobotka_s_curve() {
        let polynomial = [-0.00232, 0.1191, 0.4298, -6.868, 31.96, -40.14, 15.5];
        let mut squares = 0.0;
        for i in 0..=1000 {
            let x = f64::from(i) / 1000.0;
            let published = polynomial.iter().rev().fold(0.0, |sum, c| sum * x + c);
            let off = f64::from(agx_sigmoid(x as f32)) - published;
            assert!(off.abs() < 0.006, "at {x}: {off}");
            squares += off * off / 1001.0;
        }
        assert!(squares.sqrt() < 0.003, "{}", squares.sqrt());
    }
}
