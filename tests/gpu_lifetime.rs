// SPDX-License-Identifier: MIT OR Apache-2.0
//! Memory and time of GPU devices that are opened and closed many times, and memory of many frames on one. Alone in its
//! process, and one test at a time, so that no other test's memory is seen. Without a Vulkan adapter this fails.
#![cfg(all(target_os = "linux", target_env = "gnu"))]

#[path = "random/mod.rs"]
mod random;

use bhr::gpu::{Device, Search, adapters, forget_drivers};
use bhr::image::{ImageMut, PixelFormat, memory::Layout};
use bhr::renderer::{Backend, Renderer, RendererOptions};
use bhr::scene::{Effects, Method, Motion, Scene, View};
use random::runs_all;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

fn alone() -> MutexGuard<'static, ()> {
    static RUNNING: Mutex<()> = Mutex::new(());
    RUNNING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Resident memory of this process in KiB.
fn resident() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find(|line| line.starts_with("VmRSS:")).unwrap();
    line.split_whitespace().nth(1).unwrap().parse().unwrap()
}

/// The life of a device under one context.
fn open_use_close() -> Duration {
    let start = Instant::now();
    let found = adapters(Search::Auto, false);
    assert!(!found.is_empty(), "this test needs a Vulkan adapter; lavapipe (mesa-vulkan-drivers) will do");
    let device = Device::open(&found[0]).unwrap();
    let opened = start.elapsed();
    let buffer = device.buffer("buffer", 1 << 20, wgpu::BufferUsages::COPY_DST).unwrap();
    let mut encoder = device.encoder("clear").unwrap();
    encoder.clear_buffer(&buffer, 0, None);
    device.submit_and_wait(encoder).unwrap();
    opened
}

#[test]
fn two_hundred_devices_leave_no_memory_behind() {
    let _alone = alone();
    let first = open_use_close();
    for _ in 0..19 {
        open_use_close();
    }
    let before = resident();
    // Everyday fewer; what each may leave is the same.
    let (more, again): (u32, u64) = if runs_all() { (180, 20) } else { (20, 3) };
    let mean = (0..more).map(|_| open_use_close()).sum::<Duration>() / more;
    let grown = resident().saturating_sub(before);
    let start = Instant::now();
    let listed = adapters(Search::All, false).len();
    eprintln!(
        "opened: first {first:?}, then {mean:?}; {more} more left {grown} KiB; {listed} adapters in {:?}",
        start.elapsed()
    );
    // Measured on lavapipe: 0 to 240 KiB, whatever the count.
    assert!(grown < 45 * u64::from(more), "{more} devices left {grown} KiB");

    // The drivers are loaded anew each time.
    let before = resident();
    for _ in 0..again {
        forget_drivers();
        open_use_close();
    }
    let grown = resident().saturating_sub(before);
    eprintln!("{again} more with the drivers started anew left {grown} KiB");
    assert!(grown < 400 * again, "starting the drivers {again} times left {grown} KiB");
}

/// Memory that the heap has handed out, KiB. (Resident memory would hide growth in what was given back before.)
fn allocated() -> u64 {
    // SAFETY: takes no argument and keeps nothing.
    let heap = unsafe { libc::mallinfo2() };
    (heap.uordblks + heap.hblkhd) as u64 >> 10
}

/// Frames of an observer that moves in each; how much more the heap holds after the last one than after the first few,
/// KiB.
fn left_by_frames(size: [u32; 2], count: u32, set: fn(&mut Scene)) -> u64 {
    let mut renderer = Renderer::new(RendererOptions::default()).unwrap();
    assert_ne!(renderer.adapter().backend, Backend::Cpu, "no GPU adapter (lavapipe counts)");
    renderer.scene = Scene::plain();
    set(&mut renderer.scene);
    // Pipelines that are made ahead belong to no frame.
    renderer.settled_waits();
    let format = match renderer.scene.view {
        View::Light => PixelFormat::Rgba8Srgb,
        _ => PixelFormat::R32F,
    };
    let mut pixels = vec![0; (size[0] * size[1]) as usize * format.bytes_per_pixel()];
    let mut frame = |i: u32| {
        // Lavapipe stops to compile anew after a frame where zeros in uniforms make the kernel smaller: not a look
        // straight at the hole.
        let camera = &mut renderer.scene.camera;
        (camera.position.x, camera.forward.x) = (0.01 * f64::from(i + 1), 1.0);
        let mut image = ImageMut::new(Layout::packed(format, size[0], size[1]), &mut pixels).unwrap();
        renderer.render(&mut image, false, None, &mut |_| true).unwrap();
    };
    let warm = count / 3;
    (0..warm).for_each(&mut frame);
    let before = allocated();
    (warm..count).for_each(&mut frame);
    allocated().saturating_sub(before)
}

/// Lavapipe keeps every kernel that it compiles, and may compile some for each frame: shaders/shared/not_inlined.wgsl.
#[test]
fn many_frames_leave_no_memory_behind() {
    let _alone = alone();
    const SMALL: [u32; 2] = [64, 36];
    const SPIN_0_LENS: [u32; 2] = [96, 54];
    const KERR_LENS: [u32; 2] = [1000, 500];
    type Case = (&'static str, [u32; 2], u32, fn(&mut Scene));
    let cases: [Case; 10] = [
        ("traced", SMALL, 15, |_| {}),
        ("traced adaptively, with spin, samples", SMALL, 15, |s| {
            (s.hole.spin, s.quality.method, s.quality.samples_per_pixel) = (0.7, Method::Adaptive, 2);
        }),
        ("traced, a view", SMALL, 15, |s| s.view = View::Deflection),
        ("traced, samples", SMALL, 15, |s| s.quality.samples_per_pixel = 3),
        ("spin-0 lens", SPIN_0_LENS, 15, |_| {}),
        ("spin-0 lens, samples, a turbulent translucent disk", SPIN_0_LENS, 15, |s| {
            s.quality.samples_per_pixel = 2;
            let disk = s.disk.as_mut().unwrap();
            (disk.turbulence, disk.opacity) = (0.7, 0.5);
        }),
        ("spin-0 lens, free fall, half the effects", SPIN_0_LENS, 15, |s| {
            (s.camera.motion, s.effects) = (Motion::FreeFall, Effects(Effects::BEAMING));
        }),
        ("spin-0 lens, a view", SPIN_0_LENS, 15, |s| s.view = View::Order),
        ("Kerr lens, a turbulent translucent disk", KERR_LENS, 12, |s| {
            let disk = s.disk.as_mut().unwrap();
            (s.hole.spin, disk.turbulence, disk.opacity) = (0.9, 0.7, 0.5);
        }),
        ("Kerr lens, a view", KERR_LENS, 12, |s| (s.hole.spin, s.view) = (0.9, View::Redshift)),
    ];
    // Everyday one for each way to find rays, a view, samples, turbulence and half the effects among them.
    let taken = cases.into_iter().enumerate().filter(|(i, _)| runs_all() || [1, 2, 5, 6, 8].contains(i));
    for (_, (name, size, count, set)) in taken {
        let grown = left_by_frames(size, count, set);
        eprintln!("{name}: {grown} KiB in {} frames", count - count / 3);
        // Measured on lavapipe: 0 to 2 KiB; 500 to 4000 a frame where it compiles.
        assert!(grown < 64, "{name}: {} frames left {grown} KiB", count - count / 3);
    }
}
