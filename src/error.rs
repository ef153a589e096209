//! The one error type of the crate. Everything fallible returns it; `capi::status` maps it to a `BhrStatus` and a
//! message. Knows nothing of C, of the GPU, or of the scene.

use std::fmt;

/// The kinds of errors that a host can act on. Each is one `BHR_ERROR_*` of the C API.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorKind {
    /// An argument is outside its documented range.
    InvalidArgument,
    /// The call is valid, but not now: wrong order, an impossible combination, or from inside a callback.
    InvalidState,
    /// The caller was compiled against another ABI.
    IncompatibleAbi,
    /// Valid, but not on this adapter, platform or build.
    Unsupported,
    /// No adapter of the kind asked for exists.
    NoAdapter,
    /// Host or device memory ran out.
    OutOfMemory,
    /// The progress callback asked to stop.
    Cancelled,
    /// A surface's window is gone, or its context.
    SurfaceLost,
    /// The GPU device was lost.
    DeviceLost,
    /// A file could not be read or written.
    Io,
    /// A bug in bhr or below it: a caught panic, a driver that broke its promise.
    Internal,
}

/// An [`ErrorKind`] with a sentence for the developer of the host: it names the argument, its value and the limit.
#[derive(Clone, Debug)]
pub struct Error {
    pub kind: ErrorKind,
    pub message: String,
}

pub type Result<T, E = Error> = std::result::Result<T, E>;

impl Error {
    pub fn new(kind: ErrorKind, message: impl Into<String>) -> Self {
        Self { kind, message: message.into() }
    }

    pub fn argument(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::InvalidArgument, message)
    }

    pub fn state(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::InvalidState, message)
    }

    pub fn unsupported(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Unsupported, message)
    }

    pub fn internal(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Internal, message)
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Error {}

/// The text of a panic's payload.
pub(crate) fn panic_text(panic: &(dyn std::any::Any + Send)) -> &str {
    let owned = panic.downcast_ref::<String>().map(String::as_str);
    owned.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("a panic without a message")
}
