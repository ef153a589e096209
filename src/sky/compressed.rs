// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pictures of the whole sky in blocks of BC6H, which take a quarter of the memory that texels do: the pyramid of
//! `map.rs`, whose rows of blocks are the file's wherever filtering would not change them. Knows no files.

use super::map::{Level, Scratch, SkyMap, blur_width, finest_size, on_threads, threads_for};
use crate::allocate::filled;
use crate::error::Result;
use crate::image::BlockFile;
use crate::image::bc6h::{Blocks, SIDE, Texels, decode, encode};
use crate::image::rgb9e5::{pack, unpack};
use parking_lot::Mutex;

/// Rows of blocks that a thread takes at a time.
const BAND: usize = 4;
/// Rows that filtering would average over at most this many texels keep the file's blocks: their texels are at least
/// 2 / 3 as wide as high, so that a pixel averages over more than one of them anyway.
const KEPT_WIDTH: f64 = 1.5;

/// A picture of the whole sky, whose light is unpacked when it is read.
pub struct CompressedMap {
    /// The levels of `SkyMap`.
    levels: Vec<Blocks>,
}

/// Reads rows of light, and keeps the row of blocks that it unpacked last.
pub struct RowReader<'a> {
    blocks: &'a Blocks,
    unpacked: Option<usize>,
    texels: Vec<Texels>,
    row: Vec<[f32; 3]>,
}

impl<'a> RowReader<'a> {
    /// Errors: OUT_OF_MEMORY.
    pub fn new(blocks: &'a Blocks) -> Result<Self> {
        let across = Blocks::count(blocks.size)[0];
        let what = "rows of a sky map";
        let (texels, row) = (filled(across, [[0.0; 3]; 16], what)?, filled(blocks.size[0] as usize, [0.0; 3], what)?);
        Ok(Self { blocks, unpacked: None, texels, row })
    }

    /// The light of row `y`, as many texels as there is room for.
    pub fn read(&mut self, y: u32, out: &mut [[f32; 3]]) {
        let (row, inner) = ((y / SIDE) as usize, (y % SIDE * SIDE) as usize);
        if self.unpacked != Some(row) {
            let blocks = self.blocks.row(row);
            self.texels.iter_mut().zip(blocks).for_each(|(texels, block)| *texels = decode(block, false));
            self.unpacked = Some(row);
        }
        for (out, texels) in out.chunks_mut(SIDE as usize).zip(&self.texels) {
            out.iter_mut().zip(texels.iter().skip(inner)).for_each(|(out, texel)| *out = *texel);
        }
    }

    /// Row `y` as texels of a [`Level`].
    pub fn read_texels(&mut self, y: u32, out: &mut [u32]) {
        let mut row = std::mem::take(&mut self.row);
        self.read(y, &mut row);
        out.iter_mut().zip(&row).for_each(|(texel, light)| *texel = pack(*light));
        self.row = row;
    }
}

/// Writes the row of this number.
type Rows<'a> = Box<dyn FnMut(u32, &mut [[f32; 3]]) + 'a>;

