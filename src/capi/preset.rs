// SPDX-License-Identifier: MIT OR Apache-2.0
//! BHR_PRESET_*: named looks.

use super::call::on_context;
use super::context::BhrContext;
use super::entry::anywhere;
use super::pointer::{Out, unknown};
use super::status::BhrStatus;
use super::versioned::{self, Versioned};
use crate::error::{Error, Number, Result};
use crate::renderer::{FrameGoal, MatterChoice};
use crate::scene::{Preset, PresetMatter, Region};

/// A named look: values for all of BhrDisk, all of BhrFilm, the effects, and flags and brightness of BhrSky, which
/// setters can then change. Hole, camera, hot spots, time, shutter, view, quality, region, and the sky's orientation,
/// seed and map stay as they are: a host that shows its own map sets BHR_SKY_MAP again. docs/presets.md has the tables
/// of the values. @since 0.2.0
pub type BhrPreset = i32;
/// The default: a golden disk with structure and soft edges, its approaching side nearly white, and glare.
pub const BHR_PRESET_CINEMATIC: BhrPreset = 0;
/// A smooth disk, no glare, no tone curve; light is shown as it is, two stops down, until it clips.
pub const BHR_PRESET_PHYSICAL: BhrPreset = 1;
/// The look of the Event Horizon Telescope's sources: a ring blurred by a beam, in one colour map, on black.
pub const BHR_PRESET_OBSERVATORY: BhrPreset = 2;
/// For lessons: a grid on the sky, and a smooth disk in the colours of its shifts, without beaming and delay.
pub const BHR_PRESET_TEACHING: BhrPreset = 3;

/// The matter that bhr_set_preset_with shows. @since 0.2.0
pub type BhrPresetMatter = i32;
/// DEEP where the adapter is fast enough for it, else THIN.
pub const BHR_PRESET_MATTER_AUTO: BhrPresetMatter = 0;
/// The thin disk, as bhr_set_preset.
pub const BHR_PRESET_MATTER_THIN: BhrPresetMatter = 1;
/// One volume in place of the disk; TEACHING has no such look and stays THIN.
pub const BHR_PRESET_MATTER_DEEP: BhrPresetMatter = 2;

/// Settings of bhr_set_preset_with. @since 0.2.0
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
    /// AUTO: 1 forgets what was measured for the preset before; 0 (default) keeps it.
    pub measure_anew: u32,
    /// AUTO: 1 takes DEEP at half resolution where FULL is too slow, and sets BhrQuality.volume_resolution to what
    /// DEEP fits with; 0 (default) leaves that as it is.
    pub may_halve: u32,
}

// SAFETY: repr(C), size first, no padding, numbers only.
unsafe impl Versioned for BhrPresetOptions {
    const NAME: &'static str = "BhrPresetOptions";
    const SIZES: &'static [usize] = &[24, 32];
    fn defaults() -> Self {
        let [width, height] = DEFAULT_SIZE;
        Self {
            struct_size: 0,
            matter: BHR_PRESET_MATTER_AUTO,
            width,
            height,
            frame_ms: DEFAULT_FRAME_MS,
            measure_anew: 0,
            may_halve: 0,
        }
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
        let flag = |name: &str, value: u32| match value {
            0 | 1 => Ok(value == 1),
            _ => Err(Error::argument(format!("options {name} is {value}; it must be 0 or 1"))),
        };
        let measure_anew = flag("measure_anew", self.measure_anew)?;
        let may_halve = flag("may_halve", self.may_halve)?;
        let goal = FrameGoal { pixels, ns: 1e6 * frame_ms, measure_anew, may_halve };
        match self.matter {
            BHR_PRESET_MATTER_AUTO => Ok(MatterChoice::Within(goal)),
            BHR_PRESET_MATTER_THIN => Ok(MatterChoice::This(PresetMatter::Thin)),
            BHR_PRESET_MATTER_DEEP => Ok(MatterChoice::This(PresetMatter::Deep)),
            value => {
                let known = "BHR_PRESET_MATTER_AUTO (0), _THIN (1), _DEEP (2)";
                unknown(value, "options matter", known)
            }
        }
    }
}

/// The preset of a number.
pub(super) fn named(preset: BhrPreset) -> Result<Preset> {
    match preset {
        BHR_PRESET_CINEMATIC => Ok(Preset::Cinematic),
        BHR_PRESET_PHYSICAL => Ok(Preset::Physical),
        BHR_PRESET_OBSERVATORY => Ok(Preset::Observatory),
        BHR_PRESET_TEACHING => Ok(Preset::Teaching),
        _ => unknown(preset, "preset", "BHR_PRESET_CINEMATIC (0) to BHR_PRESET_TEACHING (3)"),
    }
}

/// The matter of a number, which is not AUTO.
pub(super) fn matter_of(matter: BhrPresetMatter) -> Result<PresetMatter> {
    match matter {
        BHR_PRESET_MATTER_THIN => Ok(PresetMatter::Thin),
        BHR_PRESET_MATTER_DEEP => Ok(PresetMatter::Deep),
        value => unknown(value, "preset_matter", "BHR_PRESET_MATTER_THIN (1), _DEEP (2)"),
    }
}

/// Gives the scene a look, with the thin disk. A volume that bhr_set_preset_with set leaves with the look that it
/// belongs to, unless it was changed since; volumes of the host's own stay. @since 0.2.0
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

/// Fills in the defaults. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_preset_options_init(options: *mut BhrPresetOptions, struct_size: usize) -> BhrStatus {
    // SAFETY: NULL or struct_size writable bytes, by the header's conventions.
    anywhere("bhr_preset_options_init", || unsafe { versioned::init(options, "options", struct_size) })
}

/// Gives the scene a look, and decides its volumes as well: with DEEP the scene has the look's one volume in place
/// of the thin disk, with THIN none. Volumes that were set before are gone; hot spots stay. options NULL: all
/// defaults. *out_matter, unless NULL, becomes BHR_PRESET_MATTER_THIN or _DEEP, whichever the scene has now.
///
/// THIN and DEEP give the same picture on every machine. AUTO measures, once for each preset and resolution in a
/// context, for about half a second at most, logs at INFO what it took, and may choose otherwise on another machine, or
/// when the machine is busy (docs/presets.md). The call waits for a job that is being rendered. @since 0.2.0
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
