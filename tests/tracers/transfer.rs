// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light through matter with depth against tests/golden/volume: images, fluxes and hot spots that two independent codes
//! agree on, and the fluxes that Gold et al. 2020 published. The CPU tracer, and single rays.

use crate::frames::{cpu, floats, picture};
use crate::random::runs_all;
use bhr::image::PixelFormat;
use bhr::renderer::Renderer;
use bhr::scene::{Camera, Fate, FlowLaw, HotSpot, Ray, Scene, Shape, Sky, Transfer, View, Volume};
use glam::DVec3;
use serde_json::Value;

fn file(name: &str) -> Vec<u8> {
    std::fs::read(format!("tests/golden/volume/{name}")).unwrap()
}

fn doubles(name: &str) -> Vec<f64> {
    file(name).as_chunks::<8>().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect()
}

fn manifest() -> Value {
    serde_json::from_slice(&file("manifest.json")).unwrap()
}

/// The volume of a manifest's medium.
fn volume(medium: &Value) -> Volume {
    let number = |name: &str| medium[name].as_f64().unwrap_or(0.0);
    let thermal = medium["emis"] == "thermal";
    let gold = medium["shape"] == "gold";
    Volume {
        power_law: !thermal,
        shape: if gold { Shape::Halo } else { Shape::Torus },
        flow: if medium["flow"] == "gold" { FlowLaw::AngularMomentum } else { FlowLaw::Keplerian },
        outer_radius: number("rmax"),
        radius: number("r0"),
        width: if gold { 2.0 } else { number("sr") },
        thickness: if gold { (1.0 / number("h")).min(1e6) } else { number("sz") / number("r0") },
        absorption: if thermal { number("kappa") } else { number("A") },
        temperature: if thermal { number("T0") } else { 5000.0 },
        temperature_slope: number("qT"),
        spectral_index: number("alpha"),
        sub_keplerian: medium["subk"].as_f64().unwrap_or(1.0),
        infall: number("infall"),
        angular_momentum: number("l0"),
        ..Volume::default()
    }
}

/// The scene of an image: a camera at rest that looks at the hole, nothing but the matter.
fn scene(image: &Value, volumes: &[Volume], hot_spots: &[HotSpot]) -> Scene {
    let number = |name: &str| image[name].as_f64().unwrap();
    let (sin, cos) = number("inclination_deg").to_radians().sin_cos();
    let position = DVec3::new(sin, 0.0, cos) * number("camera_radius");
    let mut scene = Scene {
        camera: Camera {
            position,
            forward: -position,
            up: DVec3::Z,
            fov_y: 2.0 * number("half_tan").atan(),
            ..Camera::plain()
        },
        disk: None,
        sky: Sky::black(),
        volumes: volumes.iter().copied().collect(),
        hot_spots: hot_spots.iter().copied().collect(),
        ..Scene::plain()
    };
    scene.hole.spin = number("spin");
    volumes.iter().for_each(|volume| volume.check().unwrap());
    hot_spots.iter().for_each(|spot| spot.check().unwrap());
    scene
}

fn camera_rays(scene: &Scene, side: u32) -> Vec<Ray> {
    let mut rays = vec![Ray::default(); (side * side) as usize];
    scene.camera_rays(side, side, None, &mut |i, ray| rays[i] = ray).unwrap();
    rays
}

fn transfer(renderer: &mut Renderer, rays: &[Ray]) -> Vec<Transfer> {
    let mut found = vec![Transfer::default(); rays.len()];
    renderer.transfer_rays(rays, &mut found).unwrap();
    found
}

/// Every `n`-th of a list, all with BHR_TESTS_ALL=1.
fn thinned<T>(list: Vec<T>, n: usize) -> Vec<T> {
    let n = if runs_all() { 1 } else { n };
    list.into_iter().step_by(n).collect()
}

/// Single rays are held to the error of the reference, and to 1e-8 of the picture's peak.
#[test]
fn rays_agree_with_two_other_codes() {
    let mut renderer = cpu();
    for image in manifest()["images"].as_array().unwrap() {
        let name = image["file"].as_str().unwrap();
        let channels = image["channels"].as_array().unwrap().len();
        let values = doubles(name);
        renderer.scene = scene(image, &[volume(&image["medium"])], &[]);
        let rays = camera_rays(&renderer.scene, 32);
        let places = thinned((0..rays.len()).collect(), 7);
        let found = transfer(&mut renderer, &places.iter().map(|at| rays[*at]).collect::<Vec<_>>());
        let peak = |channel: usize| values.iter().skip(channel).step_by(channels).fold(0.0, |a: f64, b| a.max(*b));
        let power = image["medium"]["emis"] == "power";
        let mut worst = [0.0_f64; 2];
        for (at, found) in places.iter().zip(&found) {
            let pixel = &values[at * channels..][..channels];
            let err = pixel[channels - 1];
            assert_eq!(pixel[0] < 0.0, found.fate == Fate::Captured, "{name} {at}");
            let mut compare = |channel: usize, value: f64| {
                let error = (value - pixel[channel]).abs() / peak(channel).max(1e-300);
                let over = error / f64::max(1e-8, 3.0 * err);
                worst[channel] = worst[channel].max(over);
            };
            if pixel[0] >= 0.0 && peak(0) > 0.0 {
                compare(0, found.optical_depth);
            }
            if power {
                compare(1, found.intensity);
            }
        }
        println!("{name}: depth {:.3}, intensity {:.3} of the tolerance", worst[0], worst[1]);
        assert!(worst[0] <= 1.0 && worst[1] <= 1.0, "{name}: {worst:?}");
    }
}

/// Pixels: the views, at the step of pictures.
#[test]
fn pixels_agree_with_two_other_codes() {
    let mut renderer = cpu();
    for image in manifest()["images"].as_array().unwrap() {
        let name = image["file"].as_str().unwrap();
        let channels = image["channels"].as_array().unwrap().len();
        let values = doubles(name);
        renderer.scene = scene(image, &[volume(&image["medium"])], &[]);
        for (view, channel) in [(View::OpticalDepth, 0), (View::Intensity, 1)] {
            if channel == 1 && image["medium"]["emis"] != "power" {
                continue;
            }
            renderer.scene.view = view;
            let pixels = floats(&picture(&mut renderer, PixelFormat::R32F, [32, 32], None, false));
            let (mut sum, mut count, mut peak, mut most) = (0.0_f64, 0, 0.0_f64, 0.0_f64);
            for (pixel, value) in pixels.iter().zip(values.chunks(channels)) {
                assert_eq!(pixel.is_nan(), channel == 0 && value[0] < 0.0, "{name}");
                if !pixel.is_nan() {
                    let error = f64::from(*pixel) - value[channel];
                    (sum, count, peak) = (sum + error * error, count + 1, peak.max(value[channel]));
                    most = most.max(error.abs());
                }
            }
            let rms = (sum / f64::from(count)).sqrt() / peak.max(1e-300);
            println!("{name} {view:?}: rms {rms:.2e}, most {:.2e} of the peak {peak:.4}", most / peak.max(1e-300));
            assert!(rms <= 1e-5, "{name} {view:?}: {rms}");
        }
    }
}
