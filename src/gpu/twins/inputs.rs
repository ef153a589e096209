// SPDX-License-Identifier: MIT OR Apache-2.0
//! Random numbers that both twins are given, and the values that the one in Rust expects of the one in WGSL.

use glam::{DVec2, DVec3, DVec4};
use std::f64::consts::TAU;

/// The most words that an item may have of inputs, and of outputs.
pub const INPUTS: usize = 96;
pub const OUTPUTS: usize = 40;

/// splitmix64 (Steele, Lea & Flood 2014).
#[derive(Clone)]
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Even in [0, 1).
    pub fn share(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn even(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.share()
    }

    /// Even in the logarithm.
    pub fn log(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.share())
    }

    pub fn below(&mut self, count: u32) -> u32 {
        ((self.bits() >> 32) % u64::from(count)) as u32
    }

    /// A direction, evenly over the sphere.
    pub fn direction(&mut self) -> DVec3 {
        let z = self.even(-1.0, 1.0);
        let (sin, cos) = self.even(0.0, TAU).sin_cos();
        let rho = (1.0 - z * z).sqrt();
        DVec3::new(rho * cos, rho * sin, z)
    }
}

/// The inputs of one item: words, of which those of f32 are numbers that either twin gets exactly.
pub struct Inputs {
    pub random: Random,
    pub words: Vec<u32>,
    /// Whether a word is an f32, and the relative shift under which the twin in Rust sees it.
    shifts: Vec<Option<f64>>,
}

impl Inputs {
    pub fn new(seed: u64) -> Self {
        Self { random: Random(seed), words: Vec::new(), shifts: Vec::new() }
    }

    /// Keeps only the first `count`.
    pub fn truncate(&mut self, count: usize) {
        self.words.truncate(count);
        self.shifts.truncate(count);
    }

    pub fn clear(&mut self) {
        self.truncate(0);
    }

    /// Adds a number, and gives it as it was rounded.
    pub fn push(&mut self, value: f64) -> f64 {
        self.words.push((value as f32).to_bits());
        self.shifts.push(Some(0.0));
        f64::from(value as f32)
    }

    pub fn push_word(&mut self, word: u32) -> u32 {
        self.words.push(word);
        self.shifts.push(None);
        word
    }

    pub fn even(&mut self, low: f64, high: f64) -> f64 {
        let value = self.random.even(low, high);
        self.push(value)
    }

    pub fn log(&mut self, low: f64, high: f64) -> f64 {
        let value = self.random.log(low, high);
        self.push(value)
    }

    /// Even in the logarithm, of either sign.
    pub fn signed(&mut self, low: f64, high: f64) -> f64 {
        let value = self.random.log(low, high);
        let value = if self.random.below(2) == 0 { value } else { -value };
        self.push(value)
    }

    pub fn evens(&mut self, count: usize, low: f64, high: f64) {
        for _ in 0..count {
            self.even(low, high);
        }
    }

    pub fn pick(&mut self, count: u32) -> u32 {
        let word = self.random.below(count);
        self.push_word(word)
    }

    pub fn bits(&mut self) -> u32 {
        let word = self.random.bits() as u32;
        self.push_word(word)
    }

    pub fn vector(&mut self, v: DVec3) -> DVec3 {
        DVec3::from_array(v.to_array().map(|c| self.push(c)))
    }

    pub fn direction(&mut self) -> DVec3 {
        let d = self.random.direction();
        self.vector(d)
    }

    /// Number `k`, under the shift at hand.
    pub fn x(&self, k: usize) -> f64 {
        f64::from(f32::from_bits(self.words[k])) * (1.0 + self.shifts[k].expect("a number, not a word"))
    }

    pub fn f(&self, k: usize) -> f32 {
        f32::from_bits(self.words[k])
    }

    pub fn word(&self, k: usize) -> u32 {
        self.words[k]
    }

    pub fn v2(&self, k: usize) -> DVec2 {
        DVec2::new(self.x(k), self.x(k + 1))
    }

    pub fn v3(&self, k: usize) -> DVec3 {
        DVec3::new(self.x(k), self.x(k + 1), self.x(k + 2))
    }

    pub fn v4(&self, k: usize) -> DVec4 {
        self.v3(k).extend(self.x(k + 3))
    }

    /// Shifts each number by the rounding of f32, up or down.
    pub fn shift(&mut self, random: &mut Random) {
        const ROUNDING: f64 = 1.0 / 16_777_216.0;
        for shift in self.shifts.iter_mut().flatten() {
            *shift = if random.below(2) == 0 { ROUNDING } else { -ROUNDING };
        }
    }

    pub fn unshift(&mut self) {
        self.shifts.iter_mut().flatten().for_each(|shift| *shift = 0.0);
    }

    /// For messages.
    pub fn shown(&self) -> String {
        let words = self.words.iter().zip(&self.shifts);
        let shown = words.map(|(word, shift)| match shift {
            Some(_) => format!("{:?}", f32::from_bits(*word)),
            None => format!("{word}u"),
        });
        shown.collect::<Vec<_>>().join(", ")
    }
}

/// The values that are expected, each with the size that errors of it are measured in.
#[derive(Default)]
pub struct Outputs {
    pub values: Vec<(f64, f64)>,
}

impl Outputs {
    /// A value whose error counts relative to itself.
    pub fn put(&mut self, value: f64) {
        self.near(value, value);
    }

    /// A value whose error counts relative to itself or to `scale`, whichever is greater.
    pub fn near(&mut self, value: f64, scale: f64) {
        self.values.push((value, value.abs().max(scale.abs())));
    }

    pub fn word(&mut self, word: u32) {
        self.values.push((f64::from(word & 0xffff), 0.0));
        self.values.push((f64::from(word >> 16), 0.0));
    }

    pub fn flag(&mut self, flag: bool) {
        self.values.push((f64::from(u8::from(flag)), 0.0));
    }

    /// Numbers whose errors count relative to the greatest of them, or to `scale`.
    pub fn all(&mut self, values: impl IntoIterator<Item = f64>, scale: f64) {
        let values = values.into_iter().collect::<Vec<_>>();
        let greatest = values.iter().filter(|v| v.is_finite()).fold(scale.abs(), |most, v| most.max(v.abs()));
        self.values.extend(values.into_iter().map(|v| (v, greatest)));
    }

    pub fn v3(&mut self, v: DVec3) {
        self.all(v.to_array(), 0.0);
    }
}
