// SPDX-License-Identifier: MIT OR Apache-2.0
//! Questions a host asks of a scene that need no tracer: numbers about the hole, camera rays, the camera's world line.

use super::bodies::FASTEST;
use super::chart::Chart;
use super::frame::Region;
use super::observer::Lens;
use super::{Camera, Motion, Ray, Scene, Transport};
use crate::error::{Error, Number, Result};
use crate::physics::geodesic::{Clock, rain_offset};
use crate::physics::metric::{Kerr, boyer_lindquist};
use crate::physics::observer::{LocalFrame, Observer};
use crate::physics::orbit::{circular_orbit, ergosphere, horizon_inner, horizon_outer, isco, photon_orbit};
use crate::physics::shadow::{CRITICAL_IMPACT_PARAMETER, shadow};
use crate::physics::world_line::{Body, End, Event, world_line};
use glam::{DQuat, DVec3};

/// Farthest pixel position that `camera_ray` takes.
const MAX_PIXEL: f64 = 1e9;

/// Lengths in scene units; NaN where not defined. Field by field `BhrHoleInfo`.
#[derive(Clone, Copy, Debug)]
pub struct HoleInfo {
    pub horizon_radius: f64,
    /// 0 without spin.
    pub inner_horizon_radius: f64,
    pub ergosphere_equatorial_radius: f64,
    pub photon_orbit_prograde: f64,
    pub photon_orbit_retrograde: f64,
    /// ISCOs of matter that moves towards +ph and -ph.
    pub isco_prograde: f64,
    pub isco_retrograde: f64,
    /// Critical impact parameter, 3 sqrt(3) M, without spin.
    pub critical_impact_parameter: f64,
    /// Angular radius of the shadow that the camera's observer sees, without spin.
    pub shadow_angular_radius: f64,
    pub camera_radius: f64,
    /// d tau / d t of the camera's observer, t being the time of the camera's chart.
    pub camera_time_rate: f64,
}

impl Scene {
    /// Numbers about the hole and the camera's observer; where the camera cannot be, its numbers are NaN.
    pub fn hole_info(&self) -> Result<HoleInfo> {
        let (m, a) = (self.hole.mass, self.hole.spin);
        let observer = self.observer().ok();
        let spinless = a == 0.0;
        Ok(HoleInfo {
            horizon_radius: m * horizon_outer(a),
            inner_horizon_radius: m * horizon_inner(a),
            ergosphere_equatorial_radius: m * ergosphere(a, std::f64::consts::FRAC_PI_2),
            photon_orbit_prograde: m * photon_orbit(a),
            photon_orbit_retrograde: m * photon_orbit(-a),
            isco_prograde: m * isco(a),
            isco_retrograde: m * isco(-a),
            critical_impact_parameter: if spinless { m * CRITICAL_IMPACT_PARAMETER } else { f64::NAN },
            shadow_angular_radius: observer.filter(|_| spinless).map_or(f64::NAN, |o| shadow(&o).radius),
            camera_radius: self.camera.position.x.hypot(self.camera.position.y).hypot(self.camera.position.z),
            camera_time_rate: observer.map_or(f64::NAN, |o| self.time_rate(&o)),
        })
    }

    /// By rain time, clocks that rest in the rain frame run at 1; t and rain time run alike where r stays.
    fn time_rate(&self, observer: &Observer) -> f64 {
        let velocity = self.camera.velocity;
        match (self.camera.chart, self.camera.motion) {
            (Chart::Rain, Motion::FreeFall) => 1.0,
            (Chart::Rain, Motion::Velocity) => (1.0 - velocity.length_squared()).max(0.0).sqrt(),
            _ => observer.time_rate(),
        }
    }

