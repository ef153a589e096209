// SPDX-License-Identifier: MIT OR Apache-2.0
//! Frames with volumes and hot spots: in front of and behind the disk and the sky, observers within them and of every
//! motion, effects, symmetries, and rays and volumes at random. transfer.rs has the numbers.

use crate::frames::{cpu, floats, picture};
use crate::random::{Random, count_from, runs_all};
use bhr::image::PixelFormat;
use bhr::renderer::Renderer;
use bhr::scene::{
    Body, Camera, Chart, Disk, Effects, Fate, FlowLaw, HotSpot, LensTables, Motion, Projection, Ray, Scene, Shape, Sky,
    Transfer, View, Volume,
};
use glam::DVec3;

fn camera(distance: f64, elevation: f64) -> Camera {
    let (sin, cos) = elevation.to_radians().sin_cos();
    let position = DVec3::new(distance * cos, 0.0, distance * sin);
    Camera { position, forward: -position, up: DVec3::Z, fov_y: 50_f64.to_radians(), ..Camera::plain() }
}

/// No disk, a black sky, rays traced one by one.
fn bare(spin: f64, camera: Camera, volumes: &[Volume]) -> Scene {
    volumes.iter().for_each(|volume| volume.check().unwrap());
    let mut scene = Scene { disk: None, sky: Sky::black(), camera, ..Scene::plain() };
    scene.volumes.extend(volumes.iter().copied());
    scene.hole.spin = spin;
    scene.quality.lens_tables = LensTables::Never;
    scene
}

fn lights(renderer: &mut Renderer, scene: &Scene, size: [u32; 2], transparent: bool) -> Vec<[f32; 4]> {
    renderer.scene = scene.clone();
    let pixels = floats(&picture(renderer, PixelFormat::Rgba32F, size, None, transparent));
    pixels.as_chunks::<4>().0.to_vec()
}

const TORUS: Volume = Volume {
    retrograde: false,
    power_law: false,
    shape: Shape::Torus,
    flow: FlowLaw::Keplerian,
    inner_radius: 0.0,
    outer_radius: 40.0,
    radius: 9.0,
    width: 2.0,
    thickness: 0.2,
    opening: 0.3,
    slope: 0.7,
    absorption: 0.3,
    temperature: 6000.0,
    temperature_slope: 0.5,
    spectral_index: 1.0,
    tint: [1.0; 3],
    brightness: 1.0,
    sub_keplerian: 1.0,
    infall: 0.0,
    angular_momentum: 1.0,
    speed: 0.9,
    turbulence: 0.0,
    clumping: 1.8,
    heating: 0.15,
    seed: 0,
};

/// One of each shape, flow and light.
fn one_of_each() -> [Volume; 4] {
    let flow = FlowLaw::AngularMomentum;
    let halo = Volume { shape: Shape::Halo, thickness: 0.5, flow, power_law: true, absorption: 0.1, ..TORUS };
    let jet = Volume { shape: Shape::Jet, flow: FlowLaw::Outflow, thickness: 0.05, slope: 1.5, ..TORUS };
    [Volume { inner_radius: 3.0, outer_radius: 20.0, thickness: 0.1, shape: Shape::Disk, ..TORUS }, TORUS, halo, jet]
}

/// Matter that neither shines nor absorbs changes nothing, whatever is before and behind it.
#[test]
fn matter_of_brightness_0_changes_nothing() {
    let mut renderer = cpu();
    for (volume, plunges) in one_of_each().into_iter().flat_map(|volume| [(volume, false), (volume, true)]) {
        let mut scene = bare(0.7, camera(25.0, 15.0), &[]);
        scene.disk = Some(Disk { opacity: 0.7, turbulence: 0.5, plunges, ..Disk::plain() });
        scene.sky = Scene::plain().sky;
        // Rays that are followed farther inwards have more crossings there, by which edges are told.
        scene.quality.refines = false;
        let without = lights(&mut renderer, &scene, [48, 32], false);
        scene.volumes.push(Volume { brightness: 0.0, absorption: 0.0, ..volume });
        scene.hot_spots.push(HotSpot { brightness: 0.0, ..HotSpot::default() });
        let with = lights(&mut renderer, &scene, [48, 32], false);
        let far =
            without.iter().zip(&with).filter(|(a, b)| (0..4).any(|c| (a[c] - b[c]).abs() > 1e-4 * a[c].max(1e-3)));
        assert_eq!(far.count(), 0, "{:?} {plunges}", volume.shape);
    }
}

