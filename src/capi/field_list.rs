// SPDX-License-Identifier: MIT OR Apache-2.0
//! The fields of structs of the API that say what a scene is, and the words of its constants. Made by
//! tests/header/field_list.rs from include/bhr.json; do not edit.

use super::camera::BhrCamera;
use super::disk::BhrDisk;
use super::fields::{Described, Field, Kind, Words};
use super::film::BhrFilm;
use super::quality::BhrQuality;
use super::region::BhrRegion;
use super::sky::BhrSky;
use super::volume::BhrHotSpot;
use super::volume::BhrVolume;
use std::mem::offset_of;

/// The words of BhrView.
pub(super) const VIEWS: Words<i32> = &[
    ("light", 0),
    ("redshift", 1),
    ("order", 2),
    ("deflection", 3),
    ("steps", 4),
    ("metric", 5),
    ("optical_depth", 6),
    ("intensity", 7),
];

/// The words of BhrPreset.
pub(super) const PRESETS: Words<i32> = &[("cinematic", 0), ("physical", 1), ("observatory", 2), ("teaching", 3)];

/// The words of BhrPresetMatter.
pub(super) const PRESET_MATTERS: Words<i32> = &[("auto", 0), ("thin", 1), ("deep", 2)];

/// The words of BHR_EFFECT_*.
pub(super) const EFFECTS: Words<u32> =
    &[("doppler_shift", 1), ("gravity_shift", 2), ("beaming", 4), ("light_delay", 8), ("all", 4294967295)];

// SAFETY: repr(C), without padding, numbers only, as for Versioned.
unsafe impl Described for BhrCamera {
    const FIELDS: &'static [Field] = &[
        Field {
            name: "projection",
            offset: offset_of!(BhrCamera, projection),
            kind: Kind::Word(&[("perspective", 0), ("fisheye", 1), ("equirect", 2), ("cube", 3), ("frustum", 4)]),
        },
        Field { name: "position", offset: offset_of!(BhrCamera, position), kind: Kind::Numbers(3) },
        Field { name: "forward", offset: offset_of!(BhrCamera, forward), kind: Kind::Numbers(3) },
        Field { name: "up", offset: offset_of!(BhrCamera, up), kind: Kind::Numbers(3) },
        Field { name: "fov_y", offset: offset_of!(BhrCamera, fov_y), kind: Kind::Angle },
        Field {
            name: "motion",
            offset: offset_of!(BhrCamera, motion),
            kind: Kind::Word(&[("static", 0), ("free_fall", 1), ("orbit", 2), ("velocity", 3)]),
        },
        Field { name: "velocity", offset: offset_of!(BhrCamera, velocity), kind: Kind::Numbers(3) },
        Field { name: "tan_left", offset: offset_of!(BhrCamera, tan_left), kind: Kind::Numbers(1) },
        Field { name: "tan_right", offset: offset_of!(BhrCamera, tan_right), kind: Kind::Numbers(1) },
        Field { name: "tan_down", offset: offset_of!(BhrCamera, tan_down), kind: Kind::Numbers(1) },
        Field { name: "tan_up", offset: offset_of!(BhrCamera, tan_up), kind: Kind::Numbers(1) },
        Field { name: "jitter", offset: offset_of!(BhrCamera, jitter), kind: Kind::Numbers(2) },
        Field { name: "eye_distance", offset: offset_of!(BhrCamera, eye_distance), kind: Kind::Numbers(1) },
        Field {
            name: "eye",
            offset: offset_of!(BhrCamera, eye),
            kind: Kind::Word(&[("middle", 0), ("left", 1), ("right", 2)]),
        },
        Field { name: "chart", offset: offset_of!(BhrCamera, chart), kind: Kind::Word(&[("static", 0), ("rain", 1)]) },
        Field {
            name: "transport",
            offset: offset_of!(BhrCamera, transport),
            kind: Kind::Word(&[("triad", 0), ("parallel", 1)]),
        },
    ];
}

