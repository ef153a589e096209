// SPDX-License-Identifier: MIT OR Apache-2.0
//! The structure of matter with depth: the factors by which turbulence changes its density and its temperature at a
//! place and a time. `filaments` has the pattern, `bands` its generations, `grid` and `baked` the texels in which a
//! frame has both; how matter carries the pattern, and how fine it may be where it is seen, is here. Mirrored by
//! `shaders/emit/clouds.wgsl`. Knows no light and no ray.
//!
//! A generation is carried by the matter as it grows old: around the axis by the angular velocity at its very place,
//! which shears it, and along the radius by that of its band's middle. The pattern is P = e^(s G) over its mean, with G
//! the weighted sum of the generations' noise, of variance 1. Density goes as P^clumping, divided by its mean, so that
//! a mean optical depth stays the stated one; the temperature as P^heating.
//!
//! Generations come and go by the frame's time, everywhere at once, and are as old there as at that time. Light that
//! left earlier or later shows matter that has since moved: the place that it has at the frame's time is where it is
//! looked up. So the structure of a frame is one function of that place, and motion is exact for each ray's own delay.

use super::bands::{Bands, Life, When};
use super::filaments::{FILAMENT_HEIGHT, FILAMENT_PERIOD, FILAMENT_SIDES, filament_log_mean, filament_variance};
use super::grid::{GRID_LAST, Grid};
use super::shape::{Cloud, Reach, Stretch};
use super::volume::{Shape, Volume};
use crate::physics::flow::{Flow, Motion, Place, Velocity};
use crate::physics::orbit::horizon_outer;
use std::f64::consts::{PI, TAU};

/// The standard deviation of ln P at `Volume::turbulence` 1.
pub(crate) const CLOUD_DEVIATION: f64 = 1.0;
/// Orbits that a generation lives, at the middle of its band; if the matter moves inwards or outwards, no longer than
/// it takes to an e-fold of the radius.
const LIFETIME: f64 = 1.0;
/// The shear of a generation half as old as it grows, rad an e-fold of the radius.
pub(crate) const HALF_SHEARED: f64 = SHEAR * PI * LIFETIME;
/// The time in which a generation fades in, in times from birth to birth. All of a band's matter changes at once: the
/// longer it takes, the less a film shows of that.
const CLOUD_FADE: f64 = 0.7;
/// The least rate of renewal, in orbital frequencies r^-1.5: turbulence of matter that stands still goes on.
const LEAST_RATE: f64 = 0.25;
/// Structure of jets is so much longer along the radius.
const JET_STRETCH: f64 = 3.0;
/// Shear, -d Omega / d ln r, in Omega: that of Keplerian orbits, for all, since it only tells how fine structure is.
pub(crate) const SHEAR: f64 = 1.5;
/// The share of a footprint that a texel may be. Where structure is finer than a pixel it crawls in films: with 0.8
/// what changes unevenly is 1.36 times what it is with 16 rays a pixel (`films_do_not_crawl` of
/// tests/tracers/structure.rs). With 1 films crawl less, 1.24 times, but blur takes light from bright filaments: 1.4 %
/// of a picture's parts, where 0.8 takes 0.8 % (`layers_leave_no_ripples`).
pub(crate) const CLOUD_SHARP: f64 = 0.8;
/// The share of a spacing of samples that a texel may be.
pub(crate) const CLOUD_SPACED: f64 = 0.7;
/// Shear may make structure so many times finer. Keplerian orbits stay below that; some flows turn many times while a
/// generation lives.
pub(crate) const WOUND: f64 = 4.0;
/// Texels of a grid for each that shear makes of one of the filaments.
const GRID_FINER: f64 = 1.1;
/// Smaller impact parameters are taken for it: rays that go round the hole have none.
pub(crate) const LEAST_B: f64 = 2.0;
/// The share of a footprint that samples lie apart where that is more than [`CLOUD_SPACING`]: coarse levels have
/// structure of about a texel, of which the finest has none.
pub(crate) const CLOUD_COARSE: f64 = 0.49;
/// The power of `worth`, and the least share.
pub(crate) const WORTH: f64 = 0.2;
pub(crate) const LEAST_WORTH: f64 = 0.1;
/// Texels that samples of a picture lie apart. With 1.4, and octaves of 0.9 of the one before, they showed as ripples
/// along filaments (docs/numerics.md).
pub(crate) const CLOUD_SPACING: f64 = 1.25;

