// SPDX-License-Identifier: MIT OR Apache-2.0
//! BhrFilm: how light becomes 8-bit pixels.

use super::call::on_context;
use super::context::BhrContext;
use super::entry::anywhere;
use super::pointer::{check_reserved, unknown};
use super::status::BhrStatus;
use super::versioned::{self, OutStruct, Versioned};
use crate::error::{Error, Result};
use crate::scene::{ColourMap, Film, ToneMap};

/// The curve from light to pixels.
pub type BhrToneMap = i32;
/// No curve: light above 1 is clipped.
pub const BHR_TONE_MAP_NONE: BhrToneMap = 0;
/// A filmic curve: the fit of ACES 1.0 by Stephen Hill (2015) after a factor 1 / 0.6, as three.js has it; middle grey,
/// 0.18, becomes 127 of 255.
pub const BHR_TONE_MAP_ACES: BhrToneMap = 1;
/// AgX (T. Sobotka, 2022), base look, with the primaries of Blender's, as three.js has it; middle grey becomes 128 of
/// 255, and bright saturated light goes to white with less shift of its hue than under ACES.
pub const BHR_TONE_MAP_AGX: BhrToneMap = 2;

/// The colours of a picture. Since 0.2.0.
pub type BhrColourMap = i32;
/// The picture has the colours of the light. Since 0.2.0.
pub const BHR_COLOUR_MAP_NONE: BhrColourMap = 0;
/// The map afmhot of matplotlib and gnuplot, in which the Event Horizon Telescope publishes its images: with s, the
/// luminance (Y of Rec. 709) of the exposed light after the tone map, 0 .. 1, red is 2 s, green 2 s - 1/2 and blue 2 s
/// - 1, each within 0 .. 1, in sRGB code values. With BHR_TONE_MAP_NONE s is linear in the light. Since 0.2.0.
pub const BHR_COLOUR_MAP_AFMHOT: BhrColourMap = 1;

/// How light becomes pixels. It applies to 8-bit formats and windows only, because float formats hold linear radiance;
/// and to BHR_VIEW_LIGHT only, because the other views show values. In this order: exposure, bloom, beam, tone map, the
/// sRGB curve or the colour map, dithering.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct BhrFilm {
    /// sizeof(BhrFilm).
    pub struct_size: u32,
    /// BHR_TONE_MAP_*. Default ACES.
    pub tone_map: BhrToneMap,
    /// Stops, -20 .. 20. Default 0.
    pub exposure_ev: f64,
    /// Glare: the share of the light that the eye's or a camera's optics scatter. 0 off .. 1, default 0.25. A pixel
    /// keeps 1 - 0.4 bloom of its light L, and the rest spreads: out = (1 - s) L + s (L * K), s = 0.4 bloom, where K,
    /// of integral 1, falls with the distance r as (r^2 + r0^2)^(-3/2) + (r^2 + r0^2)^-1 / r1, cut off smoothly about H
    /// / 4: the eye's 10 / theta^3 + 10 / theta^2 (Spencer et al., SIGGRAPH 1995) for a frame of height H seen from 2 H
    /// away, with r0 = H / 180, r1 = H / 28 = 1 degree. So it looks the same at every resolution. No light is lost:
    /// what would leave the frame is reflected at its border. Light is limited to 65504 after exposure. In transparent
    /// images glare is added light, and alpha stays coverage. Glare comes from the whole frame: with a region set,
    /// 8-bit images of light are INVALID_STATE when they are rendered; but where no bhr_set_film came after the context
    /// was made, or after the last bhr_set_preset, they are rendered without glare. It spreads over the
    /// picture, not over the sphere: in EQUIRECT and CUBE frames seams and faces' borders interrupt it. Frames above 25
    /// megapixels (12 on the CPU) are traced twice, as their light is not kept.
    pub bloom: f64,
    /// The full width at half maximum of a Gaussian that the picture is spread by, as by the beam of a telescope; in
    /// frame heights, 0 off (default) .. 1. In a PERSPECTIVE frame an angle w at its middle is w / (2 tan(fov_y / 2))
    /// heights. For how the Event Horizon Telescope saw M87*, take half the bright ring's diameter: the beam is
    /// 20 microarcseconds wide, the ring 42. What would leave the frame is mirrored at its border, and alpha is left
    /// alone. With a region set, 8-bit images of light are INVALID_STATE when they are rendered, also when a preset set
    /// the beam; EQUIRECT and CUBE frames and large ones are as for bloom. Beams of less than 7 pixels are not quite
    /// Gaussian, but of the right width. Since 0.2.0.
    pub beam_fwhm: f64,
    /// BHR_COLOUR_MAP_*. Default NONE. Since 0.2.0.
    pub colour_map: BhrColourMap,
    /// 0. Since 0.2.0.
    pub reserved: u32,
}

