// SPDX-License-Identifier: MIT OR Apache-2.0
//! BHR_PRESET_*: named looks.

use super::call::on_context;
use super::context::BhrContext;
use super::entry::anywhere;
use super::pointer::{Out, unknown};
use super::status::BhrStatus;
use super::versioned::{self, Versioned};
use crate::error::{Error, Number, Result};
use crate::renderer::MatterChoice;
use crate::scene::{Preset, PresetMatter, Region};

/// A named look: values for disk, sky, film and effects that setters can then change. Since 0.2.0.
///
/// Each preset sets all of BhrDisk, all of BhrFilm, the effects, and flags and brightness of BhrSky. Hole, camera,
/// hot spots, time, view, quality, region, and the sky's orientation, seed and map stay as they are: a host that shows
/// its own map sets BHR_SKY_MAP again. bhr_set_preset_with can also show matter with depth, a volume, in place of the
/// thin disk. An empty cell has the first column's value.
///
/// ```text
/// field                  if empty     CINEMATIC    PHYSICAL     OBSERVATORY  TEACHING
/// disk.flags             0
/// disk.inner_radius      0 (ISCO)
/// disk.outer_radius      20           17                        12           12
/// disk.temperature       6500         3500                      15000        5000
/// disk.opacity           1
/// disk.brightness        1            0.6                                    0.6
/// disk.turbulence        0            1
/// disk.seed              0
/// disk.reference         AT_MEDIAN
/// disk.emission_law      ISOTROPIC
/// disk.edge_softness     0            0.4
/// sky.flags              STARS        STARS        STARS        0            GRID
///                        | MILKY_WAY  | MILKY_WAY  | MILKY_WAY
/// sky.stars_brightness   1
/// sky.map_brightness     1
/// film.tone_map          ACES                      NONE         NONE         NONE
/// film.exposure_ev       0                         -2           -0.5
/// film.bloom             0            0.25
/// film.beam_fwhm         0                                      0.15
/// film.colour_map        NONE                                   AFMHOT
/// effects                ALL                                                 DOPPLER_SHIFT | GRAVITY_SHIFT
/// ```
pub type BhrPreset = i32;
/// The default: a golden disk with structure and soft edges, its approaching side nearly white, and glare, as a film
/// would show it. Since 0.2.0.
pub const BHR_PRESET_CINEMATIC: BhrPreset = 0;
/// As a physicist expects it: a smooth disk, no glare, no tone curve; light is shown as it is, two stops down, until it
/// clips. Since 0.2.0.
pub const BHR_PRESET_PHYSICAL: BhrPreset = 1;
/// As the Event Horizon Telescope shows its sources: a ring blurred by a Gaussian beam, its luminance in one colour
/// map, on a black sky. The beam is about half the bright ring's diameter, as for M87*, where that ring is 0.3 of the
/// frame's height: 30 M away at a fov_y of 60 degrees. M87* is seen from 73 degrees above the disk's
/// plane. Since 0.2.0.
pub const BHR_PRESET_OBSERVATORY: BhrPreset = 2;
/// For lessons: a grid on the sky, which shows the lensing, and a smooth disk whose colours are those of the frequency
/// shifts, but which motion makes neither brighter nor darker: beaming and light delay are off. Since 0.2.0.
pub const BHR_PRESET_TEACHING: BhrPreset = 3;

