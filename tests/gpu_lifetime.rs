//! Opening and closing GPU devices many times: memory and time. Alone in its process, so that no other test's
//! memory is seen. Without a Vulkan adapter this fails.
#![cfg(target_os = "linux")]

use bhr::gpu::{Device, Search, adapters, forget_drivers};
use std::time::{Duration, Instant};

/// Resident memory of this process in KiB.
fn resident() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find(|line| line.starts_with("VmRSS:")).unwrap();
    line.split_whitespace().nth(1).unwrap().parse().unwrap()
}

/// What one context does to its device.
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
    let first = open_use_close();
    for _ in 0..19 {
        open_use_close();
    }
    let before = resident();
    let mean = (0..180).map(|_| open_use_close()).sum::<Duration>() / 180;
    let grown = resident().saturating_sub(before);
    let start = Instant::now();
    let listed = adapters(Search::All, false).len();
    eprintln!(
        "opened: first {first:?}, then {mean:?}; 180 more left {grown} KiB; {listed} adapters in {:?}",
        start.elapsed()
    );
    // Measured on lavapipe: 0 to 240 KiB, whatever the count.
    assert!(grown < 8 << 10, "180 devices left {grown} KiB");

    // The same with the drivers loaded anew each time.
    let before = resident();
    for _ in 0..20 {
        forget_drivers();
        open_use_close();
    }
    let grown = resident().saturating_sub(before);
    eprintln!("20 more with the drivers started anew left {grown} KiB");
    assert!(grown < 8 << 10, "starting the drivers 20 times left {grown} KiB");
}