/// Packs a level. Each thread calls `rows` once for a reader of its own, of so many columns; where `kept` gives a row
/// of blocks, that is copied. Errors: OUT_OF_MEMORY.
fn packed<'a, 'k>(
    size: [u32; 2],
    (columns, rows): (usize, &(dyn Fn() -> Result<Rows<'a>> + Sync)),
    kept: &(dyn Fn(u32) -> Option<&'k [[u8; 16]]> + Sync),
) -> Result<Blocks> {
    let ([across, down], [width, height]) = (Blocks::count(size), size.map(|side| side as usize));
    let mut blocks = filled(across * down, [0; 16], "blocks of a sky map")?;
    let bands = Mutex::new(blocks.chunks_mut(BAND * across).zip((0..).step_by(BAND * SIDE as usize)));
    on_threads(threads_for(width * height, columns), &|| {
        let mut read = rows()?;
        let mut light = filled(width * SIDE as usize, [0.0; 3], "rows of a sky map")?;
        loop {
            let Some((band, first)) = bands.lock().next() else { return Ok(()) };
            for (row, top) in band.chunks_mut(across).zip((first..).step_by(SIDE as usize)) {
                if let Some(kept) = kept(top).filter(|kept| kept.len() == row.len()) {
                    row.copy_from_slice(kept);
                    continue;
                }
                // Texels beyond the last row and column repeat it.
                let last = (height - 1 - top as usize).min(SIDE as usize - 1);
                light.chunks_mut(width).zip(top..).take(last + 1).for_each(|(light, y)| read(y, light));
                for (block, left) in row.iter_mut().zip((0..).step_by(SIDE as usize)) {
                    *block = encode(&std::array::from_fn(|i| {
                        let (x, y) = ((left + i % SIDE as usize).min(width - 1), (i / SIDE as usize).min(last));
                        light.get(y * width + x).copied().unwrap_or_default()
                    }));
                }
            }
        }
    })?;
    Ok(Blocks { size, blocks })
}

/// A level of `size` whose texels are as wide as they are high, from one of that size or a finer one. `keeps`: copy the
/// source's blocks where filtering would hardly change them. Errors: OUT_OF_MEMORY.
fn filtered(source: &Blocks, size: [u32; 2], keeps: bool) -> Result<Blocks> {
    let rows = || -> Result<Rows<'_>> {
        let mut reader = RowReader::new(source)?;
        let mut scratch = Scratch::new(source.size[0] as usize, size[0] as usize)?;
        Ok(Box::new(move |y, out| {
            let row = scratch.row_of(&mut |y, out| reader.read(y, out), source.size[1], size, y);
            out.iter_mut().zip(row).for_each(|(out, light)| *out = light.map(|v| v as f32));
        }))
    };
    let kept = |top: u32| {
        let widest = (top..(top + SIDE).min(size[1])).map(|y| blur_width(size, y)).fold(0.0, f64::max);
        (keeps && widest <= KEPT_WIDTH).then(|| source.row((top / SIDE) as usize))
    };
    packed(size, (source.size[0] as usize, &rows), &kept)
}

impl CompressedMap {
    /// The map of a file's picture: of its level that is as large as the map of such a picture, or else of its largest,
    /// reduced. Levels that the file lacks are made. Errors: OUT_OF_MEMORY.
    pub fn new(file: BlockFile) -> Result<Self> {
        let wanted = file.levels.first().map(|largest| finest_size(largest.size));
        let fitting = file.levels.iter().position(|level| Some(level.size) == wanted);
        let mut made: Vec<Blocks> = Vec::with_capacity(u32::BITS as usize);
        if let (None, Some(largest)) = (fitting, file.levels.first()) {
            made.push(filtered(largest, finest_size(largest.size), false)?);
        }
        let mut given = file.levels.into_iter().skip(fitting.unwrap_or(usize::MAX));
        loop {
            let next = match (given.next(), made.last()) {
                (Some(level), _) if file.filtered => level,
                (Some(level), _) => filtered(&level, level.size, true)?,
                (None, Some(finer)) if finer.size != [1, 1] => {
                    filtered(finer, finer.size.map(|side| (side / 2).max(1)), false)?
                }
                (None, _) => return Ok(Self { levels: made }),
            };
            made.push(next);
        }
    }

    /// The blocks that come nearest to a map of texels. Errors: OUT_OF_MEMORY.
    pub fn of(map: &SkyMap) -> Result<Self> {
        let levels = map.levels().iter().map(|level| {
            let rows = || -> Result<Rows<'_>> {
                Ok(Box::new(|y, out| out.iter_mut().zip(level.row(y)).for_each(|(out, texel)| *out = unpack(*texel))))
            };
            packed(level.size, (level.size[0] as usize, &rows), &|_| None)
        });
        Ok(Self { levels: levels.collect::<Result<_>>()? })
    }

    /// The levels of a [`SkyMap`].
    pub fn levels(&self) -> &[Blocks] {
        &self.levels
    }

    /// The map in texels. Errors: OUT_OF_MEMORY.
    pub fn unpacked(&self) -> Result<SkyMap> {
        Ok(SkyMap::from_levels(self.levels.iter().map(unpacked).collect::<Result<_>>()?))
    }
}

/// Errors: OUT_OF_MEMORY.
fn unpacked(blocks: &Blocks) -> Result<Level> {
    let [width, height] = blocks.size.map(|side| side as usize);
    let mut texels = filled(width * height, 0, "the texels of a sky map")?;
    let bands = Mutex::new(texels.chunks_mut(BAND * SIDE as usize * width).zip((0..).step_by(BAND * SIDE as usize)));
    on_threads(threads_for(width * height, width), &|| {
        let mut reader = RowReader::new(blocks)?;
        loop {
            let Some((band, first)) = bands.lock().next() else { return Ok(()) };
            band.chunks_mut(width).zip(first..).for_each(|(texels, y)| reader.read_texels(y, texels));
        }
    })?;
    Ok(Level { size: blocks.size, texels })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::mix;

    /// A file of one level, whose blocks have one colour each, that differs from block to block.
    fn file(size: [u32; 2], filtered: bool) -> BlockFile {
        let [across, down] = Blocks::count(size);
        let light = |i: usize| 0.1 + (mix(i as u32) >> 16) as f32 / 65536.0;
        let blocks = (0..across * down).map(|i| encode(&[[light(i), light(i + 7), 0.5]; 16])).collect();
        BlockFile { levels: vec![Blocks { size, blocks }], filtered }
    }

    fn light(level: &Blocks, x: u32, y: u32) -> [f32; 3] {
        let mut row = vec![[0.0; 3]; level.size[0] as usize];
        RowReader::new(level).unwrap().read(y, &mut row);
        row[x as usize]
    }

    /// Within 48 degrees of the equator blocks are the file's; at the poles rows are their mean.
    #[test]
    fn blocks_are_kept_where_texels_are_square() {
        let given = file([128, 64], false).levels.remove(0);
        let map = CompressedMap::new(file([128, 64], false)).unwrap();
        let finest = &map.levels()[0];
        for row in 0..16 {
            let kept = finest.row(row) == given.row(row);
            // Rows 0 to 2 of blocks lie beyond 56 degrees from the equator, rows 4 to 11 within 45.
            assert!(!kept || (3..13).contains(&row), "row {row}");
            assert!(kept || !(4..12).contains(&row), "row {row}");
        }
        let mean = (0..128).map(|x| light(&given, x, 0)[0]).sum::<f32>() / 128.0;
        for x in [0, 40, 127] {
            assert!((light(finest, x, 0)[0] / mean - 1.0).abs() < 0.1, "{x}: {:?}, mean {mean}", light(finest, x, 0));
        }
        let sizes = map.levels().iter().map(|level| level.size).collect::<Vec<_>>();
        assert_eq!(sizes, [[128, 64], [64, 32], [32, 16], [16, 8], [8, 4], [4, 2], [2, 1], [1, 1]]);
    }

    /// Files whose rows are filtered stay as they are, and so does any map that is saved and read again.
    #[test]
    fn filtered_files_stay_as_they_are() {
        let given = file([128, 64], false);
        let map = CompressedMap::new(given).unwrap();
        let copies = map.levels().iter().map(|level| Blocks { size: level.size, blocks: level.blocks.clone() });
        let again = CompressedMap::new(BlockFile { levels: copies.collect(), filtered: true }).unwrap();
        for (a, b) in map.levels().iter().zip(again.levels()) {
            assert!(a.size == b.size && a.blocks == b.blocks, "{:?}", a.size);
        }
        let map = CompressedMap::new(file([128, 64], true)).unwrap();
        assert!(map.levels()[0].blocks == file([128, 64], true).levels[0].blocks && map.levels().len() == 8);
    }

    /// The texels of a smooth map come back to 2 %, rms, and its mean to 0.3 %; maps may have any size.
    #[test]
    fn smooth_maps_keep_their_light() {
        for size in [[256, 128], [250, 126], [37, 53], [3, 1], [1, 1]] {
            let of = |x: u32, y: u32| {
                let (u, v) = (f64::from(x) / f64::from(size[0]), f64::from(y) / f64::from(size[1]));
                let wave = |k: f64| (1.2 + (std::f64::consts::TAU * (k * u + v)).sin()) as f32;
                [wave(1.0), 0.3 * wave(2.0), 2.0 * wave(3.0)]
            };
            let row = |y: u32, out: &mut [[f32; 3]]| (0..).zip(out).for_each(|(x, out)| *out = of(x, y));
            let map = SkyMap::of_rows(size, &row).unwrap();
            let back = CompressedMap::of(&map).unwrap().unpacked().unwrap();
            assert_eq!(map.levels().len(), back.levels().len());
            for (a, b) in map.levels().iter().zip(back.levels()) {
                assert_eq!(a.size, b.size);
                let (mut squares, mut sums) = (0.0, [0.0; 2]);
                for (a, b) in a.texels.iter().zip(&b.texels).map(|(a, b)| (unpack(*a), unpack(*b))) {
                    for (a, b) in a.into_iter().zip(b).map(|(a, b)| (f64::from(a), f64::from(b))) {
                        squares += (b / a - 1.0).powi(2);
                        sums = [sums[0] + a, sums[1] + b];
                    }
                }
                let rms = (squares / (3 * a.texels.len()) as f64).sqrt();
                // Waves of few texels are not smooth: a block has one line of colours, however much they differ.
                let coarse = a.size[1] < 100;
                assert!(rms < if coarse { 0.4 } else { 0.02 }, "{size:?} {:?}: {rms}", a.size);
                assert!((sums[1] / sums[0] - 1.0).abs() < if coarse { 0.03 } else { 0.003 }, "{:?}: {sums:?}", a.size);
            }
        }
    }

    /// Pictures whose size no map has are resampled: those of more rows than a map's, or of fewer columns than rows.
    #[test]
    fn tall_pictures_are_reduced() {
        for (size, wanted) in [([4, 2048], [1024, 1024]), ([8, 64], [64, 64]), ([64, 16], [64, 16])] {
            for all_levels in [false, true] {
                let mut given = file(size, true);
                while all_levels && given.levels.last().is_some_and(|level| level.size != [1, 1]) {
                    let next = given.levels.last().unwrap().size.map(|side| (side / 2).max(1));
                    given.levels.extend(file(next, true).levels);
                }
                let map = CompressedMap::new(given).unwrap();
                assert_eq!(map.levels()[0].size, wanted);
                assert_eq!(map.levels().last().unwrap().size, [1, 1]);
            }
        }
    }
}
