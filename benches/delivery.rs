// SPDX-License-Identifier: MIT OR Apache-2.0
//! How frames get to the host: what presenting costs beyond tracing (into an off-screen image where no display
//! exists), what a submission costs the calling thread, how many frames a second jobs bring into the host's memory
//! beside what the GPU and the bus could, and how long one takes. `cargo bench --bench delivery`, or the program by
//! itself. Each line: median, 5 % and 95 % quantiles, count.

use bhr::gpu::{self, FrameTarget, GpuTimer, GpuTracer, Presenter, Readback, Search, read_time};
use bhr::image::{ImageMut, PixelFormat, memory::Layout};
use bhr::job::Job;
use bhr::renderer::{FrameRequest, Renderer, RendererOptions};
use bhr::scene::{Region, Scene};
use std::collections::VecDeque;
use std::time::{Duration, Instant};

const FULL_HD: [u32; 2] = [1920, 1080];
const ULTRA_HD: [u32; 2] = [3840, 2160];

fn line(name: &str, unit: &str, mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let at = |share: f64| values[((values.len() - 1) as f64 * share).round() as usize];
    println!("{name:<58} {:>9.4} / {:>9.4} / {:>9.4} {unit}  ({})", at(0.5), at(0.05), at(0.95), values.len());
    at(0.5)
}

fn milliseconds(start: Instant) -> f64 {
    1e3 * start.elapsed().as_secs_f64()
}

fn request([width, height]: [u32; 2]) -> FrameRequest {
    let region = Region { full_width: width, full_height: height, x: 0, y: 0 };
    FrameRequest { width, height, region, format: PixelFormat::Rgba8Srgb, transparent: false }
}

/// A turn of the scene, so that no two frames are the same.
fn turn(scene: &mut Scene, i: usize) {
    scene.camera.forward.x = 1e-4 * (i % 100) as f64;
}

fn frames(software: bool, many: usize) -> usize {
    if software { many / 20 } else { many }
}

