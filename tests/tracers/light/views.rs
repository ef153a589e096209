// SPDX-License-Identifier: MIT OR Apache-2.0
//! The views' raw values, pixel by pixel, against the tracer asked for the same rays; where there is no value, NaN.

use super::{both, bytes, camera, hits, neighbours, view, whole};
use crate::random::runs_all;
use bhr::image::PixelFormat;
use bhr::renderer::Renderer;
use bhr::scene::{Camera, Disk, DiskReference, EmissionLaw, Fate, Hit, LensTables, Method, Motion, View};
use glam::DVec3;

const SIZE: [u32; 2] = [160, 96];
const DISK: Disk = Disk {
    retrograde: false,
    inner_radius: 0.0,
    outer_radius: 20.0,
    temperature: 6500.0,
    opacity: 1.0,
    brightness: 1.0,
    turbulence: 0.0,
    seed: 0,
    reference: DiskReference::Hottest,
    edge_softness: 0.0,
    emission_law: EmissionLaw::Isotropic,
    plunges: false,
};

/// The value that a view should show of a ray that became `hit`. `look`: the observer's own direction, not aberrated.
/// `isco`: that of the disk's matter.
fn expected(view: View, hit: &Hit, look: DVec3, isco: f64) -> f64 {
    let listed = &hit.crossings[..hit.crossing_count as usize];
    let on_disk = listed.iter().position(|x| x.radius >= isco && x.radius <= DISK.outer_radius);
    match view {
        View::Redshift => match on_disk {
            Some(k) => hit.crossings[k].redshift,
            None => hit.sky_redshift,
        },
        View::Order => match (on_disk, hit.fate) {
            (Some(k), _) => k as f64,
            (None, Fate::Escaped) => -1.0,
            (None, _) => -2.0,
        },
        View::Deflection if hit.fate == Fate::Escaped => look.normalize().angle_between(hit.sky_direction),
        View::Metric if hit.crossing_count > 0 => 1.0 - 2.0 / hit.crossings[0].radius,
        _ => f64::NAN,
    }
}

/// A frame to compare: spin, the ISCO there, how rays are followed, and the camera's velocity.
struct Case {
    spin: f64,
    isco: f64,
    method: Method,
    tables: LensTables,
    velocity: DVec3,
}

/// design.md: 2e-5 of what the conditioning leaves for 1 + it, RK4 ten times that; the CPU's pixels take the GPU's
/// steps. Beside edges of the disk and of the shadow a pixel may belong to either side, but no more than 1 of 500
/// does.
#[test]
fn raw_values_are_those_of_the_rays() {
    let case = |spin: f64, method, tables| {
        let isco = if spin == 0.0 { 6.0 } else { 3.393_128 };
        Case { spin, isco, method, tables, velocity: DVec3::ZERO }
    };
    let fast = DVec3::new(0.2, -0.5, 0.3);
    let cases = [
        case(0.0, Method::Auto, LensTables::Always),
        case(0.7, Method::Auto, LensTables::Always),
        case(0.7, Method::Auto, LensTables::Never),
        case(0.7, Method::Rk4, LensTables::Never),
        Case { velocity: fast, ..case(0.0, Method::Auto, LensTables::Always) },
        Case { velocity: fast, ..case(0.7, Method::Auto, LensTables::Always) },
    ];
    for (i, case) in cases.into_iter().enumerate() {
        for (j, (tracer, mut renderer)) in both().into_iter().enumerate() {
            // Everyday the first two on both tracers, each of the others on one.
            if !runs_all() && i > 1 && (i + j) % 2 == 1 {
                continue;
            }
            renderer.scene.hole.spin = case.spin;
            renderer.scene.disk = Some(DISK);
            renderer.scene.camera =
                Camera { motion: Motion::Velocity, velocity: case.velocity, ..camera(20.0, 75.0, 24.0) };
            (renderer.scene.quality.method, renderer.scene.quality.lens_tables) = (case.method, case.tables);
            compare(tracer, &mut renderer, &case);
        }
    }
}

