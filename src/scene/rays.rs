// SPDX-License-Identifier: MIT OR Apache-2.0
//! Rays and their ends, in scene units, as a host asks for them directly. Field by field as in `bhr.h`.

use glam::DVec3;

/// Crossings that a [`Hit`] lists.
pub const MAX_CROSSINGS: usize = 4;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ray {
    /// Scene axes and lengths.
    pub position: DVec3,
    /// The direction in which the observer looks, opposite to the photon's momentum. Components are along the local
    /// frame, placed on the Euclidean unit vectors of spherical coordinates (bhr.h, Coordinates), in scene axes.
    pub direction: DVec3,
    /// nu(camera) / nu(observer of the local frame), > 0.
    pub frequency_ratio: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[repr(i32)]
pub enum Fate {
    Captured = 0,
    Escaped = 1,
    /// `max_steps` ran out before the end.
    Unresolved = 2,
    /// The ray's input is not valid.
    #[default]
    Invalid = 3,
}

/// A crossing of the equatorial plane outside the horizon.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Crossing {
    /// Scene lengths.
    pub radius: f64,
    /// Azimuth in the chart, (-pi, pi].
    pub azimuth: f64,
    /// g = nu(camera) / nu(the disk's matter), on its circular orbit or, inside the ISCO, plunging; NaN there if it
    /// does not plunge.
    pub redshift: f64,
    /// Coordinate time since the photon left, scene lengths; NaN for an observer inside the horizon.
    pub delay: f64,
}

/// The matter with depth along a ray.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Transfer {
    pub fate: Fate,
    /// I_nu at the camera's frequency, power laws sending 1 per M at density 1 at that frequency; NaN of a ray that is
    /// not valid.
    pub intensity: f64,
    /// NaN unless escaped.
    pub optical_depth: f64,
    /// Linear Rec. 709; NaN of a ray that is not valid.
    pub light: [f64; 3],
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hit {
    pub fate: Fate,
    pub crossing_count: u32,
    /// Asymptotic, unit, scene axes; 0 unless escaped.
    pub sky_direction: DVec3,
    /// nu(camera) / nu(at infinity).
    pub sky_redshift: f64,
    /// Spin 0: orbit angle from the observer to infinity, or to the horizon; spinning: NaN.
    pub swept_angle: f64,
    pub steps: u32,
    pub crossings: [Crossing; MAX_CROSSINGS],
}
