// SPDX-License-Identifier: MIT OR Apache-2.0
//! The structure of matter with depth: the factors by which turbulence changes its density and its temperature at a
//! place and a time. `filaments` has the pattern, `bands` its generations; how matter carries it, and how fine it may be
//! where it is seen, is here. Mirrored by `shaders/emit/clouds.wgsl`. Knows no light and no ray.
//!
//! A generation is carried by the matter as it grows old: around the axis by the angular velocity at its very place,
//! which shears it, and along the radius by that of its band's middle. The pattern is P = e^(s G) over its mean, with G
//! the weighted sum of the generations' noise, of variance 1. Density goes as P^clumping, divided by its mean, so that a
//! mean optical depth stays the stated one; the temperature as P^heating.

use super::bands::{Bands, Life, Shown, When};
use super::filaments::{
    FILAMENT_HEIGHT, FILAMENT_PERIOD, FILAMENT_SIDES, Filaments, filament_log_mean, filament_variance,
};
use super::shape::{Cloud, Reach, Stretch};
use super::volume::{Shape, Volume};
use crate::physics::flow::{Flow, Place};
use crate::physics::orbit::horizon_outer;
use crate::random::mix;
use std::f64::consts::{PI, TAU};

/// The standard deviation of ln P at `Volume::turbulence` 1.
pub(crate) const CLOUD_DEVIATION: f64 = 1.0;
/// Orbits that a generation lives, at the middle of its band; if the matter moves inwards or outwards, no longer than it
/// takes to an e-fold of the radius.
const LIFETIME: f64 = 1.0;
/// The shear of a generation half as old as it grows, rad an e-fold of the radius.
pub(crate) const HALF_SHEARED: f64 = SHEAR * PI * LIFETIME;
/// The least rate of renewal, in orbital frequencies r^-1.5: turbulence of matter that stands still goes on.
const LEAST_RATE: f64 = 0.25;
/// Structure of jets is so much longer along the radius.
const JET_STRETCH: f64 = 3.0;
/// Shear, -d Omega / d ln r, in Omega: that of Keplerian orbits, for all, since it only tells how fine structure is.
pub(crate) const SHEAR: f64 = 1.5;
/// The share of a footprint, and of a spacing of samples, that a texel may be.
pub(crate) const CLOUD_SHARP: f64 = 0.7;
pub(crate) const CLOUD_SPACED: f64 = 0.7;
/// Smaller impact parameters are taken for it: rays that go round the hole have none.
pub(crate) const LEAST_B: f64 = 2.0;
/// The share of a footprint that samples may be coarser by: levels have structure of about a texel, of which the finest
/// has none.
pub(crate) const CLOUD_COARSE: f64 = 0.35;
/// Texels that samples of a picture lie apart.
pub(crate) const CLOUD_SPACING: f64 = 1.4;

/// Where and when matter is asked for.
#[derive(Clone, Copy, Debug)]
pub struct CloudPlace {
    pub r: f64,
    pub cos: f64,
    pub azimuth: f64,
    /// M after `When::time`.
    pub later: f64,
}

/// How far apart places must be to be told from each other.
#[derive(Clone, Copy, Debug, Default)]
pub struct Blur {
    /// Across the ray, M.
    pub footprint: f64,
    /// Along it, from sample to sample, texels of the pattern.
    pub spacing: f64,
}

/// The factors on density and temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Structure {
    pub density: f64,
    pub heat: f64,
}

impl Structure {
    pub const NONE: Self = Self { density: 1.0, heat: 1.0 };
}

/// The structure of a volume as a frame shows it.
#[derive(Clone, Copy, Debug)]
pub struct Clouds {
    /// The standard deviation of ln P.
    pub strength: f64,
    pub clumping: f64,
    pub heating: f64,
    /// The range of ln r after which the pattern repeats.
    pub period: f64,
    pub bands: Bands,
}

impl Clouds {
    /// The structure of `volume`, with the shape `cloud` within `reach`, moved by `flow` about a hole of spin `spin`.
    /// `None`: it is even.
    pub fn new(volume: &Volume, cloud: &Cloud, reach: &Reach, flow: &Flow, spin: f64, when: &When) -> Option<Self> {
        if volume.turbulence <= 0.0 {
            return None;
        }
        let life = |ln_r: f64| {
            let r = ln_r.exp().max(1.02 * horizon_outer(spin));
            let at = Place::new(spin, 1.0 / r, 0.0);
            let velocity = flow.velocity(spin, &at);
            let (around, drift) = (velocity.angular_velocity(spin, &at), velocity.radial_velocity(&at) / r);
            let rate = around.hypot(TAU * drift).max(LEAST_RATE / (r * r.sqrt()));
            Life { time: LIFETIME * TAU / rate, drift }
        };
        let [outer, inner] = reach.u.map(|u| -u.ln());
        Some(Self {
            strength: CLOUD_DEVIATION * volume.turbulence,
            clumping: volume.clumping,
            heating: volume.heating,
            period: FILAMENT_PERIOD * if cloud.shape == Shape::Jet { JET_STRETCH } else { 1.0 },
            bands: Bands::new([inner, outer], volume.seed, when.time, life),
        })
    }

