//! The lens tables against integration: records of random eyes, their footprints, and scan lines without a seam, on
//! both tracers. Truth is `physics::trace` in f64 with small steps; it knows nothing of tables. Where a tracer
//! integrates every ray itself, it is held to the same bars. The GPU is whatever adapter comes first; without one the
//! tests fail.

use crate::frames::Lent;
use crate::random::{Random, count_from};
use bhr::physics::geodesic::wrap_angle;
use bhr::physics::observer::Observer;
use bhr::physics::orbit::{horizon_outer, photon_orbit, redshift};
use bhr::physics::shadow::CRITICAL_IMPACT_PARAMETER;
use bhr::physics::trace::{Fate, PlaneCrossing, Settings, trace_look};
use bhr::scene::observer::Lens;
use bhr::scene::record::Record;
use bhr::scene::{Camera, LensTables, Motion, Region, Scene};
use glam::{DMat3, DVec3};
use rayon::prelude::*;
use std::f64::consts::PI;

/// A pixel of a 3840 x 2160 frame, 60 degrees high, rad.
const PIXEL_4K: f64 = PI / 3.0 / 2160.0;
/// Step of the true rays in sigma: errors of 1e-10, divided by (1 + conditioning).
const TRUE_STEP: f64 = 0.05;

const TRACERS: [&str; 2] = ["cpu", "gpu"];
const GPU: usize = 1;

fn both() -> [Lent; 2] {
    crate::frames::both().map(|(_, renderer)| renderer)
}

/// The true image in a look direction.
#[derive(Clone)]
struct Sight {
    fate: Fate,
    direction: DVec3,
    sky_redshift: f64,
    /// |b / b_c - 1|; NaN with spin.
    from_critical: f64,
    /// Crossings of the plane at any radius, of the disk's orders only.
    crossings: Vec<(PlaneCrossing, f64)>,
}

/// A look direction, what it sees, and how well that is conditioned.
type TrueRay = (DVec3, Sight, Conditioning);

/// The true lens of a scene's camera.
struct Truth<'a> {
    scene: &'a Scene,
    lens: Lens,
    settings: Settings,
    disk_u: [f64; 2],
}

impl<'a> Truth<'a> {
    fn new(scene: &'a Scene, width: u32, height: u32) -> Self {
        let region = Region { full_width: width, full_height: height, x: 0, y: 0 };
        let settings = Settings {
            step: TRUE_STEP,
            max_crossings: scene.quality.max_disk_order as usize + 1,
            delay: scene.emitters().needs().delays,
            ..Settings::exact(scene.hole.spin)
        };
        Self { scene, lens: scene.lens(&region).unwrap(), settings, disk_u: scene.emitters().disk_u().unwrap() }
    }

    /// Through the centre of pixel `index`, counted row by row.
    fn look(&self, index: usize) -> DVec3 {
        let width = self.lens.mapping.width as usize;
        self.lens.look((index % width) as f64 + 0.5, (index / width) as f64 + 0.5)
    }

    fn sight(&self, look: DVec3) -> Sight {
        let observer = &self.lens.observer;
        let (n, ratio) = observer.look(look);
        let (constants, traced) = trace_look(&observer.frame, n, &self.settings);
        let Some(c) = constants else {
            return Sight {
                fate: Fate::Captured,
                direction: DVec3::ZERO,
                sky_redshift: f64::NAN,
                from_critical: f64::INFINITY,
                crossings: Vec::new(),
            };
        };
        let retrograde = self.scene.retrograde();
        let g = |u: f64| ratio * redshift(c.a, u, retrograde, c.energy, c.angular_momentum, c.nu_local);
        let spin_zero = c.a == 0.0;
        Sight {
            fate: traced.fate,
            direction: traced.direction,
            sky_redshift: if traced.fate == Fate::Escaped { ratio * c.nu_local / c.energy } else { f64::NAN },
            from_critical: if spin_zero {
                (c.k.max(0.0).sqrt() / (c.energy * CRITICAL_IMPACT_PARAMETER) - 1.0).abs()
            } else {
                f64::NAN
            },
            crossings: traced.crossings.iter().map(|x| (*x, g(x.u))).collect(),
        }
    }

    /// The true rays of all pixels.
    fn rays(&self) -> Vec<TrueRay> {
        let pixels = self.lens.mapping.width as usize * self.lens.mapping.height as usize;
        let ray = |i| {
            let look = self.look(i);
            let here = self.sight(look);
            let conditioning = self.conditioning(look, &here);
            (look, here, conditioning)
        };
        (0..pixels).into_par_iter().map(ray).collect()
    }

