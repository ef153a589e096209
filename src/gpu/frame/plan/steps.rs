// SPDX-License-Identifier: MIT OR Apache-2.0
//! In which steps a frame is made, each a submission: tiles and samples of them; and with bloom, what comes between
//! shading and development. Knows numbers only.

use super::tiles::TilePlan;
use crate::film::bloom::Bloom;
use crate::scene::Region;
use crate::tracer::{FrameRequest, Tile};
use std::ops::Range;

/// The work of one submission, in this order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Step {
    /// The tile that is shaded.
    pub shades: Tile,
    /// The samples of it that are shaded; none: nothing is.
    pub samples: Range<u32>,
    /// With bloom: the cells of the finest grid that then have all their light.
    pub gathers: Option<Tile>,
    /// With bloom: whether all have it, so that it spreads.
    pub spreads: bool,
    /// The part that becomes pixels.
    pub develops: Option<Tile>,
    /// Where the texture of light begins.
    pub light_origin: [u32; 2],
    /// Whether outputs beside the picture are made of the tile that is shaded.
    pub outputs: bool,
}

/// The steps of a frame.
#[derive(Debug)]
pub struct Steps {
    plan: TilePlan,
    samples: u32,
    strategy: BloomStrategy,
}

/// How the light of a frame is held until bloom has spread it.
#[derive(Debug)]
enum BloomStrategy {
    /// Without bloom: a tile's light is developed at once.
    Plain,
    /// A whole frame's light is kept until it has spread over a grid of so many cells.
    Kept([u32; 2]),
    /// The light is made twice: first for the cells of tiles of the grid, then for development.
    Twice { gather: TilePlan, frame: [u32; 2], factor: u32 },
}

impl Steps {
    pub fn plain(plan: TilePlan, samples: u32) -> Self {
        Self { plan, samples, strategy: BloomStrategy::Plain }
    }

    /// With bloom, for a device that holds a whole frame's light.
    pub fn kept(plan: TilePlan, samples: u32, bloom: &Bloom) -> Self {
        Self { plan, samples, strategy: BloomStrategy::Kept(base(bloom)) }
    }

    /// With bloom, for one that does not. `plan_of`: of a request, and how many pixels each of its own stands for.
    pub fn twice(
        request: &FrameRequest,
        samples: u32,
        bloom: &Bloom,
        plan_of: impl Fn(&FrameRequest, u64) -> TilePlan,
    ) -> Self {
        let [width, height] = base(bloom);
        let region = Region { full_width: width, full_height: height, x: 0, y: 0 };
        let gather = plan_of(&FrameRequest { width, height, region, ..*request }, u64::from(bloom.factor).pow(2));
        let strategy = BloomStrategy::Twice { gather, frame: bloom.frame, factor: bloom.factor };
        Self { plan: plan_of(request, 1), samples, strategy }
    }

    fn batches(&self, plan: &TilePlan) -> u64 {
        u64::from(self.samples.div_ceil(plan.batch))
    }

    /// Steps in which the light that spreads is made.
    fn gathering(&self) -> u64 {
        match &self.strategy {
            BloomStrategy::Plain => 0,
            BloomStrategy::Kept(_) => self.plan.count() * self.batches(&self.plan),
            BloomStrategy::Twice { gather, .. } => gather.count() * self.batches(gather),
        }
    }

    pub fn count(&self) -> u64 {
        match &self.strategy {
            // The step in which the last light is made develops the first tile.
            BloomStrategy::Kept(_) => self.gathering() + self.plan.count() - 1,
            BloomStrategy::Plain | BloomStrategy::Twice { .. } => {
                self.gathering() + self.plan.count() * self.batches(&self.plan)
            }
        }
    }

    /// Width and height of the largest tile that is shaded.
    pub fn largest(&self) -> [u32; 2] {
        let tile = self.plan.largest();
        match &self.strategy {
            BloomStrategy::Plain | BloomStrategy::Kept(_) => tile,
            BloomStrategy::Twice { gather, frame, factor } => {
                let cells = gather.largest();
                [0, 1].map(|i| tile[i].max((cells[i] * factor + factor).min(frame[i])))
            }
        }
    }

    /// How much of the light is held at once; `None`: no light is kept.
    pub fn light(&self) -> Option<[u32; 2]> {
        match &self.strategy {
            BloomStrategy::Plain => None,
            BloomStrategy::Kept(_) => Some(self.plan.frame()),
            BloomStrategy::Twice { .. } => Some(self.largest()),
        }
    }

