// SPDX-License-Identifier: MIT OR Apache-2.0
//! Matter with depth at half resolution: where the sum along one ray of each block of 2 x 2 pixels stands for those of
//! its pixels, and where a pixel's own ray has to be summed. Mirrored by `shaders/emit/half.wgsl`. Knows media and whole
//! numbers; no ray, no tracer and no picture.
//!
//! Blocks are counted from the corner of the full frame, so that a part of a frame has the blocks of the whole. The ray
//! of block b of a row goes through pixel coordinate 2 b + 1, the middle of its two pixels, plus what the sample lies
//! off the middle of a pixel. A pixel's centre is then a quarter of the way from the block nearest to it to the next,
//! and its medium is found from 4 x 4 blocks, which all must have met the same crossings and the same fate as the
//! pixel: by the cubic through four of them (Lagrange), a row at a time. The straight line between the middle two is
//! the rule of lower order that says how far the cubic may be off, as in embedded Runge-Kutta methods: where both
//! differ by more than `TOLERANCE`, the pixel's own ray is summed. The line's error is about what they differ by, and
//! that of the cubic smaller the smoother the matter is.

use super::medium::Medium;
use std::array::from_fn;

/// Pixels along the side of a block.
pub const BLOCK: i32 = 2;
/// Blocks along the side of the square that a pixel's medium is found from.
pub const STENCIL: usize = 4;

/// How far the cubic and the line may be apart, of what is interpolated: of the brightest of light's three components,
/// of the share that passes, of I_nu, and of the optical depth.
pub const TOLERANCE: f64 = 1.0 / 32.0;
/// Light this dark, of what the film shows as white, the share that passes, and the optical depth are never told more
/// exactly than values of this size.
pub const LEAST_LIGHT: f64 = 0.004;
pub const LEAST_SHARE: f64 = 0.05;
pub const LEAST_DEPTH: f64 = 1e-3;

/// The weights of four blocks in a row for a pixel a quarter of the way from the second to the third: the cubic's, and
/// the line's.
pub const CUBIC: [f64; STENCIL] = [-7.0 / 128.0, 105.0 / 128.0, 35.0 / 128.0, -5.0 / 128.0];
pub const LINE: [f64; STENCIL] = [0.0, 0.75, 0.25, 0.0];

/// The number of the first of the four blocks of a row that a pixel's medium is found from.
pub fn first_block(pixel: i32) -> i32 {
    (pixel - 1).div_euclid(BLOCK) - 1
}

/// The blocks of a row, the first and how many, that its pixels from `begin` on need.
pub fn blocks_of(begin: i32, pixels: u32) -> (i32, u32) {
    let first = first_block(begin);
    let last = first_block(begin + pixels.max(1) as i32 - 1) + STENCIL as i32 - 1;
    (first, (last - first + 1) as u32)
}

/// The place of a block's ray along a row, for samples that lie at `offset` in their pixels, 0 .. 1.
pub fn block_place(block: i32, offset: f64) -> f64 {
    f64::from(BLOCK * block) + 0.5 + offset
}

/// Weights of four blocks for a pixel: those for a pixel of an odd number, which is nearer to the second, or the same
/// the other way round.
pub fn weights(weights: [f64; STENCIL], pixel: i32) -> [f64; STENCIL] {
    let [a, b, c, d] = weights;
    if pixel & 1 == 1 { weights } else { [d, c, b, a] }
}

/// The mean of 4 x 4 values, row by row, by the weights of columns and rows.
fn mean<const N: usize>(values: &[[f64; N]; STENCIL * STENCIL], across: [f64; STENCIL], down: [f64; STENCIL]) -> [f64; N] {
    from_fn(|c| (0..STENCIL * STENCIL).map(|i| across[i % STENCIL] * down[i / STENCIL] * values[i][c]).sum())
}

fn tol() -> f64 { static T: std::sync::OnceLock<f64> = std::sync::OnceLock::new(); *T.get_or_init(|| std::env::var("BHR_TOL").ok().and_then(|v| v.parse().ok()).unwrap_or(TOLERANCE)) }
/// Whether what the cubic and the line say of light (linear Rec. 709, and the share that passes) is near enough.
/// `least`: light so dark need not be told exactly.
pub fn light_is_even(cubic: [f64; 4], line: [f64; 4], least: f64) -> bool {
    let brightest = line[0].max(line[1]).max(line[2]);
    let within = |c: usize, size: f64| (cubic[c] - line[c]).abs() <= tol() * size;
    (0..3).all(|c| within(c, brightest + least)) && within(3, line[3] + LEAST_SHARE)
}

/// The same for I_nu and optical depth.
pub fn depth_is_even(cubic: [f64; 2], line: [f64; 2]) -> bool {
    let within = |c: usize, size: f64| (cubic[c] - line[c]).abs() <= tol() * size;
    within(0, line[0]) && within(1, line[1] + LEAST_DEPTH)
}

/// The rule by which a frame's pixels are found from blocks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Evenness {
    /// Of light; darker light need not be told exactly.
    Light { least: f64 },
    /// Of I_nu and optical depth.
    Depth,
}