    fn within_disk(&self, u: f64) -> bool {
        u >= self.disk_u[0] && u <= self.disk_u[1]
    }

    /// Within a factor of two of the disk's radii.
    fn near_disk(&self, u: f64) -> bool {
        u >= 0.5 * self.disk_u[0] && u <= 2.0 * self.disk_u[1]
    }

    /// Whether a crossing lies so near to an edge of the disk that rounding decides on which side.
    fn at_an_edge(&self, u: f64, conditioning: f64) -> bool {
        self.disk_u.iter().any(|edge| (u / edge - 1.0).abs() < 1e-5 * (1.0 + conditioning))
    }

    /// Whether rays `angle` away have another fate than `fate`.
    fn near_another_fate(&self, look: DVec3, fate: Fate, angle: f64) -> bool {
        let (right, up) = around(look);
        (0..8).any(|i| {
            let (s, c) = (PI / 4.0 * f64::from(i)).sin_cos();
            self.sight((look + (right * c + up * s) * angle).normalize()).fate != fate
        })
    }

    /// How strongly what `here` sees changes with the look direction: differences over an angle so small that they are
    /// linear.
    fn conditioning(&self, look: DVec3, here: &Sight) -> Conditioning {
        let (right, up) = around(look);
        for h in [1e-6, 1e-7, 1e-8, 1e-9, 1e-10] {
            let beside = [right, up].map(|d| self.sight((look + d * h).normalize()));
            let found = Conditioning::new(here, &beside, h, |u| self.near_disk(u));
            if found.sky.max(found.ln_r.iter().copied().fold(0.0, f64::max)) * h < 0.02 {
                return found;
            }
        }
        Conditioning {
            sky: f64::INFINITY,
            sky_redshift: f64::INFINITY,
            ln_r: vec![f64::INFINITY; here.crossings.len()],
        }
    }
}

/// Two unit vectors orthogonal to a look direction and to each other.
fn around(look: DVec3) -> (DVec3, DVec3) {
    let right = look.any_orthonormal_vector();
    (right, look.cross(right))
}

/// |d . / d look|, per rad.
struct Conditioning {
    /// Stretch of the lens.
    sky: f64,
    /// Conditioning of the logarithm of the redshift.
    sky_redshift: f64,
    /// For each crossing; 0 far from the disk.
    ln_r: Vec<f64>,
}

impl Conditioning {
    fn new(here: &Sight, beside: &[Sight; 2], h: f64, matters: impl Fn(f64) -> bool) -> Self {
        let largest = |f: &dyn Fn(&Sight) -> f64| beside.iter().map(f).fold(0.0, f64::max) / h;
        let same = |there: &Sight| there.fate == here.fate;
        Self {
            sky: largest(&|s| if same(s) { (s.direction - here.direction).length() } else { f64::INFINITY }),
            sky_redshift: largest(&|s| (s.sky_redshift / here.sky_redshift).ln().abs()),
            ln_r: here
                .crossings
                .iter()
                .enumerate()
                .map(|(k, (x, _))| {
                    let change = |s: &Sight| s.crossings.get(k).map_or(f64::INFINITY, |(y, _)| (y.u / x.u).ln().abs());
                    if matters(x.u) { largest(&change) } else { 0.0 }
                })
                .collect(),
        }
    }
}

/// A share of the errors, and what they stay below.
type Bar = (f64, f64);

/// Errors of one quantity, each with its scene and ray.
#[derive(Default)]
struct Errors(Vec<(f64, usize, usize)>);

impl Errors {
    fn add(&mut self, error: f64, scene: usize, ray: usize) {
        self.0.push((if error.is_nan() { f64::INFINITY } else { error }, scene, ray));
    }

    fn merge(&mut self, other: Self) {
        self.0.extend(other.0);
    }

    /// The value that the share `share` stays below, once sorted.
    fn at(&self, share: f64) -> (f64, usize, usize) {
        self.0[((self.0.len() as f64 * share) as usize).min(self.0.len() - 1)]
    }

    /// Prints the quantiles; complaints where the errors at the given shares exceed their bars.
    fn judge(mut self, what: &str, bars: &[Bar]) -> Vec<String> {
        if self.0.is_empty() {
            return vec![format!("{what}: nothing was compared")];
        }
        self.0.sort_by(|a, b| a.0.total_cmp(&b.0));
        let [p50, p99, p999, p9999, max] = [0.5, 0.99, 0.999, 0.9999, 1.0].map(|share| self.at(share).0);
        let (_, scene, ray) = self.at(1.0);
        println!(
            "{what}: n {} 50 % {p50:.1e} 99 % {p99:.1e} 99.9 % {p999:.1e} 99.99 % {p9999:.1e} max {max:.1e} \
             (scene {scene} ray {ray})",
            self.0.len()
        );
        let failed = bars.iter().filter(|(share, bar)| self.at(*share).0 > *bar);
        failed
            .map(|(share, bar)| {
                let (error, scene, ray) = self.at(*share);
                format!("{what}: {:.2} % at {error:.3e} > {bar:.1e} (scene {scene} ray {ray})", 100.0 * share)
            })
            .collect()
    }
}

