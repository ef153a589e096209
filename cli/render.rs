// SPDX-License-Identifier: MIT OR Apache-2.0
//! `bhr render`: frames of a scene to files. A frame's bytes depend on the scene and its number only; a file is there
//! whole or not at all; what is there is passed over. So the same command may be run again, on several machines at
//! once, and be killed at any time.

use crate::encode::{Claim, Encoders, Frame};
use crate::ending::Ending;
use crate::frames::{self, Names};
use crate::manifest::{Fingerprint, Made, Manifest, Tile, hash};
use crate::open::{self, Opened, recovering};
use crate::progress::{Progress, say};
use crate::signals::Signals;
use bhr::image::{Effort, ImageMut, Layout, PixelFormat};
use bhr::renderer::Renderer;
use bhr::scene::Region;
use bhr::scene_file::parameters;
use clap::ArgMatches;
use std::fs::OpenOptions;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// How long other programs' frames are waited for before they are looked at again.
const PATIENCE: Duration = Duration::from_millis(200);

/// All that decides the bytes of frames, but their numbers.
struct Order {
    opened: Opened,
    rate: f64,
    size: [u32; 2],
    /// The part of the full frame.
    tile: Option<[u32; 4]>,
    samples: Option<u32>,
    format: PixelFormat,
    transparent: bool,
    scene_hash: String,
}

impl Order {
    fn new(given: &ArgMatches) -> Result<Self, Ending> {
        let opened = open::scene(given)?;
        let render = opened.render();
        let text = |name: &str| given.get_one::<String>(name).map(String::as_str);
        let size = text("size").map(frames::size).transpose()?.unwrap_or([render.width, render.height]);
        let tile = text("tile").map(|tile| frames::numbers::<4, u32>("tile", tile, "0,0,960,540")).transpose()?;
        if let Some([x, y, width, height]) = tile {
            let within = |begin: u32, length: u32, side: u32| {
                length > 0 && u64::from(begin) + u64::from(length) <= u64::from(side)
            };
            if !within(x, width, size[0]) || !within(y, height, size[1]) {
                let [w, h] = size;
                return Err(Ending::usage(format!("--tile {x},{y},{width},{height}: it must lie in {w} x {h}")));
            }
        }
        let out = given.get_one::<PathBuf>("out").ok_or_else(|| Ending::usage("no --out"))?;
        let extension = out.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
        let format = match (extension.as_deref(), given.get_flag("float")) {
            (Some("png"), false) => PixelFormat::Rgba8Srgb,
            (Some("exr"), false) => PixelFormat::Rgba16F,
            (Some("exr"), true) => PixelFormat::Rgba32F,
            (_, float) => {
                let known = if float { ".exr, with --float" } else { ".png or .exr" };
                return Err(Ending::usage(format!("--out {}: files are {known}", out.display())));
            }
        };
        let samples = given.get_one::<u32>("samples").copied();
        let transparent = given.get_flag("transparent");
        let map = opened.file.map().map(|map| std::fs::read(map).map_err(|error| Ending::io(map, error)));
        let map = map.transpose()?.map(|bytes| hash(&bytes));
        let scene = opened.file.text_of_pixels()?;
        let all = format!("{scene}\n{map:?} {size:?} {samples:?} {format:?} {transparent}");
        let scene_hash = hash(all.as_bytes());
        let rate = render.frames_per_second;
        Ok(Self { opened, rate, size, tile, samples, format, transparent, scene_hash })
    }

    /// Puts a frame's scene into the renderer; its region, and the size of its image.
    fn show(&self, frame: u32, renderer: &mut Renderer) -> Result<(Option<Region>, [u32; 2]), Ending> {
        let region = self.opened.show(f64::from(frame) / self.rate, renderer)?;
        if let Some(samples) = self.samples {
            renderer.scene.quality.samples_per_pixel = samples;
            renderer.scene.quality.check()?;
        }
        let [full_width, full_height] = self.size;
        Ok(match self.tile {
            Some([x, y, width, height]) => (Some(Region { full_width, full_height, x, y }), [width, height]),
            None => (region, self.size),
        })
    }

    /// All that decides the bytes of a frame's file.
    fn fingerprint(&self, frame: u32) -> Fingerprint {
        let seconds = f64::from(frame) / self.rate;
        let moment = if self.opened.file.moves() { seconds.to_bits() } else { 0 };
        let scene = hash(format!("{} {moment:x}", self.scene_hash).as_bytes());
        let [full_width, full_height] = self.size;
        let tile = self.tile.map(|[x, y, width, height]| Tile {
            region: Region { full_width, full_height, x, y },
            size: [width, height],
        });
        Fingerprint { frame, scene, tile }
    }

