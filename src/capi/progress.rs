// SPDX-License-Identifier: MIT OR Apache-2.0
//! The host's progress callback, as frames report to it.

use super::callback::InsideCallback;
use super::log::User;
use std::ffi::c_void;

/// The host's progress callback with its argument.
#[derive(Clone, Copy)]
pub(super) struct Callback {
    pub function: unsafe extern "C" fn(*mut c_void, f64) -> i32,
    pub user: User,
}

/// Tells the callback of one frame's progress: never less than before, never outside 0 .. 1.
pub(super) struct Report {
    callback: Option<Callback>,
    told: f64,
}

impl Report {
    pub(super) fn new(callback: Option<Callback>) -> Self {
        Self { callback, told: 0.0 }
    }

    /// False: cancel.
    pub(super) fn tell(&mut self, fraction: f64) -> bool {
        if fraction > self.told {
            self.told = fraction.min(1.0);
        }
        let Some(callback) = self.callback else {
            return true;
        };
        let told = self.told;
        // SAFETY: the host gave this function with this pointer for this context's frames.
        InsideCallback::progress().run(|| unsafe { (callback.function)(callback.user.0, told) }) != 0
    }

    /// The last word, if it has not been said.
    pub(super) fn finish(&mut self) {
        if self.told < 1.0 {
            self.tell(1.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn progress_never_falls_nor_leaves_its_range() {
        unsafe extern "C" fn keep(user: *mut c_void, fraction: f64) -> i32 {
            // SAFETY: the test passes this Vec.
            unsafe { &mut *user.cast::<Vec<f64>>() }.push(fraction);
            i32::from(fraction < 0.5)
        }
        let mut heard: Vec<f64> = Vec::new();
        let user = User((&raw mut heard).cast());
        let mut report = Report { callback: Some(Callback { function: keep, user }), told: 0.0 };
        let go_on: Vec<bool> = [0.0, 0.25, 0.125, f64::NAN, -1.0, 7.0].map(|fraction| report.tell(fraction)).into();
        report.finish();
        assert_eq!(heard, [0.0, 0.25, 0.25, 0.25, 0.25, 1.0]);
        assert_eq!(go_on, [true, true, true, true, true, false]);
    }
}