/// A random eye: r to 1000 M, one in three falling (to the horizon, and inside it without spin), one in three without
/// spin.
fn random_eye(random: &mut Random, index: usize) -> Scene {
    let mut scene = Scene::default();
    let any_spin = random.range(-0.998, 0.998);
    let end = random.pick(&[-0.998, 0.998]);
    scene.hole.spin = if index.is_multiple_of(3) { 0.0 } else { random.pick(&[any_spin, any_spin, any_spin, end]) };
    let spin = scene.hole.spin;
    let motion = match index / 3 % 3 {
        0 => Motion::FreeFall,
        _ => random.pick(&[Motion::Static, Motion::Static, Motion::Velocity, Motion::Orbit]),
    };
    let nearest = match motion {
        Motion::FreeFall if spin == 0.0 => 1.0,
        Motion::FreeFall => horizon_outer(spin) + 0.05,
        Motion::Orbit => photon_orbit(spin).max(2.1) * 1.02,
        _ => 2.1,
    };
    let r = random.log_range(nearest, 1000.0);
    let inclination = random.range(0.0, PI);
    let (s, c) = match random.pick(&[0, 1, 2, 3, 3, 3, 3, 3, 3, 3, 3, 3]) {
        _ if motion == Motion::Orbit && spin != 0.0 => (1.0, 0.0),
        0 => (0.0, 1.0),
        1 => (0.0, -1.0),
        2 => (1.0, 0.0),
        _ => inclination.sin_cos(),
    };
    let (sin_phi, cos_phi) = random.range(-PI, PI).sin_cos();
    let disk = scene.disk.as_mut().unwrap();
    (disk.outer_radius, disk.opacity) = (50.0, 0.5);
    disk.retrograde = random.next() < 0.5;
    disk.turbulence = random.pick(&[0.0, 1.0]);
    let forward = random.direction();
    scene.camera = Camera {
        position: DVec3::new(s * cos_phi, s * sin_phi, c) * r,
        motion,
        velocity: random.direction() * random.range(0.0, 0.9),
        ..looking(forward, random, 1.0)
    };
    scene.quality.lens_tables = LensTables::Always;
    scene
}

/// A camera that looks along `forward`, turned about it by chance.
fn looking(forward: DVec3, random: &mut Random, fov_y: f64) -> Camera {
    let (right, up) = around(forward);
    let (s, c) = random.range(-PI, PI).sin_cos();
    Camera { forward, up: right * s + up * c, fov_y, ..Camera::default() }
}

/// Turns the scene's camera to `forward` (chart).
fn turn(scene: &mut Scene, forward: DVec3, random: &mut Random, fov_y: f64) {
    let Camera { position, motion, velocity, .. } = scene.camera;
    scene.camera = Camera { position, motion, velocity, ..looking(forward, random, fov_y) };
}

/// A random direction (chart) on the shadow's edge as the scene's camera sees it; `None` where looking at the hole
/// captures no ray.
fn shadow_edge(scene: &Scene, random: &mut Random) -> Option<DVec3> {
    let truth = Truth::new(scene, 1, 1);
    let observer = truth.lens.observer;
    let mut dark = Observer::moving(observer.frame, -observer.beta).look(DVec3::NEG_X).0;
    let escapes = |n: DVec3| truth.sight(n).fate == Fate::Escaped;
    if escapes(dark) {
        return None;
    }
    let mut light = (0..100).map(|_| random.direction()).find(|n| escapes(*n))?;
    for _ in 0..40 {
        let middle = (dark + light).normalize();
        if escapes(middle) { light = middle } else { dark = middle }
    }
    Some(observer.frame.vector(light))
}