impl Evenness {
    /// The medium of `pixel` (column and row) from those of the 4 x 4 blocks about it, row by row. `None`: its own ray
    /// is to be summed.
    pub fn medium(self, blocks: &[&Medium; STENCIL * STENCIL], pixel: [i32; 2]) -> Option<Medium> {
        let values = blocks.map(|medium| {
            let [r, g, b] = medium.light;
            [r, g, b, medium.through, medium.intensity, medium.depth]
        });
        let [across, down] = pixel.map(|at| weights(CUBIC, at));
        let cubic = mean(&values, across, down);
        let [across, down] = pixel.map(|at| weights(LINE, at));
        let line = mean(&values, across, down);
        let [[r, g, b, through, intensity, depth], [lr, lg, lb, lt, li, ld]] = [cubic, line];
        let even = match self {
            Self::Light { least } => light_is_even([r, g, b, through], [lr, lg, lb, lt], least),
            Self::Depth => depth_is_even([intensity, depth], [li, ld]),
        };
        // Cubics overshoot.
        even.then(|| Medium {
            light: [r, g, b].map(|v| v.max(0.0)),
            through: through.clamp(0.0, 1.0),
            depth: depth.max(0.0),
            intensity: intensity.max(0.0),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The media of 4 x 4 blocks about a pixel, by the light at their places.
    fn about(pixel: [i32; 2], light: impl Fn(f64, f64) -> f64) -> [Medium; STENCIL * STENCIL] {
        from_fn(|i| {
            let at = |c: usize, k: usize| block_place(first_block(pixel[c]) + k as i32, 0.5);
            let light = light(at(0, i % STENCIL), at(1, i / STENCIL));
            Medium { light: [light; 3], through: (-light).exp(), depth: light, intensity: light }
        })
    }

    fn found(pixel: [i32; 2], light: impl Fn(f64, f64) -> f64) -> Option<Medium> {
        let media = about(pixel, light);
        let even = Evenness::Light { least: 0.0 };
        let depth = Evenness::Depth.medium(&media.each_ref(), pixel);
        let medium = even.medium(&media.each_ref(), pixel);
        assert!(medium.is_none() || depth == medium, "depth goes as light does: {medium:?} {depth:?}");
        medium
    }

    /// Each pixel lies between the second and the third of its blocks, and the nearest of them is its own.
    #[test]
    fn pixels_lie_amid_their_blocks() {
        for pixel in -9..=9 {
            let first = first_block(pixel);
            let [before, after] = [1, 2].map(|k| block_place(first + k, 0.5) - (f64::from(pixel) + 0.5));
            let own = pixel.div_euclid(BLOCK);
            assert!(before < 0.0 && after > 0.0 && after - before == 2.0, "{pixel}: {before} {after}");
            let near = if before.abs() < after.abs() { first + 1 } else { first + 2 };
            assert_eq!(near, own, "{pixel}");
            assert_eq!(weights(LINE, pixel)[(near - first) as usize], 0.75, "{pixel}");
            for pixels in 1..6 {
                let (begin, count) = blocks_of(pixel, pixels);
                let end = first_block(pixel + pixels as i32 - 1) + STENCIL as i32;
                assert_eq!((begin, begin + count as i32), (first, end), "{pixel} {pixels}");
            }
        }
    }

    /// Polynomials up to the third degree are met exactly, as far as they are even enough to be taken.
    #[test]
    fn cubics_are_exact() {
        let cubic = |x: f64, y: f64| 40.0 + 0.3 * x - 0.2 * y + 0.01 * x * y - 1e-3 * x * x * x + 2e-3 * y * y * y;
        for pixel in [[0, 0], [3, 2], [-4, 5], [7, -7], [-1, -2]] {
            let [x, y] = pixel.map(|at| f64::from(at) + 0.5);
            let medium = found(pixel, cubic).expect("even light");
            assert!((medium.light[1] - cubic(x, y)).abs() < 1e-12, "{pixel:?}: {medium:?}");
            assert!((medium.intensity - cubic(x, y)).abs() < 1e-12 && (medium.depth - cubic(x, y)).abs() < 1e-12);
        }
    }

    /// Bells of any width and anywhere: whatever is taken is within the tolerance, narrow bells are not taken, and wide
    /// ones are.
    #[test]
    fn what_is_taken_is_within_the_tolerance() {
        for width in [0.7, 1.5, 3.0, 6.0, 12.0_f64] {
            let (mut taken, mut worst) = (0, 0.0_f64);
            for i in 0..400 {
                let centre = [0.0, 1.0].map(|c| 6.0 * (f64::from(i) * (0.618_034 + 0.13 * c)).sin());
                let bell = |x: f64, y: f64| {
                    (-((x - centre[0]).powi(2) + (y - centre[1]).powi(2)) / (2.0 * width * width)).exp()
                };
                if let Some(medium) = found([i % 2, (i / 2) % 2], bell) {
                    let exact = bell(f64::from(i % 2) + 0.5, f64::from((i / 2) % 2) + 0.5);
                    worst = worst.max((medium.light[0] / exact - 1.0).abs());
                    taken += 1;
                }
            }
            println!("width {width}: {taken} of 400 taken, error {worst:.4}");
            assert!(worst <= TOLERANCE, "{width}: {worst}");
            assert!(if width < 1.0 { taken == 0 } else { width < 6.0 || taken == 400 }, "{width}: {taken}");
        }
    }

    /// An edge between the blocks, or no number at all, is for the pixel's own ray.
    #[test]
    fn edges_are_not_taken() {
        for edge in [-1.0, 0.0, 1.2] {
            assert_eq!(found([0, 1], |x, _| if x < edge { 1.0 } else { 1.2 }), None, "{edge}");
            assert_eq!(found([1, 0], |_, y| if y < edge { 1.0 } else { f64::NAN }), None, "{edge}");
        }
        // Where it is too dark to see, it does not matter.
        let media = about([0, 0], |x, _| if x < 0.0 { 1e-6 } else { 0.0 });
        assert!(Evenness::Light { least: 1e-3 }.medium(&media.each_ref(), [0, 0]).is_some());
    }
}
