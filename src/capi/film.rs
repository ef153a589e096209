// SPDX-License-Identifier: MIT OR Apache-2.0
//! BhrFilm: how light becomes 8-bit pixels.

use super::call::on_context;
use super::context::BhrContext;
use super::entry::anywhere;
use super::image::path_of;
use super::pointer::{check_reserved, is_null, unknown};
use super::state::State;
use super::status::BhrStatus;
use super::versioned::{self, OutStruct, Versioned};
use crate::error::{Error, Result};
use crate::image::{Lut, LutFile};
use crate::scene::{AutoExposure, ColourMap, Film, Filmic, Grade, Optics, ToneMap};
use std::ffi::c_char;
use std::mem::offset_of;
use std::sync::Arc;

/// The curve from light to pixels.
pub type BhrToneMap = i32;
/// No curve: light above 1 is clipped.
pub const BHR_TONE_MAP_NONE: BhrToneMap = 0;
/// A filmic curve, the fit of ACES 1.0 by Stephen Hill; middle grey, 0.18, becomes 127 of 255.
pub const BHR_TONE_MAP_ACES: BhrToneMap = 1;
/// AgX, base look; middle grey becomes 128 of 255, and bright saturated light shifts its hue less than under ACES.
pub const BHR_TONE_MAP_AGX: BhrToneMap = 2;
/// A filmic curve with settings, John Hable's of three powers: `toe_strength` to `shoulder_angle`. @since 0.2.0
pub const BHR_TONE_MAP_FILMIC: BhrToneMap = 3;

/// The colours of a picture. @since 0.2.0
pub type BhrColourMap = i32;
/// The picture has the colours of the light.
pub const BHR_COLOUR_MAP_NONE: BhrColourMap = 0;
/// The map afmhot, in which the Event Horizon Telescope publishes its images, of the luminance after the tone map:
/// red 2 s, green 2 s - 1/2, blue 2 s - 1, each within 0 .. 1, in sRGB code values. With BHR_TONE_MAP_NONE s is
/// linear in the light.
pub const BHR_COLOUR_MAP_AFMHOT: BhrColourMap = 1;

