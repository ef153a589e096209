// SPDX-License-Identifier: MIT OR Apache-2.0
//! Volumes and hot spots as a frame shows them: their settings with all that depends on the hole, on time and on how
//! exactly they are summed. `volumes` sums them. Knows no ray and no tracer.

use super::baking::BakeKey;
use super::bands::When;
use super::clouds::Clouds;
use super::free_spot::{Centre, FreeCentre};
use super::glow::Glow;
use super::hot_spot::HotSpot;
use super::shape::{Cloud, Reach, Stretch, gaussian};
use super::volume::{FlowLaw, Shape, Volume};
use crate::physics::blackbody::BlackbodyTable;
use crate::physics::flow::{Flow, Motion};
use crate::physics::geodesic::{Constants, turned, wrap_angle};
use crate::physics::orbit::{horizon_inner, horizon_outer};
use crate::physics::rain::OffsetSeries;
use crate::physics::rain_motion::rain_velocity;
use glam::DVec3;
use std::sync::Arc;

/// The radii at which a volume may bend.
pub(super) const BENDS: usize = 6;
/// The sine of theta below which cells are no finer.
pub(crate) const NEAR_AXIS: f64 = 0.01;
/// Structure is so many times denser here and there than matter without it.
pub(crate) const CLUMPED: f64 = 10.0;

/// Structure has texels where Gaussians are at least this; beyond, the last ones go on.
const LEAST_STRUCTURED: f64 = 1e-6;

/// 1 - r+ / r is at least this where cells are counted: nearer, no light shows.
pub(crate) const LEAST_BESIDE: f64 = 1e-5;

/// How exactly the matter along rays is summed.
#[derive(Clone, Copy, Debug)]
pub struct Accuracy {
    /// Cells for each length over which matter changes.
    pub fineness: f64,
    /// Cells for each such length beside places where matter bends.
    pub beside_bends: f64,
    /// Whether stretches that have structure are summed in even layers, not in cells: structure is so rough that
    /// polynomials gain nothing.
    pub layers: bool,
    /// Whether a volume that is alone may be summed as GPUs do it fastest (shaders/emit/layers.wgsl).
    pub alone: bool,
    /// Thinner matter is left out; of matter that absorbs, in optical depths per M.
    pub least: f64,
    /// Matter behind so great an optical depth is left out.
    pub dark: f64,
}

impl Accuracy {
    /// For pixels: matter is thinner than `least` beyond 4.8 widths of its Gaussian.
    pub const PICTURE: Self =
        Self { fineness: 1.0, beside_bends: 1.0, layers: true, alone: true, least: 1e-5, dark: 12.0 };
    /// For pixels that show a number.
    pub const VIEW: Self = Self { dark: 300.0, alone: false, ..Self::PICTURE };
    /// For rays whose numbers count: 1e-8 of it.
    pub const EXACT: Self =
        Self { fineness: 4.0, beside_bends: 16.0, layers: false, alone: false, least: 1e-13, dark: 300.0 };
}

impl Default for Accuracy {
    fn default() -> Self {
        Self::PICTURE
    }
}

/// A volume of a frame.
#[derive(Clone, Copy, Debug)]
pub struct VolumeMatter {
    pub cloud: Cloud,
    pub reach: Reach,
    pub flow: Flow,
    pub glow: Glow,
    /// 1/r where cells that reach across would lose an order or more: at the bends of the density, and at the ISCO,
    /// where matter begins to fall as (r_I - r)^(3/2). Infinite for none.
    pub bends: [f64; BENDS],
    /// Thinner matter is left out.
    pub least: f64,
    /// `None`: it is even.
    pub clouds: Option<Clouds>,
}

