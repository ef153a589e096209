// SPDX-License-Identifier: MIT OR Apache-2.0
//! The matter with depth of a frame, summed along the parts of a ray. `matter` has the volumes and hot spots, `shape`
//! their densities, `clouds` their structure, `physics::flow` the motion, `glow` the light, `medium` the equation of
//! transfer. Knows no tracer.
//!
//! Steps of a ray are as long as its curvature allows, and matter may be finer than that, so each part is cut in three
//! levels. Pieces, over which 1/r changes by 25 % and the angle by 0.25 rad at most, are told by dense output and cost
//! next to nothing; those that no matter is near are passed over. The others are clipped to where matter is, and cut
//! into cells, as many as lengths of it fit in. A cell is summed from three places, each a step of the integrator; if
//! its optical depth is more than 1, it is cut again. Pieces with structure (`clouds`), which is as fine as a pixel
//! lets it be, are cut into even layers instead, the fewer the less light they send.

use super::baked::Baked;
use super::bands::When;
use super::clouds::{Blur, Carried, CloudPlace, Structure, bend, footprint, worth};
use super::effects::EffectStrengths;
use super::glow::{Coefficients, Glow};
use super::hot_spot::HotSpot;
use super::layers::{BLOCK_LAYERS, BLOCK_ROUNDING, LEAST_SEEN, Layers};
use super::matter::{Accuracy, BENDS, FreePlace, SpotMatter, VolumeMatter};
use super::medium::Medium;
use super::shape::{Reach, Stretch};
use super::volume::{Shape, Volume};
use crate::error::Result;
use crate::physics::flow::{Place, Velocity, ZamoLight};
use crate::physics::geodesic::{Constants, State};
use crate::physics::observer::StaticObserver;
use crate::physics::quadrature::{GAUSS_NODES, GAUSS_WEIGHTS};
use crate::physics::rain::OffsetSeries;
use crate::physics::rain_motion::zamo_velocity;
use crate::physics::trace::{Part, PartCourse};
use arrayvec::ArrayVec;
use std::sync::Arc;

/// The greatest changes over a piece: of ln r, and of the angle about the hole, rad.
pub(crate) const PIECE_LN_R: f64 = 0.27;
pub(crate) const PIECE_ANGLE: f64 = 0.25;
/// Steps are as long as a piece may be, give or take a rounding, which is not to make two of one: pieces may be longer
/// by that share of one.
pub(crate) const PIECE_SLACK: f64 = 0.02;
/// The most pieces of a part, cells of a piece, and cells that one of too great an optical depth is cut into.
pub(crate) const MOST_PIECES: f64 = 96.0;
pub(crate) const MOST_CELLS: f64 = 256.0;
pub(crate) const MOST_CUTS: f64 = 16.0;
/// Pieces bend: 1/r and cos th may be off the straight line between their ends by so much, 1/r relatively.
pub(crate) const MARGIN_U: f64 = 0.02;
pub(crate) const MARGIN_COS: f64 = 0.015;
/// Within a step 1/r may become larger than at its ends by this factor.
pub(crate) const MARGIN_STEP: f64 = 1.1;
/// Where a pixel's light is the mean of so many rays or more, each has this share of the layers that structure wants.
pub(crate) const MANY_RAYS: u32 = 16;
pub(crate) const MANY_SHARE: f64 = 0.7;
/// Layers for each cell of even matter.
pub(crate) const LAYERS: f64 = 2.0;
/// The most bends between two places: those of all volumes.
const MOST_BENDS: usize = BENDS * Volume::MOST;

/// How an observer sees the matter along a ray.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// nu(camera) / nu(local frame).
    pub frequency_ratio: f64,
    /// `LocalFrame::static_observer`.
    pub static_observer: Option<StaticObserver>,
    /// The angle of a pixel, in the local frame: finer structure is left out. 0: none is.
    pub pixel_angle: f64,
    /// The angle about the hole that the ray has swept so far.
    pub swept: f64,
    /// How many rays of a pixel it is one of.
    pub rays: u32,
    /// The ray's time less that of the frame, M.
    pub moment: f64,
}

impl Seen {
    /// The width of a pixel at a place of the ray, M: by the distance in the chart, which frame-dragging does not
    /// change.
    pub(crate) fn footprint(&self, c: &Constants, observer: &State, there: &State) -> f64 {
        if self.pixel_angle <= 0.0 {
            return 0.0;
        }
        let place = |state: &State| state.n.normalize() / state.u;
        let (b, passed) = (c.k.max(0.0).sqrt() / c.energy.abs().max(1e-3), observer.du > 0.0 && there.du < 0.0);
        let (from, to) = (1.0 / observer.u, 1.0 / there.u);
        let bend = bend(self.swept, b, from, to, passed);
        footprint(self.pixel_angle, place(observer).distance(place(there)), b, from, to, bend)
    }

