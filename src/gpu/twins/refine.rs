//! Twins of refine/refine: where samples lie, and how much the disk covers of their cells.

use super::inputs::{Inputs, Outputs};
use super::scenes::{self, FRAMES, Kind, push_place, view};
use super::{Group, ROUNDING, SAME, twin};
use crate::physics::lens::critical::shadow_centre;
use crate::scene::refine::{CURVE_SAMPLES, Crossings, curve_place, level_of_share, quarter_place, share_below};
use glam::DVec2;

/// Each thread has the four samples of a pixel in arrays of its own, which are a workgroup's in the kernel.
const HEAD: &str = "
#import refine/refine
#import shared/pass
fn ray_record(id: vec2<u32>) -> Record { var record: Record; return record; }
fn medium_before(k: u32) -> vec4<f32> { return vec4<f32>(0.0, 0.0, 0.0, 1.0); }
fn next_crossing() -> Crossing { var crossing: Crossing; return crossing; }
fn more_crossings() -> bool { return false; }
fn rewind_crossings() {}
fn take_light(id: vec2<u32>, light: vec4<f32>) {}
fn enter_samples() {
    enter_scene();
    frame.max_crossings = 1u;
    frame.disk_u = in2(1u);
    frame.disk.z = 0.5;
    for (var k = 0u; k < 4u; k += 1u) {
        lane_u[k * CROSSINGS_KEPT] = in1(3u + k);
        lane_fate[k] = FATE_ESCAPED;
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

fn samples(i: &Inputs) -> Crossings {
    Crossings { u: [3, 4, 5, 6].map(|k| i.x(k)), disk_u: [i.x(1), i.x(2)] }
}

fn slope(i: &mut Inputs) {
    i.signed(1e-3, 1.0);
    i.signed(1e-3, 1.0);
}

fn across(i: &Inputs, o: &mut Outputs) {
    let lens = &view(i).lens;
    let across = lens.across(shadow_centre(&lens.observer.frame), [i.x(1), i.x(2)]);
    o.all(across, lens.mapping.pixel_angle * 0.1);
}

pub fn group() -> Group {
    let file = "refine/refine";
    let any = Kind::Static.constants();
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
            file,
            "curve_place sample_index",
            "samples = 32u; lane = word(0u); out2(curve_place(in2(1u)));",
            |i| {
                i.pick(64);
                slope(i);
            },
            |i, o| o.all(curve_place(i.word(0) % CURVE_SAMPLES, [i.x(1), i.x(2)]), 1.0),
            // A ray's lattice is a fraction of a number up to 20.
            3e-6,
        ),
        twin(
            file,
            "level_of_share",
            "out1(level_of_share(in1(0u), normalize(in2(1u))));",
            |i| {
                i.even(0.01, 0.99);
                slope(i);
            },
            |i, o| o.near(level_of_share(i.x(0), i.v2(1).normalize().to_array()), 1.0),
            ROUNDING,
        ),
        twin(
            file,
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
            file,
            "covered_share",
            "enter_samples(); lane = word(7u); out1(covered_share(lane_u[lane * CROSSINGS_KEPT], 0u));",
            push_samples,
            |i, o| o.near(samples(i).covered_share(i.word(7) as usize), 1.0),
            ROUNDING,
        ),
        twin(
            file,
            "is_ragged even_change",
            "enter_samples(); lane = 0u; out_flag(is_ragged());",
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
                o.all((sum / 4.0).to_array(), 0.0);
            },
            ROUNDING,
        ),
        twin(
            file,
            "across_curve",
            "enter_scene(); pass_.origin = vec2<i32>(-1); pass_.offset = in2(1u);
             out2(across_curve(vec2<u32>(0u)));",
            |i| {
                let view = [Kind::Spinning, Kind::Static][i.random.below(2) as usize].push(i);
                push_place(i, view);
            },
            across,
            1e-4,
        )
        .with(&any),
    ];
    Group { name: "refine", head: [HEAD, FRAMES].concat(), twins, images: Vec::new, tables: scenes::tables }
}
