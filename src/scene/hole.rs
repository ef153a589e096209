// SPDX-License-Identifier: MIT OR Apache-2.0
//! The black hole as the host states it: mass, spin, axis, and the rotation between scene axes and the hole's chart.

use crate::error::{Error, Number, Result, out_of_range};
use glam::{DMat3, DQuat, DVec3};

/// Largest |a / M| of a hole.
pub const MAX_SPIN: f64 = 1.0;
/// Largest |a / M| of holes in frames and about matter with depth. Beyond it lens tables, the disk's profile and single
/// precision do not hold; rays in f64 and world lines do.
pub const MAX_SHOWN_SPIN: f64 = 0.9999;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hole {
    /// M in scene lengths, > 0. Default 1.
    pub mass: f64,
    /// a / M in [-1, 1]; < 0: the hole turns towards -phi. Default 0.
    pub spin: f64,
    /// Spin axis and disk normal, scene axes, unit. Default +z.
    pub axis: DVec3,
}

impl Default for Hole {
    fn default() -> Self {
        Self { mass: 1.0, spin: 0.0, axis: DVec3::Z }
    }
}

impl Hole {
    /// Errors: `mass` not finite or not > 0.
    pub fn check_mass(mass: f64) -> Result<f64> {
        if mass.is_finite() && mass > 0.0 {
            return Ok(mass);
        }
        Err(Error::argument(format!("mass is {}; it must be finite and greater than 0 (scene lengths)", Number(mass))))
    }

    /// Errors: `spin` not finite or |spin| > 1.
    pub fn check_spin(spin: f64) -> Result<f64> {
        if spin.abs() <= MAX_SPIN {
            return Ok(spin);
        }
        Err(out_of_range("spin", spin, -MAX_SPIN, MAX_SPIN))
    }

    /// Whether the spin is beyond those of frames (`MAX_SHOWN_SPIN`).
    pub fn spins_too_fast(&self) -> bool {
        self.spin.abs() > MAX_SHOWN_SPIN
    }

    /// Errors: UNSUPPORTED for a spin beyond those of frames, naming `what` is asked for.
    pub fn check_shown(&self, what: &str) -> Result<()> {
        if !self.spins_too_fast() {
            return Ok(());
        }
        let spin = Number(self.spin);
        Err(Error::unsupported(format!(
            "spin is {spin}; {what} takes spins in [-{MAX_SHOWN_SPIN}, {MAX_SHOWN_SPIN}]; for faster holes \
             there are only rays, points and world lines"
        )))
    }

    /// The unit vector along `axis`. Errors: a component not finite, or zero length.
    pub fn check_axis(axis: DVec3) -> Result<DVec3> {
        // One that was scaled before is not scaled again, which would change its last digits: what hosts read and set
        // again stays.
        if (axis.length_squared() - 1.0).abs() <= 2.0 * f64::EPSILON {
            return Ok(axis);
        }
        unit(axis).ok_or_else(|| {
            Error::argument(format!(
                "axis is ({}, {}, {}); it must be finite and of non-zero length",
                Number(axis.x),
                Number(axis.y),
                Number(axis.z)
            ))
        })
    }

    /// Takes vectors in scene axes to the hole's chart, whose +z is the spin axis: the inverse of the shortest rotation
    /// from +z to the axis, about +x for -z (bhr.h, Coordinates).
    pub fn scene_to_chart(&self) -> DMat3 {
        if self.axis == DVec3::Z {
            return DMat3::IDENTITY;
        }
        if self.axis.z < 0.0 && self.axis.x == 0.0 && self.axis.y == 0.0 {
            return DMat3::from_diagonal(DVec3::new(1.0, -1.0, -1.0));
        }
        DMat3::from_quat(DQuat::from_rotation_arc(DVec3::Z, self.axis)).transpose()
    }
}

/// `v` scaled to unit length without overflow or underflow on the way; `None` when it is zero or not finite.
pub fn unit(v: DVec3) -> Option<DVec3> {
    let largest = v.abs().max_element();
    if !v.is_finite() || largest == 0.0 {
        return None;
    }
    let scaled = v / largest;
    // A subnormal `largest` leaves `scaled` inexact but never zero: its largest component is 1.
    scaled.is_finite().then(|| scaled.normalize())
}