    fn layout(&self) -> Layout {
        let [width, height] = self.tile.map_or(self.size, |[_, _, width, height]| [width, height]);
        Layout::packed(self.format, width, height)
    }
}

/// Renders the frames that arguments ask for.
pub fn run(given: &ArgMatches) -> Result<(), Ending> {
    let order = Order::new(given)?;
    let count = order.opened.render().frames();
    let list = match given.get_one::<String>("frames") {
        Some(list) => frames::list(list)?,
        None => (0..count).collect(),
    };
    let out = given.get_one::<PathBuf>("out").ok_or_else(|| Ending::usage("no --out"))?;
    let names = Names::new(out, list.len() > 1)?;
    if let Some(folder) = names.of(0).parent().filter(|folder| !folder.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder).map_err(|error| Ending::io(folder, error))?;
    }
    let kind = given.get_one::<String>("progress").map_or("auto", String::as_str);
    let mut progress = Progress::new(kind, list.len() as u64)?;
    let signals = Signals::listen();
    let mut renderer = open::renderer(given)?;
    if given.get_flag("dry-run") {
        return dry_run(&order, &list, &mut renderer, &signals);
    }
    let encoders = given.get_one::<u32>("encoders").copied().unwrap_or(0) as usize;
    let effort = given.get_one::<i32>("compression").map_or_else(Effort::default, |level| Effort(*level));
    let run = Run { order: &order, names: &names, again: given.get_flag("again"), effort, signals: &signals };
    let result = run.frames(list, encoders, &mut renderer, &mut progress);
    progress.end();
    result
}

struct Run<'a> {
    order: &'a Order,
    names: &'a Names,
    again: bool,
    effort: Effort,
    signals: &'a Signals,
}

impl Run<'_> {
    fn frames(
        &self,
        list: Vec<u32>,
        encoders: usize,
        renderer: &mut Renderer,
        progress: &mut Progress,
    ) -> Result<(), Ending> {
        let layout = self.order.layout();
        let (bytes, _) = layout.check()?;
        let mut encoders = Encoders::new(encoders, list.len(), bytes)?;
        let mut ended = self.render_all(list, layout, &mut encoders, renderer, progress);
        // Frames that are rendered are written, whatever ended the rest; the first mistake is told.
        for written in encoders.finish() {
            match written {
                Ok(made) => progress.frame(made.of.frame, &made.file, Some(made.seconds)),
                Err(ending) => ended = ended.and(Err(ending)),
            }
        }
        ended
    }

    fn render_all(
        &self,
        list: Vec<u32>,
        layout: Layout,
        encoders: &mut Encoders,
        renderer: &mut Renderer,
        progress: &mut Progress,
    ) -> Result<(), Ending> {
        let mut lost = 0;
        let mut manifest = Manifest::read(&self.names.manifest());
        let mut left = list;
        while !left.is_empty() {
            manifest.refresh();
            let mut others = Vec::new();
            for frame in left {
                self.signals.check()?;
                for written in encoders.written() {
                    let made = written?;
                    progress.frame(made.of.frame, &made.file, Some(made.seconds));
                }
                let file = self.names.of(frame);
                if self.is_there(frame, &file, &manifest) {
                    progress.frame(frame, &file, None);
                    continue;
                }
                let Some(claim) = claim(&file)? else {
                    others.push(frame);
                    continue;
                };
                // Another program may have finished the frame between the two questions.
                manifest.refresh();
                if self.is_there(frame, &file, &manifest) {
                    progress.frame(frame, &file, None);
                    continue;
                }
                let made = self.frame(frame, file, layout, claim, encoders, renderer, &mut lost)?;
                encoders.order(made)?;
            }
            // The rest is being made by other programs: it is there in a while, or they are gone.
            left = others;
            if !left.is_empty() {
                std::thread::sleep(PATIENCE);
            }
        }
        Ok(())
    }

    /// Whether a frame's file is there, whole, and of this scene as far as that is known. A tile that nobody has noted
    /// could not be joined.
    fn is_there(&self, frame: u32, file: &Path, manifest: &Manifest) -> bool {
        let is_file = || std::fs::metadata(file).is_ok_and(|found| found.is_file() && found.len() > 0);
        let is_this = || match manifest.frame_of(file) {
            None => self.order.tile.is_none(),
            Some(noted) => noted.is_some_and(|noted| noted == self.order.fingerprint(frame)),
        };
        !self.again && is_file() && is_this()
    }

    #[allow(clippy::too_many_arguments)]
    fn frame(
        &self,
        frame: u32,
        file: PathBuf,
        layout: Layout,
        claim: Claim,
        encoders: &mut Encoders,
        renderer: &mut Renderer,
        lost: &mut u32,
    ) -> Result<Frame, Ending> {
        let mut pixels = encoders.pixels()?;
        let (region, size) = self.order.show(frame, renderer)?;
        let begin = Instant::now();
        recovering(renderer, lost, |renderer| {
            let mut image = ImageMut::new(layout, bytemuck::cast_slice_mut(&mut pixels))?;
            renderer.render(&mut image, self.order.transparent, region, &mut |_| !self.signals.has_come())
        })
        .map_err(|ending| self.signals.check().err().unwrap_or(ending))?;
        let whole = Region { full_width: size[0], full_height: size[1], x: 0, y: 0 };
        let made = renderer.scene.made(&region.unwrap_or(whole));
        let adapter = renderer.adapter();
        let made = Frame {
            pixels,
            layout,
            transparent: self.order.transparent,
            effort: self.effort,
            attributes: if layout.format.is_developed() { Vec::new() } else { parameters(&made) },
            manifest: self.names.manifest(),
            made: Made {
                file,
                of: self.order.fingerprint(frame),
                adapter: adapter.name.clone(),
                backend: adapter.backend.to_string(),
                seconds: begin.elapsed().as_secs_f64(),
            },
            claim,
        };
        Ok(made)
    }
}

