// SPDX-License-Identifier: MIT OR Apache-2.0
//! The structure of a frame's volumes on grids: the factor on density at each texel, made once for a frame and read at
//! each place of a ray. `grid` has the sides and the rows, `filaments` the pattern. GPUs make the same by
//! shaders/emit/bake.wgsl. Knows no light and no ray.
//!
//! Texels hold the density itself, not its logarithm: values between texels then have the mean of those at the texels.

use super::baking::{BakeKey, BakeLevel, Baking, ROW_GENERATIONS, RowGeneration, RowMotion, row_generations};
use super::clouds::{Blur, Carried, CloudPlace, Clouds, Structure};
use super::filaments::{Filaments, filament_log_mean, filament_variance};
use super::grid::{GRID_LAST, Grid};
use super::matter::VolumeMatter;
use super::shape::Cloud;
use crate::allocate::{filled, with_room};
use crate::error::Result;
use crate::parallel::prelude::*;
use half::f16;
use std::sync::Arc;

/// The least and the largest factor: what f16 holds with all of its digits.
pub(crate) const LEAST_FACTOR: f32 = 6.103_515_6e-5;
pub(crate) const MOST_FACTOR: f32 = 65504.0;

const WHAT: &str = "the structure of matter with depth";

/// The factors of a volume.
pub struct Baked {
    grid: Grid,
    /// The finest level that is there.
    finest: usize,
    texels: Texels,
}

enum Texels {
    /// Level by level, layer by layer, row by row; values that f16 holds.
    Made(Vec<Vec<f32>>),
    /// Each is made when it is asked for: of few rays all of them are not worth it.
    Asked(Box<BakeKey>, &'static Filaments),
}

/// Without its millions of texels.
impl std::fmt::Debug for Baked {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Baked").field("grid", &self.grid).field("finest", &self.finest).finish_non_exhaustive()
    }
}

/// The structure of the last frame, kept from frame to frame.
#[derive(Default)]
pub struct BakedCache {
    /// The structure of each volume, and the key that it was made from.
    kept: Vec<Option<(BakeKey, Arc<Baked>)>>,
}

impl BakedCache {
    /// The structure of each of `volumes`, about a hole of spin `spin`, as it is seen from `r` by pixels of an angle of
    /// `pixel_angle`; 0: as fine as it is. `None` for even ones. Runs on the current pool. Errors: OUT_OF_MEMORY.
    pub fn prepare(
        &mut self,
        volumes: &[VolumeMatter],
        spin: f64,
        r: f64,
        pixel_angle: f64,
    ) -> Result<Vec<Option<Arc<Baked>>>> {
        let mut before = std::mem::take(&mut self.kept);
        before.resize_with(volumes.len(), Default::default);
        for (volume, before) in volumes.iter().zip(before) {
            let kept = match (volume.bake_key(spin, r, pixel_angle), before) {
                (None, _) => None,
                (Some(key), Some((of, baked))) if of == key => Some((key, baked)),
                (Some(key), before) => {
                    // The old one goes first: both together need not fit.
                    drop(before);
                    Some((key, Arc::new(Baked::new(&key)?)))
                }
            };
            self.kept.push(kept);
        }
        Ok(self.kept.iter().map(|kept| kept.as_ref().map(|(_, baked)| baked.clone())).collect())
    }
}

impl Baked {
    /// Errors: OUT_OF_MEMORY.
    pub fn new(key: &BakeKey) -> Result<Self> {
        let filaments = Filaments::shared()?;
        let baking = Baking::new(key)?;
        let mut levels = with_room(baking.levels.len(), WHAT)?;
        for level in &baking.levels {
            let [columns, rows, layers] = level.sides;
            let mut texels = filled(columns * rows * layers, 0.0_f32, WHAT)?;
            texels.par_chunks_mut(columns).enumerate().for_each(|(line, texels)| {
                let (row, layer) = (line % rows, line / rows);
                let (generations, motion) = (baking.generations(level, row), baking.motion(level, row, layer));
                bake_line(level, generations, motion, filaments, layer, texels);
            });
            levels.push(texels);
        }
        Ok(Self { grid: key.clouds.grid, finest: key.finest, texels: Texels::Made(levels) })
    }

