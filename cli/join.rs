// SPDX-License-Identifier: MIT OR Apache-2.0
//! `bhr join`: the tiles of a frame as one picture, with all layers. Every pixel must be in a tile; where several have
//! it they agree, as tiles are parts of one frame.

use crate::ending::Ending;
use crate::manifest::{Fingerprint, Manifest, Tile};
use crate::progress::say;
use bhr::image::{
    Alpha, Attribute, Channels, ColourSpace, Effort, ImageRef, Layout, Loaded, PixelFormat, Values, load,
    load_channels, save, save_channels,
};
use bhr::scene::Region;
use clap::ArgMatches;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// The attributes that say where a tile is: in its frame, which may itself be a region of a larger one.
const PLACE: [&str; 2] = ["bhr.region.x", "bhr.region.y"];

/// The picture that is put together.
enum Whole {
    /// The pixels of a PNG.
    Bytes(Vec<u8>),
    /// All channels of an EXR file, with the attributes that every tile has, and those of [`PLACE`].
    Channels(Channels),
}

struct Joined {
    size: [u32; 2],
    whole: Whole,
    /// For each pixel, 1 where a tile has it.
    there: Vec<u8>,
}

/// The manifests of folders, each read once.
#[derive(Default)]
struct Manifests(BTreeMap<PathBuf, Vec<Manifest>>);

impl Manifests {
    /// The frame and the place of a tile, as the manifest in its folder says that names it.
    fn find(&mut self, tile: &Path) -> Result<(Fingerprint, Tile), Ending> {
        let folder = tile.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        if !self.0.contains_key(folder) {
            let entries = std::fs::read_dir(folder).map_err(|error| Ending::io(folder, error))?;
            let paths = entries.flatten().map(|entry| entry.path());
            let manifests = paths.filter(|path| path.to_string_lossy().ends_with("manifest.jsonl"));
            let manifests = manifests.map(|path| Manifest::read(&path)).collect();
            self.0.insert(folder.to_owned(), manifests);
        }
        let all = self.0.get(folder).map(Vec::as_slice).unwrap_or_default();
        let found = all.iter().filter_map(|manifest| manifest.frame_of(tile)).collect::<Vec<_>>();
        let wrong = |what: &str| Err(Ending::data(format!("{}: {what}", tile.display())));
        match &found[..] {
            [Some(found)] => match found.tile {
                Some(tile) => Ok((found.clone(), tile)),
                None => wrong("it is a whole frame, as its manifest says"),
            },
            [None] => wrong("it was being written when its program was killed; render it again"),
            [] => wrong("no manifest beside it says which tile it is"),
            _ => wrong("two manifests beside it speak of it"),
        }
    }
}

impl Joined {
    /// The whole that a first tile is a part of, all zeros.
    fn new(region: &Region, first: &Saved) -> Result<Self, Ending> {
        let size = [region.full_width, region.full_height];
        let count = (size[0] as usize).saturating_mul(size[1] as usize);
        let whole = match first {
            Saved::Bytes(_) => Whole::Bytes(zeros(count.saturating_mul(4))?),
            Saved::Channels(first) => {
                let mut list = Vec::with_capacity(first.list.len());
                for (name, values) in &first.list {
                    let values = match values {
                        Values::Halves(_) => Values::Halves(zeros(count)?),
                        Values::Floats(_) => Values::Floats(zeros(count)?),
                    };
                    list.push((name.clone(), values));
                }
                let mut attributes = first.attributes.clone();
                for (name, value) in &mut attributes {
                    let place = PLACE.iter().zip([region.x, region.y]).find(|(of, _)| *of == name);
                    if let (Some((_, place)), Attribute::Number(number)) = (place, value) {
                        *number -= f64::from(place);
                    }
                }
                Whole::Channels(Channels { width: size[0], height: size[1], list, attributes, space: first.space })
            }
        };
        Ok(Self { size, whole, there: zeros(count)? })
    }