// SAFETY: repr(C), size first, no padding, numbers only.
unsafe impl Versioned for BhrFilm {
    const NAME: &'static str = "BhrFilm";
    const SIZES: &'static [usize] = &[24, 40];
    fn defaults() -> Self {
        Film::default().into()
    }
    fn defaults_of(size: usize) -> Self {
        // The plain film is that of 0.1.0, which had no glare unless a host asked for it.
        if size < size_of::<Self>() { Film::plain().into() } else { Self::defaults() }
    }
}

impl From<Film> for BhrFilm {
    fn from(film: Film) -> Self {
        Self {
            struct_size: 0,
            tone_map: film.tone_map as BhrToneMap,
            exposure_ev: film.exposure_ev,
            bloom: film.bloom,
            beam_fwhm: film.beam_fwhm,
            colour_map: film.colour_map as BhrColourMap,
            reserved: 0,
        }
    }
}

impl TryFrom<BhrFilm> for Film {
    type Error = Error;

    fn try_from(given: BhrFilm) -> Result<Self> {
        let tone_map = match given.tone_map {
            BHR_TONE_MAP_NONE => ToneMap::None,
            BHR_TONE_MAP_ACES => ToneMap::Aces,
            BHR_TONE_MAP_AGX => ToneMap::Agx,
            value => return unknown(value, "film tone_map", "BHR_TONE_MAP_NONE (0), _ACES (1), _AGX (2)"),
        };
        let colour_map = match given.colour_map {
            BHR_COLOUR_MAP_NONE => ColourMap::None,
            BHR_COLOUR_MAP_AFMHOT => ColourMap::Afmhot,
            value => return unknown(value, "film colour_map", "BHR_COLOUR_MAP_NONE (0), _AFMHOT (1)"),
        };
        check_reserved(given.reserved, "film")?;
        let (exposure_ev, bloom, beam_fwhm) = (given.exposure_ev, given.bloom, given.beam_fwhm);
        let film = Self { tone_map, exposure_ev, bloom, beam_fwhm, colour_map, glare_is_optional: false };
        film.check()?;
        Ok(film)
    }
}

/// Clears struct_size bytes and fills in the defaults. Any thread, inside callbacks too. Errors: INVALID_ARGUMENT
/// for NULL or a wrong struct_size.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_film_init(film: *mut BhrFilm, struct_size: usize) -> BhrStatus {
    // SAFETY: NULL or struct_size writable bytes, by the header's conventions.
    anywhere("bhr_film_init", || unsafe { versioned::init(film, "film", struct_size) })
}

/// Sets the film. Errors: INVALID_ARGUMENT for NULL, a number outside its range, an unknown tone map or colour map.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_set_film(context: *mut BhrContext, film: *const BhrFilm) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_context("bhr_set_film", context, |state| {
            state.renderer.scene.film = versioned::read(film, "film")?.try_into()?;
            Ok(())
        })
    }
}

/// The film as it is set. Errors: INVALID_ARGUMENT for NULL or a wrong struct_size.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_get_film(context: *const BhrContext, film: *mut BhrFilm) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let film = OutStruct::cleared(film, "film");
        on_context("bhr_get_film", context, |state| film.set(&state.renderer.scene.film.into()))
    }
}
