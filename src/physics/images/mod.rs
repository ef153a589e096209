// SPDX-License-Identifier: MIT OR Apache-2.0
//! The images of a point: the light rays from it to an observer, one for each number of half turns about the hole, with
//! magnification and delay. Always in f64. Knows no camera and no scene.
//!
//! Without spin a ray stays in the plane of observer, hole and point. The optical geometry of that plane has negative
//! curvature outside r = 3/2 M (-2/r^3 + 3/r^4; Gibbons & Werner 2008, Class. Quantum Grav. 25, 235009), so that two
//! rays that part never meet again: for each angle to be swept there is exactly one ray, found by bracketing (`plane`).
//! With spin that ray is followed while the spin grows from 0 (`path`), by Newton's method with the integrator itself,
//! and beside the horizon and inside while the observer falls (`falling`).

mod shooting;
mod plane;
mod spin;
mod winding;
mod path;
mod falling;
#[cfg(test)]
mod tests;

use super::geodesic::{Constants, State};
use super::observer::LocalFrame;
use super::orbit::{horizon_outer, zamo_omega};
use super::rain::azimuth_slope;
use glam::DVec3;
use shooting::{Aim, Flight, Target, fine};

/// The highest order that is looked for: each half turn more makes rays e^pi times as sensitive, and beyond this
/// doubles do not hold a direction well enough.
pub const HIGHEST_ORDER: u32 = 3;

/// The largest distance at which a ray still passes through its point, as a share of the distances of the point from
/// the observer and from the hole, whichever is less.
const PASSES: f64 = 1e-7;

/// An image of a point.
#[derive(Clone, Copy, Debug)]
pub struct Image {
    /// The unit look direction, components in the observer's local frame.
    pub look: DVec3,
    pub constants: Constants,
    /// The ray at the observer and at the point.
    pub start: State,
    pub there: State,
    /// Solid angle of the image by that in flat space, as the observer of the local frame sees it; negative where the
    /// image is mirrored, infinite on a caustic.
    pub magnification: f64,
    /// nu(observer of the local frame) / nu(ZAMO at the point).
    pub redshift: f64,
}

/// Why there is no image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoImage {
    /// No light comes from there: the point is not outside the horizon, or it is where the observer is.
    None,
    /// No ray was found, though there may be one.
    Lost,
}

/// The image of the chart place `point` that light makes after `order` half turns, for the observer at `frame`. The
/// chart is the frame's: Doran's for the rain frame of a spinning hole, which is one beside the horizon or inside.
pub fn image(frame: &LocalFrame, point: DVec3, order: u32) -> Result<Image, NoImage> {
    let Ok(at_point) = LocalFrame::new(frame.a, point) else { return Err(NoImage::None) };
    // The observer's place is known to rounding.
    let beside = point.distance(frame.e_r * frame.r);
    if at_point.rain || at_point.r <= horizon_outer(frame.a) || beside <= 4.0 * f64::EPSILON * frame.r {
        return Err(NoImage::None);
    }
    found(frame, point, &at_point, order).ok_or(NoImage::Lost)
}

/// The image of a point outside the horizon.
fn found(frame: &LocalFrame, point: DVec3, at_point: &LocalFrame, order: u32) -> Option<Image> {
    let distance = point.distance(frame.e_r * frame.r);
    let is_below = falling::is_below(frame);
    let step = if is_below { falling::STEP } else { fine(order, 1.0 / at_point.r) };
    let aim = if is_below {
        falling::aim(frame, point, order)?
    } else if frame.a == 0.0 {
        plane::aim(frame, point.normalize(), 1.0 / at_point.r, order, plane::Care { step, tolerance: f64::EPSILON })?
    } else {
        path::aim(frame, point, order)?
    };
    let target = Target::new(point);
    let flight = Flight::of(frame, &aim, step, true)?;
    let miss = (flight.there.chart_direction() / flight.there.u).distance(point);
    if miss.is_nan() || miss > PASSES * distance.min(at_point.r) {
        return None;
    }
    let area = beam_area(frame, &aim, &flight, at_point, order);
    let (c, omega) = (flight.constants, zamo_omega(frame.a, at_point.r, at_point.sin));
    let emitted = (c.energy - omega * c.angular_momentum) / at_point.lapse;
    debug_assert!(target.u > 0.0);
    Some(Image {
        look: aim.look(),
        constants: c,
        start: flight.start,
        there: flight.there,
        magnification: distance * distance / area,
        redshift: c.nu_local / emitted,
    })
}

/// Whether `image` finds those of a rain frame's observer, about a spinning hole: beside the horizon and inside.
pub use falling::is_below;

/// The area at the point, M^2, of the beam of rays about `aim`, by its solid angle at the observer; its sign is that of
/// the image's orientation.
///
/// Neighbouring rays differ at the point by displacements xi with k.xi = 0, because they meet at the observer. Their
/// area is the same for all observers at the point, and does not change when multiples of k are added (Sachs 1961), so
/// that rays may be compared at equal Mino times: the ZAMO's is taken, for whom xi has no part along time.
fn beam_area(frame: &LocalFrame, aim: &Aim, flight: &Flight, at: &LocalFrame, order: u32) -> f64 {
    let look = aim.look();
    let (first, second) = look.any_orthonormal_pair();
    // (first, second, look) is right-handed, as (e_r, e_theta, e_phi) is.
    let step = aim.small(frame, order) * 10.0;
    let (a, u) = (frame.a, flight.there.u);
    let sigma = at.r * at.r + (a * at.cos).powi(2);
    let delta = sigma_delta(a, at.r);
    let circumference = at.circumference();
    let drag = circumference * at.sin * zamo_omega(a, at.r, at.sin) / at.lapse;
    // Displacements are those of Boyer and Lindquist's chart.
    let wound = if frame.rain && a != 0.0 { azimuth_slope(a, at.r) * at.sin } else { 0.0 };
    let c = &flight.constants;
    // The photon's momentum, as the ZAMO has it; the ray is followed backward.
    let polar = flight.velocity().dot(at.e_theta);
    let momentum = DVec3::new(
        flight.there.du / (u * u) / (sigma * delta).sqrt(),
        -polar / sigma.sqrt(),
        if at.sin > 0.0 { c.angular_momentum / (circumference * at.sin) } else { -flight.velocity().dot(at.e_phi) },
    )
    .normalize();
    let displacement = |along: DVec3| {
        let [after, before] = [step, -step].map(|step| {
            let turned = (look + along * step).normalize();
            flight.again(frame, turned).map(|state| (state.u, state.chart_direction()))
        });
        let ((u1, n1), (u0, n0)) = (after?, before?);
        let (du, dn) = ((u1 - u0) / (2.0 * step), (n1 - n0) / (2.0 * step));
        let dr = -du / (u * u);
        let at_rest = DVec3::new(
            dr * (sigma / delta).sqrt(),
            dn.dot(at.e_theta) * sigma.sqrt(),
            (dn.dot(at.e_phi) - wound * dr) * circumference,
        );
        let time = momentum.dot(at_rest) / (1.0 + momentum.z * drag);
        Some(at_rest - DVec3::Z * (drag * time))
    };
    match (displacement(first), displacement(second)) {
        (Some(first), Some(second)) => -momentum.dot(first.cross(second)),
        _ => f64::NAN,
    }
}

/// Delta = (r - r+)(r - r-).
fn sigma_delta(a: f64, r: f64) -> f64 {
    (r - horizon_outer(a)) * (r - super::orbit::horizon_inner(a))
}
