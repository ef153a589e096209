// SPDX-License-Identifier: MIT OR Apache-2.0
//! Errors of one quantity, and the bars that shares of them stay below.

/// A share of the errors, and what they stay below.
pub type Bar = (f64, f64);

/// Errors of one quantity, each with its scene and ray.
#[derive(Default)]
pub struct Errors(pub Vec<(f64, usize, usize)>);

impl Errors {
    pub fn add(&mut self, error: f64, scene: usize, ray: usize) {
        self.0.push((if error.is_nan() { f64::INFINITY } else { error }, scene, ray));
    }

    pub fn merge(&mut self, other: Self) {
        self.0.extend(other.0);
    }

    /// The value that the share `share` stays below, once sorted.
    fn at(&self, share: f64) -> (f64, usize, usize) {
        self.0[((self.0.len() as f64 * share) as usize).min(self.0.len() - 1)]
    }

    /// Prints the quantiles; complaints where the errors at the given shares exceed their bars.
    pub fn judge(mut self, what: &str, bars: &[Bar]) -> Vec<String> {
        if self.0.is_empty() {
            return vec![format!("{what}: nothing was compared")];
        }
        self.0.sort_by(|a, b| a.0.total_cmp(&b.0));
        let [p50, p99, p999, p9999, max] = [0.5, 0.99, 0.999, 0.9999, 1.0].map(|share| self.at(share).0);
        let (_, scene, ray) = self.at(1.0);
        println!(
            "{what}: n {} 50 % {p50:.1e} 99 % {p99:.1e} 99.9 % {p999:.1e} 99.99 % {p9999:.1e} max {max:.1e} \
             (scene {scene} ray {ray})",
            self.0.len()
        );
        let failed = bars.iter().filter(|(share, bar)| self.at(*share).0 > *bar);
        failed
            .map(|(share, bar)| {
                let (error, scene, ray) = self.at(*share);
                format!("{what}: {:.2} % at {error:.3e} > {bar:.1e} (scene {scene} ray {ray})", 100.0 * share)
            })
            .collect()
    }
}
