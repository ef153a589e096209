// SPDX-License-Identifier: MIT OR Apache-2.0
//! Frames of both tracers: whole pictures, stars, skies, disks, cameras, tables and jobs, each against theory or
//! against the other tracer. The GPU is whatever adapter comes first; without one the tests fail. One program, so that
//! wgpu is linked once; tests that need a process of their own are in programs of their own.

mod accumulation;
mod bloom;
mod cameras;
mod composite;
mod extremes;
mod eyes;
#[path = "../frames/mod.rs"]
mod frames;
mod falls;
mod free_spots;
mod frusta;
mod grades;
mod half;
mod inside;
mod jobs;
mod kernels;
mod lens;
mod lensed;
mod light;
mod matter;
mod metering;
mod observers;
mod occluder;
mod outputs;
mod pictures;
mod pixels;
mod points;
#[path = "../random/mod.rs"]
mod random;
mod rings;
mod sky;
mod sky_target;
mod stars;
mod structure;
mod supersampling;
mod targets;
mod transfer;
mod volumes;
