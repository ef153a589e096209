// SPDX-License-Identifier: MIT OR Apache-2.0
//! Cameras as the view and projection matrices that rasterisers have, and back. Matrices multiply column vectors here.
//! Knows neither hole nor observer, nor how a host keeps matrices in memory.

use super::camera::Frustum;
use super::{Camera, Projection};
use crate::error::{Error, Number, Result};
use glam::{DMat3, DMat4, DVec2, DVec3, DVec4};

/// The largest difference from a rotation that rounding in f32 explains.
const ROUNDING: f64 = 1e-4;

/// How a host's clip space, and the camera's own axes, lie.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ClipSpace {
    /// y = +1 is the bottom row of the image.
    pub y_down: bool,
    /// Depths lie in 0 .. 1, else in -1 .. 1.
    pub zero_to_one: bool,
    /// The near plane has the greatest depth.
    pub reversed: bool,
    /// The camera looks along its +z, else along -z.
    pub forward_z: bool,
}

impl Camera {
    /// This camera with the place, the axes and the FRUSTUM of a view (world to camera, rigid) and a perspective
    /// projection; near, far and the direction of depths do not matter.
    ///
    /// With w = s z, a clip position x = P00 x + P02 z is, at the distance d = |z| ahead, x / d = (x_ndc |s| - P02
    /// sign(s)) / P00; the borders are at x_ndc = -1 and 1.
    ///
    /// Errors: numbers not finite, a view that is not rigid, a projection that is not a perspective one, matrices that
    /// mirror the scene; as `check`.
    pub fn from_matrices(&self, view: &DMat4, projection: &DMat4, y_down: bool) -> Result<Self> {
        let [right, up, back] = [0, 1, 2].map(|i| view.row(i));
        if !view.is_finite() {
            return Err(Error::argument("view holds a number that is not finite"));
        }
        let axes = DMat3::from_mat4(*view);
        let off = (axes * axes.transpose() - DMat3::IDENTITY).to_cols_array().into_iter().fold(0.0, f64_max_abs);
        if off > ROUNDING || !view.row(3).abs_diff_eq(DVec4::W, ROUNDING) {
            return Err(Error::argument(format!(
                "view differs from a rigid motion by {}; at most {ROUNDING:e} is rounding (no scale, last row 0 0 0 1; \
                 is the memory order right?)",
                Number(off.max((view.row(3) - DVec4::W).abs().max_element()))
            )));
        }
        let [across, upward, last] = [0, 1, 3].map(|i| projection.row(i));
        check_perspective(across, upward, last)?;
        let (scale, sign) = (last.z.abs(), last.z.signum());
        let top = if y_down { -1.0 } else { 1.0 };
        let forward = back.truncate() * sign;
        let to_right = right.truncate() * across.x.signum();
        let to_top = up.truncate() * (upward.y.signum() * top);
        if to_right.cross(to_top).dot(forward) > 0.0 {
            return Err(Error::argument(
                "view and projection mirror the scene: they belong to a left-handed world, where a hole would turn the \
                 wrong way. Negate one axis of all positions and the view's column of that axis (Unity: z, Unreal: y)",
            ));
        }
        let border = |at: f64, middle: f64, stretch: f64| (at * scale - middle * sign) / stretch.abs();
        let frustum = Frustum {
            left: border(-1.0, across.z, across.x),
            right: border(1.0, across.z, across.x),
            down: border(-1.0, top * upward.z, upward.y),
            up: border(1.0, top * upward.z, upward.y),
        };
        let camera = Self {
            projection: Projection::Frustum,
            position: -(axes.inverse() * view.w_axis.truncate()),
            forward,
            up: to_top,
            frustum,
            jitter: DVec2::ZERO,
            ..*self
        };
        camera.check()?;
        Ok(camera)
    }

