// SPDX-License-Identifier: MIT OR Apache-2.0
//! Random scenes at the ends of every range: no NaN where a number is promised, no endless loop, no lost device, on
//! both tracers.

use crate::frames::Lent;
use crate::random::{Random, count_from};
use bhr::image::{ImageMut, PixelFormat, memory::Layout};
use bhr::physics::trace;
use bhr::scene::record::Record;
use bhr::scene::{Camera, Fate, Hit, LensTables, Method, Motion, Projection, Ray};
use glam::DVec3;

fn both() -> [Lent; 2] {
    crate::frames::both().map(|(_, renderer)| renderer)
}

const SPINS: [f64; 7] = [0.0, 1e-9, 0.5, 0.998, 0.9999, -0.9999, -1e-3];
const PROJECTIONS: [Projection; 5] =
    [Projection::Perspective, Projection::Perspective, Projection::Fisheye, Projection::Equirect, Projection::Cube];
const MASSES: [f64; 5] = [1.0, 1e-12, 1e12, 1e-100, 1e100];

/// A place in units of M outside the horizon, often beside it, on the axis, or in the plane.
fn place(random: &mut Random, spin: f64) -> DVec3 {
    let horizon = 1.0 + (1.0 - spin * spin).sqrt();
    let r = random.pick(&[
        horizon * (1.0 + 1e-13),
        horizon * (1.0 + 1e-7),
        horizon + 1e-6,
        horizon * 1.001,
        3.0,
        10.0,
        1e3,
        1e6,
    ]);
    let random_direction = random.direction();
    let toward = random.pick(&[DVec3::Z, DVec3::NEG_Z, DVec3::X, DVec3::NEG_Y, random_direction, random_direction]);
    toward * r
}

#[test]
fn rays_at_the_extremes() {
    let mut random = Random(7);
    let mut renderers = both();
    for scene in 0..120 {
        let (spin, mass) = (random.pick(&SPINS), random.pick(&MASSES));
        let method = random.pick(&[Method::Auto, Method::Auto, Method::Rk4, Method::Adaptive]);
        let rays = (0..64).map(|_| {
            let position = place(&mut random, spin);
            let inward = -position.normalize();
            let other = random.direction();
            let direction = random.pick(&[
                inward,
                -inward,
                other,
                other,
                inward + 1e-9 * other,
                inward + other / position.length(),
            ]);
            Ray { position: position * mass, direction, frequency_ratio: 1.0 }
        });
        let rays = rays.collect::<Vec<_>>();
        for renderer in &mut renderers {
            (renderer.scene.hole.spin, renderer.scene.hole.mass) = (spin, mass);
            renderer.scene.quality.method = method;
            let mut hits = vec![Hit::default(); rays.len()];
            renderer.trace_rays(&rays, &mut hits).unwrap();
            for (ray, hit) in rays.iter().zip(&hits) {
                let case = format!("scene {scene} spin {spin} mass {mass} {method:?} {ray:?}: {hit:?}");
                assert_ne!(hit.fate, Fate::Invalid, "{case}");
                assert!(hit.steps <= renderer.scene.quality.max_steps, "{case}");
                if hit.fate == Fate::Escaped {
                    assert!((hit.sky_direction.length() - 1.0).abs() < 1e-6 && hit.sky_redshift > 0.0, "{case}");
                }
                for crossing in &hit.crossings[..hit.crossing_count as usize] {
                    assert!(
                        crossing.radius > 0.0 && crossing.radius.is_finite() && crossing.azimuth.is_finite(),
                        "{case}"
                    );
                    assert!(crossing.delay.is_finite(), "{case}");
                }
            }
        }
    }
}

/// Full vertical angles, rad.
const FIELDS: [f64; 5] = [1e-6, 0.3, 1.0, 3.0, 3.1];

#[test]
fn frames_at_the_extremes() {
    let mut random = Random(11);
    let mut renderers = both();
    for scene in 0..count_from("BHR_EXTREME_SCENES", 12, 1000) {
        let (spin, mass) = (random.pick(&SPINS), random.pick(&MASSES));
        let motion = random.pick(&[Motion::Static, Motion::FreeFall, Motion::Velocity]);
        let inside = spin == 0.0 && motion == Motion::FreeFall && random.next() < 0.5;
        let position =
            if inside { random.direction() * random.pick(&[1e-3, 1.0, 2.0]) } else { place(&mut random, spin) };
        let velocity = random.direction() * random.pick(&[0.0, 0.5, 0.999, 0.999999]);
        let forward = random.direction();
        let fov_y = random.pick(&FIELDS);
        let projection = random.pick(&PROJECTIONS);
        let camera = Camera {
            position: position * mass,
            forward,
            up: forward.any_orthonormal_vector(),
            fov_y,
            motion,
            velocity,
            projection,
            ..Camera::plain()
        };
        let height = if projection == Projection::Cube { 4 } else { 16 };
        for renderer in &mut renderers {
            (renderer.scene.hole.spin, renderer.scene.hole.mass, renderer.scene.camera) = (spin, mass, camera);
            let mut pixels = vec![0; 24 * height as usize * 16];
            let layout = Layout::packed(PixelFormat::Rgba32F, 24, height);
            let mut image = ImageMut::new(layout, &mut pixels).unwrap();
            renderer
                .render(&mut image, false, None, &mut |_| true)
                .unwrap_or_else(|e| panic!("scene {scene}: {e} {camera:?}"));
            let light = pixels.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap()));
            let bad = light.filter(|v| !(v.is_finite() && *v >= 0.0)).count();
            assert_eq!(bad, 0, "scene {scene} spin {spin} mass {mass} {camera:?}");
        }
    }
}

