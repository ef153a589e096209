// SPDX-License-Identifier: MIT OR Apache-2.0
//! Rays that a host asks for, traced in f64: where each ends, and the curve that it follows.

use super::{Fate, Hit, Ray, Scene};
use crate::allocate::collected;
use crate::error::{Error, Result};
use crate::physics::trace::{Settings, path, trace};

/// Traces `ray`.
pub fn trace_ray(scene: &Scene, settings: &Settings, ray: &Ray) -> Hit {
    let Some((frame, start)) = scene.start(ray) else { return Hit { fate: Fate::Invalid, ..Hit::default() } };
    let Some((constants, state)) = start else {
        return Hit { fate: Fate::Captured, sky_redshift: f64::NAN, swept_angle: 0.0, ..Hit::default() };
    };
    let traced = trace(&constants, &state, settings);
    scene.hit(ray, &frame, Some(&constants), &traced)
}

/// Most points of a path: more than any plot shows, and bounded memory.
const MAX_PATH: usize = 1 << 16;

/// The curve a ray follows, from the observer: x, y, z, t in scene axes and lengths, t <= 0; `capacity` points at most
/// (65536 in any case), evenly spaced in Mino time, the last one its end: just outside the horizon, or, for a ray that
/// escapes, at ten times the observer's radius, but at least 1000 M. Errors: INVALID_ARGUMENT for a ray that is not
/// valid; OUT_OF_MEMORY.
pub fn trace_path(scene: &Scene, ray: &Ray, capacity: usize) -> Result<Vec<[f64; 4]>> {
    let Some((frame, start)) = scene.start(ray) else {
        return Err(Error::argument(
            "ray is not valid: position, direction and frequency_ratio (> 0) must be finite, the direction not zero, \
             and the position outside a spinning hole's horizon",
        ));
    };
    let observer = ray.position;
    let Some((constants, state)) = start else { return Ok(vec![[observer.x, observer.y, observer.z, 0.0]]) };
    let settings = scene.quality.ray_settings(scene.hole.spin);
    let far = (10.0 * frame.r).max(1000.0);
    let to_scene = scene.hole.scene_to_chart().transpose();
    let points = path(&constants, &state, &settings, far, capacity.min(MAX_PATH))?.into_iter().map(|p| {
        let place = to_scene * p.position * scene.hole.mass;
        [place.x, place.y, place.z, -p.delay * scene.hole.mass]
    });
    collected(points, "the points of a path")
}
