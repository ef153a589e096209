// SPDX-License-Identifier: MIT OR Apache-2.0
//! Attempts that fail no call, because another one follows: adapters that are tried one after another. Errors of the
//! graphics stack are details of such an attempt then, and `capi` has hosts hear them so. Knows neither adapters nor
//! messages.

use std::cell::Cell;
use std::marker::PhantomData;

thread_local!(static DEPTH: Cell<u32> = const { Cell::new(0) });

/// While one lives, this thread makes an attempt. It belongs to the thread.
pub struct Attempt(PhantomData<*const ()>);

pub fn begin() -> Attempt {
    let _ = DEPTH.try_with(|depth| depth.set(depth.get() + 1));
    Attempt(PhantomData)
}

pub fn is_under_way() -> bool {
    DEPTH.try_with(Cell::get).unwrap_or(0) > 0
}

impl Drop for Attempt {
    fn drop(&mut self) {
        let _ = DEPTH.try_with(|depth| depth.set(depth.get().saturating_sub(1)));
    }
}
