// SPDX-License-Identifier: MIT OR Apache-2.0
//! BhrCamera: the struct, the helpers that aim one, and setting, getting and advancing it.

use super::call::on_context;
use super::chart::{BhrChart, chart};
use super::context::BhrContext;
use super::entry::anywhere;
use super::pointer::{Out, check_finite, check_finite_vector, check_reserved, is_null, read_vector, unknown};
use super::status::BhrStatus;
use super::versioned::{self, OutStruct, Versioned};
use crate::error::{Error, Number, Result};
use crate::scene::{Camera, Eye, Frustum, Motion, Projection, ThinLens, Transport};
use glam::DVec3;
use std::mem::offset_of;

/// The lens. Camera axes: right = forward x up, then up = right x forward.
pub type BhrProjection = i32;
/// A flat picture; fov_y in (0, pi).
pub const BHR_PROJECTION_PERSPECTIVE: BhrProjection = 0;
/// Dome master, equidistant: the angle from forward grows evenly with the distance from the frame's centre, to fov_y
/// / 2 (fov_y to 2 pi) at the circle inscribed in the frame. Outside the circle there is nothing: black, alpha 0 in
/// a TRANSPARENT image, NaN in views, rays without direction.
pub const BHR_PROJECTION_FISHEYE: BhrProjection = 1;
/// All-round picture, 360 x 180 degrees in even steps: longitude from forward (middle) to the right, latitude
/// towards up (top); fov_y is ignored. A frame that is not twice as wide as high is stretched.
pub const BHR_PROJECTION_EQUIRECT: BhrProjection = 2;
/// Six faces of a cube side by side: right, left, up, down, front, back. The top of each face is up; of the up face
/// it is backward, of the down face forward. Each is what a 90 degree PERSPECTIVE camera sees, not its mirror image;
/// fov_y is ignored. The full frame's width must be 6 times its height, else rendering is INVALID_STATE.
pub const BHR_PROJECTION_CUBE: BhrProjection = 3;
/// A flat picture between four tangents, as the frustum of a projection matrix: tan_left, tan_right, tan_down,
/// tan_up. fov_y is ignored, and the frame's shape may be any: it is stretched to the tangents. @since 0.2.0
pub const BHR_PROJECTION_FRUSTUM: BhrProjection = 4;

/// How the camera's observer moves. A motion that is not possible at the camera's place is INVALID_STATE when a
/// frame or rays are asked for.
pub type BhrMotion = i32;
/// At rest, outside the horizon; with spin, the zero angular momentum observer (ZAMO).
pub const BHR_MOTION_STATIC: BhrMotion = 0;
/// Falls from rest at infinity with E = 1 and L = Q = 0, inside the horizon too (with spin in chart RAIN).
pub const BHR_MOTION_FREE_FALL: BhrMotion = 1;
/// On a circle towards +ph: without spin at any latitude, with r > 3 M and beta = 1 / sqrt(r / M - 2); with spin on
/// the circular geodesic, in the equatorial plane only (to within 1e-12 of the radius).
pub const BHR_MOTION_ORBIT: BhrMotion = 2;
/// Moves with BhrCamera.velocity.
pub const BHR_MOTION_VELOCITY: BhrMotion = 3;

/// The eye for which an EQUIRECT picture is made. @since 0.2.0
pub type BhrEye = i32;
/// The camera's own place: no stereo picture.
pub const BHR_EYE_MIDDLE: BhrEye = 0;
/// The left eye.
pub const BHR_EYE_LEFT: BhrEye = 1;
/// The right eye.
pub const BHR_EYE_RIGHT: BhrEye = 2;

/// How bhr_camera_advance carries a camera's axes along. @since 0.2.0
pub type BhrTransport = i32;
/// Forward and up keep their angles to e_r, e_th and e_ph.
pub const BHR_TRANSPORT_TRIAD: BhrTransport = 0;
/// Forward and up stay parallel to themselves along the world line, as the axes of gyroscopes do. For cameras in free
/// fall: FREE_FALL, ORBIT and VELOCITY.
pub const BHR_TRANSPORT_PARALLEL: BhrTransport = 1;

