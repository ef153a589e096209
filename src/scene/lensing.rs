//! Whether a frame looks its rays up in tables of the eye's lens or integrates each. Decided by scene and frame size alone, so that
//! a frame's bytes never depend on those before it.

use super::{Method, Scene, View};
use crate::physics::lens::critical;
use crate::physics::observer::LocalFrame;

/// Where tables are used; anything but `Auto` is for tests.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LensTables {
    /// In frames large enough to pay for them.
    #[default]
    Auto,
    /// In frames of any size.
    Always,
    Never,
}

/// Pixels times samples that pay for the tables of a spin-0 lens.
const SCHWARZSCHILD_WORTH: u64 = 4096;
/// 1/r .. of eyes whose spin-0 lens is tabulated: at rest, and falling.
const SCHWARZSCHILD_STATIC: std::ops::RangeInclusive<f64> = 2.0005..=1e6;
const SCHWARZSCHILD_RAIN: std::ops::RangeInclusive<f64> = 0.9..=1e6;

/// Pixels times samples that pay for the tables of a spinning hole's lens, which take as long as so many rays or more.
const KERR_WORTH: u64 = 500_000;

/// How the rays of a frame are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lensing {
    /// Each by itself.
    Traced,
    /// In the tables of a spin-0 lens.
    Schwarzschild,
    /// In the tables of a spinning hole's lens, but for those that these leave out.
    Kerr,
}

impl Scene {
    /// How the rays of a frame of `pixels` pixels (the full frame's, of which an image may be a part) are found by an eye at `frame`.
    pub fn lensing(&self, frame: &LocalFrame, pixels: u64) -> Lensing {
        // METRIC looks where no disk is: tables end before.
        if self.quality.method != Method::Auto || self.view == View::Metric {
            return Lensing::Traced;
        }
        let work = pixels.saturating_mul(self.quality.samples_per_pixel.into());
        let pays = |worth: u64| match self.quality.lens_tables {
            LensTables::Auto => work >= worth,
            LensTables::Always => true,
            LensTables::Never => false,
        };
        let range = if frame.rain { SCHWARZSCHILD_RAIN } else { SCHWARZSCHILD_STATIC };
        if frame.a == 0.0 && range.contains(&frame.r) && pays(SCHWARZSCHILD_WORTH) {
            return Lensing::Schwarzschild;
        }
        if frame.a != 0.0 && critical::serves(frame) && pays(KERR_WORTH) {
            return Lensing::Kerr;
        }
        Lensing::Traced
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Quality;
    use glam::DVec3;

    fn lensing(spin: f64, r: f64, pixels: u64, quality: Quality, view: View) -> Lensing {
        let scene = Scene { quality, view, ..Scene::default() };
        scene.lensing(&LocalFrame::new(spin, DVec3::new(r, 0.0, 0.1)).unwrap(), pixels)
    }

    #[test]
    fn tables_serve_where_they_pay_and_can() {
        let auto = Quality::default();
        let light = View::Light;
        assert_eq!(lensing(0.0, 20.0, 4095, auto, light), Lensing::Traced);
        assert_eq!(lensing(0.0, 20.0, 4096, auto, light), Lensing::Schwarzschild);
        assert_eq!(lensing(0.9, 20.0, KERR_WORTH - 1, auto, light), Lensing::Traced);
        assert_eq!(lensing(0.9, 20.0, KERR_WORTH, auto, light), Lensing::Kerr);
        let two = Quality { samples_per_pixel: 2, ..auto };
        assert_eq!(lensing(0.9, 20.0, KERR_WORTH / 2, two, light), Lensing::Kerr);
        let always = Quality { lens_tables: LensTables::Always, ..auto };
        assert_eq!(lensing(0.9, 20.0, 1, always, light), Lensing::Kerr);
        for r in [3.0, 2e5] {
            assert_eq!(lensing(0.9, r, 1, always, light), Lensing::Traced);
        }
        assert_eq!(lensing(0.9, 20.0, 1, always, View::Metric), Lensing::Traced);
        assert_eq!(lensing(0.9, 20.0, 1, Quality { method: Method::Rk4, ..always }, light), Lensing::Traced);
        assert_eq!(
            lensing(0.9, 20.0, u64::MAX, Quality { lens_tables: LensTables::Never, ..auto }, light),
            Lensing::Traced
        );
    }
}
