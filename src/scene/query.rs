// SPDX-License-Identifier: MIT OR Apache-2.0
//! Questions a host asks of a scene that need no tracer: numbers about the hole, camera rays, the camera's world line.

use super::frame::Region;
use super::observer::Lens;
use super::{Camera, Motion, Ray, Scene};
use crate::error::{Error, Number, Result};
use crate::physics::geodesic::rain_offset;
use crate::physics::metric::{Kerr, boyer_lindquist};
use crate::physics::observer::Observer;
use crate::physics::orbit::{circular_orbit, ergosphere, horizon_inner, horizon_outer, isco, photon_orbit};
use crate::physics::shadow::{CRITICAL_IMPACT_PARAMETER, shadow};
use glam::{DQuat, DVec3};

/// Farthest pixel position that `camera_ray` takes.
const MAX_PIXEL: f64 = 1e9;

/// Lengths in scene units; NaN where not defined. Field by field `BhrHoleInfo`.
#[derive(Clone, Copy, Debug)]
pub struct HoleInfo {
    pub horizon_radius: f64,
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
    /// d tau / d t of the camera's observer.
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
            ergosphere_equatorial_radius: m * ergosphere(a, std::f64::consts::FRAC_PI_2),
            photon_orbit_prograde: m * photon_orbit(a),
            photon_orbit_retrograde: m * photon_orbit(-a),
            isco_prograde: m * isco(a),
            isco_retrograde: m * isco(-a),
            critical_impact_parameter: if spinless { m * CRITICAL_IMPACT_PARAMETER } else { f64::NAN },
            shadow_angular_radius: observer.filter(|_| spinless).map_or(f64::NAN, |o| shadow(&o).radius),
            camera_radius: self.camera.position.x.hypot(self.camera.position.y).hypot(self.camera.position.z),
            camera_time_rate: observer.map_or(f64::NAN, |o| o.time_rate()),
        })
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
        let region = region.unwrap_or(Region { full_width: width, full_height: height, x: 0, y: 0 });
        if width == 0 || height == 0 {
            return Err(Error::argument(format!("image is {width} x {height}; each side must be at least 1")));
        }
        region.check_image(width, height)?;
        let lens = self.lens(&region)?;
        let frame = lens.observer.frame;
        // Outside the horizon a ray is stated in the static frame, whatever frame the tracers prefer.
        let aberration = if frame.rain && frame.r > horizon_outer(self.hole.spin) {
            let static_frame = self.local_frame(self.camera.position)?;
            Observer::moving(static_frame, DVec3::new(-(2.0 / frame.r).sqrt(), 0.0, 0.0))
        } else {
            lens.observer
        };
        Ok((PixelRays { lens, aberration }, region))
    }

    /// `camera` moved along its own world line by `proper_time` (scene lengths, any sign), and the scene time that
    /// went by: by the clock of the end (`Scene::time`) less that of the begin. For a fall inside the horizon that is
    /// proper time.
    ///
    /// ORBIT follows the geodesic: at spin 0 and off the plane the great circle along +ph, position and axes turned
    /// together. Errors: UNSUPPORTED for VELOCITY; as `observer` for where the camera is; INVALID_STATE when a fall
    /// ends in the singularity or, with spin, at the horizon; INVALID_ARGUMENT for a `proper_time` not finite.
    pub fn advance_camera(&self, camera: &Camera, proper_time: f64) -> Result<(Camera, f64)> {
        if !proper_time.is_finite() {
            return Err(Error::argument(format!("proper_time is {}; it must be finite", Number(proper_time))));
        }
        camera.check()?;
        let observer = self.observer_of(camera)?;
        let tau = proper_time / self.hole.mass;
        match camera.motion {
            Motion::Velocity => Err(Error::unsupported(
                "camera motion VELOCITY has no world line of its own; move its position yourself",
            )),
            Motion::Static => Ok((*camera, proper_time / observer.time_rate())),
            Motion::Orbit => {
                let (a, r) = (self.hole.spin, observer.frame.r);
                let orbit =
                    circular_orbit(a, r).ok_or_else(|| Error::internal("an orbiting observer without orbit"))?;
                let axis = observer.frame.e_r.cross(observer.frame.e_phi);
                let angle = orbit.angular_velocity * orbit.ut * tau;
                Ok((self.turned(camera, axis, angle), proper_time * orbit.ut))
            }
            Motion::FreeFall => {
                let fall = if self.hole.spin == 0.0 {
                    fall_schwarzschild(observer.frame.r, tau)
                } else {
                    fall_kerr(self.hole.spin, observer.frame.r, observer.frame.cos, tau)
                }?;
                let mut moved = self.turned(camera, DVec3::Z, fall.azimuth);
                moved.position *= fall.radius / observer.frame.r;
                Ok((moved, fall.time * self.hole.mass))
            }
        }
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

/// The camera's lens and the boost into the frame in which its rays are stated.
#[derive(Clone, Copy, Debug)]
pub(super) struct PixelRays {
    pub(super) lens: Lens,
    pub(super) aberration: Observer,
}

impl PixelRays {
    fn ray(&self, scene: &Scene, x: f64, y: f64) -> Ray {
        let (n, frequency_ratio) = match self.lens.mapping.has_look_direction(x, y) {
            true => self.aberration.aberrate(self.lens.look_direction(x, y)),
            false => (DVec3::ZERO, 1.0),
        };
        let chart = self.aberration.frame.vector(n);
        Ray {
            position: scene.camera.position,
            direction: scene.hole.scene_to_chart().transpose() * chart,
            frequency_ratio,
        }
    }
}

/// The place that a fall from rest at infinity has come to, M = 1.
struct Fall {
    radius: f64,
    azimuth: f64,
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
    Ok(Fall { radius, azimuth: 0.0, time: tau - (offset(radius) - offset(r0)) })
}

/// E = 1, L = Q = 0 (Carter 1968): dr/dtau = -sqrt(2 r (r^2 + a^2)) / Sigma, dph/dtau = 2 a r / (Sigma Delta),
/// dt/dtau = A / (Sigma Delta), theta constant. RK4 with steps in proportion to the distance to the horizon.
fn fall_kerr(a: f64, r0: f64, cos: f64, tau: f64) -> Result<Fall> {
    let r_plus = horizon_outer(a);
    let rates = |r: f64| {
        let sum = r * r + a * a;
        let sigma = r * r + (a * cos).powi(2);
        let delta = (r - r_plus) * (r - horizon_inner(a));
        let big_a = sum * sum - delta * a * a * (1.0 - cos * cos);
        [-(2.0 * r * sum).sqrt() / sigma, 2.0 * a * r / (sigma * delta), big_a / (sigma * delta)]
    };
    let (mut r, mut azimuth, mut time, mut left) = (r0, 0.0, 0.0, tau);
    while left != 0.0 {
        if !r.is_finite() {
            return Err(Error::argument(format!("proper_time of {tau} M leads beyond all finite radii")));
        }
        if tau > 0.0 && r - r_plus < 1e-6 {
            return Err(Error::state(format!(
                "the fall from r = {r0} M reaches the horizon, {r_plus} M, within the proper time {tau} M asked for; \
                 inside a spinning hole no camera is possible"
            )));
        }
        let k1 = rates(r);
        let most = 0.02 * (r - r_plus) / -k1[0];
        let h = left.clamp(-most, most);
        let k2 = rates(r + 0.5 * h * k1[0]);
        let k3 = rates(r + 0.5 * h * k2[0]);
        let k4 = rates(r + h * k3[0]);
        let mean = |i: usize| h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
        r += mean(0);
        azimuth += mean(1);
        time += mean(2);
        left -= h;
    }
    Ok(Fall { radius: r, azimuth, time })
}
