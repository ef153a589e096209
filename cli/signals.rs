// SPDX-License-Identifier: MIT OR Apache-2.0
//! SIGINT and SIGTERM: the first asks for an end, at which what is being written is finished; a second one ends the
//! program at once. Knows no frames.

use crate::ending::Ending;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// The signal that has come; 0: none.
#[derive(Clone, Default)]
pub struct Signals(Arc<AtomicUsize>);

impl Signals {
    /// From now on signals ask for an end.
    pub fn listen() -> Self {
        let signals = Self::default();
        let again = Arc::new(AtomicBool::new(false));
        for signal in [signal_hook::consts::SIGINT, signal_hook::consts::SIGTERM] {
            // In this order, so that the first signal does not end the program by what it sets itself. Where a signal
            // cannot be had it ends the program as ever.
            let _ = signal_hook::flag::register_conditional_shutdown(signal, 128 + signal, again.clone());
            let _ = signal_hook::flag::register(signal, again.clone());
            let _ = signal_hook::flag::register_usize(signal, signals.0.clone(), signal as usize);
        }
        signals
    }

    pub fn has_come(&self) -> bool {
        self.0.load(Ordering::Relaxed) != 0
    }

    /// Errors: the end that a signal has asked for.
    pub fn check(&self) -> Result<(), Ending> {
        match self.0.load(Ordering::Relaxed) {
            0 => Ok(()),
            number => Err(Ending::signal(number)),
        }
    }
}
