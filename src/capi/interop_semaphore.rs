// SPDX-License-Identifier: MIT OR Apache-2.0
//! BhrSemaphore: who waits for whom on the GPU. One `Semaphore`, shared with its context, which may go first.

use super::call::{keep, on_context};
use super::context::BhrContext;
use super::entry::{SuccessStatus, destroy, give_back, outside_callbacks};
use super::interop_info::{BHR_HANDLE_HOST_POINTER, BHR_HANDLE_OPAQUE_FD, BhrHandleType};
use super::interop_target::{BhrHandle, NO_HANDLE, read_handle};
use super::log::{self, Sink};
use super::message::LastMessage;
use super::pointer::{Out, is_null, unknown};
use super::status::{BHR_NOT_READY, BHR_OK, BhrStatus};
use crate::error::{Error, Result};
use crate::gpu::{NOT_RUN, SemaphoreKind, SemaphoreOrigin};
use crate::interop::Semaphore;
use crate::platform::close_descriptor;
use crate::thread_state::Call;
use std::sync::Arc;
use std::time::Duration;

/// A semaphore that both sides reach. It belongs to its context; end it with bhr_semaphore_destroy, before or after
/// the context.
pub struct BhrSemaphore {
    pub(super) semaphore: Arc<Semaphore>,
    sink: Option<Arc<Sink>>,
    /// The context's.
    message: Arc<LastMessage>,
}

/// A semaphore's kind.
pub type BhrSemaphoreKind = i32;
/// Has a value, which grows: Vulkan, CUDA, GL_NV_timeline_semaphore.
pub const BHR_SEMAPHORE_TIMELINE: BhrSemaphoreKind = 0;
/// Each signal is waited for exactly once, after it was submitted: Vulkan, OpenGL.
pub const BHR_SEMAPHORE_BINARY: BhrSemaphoreKind = 1;

fn kind_of(kind: BhrSemaphoreKind) -> Result<SemaphoreKind> {
    Ok(match kind {
        BHR_SEMAPHORE_TIMELINE => SemaphoreKind::Timeline,
        BHR_SEMAPHORE_BINARY => SemaphoreKind::Binary,
        _ => return unknown(kind, "kind", "BHR_SEMAPHORE_TIMELINE (0) and BHR_SEMAPHORE_BINARY (1)"),
    })
}

/// A call on a semaphore alone: refused inside callbacks, with its context's log callback listening.
///
/// # Safety
/// `semaphore` is NULL or was made by this file and is not destroyed.
unsafe fn on_semaphore<T: super::entry::Success>(
    function: &str,
    semaphore: *const BhrSemaphore,
    body: impl FnOnce(&Semaphore) -> Result<T>,
) -> BhrStatus {
    // SAFETY: this function's contract.
    let Some(semaphore) = (unsafe { semaphore.as_ref() }) else {
        return outside_callbacks::<()>(function, || Err(is_null("semaphore")));
    };
    let _scope = log::Scope::enter(semaphore.sink.clone());
    keep(outside_callbacks(function, || body(&semaphore.semaphore)), Some(&semaphore.message))
}

/// Makes a semaphore on a context.
///
/// # Safety
/// All pointers are NULL or valid; `origin` is called within.
pub(super) unsafe fn make(
    function: &str,
    context: *mut BhrContext,
    kind: BhrSemaphoreKind,
    out_semaphore: *mut *mut BhrSemaphore,
    origin: impl FnOnce(&super::state::State) -> Result<SemaphoreOrigin>,
) -> BhrStatus {
    // SAFETY: this function's contract.
    unsafe {
        let out = Out::cleared(out_semaphore);
        // Not NULL in the closure: `on_context` has refused that.
        let shared = || context.as_ref().map(|context| (context.sink(), context.message.clone()));
        on_context(function, context, |state| {
            out.required("out_semaphore")?;
            let kind = kind_of(kind)?;
            let origin = origin(state)?;
            let semaphore = state.renderer.create_semaphore(kind, origin)?;
            let (sink, message) = shared().ok_or_else(|| is_null("context"))?;
            out.set(Box::into_raw(Box::new(BhrSemaphore { semaphore, sink, message })));
            Ok(())
        })
    }
}

/// Makes a semaphore: of value 0, or not signalled. handle_type is the one handle that it is exported by; 0: none,
/// for hosts on the same VkDevice, and for bhr_semaphore_wait. End *out_semaphore with bhr_semaphore_destroy.
/// Errors: UNSUPPORTED for a handle that such semaphores are not exported by here, and always on the CPU tracer,
/// OpenGL, Metal and Direct3D 12. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_semaphore_create(
    context: *mut BhrContext,
    kind: BhrSemaphoreKind,
    handle_type: BhrHandleType,
    out_semaphore: *mut *mut BhrSemaphore,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        make("bhr_semaphore_create", context, kind, out_semaphore, |_| {
            let known = NOT_RUN | BHR_HANDLE_OPAQUE_FD | BHR_HANDLE_HOST_POINTER;
            if handle_type & !known != 0 || handle_type.count_ones() > 1 {
                return Err(Error::argument(format!(
                    "handle_type is {handle_type:#x}; it must be 0 or one BHR_HANDLE_* bit"
                )));
            }
            Ok(SemaphoreOrigin::New(handle_type))
        })
    }
}

