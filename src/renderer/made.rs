// SPDX-License-Identifier: MIT OR Apache-2.0
//! How the pixels were made that a renderer has written into hosts' images, told by where the images lie: what a host
//! saves may be of a frame before the last, or of a job that was ordered in another scene. Knows no tracer.

use crate::image::ImageMut;
use crate::scene::{Made, Region, Scene};
use std::collections::VecDeque;
use std::sync::Arc;

/// Images that are remembered, those that were rendered last: all of the jobs that may be unfinished at a time. A frame
/// takes some kilobytes.
const MOST_IMAGES: usize = 512;

/// An image is the pixels at an address, in its size.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Place {
    address: usize,
    size: [u32; 2],
}

impl Place {
    pub fn of(image: &ImageMut<'_>) -> Self {
        Self { address: image.address(), size: [image.width(), image.height()] }
    }
}

#[derive(Default)]
pub(super) struct MadeFrames(VecDeque<(Place, Arc<Made>)>);

impl MadeFrames {
    /// A frame of `scene` goes into the images at `places`, as the part `region`.
    pub fn remember(&mut self, scene: &Scene, region: &Region, places: impl IntoIterator<Item = Place>) {
        let made = Arc::new(scene.made(region));
        for place in places {
            // Other images that began at this address are overwritten.
            self.0.retain(|(other, _)| other.address != place.address);
            if self.0.len() == MOST_IMAGES {
                self.0.pop_front();
            }
            self.0.push_back((place, made.clone()));
        }
    }

    /// How an image was made, if it is remembered.
    pub fn of(&self, image: &ImageMut<'_>) -> Option<&Made> {
        let place = Place::of(image);
        self.0.iter().find(|(other, _)| *other == place).map(|(_, made)| &**made)
    }
}