/// The camera: an observer with a lens. Positions and axes in scene axes and lengths.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct BhrCamera {
    /// sizeof(BhrCamera).
    pub struct_size: u32,
    /// BHR_PROJECTION_*. Default PERSPECTIVE.
    pub projection: BhrProjection,
    /// Default (0, 26, 2.5). Not (0, 0, 0).
    pub position: [f64; 3],
    /// Any non-zero length. Default: towards the hole.
    pub forward: [f64; 3],
    /// Any non-zero length, not parallel to forward. Default +z.
    pub up: [f64; 3],
    /// Radians: full vertical angle, (0, pi), for PERSPECTIVE; across the circle, (0, 2 pi], for FISHEYE. Default pi
    /// / 4.
    pub fov_y: f64,
    /// BHR_MOTION_*. Default STATIC.
    pub motion: BhrMotion,
    /// Reserved: 0.
    pub reserved: u32,
    /// For BHR_MOTION_VELOCITY: v / c against the observer of the chart's triad (by default the local static one, the
    /// ZAMO), |v| < 1; components as for a direction given at position. Default 0.
    pub velocity: [f64; 3],
    /// For FRUSTUM: the borders of the picture on the plane at distance 1 ahead, to the right and up, within +-1e9;
    /// left less than right, down less than up. Default -1, 1, -1, 1. Other projections ignore them. @since 0.2.0
    pub tan_left: f64,
    /// The right border. @since 0.2.0
    pub tan_right: f64,
    /// The lower border. @since 0.2.0
    pub tan_down: f64,
    /// The upper border. @since 0.2.0
    pub tan_up: f64,
    /// Pixels that the whole picture moves to the right and down, each within +-1, for temporal antialiasing. For
    /// PERSPECTIVE and FRUSTUM; other projections ignore it. Default 0. @since 0.2.0
    pub jitter: [f64; 2],
    /// For EQUIRECT with an eye: the distance of the two eyes, scene lengths, at least 0. Default 0. @since 0.2.0
    pub eye_distance: f64,
    /// BHR_EYE_*. With LEFT or RIGHT and an eye_distance above 0 an EQUIRECT picture is one of two for 360-degree
    /// stereo (omnidirectional stereo, ODS), and takes longer. Bloom of a preset is then left out; other bloom, and
    /// all else of a film that regions cannot have, are INVALID_STATE; windows, bhr_project_point, outputs other than
    /// LIGHT, occluders and targets on the GPU are UNSUPPORTED. Other projections ignore it. Default MIDDLE.
    /// docs/cameras.md. @since 0.2.0
    pub eye: BhrEye,
    /// Reserved: 0. @since 0.2.0
    pub reserved2: u32,
    /// BHR_CHART_*: that of position, forward, up and velocity, of the time of bhr_set_time, and of the rays, paths
    /// and points that this context is asked for. RAIN is needed at and inside a spinning hole's horizon; a fall that
    /// is to go there must be told in it from the start. Default STATIC. @since 0.2.0
    pub chart: BhrChart,
    /// BHR_TRANSPORT_*. Default TRIAD. @since 0.2.0
    pub transport: BhrTransport,
}

// SAFETY: repr(C), size first, no padding, numbers only.
unsafe impl Versioned for BhrCamera {
    const NAME: &'static str = "BhrCamera";
    const SIZES: &'static [usize] = &[120, 184, 192];
    fn defaults() -> Self {
        Camera::default().into()
    }
}

