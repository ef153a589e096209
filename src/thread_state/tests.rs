// SPDX-License-Identifier: MIT OR Apache-2.0
//! The state of threads inside and outside of calls. tests/c/thread_state.c has the whole library do its work so.

use super::*;
use std::hint::black_box;
use std::thread;
use std::time::Instant;

/// Bits of MXCSR, FPCR or FPSCR, and their default; none on machines whose control words bhr leaves alone.
#[cfg(target_arch = "x86_64")]
mod machine {
    use std::arch::asm;

    /// Subnormal numbers are 0; division by zero traps; rounds upward; an overflow has been.
    pub const GAMES: u32 = 0x8040 | 0x1f80 & !0x0200 | 0x4000 | 0x0008;
    pub const DEFAULT: u32 = 0x1f80;

    pub fn words() -> u32 {
        let mut mxcsr = 0_u32;
        // SAFETY: writes the variable.
        unsafe { asm!("stmxcsr [{0}]", in(reg) &raw mut mxcsr) };
        mxcsr
    }

    pub fn set(mxcsr: u32) {
        // SAFETY: reads the variable.
        unsafe { asm!("ldmxcsr [{0}]", in(reg) &raw const mxcsr) };
    }

    /// The x87's control word, and its flags.
    pub fn x87() -> (u16, u16) {
        let (mut control, mut status) = (0_u16, 0_u16);
        // SAFETY: writes the variables.
        unsafe {
            asm!("fnstcw [{0}]", "fnstsw [{1}]", in(reg) &raw mut control, in(reg) &raw mut status);
        }
        (control, status & 0x3f)
    }

    pub fn set_x87(control: u16) {
        // SAFETY: reads the variable.
        unsafe { asm!("fldcw [{0}]", in(reg) &raw const control) };
    }

    /// Divides 1 by 0 on the x87.
    pub fn divide_by_zero_on_x87() {
        // SAFETY: the register that it fills is emptied again; the exception comes with the last instruction at the
        // latest, where it is not masked.
        unsafe { asm!("fld1", "fldz", "fdivp", "fstp st(0)", "fwait", out("st(0)") _, out("st(1)") _) };
    }
}

#[cfg(target_arch = "x86_64")]
#[test]
fn a_call_has_default_words_and_gives_those_of_the_host_back() {
    use machine::*;
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

#[cfg(target_os = "linux")]
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

/// Takes so many KiB of stack, and more in builds without optimisation.
#[cfg(all(target_os = "linux", target_arch = "x86_64"))]
#[inline(never)]
fn take(kib: usize) -> usize {
    let room = black_box([0_u8; 1024]);
    if kib <= 1 { room.len() } else { take(kib - 1) + black_box(&room).len() }
}

#[cfg(all(target_os = "linux", target_arch = "x86_64"))]
#[test]
fn a_thread_with_little_stack_gets_more_and_its_callbacks_do_not_see_it() {
    // An address tells which stack a thread is on.
    let here = || psm::stack_pointer().addr();
    let small = thread::Builder::new().stack_size(64 << 10).spawn(move || {
        let outside = here();
        let near = |address: usize| outside.abs_diff(address) < 64 << 10;
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

/// The price of every call: the best of many rounds, as other programs run on the machine too. A host that traps pays
/// for the control word of the x87 as well, 0.15 us on the machine where this was measured (AMD EPYC, virtual).
#[test]
fn a_call_costs_less_than_a_fifth_of_a_microsecond() {
    const CALLS: u32 = 1000;
    let best = || {
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
    };
    let plain = best();
    #[cfg(target_arch = "x86_64")]
    let trapping = {
        machine::set(0x1f80 & !0x0680);
        machine::set_x87(0x0360);
        let trapping = best();
        machine::set(machine::DEFAULT);
        machine::set_x87(0x037f);
        trapping
    };
    #[cfg(not(target_arch = "x86_64"))]
    let trapping = plain;
    println!("a call: {plain:?}; of a host that traps floating-point exceptions: {trapping:?}");
    assert!(plain.as_nanos() < 200 && trapping.as_nanos() < 400, "{plain:?}, {trapping:?}");
}