/// Points the camera: in half of the frames at the shadow's edge, closely; else at the hole and its surroundings, or
/// anywhere, with fields of 1 to 170 degrees.
fn aim(scene: &mut Scene, random: &mut Random) {
    let edge = shadow_edge(scene, random);
    let (wide, narrow) = (random.range(1.0, 170.0).to_radians(), random.log_range(1e-4, 0.1));
    // The disk is 50 M wide.
    let disk = (100.0 / scene.camera.position.length() * random.log_range(0.1, 1.0)).clamp(1.0_f64.to_radians(), 2.9);
    let anywhere = random.direction();
    let (forward, fov_y) = match (random.pick(&[0, 0, 1, 2]), edge) {
        (0, Some(edge)) => (edge, narrow),
        (1, Some(edge)) => (edge, disk),
        _ => (anywhere, wide),
    };
    turn(scene, forward, random, fov_y);
}

/// Comparisons of one tracer with and without spin.
#[derive(Default)]
struct Comparison {
    sky: Errors,
    sky_redshift: Errors,
    radius: Errors,
    g: Errors,
    azimuth: Errors,
    wrong: Vec<String>,
    rays: usize,
    integrated: usize,
    excluded: usize,
}

impl Comparison {
    fn merge(&mut self, other: Self) {
        self.sky.merge(other.sky);
        self.sky_redshift.merge(other.sky_redshift);
        self.radius.merge(other.radius);
        self.g.merge(other.g);
        self.azimuth.merge(other.azimuth);
        self.wrong.extend(other.wrong);
        self.rays += other.rays;
        self.integrated += other.integrated;
        self.excluded += other.excluded;
    }

    fn judge(self, what: &str) -> Vec<String> {
        let Self { rays, integrated, excluded, .. } = self;
        println!("{what}: {rays} rays, {integrated} integrated, {excluded} at the critical curve");
        let mut failures = self.wrong;
        failures.truncate(20);
        let bars: [(&str, Errors, &[Bar]); 5] = [
            ("sky direction, 4K pixels", self.sky, &[(0.9999, 0.01), (1.0, 0.1)]),
            ("sky redshift", self.sky_redshift, &[(1.0, 1e-5)]),
            ("crossing radius", self.radius, &[(0.999, 1e-5)]),
            ("crossing g", self.g, &[(0.999, 1e-5)]),
            ("crossing azimuth", self.azimuth, &[(0.999, 1e-4)]),
        ];
        failures
            .extend(bars.into_iter().flat_map(|(name, errors, bars)| errors.judge(&format!("{what}: {name}"), bars)));
        failures
    }
}

/// Records of one frame beside the truth, ray by ray.
struct Frame<'a> {
    truth: &'a Truth<'a>,
    scene_index: usize,
    /// Whether directions were rounded to f32.
    single: bool,
}

impl Frame<'_> {
    /// Whether rounding alone may decide what becomes of the ray: |b / b_c - 1| < 1e-6 (1e-5 where it is integrated at
    /// the step of pixels), or, in f32, a look direction less than three roundings from the edge; with spin 2e-6 of
    /// the look direction.
    fn at_critical(&self, look: DVec3, here: &Sight, record: &Record) -> bool {
        if here.from_critical < if record.steps > 0 { 1e-5 } else { 1e-6 } {
            return true;
        }
        let spin_zero = self.truth.scene.hole.spin == 0.0;
        let angle = if spin_zero { 2e-7 } else { 2e-6 };
        (self.single || !spin_zero) && self.truth.near_another_fate(look, here.fate, angle)
    }

    fn compare(
        &self,
        ray: usize,
        look: DVec3,
        here: &Sight,
        conditioning: &Conditioning,
        record: &Record,
    ) -> Comparison {
        let mut found = Comparison { rays: 1, integrated: usize::from(record.steps > 0), ..Default::default() };
        let index = self.scene_index;
        let sky = (record.direction - here.direction).length() / conditioning.sky.max(1.0) / PIXEL_4K;
        if (record.fate != here.fate || sky.is_nan() || sky > 0.01) && self.at_critical(look, here, record) {
            found.excluded = 1;
            return found;
        }
        if record.fate != here.fate {
            found.wrong.push(format!(
                "scene {index} ray {ray}: {:?}, truly {:?}, |b/b_c - 1| {:.1e}, steps {}",
                record.fate, here.fate, here.from_critical, record.steps
            ));
            return found;
        }
        if here.fate == Fate::Escaped {
            found.sky.add(sky, index, ray);
            let error = (record.sky_redshift / here.sky_redshift - 1.0).abs();
            found.sky_redshift.add(error / (1.0 + conditioning.sky_redshift), index, ray);
        }
        self.compare_crossings(ray, here, conditioning, record, &mut found);
        found
    }

    fn compare_crossings(&self, ray: usize, here: &Sight, c: &Conditioning, record: &Record, found: &mut Comparison) {
        let index = self.scene_index;
        let listed = |order: u32| record.crossings.iter().find(|x| x.order == order);
        for ((crossing, g), conditioning) in here.crossings.iter().zip(&c.ln_r) {
            let share = 1.0 / (1.0 + conditioning);
            let Some(x) = listed(crossing.order).filter(|_| self.truth.within_disk(crossing.u)) else {
                let expected = self.truth.within_disk(crossing.u);
                if expected != listed(crossing.order).is_some() && !self.truth.at_an_edge(crossing.u, *conditioning) {
                    found.wrong.push(format!(
                        "scene {index} ray {ray}: crossing {} at r = {} listed: {}, conditioning {conditioning:.1e}",
                        crossing.order,
                        1.0 / crossing.u,
                        !expected
                    ));
                }
                continue;
            };
            found.radius.add((x.u / crossing.u - 1.0).abs() * share, index, ray);
            found.g.add((x.g / g - 1.0).abs() * share, index, ray);
            if self.truth.scene.emitters().needs().places {
                found.azimuth.add(wrap_angle(x.place.azimuth - crossing.azimuth).abs() * share, index, ray);
            }
        }
        for x in record.crossings.iter().filter(|x| here.crossings.iter().all(|(y, _)| y.order != x.order)) {
            found.wrong.push(format!("scene {index} ray {ray}: no crossing {} at r = {}", x.order, 1.0 / x.u));
        }
    }
}