/// Alpha is 1 - e^-T with the optical depth that the view shows, and light in front of the sky adds to e^-T of it.
#[test]
fn the_sky_behind_matter_is_dimmed_by_its_optical_depth() {
    let mut renderer = cpu();
    for volume in one_of_each() {
        let mut scene = bare(0.5, camera(30.0, 20.0), &[volume]);
        scene.quality.refines = false;
        let alone = lights(&mut renderer, &scene, [32, 24], true);
        scene.view = View::OpticalDepth;
        renderer.scene = scene.clone();
        let depths = floats(&picture(&mut renderer, PixelFormat::R32F, [32, 24], None, false));
        let thick = depths.iter().fold(0.0_f32, |a, b| if b.is_nan() { a } else { a.max(*b) });
        assert!(thick > 0.2, "{:?}: {thick}", volume.shape);
        scene.view = View::Light;
        scene.sky = Scene::plain().sky;
        let whole = lights(&mut renderer, &scene, [32, 24], false);
        scene.volumes.clear();
        let sky = lights(&mut renderer, &scene, [32, 24], false);
        for (i, depth) in depths.iter().enumerate() {
            if depth.is_nan() {
                assert_eq!(alone[i][3], 1.0);
                continue;
            }
            assert!((alone[i][3] + (-depth).exp_m1()).abs() < 1e-5, "{:?}: {:?} {depth}", volume.shape, alone[i]);
            for c in 0..3 {
                let expected = alone[i][c] + (-depth).exp() * sky[i][c];
                assert!((whole[i][c] - expected).abs() < 1e-5 * (1.0 + expected), "{:?} {c}", volume.shape);
            }
        }
    }
}

/// The disk in the middle of a halo: an opaque one hides the half behind it, a black one without opacity hides none;
/// and light before the disk adds to what passes of it.
#[test]
fn the_disk_hides_the_matter_behind_it() {
    let mut renderer = cpu();
    let halo = Volume { shape: Shape::Halo, thickness: 1e6, radius: 8.0, absorption: 0.05, ..TORUS };
    let scene = |disk: Option<Disk>, volumes: &[Volume]| {
        let mut scene = Scene { disk, ..bare(0.0, camera(40.0, 60.0), volumes) };
        scene.quality.refines = false;
        scene
    };
    let dark = Disk { brightness: 0.0, outer_radius: 1e3, ..Disk::plain() };
    let [open, veiled, hidden] = [0.0, 0.5, 1.0]
        .map(|opacity| lights(&mut renderer, &scene(Some(Disk { opacity, ..dark }), &[halo]), [24, 24], false));
    let without = lights(&mut renderer, &scene(None, &[halo]), [24, 24], false);
    let bright = Disk { brightness: 1.0, opacity: 0.5, turbulence: 0.0, ..dark };
    let [shining, bare_disk] =
        [&[halo][..], &[]].map(|volumes| lights(&mut renderer, &scene(Some(bright), volumes), [24, 24], false));
    let (mut dimmed, mut little) = (0, 0);
    for i in 0..open.len() {
        assert!((open[i][1] - without[i][1]).abs() <= 1e-5 * without[i][1], "{i}");
        assert!(hidden[i][1] <= veiled[i][1] && veiled[i][1] <= open[i][1] * 1.00001, "{i}");
        dimmed += usize::from(hidden[i][1] < 0.7 * open[i][1]);
        // The halo before the disk takes from its light, and the halo's own adds to it.
        let disk = shining[i][1] - veiled[i][1];
        assert!(disk <= bare_disk[i][1] * 1.0001 && disk >= 0.05 * bare_disk[i][1], "{i}: {disk} {}", bare_disk[i][1]);
        little += usize::from(disk < 0.99 * bare_disk[i][1] && disk > 0.5 * bare_disk[i][1]);
    }
    assert!(dimmed > open.len() / 3 && little > open.len() / 3, "{dimmed} {little}");
}

