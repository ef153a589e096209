// SPDX-License-Identifier: MIT OR Apache-2.0
//! The matter with depth of a frame: volumes and hot spots, prepared, and their sum along the parts of a ray. `shape`
//! has the densities, `physics::flow` the motion, `glow` the light, `medium` the equation of transfer. Knows no
//! tracer.
//!
//! Steps of a ray are as long as its curvature allows, and matter may be finer than that, so each part is cut in three
//! levels. Pieces, over which 1/r changes by 25 % and the angle by 0.25 rad at most, are told by dense output and cost
//! next to nothing; those that no matter is near are passed over. The others are clipped to where matter is, and cut
//! into cells, as many as lengths of it fit in. A cell is summed from three places, each a step of the integrator; if
//! its optical depth is more than 1, it is cut again.

use super::effects::Effects;
use super::glow::{Coefficients, Glow};
use super::hot_spot::HotSpot;
use super::medium::{GAUSS_NODES, GAUSS_WEIGHTS, Medium};
use super::shape::{Cloud, Reach, Stretch, gaussian};
use super::turbulence::When;
use super::volume::{FlowLaw, Volume};
use crate::physics::blackbody::BlackbodyTable;
use crate::physics::flow::{Flow, Motion, Place, ZamoLight};
use crate::physics::geodesic::{Constants, State, wrap_angle};
use crate::physics::orbit::horizon_outer;
use crate::physics::trace::{Part, PartCourse};
use arrayvec::ArrayVec;

/// The greatest changes over a piece: of ln r, and of the angle about the hole, rad.
pub(crate) const PIECE_LN_R: f64 = 0.25;
pub(crate) const PIECE_ANGLE: f64 = 0.25;
/// The most pieces of a part, cells of a piece, and cells that one of too great an optical depth is cut into.
pub(crate) const MOST_PIECES: f64 = 96.0;
pub(crate) const MOST_CELLS: f64 = 256.0;
pub(crate) const MOST_CUTS: f64 = 16.0;
/// Pieces bend: 1/r and cos th may be off the straight line between their ends by so much, 1/r relatively.
pub(crate) const MARGIN_U: f64 = 0.02;
pub(crate) const MARGIN_COS: f64 = 0.015;
/// Within a step 1/r may become larger than at its ends by this factor.
pub(crate) const MARGIN_STEP: f64 = 1.1;
/// The sine of theta below which cells are no finer.
pub(crate) const NEAR_AXIS: f64 = 0.01;

/// The radii at which a volume may bend, and the most between two places: those of all volumes.
const BENDS: usize = 6;
const MOST_BENDS: usize = BENDS * Volume::MOST;

/// How an observer sees the matter along a ray.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// nu(camera) / nu(local frame).
    pub frequency_ratio: f64,
    /// `LocalFrame::static_lapse`.
    pub static_lapse: Option<f64>,
}

/// How exactly the matter along rays is summed.
#[derive(Clone, Copy, Debug)]
pub struct Accuracy {
    /// Cells for each length over which matter changes.
    pub fineness: f64,
    /// The same beside places where it bends.
    pub beside_bends: f64,
    /// Thinner matter is left out; of matter that absorbs, in optical depths per M.
    pub least: f64,
    /// Matter behind so great an optical depth is left out.
    pub dark: f64,
}

impl Accuracy {
    /// For pixels: 1e-5 of a picture's peak.
    pub const PICTURE: Self = Self { fineness: 1.0, beside_bends: 1.0, least: 1e-7, dark: 18.0 };
    /// For pixels that show a number.
    pub const VIEW: Self = Self { dark: 300.0, ..Self::PICTURE };
    /// For rays whose numbers count: 1e-8 of it.
    pub const EXACT: Self = Self { fineness: 4.0, beside_bends: 16.0, least: 1e-13, dark: 300.0 };
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
}

/// A hot spot of a frame.
#[derive(Clone, Copy, Debug)]
pub struct SpotMatter {
    pub radius: f64,
    pub size: f64,
    /// Azimuth of its centre at the time `When::time`, and its change in time, towards +ph.
    pub azimuth: f64,
    pub angular_velocity: f64,
    pub reach: Reach,
    pub flow: Flow,
    pub glow: Glow,
}

/// All matter with depth of a frame.
#[derive(Clone, Debug, Default)]
pub struct Volumes {
    pub volumes: ArrayVec<VolumeMatter, { Volume::MOST }>,
    pub hot_spots: ArrayVec<SpotMatter, { HotSpot::MOST }>,
    effects: Effects,
    pub when: When,
    accuracy: Accuracy,
}

