// SPDX-License-Identifier: MIT OR Apache-2.0
//! Outputs beside the picture, tile by tile: one ray through each pixel's centre, and the numbers that
//! `scene::output` makes of its record. Knows no host memory.

use super::CpuTracer;
use super::frame::Frame;
use super::render::{TILE_WIDTH, tiles};
use crate::allocate::{self, filled, with_room};
use crate::error::{Error, ErrorKind, Result};
use crate::scene::output::{MOST_OUTPUTS, OUTPUT_WORDS, RayValues};
use crate::scene::{RayOutput, Scene};
use crate::tracer::{FrameRequest, FrameStats, OutputSink, Progress};

/// All numbers of a pixel.
type PixelValues = [[f32; OUTPUT_WORDS]; MOST_OUTPUTS];

impl CpuTracer {
    /// Errors: as `Renderer::render`.
    pub fn render_outputs(
        &mut self,
        scene: &Scene,
        request: &FrameRequest,
        outputs: &[RayOutput],
        sink: &mut OutputSink<'_>,
        progress: &mut Progress<'_>,
    ) -> Result<FrameStats> {
        const WHAT: &str = "the outputs of a tile";
        allocate::check_room(0, WHAT)?;
        let lens = scene.lens(&request.region)?;
        let stars = self.stars.insert(scene.stars()?).clone();
        let (pool, cache) = (&self.pool, &mut self.output_lenses);
        let frame = pool.install(|| Frame::new(scene, &lens, stars, cache, request))?;
        let values = RayValues::new(scene, &lens)?;
        let tiles = tiles(request, frame.expected_steps(scene), TILE_WIDTH)?;
        let mut steps = 0;
        for (done, tile) in (1..).zip(&tiles) {
            let count = tile.width as usize * tile.height as usize;
            let mut pixels: Vec<PixelValues> = filled(count, Default::default(), WHAT)?;
            steps += pool.install(|| {
                frame.with_records(*tile, ([0.5; 2], 0.0), &mut pixels, |record, x, y, pixel| {
                    for (output, out) in outputs.iter().zip(pixel) {
                        *out = values.values(*output, record, x, y).map(|value| value as f32);
                    }
                })
            })?;
            for (index, output) in outputs.iter().enumerate() {
                let words = output.words();
                let mut packed = with_room(count * words, WHAT)?;
                pixels.iter().for_each(|pixel| packed.extend_from_slice(&pixel[index][..words]));
                sink(index, *tile, bytemuck::cast_slice(&packed), 4 * words * tile.width as usize)?;
            }
            if !progress(done as f64 / tiles.len() as f64) && done < tiles.len() {
                return Err(Error::new(ErrorKind::Cancelled, "the progress callback cancelled the outputs"));
            }
        }
        let rays = u64::from(request.width) * u64::from(request.height);
        Ok(FrameStats { rays, steps, ..FrameStats::default() })
    }
}
