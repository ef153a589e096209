// SPDX-License-Identifier: MIT OR Apache-2.0
//! All that decides the bytes of frames: scene, size, part of the frame, format, eyes, outputs; and the rendering of
//! one frame by it. Knows no files but by their endings.

use crate::ending::Ending;
use crate::frames;
use crate::manifest::{Fingerprint, Tile, hash};
use crate::open::{self, Opened, recovering};
use crate::signals::Signals;
use crate::video::codec::Codec;
use bhr::image::{ColourSpace, ImageMut, ImageRef, Layout, PixelFormat};
use bhr::job::OutputTarget;
use bhr::renderer::Renderer;
use bhr::scene::{
    Eye, MOST_CROSSINGS, MOST_OUTPUTS, Made, Output, Projection, RayOutput, RayOutputKind, Region, ThinLens, View,
};
use clap::ArgMatches;
use std::path::{Path, PathBuf};

/// Where the pictures of the two eyes lie in one frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stereo {
    TopBottom,
    SideBySide,
}

impl Stereo {
    pub fn name(self) -> &'static str {
        match self {
            Self::TopBottom => "TOP_BOTTOM",
            Self::SideBySide => "SIDE_BY_SIDE",
        }
    }
}

/// Motion blur and depth of field: a frame shows the time from its moment on, as a lens sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Shutter {
    /// The share of a frame's time that the shutter is open.
    open: f64,
    /// The moments that are rendered, each from a place of its own on the lens.
    samples: u32,
    lens: Option<Lens>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Lens {
    aperture: f64,
    /// `None`: the hole is in focus.
    focus: Option<f64>,
}

pub struct Order {
    pub opened: Opened,
    /// Frames a second.
    pub rate: f64,
    /// The full frame of one eye.
    size: [u32; 2],
    /// The part of the full frame.
    tile: Option<[u32; 4]>,
    samples: Option<u32>,
    /// `None`: frames show one moment.
    shutter: Option<Shutter>,
    /// The video that frames go into; `None`: each has a file of its own.
    pub codec: Option<Codec>,
    format: PixelFormat,
    /// The primaries of the light of `.exr` files.
    pub space: ColourSpace,
    pub transparent: bool,
    pub stereo: Option<Stereo>,
    /// Beside the light.
    outputs: Vec<Output>,
    scene_hash: String,
}

/// An image of a frame: where its pixels lie among those of the frame.
pub struct Place {
    pub output: Output,
    pub layout: Layout,
    words: std::ops::Range<usize>,
}

/// The kinds of files that frames go into.
fn kind_of(given: &ArgMatches) -> Result<(Option<Codec>, PixelFormat), Ending> {
    let out = given.get_one::<PathBuf>("out").ok_or_else(|| Ending::usage("no --out"))?;
    let extension = out.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    let codec = given.get_one::<String>("codec").map(String::as_str);
    let hdr = hdr_of(given)?;
    let coded = hdr.unwrap_or(PixelFormat::Rgba8Srgb);
    let codec = Codec::of(extension.as_deref(), codec, given.get_one::<u32>("quality").copied(), coded)?;
    let format = match (extension.as_deref(), given.get_flag("float")) {
        (_, false) if codec.is_some() => coded,
        (Some("png"), false) => coded,
        (Some("png"), true) => return Err(Ending::usage("--float: it is for .exr files")),
        (_, _) if hdr.is_some() => {
            return Err(Ending::usage(
                "--hdr: pictures of high dynamic range are .png files or videos; .exr files have no limit",
            ));
        }
        (Some("exr"), false) => PixelFormat::Rgba16F,
        (Some("exr"), true) => PixelFormat::Rgba32F,
        (_, float) => {
            let known = if float { ".exr, with --float" } else { ".png, .exr, .mp4 or .mov" };
            return Err(Ending::usage(format!("--out {}: files are {known}", out.display())));
        }
    };
    Ok((codec, format))
}

