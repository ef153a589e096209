// SPDX-License-Identifier: MIT OR Apache-2.0
//! Stars in whole frames, CPU and GPU: their light against the lens equation, image by image; its steadiness while the
//! camera turns; their places; tiles; and the procedural sky. The GPU is whatever adapter comes first; without one the
//! tests fail.

use crate::frames::{cpu, differing, floats, gpu, new_gpu, picture, tiled};
use crate::random::{Random, runs_all};
use bhr::image::PixelFormat;
use bhr::physics::blackbody::{LUMINANCE, radiance_xyz};
use bhr::renderer::Renderer;
use bhr::scene::{Camera, Effects, Sky};
use bhr::sky::StarIndex;
use bhr::sky::catalogue::{self, Star};
use bhr::sky::galaxy::GALACTIC_POLE;
use bhr::sky::procedural;
use glam::{DQuat, DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

/// Renderers of the sky alone, seen by an observer at rest.
fn both() -> [(&'static str, crate::frames::Lent); 2] {
    crate::frames::both().map(|(name, mut renderer)| {
        renderer.scene.disk = None;
        renderer.scene.sky.flags = Sky::STARS;
        (name, renderer)
    })
}

// ---- the screen ----

/// A perspective camera's pixels.
struct Screen {
    size: [u32; 2],
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    /// Pixels of the image plane at distance 1.
    scale: f64,
}

impl Screen {
    fn new(camera: &Camera, size: [u32; 2]) -> Self {
        let forward = camera.forward.normalize();
        let right = forward.cross(camera.up).normalize();
        let scale = f64::from(size[1]) / (2.0 * (0.5 * camera.fov_y).tan());
        Self { size, right, up: right.cross(forward), forward, scale }
    }

    /// Where a direction is seen; `None` behind.
    fn place(&self, d: DVec3) -> Option<DVec2> {
        let along = d.dot(self.forward);
        let half = DVec2::new(self.size[0].into(), self.size[1].into()) * 0.5;
        (along > 0.0).then(|| half + DVec2::new(d.dot(self.right), -d.dot(self.up)) * (self.scale / along))
    }

    fn direction(&self, place: DVec2) -> DVec3 {
        let half = DVec2::new(self.size[0].into(), self.size[1].into()) * 0.5;
        let p = (place - half) / self.scale;
        (self.forward + self.right * p.x - self.up * p.y).normalize()
    }

    /// The solid angle of the pixel at a place.
    fn solid_angle(&self, place: DVec2) -> f64 {
        self.direction(place).dot(self.forward).powi(3) / (self.scale * self.scale)
    }

    fn holds(&self, place: DVec2, border: f64) -> bool {
        let size = DVec2::new(self.size[0].into(), self.size[1].into());
        place.cmpge(DVec2::splat(border)).all() && place.cmple(size - border).all()
    }
}

/// Luminance x solid angle of every pixel of a frame.
struct Light {
    screen: Screen,
    pixels: Vec<f64>,
}

impl Light {
    fn new(renderer: &mut Renderer, size: [u32; 2]) -> Self {
        let screen = Screen::new(&renderer.scene.camera, size);
        let bytes = picture(renderer, PixelFormat::Rgba32F, size, None, false);
        let values = floats(&bytes);
        let pixels = values.chunks_exact(4).enumerate().map(|(i, pixel)| {
            let luminance = (0..3).map(|c| LUMINANCE[c] * f64::from(pixel[c])).sum::<f64>();
            luminance * screen.solid_angle(centre(i, size))
        });
        let pixels = pixels.collect();
        Self { screen, pixels }
    }

    /// Summed, each pixel weighted by its place.
    fn sum(&self, weight: impl Fn(DVec2) -> f64) -> f64 {
        self.pixels.iter().enumerate().map(|(i, light)| light * weight(centre(i, self.screen.size))).sum()
    }

    /// The light of the pixels within `reach` of a place in x and in y.
    fn near(&self, place: DVec2, reach: i64) -> f64 {
        let [width, height] = self.screen.size.map(i64::from);
        let (x, y) = (place.x.floor() as i64, place.y.floor() as i64);
        let mut sum = 0.0;
        for row in (y - reach).max(0)..=(y + reach).min(height - 1) {
            for column in (x - reach).max(0)..=(x + reach).min(width - 1) {
                sum += self.pixels[(row * width + column) as usize];
            }
        }
        sum
    }
}

/// The centre of pixel `i`.
fn centre(i: usize, size: [u32; 2]) -> DVec2 {
    let width = size[0] as usize;
    DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5)
}

// ---- the lens equation of a hole without spin ----

/// Azimuth that light from infinity runs through about the hole to the observer at r, coming in past the hole at its
/// least distance 1/u_p: phi = int du / sqrt(1/b^2 - u^2 + 2 u^3), 1/b^2 = u_p^2 - 2 u_p^3 (Darwin 1959), from 0 to u_p
/// and from 1/r to u_p; with u = u_p (1 - s^2) the square root's zero is divided out. By Simpson's rule.
fn swept(u_p: f64, r: f64) -> f64 {
    let leg = |from: f64| {
        let end = (1.0 - from / u_p).max(0.0).sqrt();
        let f = |s: f64| {
            let u = u_p * (1.0 - s * s);
            2.0 * u_p.sqrt() / (u_p + u - 2.0 * (u_p * u_p + u_p * u + u * u)).sqrt()
        };
        let n = 2000;
        let h = end / f64::from(n);
        let inner = (1..n).map(|i| if i % 2 == 1 { 4.0 } else { 2.0 } * f(h * f64::from(i))).sum::<f64>();
        (f(0.0) + inner + f(end)) * h / 3.0
    };
    leg(0.0) + leg(1.0 / r)
}

/// Angle from the hole, for a static observer at r, at which light is seen that has swept `phi`.
fn seen_at(phi: f64, r: f64) -> f64 {
    let (mut far, mut near) = (1.0 / r, 1.0 / 3.0 - 1e-15);
    for _ in 0..60 {
        let middle = 0.5 * (far + near);
        if swept(middle, r) < phi { far = middle } else { near = middle }
    }
    let inverse_b2 = far * far * (1.0 - 2.0 * far);
    (((1.0 - 2.0 / r) / inverse_b2).sqrt() / r).min(1.0).asin()
}

/// An image of a star at the angle `beta` from the line observer - hole.
#[derive(Clone, Copy, Debug)]
struct Image {
    /// Angle from the hole, on the star's side or, `opposite`, on the other.
    psi: f64,
    opposite: bool,
    magnification: f64,
}

/// Image 0 is the primary one, 1 the secondary one on the other side of the hole; from 2 on light goes about the hole
/// once and more. Magnification: (sin psi / sin beta) |d psi / d beta|, the quotient of solid angles.
fn image(order: u32, beta: f64, r: f64) -> Image {
    let opposite = order % 2 == 1;
    let phi = |beta: f64| match opposite {
        false => PI * f64::from(order + 1) - beta,
        true => PI * f64::from(order) + beta,
    };
    let psi = |beta: f64| seen_at(phi(beta), r);
    let h = 1e-5;
    let slope = (psi(beta + h) - psi(beta - h)) / (2.0 * h);
    let psi = psi(beta);
    Image { psi, opposite, magnification: psi.sin() / beta.sin() * slope.abs() }
}

#[test]
fn the_lens_equation_has_its_limits() {
    // Far from the hole, light is bent by 4 / b + 15 pi / 4 / b^2 (1 + ..) from infinity to infinity.
    let (b, r): (f64, f64) = (1e4, 1e12);
    let u_p = 1.0 / (b - 1.0 - 1.5 / b);
    let deflection = 4.0 / b + 15.0 * PI / 4.0 / (b * b);
    // The observer is not quite at infinity.
    assert!((swept(u_p, r) - (PI + deflection - b / r)).abs() < 1e-9);
    // Seen from far away: the lens equation of weak fields, beta = theta - theta_E^2 / theta, and its magnification.
    let (r, beta): (f64, f64) = (1e7, 5e-4);
    let theta_e2 = 4.0 / r;
    for order in [0, 1] {
        let sign = if order == 0 { 1.0 } else { -1.0 };
        let theta = 0.5 * (beta * sign + (beta * beta + 4.0 * theta_e2).sqrt());
        let magnification = (1.0 / (1.0 - (theta_e2 / (theta * theta)).powi(2))).abs();
        let found = image(order, beta, r);
        assert!((found.psi / theta - 1.0).abs() < 4e-3, "{found:?}, not {theta}");
        assert!((found.magnification / magnification - 1.0).abs() < 0.02, "{found:?}, not {magnification}");
    }
    // At the photon orbit's distance from an observer's shadow: images of ever higher order come to its edge.
    let shadow = (27.0_f64 * (1.0 - 2.0 / 30.0)).sqrt() / 30.0;
    let orders = [0, 1, 2, 3, 4].map(|order| image(order, 0.3, 30.0).psi);
    assert!(
        orders.windows(2).all(|pair| pair[0] > pair[1]) && (orders[4] / shadow.asin() - 1.0).abs() < 1e-4,
        "{orders:?}"
    );
}

// ---- stars behind a hole ----

/// Where the observer of these tests is, on the x axis, looking at the hole.
const OBSERVER: f64 = 30.0;

fn looking_at_the_hole(fov_y: f64) -> Camera {
    let position = DVec3::X * OBSERVER;
    Camera { position, forward: -position, fov_y, ..Camera::plain() }
}

/// The direction at the angle `psi` from the hole, turned by `turn` about it.
fn around_the_hole(psi: f64, turn: f64) -> DVec3 {
    -DVec3::X * psi.cos() + (DVec3::Y * turn.cos() + DVec3::Z * turn.sin()) * psi.sin()
}

/// A star with its images.
struct Lensed {
    star: Star,
    images: Vec<(Image, DVec3)>,
}

impl Lensed {
    fn new(beta: f64, turn: f64, colour: f64, orders: u32) -> Self {
        let of_order = |order| {
            let image = image(order, beta, OBSERVER);
            (image, around_the_hole(image.psi, if image.opposite { turn + PI } else { turn }))
        };
        let star = Star { direction: around_the_hole(beta, turn), magnitude: 0.0, colour };
        Self { star, images: (0..orders).map(of_order).collect() }
    }

    /// Luminance x solid angle without a lens: what the index has for it.
    fn flux(&self) -> f64 {
        f64::from(StarIndex::new([self.star].into_iter()).unwrap().stars[0][3])
    }

    /// The factor by which the observer's frequency shift, 1 / sqrt(1 - 2 / r), brightens a blackbody of the star's
    /// temperature.
    fn gain(&self) -> f64 {
        let g = 1.0 / (1.0 - 2.0 / OBSERVER).sqrt();
        let temperature = self.star.temperature();
        radiance_xyz(g * temperature)[1] / radiance_xyz(temperature)[1]
    }
}

fn given(stars: &[Lensed]) -> Option<Arc<StarIndex>> {
    Some(Arc::new(StarIndex::new(stars.iter().map(|lensed| lensed.star)).unwrap()))
}

/// Stars at several distances from the line through the hole, those near it in the Einstein ring; turned about it so
/// that their images stay apart.
fn isolated_stars() -> Vec<Lensed> {
    let betas = [0.015, 0.02, 0.03, 0.05, 0.07, 0.1, 0.14, 0.18, 0.22, 0.26, 0.3, 0.34, 0.38];
    betas.iter().zip(0..).map(|(&beta, i)| Lensed::new(beta, 0.4 + 2.399_963 * f64::from(i), 0.2, 2)).collect()
}

/// The images on a screen, without those near to another one or to the frame's edge.
fn isolated_images<'a>(stars: &'a [Lensed], screen: &Screen, apart: f64) -> Vec<(&'a Lensed, Image, DVec3)> {
    let all = || stars.iter().flat_map(|lensed| lensed.images.iter().map(move |(image, d)| (lensed, *image, *d)));
    let places: Vec<Option<DVec2>> = all().map(|(_, _, d)| screen.place(d)).collect();
    let alone = |i: usize| {
        let Some(place) = places[i].filter(|place| screen.holds(*place, apart)) else { return false };
        let others = places.iter().enumerate().filter(|(j, _)| *j != i).filter_map(|(_, other)| *other);
        others.into_iter().all(|other| (other - place).abs().max_element() > apart)
    };
    all().enumerate().filter(|(i, _)| alone(*i)).map(|(_, image)| image).collect()
}