    /// View and projection of a PERSPECTIVE or FRUSTUM camera for frames of `width` x `height` pixels. Errors: another
    /// projection, a side of 0, near and far out of range; as `check`.
    pub fn matrices(&self, size: [u32; 2], [near, far]: [f64; 2], clip: ClipSpace) -> Result<[DMat4; 2]> {
        self.check()?;
        let [width, height] = size.map(f64::from);
        if size.contains(&0) {
            return Err(Error::argument(format!("frame is {width} x {height}; each side must be at least 1")));
        }
        let borders = match self.projection {
            Projection::Frustum => self.frustum,
            Projection::Perspective => {
                let up = (0.5 * self.fov_y).tan();
                let right = up * width / height;
                Frustum { left: -right, right, down: -up, up }
            }
            _ => {
                return Err(Error::argument(format!(
                    "camera projection is {}; only PERSPECTIVE ({}) and FRUSTUM ({}) have a matrix",
                    self.projection as i32,
                    Projection::Perspective as i32,
                    Projection::Frustum as i32
                )));
            }
        };
        if !(near > 0.0 && near.is_finite()) {
            return Err(Error::argument(format!("near_z is {}; it must be finite and greater than 0", Number(near))));
        }
        if far.is_nan() || far <= near {
            let (near, far) = (Number(near), Number(far));
            return Err(Error::argument(format!(
                "far_z is {far}; it must be greater than near_z, {near}, or infinite"
            )));
        }
        let sign = if clip.forward_z { 1.0 } else { -1.0 };
        let axes = self.axes()?;
        let rows = DMat3::from_cols(axes.x_axis, axes.y_axis, axes.z_axis * sign).transpose();
        let view = DMat4::from_mat3_translation(rows, rows * -self.position);
        // A clip position is (2 t - (right + left)) / (right - left) at the tangent t; the jitter moves it.
        let stretch = 2.0 / DVec2::new(borders.right - borders.left, borders.up - borders.down);
        let middle = 0.5 * DVec2::new(borders.right + borders.left, borders.up + borders.down);
        let moved = DVec2::new(2.0, -2.0) * self.jitter / DVec2::new(width, height);
        let shift = moved - middle * stretch;
        let top = if clip.y_down { -1.0 } else { 1.0 };
        let (first, last) = if clip.zero_to_one { (0.0, 1.0) } else { (-1.0, 1.0) };
        let [at_near, at_far] = if clip.reversed { [last, first] } else { [first, last] };
        // The depth at d is level + offset / d.
        let offset = (at_near - at_far) * if far.is_finite() { near / (1.0 - near / far) } else { near };
        let level = at_far - offset / far;
        let projection = DMat4::from_cols(
            DVec4::X * stretch.x,
            DVec4::Y * (stretch.y * top),
            DVec4::new(shift.x, shift.y * top, level, 1.0) * sign,
            DVec4::Z * offset,
        );
        if !(projection.is_finite() && view.is_finite()) {
            return Err(Error::argument("camera has no matrices: its place or its tangents are out of their range"));
        }
        Ok([view, projection])
    }
}

fn f64_max_abs(most: f64, value: f64) -> f64 {
    most.max(value.abs())
}