/// How light becomes pixels, in formats of 8 and 10 bits and windows of BHR_VIEW_LIGHT only: float formats hold
/// linear radiance, and other views show values. In this order: exposure, bloom, beam, flare, spikes and streak,
/// auto exposure, highlights and shadows, vignette, white balance, contrast, saturation, grain, tone map, the sRGB
/// curve and the LUT, or the colour map, dithering.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct BhrFilm {
    /// sizeof(BhrFilm).
    pub struct_size: u32,
    /// BHR_TONE_MAP_*. Default ACES.
    pub tone_map: BhrToneMap,
    /// Stops, -20 .. 20. Default 0.
    pub exposure_ev: f64,
    /// Glare, 0 .. 1, 0 off, default 0.25: optics scatter 0.4 bloom of each pixel's light over its surroundings, alike
    /// at every resolution. No light is lost, and transparent images keep their alpha. With a region set, 8- and 10-bit
    /// images of light are INVALID_STATE when they are rendered; but where no bhr_set_film came after the context
    /// was made, or after the last bhr_set_preset, they are rendered without glare. docs/colour-and-film.md.
    pub bloom: f64,
    /// The full width at half maximum of a Gaussian that the picture is spread by, as by a telescope's beam; in
    /// frame heights, 0 .. 1, 0 off (default). Alpha is left alone. With a region set, 8- and 10-bit images of
    /// light are INVALID_STATE when they are rendered, also when a preset set the beam.
    /// docs/colour-and-film.md. @since 0.2.0
    pub beam_fwhm: f64,
    /// BHR_COLOUR_MAP_*. Default NONE. @since 0.2.0
    pub colour_map: BhrColourMap,
    /// Blades of the lens's aperture, 3 .. 8: an even number of them makes as many spikes, an odd one twice as many.
    /// 0, the default, stands for 6. @since 0.2.0
    pub spike_blades: u32,
    /// Kelvin, 1667 .. 25000, of the blackbody whose light is to look white: the lower, the bluer the picture. Default
    /// 0: colours stay as they are. @since 0.2.0
    pub white_balance: f64,
    /// -1 .. 1: the picture turns towards magenta above 0, towards green below. Default 0. The light that is to look
    /// white has a Duv of 0.02 tint (CIE 1960): above 0 it is greener than a blackbody's. @since 0.2.0
    pub tint: f64,
    /// 0.25 .. 4, the exponent of light; light of 0.18, middle grey, stays as it is. Default 1. @since 0.2.0
    pub contrast: f64,
    /// 0 .. 4, a factor on how far colours are from the grey of their luminance; 0 is grey. Default 1. @since 0.2.0
    pub saturation: f64,
    /// FILMIC, 0 .. 1: at 0 dark light stays linear, at 1 all of the toe, the curve's dark end, is black. Default 0.5.
    /// @since 0.2.0
    pub toe_strength: f64,
    /// FILMIC: 0 .. 1; the toe ends at light toe_length^2.2 / 2. Default 0.5. @since 0.2.0
    pub toe_length: f64,
    /// FILMIC: stops, 0 .. 16; light from about 2^shoulder_strength on is white. Default 2. @since 0.2.0
    pub shoulder_strength: f64,
    /// FILMIC, 0 .. 1: the share that the shoulder, the curve's bright end, has of all that is above the toe. Default
    /// 0.5. @since 0.2.0
    pub shoulder_length: f64,
    /// FILMIC: how steep the shoulder still is at white, 0 .. 1; at 0 it ends flat. Default 1. @since 0.2.0
    pub shoulder_angle: f64,
    /// 0 .. 1, the share of a lens' natural darkening, cos^4 of an angle whose tangent is 1 in the corners of the whole
    /// frame: at 1, light is a quarter there. Default 0. @since 0.2.0
    pub vignette: f64,
    /// Auto exposure, 0 .. 1: how far the exposure goes to where auto_percentile is auto_target. Default 0: off. The
    /// frame's luminance is measured after exposure_ev and bloom, in small cells; cells darker than 2^-16 do not count.
    /// exposure_ev is taken back by it: auto_target is what makes the picture brighter. bhr_frame_stats has what was
    /// added. With a region set, 8- and 10-bit images of light are INVALID_STATE when they are rendered. @since 0.2.0
    pub auto_exposure: f64,
    /// The percentile of the frame's luminance that auto exposure goes by, 0 .. 100. Default 90. @since 0.2.0
    pub auto_percentile: f64,
    /// The luminance that auto exposure brings the percentile to, 0.001 .. 1000; middle grey is 0.18. Default 0.5.
    /// @since 0.2.0
    pub auto_target: f64,
    /// The least that auto exposure adds, stops, -20 .. 20. Default -8. @since 0.2.0
    pub auto_least_ev: f64,
    /// The most that auto exposure adds, stops, -20 .. 20. Default 8. If it is below auto_least_ev, this is what is
    /// added. @since 0.2.0
    pub auto_most_ev: f64,
    /// 0.000001 .. 1: the share of the way that a frame goes from the exposure of the last frame of its size that this
    /// context measured. Default 1: all of it, so that a picture depends on its scene alone. For frames t apart and a
    /// time constant T it is 1 - exp(-t / T). @since 0.2.0
    pub auto_adaptation: f64,
    /// Local tone mapping, 0 .. 1: how much nearer to middle grey, by the logarithm, bright parts of the
    /// picture come; their structure stays. Default 0: off. With a region set, 8- and 10-bit images of light
    /// are INVALID_STATE when they are rendered. @since 0.2.0
    pub highlights: f64,
    /// Local tone mapping, 0 .. 1: how much nearer to middle grey, by the logarithm, dark parts of the picture come.
    /// Default 0: off. Black stays black, but glare over it is lifted like other light: use less bloom with it. With a
    /// region set, 8- and 10-bit images of light are INVALID_STATE when they are rendered. @since 0.2.0
    pub shadows: f64,
    /// Grain, 0 .. 1: light varies at random from place to place, with a standard deviation of 0.25 grain of itself.
    /// Default 0: off. The mean light stays. Its cells are a 1080th of the frame's height wide, but no smaller than a
    /// pixel. @since 0.2.0
    pub grain: f64,
    /// Any number within +-1e15: each is another grain, for instance that of a film's frame. Default 0. @since 0.2.0
    pub grain_seed: f64,
    /// 0 .. 1, the share of the colours that the LUT of bhr_set_film_lut has in the picture; 0 off. Default 1.
    /// @since 0.2.0
    pub lut_strength: f64,
    /// Diffraction spikes, 0 .. 1, 0 off (default): the lens throws 0.4 spikes of each pixel's light along
    /// lines that lie across the edges of the aperture's blades; they are reddish. No light is lost. With a
    /// region set, 8- and 10-bit images of light are INVALID_STATE when they are rendered.
    /// docs/colour-and-film.md. @since 0.2.0
    pub spikes: f64,
    /// The direction of one spike, radians anticlockwise from upright, -2 pi .. 2 pi. Default 0. @since 0.2.0
    pub spike_angle: f64,
    /// In frame heights, 0.01 .. 2: the length of the spikes' faint tails, which fall off by exp(-distance /
    /// spike_length). Default 0.25. @since 0.2.0
    pub spike_length: f64,
    /// The horizontal streak of an anamorphic lens, 0 .. 1, 0 off (default): 0.4 streak of each pixel's light
    /// is thrown to its left and right. No light is lost. With a region set, 8- and 10-bit images of light are
    /// INVALID_STATE when they are rendered. docs/colour-and-film.md. @since 0.2.0
    pub streak: f64,
    /// In frame heights, 0.01 .. 4: the length of the streak's tails, which fall off by exp(-distance / streak_length).
    /// Default 0.5. @since 0.2.0
    pub streak_length: f64,
    /// The streak's colour, -1 .. 1: -1 is amber, 0 that of the light, 1 blue. Default 0. @since 0.2.0
    pub streak_tint: f64,
    /// BHR_FORMAT_RGB10A2_*: what the display shows for light of 1, diffuse white; cd/m^2, 10 .. 1000. Default 203,
    /// as in ITU-R BT.2408. @since 0.2.0
    pub paper_white: f64,
    /// BHR_FORMAT_RGB10A2_*: the brightest that the display shows, cd/m^2, 100 .. 10000, to which brighter light is
    /// rolled off. Default 1000. @since 0.2.0
    pub peak: f64,
    /// Lens flare, 0 .. 1, 0 off (default): the lens reflects 0.15 flare of each pixel's light into ghosts, blurred
    /// images of its aperture (spike_blades, spike_angle) in several colours, on the line from that pixel through the
    /// middle of the frame. Ghosts of lights near the border are faint: that light is lost, no other. With a region
    /// set, 8- and 10-bit images of light are INVALID_STATE when they are rendered. docs/colour-and-film.md.
    /// @since 0.2.0
    pub flare: f64,
    /// How many ghosts each light has, 0 .. 8; 0, the default, stands for 5. @since 0.2.0
    pub flare_ghosts: u32,
    /// Reserved: 0. @since 0.2.0
    pub reserved: u32,
}

