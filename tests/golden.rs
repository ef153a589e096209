// SPDX-License-Identifier: MIT OR Apache-2.0
//! Both tracers against the reference values in tests/golden, inside the bars of 'What "right" means' (design.md):
//! every error is divided by (1 + the case's conditioning). The GPU cases run on whatever adapter comes first and
//! fail when there is none.
//! Files are found from the package's root, where cargo runs tests.

use bhr::physics::trace;
use bhr::renderer::{Backend, Renderer, RendererOptions, adapters};
use bhr::scene::record::Record;
use bhr::scene::{Camera, Disk, Fate, Hit, LensTables, Method, Motion, Projection, Ray, Region, Scene};
use glam::DVec3;
use serde_json::Value;
use std::f64::consts::PI;

/// How exact a tracer has to be.
struct Bars {
    /// Worst error of directions, radii and redshifts.
    worst: f64,
    /// Worst error of the best 99 % of a set.
    most: f64,
    azimuth: f64,
    /// Fates of rays nearer to the critical curve are not judged.
    fate_delta: f64,
}

const F64: Bars = Bars { worst: 1e-9, most: 1e-9, azimuth: 1e-7, fate_delta: 0.0 };
const F32: Bars = Bars { worst: 2e-5, most: 2e-6, azimuth: 2e-3, fate_delta: 1e-5 };
/// Pixels that are integrated, at their own, larger step: judged by the conditioning that differences between pixels
/// show, which is too small beside the shadow. tests/tracers/lens/records.rs has their true one.
const PIXEL: Bars = Bars { worst: 1e-4, most: 1e-4, azimuth: 2e-3, fate_delta: 1e-5 };
/// RK4 at its default step: ten times the f32 bars.
const RK4: Bars = Bars { worst: 2e-4, most: 2e-5, azimuth: 2e-2, fate_delta: 1e-4 };

fn cpu() -> Renderer {
    let mut renderer = Renderer::new(RendererOptions { backend: Some(Backend::Cpu), ..Default::default() }).unwrap();
    renderer.scene = Scene::plain();
    renderer
}

fn gpu() -> Renderer {
    let mut renderer = Renderer::new(RendererOptions::default()).unwrap();
    assert_ne!(renderer.adapter().backend, Backend::Cpu, "no GPU adapter (lavapipe counts): {:?}", adapters());
    renderer.scene = Scene::plain();
    renderer
}

fn golden(file: &str) -> Value {
    let path = format!("tests/golden/{file}");
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn number(v: &Value) -> f64 {
    v.as_f64().unwrap_or(f64::NAN)
}

fn vector(v: &Value) -> DVec3 {
    DVec3::new(number(&v[0]), number(&v[1]), number(&v[2]))
}

/// Errors of one kind, each with the name of its case.
#[derive(Default)]
struct Errors(Vec<(f64, String)>);

impl Errors {
    fn add(&mut self, error: f64, case: impl Into<String>) {
        self.0.push((if error.is_nan() { f64::INFINITY } else { error }, case.into()));
    }

    fn assert(mut self, what: &str, worst: f64, most: f64) {
        assert!(!self.0.is_empty(), "{what}: nothing was compared");
        self.0.sort_by(|a, b| a.0.total_cmp(&b.0));
        let at = |share: f64| self.0[((self.0.len() as f64 * share) as usize).min(self.0.len() - 1)].clone();
        let (median, p99, max) = (at(0.5), at(0.99), at(1.0));
        println!("{what}: n {} median {:.2e} p99 {:.2e} max {:.2e} ({})", self.0.len(), median.0, p99.0, max.0, max.1);
        assert!(max.0 <= worst, "{what}: {:.3e} > {worst:.1e} in {}", max.0, max.1);
        // Small sets have no 99 %: judge them by the next to worst.
        let share = if self.0.len() < 200 { 1.0 - 2.0 / self.0.len() as f64 } else { 0.99 };
        assert!(at(share).0 <= most, "{what}: 99 % at {:.3e} > {most:.1e} in {}", at(share).0, at(share).1);
    }
}

/// One ray of a golden file with what is known about it.
struct Case<'a> {
    name: String,
    data: &'a Value,
    ray: Ray,
}

