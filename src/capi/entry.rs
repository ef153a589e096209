// SPDX-License-Identifier: MIT OR Apache-2.0
//! The shape of every entry point: set the thread's state, refuse calls from inside callbacks, run one closure under
//! the panic guard (with a context, call.rs: under its lock), and turn the result into a status, this thread's message
//! and a log line.

use super::callback::in_callback;
use super::message::keep_message;
use super::panic::{guarded, guarded_always};
use super::status::{self, BHR_OK, BhrStatus};
use crate::error::{Error, ErrorKind, Result};
use crate::gpu::process_end;
use crate::thread_state::Call;
use ::log::Level;

/// The value of a body that succeeds.
pub(super) trait Success {
    fn status(self) -> BhrStatus;
}

impl Success for () {
    fn status(self) -> BhrStatus {
        BHR_OK
    }
}

/// The status of a success, >= 0: with news, or without.
pub(super) struct SuccessStatus(pub BhrStatus);

impl Success for SuccessStatus {
    fn status(self) -> BhrStatus {
        self.0
    }
}

/// A call that touches nothing shared and takes little stack: allowed inside callbacks.
pub(super) fn anywhere(function: &str, body: impl FnOnce() -> Result<()>) -> BhrStatus {
    let _call = Call::enter();
    finish(function, guarded_always(body))
}

/// A call without a context that reaches drivers or shared state: refused inside callbacks, and in the end of the
/// process.
pub(super) fn outside_callbacks<T: Success>(function: &str, body: impl FnOnce() -> Result<T>) -> BhrStatus {
    let _call = Call::enter();
    finish(function, refuse_in_callback().and_then(|()| refuse_at_the_end()).and_then(|()| guarded(body)))
}

/// An [`outside_callbacks`] call that takes little stack and does without memory for another: what a job has come to
/// does not depend on the memory of the thread that asks.
pub(super) fn outside_callbacks_always<T: Success>(function: &str, body: impl FnOnce() -> Result<T>) -> BhrStatus {
    let _call = Call::enter();
    finish(function, refuse_in_callback().and_then(|()| refuse_at_the_end()).and_then(|()| guarded_always(body)))
}

/// Keeps the message and logs it. The status of `result`.
pub(super) fn finish<T: Success>(function: &str, result: Result<T>) -> BhrStatus {
    let error = match result {
        Ok(success) => return success.status(),
        Err(error) => error,
    };
    // `allocate` leaves the message empty where there is no memory for one.
    let message = if error.message.is_empty() { "no memory is left" } else { &error.message };
    // The host has asked for it.
    let level = if error.kind == ErrorKind::Cancelled { Level::Info } else { Level::Error };
    ::log::log!(target: "bhr", level, "{function}: {message}");
    keep_message(format_args!("{function}: {message}"));
    status::of(error.kind)
}

/// Errors: INVALID_STATE inside a callback.
pub(super) fn refuse_in_callback() -> Result<()> {
    if in_callback() {
        return Err(Error::state("called from inside a log or progress callback; return from it first"));
    }
    Ok(())
}

/// Errors: INVALID_STATE on the thread that ends the process, if a driver was loaded.
pub(super) fn refuse_at_the_end() -> Result<()> {
    if process_end::is_here() {
        return Err(Error::state("the process is ending, and with it the drivers that contexts use"));
    }
    Ok(())
}

/// Ends what the host owns, a NULL excepted: `end` gets it. Refused inside callbacks, which the message says.
///
/// # Safety
/// `owned` is NULL or came from `Box::into_raw`, and is never used again.
pub(super) unsafe fn destroy<T>(function: &str, owned: *mut T, end: impl FnOnce(Box<T>)) {
    // Where all other threads are gone, what they had locked stays locked: the system takes all.
    if owned.is_null() || process_end::is_over() {
        return;
    }
    let _call = Call::enter();
    if in_callback() {
        let ignored = Error::state("ignored inside a callback; call it after the callback returned");
        finish::<()>(function, Err(ignored));
        return;
    }
    // SAFETY: this function's contract.
    let owned = unsafe { Box::from_raw(owned) };
    let ended = guarded_always(|| {
        end(owned);
        Ok(())
    });
    finish(function, ended);
}

/// Destroys what is a driver's; in the end of the process it is left to the system, as the driver may be gone already.
pub(super) fn give_back<T: 'static>(function: &str, owned: T, end: impl FnOnce(&T)) {
    if process_end::is_here() {
        return process_end::keep(owned);
    }
    let ended = guarded_always(|| {
        end(&owned);
        Ok(())
    });
    // Dropped under a guard of its own: a second panic while one unwinds would end the process.
    let dropped = guarded_always(move || {
        drop(owned);
        Ok(())
    });
    finish(function, ended.and(dropped));
}

#[cfg(test)]
mod tests {
    use std::collections::{BTreeMap, BTreeSet};
    use std::path::Path;

    /// They return constants, and the address of a thread's message.
    const PLAIN: [&str; 5] =
        ["bhr_abi_version", "bhr_error_message", "bhr_status_name", "bhr_version", "bhr_version_string"];

    /// The functions of this room with their text, and which of them hosts call.
    fn functions() -> (BTreeMap<String, String>, BTreeSet<String>) {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/capi");
        let (mut all, mut entries) = (BTreeMap::new(), BTreeSet::new());
        // Folders have no functions of the header.
        for file in std::fs::read_dir(folder).unwrap().map(|file| file.unwrap().path()).filter(|path| path.is_file()) {
            let text = std::fs::read_to_string(file).unwrap();
            let code = text.split("#[cfg(test)]").next().unwrap();
            // A function without indentation ends with the next brace without.
            for (at, _) in code.match_indices("fn ").filter(|(at, _)| {
                let line = &code[code[..*at].rfind('\n').map_or(0, |n| n + 1)..*at];
                !line.starts_with([' ', '/'])
            }) {
                let rest = &code[at + 3..];
                let name = rest.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap();
                let body = &rest[name.len()..rest.find("\n}").unwrap_or(rest.len())];
                *all.entry(name.to_owned()).or_insert_with(String::new) += body;
                if name.starts_with("bhr_") {
                    entries.insert(name.to_owned());
                }
            }
        }
        (all, entries)
    }

    #[test]
    fn every_function_of_the_header_sets_the_state_of_its_thread() {
        let (all, entries) = functions();
        assert!(entries.len() > 100, "{} functions were found", entries.len());
        let mut set = BTreeSet::new();
        loop {
            let calls_one = |body: &str| {
                body.contains("Call::enter()")
                    || body.split('(').any(|before| {
                        let word = before.rsplit(|c: char| !c.is_alphanumeric() && c != '_').next();
                        // A call with type arguments ends with `>`.
                        let word = match before.strip_suffix('>') {
                            Some(generic) => generic
                                .rsplit_once("::<")
                                .and_then(|(name, _)| name.rsplit(|c: char| !c.is_alphanumeric() && c != '_').next()),
                            None => word,
                        };
                        word.is_some_and(|word| set.contains(word))
                    })
            };
            let more = all.iter().filter(|(name, body)| !set.contains(*name) && calls_one(body));
            let more = more.map(|(name, _)| name.clone()).collect::<Vec<_>>();
            if more.is_empty() {
                break;
            }
            set.extend(more);
        }
        let without = entries.iter().filter(|name| !set.contains(*name)).map(String::as_str).collect::<Vec<_>>();
        assert_eq!(without, PLAIN, "these run with the host's control words");
    }
}
