// SPDX-License-Identifier: MIT OR Apache-2.0
//! BhrStatus, its names, and the message of this thread's last failure. The mapping from `ErrorKind` stands here
//! and nowhere else.

use super::message::last_message;
use crate::error::ErrorKind;
use std::ffi::{CStr, c_char};

/// The result of a call: 0 is success, above 0 success with news, below 0 an error. bhr_error_message says more.
pub type BhrStatus = i32;
/// Success.
pub const BHR_OK: BhrStatus = 0;
/// bhr_job_wait: the job was still running when the timeout ran out.
pub const BHR_NOT_READY: BhrStatus = 1;
/// bhr_render_surface: the window is hidden or 0 x 0; nothing presented.
pub const BHR_FRAME_SKIPPED: BhrStatus = 2;
/// An argument is NULL, not finite, out of its range, or unknown.
pub const BHR_ERROR_INVALID_ARGUMENT: BhrStatus = 0 - 1;
/// Wrong order, an impossible combination, or inside a callback.
pub const BHR_ERROR_INVALID_STATE: BhrStatus = 0 - 2;
/// The program was compiled for another BHR_ABI_VERSION.
pub const BHR_ERROR_INCOMPATIBLE_ABI: BhrStatus = 0 - 3;
/// Valid, but not on this adapter, platform or build.
pub const BHR_ERROR_UNSUPPORTED: BhrStatus = 0 - 4;
/// No adapter of the kind asked for exists.
pub const BHR_ERROR_NO_ADAPTER: BhrStatus = 0 - 5;
/// Host or device memory ran out.
pub const BHR_ERROR_OUT_OF_MEMORY: BhrStatus = 0 - 6;
/// The progress callback, or bhr_job_cancel, stopped the work.
pub const BHR_ERROR_CANCELLED: BhrStatus = 0 - 7;
/// A window is gone or its context recovered: destroy the surface.
pub const BHR_ERROR_SURFACE_LOST: BhrStatus = 0 - 8;
/// The GPU device is gone: call bhr_context_recover.
pub const BHR_ERROR_DEVICE_LOST: BhrStatus = 0 - 9;
/// A file could not be read or written.
pub const BHR_ERROR_IO: BhrStatus = 0 - 10;
/// A bug in bhr was caught; only destroy calls are valid now.
pub const BHR_ERROR_INTERNAL: BhrStatus = 0 - 99;

pub(super) fn of(kind: ErrorKind) -> BhrStatus {
    match kind {
        ErrorKind::InvalidArgument => BHR_ERROR_INVALID_ARGUMENT,
        ErrorKind::InvalidState => BHR_ERROR_INVALID_STATE,
        ErrorKind::IncompatibleAbi => BHR_ERROR_INCOMPATIBLE_ABI,
        ErrorKind::Unsupported => BHR_ERROR_UNSUPPORTED,
        ErrorKind::NoAdapter => BHR_ERROR_NO_ADAPTER,
        ErrorKind::OutOfMemory => BHR_ERROR_OUT_OF_MEMORY,
        ErrorKind::Cancelled => BHR_ERROR_CANCELLED,
        ErrorKind::DeviceLost => BHR_ERROR_DEVICE_LOST,
        ErrorKind::SurfaceLost => BHR_ERROR_SURFACE_LOST,
        ErrorKind::Io => BHR_ERROR_IO,
        ErrorKind::Internal => BHR_ERROR_INTERNAL,
    }
}

fn name(status: BhrStatus) -> &'static CStr {
    match status {
        BHR_OK => c"BHR_OK",
        BHR_NOT_READY => c"BHR_NOT_READY",
        BHR_FRAME_SKIPPED => c"BHR_FRAME_SKIPPED",
        BHR_ERROR_INVALID_ARGUMENT => c"BHR_ERROR_INVALID_ARGUMENT",
        BHR_ERROR_INVALID_STATE => c"BHR_ERROR_INVALID_STATE",
        BHR_ERROR_INCOMPATIBLE_ABI => c"BHR_ERROR_INCOMPATIBLE_ABI",
        BHR_ERROR_UNSUPPORTED => c"BHR_ERROR_UNSUPPORTED",
        BHR_ERROR_NO_ADAPTER => c"BHR_ERROR_NO_ADAPTER",
        BHR_ERROR_OUT_OF_MEMORY => c"BHR_ERROR_OUT_OF_MEMORY",
        BHR_ERROR_CANCELLED => c"BHR_ERROR_CANCELLED",
        BHR_ERROR_SURFACE_LOST => c"BHR_ERROR_SURFACE_LOST",
        BHR_ERROR_DEVICE_LOST => c"BHR_ERROR_DEVICE_LOST",
        BHR_ERROR_IO => c"BHR_ERROR_IO",
        BHR_ERROR_INTERNAL => c"BHR_ERROR_INTERNAL",
        _ => c"unknown BhrStatus",
    }
}

/// The message of the last call that failed on this thread: the function, the argument, its value and the limit.
/// Never NULL; "" when no call has failed. Valid until this thread's next failing call, or its end.
#[unsafe(no_mangle)]
pub extern "C" fn bhr_error_message() -> *const c_char {
    last_message()
}

/// The constant's name, such as "BHR_ERROR_DEVICE_LOST"; static, never NULL.
#[unsafe(no_mangle)]
pub extern "C" fn bhr_status_name(status: BhrStatus) -> *const c_char {
    name(status).as_ptr()
}