#[test]
fn each_image_has_the_flux_that_the_lens_equation_gives() {
    let size = [1280, 720];
    let stars = isolated_stars();
    for (name, mut renderer) in both() {
        renderer.scene.camera = looking_at_the_hole(1.0);
        renderer.scene.given_stars = given(&stars);
        for effects in [Effects(0), Effects(Effects::ALL)] {
            renderer.scene.effects = effects;
            let light = Light::new(&mut renderer, size);
            let images = isolated_images(&stars, &light.screen, 16.0);
            let secondary = images.iter().filter(|(_, image, _)| image.opposite).count();
            assert!(secondary >= 8 && images.len() - secondary >= 8, "{secondary} of {}", images.len());
            for (lensed, image, d) in images {
                let gain = if effects == Effects(Effects::ALL) { lensed.gain() } else { 1.0 };
                let expected = lensed.flux() * image.magnification * gain;
                let found = light.near(light.screen.place(d).unwrap(), 7);
                println!("{name} {effects:?} {image:?}: {}", found / expected);
                assert!((found / expected - 1.0).abs() < 0.01, "{name} {effects:?} {image:?}: {}", found / expected);
            }
        }
    }
}

/// Light that has gone once about the hole, by cameras that look at a piece of the shadow's edge.
#[test]
fn higher_images_have_the_flux_that_the_lens_equation_gives() {
    let size = [300, 200];
    let stars = [Lensed::new(0.3, 1.0, 0.2, 4)];
    for (name, mut renderer) in both() {
        renderer.scene.given_stars = given(&stars);
        for (image, d) in &stars[0].images[2..] {
            renderer.scene.camera =
                Camera { forward: *d, ..looking_at_the_hole(2e-2 * f64::from(size[1]) * image.magnification) };
            let light = Light::new(&mut renderer, size);
            let found = light.near(light.screen.place(*d).unwrap(), 20);
            let expected = stars[0].flux() * image.magnification * stars[0].gain();
            println!("{name} {image:?}: {}", found / expected);
            // An f32 knows directions to some hundredths of such small pixels.
            let tolerance = if name == "cpu" { 0.01 } else { 0.03 };
            assert!((found / expected - 1.0).abs() < tolerance, "{name} {image:?}: {}", found / expected);
        }
    }
}