    /// The `index`th of all.
    pub fn step(&self, index: u64) -> Step {
        let gathering = self.gathering();
        let ends = index + 1 == gathering;
        match &self.strategy {
            BloomStrategy::Kept(base) if index < gathering => {
                let (shades, samples) = self.shading(&self.plan, index);
                let whole = Tile { x: 0, y: 0, width: base[0], height: base[1] };
                let (gathers, develops) = (ends.then_some(whole), ends.then(|| self.plan.tile(0)));
                let outputs = samples.start == 0;
                Step { shades, samples, gathers, spreads: ends, develops, light_origin: [0, 0], outputs }
            }
            BloomStrategy::Kept(_) => {
                let tile = self.plan.tile(index + 1 - gathering);
                let (shades, develops, light_origin) = (tile, Some(tile), [0, 0]);
                Step { shades, samples: 0..0, gathers: None, spreads: false, develops, light_origin, outputs: false }
            }
            BloomStrategy::Twice { gather, frame, factor } if index < gathering => {
                let (cells, samples) = self.shading(gather, index);
                let shades = under(cells, *factor, *frame);
                let gathers = (samples.end == self.samples).then_some(cells);
                let light_origin = [shades.x, shades.y];
                Step { shades, samples, gathers, spreads: ends, develops: None, light_origin, outputs: false }
            }
            BloomStrategy::Plain | BloomStrategy::Twice { .. } => {
                let (shades, samples) = self.shading(&self.plan, index - gathering);
                let develops = (samples.end == self.samples).then_some(shades);
                let light_origin = [shades.x, shades.y];
                let outputs = samples.start == 0;
                Step { shades, samples, gathers: None, spreads: false, develops, light_origin, outputs }
            }
        }
    }

    /// The `index`th tile and samples of a plan.
    fn shading(&self, plan: &TilePlan, index: u64) -> (Tile, Range<u32>) {
        let batches = self.batches(plan);
        let begin = (index % batches) as u32 * plan.batch;
        (plan.tile(index / batches), begin..(begin + plan.batch).min(self.samples))
    }
}

/// The size of the finest grid, in cells.
fn base(bloom: &Bloom) -> [u32; 2] {
    bloom.levels.first().map_or([1, 1], |level| level.size)
}

/// The pixels that share their light with `cells`: half a cell beyond them on each side.
fn under(cells: Tile, factor: u32, frame: [u32; 2]) -> Tile {
    let begin = |cell: u32| (cell * factor).saturating_sub(factor / 2);
    let end = |cell: u32, cells: u32, side: u32| ((cell + cells) * factor + factor / 2).min(side);
    let [x, y] = [begin(cells.x), begin(cells.y)];
    let [right, bottom] = [end(cells.x, cells.width, frame[0]), end(cells.y, cells.height, frame[1])];
    Tile { x, y, width: right - x, height: bottom - y }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::frame::plan::tiles::Budget;
    use crate::image::PixelFormat;
    use crate::scene::Film;

    fn request([width, height]: [u32; 2]) -> FrameRequest {
        let region = Region { full_width: width, full_height: height, x: 0, y: 0 };
        FrameRequest { width, height, region, format: PixelFormat::Rgba8Srgb, transparent: false }
    }

    fn all(steps: &Steps) -> Vec<Step> {
        (0..steps.count()).map(|i| steps.step(i)).collect()
    }

    /// Every way shades what it gathers or develops before it does, and develops every pixel once.
    #[test]
    fn everything_is_done_once_and_in_order() {
        for frame in [[64, 48], [1000, 700], [5001, 333], [16384, 2000]] {
            let bloom = Bloom::of(&Film { bloom: 1.0, ..Film::plain() }, frame).expect("grids");
            let plan_of = |request: &FrameRequest, each: u64| {
                TilePlan::new(Budget::SMALL, request, 400 * each, 2048, 300 * each, 20)
            };
            let plan = || plan_of(&request(frame), 1);
            let strategies = [
                Steps::plain(plan(), 20),
                Steps::kept(plan(), 20, &bloom),
                Steps::twice(&request(frame), 20, &bloom, plan_of),
            ];
            for (strategy, steps) in strategies.iter().enumerate() {
                let list = all(steps);
                let area = |tile: Tile| u64::from(tile.width) * u64::from(tile.height);
                let developed = list.iter().filter_map(|step| step.develops).map(area).sum::<u64>();
                assert_eq!(developed, u64::from(frame[0]) * u64::from(frame[1]), "{frame:?} {strategy}");
                let with_outputs = list.iter().filter(|step| step.outputs).map(|step| area(step.shades)).sum::<u64>();
                assert_eq!(with_outputs, developed, "{frame:?} {strategy}");
                let gathered = list.iter().filter_map(|step| step.gathers).map(area).sum::<u64>();
                let cells = bloom.levels[0].size.map(u64::from);
                assert_eq!(gathered, if strategy == 0 { 0 } else { cells[0] * cells[1] });
                let spreads = list.iter().position(|step| step.spreads);
                assert_eq!(spreads.is_some(), strategy > 0);
                assert!(list.iter().filter(|step| step.spreads).count() <= 1);
                assert!(list.iter().take(spreads.unwrap_or(0)).all(|step| step.develops.is_none()));
                let [width, height] = steps.largest();
                for step in &list {
                    assert!(
                        step.shades.width <= width && step.shades.height <= height,
                        "{step:?} in {width} x {height}"
                    );
                    assert!(
                        step.shades.x + step.shades.width <= frame[0] && step.shades.y + step.shades.height <= frame[1]
                    );
                }
            }
        }
    }

    /// The pixels shaded for a tile of cells are all those that the cells take from.
    #[test]
    fn cells_get_all_their_light() {
        let cells = Tile { x: 10, y: 0, width: 5, height: 7 };
        assert_eq!(under(cells, 4, [58, 30]), Tile { x: 38, y: 0, width: 20, height: 30 });
        assert_eq!(under(cells, 2, [400, 400]), Tile { x: 19, y: 0, width: 12, height: 15 });
    }
}
