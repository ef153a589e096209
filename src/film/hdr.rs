// SPDX-License-Identifier: MIT OR Apache-2.0
//! High dynamic range: light to the codes of ITU-R BT.2100, by the curve PQ (HDR10) or HLG, in the primaries of Rec.
//! 2020. Works on exposed, graded light in Rec. 709, of which 1 is diffuse white. In f32, so that
//! `shaders/film/hdr.wgsl`, which has the same functions, agrees to one step of 10 bits.
//!
//! A display shows light of 1 at `paper_white` cd/m^2 (203 as ITU-R BT.2408 has it), and none brighter than `peak`. The
//! brightest channel, in Rec. 2020, is rolled off to that as the EETF of ITU-R BT.2390, 5.4.1, has it for a source of
//! 10,000 cd/m^2: in PQ codes E, with e that of the peak, light stays as it is up to the knee k = 1.5 e - 0.5, and
//! above it, with t = (E - k) / (1 - k), becomes (2 t^3 - 3 t^2 + 1) k + (t^3 - 2 t^2 + t) (1 - k) + (3 t^2 - 2 t^3) e.
//! The other channels keep their ratio to it, so that hues stay; but saturated blue, which HLG cannot show as bright as
//! white, is cut at its code 1. HLG's codes are relative: the peak has the code 1, and the scene light E' of display
//! light D, both parts of the peak, is D Y^((1 - gamma) / gamma), Y the luminance of D (BT.2100, table 5: the inverse
//! of HLG's OOTF, whose black is 0), gamma = 1.2 * 1.111^log2(peak / 1000) (BT.2390, 6.2).

use super::tone_map::MAX_SCENE_LIGHT;
use crate::image::primaries::Primaries;
use crate::scene::Film;

/// The light of the PQ code 1, cd/m^2.
const PQ_PEAK: f64 = 10_000.0;
/// SMPTE ST 2084.
pub(crate) const PQ_M1: f32 = 2610.0 / 16384.0;
pub(crate) const PQ_M2: f32 = 2523.0 / 4096.0 * 128.0;
pub(crate) const PQ_C1: f32 = 3424.0 / 4096.0;
pub(crate) const PQ_C2: f32 = 2413.0 / 4096.0 * 32.0;
pub(crate) const PQ_C3: f32 = 2392.0 / 4096.0 * 32.0;
/// ITU-R BT.2100, table 5.
pub(crate) const HLG_A: f32 = 0.178_832_77;
pub(crate) const HLG_B: f32 = 0.284_668_92;
pub(crate) const HLG_C: f32 = 0.559_910_7;

/// How light becomes codes of high dynamic range: a part of `FilmParams`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct HdrParams {
    /// Rows of the matrix from Rec. 709 to the primaries of the pixels; the fourth numbers are 0.
    pub primaries: [[f32; 4]; 3],
    /// Diffuse white, in parts of 10,000 cd/m^2.
    pub white: f32,
    /// The PQ codes of the brightest light, and of the light from which it is rolled off.
    pub peak: f32,
    pub knee: f32,
    /// HLG: the peak, in parts of 10,000 cd/m^2, and the exponent (1 - gamma) / gamma.
    pub hlg_peak: f32,
    pub hlg_exponent: f32,
    pub unused: [u32; 3],
}

impl HdrParams {
    /// `film` has passed its check.
    pub fn new(film: &Film) -> Self {
        let peak = pq_encode((film.peak / PQ_PEAK) as f32);
        let gamma = 1.2 * 1.111_f64.powf((film.peak / 1000.0).log2());
        let rows = Primaries::REC2020.rows_from_rec709();
        Self {
            primaries: rows.map(|[x, y, z]| [x as f32, y as f32, z as f32, 0.0]),
            white: (film.paper_white / PQ_PEAK) as f32,
            peak,
            knee: 1.5 * peak - 0.5,
            hlg_peak: (film.peak / PQ_PEAK) as f32,
            hlg_exponent: ((1.0 - gamma) / gamma) as f32,
            unused: [0; 3],
        }
    }
}

/// The PQ code of light in parts of 10,000 cd/m^2, both 0 .. 1: ((C1 + C2 p) / (1 + C3 p))^M2, p = light^M1. The base
/// is close to 1, and the power of 79 magnifies its rounding error in f32: ln_1p of what it lacks to 1, (1 - C1) (1 -
/// p) / (1 + C3 p), does not. WGSL has no ln_1p and takes the power; the test of that twin allows the error of 10-bit
/// codes.
pub(crate) fn pq_encode(light: f32) -> f32 {
    let power = light.powf(PQ_M1);
    let below = (1.0 - PQ_C1) * (1.0 - power) / (1.0 + PQ_C3 * power);
    (PQ_M2 * (-below).ln_1p()).exp()
}