/// All images of a kind together: primary ones are outside the Einstein ring, secondary ones (with what is left to
/// higher orders) inside.
#[test]
fn a_field_has_the_flux_that_the_lens_equation_gives() {
    let size = if runs_all() { [900, 900] } else { [600, 600] };
    let mut random = Random(11);
    let ring = seen_at(PI, OBSERVER);
    let mut stars = Vec::new();
    for _ in 0..150 {
        // Evenly over the sky from 0.03 to 0.3 rad.
        let beta = random.range(0.03_f64.cos(), 0.3_f64.cos()).acos();
        stars.push(Lensed::new(beta, random.range(0.0, TAU), random.range(-0.2, 1.5), 4));
    }
    for (name, mut renderer) in both() {
        renderer.scene.camera = looking_at_the_hole(1.25);
        renderer.scene.given_stars = given(&stars);
        let light = Light::new(&mut renderer, size);
        for inside in [false, true] {
            let images = stars.iter().flat_map(|lensed| lensed.images.iter().map(move |(image, d)| (lensed, image, d)));
            let images = images.filter(|(_, image, _)| (image.psi < ring) == inside);
            let expected: f64 = images
                .map(|(lensed, image, d)| {
                    assert!(light.screen.place(*d).is_some_and(|place| light.screen.holds(place, 4.0)));
                    lensed.flux() * image.magnification * lensed.gain()
                })
                .sum();
            let region = |place| f64::from((light.screen.direction(place).angle_between(-DVec3::X) < ring) == inside);
            let found = light.sum(region);
            println!("{name}, inside {inside}: {}", found / expected);
            assert!((found / expected - 1.0).abs() < 0.01, "{name}, inside {inside}: {}", found / expected);
        }
    }
}

