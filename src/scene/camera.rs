// SPDX-License-Identifier: MIT OR Apache-2.0
//! The camera: an observer with a lens. It checks only itself; a motion that the hole does not allow is found when a
//! frame is asked for (`scene::observer`).

use super::chart::Chart;
use super::hole::unit;
use crate::error::{Error, Number, Result};
use glam::{DMat3, DVec2, DVec3};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(i32)]
pub enum Projection {
    Perspective = 0,
    Fisheye = 1,
    Equirect = 2,
    Cube = 3,
    /// Between the four tangents of `Camera::frustum`.
    Frustum = 4,
}

impl Projection {
    /// The projection by whose formula directions are found: a frustum's is the perspective one, about another centre.
    pub fn formula(self) -> Self {
        if self == Self::Frustum { Self::Perspective } else { self }
    }
}

/// The eye of a stereo picture all round.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Eye {
    /// No stereo picture: the camera's own place.
    Middle = 0,
    Left = 1,
    Right = 2,
}

/// The borders of a picture on the plane at distance 1 ahead of the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frustum {
    pub left: f64,
    pub right: f64,
    pub down: f64,
    pub up: f64,
}

impl Frustum {
    /// Largest tangent: f32 still squares it.
    pub const MOST: f64 = 1e9;

    /// Errors: a tangent not finite or above `MOST`, left not below right, down not below up.
    pub fn check(&self) -> Result<()> {
        let Self { left, right, down, up } = *self;
        for (name, tangent) in [("left", left), ("right", right), ("down", down), ("up", up)] {
            if tangent.is_nan() || tangent.abs() > Self::MOST {
                return Err(Error::argument(format!(
                    "camera tan_{name} is {}; it must lie within +-{:e}",
                    Number(tangent),
                    Self::MOST
                )));
            }
        }
        for (low, high, names) in [(left, right, ["left", "right"]), (down, up, ["down", "up"])] {
            if low >= high {
                return Err(Error::argument(format!(
                    "camera tan_{} is {} and tan_{} is {}; the first must be less than the second",
                    names[0],
                    Number(low),
                    names[1],
                    Number(high)
                )));
            }
        }
        Ok(())
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Motion {
    /// At rest; the ZAMO when the hole spins.
    Static = 0,
    /// Falls radially from rest at infinity.
    FreeFall = 1,
    /// Moves along +phi on a circle.
    Orbit = 2,
    /// Moves with `Camera::velocity`.
    Velocity = 3,
}

impl Motion {
    /// The name in `BHR_MOTION_*`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Static => "STATIC",
            Self::FreeFall => "FREE_FALL",
            Self::Orbit => "ORBIT",
            Self::Velocity => "VELOCITY",
        }
    }
}

/// How a camera's axes are carried along its world line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(i32)]
pub enum Transport {
    /// They keep their angles to the chart's triad at the camera.
    #[default]
    Triad = 0,
    /// They stay parallel to themselves along a world line in free fall, as those of gyroscopes do.
    Parallel = 1,
}

/// Position and axes in scene axes and lengths. `forward` and `up` keep the length the host gave them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    pub projection: Projection,
    /// Default (0, 26, 2.5).
    pub position: DVec3,
    /// Default: towards the hole.
    pub forward: DVec3,
    /// Default +z.
    pub up: DVec3,
    /// Radians. `Perspective`: full vertical angle, in (0, pi); `Fisheye`: angle across the circle, in (0, 2 pi].
    /// Default pi / 4.
    pub fov_y: f64,
    pub motion: Motion,
    /// v / c against the observer of the chart's triad, |v| < 1; components as for a direction given at `position`
    /// (bhr.h).
    pub velocity: DVec3,
    /// The borders of a `Frustum`'s picture. Default: 45 degrees each way.
    pub frustum: Frustum,
    /// The shift of the picture of a `Perspective` or a `Frustum`, pixels right and down, at most 1 each way.
    pub jitter: DVec2,
    /// The eye that an `Equirect` picture is for, and the distance of the eyes, scene lengths.
    pub eye: Eye,
    pub eye_distance: f64,
    /// The chart of `position`, of directions and of times; also that of the rays and points that the scene is asked
    /// for.
    pub chart: Chart,
    pub transport: Transport,
}

