// SPDX-License-Identifier: MIT OR Apache-2.0
//! A host's ray and quality in the terms of `physics::trace`, and the result of a trace in the host's terms. Both
//! tracers use it.

use super::observer::look_components;
use super::rays::{Crossing, Fate, Hit, MAX_CROSSINGS, Ray};
use super::{Chart, Method, Motion, Quality, Scene, VolumeResolution};
use crate::emit::Emitters;
use crate::emit::half::{Evenness, LEAST_LIGHT, STRUCTURE_TOLERANCE, TOLERANCE};
use crate::physics::geodesic::{Clock, Constants, RAIN_CLOCK_RADIUS, State};
use crate::physics::integrator;
use crate::physics::observer::LocalFrame;
use crate::physics::orbit::{horizon_outer, isco, photon_orbit};
use crate::physics::plunge::Matter;
use crate::physics::trace::{self, RayTrace, Settings};
use crate::sky::StoredMap;
use std::sync::Arc;

/// Step in sigma of the Nystrom method for rays that a host asks for, in f64: errors, divided by (1 + conditioning),
/// of 1e-11.
pub const RAY_STEP: f64 = 0.025;
/// Step in sigma of the Nystrom method for pixels, in f64 and f32: measured 3e-7 for 99 % of sky directions and 7e-7
/// for crossing radii, at most 1e-5; a pixel of a 3840 x 2160 frame is 5e-4 wide.
pub const PIXEL_STEP: f64 = 0.25;
/// The step of pixels that show the sky alone, in Doran's chart about a spinning hole. Measured from just above r- to
/// 2.95 M at spins to 0.998, with errors counted against how much directions change with the look: half are within
/// 1e-6, and 99 % within 1e-4. A pixel of a 3840 x 2160 frame is 2e-4 to 5e-4 wide.
pub const SKY_STEP: f64 = 0.35;

impl Quality {
    /// The settings of the f64 tracer for rays that a host asks for.
    pub fn ray_settings(&self, spin: f64) -> Settings {
        let (method, step) = match self.method {
            Method::Auto => (integrator::Method::Nystrom, RAY_STEP),
            Method::Rk4 => (integrator::Method::Rk4, self.rk4_step()),
            Method::Adaptive => (integrator::Method::DormandPrince, 0.1),
        };
        Settings {
            method,
            step,
            tolerance: self.adaptive_tolerance(),
            max_steps: self.max_steps,
            max_crossings: MAX_CROSSINGS,
            delay: true,
            capture_u: 1.0 / horizon_outer(spin),
            opaque_u: None,
        }
    }
}

impl Scene {
    /// The settings of the f64 tracer for pixels.
    pub fn pixel_settings(&self) -> Settings {
        self.pixel_settings_of(&self.emitters())
    }

    /// [`Self::pixel_settings`] for callers that have [`Self::emitters`] at hand, which take a while to make.
    pub fn pixel_settings_of(&self, emitters: &Emitters) -> Settings {
        let mut settings = self.quality.ray_settings(self.hole.spin);
        if self.quality.method == Method::Auto {
            let sky_alone = emitters.plane_u().is_none() && !emitters.needs().parts;
            settings.step = if sky_alone && self.traces_dorans_chart() { SKY_STEP } else { PIXEL_STEP };
        }
        settings.max_crossings = self.quality.max_disk_order as usize + 1;
        settings.delay = emitters.needs().delays;
        settings.capture_u = self.pixel_capture_u(emitters);
        settings.opaque_u = emitters.opaque_u().filter(|_| self.view == super::View::Light);
        settings
    }

    /// Whether pixels are traced in Doran's chart about a spinning hole.
    fn traces_dorans_chart(&self) -> bool {
        let (hole, camera) = (&self.hole, &self.camera);
        let rests = matches!(camera.motion, Motion::Static | Motion::Orbit);
        let r = camera.position.length() / hole.mass;
        hole.spin != 0.0 && camera.chart == Chart::Rain && !rests && r <= RAIN_CLOCK_RADIUS
    }

    pub fn shows_stars(&self) -> bool {
        self.sky.star_field().is_some() && self.sky.stars_brightness > 0.0
    }

    pub fn shows_milky_way(&self) -> bool {
        self.sky.flags & super::Sky::MILKY_WAY != 0 && self.sky.map_brightness > 0.0
    }

    /// The host's map, where it is to be seen.
    pub fn shown_map(&self) -> Option<&Arc<StoredMap>> {
        self.sky_map.as_ref().filter(|_| self.asks_for_map())
    }

    /// The picture on the tracer's device, where it is to be seen.
    pub fn shown_picture(&self) -> Option<&super::SkyPicture> {
        self.sky_picture.as_ref().filter(|_| self.asks_for_map())
    }

    fn asks_for_map(&self) -> bool {
        self.sky.flags & super::Sky::MAP != 0 && self.sky.map_brightness > 0.0
    }

    /// Whether the host's map is to be seen, wherever it is.
    pub fn shows_map(&self) -> bool {
        self.shown_map().is_some() || self.shown_picture().is_some()
    }

    pub fn shows_grid(&self) -> bool {
        self.sky.flags & super::Sky::GRID != 0
    }

    /// Whether anything is to be seen in the sky.
    pub fn shows_sky(&self) -> bool {
        self.shows_stars() || self.shows_milky_way() || self.shows_map() || self.shows_grid()
    }

    /// Whether pixels that edges run through are refined: there is an edge to see only where something shines, or where
    /// a `transparent` picture tells the hole from the sky.
    pub fn refines(&self, transparent: bool) -> bool {
        let emitters = self.emitters();
        let shines = emitters.plane_u().is_some() || emitters.needs().parts;
        let shows = shines || transparent || self.shows_sky();
        self.view == super::View::Light && self.quality.refines && shows
    }