fn fail_if_any(failures: Vec<String>) {
    assert!(failures.is_empty(), "{} failures:\n{}", failures.len(), failures.join("\n"));
}

/// BHR_LENS_OBSERVERS eyes of 1000 rays; half of the frames look at the shadow's edge, with pixels down to 2.5e-6 rad.
#[test]
fn records_agree_with_integration() {
    let (width, height) = (40, 25);
    let mut renderers = both();
    let mut random = Random(23);
    let mut found: [[Comparison; 2]; 2] = Default::default();
    for index in 0..count_from("BHR_LENS_OBSERVERS", 20, 1000) {
        let mut scene = random_eye(&mut random, index);
        aim(&mut scene, &mut random);
        let truth = Truth::new(&scene, width, height);
        let rays = truth.rays();
        for (tracer, renderer) in renderers.iter_mut().enumerate() {
            renderer.scene = scene.clone();
            let records = renderer.ray_records(width, height).unwrap();
            let frame = Frame { truth: &truth, scene_index: index, single: tracer == GPU };
            let mut of_frame = Comparison::default();
            for (i, ((look, here, conditioning), record)) in rays.iter().zip(&records).enumerate() {
                of_frame.merge(frame.compare(i, *look, here, conditioning, record));
            }
            if !of_frame.wrong.is_empty() {
                let name = TRACERS[tracer];
                of_frame.wrong.push(format!("on {name}: spin {}, {:?}", scene.hole.spin, scene.camera));
            }
            found[tracer][usize::from(scene.hole.spin != 0.0)].merge(of_frame);
        }
    }
    let mut failures = Vec::new();
    for (tracer, kinds) in TRACERS.iter().zip(found) {
        for (kind, comparison) in ["spin 0", "spin"].iter().zip(kinds) {
            failures.extend(comparison.judge(&format!("{tracer}, {kind}")));
        }
    }
    fail_if_any(failures);
}

/// Changes to the next pixel against true differences over 1e-3 pixel. Tables know the derivative; a tracer that
/// integrates takes the difference to its neighbours: it is held to fine pixels, of less than 1 / 150 of the shadow's
/// angle, away from edges.
#[test]
fn footprints_agree_with_differences() {
    let (width, height) = (24, 16);
    let mut renderers = both();
    let mut random = Random(29);
    // The footprints by tracer, and by whether the record was looked up or integrated.
    let mut found: [[Footprints; 2]; 2] = Default::default();
    for index in 0..count_from("BHR_LENS_OBSERVERS", 20, 1000) {
        let mut scene = random_eye(&mut random, index);
        scene.disk.as_mut().unwrap().turbulence = 1.0;
        let edge = shadow_edge(&scene, &mut random);
        let scale = (5.0 / (scene.camera.position.length() - 1.0).max(1.0)).min(1.0);
        let pixel = scale * random.log_range(3e-3, 0.1);
        let forward = edge.filter(|_| random.next() < 0.7).unwrap_or_else(|| random.direction());
        turn(&mut scene, forward, &mut random, pixel * f64::from(height));
        let truth = Truth::new(&scene, width, height);
        let true_changes = (0..(width * height) as usize).into_par_iter().map(|i| Changes::new(&truth, i));
        let true_changes = true_changes.collect::<Vec<_>>();
        for (renderer, found) in renderers.iter_mut().zip(&mut found) {
            renderer.scene = scene.clone();
            let records = renderer.ray_records(width, height).unwrap();
            for (i, (changes, record)) in true_changes.iter().zip(&records).enumerate() {
                let integrated = record.steps > 0;
                if !integrated || pixel < scale / 150.0 {
                    found[usize::from(integrated)].compare(index, i, changes, record);
                }
            }
        }
    }
    let mut failures = Vec::new();
    for (tracer, kinds) in TRACERS.iter().zip(found) {
        assert!(
            kinds.iter().any(|f| f.sky.0.len() > 1000 && f.place.0.len() > 1000),
            "{tracer}: hardly anything was compared"
        );
        for (kind, found) in ["looked up", "integrated"].iter().zip(kinds) {
            failures.extend(found.judge(&format!("{tracer}, {kind}")));
        }
    }
    fail_if_any(failures);
}