/// The format of high dynamic range that is asked for.
fn hdr_of(given: &ArgMatches) -> Result<Option<PixelFormat>, Ending> {
    match given.get_one::<String>("hdr").map(String::as_str) {
        None => Ok(None),
        Some("pq") => Ok(Some(PixelFormat::Rgb10A2Pq)),
        Some("hlg") => Ok(Some(PixelFormat::Rgb10A2Hlg)),
        Some(other) => Err(Ending::usage(format!("--hdr {other}: it must be pq or hlg"))),
    }
}

/// The primaries that are asked for. Errors: pixels of the format have none but their own.
fn space_of(given: &ArgMatches, format: PixelFormat) -> Result<ColourSpace, Ending> {
    let name = given.get_one::<String>("colour-space").map(String::as_str);
    let space = match name {
        None | Some("rec709") => ColourSpace::Rec709,
        Some("p3") => ColourSpace::P3D65,
        Some("rec2020") => ColourSpace::Rec2020,
        Some("acescg") => ColourSpace::AcesCg,
        Some(other) => {
            return Err(Ending::usage(format!("--colour-space {other}: it must be rec709, p3, rec2020 or acescg")));
        }
    };
    if name.is_some() && format.is_developed() {
        return Err(Ending::usage("--colour-space: it is for .exr files"));
    }
    Ok(space)
}

/// Outputs as they are named on the command line: `depth,position,position1`.
fn outputs_of(list: &str) -> Result<Vec<Output>, Ending> {
    let of = |name: &str| -> Option<Output> {
        let digits = name.trim_start_matches(|letter: char| letter.is_ascii_lowercase() || letter == '-');
        let (kind, _) = name.split_at(name.len() - digits.len());
        let index = if digits.is_empty() { 0 } else { digits.parse::<u32>().ok()? };
        let kind = match kind {
            "depth" => RayOutputKind::Depth,
            "sky" => RayOutputKind::Sky,
            "transmission" => RayOutputKind::Transmission,
            "position" => RayOutputKind::Position,
            "disk" => RayOutputKind::Disk,
            "redshift" => RayOutputKind::Redshift,
            "order" => RayOutputKind::Order,
            "deflection" => RayOutputKind::Deflection,
            "steps" if digits.is_empty() => return Some(Output::of_view(View::Steps)),
            "metric" if digits.is_empty() => return Some(Output::of_view(View::Metric)),
            "optical-depth" if digits.is_empty() => return Some(Output::of_view(View::OpticalDepth)),
            "intensity" if digits.is_empty() => return Some(Output::of_view(View::Intensity)),
            _ => return None,
        };
        let counts = matches!(kind, RayOutputKind::Position | RayOutputKind::Disk);
        (digits.is_empty() || (counts && index < MOST_CROSSINGS)).then_some(Output::Ray(RayOutput { kind, index }))
    };
    let mut outputs = Vec::new();
    for name in list.split(',').map(str::trim) {
        let output = of(name).ok_or_else(|| {
            Ending::usage(format!(
                "--outputs {list}: \"{name}\" is none of depth, sky, transmission, position, disk (of a later \
                 crossing: position1 .. position{last}, disk1 ..), redshift, order, deflection, steps, metric, \
                 optical-depth, intensity",
                last = MOST_CROSSINGS - 1
            ))
        })?;
        if !outputs.contains(&output) {
            outputs.push(output);
        }
    }
    // The light is one of them.
    if outputs.len() >= MOST_OUTPUTS {
        return Err(Ending::usage(format!("--outputs {list}: it must name {} at most", MOST_OUTPUTS - 1)));
    }
    Ok(outputs)
}

fn stereo_of(given: &ArgMatches) -> Result<Option<Stereo>, Ending> {
    match given.get_one::<String>("stereo").map(String::as_str) {
        None => Ok(None),
        Some("top-bottom") => Ok(Some(Stereo::TopBottom)),
        Some("side-by-side") => Ok(Some(Stereo::SideBySide)),
        Some(other) => Err(Ending::usage(format!("--stereo {other}: it must be top-bottom or side-by-side"))),
    }
}

