// SPDX-License-Identifier: MIT OR Apache-2.0
//! Settings of the f64 tracer brought to what f32 can do, and what the tracing kernels are compiled with for them.

use crate::gpu::kernel::variant::TraceVariant;
use crate::physics::observer::LocalFrame;
use crate::physics::trace::Settings;
use crate::scene::{Method, Projection, Scene};

/// f32 rounds at 6e-8; a step's error estimate cannot be trusted below a few times that.
const SMALLEST_TOLERANCE: f64 = 3e-7;
/// Nystrom step in sigma for given rays: truncation stays below rounding.
const RAY_STEP: f64 = 0.2;

/// Settings of the f64 tracer brought to what f32 can do.
pub(in crate::gpu) fn for_f32(settings: Settings) -> Settings {
    Settings { tolerance: settings.tolerance.max(SMALLEST_TOLERANCE), ..settings }
}

pub(in crate::gpu) fn ray_settings(scene: &Scene) -> Settings {
    let mut settings = for_f32(scene.quality.ray_settings(scene.hole.spin));
    if scene.quality.method == Method::Auto {
        settings.step = RAY_STEP;
    }
    settings
}

/// The variant in which the tracing kernels of a scene are compiled; pixels add what their shading needs.
/// `frame`: that of a frame's observer, `None` for given rays.
pub(in crate::gpu) fn variant(scene: &Scene, settings: &Settings, frame: Option<&LocalFrame>) -> TraceVariant {
    let spinning = scene.hole.spin != 0.0;
    TraceVariant {
        method: settings.method.into(),
        spinning,
        delay: settings.delay,
        // Given rays may begin inside the horizon.
        step_limit: spinning || settings.delay || frame.is_none_or(|frame| frame.r <= 2.0),
        rain: spinning && frame.is_some_and(|frame| frame.rain),
        azimuth: false,
        matter: None,
        projection: Some(Projection::Perspective),
    }
}
