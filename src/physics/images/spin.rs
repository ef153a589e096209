// SPDX-License-Identifier: MIT OR Apache-2.0
//! The way from the problem without spin to that with spin, on which images are followed: places keep their distance
//! from the horizon. Knows no rays.

use super::shooting::Target;
use crate::physics::observer::LocalFrame;
use crate::physics::orbit::horizon_outer;
use glam::DVec3;

/// Turns about the spin axis and towards it, radians, of the places that a point is approached from.
pub const BESIDE: [[f64; 2]; 3] = [[0.35, 0.1], [-0.35, -0.1], [0.9, 0.3]];

/// Observer and point at a share `s` of the hole's spin, as far from the horizon.
pub fn spun_way(frame: &LocalFrame, point: DVec3, s: f64) -> Option<(LocalFrame, Target)> {
    let (n, r) = (point.normalize(), point.length());
    // r+ = 1 + cos(s asin a): where spins grew evenly, the horizon of the fastest holes would leap at the end.
    let a = if s == 1.0 { frame.a } else { (s * frame.a.asin()).sin() };
    let out = horizon_outer(a) - horizon_outer(frame.a);
    let mut turned = LocalFrame::new(a, frame.e_r * (frame.r + out)).ok()?;
    // The axes are the frame's own to the last digit, on the axis too.
    (turned.e_r, turned.e_theta, turned.e_phi) = (frame.e_r, frame.e_theta, frame.e_phi);
    (turned.sin, turned.cos) = (frame.sin, frame.cos);
    Some((turned, Target::new(n * (r + out))))
}