// ---- steadiness ----

/// Frames of the CPU and of the GPU that the camera turns for, through a pixel and through four; the pictures are the
/// same (tests/tracers/pictures.rs). Everyday through half a pixel and through one and a half.
fn turns() -> [usize; 2] {
    if runs_all() { [17, 64] } else { [9, 24] }
}

/// Calls `see` with the light of each of `frames`, the camera turning by a sixteenth of a pixel from one to the next.
fn turning(renderer: &mut Renderer, size: [u32; 2], frames: usize, mut see: impl FnMut(&Light)) {
    let still = renderer.scene.camera;
    let step = 1.0 / (16.0 * Screen::new(&still, size).scale);
    // Neither along rows nor along columns.
    let axis = (Screen::new(&still, size).up + Screen::new(&still, size).right * 0.6).normalize();
    for frame in 0..frames {
        let turn = DQuat::from_axis_angle(axis, step * frame as f64);
        renderer.scene.camera = Camera { forward: turn * still.forward, up: turn * still.up, ..still };
        see(&Light::new(renderer, size));
    }
    renderer.scene.camera = still;
}

/// Largest change from one to the next, relative to the smaller one.
fn largest_change(values: &[f64]) -> f64 {
    values.windows(2).map(|pair| (pair[1] - pair[0]).abs() / pair[0].min(pair[1])).fold(0.0, f64::max)
}

