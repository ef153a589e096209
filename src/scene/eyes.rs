// SPDX-License-Identifier: MIT OR Apache-2.0
//! Stereo pictures all round, of one eye each: every column is seen from where the eye is when the head has turned to
//! it (omnidirectional stereo: Ishiguro, Yamamoto & Tsuji 1992, IEEE PAMI 14, 257; Peleg, Ben-Ezra & Pritch 2001, IEEE
//! PAMI 23, 279). Columns beside each other share an eye where that cannot be told.

use super::camera::Eye;
use super::{Camera, Projection, Region, Scene};
use crate::error::{Error, Result};
use std::f64::consts::TAU;

/// Pixels by which what is half as far as the hole may leap where the eye moves.
const LEAP: f64 = 0.1;
/// Most columns that share an eye.
const WIDEST: f64 = 64.0;

/// Columns of a frame that are seen from one place.
pub struct Strip {
    /// The first column, and how many there are.
    pub begin: u32,
    pub width: u32,
    /// An ordinary camera.
    pub camera: Camera,
}

impl Camera {
    /// Whether its columns are seen from several places.
    pub fn is_omnistereo(&self) -> bool {
        self.projection == Projection::Equirect && self.eye != Eye::Middle && self.eye_distance > 0.0
    }

    /// The camera at the place of the eye that looks at a longitude, radians from forward to the right; its axes stay.
    /// Errors: as `axes`.
    pub fn eye_towards(&self, longitude: f64) -> Result<Self> {
        let axes = self.axes()?;
        let (sin, cos) = longitude.sin_cos();
        let beside = match self.eye {
            Eye::Middle => 0.0,
            Eye::Left => -0.5,
            Eye::Right => 0.5,
        };
        let to_right = axes.x_axis * cos - axes.z_axis * sin;
        let position = self.position + to_right * (beside * self.eye_distance);
        Ok(Self { position, eye: Eye::Middle, eye_distance: 0.0, ..*self })
    }

    /// How many columns of a frame share an eye.
    fn strip_width(&self) -> u32 {
        // Over a column the eye moves by 2 pi / columns of half the eyes' distance, and a column is 2 pi / columns
        // wide.
        let columns = LEAP * 0.5 * self.position.length() / (0.5 * self.eye_distance);
        columns.clamp(1.0, WIDEST) as u32
    }

    /// The camera at the place of the eye that sees column `x` of a frame, in the middle of the columns that share it.
    /// Errors: as `strips`.
    fn eye_of_column(&self, x: f64, full_width: u32) -> Result<Self> {
        let (step, full) = (f64::from(self.strip_width()), f64::from(full_width));
        let first = (x / step).floor() * step;
        let middle = first + 0.5 * if first < full { step.min(full - first) } else { step };
        let camera = self.eye_towards(TAU * (middle / full - 0.5))?;
        camera.check()?;
        Ok(camera)
    }

    /// The strips of the columns of an image, `width` wide, that is a part of a frame: the same whatever the part is.
    /// Errors: as `eye_towards`; INVALID_ARGUMENT where an eye is in the hole's centre.
    pub fn strips(&self, region: &Region, width: u32) -> Result<Vec<Strip>> {
        let step = self.strip_width();
        let (mut begin, end) = (region.x, region.x + width);
        let mut strips = Vec::new();
        crate::allocate::reserve(&mut strips, (width / step) as usize + 2, "the strips of a stereo picture")?;
        while begin < end {
            let first = begin / step * step;
            let camera = self.eye_of_column(begin.into(), region.full_width)?;
            let next = (first + step).min(end);
            strips.push(Strip { begin: begin - region.x, width: next - begin, camera });
            begin = next;
        }
        Ok(strips)
    }
}

impl Scene {
    /// The scene as the eye sees it that sees column `x` of a frame; `None`: as the camera does. Errors: as
    /// `Camera::strips`.
    pub(super) fn seen_by_eye(&self, x: f64, full_width: u32) -> Result<Option<Self>> {
        if !self.camera.is_omnistereo() {
            return Ok(None);
        }
        let camera = self.camera.eye_of_column(x, full_width)?;
        Ok(Some(Self { camera, ..self.clone() }))
    }

