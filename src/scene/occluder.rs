// SPDX-License-Identifier: MIT OR Apache-2.0
//! The host's own things before the camera, as distances, and the part of a ray that they leave. Mirrored by
//! shaders/shade/shade.wgsl. Knows no pixels' colours.

use super::OnDevice;
use crate::allocate::with_room;
use crate::emit::Crossing;
use crate::error::{Error, Number, Result};
use crate::image::{ImageRef, PixelFormat};
use glam::DVec3;
use std::sync::Arc;

/// Distances along the look directions of a frame's pixels, row by row from the top left, in scene lengths; infinity
/// where there is nothing.
#[derive(Clone, Debug)]
pub enum Distances {
    /// Compared by identity: they never change.
    Copied(Arc<Vec<f32>>),
    OnDevice(OnDevice),
}

/// The host's things, as large as the frame's image.
#[derive(Clone, Debug)]
pub struct Occluder {
    pub width: u32,
    pub height: u32,
    pub distances: Distances,
    /// The place of the first pixel in the full frame.
    pub origin: [u32; 2],
    /// The things are where light shows them: rays end there, wherever it is.
    pub lensed: bool,
}

/// From this distance on, M, beyond which there are no observers, there is no thing that is met by rays.
pub const NO_THING: f64 = 1e15;

/// From this distance on, M, a thing stands before nothing; in f32, squares of lengths beyond are infinite.
pub const BEYOND_ALL: f64 = 1e30;

/// The part of a ray that an occluder leaves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown {
    /// The farthest that light of the direct image comes from, M.
    farthest: f64,
    /// The ray ends there: the occluder is nearer than the ray comes to the hole.
    pub ends: bool,
}

impl Occluder {
    /// A copy of the distances in `image`. Errors: INVALID_ARGUMENT for another format than R32F, NaN, and distances
    /// below 0; OUT_OF_MEMORY.
    pub fn new(image: &ImageRef<'_>) -> Result<Self> {
        let (width, height, format) = (image.width(), image.height(), image.format());
        if format != PixelFormat::R32F {
            return Err(Error::argument(format!("occluder format is {format}; it takes R32F")));
        }
        let mut distances = with_room(width as usize * height as usize, "an occluder")?;
        for y in 0..height {
            for (bytes, x) in image.row(y).chunks_exact(4).zip(0..) {
                let distance = bytemuck::pod_read_unaligned::<f32>(bytes);
                if distance.is_nan() || distance < 0.0 {
                    let distance = Number(distance.into());
                    return Err(Error::argument(format!(
                        "occluder distance at ({x}, {y}) is {distance}; it must be 0 or more, infinity for nothing"
                    )));
                }
                distances.push(distance);
            }
        }
        Ok(Self { width, height, distances: Distances::Copied(Arc::new(distances)), origin: [0, 0], lensed: false })
    }

    /// The distance at a position of the full frame, scene lengths: that of the pixel there, or of the one nearest to
    /// it; infinity where only the device knows it.
    pub fn at(&self, x: f64, y: f64) -> f64 {
        let within =
            |at: f64, begin: u32, size: u32| (at - f64::from(begin)).clamp(0.0, f64::from(size) - 1.0) as usize;
        let [column, row] =
            [within(x.floor(), self.origin[0], self.width), within(y.floor(), self.origin[1], self.height)];
        let Distances::Copied(distances) = &self.distances else { return f64::INFINITY };
        distances.get(row * self.width as usize + column).map_or(f64::INFINITY, |distance| (*distance).into())
    }
}

impl Shown {
    /// For an occluder at a distance, M, before a ray that comes nearest to the hole, on its straight line, at
    /// `closest`, M. Things that are `lensed` are met by the ray itself; beyond all observers there is none.
    pub fn new(farthest: f64, closest: f64, lensed: bool) -> Self {
        Self { farthest, ends: farthest < if lensed { NO_THING } else { closest } }
    }

    /// Whether a crossing is seen by an observer at `eye`, chart.
    pub fn shows(&self, crossing: &Crossing, eye: DVec3) -> bool {
        if crossing.order == 0 { distance(crossing, eye) <= self.farthest } else { !self.ends }
    }
}

/// The straight distance of a crossing from a place of the chart, M.
pub fn distance(crossing: &Crossing, eye: DVec3) -> f64 {
    (place(crossing) - eye).length()
}

/// The place of a crossing, chart.
pub fn place(crossing: &Crossing) -> DVec3 {
    let (sin, cos) = crossing.place.azimuth.sin_cos();
    DVec3::new(cos, sin, 0.0) / crossing.u
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emit::EmissionPoint;

    fn crossing(r: f64, azimuth: f64, order: u32) -> Crossing {
        let place = EmissionPoint { ln_r: r.ln(), azimuth, delay: 0.0 };
        Crossing { u: 1.0 / r, order, g: 1.0, place, footprint: [place; 2], share: 1.0 }
    }

    #[test]
    fn what_is_nearer_than_the_hole_hides_all_but_the_near_disk() {
        let eye = DVec3::new(30.0, 0.0, 0.0);
        let near = crossing(10.0, 0.0, 0);
        let far = crossing(10.0, std::f64::consts::PI, 0);
        let ring = crossing(6.0, 0.0, 1);
        assert!((distance(&near, eye) - 20.0).abs() < 1e-12 && (distance(&far, eye) - 40.0).abs() < 1e-12);
        for (farthest, shows) in
            [(10.0, [false; 3]), (25.0, [true, false, false]), (35.0, [true, false, true]), (50.0, [true; 3])]
        {
            let shown = Shown::new(farthest, 29.0, false);
            assert_eq!([near, far, ring].map(|crossing| shown.shows(&crossing, eye)), shows, "{farthest}");
            assert_eq!(shown.ends, farthest < 29.0);
            assert!(Shown::new(farthest, 29.0, true).ends);
        }
        for nothing in [f64::INFINITY, f32::MAX.into(), 1e15] {
            assert!(!Shown::new(nothing, 29.0, true).ends, "{nothing}");
        }
    }

    #[test]
    fn distances_are_those_of_the_pixels_that_places_lie_in() {
        let distances = (0..6_u8).map(f32::from).collect::<Vec<_>>();
        let bytes: &[u8] = bytemuck::cast_slice(&distances);
        let image = ImageRef::new(crate::image::Layout::packed(PixelFormat::R32F, 3, 2), bytes).expect("an image");
        let occluder = Occluder { origin: [10, 20], ..Occluder::new(&image).expect("distances") };
        for (x, y, distance) in [(10.0, 20.0, 0.0), (12.99, 21.5, 5.0), (11.0, 20.99, 1.0), (3.0, 99.0, 3.0)] {
            assert_eq!(occluder.at(x, y), distance, "{x} {y}");
        }
    }
}
