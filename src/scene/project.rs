// SPDX-License-Identifier: MIT OR Apache-2.0
//! Where a point of the scene appears on the screen: the inverse of `query`'s camera rays. Knows no tracer: rays are
//! found in f64 on the calling thread.

use super::{Ray, Region, Scene};
use crate::error::{Error, Number, Result};
use crate::physics::images::image;
use crate::physics::observer::Observer;
use crate::physics::orbit::horizon_outer;
use glam::{DVec2, DVec3};

pub use crate::physics::images::HIGHEST_ORDER;

/// An image of a point, in the host's terms. Field by field `BhrProjectedPoint`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProjectedPoint {
    /// In the image, pixels; `None`: the projection has no place for the direction.
    pub position: Option<DVec2>,
    /// Whether that lies in the image.
    pub on_screen: bool,
    /// The ray from the camera to the point, as `Scene::camera_ray` gives it.
    pub ray: Ray,
    pub magnification: f64,
    /// Scene lengths; NaN from inside the horizon.
    pub delay: f64,
    pub redshift: f64,
}

impl Scene {
    /// The image of a scene point that light makes after `order` half turns about the hole, in a `width` x `height`
    /// image of the camera's (`region`: of the part of a frame that it is). `None`: there is none, or none was found.
    ///
    /// Errors: as `camera_ray`; UNSUPPORTED for a camera of several places; INVALID_ARGUMENT for a point not finite or
    /// an order above `HIGHEST_ORDER`; INVALID_STATE for a point farther than 1e15 M.
    pub fn project_point(
        &self,
        width: u32,
        height: u32,
        region: Option<Region>,
        point: DVec3,
        order: u32,
    ) -> Result<Option<ProjectedPoint>> {
        if !point.is_finite() {
            let (x, y, z) = (Number(point.x), Number(point.y), Number(point.z));
            return Err(Error::argument(format!("point is ({x}, {y}, {z}); it must be finite")));
        }
        self.check_one_eye("bhr_project_point")?;
        if order > HIGHEST_ORDER {
            return Err(Error::argument(format!("order is {order}; the highest is {HIGHEST_ORDER}")));
        }
        let (pixel_rays, region) = self.pixel_rays(width, height, region)?;
        let there = self.hole.scene_to_chart() * point / self.hole.mass;
        if there.length() <= horizon_outer(self.hole.spin) {
            return Ok(None);
        }
        self.local_frame(point)?;
        let observer = pixel_rays.aberration;
        let Some(image) = image(&observer.frame, there, order) else { return Ok(None) };
        // Back from the local frame to the camera's own, whose axes are not turned by the boost.
        let (look, ratio) = Observer::moving(observer.frame, -observer.beta).aberrate(image.look);
        let frequency_ratio = 1.0 / ratio;
        let position = pixel_rays.lens.position(look).map(|at| at - DVec2::new(region.x.into(), region.y.into()));
        let inside = |at: DVec2| at.min_element() >= 0.0 && at.x <= f64::from(width) && at.y <= f64::from(height);
        let shown = |at: DVec2| {
            pixel_rays.lens.mapping.has_look_direction(at.x + f64::from(region.x), at.y + f64::from(region.y))
        };
        let chart = observer.frame.vector(image.look);
        Ok(Some(ProjectedPoint {
            position,
            on_screen: position.is_some_and(|at| inside(at) && shown(at)),
            ray: Ray {
                position: self.camera.position,
                direction: self.hole.scene_to_chart().transpose() * chart,
                frequency_ratio,
            },
            // Aberration makes solid angles as much smaller as the square of frequencies larger.
            magnification: image.magnification / (frequency_ratio * frequency_ratio),
            delay: match observer.frame.rain {
                true => f64::NAN,
                false => self.hole.mass * image.constants.retardation(&image.start, &image.there),
            },
            redshift: frequency_ratio * image.redshift,
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::metric::chart;
    use crate::scene::{Camera, Frustum, Motion, Projection};
    use std::f64::consts::TAU;

    const SIZE: [u32; 2] = [600, 100];

    /// The least distance of a ray's curve from a point: the points of a path are joined by circles through three.
    fn passes(scene: &Scene, ray: &Ray, point: DVec3) -> f64 {
        let path = crate::scene::host_rays::trace_path(scene, ray, 60_000).unwrap();
        let places = path.iter().map(|p| DVec3::new(p[0], p[1], p[2])).collect::<Vec<_>>();
        let nearest = (1..places.len() - 1)
            .min_by(|i, j| places[*i].distance_squared(point).total_cmp(&places[*j].distance_squared(point)))
            .unwrap();
        let [a, b, c] = [-1, 0, 1].map(|i: isize| places[nearest.checked_add_signed(i).unwrap()]);
        let curve = |t: f64| b + 0.5 * t * (c - a) + 0.5 * t * t * (a + c - 2.0 * b);
        let (mut low, mut high) = (-1.0, 1.0);
        for _ in 0..80 {
            let (x, y) = (low + 0.382 * (high - low), high - 0.382 * (high - low));
            if curve(x).distance(point) < curve(y).distance(point) { high = y } else { low = x }
        }
        curve(low).distance(point)
    }

    /// Each projection and each motion, a tilted and heavy hole, and a region.
    #[test]
    fn pixels_of_points_are_where_their_rays_begin() {
        let mut on_screen = 0;
        let projections =
            [Projection::Perspective, Projection::Fisheye, Projection::Equirect, Projection::Cube, Projection::Frustum];
        let motions = [Motion::Static, Motion::FreeFall, Motion::Orbit, Motion::Velocity];
        for (i, (projection, motion)) in
            projections.iter().flat_map(|p| motions.iter().map(move |m| (*p, *m))).enumerate()
        {
            for spin in [0.0, 0.8] {
                let mut scene = Scene::plain();
                scene.hole.mass = 2.5;
                scene.hole.spin = spin;
                scene.hole.axis = if motion == Motion::Orbit { DVec3::Z } else { DVec3::new(0.3, -0.2, 1.0) };
                let position = DVec3::new(30.0, 21.0, if motion == Motion::Orbit { 0.0 } else { 9.0 });
                scene.camera = Camera {
                    projection,
                    motion,
                    position,
                    forward: DVec3::new(-1.0, -0.5, 0.1),
                    velocity: DVec3::new(0.3, -0.5, 0.2),
                    fov_y: if projection == Projection::Fisheye { 5.0 } else { 2.0 },
                    frustum: Frustum { left: -2.0, right: 3.0, down: -1.5, up: 0.9 },
                    jitter: DVec2::new(0.3, -0.2),
                    ..Camera::plain()
                };
                for k in 0..4 {
                    let turn = TAU * (f64::from(k) * 0.27 + i as f64 * 0.01);
                    let point = chart(10.0 + 8.0 * f64::from(k), 1.3, turn);
                    let order = u32::from(k == 3);
                    let region = Region { full_width: 600, full_height: 100, x: 40, y: 7 };
                    let image = scene.project_point(520, 80, Some(region), point, order).unwrap().unwrap();
                    let Some(at) = image.position else { continue };
                    on_screen += u32::from(image.on_screen);
                    let ray = scene.camera_ray(520, 80, Some(region), at.x, at.y).unwrap();
                    let case = format!("{projection:?} {motion:?} {spin} {point} {order}");
                    if image.on_screen {
                        assert!(ray.direction.abs_diff_eq(image.ray.direction, 1e-10), "{case}: {ray:?} {image:?}");
                        assert!((ray.frequency_ratio / image.ray.frequency_ratio - 1.0).abs() < 1e-10, "{case}");
                        let miss = passes(&scene, &ray, point) / point.distance(position);
                        assert!(miss < 1e-6, "{case}: {miss:e}");
                    }
                    assert!(image.delay > 0.0 && image.redshift > 0.0 && image.magnification.is_finite(), "{image:?}");
                }
            }
        }
        assert!(on_screen > 60, "{on_screen}");
    }

    #[test]
    fn falling_observers_see_points_from_inside_the_horizon() {
        let mut scene = Scene::plain();
        scene.camera.position = DVec3::new(1.2, 0.8, 0.5);
        scene.camera.forward = scene.camera.position;
        scene.camera.motion = Motion::FreeFall;
        for (point, order) in [(DVec3::new(9.0, 2.0, 3.0), 0), (DVec3::new(-6.0, 9.0, 0.0), 0)] {
            let image = scene.project_point(SIZE[0], SIZE[1], None, point, order).unwrap().unwrap();
            assert!(image.delay.is_nan() && image.redshift > 0.0);
            assert!(passes(&scene, &image.ray, point) < 1e-6 * point.length(), "{point}");
        }
    }

    #[test]
    fn points_and_orders_are_checked() {
        let scene = Scene::plain();
        let project = |point, order| scene.project_point(SIZE[0], SIZE[1], None, point, order);
        assert!(project(DVec3::new(0.0, f64::NAN, 1.0), 0).unwrap_err().message.contains("finite"));
        assert!(project(DVec3::ONE * 9.0, HIGHEST_ORDER + 1).unwrap_err().message.contains("order"));
        assert!(project(DVec3::ONE * 1e16, 0).unwrap_err().message.contains("1e15"));
        assert_eq!(project(DVec3::new(0.1, 0.2, 0.3), 0).unwrap(), None);
        assert_eq!(project(scene.camera.position, 0).unwrap(), None);
    }
}