/// The matter that bhr_set_preset_with shows. Since 0.2.0.
pub type BhrPresetMatter = i32;
/// DEEP where the adapter is fast enough for it, else THIN. Since 0.2.0.
pub const BHR_PRESET_MATTER_AUTO: BhrPresetMatter = 0;
/// The thin disk, as bhr_set_preset. Since 0.2.0.
pub const BHR_PRESET_MATTER_THIN: BhrPresetMatter = 1;
/// One volume instead of the disk; sky, film and effects are as BhrPreset states. An empty cell has the first column's
/// value, and every field of BhrVolume that is not here that of bhr_volume_init. TEACHING, whose colours are the
/// frequency shifts of one plane, has no such look and stays THIN. Since 0.2.0.
///
/// ```text
/// field                     if empty     CINEMATIC    PHYSICAL     OBSERVATORY
/// volume.flags              0                                      POWER_LAW
/// volume.shape              DISK                                   TORUS
/// volume.inner_radius       0 (ISCO)
/// volume.outer_radius       17                                     20
/// volume.radius             8                                      5
/// volume.width              2
/// volume.thickness          0.05                                   0.4
/// volume.slope              0.7
/// volume.absorption         3                                      0.05
/// volume.temperature        4800                      9000
/// volume.temperature_slope  0.35                      0.75
/// volume.spectral_index     1
/// volume.brightness         1            1.4          7            0.6
/// volume.sub_keplerian      1                                      0.8
/// volume.infall             0                                      0.2
/// volume.turbulence         0            1
/// ```
pub const BHR_PRESET_MATTER_DEEP: BhrPresetMatter = 2;

/// How bhr_set_preset_with chooses. Since 0.2.0.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct BhrPresetOptions {
    /// sizeof(BhrPresetOptions).
    pub struct_size: u32,
    /// BHR_PRESET_MATTER_AUTO (default), _THIN, _DEEP.
    pub matter: BhrPresetMatter,
    /// AUTO: the width of the frames that are to be rendered, in pixels, 1 .. 1048576; 0 means the default, 1920.
    pub width: u32,
    /// AUTO: their height, in pixels, 1 .. 1048576; 0 means the default, 1080.
    pub height: u32,
    /// AUTO: the time that such a frame may take, in milliseconds, 0.001 .. 1e9; 0 means the default, 16.
    pub frame_ms: f64,
}

// SAFETY: repr(C), size first, no padding, numbers only.
unsafe impl Versioned for BhrPresetOptions {
    const NAME: &'static str = "BhrPresetOptions";
    const SIZES: &'static [usize] = &[24];
    fn defaults() -> Self {
        let [width, height] = DEFAULT_SIZE;
        Self { struct_size: 0, matter: BHR_PRESET_MATTER_AUTO, width, height, frame_ms: DEFAULT_FRAME_MS }
    }
}

const DEFAULT_SIZE: [u32; 2] = [1920, 1080];
const DEFAULT_FRAME_MS: f64 = 16.0;
/// Shorter and longer times are no goals.
const FRAME_MS: [f64; 2] = [1e-3, 1e9];

impl BhrPresetOptions {
    fn check(&self) -> Result<MatterChoice> {
        let side = |name: &str, value: u32, default: u32| match value {
            0 => Ok(f64::from(default)),
            1..=Region::MAX_FRAME_SIDE => Ok(f64::from(value)),
            _ => {
                let most = Region::MAX_FRAME_SIDE;
                Err(Error::argument(format!(
                    "options {name} is {value}; it must lie in [1, {most}], or be 0 for {default}"
                )))
            }
        };
        let [width, height] = DEFAULT_SIZE;
        let pixels = side("width", self.width, width)? * side("height", self.height, height)?;
        let [low, high] = FRAME_MS;
        let frame_ms = if self.frame_ms == 0.0 { DEFAULT_FRAME_MS } else { self.frame_ms };
        if !(low..=high).contains(&frame_ms) {
            return Err(Error::argument(format!(
                "options frame_ms is {}; it must lie in [{low}, {high}], or be 0 for {DEFAULT_FRAME_MS}",
                Number(self.frame_ms)
            )));
        }
        match self.matter {
            BHR_PRESET_MATTER_AUTO => Ok(MatterChoice::WithinNs { pixels, ns: 1e6 * frame_ms }),
            BHR_PRESET_MATTER_THIN => Ok(MatterChoice::This(PresetMatter::Thin)),
            BHR_PRESET_MATTER_DEEP => Ok(MatterChoice::This(PresetMatter::Deep)),
            value => {
                let known = "BHR_PRESET_MATTER_AUTO (0), _THIN (1), _DEEP (2)";
                unknown(value, "options matter", known)
            }
        }
    }
}

