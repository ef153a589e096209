// SPDX-License-Identifier: MIT OR Apache-2.0
//! Allocates memory in amounts that are large, or that depend on the host's requests: where the system refuses it,
//! these functions return OUT_OF_MEMORY, while `vec!`, `collect` and `push` would end the process. Knows nothing of
//! what the memory is for.

use crate::error::{Error, ErrorKind, Result};
use crate::platform::can_be_mapped;
use std::fmt::Write;

/// Bytes that must be left for small allocations (names, messages, queues, threads), which end the process where they
/// are refused.
const SMALL: usize = 1 << 20;

/// Bytes from which on an allocation is given only if `SMALL` is left after it.
const LARGE: usize = 1 << 15;

/// Address space that starting a thread takes: its stack, and what it keeps for itself.
pub const THREAD_ROOM: usize = 3 << 20;

fn refused(bytes: usize, what: &str) -> Error {
    // Making the error must not fail for lack of memory too: where there is none, it has no message.
    let mut message = String::new();
    if message.try_reserve(what.len() + 64).is_ok() {
        // Writing to a String cannot fail, and this stays within what is reserved.
        let _ = write!(message, "no memory for {what}, {bytes} bytes");
    }
    Error::new(ErrorKind::OutOfMemory, message)
}

/// An empty vector with room for `count` items. Errors: OUT_OF_MEMORY, naming `what`.
pub fn with_room<T>(count: usize, what: &str) -> Result<Vec<T>> {
    let mut items = Vec::new();
    reserve(&mut items, count, what)?;
    Ok(items)
}

/// Makes room for `more` items. Errors: OUT_OF_MEMORY, naming `what`.
pub fn reserve<T>(items: &mut Vec<T>, more: usize, what: &str) -> Result<()> {
    let bytes = items.len().saturating_add(more).saturating_mul(size_of::<T>());
    let held = items.capacity();
    let given = items.try_reserve_exact(more).is_ok();
    if given && (bytes < LARGE || items.capacity() == held || can_be_mapped(SMALL)) {
        return Ok(());
    }
    Err(refused(bytes, what))
}

/// `count` times `value`. Errors: OUT_OF_MEMORY, naming `what`.
pub fn filled<T: Clone>(count: usize, value: T, what: &str) -> Result<Vec<T>> {
    let mut items = with_room(count, what)?;
    items.resize(count, value);
    Ok(items)
}

/// Collects all items, of which there are about as many as the iterator says. Errors: OUT_OF_MEMORY, naming `what`.
pub fn collected<T>(items: impl Iterator<Item = T>, what: &str) -> Result<Vec<T>> {
    let (least, most) = items.size_hint();
    let mut all = with_room(most.unwrap_or(least), what)?;
    for item in items {
        push(&mut all, item, what)?;
    }
    Ok(all)
}

/// Appends an item to a vector whose length is not known beforehand. Errors: OUT_OF_MEMORY, naming `what`.
pub fn push<T>(items: &mut Vec<T>, item: T, what: &str) -> Result<()> {
    if items.len() == items.capacity() {
        // Grows the list by half: growing by one item at a time would copy all items each time.
        reserve(items, (items.len() / 2).max(16), what)?;
    }
    items.push(item);
    Ok(())
}

/// Errors: OUT_OF_MEMORY where `bytes`, and what small allocations may take, could not be had just now. Nothing is
/// kept: the check finds a lack of memory early, before small allocations can fail.
pub fn check_room(bytes: usize, what: &str) -> Result<()> {
    let bytes = bytes.saturating_add(SMALL);
    if can_be_mapped(bytes) { Ok(()) } else { Err(refused(bytes, what)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_can_be_had_is_given() {
        assert_eq!(filled(3, 7_u16, "numbers").unwrap(), [7; 3]);
        assert_eq!(collected((0..100).filter(|i| i % 2 == 0), "numbers").unwrap().len(), 50);
        let mut grown = Vec::new();
        (0..1000).for_each(|i| push(&mut grown, i, "numbers").unwrap());
        assert!(grown.iter().copied().eq(0..1000) && grown.capacity() < 2000);
        check_room(1 << 20, "a try").unwrap();
    }

    #[test]
    fn what_cannot_be_had_is_an_error_that_names_it() {
        for error in [
            filled(usize::MAX / 16, 0_u64, "too much").unwrap_err(),
            with_room::<u64>(usize::MAX, "too much").unwrap_err(),
            collected(std::iter::repeat_n(1_u8, usize::MAX), "too much").unwrap_err(),
            check_room(usize::MAX, "too much").unwrap_err(),
        ] {
            assert_eq!(error.kind, ErrorKind::OutOfMemory);
            assert!(error.message.starts_with("no memory for too much, "), "{error}");
        }
    }
}
