// SPDX-License-Identifier: MIT OR Apache-2.0
//! A frame of several outputs into the host's memory: the picture, views that take rays of their own, and, all in one
//! pass, the numbers of the rays through pixels' centres. Knows no threads and nothing of C.

use crate::error::{Error, ErrorKind, Result};
use crate::image::{ImageMut, PixelFormat};
use crate::scene::{Output, RayOutput, Region, Scene};
use crate::tracer::{FrameRequest, FrameStats, Progress, Tile};
use crate::tracers::Tracer;

/// An output and the image that it goes to.
pub struct OutputTarget<'a> {
    pub output: Output,
    pub target: ImageMut<'a>,
    /// For LIGHT, as in [`FrameRequest`].
    pub transparent: bool,
}

/// The outputs of one frame, all of one size.
pub struct OutputFrame<'a> {
    targets: Vec<OutputTarget<'a>>,
    region: Region,
}

/// The numbers that outputs take are packed as pixels of this format, or of R32F.
const VALUES: PixelFormat = PixelFormat::Rgba32F;

impl<'a> OutputFrame<'a> {
    /// `targets` are of one size, and in the formats of their outputs.
    pub fn new(targets: Vec<OutputTarget<'a>>, region: Region) -> Self {
        Self { targets, region }
    }

    /// The part of the full frame.
    pub fn region(&self) -> Region {
        self.region
    }

    /// Columns and rows of each image.
    pub fn size(&self) -> [u32; 2] {
        self.targets.first().map_or([0, 0], |first| [first.target.width(), first.target.height()])
    }

    /// The images that are written.
    pub fn images(&self) -> impl Iterator<Item = &ImageMut<'a>> {
        self.targets.iter().map(|target| &target.target)
    }

    /// The picture itself is among them.
    pub fn has_light(&self) -> bool {
        self.targets.iter().any(|target| target.output == Output::Light)
    }

    /// A pixel was written.
    pub fn is_touched(&self) -> bool {
        self.targets.iter().any(|target| target.target.is_touched())
    }

    /// Renders one after the other. Errors: as `Renderer::render`.
    pub fn render(&mut self, tracer: &mut Tracer, scene: &Scene, progress: &mut Progress<'_>) -> Result<FrameStats> {
        let of_rays = |target: &OutputTarget<'_>| match target.output {
            Output::Ray(output) => Some(output),
            Output::Light | Output::View(_) => None,
        };
        let asked = self.targets.iter().filter_map(of_rays).collect::<Vec<RayOutput>>();
        let parts = self.targets.len() - asked.len() + usize::from(!asked.is_empty());
        let mut stats = FrameStats::default();
        let mut done = 0;
        let region = self.region;
        for OutputTarget { output, target, transparent } in &mut self.targets {
            let viewed = match output {
                Output::Light => None,
                Output::View(view) => Some(Scene { view: *view, ..scene.clone() }),
                Output::Ray(_) => continue,
            };
            let request = request_of(target, region, target.format(), *transparent);
            let mut sink = |tile: Tile, pixels: &[u8], row_bytes: usize| {
                target.write_tile(tile.x, tile.y, tile.width, tile.height, pixels, row_bytes)
            };
            let scene = viewed.as_ref().unwrap_or(scene);
            let rendered = tracer.render(scene, &request, &mut sink, &mut part(progress, done, parts));
            stats.add(&rendered?);
            done += 1;
            check_goes_on(progress, done, parts)?;
        }
        let mut targets =
            self.targets.iter_mut().filter(|target| of_rays(target).is_some()).map(|target| &mut target.target);
        let mut targets = targets.by_ref().collect::<Vec<_>>();
        if let Some(first) = targets.first() {
            let request = request_of(first, region, VALUES, false);
            let mut sink = |index: usize, tile: Tile, pixels: &[u8], row_bytes: usize| {
                let target = targets.get_mut(index).ok_or_else(|| Error::internal("an output without an image"))?;
                target.write_tile(tile.x, tile.y, tile.width, tile.height, pixels, row_bytes)
            };
            let scene = scene.for_outputs(&asked);
            let progress = &mut part(progress, done, parts);
            stats.add(&tracer.render_outputs(&scene, &request, &asked, &mut sink, progress)?);
        }
        Ok(stats)
    }
}

fn request_of(target: &ImageMut<'_>, region: Region, format: PixelFormat, transparent: bool) -> FrameRequest {
    FrameRequest { width: target.width(), height: target.height(), region, format, transparent }
}

/// Tells `progress` of the part after `done` of `parts`; the last word is the whole's.
fn part<'a>(progress: &'a mut Progress<'_>, done: usize, parts: usize) -> impl FnMut(f64) -> bool + 'a {
    move |fraction| fraction >= 1.0 && done + 1 < parts || progress((done as f64 + fraction) / parts as f64)
}

/// Errors: CANCELLED between two parts.
fn check_goes_on(progress: &mut Progress<'_>, done: usize, parts: usize) -> Result<()> {
    if done < parts && !progress(done as f64 / parts as f64) {
        return Err(Error::new(ErrorKind::Cancelled, "the progress callback cancelled the outputs"));
    }
    Ok(())
}
