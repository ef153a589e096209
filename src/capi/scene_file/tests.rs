// SPDX-License-Identifier: MIT OR Apache-2.0
//! Scenes as text: every field comes back bit by bit, mistakes are told where they stand, and nothing panics.

use super::values::{Section, Values};
use super::{Moment, SceneFile};
use crate::capi::fields::{Field, Kind, Value};
use crate::capi::state::Files;
use crate::error::ErrorKind;
use crate::random::runs_all;
use crate::scene::{Camera, Motion, Preset, PresetMatter, Region, Scene};
use glam::DVec3;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;
use std::path::Path;

struct Random(Pcg32);

impl Random {
    fn new(seed: u64) -> Self {
        Self(Pcg32::seed_from_u64(seed))
    }

    /// From 0 to less than 1.
    fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }
}

fn parsed(text: &str) -> SceneFile {
    SceneFile::parse(text, Path::new("")).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn refused(text: &str) -> String {
    match SceneFile::parse(text, Path::new("")) {
        Ok(_) => panic!("not refused: {text}"),
        Err(error) => error.message,
    }
}

fn scene_at(file: &SceneFile, seconds: f64) -> Scene {
    file.at(seconds, &Scene::default()).unwrap_or_else(|error| panic!("{error}")).scene
}

fn scene_of(text: &str) -> Scene {
    scene_at(&parsed(text), 0.0)
}

/// A value that a field may be set to, whatever the other fields are.
fn random_value(section: Section, field: &Field, random: &mut Random) -> Value {
    let mut within = |low: f64, high: f64| low + (high - low) * random.unit();
    let numbers = |numbers: &[f64]| Value::Numbers(numbers.iter().copied().collect());
    match (section, field.name, field.kind) {
        (_, "time", _) => numbers(&[within(-1e9, 1e9)]),
        (_, "mass", _) => numbers(&[within(1e-3, 1e3)]),
        (_, "spin", _) => numbers(&[within(-1.0, 1.0)]),
        // Outside the horizon of whatever mass, and slower than light, where the spot falls freely.
        (Section::HotSpot(_), "position", _) => numbers(&[within(1e6, 2e6), within(1e6, 2e6), within(1e6, 2e6)]),
        (Section::HotSpot(_), "velocity", _) => numbers(&[within(-0.5, 0.5), within(-0.5, 0.5), within(-0.5, 0.5)]),
        (_, "position", _) => numbers(&[within(1.0, 50.0), within(1.0, 50.0), within(1.0, 50.0)]),
        (_, "axis" | "up", _) => numbers(&[within(-0.1, 0.1), within(-0.1, 0.1), within(0.2, 3.0)]),
        (_, "forward", _) => numbers(&[within(-2.0, -1.0), within(0.1, 3.0), within(-0.5, 0.5)]),
        (_, "velocity", _) => numbers(&[within(-0.5, 0.5), within(-0.5, 0.5), within(-0.5, 0.5)]),
        (_, "fov_y", _) => numbers(&[within(0.01, 3.0)]),
        (_, "tan_left" | "tan_down", _) => numbers(&[within(-9.0, -0.1)]),
        (_, "tan_right" | "tan_up", _) => numbers(&[within(0.1, 9.0)]),
        (_, "jitter", _) => numbers(&[within(-1.0, 1.0), within(-1.0, 1.0)]),
        (_, "orientation", _) => {
            let turn = glam::DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), within(0.0, 6.0));
            numbers(&turn.to_array())
        }
        (_, "white_balance", _) => numbers(&[within(1667.0, 25_000.0)]),
        (_, "contrast", _) => numbers(&[within(0.25, 4.0)]),
        (Section::Film, "tint", _) => numbers(&[within(-1.0, 1.0)]),
        (_, "tint", _) => numbers(&[within(0.0, 1.0), within(0.0, 1.0), within(0.0, 1.0)]),
        (Section::HotSpot(_), "radius", _) => numbers(&[within(8.0, 12.0)]),
        (Section::HotSpot(_), "size", _) => numbers(&[within(0.5, 1.5)]),
        (_, "inner_radius", _) => numbers(&[within(1.0, 5.0)]),
        (_, "outer_radius", _) => numbers(&[within(6.0, 100.0)]),
        (_, "radius" | "width", _) => numbers(&[within(1.0, 9.0)]),
        (_, "temperature", _) => numbers(&[within(500.0, 1e9)]),
        (_, "exposure_ev", _) => numbers(&[within(-20.0, 20.0)]),
        (_, "step" | "opening" | "heating", _) => numbers(&[within(0.01, 0.5)]),
        (_, "tolerance", _) => numbers(&[within(1e-14, 1e-3)]),
        (_, "clumping", _) => numbers(&[within(0.5, 3.0)]),
        (_, "samples_per_pixel", _) => Value::Count(within(1.0, 256.0) as u32),
        (_, "max_steps", _) => Value::Count(within(16.0, 100_000.0) as u32),
        (Section::Film, "paper_white" | "peak", _) => numbers(&[within(100.0, 1000.0)]),
        (_, "flare_ghosts", _) => Value::Count(within(1.0, 8.99) as u32),
        (_, "spike_blades", _) => Value::Count(within(3.0, 8.99) as u32),
        (_, "max_disk_order", _) => Value::Count(within(0.0, 15.0) as u32),
        (_, "full_width" | "full_height", _) => Value::Count(within(1000.0, 2000.0) as u32),
        (_, "x" | "y", _) => Value::Count(within(0.0, 999.0) as u32),
        (_, _, Kind::Word(words)) => Value::Word(words[within(0.0, words.len() as f64 - 1e-9) as usize].1),
        // Bits without a word, too, where they are allowed.
        (Section::Moment, _, Kind::Bits(_)) => Value::Bits(within(0.0, 4_294_967_295.0) as u32),
        (_, _, Kind::Bits(words)) => {
            let some = within(0.0, 31.0) as u32;
            Value::Bits(words.iter().map(|(_, bit)| bit & some).fold(0, |all, bit| all | bit))
        }
        (_, _, Kind::Seed) => Value::Seed((within(0.0, 1.0) * u64::MAX as f64) as u64),
        (_, _, Kind::Numbers(count)) => numbers(&vec![within(0.1, 0.99); count]),
        (_, _, Kind::Angle) => numbers(&[within(0.02, 1.5)]),
        (_, _, Kind::Count) => panic!("{section:?} {}", field.name),
    }
}