/// Errors: numbers not finite, or an orthographic, sheared or rolled projection.
fn check_perspective(across: DVec4, upward: DVec4, last: DVec4) -> Result<()> {
    if !(across.is_finite() && upward.is_finite() && last.is_finite()) {
        return Err(Error::argument("projection holds a number that is not finite in its rows 0, 1 or 3"));
    }
    let small = |value: f64, beside: f64| value.abs() <= 1e-9 * beside.abs();
    // Scaled matrices are perspective, too, but no host has one; transposed ones look like them.
    let is_perspective = last.truncate().abs().abs_diff_eq(DVec3::Z, ROUNDING) && small(last.w, 1.0);
    if !is_perspective {
        return Err(Error::argument(format!(
            "projection row 3 is ({}, {}, {}, {}); a perspective one has (0, 0, -1, 0) or (0, 0, 1, 0), orthographic \
             ones are not supported (is the memory order right?)",
            Number(last.x),
            Number(last.y),
            Number(last.z),
            Number(last.w)
        )));
    }
    let entries = [("[0][0]", across.x), ("[1][1]", upward.y)];
    if let Some((name, _)) = entries.into_iter().find(|(_, value)| *value == 0.0) {
        return Err(Error::argument(format!("projection {name} is 0; it must not be")));
    }
    let sheared = [("[0][1]", across.y, across.x), ("[1][0]", upward.x, upward.y)];
    let moved = [("[0][3]", across.w, across.x), ("[1][3]", upward.w, upward.y)];
    for (name, value, beside) in sheared.into_iter().chain(moved) {
        if !small(value, beside) {
            return Err(Error::argument(format!(
                "projection {name} is {}; it must be 0: a sheared, rolled or moved sensor has no frustum",
                Number(value)
            )));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
    use glam::dcamera::{lh, rh};
    use rh::proj::{directx, opengl, vulkan};

    const SIZE: [u32; 2] = [192, 108];

    fn scene() -> Scene {
        let mut scene = Scene::plain();
        scene.camera.position = DVec3::new(9.0, -4.0, 3.0);
        scene
    }

    /// The direction that a projection shows at a pixel position, scene axes: unprojected from two depths.
    fn unprojected(view: &DMat4, projection: &DMat4, y_down: bool, [x, y]: [f64; 2]) -> DVec3 {
        let inverse = (*projection * *view).inverse();
        let [width, height] = SIZE.map(f64::from);
        let y = if y_down { 2.0 * y / height - 1.0 } else { 1.0 - 2.0 * y / height };
        let [near, far] = [0.3, 0.6].map(|depth| inverse.project_point3(DVec3::new(2.0 * x / width - 1.0, y, depth)));
        let eye = view.inverse().transform_point3(DVec3::ZERO);
        // Whichever is farther: reversed depths fall.
        let direction = if near.distance(eye) < far.distance(eye) { far - near } else { near - far };
        direction.normalize()
    }

    fn seen(camera: &Camera, [x, y]: [f64; 2]) -> DVec3 {
        let scene = Scene { camera: *camera, ..scene() };
        scene.camera_ray(SIZE[0], SIZE[1], None, x, y).unwrap().direction
    }

    fn looks() -> (DVec3, DVec3, DVec3) {
        (DVec3::new(9.0, -4.0, 3.0), DVec3::new(-1.0, 2.0, 0.5), DVec3::new(0.2, -0.3, 0.9))
    }

    /// (view, projection, y_down) as hosts make them with glam, all for right-handed worlds.
    fn hosts() -> Vec<(&'static str, DMat4, DMat4, bool)> {
        let (eye, target, up) = looks();
        let aspect = f64::from(SIZE[0]) / f64::from(SIZE[1]);
        let [right, left] = [rh::view::look_at_mat4(eye, target, up), lh::view::look_at_mat4(eye, target, up)];
        // A left-handed camera of a right-handed world has its x axis negated.
        let flipped = DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0)) * left;
        // x right, y down, z forward, as of OpenCV.
        let machine = DMat4::from_scale(DVec3::new(1.0, -1.0, -1.0)) * right;
        let mut off_axis = directx::perspective(1.1, aspect, 0.1, 1000.0);
        (off_axis.z_axis.x, off_axis.z_axis.y) = (0.31, -0.17);
        vec![
            ("gl", right, opengl::perspective(1.1, aspect, 0.1, 1000.0), false),
            ("zero to one", right, directx::perspective(1.1, aspect, 0.1, 1000.0), false),
            ("infinite", right, directx::perspective_infinite(1.1, aspect, 0.1), false),
            ("reversed", right, directx::perspective_infinite_reverse(1.1, aspect, 0.1), false),
            ("vulkan", right, vulkan::perspective(1.1, aspect, 0.1, 1000.0), true),
            ("left-handed", flipped, lh::proj::directx::perspective(1.1, aspect, 0.1, 1000.0), false),
            ("reversed left-handed", flipped, lh::proj::directx::perspective_infinite_reverse(1.1, aspect, 0.1), false),
            ("opencv", machine, lh::proj::directx::perspective(1.1, aspect, 0.1, 1000.0), true),
            ("off-axis", right, off_axis, false),
            ("vulkan, off-axis", right, vulkan::frustum(-0.2, 0.5, -0.1, 0.4, 0.3, 900.0), true),
            ("frustum", right, directx::frustum(-0.2, 0.5, -0.1, 0.4, 0.3, 900.0), false),
        ]
    }

    #[test]
    fn pixels_show_what_the_matrices_show() {
        for (name, view, projection, y_down) in hosts() {
            let camera = Camera::default().from_matrices(&view, &projection, y_down).unwrap();
            assert!(camera.position.abs_diff_eq(looks().0, 1e-12), "{name}: {}", camera.position);
            for at in [[0.0, 0.0], [192.0, 0.0], [31.0, 77.0], [192.0, 108.0], [96.0, 54.0]] {
                let expected = unprojected(&view, &projection, y_down, at);
                let found = seen(&camera, at);
                assert!(found.abs_diff_eq(expected, 1e-9), "{name} at {at:?}: {found} {expected}");
            }
        }
    }

    #[test]
    fn matrices_come_back() {
        let conventions = (0..16).map(|bits| ClipSpace {
            y_down: bits & 1 != 0,
            zero_to_one: bits & 2 != 0,
            reversed: bits & 4 != 0,
            forward_z: bits & 8 != 0,
        });
        for clip in conventions {
            for (far, jitter) in [(f64::INFINITY, DVec2::ZERO), (700.0, DVec2::new(0.25, -0.5))] {
                for projection in [Projection::Perspective, Projection::Frustum] {
                    let (position, target, up) = looks();
                    let frustum = Frustum { left: -0.3, right: 1.1, down: 0.2, up: 0.7 };
                    let forward = target - position;
                    let camera = Camera { projection, position, forward, up, frustum, jitter, ..Camera::default() };
                    let [view, matrix] = camera.matrices(SIZE, [0.2, far], clip).unwrap();
                    let back = camera.from_matrices(&view, &matrix, clip.y_down).unwrap();
                    assert!(back.position.abs_diff_eq(position, 1e-12) && back.jitter == DVec2::ZERO);
                    for at in [[0.0, 0.0], [31.0, 77.0], [192.0, 108.0]] {
                        let (expected, found) = (seen(&camera, at), seen(&back, at));
                        assert!(found.abs_diff_eq(expected, 1e-12), "{clip:?} {at:?}: {found} {expected}");
                        let own = unprojected(&view, &matrix, clip.y_down, at);
                        assert!(own.abs_diff_eq(expected, 1e-9), "{clip:?} {at:?}: {own} {expected}");
                    }
                    // Depths of the planes.
                    let ahead = |d: f64| {
                        let place = position + d * camera.axes().unwrap().z_axis;
                        (matrix * view).project_point3(place).z
                    };
                    let least = if clip.zero_to_one { 0.0 } else { -1.0 };
                    let planes = if clip.reversed { [1.0, least] } else { [least, 1.0] };
                    assert!((ahead(0.2) - planes[0]).abs() < 1e-12, "{clip:?}: {}", ahead(0.2));
                    assert!((ahead(far.min(1e12)) - planes[1]).abs() < 1e-9, "{clip:?}: {}", ahead(far));
                }
            }
        }
    }

    #[test]
    fn glam_s_own_matrices_are_made() {
        let (eye, target, up) = looks();
        let camera = Camera { position: eye, forward: target - eye, up, fov_y: 1.1, ..Camera::default() };
        let aspect = f64::from(SIZE[0]) / f64::from(SIZE[1]);
        let made = |far, clip| camera.matrices(SIZE, [0.1, far], clip).unwrap();
        let gl = ClipSpace::default();
        let cases = [
            (made(50.0, gl), opengl::perspective(1.1, aspect, 0.1, 50.0)),
            (made(50.0, ClipSpace { zero_to_one: true, ..gl }), directx::perspective(1.1, aspect, 0.1, 50.0)),
            (
                made(f64::INFINITY, ClipSpace { zero_to_one: true, reversed: true, ..gl }),
                directx::perspective_infinite_reverse(1.1, aspect, 0.1),
            ),
        ];
        for ([view, projection], expected) in cases {
            assert!(view.abs_diff_eq(rh::view::look_at_mat4(eye, target, up), 1e-12));
            assert!(projection.abs_diff_eq(expected, 1e-12), "{projection} {expected}");
        }
        let clip = ClipSpace { zero_to_one: true, forward_z: true, ..gl };
        assert!(made(50.0, clip)[1].abs_diff_eq(lh::proj::directx::perspective(1.1, aspect, 0.1, 50.0), 1e-12));
    }

    /// The lines of bhr.h for engines whose worlds are left-handed.
    #[test]
    fn left_handed_worlds_are_refused_until_an_axis_is_negated() {
        let (eye, target, up) = looks();
        let aspect = f64::from(SIZE[0]) / f64::from(SIZE[1]);
        let scene = Camera { position: eye, forward: target - eye, up, fov_y: 1.1, ..Camera::default() };
        // Unity: y up, z negated; a camera that looks along -z. Unreal: y negated; one that looks along +z, reversed.
        let mirror = [DVec3::new(1.0, 1.0, -1.0), DVec3::new(1.0, -1.0, 1.0)];
        let there = |axis: DVec3| {
            // look_at_lh of a left-handed world has x to the right; Unity's camera then has its z negated.
            lh::view::look_at_mat4(eye * axis, target * axis, up * axis)
        };
        let unity = DMat4::from_scale(mirror[0]) * there(mirror[0]);
        let unreal = there(mirror[1]);
        let cases = [
            (unity, opengl::perspective(1.1, aspect, 0.1, 50.0), mirror[0]),
            (unreal, lh::proj::directx::perspective_infinite_reverse(1.1, aspect, 0.1), mirror[1]),
        ];
        for (view, projection, mirror) in cases {
            let error = Camera::default().from_matrices(&view, &projection, false).unwrap_err();
            assert!(error.message.contains("left-handed"), "{error}");
            let view = view * DMat4::from_scale(mirror);
            let camera = Camera::default().from_matrices(&view, &projection, false).unwrap();
            for at in [[0.0, 0.0], [31.0, 77.0], [192.0, 108.0]] {
                assert!(seen(&camera, at).abs_diff_eq(seen(&scene, at), 1e-9), "{camera:?}");
            }
        }
    }

    #[test]
    fn matrices_that_are_no_camera_s_are_refused() {
        let (_, view, projection, _) = hosts()[0];
        let refused = |view: DMat4, projection: DMat4, words: &str| {
            let error = Camera::default().from_matrices(&view, &projection, false).unwrap_err();
            assert!(error.message.contains(words), "{error}");
        };
        let with = |matrix: DMat4, row: usize, column: usize, value: f64| {
            let mut matrix = matrix.transpose();
            matrix.col_mut(row)[column] = value;
            matrix.transpose()
        };
        refused(view * DMat4::from_scale(DVec3::splat(1.01)), projection, "rigid");
        refused(view.transpose(), projection, "rigid");
        refused(with(view, 0, 3, f64::NAN), projection, "finite");
        refused(view, projection.transpose(), "row 3");
        refused(view, opengl::orthographic(-1.0, 1.0, -1.0, 1.0, 0.1, 9.0), "orthographic");
        refused(view, with(projection, 0, 1, 0.1), "[0][1]");
        refused(view, with(projection, 1, 0, 0.1), "[1][0]");
        refused(view, with(projection, 0, 3, 0.1), "[0][3]");
        refused(view, with(projection, 0, 0, 0.0), "[0][0]");
        refused(view, with(projection, 1, 1, f64::INFINITY), "finite");
        refused(view, with(projection, 0, 0, 1e-12), "tan_");
        // Depths do not matter, not even broken ones.
        let broken = with(with(projection, 2, 2, f64::NAN), 2, 3, f64::INFINITY);
        assert!(Camera::default().from_matrices(&view, &broken, false).is_ok());
    }
}