fn shutter_of(given: &ArgMatches) -> Result<Option<Shutter>, Ending> {
    let degrees = given.get_one::<f64>("shutter").copied().unwrap_or(0.0);
    if !(0.0..=360.0).contains(&degrees) {
        return Err(Ending::usage(format!("--shutter {degrees}: it must lie in [0, 360]")));
    }
    let lens = lens_of(given)?;
    let samples = given.get_one::<u32>("shutter-samples").copied();
    if degrees == 0.0 && lens.is_none() {
        return match samples {
            Some(_) => Err(Ending::usage(
                "--shutter-samples: it is for motion blur and depth of field; set --shutter or --aperture",
            )),
            None => Ok(None),
        };
    }
    let samples = samples.unwrap_or(if lens.is_some() { 64 } else { 16 });
    Ok(Some(Shutter { open: degrees / 360.0, samples, lens }))
}

fn lens_of(given: &ArgMatches) -> Result<Option<Lens>, Ending> {
    let aperture = given.get_one::<f64>("aperture").copied().unwrap_or(0.0);
    let focus = given.get_one::<f64>("focus").copied();
    if !(aperture >= 0.0 && aperture.is_finite()) {
        return Err(Ending::usage(format!("--aperture {aperture}: it must be finite and not less than 0")));
    }
    if let Some(focus) = focus {
        if aperture == 0.0 {
            return Err(Ending::usage("--focus: it is for depth of field; set --aperture"));
        }
        if !(focus > 0.0 && focus.is_finite()) {
            return Err(Ending::usage(format!("--focus {focus}: it must be finite and greater than 0")));
        }
    }
    Ok((aperture > 0.0).then_some(Lens { aperture, focus }))
}

impl Order {
    pub fn new(given: &ArgMatches) -> Result<Self, Ending> {
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
        let (codec, format) = kind_of(given)?;
        let space = space_of(given, format)?;
        let (stereo, outputs) = (stereo_of(given)?, text("outputs").map_or(Ok(Vec::new()), outputs_of)?);
        if !outputs.is_empty() && (format.is_developed() || stereo.is_some()) {
            return Err(Ending::usage("--outputs: only .exr files of one eye have layers"));
        }
        if tile.is_some() && format.is_hdr() && codec.is_none() {
            return Err(Ending::usage("--tile: tiles of high dynamic range cannot be joined; only a video takes both"));
        }
        if tile.is_some() && stereo.is_some() && codec.is_none() {
            return Err(Ending::usage(
                "--tile: tiles of both eyes cannot be joined; only a video takes it with --stereo",
            ));
        }
        let samples = given.get_one::<u32>("samples").copied();
        let shutter = shutter_of(given)?;
        if shutter.is_some() && (tile.is_some() || stereo.is_some() || !outputs.is_empty()) {
            return Err(Ending::usage(
                "--shutter, --aperture: a blurred frame must be a whole frame of one eye, without --outputs",
            ));
        }
        let transparent = given.get_flag("transparent");
        if transparent && format.is_hdr() {
            return Err(Ending::usage("--transparent: pictures of high dynamic range have no alpha"));
        }
        let hash_of =
            |path: &Path| std::fs::read(path).map(|bytes| hash(&bytes)).map_err(|error| Ending::io(path, error));
        let map = opened.file.map().map(hash_of).transpose()?;
        let lut = opened.file.lut().map(hash_of).transpose()?;
        let scene = opened.file.text_of_pixels()?;
        let mut all = format!("{scene}\n{map:?} {size:?} {samples:?} {format:?} {transparent}");
        if stereo.is_some() || !outputs.is_empty() {
            all += &format!(" {stereo:?} {outputs:?}");
        }
        if space != ColourSpace::Rec709 {
            all += &format!(" {space:?}");
        }
        if let Some(shutter) = shutter {
            all += &format!(" {shutter:?} {:x}", render.frames_per_second.to_bits());
        }
        if let Some(lut) = lut {
            all += &format!(" LUT {lut:?}");
        }
        let scene_hash = hash(all.as_bytes());
        let rate = render.frames_per_second;
        let order = Self {
            opened,
            rate,
            size,
            tile,
            samples,
            shutter,
            codec,
            format,
            space,
            transparent,
            stereo,
            outputs,
            scene_hash,
        };
        if let Some(codec) = &order.codec {
            let Layout { width, height, .. } = order.layout();
            codec.check(width, height, transparent)?;
        }
        Ok(order)
    }