/// A hot spot of a frame.
#[derive(Clone, Debug)]
pub struct SpotMatter {
    /// That of its orbit; 0 in free fall.
    pub radius: f64,
    /// In free fall: r+, and the rain time that light takes outwards from beside the horizon while 1 - r+ / r
    /// grows by e: 4 r+ / (r+ - r-). In that time the spot moves on.
    pub lingers: Option<[f64; 2]>,
    pub size: f64,
    /// Azimuth of its centre at the time `When::time`, and its change in time, towards +ph.
    pub azimuth: f64,
    pub angular_velocity: f64,
    pub reach: Reach,
    /// The motion of one on a circle.
    pub flow: Flow,
    pub glow: Glow,
    /// The centre of one in free fall.
    pub free: Option<Arc<FreeCentre>>,
}

/// A place outside the horizon where spots in free fall may be.
#[derive(Clone, Copy, Debug)]
pub struct FreePlace {
    pub u: f64,
    /// cos th.
    pub cos: f64,
    /// Boyer and Lindquist's.
    pub azimuth: f64,
    /// Time t since `When::time`; `None`: light takes no time, and all is seen where it is at that of the ray.
    pub later: Option<f64>,
    /// The ray's time less that of the frame, M.
    pub moment: f64,
}

impl VolumeMatter {
    /// About a hole of spin `spin`. `None`: all of it lies inside the horizon.
    pub fn new(volume: &Volume, spin: f64, when: &When, accuracy: Accuracy) -> Option<Self> {
        // The more of it shows, the thinner matter may be.
        let least = accuracy.least / volume.absorption.max(volume.brightness).max(1.0);
        // The ISCO does not depend on the law of motion.
        let circular = Motion::Keplerian { sub_keplerian: volume.sub_keplerian, infall: volume.infall };
        let flow = Flow::new(spin, volume.retrograde, circular);
        let cloud = Cloud::new(volume, flow.isco);
        let motion = match volume.flow {
            FlowLaw::Keplerian => circular,
            FlowLaw::AngularMomentum => Motion::AngularMomentum { l0: volume.angular_momentum },
            FlowLaw::Outflow => Motion::Outflow { speed: volume.speed, base: cloud.inner },
        };
        let (reach, flow) = (cloud.reach(spin, least)?, Flow { motion, ..flow });
        // However exactly it is summed, structure has the same texels.
        let structured = cloud.reach(spin, LEAST_STRUCTURED)?;
        Some(Self {
            cloud,
            reach,
            flow,
            glow: Glow {
                power_law: volume.power_law,
                absorption: volume.absorption,
                temperature: volume.temperature,
                reference_radius: cloud.reference_radius(),
                temperature_slope: volume.temperature_slope,
                log_reference: BlackbodyTable::shared().ln_luminance(volume.temperature),
                spectral_index: volume.spectral_index,
                tint: volume.tint,
                brightness: volume.brightness,
            },
            bends: {
                let [a, b, c, d, e] = cloud.bends();
                let falls = if volume.flow == FlowLaw::Keplerian { flow.isco } else { 0.0 };
                [a, b, c, d, e, falls].map(|r| 1.0 / r)
            },
            least,
            clouds: Clouds::new(volume, &cloud, &structured, &flow, spin, when),
        })
    }

    /// The key of its structure about a hole of spin `spin`, as far as it is seen from `r` by pixels of an angle of
    /// `pixel_angle`; 0: all of it. `None`: it is even.
    pub fn bake_key(&self, spin: f64, r: f64, pixel_angle: f64) -> Option<BakeKey> {
        let (clouds, cloud, flow) = (self.clouds?, self.cloud, self.flow);
        Some(BakeKey { clouds, cloud, flow, spin, finest: clouds.finest_seen(r, pixel_angle) })
    }

