// SPDX-License-Identifier: MIT OR Apache-2.0
//! The settings that decide how exactly rays are traced, as the host states them.

use crate::error::{Error, Number, Result};

/// The frames in which tables are used; anything but `Auto` is for tests.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LensTables {
    /// In frames large enough to pay for them.
    #[default]
    Auto,
    /// In frames of any size.
    Always,
    Never,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Method {
    /// The fastest that meets the stated accuracy (Nystrom, order 5).
    Auto = 0,
    /// Fixed-step classic fourth-order Runge-Kutta.
    Rk4 = 1,
    /// Embedded Runge-Kutta 5(4) with error control.
    Adaptive = 2,
}

/// The rays that matter with depth is summed along (`BHR_VOLUME_RESOLUTION_*`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum VolumeResolution {
    /// Matter is summed along the rays of all pixels.
    Full = 0,
    /// Matter is summed along one ray of each block of 2 x 2 pixels, and along those of pixels that blocks do not tell
    /// (`emit::half`).
    Half = 1,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    pub method: Method,
    /// 1 (default) .. 256.
    pub samples_per_pixel: u32,
    /// Per ray, 16 .. 100000. Default 2000. A ray that needs more is unresolved.
    pub max_steps: u32,
    /// RK4, in sigma = S tau: 1e-3 .. 0.5; 0: the default, 0.1.
    pub step: f64,
    /// ADAPTIVE, relative: 1e-14 .. 1e-3; 0: the default, 1e-10.
    pub tolerance: f64,
    /// Images of the disk to follow: 0 direct only .. 15. Default 3.
    pub max_disk_order: u32,
    /// Windows: traced size / window size, 0.1 .. 1. Default 1.
    pub render_scale: f64,
    /// Default `Full`.
    pub volume_resolution: VolumeResolution,
    /// Whether AUTO looks rays up. The host cannot choose this.
    #[doc(hidden)]
    pub lens_tables: LensTables,
    /// Whether a GPU writes pixels into the host's memory itself; `None`: where that is faster. The host cannot choose
    /// this.
    #[doc(hidden)]
    pub mapped_pixels: Option<bool>,
    /// Whether one kernel serves all projections, pixel formats and tone maps but the usual ones; `None`: on hardware.
    /// Not the host's to choose.
    #[doc(hidden)]
    pub shares_kernels: Option<bool>,
    /// Whether kernels of likely next scenes are made in the background; `None`: on hardware, because software drivers
    /// put most of their work off until a kernel runs. The host cannot choose this.
    #[doc(hidden)]
    pub anticipates: Option<bool>,
    /// Whether pixels that edges run through get more rays. The host cannot choose this.
    #[doc(hidden)]
    pub refines: bool,
    /// Whether pixels that edges run through are found, but get no more rays yet: for a page's first picture, while the
    /// kernel that traces these is made. The host cannot choose this.
    #[doc(hidden)]
    pub edges_later: bool,
    /// Whether a frame with bloom keeps its light instead of being traced twice; `None`: as its size allows. The host
    /// cannot choose this.
    #[doc(hidden)]
    pub keep_light: Option<bool>,
    /// Whether a GPU's sampler filters sky maps; `None`: on hardware. The host cannot choose this.
    #[doc(hidden)]
    pub map_sampler: Option<bool>,
}

impl Default for Quality {
    fn default() -> Self {
        Self {
            method: Method::Auto,
            samples_per_pixel: 1,
            max_steps: 2000,
            step: 0.0,
            tolerance: 0.0,
            max_disk_order: 3,
            render_scale: 1.0,
            volume_resolution: VolumeResolution::Full,
            lens_tables: LensTables::Auto,
            mapped_pixels: None,
            shares_kernels: None,
            anticipates: None,
            refines: true,
            edges_later: false,
            keep_light: None,
            map_sampler: None,
        }
    }
}

impl Quality {
    pub const DEFAULT_STEP: f64 = 0.1;
    pub const DEFAULT_TOLERANCE: f64 = 1e-10;
    pub const MAX_DISK_ORDER: u32 = 15;

    /// Errors: a value outside its range.
    pub fn check(&self) -> Result<()> {
        let bad = |name: &str, value: f64, range: &str| {
            Err(Error::argument(format!("quality {name} is {}; it must lie in {range}", Number(value))))
        };
        if !(1..=256).contains(&self.samples_per_pixel) {
            return bad("samples_per_pixel", self.samples_per_pixel.into(), "[1, 256]");
        }
        if !(16..=100_000).contains(&self.max_steps) {
            return bad("max_steps", self.max_steps.into(), "[16, 100000]");
        }
        if self.step != 0.0 && !(1e-3..=0.5).contains(&self.step) {
            return bad("step", self.step, "[0.001, 0.5], or be 0 for the default");
        }
        if self.tolerance != 0.0 && !(1e-14..=1e-3).contains(&self.tolerance) {
            return bad("tolerance", self.tolerance, "[1e-14, 1e-3], or be 0 for the default");
        }
        if self.max_disk_order > Self::MAX_DISK_ORDER {
            return bad("max_disk_order", self.max_disk_order.into(), "[0, 15]");
        }
        if !(0.1..=1.0).contains(&self.render_scale) {
            return bad("render_scale", self.render_scale, "[0.1, 1]");
        }
        Ok(())
    }

    /// `step`, or its default.
    pub fn rk4_step(&self) -> f64 {
        if self.step == 0.0 { Self::DEFAULT_STEP } else { self.step }
    }

    /// `tolerance`, or its default.
    pub fn adaptive_tolerance(&self) -> f64 {
        if self.tolerance == 0.0 { Self::DEFAULT_TOLERANCE } else { self.tolerance }
    }
}