    /// Puts a frame's scene into the renderer; its region, and the size of one eye's image.
    fn show(&self, frame: u32, renderer: &mut Renderer) -> Result<(Option<Region>, [u32; 2]), Ending> {
        self.show_at(f64::from(frame), renderer)
    }

    /// [`Self::show`] of a moment between frames.
    fn show_at(&self, frame: f64, renderer: &mut Renderer) -> Result<(Option<Region>, [u32; 2]), Ending> {
        let region = self.opened.show(frame / self.rate, renderer)?;
        open::check_frames(&renderer.scene)?;
        if let Some(samples) = self.samples {
            renderer.scene.quality.samples_per_pixel = samples;
            renderer.scene.quality.check()?;
        }
        let camera = &renderer.scene.camera;
        if self.stereo.is_some() && !(camera.projection == Projection::Equirect && camera.eye_distance > 0.0) {
            return Err(Ending::data(format!(
                "--stereo: camera projection is {:?} and eye_distance {}; two eyes need equirect and more than 0",
                camera.projection, camera.eye_distance
            )));
        }
        let [full_width, full_height] = self.size;
        let whole = || region.unwrap_or(Region { full_width, full_height, x: 0, y: 0 });
        let tile = |[x, y, _, _]: [u32; 4]| {
            let whole = whole();
            Region { x: whole.x.saturating_add(x), y: whole.y.saturating_add(y), ..whole }
        };
        let region = self.tile.map(tile).or(region);
        Ok((region, self.eye_size()))
    }

    fn eye_size(&self) -> [u32; 2] {
        self.tile.map_or(self.size, |[_, _, width, height]| [width, height])
    }

    /// All that decides the bytes of a frame's file.
    pub fn fingerprint(&self, frame: u32) -> Fingerprint {
        let seconds = f64::from(frame) / self.rate;
        let moment = if self.opened.file.moves() { seconds.to_bits() } else { 0 };
        let scene = hash(format!("{} {moment:x}", self.scene_hash).as_bytes());
        Fingerprint { frame, scene, tile: self.tile_of_frame() }
    }

    /// All that decides the bytes of a video of these frames, with `shape` of the video itself.
    pub fn fingerprint_of_video(&self, list: &[u32], shape: &str) -> Fingerprint {
        let scene = hash(format!("{} {} {list:?} {shape}", self.scene_hash, self.rate.to_bits()).as_bytes());
        Fingerprint { frame: list.first().copied().unwrap_or(0), scene, tile: self.tile_of_frame() }
    }

    fn tile_of_frame(&self) -> Option<Tile> {
        let [full_width, full_height] = self.size;
        self.tile.map(|[x, y, width, height]| Tile {
            region: Region { full_width, full_height, x, y },
            size: [width, height],
        })
    }

    /// The picture of one eye.
    pub fn eye_layout(&self) -> Layout {
        let [width, height] = self.eye_size();
        Layout::packed(self.format, width, height)
    }

    /// The picture, of both eyes.
    pub fn layout(&self) -> Layout {
        let [width, height] = self.eye_size();
        let [width, height] = match self.stereo {
            None => [width, height],
            Some(Stereo::TopBottom) => [width, height.saturating_mul(2)],
            Some(Stereo::SideBySide) => [width.saturating_mul(2), height],
        };
        Layout::packed(self.format, width, height)
    }

