// SPDX-License-Identifier: MIT OR Apache-2.0
//! Whether a frame looks its rays up in tables of the observer's lens or integrates each. Decided by scene and frame
//! size alone, so that a frame's bytes never depend on those before it.

use super::{LensTables, Method, Scene, View};
use crate::physics::lens::critical;
use crate::physics::observer::LocalFrame;

/// Pixels times samples that pay for the tables of a spin-0 lens.
const SCHWARZSCHILD_THRESHOLD: u64 = 4096;
/// r, M, of observers whose spin-0 lens is tabulated: at rest, and falling.
const SCHWARZSCHILD_STATIC: std::ops::RangeInclusive<f64> = 2.0005..=1e6;
const SCHWARZSCHILD_RAIN: std::ops::RangeInclusive<f64> = 0.9..=1e6;

/// Pixels times samples that pay for the tables of a spinning hole's lens on a tracer: as many as it integrates in the
/// time that it builds and reads the tables in. The GPU's are finer than the CPU's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KerrThreshold(u64);

impl KerrThreshold {
    pub const GPU: Self = Self(500_000);
    /// At spin 0.9, r = 30 M building takes as long as 100,000 pixels (115,000 with turbulence) and reading a fifth of
    /// what integration takes; at spin 0.998, r = 8 M a third.
    pub const CPU: Self = Self(140_000);
}

/// |cot theta| of a rain observer below which a frame with a thin disk is traced: the disk's images are narrower than
/// pixels there, and tables would integrate most rays beside them, with other footprints on each tracer.
const RAIN_LAYER: f64 = 0.03;

/// Orders of crossings that tables within 32 MB hold with azimuth and delay (without: four times as many): for all
/// observers, and for those no farther than KERR_NEAR, M.
const KERR_ORDERS: usize = 3;
const KERR_ORDERS_NEAR: usize = 4;
const KERR_NEAR: f64 = 1e4;

/// How the rays of a frame are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lensing {
    /// Each ray is traced by itself.
    Traced,
    /// Rays are looked up in the tables of a spin-0 lens.
    Schwarzschild,
    /// Rays are looked up in the tables of a Kerr lens; those that they do not hold are traced.
    Kerr,
}

impl Scene {
    /// How the rays of a frame of `pixels` pixels (the full frame's, of which an image may be a part) are found by an
    /// observer at `frame`.
    pub fn lensing(&self, frame: &LocalFrame, pixels: u64, kerr_threshold: KerrThreshold) -> Lensing {
        match self.emitters().needs().parts {
            true => Lensing::Traced,
            false => self.lensing_of_sky(frame, pixels, kerr_threshold),
        }
    }

    /// [`Self::lensing`] of a frame whose matter with depth, if it has any, is found by other rays.
    pub fn lensing_of_sky(&self, frame: &LocalFrame, pixels: u64, kerr_threshold: KerrThreshold) -> Lensing {
        let emitters = self.emitters();
        let needs = emitters.needs();
        // METRIC shows places where no disk is; tables end before. They hold no steps, and no headings.
        if self.quality.method != Method::Auto || self.view == View::Metric || needs.headings {
            return Lensing::Traced;
        }
        let work = pixels.saturating_mul(self.quality.samples_per_pixel.into());
        let pays = |worth: u64| match self.quality.lens_tables {
            LensTables::Auto => work >= worth,
            LensTables::Always => true,
            LensTables::Never => false,
        };
        let range = if frame.rain { SCHWARZSCHILD_RAIN } else { SCHWARZSCHILD_STATIC };
        if frame.a == 0.0 && range.contains(&frame.r) && pays(SCHWARZSCHILD_THRESHOLD) {
            return Lensing::Schwarzschild;
        }
        let settings = self.pixel_settings_of(&emitters);
        let layers = settings.max_crossings.div_ceil(if needs.places { 1 } else { 4 });
        let fits = layers <= if frame.r <= KERR_NEAR { KERR_ORDERS_NEAR } else { KERR_ORDERS };
        let edge_on = frame.rain && emitters.plane_u().is_some() && frame.cos.abs() < RAIN_LAYER * frame.sin;
        if frame.a != 0.0 && critical::reaches(frame) && fits && !edge_on && pays(kerr_threshold.0) {
            return Lensing::Kerr;
        }
        Lensing::Traced
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_for_frames_that_pay_for_them() {
        let mut scene = Scene::plain();
        let lensing = |scene: &Scene, pixels| {
            let [cpu, gpu] = [KerrThreshold::CPU, KerrThreshold::GPU]
                .map(|worth| scene.lensing(&scene.observer().unwrap().frame, pixels, worth));
            assert!(cpu == gpu || (cpu, gpu) == (Lensing::Kerr, Lensing::Traced));
            gpu
        };
        assert_eq!(lensing(&scene, SCHWARZSCHILD_THRESHOLD), Lensing::Schwarzschild);
        assert_eq!(lensing(&scene, SCHWARZSCHILD_THRESHOLD - 1), Lensing::Traced);
        scene.hole.spin = 0.9;
        assert_eq!(lensing(&scene, KerrThreshold::GPU.0), Lensing::Kerr);
        assert_eq!(lensing(&scene, KerrThreshold::GPU.0 - 1), Lensing::Traced);
        // Samples count as pixels do.
        scene.quality.samples_per_pixel = 2;
        assert_eq!(lensing(&scene, KerrThreshold::GPU.0 / 2), Lensing::Kerr);
        scene.quality.method = Method::Rk4;
        assert_eq!(lensing(&scene, KerrThreshold::GPU.0), Lensing::Traced);
    }
}