/// The ray of a static / ZAMO observer at (r, theta, phi = 0) with look components n.
fn ray_at(r: f64, theta: f64, axis: bool, n: DVec3) -> Ray {
    let (s, c) = if axis { (0.0, 1.0) } else { theta.sin_cos() };
    // The plane exactly: cos(pi/2) is not 0 in floating point.
    let c = if theta == PI / 2.0 { 0.0 } else { c };
    let (e_r, e_theta) = (DVec3::new(s, 0.0, c), DVec3::new(c, 0.0, -s));
    let direction = e_r * n.x + e_theta * n.y + DVec3::Y * n.z;
    Ray { position: e_r * r, direction, frequency_ratio: 1.0 }
}

fn wrap(angle: f64) -> f64 {
    ((angle + PI).rem_euclid(2.0 * PI) - PI).abs()
}

fn trace(renderer: &mut Renderer, cases: &[Case]) -> Vec<Hit> {
    let rays = cases.iter().map(|c| c.ray).collect::<Vec<_>>();
    let mut hits = vec![Hit::default(); rays.len()];
    renderer.trace_rays(&rays, &mut hits).unwrap();
    hits
}

fn delta(data: &Value) -> f64 {
    let named = ["b_over_bc_minus_1", "delta_psi_over_psi_c"].iter().find_map(|k| data[*k].as_f64());
    named.unwrap_or(1.0).abs()
}

/// Whether the fate is right, or the case too near the critical curve to judge.
fn fate_agrees(case: &Case, hit: &Hit, bars: &Bars) -> bool {
    let expect = if case.data["fate"] == "escaped" { Fate::Escaped } else { Fate::Captured };
    if hit.fate == expect {
        return true;
    }
    assert!(delta(case.data) < bars.fate_delta, "{}: fate {:?}, not {expect:?}", case.name, hit.fate);
    false
}

fn deflection(mut renderer: Renderer, bars: &Bars) {
    let file = golden("deflection.json");
    let cases = file["cases"].as_array().unwrap().iter().enumerate().map(|(i, data)| {
        let (r, psi) = (number(&data["r_o"]), number(&data["psi"]));
        // On the axis through the observer; psi from the outward radial.
        Case {
            name: format!("deflection {i}"),
            data,
            ray: ray_at(r, PI / 2.0, false, DVec3::new(psi.cos(), 0.0, psi.sin())),
        }
    });
    let cases = cases.collect::<Vec<_>>();
    let mut errors = Errors::default();
    for (case, hit) in cases.iter().zip(trace(&mut renderer, &cases)) {
        if !fate_agrees(case, &hit, bars) || delta(case.data) < bars.fate_delta {
            continue;
        }
        let dphi = number(&case.data["dphi"]);
        let conditioning = 1.0 + case.data["dphi_dpsi"].as_f64().unwrap_or(0.0).abs() + dphi;
        errors.add((hit.swept_angle - dphi).abs() / conditioning, &case.name);
    }
    errors.assert("swept angle", bars.worst, bars.most);
}