    /// The images of a frame, the picture first, and the bytes of all. Errors: as [`Layout::check`].
    pub fn places(&self) -> Result<(Vec<Place>, usize), Ending> {
        let picture = (Output::Light, self.layout());
        let others = self.outputs.iter().map(|output| {
            let [width, height] = self.eye_size();
            (*output, Layout::packed(output.format().unwrap_or(self.format), width, height))
        });
        let (mut places, mut end) = (Vec::new(), 0usize);
        for (output, layout) in std::iter::once(picture).chain(others) {
            let (bytes, _) = layout.check()?;
            let begin = end;
            end = end.saturating_add(bytes.div_ceil(4));
            places.push(Place { output, layout, words: begin..end });
        }
        Ok((places, end.saturating_mul(4)))
    }

    /// Renders a frame into pixels of as many bytes as [`Self::places`] says; all parameters of the scene that it
    /// shows. Errors: those of the scene and of the device; the end that a signal asks for.
    pub fn render(
        &self,
        frame: u32,
        pixels: &mut [u32],
        renderer: &mut Renderer,
        lost: &mut u32,
        signals: &Signals,
    ) -> Result<Made, Ending> {
        let (region, [width, height]) = self.show(frame, renderer)?;
        let (places, _) = self.places()?;
        let asked = |ending| signals.check().err().unwrap_or(ending);
        if let Some(shutter) = self.shutter {
            self.render_blurred((frame, shutter), (pixels, &places), renderer, lost, signals)?;
        } else if places.len() > 1 {
            let rendered = recovering(renderer, lost, |renderer| {
                let mut rest = &mut *pixels;
                let mut targets = Vec::new();
                for place in &places {
                    let (here, behind) = std::mem::take(&mut rest).split_at_mut(place.words.len());
                    rest = behind;
                    let target = ImageMut::new(place.layout, bytemuck::cast_slice_mut(here))?;
                    targets.push(OutputTarget { output: place.output, target, transparent: self.transparent });
                }
                renderer.render_outputs(targets, region, &mut |_| !signals.has_come())
            });
            rendered.map_err(asked)?;
        } else {
            let of_scene = renderer.scene.camera.eye;
            for (eye, layout, begin) in self.eyes()? {
                if let Some(eye) = eye {
                    renderer.scene.camera.eye = eye;
                }
                let rendered = recovering(renderer, lost, |renderer| {
                    let bytes: &mut [u8] = bytemuck::cast_slice_mut(pixels);
                    let mut image = ImageMut::new(layout, bytes.get_mut(begin..).unwrap_or_default())?;
                    renderer.render(&mut image, self.transparent, region, &mut |_| !signals.has_come())
                });
                rendered.map_err(asked)?;
            }
            // Attributes are those of both eyes.
            renderer.scene.camera.eye = of_scene;
        }
        self.convert(pixels, &places)?;
        let whole = Region { full_width: width, full_height: height, x: 0, y: 0 };
        Ok(renderer.scene.made(&region.unwrap_or(whole)))
    }

    /// Brings the light of a frame into its colour space.
    fn convert(&self, pixels: &mut [u32], places: &[Place]) -> Result<(), Ending> {
        if self.space == ColourSpace::Rec709 {
            return Ok(());
        }
        for place in places.iter().filter(|place| place.output == Output::Light) {
            let words = pixels.get_mut(place.words.clone()).unwrap_or_default();
            let mut image = ImageMut::new(place.layout, bytemuck::cast_slice_mut(words))?;
            ColourSpace::Rec709.convert(&mut image, self.space)?;
        }
        Ok(())
    }

