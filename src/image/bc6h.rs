// SPDX-License-Identifier: MIT OR Apache-2.0
//! BC6H, unsigned: light in blocks of 4 x 4 texels and 16 bytes, which GPUs read as they are. Blocks of every mode are
//! read; those that are written have one line of colours. Khronos Data Format Specification 1.3, "BPTC Compressed
//! Texture Image Formats". Knows no files.

use half::f16;

/// Columns and rows of a block.
pub const SIDE: u32 = 4;

/// Weights of a line's second end in its sixteen colours, in 64ths.
const WEIGHTS: [i32; 16] = [0, 4, 9, 13, 17, 21, 26, 30, 34, 38, 43, 47, 51, 55, 60, 64];
const MODE_BITS: u32 = 5;

/// A mode with one line: bits a channel of the first end and of the second, which is a difference where it has fewer.
struct Mode {
    code: u128,
    first: u32,
    second: u32,
}

/// The modes of one line, the finest first.
const MODES: [Mode; 4] = [
    Mode { code: 0b01111, first: 16, second: 4 },
    Mode { code: 0b01011, first: 12, second: 8 },
    Mode { code: 0b00111, first: 11, second: 9 },
    Mode { code: 0b00011, first: 10, second: 10 },
];
/// Bits of the first ends that come before all else.
const LOW_BITS: u32 = 10;

/// Largest light that a block holds: that of the largest half float.
const MAX_LIGHT: f32 = 65504.0;
/// The least weight of a texel, beside 1 for the brightest of its block.
const LEAST_WEIGHT: f32 = 1e-3;

/// The light of a block's texels, row by row.
pub type Texels = [[f32; 3]; 16];

/// A picture, or a level of one, in blocks.
pub struct Blocks {
    /// Columns and rows of texels, each at least one.
    pub size: [u32; 2],
    /// Row by row; those at the right and at the bottom reach beyond the picture where its sides are no
    /// multiples of four.
    pub blocks: Vec<[u8; 16]>,
}

impl Blocks {
    /// Columns and rows of blocks of a picture of `size` texels.
    pub fn count(size: [u32; 2]) -> [usize; 2] {
        size.map(|side| side.div_ceil(SIDE) as usize)
    }

    /// A row of blocks; empty past the last.
    pub fn row(&self, row: usize) -> &[[u8; 16]] {
        let across = Self::count(self.size)[0];
        self.blocks.get(row * across..(row + 1) * across).unwrap_or(&[])
    }
}

/// The light of an unsigned block, or of a `signed` one.
pub fn decode(block: &[u8; 16], signed: bool) -> Texels {
    let mut halves = [0_u16; 48];
    bcdec_rs::bc6h_half(block, &mut halves, 12, signed);
    let texels = halves.as_chunks::<3>().0;
    std::array::from_fn(|i| texels.get(i).map_or([0.0; 3], |texel| texel.map(|bits| f16::from_bits(bits).to_f32())))
}

/// The block that comes nearest to this light. NaN and what is negative count as 0.
///
/// Colours of a block lie on a line between two ends, in the bits of half floats, which are about the logarithm of
/// light. The line is the main axis of the texels' colours, and is then fitted to them by least squares; both weigh
/// texels by the root of their light, so that a block keeps its sum: with equal weights, a star among dark texels would
/// lose light.
pub fn encode(texels: &Texels) -> [u8; 16] {
    let light = texels.map(|texel| texel.map(|v| if v > 0.0 { v.min(MAX_LIGHT) } else { 0.0 }));
    let codes = light.map(|texel| texel.map(|v| f32::from(f16::from_f32(v).to_bits())));
    let sums = light.map(|[r, g, b]| r + g + b);
    let top = sums.iter().fold(f32::MIN_POSITIVE, |top, sum| top.max(*sum));
    let weights = sums.map(|sum| (sum / top).sqrt().max(LEAST_WEIGHT));
    let mut line = Line::new(main_line(&codes, &weights));
    let mut places = line.places(&codes);
    if let Some(fitted) = fitted_ends(&codes, &weights, &places).map(Line::new) {
        let fitted_places = fitted.places(&codes);
        if fitted.distance(&codes, &weights, &fitted_places) < line.distance(&codes, &weights, &places) {
            (line, places) = (fitted, fitted_places);
        }
    }
    // The first texel's place has three bits: it lies in the line's first half.
    if places[0] > 7 {
        line.ends.swap(0, 1);
        places = places.map(|place| 15 - place);
    }
    line.bytes(&places)
}