/// Tracing into a texture, and presenting it into an image of a window's format.
fn presenting(spin: f64) {
    let adapter = gpu::adapters(Search::Auto, false).into_iter().next().expect("a GPU adapter");
    let software = adapter.info.software;
    let mut tracer = GpuTracer::new(adapter).expect("a tracer");
    let device = tracer.device();
    let mut scene = Scene::plain();
    scene.hole.spin = spin;
    // Frames that are written into the host's memory take as long as the bus.
    scene.quality.mapped_pixels = Some(false);
    let screen = device.screen(FULL_HD, false).expect("a texture");
    let format = wgpu::TextureFormat::Bgra8Unorm;
    let image = device
        .scoped("image", |d| {
            d.create_texture(&wgpu::TextureDescriptor {
                label: None,
                size: wgpu::Extent3d { width: FULL_HD[0], height: FULL_HD[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
                view_formats: &[],
            })
        })
        .expect("an image");
    let view = image.create_view(&Default::default());
    let presenter = Presenter::new(&device, format).expect("a presenter");
    let mut timer = GpuTimer::new(&device, 1).expect("a timer").expect("timestamps");
    let (mut packed, mut traced, mut drawn, mut calls) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for i in 0..frames(software, 400) {
        turn(&mut scene, i);
        let stats = tracer.render(&scene, &request(FULL_HD), &mut |_, _, _| Ok(()), &mut |_| true).expect("a frame");
        let start = Instant::now();
        let mut frame = tracer.begin(&scene, &request(FULL_HD), FrameTarget::screen(&screen)).expect("a frame");
        let mut of_screen = frame.stats();
        let mut steps = Vec::new();
        let mut time = None;
        let mut present = |encoder: &mut wgpu::CommandEncoder| {
            let pass = timer.next_pass().map(|pass| wgpu::RenderPassTimestampWrites {
                query_set: pass.query_set,
                beginning_of_pass_write_index: pass.beginning_of_pass_write_index,
                end_of_pass_write_index: pass.end_of_pass_write_index,
            });
            presenter.draw(&device, encoder, &screen, &view, FULL_HD, pass)?;
            time = timer.finish(&device, encoder)?;
            Ok(())
        };
        while let Some(step) = tracer.submit_and(&mut frame, &mut present).expect("a step") {
            steps.push(step);
        }
        let call = milliseconds(start);
        let submission = steps.last().expect("a step").submission().clone();
        let time = time.expect("a time");
        for step in steps {
            step.finish(&device, &mut of_screen, &mut |_, _, _| Ok(())).expect("a step");
        }
        let draw = read_time(&device, time, &submission).expect("a time");
        if i >= 3 {
            packed.push(1e-6 * stats.gpu_ns as f64);
            traced.push(1e-6 * of_screen.gpu_ns as f64);
            drawn.push(1e-6 * draw as f64);
            calls.push(call);
        }
    }
    println!("\n1920 x 1080, spin {spin}");
    if software {
        println!("(software: its timestamps mean nothing)");
    }
    let alone = line("GPU: tracing, packed for the host", "ms", packed);
    let traced = line("GPU: tracing into a window's texture", "ms", traced);
    let drawn = line("GPU: the triangle that presents it", "ms", drawn);
    println!("{:<58} {:>9.4} ms", "GPU: presenting beyond tracing", traced + drawn - alone);
    line("CPU: submitting the frame and the triangle", "ms", calls);
}

/// GB/s of copies from device to staging memory.
fn copy_bandwidth() -> f64 {
    let adapter = gpu::adapters(Search::Auto, false).into_iter().next().expect("a GPU adapter");
    let device = gpu::Device::open(&adapter).expect("a device");
    let bytes = u64::from(FULL_HD[0] * FULL_HD[1]) * 4;
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
    let source = device.buffer("source", bytes, usage).expect("a buffer");
    let copies = |count: usize| {
        let readback = Readback::new();
        let mut encoder = device.encoder("copies").expect("an encoder");
        let copied = (0..count)
            .map(|_| readback.copy(&device, &mut encoder, &source, bytes).expect("a copy"))
            .collect::<Vec<_>>();
        let start = Instant::now();
        device.submit_and_wait(encoder).expect("copies");
        let seconds = start.elapsed().as_secs_f64();
        drop(copied);
        seconds
    };
    copies(4);
    let rates = (0..20).map(|_| 32.0 * bytes as f64 / (copies(36) - copies(4)).max(1e-9) * 1e-9).collect();
    line("bus: copies of 8.3 MB to staging memory", "GB/s", rates)
}

/// Jobs one after another, `in_flight` at a time.
fn jobs(
    renderer: &mut Renderer,
    size: [u32; 2],
    in_flight: usize,
    count: usize,
) -> (f64, Vec<f64>, Vec<f64>, Vec<f64>) {
    let layout = Layout::packed(PixelFormat::Rgba8Srgb, size[0], size[1]);
    let bytes = (size[0] * size[1] * 4) as usize;
    // Targets live as long as the process: a job writes to them whatever becomes of this function.
    let mut targets =
        (0..in_flight).map(|_| Box::leak(vec![0_u8; bytes].into_boxed_slice())).map(|b| (b.as_mut_ptr(), b.len()));
    let targets = targets.by_ref().collect::<Vec<_>>();
    let mut under_way = VecDeque::<(Job, Instant)>::new();
    let (mut calls, mut latencies, mut readbacks) = (Vec::new(), Vec::new(), Vec::new());
    let mut start = Instant::now();
    let warm = 2 * in_flight + 4;
    for i in 0..count + warm {
        if under_way.len() == in_flight
            && let Some((job, requested)) = under_way.pop_front()
        {
            let stats = job.wait(None, &mut |_| true).expect("an end").expect("a frame");
            latencies.push(milliseconds(requested));
            readbacks.push(1e-6 * stats.readback_ns as f64);
        }
        if i == warm {
            start = Instant::now();
            for past in [&mut calls, &mut latencies, &mut readbacks] {
                past.clear();
            }
        }
        turn(&mut renderer.scene, i);
        let (pixels, length) = targets[i % in_flight];
        let requested = Instant::now();
        // SAFETY: leaked above, and the job before it in this target has ended.
        let target = unsafe { ImageMut::from_raw(layout, pixels, length as u64) }.expect("a target");
        let job = renderer.render_in_background(target, false, None).expect("a job");
        calls.push(milliseconds(requested));
        under_way.push_back((job, requested));
    }
    for (job, _) in under_way {
        job.wait(None, &mut |_| true).expect("an end").expect("a frame");
    }
    (count as f64 / start.elapsed().as_secs_f64(), calls, latencies, readbacks)
}

/// GPU milliseconds of frames that are packed on the device.
fn tracing_alone(renderer: &mut Renderer, count: usize) -> Vec<f64> {
    let mapped = renderer.scene.quality.mapped_pixels.replace(false);
    let mut pixels = vec![0; (FULL_HD[0] * FULL_HD[1] * 4) as usize];
    let mut traced = Vec::new();
    for i in 0..frames(renderer.adapter().software, count) {
        turn(&mut renderer.scene, i);
        let layout = Layout::packed(PixelFormat::Rgba8Srgb, FULL_HD[0], FULL_HD[1]);
        let mut image = ImageMut::new(layout, &mut pixels).expect("an image");
        renderer.render(&mut image, false, None, &mut |_| true).expect("a frame");
        traced.push(1e-6 * renderer.stats().gpu_ns as f64);
    }
    renderer.scene.quality.mapped_pixels = mapped;
    traced
}

fn main() {
    let mut renderer = Renderer::new(RendererOptions::default()).expect("a renderer");
    let adapter = renderer.adapter().clone();
    println!("{} ({}), {}", adapter.name, adapter.backend, adapter.driver);
    println!("{:<58} {:>9}   {:>9}   {:>9}", "", "median", "5 %", "95 %");
    for spin in [0.0, 0.9] {
        presenting(spin);
    }
    println!();
    let bus = copy_bandwidth();
    for spin in [0.0, 0.9] {
        renderer.scene = Scene::plain();
        renderer.scene.hole.spin = spin;
        println!("\njobs, 1920 x 1080 RGBA8, spin {spin}");
        std::thread::sleep(Duration::from_secs(1));
        line("GPU: tracing alone, after a second of idleness", "ms", tracing_alone(&mut renderer, 100));
        // A GPU that was idle, or waited for the host at most times, has lowered its clocks.
        jobs(&mut renderer, FULL_HD, 4, frames(adapter.software, 4000));
        let traced = line("GPU: tracing alone", "ms", tracing_alone(&mut renderer, 200));
        for (in_flight, mapped) in [(4, Some(false)), (1, None), (3, None), (4, None), (8, None)] {
            renderer.scene.quality.mapped_pixels = mapped;
            let count = frames(adapter.software, 1000);
            let (rate, calls, latencies, readbacks) = jobs(&mut renderer, FULL_HD, in_flight, count);
            let way = if mapped == Some(false) { "packed on the device, then copied" } else { "as the device has it" };
            println!("{in_flight} in flight, {way}: {rate:.0} frames/s, {:.2} GB/s", rate * 8.2944e-3);
            line("    request to end", "ms", latencies);
            line("    the call that requests", "ms", calls);
            line("    staging memory to the host's", "ms", readbacks);
            if !adapter.software {
                let possible = (1e3 / traced).min(bus / 8.2944e-3);
                println!("    {:.0} % of min(tracing alone, bus) = {possible:.0} frames/s", 100.0 * rate / possible);
            }
        }
        println!("jobs, 3840 x 2160 RGBA8, spin {spin}");
        let (_, _, latencies, readbacks) = jobs(&mut renderer, ULTRA_HD, 1, frames(adapter.software, 200));
        line("    request to end", "ms", latencies);
        line("    staging memory to the host's", "ms", readbacks);
    }
}
