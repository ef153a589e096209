// SPDX-License-Identifier: MIT OR Apache-2.0
//! How long frames take: named scenes, on the GPU by its own timestamps (software drivers: wall time, their timestamps
//! mean nothing) and on the CPU tracer by wall time. `cargo bench`, or the program by itself; a word measures the
//! scenes whose names have it. Ends with a table: median and the 5 % and 95 % quantiles of all frames measured.

use bhr::image::{ImageMut, Lut, PixelFormat, memory::Layout};
use bhr::renderer::{Backend, PASSES, Renderer, RendererOptions};
use bhr::scene::{Camera, LensTables, Method, Projection, Scene, Sky, Volume, VolumeResolution};
use glam::{DQuat, DVec3};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Until a scene's caches, clocks and governors have settled.
const WARM_UP: Duration = Duration::from_millis(500);
/// Fast frames are measured for so long, and are then more than the least number.
const MEASURED: Duration = Duration::from_secs(1);

/// The seconds of every frame measured, by the scene's name.
type Times = BTreeMap<String, Vec<f64>>;

/// A renderer with its target.
struct Stage {
    renderer: Renderer,
    pixels: Vec<u8>,
    layout: Layout,
    /// Time by the GPU's timestamps instead of the wall clock.
    timestamps: bool,
    /// The change from frame to frame.
    change: Change,
    frames: u32,
}

/// The things that a host moves from frame to frame.
#[derive(Clone, Copy)]
enum Change {
    Nothing,
    /// The view turns by a hundredth of a degree.
    View,
    /// The observer moves outward by 1e-4 of its distance, and back.
    Observer,
}

impl Stage {
    fn new(backend: Option<Backend>, [width, height]: [u32; 2], set: impl FnOnce(&mut Renderer)) -> Self {
        let mut renderer = Renderer::new(RendererOptions { backend, ..Default::default() }).expect("a renderer");
        // The default scene of 0.1.0, so that times can be compared.
        renderer.scene = Scene::plain();
        // Kernels that write into the host's memory take as long as the bus: that is for benches/delivery.rs.
        renderer.scene.quality.mapped_pixels = Some(false);
        set(&mut renderer);
        let layout = Layout::packed(PixelFormat::Rgba8Srgb, width, height);
        let timestamps = !renderer.adapter().software;
        Self {
            renderer,
            pixels: vec![0; width as usize * height as usize * 4],
            layout,
            timestamps,
            change: Change::Nothing,
            frames: 0,
        }
    }

    fn with(self, change: Change) -> Self {
        Self { change, ..self }
    }

    fn move_on(&mut self) {
        self.frames += 1;
        let back = self.frames % 200 >= 100;
        let camera = &mut self.renderer.scene.camera;
        match self.change {
            Change::Nothing => {}
            Change::View => {
                let turn = DQuat::from_axis_angle(camera.up.normalize(), if back { -1.7e-4 } else { 1.7e-4 });
                camera.forward = turn * camera.forward;
            }
            Change::Observer => camera.position *= if back { 1.0 / 1.0001 } else { 1.0001 },
        }
    }

    /// Seconds of the passes of the last frame, if it has bloom and the GPU's timestamps mean something.
    fn passes(&self) -> Option<[f64; PASSES]> {
        let passes = self.renderer.stats().pass_ns;
        (self.timestamps && passes[1] > 0).then(|| passes.map(|ns| 1e-9 * ns as f64))
    }

    fn frame(&mut self) -> Duration {
        self.move_on();
        let started = Instant::now();
        let mut image = ImageMut::new(self.layout, &mut self.pixels).expect("an image");
        self.renderer.render(&mut image, false, None, &mut |_| true).expect("a frame");
        if self.timestamps { Duration::from_nanos(self.renderer.stats().gpu_ns) } else { started.elapsed() }
    }
}

/// Whether the command line asks for what `name` says: no word asks for everything.
fn is_wanted(name: &str) -> bool {
    let mut words = std::env::args().skip(1).filter(|word| !word.starts_with('-')).peekable();
    words.peek().is_none() || words.any(|word| name.contains(&word))
}