impl From<Camera> for BhrCamera {
    fn from(camera: Camera) -> Self {
        Self {
            struct_size: 0,
            projection: camera.projection as BhrProjection,
            position: camera.position.to_array(),
            forward: camera.forward.to_array(),
            up: camera.up.to_array(),
            fov_y: camera.fov_y,
            motion: camera.motion as BhrMotion,
            reserved: 0,
            velocity: camera.velocity.to_array(),
            tan_left: camera.frustum.left,
            tan_right: camera.frustum.right,
            tan_down: camera.frustum.down,
            tan_up: camera.frustum.up,
            jitter: camera.jitter.to_array(),
            eye_distance: camera.eye_distance,
            eye: camera.eye as BhrEye,
            reserved2: 0,
            chart: camera.chart as BhrChart,
            transport: camera.transport as BhrTransport,
        }
    }
}

impl TryFrom<BhrCamera> for Camera {
    type Error = Error;

    fn try_from(given: BhrCamera) -> Result<Self> {
        let camera = Self {
            projection: projection(given.projection)?,
            position: given.position.into(),
            forward: given.forward.into(),
            up: given.up.into(),
            fov_y: given.fov_y,
            motion: motion(given.motion)?,
            velocity: given.velocity.into(),
            frustum: Frustum { left: given.tan_left, right: given.tan_right, down: given.tan_down, up: given.tan_up },
            jitter: given.jitter.into(),
            eye_distance: given.eye_distance,
            eye: eye(given.eye)?,
            chart: chart(given.chart, "camera")?,
            transport: transport(given.transport)?,
        };
        check_reserved(given.reserved, "camera")?;
        check_reserved(given.reserved2, "camera")?;
        camera.check()?;
        Ok(camera)
    }
}

fn transport(value: BhrTransport) -> Result<Transport> {
    Ok(match value {
        BHR_TRANSPORT_TRIAD => Transport::Triad,
        BHR_TRANSPORT_PARALLEL => Transport::Parallel,
        _ => return unknown(value, "camera transport", "BHR_TRANSPORT_TRIAD (0) and BHR_TRANSPORT_PARALLEL (1)"),
    })
}

fn projection(value: BhrProjection) -> Result<Projection> {
    Ok(match value {
        BHR_PROJECTION_PERSPECTIVE => Projection::Perspective,
        BHR_PROJECTION_FISHEYE => Projection::Fisheye,
        BHR_PROJECTION_EQUIRECT => Projection::Equirect,
        BHR_PROJECTION_CUBE => Projection::Cube,
        BHR_PROJECTION_FRUSTUM => Projection::Frustum,
        _ => {
            return unknown(value, "camera projection", "BHR_PROJECTION_PERSPECTIVE (0) to BHR_PROJECTION_FRUSTUM (4)");
        }
    })
}

fn eye(value: BhrEye) -> Result<Eye> {
    Ok(match value {
        BHR_EYE_MIDDLE => Eye::Middle,
        BHR_EYE_LEFT => Eye::Left,
        BHR_EYE_RIGHT => Eye::Right,
        _ => return unknown(value, "camera eye", "BHR_EYE_MIDDLE (0) to BHR_EYE_RIGHT (2)"),
    })
}

fn motion(value: BhrMotion) -> Result<Motion> {
    Ok(match value {
        BHR_MOTION_STATIC => Motion::Static,
        BHR_MOTION_FREE_FALL => Motion::FreeFall,
        BHR_MOTION_ORBIT => Motion::Orbit,
        BHR_MOTION_VELOCITY => Motion::Velocity,
        _ => return unknown(value, "camera motion", "BHR_MOTION_STATIC (0) to BHR_MOTION_VELOCITY (3)"),
    })
}

/// Fills in the defaults.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_camera_init(camera: *mut BhrCamera, struct_size: usize) -> BhrStatus {
    // SAFETY: NULL or struct_size writable bytes, by the header's conventions.
    anywhere("bhr_camera_init", || unsafe { versioned::init(camera, "camera", struct_size) })
}

/// Puts position, forward and up into a camera that bhr_camera_init filled in; the rest of it stays.
///
/// # Safety
/// `camera` is NULL or points to a BhrCamera.
unsafe fn aim(camera: *mut BhrCamera, position: DVec3, forward: DVec3, up: DVec3) -> Result<()> {
    Camera { position, forward, up, ..Camera::default() }.check()?;
    // SAFETY: this function's contract.
    unsafe {
        let given = versioned::read(camera, "camera")?;
        let (position, forward, up) = (position.to_array(), forward.to_array(), up.to_array());
        versioned::write(camera, "camera", &BhrCamera { position, forward, up, ..given })
    }
}

