// SPDX-License-Identifier: MIT OR Apache-2.0
//! What a grid is baked from: for each of its rows the generations of the pattern that show there at the frame's time,
//! and how matter turns there. `baked` makes texels of it on the CPU, shaders/emit/bake.wgsl on GPUs. Knows no light
//! and no ray.
//!
//! Every level is made from the filaments themselves, from a level of theirs that is no finer than its texels, so that
//! none depends on which finer ones were made.

use super::clouds::{Clouds, SHEAR};
use super::filaments::FILAMENT_HEIGHT;
use super::grid::{GRID_LAST, GRID_LEVELS};
use super::shape::{Cloud, WIDEST};
use crate::allocate::with_room;
use crate::error::Result;
use crate::physics::flow::{Flow, Place};
use crate::physics::orbit::horizon_outer;
use crate::random::mix;
use bytemuck::{Pod, Zeroable};
use std::f64::consts::TAU;

/// All that the structure of a volume depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BakeKey {
    pub clouds: Clouds,
    pub cloud: Cloud,
    pub flow: Flow,
    pub spin: f64,
    /// The finest level that is made.
    pub finest: usize,
}

/// Generations of a row at most: two of two bands.
pub(crate) const ROW_GENERATIONS: usize = 4;

/// A generation as it shows in a row, in numbers that f32 holds.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct RowGeneration {
    /// ln of the density's factor where g of the filaments is 1. 0: none shows.
    pub scale: f32,
    /// M.
    pub age: f32,
    /// Its place in the filaments, in periods: in azimuth where it has no age, in ln r, and in height on the plane.
    pub turn: f32,
    pub row: f32,
    pub layer: f32,
}

/// How matter turns in a row and at a height.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct RowMotion {
    /// rad/M.
    pub omega: f32,
    /// The change of ln omega with theta over that with -ln r, as far as it is known; 0 where omega is that of the
    /// plane at all heights.
    pub lean: f32,
}

/// A level of a grid as it is baked.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BakeLevel {
    pub sides: [usize; 3],
    /// Where its first row and its first motion are among those of all levels.
    pub first_row: usize,
    pub first_motion: usize,
    /// Motions of a row: one, or one for each height.
    pub heights: usize,
    /// Filaments are no finer than the texels of this level of theirs.
    pub level: usize,
    /// Texels of the filaments' finest level over a row, and over as many rad of azimuth as a row has e-folds; and over
    /// as many as a layer has rad of theta.
    pub row_texels: f32,
    pub row_size: f32,
    pub layer_size: f32,
}

/// All that a grid is baked from, beside the filaments.
#[derive(Clone, Debug, Default)]
pub struct Baking {
    /// From the finest level that is baked to the last.
    pub levels: Vec<BakeLevel>,
    /// Four for each row of each level.
    pub generations: Vec<RowGeneration>,
    /// [`BakeLevel::heights`] for each row of each level.
    pub motions: Vec<RowMotion>,
}

/// The heights of two layers are the same, of which one is above the plane.
fn height_class(layer: usize, layers: usize) -> usize {
    layer.min(layers - 1 - layer)
}

impl Baking {
    /// Errors: OUT_OF_MEMORY.
    pub fn new(key: &BakeKey) -> Result<Self> {
        const WHAT: &str = "the rows of structure of matter with depth";
        let clouds = &key.clouds;
        let all = || (key.finest.min(GRID_LAST)..GRID_LEVELS).map(|level| BakeLevel::new(key, level));
        let [rows, motions] = all().fold([0; 2], |[r, m], level| [r + level.sides[1], m + level.motions()]);
        let mut made = Self {
            levels: with_room(GRID_LEVELS, WHAT)?,
            generations: with_room(rows * ROW_GENERATIONS, WHAT)?,
            motions: with_room(motions, WHAT)?,
        };
        for level in all() {
            let (first_row, first_motion) = (made.generations.len() / ROW_GENERATIONS, made.motions.len());
            made.levels.push(BakeLevel { first_row, first_motion, ..level });
            for row in 0..level.sides[1] {
                let ln_r = clouds.grid.row_ln_r(level.level, row);
                made.generations.extend(row_generations(clouds, ln_r));
                made.motions.extend((0..level.heights).map(|layer| level.motion(key, ln_r, layer)));
            }
        }
        Ok(made)
    }