// SAFETY: repr(C), size first, no padding, numbers only.
unsafe impl Versioned for BhrFilm {
    const NAME: &'static str = "BhrFilm";
    const SIZES: &'static [usize] = &[24, 288];
    fn defaults() -> Self {
        Film::default().into()
    }
    fn defaults_of(size: usize) -> Self {
        // The plain film is that of 0.1.0, which had no glare unless a host asked for it.
        if size < offset_of!(Self, white_balance) { Film::plain().into() } else { Self::defaults() }
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
            spike_blades: film.optics.spike_blades,
            white_balance: film.grade.white_balance,
            tint: film.grade.tint,
            contrast: film.grade.contrast,
            saturation: film.grade.saturation,
            toe_strength: film.filmic.toe_strength,
            toe_length: film.filmic.toe_length,
            shoulder_strength: film.filmic.shoulder_strength,
            shoulder_length: film.filmic.shoulder_length,
            shoulder_angle: film.filmic.shoulder_angle,
            vignette: film.grade.vignette,
            auto_exposure: film.auto_exposure.strength,
            auto_percentile: film.auto_exposure.percentile,
            auto_target: film.auto_exposure.target,
            auto_least_ev: film.auto_exposure.least_ev,
            auto_most_ev: film.auto_exposure.most_ev,
            auto_adaptation: film.auto_exposure.adaptation,
            highlights: film.highlights,
            shadows: film.shadows,
            grain: film.grade.grain,
            grain_seed: film.grade.grain_seed,
            lut_strength: film.lut_strength,
            spikes: film.optics.spikes,
            spike_angle: film.optics.spike_angle,
            spike_length: film.optics.spike_length,
            streak: film.optics.streak,
            streak_length: film.optics.streak_length,
            streak_tint: film.optics.streak_tint,
            paper_white: film.paper_white,
            peak: film.peak,
            flare: film.optics.flare,
            flare_ghosts: film.optics.flare_ghosts,
            reserved: 0,
        }
    }
}