    /// (r / M, theta) of a place. Errors: INVALID_ARGUMENT not finite, at r = 0, on the horizon.
    fn place(&self, position: DVec3) -> Result<(f64, f64)> {
        let a = self.hole.spin;
        let (r, theta, _) = boyer_lindquist(self.hole.scene_to_chart() * position / self.hole.mass);
        if !(r > 0.0 && r.is_finite()) {
            return Err(Error::argument(format!(
                "position ({}, {}, {}) must be finite and not the hole's centre",
                Number(position.x),
                Number(position.y),
                Number(position.z)
            )));
        }
        for (name, horizon) in [("outer", horizon_outer(a)), ("inner", horizon_inner(a))] {
            if (r - horizon).abs() <= 4.0 * f64::EPSILON * r {
                return Err(Error::argument(format!(
                    "position is on the {name} horizon, r = {} M, where Boyer-Lindquist components are infinite",
                    Number(r)
                )));
            }
        }
        Ok((r, theta))
    }

    /// g_ab at `position` (scene axes), Boyer-Lindquist (t, r, th, ph), [4 a + b].
    /// Errors: INVALID_ARGUMENT not finite, at r = 0, on the horizon.
    pub fn metric_at(&self, position: DVec3) -> Result<[f64; 16]> {
        let (r, theta) = self.place(position)?;
        let g = Kerr { a: self.hole.spin }.metric(r, theta);
        finite(std::array::from_fn(|i| g[i / 4][i % 4] * self.hole.mass.powi(angles(&[i / 4, i % 4]))))
    }

    /// Gamma^a_bc at `position`, [16 a + 4 b + c]. Errors: as `metric_at`, and on the axis.
    pub fn christoffel_at(&self, position: DVec3) -> Result<[f64; 64]> {
        let (r, theta) = self.place(position)?;
        let chart = self.hole.scene_to_chart() * position;
        if chart.x == 0.0 && chart.y == 0.0 {
            return Err(Error::argument(
                "position is on the spin axis, where Christoffel symbols with ph are infinite",
            ));
        }
        let gamma = Kerr { a: self.hole.spin }.christoffel(r, theta);
        finite(std::array::from_fn(|i| {
            let (up, b, c) = (i / 16, i / 4 % 4, i % 4);
            // In lengths M^(1 - 1 - 1) per coordinate t, r below and above; an angle takes away one length each.
            gamma[up][b][c] * self.hole.mass.powi(angles(&[b, c]) - angles(&[up]) - 1)
        }))
    }

    /// The ray through pixel position (x, y) of a width x height image that is `region` of a frame (`None`: the whole).
    /// Errors: INVALID_ARGUMENT sizes, region overrun, x or y not finite; INVALID_STATE / UNSUPPORTED where the camera
    /// cannot be.
    pub fn camera_ray(&self, width: u32, height: u32, region: Option<Region>, x: f64, y: f64) -> Result<Ray> {
        if !(x.abs() <= MAX_PIXEL && y.abs() <= MAX_PIXEL) {
            let (x, y) = (Number(x), Number(y));
            return Err(Error::argument(format!("pixel position ({x}, {y}) must lie within +-{MAX_PIXEL:e}")));
        }
        let full_width = region.map_or(width, |region| region.full_width);
        let column = x + f64::from(region.map_or(0, |region| region.x));
        let by_eye = self.seen_by_eye(column, full_width.max(1))?;
        let scene = by_eye.as_ref().unwrap_or(self);
        let (pixel_rays, region) = scene.pixel_rays(width, height, region)?;
        Ok(pixel_rays.ray(scene, x + f64::from(region.x), y + f64::from(region.y)))
    }