// SAFETY: repr(C), without padding, numbers only, as for Versioned.
unsafe impl Described for BhrDisk {
    const FIELDS: &'static [Field] = &[
        Field {
            name: "flags",
            offset: offset_of!(BhrDisk, flags),
            kind: Kind::Bits(&[("retrograde", 1), ("plunges", 2)]),
        },
        Field { name: "inner_radius", offset: offset_of!(BhrDisk, inner_radius), kind: Kind::Numbers(1) },
        Field { name: "outer_radius", offset: offset_of!(BhrDisk, outer_radius), kind: Kind::Numbers(1) },
        Field { name: "temperature", offset: offset_of!(BhrDisk, temperature), kind: Kind::Numbers(1) },
        Field { name: "opacity", offset: offset_of!(BhrDisk, opacity), kind: Kind::Numbers(1) },
        Field { name: "brightness", offset: offset_of!(BhrDisk, brightness), kind: Kind::Numbers(1) },
        Field { name: "turbulence", offset: offset_of!(BhrDisk, turbulence), kind: Kind::Numbers(1) },
        Field { name: "seed", offset: offset_of!(BhrDisk, seed), kind: Kind::Seed },
        Field {
            name: "reference",
            offset: offset_of!(BhrDisk, reference),
            kind: Kind::Word(&[("at_hottest", 0), ("at_median", 1)]),
        },
        Field {
            name: "emission_law",
            offset: offset_of!(BhrDisk, emission_law),
            kind: Kind::Word(&[("isotropic", 0), ("limb_darkened", 1)]),
        },
        Field { name: "edge_softness", offset: offset_of!(BhrDisk, edge_softness), kind: Kind::Numbers(1) },
    ];
}

// SAFETY: repr(C), without padding, numbers only, as for Versioned.
unsafe impl Described for BhrVolume {
    const FIELDS: &'static [Field] = &[
        Field {
            name: "flags",
            offset: offset_of!(BhrVolume, flags),
            kind: Kind::Bits(&[("retrograde", 1), ("power_law", 2)]),
        },
        Field {
            name: "shape",
            offset: offset_of!(BhrVolume, shape),
            kind: Kind::Word(&[("disk", 0), ("torus", 1), ("halo", 2), ("jet", 3)]),
        },
        Field {
            name: "flow",
            offset: offset_of!(BhrVolume, flow),
            kind: Kind::Word(&[("keplerian", 0), ("angular_momentum", 1), ("outflow", 2)]),
        },
        Field { name: "inner_radius", offset: offset_of!(BhrVolume, inner_radius), kind: Kind::Numbers(1) },
        Field { name: "outer_radius", offset: offset_of!(BhrVolume, outer_radius), kind: Kind::Numbers(1) },
        Field { name: "radius", offset: offset_of!(BhrVolume, radius), kind: Kind::Numbers(1) },
        Field { name: "width", offset: offset_of!(BhrVolume, width), kind: Kind::Numbers(1) },
        Field { name: "thickness", offset: offset_of!(BhrVolume, thickness), kind: Kind::Numbers(1) },
        Field { name: "opening", offset: offset_of!(BhrVolume, opening), kind: Kind::Angle },
        Field { name: "slope", offset: offset_of!(BhrVolume, slope), kind: Kind::Numbers(1) },
        Field { name: "absorption", offset: offset_of!(BhrVolume, absorption), kind: Kind::Numbers(1) },
        Field { name: "temperature", offset: offset_of!(BhrVolume, temperature), kind: Kind::Numbers(1) },
        Field { name: "temperature_slope", offset: offset_of!(BhrVolume, temperature_slope), kind: Kind::Numbers(1) },
        Field { name: "spectral_index", offset: offset_of!(BhrVolume, spectral_index), kind: Kind::Numbers(1) },
        Field { name: "tint", offset: offset_of!(BhrVolume, tint), kind: Kind::Numbers(3) },
        Field { name: "brightness", offset: offset_of!(BhrVolume, brightness), kind: Kind::Numbers(1) },
        Field { name: "sub_keplerian", offset: offset_of!(BhrVolume, sub_keplerian), kind: Kind::Numbers(1) },
        Field { name: "infall", offset: offset_of!(BhrVolume, infall), kind: Kind::Numbers(1) },
        Field { name: "angular_momentum", offset: offset_of!(BhrVolume, angular_momentum), kind: Kind::Numbers(1) },
        Field { name: "speed", offset: offset_of!(BhrVolume, speed), kind: Kind::Numbers(1) },
        Field { name: "turbulence", offset: offset_of!(BhrVolume, turbulence), kind: Kind::Numbers(1) },
        Field { name: "clumping", offset: offset_of!(BhrVolume, clumping), kind: Kind::Numbers(1) },
        Field { name: "heating", offset: offset_of!(BhrVolume, heating), kind: Kind::Numbers(1) },
        Field { name: "seed", offset: offset_of!(BhrVolume, seed), kind: Kind::Seed },
    ];
}