/// Directions, crossings and fates of disk_crossings.json and kerr_geodesics.json.
fn rays_of(mut renderer: Renderer, bars: &Bars, file: &str) {
    let file_data = golden(file);
    let all = file_data["cases"].as_array().unwrap();
    let (mut directions, mut radii, mut azimuths, mut redshifts) =
        (Errors::default(), Errors::default(), Errors::default(), Errors::default());
    for (i, data) in all.iter().enumerate() {
        let a = data["a"].as_f64().unwrap_or(0.0);
        renderer.scene.hole.spin = a;
        let r = number(&data["r_o"]);
        let theta = data["theta_o"].as_f64().unwrap_or_else(|| number(&data["inclination"]));
        let axis = data["exact_axis"].as_bool().unwrap_or(false);
        let ray = ray_at(r, theta, axis, vector(&data["n"]).normalize());
        let case = [Case { name: format!("{file} {i}"), data, ray }];
        let hit = trace(&mut renderer, &case)[0];
        let case = &case[0];
        if !fate_agrees(case, &hit, bars) || delta(data) < bars.fate_delta {
            continue;
        }
        // disk_crossings.json has no conditioning of the direction: golden/README.md's rule.
        let sky_conditioning = data["ddir_dpsi"].as_f64().unwrap_or_else(|| {
            let psi = number(&data["psi"]);
            data["dphi"].as_f64().unwrap_or(0.0)
                + r * psi.cos().abs() / ((1.0 - 2.0 / r).sqrt() * 27.0_f64.sqrt() * delta(data))
        });
        if data["dir_inf"].is_array() {
            let error = (hit.sky_direction - vector(&data["dir_inf"])).length();
            directions.add(error / (1.0 + sky_conditioning), &case.name);
        }
        let r_plus = 1.0 + (1.0 - a * a).sqrt();
        let expected = data["crossings"].as_array().unwrap();
        let listed = expected.len().min(4);
        assert!(hit.crossing_count as usize >= listed, "{}: {} crossings of {listed}", case.name, hit.crossing_count);
        for (k, x) in expected.iter().take(4).enumerate() {
            let (r_k, found) = (number(&x["r"]), hit.crossings[k]);
            let conditioning = 1.0 + x["dr_dpsi"].as_f64().unwrap_or(0.0).abs() / r_k;
            let name = format!("{} crossing {k} r {r_k}", case.name);
            radii.add((found.radius / r_k - 1.0).abs() / conditioning, &name);
            if r_k > r_plus + 0.05 {
                azimuths.add(wrap(found.azimuth - number(&x["phi"])) / conditioning, &name);
            }
            match x["g"].as_f64() {
                Some(g) => redshifts.add((found.redshift / g - 1.0).abs() / conditioning, &name),
                None => assert!(found.redshift.is_nan(), "{name}: g {} inside the ISCO", found.redshift),
            }
        }
    }
    directions.assert("sky direction", bars.worst, bars.most);
    radii.assert("crossing radius", bars.worst, bars.most);
    azimuths.assert("crossing azimuth", bars.azimuth, bars.azimuth);
    redshifts.assert("crossing g", bars.worst, bars.most);
}

/// The image that a tracer found for a pixel of a golden picture.
struct Seen {
    escaped: bool,
    steps: u32,
    direction: DVec3,
    /// r, azimuth and g of the first two crossings of the plane; `None` where the tracer lists none, or does not say.
    crossings: [Option<[f64; 3]>; 2],
}

impl From<&Hit> for Seen {
    fn from(hit: &Hit) -> Self {
        let crossing = |k: usize| {
            let x = hit.crossings[k];
            (k < hit.crossing_count as usize).then_some([x.radius, x.azimuth, x.redshift])
        };
        Self {
            escaped: hit.fate == Fate::Escaped,
            steps: hit.steps,
            direction: hit.sky_direction,
            crossings: std::array::from_fn(crossing),
        }
    }
}

impl From<&Record> for Seen {
    fn from(record: &Record) -> Self {
        let crossing = |k: usize| {
            let found = record.crossings.iter().find(|x| x.order as usize == k);
            found.map(|x| [1.0 / x.u, x.place.azimuth, x.g])
        };
        Self {
            escaped: record.fate == trace::Fate::Escaped,
            steps: record.steps,
            direction: record.direction,
            crossings: std::array::from_fn(crossing),
        }
    }
}

/// How a golden picture is made.
#[derive(Clone, Copy, PartialEq)]
enum Through {
    /// `camera_rays` and `trace_rays`.
    Rays,
    /// `ray_records`, looked up in lens tables: they list crossings of the disk only, here one from the ISCO to 1e6 M.
    Tables,
}

impl Through {
    fn see(self, renderer: &mut Renderer, width: u32, height: u32) -> Vec<Seen> {
        if self == Self::Rays {
            let mut rays = vec![Ray::default(); (width * height) as usize];
            renderer.scene.camera_rays(width, height, None, &mut |i, ray| rays[i] = ray).unwrap();
            let mut hits = vec![Hit::default(); rays.len()];
            renderer.trace_rays(&rays, &mut hits).unwrap();
            return hits.iter().map(Seen::from).collect();
        }
        renderer.scene.quality.lens_tables = LensTables::Always;
        // Turbulence: azimuths are left out of the records of smooth disks.
        let disk = renderer.scene.disk.as_mut().unwrap();
        (disk.outer_radius, disk.opacity, disk.turbulence) = (Disk::MAX_RADIUS, 0.5, 1.0);
        renderer.ray_records(width, height).unwrap().iter().map(Seen::from).collect()
    }
}

