// SPDX-License-Identifier: MIT OR Apache-2.0
//! Spikes and streak: that light is kept, and falls along its lines as their formula has it.

use super::*;
use crate::random::runs_all;
use crate::scene::Film;
use std::f64::consts::PI;

pub(super) type Field = Vec<[f32; 4]>;

fn optics(spikes: f64, streak: f64) -> Optics {
    Optics { spikes, streak, ..Optics::default() }
}

pub(super) fn spread(optics: Optics, frame: [u32; 2], light: &Field) -> Field {
    let bloom = Bloom::of(&Film { bloom: 0.0, optics, ..Film::plain() }, frame).expect("grids");
    let mut accumulator = bloom.accumulator().expect("a grid");
    accumulator.add([0, 0], frame[0], light);
    let glare = accumulator.spread().expect("grids");
    let place = |i: usize| (i as u32 % frame[0], i as u32 / frame[0]);
    light.iter().enumerate().map(|(i, v)| glare.over(*v, place(i).0, place(i).1)).collect()
}

pub(super) fn point([width, height]: [u32; 2], [x, y]: [u32; 2]) -> Field {
    let mut light = vec![[0.0; 4]; (width * height) as usize];
    light[(y.min(height - 1) * width + x.min(width - 1)) as usize] = [1000.0; 4];
    light
}

#[test]
fn no_light_is_lost_or_made() {
    let all = [
        Optics { spike_blades: 5, spike_angle: 0.3, ..optics(1.0, 0.0) },
        Optics { spike_blades: 8, spike_angle: PI / 8.0, spike_length: 2.0, ..optics(0.7, 0.0) },
        Optics { streak_tint: 0.8, streak_length: 4.0, ..optics(0.0, 1.0) },
        Optics { spike_length: 0.01, streak_tint: -1.0, ..optics(0.4, 0.6) },
    ];
    let frames = [[1, 1], [2, 1], [1, 9], [7, 5], [64, 64], [101, 67], [2300, 35], [35, 2300]];
    // Everyday the long ones in one direction.
    for frame in frames.into_iter().take(if runs_all() { 8 } else { 7 }) {
        for optics in all {
            let ends = |side: u32| [0, side / 2, side - 1];
            for (x, y) in ends(frame[0]).into_iter().flat_map(|x| ends(frame[1]).map(move |y| (x, y))) {
                let out = spread(optics, frame, &point(frame, [x, y]));
                for c in 0..3 {
                    let sum = out.iter().map(|v| f64::from(v[c])).sum::<f64>();
                    assert!((sum - 1000.0).abs() < 0.1, "{frame:?} ({x}, {y}) {optics:?}: {sum}");
                    assert!(out.iter().all(|v| v[c] >= 0.0), "{frame:?} ({x}, {y}) {optics:?}: light below 0");
                }
            }
        }
    }
}

#[test]
fn an_even_frame_stays_even() {
    for frame in [[5, 3], [129, 67], [640, 361], [33, 2200]] {
        let optics = Optics { spike_blades: 5, spike_angle: 0.2, streak_tint: 1.0, ..optics(1.0, 1.0) };
        let out = spread(optics, frame, &vec![[0.5, 0.25, 2.0, 0.75]; (frame[0] * frame[1]) as usize]);
        for v in out {
            let off = v.iter().zip([0.5, 0.25, 2.0, 0.75]).map(|(a, b): (&f32, f32)| (a / b - 1.0).abs());
            assert!(off.fold(0.0, f32::max) < 2e-5, "{frame:?}: {v:?}");
        }
    }
}

/// The light that passes a circle about a point, against the kernel's integral beyond it; and its colour.
#[test]
fn light_falls_along_lines_as_its_formula_has_it() {
    let frame = [801, 801];
    let height = f64::from(frame[1]);
    for (blades, angle) in [(4, 0.0), (4, 0.7), (6, 0.1), (3, 1.0)] {
        let length = 0.1;
        let optics = Optics { spike_blades: blades, spike_angle: angle, spike_length: length, ..optics(1.0, 0.0) };
        let out = spread(optics, frame, &point(frame, [400, 400]));
        for radius in [12.0, 40.0, 90.0_f64] {
            let mut beyond = [0.0; 3];
            for (i, v) in out.iter().enumerate() {
                let (x, y) = ((i as u32 % frame[0]) as f64 - 400.0, (i as u32 / frame[0]) as f64 - 400.0);
                if x.hypot(y) > radius {
                    (0..3).for_each(|c| beyond[c] += f64::from(v[c]) / 1000.0);
                }
            }
            let terms = (0..4).map(|k| (4.0_f64.powi(k) / 85.0, length * height / 4.0_f64.powi(k)));
            let formula = 0.4 * terms.map(|(part, length)| part * (-radius / length).exp()).sum::<f64>();
            let ratio = beyond[1] / formula;
            assert!((ratio - 1.0).abs() < 0.05, "{blades} blades, {angle}, beyond {radius}: {ratio} of its formula");
            if radius == 90.0 {
                let colours = [beyond[0] / beyond[1] * 549.0 / 611.0, beyond[2] / beyond[1] * 549.0 / 464.0];
                assert!(colours.iter().all(|c| (c - 1.0).abs() < 0.02), "{blades} blades, {angle}: {colours:?}");
            }
        }
    }
}