/// A line of colours.
struct Line {
    mode: &'static Mode,
    /// Its ends in the bits of the mode's first, red, green and blue.
    ends: [[i32; 3]; 2],
}

impl Line {
    /// The line between two colours, as bits of half floats, in the finest mode in which it can be written.
    fn new(ends: [[f32; 3]; 2]) -> Self {
        let [.., last] = &MODES;
        let in_mode = |mode: &'static Mode| Self { mode, ends: ends.map(|end| end.map(|v| mode.quantised(v))) };
        let lines = MODES.iter().map(in_mode);
        lines.into_iter().find(|line| line.can_be_written()).unwrap_or_else(|| in_mode(last))
    }

    /// Whether the ends' difference fits the mode, in either order.
    fn can_be_written(&self) -> bool {
        let Mode { first, second, .. } = *self.mode;
        let [a, b] = self.ends;
        first == second || (0..3).all(|c| (a[c] - b[c]).abs() < 1 << (second - 1))
    }

    /// The colour at a place, as bits of half floats.
    fn colour(&self, place: usize) -> [f32; 3] {
        let weight = WEIGHTS[place];
        std::array::from_fn(|c| {
            let [first, last] = self.ends.map(|end| self.mode.widened(end[c]));
            let mixed = (first * (64 - weight) + last * weight + 32) >> 6;
            ((mixed * 31) >> 6) as f32
        })
    }

    /// The place that is nearest to each colour.
    fn places(&self, codes: &Texels) -> [usize; 16] {
        let [first, last] = [self.colour(0), self.colour(15)];
        let along: [f32; 3] = std::array::from_fn(|c| last[c] - first[c]);
        let length2 = along.iter().map(|v| v * v).sum::<f32>().max(1.0);
        codes.map(|code| {
            let share = (0..3).map(|c| (code[c] - first[c]) * along[c]).sum::<f32>() / length2;
            // WEIGHTS are the multiples of 64 / 15, rounded.
            (share * 15.0).round().clamp(0.0, 15.0) as usize
        })
    }

    /// The weighted sum of the squares of the colours' distances from their places.
    fn distance(&self, codes: &Texels, weights: &[f32; 16], places: &[usize; 16]) -> f32 {
        let texels = codes.iter().zip(weights).zip(places);
        texels
            .map(|((code, weight), place)| {
                let found = self.colour(*place);
                weight * (0..3).map(|c| (code[c] - found[c]) * (code[c] - found[c])).sum::<f32>()
            })
            .sum()
    }

    /// The block of texels at these places, the first of them in the line's first half.
    fn bytes(&self, places: &[usize; 16]) -> [u8; 16] {
        let Mode { code, first, second } = *self.mode;
        let (mut bits, mut at) = (code, MODE_BITS);
        let mut put = |number: u128, count: u32| {
            bits |= (number & ((1 << count) - 1)) << at;
            at += count;
        };
        let [begin, end] = self.ends;
        begin.iter().for_each(|v| put(*v as u128, LOW_BITS));
        for (begin, end) in begin.into_iter().zip(end) {
            // A number below 0 is cut to its last bits, which is what the mode wants of it.
            put(if first == second { end } else { end - begin } as u128, second);
            // The other bits of the first end, the highest of them first.
            (LOW_BITS..first).rev().for_each(|bit| put(begin as u128 >> bit, 1));
        }
        places.iter().enumerate().for_each(|(i, place)| put(*place as u128, if i == 0 { 3 } else { 4 }));
        bits.to_le_bytes()
    }
}

impl Mode {
    /// The number of an end whose colour, as bits of a half float, is nearest to `code`.
    fn quantised(&self, code: f32) -> i32 {
        // Decoders take 31 / 64 of an end in 16 bits.
        let end = code * (64.0 / 31.0);
        let step = (1 << (16 - self.first)) as f32;
        // In 16 bits the next higher number gives the code itself, as decoders cut.
        let number = if self.first == 16 { end.ceil() } else { ((end - 0.5 * step) / step).round() };
        number.clamp(0.0, ((1 << self.first) - 1) as f32) as i32
    }

    /// The end of this number in 16 bits, as decoders make it.
    fn widened(&self, end: i32) -> i32 {
        match self.first {
            16 => end,
            _ if end == 0 => 0,
            bits if end == (1 << bits) - 1 => 0xffff,
            bits => ((end << 16) + 0x8000) >> bits,
        }
    }
}