/// |d ln r / d look angle| of crossing `k` of a pixel, by tracing in f64.
fn traced_change(renderer: &Renderer, x: usize, y: usize, k: usize) -> f64 {
    let region = Region { full_width: 64, full_height: 48, x: 0, y: 0 };
    let lens = renderer.scene.lens(&region).unwrap();
    let settings = trace::Settings { step: 0.05, ..trace::Settings::exact(renderer.scene.hole.spin) };
    let radius = |dx: f64, dy: f64| {
        let (n, _) = lens.observer.aberrate(lens.look_direction(x as f64 + 0.5 + dx, y as f64 + 0.5 + dy));
        let traced = trace::trace_look(&lens.observer.frame, n, &settings).1;
        traced.crossings.iter().find(|c| c.order as usize == k).map(|c| (n, -c.u.ln()))
    };
    let step = 1e-3;
    let Some((n, here)) = radius(0.0, 0.0) else { return 0.0 };
    let slope = |(other, there): (DVec3, f64)| (there - here).abs() / (other - n).length();
    let right = radius(step, 0.0).map_or(0.0, slope);
    right.max(radius(0.0, step).map_or(0.0, slope))
}

/// A 64 x 48 picture; its reference is in f32, good to 6e-8. `floor`: what no error is asked to be below.
fn picture(mut renderer: Renderer, bars: &Bars, kind: &str, through: Through, floor: f64) {
    let file = golden("image.json");
    let scene = file["scenes"].as_array().unwrap().iter().find(|s| s["kind"] == kind).unwrap();
    let raw = std::fs::read(format!("tests/golden/image_{kind}.f32")).unwrap();
    let truth = raw.chunks_exact(4).map(|b| f64::from(f32::from_le_bytes(b.try_into().unwrap()))).collect::<Vec<_>>();
    let (width, height) = (64, 48);
    let (r, theta) = (number(&scene["r_o"]), number(&scene["inclination"]));
    let position = DVec3::new(theta.sin(), 0.0, theta.cos()) * r;
    renderer.scene.hole.spin = number(&scene["a"]);
    renderer.scene.camera = Camera {
        projection: Projection::Perspective,
        position,
        forward: -position,
        up: DVec3::Z,
        fov_y: number(&scene["fovy"]),
        motion: if kind == "circular" { Motion::Orbit } else { Motion::Static },
        velocity: DVec3::ZERO,
        ..Camera::plain()
    };
    let all_seen = through.see(&mut renderer, width as u32, height as u32);

    // The first are the pixels made as asked for, the second those that are integrated although tables were asked for.
    let mut errors: [PictureErrors; 2] = Default::default();
    let mut wrong = 0;
    // The stretch of the lens, from the neighbours in the reference, stands for the conditioning.
    let pixel = |x: usize, y: usize| &truth[(y * width + x) * 10..][..10];
    let pixel_angle = number(&scene["fovy"]) / height as f64;
    let difference = |x: usize, y: usize, channel: usize, n: usize| {
        let mut largest: f64 = 0.0;
        for (nx, ny) in [(x.wrapping_sub(1), y), (x + 1, y), (x, y.wrapping_sub(1)), (x, y + 1)] {
            if nx < width && ny < height {
                let d = (0..n).map(|k| (pixel(nx, ny)[channel + k] - pixel(x, y)[channel + k]).powi(2)).sum::<f64>();
                largest = largest.max(if d.is_nan() { 0.0 } else { d.sqrt() });
            }
        }
        largest / pixel_angle
    };
    for y in 0..height {
        for x in 0..width {
            let (t, seen) = (pixel(x, y), &all_seen[y * width + x]);
            let name = format!("{kind} ({x}, {y})");
            if (t[0] == 1.0) != seen.escaped {
                wrong += 1;
                continue;
            }
            let integrated = through == Through::Tables && seen.steps > 0;
            let PictureErrors { directions, radii, azimuths, redshifts } = &mut errors[usize::from(integrated)];
            if t[0] == 1.0 {
                let e = (seen.direction - DVec3::new(t[1], t[2], t[3])).length();
                directions.add(e / (1.0 + difference(x, y, 1, 3)), &name);
            }
            for k in 0..2 {
                let (r, phi, g) = (t[4 + 3 * k], t[5 + 3 * k], t[6 + 3 * k]);
                // Far crossings of near-grazing rays: radius and reference are both ill conditioned there.
                if r.is_nan() || r > 1e4 {
                    continue;
                }
                // Where a neighbour has no such crossing, nearby rays traced in f64 say how fast it moves.
                let lone = difference(x, y, 4 + 3 * k, 1).max(traced_change(&renderer, x, y, k) * r);
                let conditioning = 1.0 + lone / r;
                let Some([found_r, found_phi, found_g]) = seen.crossings[k] else {
                    let listed = through == Through::Rays || r > renderer.scene.disk_isco() * (1.0 + 1e-5);
                    assert!(!listed, "{name}: no crossing {k} at r = {r}");
                    continue;
                };
                radii.add((found_r / r - 1.0).abs() / conditioning, &name);
                let r_plus = 1.0 + (1.0 - renderer.scene.hole.spin.powi(2)).sqrt();
                if r > r_plus + 0.05 {
                    azimuths.add(wrap(found_phi - phi) / conditioning, &name);
                }
                if g.is_finite() {
                    redshifts.add((found_g / g - 1.0).abs() / conditioning, &name);
                }
            }
        }
    }
    assert_eq!(wrong, 0, "{kind}: {wrong} wrong fates");
    let compared = |of: fn(&PictureErrors) -> &Errors| errors.iter().map(|e| of(e).0.len()).sum::<usize>();
    assert!(
        compared(|e| &e.directions) > 1000 && compared(|e| &e.redshifts) > 1000,
        "{kind}: hardly anything compared"
    );
    for (errors, bars) in errors.into_iter().zip([bars, &PIXEL]) {
        errors.assert(bars, floor);
    }
}