/// At least so many frames of a scene, if the command line asks for it; otherwise the scene is not even set up, which
/// takes as long as measuring it.
fn measure(times: &mut Times, frames: usize, name: &str, stage: impl FnOnce() -> Stage) {
    if !is_wanted(name) {
        return;
    }
    let mut stage = stage();
    let begun = Instant::now();
    // Pipelines and tables come with the first frames, whatever the time says.
    let mut warm = 0;
    while warm < 3 || begun.elapsed() < WARM_UP {
        stage.frame();
        warm += 1;
    }
    let (begun, mut seconds) = (Instant::now(), Vec::new());
    while seconds.len() < frames || begun.elapsed() < MEASURED {
        seconds.push(stage.frame().as_secs_f64());
        for (pass, seconds) in ["shading", "bloom", "development"].iter().zip(stage.passes().into_iter().flatten()) {
            times.entry(format!("{name}: {pass}")).or_default().push(seconds);
        }
    }
    println!("{name}: {:.3} ms, {} frames", 1e3 * quantile(&mut seconds, 0.5), seconds.len());
    times.entry(name.into()).or_default().extend(seconds);
}

/// Sorts the values.
fn quantile(values: &mut [f64], share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values[((values.len() - 1) as f64 * share).round() as usize]
}

fn spin(a: f64) -> impl FnOnce(&mut Renderer) {
    move |renderer| renderer.scene.hole.spin = a
}

fn bloom(a: f64) -> impl FnOnce(&mut Renderer) {
    move |renderer| (renderer.scene.hole.spin, renderer.scene.film.bloom) = (a, 0.5)
}

/// Disk, turbulence, stars, Milky Way and bloom.
fn everything(a: f64) -> impl FnOnce(&mut Renderer) {
    move |renderer| {
        bloom(a)(renderer);
        renderer.scene.disk.iter_mut().for_each(|disk| disk.turbulence = 1.0);
    }
}

fn method(a: f64, method: Method) -> impl FnOnce(&mut Renderer) {
    move |renderer| (renderer.scene.hole.spin, renderer.scene.quality.method) = (a, method)
}

fn traced(a: f64) -> impl FnOnce(&mut Renderer) {
    move |renderer| (renderer.scene.hole.spin, renderer.scene.quality.lens_tables) = (a, LensTables::Never)
}

/// Matter with depth instead of the thin disk: a soft disk or a thick one, far from it or within.
fn matter(volume: Volume, a: f64, distance: f64, elevation: f64, half_tan: f64) -> impl FnOnce(&mut Renderer) {
    move |renderer| {
        let (sin, cos) = elevation.to_radians().sin_cos();
        let position = DVec3::new(distance * cos, 0.0, distance * sin);
        let scene = &mut renderer.scene;
        (scene.hole.spin, scene.disk, scene.time) = (a, None, 35.0);
        scene.volumes.push(volume);
        let fov_y = 2.0 * half_tan.atan();
        scene.camera = Camera { position, forward: -position, up: DVec3::Z, fov_y, ..Camera::plain() };
    }
}

fn half(set: impl FnOnce(&mut Renderer)) -> impl FnOnce(&mut Renderer) {
    |renderer| {
        set(renderer);
        renderer.scene.quality.volume_resolution = VolumeResolution::Half;
    }
}

/// Sets a renderer up for a scene.
type Set = Box<dyn FnOnce(&mut Renderer)>;

fn volumes(measured: &mut dyn FnMut(&str, Set)) {
    let soft = Volume::default();
    let thick = Volume {
        thickness: 0.14,
        absorption: 0.3,
        inner_radius: 2.55,
        slope: 0.9,
        temperature: 5400.0,
        clumping: 2.0,
        ..soft
    };
    for turbulence in [1.0, 0.0] {
        let how = if turbulence > 0.0 { "" } else { ", even" };
        let [soft, thick] = [soft, thick].map(|volume| Volume { turbulence, ..volume });
        measured(&format!("soft disk{how}"), Box::new(matter(soft, 0.6, 28.0, 6.5, 0.34)));
        measured(&format!("thick disk{how}"), Box::new(matter(thick, 0.9, 30.0, 10.0, 0.36)));
        measured(&format!("within a thick disk{how}"), Box::new(matter(thick, 0.9, 8.0, 10.0, 0.8)));
        measured(&format!("soft disk{how}, half resolution"), Box::new(half(matter(soft, 0.6, 28.0, 6.5, 0.34))));
        measured(&format!("thick disk{how}, half resolution"), Box::new(half(matter(thick, 0.9, 30.0, 10.0, 0.36))));
    }
}

