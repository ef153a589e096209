//! The message of a thread's last failed call.

use std::cell::RefCell;
use std::ffi::c_char;
use std::io::Write;

/// The room for a message: two paths of the longest kind fit into it.
const MESSAGE_BYTES: usize = 10_000;

thread_local! {
    /// The message, which ends with a NUL. It is stored in place, so that saying that there is no memory needs none,
    /// and a pointer that a host kept too long shows a later message, not freed memory. (It needs no destructor either,
    /// which would take memory as well.)
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
}
