// SPDX-License-Identifier: MIT OR Apache-2.0
//! Twins of shade/shade: the light of a whole record, and the values of views, as the CPU tracer has them. The disk is
//! that of spin 0, whose profile is bound.

use super::inputs::{Inputs, Outputs};
use super::light::EmissionPoint;
use super::run::Image;
use super::scenes::{self, FRAMES, Kind, push_place, views};
use super::{Group, light, sky, twin};
use crate::cpu::shade::{Shader, Shading};
use crate::emit::Crossing;
use crate::emit::medium::Medium;
use crate::emit::thin_disk::profile_row;
use crate::gpu::kernel::sizes::TABLE_WIDTH;
use crate::physics::disk_flux::TemperatureProfile;
use crate::physics::trace::Fate;
use crate::scene::View;
use crate::scene::record::Record;
use crate::sky::StarField;
use crate::sky::index::PROFILE_OFFSET;
use glam::DVec3;
use std::f64::consts::PI;
use std::sync::OnceLock;

const HEAD: &str = "
#import shade/record
#import shade/only
fn write_pixel(id: vec2<u32>, radiance: vec4<f32>) {}
fn with_sky(record: Record) -> Record { return record; }
fn edges_of_pixel(through: f32, turn: f32) -> u32 { return EDGE_NONE; }
var<private> given: bool;
fn next_crossing() -> Crossing {
    var crossing: Crossing;
    if !given {
        given = true;
        crossing.u = in1(16u);
        crossing.g = in1(17u);
        crossing.order = word(18u);
        crossing.place = in_place(19u);
        crossing.dx = in_place(22u);
        crossing.dy = in_place(25u);
    }
    return crossing;
}
fn medium_before(k: u32) -> vec4<f32> { return select(in4(28u), in4(32u), k > 0u); }
fn more_crossings() -> bool { return !given; }
fn in_place(k: u32) -> EmissionPoint { return EmissionPoint(in1(k), in1(k + 1u), in1(k + 2u)); }
fn enter_record() -> Record {
    enter_scene();
    frame.max_crossings = 4u;
    pass_.origin = vec2<i32>(-1);
    pass_.offset = in2(1u);
    var record: Record;
    record.fate = word(3u);
    record.energy = in1(4u);
    record.angular_momentum = in1(5u);
    record.sky_redshift = in1(6u);
    record.sky = in3(7u);
    record.footprint = footprint_of(in3(7u), in3(10u), in3(13u));
    record.steps = word(18u);
    record.plane_u = in1(16u);
    record.polar_momentum = in1(36u);
    return record;
}
";

const VIEWS: [View; 6] = [View::Light, View::Redshift, View::Order, View::Deflection, View::Steps, View::Metric];
/// Where the view's number is.
const VIEW: usize = 37;
/// Where `polar_momentum` is.
const POLAR: usize = 36;

/// A shader for each view of each scene.
fn shader(i: &Inputs, view: u32) -> &'static Shader<'static> {
    static SHADERS: OnceLock<Vec<Shader<'static>>> = OnceLock::new();
    let all = SHADERS.get_or_init(|| {
        let plain = views().iter().skip(scenes::EACH as usize);
        let made = plain.flat_map(|known| {
            VIEWS.map(|view| {
                let mut scene = known.scene.clone();
                scene.view = view;
                // They live as long as the test.
                let scene = Box::leak(Box::new(scene));
                Shader::new(scene, &known.lens, StarField::catalogue().expect("an index"), false).expect("a shader")
            })
        });
        made.collect()
    });
    &all[(i.word(0) - scenes::EACH) as usize * VIEWS.len() + view as usize]
}

/// A record of a scene without spin: with a crossing or without, escaped or not.
fn push_record(i: &mut Inputs) {
    let known = [Kind::Static, Kind::Rain][i.random.below(2) as usize].push(i);
    push_place(i, known);
    let fate = [Fate::Escaped, Fate::Escaped, Fate::Captured][i.random.below(3) as usize];
    i.push_word(fate as u32);
    i.log(0.2, 1.5);
    i.even(-8.0, 8.0);
    i.log(0.5, 2.0);
    let d = i.direction();
    let (p, q) = d.any_orthonormal_pair();
    let (sin, cos) = i.random.even(0.0, 2.0 * PI).sin_cos();
    let size = i.random.log(3e-3, 0.2);
    let squeeze = i.random.log(0.2, 1.0);
    i.vector((p * cos + q * sin) * size);
    i.vector((q * cos - p * sin) * (size * squeeze));
    let [far, near] = known.scene.emitters().disk_u().expect("a disk");
    let u = i.random.even(far * 1.01, near * 0.99);
    let hits = i.random.below(2) == 0;
    i.push(if hits { u } else { 0.0 });
    i.log(0.4, 1.6);
    i.pick(3);
    i.push(-u.ln());
    i.even(-PI, PI);
    let delay = known.scene.emitters().disk.and_then(|disk| disk.turbulence).map_or(0.0, |t| t.reference_delay);
    i.even(delay - 20.0, delay + 20.0);
    i.evens(6, -0.01, 0.01);
    // The media before the crossing, or the sky, and behind the crossing.
    for _ in 0..2 {
        i.evens(3, 0.0, 0.3);
        i.even(0.3, 1.0);
    }
    i.log(0.1, 100.0);
}