fn random_values(random: &mut Random) -> Values {
    let mut scene = Scene::default();
    scene.volumes.push(crate::scene::Volume::default());
    scene.volumes.push(crate::scene::Volume::default());
    scene.hot_spots.push(crate::scene::HotSpot::default());
    let mut values = Values::of(&scene, Some(Region { full_width: 9, full_height: 9, x: 0, y: 0 }));
    for section in values.sections() {
        for field in section.fields() {
            let value = random_value(section, field, random);
            field.set(values.bytes_mut(section).unwrap(), &value);
        }
    }
    values.of_preset = [None, Some(0), Some(1)][(random.unit() * 3.0) as usize % 3];
    values.glare_is_optional = random.unit() < 0.5;
    values.grain_moves = random.unit() < 0.5;
    values
}

fn same(a: &Values, b: &Values) {
    assert_eq!(a.sections(), b.sections());
    for section in a.sections() {
        for field in section.fields() {
            let [a, b] = [a, b].map(|values| field.get(values.bytes(section).unwrap()));
            assert_eq!(a, b, "{section:?} {}", field.name);
        }
    }
    assert_eq!((a.of_preset, a.glare_is_optional), (b.of_preset, b.glare_is_optional));
}

#[test]
fn every_field_comes_back_bit_by_bit() {
    let mut random = Random::new(36);
    for _ in 0..500 {
        let given = random_values(&mut random);
        let (scene, region) = given.set_in(&Scene::default(), 0.0).unwrap_or_else(|(_, error)| panic!("{error}"));
        let text = SceneFile::of(&scene, region, &Files::default()).unwrap().text(None).unwrap();
        let read = parsed(&text);
        same(&Values::of(&scene, region), &read.values);
        // Through the scene as well: the second text is the first one.
        let Moment { scene, region } = read.at(0.0, &Scene::default()).unwrap();
        assert_eq!(SceneFile::of(&scene, region, &Files::default()).unwrap().text(None).unwrap(), text);
    }
}