impl TryFrom<BhrFilm> for Film {
    type Error = Error;

    fn try_from(given: BhrFilm) -> Result<Self> {
        check_reserved(given.reserved, "film")?;
        let tone_map = match given.tone_map {
            BHR_TONE_MAP_NONE => ToneMap::None,
            BHR_TONE_MAP_ACES => ToneMap::Aces,
            BHR_TONE_MAP_AGX => ToneMap::Agx,
            BHR_TONE_MAP_FILMIC => ToneMap::Filmic,
            value => {
                return unknown(value, "film tone_map", "BHR_TONE_MAP_NONE (0), _ACES (1), _AGX (2), _FILMIC (3)");
            }
        };
        let colour_map = match given.colour_map {
            BHR_COLOUR_MAP_NONE => ColourMap::None,
            BHR_COLOUR_MAP_AFMHOT => ColourMap::Afmhot,
            value => return unknown(value, "film colour_map", "BHR_COLOUR_MAP_NONE (0), _AFMHOT (1)"),
        };
        let (exposure_ev, bloom, beam_fwhm) = (given.exposure_ev, given.bloom, given.beam_fwhm);
        let grade = Grade {
            white_balance: given.white_balance,
            tint: given.tint,
            contrast: given.contrast,
            saturation: given.saturation,
            vignette: given.vignette,
            grain: given.grain,
            grain_seed: given.grain_seed,
        };
        let filmic = Filmic {
            toe_strength: given.toe_strength,
            toe_length: given.toe_length,
            shoulder_strength: given.shoulder_strength,
            shoulder_length: given.shoulder_length,
            shoulder_angle: given.shoulder_angle,
        };
        let auto_exposure = AutoExposure {
            strength: given.auto_exposure,
            percentile: given.auto_percentile,
            target: given.auto_target,
            least_ev: given.auto_least_ev,
            most_ev: given.auto_most_ev,
            adaptation: given.auto_adaptation,
        };
        let (highlights, shadows) = (given.highlights, given.shadows);
        let optics = Optics {
            spikes: given.spikes,
            spike_blades: given.spike_blades,
            spike_angle: given.spike_angle,
            spike_length: given.spike_length,
            streak: given.streak,
            streak_length: given.streak_length,
            streak_tint: given.streak_tint,
            flare: given.flare,
            flare_ghosts: given.flare_ghosts,
        };
        let film = Self {
            tone_map,
            exposure_ev,
            bloom,
            beam_fwhm,
            colour_map,
            grade,
            filmic,
            auto_exposure,
            highlights,
            shadows,
            lut_strength: given.lut_strength,
            optics,
            paper_white: given.paper_white,
            peak: given.peak,
            glare_is_optional: false,
        };
        film.check()?;
        Ok(film)
    }
}

