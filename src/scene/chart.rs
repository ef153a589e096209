// SPDX-License-Identifier: MIT OR Apache-2.0
//! The charts in which hosts tell places, directions and times.

use crate::physics::geodesic::Clock;

/// A chart of the space-time about the hole, with the triad that directions and velocities are told along.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(i32)]
pub enum Chart {
    /// Boyer and Lindquist's azimuth and time, and the triad of the static observer (with spin, the ZAMO): outside the
    /// horizon. At and inside a spin-0 horizon the triad is the rain observer's.
    #[default]
    Static = 0,
    /// Doran's azimuth and time, and the triad of the rain observer, who falls from rest at infinity: regular at both
    /// horizons for all that falls in.
    Rain = 1,
}

impl Chart {
    /// The chart of `physics`.
    pub fn clock(self) -> Clock {
        match self {
            Self::Static => Clock::Coordinate,
            Self::Rain => Clock::Rain,
        }
    }
}
