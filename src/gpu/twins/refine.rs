// SPDX-License-Identifier: MIT OR Apache-2.0
//! Twins of the files of refine/: where samples lie, and how much the disk covers of their cells.

use super::inputs::Inputs;
use super::scenes::{self, FRAMES, Kind, View, push_look, view};
use super::{Group, ROUNDING, SAME, twin};
use crate::cpu::refine::{LevelAbout, with_whole_turns};
use crate::physics::lens::critical::{CurveLevel, potential_minimum};
use crate::scene::cell::{CellCrossing, share_below};
use crate::scene::refine::{
    CURVE_SAMPLES, Crossings, MATTER_CURVE_SAMPLES, MATTER_NARROWEST, NARROWEST, Strips, quarter_place, spread,
};
use glam::DVec2;

/// Each thread has the four samples of a pixel in arrays of its own, which are a workgroup's in the kernel.
const HEAD: &str = "
#import refine/refine
#import shared/pass
const MATTER_SAMPLES: u32 = CURVE_SAMPLES / 2u;
fn ray_record(id: vec2<u32>) -> Record { var record: Record; return record; }
fn medium_before(k: u32) -> vec4<f32> { return vec4<f32>(0.0, 0.0, 0.0, 1.0); }
fn next_crossing() -> Crossing { var crossing: Crossing; return crossing; }
fn more_crossings() -> bool { return false; }
fn with_sky(record: Record) -> Record { return record; }
fn rewind_crossings() {}
fn sample_turn() -> f32 { return UNKNOWN_TURN; }
fn take_light(id: vec2<u32>, light: vec4<f32>) {}
fn enter_samples() {
    enter_scene();
    frame.max_crossings = 1u;
    frame.disk_u = in2(1u);
    frame.disk_opacity = 0.5;
    for (var k = 0u; k < 4u; k += 1u) {
        lane_u[k * LANE_ORDERS] = in1(3u + k);
        lane_sky[k].w = f32(FATE_ESCAPED);
    }
}
";

/// A scene, the disk's radii, and u of four samples, of which some may be missing or beside the disk.
fn push_samples(i: &mut Inputs) {
    Kind::Static.push(i);
    let far = i.log(0.005, 0.1);
    let near = i.even(far * 1.2, 0.3);
    let (middle, span) = (i.random.even(0.4 * far, 1.4 * near), i.random.log(1e-4, 0.2));
    for _ in 0..4 {
        let u = middle + i.random.even(-0.5, 0.5) * span;
        let missing = i.random.below(12) == 0;
        i.push(if missing { 0.0 } else { u.max(1e-4) });
    }
    i.pick(4);
}

/// A scene, the disk's radii, u of a sample and of those beside it, and which part of its cell is seen.
fn push_cell(i: &mut Inputs) {
    Kind::Static.push(i);
    let far = i.log(0.005, 0.1);
    let near = i.even(far * 1.2, 0.3);
    let (middle, span) = (i.random.even(0.4 * far, 1.4 * near), i.random.log(1e-4, 0.2));
    for number in 0..5 {
        let u = (middle + i.random.even(-0.5, 0.5) * span).max(1e-4);
        let missing = number > 0 && i.random.below(12) == 0;
        i.push(if missing { 0.0 } else { u });
    }
    i.pick(5);
}

fn samples(i: &Inputs) -> Crossings {
    Crossings { u: [3, 4, 5, 6].map(|k| i.x(k)), disk_u: [i.x(1), i.x(2)] }
}

fn slope(i: &mut Inputs) {
    i.signed(1e-3, 1.0);
    i.signed(1e-3, 1.0);
}

/// A place of a frame near the critical curve: on the way from one at random to where the level is 0. `false`: there is
/// no curve in sight.
fn push_near_curve(i: &mut Inputs, view: &View) -> bool {
    let (mapping, level) = (&view.lens.mapping, CurveLevel::new(&view.lens.observer.frame));
    let end = [i.random.even(0.0, mapping.width), i.random.even(0.0, mapping.height)];
    let begin = [i.random.even(0.0, mapping.width), i.random.even(0.0, mapping.height)];
    let at = |part: f64| [0, 1].map(|c| begin[c] + part * (end[c] - begin[c]));
    let outside = |part: f64| LevelAbout::new(&view.lens, &level, at(part)).at([0.0; 2]) > 0.0;
    let (mut low, mut high) = (0.0, 1.0);
    let seen = outside(low) != outside(high);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if outside(middle) == outside(low) { low = middle } else { high = middle }
    }
    let off = [i.random.even(-2.0, 2.0), i.random.even(-2.0, 2.0)];
    let place = at(high);
    i.push(place[0] + off[0]);
    i.push(place[1] + off[1]);
    seen
}

