// SPDX-License-Identifier: MIT OR Apache-2.0
//! How linear radiance becomes 8-bit pixels, as the host states it. The curves are in `crate::film`.

use crate::error::{Error, Result, out_of_range};

/// The limits of `Grade::white_balance`, K: those of the formula that others have for the Planckian locus (Kim et al.
/// 2002).
const COOLEST_WHITE: f64 = 1667.0;
const HOTTEST_WHITE: f64 = 25000.0;
/// The largest `Grade::grain_seed`: from there on numbers a step apart are equal.
const MOST_SEED: f64 = 1e15;
/// The least `AutoExposure::adaptation`: that of frames a millisecond apart, with a time constant of 17 minutes.
const SLOWEST_ADAPTATION: f64 = 1e-6;

/// The most `Optics::flare_ghosts`: those that `crate::film::bloom::Ghosts` knows.
pub const MOST_GHOSTS: u32 = 8;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum ToneMap {
    None = 0,
    Aces = 1,
    Agx = 2,
    Filmic = 3,
}

/// The colours of a picture; the maps are in `crate::film::colour_map`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum ColourMap {
    /// The light's own colours.
    None = 0,
    /// The map afmhot, for its luminance.
    Afmhot = 1,
}

/// Changes of exposed light before the tone map: see `crate::film::grade`. By default it changes nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grade {
    /// Temperature of the blackbody whose light is to look white, K, 1667 .. 25000; 0, the default, leaves white alone.
    pub white_balance: f64,
    /// Towards magenta, -1 .. 1. Default 0.
    pub tint: f64,
    /// The exponent of light about middle grey, 0.25 .. 4. Default 1.
    pub contrast: f64,
    /// 0 .. 4. Default 1.
    pub saturation: f64,
    /// The share of a lens' natural fall-off, 0 .. 1. Default 0.
    pub vignette: f64,
    /// Grain, 0 off (default) .. 1, which is a deviation of a quarter of the light.
    pub grain: f64,
    /// That of the grain's noise, any number. Default 0.
    pub grain_seed: f64,
}

impl Default for Grade {
    fn default() -> Self {
        Self {
            white_balance: 0.0,
            tint: 0.0,
            contrast: 1.0,
            saturation: 1.0,
            vignette: 0.0,
            grain: 0.0,
            grain_seed: 0.0,
        }
    }
}

impl Grade {
    /// Whether it changes anything.
    pub fn is_on(&self) -> bool {
        Self { grain_seed: 0.0, ..*self } != Self::default()
    }
}

/// The curve of `ToneMap::Filmic`: see `crate::film::filmic`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filmic {
    /// 0 .. 1. Default 0.5.
    pub toe_strength: f64,
    /// 0 .. 1. Default 0.5.
    pub toe_length: f64,
    /// Stops, 0 .. 16. Default 2.
    pub shoulder_strength: f64,
    /// 0 .. 1. Default 0.5.
    pub shoulder_length: f64,
    /// 0 .. 1. Default 1.
    pub shoulder_angle: f64,
}

impl Default for Filmic {
    fn default() -> Self {
        Self { toe_strength: 0.5, toe_length: 0.5, shoulder_strength: 2.0, shoulder_length: 0.5, shoulder_angle: 1.0 }
    }
}

/// Exposure by a percentile of the frame's luminance: see `crate::film::metering`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AutoExposure {
    /// The share of the stops to the target that is added, 0 off (default) .. 1.
    pub strength: f64,
    /// The percentile of the frame's luminance that is brought to the target, 0 .. 100. Default 90.
    pub percentile: f64,
    /// The luminance that the percentile is brought to, 0.001 .. 1000. Default 0.5.
    pub target: f64,
    /// The limits of what is added, in stops, -20 .. 20. Default -8 and 8. Where they cross, the upper one is added.
    pub least_ev: f64,
    pub most_ev: f64,
    /// The share of the way from the last frame's exposure that a frame goes, above 0 .. 1. Default 1: all of it.
    pub adaptation: f64,
}

impl Default for AutoExposure {
    fn default() -> Self {
        Self { strength: 0.0, percentile: 90.0, target: 0.5, least_ev: -8.0, most_ev: 8.0, adaptation: 1.0 }
    }
}