    /// How much of the light it may send that a stretch sends, at most, if it were even: of a blackbody that goes with
    /// the optical depth, of a power law with the density.
    pub(crate) fn weight(&self, stretch: &Stretch) -> f64 {
        let ([u, v], [c, d], [r, middle]) = (stretch.u, stretch.cos, stretch.middle());
        let density = |r: f64, cos: f64| self.cloud.density(r, cos);
        // All shapes but jets are densest nearest to the plane.
        let between = if self.cloud.shape == Shape::Jet { middle } else { 0.0_f64.clamp(c.min(d), c.max(d)) };
        let most = density(1.0 / u, c).max(density(1.0 / v, d)).max(density(r, between));
        match self.glow.power_law {
            true => most.min(1.0),
            false => 1.0 - (-CLUMPED * self.glow.absorption * most * stretch.length()).exp(),
        }
    }

    /// The number of cells that a stretch should be cut into.
    pub(crate) fn cells(&self, stretch: &Stretch) -> f64 {
        let [a, b] = stretch.cos;
        let sin2 = 1.0 - (a * a).max(b * b);
        // Velocities by angular momentum go as sqrt(R), which bends without end towards the axis.
        let bends = matches!(self.flow.motion, Motion::AngularMomentum { .. });
        let beside_axis = if bends { 0.5 * stretch.swept / sin2.max(NEAR_AXIS * NEAR_AXIS).sqrt() } else { 0.0 };
        self.cloud.cells(stretch) + beside_axis
    }
}

impl SpotMatter {
    /// About a hole of spin `spin`, as a frame shows it. `series`: the offsets of Doran's chart, for spots in free
    /// fall. `None`: its centre is nowhere at the time.
    pub fn new(spot: &HotSpot, spin: f64, when: &When, series: Option<&OffsetSeries>) -> Option<Self> {
        let sense = if spot.retrograde { -1.0 } else { 1.0 };
        let glow = Glow {
            power_law: !spot.thermal,
            absorption: spot.absorption,
            temperature: spot.temperature,
            reference_radius: 1.0,
            temperature_slope: 0.0,
            log_reference: BlackbodyTable::shared().ln_luminance(spot.temperature),
            spectral_index: spot.spectral_index,
            tint: spot.tint,
            brightness: spot.brightness,
        };
        if let Some(body) = &spot.free {
            let centre = FreeCentre::new(spin, body, spot.size, series?, when)?;
            // One that is too small for the samples along rays from far away is shown wider.
            let size = spot.size.max(HotSpot::SMALLEST * centre.r);
            let ([low, high], cos) = centre.reach(HotSpot::CUT * size, horizon_outer(spin));
            let (r_plus, r_minus) = (horizon_outer(spin), horizon_inner(spin));
            return Some(Self {
                radius: 0.0,
                lingers: Some([r_plus, 4.0 * r_plus / (r_plus - r_minus)]),
                size,
                azimuth: 0.0,
                angular_velocity: 0.0,
                reach: Reach { u: [1.0 / high, 1.0 / low], cos },
                flow: Flow::new(spin, false, Motion::Rigid { angular_velocity: 0.0 }),
                glow,
                free: Some(Arc::new(centre)),
            });
        }
        let radius = spot.radius.max(Flow::new(spin, spot.retrograde, Motion::Rigid { angular_velocity: 0.0 }).isco);
        let angular_velocity = 1.0 / (radius * radius.sqrt() + sense * spin);
        let flow = Flow::new(spin, spot.retrograde, Motion::Rigid { angular_velocity });
        let cut = HotSpot::CUT * spot.size;
        let low = (radius - cut).max(horizon_outer(spin));
        Some(Self {
            radius,
            lingers: None,
            size: spot.size,
            azimuth: wrap_angle((spot.azimuth + sense * angular_velocity * when.time) % std::f64::consts::TAU),
            angular_velocity: sense * angular_velocity,
            reach: Reach { u: [1.0 / (radius + cut), 1.0 / low], cos: (cut / low).min(1.0) },
            flow,
            glow,
            free: None,
        })
    }

