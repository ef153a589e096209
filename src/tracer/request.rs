// SPDX-License-Identifier: MIT OR Apache-2.0
//! Requests for a tracer: a frame, whose tiles go to a sink as they are finished. Knows no target.

use crate::error::{Error, Number, Result};
use crate::film::bloom::Bloom;
use crate::image::PixelFormat;
use crate::scene::{Region, Scene, View};

/// A part of the target, in its own pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tile {
    pub x: u32,
    pub y: u32,
    pub width: u32,
    pub height: u32,
}

/// A request for a frame: a width x height image, part of the frame that `region` describes.
#[derive(Clone, Copy, Debug)]
pub struct FrameRequest {
    pub width: u32,
    pub height: u32,
    pub region: Region,
    pub format: PixelFormat,
    /// Premultiplied alpha = 1 - the sky's share, sky left out.
    pub transparent: bool,
}

impl FrameRequest {
    /// The request for an image of the scene of such a size; `region` `None`: it is the whole frame. Errors: a region
    /// that the image overruns; a spin beyond those of frames; a region with bloom or a beam, or with a film that
    /// measures the frame; a format that does not go with the view.
    pub fn checked(
        scene: &Scene,
        format: PixelFormat,
        [width, height]: [u32; 2],
        transparent: bool,
        region: Option<Region>,
    ) -> Result<Self> {
        let (set, strips) = (region.is_some(), scene.camera.is_omnistereo());
        let region = region.unwrap_or(Region { full_width: width, full_height: height, x: 0, y: 0 });
        region.check_image(width, height)?;
        scene.hole.check_shown("a frame")?;
        let spreads = Bloom::is_shown(&scene.film, scene.view, format);
        let in_the_way = scene.film.needs_whole_frame().filter(|_| spreads && (set || strips));
        if let Some((name, light, value)) = in_the_way {
            return Err(Error::state(format!(
                "film {name} is {}: {light} comes from the whole frame, and {} is set; set no {}, or {name} 0",
                Number(value),
                if set { "a region" } else { "an eye" },
                if set { "region" } else { "eye" }
            )));
        }
        match (scene.view, format) {
            (View::Light, PixelFormat::R32F) => {
                return Err(Error::argument("format R32F holds views other than LIGHT; set another view or format"));
            }
            (View::Light, _) | (_, PixelFormat::R32F) => {}
            (view, format) if !format.is_developed() || format.is_hdr() => {
                let view = view.name();
                return Err(Error::argument(format!("view {view} goes into 8-bit formats or R32F, not {format}")));
            }
            _ => {}
        }
        Ok(Self { width, height, region, format, transparent })
    }

    /// Whether the image is the full frame.
    pub fn is_whole(&self) -> bool {
        let Region { full_width, full_height, x, y } = self.region;
        [full_width, full_height, x, y] == [self.width, self.height, 0, 0]
    }
}

/// Takes a finished tile: packed pixels, rows `bytes_per_row` apart. Runs on a thread of the tracer's, if that has one.
pub type TileSink<'a> = dyn FnMut(Tile, &[u8], usize) -> Result<()> + Send + 'a;

/// Takes a finished tile of one of several outputs, which its index tells; else as [`TileSink`].
pub type OutputSink<'a> = dyn FnMut(usize, Tile, &[u8], usize) -> Result<()> + Send + 'a;

/// Hears how much of the frame is done, 0 .. 1; false cancels. Runs on the thread that asked for the frame.
pub type Progress<'a> = dyn FnMut(f64) -> bool + 'a;