    /// Rays through all pixel centres of the image, row by row, handed to `write(index, ray)`. Errors: as `camera_ray`.
    pub fn camera_rays(
        &self,
        width: u32,
        height: u32,
        region: Option<Region>,
        write: &mut dyn FnMut(usize, Ray),
    ) -> Result<()> {
        let (pixel_rays, region) = self.pixel_rays(width, height, region)?;
        if self.camera.is_omnistereo() {
            for x in 0..width {
                let column = f64::from(region.x + x) + 0.5;
                let by_eye = self.seen_by_eye(column, region.full_width.max(1))?;
                let scene = by_eye.as_ref().unwrap_or(self);
                let (pixel_rays, _) = scene.pixel_rays(width, height, Some(region))?;
                for y in 0..height {
                    let index = y as usize * width as usize + x as usize;
                    write(index, pixel_rays.ray(scene, column, f64::from(region.y + y) + 0.5));
                }
            }
            return Ok(());
        }
        for y in 0..height {
            for x in 0..width {
                let (px, py) = (f64::from(region.x + x) + 0.5, f64::from(region.y + y) + 0.5);
                write(y as usize * width as usize + x as usize, pixel_rays.ray(self, px, py));
            }
        }
        Ok(())
    }

    pub(super) fn pixel_rays(&self, width: u32, height: u32, region: Option<Region>) -> Result<(PixelRays, Region)> {
        let region = image_region(width, height, region)?;
        Ok((self.pixel_rays_of(self.lens(&region)?)?, region))
    }

    /// Rays as hosts have them, through a lens of the camera's.
    pub(super) fn pixel_rays_of(&self, lens: Lens) -> Result<PixelRays> {
        let frame = lens.observer.frame;
        if self.camera.chart == Chart::Rain {
            let restated = (!frame.rain).then(|| {
                let rain = Observer::rain_against(frame);
                Observer { beta: -rain.beta, ..rain }
            });
            return Ok(PixelRays { lens, aberration: lens.observer, restated });
        }
        // Outside the horizon a ray is stated in the static frame, whatever frame the tracers prefer.
        let aberration = if frame.rain && frame.r > horizon_outer(self.hole.spin) {
            let static_frame = self.local_frame(self.camera.position)?;
            Observer::moving(static_frame, DVec3::new(-(2.0 / frame.r).sqrt(), 0.0, 0.0))
        } else {
            lens.observer
        };
        Ok(PixelRays { lens, aberration, restated: None })
    }