impl Default for Camera {
    fn default() -> Self {
        let position = DVec3::new(0.0, 26.0, 2.5);
        Self {
            projection: Projection::Perspective,
            position,
            forward: -position,
            up: DVec3::Z,
            fov_y: std::f64::consts::FRAC_PI_4,
            motion: Motion::Static,
            velocity: DVec3::ZERO,
            frustum: Frustum { left: -1.0, right: 1.0, down: -1.0, up: 1.0 },
            jitter: DVec2::ZERO,
            eye: Eye::Middle,
            eye_distance: 0.0,
            chart: Chart::Static,
            transport: Transport::Triad,
        }
    }
}

impl Camera {
    /// Errors: a number not finite, position 0, forward or up zero or parallel, fov_y out of range, |velocity| >= 1,
    /// tangents as `Frustum::check`, a jitter above 1,
    /// a negative eye distance.
    pub fn check(&self) -> Result<()> {
        let named =
            [("position", self.position), ("forward", self.forward), ("up", self.up), ("velocity", self.velocity)];
        for (name, v) in named {
            if !v.is_finite() {
                return Err(Error::argument(format!(
                    "camera {name} is ({}, {}, {}); it must be finite",
                    Number(v.x),
                    Number(v.y),
                    Number(v.z)
                )));
            }
        }
        if unit(self.position).is_none() {
            return Err(Error::argument("camera position is (0, 0, 0), the hole's centre; no observer is there"));
        }
        self.axes()?;
        let (limit, closed) = match self.projection {
            Projection::Perspective => (std::f64::consts::PI, false),
            _ => (std::f64::consts::TAU, true),
        };
        if !(self.eye_distance >= 0.0 && self.eye_distance.is_finite()) {
            return Err(Error::argument(format!(
                "camera eye_distance is {}; it must be finite and not less than 0",
                Number(self.eye_distance)
            )));
        }
        if self.projection == Projection::Frustum {
            self.frustum.check()?;
        }
        if self.jitter.is_nan() || self.jitter.abs().max_element() > 1.0 {
            return Err(Error::argument(format!(
                "camera jitter is ({}, {}); it must lie within +-1 pixel",
                Number(self.jitter.x),
                Number(self.jitter.y)
            )));
        }
        let ignored = matches!(self.projection, Projection::Equirect | Projection::Cube | Projection::Frustum);
        let inside = self.fov_y > 0.0 && (self.fov_y < limit || (closed && self.fov_y == limit));
        if !ignored && !inside {
            let range = if closed { "(0, 2 pi]" } else { "(0, pi)" };
            return Err(Error::argument(format!(
                "camera fov_y is {}; it must lie in {range}, in radians",
                Number(self.fov_y)
            )));
        }
        if self.velocity.length() >= 1.0 {
            return Err(Error::argument(format!(
                "camera velocity has length {} c; it must be less than 1",
                Number(self.velocity.length())
            )));
        }
        Ok(())
    }

    /// Unit camera axes in scene axes, as columns right, up, forward: right = forward x up, then up = right x forward.
    /// Errors: forward or up of zero length, or parallel.
    pub fn axes(&self) -> Result<DMat3> {
        let forward = unit(self.forward).ok_or_else(|| Error::argument("camera forward has zero length"))?;
        let up = unit(self.up).ok_or_else(|| Error::argument("camera up has zero length"))?;
        let right = forward.cross(up);
        // 1e-9 rad: below it, rounding of the host's own numbers decides where "up" is.
        if right.length() < 1e-9 {
            return Err(Error::argument("camera forward and up are parallel; up must point elsewhere"));
        }
        let right = right.normalize();
        Ok(DMat3::from_cols(right, right.cross(forward), forward))
    }
}
