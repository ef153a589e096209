// SPDX-License-Identifier: MIT OR Apache-2.0
//! A piece of a ray in one volume with structure, in even layers, where that is all the matter that there is. Mirrored
//! by `shaders/emit/layers.wgsl`, which sums even matter so as well. Knows no tracer.
//!
//! Structure wants many places of a piece, along which all else changes slowly: place, motion, the redshift factor g.
//! These are found at three places, between which parabolas tell them; each place of the sum has its density, its
//! structure and its luminance for itself, and each block of four places its colour.

use super::baked::Baked;
use super::bands::When;
use super::clouds::{Carried, CloudPlace, Clouds};
use super::filaments::FILAMENT_HEIGHT;
use super::glow::ABSORPTION_INDEX;
use super::matter::VolumeMatter;
use super::medium::{Medium, own_share};
use super::shape::{INNER_FADE, OUTER_FADE, WIDEST, smooth_step};
use super::volume::Shape;
use crate::physics::blackbody::{fitted_colour, fitted_luminance, rounded_exp};
use crate::physics::flow::{Place, ZamoLight};
use crate::physics::trace::Part;

/// Layers come in blocks of so many, which GPUs sum side by side. Rounding takes so much less than all of a block that
/// has begun.
pub(crate) const BLOCK_LAYERS: f64 = 4.0;
pub(crate) const BLOCK_ROUNDING: f64 = 0.375;
/// A piece is passed over if it sends less than this share of what it might.
pub(crate) const LEAST_SEEN: f64 = 2e-5;
/// Places that send less than this share of what an opaque one does are passed over, and those that would at a factor
/// of `MOST_CLUMPED` on their density.
const LEAST_PLACE: f64 = 1e-7;
const MOST_CLUMPED: f64 = 1e3;
/// Nearer to the axis (sin^2 th) and to the horizon (1 - r+ / r) parabolas do not tell azimuth and g.
pub(crate) const ROUND_AXIS: f64 = 0.1;
pub(crate) const ROUND_HORIZON: f64 = 0.1;
/// The middles of a block's layers, as shares of it.
const MIDDLES: [f64; 4] = [0.125, 0.375, 0.625, 0.875];

/// All that changes slowly.
#[derive(Clone, Copy, Default)]
struct Slow {
    /// The share of the grid's rows, cos th, turns, and ln of the temperature seen, T g, or of g of a power law.
    place: [f64; 4],
    /// r; the column of the matter in the plane, or of a torus or halo at its densest, per share of the part, but for a
    /// disk's edges; and what of the logarithm of the density falls off as the square of a length, but for a disk's
    /// height.
    matter: [f64; 3],
}

/// A volume with structure, along a part of a ray.
pub struct Layers<'a, 'b> {
    volume: &'a VolumeMatter,
    clouds: &'a Clouds,
    baked: &'a Baked,
    when: &'a When,
    part: &'a Part<'b>,
    frequency_ratio: f64,
    /// The ray's time less that of the frame, M.
    moment: f64,
    /// The end of the piece that was summed last, as a share of the part, with the quantities there.
    last: Option<(f64, Slow)>,
}

/// The parabola through three values, at 0, in the middle and at 1: its coefficients.
fn parabola([a, b, c]: [f64; 3]) -> [f64; 3] {
    [a, 4.0 * (b - a) - (c - a), 2.0 * (c - a) - 4.0 * (b - a)]
}

impl<'a, 'b> Layers<'a, 'b> {
    /// `None` without structure.
    pub fn new(
        volume: &'a VolumeMatter,
        baked: Option<&'a Baked>,
        when: &'a When,
        part: &'a Part<'b>,
        (frequency_ratio, moment): (f64, f64),
    ) -> Option<Self> {
        let (clouds, baked) = (volume.clouds.as_ref()?, baked?);
        Some(Self { volume, clouds, baked, when, part, frequency_ratio, moment, last: None })
    }

    /// Whether parabolas tell a piece between two places (1/r, cos th).
    pub fn tells(&self, ends: [[f64; 2]; 2]) -> bool {
        let r_plus = self.part.constants.r_plus;
        let near = |[u, cos]: [f64; 2]| u * r_plus < 1.0 - ROUND_HORIZON && cos * cos < 1.0 - ROUND_AXIS;
        !self.part.to_horizon && ends.into_iter().all(near)
    }

    /// The texels of the structure that are not told from each other at a place where a pixel is `width` wide, M.
    pub fn texels_blurred(&self, r: f64, cos: f64, width: f64) -> f64 {
        self.clouds.texels_blurred(&self.volume.cloud, r, cos, width)
    }