#[test]
fn text_that_says_nothing_is_a_new_contexts_scene() {
    let new = Values::of(&Scene::default(), None);
    for text in ["", "version = 1\n", "[hole]\n[camera]\n[disk]\n[sky]\n[film]\n[quality]\n", "\u{feff}# nothing"] {
        same(&new, &Values::of(&scene_of(text), None));
    }
}

#[test]
fn a_preset_is_a_base() {
    for (word, preset) in [
        ("cinematic", Preset::Cinematic),
        ("PHYSICAL", Preset::Physical),
        ("observatory", Preset::Observatory),
        ("teaching", Preset::Teaching),
    ] {
        let matters = [("", None), ("deep", Some(PresetMatter::Deep)), ("thin", Some(PresetMatter::Thin))];
        for (matter_word, matter) in matters {
            let mut scene = Scene::default();
            match matter {
                None => preset.apply(&mut scene),
                Some(matter) => drop(preset.apply_with(matter, &mut scene)),
            }
            let matter = if matter.is_some() { format!("preset_matter = \"{matter_word}\"\n") } else { String::new() };
            let read = scene_of(&format!("{matter}preset = \"{word}\""));
            same(&Values::of(&scene, None), &Values::of(&read, None));
            assert_eq!(read.film, scene.film);
        }
    }
    let changed = scene_of("preset = 'physical'\n[disk]\nbrightness = 3\n[film]\nexposure_ev = 1");
    assert_eq!((changed.disk.unwrap().brightness, changed.film.exposure_ev), (3.0, 1.0));
    assert!(scene_of("[film]\nexposure_ev = 1").film.glare_is_optional);
    assert!(!scene_of("[film]\nbloom = 0.1").film.glare_is_optional);
    assert!(scene_of("preset = 'cinematic'\npreset_matter = 'deep'\nvolumes = []").volumes.is_empty());
}