// SAFETY: repr(C), without padding, numbers only, as for Versioned.
unsafe impl Described for BhrHotSpot {
    const FIELDS: &'static [Field] = &[
        Field {
            name: "flags",
            offset: offset_of!(BhrHotSpot, flags),
            kind: Kind::Bits(&[("retrograde", 1), ("thermal", 2), ("free", 4), ("rain", 8)]),
        },
        Field { name: "radius", offset: offset_of!(BhrHotSpot, radius), kind: Kind::Numbers(1) },
        Field { name: "size", offset: offset_of!(BhrHotSpot, size), kind: Kind::Numbers(1) },
        Field { name: "azimuth", offset: offset_of!(BhrHotSpot, azimuth), kind: Kind::Angle },
        Field { name: "absorption", offset: offset_of!(BhrHotSpot, absorption), kind: Kind::Numbers(1) },
        Field { name: "temperature", offset: offset_of!(BhrHotSpot, temperature), kind: Kind::Numbers(1) },
        Field { name: "spectral_index", offset: offset_of!(BhrHotSpot, spectral_index), kind: Kind::Numbers(1) },
        Field { name: "tint", offset: offset_of!(BhrHotSpot, tint), kind: Kind::Numbers(3) },
        Field { name: "brightness", offset: offset_of!(BhrHotSpot, brightness), kind: Kind::Numbers(1) },
        Field { name: "position", offset: offset_of!(BhrHotSpot, position), kind: Kind::Numbers(3) },
        Field { name: "velocity", offset: offset_of!(BhrHotSpot, velocity), kind: Kind::Numbers(3) },
        Field { name: "time", offset: offset_of!(BhrHotSpot, time), kind: Kind::Numbers(1) },
    ];
}

// SAFETY: repr(C), without padding, numbers only, as for Versioned.
unsafe impl Described for BhrSky {
    const FIELDS: &'static [Field] = &[
        Field {
            name: "flags",
            offset: offset_of!(BhrSky, flags),
            kind: Kind::Bits(&[("stars", 1), ("procedural", 2), ("milky_way", 4), ("map", 8), ("grid", 16)]),
        },
        Field { name: "stars_brightness", offset: offset_of!(BhrSky, stars_brightness), kind: Kind::Numbers(1) },
        Field { name: "map_brightness", offset: offset_of!(BhrSky, map_brightness), kind: Kind::Numbers(1) },
        Field { name: "orientation", offset: offset_of!(BhrSky, orientation), kind: Kind::Numbers(4) },
        Field { name: "seed", offset: offset_of!(BhrSky, seed), kind: Kind::Seed },
    ];
}