#[test]
fn each_star_is_steady_while_the_camera_turns() {
    let size = [640, 360];
    let mut stars = isolated_stars();
    // And some far from the hole, where the lens does little.
    stars.extend([(0.5, 0.3), (0.55, 2.9), (0.6, 3.4), (0.7, 6.1)].map(|(beta, turn)| Lensed::new(beta, turn, 0.2, 1)));
    for ((name, mut renderer), frames) in both().into_iter().zip(turns()) {
        renderer.scene.camera = looking_at_the_hole(1.0);
        renderer.scene.given_stars = given(&stars);
        let images = isolated_images(&stars, &Screen::new(&renderer.scene.camera, size), 13.0);
        assert!(images.len() > 16, "{} images", images.len());
        let mut sums = vec![Vec::new(); images.len()];
        turning(&mut renderer, size, frames, |light| {
            for (sums, (_, _, d)) in sums.iter_mut().zip(&images) {
                sums.push(light.near(light.screen.place(*d).unwrap(), 4));
            }
        });
        for (sums, (_, image, _)) in sums.iter().zip(&images) {
            assert_eq!(sums.len(), frames);
            let change = largest_change(sums);
            println!("{name} {image:?}: {change}");
            assert!(change < 0.02, "{name} {image:?}: {change}");
        }
    }
}

/// Windows with soft edges that stay in their places of the sky, in the catalogue's and in a procedural sky: at the
/// edge of the shadow, where the lens squeezes the sky and stars fade into their mean light; at the Einstein ring; far
/// from the hole.
#[test]
#[ignore = "in tests/run all; everyday: each star is steady while the camera turns"]
fn nothing_sparkles_while_the_camera_turns() {
    let size = [640, 360];
    let windows = [(0.17, 1.0), (0.2, 3.0), (0.36, 0.1), (0.36, 4.0), (0.7, 0.2), (0.75, 3.0)];
    let windows = windows.map(|(psi, turn)| around_the_hole(psi, turn));
    for flags in [Sky::STARS, Sky::PROCEDURAL] {
        for ((name, mut renderer), frames) in both().into_iter().zip(turns()) {
            renderer.scene.sky.flags = flags;
            renderer.scene.camera = looking_at_the_hole(1.0);
            let mut sums = windows.map(|_| Vec::new());
            turning(&mut renderer, size, frames, |light| {
                let mut frame = windows.map(|_| 0.0);
                for (i, pixel) in light.pixels.iter().enumerate() {
                    let d = light.screen.direction(centre(i, size));
                    for (sum, window) in frame.iter_mut().zip(windows) {
                        // 1 in the middle, 0 from 0.12 rad on.
                        let weight = (1.0 - (d - window).length_squared() / 0.0144).max(0.0);
                        *sum += pixel * weight * weight;
                    }
                }
                sums.iter_mut().zip(frame).for_each(|(sums, sum)| sums.push(sum));
            });
            for (sums, window) in sums.iter().zip(windows) {
                let change = largest_change(sums);
                println!("{name}, flags {flags}, at {window}: {change}");
                assert!(change < 0.02 && sums[0] > 0.0, "{name}, flags {flags}, at {window}: {change}");
            }
        }
    }
}

