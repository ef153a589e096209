// SPDX-License-Identifier: MIT OR Apache-2.0
//! The moments at which the samples of a frame see matter that moves, while a shutter is open. Knows samples by their
//! numbers alone.

/// How long a shutter is open, M, half of it before the frame's time.
#[derive(Clone, Copy, Debug, Default)]
pub struct Shutter(pub f64);

impl Shutter {
    pub fn is_open(self) -> bool {
        self.0 > 0.0
    }

    /// The time of sample `index` of `count` less that of the frame, M: the middle of its part of the time.
    pub fn moment(self, index: u32, count: u32) -> f64 {
        self.0 * ((f64::from(index) + 0.5) / f64::from(count) - 0.5)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_the_middles_of_even_parts() {
        assert_eq!(Shutter(4.0).moment(0, 1), 0.0);
        assert_eq!([0, 1, 2, 3].map(|index| Shutter(4.0).moment(index, 4)), [-1.5, -0.5, 0.5, 1.5]);
        assert_eq!(Shutter(0.0).moment(3, 8), 0.0);
    }
}