    /// The density at (1/r, cos th, azimuth) = (1 / `r`, `cos`, `azimuth`), `later` after `When::time`: a Gaussian of
    /// the distance from the spot's centre in chart coordinates.
    pub fn density(&self, r: f64, cos: f64, azimuth: f64, later: f64) -> f64 {
        let from = azimuth - self.azimuth - self.angular_velocity * later;
        // |x - x_s|^2 with the difference of the radii apart from the angle: no cancellation.
        let axis = r * ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt();
        let half = (0.5 * from).sin();
        let square = (axis - self.radius).powi(2) + 4.0 * axis * self.radius * half * half + (r * cos).powi(2);
        self.density_at(square)
    }

    /// The density of a spot in free fall at a place, and the velocity of its matter as the rain observer there sees
    /// it. `series`: the offsets of Doran's chart. `None`: there is none of it.
    pub fn free_at(&self, c: &Constants, series: &OffsetSeries, there: &FreePlace) -> Option<(f64, DVec3)> {
        let offsets = series.at(there.u, 1.0 - there.u * c.r_plus);
        let free = self.free.as_ref()?;
        let centre = free.at(there.later.map_or(there.moment * free.pace, |later| later + offsets.time))?;
        let sin = ((1.0 - there.cos) * (1.0 + there.cos)).max(0.0).sqrt();
        let place = turned(DVec3::new(sin, 0.0, there.cos) / there.u, there.azimuth + offsets.azimuth);
        let density = self.free_density(place, &centre);
        (density > 0.0).then(|| (density, rain_velocity(c.a, centre.position, centre.rate)))
    }

    /// The density at a place of Doran's chart, of one in free fall.
    pub fn free_density(&self, place: DVec3, centre: &Centre) -> f64 {
        centre.share * self.density_at(place.distance_squared(centre.position))
    }

    /// The density at the square of a distance from the centre.
    fn density_at(&self, square: f64) -> f64 {
        let widths = square.sqrt() / self.size;
        if widths < HotSpot::CUT { gaussian(widths) } else { 0.0 }
    }

    /// The number of cells that a stretch should be cut into.
    pub(crate) fn cells(&self, stretch: &Stretch) -> f64 {
        let [a, b] = stretch.u;
        let across = stretch.swept / a.min(b).max(1e-30);
        let passed = self.lingers.map_or(0.0, |[r_plus, time]| {
            let [beside, before] = [a, b].map(|u| (1.0 - r_plus * u).max(LEAST_BESIDE));
            time * (beside / before).ln().abs()
        });
        ((1.0 / a - 1.0 / b).hypot(across) + passed) / self.size
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::orbit::isco;

    /// A spot moves along its circular geodesic, either way, and none orbits inside the ISCO.
    #[test]
    fn spots_are_on_circular_geodesics() {
        let spin = 0.7;
        for (retrograde, sense) in [(false, 1.0), (true, -1.0)] {
            let spot = HotSpot { retrograde, radius: 9.0, azimuth: 0.3, ..HotSpot::default() };
            let when = When { time: 1e4, ..When::default() };
            let new = |spot: &HotSpot| SpotMatter::new(spot, spin, &when, None).unwrap();
            let matter = new(&spot);
            let omega = sense / (27.0 + sense * spin);
            assert!((matter.angular_velocity / omega - 1.0).abs() < 1e-14);
            for later in [-40.0, 0.0, 13.0] {
                let azimuth = 0.3 + omega * (1e4 + later);
                assert!((matter.density(9.0, 0.0, azimuth, later) - 1.0).abs() < 1e-9, "{later}");
                let beside = matter.density(9.0 + spot.size, 0.0, azimuth, later);
                assert!((beside - gaussian(1.0)).abs() < 1e-9, "{later}: {beside}");
                assert_eq!(matter.density(9.0, 0.0, azimuth + 2.0, later), 0.0);
            }
            let inner = new(&HotSpot { radius: 1.0, ..spot });
            assert_eq!(inner.radius, isco(sense * spin));
        }
    }
}