/// The errors of a picture's pixels.
#[derive(Default)]
struct PictureErrors {
    directions: Errors,
    radii: Errors,
    azimuths: Errors,
    redshifts: Errors,
}

impl PictureErrors {
    fn assert(self, bars: &Bars, floor: f64) {
        let (worst, most, azimuth) = (bars.worst.max(floor), bars.most.max(floor), bars.azimuth.max(5e-7));
        let judged = [
            ("picture direction", self.directions, worst, most),
            ("picture radius", self.radii, worst, most),
            ("picture azimuth", self.azimuths, azimuth, azimuth),
            ("picture g", self.redshifts, worst, most),
        ];
        for (what, errors, worst, most) in judged.into_iter().filter(|(_, errors, ..)| !errors.0.is_empty()) {
            errors.assert(what, worst, most);
        }
    }
}

/// Rounding of the reference pictures.
const PICTURE_FLOOR: f64 = 1.2e-7;

fn all(make: fn() -> Renderer, bars: &Bars, method: Method) {
    let with_method = || {
        let mut renderer = make();
        renderer.scene.quality.method = method;
        renderer
    };
    deflection(with_method(), bars);
    for file in ["disk_crossings.json", "kerr_geodesics.json"] {
        rays_of(with_method(), bars, file);
    }
    for kind in ["static", "circular", "kerr"] {
        picture(with_method(), bars, kind, Through::Rays, PICTURE_FLOOR);
    }
}

#[test]
fn cpu_auto() {
    all(cpu, &F64, Method::Auto);
}

#[test]
fn cpu_adaptive() {
    all(cpu, &Bars { worst: 1e-8, most: 1e-9, ..F64 }, Method::Adaptive);
}

#[test]
fn cpu_rk4() {
    all(cpu, &RK4, Method::Rk4);
}

#[test]
fn gpu_auto() {
    all(gpu, &F32, Method::Auto);
}

#[test]
fn gpu_adaptive() {
    all(gpu, &F32, Method::Adaptive);
}

#[test]
fn gpu_rk4() {
    all(gpu, &RK4, Method::Rk4);
}

/// The tables of the CPU tracer are as exact as those of the GPU.
#[test]
fn cpu_tables() {
    for kind in ["static", "circular", "kerr"] {
        picture(cpu(), &F32, kind, Through::Tables, PICTURE_FLOOR);
    }
}

#[test]
fn gpu_tables() {
    for kind in ["static", "circular", "kerr"] {
        picture(gpu(), &F32, kind, Through::Tables, PICTURE_FLOOR);
    }
}
