// SPDX-License-Identifier: MIT OR Apache-2.0
//! The media along a ray, gathered while it is traced. Knows no kind of matter.

use super::Emitters;
use super::medium::{Media, Medium};
use super::volumes::Seen;
use crate::physics::trace::{Part, PlaneCrossing, Visitor};

/// Gathers the media along a ray while it is traced.
pub struct MediaAlong<'a> {
    pub emitters: &'a Emitters,
    pub seen: Seen,
    /// The interval of 1/r in which crossings are kept.
    pub plane_u: Option<[f64; 2]>,
    pub media: Media,
    /// The medium since the last crossing that was kept.
    pub medium: Medium,
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
        self.emitters.along(part, &self.seen, &mut self.medium);
        self.seen = self.seen.after(part, 1.0);
    }

    fn crossing(&mut self, crossing: &PlaneCrossing) {
        if self.plane_u.is_some_and(|[outer, inner]| crossing.u >= outer && crossing.u <= inner) {
            // There is room for one more than there are crossings.
            let _ = self.media.try_push(std::mem::take(&mut self.medium));
        }
    }
}
