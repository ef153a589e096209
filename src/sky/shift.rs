// SPDX-License-Identifier: MIT OR Apache-2.0
//! The light of sky maps under frequency shifts. The same in both tracers (`shaders/sky/shift.wgsl`), by one table.
//! Knows no maps.
//!
//! A picture tells three numbers of light, not its spectrum; so it is taken for light that shifts as a blackbody of
//! its blue-to-red ratio does, of 2500 K to 25000 K: each channel is multiplied by what that blackbody's is. The
//! table holds that factor m(colour, g), both g of a shift being g, as (m / g)^(1/4), which bends little: along
//! g / (1 + g), which has g = 1 on a node, where m is 1, so that unshifted light stays as it is; and along
//! s = sqrt(blue) / (sqrt(red) + sqrt(blue)), which takes no logarithm and spaces its nodes as evenly.

use crate::physics::blackbody::{BlackbodyTable, MAX_BEAMING, MAX_RATIO};
use std::sync::OnceLock;

/// Brightest light: finite in f32, whatever the host multiplies it by.
pub(crate) const MAX_MAP_LIGHT: f64 = 1e9;
/// The least blue and red that have a colour; the colour of darker light is not looked at.
pub(crate) const TINY_LIGHT: f64 = 1e-9;

// Colours are taken for temperatures from 2500 K to 25000 K: those of the reddest and the bluest stars.
/// ln(blue / red) of such blackbodies, linear Rec. 709, and the s of those ratios.
const COOLEST_RATIO: f64 = -2.696;
const HOTTEST_RATIO: f64 = 0.973;
pub(crate) const COOLEST_COLOUR: f64 = 0.206_197_539_675;
pub(crate) const HOTTEST_COLOUR: f64 = 0.619_281_575_881;
/// Coefficients of 1000 K / T in powers of ln(blue / red), between those: least squares, at most 0.15 % off.
const INVERSE_TEMPERATURE: [f64; 6] =
    [0.152_906_4, -0.102_254_5, -0.005_097_082, -0.005_358_591, -0.003_424_309, -0.000_596_459_5];

/// Nodes of a row of the table, along s; and rows, along g / (1 + g): row SHIFT_SCALE is that of infinite g, and the
/// one behind it repeats it.
pub(crate) const SHIFT_COLOURS: usize = 64;
const SHIFT_ROWS: usize = 256;
pub(crate) const SHIFT_SCALE: f64 = 254.0;
pub(crate) const SHIFT_SIZE: usize = SHIFT_COLOURS * SHIFT_ROWS;
/// The row of infinite g is that of this one.
const FAR_SHIFT: f64 = 1e6;

/// The table, row by row; of each node red, green, blue, 0.
pub struct ShiftTable(Vec<[f32; 4]>);

impl ShiftTable {
    /// The one of this process, made at first use (some milliseconds).
    pub fn shared() -> &'static Self {
        static SHARED: OnceLock<ShiftTable> = OnceLock::new();
        SHARED.get_or_init(|| Self((0..SHIFT_SIZE).map(Self::node).collect()))
    }

    pub fn nodes(&self) -> &[[f32; 4]] {
        &self.0
    }

    fn node(index: usize) -> [f32; 4] {
        let (row, column) = (index / SHIFT_COLOURS, index % SHIFT_COLOURS);
        let s = COOLEST_COLOUR + (HOTTEST_COLOUR - COOLEST_COLOUR) * column as f64 / (SHIFT_COLOURS - 1) as f64;
        let temperature = colour_temperature(2.0 * (s / (1.0 - s)).ln());
        let y = row as f64 / SHIFT_SCALE;
        let g = if y < 1.0 { y / (1.0 - y) } else { FAR_SHIFT };
        if g == 0.0 {
            return [0.0; 4];
        }
        let table = BlackbodyTable::shared();
        let log_reference = table.ln_luminance(temperature);
        let rest = table.shifted_blackbody(temperature, log_reference, 1.0, 1.0);
        let seen = table.shifted_blackbody(temperature, log_reference, g, g);
        let [r, g, b] = std::array::from_fn(|c| (seen[c] / (rest[c] * g)).sqrt().sqrt() as f32);
        [r, g, b, 0.0]
    }

    /// (m / g)^(1/4) of the channels of light whose s is `colour`, between the nodes. `g` > 0.
    fn root(&self, colour: f64, g: f64) -> [f32; 4] {
        const COLUMNS: f64 = (SHIFT_COLOURS - 1) as f64 / (HOTTEST_COLOUR - COOLEST_COLOUR);
        let x = ((colour - COOLEST_COLOUR) * COLUMNS).clamp(0.0, (SHIFT_COLOURS - 1) as f64);
        let y = (1.0 - 1.0 / (1.0 + g)) * SHIFT_SCALE;
        let (column, row) = ((x as usize).min(SHIFT_COLOURS - 2), (y as usize).min(SHIFT_ROWS - 2));
        let (sx, sy) = ((x - column as f64) as f32, (y - row as f64) as f32);
        let first = row * SHIFT_COLOURS + column;
        let Some([a, b]) = self.0.get(first..first + 2) else { return [0.0; 4] };
        let Some([c, d]) = self.0.get(first + SHIFT_COLOURS..first + SHIFT_COLOURS + 2) else { return [0.0; 4] };
        std::array::from_fn(|i| {
            let (above, below) = (a[i] + (b[i] - a[i]) * sx, c[i] + (d[i] - c[i]) * sx);
            above + (below - above) * sy
        })
    }
}