// ---- places ----

#[test]
fn orientation_puts_sirius_where_it_says() {
    let sirius = catalogue::stars().next().unwrap();
    assert_eq!(sirius.magnitude, -1.44);
    let size = [320, 180];
    let mut random = Random(5);
    for (name, mut renderer) in both() {
        for _ in 0..4 {
            let axis = random.direction();
            let orientation = DQuat::from_axis_angle(axis, random.range(0.0, TAU));
            let seen = orientation * sirius.direction;
            // Far away, the hole behind the camera, the star beside the middle.
            let side = seen.any_orthonormal_vector();
            let forward =
                (seen + side * random.range(-0.15, 0.15) + seen.cross(side) * random.range(-0.15, 0.15)).normalize();
            let up = random.direction();
            renderer.scene.camera = Camera { position: seen * 1e5, forward, up, fov_y: 0.6, ..Camera::plain() };
            renderer.scene.sky.orientation = orientation;
            let light = Light::new(&mut renderer, size);
            let place = light.screen.place(seen).unwrap();
            let brightest = light.pixels.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).unwrap();
            let found = centre(brightest.0, size);
            assert!((found - place).abs().max_element() <= 0.52, "{name}: Sirius at {found}, not {place}");
            let flux = f64::from(StarIndex::new([sirius].into_iter()).unwrap().stars[0][3]);
            // Fainter stars stand near it.
            let sum = light.near(place, 2);
            assert!((0.999..1.02).contains(&(sum / flux)), "{name}: {}", sum / flux);
        }
    }
}

/// Stars so dense that every tile's border cuts some.
#[test]
fn no_star_is_cut_at_the_borders_of_tiles() {
    let size = [320, 200];
    let mut random = Random(3);
    let stars = (0..40_000).map(|_| Star { direction: random.direction(), magnitude: 2.0, colour: 0.3 });
    let stars = Some(Arc::new(StarIndex::new(stars).unwrap()));
    // The borders of `tiled`.
    let (columns, rows) = ([7, 40], [1, 30]);
    for (name, mut renderer) in both() {
        renderer.scene.given_stars = stars.clone();
        let whole = picture(&mut renderer, PixelFormat::Rgba8Srgb, size, None, false);
        let lit = |x: u32, y: u32| whole[(y * size[0] + x) as usize * 4] > 100;
        assert!(columns.iter().all(|&x| (0..size[1]).any(|y| lit(x - 1, y) && lit(x, y))), "{name}: no star is cut");
        assert!(rows.iter().all(|&y| (0..size[0]).any(|x| lit(x, y - 1) && lit(x, y))), "{name}: no star is cut");
        assert!(tiled(&mut renderer, PixelFormat::Rgba8Srgb, size) == whole, "{name}: tiles differ from the frame");
    }
}

// ---- the procedural sky ----

#[test]
#[ignore = "in tests/run all; everyday: both tracers draw the same procedural sky"]
fn a_seed_gives_the_same_bytes_in_every_context_and_order() {
    let size = if runs_all() { [320, 180] } else { [160, 90] };
    // Everyday two of them, in contexts of one tracer each.
    let seeds = [1, u64::MAX, 2];
    let seeds = if runs_all() { &seeds[..] } else { &seeds[..2] };
    for make in [cpu, gpu] {
        let show = |renderer: &mut Renderer, flags: u32, seed: u64| {
            (renderer.scene.sky.flags, renderer.scene.sky.seed) = (flags, seed);
            picture(renderer, PixelFormat::Rgba8Srgb, size, None, false)
        };
        let (mut first, mut second) = (make(), make());
        let there = seeds.iter().map(|seed| show(&mut first, Sky::PROCEDURAL, *seed)).collect::<Vec<_>>();
        let real = show(&mut first, Sky::STARS, 1);
        let both = show(&mut first, Sky::STARS | Sky::PROCEDURAL, 1);
        assert!(both == show(&mut second, Sky::STARS | Sky::PROCEDURAL, 1));
        assert!(real == show(&mut second, Sky::STARS, 7), "the real sky has no seed");
        for (seed, there) in seeds.iter().zip(&there).rev() {
            assert!(*there == show(&mut second, Sky::PROCEDURAL, *seed), "seed {seed}");
        }
        let all = there.iter().chain([&real, &both]).collect::<Vec<_>>();
        for (i, one) in all.iter().enumerate() {
            assert!(all[..i].iter().all(|other| other != one), "picture {i} is another one's");
        }
    }
}

