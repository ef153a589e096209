// SPDX-License-Identifier: MIT OR Apache-2.0
//! The control words of x86-64: MXCSR, and those of the x87.

use super::best_call;
use crate::thread_state::{Call, begin_own_thread, call_host};
use std::arch::asm;
use std::hint::black_box;
use std::thread;

/// Subnormal numbers are 0; division by zero traps; rounds upward; an overflow has been.
const GAMES: u32 = 0x8040 | 0x1f80 & !0x0200 | 0x4000 | 0x0008;
const DEFAULT: u32 = 0x1f80;

fn words() -> u32 {
    let mut mxcsr = 0_u32;
    // SAFETY: writes the variable.
    unsafe { asm!("stmxcsr [{0}]", in(reg) &raw mut mxcsr) };
    mxcsr
}

fn set(mxcsr: u32) {
    // SAFETY: reads the variable.
    unsafe { asm!("ldmxcsr [{0}]", in(reg) &raw const mxcsr) };
}

/// The x87's control word, and its flags.
fn x87() -> (u16, u16) {
    let (mut control, mut status) = (0_u16, 0_u16);
    // SAFETY: writes the variables.
    unsafe {
        asm!("fnstcw [{0}]", "fnstsw [{1}]", in(reg) &raw mut control, in(reg) &raw mut status);
    }
    (control, status & 0x3f)
}

fn set_x87(control: u16) {
    // SAFETY: reads the variable.
    unsafe { asm!("fldcw [{0}]", in(reg) &raw const control) };
}

/// Divides 1 by 0 on the x87.
fn divide_by_zero_on_x87() {
    // SAFETY: the register that it fills is emptied again; the exception comes with the last instruction at the
    // latest, where it is not masked.
    unsafe { asm!("fld1", "fldz", "fdivp", "fstp st(0)", "fwait", out("st(0)") _, out("st(1)") _) };
}

#[test]
fn a_call_has_default_words_and_gives_those_of_the_host_back() {
    // Rounded to 24 bits, upward, with traps for division by zero: as Direct3D 9 leaves it, and worse.
    const X87: u16 = 0x087b;
    set(GAMES);
    set_x87(X87);
    {
        let _call = Call::enter();
        assert_eq!((words(), x87().0), (DEFAULT, 0x037f));
        divide_by_zero_on_x87();
        assert_eq!(x87().1 & 4, 4, "no flag: the test divides nothing");
        assert_eq!(black_box(1.0_f32) / black_box(0.0), f32::INFINITY);
        let heard = call_host(|| {
            let heard = (words(), x87());
            // A callback may make calls; and it may change the words for good.
            drop(Call::enter());
            assert_eq!((words(), x87().0), (GAMES, X87));
            set(GAMES & !0x4000);
            heard
        });
        assert_eq!(heard, (GAMES, (X87, 0)));
        assert_eq!((words(), x87().0), (DEFAULT, 0x037f));
    }
    assert_eq!((words(), x87()), (GAMES & !0x4000, (X87, 0)));
    let of_own_thread = thread::spawn(|| {
        let began = words();
        begin_own_thread();
        (began, words(), x87().0)
    });
    set(DEFAULT);
    set_x87(0x037f);
    // The system lets a thread begin with the words of the one that starts it: the first is not what is tested.
    let (_, words, x87) = of_own_thread.join().unwrap();
    assert_eq!((words, x87), (DEFAULT, 0x037f));
}

/// A host that traps pays for the control word of the x87 as well, 0.15 us on the machine where this was measured (AMD
/// EPYC, virtual).
#[test]
fn a_call_of_a_host_that_traps_costs_less_than_two_fifths_of_a_microsecond() {
    set(0x1f80 & !0x0680);
    set_x87(0x0360);
    let trapping = best_call();
    set(DEFAULT);
    set_x87(0x037f);
    println!("a call of a host that traps floating-point exceptions: {trapping:?}");
    assert!(trapping.as_nanos() < 400, "{trapping:?}");
}
