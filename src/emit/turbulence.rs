// SPDX-License-Identifier: MIT OR Apache-2.0
//! Structure of the disk: the factor by which its turbulence changes the brightness at a place and a time. The
//! pattern's motion, the split of the scene's time, and where which pattern shows are here; `streaks` has the pattern.
//! Both tracers use them, and `shaders/emit/turbulence.wgsl` mirrors `brightness`. Knows no colours and no rays.
//!
//! `bands` splits the disk into bands of radius, and its structure into generations, each sheared by its own age only.
//! They live for a fixed number of the band's orbits: hence streaks have the same pitch at every radius. Each shows
//! another part of the picture of `streaks`, by a seed of its own.
//!
//! The factor is e^G over its mean, with G the weighted sum of the patterns, so that its variance is the same
//! everywhere and at any time; its distribution is about log-normal, as is that of the light of accreting black holes
//! (Uttley, McHardy & Vaughan 2005).
//!
//! A pixel shows the mean of the factor. Each pattern is filtered by itself, but the mean of their product is not that
//! of their means, and the bands' weights change within a pixel. So a large pixel is seen in three parts, side by side
//! along the side on which ln r changes more, and shows their mean.

use super::bands::{BAND, Bands, GENERATION_FADE, Life, Shown, When};
use super::crossing::EmissionPoint;
use super::disk::Disk;
use super::streaks::{STREAK_COLUMNS, STREAK_PERIOD, STREAK_ROWS, STREAK_WHOLE, Streaks};
use crate::physics::orbit::isco;
use std::f64::consts::TAU;

/// The lifetime of a generation, in orbits at the middle of its band. Half-way through it, shear has displaced the
/// pattern by 1.5 pi rad an e-fold of the radius. A longer one would wind it up, of a shorter one little would be seen
/// to go round.
const LIFETIME: f64 = 1.0;
/// Plunging matter loses its structure over so much in ln r inside the ISCO: it falls faster than patterns that live
/// for an orbit could show, and is drawn out.
pub(crate) const PLUNGE_FADE: f64 = 0.4;
/// The size from which a pixel is large (`part_of_side`), in texels of the streaks. Found by trial: parts of smaller
/// ones change little that is seen, while with twice this limit twice as many pixels are off by 5 %.
pub(crate) const LARGE_PIXEL: f64 = 8.0;
/// Texels of the streaks in a radian, and in an e-fold of the radius.
pub(crate) const TEXELS_AROUND: f64 = STREAK_COLUMNS as f64 / TAU;
pub(crate) const TEXELS_ACROSS: f64 = STREAK_ROWS as f64 / STREAK_PERIOD;

/// The turbulence of a frame. Times in M.
#[derive(Clone, Copy, Debug)]
pub struct Turbulence {
    /// 0 .. 1.
    pub strength: f64,
    /// Delay of light that left at the reference time; 0 where light is not delayed.
    pub reference_delay: f64,
    /// Whether the delays of crossings are to be known.
    pub needs_delay: bool,
    pub bands: Bands,
    /// Spin as the matter meets it, and +1 or -1: its sense of motion.
    matter_spin: f64,
    sense: f64,
    /// ln r from which inwards the pattern fades out over `PLUNGE_FADE`; `None`: nowhere.
    pub fades_inside: Option<f64>,
}

impl Turbulence {
    /// The turbulence of `disk`, whose edges lie at 1/r = `u`, as a frame shows it; `matter_spin`: spin as its matter
    /// meets it. It is that of matter on circular orbits, and goes on some way inside the ISCO. `None`: there is none.
    pub fn new(disk: &Disk, u: [f64; 2], matter_spin: f64, when: &When) -> Option<Self> {
        if disk.turbulence <= 0.0 {
            return None;
        }
        // From the inner edge to the outer one.
        let fades_inside = disk.plunges.then(|| isco(matter_spin).ln());
        let innermost = fades_inside.map_or(f64::NEG_INFINITY, |ln_r| ln_r - PLUNGE_FADE);
        let [outer, inner] = u.map(|u| (-u.ln()).max(innermost));
        let life = |ln_r: f64| Life {
            time: TAU * ((1.5 * ln_r).exp() + matter_spin) * LIFETIME,
            drift: 0.0,
            fade: GENERATION_FADE,
            eased: false,
        };
        Some(Self {
            strength: disk.turbulence,
            reference_delay: when.reference_delay,
            needs_delay: when.delayed,
            bands: Bands::new([inner, outer], disk.seed, when.time, life),
            matter_spin,
            sense: if disk.retrograde { -1.0 } else { 1.0 },
            fades_inside,
        })
    }

