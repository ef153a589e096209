// SPDX-License-Identifier: MIT OR Apache-2.0
//! Cancellation, by the numbers that Linux has for it.

use crate::thread_state::{Call, call_host};

#[test]
fn a_thread_is_not_cancelled_inside_a_call_nor_in_its_callbacks() {
    unsafe extern "C" {
        safe fn pthread_setcancelstate(state: i32, old: Option<&mut i32>) -> i32;
    }
    let state = || {
        let (mut state, mut now) = (-1, -1);
        pthread_setcancelstate(1, Some(&mut state));
        pthread_setcancelstate(state, Some(&mut now));
        state
    };
    assert_eq!(state(), 0);
    {
        let _call = Call::enter();
        assert_eq!(state(), 1);
        drop(Call::enter());
        assert_eq!(call_host(state), 1);
    }
    assert_eq!(state(), 0);
}