/// Light of a map under a shift; shifts as for `BlackbodyTable::shifted_blackbody`. Exact for the light of stars and
/// dust; unshifted light stays as it is.
pub fn shifted_map_light(rgb: [f64; 3], g_colour: f64, g_beaming: f64) -> [f64; 3] {
    // The condition is positive so that it is false for NaN.
    let shines = g_colour > 0.0 && g_beaming > 0.0;
    if !shines {
        return [0.0; 3];
    }
    let [red, blue] = [rgb[0], rgb[2]].map(|v| v.max(TINY_LIGHT).sqrt());
    let root = ShiftTable::shared().root(blue / (red + blue), g_colour);
    let beaming = (g_beaming / g_colour).min(MAX_BEAMING);
    let gain = (beaming * beaming) * (beaming * beaming);
    let g = g_colour.min(MAX_BEAMING);
    std::array::from_fn(|c| {
        let root2 = f64::from(root[c]) * f64::from(root[c]);
        // The factors are multiplied in this order so that no product is 0 times infinity, in f32 either.
        (rgb[c] * (root2 * root2 * g * gain).min(MAX_RATIO)).min(MAX_MAP_LIGHT)
    })
}

/// Temperature, K, of the blackbody of this ln(blue / red).
fn colour_temperature(ln_ratio: f64) -> f64 {
    let x = ln_ratio.clamp(COOLEST_RATIO, HOTTEST_RATIO);
    1000.0 / INVERSE_TEMPERATURE.iter().rev().fold(0.0, |sum, coefficient| sum * x + coefficient)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_those_of_the_ratios() {
        for (ln_ratio, colour) in [(COOLEST_RATIO, COOLEST_COLOUR), (HOTTEST_RATIO, HOTTEST_COLOUR)] {
            assert!((1.0 / (1.0 + (-0.5 * ln_ratio).exp()) - colour).abs() < 1e-9, "{ln_ratio}");
        }
    }

    /// Between the nodes the table is as its formula is at them.
    #[test]
    fn the_table_is_fine_enough() {
        let table = BlackbodyTable::shared();
        for i in 0..=300 {
            let ln_ratio = COOLEST_RATIO + (HOTTEST_RATIO - COOLEST_RATIO) * f64::from(i) / 300.0;
            let temperature = colour_temperature(ln_ratio);
            let colour = 1.0 / (1.0 + (-0.5 * ln_ratio).exp());
            let log_reference = table.ln_luminance(temperature);
            let rest = table.shifted_blackbody(temperature, log_reference, 1.0, 1.0);
            for j in 0..=400 {
                let g = 0.3 * 20.0_f64.powf(f64::from(j) / 400.0);
                let seen = table.shifted_blackbody(temperature, log_reference, g, g);
                let root = ShiftTable::shared().root(colour, g);
                for c in 0..3 {
                    let (found, wanted) = (f64::from(root[c]).powi(4) * g, seen[c] / rest[c]);
                    // Far from g = 1 less is asked of what is darker.
                    let slack = 3e-3 * wanted + 1e-3;
                    assert!((found - wanted).abs() < slack, "{temperature} K, g {g}: {found} for {wanted}");
                }
            }
        }
    }

    #[test]
    fn colour_temperature_is_that_of_blackbodies() {
        let table = BlackbodyTable::shared();
        for i in 0..=400 {
            let temperature = 1.0 / (1.0 / 25000.0 + (1.0 / 2500.0 - 1.0 / 25000.0) * f64::from(i) / 400.0);
            let [r, _, b] = table.shade(temperature, temperature);
            let found = colour_temperature((b / r).ln());
            assert!((found / temperature - 1.0).abs() < 3e-3, "{found} for {temperature}");
        }
        assert!((colour_temperature(f64::INFINITY) / 25000.0 - 1.0).abs() < 3e-3);
        assert!((colour_temperature(-1e9) / 2500.0 - 1.0).abs() < 3e-3);
    }

    /// Blackbody light shifts as a blackbody; g = 1 changes nothing, of any colour; nothing is negative or infinite.
    #[test]
    fn shifted_light_is_that_of_blackbodies() {
        let table = BlackbodyTable::shared();
        for temperature in [2600.0, 4000.0, 6500.0, 12000.0, 24000.0] {
            let log_reference = table.ln_luminance(temperature);
            let rest = table.shifted_blackbody(temperature, log_reference, 1.0, 1.0);
            for (g, beaming) in [(0.6, 0.6), (0.9, 0.9), (1.0, 1.0), (1.5, 1.5), (2.0, 1.0), (1.0, 1.3)] {
                let wanted = table.shifted_blackbody(temperature, log_reference, g, beaming);
                let found = shifted_map_light(rest, g, beaming);
                for c in 0..3 {
                    let slack = 0.02 * wanted[c] + 1e-3 * wanted[1];
                    assert!((found[c] - wanted[c]).abs() < slack, "{temperature} K, g {g}: {found:?} {wanted:?}");
                }
            }
        }
        for rgb in [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [65408.0, 1e-7, 3.0], [0.2, 0.3, 0.4]]
        {
            let same = shifted_map_light(rgb, 1.0, 1.0);
            assert!((0..3).all(|c| (same[c] - rgb[c]).abs() <= 1e-12 * rgb[c]), "{rgb:?}: {same:?}");
            for g in [0.0, 1e-6, 0.03, 5.0, 1e6, f64::INFINITY, f64::NAN] {
                let light = shifted_map_light(rgb, g, g);
                assert!(light.iter().all(|v| (0.0..=MAX_MAP_LIGHT).contains(v)), "{rgb:?} g {g}: {light:?}");
            }
        }
    }
}