    /// The factor on the disk's radiance: mean 1, rarely above 10. `per_pixel`: change of `at` to the next pixel in x
    /// and in y, over which the pattern is filtered.
    pub fn brightness(&self, streaks: &Streaks, at: EmissionPoint, per_pixel: [EmissionPoint; 2]) -> f64 {
        // Omega = +-1 / (r^(3/2) +- a), and dOmega / d ln r.
        let root_cube = (1.5 * at.ln_r).exp();
        let omega = self.sense / (root_cube + self.matter_spin);
        let shear = -1.5 * root_cube * omega * omega * self.sense;
        // Azimuth fixed to the matter, and ln r, in texels.
        let [right, down] = per_pixel.map(|d| [(d.azimuth + omega * d.delay) * TEXELS_AROUND, d.ln_r * TEXELS_ACROSS]);
        let [cut, other] = if right[1].abs() >= down[1].abs() { [right, down] } else { [down, right] };
        let apart = part_of_side(cut, other);
        let left = self.fades_inside.map_or(1.0, |from| (1.0 + (at.ln_r - from) / PLUNGE_FADE).clamp(0.0, 1.0));
        let beside = if apart > 0.0 { apart * cut[1] / TEXELS_ACROSS } else { 0.0 };
        let mut exponents = [0.0; 3];
        for Shown { weights, age, key, .. } in
            self.bands.shown([at.ln_r - beside, at.ln_r, at.ln_r + beside], self.reference_delay - at.delay)
        {
            let place = [
                (at.azimuth - omega * age) / TAU + f64::from(key & 0xffff) / 65536.0,
                at.ln_r / STREAK_PERIOD + f64::from(key >> 16) / 65536.0,
            ];
            let sheared =
                |[around, across]: [f64; 2]| [around - shear * age * (TEXELS_AROUND / TEXELS_ACROSS) * across, across];
            let patches = streaks.patches(place, apart, sheared(cut), sheared(other));
            for ((exponent, patch), weight) in exponents.iter_mut().zip(patches).zip(weights) {
                *exponent += patch.exponent(self.strength * left * weight);
            }
        }
        exponents.map(f64::exp).iter().sum::<f64>() / 3.0
    }
}