    /// The rule by which pixels get their matter with depth from blocks. `None`: each sums its own.
    pub fn half_resolution(&self) -> Option<Evenness> {
        // Blocks do not know where the edges of the host's things run.
        let half = self.quality.volume_resolution == VolumeResolution::Half && self.occluder.is_none();
        let half = half && !self.shown_volumes().is_empty();
        let structured = self.volumes.iter().any(|volume| volume.turbulence > 0.0);
        let tolerance = if structured { STRUCTURE_TOLERANCE } else { TOLERANCE };
        // Light that the film shows as white is 1 after exposure.
        let light = Evenness::Light { least: LEAST_LIGHT * (-self.film.exposure_ev).exp2(), tolerance };
        half.then_some(if self.view == super::View::Light { light } else { Evenness::Depth { tolerance } })
    }

    /// Steps a ray of a pixel takes on average, for planning, or what takes as long: sigma runs to about 6.
    pub fn expected_steps(&self) -> u64 {
        let settings = self.pixel_settings();
        let steps = match self.quality.method {
            // A rejected step costs as much, and each has seven evaluations.
            Method::Adaptive => 60,
            _ => (6.0 / settings.step).ceil() as u64,
        };
        // Each volume or spot costs as much as some eighty steps more, structure as much as 140 on top (H100; a thick
        // disk half as much again).
        let structured = self.volumes.iter().filter(|volume| volume.turbulence > 0.0).count();
        let matter = 80 * (self.volumes.len() + self.hot_spots.len()) as u64 + 140 * structured as u64;
        let steps = steps.clamp(1, settings.max_steps.into());
        match self.half_resolution() {
            None => steps + matter,
            // A quarter as many rays of blocks, and about as many of pixels.
            Some(_) => steps + (steps + matter) / 2,
        }
    }

    /// 1/r beyond which an inward ray of a pixel is captured. No ray turns back outside the horizon below the prograde
    /// photon orbit; only METRIC, plunging matter, which shines down to `plane_u`, and matter with depth look deeper.
    fn pixel_capture_u(&self, emitters: &Emitters) -> f64 {
        let spin = self.hole.spin;
        if self.view == super::View::Metric {
            return 1.0 / horizon_outer(spin);
        }
        // The margin is 1 %: an observer on the photon orbit itself still sees its rays leave.
        let turning = 1.0 / (0.99 * photon_orbit(spin.abs())).max(horizon_outer(spin));
        let innermost = |u: Option<[f64; 2]>| u.map_or(turning, |[_, inner]| inner.max(turning));
        innermost(emitters.plane_u()).max(innermost(emitters.depth_u())).min(1.0 / horizon_outer(spin))
    }

    /// The start of a host's ray; `None` when it is not valid. The inner `None`: captured at once
    /// (`LocalFrame::start`).
    pub fn start(&self, ray: &Ray) -> Option<(LocalFrame, Option<(Constants, State)>)> {
        if !(ray.frequency_ratio > 0.0 && ray.frequency_ratio.is_finite() && ray.position.is_finite()) {
            return None;
        }
        let frame = self.frame_of_rays(ray.position).ok()?;
        let n = look_components(self, &frame, ray.direction)?;
        let mut start = frame.start(n);
        // Without spin far observers' rays would be told by t.
        if let (Chart::Rain, Some((constants, _))) = (self.camera.chart, &mut start) {
            constants.clock = Clock::Rain;
        }
        Some((frame, start))
    }

    /// Whether the disk's matter, or without a disk any matter a redshift is asked for, orbits towards -ph.
    pub fn retrograde(&self) -> bool {
        self.disk.is_some_and(|d| d.retrograde)
    }

    /// Spin as the disk's matter meets it: its own sense of motion is +ph.
    pub fn matter_spin(&self) -> f64 {
        if self.retrograde() { -self.hole.spin } else { self.hole.spin }
    }

    /// The motion of the disk's matter, or without a disk of matter on prograde orbits.
    pub fn matter(&self) -> Matter {
        Matter::new(self.hole.spin, self.retrograde(), self.disk.is_some_and(|d| d.plunges))
    }

    /// ISCO of the disk's matter, M.
    pub fn disk_isco(&self) -> f64 {
        isco(self.matter_spin())
    }

    /// The host's view of a finished trace.
    pub fn hit(&self, ray: &Ray, frame: &LocalFrame, constants: Option<&Constants>, traced: &RayTrace) -> Hit {
        let mut hit = Hit {
            fate: match traced.fate {
                trace::Fate::Captured => Fate::Captured,
                trace::Fate::Escaped => Fate::Escaped,
                // A host's rays see nothing as opaque, so none is hidden.
                trace::Fate::Unresolved | trace::Fate::Hidden => Fate::Unresolved,
            },
            sky_direction: self.hole.scene_to_chart().transpose() * traced.direction,
            sky_redshift: f64::NAN,
            swept_angle: traced.swept,
            steps: traced.steps,
            ..Hit::default()
        };
        let Some(c) = constants else { return hit };
        if hit.fate == Fate::Escaped {
            hit.sky_redshift = ray.frequency_ratio * c.nu_local / c.energy;
        }
        let (matter, mass) = (self.matter(), self.hole.mass);
        for (out, crossing) in hit.crossings.iter_mut().zip(&traced.crossings) {
            *out = Crossing {
                radius: mass / crossing.u,
                azimuth: crossing.azimuth,
                redshift: ray.frequency_ratio * crossing.redshift(c, &matter),
                delay: if frame.rain && self.camera.chart == Chart::Static { f64::NAN } else { mass * crossing.delay },
            };
        }
        hit.crossing_count = traced.crossings.len().min(MAX_CROSSINGS) as u32;
        hit
    }
}