/// The share of a grid's rows that are told from each other: most generations are younger than the oldest, for which
/// the rows are as fine as they are. With 0.78 bright filaments lost a tenth of their light.
pub(crate) const CLOUD_SEEN: f64 = 0.47;
/// The least share of its radius at which matter was that has come outwards since.
pub(crate) const LEAST_CARRIED: f64 = 0.05;

/// Where and when matter is asked for.
#[derive(Clone, Copy, Debug)]
pub struct CloudPlace {
    pub r: f64,
    pub cos: f64,
    pub azimuth: f64,
    /// M after `When::time`.
    pub later: f64,
}

/// How matter is carried: dph/dt, and the change of ln r with time.
#[derive(Clone, Copy, Debug)]
pub struct Carried {
    pub omega: f64,
    pub drift: f64,
}

impl Carried {
    /// Matter with a velocity, about a hole of spin `a`.
    pub fn new(velocity: Velocity, a: f64, at: &Place) -> Self {
        Self { omega: velocity.angular_velocity(a, at), drift: velocity.radial_velocity(at) / at.r }
    }
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
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clouds {
    /// The standard deviation of ln P.
    pub strength: f64,
    pub clumping: f64,
    pub heating: f64,
    /// The range of ln r after which the pattern repeats.
    pub period: f64,
    /// The angular velocity changes with the distance from the axis, not from the hole.
    pub leans: bool,
    pub bands: Bands,
    /// The texels in which a frame has it.
    pub grid: Grid,
}

impl Clouds {
    /// The structure of `volume`, with the shape `cloud`, moved by `flow` about a hole of spin `spin`. `None`: it is
    /// even.
    pub fn new(volume: &Volume, cloud: &Cloud, reach: &Reach, flow: &Flow, spin: f64, when: &When) -> Option<Self> {
        if volume.turbulence <= 0.0 {
            return None;
        }
        let velocity = |ln_r: f64| {
            let r = ln_r.exp().max(1.02 * horizon_outer(spin));
            let at = Place::new(spin, 1.0 / r, 0.0);
            Carried::new(flow.velocity(spin, &at), spin, &at)
        };
        let life = |ln_r: f64| {
            let Carried { omega, drift } = velocity(ln_r);
            let rate = omega.hypot(TAU * drift).max(LEAST_RATE * (-1.5 * ln_r).exp());
            Life { time: LIFETIME * TAU / rate, drift, fade: CLOUD_FADE, eased: true }
        };
        let [outer, inner] = reach.u.map(|u| -u.ln());
        let period = FILAMENT_PERIOD * if cloud.shape == Shape::Jet { JET_STRETCH } else { 1.0 };
        // The most that shear draws the pattern out before it is gone; an even flow, such as a jet's, hardly does.
        let middle = 0.5 * (inner + outer);
        let turned = SHEAR * velocity(middle).omega.abs() * life(middle).time;
        let [columns, rows] = [FILAMENT_SIDES[0] as f64 / TAU, FILAMENT_SIDES[1] as f64 / period];
        let fineness = rows.hypot((columns * turned).min(WOUND * rows)) * GRID_FINER;
        Some(Self {
            strength: CLOUD_DEVIATION * volume.turbulence,
            clumping: volume.clumping,
            heating: volume.heating,
            period,
            leans: matches!(flow.motion, Motion::AngularMomentum { .. }),
            bands: Bands::new([inner, outer], volume.seed, when.time, life),
            grid: Grid::new([inner, outer], fineness),
        })
    }

    /// Where matter of the shape `cloud` has its structure: turns, the share of the grid's rows, and periods of its
    /// layers. It is where the matter is at the frame's time, which has moved at an even speed since it was seen.
    pub fn place(&self, cloud: &Cloud, at: &CloudPlace, carried: Carried) -> [f64; 3] {
        let [low, high] = self.grid.ln_r;
        let ln_r = (at.r * (1.0 - carried.drift * at.later).max(LEAST_CARRIED)).ln();
        [
            (at.azimuth - carried.omega * at.later) / TAU,
            (ln_r - low) / (high - low),
            cloud.height(at.r, at.cos)[0] / FILAMENT_HEIGHT,
        ]
    }

    /// The level of the grid at which its matter is seen.
    pub fn level(&self, cloud: &Cloud, r: f64, cos: f64, blur: Blur) -> f64 {
        self.texels_blurred(cloud, r, cos, blur.footprint).max(CLOUD_SPACED * blur.spacing).log2()
    }