/// The ends of the line through the weighted mean of the colours along their main axis, at the outermost of them.
fn main_line(codes: &Texels, weights: &[f32; 16]) -> [[f32; 3]; 2] {
    let total = weights.iter().sum::<f32>();
    let mean: [f32; 3] =
        std::array::from_fn(|c| codes.iter().zip(weights).map(|(code, weight)| code[c] * weight).sum::<f32>() / total);
    let from_mean = codes.map(|code| [code[0] - mean[0], code[1] - mean[1], code[2] - mean[2]]);
    let mut spread = [[0.0_f32; 3]; 3];
    for (offset, weight) in from_mean.iter().zip(weights) {
        for (row, a) in spread.iter_mut().zip(offset) {
            row.iter_mut().zip(offset).for_each(|(sum, b)| *sum += weight * a * b);
        }
    }
    // Powers of the matrix, divided by their traces, tend to that of the main axis with itself.
    for _ in 0..4 {
        let trace = (spread[0][0] + spread[1][1] + spread[2][2]).max(f32::MIN_POSITIVE);
        let share = spread.map(|row| row.map(|v| v / trace));
        spread = share.map(|row| std::array::from_fn(|c| (0..3).map(|k| row[k] * share[k][c]).sum::<f32>()));
    }
    let widest = (0..3).fold(0, |widest, c| if spread[c][c] > spread[widest][widest] { c } else { widest });
    let length = spread[widest].iter().map(|v| v * v).sum::<f32>().sqrt();
    // The condition is positive so that it is false for NaN.
    let axis = if length > 0.0 { spread[widest].map(|v| v / length) } else { [0.0; 3] };
    let along = from_mean.map(|offset| (0..3).map(|c| offset[c] * axis[c]).sum::<f32>());
    let [first, last] =
        along.iter().fold([f32::MAX, f32::MIN], |[first, last], place| [first.min(*place), last.max(*place)]);
    [first, last].map(|place| std::array::from_fn(|c| mean[c] + axis[c] * place))
}

