// SPDX-License-Identifier: MIT OR Apache-2.0
//! Threads with little stack.

use crate::thread_state::{call_host, on_enough_stack};
use std::hint::black_box;
use std::thread;

/// Takes so many KiB of stack, and more in builds without optimisation.
#[inline(never)]
fn take(kib: usize) -> usize {
    let room = black_box([0_u8; 1024]);
    if kib <= 1 { room.len() } else { take(kib - 1) + black_box(&room).len() }
}

#[test]
fn a_thread_with_little_stack_gets_more_and_its_callbacks_do_not_see_it() {
    // An address tells which stack a thread is on.
    let here = || psm::stack_pointer().addr();
    let small = thread::Builder::new().stack_size(64 << 10).spawn(move || {
        let outside = here();
        // Half of the stack: another one may lie right below it.
        let near = |address: usize| outside.abs_diff(address) < 32 << 10;
        for _ in 0..3 {
            let Ok((inside, callback, nested, after)) = on_enough_stack(|| {
                let inside = here();
                assert_eq!(take(1000), 1000 << 10);
                let (callback, nested) = call_host(|| (here(), on_enough_stack(|| take(1000) + here()).ok()));
                (inside, callback, nested, here())
            }) else {
                panic!("no memory for a stack");
            };
            assert!(!near(inside) && near(callback) && near(here()), "{inside:x} {callback:x}");
            assert!(nested.is_some_and(|address| !near(address - (1000 << 10))));
            assert!(after.abs_diff(inside) < 4096);
        }
    });
    small.unwrap().join().unwrap();
    let large = thread::Builder::new().stack_size(2 << 20).spawn(move || {
        let outside = here();
        assert!(on_enough_stack(here).is_ok_and(|inside| outside.abs_diff(inside) < 64 << 10));
    });
    large.unwrap().join().unwrap();
}
