// SPDX-License-Identifier: MIT OR Apache-2.0
//! The media along a ray, gathered while it is traced. Knows no kind of matter.

use super::Emitters;
use super::medium::{Media, Medium};
use super::volumes::Seen;
use crate::physics::geodesic::State;
use crate::physics::trace::{Part, PlaneCrossing, Visitor};
use glam::DVec3;

/// Gathers the media along a ray while it is traced.
pub struct MediaAlong<'a> {
    pub emitters: &'a Emitters,
    pub seen: Seen,
    /// The interval of 1/r in which crossings are kept.
    pub plane_u: Option<[f64; 2]>,
    pub media: Media,
    /// The medium since the last crossing that was kept.
    pub medium: Medium,
    /// How far there is anything to be seen; `None`: everywhere.
    pub limit: Option<Limit>,
}

/// The straight distance from the eye, M, beyond which no matter is seen: that of a thing of the host's. Mirrored by
/// shaders/emit/shown_part.wgsl.
#[derive(Clone, Copy, Debug)]
pub struct Limit {
    /// Chart.
    pub eye: DVec3,
    pub farthest: f64,
    /// The ray ends there: what comes nearer again is not seen either.
    pub ends: bool,
    pub ended: bool,
}

/// Steps that find where a part leaves what is seen.
pub(crate) const LIMIT_SECANTS: usize = 8;

impl Limit {
    /// The shares of a part between which its matter is seen. `beyond`: of its place at a share.
    fn shown(&mut self, beyond: impl Fn(f64) -> f64) -> Option<[f64; 2]> {
        if self.ended {
            return None;
        }
        let (mut low, mut high) = (0.0, 1.0);
        let (mut at_low, mut at_high) = (beyond(low), beyond(high));
        self.ended = self.ends && (at_low > 0.0 || at_high > 0.0);
        match (at_low > 0.0, at_high > 0.0) {
            (false, false) => return Some([0.0, 1.0]),
            (true, true) => return None,
            (true, false) if self.ends => return None,
            _ => {}
        }
        let leaves = at_high > 0.0;
        // A border that stays counts by half of its value: the Illinois variant of false position.
        for _ in 0..LIMIT_SECANTS {
            let x = low + (high - low) * (at_low / (at_low - at_high));
            let here = beyond(x);
            if (here > 0.0) == (at_low > 0.0) {
                (low, at_low, at_high) = (x, here, 0.5 * at_high);
            } else {
                (high, at_high, at_low) = (x, here, 0.5 * at_low);
            }
        }
        let x = low + (high - low) * (at_low / (at_low - at_high));
        Some(if leaves { [0.0, x] } else { [x, 1.0] })
    }

    /// How far a state is beyond it, in d / (d + r) of distances d, r being the eye's: along radial rays outwards that
    /// grows evenly in Mino time.
    fn beyond(&self, there: &State) -> f64 {
        // Past infinity, u < 0, everything is.
        let distance = if there.u > 0.0 { (there.chart_direction() / there.u).distance(self.eye) } else { 1e30 };
        let share = |distance: f64| distance / (distance + self.eye.length());
        share(distance) - share(self.farthest.min(1e30))
    }
}

impl MediaAlong<'_> {
    /// All media, the one behind the last crossing among them.
    pub fn finish(mut self) -> Media {
        let _ = self.media.try_push(self.medium);
        self.media
    }
}

impl Visitor for MediaAlong<'_> {
    fn part(&mut self, part: &Part<'_>) {
        match &mut self.limit {
            None => self.emitters.along(part, &self.seen, &mut self.medium),
            Some(limit) => {
                let borders = *limit;
                if let Some([from, to]) = limit.shown(|x| borders.beyond(&part.at(x))) {
                    let seen = self.seen.after(part, from);
                    self.emitters.along(&part.between(from, to), &seen, &mut self.medium);
                }
            }
        }
        self.seen = self.seen.after(part, 1.0);
    }

    fn crossing(&mut self, crossing: &PlaneCrossing) {
        if self.plane_u.is_some_and(|[outer, inner]| crossing.u >= outer && crossing.u <= inner) {
            // There is room for one more than there are crossings.
            let _ = self.media.try_push(std::mem::take(&mut self.medium));
        }
    }
}