    /// The view from farther along the ray, by `share` of a part. N turns by sqrt(K) per tau.
    pub fn after(&self, part: &Part<'_>, share: f64) -> Self {
        let turned = part.swept() * (part.constants.k.max(0.0).sqrt() / part.constants.scale).min(1.0);
        Self { swept: self.swept + share * turned, ..*self }
    }
}

/// How fine the structure of a piece's matter may be.
#[derive(Clone, Debug)]
struct Grain {
    /// The width of a pixel at its ends, M.
    footprints: [f64; 2],
    /// Texels of each volume's structure from place to place along the ray.
    spacing: Texels,
}

/// Texels of the structure of each volume.
type Texels = ArrayVec<f64, { Volume::MOST }>;

/// All matter with depth of a frame.
#[derive(Clone, Debug, Default)]
pub struct Volumes {
    /// [`Volume::MOST`] at most; no array, which would be copied with each of a frame's settings.
    pub volumes: Vec<VolumeMatter>,
    /// [`HotSpot::MOST`] at most.
    pub hot_spots: Vec<SpotMatter>,
    /// The structure of each volume (`BakedCache::prepare`); without, or where it is `None`, volumes are even.
    pub baked: Vec<Option<Arc<Baked>>>,
    /// The offsets of Doran's chart, in which spots in free fall are; `None`: none is.
    pub offsets: Option<OffsetSeries>,
    effects: EffectStrengths,
    pub when: When,
    accuracy: Accuracy,
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

/// How a stretch should be cut.
struct Cut {
    /// The share of it that has matter.
    share: [f64; 2],
    /// The number of cells of even matter that the whole of it wants, and that of places that structure wants.
    cells: f64,
    places: f64,
    /// The most that matter of it with structure sends, of what it might.
    weight: f64,
}

impl Cut {
    /// For the matter of both.
    fn with(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (self.share, other.share);
        let share = [a.min(c), b.max(d)];
        Self {
            share,
            cells: self.cells.max(other.cells),
            places: self.places.max(other.places),
            weight: self.weight.max(other.weight),
        }
    }
}

/// Where a stretch of a part begins or ends: the share of the part, (1/r, cos th) and the width of a pixel there.
struct Border {
    share: f64,
    at: [f64; 2],
    footprint: f64,
}

/// The part of a ray that is being summed.
struct Sum<'a, 'b> {
    volumes: &'a Volumes,
    part: &'a Part<'b>,
    seen: &'a Seen,
    /// The width of a pixel at the ends of the part, M, which changes evenly between; 0 without structure.
    footprints: [f64; 2],
    /// How a volume with structure is summed that is alone.
    alone: Option<Layers<'a, 'b>>,
}

impl Volumes {
    pub fn new(
        volumes: &[Volume],
        hot_spots: &[HotSpot],
        spin: f64,
        effects: EffectStrengths,
        when: When,
        accuracy: Accuracy,
    ) -> Self {
        let matter = |volume: &Volume| VolumeMatter::new(volume, spin, &when, accuracy);
        let series = hot_spots.iter().any(|spot| spot.free.is_some()).then(|| OffsetSeries::new(spin));
        let spot = |spot: &HotSpot| SpotMatter::new(spot, spin, &when, series.as_ref());
        Self {
            volumes: volumes.iter().filter_map(matter).take(Volume::MOST).collect(),
            hot_spots: hot_spots.iter().take(HotSpot::MOST).filter_map(spot).collect(),
            offsets: series,
            baked: Vec::new(),
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
        self.when.delayed && (!self.hot_spots.is_empty() || self.has_structure())
    }

    pub fn has_structure(&self) -> bool {
        self.volumes.iter().any(|volume| volume.clouds.is_some())
    }

    /// Whether one volume that stays away from the axis is all the matter that there is, in a picture with all effects:
    /// GPUs sum it in a way of its own.
    pub fn is_alone(&self) -> bool {
        let away = |volume: &VolumeMatter| !matches!(volume.cloud.shape, Shape::Jet);
        matches!(&self.volumes[..], [volume] if away(volume))
            && self.hot_spots.is_empty()
            && self.effects.are_whole()
            && self.accuracy.alone
    }

    /// Whether that is so, and it is summed in layers.
    fn is_alone_in_layers(&self) -> bool {
        self.is_alone() && self.has_structure()
    }

    /// Gives the matter its structure, about a hole of spin `spin`, for few rays (`Baked::asked`). Errors:
    /// OUT_OF_MEMORY.
    pub fn ask_structure(&mut self, spin: f64) -> Result<()> {
        let of = |volume: &VolumeMatter| {
            let baked = |key| Baked::asked(key).map(Arc::new);
            volume.bake_key(spin, 1.0, 0.0).map(baked).transpose()
        };
        self.baked = self.volumes.iter().map(of).collect::<Result<_>>()?;
        Ok(())
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
        let alone = self.volumes.first().filter(|_| self.is_alone_in_layers()).and_then(|volume| {
            let baked = self.baked.first().and_then(Option::as_deref);
            Layers::new(volume, baked, &self.when, part, (seen.frequency_ratio, seen.moment))
        });
        let footprints = match seen.pixel_angle > 0.0 && self.has_structure() {
            true => [0.0, 1.0].map(|x| seen.after(part, x).footprint(part.constants, part.observer, &part.at(x))),
            false => [0.0; 2],
        };
        let mut sum = Sum { volumes: self, part, seen, footprints, alone };
        let course = part.course();
        let [first, last] = [0.0, 1.0].map(|x| course.at(x)[0]);
        let pieces = Pieces::new([first, last], part.swept(), outer * (1.0 - MARGIN_U));
        let begin = pieces.border(0);
        let mut before = sum.border(begin, course.at(begin));
        for k in 1..=pieces.count {
            let end = pieces.border(k);
            let last = course.at(end);
            let mut fineness = self.accuracy.fineness;
            for bend in self.bends_between(before.at[0], last[0]) {
                let there = course_reaches(&course, [before.share, end], bend);
                let after = sum.border(there, course.at(there));
                sum.stretch([&before, &after], self.accuracy.beside_bends, medium);
                fineness = self.accuracy.beside_bends;
                before = after;
            }
            let last = sum.border(end, last);
            sum.stretch([&before, &last], fineness, medium);
            before = last;
        }
    }

    /// 1/r of the places between two at which volumes bend, in their order.
    fn bends_between(&self, from: f64, to: f64) -> ArrayVec<f64, MOST_BENDS> {
        let bends = self.volumes.iter().filter(|v| !self.accuracy.layers || v.clouds.is_none());
        let bends = bends.flat_map(|volume| volume.bends);
        let between = bends.filter(|u| (u - from) * (u - to) < 0.0);
        let mut between = between.take(MOST_BENDS).collect::<ArrayVec<_, MOST_BENDS>>();
        between.sort_by(|a, b| (a - from).abs().total_cmp(&(b - from).abs()));
        between
    }

    /// How a stretch should be cut. `passed`: the texels that it passes of each volume's structure; `footprint`: how
    /// wide a pixel is there; `through`: the share of light that passes what is in front.
    fn cut(&self, stretch: &Stretch, passed: &Texels, footprint: f64, through: f64) -> Option<Cut> {
        let of_volume = |(v, passed): (&VolumeMatter, &f64)| {
            let share = clip(&v.reach, stretch)?;
            let (places, weight) = v.clouds.as_ref().map_or((0.0, 0.0), |clouds| {
                let (places, weight) =
                    (clouds.samples(&v.cloud, *passed, stretch.middle()[0], footprint), v.weight(stretch));
                (places * if self.accuracy.layers { worth(through, weight) } else { 1.0 }, weight)
            });
            Some(Cut { share, cells: v.cells(stretch), places, weight })
        };
        let of_spot = |s: &SpotMatter| {
            let (share, cells) = (clip(&s.reach, stretch)?, s.cells(stretch));
            Some(Cut { share, cells, places: 0.0, weight: 0.0 })
        };
        let all =
            self.volumes.iter().zip(passed).filter_map(of_volume).chain(self.hot_spots.iter().filter_map(of_spot));
        all.reduce(Cut::with)
    }

    /// The matter at a state of a ray, per unit of affine length. `blurs`: for the structure of each volume.
    pub fn coefficients(
        &self,
        c: &Constants,
        observer: &State,
        there: &State,
        seen: &Seen,
        blurs: &[Blur],
    ) -> Coefficients {
        // None is past infinity, where the last step of a ray may end, nor within the horizon.
        if !(there.u > 0.0 && there.u * c.r_plus < 1.0 - 1e-12) {
            return Coefficients::default();
        }
        let (r, cos, mut measured) = (1.0 / there.u, there.n.z / there.n.length(), None);
        let mut sum = Coefficients::default();
        let mut measure = || {
            *measured.get_or_insert_with(|| {
                let at = Place::on_ray(c, there.u, cos);
                (at, ZamoLight::new(c, &at, there.du, there.dn.z / there.n.length()))
            })
        };
        let mut moment = None;
        let mut moment = || {
            *moment.get_or_insert_with(|| {
                let delay = if self.when.delayed { c.retardation(observer, there) } else { 0.0 };
                (c.matter_azimuth(there), self.when.reference_delay - delay + seen.moment)
            })
        };
        let mut add = |light: &ZamoLight, velocity: Velocity, glow: &Glow, density: f64, heat: f64| {
            let nu = light.measured_by(velocity) / c.nu_local;
            // No motion has such a frequency where this fails; NaN fails it as well.
            if nu > 0.0 && nu.is_finite() {
                let g = seen.frequency_ratio / nu;
                let at_camera = |o: StaticObserver| o.frequency(c.energy, c.angular_momentum);
                let camera = seen.static_observer.map_or(c.nu_local, at_camera);
                let shift = self.effects.visible_shift(g, || camera / light.frequency);
                sum.add(glow.coefficients(density, heat, r, nu, g, shift));
            }
        };
        for (index, (volume, blur)) in self.volumes.iter().zip(blurs).enumerate() {
            let even = volume.cloud.density(r, cos);
            if even < volume.least {
                continue;
            }
            let (at, light) = measure();
            let velocity = volume.flow.velocity(c.a, &at);
            let baked = self.baked.get(index).and_then(Option::as_ref);
            let structure = match (&volume.clouds, baked) {
                (Some(clouds), Some(baked)) => {
                    let (azimuth, later) = moment();
                    let at_place = CloudPlace { r, cos, azimuth, later };
                    baked.pattern((clouds, &volume.cloud), &at_place, Carried::new(velocity, c.a, &at), *blur)
                }
                _ => Structure::NONE,
            };
            add(&light, velocity, &volume.glow, even * structure.density, structure.heat);
        }
        for spot in &self.hot_spots {
            let (azimuth, later) = moment();
            if spot.free.is_some() {
                let Some(series) = &self.offsets else { continue };
                let later = self.when.delayed.then_some(later);
                let place = FreePlace { u: there.u, cos, azimuth, later, moment: seen.moment };
                if let Some((density, seen)) = spot.free_at(c, series, &place) {
                    let (at, light) = measure();
                    add(&light, zamo_velocity(&at, seen), &spot.glow, density, 1.0);
                }
                continue;
            }
            let density = spot.density(r, cos, azimuth, later);
            if density > 0.0 {
                let (at, light) = measure();
                add(&light, spot.flow.velocity(c.a, &at), &spot.glow, density, 1.0);
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
    /// `at`: (1/r, cos th) there.
    fn border(&self, share: f64, at: [f64; 2]) -> Border {
        let [first, last] = self.footprints;
        Border { share, at, footprint: first + (last - first) * share }
    }

    /// Adds the stretch between two places of the part.
    fn stretch(&mut self, [from, to]: [&Border; 2], fineness: f64, medium: &mut Medium) {
        let ([u, c], [v, d], run) = (from.at, to.at, to.share - from.share);
        let stretch = Stretch { u: [u, v], cos: [c, d], swept: self.part.swept() * run };
        let of_volume = |v: &VolumeMatter| v.clouds.as_ref().map_or(0.0, |clouds| clouds.passed(&v.cloud, &stretch));
        let passed = self.volumes.volumes.iter().map(of_volume).collect::<Texels>();
        let width = |share: f64| from.footprint + (to.footprint - from.footprint) * share;
        let Some(cut) = self.volumes.cut(&stretch, &passed, width(0.5), medium.through) else { return };
        let [low, high] = cut.share;
        let layers = self.volumes.accuracy.layers && cut.places > 0.0;
        let wanted = match layers {
            true => {
                let share = if self.seen.rays >= MANY_RAYS { MANY_SHARE } else { 1.0 };
                (share * cut.places).max(LAYERS * cut.cells)
            }
            // Three places a cell. Structure is rough: finer cells gain less there than the sixth order in them.
            false => (cut.cells * fineness).max(cut.places / 3.0 * fineness.sqrt()),
        };
        let wanted = wanted * (high - low);
        let count = match self.volumes.is_alone_in_layers() {
            true => {
                BLOCK_LAYERS * (wanted / BLOCK_LAYERS - BLOCK_ROUNDING).ceil().clamp(1.0, MOST_CELLS / BLOCK_LAYERS)
            }
            false => wanted.ceil().clamp(1.0, MOST_CELLS),
        };
        // Layers that are wider than structure is are so because it matters little there.
        let apart = |passed: &f64| if layers { 0.0 } else { passed * (high - low) / (3.0 * count) };
        let shares = [low, high].map(|share| from.share + run * share);
        if let Some(alone) = &mut self.alone {
            if cut.weight * medium.through <= LEAST_SEEN {
                return;
            }
            let ends = [low, high].map(|x| [u + (v - u) * x, c + (d - c) * x]);
            if alone.tells(ends) {
                let blur = |[u, cos]: [f64; 2], x: f64| alone.texels_blurred(1.0 / u, cos, width(x));
                let blurs = [blur(ends[0], low), blur(ends[1], high)];
                return alone.add(shares, count, blurs, self.volumes.accuracy.dark, medium);
            }
        }
        let grain = Grain { footprints: [width(low), width(high)], spacing: passed.iter().map(apart).collect() };
        if layers {
            self.layers(shares, count, &grain, medium);
        } else {
            self.piece(shares, count, &grain, medium);
        }
    }

    /// Adds a piece in even layers, each as it is in its middle.
    fn layers(&self, [begin, end]: [f64; 2], count: f64, grain: &Grain, medium: &mut Medium) {
        let size = (end - begin) / count;
        for i in 0..count as u32 {
            if medium.depth > self.volumes.accuracy.dark {
                return;
            }
            let share = (f64::from(i) + 0.5) / count;
            medium.add_layer(&self.coefficients(begin + (end - begin) * share, size, share, grain));
        }
    }

    /// The coefficients at a share of the part, as if `size` of it were as it is there. `share`: that of the piece.
    fn coefficients(&self, x: f64, size: f64, share: f64, grain: &Grain) -> Coefficients {
        let (part, [near, far]) = (self.part, grain.footprints);
        let footprint = near + (far - near) * share;
        let blurs = grain.spacing.iter().map(|spacing| Blur { footprint, spacing: *spacing });
        let blurs = blurs.collect::<ArrayVec<_, { Volume::MOST }>>();
        // Before the horizon the light of matter that does not fall grows as (u+ - u)^(-1/2), whose integral is even in
        // the square root.
        let (x, slope) = if part.to_horizon { (x * (2.0 - x), 2.0 * (1.0 - x)) } else { (x, 1.0) };
        let there = part.at(x);
        let found = self.volumes.coefficients(part.constants, part.observer, &there, self.seen, &blurs);
        if found == Coefficients::default() {
            return found;
        }
        found.along(slope * size * part.length(&there))
    }

    /// Adds a piece in cells.
    fn piece(&self, [begin, end]: [f64; 2], cells: f64, grain: &Grain, medium: &mut Medium) {
        let size = (end - begin) / cells;
        for i in 0..cells as u32 {
            let shares = [f64::from(i) / cells, f64::from(i + 1) / cells];
            let cell = shares.map(|share| begin + (end - begin) * share);
            let nodes = self.nodes(cell, shares, grain);
            let depth: f64 = nodes.iter().zip(GAUSS_WEIGHTS).map(|(node, weight)| node.absorption * weight).sum();
            if depth <= 1.0 || medium.depth > self.volumes.accuracy.dark {
                medium.add_nodes(&nodes);
                continue;
            }
            let cuts = depth.ceil().min(MOST_CUTS);
            let size = size / cuts;
            for k in 0..cuts as u32 {
                let [begin, end] = [k, k + 1].map(|k| cell[0] + size * f64::from(k));
                medium.add_nodes(&self.nodes([begin, end], shares, grain));
            }
        }
    }

    /// The coefficients of the cell between two shares of the part, each as if all of the cell were as it is there.
    /// `shares`: those of the piece.
    fn nodes(&self, [begin, end]: [f64; 2], shares: [f64; 2], grain: &Grain) -> [Coefficients; 3] {
        GAUSS_NODES.map(|node| {
            let share = shares[0] + (shares[1] - shares[0]) * node;
            self.coefficients(begin + (end - begin) * node, end - begin, share, grain)
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
        let count = (ratio.ln().abs() / PIECE_LN_R).max(swept / PIECE_ANGLE) - PIECE_SLACK;
        let count = count.ceil().clamp(1.0, MOST_PIECES);
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

    /// Clipping keeps all that lies within a reach, and takes away the parts of a long stretch that are far from it.
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
}
