// SPDX-License-Identifier: MIT OR Apache-2.0
//! Where a point of the scene appears on the screen: the inverse of `query`'s camera rays. Knows no tracer: rays are
//! found in f64, those of many points on several threads.

use super::chart::Chart;
use super::content::clock_advance;
use super::query::{PixelRays, image_region};
use super::spread::Spread;
use super::{Ray, Region, Scene};
use crate::error::{Error, Number, Result};
use crate::physics::geodesic::turned;
use crate::physics::images::{Image, NoImage, image};
use crate::physics::observer::{LocalFrame, Observer};
use crate::physics::orbit::horizon_outer;
use crate::physics::rain::offsets;
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
    /// Straight, from the camera to the point.
    pub distance: f64,
    /// The place as far from the camera as the point, in the direction in which its image is seen.
    pub apparent: DVec3,
}

/// How a point is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projected {
    At(ProjectedPoint),
    /// There is no such image.
    Nowhere,
    /// None was found, though there may be one.
    Lost,
}

/// A camera that points are seen by.
#[derive(Clone, Copy, Debug)]
pub struct Projector<'a> {
    scene: &'a Scene,
    pixel_rays: PixelRays,
    region: Region,
    size: DVec2,
    order: u32,
}

const SPREAD: Spread = Spread { at_a_time: 64, a_thread: 256, name: "bhr-points" };

impl Scene {
    /// For images that light makes after `order` half turns about the hole, in a `width` x `height` image of the
    /// camera's (`region`: of the part of a frame that it is).
    ///
    /// Errors: as `camera_ray`; UNSUPPORTED for a camera of several places; INVALID_ARGUMENT for an order above
    /// `HIGHEST_ORDER`.
    pub fn projector(&self, width: u32, height: u32, region: Option<Region>, order: u32) -> Result<Projector<'_>> {
        self.check_one_eye("bhr_project_point")?;
        if order > HIGHEST_ORDER {
            return Err(Error::argument(format!("order is {order}; the highest is {HIGHEST_ORDER}")));
        }
        let region = image_region(width, height, region)?;
        let viewpoint = self.viewpoint_of_points()?;
        let pixel_rays = self.pixel_rays_of(self.lens_at(&viewpoint, &region)?)?;
        Ok(Projector { scene: self, pixel_rays, region, size: DVec2::new(width.into(), height.into()), order })
    }
}

