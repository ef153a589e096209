// SPDX-License-Identifier: MIT OR Apache-2.0
//! Numbers for tests with random scenes, the same in every run. Knows directions, no scenes.

#![allow(dead_code)]

use glam::DVec3;

/// Numerical Recipes' 64-bit linear congruential generator: repeatable.
pub struct Random(pub u64);

impl Random {
    /// The next number, in [0, 1).
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn range(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    /// Evenly spread in its logarithm.
    pub fn log_range(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.next())
    }

    pub fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[((self.next() * from.len() as f64) as usize).min(from.len() - 1)]
    }

    pub fn direction(&mut self) -> DVec3 {
        let z = 2.0 * self.next() - 1.0;
        let (s, c) = (std::f64::consts::TAU * self.next()).sin_cos();
        let rho = (1.0 - z * z).sqrt();
        DVec3::new(rho * c, rho * s, z)
    }
}

/// The count that the environment variable `name` asks for; else `all` in `tests/run all`, and `everyday` otherwise.
pub fn count_from(name: &str, everyday: usize, all: usize) -> usize {
    let default = if runs_all() { all } else { everyday };
    std::env::var(name).map_or(default, |text| text.parse().unwrap_or_else(|e| panic!("{name}={text}: {e}")))
}

/// Whether long soaks run: `tests/run all`.
pub fn runs_all() -> bool {
    std::env::var("BHR_TESTS_ALL").is_ok_and(|value| value == "1")
}
