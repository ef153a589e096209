// SPDX-License-Identifier: MIT OR Apache-2.0
//! Converts the host's scene to the hole's units (M = 1, chart axes): where the camera's observer is and how it looks
//! through a pixel. The only place that converts; both tracers and the queries build on it.

use super::chart::Chart;
use super::content::clock_advance;
use super::hole::unit;
use super::projection::Mapping;
use super::{Camera, Motion, Region, Scene};
use crate::error::{Error, Number, Result};
use crate::physics::geodesic::{Clock, RAIN_CLOCK_RADIUS};
use crate::physics::images::is_below;
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
        let chart = self.chart_place(position)?;
        LocalFrame::new(self.hole.spin, chart).map_err(|why| match why {
            NoFrame::NotAPlace => Error::argument(format!(
                "position ({}, {}, {}) is no place for an observer: it must be finite, and not the hole's centre",
                Number(position.x),
                Number(position.y),
                Number(position.z)
            )),
            NoFrame::InsideSpinningHorizon => Error::unsupported(format!(
                "r = {} M lies at or inside the horizon, {} M, of a hole of spin {}; there observers have places in \
                 the chart BHR_CHART_RAIN only",
                Number(chart.length()),
                Number(horizon_outer(self.hole.spin)),
                Number(self.hole.spin)
            )),
        })
    }

    /// A place in the chart, M. Errors: INVALID_STATE outside 1e-6 .. 1e15 M. A place that is none is left as it is.
    fn chart_place(&self, position: DVec3) -> Result<DVec3> {
        let chart = self.hole.scene_to_chart() * position / self.hole.mass;
        let r = chart.length();
        if position.is_finite() && (r > MAX_RADIUS || (r > 0.0 && r < MIN_RADIUS)) {
            return Err(Error::state(format!(
                "position lies at r = {} M (mass is {}); it must lie in [{MIN_RADIUS:e}, {MAX_RADIUS:e}] M",
                Number(r),
                Number(self.hole.mass)
            )));
        }
        Ok(chart)
    }

    /// The rain observer's frame at a place of Doran's chart. Errors: as `local_frame`; UNSUPPORTED at or within
    /// r- (1 + 1e-6).
    fn rain_frame(&self, position: DVec3) -> Result<LocalFrame> {
        LocalFrame::rain(self.hole.spin, self.chart_place(position)?)
    }

    /// The local frame at a place that a host's rays begin at, which are told in the chart of the camera. Errors: as
    /// `local_frame` and `rain_frame`.
    pub fn frame_of_rays(&self, position: DVec3) -> Result<LocalFrame> {
        match self.camera.chart {
            Chart::Static => self.local_frame(position),
            Chart::Rain => self.rain_frame(position),
        }
    }

    /// Takes chart directions to sky axes.
    pub fn chart_to_sky(&self) -> DMat3 {
        let scene_to_sky = DMat3::from_quat(self.sky.orientation.normalize()).transpose();
        scene_to_sky * self.hole.scene_to_chart().transpose()
    }

    /// The camera's observer. Errors: as `local_frame`; INVALID_STATE where the camera's motion cannot be.
    pub fn observer(&self) -> Result<Observer> {
        Ok(self.viewpoint_of(&self.camera)?.observer)
    }

    /// The viewpoint that tracers see a camera's scene from. Errors: as `observer`.
    pub(super) fn viewpoint_of(&self, camera: &Camera) -> Result<Viewpoint> {
        let observer = match camera.chart {
            Chart::Static => self.observer_in_static_chart(camera, self.local_frame(camera.position)?)?,
            Chart::Rain => return self.viewpoint_in_rain_chart(camera),
        };
        Ok(Viewpoint { observer, place: observer.frame, turn: DMat3::IDENTITY, place_speed: 0.0 })
    }

    /// Where light that escapes may come from farther in, rays are traced in the chart of Boyer and Lindquist, which
    /// has lens tables, and nearer in Doran's, of which nothing diverges at the horizon.
    fn viewpoint_in_rain_chart(&self, camera: &Camera) -> Result<Viewpoint> {
        let place = self.rain_frame(camera.position)?;
        let beta = match camera.motion {
            Motion::Velocity => place.components(self.hole.scene_to_chart() * camera.velocity),
            Motion::FreeFall => DVec3::ZERO,
            Motion::Static | Motion::Orbit => return self.resting_viewpoint(camera, place),
        };
        if place.a == 0.0 || place.r <= RAIN_CLOCK_RADIUS {
            let observer = Observer::moving(place.with_offset_series(), beta);
            return Ok(Viewpoint { observer, place, turn: DMat3::IDENTITY, place_speed: 0.0 });
        }
        Ok(restated(&Observer::moving(place, beta)))
    }

    /// The viewpoint that images of points are found from: in Doran's chart beside the horizon of a spinning hole and
    /// inside, else in that of Boyer and Lindquist. Errors: as `observer`.
    pub(super) fn viewpoint_of_points(&self) -> Result<Viewpoint> {
        let viewpoint = self.viewpoint_of(&self.camera)?;
        let frame = viewpoint.observer.frame;
        let stays = !frame.rain || frame.a == 0.0 || is_below(&frame);
        Ok(if stays { viewpoint } else { restated(&viewpoint.observer) })
    }

    /// The viewpoint of a camera that keeps its radius, at the place of a rain frame.
    fn resting_viewpoint(&self, camera: &Camera, place: LocalFrame) -> Result<Viewpoint> {
        if place.r <= horizon_outer(place.a) {
            return Err(no_motion(camera.motion, &place));
        }
        let observer = self.observer_in_static_chart(camera, place.to_static())?;
        Ok(Viewpoint { observer, place, turn: DMat3::IDENTITY, place_speed: 0.0 })
    }

    /// The camera's observer at a place of the chart of Boyer and Lindquist.
    fn observer_in_static_chart(&self, camera: &Camera, frame: LocalFrame) -> Result<Observer> {
        let spin = self.hole.spin;
        if frame.rain && camera.motion != Motion::FreeFall {
            return Err(no_motion(camera.motion, &frame));
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
        self.lens_at(&self.viewpoint_of(&self.camera)?, region)
    }

    /// [`Self::lens`] at a viewpoint of the camera's.
    pub(super) fn lens_at(&self, viewpoint: &Viewpoint, region: &Region) -> Result<Lens> {
        let Viewpoint { observer, place, turn, place_speed } = *viewpoint;
        let mapping = Mapping::new(&self.camera, region)?;
        let axes = self.hole.scene_to_chart() * self.camera.axes()?;
        let [right, up, forward] = [axes.x_axis, axes.y_axis, axes.z_axis].map(|axis| turn * place.components(axis));
        // A picture about another centre costs nothing in the axis that every point of the image plane has once.
        let middle = forward + right * mapping.centre.x + up * mapping.centre.y;
        let axes = DMat3::from_cols(right * mapping.plane.x, up * mapping.plane.y, middle);
        let delay_offset = match (self.camera.chart, observer.frame.clock()) {
            (Chart::Static, Clock::Rain) => f64::NAN,
            (chart, _) => -clock_advance(&observer.frame, chart),
        };
        Ok(Lens { observer, axes, mapping, place, turn, place_speed, delay_offset })
    }
}