/// Fills in the defaults.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_film_init(film: *mut BhrFilm, struct_size: usize) -> BhrStatus {
    // SAFETY: NULL or struct_size writable bytes, by the header's conventions.
    anywhere("bhr_film_init", || unsafe { versioned::init(film, "film", struct_size) })
}

/// Sets the film.
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

/// Reads the film as it is set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_get_film(context: *const BhrContext, film: *mut BhrFilm) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let film = OutStruct::cleared(film, "film");
        on_context("bhr_get_film", context, |state| film.set(&state.renderer.scene.film.into()))
    }
}

/// Gives the film a LUT, a table of colours, copied before return: side^3 nodes of red, green and blue, red changing
/// fastest, spread evenly over sRGB-encoded colours from 0 to 1, which become the nodes' colours, by tetrahedral
/// interpolation between them, limited to 0 .. 1. side: 2 .. 65; count = 3 side^3, the number of floats; 0 takes the
/// LUT away, and then nodes may be NULL. It works where the film does, but with no colour map, and stays when film or
/// preset change. Black becomes what the LUT has for it, in transparent images as well. Memory: 16 bytes a node in the
/// context and on the device. docs/colour-and-film.md.
/// Errors: INVALID_ARGUMENT also for a node that is not finite; the LUT is then as it was. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_set_film_lut(
    context: *mut BhrContext,
    nodes: *const f32,
    count: usize,
    side: u32,
) -> BhrStatus {
    // SAFETY: NULL or count floats, by the header's conventions.
    unsafe {
        on_context("bhr_set_film_lut", context, |state| {
            let lut = match count {
                0 => None,
                _ if nodes.is_null() => return Err(is_null("nodes")),
                _ => {
                    // The host's memory is read once side and count fit.
                    let numbers = (0..count).map(|index| nodes.add(index).read_unaligned());
                    Some(Arc::new(Lut::new(side, numbers)?))
                }
            };
            (state.renderer.scene.film_lut, state.files.lut) = (lut, None);
            Ok(())
        })
    }
}

/// Gives the film the LUT in a .cube file (Adobe's Cube LUT Specification 1.0), as bhr_set_film_lut does one in
/// memory; over its DOMAIN_MIN and DOMAIN_MAX, or LUT_3D_INPUT_RANGE, beyond which colours become those at the edge.
/// The path is kept, so that bhr_scene_save can name it; a file that is given again and has not changed is not read
/// again.
/// Errors, after which the LUT is as it was: IO, with the line, for a file that is not there, not readable, not UTF-8,
/// larger than 32 MiB, or no LUT of three dimensions and 2 to 65 nodes a side. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_set_film_lut_file(context: *mut BhrContext, path: *const c_char) -> BhrStatus {
    // SAFETY: NULL or a C string, by the header's conventions.
    unsafe {
        on_context("bhr_set_film_lut_file", context, |state| {
            let path = path_of(path)?;
            let path = std::path::absolute(&path).unwrap_or(path);
            let lut = LutFile::load(&path, state.files.lut.as_ref())?;
            show_lut(state, Some(lut));
            Ok(())
        })
    }
}

/// Shows the LUT of a file, or none.
pub(super) fn show_lut(state: &mut State, lut: Option<LutFile>) {
    state.renderer.scene.film_lut = lut.as_ref().map(|lut| lut.value().clone());
    state.files.lut = lut;
}
