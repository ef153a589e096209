// SPDX-License-Identifier: MIT OR Apache-2.0
//! The device layer of the GPU tracer on a real adapter; lavapipe will do. Without a Vulkan adapter these tests fail.

use bhr::error::{ErrorKind, Result};
use bhr::gpu::{
    Adapter, Buffer, Device, GpuTimer, GpuTracer, Kernel, Loops, Readback, Search, adapters, forget_drivers, read_time,
};
use bhr::image::PixelFormat;
use bhr::renderer::{Backend, FrameRequest, Tile};
use bhr::scene::{Region, Scene};
use std::time::{Duration, Instant};
use wgpu::BufferUsages;

const DOUBLE: &str = "
@group(0) @binding(0) var<storage, read_write> values: array<u32>;
override factor: u32 = 2u;
@compute @workgroup_size(64)
fn scale(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < arrayLength(&values) { values[id.x] = factor * values[id.x] + offset; }
}";
const OFFSET: &str = "const offset = 1u;";

fn adapter() -> Adapter {
    let mut found = adapters(Search::Only(Backend::Vulkan), false);
    assert!(!found.is_empty(), "these tests need a Vulkan adapter; lavapipe (mesa-vulkan-drivers) will do");
    found.remove(0)
}

fn device() -> Device {
    Device::open(&adapter()).unwrap()
}

fn layout(device: &Device) -> Result<wgpu::BindGroupLayout> {
    let entry = wgpu::BindGroupLayoutEntry {
        binding: 0,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only: false },
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    };
    let descriptor = wgpu::BindGroupLayoutDescriptor { label: None, entries: &[entry] };
    device.scoped("layout", |d| d.create_bind_group_layout(&descriptor))
}