/// An observer who falls from rest is the static one moving inwards, whatever effects are left out: the rain frame, in
/// which rays of the one begin, is no other place.
#[test]
fn falling_and_moving_observers_see_the_same() {
    let mut renderer = cpu();
    let r: f64 = 10.0;
    for effects in [Effects::ALL, 0, Effects::DOPPLER_SHIFT, Effects::GRAVITY_SHIFT | Effects::BEAMING] {
        let mut scene = bare(0.0, camera(r, 10.0), &one_of_each());
        scene.effects = Effects(effects);
        scene.hot_spots.push(HotSpot { thermal: true, absorption: 1.0, ..HotSpot::default() });
        scene.camera.motion = Motion::FreeFall;
        let falling = lights(&mut renderer, &scene, [24, 16], false);
        scene.camera.motion = Motion::Velocity;
        scene.camera.velocity = -scene.camera.position.normalize() * (2.0 / r).sqrt();
        let moving = lights(&mut renderer, &scene, [24, 16], false);
        let most = falling.iter().fold(0.0_f32, |a, b| a.max(b[1]));
        let far = falling.iter().zip(&moving).filter(|(a, b)| (0..4).any(|c| (a[c] - b[c]).abs() > 1e-3 * most));
        assert!(most > 0.1 && far.count() == 0, "{effects}: {most}");
    }
}

/// With all light's effects off opaque matter of one temperature is the same colour everywhere.
#[test]
fn without_effects_matter_looks_as_it_is_at_rest() {
    let mut renderer = cpu();
    let opaque = Volume { absorption: 100.0, temperature_slope: 0.0, ..TORUS };
    let mut scene = bare(0.9, camera(30.0, 10.0), &[opaque]);
    scene.quality.refines = false;
    let spread = |pixels: &[[f32; 4]]| {
        let covered = pixels.iter().filter(|p| p[3] > 0.9999 && p[0] > 0.0).map(|p| p[0]).collect::<Vec<_>>();
        assert!(covered.len() > 100, "{}", covered.len());
        covered.iter().fold(0.0_f32, |a, b| a.max(*b)) / covered.iter().fold(f32::INFINITY, |a, b| a.min(*b))
    };
    let shifted = spread(&lights(&mut renderer, &scene, [48, 32], true));
    scene.effects = Effects(0);
    let even = spread(&lights(&mut renderer, &scene, [48, 32], true));
    assert!(shifted > 5.0 && even < 1.02, "{shifted} {even}");
}

/// The mirror image of hole and matter is the mirrored picture; a hole twice as heavy, twice as far away, looks the
/// same.
#[test]
fn mirrors_and_scales_change_nothing() {
    let mut renderer = cpu();
    let mut scene = bare(0.8, camera(20.0, 12.0), &one_of_each()[..3]);
    scene.hot_spots.push(HotSpot { azimuth: 2.0, ..HotSpot::default() });
    scene.time = 30.0;
    let seen = lights(&mut renderer, &scene, [32, 20], false);
    let mut mirrored = scene.clone();
    mirrored.hole.spin = -0.8;
    mirrored.volumes.iter_mut().for_each(|volume| volume.retrograde = true);
    mirrored.hot_spots[0] = HotSpot { azimuth: -2.0, retrograde: true, ..scene.hot_spots[0] };
    let other = lights(&mut renderer, &mirrored, [32, 20], false);
    scene.hole.mass = 2.0;
    scene.time *= 2.0;
    scene.camera.position *= 2.0;
    let heavy = lights(&mut renderer, &scene, [32, 20], false);
    let most = seen.iter().fold(0.0_f32, |a, b| a.max(b[0]));
    for (i, here) in seen.iter().enumerate() {
        let there = other[i / 32 * 32 + 31 - i % 32];
        for c in 0..4 {
            assert!((here[c] - there[c]).abs() < 1e-5 * most, "{i}: {here:?} {there:?}");
            assert!((here[c] - heavy[i][c]).abs() < 1e-5 * most, "{i}: {here:?} {:?}", heavy[i]);
        }
    }
}