/// The scene of a new context; its quality stays, which says that frames are not written into the host's memory.
fn default_scene(a: f64) -> impl FnOnce(&mut Renderer) {
    move |renderer| {
        let plain = std::mem::take(&mut renderer.scene);
        renderer.scene.quality = plain.quality;
        renderer.scene.hole.spin = a;
    }
}

/// The films of the default scene at spin 0.9.
fn films(measured: &mut dyn FnMut(&str, Set)) {
    let mut film = |name: &str, change: fn(&mut Scene)| {
        let set = move |renderer: &mut Renderer| {
            default_scene(0.9)(renderer);
            change(&mut renderer.scene);
        };
        measured(&format!("film, {name}"), Box::new(set));
    };
    film("as it is", |_| ());
    film("auto exposure", |scene| scene.film.auto_exposure.strength = 1.0);
    film("auto exposure and a LUT", |scene| {
        scene.film.auto_exposure.strength = 1.0;
        let node = |i: u32| (i % 33) as f32 / 32.0;
        let numbers = (0..33 * 33 * 33).flat_map(|i: u32| [node(i), node(i / 33), node(i / 33 / 33)]);
        let numbers: Vec<f32> = numbers.collect();
        scene.film_lut = Some(Arc::new(Lut::new(33, numbers.into_iter()).expect("a LUT")));
    });
    film("highlights and shadows", |scene| (scene.film.highlights, scene.film.shadows) = (0.5, 0.2));
    film("a streak", |scene| scene.film.optics.streak = 0.5);
    film("spikes", |scene| scene.film.optics.spikes = 0.5);
    film("a flare", |scene| scene.film.optics.flare = 0.5);
    film("a grade", |scene| {
        let grade = &mut scene.film.grade;
        (grade.contrast, grade.saturation, grade.vignette, grade.grain) = (1.1, 0.9, 0.3, 0.2);
    });
}

