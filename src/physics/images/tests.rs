// SPDX-License-Identifier: MIT OR Apache-2.0
//! Images of points against rays that another integrator follows, and against the lens equation.

use super::*;
use crate::physics::integrator::{Method, held_inside, step, step_limit};
use crate::physics::metric::chart;
use crate::physics::orbit::innermost_radius;
use crate::random::{mix, runs_all};
use rayon::prelude::*;
use std::f64::consts::PI;
use std::time::Instant;

/// Numbers in [0, 1), the same in every run.
struct Random(u32);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(1);
        f64::from(mix(self.0)) / 4_294_967_296.0
    }

    fn even(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    fn log(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.next())
    }
}

/// The least distance of a ray from a point, by the method of Dormand and Prince in small steps.
fn least_distance(frame: &LocalFrame, look: DVec3, point: DVec3) -> f64 {
    let (c, start) = frame.start(look).unwrap();
    let distance = |s: &State| (s.chart_direction() / s.u).distance(point);
    let advance = |s: &State, h: f64| held_inside(&c, step(Method::DormandPrince, &c, s, h, false).0);
    // The golden section, within two steps.
    let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
    let refined = |from: &State, length: f64| {
        let far = |h: f64| distance(&(0..2).fold(*from, |s, _| advance(&s, h / 2.0)));
        let (mut low, mut high) = (0.0, length);
        for _ in 0..60 {
            let (x, y) = (high - ratio * (high - low), low + ratio * (high - low));
            if far(x) < far(y) { high = y } else { low = x }
        }
        far(0.5 * (low + high))
    };
    let (mut before, mut state, mut length) = (start, start, 0.0);
    let mut best = distance(&start);
    for _ in 0..20_000 {
        // Far out steps are so short that none leaps to infinity.
        let h = (0.02 / c.scale).min(0.5 * step_limit(&c, &state, 0.025)).min(0.05 * state.u / state.du.abs());
        let next = advance(&state, h);
        if next.u < 0.1 / point.length() && next.du < 0.0 || next.du > 0.0 && next.u * c.r_plus > 1.0 - 1e-8 {
            break;
        }
        // A ray may come near several times.
        if distance(&state) <= distance(&before).min(distance(&next)) && distance(&state) < 0.3 * point.length() {
            best = best.min(refined(&before, length + h));
        }
        (before, state, length) = (state, next, h);
    }
    best
}

/// An observer, a point, an order, and the spin.
type Case = (f64, DVec3, DVec3, u32);

fn cases(count: usize, spins: &[f64], orders: u32, least: [f64; 2], seed: u32) -> Vec<Case> {
    let mut random = Random(seed);
    let case = |i: usize| {
        let a = spins[i % spins.len()];
        let mut place = |least: f64| {
            let r = horizon_outer(a) + random.log(least, 1000.0);
            chart(r, random.even(-1.0, 1.0).acos(), random.even(0.0, 2.0 * PI))
        };
        let (observer, point) = (place(least[0]), place(least[1]));
        (a, observer, point, (random.next() * f64::from(orders + 1)) as u32)
    };
    (0..count).map(case).collect()
}

/// How many points have no image, and how many rays miss their point by more than 1e-6 of its distance.
fn lost_and_missed(cases: &[Case]) -> [usize; 2] {
    let miss = |&(a, observer, point, order): &Case| {
        let frame = LocalFrame::new(a, observer).unwrap();
        let found = image(&frame, point, order);
        if let Err(why) = found {
            println!("{why:?}: spin {a}, order {order}, {observer} {point}");
        }
        found.ok().map(|image| {
            let miss = least_distance(&frame, image.look, point) / point.distance(observer);
            if miss > 1e-6 {
                println!("missed by {miss:e}: spin {a}, order {order}, {observer} {point}");
            }
            miss
        })
    };
    let begun = Instant::now();
    let found = cases.par_iter().map(miss).collect::<Vec<_>>();
    let lost = found.iter().filter(|miss| miss.is_none()).count();
    let missed = found.iter().flatten().filter(|miss| miss.is_nan() || **miss > 1e-6).count();
    let [first, last] = [cases[0].0, cases[cases.len() - 1].0];
    let worst = found.iter().flatten().copied().fold(0.0, f64::max);
    println!(
        "spins {first} to {last}: {lost} of {} lost, {missed} missed, at most by {worst:.1e}, {:?}",
        cases.len(),
        begun.elapsed()
    );
    [lost, missed]
}