impl VolumeMatter {
    /// About a hole of spin `spin`. `None`: all of it lies inside the horizon.
    pub fn new(volume: &Volume, spin: f64, accuracy: Accuracy) -> Option<Self> {
        let least = accuracy.least / volume.absorption.max(1.0);
        // The ISCO does not depend on the law of motion.
        let circular = Motion::Keplerian { sub_keplerian: volume.sub_keplerian, infall: volume.infall };
        let flow = Flow::new(spin, volume.retrograde, circular);
        let cloud = Cloud::new(volume, flow.isco);
        let motion = match volume.flow {
            FlowLaw::Keplerian => circular,
            FlowLaw::AngularMomentum => Motion::AngularMomentum { l0: volume.angular_momentum },
            FlowLaw::Outflow => Motion::Outflow { speed: volume.speed, base: cloud.inner },
        };
        Some(Self {
            cloud,
            reach: cloud.reach(spin, least)?,
            flow: Flow { motion, ..flow },
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
        })
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
    /// About a hole of spin `spin`, as a frame shows it.
    pub fn new(spot: &HotSpot, spin: f64, when: &When) -> Self {
        let sense = if spot.retrograde { -1.0 } else { 1.0 };
        let radius = spot.radius.max(Flow::new(spin, spot.retrograde, Motion::Rigid { angular_velocity: 0.0 }).isco);
        let angular_velocity = 1.0 / (radius * radius.sqrt() + sense * spin);
        let flow = Flow::new(spin, spot.retrograde, Motion::Rigid { angular_velocity });
        let cut = HotSpot::CUT * spot.size;
        let low = (radius - cut).max(horizon_outer(spin));
        Self {
            radius,
            size: spot.size,
            azimuth: wrap_angle((spot.azimuth + sense * angular_velocity * when.time) % std::f64::consts::TAU),
            angular_velocity: sense * angular_velocity,
            reach: Reach { u: [1.0 / (radius + cut), 1.0 / low], cos: (cut / low).min(1.0) },
            flow,
            glow: Glow {
                power_law: !spot.thermal,
                absorption: spot.absorption,
                temperature: spot.temperature,
                reference_radius: 1.0,
                temperature_slope: 0.0,
                log_reference: BlackbodyTable::shared().ln_luminance(spot.temperature),
                spectral_index: spot.spectral_index,
                tint: spot.tint,
                brightness: spot.brightness,
            },
        }
    }

    /// The density at (1/r, cos th, azimuth) = (1 / `r`, `cos`, `azimuth`), `later` after `When::time`: a Gaussian of
    /// the distance from the spot's centre in chart coordinates.
    pub fn density(&self, r: f64, cos: f64, azimuth: f64, later: f64) -> f64 {
        let from = azimuth - self.azimuth - self.angular_velocity * later;
        // |x - x_s|^2 with the difference of the radii apart from the angle: no cancellation.
        let axis = r * ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt();
        let half = (0.5 * from).sin();
        let square = (axis - self.radius).powi(2) + 4.0 * axis * self.radius * half * half + (r * cos).powi(2);
        let widths = square.sqrt() / self.size;
        if widths < HotSpot::CUT { gaussian(widths) } else { 0.0 }
    }

    /// The number of cells that a stretch should be cut into.
    pub(crate) fn cells(&self, stretch: &Stretch) -> f64 {
        let [a, b] = stretch.u;
        let across = stretch.swept / a.min(b).max(1e-30);
        (1.0 / a - 1.0 / b).hypot(across) / self.size
    }
}

/// The share of a stretch, of which the straight lines between its ends lie within a reach.
pub(crate) fn clip(reach: &Reach, stretch: &Stretch) -> Option<[f64; 2]> {
    let u = [reach.u[0] * (1.0 - MARGIN_U), reach.u[1] * (1.0 + MARGIN_U)];
    let cos = reach.cos * (1.0 + MARGIN_U) + MARGIN_COS;
    let mut share = [0.0_f64, 1.0];
    for ([from, to], [low, high]) in [(stretch.u, u), (stretch.cos, [-cos, cos])] {
        let change = to - from;
        if change.abs() < 1e-12 * high {
            if from < low || from > high {
                return None;
            }
            continue;
        }
        let (a, b) = ((low - from) / change, (high - from) / change);
        share = [share[0].max(a.min(b)), share[1].min(a.max(b))];
    }
    (share[0] < share[1]).then_some(share)
}

/// The part of a ray that is being summed.
struct Sum<'a, 'b> {
    volumes: &'a Volumes,
    part: &'a Part<'b>,
    seen: &'a Seen,
}

impl Volumes {
    pub fn new(
        volumes: &[Volume],
        hot_spots: &[HotSpot],
        spin: f64,
        effects: Effects,
        when: When,
        accuracy: Accuracy,
    ) -> Self {
        let matter = |volume: &Volume| VolumeMatter::new(volume, spin, accuracy);
        Self {
            volumes: volumes.iter().filter_map(matter).take(Volume::MOST).collect(),
            hot_spots: hot_spots.iter().take(HotSpot::MOST).map(|s| SpotMatter::new(s, spin, &when)).collect(),
            effects,
            when,
            accuracy,
        }
    }