/// The ends of the line for which the colours at these places are nearest, by least squares. `None` where
/// the places do not determine a line.
fn fitted_ends(codes: &Texels, weights: &[f32; 16], places: &[usize; 16]) -> Option<[[f32; 3]; 2]> {
    let (mut squares, mut sums) = ([0.0_f32; 3], [[0.0_f32; 3]; 2]);
    for ((code, weight), place) in codes.iter().zip(weights).zip(places) {
        let last = WEIGHTS[*place] as f32 / 64.0;
        let first = 1.0 - last;
        for (square, product) in squares.iter_mut().zip([first * first, first * last, last * last]) {
            *square += weight * product;
        }
        for (sum, share) in sums.iter_mut().zip([first, last]) {
            sum.iter_mut().zip(code).for_each(|(sum, v)| *sum += weight * share * v);
        }
    }
    let [first, both, last] = squares;
    let determinant = first * last - both * both;
    if determinant < 1e-6 * (first + last) {
        return None;
    }
    let solved = |own: f32, a: [f32; 3], b: [f32; 3]| std::array::from_fn(|c| (a[c] * own - b[c] * both) / determinant);
    Some([solved(last, sums[0], sums[1]), solved(first, sums[1], sums[0])])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::mix;

    fn noise(i: u32) -> f32 {
        (mix(i) >> 8) as f32 / 16_777_216.0
    }

    /// One colour comes back to a part in a thousand, and steps that are about a line to some percent, because the
    /// wider a block's range is, the coarser are its sixteen steps.
    #[test]
    fn lines_of_colours_come_back() {
        for base in [1e-3_f32, 0.02, 0.7, 1.0, 40.0, 3e4] {
            let flat = [[base, 0.6 * base, 0.3 * base]; 16];
            let steps: Texels = std::array::from_fn(|i| [1.0, 0.6, 0.3].map(|c| base * c * 1.1_f32.powi(i as i32 % 7)));
            for (texels, slack) in [(flat, 0.0015), (steps, 0.04)] {
                let back = decode(&encode(&texels), false);
                for (found, wanted) in back.as_flattened().iter().zip(texels.as_flattened()) {
                    assert!((found / wanted - 1.0).abs() < slack, "{base}: {found}, wanted {wanted}");
                }
            }
        }
        assert_eq!(decode(&encode(&[[0.0; 3]; 16]), false), [[0.0; 3]; 16]);
    }

    #[test]
    fn any_numbers_are_finite_light() {
        for odd in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, f32::MAX, 1e-30] {
            let mut texels = [[0.5_f32; 3]; 16];
            texels[3] = [odd, 1.0, odd];
            texels[9] = [odd; 3];
            let back = decode(&encode(&texels), false);
            assert!(back.as_flattened().iter().all(|v| (0.0..=MAX_LIGHT).contains(v)), "{odd}: {back:?}");
        }
    }

    /// Colours of two channels that exclude each other stay apart, however bright they are.
    #[test]
    fn bright_colours_stay_apart() {
        for light in [1.0, 200.0, 1000.0, MAX_LIGHT] {
            for [a, b] in [[[light, light, 0.0], [0.0, 0.0, light]], [[light, 0.0, 0.0], [0.0, 0.0, light]]] {
                let texels: Texels = std::array::from_fn(|i| if (i + i / 4) % 2 == 0 { a } else { b });
                let back = decode(&encode(&texels), false);
                for (found, wanted) in back.as_flattened().iter().zip(texels.as_flattened()) {
                    assert!((found - wanted).abs() <= 0.02 * light, "{light}: {found}, wanted {wanted}");
                }
            }
        }
    }

    /// Blocks of narrower ranges are written in finer modes, in either order of their ends.
    #[test]
    fn every_mode_is_written() {
        let mut seen = std::collections::BTreeMap::new();
        for i in 0..4000_u32 {
            let spread = 10.0_f32.powf(8.0 * noise(i) - 5.0);
            let base = 0.5 + noise(i + 1);
            let texels: Texels = std::array::from_fn(|k| {
                [1.0, 0.7, 0.4].map(|c| c * base * (1.0 + spread * noise(16 * i + k as u32).powi(4)))
            });
            let block = encode(&texels);
            let back = decode(&block, false);
            let off = back.as_flattened().iter().zip(texels.as_flattened()).map(|(a, b)| (a / b - 1.0).abs());
            let worst = off.fold(0.0, f32::max);
            let (count, most) = seen.entry(block[0] & 31).or_insert((0, 0.0_f32));
            (*count, *most) = (*count + 1, most.max(worst));
        }
        // Where a channel passes a power of two, the line bends in the bits of half floats.
        let wanted = [(0b01111, 0.003), (0b01011, 0.1), (0b00111, 0.25), (0b00011, 0.6)];
        for (mode, most) in wanted {
            let (count, worst) = seen.get(&mode).copied().unwrap_or_default();
            assert!(count > 50 && worst < most, "mode {mode:05b}: {count} blocks, off by {worst}");
        }
    }

    /// Stars of many brightnesses and colours over a noisy ground keep their light: sums to 1 %, and every texel's own
    /// error, relative, to 6 % (rms), though each block has only one line of colours.
    #[test]
    fn stars_keep_their_light() {
        let (mut sum, mut wanted_sum, mut squares, mut count) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
        for block in 0..4000_u32 {
            let mut texels: Texels = std::array::from_fn(|i| {
                let v = 0.02 * (0.6 + 0.8 * noise(block * 64 + i as u32));
                [v, v, 1.1 * v]
            });
            if block % 2 == 0 {
                let (place, light) = (mix(block) as usize % 11, 0.05 * noise(block + 7).max(1e-3).powf(-1.5));
                let warmth = 0.8 * (noise(block + 99) - 0.5);
                for (texel, share) in [(place, 1.0), (place + 1, 0.4), (place + 4, 0.4), (place + 5, 0.15)] {
                    for (v, c) in texels[texel].iter_mut().zip([1.0 + warmth, 1.0, 1.0 - warmth]) {
                        *v += light * share * c;
                    }
                }
            }
            let back = decode(&encode(&texels), false);
            for (found, wanted) in back.as_flattened().iter().zip(texels.as_flattened()) {
                sum += f64::from(*found);
                wanted_sum += f64::from(*wanted);
                squares += f64::from(found / wanted - 1.0).powi(2);
                count += 1.0;
            }
        }
        let (mean, rms) = (sum / wanted_sum - 1.0, (squares / count).sqrt());
        assert!(mean.abs() < 0.01 && rms < 0.06, "sum {mean:+}, rms {rms}");
    }
}