#[test]
fn mistakes_are_told_where_they_stand() {
    for (text, words) in [
        ("[hole]\nspin = 1.5", "line 2, column 8: [hole]: spin is 1.5; it must lie in [-1, 1]"),
        ("[hole]\nspinn = 0.5", "line 2, column 1: [hole] has no \"spinn\"; it has mass, spin, axis"),
        ("[hole]\nspin = 'fast'", "line 2, column 8: spin is text; it must be a number"),
        ("[hole]\naxis = [0, 1]", "line 2, column 8: axis has 2 numbers; it must be a list of 3 numbers"),
        ("[hole]\naxis = [0, 1, 'z']", "line 2, column 15: axis is text"),
        ("holes = 1", "line 1, column 1: the scene has no \"holes\""),
        ("[hole]\nspin = nan", "line 2, column 8: [hole]: spin is NaN; it must lie in"),
        ("[hole]\nspin = 1e999", "line 2, column 8: spin is no number of 64 bits"),
        ("a = [[[[[[[[[[[[[[[[[[[[1]]]]]]]]]]]]]]]]]]]]", "line 1, column 21: nested too deeply"),
        ("a.a.a.a.a.a.a.a.a.a = 1", "line 1, column 18: nested too deeply"),
        ("time = { keys = [[-1e308, 0], [1e308, 1]] }", "a key's time is -1e308; it must lie within +-1e9 s"),
        ("[disk]\ninner_radius = 9\nouter_radius = 5", "line 3, column 16: [disk]: disk outer_radius is 5"),
        ("[disk]\nflags = ['retrograd']", "line 2, column 10: flags is \"retrograd\"; known are \"retrograde\""),
        ("[disk]\nseed = -1", "line 2, column 8: seed is -1; it must lie in [0, 18446744073709551615]"),
        (
            "[[volumes]]\n[[volumes]]\nshape = 'cube'",
            "line 3, column 9: shape is \"cube\"; known are \"disk\", \"torus\"",
        ),
        ("[[volumes]]\n[[volumes]]\nslope = 7", "line 3, column 9: [[volumes]] 2: volume slope is 7"),
        ("volumes = [{}, {}, {}, {}, {}]", "line 1, column 11: volumes are 5; there may be 4"),
        ("version = 2", "line 1, column 11: version is 2; this library reads 1"),
        ("preset_matter = 'deep'", "line 1, column 17: preset_matter is there, and no preset"),
        (
            "preset = 'teaching'\npreset_matter = 'auto'",
            "line 2, column 17: preset_matter is \"auto\"; known are \"thin\"",
        ),
        ("[hole\n", "line 1, column 6"),
        ("[hole]\nspin = 0.5\nspin = 0.6", "line 3, column 1: duplicate key"),
        ("a = 1979-05-27", "line 1, column 1: the scene has no \"a\""),
        ("# \u{e4}\u{f6}\n'\u{e4}' = 1", "line 2, column 1"),
        ("[camera]\norbit = { distance = 9 }\nup = [0, 0, 1]", "line 2, column 9: a camera has an orbit, or up"),
        ("[camera]\norbit = {}", "line 2, column 9: an orbit has no distance"),
        ("[camera]\nlook_at = [1, 2, 3]\nforward = [1, 0, 0]", "line 2, column 11: a camera has look_at, or forward"),
        ("[camera]\nturn = { left = 1 }", "line 2, column 10: [camera.turn] has no \"left\"; it has right, up, roll"),
        ("[camera]\nturn = { up = 'nan deg' }", "line 2, column 15: up is \"nan deg\""),
        ("[camera]\nturn = { up = inf }", "camera turn up is"),
        ("[camera]\nfov_y = '45'", "line 2, column 9: fov_y is \"45\"; it must be a number of radians, or degrees"),
        ("[camera]\nfov_y = 4", "line 2, column 9: [camera]: camera fov_y is 4"),
        ("[camera]\nposition = [1, 0, 0]\nmotion = 'free_fall'\nproper_time = 9", "[camera]: the fall from"),
        ("[camera.fov_y]\nkeys = [[0, 1], [1, 4]]", "[camera] at 1 s: camera fov_y is 4"),
        ("time = { keys = [[1, 0], [0, 0]] }", "line 1, column 27: a key's time is 0; the key before has 1"),
        ("time = { keys = [[1, 0], [1, 1], [1, 2]] }", "three keys have the time 1"),
        ("time = { keys = [] }", "time has an empty list of keys"),
        ("time = { keys = [[1]] }", "a key has 1 parts"),
        ("time = { values = 1 }", "time has no \"values\""),
        ("view = { keys = [[0, 'light', 'ease']] }", "its curve must be \"hold\""),
        ("[render]\nwidth = 0", "line 2, column 9: [render]: render width is 0; it must lie in [1, 1048576]"),
        ("[render]\nduration = { keys = [[0, 1]] }", "line 2, column 12: duration is a table"),
        ("[[cuts]]\nat = 1", "line 1, column 1: a cut has at, a time in seconds, and a camera"),
        (
            "cuts = [{ at = 2, camera = {} }, { at = 2, camera = {} }]",
            "at is 2; it must be later than the cut before, 2",
        ),
        ("[film]\nlut = 3", "line 2, column 7: lut is an integer; it must be a path"),
        ("[film]\nlut = ''", "line 2, column 7: lut is no path"),
        ("[sky]\nmap = 3", "line 2, column 7: map is an integer; it must be a path"),
        ("[sky]\norientation = [0, 0, 0, 2]", "line 2, column 15: [sky]: sky orientation has length 2"),
    ] {
        let told = refused(text);
        assert!(told.contains(words), "{told}\n{words}\n{text}");
    }
    let error = SceneFile::parse("[camera]\ntransport = 'parallel'\nproper_time = 1", Path::new("")).err().unwrap();
    assert_eq!(error.kind, ErrorKind::Unsupported, "{error}");
}