/// BHR_EXTREME_SCENES frames of 101 x 99 rays (cubes: fewer), most of them looked up: the middle one is exactly radial
/// where the camera looks at the hole or away from it. Among the first 15 is every spin, motion, projection and kind
/// of tables.
#[test]
#[ignore = "in tests/run all; everyday: small frames at the same extremes"]
fn table_frames_at_the_extremes() {
    let mut random = Random(13);
    let mut renderers = both();
    for scene in 0..count_from("BHR_EXTREME_SCENES", 15, 1000) {
        let (spin, mass) = (random.pick(&SPINS), random.pick(&MASSES));
        let spin = if random.next() < 0.3 { 0.0 } else { spin };
        let motion = random.pick(&[Motion::Static, Motion::FreeFall, Motion::Velocity]);
        let inside = spin == 0.0 && motion == Motion::FreeFall && random.next() < 0.3;
        let position =
            if inside { random.direction() * random.pick(&[1e-3, 0.9, 1.0, 2.0]) } else { place(&mut random, spin) };
        let (anywhere, outward) = (random.direction(), position.normalize());
        let forward =
            random.pick(&[anywhere, anywhere, outward, -outward, -outward, -outward + anywhere / position.length()]);
        let camera = Camera {
            position: position * mass,
            forward,
            up: forward.any_orthogonal_vector(),
            fov_y: random.pick(&FIELDS),
            motion,
            velocity: random.direction() * random.pick(&[0.0, 0.5, 0.999, 0.999999]),
            projection: random.pick(&PROJECTIONS),
            ..Camera::plain()
        };
        let [width, height] = if camera.projection == Projection::Cube { [102, 17] } else { [101, 99] };
        let disk = [random.pick(&[20.0, 1e6]), random.pick(&[0.5, 1.0]), random.pick(&[0.0, 1.0])];
        let tables = random.pick(&[LensTables::Always, LensTables::Always, LensTables::Auto]);
        for renderer in &mut renderers {
            let hole = &mut renderer.scene.hole;
            (hole.spin, hole.mass, renderer.scene.camera) = (spin, mass, camera);
            renderer.scene.quality.lens_tables = tables;
            let matter = renderer.scene.disk.as_mut().unwrap();
            [matter.outer_radius, matter.opacity, matter.turbulence] = disk;
            let case = || format!("scene {scene} spin {spin} mass {mass} disk {disk:?} {tables:?} {camera:?}");
            let records = renderer.ray_records(width, height).unwrap_or_else(|e| panic!("{e}: {}", case()));
            let bad = records.iter().enumerate().find(|(_, record)| !is_sound(record));
            assert!(bad.is_none(), "{} {}: {bad:?}", renderer.adapter().name, case());
        }
    }
}

/// Whether a record holds numbers where shading reads them.
fn is_sound(record: &Record) -> bool {
    let sky = match record.fate {
        trace::Fate::Escaped => {
            (record.direction.length() - 1.0).abs() < 1e-5
                && record.sky_redshift > 0.0
                && record.sky_redshift.is_finite()
                && !record.footprint.iter().any(|f| f.is_nan())
        }
        _ => true,
    };
    let crossings = record.crossings.iter().all(|x| {
        let places = [x.place, x.footprint[0], x.footprint[1]];
        x.u > 0.0 && x.u.is_finite() && x.g >= 0.0 && !places.iter().any(|p| (p.ln_r + p.azimuth + p.delay).is_nan())
    });
    let constants = record.energy.is_finite() && record.angular_momentum.is_finite();
    sky && crossings && (constants || record.fate == trace::Fate::Unresolved)
}

/// The speeds of cameras that see nearly all light within 1 / gamma of where they go: gamma is 22, 71, 707 and 7e5.
const SPEEDS: [f64; 4] = [0.999, 0.9999, 1.0 - 1e-6, 1.0 - 1e-12];

/// Frames of cameras at such speeds are alike on both tracers: light by its frequency and its beaming, ahead, aside
/// and behind, without a motion along an axis, through lens tables and ray by ray.
#[test]
fn fast_cameras_see_the_same_on_both_tracers() {
    let mut renderers = both();
    let motion = DVec3::new(-0.3, -0.9, 0.2).normalize();
    let aside = motion.any_orthonormal_vector();
    for (spin, tables) in [(0.0, LensTables::Never), (0.0, LensTables::Always), (0.7, LensTables::Never)] {
        for speed in SPEEDS {
            for (forward, fov_y) in [(motion, 0.02), (motion, 0.8), (motion + 0.5 * aside, 1.0), (-motion, 1.0)] {
                let lights = renderers.each_mut().map(|renderer| {
                    let scene = &mut renderer.scene;
                    scene.hole.spin = spin;
                    scene.quality.lens_tables = tables;
                    scene.camera = Camera {
                        position: DVec3::new(0.0, 26.0, 2.5),
                        forward,
                        up: aside.cross(forward),
                        fov_y,
                        motion: Motion::Velocity,
                        velocity: motion * speed,
                        ..Camera::plain()
                    };
                    let records = renderer.ray_records(49, 49).unwrap();
                    records.iter().map(|record| (record.fate, record.sky_redshift)).collect::<Vec<_>>()
                });
                let [cpu, gpu] = &lights;
                // Lens tables do not tell whether a disk hides what is behind it.
                let both = cpu.iter().zip(gpu).filter(|(a, b)| ![a.0, b.0].contains(&trace::Fate::Hidden));
                let unlike = both.filter(|((fate, g), (other, h))| {
                    fate != other || (*fate == trace::Fate::Escaped && (g / h - 1.0).abs() > 0.01)
                });
                let unlike = unlike.count();
                assert!(unlike <= cpu.len() / 1000, "spin {spin} {tables:?} v {speed} fov {fov_y}: {unlike} differ");
            }
        }
    }
}
