// SPDX-License-Identifier: MIT OR Apache-2.0
//! Matter with depth at half resolution: where the sum along one ray of each block of 2 x 2 pixels stands for those of
//! its pixels, and where a pixel's own ray has to be summed. Mirrored by `shaders/emit/half.wgsl`. Knows media and
//! whole numbers; no ray, no tracer and no picture.
//!
//! Blocks are counted from the corner of the full frame, so that a part of a frame has the blocks of the whole. The ray
//! of block b of a row goes through pixel coordinate 2 b + 1, the middle of its two pixels, plus what the sample lies
//! off the middle of a pixel. A pixel's centre is then a quarter of the way from the block nearest to it to the next,
//! and its medium is found from 4 x 4 blocks without the corners, which all must have met the same crossings and the
//! same fate as the pixel. (GPUs that look up what is behind matter compare the blocks alone: nothing shines in the
//! plane then, and a shadow that is narrower than a block is all that they may miss.) What the cubics through four
//! blocks (Lagrange) of the middle rows add to the plane between the nearest four, and what those of the middle columns
//! add, is added to that plane (Gordon's sum of interpolations, Gordon 1971, SIAM J. Numer. Anal. 8, 158): as exact as
//! the product of both cubics but for a term of the fourth order, and no block counts that the test below does not look
//! at.
//!
//! Second differences of the blocks say how far a straight line between two of them may be off, which is 3/32 of them a
//! quarter of the way. Where that is more than `TOLERANCE` of what is interpolated, the pixel's own ray is summed. It
//! is the error of a rule of lower order than the one that is used, as in embedded Runge-Kutta methods: the smoother
//! matter is, the smaller is the cubic's. Their sizes are added, so that none hides where one of them passes through 0.

use super::medium::Medium;
use std::array::from_fn;

/// Pixels along the side of a block.
pub const BLOCK: i32 = 2;
/// Blocks along the side of the square that a pixel's medium is found from.
pub const STENCIL: usize = 4;

/// How far a line between blocks may be off, of what is interpolated: of the brightest of light's three components, of
/// the share that passes, of I_nu, and of the optical depth.
pub const TOLERANCE: f64 = 1.0 / 64.0;
/// The tolerance for matter that has structure. With 1/64 seven times as many pixels of a soft disk sum their own rays,
/// for three quarters of the error; pictures at the scale of 3840 x 2160 differ from those at full resolution by .2 to
/// .5 of 255 (root mean square).
pub const STRUCTURE_TOLERANCE: f64 = 1.0 / 16.0;
/// Light this dark, of what the film shows as white, the share that passes, and the optical depth are never told more
/// exactly than values of this size.
pub const LEAST_LIGHT: f64 = 0.004;
pub const LEAST_SHARE: f64 = 0.05;
pub const LEAST_DEPTH: f64 = 1e-3;

/// The cubic's weights of four blocks in a row for a pixel a quarter of the way from the second to the third.
pub const CUBIC: [f64; STENCIL] = [-7.0 / 128.0, 105.0 / 128.0, 35.0 / 128.0, -5.0 / 128.0];
/// A line's weights of four blocks in a row, for a pixel a quarter of the way from the second to the third.
pub const LINE: [f64; STENCIL] = [0.0, 0.75, 0.25, 0.0];
/// The share of a second difference by which a line is off a quarter of the way.
pub const OFF_LINE: f64 = 3.0 / 32.0;

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

/// The weight of the block in `row` and `column` of 4 x 4 for a pixel: one of an odd number is nearer to the second.
pub fn weight(pixel: [i32; 2], column: usize, row: usize) -> f64 {
    let [x, y] = [(pixel[0], column), (pixel[1], row)].map(|(p, i)| if p & 1 == 1 { i } else { STENCIL - 1 - i });
    CUBIC[x] * LINE[y] + LINE[x] * CUBIC[y] - LINE[x] * LINE[y]
}

/// Whether a block of 4 x 4, counted row by row, has a weight: all but the corners.
pub fn counts(i: usize) -> bool {
    ![0, STENCIL - 1, STENCIL * (STENCIL - 1), STENCIL * STENCIL - 1].contains(&i)
}

/// How far the line between the middle two of four values may be off.
pub fn bend([a, b, c, d]: [f64; STENCIL]) -> f64 {
    0.5 * OFF_LINE * ((a - 2.0 * b + c).abs() + (b - 2.0 * c + d).abs())
}

/// How far lines amid 4 x 4 values, row by row, may be off: along the rows and along the columns.
fn bends(value: impl Fn(usize) -> f64) -> f64 {
    let across = |row: usize| bend(from_fn(|i| value(STENCIL * row + i)));
    let down = |column: usize| bend(from_fn(|i| value(STENCIL * i + column)));
    across(1).max(across(2)) + down(1).max(down(2))
}

/// Whether light is even enough that bends so: linear Rec. 709 and the share that passes. `darkest`: the least of what
/// it is at the four blocks nearest, of light the brightest component; light as dark as `least` need not be told
/// exactly. `tolerance`: of how far the line between blocks may be off.
pub fn light_is_even(bends: [f64; 4], darkest: [f64; 2], least: f64, tolerance: f64) -> bool {
    (0..3).all(|c| bends[c] <= tolerance * (darkest[0] + least)) && bends[3] <= tolerance * (darkest[1] + LEAST_SHARE)
}

