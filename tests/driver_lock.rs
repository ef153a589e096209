// SPDX-License-Identifier: MIT OR Apache-2.0
//! Everything that begins or ends the use of a driver happens under the process's one lock, whoever does it last. The
//! test is alone in its process, as it listens to wgpu's log. Without a Vulkan adapter it fails.

use bhr::gpu::{GpuTracer, Search, adapters, driver_lock};
use bhr::image::{ImageMut, PixelFormat, memory::Layout};
use bhr::renderer::{Backend, Renderer, RendererOptions};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// How wgpu's messages about drivers begin, those about what must not be done by two threads at once.
const ALONE: [&str; 6] = [
    "Instance::new: created",
    "Instance::enumerate_adapters",
    "Adapter::create_device",
    "Drop Device",
    "Global::drop",
    FIRST_PIPELINE,
];
/// The message of a device's first pipeline.
const FIRST_PIPELINE: &str = "Device::create_compute_pipeline";

/// Messages of [`ALONE`], and whether their thread held the lock.
static HEARD: Mutex<Vec<(String, bool)>> = Mutex::new(Vec::new());

fn heard() -> MutexGuard<'static, Vec<(String, bool)>> {
    HEARD.lock().unwrap_or_else(PoisonError::into_inner)
}

struct Recorder;

impl log::Log for Recorder {
    fn enabled(&self, _: &log::Metadata<'_>) -> bool {
        true
    }

    fn log(&self, record: &log::Record<'_>) {
        let message = record.args().to_string();
        if ALONE.iter().any(|begin| message.starts_with(begin)) {
            heard().push((message, driver_lock::is_held()));
        }
    }

    fn flush(&self) {}
}

fn options() -> RendererOptions {
    RendererOptions { backend: Some(Backend::Vulkan), ..RendererOptions::default() }
}

fn render(renderer: &mut Renderer) {
    let mut pixels = vec![0; 64 * 36 * 4];
    let mut image = ImageMut::new(Layout::packed(PixelFormat::Rgba8Srgb, 64, 36), &mut pixels).unwrap();
    renderer.render(&mut image, false, None, &mut |_| true).unwrap();
}

/// All that was heard since the last call was alone; pipelines but the first of each device were not.
fn check(case: &str, devices: usize, instances: usize) {
    let messages = std::mem::take(&mut *heard());
    let count = |begin: &str| messages.iter().filter(|(message, _)| message.starts_with(begin)).count();
    assert_eq!(count("Adapter::create_device"), devices, "{case}: {messages:#?}");
    assert_eq!(count("Drop Device"), devices, "{case}: {messages:#?}");
    assert_eq!(count("Global::drop"), instances, "{case}: {messages:#?}");
    let mut first = true;
    for (message, held) in &messages {
        let pipeline = message.starts_with(FIRST_PIPELINE);
        assert_eq!(*held, first || !pipeline, "{case}: {message} in {messages:#?}");
        first = (first && !pipeline) || message.starts_with("Adapter::create_device");
    }
}

#[test]
fn drivers_begin_and_end_under_the_lock() {
    log::set_logger(&Recorder).unwrap();
    log::set_max_level(log::LevelFilter::Trace);

    drop(adapters(Search::Only(Backend::Gl), false));
    check("the first search for GL, whose instance stays for the display's sake", 0, 0);
    drop(adapters(Search::Only(Backend::Gl), false));
    check("a search that keeps nothing", 0, 1);

    assert!(!adapters(Search::Only(Backend::Vulkan), false).is_empty(), "this test needs a Vulkan adapter");
    check("a search that keeps what it finds", 0, 0);

    let mut renderer = Renderer::new(options()).unwrap();
    render(&mut renderer);
    drop(renderer);
    check("a frame", 1, 0);

    let mut renderer = Renderer::new(options()).unwrap();
    render(&mut renderer);
    renderer.recover().unwrap();
    render(&mut renderer);
    drop(renderer);
    check("a recovery", 2, 1);

    let mut renderer = Renderer::new(options()).unwrap();
    let mut pixels = vec![0_u8; 640 * 360 * 4];
    let layout = Layout::packed(PixelFormat::Rgba8Srgb, 640, 360);
    // SAFETY: the pixels outlive the job.
    let target = unsafe { ImageMut::from_raw(layout, pixels.as_mut_ptr(), pixels.len() as u64) }.unwrap();
    let job = renderer.render_in_background(target, false, None).unwrap();
    drop(renderer);
    assert!(job.wait(None, &mut |_| true).is_some_and(|outcome| outcome.is_ok()));
    drop(job);
    check("a job that is there when its renderer goes", 1, 0);

    let tracer = GpuTracer::new(adapters(Search::Only(Backend::Vulkan), false).remove(0)).unwrap();
    let device = tracer.device();
    drop(tracer);
    std::thread::spawn(move || drop(device)).join().unwrap();
    check("a device that ends on another thread", 1, 0);
}