    /// `camera` moved along its own world line by `proper_time` (scene lengths, any sign), and the scene time that
    /// went by: by the clock of the end (`Scene::time`) less that of the begin. In the chart STATIC that is proper time
    /// for a fall inside the horizon of a hole without spin.
    ///
    /// ORBIT follows the geodesic: at spin 0 and off the plane the great circle along +ph, position and axes turned
    /// together. VELOCITY is a body in free fall. Errors: as `observer` for where the camera is; INVALID_STATE when the
    /// world line ends before (in the singularity, above the inner horizon or, in the chart STATIC, at the horizon);
    /// INVALID_ARGUMENT for a `proper_time` not finite; UNSUPPORTED for a STATIC camera with PARALLEL axes, and as
    /// `world_line`.
    pub fn advance_camera(&self, camera: &Camera, proper_time: f64) -> Result<(Camera, f64)> {
        if !proper_time.is_finite() {
            return Err(Error::argument(format!("proper_time is {}; it must be finite", Number(proper_time))));
        }
        camera.check()?;
        let viewpoint = self.viewpoint_of(camera)?;
        let (observer, place) = (viewpoint.observer, viewpoint.place);
        let (tau, spin) = (proper_time / self.hole.mass, self.hole.spin);
        let parallel = camera.transport == Transport::Parallel;
        match camera.motion {
            Motion::Static if parallel => Err(Error::unsupported(
                "camera transport PARALLEL needs a world line in free fall; a STATIC camera's is none",
            )),
            _ if proper_time == 0.0 => Ok((*camera, 0.0)),
            Motion::Static => Ok((*camera, proper_time / observer.time_rate())),
            Motion::Orbit => {
                let orbit = circular_orbit(spin, observer.frame.r)
                    .ok_or_else(|| Error::internal("an orbiting observer without orbit"))?;
                let axis = place.e_r.cross(place.e_phi);
                let angle = orbit.angular_velocity * orbit.ut * tau;
                let mut carried = *camera;
                if parallel {
                    // How axes turn against the triad does not depend on the azimuth, nor without spin on the latitude.
                    let position = DVec3::new(place.r, 0.0, 0.0);
                    let body = Body { clock: Clock::Coordinate, position, velocity: observer.beta, time: 0.0 };
                    let event = self.fall(&body, self.axes_at(camera, &place), tau)?;
                    [carried.forward, carried.up] = self.axes_of(&place, &event.axes);
                }
                Ok((self.turned(&carried, axis, angle), proper_time * orbit.ut))
            }
            Motion::FreeFall if spin == 0.0 => {
                let fall = fall_schwarzschild(place.r, tau)?;
                let time = if camera.chart == Chart::Rain { tau } else { fall.time };
                let position = camera.position * (fall.radius / place.r);
                Ok((Camera { position, ..*camera }, time * self.hole.mass))
            }
            Motion::FreeFall | Motion::Velocity => {
                let velocity = match (camera.motion, camera.chart) {
                    (Motion::FreeFall, Chart::Rain) => DVec3::ZERO,
                    (_, Chart::Rain) => place.components(self.hole.scene_to_chart() * camera.velocity),
                    (_, Chart::Static) => observer.beta,
                };
                let (clock, position) = (camera.chart.clock(), place.e_r * place.r);
                let axes = self.axes_at(camera, &place);
                let event = self.fall(&Body { clock, position, velocity, time: 0.0 }, axes, tau)?;
                let there = match camera.chart {
                    Chart::Rain => LocalFrame::rain(spin, event.body.position)?,
                    Chart::Static => LocalFrame::new(spin, event.body.position)
                        .map_err(|why| Error::internal(format!("a body outside the horizon has no frame: {why:?}")))?,
                };
                let [forward, up] = self.axes_of(&there, if parallel { &event.axes } else { &axes });
                let to_scene = self.hole.scene_to_chart().transpose();
                let velocity = match camera.motion {
                    Motion::Velocity => (to_scene * there.vector(event.body.velocity)).clamp_length_max(FASTEST),
                    _ => camera.velocity,
                };
                let position = to_scene * event.body.position * self.hole.mass;
                Ok((Camera { position, forward, up, velocity, ..*camera }, event.body.time * self.hole.mass))
            }
        }
    }

    /// A camera's forward and up, and no third axis, along the triad of `place`.
    fn axes_at(&self, camera: &Camera, place: &LocalFrame) -> [DVec3; 3] {
        let along = |axis| place.components(self.hole.scene_to_chart() * axis);
        [along(camera.forward), along(camera.up), DVec3::ZERO]
    }

    /// The forward and up of which these are the components along the triad of `place`.
    fn axes_of(&self, place: &LocalFrame, axes: &[DVec3; 3]) -> [DVec3; 2] {
        [axes[0], axes[1]].map(|axis| self.hole.scene_to_chart().transpose() * place.vector(axis))
    }

    /// A body in free fall, and axes that it carries along, after the proper time `tau`, M. Errors: as
    /// `advance_camera`.
    fn fall(&self, body: &Body, axes: [DVec3; 3], tau: f64) -> Result<Event> {
        let a = self.hole.spin;
        let events = world_line(a, body, &axes, &[tau])?;
        let event = *events.first().ok_or_else(|| Error::internal("a world line without its event"))?;
        if let Some(end) = event.end {
            let (tau, reached, r) = (Number(tau), Number(event.proper_time), Number(event.body.position.length()));
            let why = match end {
                End::Horizon => "the horizon, beyond which the chart BHR_CHART_STATIC does not reach",
                End::InnerHorizon if a == 0.0 => "the singularity",
                End::InnerHorizon => "the inner horizon",
            };
            return Err(Error::state(format!(
                "the camera comes to {why}, at r = {r} M, after proper time {reached} M; {tau} M were asked for"
            )));
        }
        Ok(event)
    }

