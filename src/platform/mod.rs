// SPDX-License-Identifier: MIT OR Apache-2.0
//! Systems and processors behind one face: what the library asks of the system itself, and not of the windows or
//! drivers that other rooms are about. Each function here is there on every system, with one signature, so that who
//! calls it need not know where it runs. Knows nothing of bhr.
//!
//! bare.rs has everything, as far as it goes on a system of which nothing is known, with the comments that hold for
//! all; a system's own file puts what it does better in its place.

#![cfg_attr(
    not(shares_memory),
    allow(dead_code, unused_imports, reason = "no driver there passes anything by a descriptor")
)]

#[allow(dead_code, reason = "systems have most of it themselves")]
mod bare;
mod control_words;
#[cfg(target_arch = "wasm32")]
mod page;
mod system;
#[cfg(unix)]
mod unix;
#[cfg(windows)]
mod windows;

#[cfg(not(any(unix, windows, target_arch = "wasm32")))]
use bare as here;
#[cfg(target_arch = "wasm32")]
use page as here;
#[cfg(unix)]
use unix as here;
#[cfg(windows)]
use windows as here;

pub use bare::{DescriptorFacts, FileForm, NoCopy, NotFound};
pub use control_words::ControlWords;
pub use here::{
    Instant, Uncancelled, around_thread_end, at_exit, block_file_size_signal, can_be_mapped, close_descriptor,
    close_file, copy_descriptor, descriptor_facts, folders_of_libraries, is_same_file, keep_mode, library_function,
    lower_priority, may_follow_link, never_wider, on_enough_stack, on_host_stack, open_without_waiting,
    other_threads_are_gone, path_of_bytes, process_id, program_of_window, receive_within, stack_left, stay_mapped,
    sync_folder, window_exists,
};
pub use system::{SYSTEM, System};
