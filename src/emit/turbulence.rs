//! Structure of the disk: the factor by which its turbulence changes the brightness at a place and a time. The pattern,
//! its motion and the split of the scene's time are here; both tracers use them, and `shaders/emit/turbulence.wgsl`
//! mirrors `brightness`. Knows no colours and no rays.
//!
//! Octaves of gradient noise (Perlin 2002) in (ln r, azimuth fixed to the matter) multiply: factor = prod (1 + t a_i
//! n_i), with n_i independent, of mean 0, within [-1, 1]. So the mean is 1 whatever octaves are filtered away, the
//! factor is never negative, and its distribution is near log-normal, as is that of the light of accreting black holes
//! (Uttley, McHardy & Vaughan 2005).
//!
//! Matter at radius r turns by Omega(r) times its age. Were age counted from one instant, differential rotation would
//! wind the pattern up without end; so generations are born every `LIFETIME` / 2 and live for `LIFETIME`, each with a
//! seed of its own, sheared by its own age only, and with weight sin(pi age / LIFETIME): the squares of the two alive
//! add up to 1, which keeps the variance, and a generation is invisible when it comes and goes.

use super::crossing::EmissionPoint;
use super::disk::Disk;
use crate::random::mix;
use std::f64::consts::{PI, TAU};

/// The lifetime of a generation, M: at its brightest (half of it) it is sheared 6 : 1 at r = 6 and 1 : 1 at r = 20.
/// Were it much longer, the inner disk would be rings; were it much shorter, nothing could be seen to go round there
/// (92 M at r = 6).
pub(crate) const LIFETIME: f64 = 120.0;
/// Cells of the coarsest octave: around the disk (whole, so that there is no seam), and in an e-fold of the radius,
/// where 5 / 2 pi would make them square. The next octave has twice as many.
pub(crate) const CELLS_AROUND: u32 = 5;
pub(crate) const CELLS_PER_E_FOLD: f64 = 2.5;
/// The amplitudes a_i of the octaves.
pub(crate) const AMPLITUDES: [f64; 4] = [0.8, 0.7, 0.6, 0.5];
/// Gradient noise has a standard deviation of about 0.2; more than doubled, hardly any of it is cut off at 1.
pub(crate) const GAIN: f64 = 2.2;

/// When a frame shows its emitters. Times in M.
#[derive(Clone, Copy, Debug)]
pub struct When {
    /// The time at which light leaves emitters whose delay is `reference_delay`.
    pub time: f64,
    /// 0 where light is not delayed.
    pub reference_delay: f64,
    /// Whether light is seen as it left, each ray's by its own delay.
    pub delayed: bool,
}

/// The turbulence of a frame. Times in M.
#[derive(Clone, Copy, Debug)]
pub struct Turbulence {
    /// 0 .. 1.
    pub strength: f64,
    pub seed: u32,
    /// Delay of light that left at the reference time; 0 where light is not delayed.
    pub reference_delay: f64,
    /// Whether the delays of crossings are to be known.
    pub needs_delay: bool,
    /// The youngest generation at the reference time (counted modulo 2^32), and its age: small numbers that f32 can
    /// hold, however large the scene's time is.
    pub generation: u32,
    pub age: f64,
    /// Spin as the matter meets it, and +1 or -1: its sense of motion.
    matter_spin: f64,
    sense: f64,
}

impl Turbulence {
    /// The turbulence of `disk` as a frame shows it; `matter_spin`: spin as its matter meets it. `None`: there is none.
    pub fn new(disk: &Disk, matter_spin: f64, when: &When) -> Option<Self> {
        let age = when.time.rem_euclid(0.5 * LIFETIME);
        let births = ((when.time - age) / (0.5 * LIFETIME)).round();
        (disk.turbulence > 0.0).then(|| Self {
            strength: disk.turbulence,
            seed: mix((disk.seed as u32).wrapping_add(mix((disk.seed >> 32) as u32))),
            reference_delay: when.reference_delay,
            needs_delay: when.delayed,
            generation: births.rem_euclid(4_294_967_296.0) as u32,
            age,
            matter_spin,
            sense: if disk.retrograde { -1.0 } else { 1.0 },
        })
    }

