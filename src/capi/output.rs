// SPDX-License-Identifier: MIT OR Apache-2.0
//! BhrOutput: what a host can have of a frame beside its picture.

use super::array::{Names, read_array};
use super::call::on_context;
use super::context::BhrContext;
use super::entry::anywhere;
use super::image::{self, BhrImage, path_of};
use super::interop_target::BhrTarget;
use super::job::{BhrJob, new_job};
use super::pointer::{Out, check_reserved, is_null, unknown};
use super::progress::Report;
use super::scene_file::parameters;
use super::status::BhrStatus;
use super::versioned::{self, POINTER, Versioned};
use super::view::view;
use crate::error::{Error, ErrorKind, Result};
use crate::job::OutputTarget;
use crate::renderer::SharedOutput;
use crate::scene::{MOST_CROSSINGS, MOST_OUTPUTS, Output, RayOutput, RayOutputKind, View};
use arrayvec::ArrayVec;
use std::ffi::{c_char, c_void};
use std::ptr::{null, null_mut};

/// Outputs of one call at most. @since 0.2.0
pub const BHR_MAX_OUTPUTS: u32 = 8u32;

/// A kind of output. All but LIGHT are numbers of the one ray through a pixel's centre: they are not filtered, and
/// not to be averaged across edges. Scene lengths and axes; crossings are those within the disk's radii, in the
/// order in which the ray from the camera meets them, so that without a disk there are none. Outside a fisheye's
/// circle SKY and TRANSMISSION are 0, the others NaN. @since 0.2.0
pub type BhrOutputKind = i32;
/// The picture, or with BhrView another than LIGHT its values: what bhr_render_image makes, byte for byte, in any
/// format that goes with the view. index: 0.
pub const BHR_OUTPUT_LIGHT: BhrOutputKind = 0;
/// R32F: the distance from the camera to what the ray meets first: along a straight line to the direct image of the
/// disk; for light of higher orders, and captured rays, to the point of the line of sight that is nearest to the
/// hole, 0 where that lies behind; infinity where the ray escapes without a crossing. Volumes and hot spots have
/// none. A linear depth is this times the cosine of the angle to the forward axis. index: 0.
pub const BHR_OUTPUT_DEPTH: BhrOutputKind = 1;
/// RGBA32F, the lens map: the unit vector from which the light of the sky comes, and g = nu(camera) / nu(at
/// infinity). All 0 where the ray is captured or unresolved. The disk does not hide it (see TRANSMISSION). index: 0.
pub const BHR_OUTPUT_SKY: BhrOutputKind = 2;
/// R32F: the share of the sky's light that the disk, volumes and hot spots let pass, 0 .. 1; 0 where the ray is
/// captured. The alpha of a TRANSPARENT picture is 1 less the mean of this over a pixel. index: 0.
pub const BHR_OUTPUT_TRANSMISSION: BhrOutputKind = 3;
/// RGBA32F: x, y, z of crossing number index, and its order, 0 for the direct image. Without that crossing x, y, z
/// are NaN, and the fourth is -1 where the ray escapes, -2 where it is captured, NaN where it is unresolved.
pub const BHR_OUTPUT_POSITION: BhrOutputKind = 4;
/// RGBA32F: radius, azimuth, redshift and delay of crossing number index, as in BhrCrossing; NaN without that
/// crossing. The delay is NaN for cameras in chart STATIC at or inside the photon sphere that fall.
pub const BHR_OUTPUT_DISK: BhrOutputKind = 5;
/// R32F: the value of the view whose BHR_VIEW_* index is, but not LIGHT. Views but REDSHIFT, ORDER and DEFLECTION
/// take as long as a frame of their own.
pub const BHR_OUTPUT_VIEW: BhrOutputKind = 6;

/// An output and where it goes. Begin with bhr_output_init. @since 0.2.0
#[repr(C)]
#[derive(Clone, Copy)]
pub struct BhrOutput {
    /// sizeof(BhrOutput).
    pub struct_size: u32,
    /// BHR_OUTPUT_*. Default LIGHT.
    pub kind: BhrOutputKind,
    /// POSITION, DISK: the number of a crossing, 0 .. 15. VIEW: BHR_VIEW_*. Otherwise 0. Default 0.
    pub index: u32,
    /// Reserved: 0.
    pub reserved: u32,
    /// The image, in the format of its kind; NULL with target. Of its flags BHR_IMAGE_TRANSPARENT matters for LIGHT
    /// only.
    pub image: *const BhrImage,
    /// A BhrTarget on the GPU instead of image, for bhr_render_outputs_shared of bhr_interop.h; else NULL.
    pub target: *mut c_void,
}

