// SPDX-License-Identifier: MIT OR Apache-2.0
//! Rays that a host asks for, traced in f64: where each ends, and the curve that it follows.

use super::spread::Spread;
use super::{Fate, Hit, Method, Ray, Scene, Transfer};
use crate::allocate::{collected, filled};
use crate::emit::Emitters;
use crate::emit::along::MediaAlong;
use crate::emit::medium::{Media, Medium};
use crate::emit::volumes::Seen;
use crate::error::{Error, Result};
use crate::physics::trace::{CROSSINGS_KEPT, Settings, path, trace, trace_visited};

/// Traces `ray`.
pub fn trace_ray(scene: &Scene, settings: &Settings, ray: &Ray) -> Hit {
    let Some((frame, start)) = scene.start(ray) else { return Hit { fate: Fate::Invalid, ..Hit::default() } };
    let Some((constants, state)) = start else {
        return Hit { fate: Fate::Captured, sky_redshift: f64::NAN, swept_angle: 0.0, ..Hit::default() };
    };
    let traced = trace(&constants, &state, settings);
    scene.hit(ray, &frame, Some(&constants), &traced)
}

/// A ray takes some 20 microseconds.
const SPREAD: Spread = Spread { at_a_time: 32, a_thread: 128, name: "bhr-rays" };

/// [`trace_ray`] for those of `rays` with the numbers `which`, on as many threads as the machine has cores. Errors:
/// OUT_OF_MEMORY.
pub fn trace_some(scene: &Scene, rays: &[Ray], which: &[usize], hits: &mut [Hit]) -> Result<()> {
    let settings = scene.quality.ray_settings(scene.hole.spin);
    let mut found = filled(which.len(), Hit::default(), "what rays hit")?;
    SPREAD.over(which, &mut found, |index, hit| *hit = trace_ray(scene, &settings, &rays[*index]));
    for (index, hit) in which.iter().zip(found) {
        hits[*index] = hit;
    }
    Ok(())
}

/// The matter with depth along rays as a host asks for them.
pub struct TransferSetup {
    /// The matter as it is seen from the radius `r`.
    emitters: Emitters,
    r: f64,
    settings: Settings,
}

/// The matter with depth along `ray`; thin disk and sky left out.
pub fn transfer_ray(scene: &Scene, setup: &TransferSetup, ray: &Ray) -> Transfer {
    let nothing = Transfer { fate: Fate::Invalid, intensity: f64::NAN, optical_depth: f64::NAN, light: [f64::NAN; 3] };
    let Some((frame, start)) = scene.start(ray) else { return nothing };
    let Some((constants, state)) = start else {
        return Transfer { fate: Fate::Captured, intensity: 0.0, light: [0.0; 3], ..nothing };
    };
    let own = (setup.emitters.volumes.has_structure() && frame.r != setup.r).then(|| emitters_from(scene, frame.r));
    let emitters = own.as_ref().and_then(|own| own.as_ref().ok()).unwrap_or(&setup.emitters);
    let (frequency_ratio, static_observer) = (ray.frequency_ratio, frame.static_observer());
    let seen = Seen { frequency_ratio, static_observer, pixel_angle: 0.0, swept: 0.0, rays: 1, moment: 0.0 };
    let (media, medium) = (Media::new(), Medium::default());
    let mut along = MediaAlong { emitters, seen, plane_u: None, media, medium, limit: None };
    let traced = trace_visited(&constants, &state, &setup.settings, &mut along);
    let Medium { light, depth, intensity, .. } = along.medium;
    let fate = scene.hit(ray, &frame, Some(&constants), &traced).fate;
    Transfer { fate, intensity, light, optical_depth: if fate == Fate::Escaped { depth } else { f64::NAN } }
}

/// The matter with depth as an observer at `r` sees it. Errors: OUT_OF_MEMORY.
fn emitters_from(scene: &Scene, r: f64) -> Result<Emitters> {
    let mut emitters = Emitters { volumes: scene.volumes_now(r), ..Emitters::default() };
    emitters.volumes.ask_structure(scene.hole.spin)?;
    Ok(emitters)
}

/// The setup of `transfer_ray`, which is quicker where all of `rays` begin as far from the hole as the first one. Parts
/// end in the plane, where jets bend. Where delays matter, steps are half as long, which takes the error of a hot
/// spot's light, seen from 1000 M, from 8e-8 of its peak to 8e-9. Errors: OUT_OF_MEMORY.
pub fn transfer_setup(scene: &Scene, rays: &[Ray]) -> Result<TransferSetup> {
    let r = rays.iter().find_map(|ray| scene.start(ray)).map_or(1.0, |(frame, _)| frame.r);
    let emitters = emitters_from(scene, r)?;
    let mut settings = scene.quality.ray_settings(scene.hole.spin);
    settings.delay = emitters.needs().delays;
    settings.max_crossings = CROSSINGS_KEPT;
    if settings.delay && scene.quality.method == Method::Auto {
        settings.step *= 0.5;
    }
    Ok(TransferSetup { emitters, r, settings })
}

/// Most points of a path: more than any plot shows, and bounded memory.
const MAX_PATH: usize = 1 << 16;

/// The curve a ray follows, from the observer: x, y, z, t in scene axes and lengths, t <= 0; `capacity` points at most
/// (65536 in any case), evenly spaced in Mino time, the last one its end: just outside the horizon, or, for a ray that
/// escapes, at ten times the observer's radius, but at least 1000 M. Places and times are those of the camera's chart.
/// Errors: INVALID_ARGUMENT for a ray that is not
/// valid; OUT_OF_MEMORY.
pub fn trace_path(scene: &Scene, ray: &Ray, capacity: usize) -> Result<Vec<[f64; 4]>> {
    let Some((frame, start)) = scene.start(ray) else {
        return Err(Error::argument(
            "ray is not valid: position, direction and frequency_ratio (> 0) must be finite, the direction not zero, \
             and the position one where the camera's chart has observers",
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
