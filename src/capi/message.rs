// SPDX-License-Identifier: MIT OR Apache-2.0
//! The message of a thread's last failed call, and those of a context's and a job's, which any thread may ask for.

use crate::thread_state::Call;
use parking_lot::Mutex;
use std::cell::RefCell;
use std::ffi::c_char;
use std::io::Write;

/// The room for a message and its NUL: two paths of the longest kind fit into it.
const MESSAGE_BYTES: usize = 10_000;

thread_local! {
    /// The message is stored in place, so that saying that there is no memory needs none, and a pointer that a host
    /// kept too long shows a later message, not freed memory. (It needs no destructor either, which would take memory
    /// as well.)
    static MESSAGE: RefCell<[u8; MESSAGE_BYTES]> = const { RefCell::new([0; MESSAGE_BYTES]) };
}

/// Takes the place of the message before; zeros become spaces, and what does not fit is left out.
pub(super) fn keep_message(message: std::fmt::Arguments<'_>) {
    // A thread that is ending has no place for a message any more.
    let _ = MESSAGE.try_with(|kept| {
        let mut kept = kept.borrow_mut();
        let mut rest = &mut kept[..MESSAGE_BYTES - 1];
        // The part that does not fit is left out.
        let _ = rest.write_fmt(message);
        let written = MESSAGE_BYTES - 1 - rest.len();
        let text = &mut kept[..written];
        text.iter_mut().filter(|byte| **byte == 0).for_each(|byte| *byte = b' ');
        // The message is not cut inside a character.
        let length = std::str::from_utf8(text).map_or_else(|cut| cut.valid_up_to(), str::len);
        kept[length] = 0;
    });
}

/// This thread's message; never NULL.
pub(super) fn last_message() -> *const c_char {
    MESSAGE.try_with(|kept| kept.as_ptr().cast_const().cast()).unwrap_or(c"".as_ptr())
}

/// The message of the last failed call on an object of the host's, on whichever thread that was. Its lock is held for
/// a copy only.
pub(super) struct LastMessage(Mutex<[u8; MESSAGE_BYTES]>);

impl LastMessage {
    pub const fn new() -> Self {
        Self(Mutex::new([0; MESSAGE_BYTES]))
    }

    /// Takes over the message of this thread, whose call on the object has just failed.
    pub fn keep_of_thread(&self) {
        let _ = MESSAGE.try_with(|kept| *self.0.lock() = *kept.borrow());
    }

    /// Copies as much of it as fits, with a NUL, into `size` bytes, and returns its whole length without the NUL.
    ///
    /// # Safety
    /// `buffer` is NULL or has `size` writable bytes.
    pub unsafe fn copy_to(&self, buffer: *mut c_char, size: usize) -> usize {
        let message = self.0.lock();
        let length = message.iter().position(|byte| *byte == 0).unwrap_or_default();
        // SAFETY: this function's contract.
        unsafe { copy_text(&message[..length], buffer, size) };
        length
    }
}

/// The message of an object into a host's buffer, as [`LastMessage::copy_to`] has it; "" and 0 for no object.
///
/// # Safety
/// `buffer` is NULL or has `size` writable bytes.
pub(super) unsafe fn copy_last(message: Option<&LastMessage>, buffer: *mut c_char, size: usize) -> usize {
    let _call = Call::enter();
    // SAFETY: this function's contract.
    unsafe {
        copy_text(b"", buffer, size);
        message.map_or(0, |message| message.copy_to(buffer, size))
    }
}

/// Copies `text`, cut at a character, and a NUL into a host's buffer.
///
/// # Safety
/// `buffer` is NULL or has `size` writable bytes.
pub(super) unsafe fn copy_text(text: &[u8], buffer: *mut c_char, size: usize) {
    if buffer.is_null() || size == 0 {
        return;
    }
    let mut end = text.len().min(size - 1);
    // Bytes 10xxxxxx go on with a character of UTF-8.
    while end > 0 && text.get(end).is_some_and(|byte| byte & 0xc0 == 0x80) {
        end -= 1;
    }
    // SAFETY: `end` is less than `size`.
    unsafe {
        std::ptr::copy_nonoverlapping(text.as_ptr(), buffer.cast(), end);
        buffer.add(end).write(0);
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use std::ffi::CStr;

    pub fn message() -> String {
        // SAFETY: a C string of this thread's.
        unsafe { CStr::from_ptr(last_message()) }.to_str().unwrap().to_owned()
    }

    #[test]
    fn a_message_stays_where_it_is() {
        keep_message(format_args!("first"));
        let place = last_message();
        for length in [0, 100, MESSAGE_BYTES - 1, MESSAGE_BYTES, 1_000_000] {
            keep_message(format_args!("{}", "\u{e9}".repeat(length / 2)));
            assert_eq!(last_message(), place);
            assert_eq!(message().len(), (length / 2 * 2).min(MESSAGE_BYTES - 2));
        }
    }

    #[test]
    fn an_objects_message_is_copied_as_far_as_it_fits() {
        let kept = LastMessage::new();
        keep_message(format_args!("a\u{e9}\u{20ac}b"));
        kept.keep_of_thread();
        keep_message(format_args!("another call's"));
        for (size, text) in
            [(0, None), (1, Some("")), (2, Some("a")), (3, Some("a")), (4, Some("a\u{e9}"))].into_iter().chain([
                (6, Some("a\u{e9}")),
                (7, Some("a\u{e9}\u{20ac}")),
                (8, Some("a\u{e9}\u{20ac}b")),
                (20, Some("a\u{e9}\u{20ac}b")),
            ])
        {
            let mut buffer = [0x7f_u8; 20];
            // SAFETY: there are at least `size` bytes.
            assert_eq!(unsafe { kept.copy_to(buffer.as_mut_ptr().cast(), size) }, 7);
            let written = text.map(|text| [text.as_bytes(), b"\0"].concat()).unwrap_or_default();
            assert_eq!(buffer[..written.len()], written);
            assert!(buffer[written.len().max(size)..].iter().all(|byte| *byte == 0x7f));
        }
        // SAFETY: NULL is allowed.
        assert_eq!(unsafe { kept.copy_to(std::ptr::null_mut(), 100) }, 7);
    }
}
