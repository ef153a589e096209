// SPDX-License-Identifier: MIT OR Apache-2.0
//! Twins of shared/blackbody and emit: thermal light, the disk's profile, its turbulence.

use super::inputs::{Inputs, Outputs};
use super::run::{Image, Table};
use super::scenes::{self, FRAME, FRAMES, Kind, view};
use super::{Group, ROUNDING, SAME, twin};
pub use crate::emit::EmissionPoint;
use crate::emit::streaks::{STREAK_COLUMNS, STREAK_LAST, STREAK_ROWS, Streaks};
use crate::emit::thin_disk::{emission_law, profile_row};
use crate::emit::turbulence::{Turbulence, part_of_side};
use crate::gpu::kernel::slots::STREAKS;
use crate::physics::blackbody::{
    BlackbodyTable, MAX_TEMPERATURE, MIN_TEMPERATURE, fitted_colour, fitted_luminance, into_gamut,
};
use crate::physics::disk_flux::TemperatureProfile;
use crate::physics::observer::LocalFrame;
use crate::physics::orbit::zamo_frequency;
use crate::sky::StarField;
use glam::DVec3;
use std::f64::consts::PI;
use std::sync::OnceLock;

/// The tables of light; each scene's profile lies beside them.
const HOOKS: &str = "
@group(1) @binding(13) var<storage, read> light_tables: array<vec4<f32>>;
@group(1) @binding(14) var<storage, read> profiles: array<vec4<f32>>;
fn light_table(i: u32) -> vec4<f32> {
    if i >= PROFILE_OFFSET && i < PROFILE_OFFSET + PROFILE_SIZE {
        return profiles[word(0u) * PROFILE_SIZE + i - PROFILE_OFFSET];
    }
    return light_tables[i];
}
fn in_place(k: u32) -> EmissionPoint { return EmissionPoint(in1(k), in1(k + 1u), in1(k + 2u)); }
";

fn profiles() -> &'static [TemperatureProfile] {
    static PROFILES: OnceLock<Vec<TemperatureProfile>> = OnceLock::new();
    let make = || scenes::views().iter().map(|view| TemperatureProfile::new(view.scene.matter_spin())).collect();
    PROFILES.get_or_init(make)
}

fn tables() -> Vec<Table> {
    let light = StarField::catalogue().expect("an index").light_tables().collect::<Vec<_>>();
    let rows = profiles().iter().flat_map(profile_row).collect::<Vec<_>>();
    let mut tables = scenes::tables();
    tables.push(Table { name: "light_tables", bytes: bytemuck::cast_slice(&light).to_vec() });
    tables.push(Table { name: "profiles", bytes: bytemuck::cast_slice(&rows).to_vec() });
    tables
}

/// A scene, and a place on its disk.
fn disk_place(i: &mut Inputs) {
    let kind = [Kind::Spinning, Kind::Static, Kind::Rain][i.random.below(3) as usize];
    let view = kind.push(i);
    let [far, near] = view.scene.emitters().disk_u().expect("a disk");
    i.even(far, near);
}

/// Cold light is the exponential of a large number, which f32 knows to its rounding.
fn cold(temperature: f64) -> f64 {
    1.0 + 22135.0 / temperature.max(MIN_TEMPERATURE) * 0.1
}

fn shifted(i: &Inputs, o: &mut Outputs) {
    let table = BlackbodyTable::shared();
    let light = table.shifted_blackbody(i.x(1), i.x(2), i.x(3), i.x(4));
    let largest = light.iter().fold(1e-30_f64, |a, &b| a.max(b));
    o.all(light, largest * cold(i.x(1) * i.x(3)));
}

fn push_place(i: &mut Inputs) {
    let view = [Kind::Spinning, Kind::Static][i.random.below(2) as usize].push(i);
    let delay = turbulence(view).reference_delay;
    i.even(1.8, 3.0);
    i.even(-PI, PI);
    i.even(delay - 40.0, delay + 40.0);
    for _ in 0..2 {
        i.signed(1e-4, 0.3);
        i.signed(1e-4, 0.3);
        i.signed(1e-4, 3.0);
    }
}

fn turbulence(view: &scenes::View) -> Turbulence {
    view.scene.emitters().disk.and_then(|disk| disk.turbulence).expect("turbulence")
}

/// The texture that emit/streaks.wgsl reads.
pub fn streaks_image() -> Image {
    let levels = Streaks::shared().expect("streaks").levels().map(|level| level.expect("a level").1);
    let texels = levels.flatten().flat_map(|pair| pair.map(half::f16::to_bits)).collect::<Vec<_>>();
    Image {
        name: "streaks",
        format: STREAKS.format,
        size: [STREAK_COLUMNS as u32, STREAK_ROWS as u32, 0],
        levels: STREAK_LAST as u32 + 1,
        solid: false,
        bytes: bytemuck::cast_slice(&texels).to_vec(),
    }
}

fn place(i: &Inputs, k: usize) -> EmissionPoint {
    EmissionPoint { ln_r: i.x(k), azimuth: i.x(k + 1), delay: i.x(k + 2) }
}