    /// The structure for few rays: no texel is kept. Errors: OUT_OF_MEMORY.
    pub fn asked(key: BakeKey) -> Result<Self> {
        let (grid, finest) = (key.clouds.grid, key.finest);
        Ok(Self { grid, finest, texels: Texels::Asked(Box::new(key), Filaments::shared()?) })
    }

    /// The texels, level by level, layer by layer, row by row.
    #[cfg(test)]
    pub fn texels(&self) -> &[Vec<f32>] {
        let Texels::Made(levels) = &self.texels else { panic!("texels that were not made") };
        levels
    }

    /// The structure at a place of matter of the shape `cloud`, of which `clouds` says how it is carried.
    pub fn pattern(
        &self,
        (clouds, cloud): (&Clouds, &Cloud),
        at: &CloudPlace,
        carried: Carried,
        blur: Blur,
    ) -> Structure {
        let level = clouds.level(cloud, at.r, at.cos, blur);
        let density = self.factor(clouds.place(cloud, at, carried), level);
        Structure { density, heat: clouds.heat(density) }
    }

    /// The factor on density at a place, as [`Clouds::place`] gives it, of a level, which need not be a whole number.
    pub fn factor(&self, place: [f64; 3], level: f64) -> f64 {
        let left = (GRID_LAST as f64 + 1.0 - level).clamp(0.0, 1.0);
        let level = level.clamp(self.finest as f64, GRID_LAST as f64);
        let whole = level as usize;
        let share = (level - whole as f64) as f32;
        let fine = self.trilinear(whole, place);
        let coarse = |share| (self.trilinear((whole + 1).min(GRID_LAST), place) - fine) * share;
        let seen = if share > 0.0 { fine + coarse(share) } else { fine };
        1.0 + (f64::from(seen) - 1.0) * left
    }

    /// Between texels of a level, around two of the sides.
    fn trilinear(&self, level: usize, [turns, row, layer]: [f64; 3]) -> f32 {
        let sides = self.grid.sides(level);
        let between = |at: f64| {
            // Many a processor's `floor` is a call.
            let towards_zero = at as i64;
            let whole = if at < towards_zero as f64 { towards_zero.wrapping_sub(1) } else { towards_zero };
            (whole, (at - whole as f64) as f32)
        };
        let around = |share: f64, side: usize| {
            let (whole, part) = between(share * side as f64 - 0.5);
            // Sides are powers of two.
            ([whole, whole.wrapping_add(1)].map(|i| i as usize & (side - 1)), part)
        };
        let (xs, right) = around(turns, sides[0]);
        let (zs, up) = around(layer, sides[2]);
        let last = sides[1] - 1;
        let (row, down) = between((row * sides[1] as f64 - 0.5).clamp(0.0, last as f64));
        let ys = [row as usize, (row as usize + 1).min(last)];
        let between = |[[a, b], [c, d]]: [[f32; 2]; 2]| {
            let [a, c] = [a + (b - a) * right, c + (d - c) * right];
            a + (c - a) * down
        };
        let [near, far] = match &self.texels {
            Texels::Made(levels) => {
                let texels = &levels[level - self.finest];
                // Written out: nested maps over arrays are not inlined.
                let line = |y: usize, z: usize| {
                    let begin = (z * sides[1] + y) * sides[0];
                    [texels[begin + xs[0]], texels[begin + xs[1]]]
                };
                [between([line(ys[0], zs[0]), line(ys[1], zs[0])]), between([line(ys[0], zs[1]), line(ys[1], zs[1])])]
            }
            Texels::Asked(key, filaments) => {
                let texels = ys.map(|y| Asked::new(key, [level, y]));
                zs.map(|z| between([0, 1].map(|y| xs.map(|x| texels[y].texel(filaments, [x, z])))))
            }
        };
        near + (far - near) * up
    }
}

/// The texels of a row of a layer.
fn bake_line(
    level: &BakeLevel,
    generations: &[RowGeneration],
    motion: RowMotion,
    filaments: &Filaments,
    layer: usize,
    texels: &mut [f32],
) {
    let mut lost = 0.0;
    for generation in generations.iter().filter(|generation| generation.scale > 0.0) {
        let grain = level.grain(motion, generation.age);
        filaments.add_line(texels, generation.scale, level.place(generation, motion, layer), grain);
        lost += lost_by(generation.scale, grain);
    }
    texels.iter_mut().for_each(|texel| *texel = rounded(*texel - lost));
}

