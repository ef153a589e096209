// SPDX-License-Identifier: MIT OR Apache-2.0
//! Cameras from and to the view and projection matrices of rasterisers.

use super::camera::BhrCamera;
use super::entry::anywhere;
use super::pointer::{Out, check_flags, is_null};
use super::status::BhrStatus;
use super::versioned::{self};
use crate::error::{Error, Result};
use crate::scene::Camera;
use crate::scene::matrices::ClipSpace;
use glam::DMat4;
use std::mem::size_of;

/// Matrices lie in memory row by row, else column by column. For matrices that multiply row vectors (DirectXMath,
/// Unreal) it is the other way round: those that lie in memory row by row are given without this flag.
pub const BHR_MATRIX_ROW_MAJOR: u32 = 1u32;
/// Clip space's y = +1 is the image's bottom row, as in Vulkan; else its top row, as in OpenGL, Direct3D and Metal.
pub const BHR_MATRIX_Y_DOWN: u32 = 2u32;
/// Depths lie in 0 .. 1, else in -1 .. 1 (OpenGL). bhr_camera_from_matrices does not ask for it.
pub const BHR_MATRIX_ZERO_TO_ONE: u32 = 4u32;
/// The near plane has the greatest depth, the far one the least. bhr_camera_from_matrices does not ask for it.
pub const BHR_MATRIX_REVERSED: u32 = 8u32;
/// The camera looks along its own +z, with x to the right and y up (Direct3D, Unreal), else along -z (OpenGL,
/// Vulkan, Unity). bhr_camera_from_matrices sees it in the projection.
pub const BHR_MATRIX_FORWARD_Z: u32 = 16u32;

const KNOWN: u32 =
    BHR_MATRIX_ROW_MAJOR | BHR_MATRIX_Y_DOWN | BHR_MATRIX_ZERO_TO_ONE | BHR_MATRIX_REVERSED | BHR_MATRIX_FORWARD_Z;

fn clip_space(flags: u32) -> ClipSpace {
    ClipSpace {
        y_down: flags & BHR_MATRIX_Y_DOWN != 0,
        zero_to_one: flags & BHR_MATRIX_ZERO_TO_ONE != 0,
        reversed: flags & BHR_MATRIX_REVERSED != 0,
        forward_z: flags & BHR_MATRIX_FORWARD_Z != 0,
    }
}

/// # Safety
/// `pointer` is NULL or points to sixteen readable doubles, aligned or not.
unsafe fn read_matrix(pointer: *const f64, name: &str, flags: u32) -> Result<DMat4> {
    if pointer.is_null() {
        return Err(is_null(name));
    }
    // SAFETY: not NULL, hence sixteen doubles by this function's contract.
    let matrix = DMat4::from_cols_array(&unsafe { pointer.cast::<[f64; 16]>().read_unaligned() });
    Ok(if flags & BHR_MATRIX_ROW_MAJOR != 0 { matrix.transpose() } else { matrix })
}

/// Sets position, forward, up and the picture (projection FRUSTUM, its tangents, jitter 0) of a camera from the
/// host's matrices; the rest of it, such as its motion, stays. Touches no context.
///
/// view takes the world, whose origin is the hole's centre and whose lengths are scene lengths, to the camera: a
/// rotation and a shift, without scale. projection is any perspective one, off-axis, jittered, with reversed or
/// infinite depths; its row of depths is not read. flags: BHR_MATRIX_ROW_MAJOR and BHR_MATRIX_Y_DOWN. The world is
/// right-handed: docs/cameras.md says how Unity and Unreal, whose worlds are not, negate an axis.
/// Errors: INVALID_ARGUMENT also for a view that is not rigid to 1e-4, a projection that is orthographic, sheared or
/// rolled, matrices that mirror the scene (left-handed worlds), the hole's centre as position, and a camera whose
/// struct_size ends before jitter does. @since 0.2.0
/// cbindgen:ptrs-as-arrays=[[view;16], [projection;16]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_camera_from_matrices(
    camera: *mut BhrCamera,
    view: *const f64,
    projection: *const f64,
    flags: u32,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    anywhere("bhr_camera_from_matrices", || unsafe {
        let size = versioned::caller_size(camera, "camera")?;
        let needed = std::mem::offset_of!(BhrCamera, jitter) + size_of::<[f64; 2]>();
        if size < needed {
            return Err(Error::argument(format!(
                "camera struct_size is {size}; a FRUSTUM needs {needed}, a BhrCamera with tangents and jitter"
            )));
        }
        let flags = check_flags(flags, KNOWN, "flags")?;
        let view = read_matrix(view, "view", flags)?;
        let projection = read_matrix(projection, "projection", flags)?;
        let before: Camera = versioned::read(camera, "camera")?.try_into()?;
        let after = before.from_matrices(&view, &projection, clip_space(flags).y_down)?;
        versioned::write(camera, "camera", &after.into())
    })
}

/// The view and the projection of a PERSPECTIVE or FRUSTUM camera, as bhr_camera_from_matrices takes them: for
/// pixels of a width x height frame with the planes near_z > 0 and far_z > near_z, or INFINITY. flags: any of
/// BHR_MATRIX_*. For a left-handed world multiply the view by the same scale again. The camera's motion does not
/// enter: an observer that moves sees directions aberrated, which no matrix says. Touches no context.
/// Errors: INVALID_ARGUMENT also for another projection, and a camera that bhr_set_camera would refuse. @since 0.2.0
/// cbindgen:ptrs-as-arrays=[[out_view;16], [out_projection;16]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_camera_matrices(
    camera: *const BhrCamera,
    width: u32,
    height: u32,
    near_z: f64,
    far_z: f64,
    flags: u32,
    out_view: *mut f64,
    out_projection: *mut f64,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    anywhere("bhr_camera_matrices", || unsafe {
        let outs = [out_view, out_projection].map(|out| Out::<[f64; 16]>::cleared(out.cast()));
        outs[0].required("out_view")?;
        outs[1].required("out_projection")?;
        let flags = check_flags(flags, KNOWN, "flags")?;
        let camera: Camera = versioned::read(camera, "camera")?.try_into()?;
        let made = camera.matrices([width, height], [near_z, far_z], clip_space(flags))?;
        for (out, matrix) in outs.iter().zip(made) {
            let matrix = if flags & BHR_MATRIX_ROW_MAJOR != 0 { matrix.transpose() } else { matrix };
            out.set(matrix.to_cols_array());
        }
        Ok(())
    })
}
