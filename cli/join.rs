// SPDX-License-Identifier: MIT OR Apache-2.0
//! `bhr join`: the tiles of a frame as one picture. Every pixel must be in a tile; where several have it they agree, as
//! tiles are parts of one frame.

use crate::ending::Ending;
use crate::manifest::{Fingerprint, Manifest};
use crate::progress::say;
use bhr::image::{Alpha, Effort, ImageRef, Layer, Layout, Loaded, PixelFormat, load, save, save_layers};
use bhr::scene::{Output, Region};
use clap::ArgMatches;
use half::f16;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The picture that is put together, in the channels of its file.
enum Whole {
    Bytes(Vec<u8>),
    Halves(Vec<f16>),
}

struct Joined {
    size: [u32; 2],
    pixels: Whole,
    /// Pixels of each row that are there.
    there: Vec<bool>,
}

/// The manifests of folders, each read once.
#[derive(Default)]
struct Manifests(BTreeMap<PathBuf, Vec<Manifest>>);

impl Manifests {
    /// The frame and the place of a tile, as the manifest in its folder says that names it.
    fn find(&mut self, tile: &Path) -> Result<(Fingerprint, Region), Ending> {
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
                Some(tile) => Ok((found.clone(), tile.region)),
                None => wrong("it is a whole frame, as its manifest says"),
            },
            [None] => wrong("it was being written when its program was killed; render it again"),
            [] => wrong("no manifest beside it says which tile it is"),
            _ => wrong("two manifests beside it speak of it"),
        }
    }
}

impl Joined {
    fn new(region: &Region, exr: bool) -> Result<Self, Ending> {
        let size = [region.full_width, region.full_height];
        let count = size[0] as usize * size[1] as usize;
        let none = |_| {
            bhr::error::Error::new(
                bhr::error::ErrorKind::OutOfMemory,
                format!("no memory for {} x {}", size[0], size[1]),
            )
        };
        let (mut bytes, mut halves, mut there) = (Vec::new(), Vec::new(), Vec::new());
        there.try_reserve_exact(count).map_err(none)?;
        there.resize(count, false);
        let pixels = if exr {
            halves.try_reserve_exact(4 * count).map_err(none)?;
            halves.resize(4 * count, f16::ZERO);
            Whole::Halves(halves)
        } else {
            bytes.try_reserve_exact(4 * count).map_err(none)?;
            bytes.resize(4 * count, 0);
            Whole::Bytes(bytes)
        };
        Ok(Self { size, pixels, there })
    }

    fn put(&mut self, tile: &Loaded, region: &Region, path: &Path) -> Result<(), Ending> {
        let [width, height] = self.size;
        let fits = u64::from(region.x) + u64::from(tile.width) <= u64::from(width)
            && u64::from(region.y) + u64::from(tile.height) <= u64::from(height);
        if !fits || [region.full_width, region.full_height] != self.size {
            return Err(Ending::data(format!("{}: it is a tile of another frame", path.display())));
        }
        let bytes = tile.pixels.as_bytes();
        for row in 0..tile.height as usize {
            let begin = (region.y as usize + row) * width as usize + region.x as usize;
            let (from, count) = (row * tile.width as usize, tile.width as usize);
            self.there[begin..begin + count].fill(true);
            let (to, from) = (4 * begin..4 * (begin + count), 4 * from..4 * (from + count));
            match (&mut self.pixels, tile.format) {
                (Whole::Bytes(all), PixelFormat::Rgba8Srgb) => all[to].copy_from_slice(&bytes[from]),
                (Whole::Halves(all), PixelFormat::Rgba32F) => {
                    let floats: &[f32] = bytemuck::cast_slice(bytes);
                    for (to, from) in all[to].iter_mut().zip(&floats[from]) {
                        *to = f16::from_f32(*from);
                        if to.is_infinite() && from.is_finite() {
                            return Err(Ending::data(format!("{}: {from} does not fit into a half", path.display())));
                        }
                    }
                }
                _ => {
                    let message = "its pixels are of another kind than --out";
                    return Err(Ending::data(format!("{}: {message}", path.display())));
                }
            }
        }
        Ok(())
    }

    fn save(&self, out: &Path) -> Result<(), Ending> {
        if let Some(place) = self.there.iter().position(|there| !there) {
            let (x, y) = (place % self.size[0] as usize, place / self.size[0] as usize);
            return Err(Ending::data(format!("no tile has the pixel {x}, {y}")));
        }
        let [width, height] = self.size;
        match &self.pixels {
            Whole::Bytes(bytes) => {
                let image = ImageRef::new(Layout::packed(PixelFormat::Rgba8Srgb, width, height), bytes)?;
                save(&image, Alpha::AsInFile, out)?;
            }
            Whole::Halves(halves) => {
                let layout = Layout::packed(PixelFormat::Rgba16F, width, height);
                let image = ImageRef::new(layout, bytemuck::cast_slice(halves))?;
                let channels = Output::of_view(bhr::scene::View::Light).channels();
                save_layers(&[Layer { channels, image }], &[], Effort::default(), out)?;
            }
        }
        Ok(())
    }
}

pub fn run(given: &ArgMatches) -> Result<(), Ending> {
    let out = given.get_one::<PathBuf>("out").ok_or_else(|| Ending::usage("no --out"))?;
    let tiles = given.get_many::<PathBuf>("tiles").unwrap_or_default().collect::<Vec<_>>();
    let exr = out.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("exr"));
    let mut joined: Option<Joined> = None;
    let (mut manifests, mut first) = (Manifests::default(), None);
    for path in &tiles {
        let (of, region) = manifests.find(path)?;
        let (frame, scene) = first.get_or_insert_with(|| (of.frame, of.scene.clone()));
        if (of.frame, &of.scene) != (*frame, &*scene) {
            return Err(Ending::data(format!("{}: it is a tile of another frame", path.display())));
        }
        let tile = load(path)?;
        let whole = match &mut joined {
            Some(whole) => whole,
            None => joined.insert(Joined::new(&region, exr)?),
        };
        whole.put(&tile, &region, path)?;
    }
    joined.ok_or_else(|| Ending::usage("no tiles"))?.save(out)?;
    say(&format!("{}: {} tiles", out.display(), tiles.len()));
    Ok(())
}
