// SPDX-License-Identifier: MIT OR Apache-2.0
//! A thread of the library enters the scope of the thread that it works for. The C API installs what a scope is: the
//! context whose log gets the thread's messages. This module does not know that.

use std::any::Any;
use std::sync::{Arc, OnceLock};

/// A thread calls this to enter the scope, and drops the returned value to leave it.
pub type ThreadScope = Arc<dyn Fn() -> Box<dyn Any> + Send + Sync>;

static OF_CALLER: OnceLock<fn() -> ThreadScope> = OnceLock::new();

/// Sets the function that makes the scope of the thread that calls it. Later calls of `install` change nothing.
pub fn install(of_caller: fn() -> ThreadScope) {
    OF_CALLER.get_or_init(|| of_caller);
}

/// The scope of this thread, for another thread to enter.
pub fn of_caller() -> ThreadScope {
    match OF_CALLER.get() {
        Some(of_caller) => of_caller(),
        None => Arc::new(|| Box::new(())),
    }
}
