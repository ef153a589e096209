// SPDX-License-Identifier: MIT OR Apache-2.0
//! Ghosts of a lens flare: that light is kept but towards the border, and lies where the lens reflects it, in the
//! aperture's shape.

use super::spike_tests::{Field, point, spread};
use super::*;
use crate::random::runs_all;

fn flare(flare_ghosts: u32) -> Optics {
    Optics { flare: 1.0, flare_ghosts, ..Optics::default() }
}

/// Sums over a frame: of the light in green, and of it times the places of the pixels from the frame's middle.
fn moments(light: &Field, [width, height]: [u32; 2]) -> [f64; 3] {
    let mut sums = [0.0; 3];
    for (i, v) in light.iter().enumerate() {
        let (x, y) = (i as u32 % width, i as u32 / width);
        let from = |i: u32, side: u32| f64::from(i) + 0.5 - 0.5 * f64::from(side);
        let light = f64::from(v[1]);
        [light, light * from(x, width), light * from(y, height)].iter().zip(&mut sums).for_each(|(v, sum)| *sum += v);
    }
    sums
}

/// The light that a frame of one bright pixel gets beside that pixel.
fn ghosts_of(optics: Optics, frame: [u32; 2], place: [u32; 2]) -> Field {
    let light = point(frame, place);
    let mut out = spread(optics, frame, &light);
    for (out, own) in out.iter_mut().zip(&light) {
        (0..3).for_each(|c| out[c] -= (1.0 - Ghosts::share(&optics)) as f32 * own[c]);
    }
    out
}

/// The part of what is reflected of a place's light that reaches ghosts.
fn reflected([x, y]: [u32; 2], [width, height]: [u32; 2]) -> f64 {
    let part = |i: u32, side: u32| (1.0 - ((2.0 * f64::from(i) + 1.0) / f64::from(side) - 1.0).powi(6)).powi(2);
    part(x, width) * part(y, height)
}

#[test]
fn light_is_lost_towards_the_border_only() {
    // Everyday the smallest: what a ghost loses depends on where its light is, in halves of the frame.
    let frames = [[160, 90], [320, 180], [222, 333]];
    for frame in frames.into_iter().take(if runs_all() { 3 } else { 1 }) {
        let mut worst = 0.0_f64;
        for (ghosts, blades) in [(0, 0), (8, 3), (1, 5)] {
            let optics = Optics { spike_blades: blades, spike_angle: 0.3, ..flare(ghosts) };
            let ends = |side: u32| [0, side / 3, side - 1];
            for (x, y) in ends(frame[0]).into_iter().flat_map(|x| ends(frame[1]).map(move |y| (x, y))) {
                let out = spread(optics, frame, &point(frame, [x, y]));
                for c in 0..3 {
                    let sum = out.iter().map(|v| f64::from(v[c])).sum::<f64>();
                    let off = sum / 1000.0 - 0.85 - 0.15 * reflected([x, y], frame);
                    assert!(off.abs() < 0.015 * 0.15, "{frame:?} ({x}, {y}) {ghosts} {blades}: {off}");
                    worst = worst.max(off.abs() / 0.15);
                    assert!(out.iter().all(|v| v[c] >= 0.0), "{frame:?} ({x}, {y}): light below 0");
                }
            }
        }
        println!("{frame:?}: {worst} of the ghosts' light");
    }
}

/// The first ghost lies at -0.38 times the light's own place, wherever between cells that is.
#[test]
fn a_ghost_lies_on_the_line_through_the_middle() {
    let frame = [640, 360];
    for place in [[600, 40], [601, 40], [602, 43], [100, 300], [101, 303], [320, 25], [40, 180]] {
        let [light, x, y] = moments(&ghosts_of(flare(1), frame, place), frame);
        let part = light / 150.0 / reflected(place, frame);
        assert!((part - 1.0).abs() < 0.03, "{place:?}: {part} of the light that is reflected");
        let expected = [0, 1].map(|i| -0.38 * (f64::from(place[i]) + 0.5 - 0.5 * f64::from(frame[i])));
        let off = (x / light - expected[0]).hypot(y / light - expected[1]);
        assert!(off < 0.5, "{place:?}: {off} pixels off");
    }
}

/// Within the polygon that the blades make the ghost is even; beyond it there is nothing; and its edges lie across the
/// directions of the spikes.
#[test]
fn a_ghost_has_the_shape_of_the_aperture() {
    let frame = [1280, 720];
    let place = [940, 520];
    for (blades, angle) in [(3, 0.0), (4, 0.2), (6, 0.0), (7, -0.4)] {
        let optics = Optics { spike_blades: blades, spike_angle: angle, ..flare(1) };
        let out = ghosts_of(optics, frame, place);
        let middle = [0, 1].map(|i| 0.5 * f64::from(frame[i]) * 1.38 - 0.38 * (f64::from(place[i]) + 0.5));
        let n = f64::from(blades);
        let area = n * (std::f64::consts::PI / n).tan();
        let apothem = 0.05 * 720.0 * (std::f64::consts::PI / area).sqrt();
        let even = 0.15 * 1000.0 * reflected(place, frame) / (area * apothem * apothem);
        // Half of the fall-off: a cell of 1 / 45 of the height, magnified, and the spline that gathered its light.
        let soft = 24.0;
        for (i, v) in out.iter().enumerate() {
            let (x, y) = (f64::from(i as u32 % frame[0]) + 0.5, f64::from(i as u32 / frame[0]) + 0.5);
            // The aperture's image is upside down, as the magnification is below 0.
            let [dx, dy] = [middle[0] - x, middle[1] - y];
            let edge = (0..blades)
                .map(|blade| {
                    let normal = angle + std::f64::consts::PI * (0.5 + 2.0 * f64::from(blade) / n);
                    normal.cos() * dx - normal.sin() * dy
                })
                .fold(f64::NEG_INFINITY, f64::max);
            let light = f64::from(v[1]);
            if edge < apothem - soft {
                assert!((light / even - 1.0).abs() < 0.03, "{blades}: {light}, not {even}, {edge} from the middle");
            } else if edge > apothem + soft {
                assert!(light < 0.01 * even, "{blades}: {light} of {even}, {edge} from the middle");
            }
        }
    }
}

/// Ghosts have colours, and together none: within 0.1 % light that was white is white.
#[test]
fn ghosts_have_colours_and_are_neutral_together() {
    let frame = [640, 360];
    for ghosts in [2, 5, 8] {
        let out = ghosts_of(flare(ghosts), frame, [600, 30]);
        let sum = |c: usize| out.iter().map(|v| f64::from(v[c])).sum::<f64>();
        assert!((sum(0) / sum(1) - 1.0).abs() < 2e-3 && (sum(2) / sum(1) - 1.0).abs() < 2e-3, "{ghosts}: not neutral");
        let most = out.iter().max_by(|a, b| a[1].total_cmp(&b[1])).expect("pixels");
        assert!((most[0] / most[1] - 1.0).abs() > 0.1, "{ghosts}: the brightest has no colour: {most:?}");
    }
}