/// d(sight) / d(pixel), to the right and down.
struct Changes {
    sky: Option<[DVec3; 2]>,
    /// Order, and changes of ln r, azimuth and delay / r, of crossings that have them.
    crossings: Vec<(u32, [[f64; 3]; 2])>,
}

impl Changes {
    const SHARE: f64 = 1e-3;

    fn new(truth: &Truth, pixel: usize) -> Self {
        let width = truth.lens.mapping.width as usize;
        let (x, y) = ((pixel % width) as f64 + 0.5, (pixel / width) as f64 + 0.5);
        let h = 0.5 * Self::SHARE;
        let at = |dx: f64, dy: f64| truth.sight(truth.lens.look(x + dx, y + dy));
        let pairs = [[at(-h, 0.0), at(h, 0.0)], [at(0.0, -h), at(0.0, h)]];
        let escaped = pairs.as_flattened().iter().all(|s| s.fate == Fate::Escaped);
        let sky = pairs.each_ref().map(|[before, after]| (after.direction - before.direction) / Self::SHARE);
        let orders = 0..pairs.as_flattened().iter().map(|s| s.crossings.len()).min().unwrap_or(0);
        Self {
            sky: escaped.then_some(sky),
            crossings: orders
                .map(|k| {
                    let change = |[before, after]: &[Sight; 2]| {
                        let (p, q) = (&before.crossings[k].0, &after.crossings[k].0);
                        let delay = (q.delay - p.delay) * q.u;
                        [(p.u / q.u).ln(), wrap_angle(q.azimuth - p.azimuth), delay].map(|d| d / Self::SHARE)
                    };
                    (k as u32, pairs.each_ref().map(change))
                })
                .collect(),
        }
    }
}

/// Errors relative to the larger of both changes.
#[derive(Default)]
struct Footprints {
    sky: Errors,
    place: Errors,
}

impl Footprints {
    /// Whether neighbours' differences can tell: all there, and the change small enough to be linear.
    fn is_fair(record: &Record, size: f64, known: bool) -> bool {
        record.steps == 0 || (known && size < 0.01)
    }

    fn compare(&mut self, scene: usize, ray: usize, truth: &Changes, record: &Record) {
        if let Some(sky) = truth.sky.filter(|_| record.fate == Fate::Escaped) {
            let size = sky[0].length().max(sky[1].length());
            let error = (0..2).map(|i| (record.footprint[i] - sky[i]).length()).fold(0.0, f64::max);
            if Self::is_fair(record, size, record.footprint.iter().all(|f| f.x < 1e30)) {
                self.sky.add(error / size, scene, ray);
            }
        }
        for (order, changes) in &truth.crossings {
            let Some(x) = record.crossings.iter().find(|x| x.order == *order) else { continue };
            let size = changes.as_flattened().iter().copied().fold(0.0_f64, |m, d| m.max(d.abs()));
            let error = x.footprint.iter().zip(changes).flat_map(|(found, d)| {
                [found.ln_r - d[0], found.azimuth - d[1], found.delay * x.u - d[2]].map(f64::abs)
            });
            if Self::is_fair(record, size, x.footprint.iter().all(|f| f.ln_r < 1e30)) {
                self.place.add(error.fold(0.0, f64::max) / size, scene, ray);
            }
        }
    }

    fn judge(self, what: &str) -> Vec<String> {
        // They decide how wide a filter is; a spline of the fourth order knows its slope to the third.
        let bars = [(0.99, 3e-2)];
        let compared =
            [("sky direction", self.sky), ("crossing", self.place)].into_iter().filter(|(_, e)| !e.0.is_empty());
        compared.flat_map(|(name, errors)| errors.judge(&format!("{what}: change of a {name}"), &bars)).collect()
    }
}

