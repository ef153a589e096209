// SPDX-License-Identifier: MIT OR Apache-2.0
//! Packed arrays of structs that may grow: the host says the size of its elements, and each element states its own.

use super::pointer::is_null;
use super::versioned::{self, Versioned, check_named_size};
use crate::error::{Error, Result};
use arrayvec::ArrayVec;

/// The names of an array of structs in messages: of the array, of its elements' size, and of a number of them.
pub(super) struct Names {
    pub array: &'static str,
    pub size: &'static str,
    pub count: &'static str,
}

/// Reads the `count` structs, `size` bytes apart, of the host's. Errors: NULL unless `count` is 0; too many; a size
/// that is none of `C`; whatever is wrong with one, which the message numbers.
///
/// # Safety
/// `begin` is NULL or points to `count` structs of `size` readable bytes.
pub(super) unsafe fn read_array<C: Versioned, T: TryFrom<C, Error = Error>, const MOST: usize>(
    begin: *const C,
    size: usize,
    count: u32,
    names: &Names,
) -> Result<ArrayVec<T, MOST>> {
    let Names { array, size: size_name, count: count_name } = names;
    if count as usize > MOST {
        return Err(Error::argument(format!("{count_name} is {count}; it must be at most {MOST}")));
    }
    let mut read = ArrayVec::new();
    if count == 0 {
        return Ok(read);
    }
    if begin.is_null() {
        return Err(is_null(array));
    }
    check_named_size::<C>(size, size_name)?;
    for index in 0..count as usize {
        let numbered = |error: Error| Error { message: format!("{array}[{index}]: {}", error.message), ..error };
        // SAFETY: the element lies within the array by this function's contract.
        let element = unsafe { begin.byte_add(index * size) };
        // SAFETY: `struct_size` is within the element's `size` bytes.
        let stated = unsafe { versioned::caller_size(element, "its") }.map_err(numbered)?;
        if stated > size {
            let message = format!("its struct_size is {stated}; it must be at most {size_name}, {size}");
            return Err(numbered(Error::argument(message)));
        }
        // SAFETY: `stated` bytes are readable.
        let value = unsafe { versioned::read(element, "its") }.and_then(T::try_from).map_err(numbered)?;
        // There is room for `MOST`.
        let _ = read.try_push(value);
    }
    Ok(read)
}

/// Writes as many of `values` as `capacity` structs of the host's hold, `size` bytes apart, and states that size in
/// each.
///
/// # Safety
/// `begin` is NULL or points to `capacity` structs of `size` writable bytes.
pub(super) unsafe fn write_array<C: Versioned>(
    begin: *mut C,
    size: usize,
    capacity: u32,
    values: impl Iterator<Item = C>,
    names: &Names,
) -> Result<()> {
    if capacity == 0 {
        return Ok(());
    }
    if begin.is_null() {
        return Err(is_null(names.array));
    }
    check_named_size::<C>(size, names.size)?;
    for (index, value) in values.take(capacity as usize).enumerate() {
        // SAFETY: the element lies within the array by this function's contract; `fill` needs no `struct_size` there.
        unsafe { versioned::fill(begin.byte_add(index * size), size, &value) };
    }
    Ok(())
}