fn place(i: &Inputs, k: usize) -> EmissionPoint {
    EmissionPoint { ln_r: i.x(k), azimuth: i.x(k + 1), delay: i.x(k + 2) }
}

fn record(i: &Inputs) -> Record {
    let fate = if i.word(3) == Fate::Escaped as u32 { Fate::Escaped } else { Fate::Captured };
    let across = |v: DVec3| v - i.v3(7) * i.v3(7).dot(v);
    let mut record = Record {
        fate,
        direction: i.v3(7),
        footprint: [across(i.v3(10)), across(i.v3(13))],
        sky_redshift: i.x(6),
        energy: i.x(4),
        angular_momentum: i.x(5),
        polar_momentum: i.x(POLAR),
        steps: i.word(18),
        plane_u: i.x(16),
        ..Record::captured()
    };
    if i.x(16) > 0.0 {
        record.crossings.push(Crossing {
            u: i.x(16),
            order: i.word(18),
            g: i.x(17),
            place: place(i, 19),
            footprint: [place(i, 22), place(i, 25)],
            share: 1.0,
        });
    }
    let medium = |k: usize| Medium { light: i.v3(k).to_array(), through: i.x(k + 3), ..Medium::default() };
    record.media.extend([medium(28)]);
    if i.x(16) > 0.0 {
        record.media.push(medium(32));
    }
    record
}

fn light_of_record(i: &Inputs, o: &mut Outputs) {
    let [r, g, b, alpha] = Shading { shader: shader(i, 0), moment: 0.0 }.shade_record(&record(i), i.x(1), i.x(2));
    o.all([r, g, b], 1e-3);
    o.near(alpha, 1.0);
}

fn value(i: &Inputs, o: &mut Outputs) {
    let [value, ..] = Shading { shader: shader(i, i.word(VIEW)), moment: 0.0 }.shade_record(&record(i), i.x(1), i.x(2));
    o.near(value, 1.0);
}

fn images() -> Vec<Image> {
    let index = StarField::catalogue().expect("an index");
    let mut light = index.light_tables().collect::<Vec<_>>();
    let profile = TemperatureProfile::new(0.0);
    light[PROFILE_OFFSET..].iter_mut().zip(profile_row(&profile)).for_each(|(out, entry)| *out = entry);
    light.resize(light.len().next_multiple_of(TABLE_WIDTH), [0.0; 4]);
    let mut cells = index.cell_tables().collect::<Vec<_>>();
    cells.resize(cells.len().next_multiple_of(TABLE_WIDTH), 0);
    let image = |name, format, rows: usize, bytes: &[u8]| Image {
        name,
        format,
        size: [TABLE_WIDTH as u32, rows as u32, 0],
        levels: 1,
        solid: false,
        bytes: bytes.to_vec(),
    };
    let (float, word) = (wgpu::TextureFormat::Rgba32Float, wgpu::TextureFormat::R32Uint);
    vec![
        image("light_tables", float, light.len() / TABLE_WIDTH, bytemuck::cast_slice(&light)),
        image("star_cells", word, cells.len() / TABLE_WIDTH, bytemuck::cast_slice(&cells)),
        sky::map_image("sky_map", sky::map()),
        sky::map_image("milky_way", sky::map()),
        light::streaks_image(),
        image("occluder", wgpu::TextureFormat::R32Float, 1, &[0; 4 * TABLE_WIDTH]),
    ]
}

pub fn group() -> Group {
    let file = "shade/shade";
    let any = Kind::Static.constants();
    let effects = [("ALL_EFFECTS", 0.0), ("SHOWS_MILKY_WAY", 0.0), ("VOLUMES", 1.0)];
    let twins = vec![
        twin(
            file,
            "shade_record pixel_light crossing_emission crossing_shift sky_light extended_light to_sky least_patch \
             light_table star_cell",
            "let record = enter_record(); out4(shade_record(vec2<u32>(0u), record));",
            push_record,
            light_of_record,
            // The errors of star_light and of under_grid add up.
            3e-3,
        )
        .with(&any)
        .with(&effects),
        twin(
            "emit/shift",
            "visible_shift to_strength",
            "let record = enter_record(); out4(shade_record(vec2<u32>(0u), record));",
            |i| {
                push_record(i);
                // A crossing, and nothing of the sky.
                i.words[3] = Fate::Captured as u32;
            },
            light_of_record,
            // The bound is that of turbulent_brightness.
            4e-3,
        )
        .with(&any)
        .with(&effects),
        twin(
            file,
            "view_value no_value",
            "let record = enter_record(); frame.view = word(37u); out1(shade_record(vec2<u32>(0u), record).x);",
            |i| {
                push_record(i);
                let view = 1 + i.random.below(VIEWS.len() as u32 - 1);
                i.push_word(view);
            },
            value,
            1e-6,
        )
        .with(&any)
        .with(&[("SHOWS_LIGHT", 0.0)]),
    ];
    Group { name: "shade", head: [HEAD, FRAMES].concat(), twins, images, tables: scenes::tables }
}
