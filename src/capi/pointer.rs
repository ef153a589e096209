// SPDX-License-Identifier: MIT OR Apache-2.0
//! Plain pointers of the host: NULL checks, fixed arrays in, out-parameters out. Copies only, never a reference, so
//! that alignment does not matter. Structs that carry a size are in `versioned`.

use crate::error::{Error, Number, Result};
use bytemuck::Zeroable;
use glam::DVec3;

/// The error for a NULL `name`.
pub(super) fn is_null(name: &str) -> Error {
    Error::argument(format!("{name} is NULL"))
}

/// A `double[3]` of the host's.
///
/// # Safety
/// `pointer` is NULL or points to three readable doubles, aligned or not.
pub(super) unsafe fn read_vector(pointer: *const f64, name: &str) -> Result<DVec3> {
    if pointer.is_null() {
        return Err(is_null(name));
    }
    // SAFETY: not NULL, hence three doubles by this function's contract.
    Ok(DVec3::from_array(unsafe { pointer.cast::<[f64; 3]>().read_unaligned() }))
}

/// The error for a number that is NaN or infinite.
pub(super) fn check_finite(value: f64, name: &str) -> Result<f64> {
    if value.is_finite() {
        return Ok(value);
    }
    Err(Error::argument(format!("{name} is {}; it must be finite", Number(value))))
}

/// The error for a vector with a component that is NaN or infinite.
pub(super) fn check_finite_vector(v: DVec3, name: &str) -> Result<DVec3> {
    if v.is_finite() {
        return Ok(v);
    }
    Err(Error::argument(format!("{name} is ({}, {}, {}); it must be finite", Number(v.x), Number(v.y), Number(v.z))))
}

/// The error for a `reserved` field that is not 0.
pub(super) fn check_reserved(value: u32, name: &str) -> Result<()> {
    if value == 0 {
        return Ok(());
    }
    Err(Error::argument(format!("{name} reserved is {value}; it must be 0")))
}

/// The error for bits outside `known` in a flags field.
pub(super) fn check_flags(value: u32, known: u32, name: &str) -> Result<u32> {
    if value & !known == 0 {
        return Ok(value);
    }
    Err(Error::argument(format!("{name} is {value:#x}; the known bits are {known:#x}")))
}

/// The error for an enumeration value that the header does not list; `known` says which it does.
pub(super) fn unknown<T>(value: i32, name: &str, known: &str) -> Result<T> {
    Err(Error::argument(format!("{name} is {value}; known are {known}")))
}

/// An out-parameter of the host's, cleared when it is taken, so that every failure leaves it NULL or 0.
pub(super) struct Out<T>(*mut T);

impl<T: Zeroable> Out<T> {
    /// # Safety
    /// `pointer` is NULL or points to a writable `T`, aligned or not, until the entry point returns.
    pub(super) unsafe fn cleared(pointer: *mut T) -> Self {
        let out = Self(pointer);
        out.set(T::zeroed());
        out
    }

    /// Errors: INVALID_ARGUMENT when the host passed NULL.
    pub(super) fn required(&self, name: &str) -> Result<()> {
        if self.0.is_null() { Err(is_null(name)) } else { Ok(()) }
    }

    /// Writes through the pointer, unless the host passed NULL.
    pub(super) fn set(&self, value: T) {
        if !self.0.is_null() {
            // SAFETY: not NULL, hence writable by the contract of `cleared`.
            unsafe { self.0.write_unaligned(value) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn out_parameters_are_cleared_and_may_be_misaligned() {
        let mut bytes = [0xffu8; 17];
        // SAFETY: 16 bytes follow the odd address.
        let out = unsafe { Out::<[f64; 2]>::cleared(bytes.as_mut_ptr().add(1).cast()) };
        out.required("out").unwrap();
        assert_eq!(bytes[1..], [0; 16]);
        out.set([1.0, 2.0]);
        assert_eq!(bytes[0], 0xff);
        assert_eq!(bytes[1..9], 1f64.to_ne_bytes());
        assert_eq!(bytes[9..], 2f64.to_ne_bytes());
    }

    #[test]
    fn a_null_out_parameter_is_named() {
        // SAFETY: NULL is allowed.
        let out = unsafe { Out::<f64>::cleared(std::ptr::null_mut()) };
        assert_eq!(out.required("out_mass").unwrap_err().message, "out_mass is NULL");
        out.set(1.0);
    }
}
