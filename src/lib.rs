// SPDX-License-Identifier: MIT OR Apache-2.0
//! bhr, the embeddable black-hole renderer. The map of the crate, from left to right as a frame flows:
//!
//! - `capi`: the C API, `include/bhr.h`: checks every argument, holds all pointer code.
//! - `web`: the boundary to a page's scripts, in builds for WebAssembly.
//! - [`renderer`]: one scene and one tracer; the safe Rust face. [`job`]: its frames in the background. [`surface`]:
//!   its frames in the host's windows. [`interop`]: pictures and semaphores on the GPU that hosts share.
//! - `tracers`: the tracers behind one face. `cpu`, `gpu`: the two of them, with one behaviour: scene -> pixels.
//! - [`window`]: the host's windows, as their platforms know them.
//! - [`tracer`]: what tracers take and give: requests, tiles, numbers, adapters.
//! - [`film`]: radiance -> pixels.
//! - [`scene`]: what to draw, as plain validated data.
//! - [`emit`]: what shines or absorbs near the hole. [`sky`]: stars and maps. [`image`]: pixels in memory and files.
//! - [`physics`]: metrics, geodesics, observers, orbits, lenses, disk flux, blackbody; f64, usable alone.
//! - `random`, `recent` (costly things that are kept), `deferred` (work that waits until a thread holds no lock of the
//!   process), `attempt` (what fails no call), `allocate` (memory that may be refused), `parallel` (work on a pool of
//!   threads), `thread_scope` (what the library's threads take over from the threads that they work for), `platform`
//!   (what is asked of the system), [`error`].
//!
//! Each imports from those below it only; `ARCHITECTURE.md` says more, and tests/rooms/imports.rs holds it.

mod allocate;
mod attempt;
#[doc(hidden)]
pub mod capi;
pub mod cpu;
mod deferred;
pub mod emit;
pub mod error;
pub mod film;
pub mod gpu;
pub mod image;
pub mod interop;
pub mod job;
#[cfg_attr(target_arch = "wasm32", path = "parallel_absent.rs")]
mod parallel;
pub mod physics;
mod platform;
mod random;
mod recent;
mod accumulation;
pub mod renderer;
pub mod scene;
pub mod sky;
pub mod surface;
mod thread_scope;
mod thread_state;
pub mod tracer;
mod tracers;
#[cfg(target_arch = "wasm32")]
pub mod web;
pub mod window;

#[doc(hidden)]
pub use capi::scene_file;