fn compare(tracer: &str, renderer: &mut Renderer, case: &Case) {
    let hits = hits(renderer, SIZE, whole(SIZE));
    let lens = renderer.scene.lens(&whole(SIZE)).unwrap();
    // The hole's axis being z, the chart's axes are the scene's.
    let looks: Vec<DVec3> = (0..hits.len())
        .map(|k| [k as u32 % SIZE[0], k as u32 / SIZE[0]].map(|v| f64::from(v) + 0.5))
        .map(|[x, y]| lens.observer.frame.vector(lens.look_direction(x, y)))
        .collect();
    let pixel = looks[0].angle_between(looks[1]);
    for shown in [View::Redshift, View::Order, View::Deflection, View::Metric] {
        let values = view(renderer, shown, SIZE, whole(SIZE));
        let wanted: Vec<f64> =
            hits.iter().zip(&looks).map(|(hit, look)| expected(shown, hit, *look, case.isco)).collect();
        let name = format!(
            "{tracer}: spin {}, {:?}, {:?}, velocity {}, {shown:?}",
            case.spin, case.method, case.tables, case.velocity
        );
        let bar = if case.method == Method::Rk4 { 2e-4 } else { 2e-5 };
        let (mut stray, mut worst, mut nothing) = (0, 0.0_f64, 0);
        for (k, (value, wanted_here)) in values.iter().zip(&wanted).enumerate() {
            nothing += u32::from(value.is_nan());
            let Some(near) = neighbours(k, SIZE).filter(|_| !(value.is_nan() && wanted_here.is_nan())) else {
                continue;
            };
            let change = near.iter().map(|n| (wanted[*n] - wanted_here).abs()).fold(0.0, f64::max);
            let error = (value - wanted_here).abs() / (1.0 + change / pixel);
            // Not as `error > bar`: true for NaN.
            if error <= bar { worst = worst.max(error) } else { stray += 1 }
        }
        println!("{name}: within {worst:.1e}, {stray} strays, {nothing} without value");
        assert!(stray * 500 <= values.len(), "{name}: {stray} values are not those of the rays");
        assert_eq!(nothing > 0, shown != View::Order, "{name}: {nothing} without value");
    }
}

/// Steps are counted where rays are integrated; a ray that passes the hole takes more than one that misses it.
#[test]
fn steps_are_those_of_integrated_rays() {
    for (tracer, mut renderer) in both() {
        renderer.scene.camera = camera(20.0, 75.0, 60.0);
        for method in [Method::Rk4, Method::Adaptive] {
            renderer.scene.quality.method = method;
            let steps = view(&mut renderer, View::Steps, SIZE, whole(SIZE));
            assert!(steps.iter().all(|s| *s > 0.0 && s.fract() == 0.0), "{tracer} {method:?}");
            let most = steps.iter().copied().fold(0.0, f64::max);
            assert!(most > 1.2 * steps[0] && most < 2000.0, "{tracer} {method:?}: {most}, {} in a corner", steps[0]);
        }
        renderer.scene.quality.method = Method::Auto;
        let steps = view(&mut renderer, View::Steps, SIZE, whole(SIZE));
        assert!(steps.iter().all(|s| *s == 0.0), "{tracer}: rays of spin 0 are looked up");
    }
}

/// Both tracers' 8-bit pictures, to one step in 99.9 % of the pixels; each shows many colours (ORDER: few), and no
/// value as grey.
#[test]
fn false_colours_agree() {
    for shown in [View::Redshift, View::Order, View::Deflection, View::Steps, View::Metric] {
        let [cpu, gpu] = both().map(|(_, mut renderer)| {
            renderer.scene.hole.spin = 0.7;
            renderer.scene.disk = Some(DISK);
            renderer.scene.camera = camera(20.0, 75.0, 24.0);
            renderer.scene.view = shown;
            if shown == View::Steps {
                renderer.scene.quality.method = Method::Rk4;
            }
            bytes(&mut renderer, PixelFormat::Rgba8Srgb, SIZE, whole(SIZE))
        });
        let pixels = || cpu.chunks_exact(4).zip(gpu.chunks_exact(4));
        let differ = pixels().filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 1)).count();
        let mut colours: Vec<&[u8]> = cpu.chunks_exact(4).collect();
        colours.sort_unstable();
        colours.dedup();
        println!("{shown:?}: {differ} pixels differ, {} colours", colours.len());
        // A step more or less of an integration is a colour more or less.
        let allowed = if shown == View::Steps { 50 } else { 1000 };
        assert!(differ * allowed <= pixels().count(), "{shown:?}: {differ} pixels");
        let range = match shown {
            View::Order => 4..7,
            View::Steps => 10..100,
            _ => 100..20_000,
        };
        assert!(range.contains(&colours.len()), "{shown:?}: {} colours", colours.len());
        let grey = colours.contains(&&[128, 128, 128, 255][..]);
        assert_eq!(grey, !matches!(shown, View::Order | View::Steps), "{shown:?}: grey for no value");
    }
}