    /// Errors: UNSUPPORTED for a camera with several places, naming what cannot be done with one.
    pub fn check_one_eye(&self, what: &str) -> Result<()> {
        if self.camera.is_omnistereo() {
            return Err(Error::unsupported(format!(
                "camera eye is {}: {what} of a picture whose columns are seen from several places is not supported; \
                 set eye 0",
                self.camera.eye as i32
            )));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(eye: Eye) -> Camera {
        Camera { projection: Projection::Equirect, eye, eye_distance: 0.4, ..Camera::plain() }
    }

    #[test]
    fn eyes_are_beside_the_place_on_the_side_of_their_name() {
        let axes = camera(Eye::Left).axes().unwrap();
        for longitude in [0.0, 1.0, -2.5, 3.1] {
            let ahead = axes.z_axis * f64::cos(longitude) + axes.x_axis * f64::sin(longitude);
            let [left, right] = [Eye::Left, Eye::Right].map(|eye| camera(eye).eye_towards(longitude).unwrap().position);
            assert!(((left + right) / 2.0).abs_diff_eq(camera(Eye::Left).position, 1e-12));
            let between = right - left;
            assert!((between.length() - 0.4).abs() < 1e-12 && between.dot(ahead).abs() < 1e-12);
            assert!(ahead.cross(axes.y_axis).dot(between) > 0.39, "{longitude}");
        }
    }

    #[test]
    fn strips_cover_an_image_and_do_not_depend_on_it() {
        for distance in [0.4, 1e-6, 40.0] {
            let camera = Camera { eye_distance: distance, ..camera(Eye::Right) };
            let whole = Region { full_width: 1000, full_height: 500, x: 0, y: 0 };
            let of_frame = camera.strips(&whole, 1000).unwrap();
            for (x, width) in [(0, 1000), (13, 500), (999, 1), (640, 100)] {
                let strips = camera.strips(&Region { x, ..whole }, width).unwrap();
                let mut next = 0;
                for strip in &strips {
                    assert!(strip.begin == next && strip.width > 0);
                    next += strip.width;
                    let column = x + strip.begin;
                    let same = of_frame.iter().find(|s| s.begin <= column && column < s.begin + s.width).unwrap();
                    assert_eq!(same.camera, strip.camera);
                }
                assert_eq!(next, width);
            }
        }
        assert!(
            !Camera { eye_distance: 0.0, ..camera(Eye::Left) }.is_omnistereo() && !camera(Eye::Middle).is_omnistereo()
        );
        assert!(!Camera { projection: Projection::Cube, ..camera(Eye::Left) }.is_omnistereo());
    }

    /// A host's rays are those of the pixels of a picture, whose columns share eyes.
    #[test]
    fn rays_begin_where_the_strip_of_their_column_is_seen_from() {
        const WIDTH: u32 = 1000;
        let scene = Scene { camera: camera(Eye::Right), ..Scene::plain() };
        let region = Region { full_width: WIDTH, full_height: WIDTH / 2, x: 0, y: 0 };
        let strips = scene.camera.strips(&region, WIDTH).unwrap();
        assert!((2..500).contains(&strips.len()), "{}", strips.len());
        let mut rays = std::collections::HashMap::new();
        let mut keep = |index, ray| {
            rays.insert(index, ray);
        };
        scene.camera_rays(WIDTH, WIDTH / 2, None, &mut keep).unwrap();
        for strip in &strips {
            let alone = Scene { camera: strip.camera, ..scene.clone() };
            for x in [strip.begin, strip.begin + strip.width - 1] {
                let (column, row) = (f64::from(x) + 0.5, 100.5);
                let own = scene.camera_ray(WIDTH, WIDTH / 2, None, column, row).unwrap();
                let of_strip = alone.camera_ray(WIDTH, WIDTH / 2, None, column, row).unwrap();
                assert_eq!((own.position, own.direction), (of_strip.position, of_strip.direction), "{x}");
                let ray = rays[&((100 * WIDTH + x) as usize)];
                assert_eq!((ray.position, ray.direction), (own.position, own.direction), "{x}");
            }
        }
    }
}