fn kernel<'a>(source: &'a [&'a str], groups: &'a [&'a wgpu::BindGroupLayout]) -> Kernel<'a> {
    Kernel {
        label: "scale",
        source,
        loops: Loops::Counted,
        entry_point: "scale",
        constants: &[],
        zero_workgroup_memory: false,
        groups,
    }
}

/// A buffer of values and what it takes to scale them.
struct Scaling {
    values: Buffer,
    group: wgpu::BindGroup,
    pipeline: wgpu::ComputePipeline,
}

impl Scaling {
    fn new(device: &Device, values: &[u32], constants: &[(&str, f64)]) -> Result<Self> {
        let layout = layout(device)?;
        let groups = [&layout];
        let kernel = Kernel { constants, ..kernel(&[DOUBLE, OFFSET], &groups) };
        let pipeline = device.compute_pipeline(&kernel)?;
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
        let buffer = device.buffer("values", size_of_val(values) as u64, usage)?;
        device.write(&buffer, 0, bytemuck::cast_slice(values))?;
        let entries = [wgpu::BindGroupEntry { binding: 0, resource: buffer.as_entire_binding() }];
        let descriptor = wgpu::BindGroupDescriptor { label: None, layout: &layout, entries: &entries };
        let group = device.scoped("group", |d| d.create_bind_group(&descriptor))?;
        Ok(Self { values: buffer, group, pipeline })
    }

    fn record(&self, encoder: &mut wgpu::CommandEncoder, timestamps: Option<wgpu::ComputePassTimestampWrites<'_>>) {
        let descriptor = wgpu::ComputePassDescriptor { label: None, timestamp_writes: timestamps };
        let mut pass = encoder.begin_compute_pass(&descriptor);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        pass.dispatch_workgroups((self.values.size() as u32 / 4).div_ceil(64), 1, 1);
    }

    fn run(&self, device: &Device, readback: &Readback) -> Result<Vec<u32>> {
        let mut encoder = device.encoder("scale")?;
        self.record(&mut encoder, None);
        let copied = readback.copy(device, &mut encoder, &self.values, self.values.size())?;
        let submission = device.submit(encoder)?;
        copied.read(device, &submission, |bytes| Ok(bytemuck::cast_slice(bytes).to_vec()))
    }
}

fn round_trip(device: &Device) -> Result<()> {
    let input = (0..1000).collect::<Vec<u32>>();
    let output = Scaling::new(device, &input, &[("factor", 3.0)])?.run(device, &Readback::new())?;
    assert_eq!(output, input.iter().map(|v| 3 * v + 1).collect::<Vec<_>>());
    Ok(())
}

#[test]
fn lists_adapters_best_first_and_the_same_each_time() {
    let list = || adapters(Search::All, false).into_iter().map(|a| a.info).collect::<Vec<_>>();
    let (first, second) = (list(), list());
    assert!(first.iter().any(|a| a.backend == Backend::Vulkan), "no Vulkan adapter: {first:?}");
    assert_eq!(format!("{first:?}"), format!("{second:?}"));
    assert!(first.iter().all(|a| !(a.name.is_empty() || a.discrete && a.software)), "{first:?}");
    assert!(first.is_sorted_by_key(|a| a.software), "software before hardware: {first:?}");
    assert!(first.iter().filter(|a| a.software && a.backend == Backend::Vulkan).all(|a| !a.driver.is_empty()));
}

#[test]
fn a_search_keeps_to_its_interfaces() {
    assert!(adapters(Search::Only(Backend::Vulkan), false).iter().all(|a| a.info.backend == Backend::Vulkan));
    assert!(adapters(Search::Only(Backend::Gl), false).iter().all(|a| a.info.backend == Backend::Gl));
    assert!(adapters(Search::Only(Backend::Cpu), false).is_empty());
}

#[test]
fn auto_takes_hardware_before_software_and_no_software_of_gl() {
    let auto = adapters(Search::Auto, false).into_iter().map(|a| a.info).collect::<Vec<_>>();
    assert!(auto.iter().any(|a| a.backend == Backend::Vulkan), "no Vulkan adapter: {auto:?}");
    assert!(auto.is_sorted_by_key(|a| a.software), "software before hardware: {auto:?}");
    assert!(auto.iter().all(|a| !a.software || a.backend != Backend::Gl), "software GL was not asked for: {auto:?}");
    // Hardware that no other interface reaches is taken by GL.
    let hardware = adapters(Search::All, false).iter().any(|a| !a.info.software);
    assert_eq!(auto.first().is_some_and(|a| !a.software), hardware, "{auto:?}");
}

#[test]
fn computes_and_reads_back() {
    round_trip(&device()).unwrap();
}

#[test]
fn computes_on_gl_too() {
    for adapter in adapters(Search::Only(Backend::Gl), false) {
        round_trip(&Device::open(&adapter).unwrap()).unwrap();
    }
}

#[test]
fn computes_with_validation_on() {
    let found = adapters(Search::Only(Backend::Vulkan), true);
    round_trip(&Device::open(&found[0]).unwrap()).unwrap();
}

#[test]
fn reads_a_piece_while_the_next_is_made() {
    let device = device();
    let scaling = Scaling::new(&device, &[1; 256], &[]).unwrap();
    let readback = Readback::new();
    let submit = |readback: &Readback| {
        let mut encoder = device.encoder("piece").unwrap();
        scaling.record(&mut encoder, None);
        let copied = readback.copy(&device, &mut encoder, &scaling.values, 1024).unwrap();
        (copied, device.submit(encoder).unwrap())
    };
    let mut last = submit(&readback);
    for turn in 1..20u32 {
        let next = submit(&readback);
        let (copied, submission) = std::mem::replace(&mut last, next);
        let expected = (1u32 << (turn + 1)) - 1;
        copied
            .read(&device, &submission, |bytes| {
                assert_eq!(bytemuck::cast_slice::<u8, u32>(bytes), [expected; 256]);
                Ok(())
            })
            .unwrap();
    }
}

#[test]
fn many_pieces_under_way_are_read_in_any_order() {
    let device = device();
    let scaling = Scaling::new(&device, &[1; 16], &[]).unwrap();
    let readback = Readback::new();
    let submit = || {
        let mut encoder = device.encoder("piece").unwrap();
        scaling.record(&mut encoder, None);
        let copied = readback.copy(&device, &mut encoder, &scaling.values, 64).unwrap();
        (copied, device.submit(encoder).unwrap())
    };
    let mut pieces = (1..=8u32).map(|turn| ((1u32 << (turn + 1)) - 1, submit())).collect::<Vec<_>>();
    let used = device.bytes();
    pieces.rotate_left(5);
    for (expected, (copied, submission)) in pieces {
        copied
            .read(&device, &submission, |bytes| {
                assert_eq!(bytemuck::cast_slice::<u8, u32>(bytes), [expected; 16]);
                Ok(())
            })
            .unwrap();
    }
    assert!(device.bytes() < used, "no more staging buffers stay than are usually needed");
}

#[test]
fn a_failing_or_panicking_reader_leaves_the_staging_buffer_usable() {
    let device = device();
    let scaling = Scaling::new(&device, &[1; 16], &[]).unwrap();
    let readback = Readback::new();
    for turn in 0..4 {
        let mut encoder = device.encoder("reader").unwrap();
        let copied = readback.copy(&device, &mut encoder, &scaling.values, 64).unwrap();
        let submission = device.submit(encoder).unwrap();
        let read = std::panic::AssertUnwindSafe(|| {
            copied.read(&device, &submission, |_| match turn % 2 {
                0 => Err::<(), _>(bhr::error::Error::state("the reader's own")),
                _ => panic!("the reader's own"),
            })
        });
        match std::panic::catch_unwind(read) {
            Ok(result) => assert_eq!(result.unwrap_err().kind, ErrorKind::InvalidState),
            Err(_) => assert_eq!(turn % 2, 1),
        }
    }
    scaling.run(&device, &readback).unwrap();
}

#[test]
fn times_passes() {
    let device = device();
    assert!(device.has_timestamps(), "lavapipe and every desktop driver have timestamps");
    let scaling = Scaling::new(&device, &vec![1; 1 << 16], &[]).unwrap();
    let mut timer = GpuTimer::new(&device, 2).unwrap().unwrap();
    let start = Instant::now();
    let mut encoder = device.encoder("timed").unwrap();
    for _ in 0..2 {
        scaling.record(&mut encoder, timer.next_pass());
    }
    assert!(timer.next_pass().is_none(), "a third pass is beyond the capacity");
    let copied = timer.finish(&device, &mut encoder).unwrap().unwrap();
    let submission = device.submit(encoder).unwrap();
    let spent = read_time(&device, copied, &submission).unwrap();
    assert!(u128::from(spent) <= start.elapsed().as_nanos(), "{spent} ns");
    assert!(timer.finish(&device, &mut device.encoder("empty").unwrap()).unwrap().is_none());
}

#[test]
fn a_rejected_request_is_an_error_and_the_device_goes_on() {
    let device = device();
    let layout = layout(&device).unwrap();
    let groups = [&layout];
    let faulty = [
        ("unknown identifier", kernel(&[DOUBLE], &groups)),
        ("missing entry point", Kernel { entry_point: "none", ..kernel(&[DOUBLE, OFFSET], &groups) }),
        ("unknown constant", Kernel { constants: &[("none", 1.0)], ..kernel(&[DOUBLE, OFFSET], &groups) }),
        ("missing layout", kernel(&[DOUBLE, OFFSET], &[])),
    ];
    for (case, kernel) in faulty {
        let error = device.compute_pipeline(&kernel).unwrap_err();
        assert_eq!(error.kind, ErrorKind::Internal, "{case}");
        assert!(error.message.starts_with("scale: ") && error.message.len() > 20, "{case}: {error}");
    }
    let small = device.buffer("small", 16, BufferUsages::COPY_SRC).unwrap();
    let mut encoder = device.encoder("overrun").unwrap();
    let copied = Readback::new().copy(&device, &mut encoder, &small, 64).unwrap();
    let error = device.submit(encoder).unwrap_err();
    assert_eq!(error.kind, ErrorKind::Internal, "{error}");
    drop(copied);
    round_trip(&device).unwrap();
}

#[test]
fn an_error_outside_every_scope_is_returned_once() {
    let device = device();
    let raw = device.scoped("clone", Clone::clone).unwrap();
    drop(raw.create_query_set(&wgpu::QuerySetDescriptor { label: None, ty: wgpu::QueryType::Timestamp, count: 0 }));
    assert_eq!(device.check().unwrap_err().kind, ErrorKind::Internal);
    round_trip(&device).unwrap();
}

#[test]
fn sizes_beyond_the_limits_name_the_size_and_the_limit() {
    let device = device();
    let limits = device.limits().clone();
    // Outputs in targets take one each; adapters with fewer serve all else.
    assert!(limits.max_storage_buffers_per_shader_stage <= 12, "asks for more than it uses");
    let cases = [
        (BufferUsages::COPY_DST, limits.max_buffer_size),
        (BufferUsages::STORAGE, limits.max_storage_buffer_binding_size),
        (BufferUsages::UNIFORM, limits.max_uniform_buffer_binding_size),
    ];
    for (usage, limit) in cases {
        let Err(error) = device.buffer("big", limit + 1, usage) else { panic!("{usage:?} of {} bytes", limit + 1) };
        assert_eq!(error.kind, ErrorKind::Unsupported);
        for part in ["'big'".to_owned(), (limit + 1).to_string(), format!("{limit} bytes")] {
            assert!(error.message.contains(&part), "{part} is not in: {error}");
        }
    }
    assert_eq!(device.buffer("none", 0, BufferUsages::COPY_DST).err().unwrap().kind, ErrorKind::Internal);
    assert_eq!(device.buffer("huge", u64::MAX, BufferUsages::COPY_DST).err().unwrap().kind, ErrorKind::Unsupported);
    assert_eq!(device.bytes(), 0);
}

#[test]
fn counts_the_bytes_it_holds() {
    let device = device();
    let first = device.buffer("first", 1001, BufferUsages::COPY_DST).unwrap();
    assert_eq!(device.bytes(), 1004);
    let second = device.buffer("second", 4096, BufferUsages::STORAGE).unwrap();
    assert_eq!(device.bytes(), 5100);
    drop(first);
    assert_eq!(device.bytes(), 4096);
    drop(device);
    drop(second);
}

#[test]
fn a_lost_device_is_an_error_in_every_call() {
    let device = device();
    let scaling = Scaling::new(&device, &[1; 16], &[]).unwrap();
    let readback = Readback::new();
    let mut before = device.encoder("before").unwrap();
    let copied = readback.copy(&device, &mut before, &scaling.values, 64).unwrap();
    let submission = device.submit(before).unwrap();
    let encoder = device.encoder("during").unwrap();
    destroy(&device);

    let start = Instant::now();
    assert_eq!(device.submit_and_wait(encoder).unwrap_err().kind, ErrorKind::DeviceLost);
    assert_eq!(device.check().unwrap_err().kind, ErrorKind::DeviceLost);
    assert_eq!(device.encoder("after").unwrap_err().kind, ErrorKind::DeviceLost);
    assert_eq!(device.buffer("after", 4, BufferUsages::COPY_DST).err().unwrap().kind, ErrorKind::DeviceLost);
    assert_eq!(device.write(&scaling.values, 0, &[0; 4]).unwrap_err().kind, ErrorKind::DeviceLost);
    assert_eq!(scaling.run(&device, &readback).unwrap_err().kind, ErrorKind::DeviceLost);
    let late = copied.read(&device, &submission, |_| Ok(()));
    assert_eq!(late.unwrap_err().kind, ErrorKind::DeviceLost);
    assert_eq!(round_trip(&device).unwrap_err().kind, ErrorKind::DeviceLost);
    assert!(start.elapsed().as_secs() < 60, "took {:?}", start.elapsed());
}

#[test]
fn what_a_lost_device_reports_is_its_loss() {
    let device = device();
    destroy(&device);
    // wgpu has not told of it yet: nothing was waited for.
    let invalid = device.buffer("after", 4, BufferUsages::COPY_DST).unwrap();
    invalid.unmap();
    assert_eq!(device.check().unwrap_err().kind, ErrorKind::DeviceLost);
}

#[test]
fn work_that_a_lost_device_drops_is_its_loss() {
    let device = device();
    destroy(&device);
    let encoder = device.encoder("after").unwrap();
    let dropped = device.submit(encoder).unwrap();
    assert_eq!(device.is_done(&dropped).unwrap_err().kind, ErrorKind::DeviceLost);
}

#[test]
fn a_device_lost_during_a_readback_is_an_error() {
    let device = device();
    let scaling = Scaling::new(&device, &[1; 16], &[]).unwrap();
    let readback = Readback::new();
    let mut encoder = device.encoder("readback").unwrap();
    let copied = readback.copy(&device, &mut encoder, &scaling.values, 64).unwrap();
    let submission = device.submit(encoder).unwrap();
    destroy(&device);
    let error = copied.read(&device, &submission, |_| Ok(())).unwrap_err();
    assert_eq!(error.kind, ErrorKind::DeviceLost, "{error}");
    drop(device);
    drop(readback);
}

/// wgpu frees all memory of a device that has ended, on whichever thread polls it next.
#[test]
fn memory_that_is_being_read_stays_when_the_device_ends() {
    let device = device();
    let size = 64 << 20;
    let source = device.buffer("source", size, BufferUsages::COPY_SRC).unwrap();
    let mut encoder = device.encoder("readback").unwrap();
    let copied = Readback::new().copy(&device, &mut encoder, &source, size).unwrap();
    let submission = device.submit(encoder).unwrap();
    let (reading, begun) = std::sync::mpsc::channel();
    let read = std::thread::scope(|scope| {
        let of_end = submission.clone();
        let device = &device;
        let ending = scope.spawn(move || {
            begun.recv().unwrap();
            destroy(device);
            device.is_done(&of_end)
        });
        let read = copied.read(device, &submission, |bytes| {
            reading.send(()).unwrap();
            let end = Instant::now() + Duration::from_millis(300);
            let mut sum = 0;
            while Instant::now() < end {
                sum += bytes.iter().step_by(1024).map(|byte| u64::from(*byte)).sum::<u64>();
            }
            Ok(sum)
        });
        assert_eq!(ending.join().unwrap().unwrap_err().kind, ErrorKind::DeviceLost);
        read
    });
    assert_eq!(read.unwrap(), 0);
}

/// Pixels are taken in bands, and a device may end between two of them.
#[test]
fn a_frame_whose_device_ends_while_it_is_copied_is_lost() {
    let mut tracer = GpuTracer::new(adapter()).unwrap();
    let device = tracer.device();
    // More than a band: 24 MB.
    let (width, height) = (1500, 1000);
    let request = FrameRequest {
        width,
        height,
        region: Region { full_width: width, full_height: height, x: 0, y: 0 },
        format: PixelFormat::Rgba32F,
        transparent: false,
    };
    let scene = Scene { disk: None, ..Scene::plain() };
    let (copying, begun) = std::sync::mpsc::channel();
    let (ended, end) = std::sync::mpsc::channel();
    let end = std::sync::Mutex::new(end);
    let mut taken = 0;
    let rendered = std::thread::scope(|scope| {
        let device = &device;
        scope.spawn(move || {
            begun.recv().unwrap();
            destroy(device);
            ended.send(()).unwrap();
            while device.check().is_ok() {
                let _ = device.submit_and_wait(device.encoder("nothing").unwrap());
            }
        });
        let mut sink = |_: Tile, pixels: &[u8], _: usize| {
            if taken == 0 {
                copying.send(()).unwrap();
                end.lock().unwrap().recv().unwrap();
                std::thread::sleep(Duration::from_millis(100));
            }
            taken += pixels.len();
            // All of them are still there.
            assert!(pixels.iter().map(|byte| u64::from(*byte)).sum::<u64>() > 0);
            Ok(())
        };
        tracer.render(&scene, &request, &mut sink, &mut |_| true)
    });
    let all = (width * height) as usize * 16;
    assert!(taken > 0, "no band was taken");
    match rendered {
        // On a busy machine the device may end after the last band.
        Ok(_) => assert_eq!(taken, all),
        Err(error) => assert_eq!(error.kind, ErrorKind::DeviceLost),
    }
}

/// Ends the device, as a driver may. Another thread may tell of the loss before the call that brings it about returns.
fn destroy(device: &Device) {
    if let Err(error) = device.scoped("destroy", |d| d.destroy()) {
        assert_eq!(error.kind, ErrorKind::DeviceLost, "{error}");
    }
}

/// Uploads, kernels and readbacks, losses at moments of all kinds, and a third thread that polls. Small enough for
/// valgrind.
#[test]
fn a_device_may_end_at_any_moment_of_a_round_trip() {
    for round in 0..40 {
        let device = device();
        let input = vec![1; 1 << 16];
        let scaling = Scaling::new(&device, &input, &[]).unwrap();
        let readback = Readback::new();
        let output = scaling.run(&device, &readback).unwrap();
        assert!(output.iter().all(|value| *value == 3));
        let failed = std::thread::scope(|scope| {
            let device = &device;
            scope.spawn(move || {
                std::thread::sleep(Duration::from_micros(200 * round));
                destroy(device);
            });
            scope.spawn(move || {
                while device.check().is_ok() {
                    let _ = device.scoped("poll", |d| d.poll(wgpu::PollType::Poll));
                }
            });
            let round_trip = || {
                device.write(&scaling.values, 0, bytemuck::cast_slice(&input))?;
                let output = scaling.run(device, &readback)?;
                assert!(output.iter().all(|value| *value == 3), "{:?}", &output[..4]);
                Ok(())
            };
            std::iter::repeat_with(round_trip).find_map(|done: Result<()>| done.err())
        });
        assert_eq!(failed.unwrap().kind, ErrorKind::DeviceLost, "round {round}");
    }
}

/// A device may end at any moment of a frame, too.
#[test]
fn a_device_may_end_at_any_moment_of_a_frame() {
    let request = FrameRequest {
        width: 160,
        height: 90,
        region: Region { full_width: 160, full_height: 90, x: 0, y: 0 },
        format: PixelFormat::Rgba8Srgb,
        transparent: false,
    };
    let mut frames = 0;
    for round in 0..12 {
        let mut tracer = GpuTracer::new(adapter()).unwrap();
        let device = tracer.device();
        // The pipelines take long; afterwards a frame takes a few milliseconds.
        let early = round % 3 == 0;
        let mut render = |frames: &mut u32| {
            let mut sum = 0_u64;
            let mut sink = |_: Tile, pixels: &[u8], _: usize| {
                sum += pixels.iter().map(|byte| u64::from(*byte)).sum::<u64>();
                Ok(())
            };
            let rendered = tracer.render(&Scene::plain(), &request, &mut sink, &mut |_| true);
            *frames += u32::from(rendered.is_ok());
            rendered.map(|_| sum)
        };
        if !early {
            assert!(render(&mut frames).unwrap() > 0);
        }
        let failed = std::thread::scope(|scope| {
            let device = &device;
            scope.spawn(move || {
                std::thread::sleep(Duration::from_micros(700 * round));
                destroy(device);
            });
            scope.spawn(move || {
                let end = Instant::now() + Duration::from_secs(60);
                while device.check().is_ok() && Instant::now() < end {
                    // A failure that is no loss: it looks for one.
                    let _ = device.buffer("none", 0, BufferUsages::COPY_DST);
                    let _ = device.scoped("poll", |d| d.poll(wgpu::PollType::Poll));
                }
            });
            (0..100_000).find_map(|_| render(&mut frames).err())
        });
        assert_eq!(failed.unwrap().kind, ErrorKind::DeviceLost, "round {round}");
        assert_eq!(render(&mut frames).unwrap_err().kind, ErrorKind::DeviceLost, "round {round}");
    }
    assert!(frames >= 8);
}

/// Another thread may be making the images of a window of the same device: nothing may be submitted then.
#[test]
fn a_failure_is_looked_into_without_submitting_anything() {
    let device = device();
    let submit = || device.submit(device.encoder("empty").unwrap()).unwrap();
    let layout = layout(&device).unwrap();
    // wgpu counts submissions, and shows the count nowhere else.
    let number = |index: wgpu::SubmissionIndex| {
        format!("{index:?}").chars().filter(char::is_ascii_digit).collect::<String>().parse::<u64>().unwrap()
    };
    let before = number(submit());
    assert_eq!(number(submit()), before + 1);
    let error = device.compute_pipeline(&kernel(&[DOUBLE], &[&layout])).unwrap_err();
    assert_eq!(error.kind, ErrorKind::Internal);
    assert_eq!(number(submit()), before + 2);
}

#[test]
fn devices_on_two_threads_do_not_disturb_each_other() {
    let run = || (0..5).for_each(|_| round_trip(&device()).unwrap());
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(run);
        }
    });
}

/// Drivers too: instances are made anew and dropped among them. NVIDIA's hangs or crashes when these things happen at
/// once.
#[test]
fn devices_and_instances_begin_and_end_on_many_threads_at_once() {
    let run = |thread: u32| {
        for round in 0..4 {
            if (thread + round).is_multiple_of(4) {
                forget_drivers();
            }
            round_trip(&device()).unwrap();
        }
    };
    std::thread::scope(|scope| {
        for thread in 0..8 {
            scope.spawn(move || run(thread));
        }
    });
}
