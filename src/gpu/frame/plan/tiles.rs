// SPDX-License-Identifier: MIT OR Apache-2.0
//! How a frame is cut into tiles, so that memory stays bounded and no submission runs for long. Knows numbers only.

use crate::tracer::{FrameRequest, Tile};

/// The bounds of a tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// Ray-steps of one submission, far below the seconds after which a driver's watchdog fires.
    steps: u64,
    /// Bytes that the records and the radiance of a tile may take; and, in frames with bloom, the light that is kept.
    pub memory: u64,
}

impl Budget {
    /// For a GPU that shares its memory with the host, or a software driver: 40 ms at 0.4 TFLOPS.
    pub const SMALL: Self = Self { steps: 96 << 20, memory: 192 << 20 };
    /// For a GPU with memory of its own, of 2 TFLOPS or more: 64 ms at most.
    pub const LARGE: Self = Self { steps: 768 << 20, memory: 576 << 20 };
    /// The steps for such a GPU that sums matter with depth, 175 ms at most. Some rays, along the edge of the shadow,
    /// take many times as long as others, and each kernel of a tile ends with its last one: a frame of turbulent matter
    /// at 3840 x 2160 takes 1.07 times as long in four tiles as in the one of this budget, at half resolution 1.16
    /// times (H100). Most are what matter counts as: 32 bits hold the sum of the others.
    pub const STEPS_OF_MATTER: u64 = 2048 << 20;

    /// `discrete`: whether the GPU has memory of its own; `binding`: the most bytes of a buffer that its kernels reach,
    /// of which plans count packed pixels three times; `matter`: whether it sums matter with depth.
    pub fn of(discrete: bool, binding: u64, matter: bool) -> Self {
        let budget = if discrete { Self::LARGE } else { Self::SMALL };
        let steps = if discrete && matter { Self::STEPS_OF_MATTER } else { budget.steps };
        Self { memory: budget.memory.min(3 * binding), steps }
    }
}

/// Samples of one submission at most.
pub const MAX_BATCH: u32 = 16;

/// Tiles of one frame, and how many samples of a tile go into one submission.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TilePlan {
    frame: [u32; 2],
    tile: [u32; 2],
    pub batch: u32,
}

impl TilePlan {
    /// `bytes_per_pixel` that a tile takes on the device, `max_side` of a texture there; `steps` a ray is expected to
    /// take; `batch` is the most samples that one submission may have.
    pub fn new(
        budget: Budget,
        request: &FrameRequest,
        bytes_per_pixel: u64,
        max_side: u32,
        steps: u64,
        batch: u32,
    ) -> Self {
        let steps = steps.max(1);
        let max_side = max_side.saturating_sub(2).max(1);
        let by_memory = budget.memory / bytes_per_pixel.max(1);
        let by_time = budget.steps / steps;
        let pixels = by_memory.min(by_time).max(1024);
        // The traced rectangle is one pixel wider on each side; wide tiles waste least on short frames, squarer ones
        // on small tiles.
        let wide = (8.0 * (pixels as f64).sqrt()) as u32;
        let width = request.width.min(max_side).min(wide.max(128)).max(1);
        let height = (pixels / u64::from(width + 2)).saturating_sub(2).clamp(1, u64::from(max_side)) as u32;
        let height = height.min(request.height.max(1));
        // Even shares: no sliver at the end.
        let share = |full: u32, part: u32| full.div_ceil(full.div_ceil(part).max(1)).max(1);
        let tile = [share(request.width, width), share(request.height, height)];
        let traced = u64::from(tile[0] + 2) * u64::from(tile[1] + 2);
        let batch = (budget.steps / (traced * steps)).clamp(1, u64::from(MAX_BATCH.min(batch.max(1)))) as u32;
        Self { frame: [request.width, request.height], tile, batch }
    }

    /// Width and height of all tiles together.
    pub fn frame(&self) -> [u32; 2] {
        self.frame
    }

    /// Width and height of the largest tile.
    pub fn largest(&self) -> [u32; 2] {
        self.tile
    }

    /// The `index`th, row by row from the top left.
    pub fn tile(&self, index: u64) -> Tile {
        let [width, height] = self.frame;
        let [w, h] = self.tile;
        let across = u64::from(width.div_ceil(w));
        let [x, y] = [(index % across) as u32 * w, (index / across) as u32 * h];
        Tile { x, y, width: w.min(width - x), height: h.min(height - y) }
    }

    pub fn count(&self) -> u64 {
        let [nx, ny] = [0, 1].map(|i| u64::from(self.frame[i].div_ceil(self.tile[i])));
        nx * ny
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::PixelFormat;
    use crate::scene::Region;

    fn request(width: u32, height: u32) -> FrameRequest {
        let region = Region { full_width: width, full_height: height, x: 0, y: 0 };
        FrameRequest { width, height, region, format: PixelFormat::Rgba8Srgb, transparent: false }
    }

    #[test]
    fn tiles_cover_every_pixel_once_within_the_limits() {
        for (width, height, steps) in [(1, 1, 30), (1280, 720, 30), (16384, 16384, 30), (5000, 3, 30), (300, 70, 6000)]
        {
            for budget in [Budget::SMALL, Budget::LARGE] {
                let plan = TilePlan::new(budget, &request(width, height), 100, 2048, steps, 1);
                let [w, h] = plan.largest().map(u64::from);
                assert!((w + 2) * (h + 2) * 100 <= budget.memory, "{width} x {height}: {plan:?}");
                assert!(w * h * steps <= budget.steps && w.max(h) + 2 <= 2048, "{plan:?}");
            }
            let plan = TilePlan::new(Budget::SMALL, &request(width, height), 100, 2048, steps, 1);
            let tiles = (0..plan.count()).map(|i| plan.tile(i)).collect::<Vec<_>>();
            let pixels = tiles.iter().map(|t| u64::from(t.width) * u64::from(t.height)).sum::<u64>();
            assert_eq!(pixels, u64::from(width) * u64::from(height));
            let corners = tiles.iter().map(|t| (t.y, t.x)).collect::<Vec<_>>();
            assert!(corners.is_sorted_by(|a, b| a < b), "each tile once, row by row");
            assert!(tiles.iter().all(|t| t.x + t.width <= width && t.y + t.height <= height));
        }
    }

    #[test]
    fn a_frame_of_720_rows_is_one_submission_even_on_the_smallest_devices() {
        let plan = TilePlan::new(Budget::SMALL, &request(1280, 720), 112, 2048, 30, 1);
        assert_eq!((plan.count(), plan.batch), (1, 1));
    }
}