/// Sets position, forward (towards target) and up of a camera; touches no context.
/// Errors: INVALID_ARGUMENT for position (0, 0, 0) or equal to target, up zero or along the line of sight.
/// cbindgen:ptrs-as-arrays=[[position;3], [target;3], [up;3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_camera_look_at(
    camera: *mut BhrCamera,
    position: *const f64,
    target: *const f64,
    up: *const f64,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    anywhere("bhr_camera_look_at", || unsafe {
        versioned::caller_size(camera, "camera")?;
        let position = read_vector(position, "position")?;
        let target = check_finite_vector(read_vector(target, "target")?, "target")?;
        if position == target {
            return Err(Error::argument("position and target are the same place; there is no direction to look in"));
        }
        aim(camera, position, target - position, read_vector(up, "up")?)
    })
}

/// Below this distance from a pole (radians of elevation) +z is no usable "up".
const POLE: f64 = 1e-6;

/// Position on a sphere about the hole, and up; `elevation` and `azimuth` as for `bhr_camera_orbit`.
pub(super) fn orbit(distance: f64, azimuth: f64, elevation: f64) -> Result<(DVec3, DVec3)> {
    if !(distance.is_finite() && distance > 0.0) {
        let distance = Number(distance);
        return Err(Error::argument(format!("distance is {distance}; it must be finite and greater than 0")));
    }
    let (sin_az, cos_az) = check_finite(azimuth, "azimuth")?.sin_cos();
    let (sin_el, cos_el) = check_finite(elevation, "elevation")?.sin_cos();
    let position = distance * DVec3::new(cos_el * cos_az, cos_el * sin_az, sin_el);
    let up = if cos_el.abs() > POLE { DVec3::Z } else { -sin_el * DVec3::new(cos_az, sin_az, 0.0) };
    Ok((position, up))
}

/// Sets a camera at distance (> 0) from the hole, at azimuth from +x towards +y and elevation from the xy plane
/// towards +z (radians), looking at the hole: position = distance (cos el cos az, cos el sin az, sin el), up = +z.
/// Within 1e-6 of a pole up is the limit of what it is on the way there, -sin el (cos az, sin az, 0).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_camera_orbit(
    camera: *mut BhrCamera,
    distance: f64,
    azimuth: f64,
    elevation: f64,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    anywhere("bhr_camera_orbit", || unsafe {
        versioned::caller_size(camera, "camera")?;
        let (position, up) = orbit(distance, azimuth, elevation)?;
        aim(camera, position, -position, up)
    })
}

/// For depth of field: moves a PERSPECTIVE or FRUSTUM camera to place index (from 0) of count (1 to 65536) on a thin
/// lens of the diameter aperture (>= 0), and makes it a FRUSTUM one in which what lies at the distance focus (> 0)
/// ahead keeps its place. Frames from all places, each made from the same camera, add up by bhr_accumulate, with equal
/// weights (docs/motion-blur.md). aperture and focus are scene lengths; aspect (> 0) is the frame's width / height.
/// Errors: INVALID_ARGUMENT also for another projection, and for a struct_size without tan_up. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_camera_through_lens(
    camera: *mut BhrCamera,
    aperture: f64,
    focus: f64,
    aspect: f64,
    index: u32,
    count: u32,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    anywhere("bhr_camera_through_lens", || unsafe {
        let size = versioned::caller_size(camera, "camera")?;
        let least = offset_of!(BhrCamera, tan_up) + size_of::<f64>();
        if size < least {
            return Err(Error::argument(format!(
                "camera struct_size is {size}; a lens needs tan_up, so at least {least}"
            )));
        }
        let before: Camera = versioned::read(camera, "camera")?.try_into()?;
        let after = before.through_lens(&ThinLens { aperture, focus, aspect }, index, count)?;
        versioned::write(camera, "camera", &after.into())
    })
}