#[test]
fn cameras_are_put_where_the_text_says() {
    let camera = |text: &str, seconds: f64| scene_at(&parsed(text), seconds).camera;
    let looking = camera("[camera]\nposition = [0, 10, 0]", 0.0);
    assert_eq!(looking.forward, DVec3::new(0.0, -10.0, 0.0));
    let turning = "[camera]\norbit = { distance = 20, azimuth = { keys = [[0, 0], [2, '90 deg']] }, elevation = 0.1 }";
    let quarter = camera(turning, 2.0);
    let expected = 20.0 * DVec3::new(0.0, 0.1f64.cos(), 0.1f64.sin());
    assert!(quarter.position.abs_diff_eq(expected, 1e-12), "{}", quarter.position);
    // A fall by its own clock, and the scene's time with it.
    let falling = parsed(
        "time = 5\n[camera]\nposition = [0, 10, 1]\nmotion = 'free_fall'\nproper_time = { keys = [[0, 0], [1, 4]] }",
    );
    let start = Camera { position: DVec3::new(0.0, 10.0, 1.0), motion: Motion::FreeFall, ..Camera::default() };
    let (fallen, passed) = Scene::default().advance_camera(&start, 4.0).unwrap();
    let scene = scene_at(&falling, 1.0);
    assert_eq!((scene.camera.position, scene.time), (fallen.position, 5.0 + passed));
    assert!(scene.camera.forward.abs_diff_eq(-fallen.position, 1e-12));
    // The look is turned from the hole: to its right, up to the zenith, and about itself.
    let turned = |turn: &str| {
        let camera = camera(&format!("[camera]\norbit = {{ distance = 20 }}\nturn = {{ {turn} }}"), 1.0);
        assert!((camera.forward.length() - 1.0).abs() < 1e-15 && camera.forward.dot(camera.up).abs() < 1e-15);
        [camera.forward, camera.up]
    };
    let close = |found: [DVec3; 2], expected: [DVec3; 2]| {
        assert!(found[0].abs_diff_eq(expected[0], 1e-15) && found[1].abs_diff_eq(expected[1], 1e-15), "{found:?}");
    };
    close(turned("right = '90 deg'"), [DVec3::Y, DVec3::Z]);
    close(turned("up = '90 deg'"), [DVec3::Z, DVec3::X]);
    close(turned("roll = '90 deg'"), [DVec3::NEG_X, DVec3::Y]);
    close(turned("right = '90 deg', up = { keys = [[0, 0], [2, '180 deg']] }"), [DVec3::Z, DVec3::NEG_Y]);
    let cut = "[camera]\nfov_y = 1\n[[cuts]]\nat = 2\ncamera = { fov_y = { keys = [[0, 0.2], [4, 0.6]] } }";
    assert_eq!([0.0, 1.9, 2.0, 4.0].map(|seconds| camera(cut, seconds).fov_y), [1.0, 1.0, 0.4, 0.6]);
}