    /// Renders the moments of a frame and develops their mean.
    fn render_blurred(
        &self,
        (frame, shutter): (u32, Shutter),
        (pixels, places): (&mut [u32], &[Place]),
        renderer: &mut Renderer,
        lost: &mut u32,
        signals: &Signals,
    ) -> Result<(), Ending> {
        let asked = |ending| signals.check().err().unwrap_or(ending);
        renderer.begin_accumulation(self.size, self.transparent)?;
        for sample in 0..shutter.samples {
            let share = (f64::from(sample) + 0.5) / f64::from(shutter.samples);
            let (region, _) = self.show_at(f64::from(frame) + share * shutter.open, renderer)?;
            if region.is_some() {
                return Err(Ending::data(
                    "--shutter, --aperture: the scene has a region, and blurred frames are whole",
                ));
            }
            // The scene's own shutter would blur each of these moments once more.
            if shutter.open > 0.0 {
                renderer.scene.shutter = 0.0;
            }
            if let Some(lens) = shutter.lens {
                let camera = &mut renderer.scene.camera;
                // The hole's distance along the line of sight; its straight distance where it is not ahead.
                let ahead = -camera.position.dot(camera.forward.normalize());
                let focus = lens.focus.unwrap_or(if ahead > 0.0 { ahead } else { camera.position.length() });
                let [width, height] = self.size.map(f64::from);
                let lens = ThinLens { aperture: lens.aperture, focus, aspect: width / height };
                *camera = camera.through_lens(&lens, sample, shutter.samples)?;
            }
            let added = recovering(renderer, lost, |renderer| renderer.accumulate(1.0, &mut |_| !signals.has_come()));
            added.map_err(asked)?;
        }
        // The film is that of the frame's moment.
        self.show(frame, renderer)?;
        if shutter.open > 0.0 {
            renderer.scene.shutter = 0.0;
        }
        let layout = places.first().map_or_else(|| self.layout(), |place| place.layout);
        let mut image = ImageMut::new(layout, bytemuck::cast_slice_mut(pixels))?;
        Ok(renderer.end_accumulation(&mut image, self.transparent)?)
    }

    /// The pictures that are rendered of a frame.
    pub fn moments(&self) -> u32 {
        self.shutter.map_or(1, |shutter| shutter.samples)
    }

    /// Each eye's picture in the frame, and the byte at which it begins; one without an eye is all of it.
    fn eyes(&self) -> Result<Vec<(Option<Eye>, Layout, usize)>, Ending> {
        let (whole, one) = (self.layout(), self.eye_layout());
        let (bytes, row) = one.check()?;
        Ok(match self.stereo {
            None => vec![(None, whole, 0)],
            Some(Stereo::TopBottom) => vec![(Some(Eye::Left), one, 0), (Some(Eye::Right), one, bytes)],
            Some(Stereo::SideBySide) => {
                let one = Layout { row_stride: 2 * row as i64, ..one };
                vec![(Some(Eye::Left), one, 0), (Some(Eye::Right), one, row.unsigned_abs())]
            }
        })
    }

    /// Renders a frame small, into an image of its own, and not its outputs. Errors: as [`Self::render`].
    pub fn try_small(
        &self,
        frame: u32,
        small: Layout,
        renderer: &mut Renderer,
        signals: &Signals,
    ) -> Result<(), Ending> {
        self.show(frame, renderer)?;
        let (bytes, _) = small.check()?;
        let mut pixels = vec![0u32; bytes.div_ceil(4)];
        let mut image = ImageMut::new(small, bytemuck::cast_slice_mut(&mut pixels))?;
        let rendered = renderer.render(&mut image, self.transparent, None, &mut |_| !signals.has_come());
        signals.check()?;
        Ok(rendered?)
    }

    /// The parts of the whole sphere's width and height that are not in frames, from their left, top, right and bottom
    /// border; `None` where frames are no panoramas, as the first one tells. Errors: the scene's.
    pub fn panorama(&self, first: u32, renderer: &mut Renderer) -> Result<Option<[f64; 4]>, Ending> {
        let (region, size) = self.show(first, renderer)?;
        if renderer.scene.camera.projection != Projection::Equirect {
            return Ok(None);
        }
        let [width, height] = size.map(f64::from);
        Ok(Some(region.map_or([0.0; 4], |region| {
            let [full_width, full_height, x, y] =
                [region.full_width, region.full_height, region.x, region.y].map(f64::from);
            [x / full_width, y / full_height, 1.0 - (x + width) / full_width, 1.0 - (y + height) / full_height]
        })))
    }
}

impl Place {
    /// The image, in the pixels of its frame.
    pub fn image<'a>(&self, pixels: &'a [u32]) -> bhr::error::Result<ImageRef<'a>> {
        ImageRef::new(self.layout, bytemuck::cast_slice(pixels.get(self.words.clone()).unwrap_or_default()))
    }
}
