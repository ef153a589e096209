// SPDX-License-Identifier: MIT OR Apache-2.0
//! Converts the host's scene to the hole's units (M = 1, chart axes): where the camera's observer is and how it looks
//! through a pixel. The only place that converts; both tracers and the queries build on it.

use super::hole::unit;
use super::projection::Mapping;
use super::{Camera, Motion, Region, Scene};
use crate::error::{Error, Number, Result};
use crate::physics::observer::{LocalFrame, NoFrame, Observer};
use crate::physics::orbit::{horizon_outer, photon_orbit};
use glam::{DMat3, DVec2, DVec3};

/// The range of observers, M: farther out, f32 tracers could not hold a ray's constants.
pub const MIN_RADIUS: f64 = 1e-6;
pub const MAX_RADIUS: f64 = 1e15;

impl Scene {
    /// The local frame at a place given in scene axes and lengths. Errors: INVALID_ARGUMENT for no place at all,
    /// INVALID_STATE outside 1e-6 .. 1e15 M, UNSUPPORTED at or inside a spinning hole's horizon.
    pub fn local_frame(&self, position: DVec3) -> Result<LocalFrame> {
        let chart = self.hole.scene_to_chart() * position / self.hole.mass;
        let r = chart.length();
        // NaN and r = 0 are refused by the frame itself.
        if position.is_finite() && (r > MAX_RADIUS || (r > 0.0 && r < MIN_RADIUS)) {
            return Err(Error::state(format!(
                "position lies at r = {} M (mass is {}); it must lie in [{MIN_RADIUS:e}, {MAX_RADIUS:e}] M",
                Number(r),
                Number(self.hole.mass)
            )));
        }
        LocalFrame::new(self.hole.spin, chart).map_err(|why| match why {
            NoFrame::NotAPlace => Error::argument(format!(
                "position ({}, {}, {}) is no place for an observer: it must be finite, and not the hole's centre",
                Number(position.x),
                Number(position.y),
                Number(position.z)
            )),
            NoFrame::InsideSpinningHorizon => Error::unsupported(format!(
                "r = {} M lies at or inside the horizon, {} M, of a hole of spin {}; inside, only spin 0 is traced",
                Number(chart.length()),
                Number(horizon_outer(self.hole.spin)),
                Number(self.hole.spin)
            )),
        })
    }

    /// Takes chart directions to sky axes.
    pub fn chart_to_sky(&self) -> DMat3 {
        let scene_to_sky = DMat3::from_quat(self.sky.orientation.normalize()).transpose();
        scene_to_sky * self.hole.scene_to_chart().transpose()
    }

    /// The camera's observer. Errors: as `local_frame`; INVALID_STATE where the camera's motion cannot be.
    pub fn observer(&self) -> Result<Observer> {
        self.observer_of(&self.camera)
    }

    pub(super) fn observer_of(&self, camera: &Camera) -> Result<Observer> {
        let frame = self.local_frame(camera.position)?;
        let spin = self.hole.spin;
        if frame.rain && camera.motion != Motion::FreeFall {
            return Err(Error::state(format!(
                "camera at r = {} M, at or inside the horizon, 2 M, cannot move as {}: there only FREE_FALL is \
                 possible",
                Number(frame.r),
                camera.motion.name()
            )));
        }
        match camera.motion {
            Motion::Static => Ok(Observer::at_rest(frame)),
            Motion::FreeFall => Ok(Observer::free_fall(frame)),
            Motion::Velocity => {
                let velocity = self.hole.scene_to_chart() * camera.velocity;
                Ok(Observer::moving(frame, frame.components(velocity)))
            }
            Motion::Orbit => Observer::orbiting(frame).ok_or_else(|| {
                Error::state(if spin != 0.0 && frame.cos.abs() > Observer::IN_PLANE {
                    format!(
                        "camera motion ORBIT off the equatorial plane (z = {} M) needs spin 0; spin is {}",
                        Number(frame.r * frame.cos),
                        Number(spin)
                    )
                } else {
                    format!(
                        "camera motion ORBIT at r = {} M: circular orbits exist only outside the photon orbit, {} M",
                        Number(frame.r),
                        Number(photon_orbit(spin))
                    )
                })
            }),
        }
    }

    /// The lens of the camera for the frame that `region` describes. Errors: as `observer` and `Mapping::new`.
    pub fn lens(&self, region: &Region) -> Result<Lens> {
        let observer = self.observer()?;
        let mapping = Mapping::new(&self.camera, region)?;
        let axes = self.hole.scene_to_chart() * self.camera.axes()?;
        let frame = &observer.frame;
        let [right, up, forward] = [axes.x_axis, axes.y_axis, axes.z_axis].map(|axis| frame.components(axis));
        // A picture about another centre costs nothing in the axis that every point of the image plane has once.
        let middle = forward + right * mapping.centre.x + up * mapping.centre.y;
        let axes = DMat3::from_cols(right * mapping.plane.x, up * mapping.plane.y, middle);
        Ok(Lens { observer, axes, mapping })
    }
}

/// The lens before an observer.
#[derive(Clone, Copy, Debug)]
pub struct Lens {
    pub observer: Observer,
    /// Columns: the units of a point of `mapping`, to the right, up, towards the frame's middle; components in the
    /// observer's frame.
    pub axes: DMat3,
    pub mapping: Mapping,
}

impl Lens {
    /// The angle of a pixel in the local frame, rad, where aberration makes it least.
    pub fn least_pixel_angle(&self) -> f64 {
        let beta = self.observer.beta.length().min(1.0);
        self.mapping.pixel_angle * ((1.0 - beta) / (1.0 + beta)).sqrt()
    }

    /// Unit look direction (components in the observer's own frame) through position (x, y) of the full frame, (0, 0)
    /// being its top-left corner. Unit even where the projection shows nothing (`Mapping::has_look_direction`).
    pub fn look_direction(&self, x: f64, y: f64) -> DVec3 {
        (self.axes * self.mapping.point(x, y)).normalize()
    }

    /// The distance, M, along the line of sight through (x, y), straight as on the chart, to its point nearest to the
    /// hole; 0 where that lies behind the observer.
    pub fn closest_approach(&self, x: f64, y: f64) -> f64 {
        let (n, _) = self.observer.aberrate(self.look_direction(x, y));
        self.observer.frame.r * (-n.x).max(0.0)
    }

    /// The position of the full frame at which a look direction (components in the observer's own frame) is seen;
    /// `None` where the projection has none for it.
    pub fn position(&self, look: DVec3) -> Option<DVec2> {
        self.mapping.position(self.axes.inverse() * look)
    }

    /// `look_direction`, and its changes to the next pixel right and down, to first order.
    #[inline]
    pub fn look_direction_and_changes(&self, x: f64, y: f64) -> (DVec3, [DVec3; 2]) {
        let point = self.axes * self.mapping.point(x, y);
        let inverse = 1.0 / point.length();
        let look = point * inverse;
        let steps = self.mapping.changes(x, y).map(|step| self.axes * step);
        (look, steps.map(|step| (step - look * look.dot(step)) * inverse))
    }
}

/// The components of a host's direction in `frame`, unit; `None` when it is zero or not finite.
pub fn look_components(scene: &Scene, frame: &LocalFrame, direction: DVec3) -> Option<DVec3> {
    unit(direction).map(|d| frame.components(scene.hole.scene_to_chart() * d).normalize())
}