    fn put(&mut self, tile: &Saved, of: &Tile, path: &Path) -> Result<(), Ending> {
        let Tile { region, size } = of;
        let wrong = |what: &str| Err(Ending::data(format!("{}: {what}", path.display())));
        let [width, height] = self.size;
        let [tile_width, tile_height] = tile.size();
        if tile.size() != *size {
            let [w, h] = size;
            return wrong(&format!("it has {tile_width} x {tile_height} pixels; its manifest says {w} x {h}"));
        }
        let fits = u64::from(region.x) + u64::from(tile_width) <= u64::from(width)
            && u64::from(region.y) + u64::from(tile_height) <= u64::from(height);
        if !fits || [region.full_width, region.full_height] != self.size {
            return wrong("it is a tile of another frame");
        }
        // For each row: where its pixels go to in the whole, and where they are in the tile.
        let rows = (0..tile_height as usize).map(|row| {
            let begin = (region.y as usize + row) * width as usize + region.x as usize;
            let (from, count) = (row * tile_width as usize, tile_width as usize);
            (begin..begin + count, from..from + count)
        });
        for (to, _) in rows.clone() {
            self.there[to].fill(1);
        }
        match (&mut self.whole, tile) {
            (Whole::Bytes(all), Saved::Bytes(tile)) => {
                let bytes = tile.pixels.as_bytes();
                for (to, from) in rows {
                    all[4 * to.start..4 * to.end].copy_from_slice(&bytes[4 * from.start..4 * from.end]);
                }
            }
            (Whole::Channels(all), Saved::Channels(tile)) => {
                let same = all.list.iter().map(|(name, _)| name).eq(tile.list.iter().map(|(name, _)| name));
                if !same {
                    return wrong("it has other layers than the tiles before it");
                }
                if all.space != tile.space {
                    return wrong("its light has other primaries than that of the tiles before it");
                }
                let shared = |of_all: &(String, Attribute)| {
                    PLACE.contains(&of_all.0.as_str()) || tile.attributes.contains(of_all)
                };
                all.attributes.retain(shared);
                for ((_, all), (_, tile)) in all.list.iter_mut().zip(&tile.list) {
                    match (all, tile) {
                        (Values::Halves(all), Values::Halves(tile)) => copy_rows(all, tile, rows.clone()),
                        (Values::Floats(all), Values::Floats(tile)) => copy_rows(all, tile, rows.clone()),
                        _ => return wrong("its floats have another size than those of the tiles before it"),
                    }
                }
            }
            _ => return wrong("it is another kind of file than the tiles before it"),
        }
        Ok(())
    }

    fn save(&self, effort: Effort, out: &Path) -> Result<(), Ending> {
        if let Some(place) = self.there.iter().position(|there| *there == 0) {
            let (x, y) = (place % self.size[0] as usize, place / self.size[0] as usize);
            return Err(Ending::data(format!("no tile has the pixel {x}, {y}")));
        }
        let [width, height] = self.size;
        match &self.whole {
            Whole::Bytes(bytes) => {
                let image = ImageRef::new(Layout::packed(PixelFormat::Rgba8Srgb, width, height), bytes)?;
                save(&image, Alpha::AsInFile, ColourSpace::Rec709, out)?;
            }
            Whole::Channels(all) => save_channels(all, effort, out)?,
        }
        Ok(())
    }
}

/// A tile as it was saved.
enum Saved {
    Bytes(Loaded),
    Channels(Channels),
}

impl Saved {
    fn load(path: &Path) -> Result<Self, Ending> {
        if is_exr(path) {
            return Ok(Self::Channels(load_channels(path)?));
        }
        let loaded = load(path)?;
        match loaded.format {
            PixelFormat::Rgba8Srgb => Ok(Self::Bytes(loaded)),
            _ => Err(Ending::data(format!("{}: it is neither an EXR file nor an 8-bit PNG", path.display()))),
        }
    }

    fn size(&self) -> [u32; 2] {
        match self {
            Self::Bytes(loaded) => [loaded.width, loaded.height],
            Self::Channels(channels) => [channels.width, channels.height],
        }
    }
}

/// Copies rows of a tile to their places in the whole.
fn copy_rows<T: Copy>(all: &mut [T], tile: &[T], rows: impl Iterator<Item = (Range<usize>, Range<usize>)>) {
    for (to, from) in rows {
        all[to].copy_from_slice(&tile[from]);
    }
}

/// Zeros, or the error for no memory.
fn zeros<T: bytemuck::Zeroable>(count: usize) -> Result<Vec<T>, Ending> {
    bytemuck::allocation::try_zeroed_vec(count).map_err(|()| {
        let message = format!("no memory for {count} values");
        bhr::error::Error::new(bhr::error::ErrorKind::OutOfMemory, message).into()
    })
}

fn is_exr(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("exr"))
}

pub fn run(given: &ArgMatches) -> Result<(), Ending> {
    let out = given.get_one::<PathBuf>("out").ok_or_else(|| Ending::usage("no --out"))?;
    let tiles = given.get_many::<PathBuf>("tiles").unwrap_or_default().collect::<Vec<_>>();
    let mut joined: Option<Joined> = None;
    let (mut manifests, mut first) = (Manifests::default(), None);
    for path in &tiles {
        let (of, place) = manifests.find(path)?;
        let (frame, scene) = first.get_or_insert_with(|| (of.frame, of.scene.clone()));
        if (of.frame, &of.scene) != (*frame, &*scene) {
            return Err(Ending::data(format!("{}: it is a tile of another frame", path.display())));
        }
        if is_exr(path) != is_exr(out) {
            return Err(Ending::data(format!("{}: it is another kind of file than --out", path.display())));
        }
        let tile = Saved::load(path)?;
        let whole = match &mut joined {
            Some(whole) => whole,
            None => joined.insert(Joined::new(&place.region, &tile)?),
        };
        whole.put(&tile, &place, path)?;
    }
    let effort = given.get_one::<i32>("compression").map_or_else(Effort::default, |level| Effort(*level));
    joined.ok_or_else(|| Ending::usage("no tiles"))?.save(effort, out)?;
    say(&format!("{}: {} tiles", out.display(), tiles.len()));
    Ok(())
}