/// Light that a lens throws along lines, and reflects into ghosts: see `crate::film::bloom::Spikes` and `Ghosts`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Optics {
    /// Diffraction spikes, 0 off (default) .. 1.
    pub spikes: f64,
    /// Blades of the aperture, 3 .. 8, or 0 (default): 6.
    pub spike_blades: u32,
    /// The direction of one spike, anticlockwise from upright, radians, -2 pi .. 2 pi. Default 0.
    pub spike_angle: f64,
    /// Where spikes have fallen off, in frame heights, 0.01 .. 2. Default 0.25.
    pub spike_length: f64,
    /// The horizontal streak of an anamorphic lens, 0 off (default) .. 1.
    pub streak: f64,
    /// Where the streak has fallen off, in frame heights, 0.01 .. 4. Default 0.5.
    pub streak_length: f64,
    /// The streak's colour: -1 amber, 0 (default) that of the light, 1 blue.
    pub streak_tint: f64,
    /// Lens flare: the light that goes into ghosts, 0 off (default) .. 1.
    pub flare: f64,
    /// How many ghosts there are, 1 .. 8, or 0 (default): 5.
    pub flare_ghosts: u32,
}

impl Default for Optics {
    fn default() -> Self {
        Self {
            spikes: 0.0,
            spike_blades: 0,
            spike_angle: 0.0,
            spike_length: 0.25,
            streak: 0.0,
            streak_length: 0.5,
            streak_tint: 0.0,
            flare: 0.0,
            flare_ghosts: 0,
        }
    }
}

impl Optics {
    /// Blades of the aperture.
    pub fn blades(&self) -> u32 {
        if self.spike_blades == 0 { 6 } else { self.spike_blades }
    }

    /// Ghosts of a flare.
    pub fn ghosts(&self) -> u32 {
        if self.flare_ghosts == 0 { 5 } else { self.flare_ghosts }
    }

