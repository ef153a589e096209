//! Questions a host asks of a scene that need no tracer: numbers about the hole, camera rays, the camera's world line.

use super::{Camera, Ray, Region, Scene};
use crate::error::{Error, Result};
use glam::DVec3;

/// Lengths in scene units; NaN where not defined. Field by field `BhrHoleInfo`.
#[derive(Clone, Copy, Debug)]
pub struct HoleInfo {
    pub horizon_radius: f64,
    pub ergosphere_equatorial_radius: f64,
    pub photon_orbit_prograde: f64,
    pub photon_orbit_retrograde: f64,
    pub isco_prograde: f64,
    pub isco_retrograde: f64,
    pub critical_impact_parameter: f64,
    pub shadow_angular_radius: f64,
    pub camera_radius: f64,
    pub camera_time_rate: f64,
}

impl Scene {
    /// Numbers about the hole and the camera's observer. Errors: none today; where the camera cannot be, its numbers are NaN.
    pub fn hole_info(&self) -> Result<HoleInfo> {
        Err(Error::unsupported("skeleton"))
    }

    /// g_ab at `position` (scene axes), Boyer-Lindquist (t, r, th, ph), [4 a + b].
    /// Errors: INVALID_ARGUMENT not finite, at r = 0, on the horizon.
    pub fn metric_at(&self, _position: DVec3) -> Result<[f64; 16]> {
        Err(Error::unsupported("skeleton"))
    }

    /// Gamma^a_bc at `position`, [16 a + 4 b + c]. Errors: as `metric_at`, and on the axis.
    pub fn christoffel_at(&self, _position: DVec3) -> Result<[f64; 64]> {
        Err(Error::unsupported("skeleton"))
    }

    /// The ray through pixel position (x, y) of a width x height image that is `region` of a frame (`None`: the whole).
    /// Errors: INVALID_ARGUMENT sizes, region overrun, x or y not finite; INVALID_STATE / UNSUPPORTED where the camera cannot be.
    pub fn camera_ray(&self, _width: u32, _height: u32, _region: Option<Region>, _x: f64, _y: f64) -> Result<Ray> {
        Err(Error::unsupported("skeleton"))
    }

    /// Rays through all pixel centres of the image, row by row, handed to `write(index, ray)`.
    pub fn camera_rays(
        &self,
        _width: u32,
        _height: u32,
        _region: Option<Region>,
        _write: &mut dyn FnMut(usize, Ray),
    ) -> Result<()> {
        Err(Error::unsupported("skeleton"))
    }

    /// `camera` moved along its own world line by `proper_time`, and the scene time that went by.
    pub fn advance_camera(&self, _camera: &Camera, _proper_time: f64) -> Result<(Camera, f64)> {
        Err(Error::unsupported("skeleton"))
    }
}
