// SPDX-License-Identifier: MIT OR Apache-2.0
//! The matter with depth of a frame: volumes and hot spots, prepared, and their sum along the parts of a ray. `shape`
//! has the densities, `physics::flow` the motion, `glow` the light, `medium` the equation of transfer. Knows no tracer.
//!
//! Steps of a ray are as long as its curvature allows, and matter may be finer than that, so each part is sampled in
//! three levels. Pieces, over which 1/r changes by 15 % and the angle by 0.2 rad at most, are told by dense output and
//! cost next to nothing; those that no matter is near are passed over. The others are clipped to where matter is, and
//! cut into cells, as many as lengths of it fit in. A cell has three samples, each a step of the integrator; if its
//! optical depth is more than 1, it is cut again.

use super::bands::When;
use super::clouds::{Blur, CloudPlace, Clouds, Structure, bend, footprint};
use super::effects::Effects;
use super::filaments::Filaments;
use super::glow::{Glow, Sample};
use super::hot_spot::HotSpot;
use super::medium::{GAUSS_NODES, GAUSS_WEIGHTS, Medium};
use super::shape::{Cloud, Reach, Stretch, gaussian};
use super::volume::{FlowLaw, Volume};
use crate::error::Result;
use crate::physics::blackbody::BlackbodyTable;
use crate::physics::flow::{Flow, Motion, Place, Velocity, ZamoLight};
use crate::physics::geodesic::{Constants, State, wrap_angle};
use crate::physics::orbit::horizon_outer;
use crate::physics::trace::{Part, PartCourse};
use arrayvec::ArrayVec;

/// The greatest changes over a piece: of ln r, and of the angle about the hole, rad.
const PIECE_LN_R: f64 = 0.15;
const PIECE_ANGLE: f64 = 0.2;
/// The most pieces of a part, cells of a piece, and cells that one of too great an optical depth is cut into.
const MOST_PIECES: f64 = 96.0;
const MOST_CELLS: f64 = 256.0;
const MOST_CUTS: f64 = 16.0;
/// Pieces bend: 1/r and cos th may be off the straight line between their ends by so much, 1/r relatively.
const MARGIN_U: f64 = 0.02;
const MARGIN_COS: f64 = 0.01;
/// Within a step 1/r may become larger than at its ends by this factor.
const MARGIN_STEP: f64 = 1.1;
/// The sine of theta below which cells are no finer.
const NEAR_AXIS: f64 = 0.01;
/// Thinner matter is left out.
const LEAST_DENSITY: f64 = 1e-13;
/// Matter behind so great an optical depth is not seen.
const DARK: f64 = 300.0;

/// How an observer sees the matter along a ray.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// nu(camera) / nu(local frame).
    pub frequency_ratio: f64,
    /// `LocalFrame::static_lapse`.
    pub static_lapse: Option<f64>,
    /// Cells for every cell that a picture needs.
    pub fineness: f64,
    /// The angle of a pixel, in the local frame: finer structure is left out. 0: none is.
    pub pixel_angle: f64,
    /// The angle about the hole that the ray has swept so far.
    pub swept: f64,
}

impl Seen {
    /// Cells of rays whose numbers count, for each of a pixel's.
    pub const EXACT: f64 = 4.0;

    /// The width of a pixel at a place of the ray, M: by the distance in the chart, which frame-dragging does not
    /// change.
    fn footprint(&self, c: &Constants, observer: &State, there: &State) -> f64 {
        if self.pixel_angle <= 0.0 {
            return 0.0;
        }
        let place = |state: &State| state.n.normalize() / state.u;
        let (b, passed) = (c.k.max(0.0).sqrt() / c.energy.abs().max(1e-3), observer.du > 0.0 && there.du < 0.0);
        let (from, to) = (1.0 / observer.u, 1.0 / there.u);
        let bend = bend(self.swept, b, from, to, passed);
        footprint(self.pixel_angle, place(observer).distance(place(there)), b, from, to, bend)
    }

    /// The same `share` of a part farther along the ray. N turns by sqrt(K) per tau.
    pub fn after(&self, part: &Part<'_>, share: f64) -> Self {
        let turned = part.swept() * (part.constants.k.max(0.0).sqrt() / part.constants.scale).min(1.0);
        Self { swept: self.swept + share * turned, ..*self }
    }
}