/// Gives a new handle of a semaphore, which is the host's: to be imported by what takes it over, or closed.
/// Errors: INVALID_STATE for one that was not made for export; SURFACE_LOST. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_semaphore_export(semaphore: *mut BhrSemaphore, out_handle: *mut BhrHandle) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let out = Out::cleared(out_handle);
        out.set(NO_HANDLE);
        on_semaphore("bhr_semaphore_export", semaphore, |semaphore| {
            out.required("out_handle")?;
            out.set(BhrHandle { r#type: BHR_HANDLE_OPAQUE_FD, fd: semaphore.export()?, ..NO_HANDLE });
            Ok(())
        })
    }
}

/// Makes a semaphore of one of the host's, which is of this kind. The descriptor in handle is bhr's after OK, and
/// the host's after an error.
/// Errors: those of bhr_semaphore_create; INVALID_ARGUMENT also for a descriptor that is not open or is no
/// semaphore. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_semaphore_import(
    context: *mut BhrContext,
    kind: BhrSemaphoreKind,
    handle: *const BhrHandle,
    out_semaphore: *mut *mut BhrSemaphore,
) -> BhrStatus {
    let _call = Call::enter();
    let mut taken = None;
    // SAFETY: NULL or valid, by the header's conventions.
    let status = unsafe {
        make("bhr_semaphore_import", context, kind, out_semaphore, |_| {
            let handle = read_handle(handle)?;
            if handle.r#type != BHR_HANDLE_OPAQUE_FD {
                return Err(Error::unsupported(format!(
                    "handle type {} is not taken; bhr_interop_info lists those that are",
                    handle.r#type
                )));
            }
            taken = Some(handle.fd);
            Ok(SemaphoreOrigin::Descriptor(handle.fd))
        })
    };
    if let Some(fd) = taken.filter(|_| status >= BHR_OK) {
        // The host has given it away.
        close_descriptor(fd);
    }
    status
}

/// Gives the VkSemaphore to a host on the same VkDevice. It lives as long as the semaphore does.
/// Errors: SURFACE_LOST. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_semaphore_vulkan(semaphore: *const BhrSemaphore, out_semaphore: *mut u64) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let out = Out::cleared(out_semaphore);
        on_semaphore("bhr_semaphore_vulkan", semaphore, |semaphore| {
            out.required("out_semaphore")?;
            out.set(semaphore.vulkan()?);
            Ok(())
        })
    }
}

/// Waits on the CPU until a TIMELINE has reached value, at most timeout_ns nanoseconds: 0 looks, UINT64_MAX waits
/// without limit. NOT_READY: it has not.
/// Errors: UNSUPPORTED for a BINARY one; SURFACE_LOST when the context ends meanwhile. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_semaphore_wait(semaphore: *mut BhrSemaphore, value: u64, timeout_ns: u64) -> BhrStatus {
    let time = (timeout_ns != u64::MAX).then(|| Duration::from_nanos(timeout_ns));
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_semaphore("bhr_semaphore_wait", semaphore, |semaphore| {
            Ok(SuccessStatus(if semaphore.wait(value, time)? { BHR_OK } else { BHR_NOT_READY }))
        })
    }
}

/// Signals a TIMELINE on the CPU.
/// Errors: INVALID_ARGUMENT for a value that is not greater than the present one, or not smaller than one that a
/// frame under way will signal; UNSUPPORTED for a BINARY one; SURFACE_LOST. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_semaphore_signal(semaphore: *mut BhrSemaphore, value: u64) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe { on_semaphore("bhr_semaphore_signal", semaphore, |semaphore| semaphore.signal(value)) }
}

/// Ends a semaphore and returns at once; bhr keeps it for the frames that were submitted with it. NULL is a no-op;
/// its context may be gone. No other thread may use it any more. From inside a callback it does nothing:
/// bhr_error_message then says so. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_semaphore_destroy(semaphore: *mut BhrSemaphore) {
    const NAME: &str = "bhr_semaphore_destroy";
    let end = |owned: Box<BhrSemaphore>| {
        let BhrSemaphore { semaphore, sink, .. } = *owned;
        let _scope = log::Scope::enter(sink);
        give_back(NAME, semaphore, |semaphore| semaphore.end("it was destroyed"));
    };
    // SAFETY: this file made it with Box::into_raw, and the host destroys it once.
    unsafe { destroy(NAME, semaphore, end) }
}