/// The light of a PQ code: ((root - C1) / (C2 - C3 root))^(1 / M1), root = code^(1 / M2), by the root's distance from
/// 1.
pub(crate) fn pq_decode(code: f32) -> f32 {
    let below = (code.ln() / PQ_M2).exp_m1();
    (((1.0 - PQ_C1) + below).max(0.0) / ((1.0 - PQ_C1) - PQ_C3 * below)).powf(1.0 / PQ_M1)
}

/// The PQ code that brightest channels of the code `code` are rolled off to.
pub(crate) fn rolled_off(hdr: &HdrParams, code: f32) -> f32 {
    let t = ((code - hdr.knee) / (1.0 - hdr.knee).max(1e-6)).clamp(0.0, 1.0);
    let (t2, t3) = (t * t, t * t * t);
    let rolled = (2.0 * t3 - 3.0 * t2 + 1.0) * hdr.knee
        + (t3 - 2.0 * t2 + t) * (1.0 - hdr.knee)
        + (3.0 * t2 - 2.0 * t3) * hdr.peak;
    if code <= hdr.knee { code } else { rolled.min(hdr.peak) }
}

/// The light that a display shows for a film's, Rec. 2020, parts of 10,000 cd/m^2.
pub(crate) fn display_light(hdr: &HdrParams, scene: [f32; 3]) -> [f32; 3] {
    let light = scene.map(|v| v.min(MAX_SCENE_LIGHT) * hdr.white);
    let light = hdr.primaries.map(|row| (row[0] * light[0] + row[1] * light[1] + row[2] * light[2]).max(0.0));
    let brightest = light[0].max(light[1]).max(light[2]);
    let shown = pq_decode(rolled_off(hdr, pq_encode(brightest.min(1.0))));
    let factor = if brightest > 0.0 { shown / brightest } else { 0.0 };
    light.map(|v| v * factor)
}

/// The code of the scene light that HLG has for one channel, both 0 .. 1.
pub(crate) fn hlg_encode(light: f32) -> f32 {
    let bright = HLG_A * (12.0 * light - HLG_B).max(1e-6).ln() + HLG_C;
    if light <= 1.0 / 12.0 { (3.0 * light).sqrt() } else { bright }
}

/// PQ codes, 0 .. 1, of light of a film.
pub(crate) fn pq_codes(hdr: &HdrParams, scene: [f32; 3]) -> [f32; 3] {
    display_light(hdr, scene).map(|v| pq_encode(v.min(1.0)).min(1.0))
}

