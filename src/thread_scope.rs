//! What a thread of the library's takes over from the thread that it works for: with the C API, whose log hears it.
//! Knows nothing of what that is.

use std::any::Any;
use std::sync::{Arc, OnceLock};

/// What a thread enters, and leaves again by dropping the value.
pub type ThreadScope = Arc<dyn Fn() -> Box<dyn Any> + Send + Sync>;

static OF_CALLER: OnceLock<fn() -> ThreadScope> = OnceLock::new();

/// `of_caller` makes the scope of the thread that calls it. The first one stays.
pub fn install(of_caller: fn() -> ThreadScope) {
    OF_CALLER.get_or_init(|| of_caller);
}

/// The scope of this thread, for another one.
pub fn of_caller() -> ThreadScope {
    match OF_CALLER.get() {
        Some(of_caller) => of_caller(),
        None => Arc::new(|| Box::new(())),
    }
}