#[test]
fn what_moves_is_saved_as_it_was_loaded() {
    let text = "time = { keys = [[0, 0], [10, 300]] }\n[hole]\nspin = { keys = [[0, 0.1], [1, 0.5, 'hold'], [2, 0.9]], \
                curve = 'ease' }\n[camera]\nproper_time = { keys = [[0, 0], [9, 5]] }\nmotion = 'orbit'\norbit = { \
                distance = 8, azimuth = '30 deg' }\nturn = { right = 1, roll = { keys = [[0, 0], [9, 1]] } }\n\
                [[cuts]]\nat = 3\ncamera = { position = [3, 4, 5], look_at = { keys = [[3, [0, 0, 0]], [4, [1, 1, \
                1]]] } }\n[[volumes]]\nflags = { keys = [[0, []], [1, ['retrograde']]] }\n\
                [render]\nwidth = 300";
    let file = parsed(text);
    let first = file.text(None).unwrap();
    let mut scene = Scene::default();
    for seconds in [0.0, 0.5, 3.5, 11.0] {
        let there = scene_at(&file, seconds);
        same(&Values::of(&there, None), &Values::of(&scene_at(&parsed(&first), seconds), None));
        // From any other moment to this one.
        scene = file.moved(seconds, &scene_at(&file, 1.7), None).unwrap().scene;
        same(&Values::of(&there, None), &Values::of(&scene, None));
    }
    // At any moment the same text; what a setter has changed is in it.
    assert_eq!(file.updated(&scene_at(&file, 0.0), None, &Files::default()).unwrap().text(None).unwrap(), first);
    scene.film.exposure_ev = 1.25;
    scene.hole.spin = 0.77;
    let changed = file.updated(&scene, None, &Files::default()).unwrap().text(None).unwrap();
    assert!(changed.contains("exposure_ev = 1.25\n") && !changed.contains("0.77"), "{changed}");
    let moved = file.moved(0.0, &scene, None).unwrap().scene;
    assert_eq!((moved.film.exposure_ev, moved.hole.spin), (1.25, 0.1));
    // A volume that moves may be gone.
    scene.volumes.clear();
    let error = file.moved(0.0, &scene, None).err().unwrap();
    assert_eq!(error.kind, ErrorKind::InvalidState, "{error}");
    assert!(error.message.contains("[[volumes]] 1"), "{error}");
    assert_eq!(file.render().unwrap().width, 300);
}

/// The grain of a film is another one in each frame, unless the text has a seed or says that it stays.
#[test]
fn grain_moves_with_the_film() {
    let seeds = |text: &str| [0.0, 0.04, 7.0].map(|seconds| scene_at(&parsed(text), seconds).film.grade.grain_seed);
    assert_eq!(seeds("[film]\ngrain = 0.2"), [0.0, 0.04, 7.0]);
    assert_eq!(seeds("[film]\ngrain = { keys = [[0, 0], [5, 1]] }"), [0.0, 0.04, 7.0]);
    assert_eq!(seeds("[film]\ngrain = 0.2\ngrain_seed = 3"), [3.0; 3]);
    assert_eq!(seeds("[film]\ngrain = 0.2\ngrain_moves = false"), [0.0; 3]);
    assert_eq!(seeds("[film]\ngrain = 0.2\ngrain_seed = 3\ngrain_moves = true"), [0.0, 0.04, 7.0]);
    assert_eq!(seeds("[film]\nbloom = 0.1"), [0.0; 3]);
    assert_eq!(seeds("[film]\ngrain = 0"), [0.0; 3]);
    let file = parsed("[film]\ngrain = 0.2");
    assert!(file.moves() && !parsed("[film]\nbloom = 0.1").moves());
    let later = file.moved(7.0, &scene_at(&file, 1.0), None).unwrap().scene;
    assert_eq!(later.film.grade.grain_seed, 7.0);
    let text = file.updated(&later, None, &Files::default()).unwrap().text(None).unwrap();
    assert_eq!(text, file.text(None).unwrap());
    assert_eq!(seeds(&text), [0.0, 0.04, 7.0], "{text}");
}