    pub fn generations(&self, level: &BakeLevel, row: usize) -> &[RowGeneration] {
        let begin = ROW_GENERATIONS * (level.first_row + row);
        self.generations.get(begin..begin + ROW_GENERATIONS).unwrap_or(&[])
    }

    pub fn motion(&self, level: &BakeLevel, row: usize, layer: usize) -> RowMotion {
        let class = if level.heights > 1 { height_class(layer, level.sides[2]) } else { 0 };
        self.motions.get(level.first_motion + row * level.heights + class).copied().unwrap_or_default()
    }
}

/// The generations that show at ln r.
pub fn row_generations(clouds: &Clouds, ln_r: f64) -> [RowGeneration; ROW_GENERATIONS] {
    let mut all = [RowGeneration::default(); ROW_GENERATIONS];
    for (made, shown) in all.iter_mut().zip(clouds.bands.shown([ln_r], 0.0)) {
        let key = shown.key;
        let share = |bits: u32| f64::from(bits & 0xffff) / 65536.0;
        *made = RowGeneration {
            scale: (clouds.clumping * clouds.strength * shown.weights[0]) as f32,
            age: shown.age as f32,
            turn: share(key) as f32,
            row: ((ln_r - shown.drift * shown.age) / clouds.period + share(key >> 16)).rem_euclid(1.0) as f32,
            layer: share(mix(key)) as f32,
        };
    }
    all
}

impl BakeLevel {
    pub fn new(key: &BakeKey, level: usize) -> Self {
        let BakeKey { clouds, cloud, .. } = key;
        let grid = &clouds.grid;
        let sides @ [_, rows, layers] = grid.sides(level);
        let ([around, texels, _], row) = (clouds.texels(), (grid.ln_r[1] - grid.ln_r[0]) / rows as f64);
        Self {
            sides,
            first_row: 0,
            first_motion: 0,
            heights: if clouds.leans { (layers / 2).max(1) } else { 1 },
            level,
            row_texels: (texels * row) as f32,
            row_size: (around * row) as f32,
            layer_size: (around * cloud.thickness.min(WIDEST) * FILAMENT_HEIGHT / layers as f64) as f32,
        }
    }

    /// The number of its motions.
    fn motions(&self) -> usize {
        self.sides[1] * self.heights
    }

    /// How matter turns at ln r in a layer.
    pub fn motion(&self, key: &BakeKey, ln_r: f64, layer: usize) -> RowMotion {
        let BakeKey { cloud, flow, spin, .. } = *key;
        let (r, layers) = (ln_r.exp().max(1.0001 * horizon_outer(spin)), self.sides[2]);
        let cos = match self.heights {
            1 => cloud.middle_cos(r),
            _ => {
                let height = FILAMENT_HEIGHT * (height_class(layer, layers) as f64 + 0.5) / layers as f64;
                (cloud.thickness.min(WIDEST) * height).min(0.995)
            }
        };
        let at = Place::new(spin, 1.0 / r, cos);
        let omega = flow.velocity(spin, &at).angular_velocity(spin, &at);
        let lean = if self.heights > 1 { cos / at.sin2.sqrt() } else { 0.0 };
        RowMotion { omega: omega as f32, lean: lean as f32 }
    }

    /// The level of the filaments that a generation of an age is made from: there no texel of theirs is finer than one
    /// of the grid's, however far the shear of orbits has wound it up.
    pub fn grain(&self, motion: RowMotion, age: f32) -> f32 {
        let wound = SHEAR as f32 * motion.omega.abs() * age;
        let along = (wound * self.row_size).hypot(self.row_texels);
        let across = wound * motion.lean * self.layer_size;
        along.max(across).log2().max(self.level as f32)
    }

    /// The place in the filaments, in periods, of a generation where the azimuth of the grid begins, in a layer.
    pub fn place(&self, generation: &RowGeneration, motion: RowMotion, layer: usize) -> [f32; 3] {
        let turns = generation.turn - motion.omega * generation.age * (1.0 / TAU) as f32;
        let height = (layer as f32 + 0.5) / self.sides[2] as f32;
        [turns - turns.floor(), generation.row, height + generation.layer]
    }
}