#[test]
fn procedural_pictures_agree() {
    for (spin, flags, seed) in [(0.0, Sky::PROCEDURAL, 3), (0.9, Sky::STARS | Sky::PROCEDURAL, 4)] {
        let [cpu, gpu] = both().map(|(_, mut renderer)| {
            (renderer.scene.hole.spin, renderer.scene.sky.flags, renderer.scene.sky.seed) = (spin, flags, seed);
            picture(&mut renderer, PixelFormat::Rgba8Srgb, [640, 360], None, false)
        });
        let wrong = differing(&cpu, &gpu);
        assert!(wrong * 1000 <= cpu.len() / 4, "spin {spin}: {wrong} of {} pixels", cpu.len() / 4);
    }
}

/// Over the whole sky, at every size of pixels: stars, and stars that have faded into their mean. And they crowd
/// towards the Milky Way.
#[test]
fn procedural_light_is_that_of_all_its_stars() {
    let mut renderer = cpu();
    renderer.scene.disk = None;
    (renderer.scene.sky.flags, renderer.scene.sky.seed) = (Sky::PROCEDURAL, 6);
    let expected = StarIndex::new(procedural::stars(6).unwrap())
        .unwrap()
        .stars
        .iter()
        .step_by(2)
        .map(|star| f64::from(star[3]))
        .sum::<f64>();
    // A sixth of the sky, the hole behind the camera and, 1e6 M away, far smaller than a pixel.
    let mut side = |forward: DVec3, up: DVec3, size: u32| {
        renderer.scene.camera = Camera { position: forward * 1e6, forward, up, fov_y: FRAC_PI_2, ..Camera::plain() };
        Light::new(&mut renderer, [size, size]).pixels.iter().sum::<f64>()
    };
    let plane = GALACTIC_POLE.any_orthonormal_vector();
    let axes = [(plane, GALACTIC_POLE), (GALACTIC_POLE, plane), (GALACTIC_POLE.cross(plane), GALACTIC_POLE)];
    // Everyday without the finest pixels.
    for (size, tolerance) in [(24, 1e-2), (150, 1e-2), (500, 3e-3)].into_iter().take(if runs_all() { 3 } else { 2 }) {
        let sides = axes.iter().flat_map(|&(axis, up)| [(axis, up), (-axis, up)]);
        let sum = sides.map(|(axis, up)| side(axis, up, size)).sum::<f64>();
        println!("{size} pixels a side: {}", sum / expected);
        assert!((sum / expected - 1.0).abs() < tolerance, "{size} pixels a side: {}", sum / expected);
    }
    assert!(side(plane, GALACTIC_POLE, 24) > 1.7 * side(GALACTIC_POLE, plane, 24));
}

#[test]
#[ignore = "in tests/run all; everyday: large frames in tests/c"]
fn a_4k_frame_of_a_procedural_sky_stays_within_its_memory() {
    let mut renderer = new_gpu();
    renderer.scene.sky.flags = Sky::STARS | Sky::PROCEDURAL;
    picture(&mut renderer, PixelFormat::Rgba8Srgb, [3840, 2160], None, false);
    let bytes = renderer.stats().device_bytes;
    assert!(bytes < 400 << 20, "{bytes} bytes");
    renderer.scene.sky.flags = Sky::STARS;
    picture(&mut renderer, PixelFormat::Rgba8Srgb, [3840, 2160], None, false);
    let without = renderer.stats().device_bytes;
    println!("{bytes} bytes, {without} without procedural stars");
    assert!(bytes - without > 50 << 20 && bytes - without < 115 << 20, "{} bytes of stars", bytes - without);
}