/// The light of a ring by angle: there are as many spikes as the blades make, each where its angle says.
#[test]
fn blades_make_spikes_where_their_angle_says() {
    let frame = [401, 401];
    for (blades, angle) in [(3, 0.0), (4, 0.5), (5, -1.1), (6, 0.0), (7, 2.0), (8, 0.35)] {
        let optics = Optics { spike_blades: blades, spike_angle: angle, ..optics(1.0, 0.0) };
        let out = spread(optics, frame, &point(frame, [200, 200]));
        let count = if blades % 2 == 0 { blades } else { 2 * blades };
        let (mut on, mut all) = (0.0, 0.0);
        for (i, v) in out.iter().enumerate() {
            let (right, up) = ((i as u32 % frame[0]) as f64 - 200.0, 200.0 - (i as u32 / frame[0]) as f64);
            let radius = right.hypot(up);
            if (60.0..90.0).contains(&radius) {
                // Anticlockwise from upright, in parts of the angle between spikes.
                let turns = ((-right).atan2(up) - angle) / (2.0 * PI / f64::from(count));
                let off_axis = (turns - turns.round()).abs() * 2.0 * PI / f64::from(count) * radius;
                all += f64::from(v[1]);
                on += if off_axis < 5.0 { f64::from(v[1]) } else { 0.0 };
            }
        }
        assert!(
            all > 0.0 && on / all > 0.97,
            "{blades} blades at {angle}: {} of the light on {count} spikes",
            on / all
        );
    }
}

/// The deviation across a line, with the finest grid's own spread in it; and its ridge, which does not ripple from cell
/// to cell.
#[test]
fn spikes_are_as_wide_as_their_angle_has_it() {
    let frame = [401, 401];
    for angle in [0.0, 0.02, 0.12, 0.3, 0.6, PI / 4.0_f64] {
        let optics = Optics { spike_blades: 4, spike_angle: angle, ..optics(1.0, 0.0) };
        let out = spread(optics, frame, &point(frame, [200, 200]));
        let (mut sum, mut squares) = (0.0, 0.0);
        for (i, v) in out.iter().enumerate() {
            let (right, up) = ((i as u32 % frame[0]) as f64 - 200.0, 200.0 - (i as u32 / frame[0]) as f64);
            let (along, across) = (up * angle.cos() - right * angle.sin(), right * angle.cos() + up * angle.sin());
            if (50.0..110.0).contains(&along) && across.abs() < 12.0 {
                sum += f64::from(v[1]);
                squares += f64::from(v[1]) * across * across;
            }
        }
        let (width, wanted) = ((squares / sum).sqrt(), (1.5 + 2.0 * angle.cos().powi(2)).sqrt());
        assert!((width / wanted - 1.0).abs() < 0.02, "{angle}: {width} pixels, not {wanted}");
        let row = |y: usize| out[y * 401..(y + 1) * 401].iter().map(|v| f64::from(v[1])).fold(0.0, f64::max);
        let ripples = (110..150).map(|y| {
            let mean = (y - 16..y + 16).map(|y| row(y).ln()).sum::<f64>() / 32.0;
            (row(y).ln() - mean).powi(2)
        });
        let ripple = (ripples.sum::<f64>() / 40.0).sqrt();
        println!("{angle}: {width} pixels wide, ripples of {ripple}");
        assert!(ripple < 0.04, "{angle}: ripples of {ripple}");
    }
}

#[test]
fn a_streak_is_level_and_has_its_tint() {
    let frame = [640, 120];
    for tint in [-1.0, 0.0, 0.5, 1.0] {
        let out = spread(Optics { streak_tint: tint, ..optics(0.0, 1.0) }, frame, &point(frame, [320, 60]));
        let far = |c: usize, y: u32| f64::from(out[(y * frame[0] + 450) as usize][c]);
        let beside = (0..frame[1]).filter(|y| y.abs_diff(60) > 7).map(|y| far(1, y)).sum::<f64>();
        assert!(beside == 0.0 && far(1, 60) > 0.0, "tint {tint}: {beside} beside the streak");
        let wanted = |part: f64| 1.0 + f64::abs(tint) * (part - 1.0);
        let (blue, red) = (far(2, 60) / far(1, 60), far(0, 60) / far(1, 60));
        let (strong, weak) = (wanted(1.0) / wanted(0.45), wanted(0.12) / wanted(0.45));
        let wanted = if tint < 0.0 { (weak, strong) } else { (strong, weak) };
        assert!((blue - wanted.0).abs() < 1e-3 && (red - wanted.1).abs() < 1e-3, "tint {tint}: {blue}, {red}");
    }
}
