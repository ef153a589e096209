// SPDX-License-Identifier: MIT OR Apache-2.0
//! The C boundary: the only `extern "C"` of the crate and all code that touches a host's pointers. One file per C
//! concept; each holds the types, constants and functions of one section of `include/bhr.h`, which
//! `tests/header/generated.rs` makes from them. Public items that begin with `bhr_`, `Bhr` or `BHR_` are the API, and
//! their comments are written for the reader of the header. Nothing here knows physics or pixels: a function checks its
//! arguments and makes one call into `Renderer`, `Scene` or `image`.
//!
//! Every entry point has one shape: out-parameters are cleared ([`pointer::Out`]), then [`entry`] (or [`call`]) takes a
//! closure, runs it under the panic guard (with a context: under its lock) and turns its `Result` into a status, a
//! message and a log line. Structs cross the boundary by value only ([`versioned`]); no pointer of the host's ever
//! becomes a reference, so misaligned structs and arrays are read and written correctly. (Pixels must be aligned;
//! `image` checks.)

// Item documentation here is the C header: its brackets are cbindgen annotations and C arrays, no links.
#![allow(rustdoc::broken_intra_doc_links, rustdoc::private_intra_doc_links)]
// The safety contract of every function here is the same, is the header's, and is written once, in `cbindgen.toml`.
#![allow(clippy::missing_safety_doc)]

mod callback;
mod gate;
mod message;
mod pointer;
pub mod version;
pub mod log;
mod panic;
pub mod status;
mod versioned;
mod array;
mod entry;
mod progress;
pub mod window;
pub mod adapter;
pub mod image;
mod fields;
mod state;
mod call;
pub mod context;
pub mod chart;
pub mod camera;
pub mod disk;
pub mod effects;
pub mod film;
pub mod hole;
pub mod interop_info;
pub mod job;
pub mod occluder;
pub mod preset;
pub mod quality;
pub mod rays;
pub mod region;
pub mod render;
pub mod accumulation;
pub mod sky;
pub mod surface;
pub mod view;
pub mod volume;
mod field_list;
#[doc(hidden)]
pub mod scene_file;
pub mod scene;
pub mod interop_target;
pub mod matrix;
pub mod body;
pub mod project;
pub mod stats;
pub mod transfer;
pub mod interop_occluder;
pub mod interop_semaphore;
pub mod interop_sky;
pub mod output;
pub mod interop_render;
pub mod interop_vulkan;