impl Projector<'_> {
    /// The image of a scene point. Errors: INVALID_ARGUMENT for a point not finite; INVALID_STATE for one farther than
    /// 1e15 M.
    pub fn point(&self, point: DVec3) -> Result<Projected> {
        if !point.is_finite() {
            let (x, y, z) = (Number(point.x), Number(point.y), Number(point.z));
            return Err(Error::argument(format!("point is ({x}, {y}, {z}); it must be finite")));
        }
        let scene = self.scene;
        let (spin, mut there) = (scene.hole.spin, scene.hole.scene_to_chart() * point / scene.hole.mass);
        if there.length() <= horizon_outer(spin) {
            return Ok(Projected::Nowhere);
        }
        let at_point = scene.local_frame(point)?;
        // The point as the chart of the rays has it.
        let is_rain = self.pixel_rays.aberration.frame.rain;
        if scene.camera.chart == Chart::Rain && spin != 0.0 && !is_rain {
            there = turned(there, -offsets(spin, 1.0 / there.length()).azimuth);
        }
        Ok(match image(&self.pixel_rays.aberration.frame, there, self.order) {
            Ok(image) => Projected::At(self.seen(&image, point, &at_point, there)),
            Err(NoImage::None) => Projected::Nowhere,
            Err(NoImage::Lost) => Projected::Lost,
        })
    }

    /// The images of many points, on as many threads as the machine has cores. One that `point` refuses is nowhere.
    pub fn points(&self, points: &[DVec3], found: &mut [Projected]) {
        SPREAD.over(points, found, |point, found| *found = self.point(*point).unwrap_or(Projected::Nowhere));
    }

    /// An image in the host's terms; `there`: the point in the chart of the rays.
    fn seen(&self, image: &Image, point: DVec3, at_point: &LocalFrame, there: DVec3) -> ProjectedPoint {
        let (scene, observer, lens) = (self.scene, &self.pixel_rays.aberration, &self.pixel_rays.lens);
        let [begin_x, begin_y] = [self.region.x, self.region.y].map(f64::from);
        // Back from the local frame to the camera's own, whose axes are not turned by the boost.
        let (look, ratio) = Observer::moving(observer.frame, -observer.beta).aberrate(image.look);
        let frequency_ratio = 1.0 / ratio;
        let ray = self.pixel_rays.stated(scene, image.look, frequency_ratio);
        let position = lens.position(look).map(|at| at - DVec2::new(begin_x, begin_y));
        let inside = |at: DVec2| at.min_element() >= 0.0 && at.x <= self.size.x && at.y <= self.size.y;
        let shown = |at: DVec2| lens.mapping.has_look_direction(at.x + begin_x, at.y + begin_y);
        let to_scene = scene.hole.scene_to_chart().transpose();
        let retardation = image.constants.retardation(&image.start, &image.there);
        let delay = match scene.camera.chart {
            Chart::Static if observer.frame.rain => f64::NAN,
            Chart::Static => retardation,
            Chart::Rain => {
                // Up to the clock of the observer's delays, from rain time at the point.
                let advance = clock_advance(&observer.frame, Chart::Rain);
                retardation - advance - at_point.rain_time_offset()
            }
        };
        let distance = point.distance(scene.camera.position);
        // The solid angle without the hole is that at the distance which the host is told, in the camera's chart.
        let stretch = distance / (scene.hole.mass * there.distance(observer.frame.e_r * observer.frame.r));
        ProjectedPoint {
            position,
            on_screen: position.is_some_and(|at| inside(at) && shown(at)),
            ray,
            // Aberration makes solid angles as much smaller as the square of frequencies larger.
            magnification: image.magnification * (stretch / frequency_ratio).powi(2),
            delay: scene.hole.mass * delay,
            redshift: frequency_ratio * image.redshift,
            distance,
            apparent: scene.camera.position + to_scene * lens.placed(look) * distance,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::metric::chart;
    use crate::physics::orbit::horizon_inner;
    use crate::scene::{Camera, Frustum, Motion, Projection};
    use std::f64::consts::TAU;

    const SIZE: [u32; 2] = [600, 100];

    fn image_at(scene: &Scene, region: Option<Region>, point: DVec3, order: u32) -> ProjectedPoint {
        let [width, height] = if region.is_some() { [520, 80] } else { SIZE };
        match scene.projector(width, height, region, order).unwrap().point(point).unwrap() {
            Projected::At(image) => image,
            other => panic!("{point}: {other:?}"),
        }
    }

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
                    let image = image_at(&scene, Some(region), point, order);
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
                    // A straight line through the apparent place leads to the same pixel.
                    let lens = scene.lens(&region).unwrap();
                    let chart = scene.hole.scene_to_chart() * (image.apparent - position);
                    let line = lens.position(lens.observer.frame.components(chart)).unwrap();
                    assert!(line.abs_diff_eq(at + DVec2::new(40.0, 7.0), 1e-6), "{case}: {line} {at}");
                    assert!((image.apparent.distance(position) / image.distance - 1.0).abs() < 1e-12, "{case}");
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
            let image = image_at(&scene, None, point, order);
            assert!(image.delay.is_nan() && image.redshift > 0.0);
            assert!(passes(&scene, &image.ray, point) < 1e-6 * point.length(), "{point}");
        }
    }

    /// Through the horizon of a spinning hole, and on to the inner one: rays pass their points, and nothing jumps,
    /// neither at r+ nor at r+ + 0.3 M, where images begin to be found in the other chart.
    #[test]
    fn falling_observers_see_points_from_inside_spinning_holes() {
        let mut worst: f64 = 0.0;
        for (i, a) in [0.9, -0.5, 0.998].into_iter().enumerate() {
            let mut scene = Scene::plain();
            (scene.hole.spin, scene.hole.mass, scene.hole.axis) = (a, 2.5, DVec3::new(0.3, -0.4, 0.866).normalize());
            scene.camera.chart = Chart::Rain;
            scene.camera.projection = Projection::Equirect;
            let at = |scene: &mut Scene, r: f64| {
                scene.camera.position = chart(r, 1.1, 0.4 + i as f64) * scene.hole.mass;
                scene.camera.forward = scene.camera.position;
            };
            let (outer, inner) = (horizon_outer(a), horizon_inner(a));
            for (k, r) in [1.3 * inner, 0.5 * (inner + outer), 0.99 * outer, 1.05 * outer].into_iter().enumerate() {
                for (motion, velocity) in [(Motion::FreeFall, DVec3::ZERO), (Motion::Velocity, DVec3::splat(0.3))] {
                    at(&mut scene, r);
                    (scene.camera.motion, scene.camera.velocity) = (motion, velocity);
                    for (order, r) in [(0, 9.0), (1, 30.0), (0, 3.0)] {
                        let point = chart(r, 1.9, 2.1 * k as f64) * scene.hole.mass;
                        let image = image_at(&scene, None, point, order);
                        let miss = passes(&scene, &image.ray, point) / point.distance(scene.camera.position);
                        worst = worst.max(miss);
                        assert!(image.delay > 0.0 && image.redshift > 0.0 && image.magnification.is_finite());
                        let ray = image.position.map(|at| scene.camera_ray(SIZE[0], SIZE[1], None, at.x, at.y));
                        assert!(ray.unwrap().unwrap().direction.abs_diff_eq(image.ray.direction, 1e-10), "{image:?}");
                    }
                }
            }
            let point = chart(7.0, 0.8, 3.0) * scene.hole.mass;
            for (r, change) in [(outer, 1e-6), (outer + 0.3, 1e-7)] {
                for (motion, order) in [(Motion::FreeFall, 0), (Motion::Velocity, 1)] {
                    scene.camera.motion = motion;
                    let [above, below] = [1.0, -1.0].map(|sign| {
                        at(&mut scene, r + sign * change);
                        image_at(&scene, None, point, order)
                    });
                    let name = format!("{a} {r} {motion:?}: {above:?} {below:?}");
                    assert!(above.ray.direction.abs_diff_eq(below.ray.direction, 100.0 * change), "{name}");
                    for (x, y) in [
                        (above.redshift, below.redshift),
                        (above.delay, below.delay),
                        (above.ray.frequency_ratio, below.ray.frequency_ratio),
                    ] {
                        assert!((x / y - 1.0).abs() < 100.0 * change, "{x} {y} {name}");
                    }
                    assert!((above.magnification / below.magnification - 1.0).abs() < 1e-3, "{name}");
                }
            }
        }
        // The points of paths, in longer steps, and parabolas through them: `physics::images` holds more digits.
        println!("paths from inside miss their points by {worst:.1e} of the distance");
        assert!(worst < 1e-7, "{worst:.1e}");
    }

    #[test]
    fn points_and_orders_are_checked() {
        let scene = Scene::plain();
        let project = |point, order| scene.projector(SIZE[0], SIZE[1], None, order)?.point(point);
        assert!(project(DVec3::new(0.0, f64::NAN, 1.0), 0).unwrap_err().message.contains("finite"));
        assert!(project(DVec3::ONE * 9.0, HIGHEST_ORDER + 1).unwrap_err().message.contains("order"));
        assert!(project(DVec3::ONE * 1e16, 0).unwrap_err().message.contains("1e15"));
        assert_eq!(project(DVec3::new(0.1, 0.2, 0.3), 0).unwrap(), Projected::Nowhere);
        assert_eq!(project(scene.camera.position, 0).unwrap(), Projected::Nowhere);
    }

    /// Threads find the same images as one point after the other, and a bad point harms no other.
    #[test]
    fn many_points_are_found_as_one_is() {
        let mut scene = Scene::plain();
        scene.hole.spin = 0.9;
        let mut points =
            (0..1500).map(|i| chart(3.0 + 0.01 * f64::from(i), 1.0, 0.37 * f64::from(i))).collect::<Vec<_>>();
        (points[700], points[701], points[702]) = (DVec3::NAN, DVec3::ONE * 1e17, DVec3::ZERO);
        let projector = scene.projector(SIZE[0], SIZE[1], None, 0).unwrap();
        let mut found = vec![Projected::Lost; points.len()];
        projector.points(&points, &mut found);
        for (i, (point, found)) in points.iter().zip(&found).enumerate() {
            match i {
                700..=702 => assert_eq!(*found, Projected::Nowhere, "{point}"),
                _ => assert_eq!(*found, projector.point(*point).unwrap(), "{point}"),
            }
        }
    }
}
