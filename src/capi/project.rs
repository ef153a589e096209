// SPDX-License-Identifier: MIT OR Apache-2.0
//! BhrProjectedPoint: where on the screen points of the scene appear. Knows no rays but those that it hands out.

use super::call::on_context;
use super::context::BhrContext;
use super::entry::anywhere;
use super::pointer::read_vector;
use super::rays::{Array, BhrRay, CHUNK, frame_pixels};
use super::status::BhrStatus;
use super::versioned::{self, OutStruct, Versioned, check_named_size};
use crate::allocate::{filled, with_room};
use crate::scene::Ray;
use crate::scene::project::{HIGHEST_ORDER, Projected, ProjectedPoint};
use glam::DVec3;
use std::mem::size_of;

/// The highest order that bhr_project_point looks for. @since 0.2.0
pub const BHR_MAX_IMAGE_ORDER: u32 = 3u32;

const _: () = assert!(BHR_MAX_IMAGE_ORDER == HIGHEST_ORDER);

/// An image of a point: where on the screen it appears, and how. @since 0.2.0
#[repr(C)]
#[derive(Clone, Copy)]
pub struct BhrProjectedPoint {
    /// sizeof(BhrProjectedPoint), set by the caller.
    pub struct_size: u32,
    /// 1: a ray to the point was found. 0: there is none (the point is in the hole, or where the camera is), or it
    /// is lost; the numbers are then NaN, the ray's 0.
    pub found: u32,
    /// 1: it is within the image, whatever matter or sky may be before it. 0: beside it, or not found.
    pub on_screen: u32,
    /// 1: none was found, though there may be one.
    pub lost: u32,
    /// Pixel position to the right, as of bhr_camera_ray; beyond the image where it is not on the screen. NaN where
    /// the projection has no place for the direction: behind a PERSPECTIVE or FRUSTUM.
    pub x: f64,
    /// Pixel position downwards, likewise.
    pub y: f64,
    /// The ray from the camera to the point, on the screen or not: bhr_camera_ray at x, y.
    pub ray: BhrRay,
    /// The solid angle in which the camera, moving as it does, sees something small at the point, over A / distance^2,
    /// that without the hole; negative where the image is mirrored. A is its area square to the light, as the ZAMO
    /// there measures it (any observer there finds the same); its area in chart coordinates is less near the hole,
    /// without spin by sqrt(1 - 2 M / r) where it lies along the radius. It grows without limit near a caustic.
    pub magnification: f64,
    /// Coordinate time (in chart RAIN rain time) since the light left the point, scene lengths; NaN from inside the
    /// horizon in chart STATIC.
    pub delay: f64,
    /// g = nu(camera) / nu(observer at rest at the point, with spin the ZAMO).
    pub redshift: f64,
    /// The straight distance from the camera to the point, scene lengths: its depth for BHR_OUTPUT_DEPTH and
    /// bhr_set_occluder.
    pub distance: f64,
    /// Where the point seems to be, scene axes: as far from the camera as it is, in the direction of its image. A
    /// vertex that is drawn here with the camera's own matrices appears at x, y, with the depth that belongs to it.
    pub apparent: [f64; 3],
}

// SAFETY: repr(C), size first, no padding, numbers only.
unsafe impl Versioned for BhrProjectedPoint {
    const NAME: &'static str = "BhrProjectedPoint";
    const SIZES: &'static [usize] = &[144];
    fn defaults() -> Self {
        Projected::Nowhere.into()
    }
}

impl From<Projected> for BhrProjectedPoint {
    fn from(projected: Projected) -> Self {
        let image = match projected {
            Projected::At(image) => Some(image),
            Projected::Nowhere | Projected::Lost => None,
        };
        let nothing = Ray { position: DVec3::ZERO, direction: DVec3::ZERO, frequency_ratio: 0.0 };
        let position = image.and_then(|image| image.position);
        let number = |of: fn(&ProjectedPoint) -> f64| image.as_ref().map_or(f64::NAN, of);
        Self {
            struct_size: 0,
            found: image.is_some().into(),
            on_screen: image.is_some_and(|image| image.on_screen).into(),
            lost: (projected == Projected::Lost).into(),
            x: position.map_or(f64::NAN, |at| at.x),
            y: position.map_or(f64::NAN, |at| at.y),
            ray: image.map_or(nothing, |image| image.ray).into(),
            magnification: number(|image| image.magnification),
            delay: number(|image| image.delay),
            redshift: number(|image| image.redshift),
            distance: number(|image| image.distance),
            apparent: image.map_or(DVec3::NAN, |image| image.apparent).to_array(),
        }
    }
}