/// The number of random cases: `all` in `tests/run all`, else a twenty-fifth.
fn count(all: usize) -> usize {
    if runs_all() { all } else { all / 25 }
}

const SPINS: [f64; 4] = [0.5, 0.9, -0.998, 0.9999];

#[test]
fn rays_of_images_pass_their_points_without_spin() {
    let cases = cases(count(50_000), &[0.0], HIGHEST_ORDER, [0.3, 0.05], 1);
    assert_eq!(lost_and_missed(&cases), [0, 0]);
}

#[test]
fn rays_of_images_pass_their_points_with_spin() {
    let cases = cases(count(50_000), &SPINS, 1, [2.0, 1.0], 2);
    let [lost, missed] = lost_and_missed(&cases);
    assert_eq!(missed, 0);
    assert!(lost * 10_000 <= cases.len(), "{lost} lost");
}

/// About the fastest holes, of which there are rays but no frames.
#[test]
fn images_about_the_fastest_holes() {
    let cases = cases(count(10_000), &[1.0, -1.0, 1.0 - 1e-6, 1e-12 - 1.0], 1, [2.0, 1.0], 6);
    let [lost, missed] = lost_and_missed(&cases);
    assert_eq!(missed, 0);
    assert!(lost * 500 <= cases.len(), "{lost} lost");
}

/// Rain observers between the horizons of spinning holes, and beside the outer one: the rays pass their points within
/// 1e-9 (1 + conditioning), which is what they turn by as the look does.
#[test]
#[ignore = "in tests/run all; everyday: falling observers see points from inside (scene::project)"]
fn images_inside_the_horizon() {
    let rain = |a: f64, place: DVec3| LocalFrame::rain(a, place).unwrap();
    let all = cases(count(10_000), &[0.9, -0.5, 0.998, 0.1, -0.9999], HIGHEST_ORDER, [0.1, 0.1], 7);
    let mut random = Random(11);
    let placed = |(i, (a, observer, point, order)): (usize, Case)| {
        let (outer, inner) = (horizon_outer(a), innermost_radius(a));
        let r = match i / 5 % 5 {
            0 => outer * (1.0 + 1e-6 * random.even(-1.0, 1.0)),
            1 => outer + 0.3 * random.next(),
            2 => inner * (1.0 + random.log(1e-6, 0.1)),
            _ => random.even(inner, outer),
        };
        (a, observer.normalize() * r, point, order)
    };
    let all = all.into_iter().enumerate().map(placed).collect::<Vec<_>>();
    for order in 0..=HIGHEST_ORDER {
        let begun = Instant::now();
        let cases = all.iter().filter(|case| case.3 == order).collect::<Vec<_>>();
        let miss = |&&(a, observer, point, order): &&Case| {
            let frame = rain(a, observer);
            let Ok(image) = image(&frame, point, order) else {
                println!("lost: spin {a}, order {order}, {observer} r {} {point}", observer.length());
                return None;
            };
            let distance = point.distance(observer);
            let aim = Aim::new(image.look, 1.0);
            let small = aim.small(&frame, order);
            let beside = aim.with(aim.vector() + DVec3::new(0.6, 0.8, 0.0) * small).look();
            let [miss, near] = [image.look, beside].map(|look| least_distance(&frame, look, point) / distance);
            Some((miss, near / small))
        };
        let found = cases.par_iter().map(miss).collect::<Vec<_>>();
        let lost = found.iter().filter(|miss| miss.is_none()).count();
        let greatest = |of: fn(&(f64, f64)) -> f64| found.iter().flatten().map(of).fold(0.0, f64::max);
        let [worst, by_conditioning] = [greatest(|m| m.0), greatest(|m| m.0 / (1.0 + m.1))];
        println!(
            "order {order}: {lost} of {} lost, missed by {worst:.1e}, {by_conditioning:.1e} (1 + conditioning), {:?}",
            cases.len(),
            begun.elapsed()
        );
        let most = [1e-9, 1e-9, 1e-8, 1e-7][order as usize];
        assert!(by_conditioning < most && (order > 1 || worst < 1e-8), "{worst:.1e} {by_conditioning:.1e}");
        assert!(lost * 20 <= cases.len(), "{lost} lost");
    }
}

