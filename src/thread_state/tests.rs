// SPDX-License-Identifier: MIT OR Apache-2.0
//! The state of threads inside and outside of calls. tests/c/thread_state.c has the whole library do its work so.

use super::*;
use std::hint::black_box;
use std::time::{Duration, Instant};

// These test what one system has, or what the instructions of one processor set.
#[cfg(target_os = "linux")]
mod cancellation;
#[cfg(all(target_os = "linux", target_arch = "x86_64"))]
mod stack;
#[cfg(target_arch = "x86_64")]
mod x86_64;

/// The time of a call: the best of many rounds, as other programs run on the machine too.
fn best_call() -> Duration {
    const CALLS: u32 = 1000;
    let round = || {
        let began = Instant::now();
        for _ in 0..CALLS {
            let call = Call::enter();
            assert!(on_enough_stack(|| black_box(true)).is_ok_and(|done| done));
            drop(call);
        }
        began.elapsed() / CALLS
    };
    (0..500).map(|_| round()).min().unwrap()
}

/// The price of every call: some 0.1 microseconds on an idle machine, twice that on a busy one.
#[test]
fn a_call_costs_less_than_half_a_microsecond() {
    let plain = best_call();
    println!("a call: {plain:?}");
    assert!(plain.as_nanos() < 500, "{plain:?}");
}
