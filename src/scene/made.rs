// SPDX-License-Identifier: MIT OR Apache-2.0
//! How a frame was made, kept for as long as its pixels may be saved. Knows no names of parameters.

use super::{Region, Scene};

/// How a frame was made: all parameters of its scene, without pictures, which may be large.
pub struct Made {
    scene: Scene,
    has_map: bool,
    has_lut: bool,
    region: Region,
}

impl Scene {
    /// The scene as it is now, for a frame of which an image shows `region`.
    pub fn made(&self, region: &Region) -> Made {
        let has_map = self.sky_map.is_some() || self.sky_picture.is_some();
        let has_lut = self.film_lut.is_some();
        let mut scene = self.clone();
        (scene.sky_map, scene.sky_picture, scene.occluder, scene.given_stars) = (None, None, None, None);
        scene.film_lut = None;
        Made { scene, has_map, has_lut, region: *region }
    }
}

impl Made {
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Whether the sky had a map, which [`Self::scene`] lacks.
    pub fn has_map(&self) -> bool {
        self.has_map
    }

    /// Whether the film had a LUT, which [`Self::scene`] lacks.
    pub fn has_lut(&self) -> bool {
        self.has_lut
    }

    pub fn region(&self) -> Region {
        self.region
    }
}