/// On both sides of the horizon the image is the same.
#[test]
fn images_do_not_jump_at_the_horizon() {
    let (mut jump, mut compared) = (0.0_f64, 0);
    for (i, (a, observer, point, order)) in cases(60, &[0.9, -0.5, 0.998], 1, [0.1, 0.5], 20).into_iter().enumerate() {
        let at = |r: f64| image(&LocalFrame::rain(a, observer.normalize() * r).unwrap(), point, order).ok();
        let r_plus = horizon_outer(a);
        let (Some(above), Some(below)) = (at(r_plus * (1.0 + 1e-6)), at(r_plus * (1.0 - 1e-6))) else { continue };
        jump = jump.max(above.look.distance(below.look));
        for (x, y) in [(above.magnification, below.magnification), (above.redshift, below.redshift)] {
            assert!((x / y - 1.0).abs() < 1e-3, "{i}: {above:?} {below:?}");
        }
        compared += 1;
    }
    println!("{compared} images change by {jump:.1e} from r+ (1 + 1e-6) to r+ (1 - 1e-6)");
    assert!(compared > 55 && jump < 1e-4, "{compared} {jump:.1e}");
}

/// Higher orders, where caustics are wide, and places beside the horizon.
#[test]
#[ignore = "in tests/run all; everyday: rays of images pass their points"]
fn images_that_are_hard_to_find() {
    for (orders, least) in [(0, [0.3, 0.05]), (3, [2.0, 1.0])] {
        let cases = cases(count(24_000), &SPINS, orders, least, 3);
        let [lost, missed] = lost_and_missed(&cases);
        assert_eq!(missed, 0);
        assert!(lost * 10_000 <= cases.len(), "{lost} lost");
    }
}

/// Reciprocity (Etherington 1933): light that goes the other way, about a hole that turns the other way, takes as long,
/// and beams widen by the same but for the square of the redshift.
#[test]
fn images_are_reciprocal() {
    let mut compared = 0;
    for (a, observer, point, order) in cases(120, &[0.0, 0.6, -0.95], 1, [2.0, 1.0], 4) {
        let frames = [LocalFrame::new(a, observer).unwrap(), LocalFrame::new(-a, point).unwrap()];
        let there = image(&frames[0], point, order).ok().zip(image(&frames[1], observer, order).ok());
        let Some((to, fro)) = there else { continue };
        let delay = |image: &Image| image.constants.retardation(&image.start, &image.there);
        let [one, other] = [delay(&to), delay(&fro)];
        assert!((one / other - 1.0).abs() < 1e-7, "spin {a}, order {order}: {one} {other}");
        assert!((to.redshift * fro.redshift - 1.0).abs() < 1e-7, "{} {}", to.redshift, fro.redshift);
        let ratio = fro.magnification / to.magnification / to.redshift.powi(2);
        assert!((ratio - 1.0).abs() < 1e-4, "spin {a}, order {order}, {observer} {point}: {ratio}");
        compared += 1;
    }
    assert!(compared > 110, "{compared}");
}