/// Texels of the structure of each volume.
pub type Passed = ArrayVec<f64, { Volume::MOST }>;

/// A volume of a frame.
#[derive(Clone, Copy, Debug)]
pub struct VolumeMatter {
    pub cloud: Cloud,
    pub reach: Reach,
    pub flow: Flow,
    pub glow: Glow,
    /// `None`: it is even.
    pub clouds: Option<Clouds>,
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
    when: When,
}

impl VolumeMatter {
    /// About a hole of spin `spin`. `None`: all of it lies inside the horizon, or nothing of it would be seen.
    pub fn new(volume: &Volume, spin: f64, when: &When) -> Option<Self> {
        // The ISCO does not depend on the law of motion.
        let circular = Motion::Keplerian { sub_keplerian: volume.sub_keplerian, infall: volume.infall };
        let flow = Flow::new(spin, volume.retrograde, circular);
        let cloud = Cloud::new(volume, flow.isco);
        let motion = match volume.flow {
            FlowLaw::Keplerian => circular,
            FlowLaw::AngularMomentum => Motion::AngularMomentum { l0: volume.angular_momentum },
            FlowLaw::Outflow => Motion::Outflow { speed: volume.speed, base: cloud.inner },
        };
        let (reach, flow) = (cloud.reach(spin)?, Flow { motion, ..flow });
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
            clouds: Clouds::new(volume, &cloud, &reach, &flow, spin, when),
        })
    }

    /// The number of cells that a stretch should be cut into.
    fn cells(&self, stretch: &Stretch) -> f64 {
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
    pub fn new(spot: &HotSpot, spin: f64, when: &When) -> Option<Self> {
        let sense = if spot.retrograde { -1.0 } else { 1.0 };
        let radius = spot.radius.max(Flow::new(spin, spot.retrograde, Motion::Rigid { angular_velocity: 0.0 }).isco);
        let angular_velocity = 1.0 / (radius * radius.sqrt() + sense * spin);
        let flow = Flow::new(spin, spot.retrograde, Motion::Rigid { angular_velocity });
        let cut = HotSpot::CUT * spot.size;
        let low = (radius - cut).max(horizon_outer(spin));
        Some(Self {
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
        let widths = square.sqrt() / self.size;
        if widths < HotSpot::CUT { gaussian(widths) } else { 0.0 }
    }

    /// The number of cells that a stretch should be cut into.
    fn cells(&self, stretch: &Stretch) -> f64 {
        let [a, b] = stretch.u;
        let across = stretch.swept / a.min(b).max(1e-30);
        (1.0 / a - 1.0 / b).hypot(across) / self.size
    }
}

/// The share of a stretch, of which the straight lines between its ends lie within a reach.
fn clip(reach: &Reach, stretch: &Stretch) -> Option<[f64; 2]> {
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
    pub fn new(volumes: &[Volume], hot_spots: &[HotSpot], spin: f64, effects: Effects, when: When) -> Self {
        Self {
            volumes: volumes.iter().filter_map(|v| VolumeMatter::new(v, spin, &when)).take(Volume::MOST).collect(),
            hot_spots: hot_spots.iter().filter_map(|s| SpotMatter::new(s, spin, &when)).take(HotSpot::MOST).collect(),
            effects,
            when,
        }
    }

    pub fn is_empty(&self) -> bool {
        self.volumes.is_empty() && self.hot_spots.is_empty()
    }

    /// Whether the delays of the light must be known.
    pub fn needs_delay(&self) -> bool {
        self.when.delayed && self.changes()
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
        if part.innermost_end() * MARGIN_STEP < outer || medium.depth > DARK {
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
            for bend in self.bends_between(before[0], last[0]) {
                let there = course_reaches(&course, [at, end], bend);
                let after = course.at(there);
                sum.stretch([at, there], [before, after], medium);
                (at, before) = (there, after);
            }
            sum.stretch([at, end], [before, last], medium);
            (at, before) = (end, last);
        }
    }

    /// 1/r of the ISCOs between two places, in their order: there matter begins to fall, as (r_I - r)^(3/2), and cells
    /// that reach across lose an order or more.
    fn bends_between(&self, from: f64, to: f64) -> ArrayVec<f64, { Volume::MOST }> {
        let falls = |flow: &Flow| matches!(flow.motion, Motion::Keplerian { .. });
        let bends = self.volumes.iter().filter(|v| falls(&v.flow)).map(|v| 1.0 / v.flow.isco);
        let mut between = bends.filter(|u| (u - from) * (u - to) < 0.0).collect::<ArrayVec<_, { Volume::MOST }>>();
        between.sort_by(|a, b| (a - from).abs().total_cmp(&(b - from).abs()));
        between
    }

    /// The share of a stretch that has matter, and the number of cells that it should be cut into. `footprint`: how
    /// wide a pixel is there; `passed`: the texels that it passes of each volume's structure; `fineness`: of `Seen`.
    fn cells(&self, stretch: &Stretch, footprint: f64, passed: &Passed, fineness: f64) -> Option<([f64; 2], f64)> {
        let r = 2.0 / (stretch.u[0] + stretch.u[1]);
        let volumes = self.volumes.iter().zip(passed).filter_map(|(v, passed)| {
            // Three samples a cell. Structure is rough: finer cells gain less there than the sixth order in them.
            let samples = v.clouds.map_or(0.0, |clouds| clouds.samples(&v.cloud, *passed, r, footprint));
            Some((clip(&v.reach, stretch)?, (v.cells(stretch) * fineness).max(samples / 3.0 * fineness.sqrt())))
        });
        let spots = self.hot_spots.iter().filter_map(|s| Some((clip(&s.reach, stretch)?, s.cells(stretch) * fineness)));
        let all = volumes.chain(spots);
        let (share, cells) = all.reduce(|([a, b], m), ([c, d], n)| ([a.min(c), b.max(d)], m.max(n)))?;
        Some((share, cells * (share[1] - share[0])))
    }

    /// Whether matter that moves, and is not the same all around, is seen as it was when its light left.
    fn changes(&self) -> bool {
        !self.hot_spots.is_empty() || self.volumes.iter().any(|v| v.clouds.is_some())
    }

    /// The matter at a state of a ray, per unit of affine length. `passed`: texels of each volume's structure from
    /// sample to sample.
    pub fn sample(&self, c: &Constants, observer: &State, there: &State, seen: &Seen, passed: &Passed) -> Sample {
        // None is past infinity, where the last step of a ray may end, nor within the horizon.
        if !(there.u > 0.0 && there.u * c.r_plus < 1.0 - 1e-12) {
            return Sample::default();
        }
        let (r, cos) = (1.0 / there.u, there.n.z / there.n.length());
        let mut sum = Sample::default();
        let mut measured = None;
        let mut moment = None;
        let mut moment = || {
            *moment.get_or_insert_with(|| {
                let delay = if self.when.delayed { c.retardation(observer, there) } else { 0.0 };
                (there.n.y.atan2(there.n.x) + there.drag, self.when.reference_delay - delay)
            })
        };
        let mut measure = || {
            *measured.get_or_insert_with(|| {
                let at = Place::new(c.a, there.u, cos);
                (at, ZamoLight::new(c, &at, there.du))
            })
        };
        let mut add = |light: &ZamoLight, velocity: Velocity, glow: &Glow, density: f64, heat: f64| {
            let nu = light.measured_by(velocity) / c.nu_local;
            // Nothing can move so where this fails, NaN among it.
            if nu > 0.0 && nu.is_finite() {
                let g = seen.frequency_ratio / nu;
                let camera = seen.static_lapse.map_or(c.nu_local, |lapse| c.energy / lapse);
                let shift = self.effects.visible_shift(g, || camera / light.frequency);
                sum.add(glow.sample(density, heat, r, nu, g, shift));
            }
        };
        for (volume, passed) in self.volumes.iter().zip(passed) {
            let even = volume.cloud.density(r, cos);
            if even < LEAST_DENSITY {
                continue;
            }
            let (at, light) = measure();
            let velocity = volume.flow.velocity(c.a, &at);
            let structure = match (volume.clouds, Filaments::shared()) {
                (Some(clouds), Ok(filaments)) => {
                    let (azimuth, later) = moment();
                    let omega = velocity.angular_velocity(c.a, &at);
                    let blur = Blur { footprint: seen.footprint(c, observer, there), spacing: *passed };
                    clouds.pattern(filaments, &volume.cloud, &CloudPlace { r, cos, azimuth, later }, omega, blur)
                }
                _ => Structure::NONE,
            };
            add(&light, velocity, &volume.glow, even * structure.density, structure.heat);
        }
        for spot in &self.hot_spots {
            let (azimuth, later) = moment();
            let density = spot.density(r, cos, azimuth, later);
            if density >= LEAST_DENSITY {
                let (at, light) = measure();
                add(&light, spot.flow.velocity(c.a, &at), &spot.glow, density, 1.0);
            }
        }
        sum
    }

    /// Makes the structure of the matter, if there is any, so that `along` has it. Errors: OUT_OF_MEMORY.
    pub fn prepare(&self) -> Result<()> {
        if self.volumes.iter().any(|v| v.clouds.is_some()) { Filaments::shared().map(|_| ()) } else { Ok(()) }
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
    fn stretch(&self, [begin, end]: [f64; 2], ends: [[f64; 2]; 2], medium: &mut Medium) {
        let [[u, c], [v, d]] = ends;
        let stretch = Stretch { u: [u, v], cos: [c, d], swept: self.part.swept() * (end - begin) };
        let of_volume = |v: &VolumeMatter| v.clouds.map_or(0.0, |clouds| clouds.passed(&v.cloud, &stretch));
        let passed = self.volumes.volumes.iter().map(of_volume).collect::<Passed>();
        let footprint = if passed.iter().any(|passed| *passed > 0.0) {
            let middle = 0.5 * (begin + end);
            let seen = self.seen.after(self.part, middle);
            seen.footprint(self.part.constants, self.part.observer, &self.part.at(middle))
        } else {
            0.0
        };
        if let Some(([low, high], cells)) = self.volumes.cells(&stretch, footprint, &passed, self.seen.fineness) {
            let at = |share: f64| begin + (end - begin) * share;
            let cells = cells.ceil().clamp(1.0, MOST_CELLS);
            let apart = passed.iter().map(|passed| passed * (high - low) / (3.0 * cells)).collect();
            self.piece([at(low), at(high)], cells, &apart, medium);
        }
    }

    /// Adds a piece in cells; `passed`: texels of each volume's structure from sample to sample.
    fn piece(&self, [begin, end]: [f64; 2], cells: f64, passed: &Passed, medium: &mut Medium) {
        let size = (end - begin) / cells;
        for i in 0..cells as u32 {
            let cell = [begin + size * f64::from(i), begin + size * f64::from(i + 1)];
            let nodes = self.nodes(cell, passed);
            let depth: f64 = nodes.iter().zip(GAUSS_WEIGHTS).map(|(node, weight)| node.absorption * weight).sum();
            if depth <= 1.0 || medium.depth > DARK {
                medium.add_nodes(&nodes);
                continue;
            }
            let cuts = depth.ceil().min(MOST_CUTS);
            let size = size / cuts;
            for k in 0..cuts as u32 {
                let [begin, end] = [k, k + 1].map(|k| cell[0] + size * f64::from(k));
                medium.add_nodes(&self.nodes([begin, end], passed));
            }
        }
    }

    /// The samples of the cell between two shares of the part, each as if all of the cell were as it is there.
    fn nodes(&self, [begin, end]: [f64; 2], passed: &Passed) -> [Sample; 3] {
        let part = self.part;
        GAUSS_NODES.map(|node| {
            let x = begin + (end - begin) * node;
            // Before the horizon the light of matter that does not fall grows as (u+ - u)^(-1/2), whose integral is
            // even in the square root.
            let (x, slope) = if part.to_horizon { (x * (2.0 - x), 2.0 * (1.0 - x)) } else { (x, 1.0) };
            let there = part.at(x);
            let seen = self.seen.after(part, x);
            let sample = self.volumes.sample(part.constants, part.observer, &there, &seen, passed);
            if sample == Sample::default() {
                return sample;
            }
            sample.along(slope * (end - begin) * part.length(&there))
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
