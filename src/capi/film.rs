//! BhrFilm: how light becomes 8-bit pixels.

use super::call::on_context;
use super::context::BhrContext;
use super::entry::anywhere;
use super::pointer::unknown;
use super::status::BhrStatus;
use super::versioned::{self, OutStruct, Versioned};
use crate::error::{Error, Result};
use crate::scene::{Film, ToneMap};

/// The curve from light to pixels.
pub type BhrToneMap = i32;
/// No curve: light above 1 is clipped.
pub const BHR_TONE_MAP_NONE: BhrToneMap = 0;
/// A filmic curve after ACES.
pub const BHR_TONE_MAP_ACES: BhrToneMap = 1;
/// The AgX curve.
pub const BHR_TONE_MAP_AGX: BhrToneMap = 2;

/// How light becomes pixels. It applies to 8-bit formats and windows only, because float formats hold linear radiance;
/// and to BHR_VIEW_LIGHT only, because the other views show values. In this order: exposure, bloom, tone map, the sRGB
/// curve, dithering.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct BhrFilm {
    /// sizeof(BhrFilm).
    pub struct_size: u32,
    /// BHR_TONE_MAP_*. Default ACES.
    pub tone_map: BhrToneMap,
    /// Stops, -20 .. 20. Default 0.
    pub exposure_ev: f64,
    /// Glare: the share of the light that the eye's or a camera's optics scatter. 0 off (default) .. 1. A pixel keeps
    /// 1 - 0.4 bloom of its light L, and the rest spreads: out = (1 - s) L + s (L * K), s = 0.4 bloom, where K, of
    /// integral 1, falls with the distance r as (r^2 + r0^2)^(-3/2) + (r^2 + r0^2)^-1 / r1, cut off smoothly about
    /// H / 4: the eye's 10 / theta^3 + 10 / theta^2 (Spencer et al., SIGGRAPH 1995) for a frame of height H seen from
    /// 2 H away, with r0 = H / 180, r1 = H / 28 = 1 degree. So it looks the same at every resolution. No light is
    /// lost: what would leave the frame is reflected at its border. Light is limited to 65504 after exposure. In
    /// transparent images glare is added light, and alpha stays coverage. Glare comes from the whole frame: with a
    /// region set, 8-bit images of light are INVALID_STATE when they are rendered. It spreads over the picture, not
    /// over the sphere: in EQUIRECT and CUBE frames seams and faces' borders interrupt it. Frames above 25 megapixels
    /// (12 on the CPU) are traced twice, as their light is not kept.
    pub bloom: f64,
}

// SAFETY: repr(C), size first, no padding, numbers only.
unsafe impl Versioned for BhrFilm {
    const NAME: &'static str = "BhrFilm";
    const SIZES: &'static [usize] = &[24];
    fn defaults() -> Self {
        Film::default().into()
    }
}

impl From<Film> for BhrFilm {
    fn from(film: Film) -> Self {
        Self { struct_size: 0, tone_map: film.tone_map as BhrToneMap, exposure_ev: film.exposure_ev, bloom: film.bloom }
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
        let film = Self { tone_map, exposure_ev: given.exposure_ev, bloom: given.bloom };
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

/// Sets the film. Errors: INVALID_ARGUMENT for NULL, a number outside its range, an unknown tone map.
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