/// Rays towards the hole have energies next to 0 there, and steps too short to go anywhere.
#[test]
fn observers_on_the_horizon_get_an_answer() {
    let place = DVec3::new(1.076_880_086_083_842, 1.673_458_226_511_358_7, 0.199_666_833_293_656_3);
    for distance in [2.0, 2.0 * (1.0 - f64::EPSILON), 2.0 * (1.0 + f64::EPSILON), 2.0 + 1e-12] {
        let Ok(frame) = LocalFrame::new(0.0, place.normalize() * distance) else { continue };
        let begun = Instant::now();
        for point in [DVec3::new(6.3, 0.999, 3.1), DVec3::new(-3.0, 0.1, 0.0)] {
            for order in 0..=HIGHEST_ORDER {
                let found = image(&frame, point, order);
                assert!(found.is_err() || found.is_ok_and(|image| image.look.is_normalized()), "r = {distance}");
            }
        }
        assert!(begun.elapsed().as_secs() < 30, "r = {distance}: {:?}", begun.elapsed());
    }
}

/// The lens equation of weak fields: with x the angle from the hole in Einstein radii, mu = 1/2 +- (x^2 + 2) / (2 x
/// sqrt(x^2 + 4)) (Schneider, Ehlers & Falco 1992, chapter 2).
#[test]
fn far_images_obey_the_lens_equation() {
    let distance = 1e7_f64;
    let einstein = (4.0 / (2.0 * distance)).sqrt();
    for x in [0.3_f64, 1.0, 2.5] {
        // Half as far behind the hole as from the observer to it, twice the angle of the whole way.
        let beside = 2.0 * x * einstein * distance;
        let (observer, point) = (DVec3::new(distance, 0.0, 0.0), DVec3::new(-distance, 0.0, beside));
        for a in [0.0, 0.7] {
            let frame = LocalFrame::new(a, observer).unwrap();
            let part = (x * x + 2.0) / (2.0 * x * (x * x + 4.0).sqrt());
            for (order, expected) in [(0, 0.5 + part), (1, 0.5 - part)] {
                let found = image(&frame, point, order).unwrap();
                assert!((found.magnification / expected - 1.0).abs() < 0.01, "{x} {order}: {found:?} {expected}");
                let angle = found.look.x.acos().min((-found.look.x).acos());
                let seen = 0.5 * ((x * x + 4.0).sqrt() + if order == 0 { x } else { -x }) * einstein;
                assert!((angle / seen - 1.0).abs() < 0.01, "{angle} {seen}");
            }
        }
    }
}

#[test]
fn points_straight_above_and_below_have_radial_rays() {
    for (r, below, above) in [(10.0, 4.0, 30.0), (1e6, 2.1, 2e6)] {
        let direction = DVec3::new(0.36, 0.48, 0.8);
        let frame = LocalFrame::new(0.0, direction * r).unwrap();
        for target in [below, above] {
            let image = image(&frame, direction * target, 0).unwrap();
            let expected = (r - target).abs() + 2.0 * ((r - 2.0) / (target - 2.0)).ln().abs();
            let delay = image.constants.retardation(&image.start, &image.there);
            assert!((delay / expected - 1.0).abs() < 1e-7, "{delay} {expected}");
            let lapse = |r: f64| (1.0 - 2.0 / r).sqrt();
            assert!((image.redshift * lapse(r) / lapse(target) - 1.0).abs() < 1e-9);
        }
    }
}

#[test]
fn points_that_have_no_image_have_none() {
    let observer = DVec3::new(9.0, 2.0, 3.0);
    for a in [0.0, 0.9] {
        let frame = LocalFrame::new(a, observer).unwrap();
        for point in [observer, DVec3::ZERO, DVec3::X * horizon_outer(a), DVec3::Y * 0.5, DVec3::splat(f64::NAN)] {
            assert_eq!(image(&frame, point, 0).err(), Some(NoImage::None), "{point}");
        }
    }
}