    /// The structure at a place of matter of the shape `cloud`, with the angular velocity `omega` there.
    pub fn pattern(&self, filaments: &Filaments, cloud: &Cloud, at: &CloudPlace, omega: f64, blur: Blur) -> Structure {
        let (ln_r, sin) = (at.r.ln(), ((1.0 - at.cos) * (1.0 + at.cos)).max(1e-12).sqrt());
        let [height, steepness] = cloud.height(at.r, at.cos);
        let [columns, rows, layers] = self.texels();
        // Texels per rad of the directions: around, outwards, and across the shape.
        let (around, across) = (columns / sin, layers * steepness * sin);
        let (mut sum, mut cumulants) = (0.0, [0.0; 2]);
        for Shown { weight, age, drift, key } in self.bands.shown(ln_r, at.later) {
            let outwards = rows.hypot(columns * SHEAR * omega * age);
            let finest = outwards.max(across);
            // Near the axis nothing is to be finer around than it is along or across.
            let seen = (CLOUD_SHARP * blur.footprint / at.r * finest.max(around)).max(CLOUD_SPACED * blur.spacing);
            let level = seen.max(around / rows.max(across)).log2().max(0.0);
            let place = [
                (at.azimuth - omega * age) / TAU + f64::from(key & 0xffff) / 65536.0,
                (ln_r - drift * age) / self.period + f64::from(key >> 16) / 65536.0,
                height / FILAMENT_HEIGHT + f64::from(mix(key) & 0xffff) / 65536.0,
            ];
            let s = self.strength * weight;
            sum += s * filaments.value(place, level);
            let variance = filament_variance(level);
            for (sum, power) in cumulants.iter_mut().zip([self.clumping, 1.0]) {
                *sum += filament_log_mean(power * s, variance);
            }
        }
        let [clumps, pattern] = cumulants;
        Structure { density: (self.clumping * sum - clumps).exp(), heat: (self.heating * (sum - pattern)).exp() }
    }

    /// Texels of the finest level per rad of azimuth, per e-fold of the radius and per thickness.
    pub fn texels(&self) -> [f64; 3] {
        let [columns, rows, layers] = FILAMENT_SIDES.map(|side| side as f64);
        [columns / TAU, rows / self.period, layers / FILAMENT_HEIGHT]
    }

    /// The most texels of the finest level that a stretch passes.
    pub fn passed(&self, cloud: &Cloud, stretch: &Stretch) -> f64 {
        let ([u, v], [c, d]) = (stretch.u, stretch.cos);
        let [columns, rows, layers] = self.texels();
        let [height, steepness] = cloud.height(1.0 / u, c);
        let climb = cloud.height(1.0 / v, d)[0] - height;
        let sin = (1.0 - (c * c).max(d * d)).max(0.0).sqrt();
        // Near the axis azimuths change without end, but structure is no finer there.
        let around = stretch.swept * (columns / sin.max(0.05)).min(rows.max(layers * steepness * sin));
        ((u / v).ln() * rows.hypot(columns * HALF_SHEARED)).hypot(climb * layers).hypot(around)
    }

    /// The number of samples that the texels `passed` at the radius r want, where structure finer than `footprint` does
    /// not show.
    pub fn samples(&self, cloud: &Cloud, passed: f64, r: f64, footprint: f64) -> f64 {
        let [columns, rows, layers] = self.texels();
        let finest = rows.hypot(columns * HALF_SHEARED).max(layers * cloud.height(r, 0.0)[1]);
        passed / (CLOUD_SPACING * (CLOUD_COARSE * footprint / r * finest).max(1.0))
    }
}

/// The angle by which a ray with the impact parameter `b` has been bent so far, of which `swept` is that about the hole:
/// a straight one from r = `from` to r = `to` would have swept less. `passed`: it came closer to the hole in between.
pub fn bend(swept: f64, b: f64, from: f64, to: f64, passed: bool) -> f64 {
    let [from, to] = [from, to].map(|r| (b / r).min(1.0).acos());
    (swept - if passed { from + to } else { (from - to).abs() }).max(0.0)
}

/// The width that a pixel sees of matter at r = `to`, from r = `from` at a distance, M: the side of a square as large as
/// what it sees. Where rays have been bent, they part in the plane that they lie in: the angle changes by d alpha = F db
/// / b, F being e^(alpha + 0.40) for rays that go round the hole (Darwin 1959, Proc. R. Soc. A 249, 180: alpha = -ln(b /
/// b_c - 1) - 0.40) and alpha for others (alpha = 4 M / b). e^(alpha + 0.40) - 1.5 - alpha / 2 is near to both, which is
/// enough to tell how fine structure may be.
pub fn footprint(pixel_angle: f64, distance: f64, b: f64, from: f64, to: f64, bend: f64) -> f64 {
    let parted = from * to / b.max(LEAST_B) * ((bend + 0.4).exp() - 1.5 - 0.5 * bend).max(0.0);
    pixel_angle * (distance * (distance + parted)).sqrt()
}