pub fn group() -> Group {
    let (blackbody, disk, turbulent, shift) = ("shared/blackbody", "emit/disk", "emit/turbulence", "emit/shift");
    let twins = vec![
        twin(
            blackbody,
            "blackbody_lookup",
            "out4(blackbody_lookup(0u, in1(0u)));",
            |i| {
                i.log(MIN_TEMPERATURE * 1.01, MAX_TEMPERATURE * 0.9);
            },
            |i, o| {
                let [r, g, b, ln] = BlackbodyTable::shared().blackbody_lookup(i.x(0));
                o.all([r, g, b], 1.0);
                // The difference of the table's and of Wien's exponent.
                o.near(ln, 1.0 + 22135.0 / i.x(0));
            },
            // The nodes are rounded, too, whose ln(Y / T) is about -20.
            6e-6,
        ),
        twin(
            blackbody,
            "shifted_blackbody shifted_light",
            "out3(shifted_blackbody(in1(1u), in1(2u), in1(3u), in1(4u)));",
            |i| {
                i.pick(1);
                let temperature = i.log(150.0, 1e9);
                i.push(BlackbodyTable::shared().ln_luminance(temperature.max(500.0)));
                i.log(0.2, 4.0);
                i.log(0.2, 4.0);
            },
            shifted,
            2e-5,
        ),
        twin(
            blackbody,
            "into_gamut",
            "out3(into_gamut(in3(0u)));",
            |i| i.evens(3, -0.5, 3.0),
            |i, o| o.v3(DVec3::from_array(into_gamut(i.v3(0).to_array()))),
            ROUNDING,
        ),
        twin(
            shift,
            "nu_static_observer",
            "enter_scene(); out1(nu_static_observer(in1(1u), in1(2u)));",
            |i| {
                [Kind::Spinning, Kind::Static, Kind::Rain][i.random.below(3) as usize].push(i);
                i.even(0.05, 2.0);
                i.even(-2.0, 2.0);
            },
            |i, o| {
                let frame = view(i).lens.observer.frame;
                // The static observer there measures E over its lapse.
                let here = LocalFrame::new(frame.a, frame.e_r * frame.r).expect("a place");
                o.put(if frame.rain && !here.rain { i.x(1) / here.lapse } else { 1.0 });
            },
            // Beside the horizon the lapse knows less of r than r does.
            2e-5,
        ),
        twin(
            shift,
            "zamo_frequency",
            "enter_scene(); out1(zamo_frequency(in1(1u), in1(2u), in1(3u), in1(4u)));",
            |i| {
                disk_place(i);
                i.even(-0.9, 0.9);
                i.even(0.1, 1.5);
                i.even(-6.0, 6.0);
            },
            |i, o| {
                let a = view(i).scene.hole.spin;
                let nu = |energy: f64, momentum: f64| zamo_frequency(a, i.x(1), i.x(2), energy, momentum);
                // E and omega L may cancel.
                o.near(nu(i.x(3), i.x(4)), nu(i.x(3), 0.0).abs() + nu(0.0, i.x(4)).abs());
            },
            // At spin 0.998 the ISCO lies where D is 0.01.
            1e-5,
        ),
        twin(
            disk,
            "disk_covers",
            "enter_scene(); out1(disk_covers(in1(1u)));",
            |i| {
                let view = Kind::Spinning.push(i);
                let [far, near] = view.scene.emitters().disk_u().expect("a disk");
                i.even(0.5 * far, 1.5 * near);
            },
            |i, o| {
                let [far, near] = view(i).scene.emitters().disk_u().expect("a disk").map(|u| f64::from(u as f32));
                o.put(f64::from(u8::from(i.x(1) >= far && i.x(1) <= near)));
            },
            SAME,
        ),
        twin(
            disk,
            "temperature_profile",
            "enter_scene(); out1(temperature_profile(in1(1u)));",
            disk_place,
            |i, o| o.near(profiles()[i.word(0) as usize].at(1.0 / i.x(1)), 1.0),
            // The profile rises like the root of the distance from the ISCO, which the uniform has rounded.
            1e-4,
        ),
        twin(
            disk,
            "disk_profile",
            "enter_scene(); out1(disk_profile(in1(1u)));",
            disk_place,
            |i, o| {
                let thin = view(i).scene.emitters().disk.expect("a disk");
                o.near(thin.profile(&profiles()[i.word(0) as usize], i.x(1)), 1.0);
            },
            // The bound is that of temperature_profile.
            1e-4,
        ),
        twin(
            disk,
            "emission_law",
            "enter_scene(); out1(emission_law(in1(1u)));",
            |i| {
                disk_place(i);
                i.truncate(1);
                i.even(-0.1, 1.1);
            },
            // The finer table cuts the corners of the coarse one off.
            |i, o| o.near(emission_law(view(i).scene.disk.expect("a disk").emission_law, i.x(1)), 1.0),
            1e-5,
        ),
        twin(
            disk,
            "left_by_edges",
            "enter_scene(); out1(left_by_edges(in1(1u), in1(2u)));",
            |i| {
                disk_place(i);
                i.even(0.0, 1.0);
            },
            |i, o| {
                let thin = view(i).scene.emitters().disk.expect("a disk");
                // Where it fades out 1/r is subtracted from something as large.
                o.near(thin.edges.left(i.x(1), i.x(2)), 1.0 + thin.edges.outer[0] * thin.edges.outer[1]);
            },
            ROUNDING,
        ),
        twin(
            disk,
            "disk_light",
            "enter_scene(); out3(disk_light(in1(1u), Shift(in1(2u), in1(3u))));",
            |i| {
                [Kind::Spinning, Kind::Static, Kind::Rain][i.random.below(3) as usize].push(i);
                i.even(0.05, 1.0);
                i.log(0.3, 2.0);
                i.log(0.3, 2.0);
            },
            |i, o| {
                let disk = view(i).scene.disk.expect("a disk");
                let temperature = view(i).scene.emitters().disk.expect("a disk").hottest * i.x(1);
                let table = BlackbodyTable::shared();
                let reference = table.ln_luminance(disk.temperature);
                let light =
                    table.shifted_blackbody(temperature, reference, i.x(2), i.x(3)).map(|v| v * disk.brightness);
                let gain = i.x(3).powi(4) / i.x(2).powi(4) * disk.brightness;
                o.all(light, gain * 1e-3);
            },
            // The errors of the profile and of its light add up.
            2e-4,
        ),
        twin(
            turbulent,
            "turbulent_brightness",
            "enter_scene(); out1(turbulent_brightness(in_place(1u), in_place(4u), in_place(7u)));",
            push_place,
            |i, o| {
                let streaks = Streaks::shared().expect("streaks");
                let seen = turbulence(view(i)).brightness(streaks, place(i, 1), [place(i, 4), place(i, 7)]);
                o.near(seen, seen.max(1.0));
            },
            // Samplers weigh texels in steps of 1/256; a step of an 8-bit pixel is as large.
            4e-3,
        ),
        twin(
            turbulent,
            "part_of_side",
            "out1(part_of_side(in2(0u), in2(2u)));",
            |i| {
                // Some are unknown, and some change nothing.
                let kind = i.random.below(8);
                for _ in 0..4 {
                    match kind {
                        0 => i.push(1e33),
                        1 if i.random.below(2) == 0 => i.push(0.0),
                        _ => i.signed(1e-1, 1e4),
                    };
                }
            },
            |i, o| {
                let two = |k: usize| [i.x(k), i.x(k + 1)];
                o.near(part_of_side(two(0), two(2)), 1.0);
            },
            ROUNDING,
        ),
        twin(
            "emit/streaks",
            "streak_exponents",
            "out3(streak_exponents(in3(0u), in2(3u), in1(5u), in2(6u), in2(8u)));",
            |i| {
                i.evens(3, 0.0, 1.0);
                i.evens(2, -3.0, 3.0);
                // One in eight is unknown, as UNKNOWN_EMISSION_POINT makes it.
                let unknown = i.random.below(8) == 0;
                let parted = !unknown && i.random.below(2) == 0;
                i.even(0.0, if parted { 1.0 / 3.0 } else { 0.0 });
                for _ in 0..4 {
                    if unknown {
                        i.push(1e33);
                    } else {
                        i.signed(1e-3, 300.0);
                    }
                }
            },
            |i, o| {
                let two = |k: usize| [i.x(k), i.x(k + 1)];
                let patches = Streaks::shared().expect("streaks").patches(two(3), i.x(5), two(6), two(8));
                patches.iter().zip(0..).for_each(|(patch, k)| o.near(patch.exponent(i.x(k)), 1.0));
            },
            4e-3,
        ),
        twin(
            blackbody,
            "blackbody_luminances",
            "out4(blackbody_luminances(in4(0u), in1(4u)));",
            |i| {
                (0..4).for_each(|_| {
                    i.even(500.0_f64.ln(), 1e7_f64.ln());
                });
                i.even(2.0, 18.0);
            },
            |i, o| (0..4).for_each(|k| o.put(fitted_luminance(i.x(k), i.x(4)))),
            // Exponentials of numbers of some tens.
            3e-5,
        ),
        twin(
            blackbody,
            "blackbody_colour",
            "out3(blackbody_colour(in1(0u)));",
            |i| {
                i.even(500.0_f64.ln(), 1e7_f64.ln());
            },
            |i, o| o.all(fitted_colour(i.x(0)), 1.0),
            // Terms of some hundreds cancel each other.
            1e-4,
        ),
    ];
    let imports = "#import shared/blackbody\n#import emit/disk\n#import emit/turbulence\n#import emit/volumes\n\
                   fn on_part(c: Constants, observer: State, from_state: State, to_state: State, h: f32, begin: f32,
                   end: f32) {}\n\
                   fn on_crossing(c: Constants, crossing: PlaneCrossing) {}\n\
                   var<private> clouds: Clouds;\n\
                   fn baked_factor(index: u32, place: vec3<f32>, level: f32) -> f32 { return 1.0; }\n";
    Group {
        name: "light",
        head: [imports, FRAME, FRAMES, HOOKS].concat(),
        twins,
        images: || vec![streaks_image()],
        tables,
    }
}