/// A camera that does not move is a host's as soon as it sets another, and so is the rest of one whose field of view
/// moves.
#[test]
fn cameras_that_do_not_move_are_left_alone() {
    let still = parsed("time = 3\n[camera]\nposition = [0, 30, 3]\nmotion = 'orbit'\nproper_time = 2");
    assert!(!still.moves());
    let mut scene = scene_at(&still, 0.0);
    let placed = scene.camera.position;
    assert!(scene.time > 3.0 && placed != DVec3::new(0.0, 30.0, 3.0), "{placed}");
    let again = parsed(&still.updated(&scene, None, &Files::default()).unwrap().text(None).unwrap());
    same(&Values::of(&scene, None), &Values::of(&scene_at(&again, 7.0), None));
    scene.camera.position = DVec3::new(1.0, 2.0, 9.0);
    assert_eq!(still.moved(1.0, &scene, None).unwrap().scene.camera, scene.camera);
    let zoom = parsed("[camera]\nposition = [0, 30, 3]\nfov_y = { keys = [[0, 1], [1, 2]] }");
    let zoomed = zoom.moved(0.5, &scene, None).unwrap().scene.camera;
    assert_eq!((zoomed.position, zoomed.fov_y), (scene.camera.position, 1.5));
}

/// Numbers that a setter takes because nothing reads them come back as well.
#[test]
fn numbers_that_mean_nothing_come_back() {
    let mut scene = Scene::default();
    scene.camera.projection = crate::scene::Projection::Equirect;
    for fov_y in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        scene.camera.fov_y = fov_y;
        scene.camera.check().unwrap();
        let text = SceneFile::of(&scene, None, &Files::default()).unwrap().text(None).unwrap();
        assert_eq!(scene_of(&text).camera.fov_y.to_bits(), fov_y.to_bits(), "{text}");
    }
}

/// The samples of docs/scenes.md are scenes.
#[test]
fn samples_of_pages_are_scenes() {
    let page = |name: &str| {
        let page = Path::new(env!("CARGO_MANIFEST_DIR")).join(name);
        std::fs::read_to_string(page).unwrap()
    };
    let pages = page("docs/scenes.md") + &page("docs/domes.md");
    let samples = pages.split("```toml\n").skip(1).map(|rest| rest.split("```").next().unwrap()).collect::<Vec<_>>();
    assert!(samples.len() >= 5);
    for sample in samples {
        let file = parsed(sample);
        for seconds in [0.0, 1.0, 5.0, 20.0] {
            scene_at(&file, seconds).observer().unwrap_or_else(|error| panic!("{error}\n{sample}"));
        }
    }
}

#[test]
fn hostile_texts_take_little() {
    let cuts = (0..100_000).map(|i| format!("{{at={i},camera={{}}}},")).collect::<String>();
    assert!(refused(&format!("cuts = [{cuts}]")).contains("cuts are 100000; there may be 200"));
    let keys = (0..30_000).map(|i| format!("[{i}, 1],")).collect::<String>();
    assert!(refused(&format!("time = {{ keys = [{keys}] }}")).contains("30000 keys of 30000 times"));
    // Within the bounds it takes a moment, on a small stack.
    let keys = (0..19_000).map(|i| format!("[{i}, {}],", 1.0 + f64::from(i) * 1e-6)).collect::<String>();
    let text = format!("[camera]\nposition = [0, 9, 1]\nmotion = 'orbit'\nproper_time = {{ keys = [{keys}] }}");
    let deep = "a={".repeat(16) + &"}".repeat(16);
    let on_little =
        move || (SceneFile::parse(&text, Path::new("")).is_ok(), SceneFile::parse(&deep, Path::new("")).is_err());
    let thread = std::thread::Builder::new().stack_size(256 * 1024).spawn(on_little).unwrap();
    assert_eq!(thread.join().unwrap(), (true, true));
}