    /// The texels of the grid's finest level that are not told from each other where a pixel is `footprint` wide, M.
    pub fn texels_blurred(&self, cloud: &Cloud, r: f64, cos: f64, footprint: f64) -> f64 {
        let sin = ((1.0 - cos) * (1.0 + cos)).max(1e-12).sqrt();
        let [columns, rows, layers] = self.texels();
        // Texels per rad of the directions: around, and across the shape.
        let (around, across) = (columns / sin, layers * cloud.height(r, cos)[1] * sin);
        // Near the axis nothing is to be finer around than it is along or across.
        let pinched = around / rows.max(across);
        let finest = self.seen_rows().max(across).max(around);
        (CLOUD_SHARP * footprint / r * finest).max(pinched).max(1.0)
    }

    /// Rows an e-fold of the radius that are told from each other.
    pub fn seen_rows(&self) -> f64 {
        CLOUD_SEEN * self.grid.rows_per_e_fold()
    }

    /// The finest level of the grid that an observer at `r` sees, of whom a pixel has an angle of `pixel_angle` or
    /// more: none of its matter is nearer than the difference of the radii.
    pub fn finest_seen(&self, r: f64, pixel_angle: f64) -> usize {
        let [inner, outer] = self.grid.ln_r.map(f64::exp);
        let nearest = if r > outer { r / outer - 1.0 } else { 1.0 - r / inner.max(r) };
        (CLOUD_SHARP * pixel_angle * nearest * self.seen_rows()).max(1.0).log2().min(GRID_LAST as f64) as usize
    }

    /// The factor on the temperature where that on the density is `density`: both are powers of the pattern, each over
    /// its mean.
    pub fn heat(&self, density: f64) -> f64 {
        let [power, log] = self.heating_powers();
        (power * density.ln() + log).exp()
    }

    /// ln of the factor on the temperature over ln of that on the density, and what is added.
    pub fn heating_powers(&self) -> [f64; 2] {
        let deviation = self.strength * filament_variance(0.0).sqrt();
        let power = self.heating / self.clumping;
        [power, power * filament_log_mean(self.clumping * deviation) - self.heating * filament_log_mean(deviation)]
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
        let sheared = columns * HALF_SHEARED;
        // No number here comes near to what a square cannot hold; `hypot` takes ten times as long.
        ((u / v).ln().powi(2) * (rows * rows + sheared * sheared) + (climb * layers).powi(2) + around * around).sqrt()
    }

