// SPDX-License-Identifier: MIT OR Apache-2.0
//! The control words of floating point, which every thread has of its own: how results are rounded, which exceptions
//! trap, and what becomes of subnormal numbers; and the flags of exceptions since they were last cleared. Rust knows
//! the default only: round to nearest, no traps, subnormal numbers as they are.

pub use machine::ControlWords;

/// SSE has MXCSR for control and flags; the x87, which C's `long double` and code for 32 bits use, has a word for each.
#[cfg(any(target_arch = "x86_64", target_arch = "x86"))]
mod machine {
    use std::arch::asm;

    const MXCSR: u32 = 0x1f80;
    /// Windows counts in 53 bits, other systems in 64.
    const X87_CONTROL: u16 = if cfg!(windows) { 0x027f } else { 0x037f };
    /// The flags in the x87's status word, and the two bits that sum up those that are not masked.
    const X87_FLAGS: u16 = 0x80ff;

    #[derive(Clone, Copy)]
    pub struct ControlWords {
        mxcsr: u32,
        x87_control: u16,
        x87_status: u16,
    }

    impl ControlWords {
        pub fn of_thread() -> Self {
            let (mut mxcsr, mut x87_control, mut x87_status) = (0_u32, 0_u16, 0_u16);
            // SAFETY: writes the three variables, and waits for no exception of the x87's that is pending.
            unsafe {
                asm!(
                    "stmxcsr [{mxcsr}]", "fnstcw [{control}]", "fnstsw [{status}]",
                    mxcsr = in(reg) &raw mut mxcsr,
                    control = in(reg) &raw mut x87_control,
                    status = in(reg) &raw mut x87_status,
                    options(nostack, preserves_flags)
                );
            }
            Self { mxcsr, x87_control, x87_status }
        }

        pub fn set(self) {
            set_mxcsr(self.mxcsr);
            let now = Self::of_thread();
            if (now.x87_status ^ self.x87_status) & X87_FLAGS != 0 {
                set_x87(self.x87_control, self.x87_status);
            } else if now.x87_control != self.x87_control {
                set_x87_control(self.x87_control);
            }
        }

        pub fn set_default() {
            set_mxcsr(MXCSR);
            let now = Self::of_thread();
            // Flags of the x87's do no harm while nothing traps.
            if now.x87_control == X87_CONTROL {
                return;
            }
            if now.x87_status & X87_FLAGS != 0 {
                // SAFETY: clears the flags, and waits for none of them.
                unsafe { asm!("fnclex", options(nomem, nostack, preserves_flags)) }
            }
            set_x87_control(X87_CONTROL);
        }
    }

    fn set_mxcsr(mxcsr: u32) {
        // SAFETY: reads the variable; the value is a constant of this file, or was read from the register. A flag whose
        // exception is not masked does not trap by being loaded.
        unsafe { asm!("ldmxcsr [{0}]", in(reg) &raw const mxcsr, options(nostack, preserves_flags, readonly)) }
    }

    /// No flag may be set whose exception is not masked, now or then: it would trap.
    fn set_x87_control(control: u16) {
        // SAFETY: reads the variable; the value was read from the x87, or is a constant of this file.
        unsafe { asm!("fldcw [{0}]", in(reg) &raw const control, options(nostack, preserves_flags, readonly)) }
    }

    /// Sets control and flags at once: a flag that is set while its exception is not masked would trap later on. The
    /// registers of the x87, and which of them is the top, stay as they are. It costs some 100 cycles.
    #[cold]
    fn set_x87(control: u16, status: u16) {
        let mut environment = [0_u32; 7];
        // SAFETY: reads and writes the variable, which has the size of the environment; the values were read from the
        // x87, or are constants of this file.
        unsafe {
            asm!("fnstenv [{0}]", in(reg) &raw mut environment, options(nostack, preserves_flags));
            environment[0] = environment[0] & !0xffff | u32::from(control);
            environment[1] = environment[1] & !u32::from(X87_FLAGS) | u32::from(status & X87_FLAGS);
            asm!("fldenv [{0}]", in(reg) &raw const environment, options(nostack, preserves_flags));
        }
    }
}

/// FPCR for control, FPSR for flags; both are 0 by default.
#[cfg(target_arch = "aarch64")]
mod machine {
    use std::arch::asm;

    #[derive(Clone, Copy, PartialEq)]
    pub struct ControlWords {
        control: u64,
        flags: u64,
    }

    impl ControlWords {
        pub fn of_thread() -> Self {
            let (control, flags);
            // SAFETY: reads two registers.
            unsafe {
                asm!(
                    "mrs {0}, fpcr", "mrs {1}, fpsr", out(reg) control, out(reg) flags,
                    options(nostack, preserves_flags)
                );
            }
            Self { control, flags }
        }

        pub fn set(self) {
            // To write FPCR waits for all that is under way.
            if self == Self::of_thread() {
                return;
            }
            // SAFETY: the values are 0, or were read from the registers.
            unsafe {
                asm!(
                    "msr fpcr, {0}", "msr fpsr, {1}", in(reg) self.control, in(reg) self.flags,
                    options(nostack, preserves_flags)
                );
            }
        }

        pub fn set_default() {
            Self { control: 0, flags: 0 }.set();
        }
    }
}

/// FPSCR for both, 0 by default.
#[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
mod machine {
    use std::arch::asm;

    #[derive(Clone, Copy)]
    pub struct ControlWords(u32);

    impl ControlWords {
        pub fn of_thread() -> Self {
            let words;
            // SAFETY: reads a register.
            unsafe { asm!("vmrs {0}, fpscr", out(reg) words, options(nostack, preserves_flags)) }
            Self(words)
        }

        pub fn set(self) {
            // SAFETY: the value is 0, or was read from the register.
            unsafe { asm!("vmsr fpscr, {0}", in(reg) self.0, options(nostack, preserves_flags)) }
        }

        pub fn set_default() {
            Self(0).set();
        }
    }
}

/// Other machines keep what the host has set.
#[cfg(not(any(
    target_arch = "x86_64",
    target_arch = "x86",
    target_arch = "aarch64",
    all(target_arch = "arm", target_abi = "eabihf")
)))]
mod machine {
    #[derive(Clone, Copy)]
    pub struct ControlWords;

    impl ControlWords {
        pub fn of_thread() -> Self {
            Self
        }

        pub fn set(self) {}

        pub fn set_default() {}
    }
}