/// Whether I_nu and optical depth are even enough that bend so. `least`: of either at the four blocks nearest.
pub fn depth_is_even(bends: [f64; 2], least: [f64; 2], tolerance: f64) -> bool {
    bends[0] <= tolerance * least[0] && bends[1] <= tolerance * (least[1] + LEAST_DEPTH)
}

/// The numbers of the four blocks nearest among 4 x 4.
const MIDDLE: [usize; 4] = [5, 6, 9, 10];

/// The rule by which a frame's pixels are found from blocks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Evenness {
    /// For light; darker light need not be told exactly.
    Light { least: f64, tolerance: f64 },
    /// For I_nu and optical depth.
    Depth { tolerance: f64 },
}

impl Evenness {
    /// The medium of `pixel` (column and row) from those of the 4 x 4 blocks about it, row by row. `None`: its own ray
    /// is to be summed.
    pub fn medium(self, blocks: &[&Medium; STENCIL * STENCIL], pixel: [i32; 2]) -> Option<Medium> {
        let bends = |value: &dyn Fn(&Medium) -> f64| bends(|i| value(blocks[i]));
        let least = |value: &dyn Fn(&Medium) -> f64| MIDDLE.map(|i| value(blocks[i])).into_iter().reduce(f64::min);
        let least = |value: &dyn Fn(&Medium) -> f64| least(value).unwrap_or(0.0);
        let even = match self {
            Self::Light { least: dark, tolerance } => {
                let light = [0, 1, 2].map(|c| bends(&|medium| medium.light[c]));
                let darkest = least(&|medium| medium.light.into_iter().fold(0.0, f64::max));
                let bends = [light[0], light[1], light[2], bends(&|medium| medium.through)];
                light_is_even(bends, [darkest, least(&|medium| medium.through)], dark, tolerance)
            }
            Self::Depth { tolerance } => depth_is_even(
                [bends(&|medium| medium.intensity), bends(&|medium| medium.depth)],
                [least(&|medium| medium.intensity), least(&|medium| medium.depth)],
                tolerance,
            ),
        };
        let weights: [f64; STENCIL * STENCIL] = from_fn(|i| weight(pixel, i % STENCIL, i / STENCIL));
        let mean = |value: &dyn Fn(&Medium) -> f64| {
            // Cubics overshoot.
            blocks.iter().zip(weights).map(|(medium, weight)| weight * value(medium)).sum::<f64>().max(0.0)
        };
        even.then(|| Medium {
            light: [0, 1, 2].map(|c| mean(&|medium| medium.light[c])),
            through: mean(&|medium| medium.through).min(1.0),
            depth: mean(&|medium| medium.depth),
            intensity: mean(&|medium| medium.intensity),
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
        let even = Evenness::Light { least: 0.0, tolerance: TOLERANCE };
        let depth = Evenness::Depth { tolerance: TOLERANCE }.medium(&media.each_ref(), pixel);
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
            let share = |block: i32| {
                let place = (block - first) as usize;
                (0..STENCIL).map(|row| weight([pixel, 1], place, row)).sum::<f64>()
            };
            assert!((share(near) - CUBIC[1]).abs() < 1e-15, "{pixel}");
            for i in 0..STENCIL * STENCIL {
                assert_eq!(weight([pixel, pixel / 3], i % STENCIL, i / STENCIL) != 0.0, counts(i), "{pixel} {i}");
            }
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

    /// Bells of any width and anywhere: whatever is taken is within the tolerance, the middle of narrow bells is not
    /// taken, and all of wide ones is.
    #[test]
    fn what_is_taken_is_within_the_tolerance() {
        let least = 0.01;
        for width in [1.0, 1.5, 3.0, 6.0, 12.0_f64] {
            let (mut taken, mut worst) = (0, 0.0_f64);
            for i in 0..400 {
                let centre = [0.0, 1.0].map(|c| 6.0 * (f64::from(i) * (0.618_034 + 0.13 * c)).sin());
                let bell = |x: f64, y: f64| {
                    (-((x - centre[0]).powi(2) + (y - centre[1]).powi(2)) / (2.0 * width * width)).exp()
                };
                let pixel = [i % 2, (i / 2) % 2];
                let exact = bell(f64::from(pixel[0]) + 0.5, f64::from(pixel[1]) + 0.5);
                let medium =
                    Evenness::Light { least, tolerance: TOLERANCE }.medium(&about(pixel, bell).each_ref(), pixel);
                if let Some(medium) = medium {
                    worst = worst.max((medium.light[0] - exact).abs() / (exact + least));
                    taken += 1;
                }
                assert!(medium.is_none() || width > 1.5 || exact < 0.1, "{width}: {exact}");
            }
            println!("width {width}: {taken} of 400 taken, error {worst:.4}");
            assert!(worst <= TOLERANCE, "{width}: {worst}");
            assert!(width < 12.0 || taken == 400, "{width}: {taken}");
        }
    }

    /// An edge between the blocks, or no number at all, is for the pixel's own ray.
    #[test]
    fn edges_are_not_taken() {
        for edge in [-1.0, 0.0, 1.2] {
            assert_eq!(found([0, 1], |x, _| if x < edge { 1.0 } else { 1.4 }), None, "{edge}");
            assert_eq!(found([1, 0], |_, y| if y < edge { 1.0 } else { f64::NAN }), None, "{edge}");
        }
        // Where it is too dark to see, it does not matter.
        let media = about([0, 0], |x, _| if x < 0.0 { 1e-6 } else { 0.0 });
        assert!(Evenness::Light { least: 1e-3, tolerance: TOLERANCE }.medium(&media.each_ref(), [0, 0]).is_some());
    }
}