/// INVALID_STATE for a motion that is none at or inside the horizon.
fn no_motion(motion: Motion, place: &LocalFrame) -> Error {
    Error::state(format!(
        "camera at r = {} M, at or inside the horizon, {} M, cannot move as {}: nothing is at rest or in orbit there, \
         and velocities are told in the chart BHR_CHART_RAIN only",
        Number(place.r),
        Number(horizon_outer(place.a)),
        motion.name()
    ))
}

/// The viewpoint of an observer of the rain frame, outside the horizon, in the chart of Boyer and Lindquist.
fn restated(observer: &Observer) -> Viewpoint {
    let place = observer.frame;
    let rain = Observer::rain_against(place.to_static());
    let (observer, turn) = observer.carried_by(&rain);
    Viewpoint { observer, place, turn, place_speed: rain.beta.length() }
}

/// An observer as tracers have it, and its place as the host tells it.
#[derive(Clone, Copy, Debug)]
pub struct Viewpoint {
    pub observer: Observer,
    /// The frame of the camera's chart at its place.
    pub place: LocalFrame,
    /// Takes directions along the axes of the camera's own observer, who moves against `place`, to those along the axes
    /// of `observer`.
    pub turn: DMat3,
    /// The speed inwards of the observer of `place` against the local frame of `observer`, where the camera's
    /// directions are those of the one and tracers have the other; else 0.
    pub place_speed: f64,
}

/// The lens before an observer.
#[derive(Clone, Copy, Debug)]
pub struct Lens {
    pub observer: Observer,
    /// Columns: the units of a point of `mapping`, to the right, up, towards the frame's middle; components in the
    /// observer's frame.
    pub axes: DMat3,
    pub mapping: Mapping,
    /// These three from `Viewpoint`.
    pub place: LocalFrame,
    pub turn: DMat3,
    pub place_speed: f64,
    /// The delays of the camera's chart less those of records, M; NaN where the chart has none.
    pub delay_offset: f64,
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

    /// A direction along the axes of `observer` as the host places it in the chart of the camera.
    pub fn placed(&self, look: DVec3) -> DVec3 {
        self.place.vector(self.turn.transpose() * look)
    }

    /// The distance, M, along the line of sight through (x, y), straight as on the chart, to its point nearest to the
    /// hole; 0 where that lies behind the observer.
    pub fn closest_approach(&self, x: f64, y: f64) -> f64 {
        self.closest_approach_towards(self.observer.aberrate(self.look_direction(x, y)).0)
    }

    /// [`Self::closest_approach`] in the look direction `n` of the observer's local frame: along what the observer of
    /// `place` sees there.
    pub fn closest_approach_towards(&self, n: DVec3) -> f64 {
        let speed = self.place_speed;
        self.place.r * ((speed - n.x) / (1.0 - speed * n.x)).max(0.0)
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