    pub fn is_empty(&self) -> bool {
        self.volumes.is_empty() && self.hot_spots.is_empty()
    }

    /// Whether the delays of the light must be known.
    pub fn needs_delay(&self) -> bool {
        self.when.delayed && !self.hot_spots.is_empty()
    }

    fn reaches(&self) -> impl Iterator<Item = &Reach> {
        self.volumes.iter().map(|v| &v.reach).chain(self.hot_spots.iter().map(|s| &s.reach))
    }

    /// The range of 1/r, outer end first, outside which there is no matter. `None`: there is none at all.
    pub fn reach_u(&self) -> Option<[f64; 2]> {
        self.reaches().map(|reach| reach.u).reduce(|[a, b], [c, d]| [a.min(c), b.max(d)])
    }

    /// Adds the matter along a part of a ray.
    pub fn along(&self, part: &Part<'_>, seen: &Seen, medium: &mut Medium) {
        let Some([outer, _]) = self.reach_u() else { return };
        if part.innermost_end() * MARGIN_STEP < outer || medium.depth > self.accuracy.dark {
            return;
        }
        let sum = Sum { volumes: self, part, seen };
        let course = part.course();
        let [first, last] = [0.0, 1.0].map(|x| course.at(x)[0]);
        let pieces = Pieces::new([first, last], part.swept(), outer * (1.0 - MARGIN_U));
        let mut at = pieces.border(0);
        let mut before = course.at(at);
        for k in 1..=pieces.count {
            let end = pieces.border(k);
            let last = course.at(end);
            let mut fineness = self.accuracy.fineness;
            for bend in self.bends_between(before[0], last[0]) {
                let there = course_reaches(&course, [at, end], bend);
                let after = course.at(there);
                sum.stretch([at, there], [before, after], self.accuracy.beside_bends, medium);
                fineness = self.accuracy.beside_bends;
                (at, before) = (there, after);
            }
            sum.stretch([at, end], [before, last], fineness, medium);
            (at, before) = (end, last);
        }
    }

    /// 1/r of the places between two at which volumes bend, in their order.
    fn bends_between(&self, from: f64, to: f64) -> ArrayVec<f64, MOST_BENDS> {
        let bends = self.volumes.iter().flat_map(|volume| volume.bends);
        let between = bends.filter(|u| (u - from) * (u - to) < 0.0);
        let mut between = between.take(MOST_BENDS).collect::<ArrayVec<_, MOST_BENDS>>();
        between.sort_by(|a, b| (a - from).abs().total_cmp(&(b - from).abs()));
        between
    }

    /// The share of a stretch that has matter, and the number of cells that it should be cut into.
    fn cells(&self, stretch: &Stretch) -> Option<([f64; 2], f64)> {
        let volumes = self.volumes.iter().filter_map(|v| Some((clip(&v.reach, stretch)?, v.cells(stretch))));
        let spots = self.hot_spots.iter().filter_map(|s| Some((clip(&s.reach, stretch)?, s.cells(stretch))));
        let all = volumes.chain(spots);
        let (share, cells) = all.reduce(|([a, b], m), ([c, d], n)| ([a.min(c), b.max(d)], m.max(n)))?;
        Some((share, cells * (share[1] - share[0])))
    }