fn named(preset: BhrPreset) -> Result<Preset> {
    match preset {
        BHR_PRESET_CINEMATIC => Ok(Preset::Cinematic),
        BHR_PRESET_PHYSICAL => Ok(Preset::Physical),
        BHR_PRESET_OBSERVATORY => Ok(Preset::Observatory),
        BHR_PRESET_TEACHING => Ok(Preset::Teaching),
        _ => unknown(preset, "preset", "BHR_PRESET_CINEMATIC (0) to BHR_PRESET_TEACHING (3)"),
    }
}

/// Gives the scene a look: the values of BhrPreset, with the thin disk. A volume that bhr_set_preset_with set leaves
/// with the look that it belongs to, unless it was changed since; volumes of the host's own stay. Since 0.2.0. Errors:
/// INVALID_ARGUMENT for an unknown preset.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_set_preset(context: *mut BhrContext, preset: BhrPreset) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_context("bhr_set_preset", context, |state| {
            named(preset)?.apply(&mut state.renderer.scene);
            Ok(())
        })
    }
}

/// Clears struct_size bytes and fills in the defaults. Any thread, inside callbacks too. Errors: INVALID_ARGUMENT
/// for NULL or a wrong struct_size. Since 0.2.0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_preset_options_init(options: *mut BhrPresetOptions, struct_size: usize) -> BhrStatus {
    // SAFETY: NULL or struct_size writable bytes, by the header's conventions.
    anywhere("bhr_preset_options_init", || unsafe { versioned::init(options, "options", struct_size) })
}

/// Gives the scene a look, and decides its volumes as well: with DEEP they are that look's one, in place of the
/// thin disk; with THIN there are none. Volumes that were set before are gone; hot spots stay. options NULL: all
/// defaults. *out_matter becomes BHR_PRESET_MATTER_THIN or _DEEP, whichever the scene has now; out_matter may be
/// NULL.
///
/// THIN and DEEP give the same picture on every machine. AUTO measures, and may choose otherwise on another
/// machine, or when the machine is busy: it renders the look with depth, as a new context's camera sees it, about a
/// hole of spin 0.5, with the context's BhrQuality, and throws it away. Frames of 4 x 2 come first, larger ones
/// follow, up to 1920 x 1080, until one of 480 x 270 or more takes 4 ms, and as long as the time allows. The
/// fastest of three counts, by the GPU's clock where BhrFrameStats has it (gpu_ns), else by the host's. DEEP is
/// chosen if width x height pixels take at most frame_ms by that. Each preset is measured once in a context, and
/// again when BhrQuality or, by bhr_context_recover, the device is another. Measuring takes about half a second at
/// most, whatever the quality; what comes on top is what the first frame of such a scene takes anyway: the sky's
/// pictures and tables of noise are made, and on GPUs and software drivers programs compiled. bhr_frame_stats does
/// not count these frames and the progress callback is not told of them; the call waits for a job that is being
/// rendered.
///
/// Any thread, not inside callbacks. Errors: INVALID_ARGUMENT for an unknown preset or matter, or a number outside
/// its range; with AUTO also DEVICE_LOST and OUT_OF_MEMORY. The scene then stays as it was. Since 0.2.0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_set_preset_with(
    context: *mut BhrContext,
    preset: BhrPreset,
    options: *const BhrPresetOptions,
    out_matter: *mut BhrPresetMatter,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let out = Out::cleared(out_matter);
        on_context("bhr_set_preset_with", context, |state| {
            let preset = named(preset)?;
            let given =
                if options.is_null() { BhrPresetOptions::defaults() } else { versioned::read(options, "options")? };
            out.set(match state.renderer.set_preset(preset, given.check()?)? {
                PresetMatter::Thin => BHR_PRESET_MATTER_THIN,
                PresetMatter::Deep => BHR_PRESET_MATTER_DEEP,
            });
            Ok(())
        })
    }
}
