// SPDX-License-Identifier: MIT OR Apache-2.0
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

/// Ends the message of a frame that failed after some of its pixels had been written.
pub(crate) const PARTLY_WRITTEN: &str = "; part of the target has been written";

/// A number of the host's in a message: nine significant digits at most, because the sixteen of a double that was
/// computed hide what matters, and with an exponent beyond seven places.
pub struct Number(pub f64);

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(value) = *self;
        let rounded = format!("{value:.8e}").parse().unwrap_or(value);
        match value.abs() {
            0.0 | 1e-4..1e7 => write!(f, "{rounded}"),
            size if size.is_finite() => write!(f, "{rounded:e}"),
            _ => write!(f, "{value}"),
        }
    }
}

/// The error for a number that is not in `[low, high]`, or not a number.
pub fn out_of_range(name: &str, value: f64, low: f64, high: f64) -> Error {
    let number = Number(value).to_string();
    // A number just outside keeps all its digits: rounded it would seem to lie inside.
    let seems_inside = number.parse().is_ok_and(|shown: f64| (low..=high).contains(&shown));
    let number = if seems_inside { value.to_string() } else { number };
    Error::argument(format!("{name} is {number}; it must lie in [{}, {}]", Number(low), Number(high)))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_messages_are_short() {
        for (value, text) in [
            (0.0, "0"),
            (-0.999, "-0.999"),
            (0.1 + 0.2, "0.3"),
            (std::f64::consts::PI, "3.14159265"),
            (1e6, "1000000"),
            (1e308, "1e308"),
            (f64::MAX, "1.79769313e308"),
            (-1.234_567_890_123e-5, "-1.23456789e-5"),
            (f64::NAN, "NaN"),
            (f64::NEG_INFINITY, "-inf"),
        ] {
            assert_eq!(Number(value).to_string(), text);
        }
    }

    #[test]
    fn a_number_just_outside_its_range_does_not_seem_to_be_inside() {
        let message = |value| out_of_range("spin", value, -0.999, 0.999).message;
        assert_eq!(message(1.0), "spin is 1; it must lie in [-0.999, 0.999]");
        assert_eq!(message(0.999_000_000_000_01), "spin is 0.99900000000001; it must lie in [-0.999, 0.999]");
        assert_eq!(message(f64::NAN), "spin is NaN; it must lie in [-0.999, 0.999]");
    }
}
