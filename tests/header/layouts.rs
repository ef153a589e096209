// SPDX-License-Identifier: MIT OR Apache-2.0
//! The layouts of include/bhr.json hold in C11, in C++17, where include/bhr.hpp has structs of its own, and in Rust;
//! and bhr.hpp and bhr/interop.hpp leave out nothing that the headers have.

use crate::c_header::{HEADER, INTEROP, compiler, constants, functions, root, run, scratch};
use crate::json::{committed, entries, text};
use bhr::capi;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::mem::{align_of, offset_of, size_of};
use std::path::Path;

/// Structs of bhr.h that bhr.hpp has no type of its own for.
const C_ONLY: [&str; 1] = ["BhrCrossing"];

/// A file of assertions, each `assertion(condition, "")`: those of `name_of(struct)` for every struct that has a name.
fn assertions(include: &str, assertion: &str, align: &str, name_of: impl Fn(&str) -> Option<String>) -> String {
    let json = committed();
    let mut program = format!("#include <stddef.h>\n#include \"{include}\"\n");
    for object in entries(&json, "structs") {
        let Some(name) = name_of(text(&object["name"])) else { continue };
        writeln!(program, "{assertion}(sizeof({name}) == {}, \"size\");", object["size"]).unwrap();
        writeln!(program, "{assertion}({align}({name}) == {}, \"alignment\");", object["alignment"]).unwrap();
        for field in object["fields"].as_array().unwrap() {
            let (member, size) = (text(&field["name"]), &field["size"]);
            writeln!(program, "{assertion}(offsetof({name}, {member}) == {}, \"{member}\");", field["offset"]).unwrap();
            writeln!(program, "{assertion}(sizeof((({name} *)0)->{member}) == {size}, \"{member}\");").unwrap();
        }
    }
    program
}

/// Compiles the assertions, and then finds out that a wrong one does not compile.
fn hold(cpp: bool, name: &str, dialect: &str, program: &str) {
    let compile = |text: &str| {
        let source = scratch("layouts").join(name);
        std::fs::write(&source, text).unwrap();
        let mut command = compiler(cpp);
        command.args([dialect, "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fsyntax-only", "-I"]);
        command.arg(root().join("include")).arg(source);
        command
    };
    run(&mut compile(program));
    let wrong = program.replacen("== 8,", "== 9,", 1);
    assert!(wrong != program && !compile(&wrong).output().unwrap().status.success());
}

#[test]
fn layouts_hold_in_c11() {
    hold(false, "c11.c", "-std=c11", &assertions("bhr.h", "_Static_assert", "_Alignof", |name| Some(name.to_owned())));
}

#[test]
#[ignore = "in tests/run all; everyday: layouts in C11, and the C++ programs of tests/cpp"]
fn layouts_hold_in_cpp17() {
    let program = assertions("bhr.hpp", "static_assert", "alignof", |name| {
        let own = name.strip_prefix("Bhr").filter(|_| !C_ONLY.contains(&name));
        own.map(|name| format!("bhr::{name}"))
    });
    hold(true, "own.cpp", "-std=c++17", &program);
    let program = assertions("bhr.h", "static_assert", "alignof", |name| Some(name.to_owned()));
    hold(true, "plain.cpp", "-std=c++17", &program);
}

/// The words of a C++ header. A comment is no use of one.
fn words_of(path: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(path).unwrap();
    let code = text.lines().map(|line| line.split("//").next().unwrap()).collect::<Vec<_>>().join("\n");
    code.split(|c: char| !c.is_alphanumeric() && c != '_').map(str::to_owned).collect()
}

/// The functions that C++ calls by BHR_INIT, by the type of what they fill in.
fn is_behind_init(function: &str) -> bool {
    function.ends_with("_init")
}

#[test]
fn bhr_hpp_names_every_function_and_constant() {
    /// Values that C++ has no use for: they are in other functions, or BHR_MAX_CROSSINGS is the size of an array.
    const OTHERWISE: [&str; 3] = ["BHR_VERSION_MAJOR", "BHR_VERSION_MINOR", "BHR_VERSION_PATCH"];
    let parts = std::fs::read_dir(root().join("include/bhr")).unwrap().map(|part| part.unwrap().path());
    let named = parts.filter(|part| !part.ends_with("interop.hpp")).flat_map(|part| words_of(&part));
    let named: BTreeSet<_> = named.collect();
    assert!(named.contains("BHR_INIT"), "structs that are asked for are filled in by it");
    let wanted = functions(HEADER).into_iter().chain(constants(HEADER)).filter(|name| !is_behind_init(name));
    let missing: Vec<_> = wanted.filter(|name| !named.contains(name) && !OTHERWISE.contains(&name.as_str())).collect();
    assert!(missing.is_empty(), "include/bhr/ has no {missing:?}");
}

#[test]
fn interop_hpp_names_every_function_and_constant() {
    let named: BTreeSet<_> = words_of(&root().join("include/bhr/interop.hpp")).into_iter().collect();
    let constants = constants(INTEROP).into_iter().filter(|name| name != "BHR_INTEROP_H");
    let wanted = functions(INTEROP).into_iter().chain(constants).filter(|name| !is_behind_init(name));
    let wanted: Vec<_> = wanted.collect();
    assert!(wanted.len() > 30, "{wanted:?}");
    let missing: Vec<_> = wanted.iter().filter(|name| !named.contains(*name)).collect();
    assert!(missing.is_empty(), "include/bhr/interop.hpp has no {missing:?}");
}