/// How far the middles of a pixel's three parts are from each other, as a share of its side `cut`, the one on which
/// ln r changes more: a third of it, but no more than a third of a band, so that all parts see the same two bands. A
/// pixel that is small, or of unknown size, has one part: 0. Sides in texels.
///
/// The size of a pixel is its change of ln r, or half of that of the azimuth, as streaks are twice as many texels long
/// as wide.
pub(crate) fn part_of_side(cut: [f64; 2], other: [f64; 2]) -> f64 {
    let across = cut[1].abs();
    let size = across.max(0.5 * cut[0].abs().max(other[0].abs()));
    // The condition is positive so that it is false where the side is no number.
    let large = size > LARGE_PIXEL && cut[0] * cut[0] + cut[1] * cut[1] < STREAK_WHOLE;
    if large { (1.0_f64 / 3.0).min(BAND / 3.0 * TEXELS_ACROSS / across.max(1e-30)) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Effects, Scene};

    const STILL: [EmissionPoint; 2] = [EmissionPoint { ln_r: 0.0, azimuth: 0.0, delay: 0.0 }; 2];

    fn scene(spin: f64, retrograde: bool, time: f64, seed: u64) -> Scene {
        let mut scene = Scene { time, ..Scene::plain() };
        scene.hole.spin = spin;
        scene.disk = Some(Disk { retrograde, turbulence: 1.0, seed, ..Disk::plain() });
        scene.effects = Effects(0);
        scene
    }

    fn of_scene(scene: &Scene) -> Turbulence {
        scene.emitters().disk.unwrap().turbulence.unwrap()
    }

    fn turbulence(spin: f64, retrograde: bool, time: f64, seed: u64) -> Turbulence {
        of_scene(&scene(spin, retrograde, time, seed))
    }

    fn brightness(t: &Turbulence, at: EmissionPoint, per_pixel: [EmissionPoint; 2]) -> f64 {
        t.brightness(Streaks::shared().unwrap(), at, per_pixel)
    }

    fn at(ln_r: f64, azimuth: f64) -> EmissionPoint {
        EmissionPoint { ln_r, azimuth, delay: 0.0 }
    }

    /// Places all over a disk from r = 6 to 20.
    fn places(count: u32) -> impl Iterator<Item = EmissionPoint> {
        let part = move |i: u32| (f64::from(i) + 0.5) / f64::from(count);
        (0..count).flat_map(move |i| {
            (0..count).map(move |j| at(6_f64.ln() + (20.0_f64 / 6.0).ln() * part(i), TAU * (part(j) - 0.5)))
        })
    }

    fn mean(values: impl Iterator<Item = f64>) -> f64 {
        let (sum, count) = values.fold((0.0, 0.0), |(sum, count), v| (sum + v, count + 1.0));
        sum / count
    }

    /// Filtered or not.
    #[test]
    fn mean_brightness_is_one() {
        for step in [0.0, 0.05, 0.15] {
            let filter = [at(step, 0.0), at(0.0, 0.0)];
            let patterns = (0..60_u32).map(|i| turbulence(0.5, false, 37.0 * f64::from(i), u64::from(i)));
            let patterns = patterns.collect::<Vec<_>>();
            let all = || patterns.iter().flat_map(|t| places(60).map(move |p| brightness(t, p, filter)));
            let average = mean(all());
            assert!((average - 1.0).abs() < 0.02, "step {step}: {average}");
            assert!(all().all(|b| (0.0..40.0).contains(&b)));
            let variance = mean(all().map(|b| (b - average).powi(2)));
            assert!(variance > 0.04, "step {step}: {variance}");
        }
        let blurred = brightness(&turbulence(0.5, false, 0.0, 0), at(2.0, 1.0), [at(1e30, 0.0); 2]);
        assert!((blurred - 1.0).abs() < 1e-3, "{blurred}");
    }

    /// Pixels are compared with the means over them, whichever side is cut, where two generations of two bands show and
    /// where one does.
    #[test]
    fn pixels_are_the_means_of_finer_ones() {
        let t = turbulence(0.5, false, 400.0, 2);
        let (mut off, mut count, mut error) = ([0, 0], 0, 0.0);
        for (ln_r, azimuth, turned) in [(0.02, 0.004, false), (-0.05, 0.05, true), (0.01, 0.1, true)] {
            let mut sides = [at(ln_r, 0.3 * azimuth), at(-0.2 * ln_r, azimuth)];
            if turned {
                sides.reverse();
            }
            let finer = sides.map(|side| at(side.ln_r / 12.0, side.azimuth / 12.0));
            for p in places(24) {
                let inside = (0..144).map(|i| {
                    let [x, y] = [i % 12, i / 12].map(|k| (f64::from(k) + 0.5) / 12.0 - 0.5);
                    let beside = |a: f64, b: f64| x * a + y * b;
                    let there = [beside(sides[0].ln_r, sides[1].ln_r), beside(sides[0].azimuth, sides[1].azimuth)];
                    brightness(&t, at(p.ln_r + there[0], p.azimuth + there[1]), finer)
                });
                let off_by = brightness(&t, p, sides) / mean(inside) - 1.0;
                error += off_by * off_by;
                count += 1;
                (0..2).for_each(|k| off[k] += u32::from(off_by.abs() > [0.05, 0.1][k]));
            }
        }
        let rms = (error / f64::from(count)).sqrt();
        println!("{off:?} of {count} pixels beyond 5 % and 10 %, rms {rms:.4}");
        assert!(off[0] * 100 < count && off[1] * 400 < count && rms < 0.02, "{off:?} of {count}, {rms}");
    }

    /// Where pixels become large enough to have parts no line is seen: their light is nearly that with one part.
    #[test]
    fn no_seam_where_pixels_become_large() {
        let t = turbulence(0.5, false, 400.0, 2);
        let sides = |texels: f64| [at(texels / TEXELS_ACROSS, 0.0), at(0.0, 0.5 * texels / TEXELS_AROUND)];
        let [small, large] = [0.999, 1.001].map(|size| sides(size * LARGE_PIXEL));
        let steps = || places(60).map(|p| brightness(&t, p, large) / brightness(&t, p, small) - 1.0);
        let [mean, rms] = [mean(steps()), mean(steps().map(|step| step * step)).sqrt()];
        let most = steps().map(f64::abs).fold(0.0, f64::max);
        println!("steps of {mean:.5} on average, rms {rms:.4}, at most {most:.3}");
        assert!(mean.abs() < 2e-3 && rms < 0.015 && most < 0.12, "{mean} {rms} {most}");
    }

    /// Slopes along the radius and the azimuth at one radius, averaged over the azimuth and over `orbits` there.
    fn slopes(spin: f64, r: f64, begin: f64) -> [f64; 2] {
        let (step, orbit) = (1e-5, TAU * (r.powf(1.5) + spin));
        let slope = |dr: f64, da: f64| {
            mean((0..240_u32).flat_map(|i| {
                let ln_r = r.ln() + BAND * (f64::from(i % 8) / 8.0 - 0.5);
                let t = turbulence(spin, false, begin + 0.043 * orbit * f64::from(i), 3);
                (0..40).map(move |j| {
                    let p = at(ln_r, TAU * (f64::from(j) + 0.3) / 40.0);
                    let moved = at(p.ln_r + dr * step, p.azimuth + da * step);
                    (brightness(&t, moved, STILL) - brightness(&t, p, STILL)).abs() / step
                })
            }))
        };
        [slope(1.0, 0.0), slope(0.0, 1.0)]
    }

    /// Nor does it matter how fast the orbits are: streaks have the same pitch everywhere.
    #[test]
    fn time_does_not_wind_the_pattern_up() {
        let early = slopes(0.7, 8.0, 100.0);
        assert!(early[0] > 2.0 * early[1], "{early:?}: not drawn out along the orbit");
        for (spin, r, begin) in
            [(0.7, 8.0, 1e6), (0.7, 8.0, 1e9), (0.998, 1.7, 1e9), (0.0, 18.0, -1e9), (0.0, 11.0, 0.0)]
        {
            let late = slopes(spin, r, begin);
            (0..2).for_each(|i| assert!((late[i] / early[i] - 1.0).abs() < 0.15, "{r} {begin}: {early:?} {late:?}"));
        }
    }

    #[test]
    fn bands_meet_without_a_seam() {
        let t = turbulence(0.3, false, 777.0, 4);
        for azimuth in [0.1, 2.0, -3.0] {
            let along = |i: u32| brightness(&t, at(1.8 + f64::from(i) * 1e-5, azimuth), STILL);
            let step = (0..100_000).map(|i| (along(i + 1) - along(i)).abs()).fold(0.0, f64::max);
            assert!(step < 0.05, "{step}");
        }
    }

    #[test]
    fn no_seam_in_azimuth() {
        let t = turbulence(0.3, false, 1234.5, 9);
        for p in places(40) {
            let turned = at(p.ln_r, p.azimuth + TAU);
            assert!((brightness(&t, p, STILL) - brightness(&t, turned, STILL)).abs() < 1e-9, "{p:?}");
        }
        // Anywhere around, also where the lattice's first row meets its last.
        let around = |i: u32| brightness(&t, at(2.1, TAU * f64::from(i) / 1e5), STILL);
        let step = (0..100_000).map(|i| (around(i + 1) - around(i)).abs()).fold(0.0, f64::max);
        assert!(step < 0.04, "{step}");
    }

    #[test]
    fn generations_come_and_go_unseen() {
        for time in [0.0, -600.0, 1e6] {
            let some = turbulence(0.0, false, time, 1);
            for (index, band) in some.bands.bands.iter().enumerate().take(some.bands.count) {
                let birth = time + band.spacing - band.age;
                let [before, after] = [birth - 1e-5, birth + 1e-5].map(|time| turbulence(0.0, false, time, 1));
                assert_eq!(
                    before.bands.bands[index].generation.wrapping_add(1),
                    after.bands.bands[index].generation,
                    "{birth}"
                );
                let places = places(30)
                    .map(|p| at(BAND * (f64::from(some.bands.first + index as i32) + p.ln_r / 3.0), p.azimuth));
                let step = places.map(|p| (brightness(&before, p, STILL) - brightness(&after, p, STILL)).abs());
                assert!(step.fold(0.0, f64::max) < 1e-3, "{birth}");
            }
        }
    }

    /// For a little while the pattern moves with the orbits of `physics::orbit`, whichever way they go.
    #[test]
    fn matter_carries_the_pattern() {
        use crate::physics::orbit::circular_orbit;
        for (retrograde, spin) in [(false, 0.7), (true, 0.7), (true, -0.4)] {
            let (first, then) = (turbulence(spin, retrograde, 91.0, 5), turbulence(spin, retrograde, 93.0, 5));
            let sense = if retrograde { -1.0 } else { 1.0 };
            let (mut carried, mut standing) = (0.0, 0.0);
            for p in places(30).filter(|p| p.ln_r > 9_f64.ln()) {
                let orbit = circular_orbit(sense * spin, p.ln_r.exp()).unwrap();
                let there = at(p.ln_r, p.azimuth + sense * 2.0 * orbit.angular_velocity);
                carried += (brightness(&then, there, STILL) - brightness(&first, p, STILL)).abs();
                standing += (brightness(&then, p, STILL) - brightness(&first, p, STILL)).abs();
            }
            assert!(carried < 0.5 * standing, "{carried} {standing}");
        }
    }

    /// Light that took longer shows an earlier time; without the effect all is of one time.
    #[test]
    fn delay_is_time() {
        let mut late = scene(0.0, false, 1e6, 5);
        late.effects = Effects(Effects::ALL);
        let late = of_scene(&late);
        assert!(late.needs_delay);
        for delay in [3.0, 31.0, 500.0] {
            let then = turbulence(0.0, false, 1e6 - delay, 5);
            for p in places(10) {
                let difference = brightness(&late, EmissionPoint { delay, ..p }, STILL) - brightness(&then, p, STILL);
                assert!(difference.abs() < 1e-6, "{delay}: {difference}");
            }
        }
        let still = scene(0.0, false, 0.0, 0);
        assert!(!still.emitters().needs().delays);
        assert_eq!(of_scene(&still).reference_delay, 0.0);
    }

    #[test]
    fn any_finite_time_and_seed_will_do() {
        for time in [0.0, -1e-300, 1e300, f64::MAX, f64::MIN] {
            let mut scene = scene(0.9, true, time, u64::MAX);
            scene.hole.mass = 1e-3;
            let t = of_scene(&scene);
            assert!(
                t.bands.bands.iter().take(t.bands.count).all(|b| (0.0..=b.spacing).contains(&b.age)),
                "{time}: {t:?}"
            );
            assert!(places(5).all(|p| brightness(&t, p, STILL).is_finite()));
        }
    }
}
