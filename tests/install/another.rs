// SPDX-License-Identifier: MIT OR Apache-2.0
//! Another Rust library in the same program, with a standard library of its own: it allocates, panics and catches.

use std::collections::HashMap;
use std::panic::catch_unwind;

/// The sum of the numbers below `count`, by threads, tables and a panic; -1 when the panic was not caught as it was.
#[unsafe(no_mangle)]
pub extern "C" fn another_sum(count: u32) -> i64 {
    let table = (0..count).map(|n| (n, i64::from(n))).collect::<HashMap<_, _>>();
    let sum = std::thread::spawn(move || table.values().sum::<i64>()).join();
    let caught = catch_unwind(|| std::panic::panic_any(count));
    match (sum, caught.map_err(|payload| payload.downcast_ref::<u32>().copied())) {
        (Ok(sum), Err(Some(payload))) if payload == count => sum,
        _ => -1,
    }
}
