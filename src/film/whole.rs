// SPDX-License-Identifier: MIT OR Apache-2.0
//! Develops the light of a whole frame that lies in memory: glare, metering and pixels, as the tracers do with what
//! they trace. Knows nothing of how light was made, or of hosts' images.

use super::bloom::Bloom;
use super::metering::{MeterParams, SpreadLight};
use super::{FilmParams, develop_row};
use crate::allocate::{collected, filled};
use crate::error::Result;
use crate::image::{Lut, PixelFormat};
use crate::parallel::prelude::*;
use crate::scene::{Film, View};

/// Rows that are developed at a time.
const ROWS: usize = 64;
/// The name of this memory in out-of-memory errors.
const LIGHT: &str = "the light of rows that are developed";

/// Takes rows of packed pixels, by their first one.
pub type RowSink<'a> = dyn FnMut(u32, &[u8]) -> Result<()> + 'a;

/// Develops `light`, rows of `width`, with a LUT (`Scene::shown_lut`); the stops that auto exposure added. On the
/// current pool. Errors: OUT_OF_MEMORY; those of the sink.
pub fn develop_whole(
    (film, lut): (&Film, Option<&Lut>),
    (format, transparent): (PixelFormat, bool),
    [width, height]: [u32; 2],
    light: &[[f32; 4]],
    sink: &mut RowSink<'_>,
) -> Result<f64> {
    let params = FilmParams::new(film, View::Light, format, transparent).over_frame(width, height).with_lut(lut, film);
    let bands = || light.chunks(ROWS * width as usize).zip((0..height).step_by(ROWS));
    let mut pixels = Vec::new();
    let mut deliver = |params: &FilmParams, y: u32, light: &[[f64; 4]]| {
        let row_bytes = width as usize * format.bytes_per_pixel();
        let bytes = light.len() / width as usize * row_bytes;
        if pixels.len() < bytes {
            pixels = filled(bytes, 0, "the pixels of rows that are developed")?;
        }
        let rows = pixels[..bytes].par_chunks_mut(row_bytes).zip(light.par_chunks(width as usize));
        rows.zip(y..height).for_each(|((out, light), y)| develop_row(params, lut, light, 0, y, out));
        sink(y, &pixels[..bytes])
    };
    if !Bloom::is_shown(film, View::Light, format) {
        for (light, y) in bands() {
            deliver(&params, y, &collected(light.iter().map(|light| light.map(f64::from)), LIGHT)?)?;
        }
        return Ok(0.0);
    }
    let bloom = Bloom::of(film, [width, height])?;
    let exposed =
        |light: &[[f32; 4]]| collected(light.iter().map(|light| params.exposed_light(light.map(f64::from))), LIGHT);
    let mut accumulator = bloom.accumulator()?;
    for (light, y) in bands() {
        accumulator.add([0, y], width, &exposed(light)?);
    }
    let spread = SpreadLight::new(accumulator, MeterParams::new(film, &bloom), None)?;
    for (light, y) in bands() {
        let mut with_glare = filled(light.len(), [0.0; 4], LIGHT)?;
        let rows = with_glare.par_chunks_mut(width as usize).zip(light.par_chunks(width as usize));
        rows.zip(y..height).for_each(|((out, light), y)| {
            for ((out, light), x) in out.iter_mut().zip(light).zip(0..) {
                *out = spread.over(params.exposed_light(light.map(f64::from)), x, y).map(f64::from);
            }
        });
        deliver(&params.of_exposed(), y, &with_glare)?;
    }
    Ok(spread.stops().map_or(0.0, f64::from))
}