    /// Whether it changes anything.
    pub fn is_on(&self) -> bool {
        self.spikes > 0.0 || self.streak > 0.0 || self.flare > 0.0
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Film {
    /// Default `Aces`.
    pub tone_map: ToneMap,
    /// Stops, -20 .. 20. Default 0.
    pub exposure_ev: f64,
    /// Glare, 0 off .. 1: see `crate::film::bloom`. Default 0.25.
    pub bloom: f64,
    /// Full width at half maximum of a telescope's beam, in frame heights, 0 off (default) .. 1.
    pub beam_fwhm: f64,
    /// Default `None`.
    pub colour_map: ColourMap,
    pub grade: Grade,
    pub filmic: Filmic,
    pub auto_exposure: AutoExposure,
    /// The share of their stops above middle grey that bright parts lose, 0 off (default) .. 1: see
    /// `crate::film::metering`.
    pub highlights: f64,
    /// The share of their stops below middle grey that dark parts lose, 0 off (default) .. 1.
    pub shadows: f64,
    /// The share of what the LUT (`Scene::film_lut`) makes of colours, 0 .. 1. Default 1.
    pub lut_strength: f64,
    pub optics: Optics,
    /// Formats of high dynamic range: what a display shows for light of 1, 10 .. 1000 cd/m^2. Default 203.
    pub paper_white: f64,
    /// Formats of high dynamic range: the brightest light that a display shows, 100 .. 10000 cd/m^2. Default 1000.
    pub peak: f64,
    /// Whether frames of a region, which cannot have glare, go without it; else they fail. True (default) until a host
    /// states a film of its own: those that never asked for glare are to get their tiles.
    pub glare_is_optional: bool,
}

impl Default for Film {
    fn default() -> Self {
        Self {
            tone_map: ToneMap::Aces,
            exposure_ev: 0.0,
            bloom: 0.25,
            beam_fwhm: 0.0,
            colour_map: ColourMap::None,
            grade: Grade::default(),
            filmic: Filmic::default(),
            auto_exposure: AutoExposure::default(),
            highlights: 0.0,
            shadows: 0.0,
            lut_strength: 1.0,
            optics: Optics::default(),
            paper_white: 203.0,
            peak: 1000.0,
            glare_is_optional: true,
        }
    }
}

impl Film {
    /// Whether it asks for the light of the whole frame to be measured.
    pub fn is_metered(&self) -> bool {
        self.auto_exposure.strength > 0.0 || self.highlights > 0.0 || self.shadows > 0.0
    }

    /// The film without what the light of the whole frame goes into: glare, beam, spikes, flare, auto exposure, local
    /// tone mapping.
    pub fn of_parts(self) -> Self {
        let (auto_exposure, optics) = (AutoExposure::default(), Optics::default());
        Self { bloom: 0.0, beam_fwhm: 0.0, optics, auto_exposure, highlights: 0.0, shadows: 0.0, ..self }
    }

    /// The first field that asks for the light of the whole frame, and in words what comes from there.
    /// Glare that may be left out is not among it. `None`: the film can develop parts of a frame.
    pub fn needs_whole_frame(&self) -> Option<(&'static str, &'static str, f64)> {
        let bloom = if self.glare_is_optional { 0.0 } else { self.bloom };
        let needs = [
            ("bloom", "glare", bloom),
            ("beam_fwhm", "its light", self.beam_fwhm),
            ("spikes", "their light", self.optics.spikes),
            ("streak", "its light", self.optics.streak),
            ("flare", "its light", self.optics.flare),
            ("auto_exposure", "the exposure", self.auto_exposure.strength),
            ("highlights", "what is bright", self.highlights),
            ("shadows", "what is dark", self.shadows),
        ];
        needs.into_iter().find(|(_, _, value)| *value > 0.0)
    }

    /// Errors: a number out of range.
    pub fn check(&self) -> Result<()> {
        let (grade, filmic, auto, optics) = (&self.grade, &self.filmic, &self.auto_exposure, &self.optics);
        for (name, value, low, high) in [
            ("exposure_ev", self.exposure_ev, -20.0, 20.0),
            ("bloom", self.bloom, 0.0, 1.0),
            ("beam_fwhm", self.beam_fwhm, 0.0, 1.0),
            ("tint", grade.tint, -1.0, 1.0),
            ("contrast", grade.contrast, 0.25, 4.0),
            ("saturation", grade.saturation, 0.0, 4.0),
            ("toe_strength", filmic.toe_strength, 0.0, 1.0),
            ("toe_length", filmic.toe_length, 0.0, 1.0),
            ("shoulder_strength", filmic.shoulder_strength, 0.0, 16.0),
            ("shoulder_length", filmic.shoulder_length, 0.0, 1.0),
            ("shoulder_angle", filmic.shoulder_angle, 0.0, 1.0),
            ("vignette", grade.vignette, 0.0, 1.0),
            ("grain", grade.grain, 0.0, 1.0),
            ("grain_seed", grade.grain_seed, -MOST_SEED, MOST_SEED),
            ("auto_exposure", auto.strength, 0.0, 1.0),
            ("auto_percentile", auto.percentile, 0.0, 100.0),
            ("auto_target", auto.target, 0.001, 1000.0),
            ("auto_least_ev", auto.least_ev, -20.0, 20.0),
            ("auto_most_ev", auto.most_ev, -20.0, 20.0),
            ("auto_adaptation", auto.adaptation, SLOWEST_ADAPTATION, 1.0),
            ("highlights", self.highlights, 0.0, 1.0),
            ("shadows", self.shadows, 0.0, 1.0),
            ("lut_strength", self.lut_strength, 0.0, 1.0),
            ("spikes", optics.spikes, 0.0, 1.0),
            ("spike_angle", optics.spike_angle, -std::f64::consts::TAU, std::f64::consts::TAU),
            ("spike_length", optics.spike_length, 0.01, 2.0),
            ("streak", optics.streak, 0.0, 1.0),
            ("streak_length", optics.streak_length, 0.01, 4.0),
            ("streak_tint", optics.streak_tint, -1.0, 1.0),
            ("flare", optics.flare, 0.0, 1.0),
            ("paper_white", self.paper_white, 10.0, 1000.0),
            ("peak", self.peak, 100.0, 10000.0),
        ] {
            if !(low..=high).contains(&value) {
                return Err(out_of_range(&format!("film {name}"), value, low, high));
            }
        }
        if !matches!(optics.spike_blades, 0 | 3..=8) {
            let range = out_of_range("film spike_blades", optics.spike_blades.into(), 3.0, 8.0);
            return Err(Error::argument(format!("{range}, or be 0")));
        }
        if optics.flare_ghosts > MOST_GHOSTS {
            return Err(out_of_range("film flare_ghosts", optics.flare_ghosts.into(), 0.0, MOST_GHOSTS.into()));
        }
        let white = grade.white_balance;
        if white != 0.0 && !(COOLEST_WHITE..=HOTTEST_WHITE).contains(&white) {
            let range = out_of_range("film white_balance", white, COOLEST_WHITE, HOTTEST_WHITE);
            return Err(Error::argument(format!("{range}, or be 0")));
        }
        Ok(())
    }
}
