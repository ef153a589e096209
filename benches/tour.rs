// SPDX-License-Identifier: MIT OR Apache-2.0
//! How long a host waits for frames that are the first of their kind: from the context on, through a tour of spins,
//! effects, views, projections and formats. `cargo bench --bench tour -- [WxH] [hold ms] [cpu|vulkan|gl] [--verbose]`.
//! For each step the slowest frame and the one in the middle, by wall time from the call to the pixels in memory; the
//! host asks for 60 frames a second meanwhile. To see what users see once, run it with the driver's cache of shaders
//! off: MESA_SHADER_CACHE_DISABLE=true, __GL_SHADER_DISK_CACHE=0.

use bhr::image::{ImageMut, PixelFormat, memory::Layout};
use bhr::renderer::{Backend, Renderer, RendererOptions};
use bhr::scene::{Motion, Projection, Scene, View};
use std::time::{Duration, Instant};

type Change = fn(&mut Scene, &mut PixelFormat);

/// Name of the step, and what the host changes in it.
const TOUR: [(&str, Change); 20] = [
    ("the default scene", |_, _| ()),
    ("spin 0.3", |scene, _| scene.hole.spin = 0.3),
    ("spin 0.9", |scene, _| scene.hole.spin = 0.9),
    ("bloom", |scene, _| scene.film.bloom = 0.2),
    ("turbulence", |scene, _| {
        if let Some(disk) = &mut scene.disk {
            disk.turbulence = 1.0;
        }
    }),
    ("view REDSHIFT", |scene, _| scene.view = View::Redshift),
    ("view ORDER", |scene, _| scene.view = View::Order),
    ("view DEFLECTION", |scene, _| scene.view = View::Deflection),
    ("view STEPS", |scene, _| scene.view = View::Steps),
    ("view LIGHT, no bloom", |scene, _| {
        scene.view = View::Light;
        scene.film.bloom = 0.0;
    }),
    ("FISHEYE", |scene, _| scene.camera.projection = Projection::Fisheye),
    ("EQUIRECT", |scene, _| scene.camera.projection = Projection::Equirect),
    ("PERSPECTIVE, moving", |scene, _| {
        scene.camera.projection = Projection::Perspective;
        scene.camera.motion = Motion::Velocity;
        scene.camera.velocity.x = 0.3;
    }),
    ("RGBA16F", |_, format| *format = PixelFormat::Rgba16F),
    ("RGBA32F", |_, format| *format = PixelFormat::Rgba32F),
    ("BGRA8_SRGB", |_, format| *format = PixelFormat::Bgra8Srgb),
    ("four samples", |scene, _| scene.quality.samples_per_pixel = 4),
    ("spin 0 again", |scene, _| {
        scene.quality.samples_per_pixel = 1;
        scene.hole.spin = 0.0;
    }),
    ("free fall", |scene, _| scene.camera.motion = Motion::FreeFall),
    ("no disk", |scene, _| scene.disk = None),
];

/// Prints what bhr logs and when, for `--verbose`.
struct Printer(Instant);

impl log::Log for Printer {
    fn enabled(&self, metadata: &log::Metadata<'_>) -> bool {
        metadata.target().starts_with("bhr")
    }

    fn log(&self, record: &log::Record<'_>) {
        if self.enabled(record.metadata()) {
            println!("    {:9.1} {}", 1e3 * self.0.elapsed().as_secs_f64(), record.args());
        }
    }

    fn flush(&self) {}
}

/// The frame time that a display asks for.
const FRAME_TIME: Duration = Duration::from_nanos(16_666_667);

fn main() {
    let arguments = std::env::args().skip(1).filter(|word| !word.starts_with("--")).collect::<Vec<_>>();
    if std::env::args().any(|word| word == "--verbose") {
        log::set_logger(Box::leak(Box::new(Printer(Instant::now())))).expect("no other logger");
        log::set_max_level(log::LevelFilter::Debug);
    }
    let size = arguments.first().map_or("1920x1080", String::as_str);
    let hold = arguments.get(1).map_or(1000, |ms| ms.parse().expect("milliseconds"));
    let backend = arguments.get(2).map(|name| match name.as_str() {
        "cpu" => Backend::Cpu,
        "gl" => Backend::Gl,
        _ => Backend::Vulkan,
    });
    let (width, height) = size.split_once('x').expect("WxH");
    let [width, height] = [width, height].map(|side| side.parse::<u32>().expect("pixels"));
    let mut pixels = vec![0; width as usize * height as usize * 16];
    let started = Instant::now();
    let mut renderer = Renderer::new(RendererOptions { backend, ..Default::default() }).expect("a renderer");
    let opened = started.elapsed();
    println!("{}, {width} x {height}, {hold} ms a step; milliseconds", renderer.adapter().name);
    println!("{:24} {:>9.1}", "context", 1e3 * opened.as_secs_f64());
    println!("{:24} {:>9} {:>9} {:>7}", "step", "slowest", "middle", "frames");
    let mut format = PixelFormat::Rgba8Srgb;
    for (index, (name, change)) in TOUR.iter().enumerate() {
        change(&mut renderer.scene, &mut format);
        let begun = Instant::now();
        let mut times = Vec::new();
        while times.is_empty() || begun.elapsed() < Duration::from_millis(hold) {
            let frame = Instant::now();
            let layout = Layout::packed(format, width, height);
            let mut target = ImageMut::new(layout, &mut pixels).expect("a target");
            renderer.render(&mut target, false, None, &mut |_| true).expect("a frame");
            times.push(1e3 * frame.elapsed().as_secs_f64());
            if index == 0 && times.len() == 1 {
                println!("{:24} {:>9.1}", "context + first frame", 1e3 * started.elapsed().as_secs_f64());
            }
            std::thread::sleep(FRAME_TIME.saturating_sub(frame.elapsed()));
        }
        times.sort_by(f64::total_cmp);
        println!("{name:24} {:>9.1} {:>9.1} {:>7}", times[times.len() - 1], times[times.len() / 2], times.len());
    }
    let started = Instant::now();
    drop(renderer);
    println!("{:24} {:>9.1}", "end of the context", 1e3 * started.elapsed().as_secs_f64());
}