    /// The factor on the disk's radiance: mean 1, within 0 .. prod (1 + a_i) = 7.4. `per_pixel`: change of `at` to the
    /// next pixel in x and in y; octaves whose cells are narrower than that fade out.
    pub fn brightness(&self, at: EmissionPoint, per_pixel: [EmissionPoint; 2]) -> f64 {
        let since = self.age + (self.reference_delay - at.delay);
        let births = (since / (0.5 * LIFETIME)).floor();
        let generation = self.generation.wrapping_add(births as i32 as u32);
        let age = since - births * (0.5 * LIFETIME);
        let young = self.octaves(generation, age, at, per_pixel);
        let old = self.octaves(generation.wrapping_sub(1), age + 0.5 * LIFETIME, at, per_pixel);
        let noise = young.iter().zip(old).map(|(y, o)| (y + o).clamp(-1.0, 1.0));
        noise.zip(AMPLITUDES).map(|(n, a)| 1.0 + self.strength * a * n).product()
    }

    /// The share of one generation in each n_i.
    fn octaves(
        &self,
        generation: u32,
        age: f64,
        at: EmissionPoint,
        per_pixel: [EmissionPoint; 2],
    ) -> [f64; AMPLITUDES.len()] {
        // Omega = +-1 / (r^(3/2) +- a), and dOmega / d ln r.
        let root_cube = (1.5 * at.ln_r).exp();
        let omega = self.sense / (root_cube + self.matter_spin);
        let shear = -1.5 * root_cube * omega * omega * self.sense;
        let turn = (at.azimuth - omega * age) / TAU;
        let cells = |d: EmissionPoint| {
            let turn = (d.azimuth - shear * age * d.ln_r + omega * d.delay) / TAU;
            (d.ln_r * CELLS_PER_E_FOLD).hypot(turn * f64::from(CELLS_AROUND))
        };
        let footprint = cells(per_pixel[0]).max(cells(per_pixel[1]));
        let weight = GAIN * (PI * age / LIFETIME).sin();
        std::array::from_fn(|i| {
            let finer = 1_u32 << i;
            let key = mix((i as u32).wrapping_add(mix(generation.wrapping_add(self.seed))));
            let visible = (2.0 - 2.0 * footprint * f64::from(finer)).clamp(0.0, 1.0);
            let along = at.ln_r * CELLS_PER_E_FOLD * f64::from(finer);
            weight * visible * noise(along, turn, CELLS_AROUND * finer, key)
        })
    }
}

/// Gradient noise at `x` and at `turn` of a circle with `around` cells. Each key shifts its lattice, on which the
/// noise is 0.
fn noise(x: f64, turn: f64, around: u32, key: u32) -> f64 {
    let x = x + f64::from(key & 0xffff) / 65536.0;
    let turn = turn + f64::from(key >> 16) / 65536.0;
    let y = (turn - turn.floor()) * f64::from(around);
    let column = x.floor();
    let row = (y as u32).min(around - 1);
    let (dx, dy) = (x - column, y - f64::from(row));
    let column = column as i32 as u32;
    let corner = |i: u32, j: u32| {
        let h = mix(column.wrapping_add(i).wrapping_add(mix(((row + j) % around).wrapping_add(key))));
        let part = |bits: u32| f64::from(bits) / 32767.5 - 1.0;
        part(h & 0xffff) * (dx - f64::from(i)) + part(h >> 16) * (dy - f64::from(j))
    };
    let (sx, sy) = (fade(dx), fade(dy));
    let low = corner(0, 0) + (corner(1, 0) - corner(0, 0)) * sx;
    let high = corner(0, 1) + (corner(1, 1) - corner(0, 1)) * sx;
    low + (high - low) * sy
}