/// ln of the mean factor of a generation.
fn lost_by(scale: f32, grain: f32) -> f32 {
    filament_log_mean(f64::from(scale) * filament_variance(grain.into()).sqrt()) as f32
}

/// The factor of which `ln` is the logarithm, as f16 holds it.
fn rounded(ln: f32) -> f32 {
    f16::from_f32(ln.exp().clamp(LEAST_FACTOR, MOST_FACTOR)).to_f32()
}

/// A row of a level, of which single texels are asked for.
struct Asked<'a> {
    key: &'a BakeKey,
    ln_r: f64,
    level: BakeLevel,
    generations: [RowGeneration; ROW_GENERATIONS],
}

impl<'a> Asked<'a> {
    fn new(key: &'a BakeKey, [level, row]: [usize; 2]) -> Self {
        let clouds = &key.clouds;
        let ln_r = clouds.grid.row_ln_r(level, row);
        Self { key, ln_r, level: BakeLevel::new(key, level), generations: row_generations(clouds, ln_r) }
    }

    fn texel(&self, filaments: &Filaments, [column, layer]: [usize; 2]) -> f32 {
        let motion = self.level.motion(self.key, self.ln_r, layer);
        let turn = (column as f64 + 0.5) / self.level.sides[0] as f64;
        let mut sum = 0.0;
        for generation in self.generations.iter().filter(|generation| generation.scale > 0.0) {
            let grain = self.level.grain(motion, generation.age);
            let [begin, row, height] = self.level.place(generation, motion, layer).map(f64::from);
            let g = filaments.value([begin + turn, row, height], grain.into());
            sum += generation.scale * g as f32 - lost_by(generation.scale, grain);
        }
        rounded(sum)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emit::bands::When;
    use crate::emit::matter::Accuracy;
    use crate::emit::volume::{FlowLaw, Shape, Volume};
    use crate::random::runs_all;
    use std::f64::consts::{PI, TAU};

    const SPIN: f64 = 0.6;

    fn key(volume: &Volume, time: f64, finest: usize) -> BakeKey {
        let when = When { time, reference_delay: 0.0, delayed: true, shutter: 0.0 };
        let matter = VolumeMatter::new(volume, SPIN, &when, Accuracy::PICTURE).unwrap();
        BakeKey { finest, ..matter.bake_key(SPIN, 1.0, 0.0).unwrap() }
    }

    /// On every level, however strong the contrast is.
    #[test]
    fn mean_factors_are_one() {
        let finest = if runs_all() { 0 } else { 2 };
        for clumping in [0.5, 1.0, 1.8] {
            for level in finest..=GRID_LAST {
                let seeds = 8 << level;
                let (mut sum, mut count) = (0.0, 0.0);
                for seed in 0..seeds.min(200) {
                    let volume = Volume { clumping, seed, ..Volume::default() };
                    let baked = Baked::new(&key(&volume, 37.0, level)).unwrap();
                    sum += baked.texels()[0].iter().map(|texel| f64::from(*texel)).sum::<f64>();
                    count += baked.texels()[0].len() as f64;
                }
                let mean = sum / count;
                println!("{clumping}, level {level}: {mean}");
                assert!((mean - 1.0).abs() < 0.02 * (1.0 + clumping), "{clumping}, level {level}: {mean}");
            }
        }
    }

    /// Texels that are asked for are those that are made, and do not depend on the finest level that is.
    #[test]
    fn texels_are_those_that_are_asked_for() {
        let flow = FlowLaw::AngularMomentum;
        let torus = Volume { shape: Shape::Torus, flow, thickness: 0.3, outer_radius: 40.0, ..Volume::default() };
        for volume in [Volume::default(), torus] {
            let [fine, coarse] = [2, 3].map(|finest| key(&volume, 12.0, finest));
            let (made, coarser) = (Baked::new(&fine).unwrap(), Baked::new(&coarse).unwrap());
            let asked = Baked::asked(fine).unwrap();
            for i in 0..3000 {
                let place = [0.618, 0.755, 0.57].map(|step| (f64::from(i) * step).fract() * 1.2 - 0.1);
                for level in [2.0, 3.0, 3.4, 6.5] {
                    let [a, b] = [made.factor(place, level), asked.factor(place, level)];
                    assert!((a / b - 1.0).abs() < 2e-3, "{place:?}, level {level}: {a} {b}");
                    if level >= 3.0 {
                        assert_eq!(a, coarser.factor(place, level), "{place:?}, level {level}");
                    }
                }
            }
            assert_eq!(made.factor([0.1, 0.2, 0.3], 7.0), 1.0);
        }
    }

    /// Azimuths and heights go around without a seam, and beyond its ends the pattern goes on.
    #[test]
    fn sides_meet() {
        let baked = Baked::new(&key(&Volume::default(), 5.0, 3)).unwrap();
        for i in 0..200 {
            let [a, b] = [0.618, 0.57].map(|step| (f64::from(i) * step).fract());
            for (one, other) in [
                ([0.0, a, b], [1.0, a, b]),
                ([a, b, -1e-9], [a, b, 1.0 - 1e-9]),
                ([a, -0.2, b], [a, -9.0, b]),
                ([a, 1.1, b], [a, 5.0, b]),
            ] {
                assert!((baked.factor(one, 3.3) - baked.factor(other, 3.3)).abs() < 1e-5, "{one:?} {other:?}");
            }
        }
    }

    /// The less of it is seen, the less it varies; heat goes with the density.
    #[test]
    fn blurred_structure_varies_less() {
        let key = key(&Volume::default(), 1e9, 1);
        let baked = Baked::new(&key).unwrap();
        let seen = |i: u32, footprint: f64| {
            let [a, b, c] = [0.618, 0.755, 0.57].map(|step| (f64::from(i) * step).fract());
            let at = CloudPlace { r: 5.0 * 3.0_f64.powf(a), cos: 0.1 * (b - 0.5), azimuth: TAU * c, later: 3.0 };
            baked.pattern(
                (&key.clouds, &key.cloud),
                &at,
                Carried { omega: 0.03, drift: 0.0 },
                Blur { footprint, spacing: 0.0 },
            )
        };
        let mut last = f64::INFINITY;
        for footprint in [0.05, 0.2, 0.8, 3.0, 1e3] {
            let spread = (0..4000).map(|i| seen(i, footprint).density.ln().powi(2)).sum::<f64>();
            assert!(spread < last, "{footprint}: {spread} {last}");
            last = spread;
        }
        assert_eq!(last, 0.0);
        let ratio = |i: u32| {
            let [a, b] = [seen(i, 0.05), seen(i + 1, 0.05)];
            (b.heat / a.heat).ln() / (b.density / a.density).ln()
        };
        (0..50).for_each(|i| assert!((ratio(i) / (0.15 / 1.8) - 1.0).abs() < 1e-6, "{}", ratio(i)));
    }

    #[test]
    fn any_finite_time_and_place_will_do() {
        for time in [0.0, -1e-300, 1e12, 1e300, f64::MAX, f64::MIN] {
            for (shape, flow) in [
                (Shape::Disk, FlowLaw::Keplerian),
                (Shape::Torus, FlowLaw::AngularMomentum),
                (Shape::Halo, FlowLaw::AngularMomentum),
                (Shape::Jet, FlowLaw::Outflow),
            ] {
                let wide =
                    Volume { thickness: 1e6, outer_radius: 1e4, radius: 1e3, seed: u64::MAX, ..Volume::default() };
                let key = key(&Volume { shape, flow, ..wide }, time, 0);
                let baked = Baked::asked(key).unwrap();
                for (r, cos) in [(1.72, 0.0), (2.0, 1.0), (1e4, -1.0), (7.0, 1.0 - 1e-12), (300.0, 0.3)] {
                    for (footprint, spacing) in [(0.0, 0.0), (1e30, 1e30), (0.1, 3.0)] {
                        let at = CloudPlace { r, cos, azimuth: -PI, later: -1e4 };
                        let carried = Carried { omega: 0.4, drift: 0.9 };
                        let blur = Blur { footprint, spacing };
                        let seen = baked.pattern((&key.clouds, &key.cloud), &at, carried, blur);
                        assert!(seen.density > 0.0 && seen.density.is_finite() && seen.heat.is_finite(), "{seen:?}");
                    }
                }
            }
        }
    }
}