fn gpu(times: &mut Times, frames: usize) {
    let software = Stage::new(None, [16, 16], |_| ()).renderer.adapter().software;
    let size = if software { [1280, 720] } else { [3840, 2160] };
    let mut measured = |what: &str, size: [u32; 2], change: Change, set: Set| {
        let name = format!("gpu {}x{} {what}", size[0], size[1]);
        measure(times, frames, &name, || Stage::new(None, size, set).with(change));
    };
    for a in [0.0, 0.9] {
        measured(&format!("spin {a}"), size, Change::Nothing, Box::new(spin(a)));
        measured(&format!("spin {a}, view turning"), size, Change::View, Box::new(spin(a)));
        measured(&format!("spin {a}, observer moving"), size, Change::Observer, Box::new(spin(a)));
        measured(&format!("spin {a}, each ray integrated"), size, Change::Nothing, Box::new(traced(a)));
        measured(&format!("spin {a}, bloom"), size, Change::Nothing, Box::new(bloom(a)));
        measured(&format!("spin {a}, RK4"), size, Change::Nothing, Box::new(method(a, Method::Rk4)));
    }
    for a in [0.0, 0.9] {
        for size in [size, [640, 360]] {
            measured(&format!("spin {a}, everything"), size, Change::Nothing, Box::new(everything(a)));
            measured(
                &format!("spin {a}, everything, observer moving"),
                size,
                Change::Observer,
                Box::new(everything(a)),
            );
        }
    }
    for a in [0.0, 0.9, 0.998] {
        measured(&format!("default scene, spin {a}"), size, Change::Nothing, Box::new(default_scene(a)));
    }
    films(&mut |name, set| measured(name, size, Change::Nothing, set));
    let sizes = if software { vec![[640, 360]] } else { vec![size, [1920, 1080]] };
    for size in sizes {
        volumes(&mut |name, set| measured(name, size, Change::Nothing, set));
    }
    for a in [0.5, 0.998] {
        measured(&format!("spin {a}"), size, Change::Nothing, Box::new(spin(a)));
    }
    measured("spin 0, ADAPTIVE", size, Change::Nothing, Box::new(method(0.0, Method::Adaptive)));
    let fisheye = |r: &mut Renderer| (r.scene.hole.spin, r.scene.camera.projection) = (0.9, Projection::Fisheye);
    measured("spin 0.9, FISHEYE", size, Change::Nothing, Box::new(fisheye));
    measured("spin 0, no disk", size, Change::Nothing, Box::new(|r| r.scene.disk = None));
    measured("spin 0, no stars", size, Change::Nothing, Box::new(|r| r.scene.sky.flags = 0));
    measured("spin 0, no Milky Way", size, Change::Nothing, Box::new(|r| r.scene.sky.flags = Sky::STARS));
    let procedural = |r: &mut Renderer| r.scene.sky.flags |= Sky::PROCEDURAL;
    measured("spin 0, procedural stars too", size, Change::Nothing, Box::new(procedural));
    for (how, sampler) in [("by a sampler", true), ("texel by texel", false)] {
        let sky = move |r: &mut Renderer| r.scene.quality.map_sampler = Some(sampler);
        measured(&format!("spin 0, Milky Way {how}"), size, Change::Nothing, Box::new(sky));
    }
    measured("spin 0, neither", size, Change::Nothing, Box::new(|r| (r.scene.disk, r.scene.sky.flags) = (None, 0)));
    let turbulent = |r: &mut Renderer| r.scene.disk.iter_mut().for_each(|d| d.turbulence = 1.0);
    measured("spin 0, turbulent", size, Change::Nothing, Box::new(turbulent));
    if !software {
        for size in [[1920, 1080], [7680, 4320]] {
            for a in [0.0, 0.9] {
                measured(&format!("spin {a}"), size, Change::Nothing, Box::new(spin(a)));
            }
        }
    }
}

/// Frames of the CPU tracer are slow: a few will do.
fn cpu(times: &mut Times) {
    let frames = 10;
    volumes(&mut |name, set| {
        measure(times, frames, &format!("cpu 640x360 {name}"), || Stage::new(Some(Backend::Cpu), [640, 360], set));
    });
    let size = [1280, 720];
    for a in [0.0, 0.9] {
        let name = format!("cpu 1280x720 plain scene, spin {a}");
        measure(times, frames, &name, || Stage::new(Some(Backend::Cpu), size, spin(a)));
    }
    let far = |renderer: &mut Renderer| {
        let position = renderer.scene.camera.position * 10.0;
        renderer.scene.camera = Camera { position, forward: -position, ..Camera::plain() };
    };
    measure(times, frames, "cpu 1280x720 from 300 M, spin 0", || Stage::new(Some(Backend::Cpu), size, far));
    for (name, flags) in [("nothing", 0), ("stars alone", Sky::STARS), ("Milky Way alone", Sky::MILKY_WAY)] {
        let sky = move |r: &mut Renderer| (r.scene.disk, r.scene.sky.flags) = (None, flags);
        measure(times, frames, &format!("cpu 1280x720 {name}, spin 0"), || Stage::new(Some(Backend::Cpu), size, sky));
    }
}

fn main() {
    let adapter = Stage::new(None, [16, 16], |_| ()).renderer.adapter().clone();
    println!("GPU adapter: {}, driver {}", adapter.name, adapter.driver);
    // 100 frames a scene on hardware; software takes its time.
    let frames = if adapter.software { 10 } else { 100 };
    let mut times = Times::new();
    gpu(&mut times, frames);
    cpu(&mut times);
    println!("\n{:52} {:>8} {:>9} {:>9} {:>9}", "milliseconds a frame", "frames", "median", "5 %", "95 %");
    for (name, seconds) in &mut times {
        let [median, least, most] = [0.5, 0.05, 0.95].map(|share| 1e3 * quantile(seconds, share));
        println!("{name:52} {:>8} {median:>9.3} {least:>9.3} {most:>9.3}", seconds.len());
    }
}