/// Sets the camera.
/// Errors: INVALID_ARGUMENT also for position (0, 0, 0), and forward or up that are zero or parallel.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_set_camera(context: *mut BhrContext, camera: *const BhrCamera) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_context("bhr_set_camera", context, |state| {
            state.renderer.scene.camera = versioned::read(camera, "camera")?.try_into()?;
            Ok(())
        })
    }
}

/// Reads the camera as it is set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_get_camera(context: *const BhrContext, camera: *mut BhrCamera) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let camera = OutStruct::cleared(camera, "camera");
        on_context("bhr_get_camera", context, |state| camera.set(&state.renderer.scene.camera.into()))
    }
}

/// Moves a camera along its own world line about the context's hole by proper_time (scene lengths, of any sign): a
/// STATIC one stays, a FREE_FALL one falls, an ORBIT one orbits, a VELOCITY one falls freely, which changes its
/// velocity. BhrCamera.transport says how axes go along. The context's own camera stays where it is.
/// *out_coordinate_time, unless NULL, becomes the time of the camera's chart that went by: add it to the time of
/// bhr_set_time. In chart RAIN a fall is seamless through the horizon, without spin in STATIC too (docs/cameras.md).
/// Errors: INVALID_ARGUMENT as bhr_set_camera; INVALID_STATE where the motion is not possible, and for a fall that
/// ends before: in the centre, at r- (1 + 1e-6), or in STATIC at the horizon; UNSUPPORTED for a STATIC camera with
/// PARALLEL axes, and for more than 300,000 steps.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_camera_advance(
    context: *const BhrContext,
    camera: *mut BhrCamera,
    proper_time: f64,
    out_coordinate_time: *mut f64,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let out = Out::cleared(out_coordinate_time);
        on_context("bhr_camera_advance", context, |state| {
            if camera.is_null() {
                return Err(is_null("camera"));
            }
            let before = versioned::read(camera, "camera")?.try_into()?;
            let proper_time = check_finite(proper_time, "proper_time")?;
            let (after, coordinate_time) = state.renderer.scene.advance_camera(&before, proper_time)?;
            versioned::write(camera, "camera", &after.into())?;
            out.set(coordinate_time);
            Ok(())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    #[test]
    fn an_orbit_camera_is_valid_at_every_elevation() {
        for azimuth in [-3.0, 0.0, 0.7, PI] {
            for elevation in [-FRAC_PI_2, -1.5, 0.0, 1.0, FRAC_PI_2 - 2e-6, FRAC_PI_2 - 1e-7, FRAC_PI_2, 2.0] {
                let (position, up) = orbit(30.0, azimuth, elevation).unwrap();
                let camera = Camera { position, forward: -position, up, ..Camera::default() };
                camera.check().unwrap();
                assert!((position.length() - 30.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn the_image_does_not_turn_on_the_way_to_a_pole() {
        for pole in [FRAC_PI_2, -FRAC_PI_2] {
            let axes = |elevation: f64| {
                let (position, up) = orbit(30.0, 0.7, elevation).unwrap();
                Camera { position, forward: -position, up, ..Camera::default() }.axes().unwrap()
            };
            let near = axes(pole * (1.0 - 1e-5));
            assert!(near.abs_diff_eq(axes(pole), 1e-4), "{near} {}", axes(pole));
        }
    }

    #[test]
    fn the_struct_and_the_scene_agree() {
        let camera = Camera { motion: Motion::Velocity, velocity: DVec3::new(0.1, 0.2, 0.3), ..Camera::default() };
        assert_eq!(Camera::try_from(BhrCamera::from(camera)).unwrap(), camera);
        let error = Camera::try_from(BhrCamera { motion: 9, ..BhrCamera::defaults() }).unwrap_err();
        assert!(error.message.contains("motion is 9"), "{error}");
    }
}