/// Light delay moves what a hot spot shows, and after an orbit all is as it was, at any time.
#[test]
fn hot_spots_go_round() {
    let mut renderer = cpu();
    let spin = 0.6;
    let mut scene = bare(spin, camera(30.0, 25.0), &[]);
    scene.hot_spots.push(HotSpot { radius: 8.0, azimuth: 0.4, ..HotSpot::default() });
    let period = std::f64::consts::TAU * (8.0_f64.powf(1.5) + spin);
    let mut at = |time: f64, effects: u32| {
        scene.time = time;
        scene.effects = Effects(effects);
        lights(&mut renderer, &scene, [32, 24], false)
    };
    let apart = |a: &[[f32; 4]], b: &[[f32; 4]]| a.iter().zip(b).map(|(a, b)| (a[0] - b[0]).abs()).fold(0.0, f32::max);
    let begin = at(0.0, Effects::ALL);
    let most = apart(&begin, &vec![[0.0; 4]; begin.len()]);
    assert!(apart(&begin, &at(period, Effects::ALL)) < 1e-5 * most);
    assert!(apart(&begin, &at(-period * 1e6, Effects::ALL)) < 1e-3 * most);
    assert!(apart(&begin, &at(0.5 * period, Effects::ALL)) > 0.3 * most);
    assert!(apart(&begin, &at(0.0, Effects::ALL & !Effects::LIGHT_DELAY)) > 0.3 * most);
}

/// Wherever the observer is, within the matter, beside the horizon and inside it, and whatever the projection, light is
/// finite and alpha within its range. Everyday thin and opaque matter by turns.
#[test]
fn observers_within_the_matter_see_finite_light() {
    let mut renderer = cpu();
    let places = [(0.998, 1.08), (0.0, 2.001), (0.0, 1.0), (0.0, 2.9), (0.5, 9.0), (-0.9, 6.0), (0.3, 1e5)];
    let projections = [Projection::Perspective, Projection::Fisheye, Projection::Equirect, Projection::Cube];
    for (i, (spin, distance)) in places.into_iter().enumerate() {
        for (j, projection) in projections.into_iter().enumerate() {
            for (k, absorption) in [0.01, 1e6].into_iter().enumerate() {
                if !runs_all() && (i + j + k) % 2 == 1 {
                    continue;
                }
                let volumes = one_of_each().map(|volume| Volume { absorption, ..volume });
                let mut scene = bare(spin, camera(distance, 8.0), &volumes);
                scene.hot_spots.push(HotSpot { radius: 9.0, size: 1.0, absorption, ..HotSpot::default() });
                scene.camera.projection = projection;
                let falls = distance <= 2.9 && spin == 0.0;
                scene.camera.motion = if falls { Motion::FreeFall } else { Motion::Static };
                let size = if projection == Projection::Cube { [48, 8] } else { [16, 12] };
                let pixels = lights(&mut renderer, &scene, size, true);
                let good = |p: &[f32; 4]| p.iter().all(|v| v.is_finite() && *v >= 0.0) && p[3] <= 1.0;
                let bad = pixels.iter().find(|p| !good(p));
                assert!(bad.is_none(), "{spin} {distance} {projection:?} {absorption}: {bad:?}");
                let seen = pixels.iter().filter(|p| p[3] > 0.0).count();
                assert!(seen > 0 || distance > 1e3, "{spin} {distance} {projection:?} {absorption}: nothing is seen");
            }
        }
    }
}

fn any_volume(random: &mut Random) -> Volume {
    let shape = random.pick(&[Shape::Disk, Shape::Torus, Shape::Halo, Shape::Jet]);
    let outer_radius = random.log_range(1.0, Volume::MAX_RADIUS);
    let radius = random.log_range(0.1, Volume::MAX_RADIUS);
    Volume {
        retrograde: random.next() < 0.5,
        power_law: random.next() < 0.5,
        shape,
        flow: random.pick(&[FlowLaw::Keplerian, FlowLaw::AngularMomentum, FlowLaw::Outflow]),
        inner_radius: random.pick(&[0.0, 0.3, 0.99]) * outer_radius,
        outer_radius,
        radius,
        width: radius * random.log_range(Volume::NARROWEST, 1.0),
        thickness: random.log_range(0.01, 1e6),
        opening: random.range(0.01, 1.5),
        slope: random.range(0.0, 4.0),
        absorption: random.pick(&[0.0, 1.0, 1e6]) * random.next(),
        temperature: random.log_range(500.0, 1e9),
        temperature_slope: random.range(0.0, 2.0),
        spectral_index: random.range(-4.0, 4.0),
        tint: [random.next(), random.next(), random.next()],
        brightness: random.pick(&[0.0, 1.0, 1e6]),
        sub_keplerian: random.next(),
        infall: random.pick(&[0.0, 1.0, random.0 as f64 / u64::MAX as f64]),
        angular_momentum: random.next(),
        speed: random.range(0.0, 0.995),
        turbulence: random.pick(&[0.0, 1.0, 0.4]),
        clumping: random.range(0.5, 3.0),
        heating: random.range(0.0, 0.5),
        seed: random.0,
    }
}

