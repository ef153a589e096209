// SPDX-License-Identifier: MIT OR Apache-2.0
//! BhrTransfer: the matter with depth along single rays.

use super::call::on_context;
use super::context::BhrContext;
use super::rays::{Array, BhrFate, BhrRay, CHUNK};
use super::status::BhrStatus;
use crate::allocate::{filled, with_room};
use crate::error::Result;
use crate::renderer::Renderer;
use crate::scene::Transfer;
use bytemuck::{Pod, Zeroable};
use std::mem::size_of;

/// How the volumes and hot spots along a ray shine, and how much they absorb. nu_camera is the one frequency at
/// which a picture shows power laws (BhrVolume). It may grow: bhr_transfer_rays is told its size. @since 0.2.0
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct BhrTransfer {
    /// BHR_FATE_*.
    pub fate: BhrFate,
    /// Reserved: 0.
    pub reserved: u32,
    /// The specific intensity I_nu of power laws at nu_camera where the ray begins, 0 and up, in units of the
    /// emission of 1 M of matter at density 1 that is at rest; brightness and tint do not count, and thermal matter
    /// adds none. NaN for a ray that is not valid; a BHR_FATE_UNRESOLVED one has the part as far as it was followed,
    /// and so has its light.
    pub intensity: f64,
    /// At nu_camera, of all volumes and hot spots together, 0 and up: of light from behind them the share
    /// e^-optical_depth passes. Above 300 the number says only that it is more. NaN unless the ray is
    /// BHR_FATE_ESCAPED.
    pub optical_depth: f64,
    /// The light that a picture shows of all volumes and hot spots, linear Rec. 709 before exposure, with
    /// brightness, tint and the effects that are set. NaN for a ray that is not valid.
    pub light: [f64; 3],
}

/// The sizes of a BhrTransfer, as `Versioned::SIZES` of structs that hold theirs.
const TRANSFER_SIZES: [usize; 1] = [48];

const _: () = assert!(TRANSFER_SIZES[TRANSFER_SIZES.len() - 1] == size_of::<BhrTransfer>());

impl From<Transfer> for BhrTransfer {
    fn from(found: Transfer) -> Self {
        Self {
            fate: found.fate as BhrFate,
            reserved: 0,
            intensity: found.intensity,
            optical_depth: found.optical_depth,
            light: found.light,
        }
    }
}

/// # Safety
/// `rays` and `out` hold `count` elements.
unsafe fn transfer_all(renderer: &mut Renderer, rays: Array, out: Array, count: usize) -> Result<()> {
    let most = CHUNK.min(count);
    let mut chunk = with_room(most, "rays to trace")?;
    let mut found = filled(most, Transfer::default(), "the matter along rays")?;
    let mut begin = 0;
    while begin < count {
        let length = CHUNK.min(count - begin);
        chunk.clear();
        for index in begin..begin + length {
            // SAFETY: the indices are below `count`.
            chunk.push(unsafe { rays.read_ray(index) }?);
        }
        renderer.transfer_rays(&chunk, &mut found[..length])?;
        for (index, found) in (begin..).zip(&found[..length]) {
            // SAFETY: as above.
            unsafe { out.write(index, bytemuck::bytes_of(&BhrTransfer::from(*found))) };
        }
        begin += length;
    }
    Ok(())
}

/// Sums the matter of volumes and hot spots along count rays, the thin disk and the sky left out, in double
/// precision on the CPU, whatever the backend; on BHR_BACKEND_CPU on all of its threads, else on the calling one.
/// The scene's time is that of the rays' observers, at rest where they are; hot spots and structure are seen at
/// their retarded time with BHR_EFFECT_LIGHT_DELAY. ray_size = sizeof(BhrRay) and out_size = sizeof(BhrTransfer) as
/// the caller was compiled, at least 56 and 48; otherwise the arrays are as for bhr_trace_rays. An error on the way
/// clears out. docs/matter.md says how exact it is. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_transfer_rays(
    context: *mut BhrContext,
    rays: *const BhrRay,
    ray_size: usize,
    count: usize,
    out: *mut BhrTransfer,
    out_size: usize,
) -> BhrStatus {
    // SAFETY: NULL or count elements, by the header's conventions.
    unsafe {
        on_context("bhr_transfer_rays", context, |state| {
            let from = Array::new(rays.cast_mut().cast(), ray_size, size_of::<BhrRay>(), count, ["rays", "ray_size"])?;
            let to = Array::new(out.cast(), out_size, TRANSFER_SIZES[0], count, ["out", "out_size"])?;
            if count > 0 {
                state.renderer.check_transfer()?;
            }
            let result = transfer_all(&mut state.renderer, from, to, count);
            if result.is_err() {
                to.clear(count);
            }
            result
        })
    }
}