/// Size, alignment and the fields' places of structs of the library, by the struct's name.
macro_rules! layouts {
    ($($module:ident::$name:ident { $($field:ident),* })*) => {
        BTreeMap::from([$((stringify!($name), (
            size_of::<capi::$module::$name>(),
            align_of::<capi::$module::$name>(),
            vec![$((stringify!($field), offset_of!(capi::$module::$name, $field))),*],
        ))),*])
    };
}

#[test]
fn layouts_hold_in_rust() {
    let ours = layouts! {
        adapter::BhrAdapterInfo { struct_size, backend, flags, vendor_id, device_id, reserved, name, driver }
        window::BhrWindow { struct_size, kind, display, handle, aux, id, visual_id, screen, reserved }
        context::BhrContextOptions {
            struct_size, flags, backend, adapter_index, cpu_threads, log_level, log_fn, log_user, compatible_window
        }
        hole::BhrHoleInfo {
            struct_size, reserved, horizon_radius, ergosphere_equatorial_radius, photon_orbit_prograde,
            photon_orbit_retrograde, isco_prograde, isco_retrograde, critical_impact_parameter, shadow_angular_radius,
            camera_radius, camera_time_rate, inner_horizon_radius
        }
        camera::BhrCamera {
            struct_size, projection, position, forward, up, fov_y, motion, reserved, velocity, tan_left, tan_right,
            tan_down, tan_up, jitter, eye_distance, eye, reserved2, chart, transport
        }
        disk::BhrDisk {
            struct_size, flags, inner_radius, outer_radius, temperature, opacity, brightness, turbulence, seed,
            reference, emission_law, edge_softness
        }
        volume::BhrVolume {
            struct_size, flags, shape, flow, inner_radius, outer_radius, radius, width, thickness, opening, slope,
            absorption, temperature, temperature_slope, spectral_index, tint, brightness, sub_keplerian, infall,
            angular_momentum, speed, turbulence, clumping, heating, seed
        }
        volume::BhrHotSpot {
            struct_size, flags, radius, size, azimuth, absorption, temperature, spectral_index, tint, brightness,
            position, velocity, time
        }
        body::BhrBody { struct_size, chart, position, velocity, time, proper_time, end, reserved }
        transfer::BhrTransfer { fate, reserved, intensity, optical_depth, light }
        image::BhrImage { struct_size, format, width, height, pixels, row_stride, byte_size, flags, reserved,
            colour_space, reserved2 }
        sky::BhrSky { struct_size, flags, stars_brightness, map_brightness, orientation, seed }
        film::BhrFilm { struct_size, tone_map, exposure_ev, bloom, beam_fwhm, colour_map, spike_blades, white_balance,
            tint, contrast, saturation, toe_strength, toe_length, shoulder_strength, shoulder_length, shoulder_angle,
            vignette, auto_exposure, auto_percentile, auto_target, auto_least_ev, auto_most_ev, auto_adaptation,
            highlights, shadows, grain, grain_seed, lut_strength, spikes, spike_angle, spike_length, streak,
            streak_length, streak_tint, paper_white, peak, flare, flare_ghosts, reserved }
        preset::BhrPresetOptions { struct_size, matter, width, height, frame_ms, measure_anew, may_halve }
        quality::BhrQuality {
            struct_size, method, samples_per_pixel, max_steps, step, tolerance, max_disk_order, reserved, render_scale,
            volume_resolution, reserved2
        }
        output::BhrOutput { struct_size, kind, index, reserved, image, target }
        region::BhrRegion { struct_size, full_width, full_height, x, y, reserved }
        project::BhrProjectedPoint {
            struct_size, found, on_screen, lost, x, y, ray, magnification, delay, redshift, distance, apparent
        }
        rays::BhrRay { position, direction, frequency_ratio }
        rays::BhrCrossing { radius, azimuth, redshift, delay }
        rays::BhrHit {
            fate, crossing_count, sky_direction, sky_redshift, swept_angle, steps, reserved, crossings
        }
        stats::BhrFrameStats {
            struct_size, reserved, frame_index, rays, steps, cpu_ns, gpu_ns, readback_ns, device_bytes,
            lens_tables, auto_ev
        }
    };
    let json = committed();
    let number = |value: &serde_json::Value| usize::try_from(value.as_u64().unwrap()).unwrap();
    let mut left: BTreeSet<&str> = ours.keys().copied().collect();
    for object in entries(&json, "structs") {
        let name = text(&object["name"]);
        let (size, alignment, fields) = ours.get(name).unwrap_or_else(|| panic!("this test does not know {name}"));
        assert_eq!((number(&object["size"]), number(&object["alignment"])), (*size, *alignment), "{name}");
        let places = object["fields"].as_array().unwrap().iter();
        let places: Vec<_> = places.map(|field| (text(&field["name"]), number(&field["offset"]))).collect();
        assert_eq!(places, *fields, "{name}: left: bhr.json, right: Rust");
        left.remove(name);
    }
    assert!(left.is_empty(), "bhr.json has no {left:?}");
}
