//! Random scenes at the ends of every range: no NaN where a number is promised, no endless loop, no lost device, on both tracers.

use bhr::image::{ImageMut, PixelFormat, memory::Layout};
use bhr::renderer::{Backend, Renderer, RendererOptions};
use bhr::scene::{Camera, Fate, Hit, Method, Motion, Ray};
use glam::DVec3;

/// Numerical Recipes' 64-bit linear congruential generator: repeatable.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[((self.next() * from.len() as f64) as usize).min(from.len() - 1)]
    }

    fn direction(&mut self) -> DVec3 {
        let z = 2.0 * self.next() - 1.0;
        let (s, c) = (std::f64::consts::TAU * self.next()).sin_cos();
        let rho = (1.0 - z * z).sqrt();
        DVec3::new(rho * c, rho * s, z)
    }
}

fn both() -> [Renderer; 2] {
    let cpu = Renderer::new(RendererOptions { backend: Some(Backend::Cpu), ..Default::default() }).unwrap();
    let gpu = Renderer::new(RendererOptions::default()).unwrap();
    assert_ne!(gpu.adapter().backend, Backend::Cpu, "no GPU adapter (lavapipe counts)");
    [cpu, gpu]
}

const SPINS: [f64; 7] = [0.0, 1e-9, 0.5, 0.998, 0.999, -0.999, -1e-3];
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

#[test]
fn frames_at_the_extremes() {
    let mut random = Random(11);
    let mut renderers = both();
    for scene in 0..60 {
        let (spin, mass) = (random.pick(&SPINS), random.pick(&MASSES));
        let motion = random.pick(&[Motion::Static, Motion::FreeFall, Motion::Velocity]);
        let inside = spin == 0.0 && motion == Motion::FreeFall && random.next() < 0.5;
        let position =
            if inside { random.direction() * random.pick(&[1e-3, 1.0, 2.0]) } else { place(&mut random, spin) };
        let (forward, velocity) = (random.direction(), random.direction() * random.pick(&[0.0, 0.5, 0.999, 0.999999]));
        let fov_y = random.pick(&[1e-6, 0.3, 1.0, 3.0, 3.1]);
        let camera = Camera {
            position: position * mass,
            forward,
            up: forward.any_orthonormal_vector(),
            fov_y,
            motion,
            velocity,
            ..Camera::default()
        };
        for renderer in &mut renderers {
            (renderer.scene.hole.spin, renderer.scene.hole.mass, renderer.scene.camera) = (spin, mass, camera);
            let mut pixels = vec![0; 24 * 16 * 16];
            let layout = Layout::packed(PixelFormat::Rgba32F, 24, 16);
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