#[test]
fn attributes_name_every_parameter_once() {
    let mut scene = Scene::default();
    scene.volumes.extend([crate::scene::Volume::default(); crate::scene::Volume::MOST]);
    scene.hot_spots.extend([crate::scene::HotSpot::default(); crate::scene::HotSpot::MOST]);
    scene.camera.motion = Motion::FreeFall;
    scene.hole.spin = 0.1;
    let list = super::parameters(&scene.made(&Region { full_width: 3, full_height: 4, x: 1, y: 2 }));
    let mut names = list.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>();
    // OpenEXR's readers before 2.0 take names of 31 bytes.
    assert!(names.iter().all(|name| name.len() <= 31), "{names:?}");
    let value = |name: &str| list.iter().find(|(of, _)| of == name).map(|(_, value)| format!("{value:?}"));
    assert_eq!(value("bhr.hole.spin").as_deref(), Some("Number(0.1)"));
    assert_eq!(value("bhr.camera.motion").as_deref(), Some("Text(\"FREE_FALL\")"));
    assert_eq!(value("bhr.camera.position").as_deref(), Some("Text(\"0 26 2.5\")"));
    assert_eq!(value("bhr.disk.retrograde").as_deref(), Some("Number(0.0)"));
    assert_eq!(value("bhr.disk.reference").as_deref(), Some("Text(\"AT_MEDIAN\")"));
    assert_eq!(value("bhr.region.y").as_deref(), Some("Number(2.0)"));
    assert_eq!(value("bhr.view").as_deref(), Some("Text(\"LIGHT\")"));
    names.sort_unstable();
    let count = names.len();
    names.dedup();
    assert_eq!(names.len(), count);
}

/// Texts that are broken at random, from whole ones: each is refused or read, and what is read is a scene.
#[test]
fn broken_texts_are_errors() {
    let rounds = if runs_all() { 100_000 } else { 3_000 };
    let mut random = Random::new(1);
    let whole = [
        parsed("").text(None).unwrap(),
        "time = { keys = [[0, 0], [10, 300, 'ease']] }\n[camera]\norbit = { distance = 8 }\n\
         [[cuts]]\nat = 3\ncamera = {}"
            .to_owned(),
        "preset = 'cinematic'\n[[hot_spots]]\nradius = 9\n[[volumes]]\nshape = 'jet'\ntint = [1, 0.5, 1]".to_owned(),
    ];
    let bits =
        ["[", "]", "=", "\n", "1e400", "nan", "-", "'", "\"", "{", "keys", "[[", "99999999999", "\u{0}", "\u{fffd}"];
    let (mut read, mut refused) = (0, 0);
    for round in 0..rounds {
        let mut text = whole[round % whole.len()].clone();
        for _ in 0..=(random.unit() * 3.0) as usize {
            let mut pick = |count: usize| (random.unit() * count as f64) as usize % count.max(1);
            let at = pick(text.len().max(1));
            let Some(at) = (at..=text.len()).find(|at| text.is_char_boundary(*at)) else { continue };
            match pick(3) {
                0 => text.insert_str(at, bits[pick(bits.len())]),
                1 => drop(text.split_off(at)),
                _ => {
                    let end = (at + pick(9)..=text.len()).find(|end| text.is_char_boundary(*end));
                    text.replace_range(at..end.unwrap_or(at).max(at), "");
                }
            }
        }
        match SceneFile::parse(&text, Path::new("")) {
            Ok(file) => {
                file.at(1.0, &Scene::default()).unwrap_or_else(|error| panic!("{error}\n{text}"));
                read += 1;
            }
            Err(error) => {
                assert!(error.message.starts_with("line "), "{error}\n{text}");
                refused += 1;
            }
        }
    }
    assert!(read > rounds / 50 && refused > rounds / 4, "{read} {refused}");
}