    /// The matter at a state of a ray, per unit of affine length.
    pub fn coefficients(&self, c: &Constants, observer: &State, there: &State, seen: &Seen) -> Coefficients {
        // None is past infinity, where the last step of a ray may end, nor within the horizon.
        if !(there.u > 0.0 && there.u * c.r_plus < 1.0 - 1e-12) {
            return Coefficients::default();
        }
        let (r, cos) = (1.0 / there.u, there.n.z / there.n.length());
        let mut sum = Coefficients::default();
        let mut measured = None;
        let mut add = |flow: &Flow, glow: &Glow, density: f64| {
            let (at, light) = measured.get_or_insert_with(|| {
                let at = Place::on_ray(c, there.u, cos);
                (at, ZamoLight::new(c, &at, there.du))
            });
            let nu = flow.frequency(c, at, light) / c.nu_local;
            // Nothing can move so where this fails, NaN among it.
            if nu > 0.0 && nu.is_finite() {
                let g = seen.frequency_ratio / nu;
                let camera = seen.static_lapse.map_or(c.nu_local, |lapse| c.energy / lapse);
                let shift = self.effects.visible_shift(g, || camera / light.frequency);
                sum.add(glow.coefficients(density, r, nu, g, shift));
            }
        };
        for volume in &self.volumes {
            let density = volume.cloud.density(r, cos);
            if density >= volume.least {
                add(&volume.flow, &volume.glow, density);
            }
        }
        if !self.hot_spots.is_empty() {
            let azimuth = there.n.y.atan2(there.n.x) + there.drag;
            let delay = if self.when.delayed { c.retardation(observer, there) } else { 0.0 };
            for spot in &self.hot_spots {
                let density = spot.density(r, cos, azimuth, self.when.reference_delay - delay);
                if density > 0.0 {
                    add(&spot.flow, &spot.glow, density);
                }
            }
        }
        sum
    }
}

/// The share of a part at which 1/r is `u`, between two shares on either side of it: the secant, four times.
fn course_reaches(course: &PartCourse, [mut low, mut high]: [f64; 2], u: f64) -> f64 {
    let over = |x: f64| course.at(x)[0] - u;
    let (mut below, mut above) = (over(low), over(high));
    for _ in 0..4 {
        let x = low + (high - low) * (below / (below - above)).clamp(0.0, 1.0);
        let here = over(x);
        if here * below > 0.0 {
            (low, below) = (x, here);
        } else if here * above > 0.0 {
            (high, above) = (x, here);
        } else {
            return x;
        }
    }
    if below.abs() < above.abs() { low } else { high }
}

impl Sum<'_, '_> {
    /// Adds the stretch between two shares of the part, at which (1/r, cos th) are `ends`.
    fn stretch(&self, [begin, end]: [f64; 2], ends: [[f64; 2]; 2], fineness: f64, medium: &mut Medium) {
        let [[u, c], [v, d]] = ends;
        let stretch = Stretch { u: [u, v], cos: [c, d], swept: self.part.swept() * (end - begin) };
        if let Some(([low, high], cells)) = self.volumes.cells(&stretch) {
            let at = |share: f64| begin + (end - begin) * share;
            self.piece([at(low), at(high)], (cells * fineness).ceil().clamp(1.0, MOST_CELLS), medium);
        }
    }

    /// Adds a piece in cells.
    fn piece(&self, [begin, end]: [f64; 2], cells: f64, medium: &mut Medium) {
        let size = (end - begin) / cells;
        for i in 0..cells as u32 {
            let cell = [begin + size * f64::from(i), begin + size * f64::from(i + 1)];
            let nodes = self.nodes(cell);
            let depth: f64 = nodes.iter().zip(GAUSS_WEIGHTS).map(|(node, weight)| node.absorption * weight).sum();
            if depth <= 1.0 || medium.depth > self.volumes.accuracy.dark {
                medium.add_nodes(&nodes);
                continue;
            }
            let cuts = depth.ceil().min(MOST_CUTS);
            let size = size / cuts;
            for k in 0..cuts as u32 {
                let [begin, end] = [k, k + 1].map(|k| cell[0] + size * f64::from(k));
                medium.add_nodes(&self.nodes([begin, end]));
            }
        }
    }

    /// The coefficients of the cell between two shares of the part, each as if all of the cell were as it is there.
    fn nodes(&self, [begin, end]: [f64; 2]) -> [Coefficients; 3] {
        let part = self.part;
        GAUSS_NODES.map(|node| {
            let x = begin + (end - begin) * node;
            // Before the horizon the light of matter that does not fall grows as (u+ - u)^(-1/2), whose integral is
            // even in the square root.
            let (x, slope) = if part.to_horizon { (x * (2.0 - x), 2.0 * (1.0 - x)) } else { (x, 1.0) };
            let there = part.at(x);
            let found = self.volumes.coefficients(part.constants, part.observer, &there, self.seen);
            if found == Coefficients::default() {
                return found;
            }
            found.along(slope * (end - begin) * part.length(&there))
        })
    }
}

/// The borders of the pieces of a part: where 1/r, if it went evenly, would change by one factor from piece to piece.
struct Pieces {
    count: u32,
    /// The shares of the part at which pieces begin and end, and the ratio of 1/r there.
    ends: [f64; 2],
    ratio: f64,
}

impl Pieces {
    /// `u`: 1/r at the ends of the part; `swept`: its angle; nothing is where 1/r is less than `outer`.
    fn new([u, v]: [f64; 2], swept: f64, outer: f64) -> Self {
        let share = |at: f64| (outer - at) / (v - u);
        let begin = if u < outer && v > outer { share(u).abs() } else { 0.0 };
        let end = if v < outer && u > outer { share(u).abs() } else { 1.0 };
        let ratio = v.max(outer) / u.max(outer);
        let count = (ratio.ln().abs() / PIECE_LN_R).max(swept / PIECE_ANGLE).ceil().clamp(1.0, MOST_PIECES);
        Self { count: count as u32, ends: [begin, end], ratio }
    }