    /// The number of samples that the texels `passed` at the radius r want, where structure finer than `footprint` does
    /// not show.
    pub fn samples(&self, cloud: &Cloud, passed: f64, r: f64, footprint: f64) -> f64 {
        let [columns, rows, layers] = self.texels();
        let sheared = columns * HALF_SHEARED;
        let finest = (rows * rows + sheared * sheared).sqrt().max(layers * cloud.height(r, 0.0)[1]);
        passed / (CLOUD_SPACING * (CLOUD_COARSE * footprint / r * finest).max(1.0))
    }
}

/// The share of the places that structure wants, where what is in front lets the share `through` of the light pass,
/// and it sends the share `weight` of what it might: an error there shows that much. That the root is the fifth is
/// found by trial: even places take twice as many for the same errors.
pub fn worth(through: f64, weight: f64) -> f64 {
    (through * weight).powf(WORTH).max(LEAST_WORTH)
}

/// The angle by which a ray with the impact parameter `b` has been bent so far, of which `swept` is that about the
/// hole: a straight one from r = `from` to r = `to` would have swept less. `passed`: it came closer to the hole in
/// between.
pub fn bend(swept: f64, b: f64, from: f64, to: f64, passed: bool) -> f64 {
    let [from, to] = [from, to].map(|r| (b / r).min(1.0).acos());
    (swept - if passed { from + to } else { (from - to).abs() }).max(0.0)
}

/// The width that a pixel sees of matter at r = `to`, from r = `from` at a distance, M: the side of a square as large
/// as what it sees. Where rays have been bent, they part in the plane that they lie in: the angle changes by d alpha =
/// F db / b, F being e^(alpha + 0.40) for rays that go round the hole (Darwin 1959, Proc. R. Soc. A 249, 180: alpha =
/// -ln(b / b_c - 1) - 0.40) and alpha for others (alpha = 4 M / b). e^(alpha + 0.40) - 1.5 - alpha / 2 is near to both,
/// which is enough to tell how fine structure may be.
pub fn footprint(pixel_angle: f64, distance: f64, b: f64, from: f64, to: f64, bend: f64) -> f64 {
    let parted = from * to / b.max(LEAST_B) * ((bend + 0.4).exp() - 1.5 - 0.5 * bend).max(0.0);
    pixel_angle * (distance * (distance + parted)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emit::bands::Shown;
    use crate::emit::filaments::Filaments;
    use crate::physics::orbit::circular_orbit;
    use crate::random::mix;
    use arrayvec::ArrayVec;

    const SPIN: f64 = 0.7;
    /// A volume with its structure, as `Volumes` makes it.
    struct Matter {
        cloud: Cloud,
        flow: Flow,
        clouds: Clouds,
    }

    fn matter(volume: &Volume, motion: Motion, time: f64) -> Matter {
        let flow = Flow::new(SPIN, volume.retrograde, motion);
        let cloud = Cloud::new(volume, flow.isco);
        let reach = cloud.reach(SPIN, 1e-7).unwrap();
        let when = When { time, reference_delay: 0.0, delayed: true, shutter: 0.0 };
        Matter { cloud, flow, clouds: Clouds::new(volume, &cloud, &reach, &flow, SPIN, &when).unwrap() }
    }

    const CIRCULAR: Motion = Motion::Keplerian { sub_keplerian: 1.0, infall: 0.0 };

    fn disk(seed: u64) -> Volume {
        Volume { turbulence: 1.0, seed, ..Volume::default() }
    }

    impl Matter {
        /// ln of the density's factor, as fine as the filaments are.
        fn log(&self, at: &CloudPlace) -> f64 {
            let (clouds, filaments) = (&self.clouds, Filaments::shared().unwrap());
            let carried = |r: f64, cos: f64| {
                let place = Place::new(SPIN, 1.0 / r, cos);
                Carried::new(self.flow.velocity(SPIN, &place), SPIN, &place)
            };
            let [turns, row, layer] = clouds.place(&self.cloud, at, carried(at.r, at.cos));
            let [low, high] = clouds.grid.ln_r;
            let ln_r = low + (high - low) * row;
            let r = ln_r.exp();
            let omega = carried(r, if clouds.leans { at.cos } else { self.cloud.middle_cos(r) }).omega;
            let mut sum = 0.0;
            for Shown { weights: [weight], age, drift, key } in clouds.bands.shown([ln_r], 0.0) {
                let place = [
                    turns - omega * age / TAU + f64::from(key & 0xffff) / 65536.0,
                    (ln_r - drift * age) / clouds.period + f64::from(key >> 16) / 65536.0,
                    layer + f64::from(mix(key) & 0xffff) / 65536.0,
                ];
                let s = clouds.clumping * clouds.strength * weight;
                sum += s * filaments.value(place, 0.0) - filament_log_mean(s * filament_variance(0.0).sqrt());
            }
            sum
        }
    }

    /// Places all over a disk from r = 5 to 16.
    fn places(count: u32) -> impl Iterator<Item = CloudPlace> {
        let part = |i: u32, step: f64| (f64::from(i) * step).fract();
        (1..=count).map(move |i| CloudPlace {
            r: 5.0 * 3.2_f64.powf(part(i, 0.819_172_513)),
            cos: 0.2 * (part(i, 0.671_043_607) - 0.5),
            azimuth: TAU * part(i, 0.549_700_478),
            later: 0.0,
        })
    }

    fn mean(values: impl Iterator<Item = f64>) -> f64 {
        let (sum, count) = values.fold((0.0, 0.0), |(sum, count), v| (sum + v, count + 1.0));
        sum / count
    }

    /// Neither across the border of two bands, nor at the azimuth where the block begins.
    #[test]
    fn there_is_no_seam() {
        let m = matter(&disk(4), CIRCULAR, 777.0);
        let fine = 1e-5;
        for start in places(6) {
            let along = |i: f64| m.log(&CloudPlace { r: start.r.min(8.0) * (fine * i).exp(), ..start });
            let around = |i: f64| m.log(&CloudPlace { azimuth: TAU * i * fine, ..start });
            let across = |i: f64| m.log(&CloudPlace { cos: 0.2 * (i * fine - 0.5), ..start });
            let step = |value: &dyn Fn(f64) -> f64| {
                (0..100_000).map(f64::from).map(|i| (value(i + 1.0) - value(i)).abs()).fold(0.0, f64::max)
            };
            let steps = [step(&along), step(&around), step(&across)];
            assert!(steps.iter().all(|s| *s < 0.03 && *s > 0.0), "{steps:?}");
            let turned = CloudPlace { azimuth: start.azimuth - 3.0 * TAU, ..start };
            assert!((m.log(&start) - m.log(&turned)).abs() < 1e-9);
        }
    }

    /// The pattern does not jump when a generation comes or goes, nor at any other time, and it changes evenly.
    #[test]
    fn generations_come_and_go_unseen() {
        let at_time = |time: f64| matter(&disk(1), CIRCULAR, time);
        for time in [0.0, -600.0, 1e6] {
            let now = at_time(time);
            for number in 0..now.clouds.bands.count as i32 {
                let band = now.clouds.bands.band(now.clouds.bands.first + number);
                let r = (crate::emit::bands::BAND * (f64::from(now.clouds.bands.first + number) + 0.5)).exp();
                let birth = time + band.spacing - band.age;
                let [before, after] = [birth - 1e-6, birth + 1e-6].map(at_time);
                for at in places(20) {
                    let at = CloudPlace { r: r.max(2.5), ..at };
                    let [before, after] = [before.log(&at), after.log(&at)];
                    assert!((before - after).abs() < 1e-3, "{time} {r}: {before} {after}");
                }
            }
            let (mut change, mut bend) = (0.0_f64, 0.0_f64);
            let mut last = ArrayVec::<Vec<f64>, 3>::new();
            for i in 0..5_000 {
                let now = at_time(time + 0.02 * f64::from(i));
                if last.is_full() {
                    last.remove(0);
                }
                last.push(places(12).map(|at| now.log(&at)).collect());
                if let [a, b, c] = &last[..] {
                    for ((a, b), c) in a.iter().zip(b).zip(c) {
                        (change, bend) = (change.max((b - a).abs()), bend.max((c - 2.0 * b + a).abs()));
                    }
                }
            }
            // At r = 5 the finest cells pass in 1 M.
            assert!(change < 0.2 && bend < 0.15, "{time}: {change} {bend}");
        }
    }

    /// A parcel keeps its density for a while, wherever its orbit takes it, and whatever moves it.
    #[test]
    fn matter_carries_the_pattern() {
        let outflow = Motion::Outflow { speed: 0.6, base: 2.0 };
        let jet = Volume { shape: Shape::Jet, thickness: 0.03, outer_radius: 30.0, ..disk(2) };
        let infall = Motion::Keplerian { sub_keplerian: 0.8, infall: 0.5 };
        for (volume, motion) in [(disk(5), CIRCULAR), (Volume { retrograde: true, ..disk(6) }, CIRCULAR)]
            .into_iter()
            .chain([(disk(7), infall), (jet, outflow), (disk(8), Motion::AngularMomentum { l0: 0.9 })])
        {
            let later = 1.5;
            let [m, then] = [91.0, 91.0 + later].map(|time| matter(&volume, motion, time));
            let (mut carried, mut seen_later, mut standing) = (0.0, 0.0, 0.0);
            for at in places(400) {
                let at = match volume.shape {
                    Shape::Jet => CloudPlace { cos: 1.0 - 0.02 * (1.0 + at.cos), ..at },
                    _ => at,
                };
                let mut parcel = at;
                for _ in 0..100 {
                    let place = Place::new(SPIN, 1.0 / parcel.r, at.cos);
                    let velocity = m.flow.velocity(SPIN, &place);
                    parcel.azimuth += velocity.angular_velocity(SPIN, &place) * later / 100.0;
                    parcel.r += velocity.radial_velocity(&place) * later / 100.0;
                }
                if volume.shape == Shape::Jet {
                    // Along the wall.
                    let [before, after] = [at.r, parcel.r].map(|r| m.cloud.height(r, at.cos)[0]);
                    parcel.cos += (before - after) * m.cloud.thickness;
                }
                let begin = m.log(&at);
                carried += (then.log(&parcel) - begin).abs();
                seen_later += (m.log(&CloudPlace { later, ..parcel }) - begin).abs();
                standing += (then.log(&at) - begin).abs();
            }
            // Along the radius a band goes as fast as its middle, which matters most for jets.
            let limit = if volume.shape == Shape::Jet { 0.75 } else { 0.5 };
            assert!(carried < limit * standing, "{motion:?}: {carried} {standing}");
            // Light that left as much later shows the parcel where it was.
            assert!(seen_later < 0.1 * standing, "{motion:?}: {seen_later} {standing}");
        }
        // The angular velocity is that of circular geodesics.
        let (m, place) = (matter(&disk(5), CIRCULAR, 0.0), Place::new(SPIN, 0.1, 0.0));
        let omega = m.flow.velocity(SPIN, &place).angular_velocity(SPIN, &place);
        assert!((omega / circular_orbit(SPIN, 10.0).unwrap().angular_velocity - 1.0).abs() < 1e-12);
    }

    /// Nor does it matter how fast orbits are: the pattern is as fine everywhere, and always.
    #[test]
    fn time_does_not_wind_the_pattern_up() {
        let slopes = |time: f64, r: f64| {
            let orbit = TAU * (r * r.sqrt() + SPIN);
            let slope = |i: u32, dr: f64, turn: f64| {
                let m = matter(&disk(i.into()), CIRCULAR, time + 0.043 * orbit * f64::from(i));
                mean(places(60).map(|at| {
                    let at = CloudPlace { r: r * (1.0 + 0.3 * at.azimuth / TAU), ..at };
                    let there = CloudPlace { r: at.r * (1.0 + dr), azimuth: at.azimuth + turn, ..at };
                    (m.log(&there) - m.log(&at)).abs() / (dr + turn)
                }))
            };
            [(1e-5, 0.0), (0.0, 1e-5)].map(|(dr, turn)| mean((0..120).map(|i| slope(i, dr, turn))))
        };
        let early = slopes(100.0, 8.0);
        assert!(early[0] > 2.0 * early[1], "{early:?}: not drawn out along the orbit");
        for (time, r) in [(1e6, 8.0), (1e12, 8.0), (0.0, 14.0), (-1e9, 4.5)] {
            let late = slopes(time, r);
            (0..2).for_each(|i| assert!((late[i] / early[i] - 1.0).abs() < 0.15, "{time} {r}: {early:?} {late:?}"));
        }
    }

    #[test]
    fn even_matter_has_none() {
        let even = Volume { turbulence: 0.0, ..Volume::default() };
        let (flow, cloud) = (Flow::new(SPIN, false, CIRCULAR), Cloud::new(&even, 4.0));
        let reach = cloud.reach(SPIN, 1e-7).unwrap();
        assert!(Clouds::new(&even, &cloud, &reach, &flow, SPIN, &When::default()).is_none());
    }

    /// No texel that is seen is finer than the finest that is made, wherever the observer is.
    #[test]
    fn finest_levels_are_made() {
        let m = matter(&disk(3), CIRCULAR, 0.0);
        for (r, pixel_angle) in [(28.0, 1e-3), (28.0, 0.03), (300.0, 1e-4), (2.5, 0.01), (10.0, 0.3), (1e4, 0.5)] {
            let finest = m.clouds.finest_seen(r, pixel_angle) as f64;
            for at in places(500) {
                let footprint = pixel_angle * (at.r - r).abs();
                let level = m.clouds.level(&m.cloud, at.r, at.cos, Blur { footprint, spacing: 0.0 });
                assert!(level >= finest, "{r} {pixel_angle}: {level} {finest}");
            }
        }
        assert_eq!(m.clouds.finest_seen(10.0, 0.1), 0);
        assert!(m.clouds.finest_seen(28.0, 0.03) > 0);
    }

    /// A straight ray is not bent, whichever way it goes; a pixel then sees as much as it would without a hole.
    #[test]
    fn straight_rays_see_small_patches() {
        for (b, x) in [(5.0, 30.0), (20.0, -12.0), (0.1, 7.0)] {
            let (from, to) = (f64::hypot(50.0, b), f64::hypot(x, b));
            let swept = f64::atan2(50.0, b) + f64::atan2(x, b);
            let turned = if x > 0.0 { swept } else { f64::atan2(50.0, b) - f64::atan2(-x, b) };
            assert!(bend(turned, b, from, to, x > 0.0) < 1e-12, "{b} {x}");
            assert!((footprint(1e-3, 80.0, b, from, to, 0.0) / 0.08 - 1.0).abs() < 1e-12);
            // Half a turn more, and everything is e^pi times as narrow, of which the square has the root.
            let [one, two] = [2.0, 3.0].map(|half| footprint(1e-3, 80.0, b, from, to, half * PI));
            assert!((two / one / (0.5 * PI).exp() - 1.0).abs() < 0.05, "{one} {two}");
        }
    }
}