    /// The slow quantities at the share `x` of the part.
    fn slow_at(&self, x: f64) -> Slow {
        let (c, volume) = (self.part.constants, self.volume);
        let there = self.part.at(x);
        // None is past infinity.
        let u = there.u.max(1e-9);
        let (r, cos) = (1.0 / u, there.n.z / there.n.length());
        let at = Place::on_ray(c, u, cos);
        let velocity = volume.flow.velocity(c.a, &at);
        let nu = ZamoLight::new(c, &at, there.du, there.dn.z).measured_by(velocity) / c.nu_local;
        // No motion has such a frequency where this fails; NaN fails it as well.
        let moves = nu > 0.0 && nu.is_finite() && u == there.u;
        let (g, nu) = if moves { (self.frequency_ratio / nu, nu) } else { (1.0, 0.0) };
        let delay = if self.when.delayed { c.retardation(self.part.observer, &there) } else { 0.0 };
        let azimuth = c.matter_azimuth(&there);
        let seen = CloudPlace { r, cos, azimuth, later: self.when.reference_delay - delay + self.moment };
        let [turns, row, _] = self.clouds.place(&volume.cloud, &seen, Carried::new(velocity, c.a, &at));
        let cloud = &volume.cloud;
        let mut column = nu * self.part.length(&there);
        let falls = match cloud.shape {
            Shape::Disk | Shape::Jet => {
                column *= (r / cloud.inner).powf(-cloud.slope);
                0.0
            }
            Shape::Torus => {
                let out = (r * at.sin2.sqrt() - cloud.radius) / cloud.width;
                0.5 * (out * out + (r * cos / (cloud.thickness * cloud.radius)).powi(2))
            }
            Shape::Halo => 0.5 * ((r / cloud.radius).powi(2) + (cos / cloud.thickness).powi(2)),
        };
        let glow = &volume.glow;
        let heat = glow.temperature.ln() - glow.temperature_slope * (r / glow.reference_radius).ln();
        let ln_seen = g.ln() + if glow.power_law { 0.0 } else { heat };
        Slow { place: [row, cos, turns, ln_seen], matter: [r, column, falls] }
    }

    /// Adds a piece between two shares of the part in so many layers. `blurs`: texels that are not told from each other
    /// at its ends; `dark`: what is behind such an optical depth is left out.
    pub fn add(&mut self, ends: [f64; 2], count: f64, blurs: [f64; 2], dark: f64, medium: &mut Medium) {
        let [begin, end] = ends;
        let first = match self.last {
            Some((at, slow)) if at == begin => slow,
            _ => self.slow_at(begin),
        };
        let mut slow = [first, self.slow_at(0.5 * (begin + end)), self.slow_at(end)];
        self.last = Some((end, slow[2]));
        // Turns have no seam between them.
        let [from, to, past] = slow.map(|slow| slow.place[2]);
        slow[1].place[2] = to - (to - from).round();
        slow[2].place[2] = past - (past - 2.0 * slow[1].place[2] + from).round();
        let [row, cos, turns, ln_seen] = [0, 1, 2, 3].map(|k| parabola(slow.map(|slow| slow.place[k])));
        let [r, column, falls] = [0, 1, 2].map(|k| parabola(slow.map(|slow| slow.matter[k])));
        let (cloud, glow) = (&self.volume.cloud, &self.volume.glow);
        let [heat_power, heat_log] = self.clouds.heating_powers();
        let layer_size = 1.0 / (cloud.thickness.min(WIDEST) * FILAMENT_HEIGHT);
        let size = (end - begin) / count;
        let (disk, shows) = (cloud.shape == Shape::Disk, glow.absorption.max(glow.brightness));
        let per_thickness = 1.0 / cloud.thickness;
        // No parabola tells of soft edges, of which a piece may hold the greater part. The parabola of r may pass its
        // three places by a little.
        let [nearest, farthest] =
            [f64::min, f64::max].map(|end| slow.iter().map(|s| s.matter[0]).fold(slow[0].matter[0], end));
        let begins = disk && nearest < 1.05 * INNER_FADE[1] * cloud.inner;
        let ends = disk && farthest > 0.95 * OUTER_FADE[0] * cloud.outer;
        let blocks = (count / BLOCK_LAYERS).round().max(1.0) as u32;
        for block in 0..blocks {
            if medium.depth > dark {
                return;
            }
            let share = |middle: f64| (f64::from(block) + middle) / f64::from(blocks);
            let level = (blurs[0] + (blurs[1] - blurs[0]) * share(0.5)).log2();
            let (mut light, mut heat) = (0.0, 0.0);
            for t in MIDDLES.map(share) {
                let at = |[a, b, c]: [f64; 3]| a + t * (b + t * c);
                let (r, cos) = (at(r), at(cos));
                let falls = if disk { 0.5 * (cos * per_thickness).powi(2) } else { at(falls) };
                let mut density = if r > cloud.outer { 0.0 } else { rounded_exp(-falls) };
                if begins {
                    density *= smooth_step(INNER_FADE, r / cloud.inner);
                }
                if ends {
                    density *= 1.0 - smooth_step(OUTER_FADE, r / cloud.outer);
                }
                let column = (density * at(column) * size).max(0.0);
                if column * shows * medium.through < LEAST_PLACE / MOST_CLUMPED {
                    continue;
                }
                let factor = self.baked.factor([at(turns), at(row), cos * layer_size], level);
                let column = column * factor;
                if column * shows * medium.through < LEAST_PLACE {
                    continue;
                }
                let mut ln_seen = at(ln_seen);
                let (depth, opaque) = if glow.power_law {
                    let depth = glow.absorption * column * ((ABSORPTION_INDEX + glow.spectral_index) * ln_seen).exp();
                    let sent = glow.brightness * column * ((3.0 + glow.spectral_index) * ln_seen).exp();
                    (depth, sent)
                } else {
                    ln_seen += heat_power * f64::from((factor as f32).ln()) + heat_log;
                    (glow.absorption * column, glow.brightness * fitted_luminance(ln_seen, glow.log_reference))
                };
                let left = (-depth).exp();
                // Thinner ones would be rounding.
                let share = match glow.power_law {
                    true => own_share(depth),
                    false if depth < 1e-5 => depth * (1.0 - 0.5 * depth),
                    false => 1.0 - left,
                };
                let sent = opaque * share * medium.through;
                light += sent;
                heat += sent * ln_seen;
                medium.through *= left;
                medium.depth += depth;
            }
            let colour = match glow.power_law {
                true => glow.tint,
                false => fitted_colour(heat / light.max(1e-30)),
            };
            (0..3).for_each(|k| medium.light[k] += colour[k] * light);
        }
    }
}