    /// `camera` with position and axes turned about a chart axis through the hole.
    fn turned(&self, camera: &Camera, chart_axis: DVec3, angle: f64) -> Camera {
        if angle == 0.0 {
            return *camera;
        }
        let axis = (self.hole.scene_to_chart().transpose() * chart_axis).normalize();
        let turn = DQuat::from_axis_angle(axis, angle % std::f64::consts::TAU);
        Camera { position: turn * camera.position, forward: turn * camera.forward, up: turn * camera.up, ..*camera }
    }
}

/// Errors: INVALID_ARGUMENT where a component is beyond the range of doubles.
fn finite<const N: usize>(components: [f64; N]) -> Result<[f64; N]> {
    if components.iter().all(|v| v.is_finite()) {
        return Ok(components);
    }
    Err(Error::argument("position and mass are so large or small that a component is not finite"))
}

/// The number of angles among the Boyer-Lindquist indices: each carries one length.
fn angles(indices: &[usize]) -> i32 {
    indices.iter().filter(|&&i| i >= 2).count() as i32
}

/// The region that a `width` x `height` image is, of itself without one. Errors: INVALID_ARGUMENT for a side of 0, and
/// as `Region::check_image`.
pub(super) fn image_region(width: u32, height: u32, region: Option<Region>) -> Result<Region> {
    let region = region.unwrap_or(Region { full_width: width, full_height: height, x: 0, y: 0 });
    if width == 0 || height == 0 {
        return Err(Error::argument(format!("image is {width} x {height}; each side must be at least 1")));
    }
    region.check_image(width, height)?;
    Ok(region)
}

/// The camera's lens and the boosts into the frame in which its rays are stated.
#[derive(Clone, Copy, Debug)]
pub(super) struct PixelRays {
    pub(super) lens: Lens,
    pub(super) aberration: Observer,
    /// From there into the rain frame, where rays are stated in it and tracers do not.
    pub(super) restated: Option<Observer>,
}

impl PixelRays {
    fn ray(&self, scene: &Scene, x: f64, y: f64) -> Ray {
        if !self.lens.mapping.has_look_direction(x, y) {
            return Ray { position: scene.camera.position, direction: DVec3::ZERO, frequency_ratio: 1.0 };
        }
        let (n, ratio) = self.aberration.aberrate(self.lens.look_direction(x, y));
        self.stated(scene, n, ratio)
    }

    /// The ray in the direction `n` of `aberration`'s frame, as a host has it; `ratio`: nu(camera) / nu(that frame).
    pub(super) fn stated(&self, scene: &Scene, n: DVec3, ratio: f64) -> Ray {
        let (n, more) = self.restated.map_or((n, 1.0), |to_rain| to_rain.aberrate(n));
        Ray {
            position: scene.camera.position,
            direction: scene.hole.scene_to_chart().transpose() * self.lens.place.vector(n),
            frequency_ratio: ratio * more,
        }
    }
}

/// The place that a fall from rest at infinity has come to, M = 1.
struct Fall {
    radius: f64,
    time: f64,
}

/// r^(3/2) falls evenly in proper time, which is rain time: r^(3/2) = r0^(3/2) - (3/2) sqrt(2) tau (Martel & Poisson
/// 2001, eq. 2.5). Outside the horizon the clock is t.
fn fall_schwarzschild(r0: f64, tau: f64) -> Result<Fall> {
    let left = r0.powf(1.5) - 1.5 * std::f64::consts::SQRT_2 * tau;
    if left.is_nan() || left <= 0.0 {
        let limit = r0.powf(1.5) / (1.5 * std::f64::consts::SQRT_2);
        return Err(Error::state(format!(
            "the fall from r = {r0} M ends in the singularity after proper time {limit} M; {tau} M were asked for"
        )));
    }
    let radius = left.powf(2.0 / 3.0);
    let offset = |r: f64| if r > 2.0 { rain_offset(1.0 / r, (r - 2.0) / r) } else { 0.0 };
    Ok(Fall { radius, time: tau - (offset(radius) - offset(r0)) })
}