/// `time`: that of the scene, which free spots were near lately.
fn any_spot(random: &mut Random, time: f64) -> HotSpot {
    let falling = Body {
        chart: random.pick(&[Chart::Static, Chart::Rain]),
        position: random.direction() * random.log_range(2.1, 300.0),
        velocity: random.direction() * random.range(0.0, 0.999),
        time: time + random.range(-300.0, 300.0),
    };
    let radius = random.log_range(1.0, 1e3);
    HotSpot {
        retrograde: random.next() < 0.5,
        thermal: random.next() < 0.5,
        radius,
        size: random.log_range(f64::max(0.05, 0.0051 * radius), f64::max(0.05, HotSpot::LARGEST * radius)),
        azimuth: random.range(-1e6, 1e6),
        absorption: random.pick(&[0.0, 1.0, 1e6]),
        temperature: random.log_range(500.0, 1e9),
        spectral_index: random.range(-4.0, 4.0),
        tint: [1.0; 3],
        brightness: random.pick(&[0.0, 1.0, 1e6]),
        free: (random.next() < 0.3).then(|| falling.falling()),
    }
}

/// No ray, through no matter, gives NaN where it should not, or less than nothing; and all end.
#[test]
fn random_rays_through_random_matter_give_numbers() {
    let mut random = Random(20_261_123);
    let mut renderer = cpu();
    let rays = count_from("BHR_TEST_TRANSFER_RAYS", 700, 1_000_000);
    let (mut seen, mut escaped, mut count) = (0, 0, 0);
    while count < rays {
        let spin = random.pick(&[0.0, 0.5, -0.9, 0.998, -0.998]);
        let mut scene = bare(spin, camera(30.0, 10.0), &[]);
        (0..1 + random.0 % 4).for_each(|_| scene.volumes.push(any_volume(&mut random)));
        scene.time = random.range(-1e9, 1e9);
        (0..random.0 % 4).for_each(|_| scene.hot_spots.push(any_spot(&mut random, scene.time)));
        scene.hot_spots.iter().for_each(|spot| spot.check().unwrap_or_else(|e| panic!("{e}")));
        scene.volumes.iter().for_each(|volume| volume.check().unwrap_or_else(|e| panic!("{e}")));
        scene.effects = Effects(random.pick(&[Effects::ALL, 0, 3, 5, 8]));
        scene.effect_strengths.beaming = random.pick(&[1.0, 0.0, 0.5]);
        scene.effect_strengths.doppler_shift = random.pick(&[1.0, 0.3]);
        renderer.scene = scene;
        let least = if spin == 0.0 { 0.5 } else { 1.08 + (1.0 - spin * spin).sqrt() };
        let given = (0..50).map(|_| {
            let position = random.direction() * random.log_range(least, 3e4);
            // Half of them look at the hole's surroundings.
            let target = random.direction() * random.log_range(0.01, 100.0);
            let direction = if random.next() < 0.5 { random.direction() } else { target - position };
            Ray { position, direction, frequency_ratio: random.log_range(0.1, 10.0) }
        });
        let given = given.collect::<Vec<_>>();
        let mut found = vec![Transfer::default(); given.len()];
        renderer.transfer_rays(&given, &mut found).unwrap();
        for (ray, found) in given.iter().zip(&found) {
            let scene = || format!("{found:?} {ray:?} {:?}", renderer.scene);
            assert_ne!(found.fate, Fate::Invalid, "{}", scene());
            assert!(found.intensity >= 0.0 && found.intensity.is_finite(), "{}", scene());
            assert!(found.light.iter().all(|v| *v >= 0.0 && v.is_finite()), "{}", scene());
            assert_eq!(found.optical_depth.is_nan(), found.fate != Fate::Escaped, "{}", scene());
            assert!(found.optical_depth.is_nan() || found.optical_depth >= 0.0, "{}", scene());
            seen += usize::from(found.light[0] > 0.0);
            escaped += usize::from(found.fate == Fate::Escaped);
        }
        count += given.len();
    }
    println!("{seen} of {count} see light, {escaped} escape");
    assert!(seen > count / 5 && escaped > count / 5, "{seen} {escaped}");
}