/// The error that a record may have from sample to sample of a scan line: in the components of the sky direction
/// (`sky_path`) divided by the stretch, rad, and in ln r of a crossing divided by (1 + conditioning). A few roundings
/// of f32, which differ from one sample to the next, make second differences; a seam is a step that stays, and shows in
/// the means of `WINDOW` samples on either side, where rounding averages out: 0.005 pixel of a 3840 x 2160 frame,
/// 2.4e-6 rad, is one and a half times the bar.
const ROUNDING_BAR: f64 = 5e-6;
const STEP_BAR: f64 = 1.6e-6;
const WINDOW: usize = 32;

/// Samples of a scan line.
const SAMPLES: u32 = 2048;

/// The errors of the samples of a scan line; `None` where there is nothing to compare.
type Wrong = Vec<Option<DVec3>>;

/// The largest component of `measure` of every run of `length` samples that are all there, and the run's middle.
fn along(wrong: &Wrong, length: usize, measure: impl Fn(&[DVec3]) -> DVec3) -> Vec<(f64, usize)> {
    let mut found = Vec::new();
    for (first, run) in wrong.windows(length).enumerate() {
        let run = run.iter().copied().flatten().collect::<Vec<_>>();
        if run.len() == length {
            found.push((measure(&run).abs().max_element(), first + length / 2));
        }
    }
    found
}

fn second_differences(wrong: &Wrong) -> Vec<(f64, usize)> {
    along(wrong, 3, |run| run[0] - 2.0 * run[1] + run[2])
}

fn steps(wrong: &Wrong) -> Vec<(f64, usize)> {
    let mean = |part: &[DVec3]| part.iter().sum::<DVec3>() / part.len() as f64;
    along(wrong, 2 * WINDOW, |run| mean(&run[WINDOW..]) - mean(&run[..WINDOW]))
}

/// The checkers themselves: rounding alone passes, and 0.005 pixel more from some sample on, or 0.01 pixel in one,
/// does not.
#[test]
fn a_step_would_be_seen() {
    let mut random = Random(31);
    let largest = |found: Vec<(f64, usize)>| found.into_iter().fold(0.0, |m: f64, d| m.max(d.0));
    for at in [WINDOW, 700, SAMPLES as usize - WINDOW] {
        let mut rounding = || random.range(-5e-7, 5e-7);
        let mut wrong = (0..SAMPLES).map(|_| Some(DVec3::new(0.0, rounding(), rounding()))).collect::<Wrong>();
        let (second, step) = (largest(second_differences(&wrong)), largest(steps(&wrong)));
        assert!(second < ROUNDING_BAR && step < STEP_BAR, "{second:e} {step:e}");
        let mut outlier = wrong.clone();
        outlier[at].as_mut().unwrap().z += 0.01 * PIXEL_4K;
        assert!(largest(second_differences(&outlier)) > ROUNDING_BAR, "an outlier at {at}");
        wrong.iter_mut().skip(at).flatten().for_each(|e| e.y += 0.005 * PIXEL_4K);
        assert!(largest(steps(&wrong)) > STEP_BAR, "a step at {at}: {:e}", largest(steps(&wrong)));
    }
}

/// Directions (chart) in whose middle scan lines lie, and the lines' widths, rad: four that go round the sky through
/// the hole's direction, two across the shadow's edge, one anywhere.
fn scan_lines(scene: &Scene, random: &mut Random) -> Vec<(DVec3, DVec3, f64)> {
    let observer = scene.observer().unwrap();
    let inward = Observer::moving(observer.frame, -observer.beta).look(DVec3::NEG_X).0;
    let inward = observer.frame.vector(inward);
    let aside = inward.cross(random.direction()).normalize();
    let turned = random.range(0.0, PI / 2.0);
    let mut lines = Vec::new();
    for quarter in 0..4 {
        let (s, c) = (turned + PI / 2.0 * f64::from(quarter)).sin_cos();
        lines.push((inward * c + aside * s, aside * c - inward * s, PI / 2.0));
    }
    for _ in 0..2 {
        if let Some(edge) = shadow_edge(scene, random) {
            lines.push((edge, edge.cross(random.direction()), random.log_range(3e-3, 0.5)));
        }
    }
    let anywhere = random.direction();
    lines.push((anywhere, anywhere.cross(random.direction()), random.range(0.1, 2.0)));
    lines
}

/// Second differences and steps of sky directions and of radii.
#[derive(Default)]
struct Seams {
    sky: [Errors; 2],
    radius: [Errors; 2],
}