/// The strips of a pixel, the slope of its level, and the curve's distance.
fn strips_of(i: &Inputs) -> (Strips, f64, f64) {
    let lens = &view(i).lens;
    let level = CurveLevel::new(&lens.observer.frame);
    let level = LevelAbout::new(lens, &level, [i.x(1), i.x(2)]);
    let (strips, slope) = level.strips(CURVE_SAMPLES);
    (strips, slope, level.curve_distance())
}

pub fn group() -> Group {
    let (file, strips, cell) = ("refine/refine", "refine/strips", "refine/cell");
    let any = Kind::Spinning.constants();
    let twins = vec![
        twin(
            file,
            "quarter_place",
            "lane = word(0u); out2(quarter_place());",
            |i| {
                i.pick(64);
            },
            |i, o| o.all(quarter_place(i.word(0)), 1.0),
            SAME,
        ),
        twin(
            strips,
            "spread narrowest",
            "samples = select(MATTER_SAMPLES, CURVE_SAMPLES, word(1u) == 0u); out1(spread(in1(0u)));",
            |i| {
                i.signed(1e-4, 16.0);
                i.pick(2);
            },
            |i, o| o.near(spread(i.x(0), [NARROWEST, MATTER_NARROWEST][i.word(1) as usize]), 1.0),
            ROUNDING,
        ),
        twin(
            strips,
            "gathered",
            "samples = select(MATTER_SAMPLES, CURVE_SAMPLES, word(1u) == 0u); out1(gathered(in1(0u)));",
            |i| {
                i.even(-8.0, 8.0);
                i.pick(2);
            },
            |i, o| {
                let narrowest = [NARROWEST, MATTER_NARROWEST][i.word(1) as usize];
                o.near(narrowest * i.x(0).sinh(), narrowest);
            },
            ROUNDING,
        ),
        twin(
            strips,
            "strips_at strip_distance strip_cell sample_index strip_count",
            "samples = word(4u); lane = word(0u);
             let cell = strip_cell(strips_at(in1(3u), normalize(in2(1u)), 1.0));
             out2(cell.place); out1(cell.distance); out1(cell.weight); out1(cell.weight * cell.first_half);",
            |i| {
                i.pick(64);
                slope(i);
                i.even(-3.0, 3.0);
                let samples = [CURVE_SAMPLES, MATTER_CURVE_SAMPLES][i.random.below(2) as usize];
                i.push_word(samples);
            },
            |i, o| {
                let samples = i.word(4);
                let cell = Strips::new(i.x(3), [i.x(1), i.x(2)], samples).cell(i.word(0) % samples);
                o.all(cell.place, 1.0);
                o.near(cell.distance, 1.0);
                o.near(cell.weight, 1.0);
                // The share of a narrow cell is a small difference; its weight times this one is what counts.
                o.near(cell.weight * cell.first_half, 1.0);
            },
            // Chords in a corner of the pixel are differences of numbers of a pixel's size.
            2e-4,
        ),
        twin(
            cell,
            "share_below",
            "out1(share_below(in1(0u), in2(1u)));",
            |i| {
                i.even(-1.0, 1.0);
                slope(i);
            },
            |i, o| o.near(share_below(i.x(0), DVec2::to_array(&i.v2(1))), 1.0),
            ROUNDING,
        ),
        twin(
            cell,
            "covered cell_crossing change_of_u half_cell levels_on_disk sum_below",
            "enter_scene(); frame.disk_u = in2(1u);
             let whole = cell_crossing(in1(3u), in4(4u));
             var part = whole;
             if word(8u) == 1u || word(8u) == 2u {
                 part = half_cell(whole, f32(word(8u)) * 2.0 - 3.0);
             }
             var levels = levels_on_disk(part);
             let middle = 0.5 * (levels.x + levels.y);
             levels = select(levels, vec2<f32>(levels.x, middle), word(8u) == 3u);
             levels = select(levels, vec2<f32>(middle, levels.y), word(8u) == 4u);
             out2(levels);
             let seen = covered(part, levels);
             out1(max(seen.x, 0.0));
             out1(max(seen.x, 0.0) * seen.y);",
            push_cell,
            |i, o| {
                let whole = CellCrossing::new(i.x(3), [[i.x(4), i.x(5)], [i.x(6), i.x(7)]]);
                let part = match i.word(8) {
                    side @ (1 | 2) => whole.half(f64::from(side) * 2.0 - 3.0),
                    _ => whole,
                };
                let [low, high] = part.levels_on([i.x(1), i.x(2)]);
                let middle = 0.5 * (low + high);
                let levels = match i.word(8) {
                    3 => [low, middle],
                    4 => [middle, high],
                    _ => [low, high],
                };
                // Rounding of u, which is some ten times as large, in the cell's own change of it.
                let span = part.du[0].abs() + part.du[1].abs();
                o.all(levels, span + 1e-3);
                let seen = part.covered(levels);
                o.near(seen.map_or(0.0, |seen| seen.share), 1.0 + 1e-3 / span.max(1e-6));
                o.near(seen.map_or(0.0, |seen| seen.share * seen.u), 0.2 + 2e-4 / span.max(1e-6));
            },
            2e-4,
        ),
        twin(
            file,
            "with_whole_turns",
            "out3(with_whole_turns(in3(0u), in3(3u), in1(6u)));",
            |i| {
                i.direction();
                i.direction();
                let turn = i.random.even(-20.0, 20.0);
                let none = i.random.below(4) == 0;
                i.push(if none { 0.0 } else { turn });
            },
            |i, o| o.all(with_whole_turns(i.v3(0), i.v3(3), i.x(6)).to_array(), 20.0),
            ROUNDING,
        ),
        twin(
            file,
            "quarters_evenness even_change",
            "enter_samples(); lane = 0u; out_flag(quarters_evenness() == RAGGED);",
            push_samples,
            |i, o| o.flag(samples(i).are_ragged(true)),
            SAME,
        ),
        twin(
            file,
            "mean_light",
            "samples = 4u; lane = 0u;
             for (var k = 0u; k < 4u; k += 1u) { lane_light[k] = in4(4u * k); }
             out4(mean_light());",
            |i| i.evens(16, 0.0, 10.0),
            |i, o| {
                let sum = i.v4(0) + i.v4(4) + i.v4(8) + i.v4(12);
                o.all(sum.to_array(), 0.0);
            },
            ROUNDING,
        ),
        twin(
            strips,
            "strips_of level_about curve_distance level_at go_to_pixel",
            "samples = CURVE_SAMPLES; enter_scene(); go_to_pixel(in2(1u)); let about = level_about();
             let strips = strips_of(about);
             out1(strips.level); out1(strips.slope); out2(strips.normal); out1(curve_distance(about));",
            |i| {
                loop {
                    i.clear();
                    let view = [Kind::Spinning, Kind::Static][i.random.below(2) as usize].push(i);
                    if push_near_curve(i, view) {
                        break;
                    }
                }
            },
            |i, o| {
                let (strips, slope, distance) = strips_of(i);
                o.near(strips.level, 1.0);
                o.near(slope, 1e-6);
                o.all(strips.normal, 1.0);
                o.near(distance, 1.0);
            },
            5e-3,
        )
        .with(&any),
        twin(
            "camera/critical",
            "curve_level",
            "enter_scene(); out1(curve_level(in3(1u)));",
            |i| {
                let kind = [Kind::Spinning, Kind::Static, Kind::Rain][i.random.below(3) as usize];
                let view = kind.push(i);
                push_look(i, view);
            },
            |i, o| o.near(CurveLevel::new(&view(i).lens.observer.frame).at(i.v3(1).normalize()), 1.0),
            4e-6,
        )
        .with(&any),
        twin(
            "camera/critical",
            "curve_level curve_level_within",
            "enter_scene(); out1(curve_level(in3(1u)));",
            |i| loop {
                i.clear();
                let view = Kind::SpinningRain.push(i);
                let n = push_look(i, view);
                // Where the least potential is at the horizon, the root of a small difference is lost in rounding.
                let (c, s) = view.lens.observer.frame.start(n.normalize()).expect("light");
                if potential_minimum(&c) * c.r_plus < 0.999 || (s.u * c.r_plus - 1.0).abs() > 1e-2 {
                    return;
                }
            },
            |i, o| {
                let frame = view(i).lens.observer.frame;
                let (c, s) = frame.start(i.v3(1).normalize()).expect("light");
                // P is a difference of terms that grow with 1/r.
                let size = 1.0 + c.k * s.u * s.u.min(potential_minimum(&c));
                o.near(CurveLevel::new(&frame).at(i.v3(1).normalize()), size);
            },
            1e-5,
        )
        .with(&Kind::SpinningRain.constants()),
        twin(
            "camera/critical",
            "potential_minimum",
            "enter_scene(); out1(potential_minimum(begin_local(in3(1u)).c));",
            |i| {
                let view = Kind::Spinning.push(i);
                push_look(i, view);
            },
            |i, o| {
                let (c, _) = view(i).lens.observer.frame.start(i.v3(1).normalize()).expect("light");
                o.near(potential_minimum(&c), 0.1);
            },
            4e-6,
        )
        .with(&Kind::Spinning.constants()),
    ];
    Group { name: "refine", head: [HEAD, FRAMES].concat(), twins, images: Vec::new, tables: scenes::tables }
}