    fn border(&self, k: u32) -> f64 {
        let even = f64::from(k) / f64::from(self.count);
        let rise = self.ratio - 1.0;
        let share = if rise.abs() < 1e-6 { even } else { (self.ratio.powf(even) - 1.0) / rise };
        self.ends[0] + (self.ends[1] - self.ends[0]) * share
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::orbit::isco;

    /// Pieces follow each other from where matter may be to where it ends, and none is longer than it may be.
    #[test]
    fn pieces_cover_a_part_evenly() {
        for (u, v, swept) in
            [(1e-6, 0.05, 0.2), (0.05, 1e-9, 0.01), (0.1, 0.1, 0.6), (0.3, -0.02, 0.25), (0.2, 0.3, 0.0)]
        {
            let outer = 0.01;
            let pieces = Pieces::new([u, v], swept, outer);
            let at = |k: u32| u + (v - u) * pieces.border(k);
            let within = |u: f64| u.max(outer);
            assert!((at(0) - within(u)).abs() < 1e-12 && (at(pieces.count) - within(v)).abs() < 1e-12, "{u} {v}");
            for k in 0..pieces.count {
                assert!(pieces.border(k) < pieces.border(k + 1), "{u} {v} {k}");
                assert!((at(k + 1) / at(k)).ln().abs() < PIECE_LN_R * 1.001, "{u} {v} {k}");
                assert!(swept / f64::from(pieces.count) < PIECE_ANGLE * 1.001, "{u} {v}");
            }
        }
    }

    /// Nothing that lies within a reach is clipped away, and of a long stretch what is far from it is.
    #[test]
    fn clipping_keeps_the_reach() {
        let reach = Reach { u: [0.1, 0.2], cos: 0.3 };
        let clipped = |u: [f64; 2], cos: [f64; 2]| clip(&reach, &Stretch { u, cos, swept: 0.1 });
        assert_eq!(clipped([0.12, 0.15], [0.1, -0.2]), Some([0.0, 1.0]));
        assert_eq!(clipped([0.01, 0.09], [0.0, 0.0]), None);
        assert_eq!(clipped([0.15, 0.15], [0.4, 0.9]), None);
        let [low, high] = clipped([0.05, 0.45], [0.0, 0.0]).unwrap();
        assert!(low < 0.125 && low > 0.1 && high > 0.375 && high < 0.4, "{low} {high}");
        let [low, high] = clipped([0.15, 0.16], [-1.0, 1.0]).unwrap();
        assert!(low < 0.35 && low > 0.3 && high > 0.65 && high < 0.7, "{low} {high}");
    }

    /// A spot moves along its circular geodesic, either way, and none orbits inside the ISCO.
    #[test]
    fn spots_are_on_circular_geodesics() {
        let spin = 0.7;
        for (retrograde, sense) in [(false, 1.0), (true, -1.0)] {
            let spot = HotSpot { retrograde, radius: 9.0, azimuth: 0.3, ..HotSpot::default() };
            let when = When { time: 1e4, ..When::default() };
            let matter = SpotMatter::new(&spot, spin, &when);
            let omega = sense / (27.0 + sense * spin);
            assert!((matter.angular_velocity / omega - 1.0).abs() < 1e-14);
            for later in [-40.0, 0.0, 13.0] {
                let azimuth = 0.3 + omega * (1e4 + later);
                assert!((matter.density(9.0, 0.0, azimuth, later) - 1.0).abs() < 1e-9, "{later}");
                let beside = matter.density(9.0 + spot.size, 0.0, azimuth, later);
                assert!((beside - gaussian(1.0)).abs() < 1e-9, "{later}: {beside}");
                assert_eq!(matter.density(9.0, 0.0, azimuth + 2.0, later), 0.0);
            }
            let inner = SpotMatter::new(&HotSpot { radius: 1.0, ..spot }, spin, &when);
            assert_eq!(inner.radius, isco(sense * spin));
        }
    }
}