impl Seams {
    fn look_at(&mut self, wrong: &[Wrong], scene: usize, line: usize) {
        for (kind, wrong) in wrong.iter().enumerate() {
            let errors = if kind == 0 { &mut self.sky } else { &mut self.radius };
            for (errors, found) in errors.iter_mut().zip([second_differences(wrong), steps(wrong)]) {
                found.into_iter().for_each(|(error, i)| errors.add(error, scene, line * 10_000 + i));
            }
        }
    }

    fn judge(self, what: &str) -> Vec<String> {
        let mut failures = Vec::new();
        for (quantity, [second, step]) in [("sky direction", self.sky), ("crossing radius", self.radius)] {
            for (name, errors, bar) in [("second differences", second, ROUNDING_BAR), ("steps", step, STEP_BAR)] {
                if !errors.0.is_empty() {
                    failures.extend(errors.judge(&format!("{what}: {name} of {quantity}"), &[(1.0, bar)]));
                }
            }
        }
        failures
    }
}

/// Scan lines through table edges, across the critical curve and to where integration takes over.
#[test]
fn no_seam() {
    let mut renderers = both();
    let mut random = Random(37);
    // The lines by tracer, and by whether they were looked up (partly, at least) or integrated.
    let mut found: [[Seams; 2]; 2] = Default::default();
    for index in 0..count_from("BHR_LENS_OBSERVERS", 20, 1000) / 5 {
        let mut scene = random_eye(&mut random, index);
        for (line, (forward, right, width)) in scan_lines(&scene, &mut random).into_iter().enumerate() {
            let fov_y = 2.0 * ((0.5 * width).tan() / f64::from(SAMPLES)).atan();
            scene.camera = Camera { forward, up: right.cross(forward), fov_y, ..scene.camera };
            let truth = Truth::new(&scene, SAMPLES, 1);
            let rays = truth.rays();
            for (tracer, renderer) in renderers.iter_mut().enumerate() {
                renderer.scene = scene.clone();
                let records = renderer.ray_records(SAMPLES, 1).unwrap();
                let integrated = records.iter().all(|r| r.steps > 0);
                let frame = Frame { truth: &truth, scene_index: index, single: tracer == GPU };
                found[tracer][usize::from(integrated)].look_at(&frame.wrong(&rays, &records), index, line);
            }
        }
    }
    let mut failures = Vec::new();
    for (tracer, kinds) in TRACERS.iter().zip(found) {
        let compared = |f: &Seams| f.sky[1].0.len() > 5000 && f.radius[1].0.len() > 1000;
        assert!(kinds.iter().any(compared), "{tracer}: hardly anything was compared");
        for (kind, seams) in ["looked up", "integrated"].iter().zip(kinds) {
            failures.extend(seams.judge(&format!("{tracer}, {kind}")));
        }
    }
    fail_if_any(failures);
}

/// Axes that go with the true sky direction along a scan line: the way it moves, across, and outward. In them an error
/// that changes slowly is one, however fast the sky turns beside the critical curve.
fn sky_path(rays: &[TrueRay], i: usize) -> Option<DMat3> {
    let [before, here, after] =
        [i.wrapping_sub(1), i, i + 1].map(|k| rays.get(k).filter(|r| r.1.fate == Fate::Escaped));
    let outward = here?.1.direction;
    let along = (after?.1.direction - before?.1.direction).reject_from_normalized(outward).try_normalize()?;
    Some(DMat3::from_cols(along, outward.cross(along), outward))
}

impl Frame<'_> {
    /// The errors of the samples: of sky directions, and of ln r of the crossings of each order.
    fn wrong(&self, rays: &[TrueRay], records: &[Record]) -> Vec<Wrong> {
        let orders = self.truth.settings.max_crossings;
        let mut all = vec![vec![None; rays.len()]; 1 + orders];
        for (i, ((look, here, conditioning), record)) in rays.iter().zip(records).enumerate() {
            let wrong = (record.direction - here.direction) / conditioning.sky.max(1.0);
            let judged = record.fate == here.fate && (wrong.length() < 1e-6 || !self.at_critical(*look, here, record));
            if judged && here.fate == Fate::Escaped {
                all[0][i] = sky_path(rays, i).map(|axes| axes.transpose() * wrong);
            }
            for ((crossing, _), conditioning) in here.crossings.iter().zip(&conditioning.ln_r) {
                let listed = record.crossings.iter().find(|x| judged && x.order == crossing.order);
                let ratio = listed.map(|x| (x.u / crossing.u).ln() / (1.0 + conditioning));
                all[1 + crossing.order as usize][i] = ratio.map(|e| DVec3::new(e, 0.0, 0.0));
            }
        }
        all
    }
}
