// SPDX-License-Identifier: MIT OR Apache-2.0
//! BHR_PRESET_*: named looks.

use super::call::on_context;
use super::context::BhrContext;
use super::pointer::unknown;
use super::status::BhrStatus;
use crate::scene::Preset;

/// A named look: values for disk, sky, film and effects that setters can then change. Since 0.2.0.
///
/// Each preset sets all of BhrDisk, all of BhrFilm, the effects, and flags and brightness of BhrSky. Hole, camera,
/// volumes, hot spots, time, view, quality, region, and the sky's orientation, seed and map stay as they are: a host
/// that shows its own map sets BHR_SKY_MAP again. An empty cell has the first column's value.
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

/// Gives the scene a look: the values of BhrPreset. Since 0.2.0. Errors: INVALID_ARGUMENT for an unknown preset.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_set_preset(context: *mut BhrContext, preset: BhrPreset) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_context("bhr_set_preset", context, |state| {
            let preset = match preset {
                BHR_PRESET_CINEMATIC => Preset::Cinematic,
                BHR_PRESET_PHYSICAL => Preset::Physical,
                BHR_PRESET_OBSERVATORY => Preset::Observatory,
                BHR_PRESET_TEACHING => Preset::Teaching,
                _ => return unknown(preset, "preset", "BHR_PRESET_CINEMATIC (0) to BHR_PRESET_TEACHING (3)"),
            };
            preset.apply(&mut state.renderer.scene);
            Ok(())
        })
    }
}