/// Goes from 0 to 1 with two continuous derivatives (Perlin 2002).
fn fade(t: f64) -> f64 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Effects, Scene};

    const STILL: [EmissionPoint; 2] = [EmissionPoint { ln_r: 0.0, azimuth: 0.0, delay: 0.0 }; 2];

    fn scene(spin: f64, retrograde: bool, time: f64, seed: u64) -> Scene {
        let mut scene = Scene { time, ..Scene::default() };
        scene.hole.spin = spin;
        scene.disk = Some(Disk { retrograde, turbulence: 1.0, seed, ..Disk::default() });
        scene.effects = Effects(0);
        scene
    }

    fn of_scene(scene: &Scene) -> Turbulence {
        scene.emitters().disk.unwrap().turbulence.unwrap()
    }

    fn turbulence(spin: f64, retrograde: bool, time: f64, seed: u64) -> Turbulence {
        of_scene(&scene(spin, retrograde, time, seed))
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
            let all = || patterns.iter().flat_map(|t| places(60).map(|p| t.brightness(p, filter)));
            let average = mean(all());
            assert!((average - 1.0).abs() < 0.02, "step {step}: {average}");
            assert!(all().all(|b| (0.0..7.4).contains(&b)));
            let variance = mean(all().map(|b| (b - average).powi(2)));
            assert!(variance > 0.04, "step {step}: {variance}");
        }
        let blurred = turbulence(0.5, false, 0.0, 0).brightness(at(2.0, 1.0), [at(1e30, 0.0); 2]);
        assert_eq!(blurred, 1.0);
    }

    /// Slopes along the radius and the azimuth, averaged over a generation, are as steep at any time.
    #[test]
    fn time_does_not_wind_the_pattern_up() {
        let slopes = |begin: f64| {
            let step = 1e-5;
            let slope = |dr: f64, da: f64| {
                mean((0..20_u32).flat_map(|i| {
                    let t = turbulence(0.7, false, begin + 6.0 * f64::from(i), 3);
                    places(40).map(move |p| {
                        let moved = at(p.ln_r + dr * step, p.azimuth + da * step);
                        (t.brightness(moved, STILL) - t.brightness(p, STILL)).abs() / step
                    })
                }))
            };
            [slope(1.0, 0.0), slope(0.0, 1.0)]
        };
        let early = slopes(100.0);
        assert!(early[0] > early[1], "{early:?}: not sheared");
        for begin in [1e6, 1e9] {
            let late = slopes(begin);
            (0..2).for_each(|i| assert!((late[i] / early[i] - 1.0).abs() < 0.1, "{early:?} {late:?}"));
        }
    }

    #[test]
    fn no_seam_in_azimuth() {
        let t = turbulence(0.3, false, 1234.5, 9);
        for p in places(40) {
            let turned = at(p.ln_r, p.azimuth + TAU);
            assert!((t.brightness(p, STILL) - t.brightness(turned, STILL)).abs() < 1e-9, "{p:?}");
        }
        // Anywhere around, also where the lattice's first row meets its last.
        let around = |i: u32| t.brightness(at(2.1, TAU * f64::from(i) / 1e5), STILL);
        let step = (0..100_000).map(|i| (around(i + 1) - around(i)).abs()).fold(0.0, f64::max);
        assert!(step < 5e-3, "{step}");
    }

    #[test]
    fn generations_come_and_go_unseen() {
        for birth in [0.0, 60.0, -600.0, 6e8] {
            let [before, after] = [birth - 1e-4, birth + 1e-4].map(|time| turbulence(0.0, false, time, 1));
            assert_ne!(before.generation, after.generation, "{birth}");
            let step = places(30).map(|p| (before.brightness(p, STILL) - after.brightness(p, STILL)).abs());
            assert!(step.fold(0.0, f64::max) < 1e-3, "{birth}");
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
                carried += (then.brightness(there, STILL) - first.brightness(p, STILL)).abs();
                standing += (then.brightness(p, STILL) - first.brightness(p, STILL)).abs();
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
                let difference = late.brightness(EmissionPoint { delay, ..p }, STILL) - then.brightness(p, STILL);
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
            assert!((0.0..=60.0).contains(&t.age), "{time}: {}", t.age);
            assert!(places(5).all(|p| t.brightness(p, STILL).is_finite()));
        }
    }
}