// SAFETY: repr(C), size first, no padding, integers and nullable pointers.
unsafe impl Versioned for BhrOutput {
    const NAME: &'static str = "BhrOutput";
    const SIZES: &'static [usize] = &[16 + 2 * POINTER];
    fn defaults() -> Self {
        Self { struct_size: 0, kind: BHR_OUTPUT_LIGHT, index: 0, reserved: 0, image: null(), target: null_mut() }
    }
}

const OUTPUTS: Names = Names { array: "outputs", size: "output_size", count: "output count" };

/// An output as the host gave it, its numbers checked.
#[derive(Clone, Copy)]
struct Given {
    output: Output,
    image: *const BhrImage,
    target: *mut c_void,
}

impl TryFrom<BhrOutput> for Given {
    type Error = Error;

    fn try_from(given: BhrOutput) -> Result<Self> {
        let BhrOutput { kind, index, .. } = given;
        check_reserved(given.reserved, "its")?;
        let most = match kind {
            BHR_OUTPUT_POSITION | BHR_OUTPUT_DISK => MOST_CROSSINGS - 1,
            BHR_OUTPUT_VIEW => u32::MAX,
            _ => 0,
        };
        let of_ray = |kind| Output::Ray(RayOutput { kind, index });
        let output = match kind {
            BHR_OUTPUT_LIGHT => Output::Light,
            BHR_OUTPUT_DEPTH => of_ray(RayOutputKind::Depth),
            BHR_OUTPUT_SKY => of_ray(RayOutputKind::Sky),
            BHR_OUTPUT_TRANSMISSION => of_ray(RayOutputKind::Transmission),
            BHR_OUTPUT_POSITION => of_ray(RayOutputKind::Position),
            BHR_OUTPUT_DISK => of_ray(RayOutputKind::Disk),
            BHR_OUTPUT_VIEW => match view(i32::try_from(index).unwrap_or(i32::MAX), "its index")? {
                View::Light => {
                    return Err(Error::argument("its index is 0, BHR_VIEW_LIGHT; that is the kind BHR_OUTPUT_LIGHT"));
                }
                view => Output::of_view(view),
            },
            _ => return unknown(kind, "its kind", "BHR_OUTPUT_LIGHT (0) to BHR_OUTPUT_VIEW (6)"),
        };
        if index > most {
            return Err(Error::argument(format!("its index is {index}; for its kind it must be at most {most}")));
        }
        Ok(Self { output, image: given.image, target: given.target })
    }
}

type GivenOutputs = ArrayVec<Given, MOST_OUTPUTS>;

const _: () = assert!(MOST_OUTPUTS == BHR_MAX_OUTPUTS as usize);

/// Errors: INVALID_ARGUMENT for a number outside its range, or NULL.
///
/// # Safety
/// `outputs` is NULL or points to `count` structs of `size` readable bytes.
unsafe fn read_given(outputs: *const BhrOutput, size: usize, count: u32) -> Result<GivenOutputs> {
    // SAFETY: this function's contract.
    let given: GivenOutputs = unsafe { read_array(outputs, size, count, &OUTPUTS) }?;
    if given.is_empty() {
        return Err(Error::argument(format!("output count is 0; it must lie in [1, {MOST_OUTPUTS}]")));
    }
    Ok(given)
}

/// Outputs that go into targets and images. `is_job`: the host is told when the frame has ended. Errors:
/// INVALID_ARGUMENT as [`read`], with neither a target nor an image, or with both, and for an image without a job.
///
/// # Safety
/// As [`read`], with targets in the place of some images; these are the host's until the frame has ended.
pub(super) unsafe fn read_shared<'a>(
    outputs: *const BhrOutput,
    size: usize,
    count: u32,
    is_job: bool,
) -> Result<Vec<(Output, SharedOutput<'a>)>> {
    // SAFETY: this function's contract.
    let given = unsafe { read_given(outputs, size, count) }?;
    let places = given.iter().enumerate().map(|(index, given)| {
        // SAFETY: as above.
        let target = unsafe { given.target.cast::<BhrTarget>().as_ref() };
        let place = match (target, given.image.is_null()) {
            (Some(target), true) => SharedOutput::Target(&target.target),
            (Some(_), false) => {
                return Err(Error::argument(format!(
                    "outputs[{index}] has an image and a target; it goes into one of them"
                )));
            }
            (None, true) => return Err(is_null(&format!("outputs[{index}] target, without an image,"))),
            (None, false) if !is_job => {
                return Err(Error::argument(format!(
                    "outputs[{index}] has an image, which is complete when the job is, and out_job is NULL"
                )));
            }
            (None, false) => {
                // SAFETY: as above.
                let image = unsafe { image::read(given.image, &format!("outputs[{index}] image")) }?;
                SharedOutput::Image(image.pixels, image.transparent)
            }
        };
        Ok((given.output, place))
    });
    places.collect()
}