// SAFETY: repr(C), without padding, numbers only, as for Versioned.
unsafe impl Described for BhrFilm {
    const FIELDS: &'static [Field] = &[
        Field {
            name: "tone_map",
            offset: offset_of!(BhrFilm, tone_map),
            kind: Kind::Word(&[("none", 0), ("aces", 1), ("agx", 2), ("filmic", 3)]),
        },
        Field { name: "exposure_ev", offset: offset_of!(BhrFilm, exposure_ev), kind: Kind::Numbers(1) },
        Field { name: "bloom", offset: offset_of!(BhrFilm, bloom), kind: Kind::Numbers(1) },
        Field { name: "beam_fwhm", offset: offset_of!(BhrFilm, beam_fwhm), kind: Kind::Numbers(1) },
        Field {
            name: "colour_map",
            offset: offset_of!(BhrFilm, colour_map),
            kind: Kind::Word(&[("none", 0), ("afmhot", 1)]),
        },
        Field { name: "spike_blades", offset: offset_of!(BhrFilm, spike_blades), kind: Kind::Count },
        Field { name: "white_balance", offset: offset_of!(BhrFilm, white_balance), kind: Kind::Numbers(1) },
        Field { name: "tint", offset: offset_of!(BhrFilm, tint), kind: Kind::Numbers(1) },
        Field { name: "contrast", offset: offset_of!(BhrFilm, contrast), kind: Kind::Numbers(1) },
        Field { name: "saturation", offset: offset_of!(BhrFilm, saturation), kind: Kind::Numbers(1) },
        Field { name: "toe_strength", offset: offset_of!(BhrFilm, toe_strength), kind: Kind::Numbers(1) },
        Field { name: "toe_length", offset: offset_of!(BhrFilm, toe_length), kind: Kind::Numbers(1) },
        Field { name: "shoulder_strength", offset: offset_of!(BhrFilm, shoulder_strength), kind: Kind::Numbers(1) },
        Field { name: "shoulder_length", offset: offset_of!(BhrFilm, shoulder_length), kind: Kind::Numbers(1) },
        Field { name: "shoulder_angle", offset: offset_of!(BhrFilm, shoulder_angle), kind: Kind::Numbers(1) },
        Field { name: "vignette", offset: offset_of!(BhrFilm, vignette), kind: Kind::Numbers(1) },
        Field { name: "auto_exposure", offset: offset_of!(BhrFilm, auto_exposure), kind: Kind::Numbers(1) },
        Field { name: "auto_percentile", offset: offset_of!(BhrFilm, auto_percentile), kind: Kind::Numbers(1) },
        Field { name: "auto_target", offset: offset_of!(BhrFilm, auto_target), kind: Kind::Numbers(1) },
        Field { name: "auto_least_ev", offset: offset_of!(BhrFilm, auto_least_ev), kind: Kind::Numbers(1) },
        Field { name: "auto_most_ev", offset: offset_of!(BhrFilm, auto_most_ev), kind: Kind::Numbers(1) },
        Field { name: "auto_adaptation", offset: offset_of!(BhrFilm, auto_adaptation), kind: Kind::Numbers(1) },
        Field { name: "highlights", offset: offset_of!(BhrFilm, highlights), kind: Kind::Numbers(1) },
        Field { name: "shadows", offset: offset_of!(BhrFilm, shadows), kind: Kind::Numbers(1) },
        Field { name: "grain", offset: offset_of!(BhrFilm, grain), kind: Kind::Numbers(1) },
        Field { name: "grain_seed", offset: offset_of!(BhrFilm, grain_seed), kind: Kind::Numbers(1) },
        Field { name: "lut_strength", offset: offset_of!(BhrFilm, lut_strength), kind: Kind::Numbers(1) },
        Field { name: "spikes", offset: offset_of!(BhrFilm, spikes), kind: Kind::Numbers(1) },
        Field { name: "spike_angle", offset: offset_of!(BhrFilm, spike_angle), kind: Kind::Angle },
        Field { name: "spike_length", offset: offset_of!(BhrFilm, spike_length), kind: Kind::Numbers(1) },
        Field { name: "streak", offset: offset_of!(BhrFilm, streak), kind: Kind::Numbers(1) },
        Field { name: "streak_length", offset: offset_of!(BhrFilm, streak_length), kind: Kind::Numbers(1) },
        Field { name: "streak_tint", offset: offset_of!(BhrFilm, streak_tint), kind: Kind::Numbers(1) },
        Field { name: "paper_white", offset: offset_of!(BhrFilm, paper_white), kind: Kind::Numbers(1) },
        Field { name: "peak", offset: offset_of!(BhrFilm, peak), kind: Kind::Numbers(1) },
        Field { name: "flare", offset: offset_of!(BhrFilm, flare), kind: Kind::Numbers(1) },
        Field { name: "flare_ghosts", offset: offset_of!(BhrFilm, flare_ghosts), kind: Kind::Count },
    ];
}

// SAFETY: repr(C), without padding, numbers only, as for Versioned.
unsafe impl Described for BhrQuality {
    const FIELDS: &'static [Field] = &[
        Field {
            name: "method",
            offset: offset_of!(BhrQuality, method),
            kind: Kind::Word(&[("auto", 0), ("rk4", 1), ("adaptive", 2)]),
        },
        Field { name: "samples_per_pixel", offset: offset_of!(BhrQuality, samples_per_pixel), kind: Kind::Count },
        Field { name: "max_steps", offset: offset_of!(BhrQuality, max_steps), kind: Kind::Count },
        Field { name: "step", offset: offset_of!(BhrQuality, step), kind: Kind::Numbers(1) },
        Field { name: "tolerance", offset: offset_of!(BhrQuality, tolerance), kind: Kind::Numbers(1) },
        Field { name: "max_disk_order", offset: offset_of!(BhrQuality, max_disk_order), kind: Kind::Count },
        Field { name: "render_scale", offset: offset_of!(BhrQuality, render_scale), kind: Kind::Numbers(1) },
        Field {
            name: "volume_resolution",
            offset: offset_of!(BhrQuality, volume_resolution),
            kind: Kind::Word(&[("full", 0), ("half", 1)]),
        },
    ];
}

// SAFETY: repr(C), without padding, numbers only, as for Versioned.
unsafe impl Described for BhrRegion {
    const FIELDS: &'static [Field] = &[
        Field { name: "full_width", offset: offset_of!(BhrRegion, full_width), kind: Kind::Count },
        Field { name: "full_height", offset: offset_of!(BhrRegion, full_height), kind: Kind::Count },
        Field { name: "x", offset: offset_of!(BhrRegion, x), kind: Kind::Count },
        Field { name: "y", offset: offset_of!(BhrRegion, y), kind: Kind::Count },
    ];
}
