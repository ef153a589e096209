// SPDX-License-Identifier: MIT OR Apache-2.0
//! Numbers that look random and are the same on every machine.

/// A bijection of 32 bits in which every input bit moves every output bit (Wellons 2018, "lowbias32").
pub fn mix(mut x: u32) -> u32 {
    x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
    x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

/// Whether tests take as long as it takes, in `tests/run all`; everyday they stay short.
#[cfg(test)]
pub fn runs_all() -> bool {
    std::env::var("BHR_TESTS_ALL").is_ok_and(|value| value == "1")
}