/// Errors: INVALID_ARGUMENT for a number outside its range, NULL, or what is wrong with an output or its image.
///
/// # Safety
/// `outputs` is NULL or points to `count` structs of `size` readable bytes, whose images are NULL or images of the
/// host's during `'a`.
unsafe fn read<'a>(outputs: *const BhrOutput, size: usize, count: u32) -> Result<Vec<OutputTarget<'a>>> {
    // SAFETY: this function's contract.
    let given = unsafe { read_given(outputs, size, count) }?;
    let targets = given.iter().enumerate().map(|(index, given)| {
        if !given.target.is_null() {
            return Err(Error::argument(format!(
                "outputs[{index}] target is not NULL; bhr_render_outputs_shared writes into targets, and images with \
                 them"
            )));
        }
        let name = format!("outputs[{index}] image");
        // SAFETY: as above.
        let image = unsafe { image::read(given.image, &name) }?;
        Ok(OutputTarget { output: given.output, target: image.pixels, transparent: image.transparent })
    });
    targets.collect()
}

/// Fills in the defaults. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_output_init(output: *mut BhrOutput, struct_size: usize) -> BhrStatus {
    // SAFETY: NULL or struct_size writable bytes, by the header's conventions.
    anywhere("bhr_output_init", || unsafe { versioned::init(output, "output", struct_size) })
}

/// Renders several outputs of the scene as it is now: count of them, packed, 1 .. BHR_MAX_OUTPUTS, whose images are
/// of one size; the region, if one is set, is theirs. LIGHT has the bytes that bhr_render_image makes;
/// docs/compositing.md says how exact the others are. out_job NULL: the call returns when all of it is there, and
/// reports to the progress callback. Otherwise *out_job becomes a job as bhr_render_image_async makes them; images
/// are then written until it is done or destroyed. output_size = sizeof(BhrOutput) as the caller was compiled; no
/// output's struct_size may be larger.
/// Errors: those of bhr_render_image, or of bhr_render_image_async; INVALID_ARGUMENT for images of several sizes, a
/// format that does not go with its kind, or a target; UNSUPPORTED for outputs other than LIGHT where BhrCamera.eye
/// has effect. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_render_outputs(
    context: *mut BhrContext,
    outputs: *const BhrOutput,
    output_size: usize,
    count: u32,
    out_job: *mut *mut BhrJob,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions; the images' blocks are the host's until the end.
    unsafe {
        let out = Out::cleared(out_job);
        on_context("bhr_render_outputs", context, |state| {
            let targets = read(outputs, output_size, count)?;
            if !out_job.is_null() {
                let job = state.renderer.render_outputs_in_background(targets, state.region)?;
                let context = context.as_ref().ok_or_else(|| is_null("context"))?;
                out.set(new_job(context, job, state));
                return Ok(());
            }
            let mut report = Report::new(state.progress);
            if !report.tell(0.0) {
                return Err(Error::new(ErrorKind::Cancelled, "the progress callback cancelled the frame at its begin"));
            }
            let frame = state.renderer.render_outputs(targets, state.region, &mut |fraction| report.tell(fraction));
            if frame.is_ok() {
                report.finish();
            }
            frame
        })
    }
}

/// Writes outputs that bhr_render_outputs has made to an .exr file: one part with a layer for each, and among its
/// attributes every parameter of the scene that the frame of the first output showed; for pixels that are not of the
/// last 512 images of this context, of the scene as it is now. docs/files.md lists channels and attributes. Alpha is
/// written as it is. A file is replaced as bhr_image_save does it.
/// Errors: INVALID_ARGUMENT as bhr_render_outputs, for two outputs of the same channels, or LIGHT in R32F;
/// UNSUPPORTED for another extension, LIGHT in a format of 8 or 10 bits, or a library that was built without EXR; IO.
/// @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_save_outputs(
    context: *const BhrContext,
    outputs: *const BhrOutput,
    output_size: usize,
    count: u32,
    path: *const c_char,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_context("bhr_save_outputs", context, |state| {
            let targets = read(outputs, output_size, count)?;
            state.renderer.save_outputs(&targets, state.region, parameters, &path_of(path)?)
        })
    }
}