/// HLG codes, 0 .. 1, of light of a film.
pub(crate) fn hlg_codes(hdr: &HdrParams, scene: [f32; 3]) -> [f32; 3] {
    let light = display_light(hdr, scene).map(|v| v / hdr.hlg_peak);
    let [r, g, b] = light;
    // Luminance of Rec. 2020: BT.2100, table 5.
    let luminance = (0.2627 * r + 0.678 * g + 0.0593 * b).max(1e-12);
    let factor = luminance.powf(hdr.hlg_exponent);
    light.map(|v| hlg_encode((v * factor).min(1.0)).min(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn params(paper_white: f64, peak: f64) -> HdrParams {
        HdrParams::new(&Film { paper_white, peak, ..Film::plain() })
    }

    /// Codes of ITU-R BT.2408-7, table 1 (203, 1000 cd/m^2) and of BT.2390 (100, 4000), and the ends.
    #[test]
    fn pq_has_the_published_codes() {
        for (light, code) in [
            (0.0, 0.0),
            (100.0, 0.508_078),
            (203.0, 0.580_689),
            (1000.0, 0.751_827),
            (4000.0, 0.902_572),
            (10_000.0, 1.0),
        ] {
            let got = pq_encode((light / PQ_PEAK) as f32);
            assert!((f64::from(got) - code).abs() < 1e-6, "{light} cd/m^2: {got}, not {code}");
            assert!((f64::from(pq_decode(got)) * PQ_PEAK - light).abs() <= 2e-5 * light, "{light}: and back");
        }
    }

    /// SMPTE ST 2084 and ITU-R BT.2100, table 5, in f64.
    #[test]
    fn codes_are_those_of_the_formulas() {
        let [m1, m2] = [2610.0 / 16384.0, 2523.0 / 32.0_f64];
        let [c1, c2, c3] = [3424.0 / 4096.0, 2413.0 / 128.0, 2392.0 / 128.0_f64];
        for i in 0..=10_000 {
            let light = (i as f32 * 1e-4).powi(3);
            let power = f64::from(light).powf(m1);
            let pq = ((c1 + c2 * power) / (1.0 + c3 * power)).powf(m2);
            let (a, b) = (0.178_832_77_f64, 0.284_668_92);
            let c = 0.5 - a * (4.0 * a).ln();
            let exact = f64::from(light);
            let hlg = if exact <= 1.0 / 12.0 { (3.0 * exact).sqrt() } else { a * (12.0 * exact - b).ln() + c };
            let ours = [pq_encode(light), hlg_encode(light)].map(f64::from);
            assert!((ours[0] - pq).abs() < 1e-6 && (ours[1] - hlg).abs() < 1e-6, "{light}: {ours:?}, not {pq}, {hlg}");
        }
    }

    /// BT.2408: diffuse white is 58 % of PQ; and 75 % of HLG on a display of 1000 cd/m^2.
    #[test]
    fn diffuse_white_is_where_bt_2408_has_it() {
        let white = [1.0; 3];
        // A display whose peak is that of PQ rolls nothing off.
        let pq = pq_codes(&params(203.0, 10_000.0), white);
        let hlg = hlg_codes(&params(203.0, 1000.0), white);
        for c in 0..3 {
            assert!((pq[c] - 0.580_69).abs() < 1e-4 && (hlg[c] - 0.75).abs() < 1e-3, "{pq:?} {hlg:?}");
        }
    }

    /// HLG through its OOTF again: light = peak Y^(gamma - 1) E, with BT.2100's inverse of the curve.
    #[test]
    fn hlg_comes_back_through_its_ootf() {
        for (peak, gamma) in [(1000.0, 1.2), (2000.0, 1.2 * 1.111), (500.0, 1.2 / 1.111)] {
            let hdr = params(100.0, peak);
            for scene in [[0.5, 0.5, 0.5], [1.2, 0.3, 0.1], [0.02, 0.3, 0.9]] {
                let wanted = display_light(&hdr, scene).map(|v| f64::from(v) * PQ_PEAK);
                let (a, b, c) = (0.178_832_77, 0.284_668_92, 0.559_910_73);
                let decode = |v: f64| if v <= 0.5 { v * v / 3.0 } else { (((v - c) / a).exp() + b) / 12.0 };
                let light = hlg_codes(&hdr, scene).map(|v| decode(f64::from(v)));
                let luminance: f64 = 0.2627 * light[0] + 0.678 * light[1] + 0.0593 * light[2];
                for (light, wanted) in light.iter().zip(wanted) {
                    let shown = peak * luminance.powf(gamma - 1.0) * light;
                    assert!((shown / wanted - 1.0).abs() < 1e-4, "{peak}, {scene:?}: {shown}, not {wanted}");
                }
            }
        }
    }

    /// No light beyond the peak, none changed below the knee, brighter light never darker; hues stay.
    #[test]
    fn bright_light_is_rolled_off_to_the_peak() {
        for peak in [100.0, 203.0, 600.0, 1000.0, 4000.0, 10_000.0] {
            let hdr = params(203.0, peak);
            let knee = f64::from(pq_decode(hdr.knee.max(0.0))) * PQ_PEAK / 203.0;
            let mut last = 0.0;
            for i in 0..400 {
                let scene = 1e-3 * 1.05_f64.powi(i);
                let [red, ..] = display_light(&hdr, [scene as f32; 3]);
                let shown = f64::from(red) * PQ_PEAK;
                assert!(shown <= peak * 1.0005 && shown >= last * 0.999_9, "{peak}, {scene}: {shown} after {last}");
                if scene < knee.min(49.0) {
                    assert!((shown / (203.0 * scene) - 1.0).abs() < 1e-3, "{peak}, {scene}: {shown} below the knee");
                }
                last = shown;
            }
            assert!(last > 0.99 * peak, "{peak}: the brightest light shows at {last}");
            let [dim, bright] = [0.01_f32, 100.0].map(|v| display_light(&hdr, [v, 0.4 * v, 0.1 * v]));
            for c in 1..3 {
                assert!((dim[c] / dim[0] - bright[c] / bright[0]).abs() < 1e-4, "{peak}: {dim:?} {bright:?}");
            }
        }
    }

    /// The matrix of ITU-R BT.2087, table 2.
    #[test]
    fn primaries_are_those_of_bt_2087() {
        let wanted = [[0.6274, 0.3293, 0.0433], [0.0691, 0.9195, 0.0114], [0.0164, 0.0880, 0.8956]];
        for (row, wanted) in params(203.0, 1000.0).primaries.iter().zip(wanted) {
            assert!((0..3).all(|c| (row[c] - wanted[c]).abs() < 6e-5), "{row:?}, not {wanted:?}");
        }
    }
}
