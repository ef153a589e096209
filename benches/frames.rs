//! How long frames take: named scenes, on the GPU by its own timestamps (software drivers: wall time, their timestamps mean nothing) and on
//! the CPU tracer by wall time. `cargo bench`, or the program by itself; a word filters the names. Ends with a table: median and the
//! 5 % and 95 % quantiles of all frames measured.

use bhr::image::{ImageMut, PixelFormat, memory::Layout};
use bhr::renderer::{Backend, Renderer, RendererOptions};
use bhr::scene::{Camera, Method};
use criterion::Criterion;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;
use std::time::{Duration, Instant};

type Times = Rc<RefCell<BTreeMap<String, Vec<f64>>>>;

/// A renderer with its target.
struct Stage {
    renderer: Renderer,
    pixels: Vec<u8>,
    layout: Layout,
    /// Time by the GPU's timestamps instead of the wall clock.
    timestamps: bool,
}

impl Stage {
    fn new(backend: Option<Backend>, [width, height]: [u32; 2], set: impl FnOnce(&mut Renderer)) -> Self {
        let mut renderer = Renderer::new(RendererOptions { backend, ..Default::default() }).expect("a renderer");
        set(&mut renderer);
        let layout = Layout::packed(PixelFormat::Rgba8Srgb, width, height);
        let timestamps = !renderer.adapter().software;
        Self { renderer, pixels: vec![0; width as usize * height as usize * 4], layout, timestamps }
    }

    fn frame(&mut self) -> Duration {
        let started = Instant::now();
        let mut image = ImageMut::new(self.layout, &mut self.pixels).expect("an image");
        self.renderer.render(&mut image, false, None, &mut |_| true).expect("a frame");
        if self.timestamps { Duration::from_nanos(self.renderer.stats().gpu_ns) } else { started.elapsed() }
    }
}

fn measure(criterion: &mut Criterion, times: &Times, name: &str, mut stage: Stage) {
    // Pipelines, tables and caches.
    for _ in 0..3 {
        stage.frame();
    }
    criterion.bench_function(name, |bencher| {
        bencher.iter_custom(|iterations| {
            let each = (0..iterations).map(|_| stage.frame()).collect::<Vec<_>>();
            let seconds = each.iter().map(Duration::as_secs_f64);
            times.borrow_mut().entry(name.into()).or_default().extend(seconds);
            each.iter().sum()
        });
    });
}

fn spin(a: f64) -> impl FnOnce(&mut Renderer) {
    move |renderer| renderer.scene.hole.spin = a
}

fn method(a: f64, method: Method) -> impl FnOnce(&mut Renderer) {
    move |renderer| (renderer.scene.hole.spin, renderer.scene.quality.method) = (a, method)
}

fn gpu(criterion: &mut Criterion, times: &Times) {
    let software = Stage::new(None, [16, 16], |_| ()).renderer.adapter().software;
    let (name, size) = if software { ("1280x720", [1280, 720]) } else { ("3840x2160", [3840, 2160]) };
    for a in [0.0, 0.5, 0.9, 0.998] {
        measure(criterion, times, &format!("gpu {name} default scene, spin {a}"), Stage::new(None, size, spin(a)));
    }
    let no_disk = |renderer: &mut Renderer| renderer.scene.disk = None;
    measure(criterion, times, &format!("gpu {name} no disk, spin 0"), Stage::new(None, size, no_disk));
    let black = |renderer: &mut Renderer| renderer.scene.sky.flags = 0;
    measure(criterion, times, &format!("gpu {name} no stars, spin 0"), Stage::new(None, size, black));
    let rk4 = Stage::new(None, size, method(0.0, Method::Rk4));
    measure(criterion, times, &format!("gpu {name} RK4, spin 0"), rk4);
    let adaptive = Stage::new(None, size, method(0.0, Method::Adaptive));
    measure(criterion, times, &format!("gpu {name} ADAPTIVE, spin 0"), adaptive);
    if !software {
        for size in [[1920, 1080], [7680, 4320]] {
            let name = format!("gpu {}x{} default scene, spin 0.9", size[0], size[1]);
            measure(criterion, times, &name, Stage::new(None, size, spin(0.9)));
        }
    }
}

fn cpu(criterion: &mut Criterion, times: &Times) {
    let size = [1280, 720];
    for a in [0.0, 0.9] {
        let name = format!("cpu 1280x720 default scene, spin {a}");
        measure(criterion, times, &name, Stage::new(Some(Backend::Cpu), size, spin(a)));
    }
    let far = |renderer: &mut Renderer| {
        let position = renderer.scene.camera.position * 10.0;
        renderer.scene.camera = Camera { position, forward: -position, ..Camera::default() };
    };
    measure(criterion, times, "cpu 1280x720 from 300 M, spin 0", Stage::new(Some(Backend::Cpu), size, far));
}

fn main() {
    let times = Times::default();
    let adapter = Stage::new(None, [16, 16], |_| ()).renderer.adapter().clone();
    println!("GPU adapter: {}, driver {}", adapter.name, adapter.driver);
    // 100 frames a scene on hardware; software takes its time.
    let samples = if adapter.software { 10 } else { 100 };
    let mut criterion = Criterion::default()
        .sample_size(samples)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(if adapter.software { 5 } else { 1 }))
        .without_plots()
        .configure_from_args();
    gpu(&mut criterion, &times);
    let mut slow = criterion.sample_size(10);
    cpu(&mut slow, &times);
    println!("\n{:52} {:>8} {:>9} {:>9} {:>9}", "milliseconds a frame", "frames", "median", "5 %", "95 %");
    for (name, seconds) in times.borrow_mut().iter_mut() {
        seconds.sort_by(f64::total_cmp);
        let at = |share: f64| 1e3 * seconds[((seconds.len() - 1) as f64 * share).round() as usize];
        println!("{name:52} {:>8} {:>9.3} {:>9.3} {:>9.3}", seconds.len(), at(0.5), at(0.05), at(0.95));
    }
}
