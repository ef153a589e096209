// SPDX-License-Identifier: MIT OR Apache-2.0
//! The matter with depth of a tile at half resolution: the rays of its blocks, and the media of its pixels from them or
//! from their own rays (`emit::half` has the rule). Knows no light of anything else.

use super::record::Recorder;
use crate::allocate::filled;
use crate::emit::half::{Evenness, STENCIL, block_place, blocks_of, counts, first_block};
use crate::emit::medium::{Media, Medium};
use crate::error::Result;
use crate::parallel::prelude::*;
use crate::scene::record::Record;

/// The blocks that the pixels of a tile are found from.
pub struct Blocks<'a> {
    recorder: &'a Recorder<'a>,
    evenness: Evenness,
    /// The place of the sample in a pixel, 0 .. 1.
    offset: [f64; 2],
    /// The number of the first block of a row, and of a column.
    first: [i32; 2],
    stride: usize,
    records: Vec<Record>,
    /// When matter is seen, less the frame's time, M.
    moment: f64,
}

impl<'a> Blocks<'a> {
    /// For pixels from `begin` on, `size` of them. Errors: OUT_OF_MEMORY.
    pub fn new(
        recorder: &'a Recorder<'a>,
        evenness: Evenness,
        begin: [i32; 2],
        size: [u32; 2],
        (offset, moment): ([f64; 2], f64),
    ) -> Result<Self> {
        let [(x, columns), (y, rows)] = [0, 1].map(|i| blocks_of(begin[i], size[i]));
        let stride = columns as usize;
        let mut records = filled(stride * rows as usize, Record::captured(), "the blocks of a tile's matter")?;
        records.par_chunks_mut(stride).zip(y..y + rows as i32).for_each(|(records, y)| {
            for (record, x) in records.iter_mut().zip(x..) {
                *record = recorder.trace_among(block_place(x, offset[0]), block_place(y, offset[1]), 1, moment);
            }
        });
        Ok(Self { recorder, evenness, offset, first: [x, y], stride, records, moment })
    }

    /// The media of a pixel, of which `record` has everything else, and whether they come from blocks. None where the
    /// projection shows nothing.
    pub fn media(&self, pixel: [i32; 2], record: &Record) -> (Media, bool) {
        let [x, y] = [0, 1].map(|i| f64::from(pixel[i]) + self.offset[i]);
        let mapping = &self.recorder.lens.mapping;
        if !mapping.has_look_direction(x, y) {
            return (Media::new(), true);
        }
        match self.told_by_blocks(pixel, x, record) {
            Some(media) => (media, true),
            None => (self.recorder.trace_among(x, y, 1, self.moment).media, false),
        }
    }

    /// `None`: they do not tell.
    fn told_by_blocks(&self, pixel: [i32; 2], x: f64, record: &Record) -> Option<Media> {
        let mapping = &self.recorder.lens.mapping;
        let [left, top] = pixel.map(first_block);
        let begin = (top - self.first[1]) as usize * self.stride + (left - self.first[0]) as usize;
        let mut blocks = [record; STENCIL * STENCIL];
        for (i, block) in blocks.iter_mut().enumerate() {
            let [across, down] = [i % STENCIL, i / STENCIL];
            let there = block_place(left + across as i32, self.offset[0]);
            let below = block_place(top + down as i32, self.offset[1]);
            *block = self.records.get(begin + down * self.stride + across)?;
            let alike = !counts(i) || (block.fate == record.fate && block.orders() == record.orders());
            if !(alike && mapping.has_look_direction(there, below) && mapping.same_face(x, there)) {
                return None;
            }
        }
        let nothing = Medium::default();
        let layer = |k: usize| blocks.map(|block| block.media.get(k).unwrap_or(&nothing));
        (0..=record.crossings.len()).map(|k| self.evenness.medium(&layer(k), pixel)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Camera, Region, Scene, Volume, VolumeResolution};
    use glam::DVec3;

    /// The share of a frame's rays that matter is summed along: of blocks, and of pixels that they do not tell.
    fn share_summed(scene: &Scene, [full_width, full_height]: [u32; 2]) -> [f64; 2] {
        let lens = scene.lens(&Region { full_width, full_height, x: 0, y: 0 }).expect("a lens");
        let recorder = Recorder::new(scene, &lens, &[]);
        let evenness = scene.half_resolution().expect("half resolution");
        let blocks =
            Blocks::new(&recorder, evenness, [0, 0], [full_width, full_height], ([0.5; 2], 0.0)).expect("blocks");
        let own = (0..full_width * full_height).into_par_iter().filter(|i| {
            let pixel = [(i % full_width) as i32, (i / full_width) as i32];
            let [x, y] = pixel.map(|at| f64::from(at) + 0.5);
            !blocks.media(pixel, &recorder.trace_bare(x, y)).1
        });
        [own.count() as f64, blocks.records.len() as f64].map(|count| count / f64::from(full_width * full_height))
    }

    /// The soft disk without turbulence from near its plane, as large as it is meant to be shown: less than 45 % of the
    /// rays of a frame.
    #[test]
    fn few_rays_are_summed() {
        let mut scene = Scene { disk: None, ..Scene::plain() };
        scene.hole.spin = 0.6;
        scene.volumes.push(Volume { turbulence: 0.0, ..Volume::default() });
        scene.quality.volume_resolution = VolumeResolution::Half;
        let elevation = 6.5_f64.to_radians();
        let position = 28.0 * DVec3::new(elevation.cos(), 0.0, elevation.sin());
        scene.camera =
            Camera { position, forward: -position, up: DVec3::Z, fov_y: 2.0 * 0.34_f64.atan(), ..Camera::plain() };
        let [own, blocks] = share_summed(&scene, [640, 360]);
        println!("{own:.3} of the pixels' rays, {blocks:.3} of the blocks'");
        assert!(own + blocks < 0.45, "{own} {blocks}");
        assert!(own > 0.0 && blocks > 0.25, "{own} {blocks}");
    }
}