/// Claims a frame for this program; `None`: another one is making it. File systems without locks let every program make
/// every frame: the bytes are the same.
fn claim(file: &Path) -> Result<Option<Claim>, Ending> {
    let mut name = file.file_name().unwrap_or_default().to_owned();
    name.push(".lock");
    let path = file.with_file_name(name);
    // Another user's, who was killed, may be read at least, which is enough for a lock.
    let open = OpenOptions::new().create(true).truncate(false).write(true).open(&path);
    let lock = open.or_else(|error| std::fs::File::open(&path).map_err(|_| error));
    let lock = lock.map_err(|error| Ending::io(&path, error))?;
    match lock.try_lock() {
        Err(std::fs::TryLockError::WouldBlock) => Ok(None),
        Ok(()) | Err(std::fs::TryLockError::Error(_)) => Ok(Some(Claim { path, file: Some(lock) })),
    }
}

/// The pixels of frames that are tried.
const TRIED_PIXELS: f64 = 320.0 * 180.0;

/// Renders the first, the middle and the last frame small, and says what all of them take.
fn dry_run(order: &Order, list: &[u32], renderer: &mut Renderer, signals: &Signals) -> Result<(), Ending> {
    let layout = order.layout();
    let pixels = f64::from(layout.width) * f64::from(layout.height);
    let shrink = (TRIED_PIXELS / pixels).sqrt().min(1.0);
    let side = |side: u32| ((f64::from(side) * shrink).round() as u32).max(1);
    // A cube's width is six times its height.
    let small = Layout::packed(order.format, side(layout.width / 6) * 6, side(layout.height));
    let (bytes, _) = small.check()?;
    let mut seconds = Vec::new();
    for index in [0, list.len() / 2, list.len().saturating_sub(1)] {
        let Some(frame) = list.get(index) else { continue };
        order.show(*frame, renderer)?;
        let mut pixels = vec![0u32; bytes.div_ceil(4)];
        // The first one compiles what the frames run.
        let mut took = 0.0;
        for _ in 0..2 {
            let begin = Instant::now();
            let mut image = ImageMut::new(small, bytemuck::cast_slice_mut(&mut pixels))?;
            let rendered = renderer.render(&mut image, order.transparent, None, &mut |_| !signals.has_come());
            signals.check()?;
            rendered?;
            took = begin.elapsed().as_secs_f64();
        }
        seconds.push(took);
    }
    let mean = seconds.iter().sum::<f64>() / seconds.len().max(1) as f64;
    let scale = pixels / (f64::from(small.width) * f64::from(small.height));
    let (whole, _) = layout.check()?;
    let adapter = renderer.adapter();
    say(&format!(
        "{} frames of {} x {} on {} ({}): about {:.0} s, if each takes {scale:.1} times what {} x {} took, {:.3} s",
        list.len(),
        layout.width,
        layout.height,
        adapter.name,
        adapter.backend,
        mean * scale * list.len() as f64,
        small.width,
        small.height,
        mean,
    ));
    say(&format!("at most {:.1} MB of files", whole as f64 * list.len() as f64 / 1e6));
    Ok(())
}