/// Fills in struct_size, which calls that fill the struct read, and what stands for no image. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_projected_point_init(point: *mut BhrProjectedPoint, struct_size: usize) -> BhrStatus {
    // SAFETY: NULL or struct_size writable bytes, by the header's conventions.
    anywhere("bhr_projected_point_init", || unsafe { versioned::init(point, "point", struct_size) })
}

/// Where in a width x height image (with a region: that is this part of a frame) a point of the scene appears: the
/// inverse of bhr_camera_ray. point: scene axes and lengths. order: how often the light went half round the hole; 0
/// is the direct image, 1 that on the hole's other side, to BHR_MAX_IMAGE_ORDER. Every point outside the horizon has
/// an image of each order, also behind the hole; whether matter is before it is for the host to ask
/// (bhr_trace_rays). Computed in double precision on this thread. docs/cameras.md has times and accuracy, and what
/// becomes of images with spin.
/// Errors: INVALID_STATE for a point farther than 1e15 M; else those of bhr_camera_ray. @since 0.2.0
/// cbindgen:ptrs-as-arrays=[[point;3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_project_point(
    context: *const BhrContext,
    width: u32,
    height: u32,
    point: *const f64,
    order: u32,
    out_image: *mut BhrProjectedPoint,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let out = OutStruct::cleared(out_image, "out_image");
        on_context("bhr_project_point", context, |state| {
            frame_pixels(width, height)?;
            let point = read_vector(point, "point")?;
            let projector = state.renderer.scene.projector(width, height, state.region, order)?;
            out.set(&projector.point(point)?.into())
        })
    }
}

/// bhr_project_point for many points, such as the vertices of a mesh, on as many threads as the machine has cores.
/// points: 3 count doubles, x, y, z of each. image_size: sizeof(BhrProjectedPoint) as the caller was compiled;
/// out_images has room for count, packed, and each gets that size as its struct_size, which need not be set before.
/// A point that is not finite, or farther than 1e15 M, has no image and is no error of the others. With count 0 the
/// call does nothing. Other calls of the context wait until it returns. An error leaves out_images alone.
/// docs/compositing.md.
/// Errors: those of bhr_project_point. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_project_points(
    context: *const BhrContext,
    width: u32,
    height: u32,
    points: *const f64,
    count: usize,
    order: u32,
    out_images: *mut BhrProjectedPoint,
    image_size: usize,
) -> BhrStatus {
    // SAFETY: NULL or count elements, by the header's conventions.
    unsafe {
        on_context("bhr_project_points", context, |state| {
            frame_pixels(width, height)?;
            let element = 3 * size_of::<f64>();
            let from = Array::new(points.cast_mut().cast(), element, element, count, ["points", "size of a point"])?;
            check_named_size::<BhrProjectedPoint>(image_size, "image_size")?;
            let first = BhrProjectedPoint::SIZES[0];
            let to = Array::new(out_images.cast(), image_size, first, count, ["out_images", "image_size"])?;
            let projector = state.renderer.scene.projector(width, height, state.region, order)?;
            let most = CHUNK.min(count);
            let mut places = with_room(most, "points to project")?;
            let mut found = filled(most, Projected::Nowhere, "images of points")?;
            let mut begin = 0;
            while begin < count {
                let length = CHUNK.min(count - begin);
                places.clear();
                places.extend((begin..begin + length).map(|index| from.read_vector(index)));
                projector.points(&places, &mut found[..length]);
                for (index, projected) in (begin..).zip(&found[..length]) {
                    versioned::fill(to.at(index).cast(), image_size, &BhrProjectedPoint::from(*projected));
                }
                begin += length;
            }
            Ok(())
        })
    }
}
