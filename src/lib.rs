//! bhr, the embeddable black-hole renderer. The map of the crate, from left to right as a frame flows:
//!
//! - `capi`: the C API, `include/bhr.h`: checks every argument, holds all pointer code.
//! - [`scene`]: what to draw, as plain validated data.
//! - [`renderer`]: one scene and one tracer; the safe Rust face. [`job`]: its frames in the background.
//! - `cpu`, `gpu`: the two tracers, with one behaviour: scene -> linear radiance.
//! - [`film`]: radiance -> pixels. [`image`]: pixels in memory and files. [`sky`]: the stars.
//! - [`window`]: the host's windows as targets of frames.
//! - `thread_scope`: what the library's threads take over from the threads that they work for.
//! - [`physics`]: beside the line: metrics, geodesics, observers, orbits, disk flux, blackbody; f64, usable alone.
//! - `deferred`: below all: work that waits until a thread holds no lock of the process. `allocate`: memory that may be
//!   refused.

mod allocate;
#[doc(hidden)]
pub mod capi;
pub mod cpu;
mod deferred;
pub mod error;
pub mod film;
pub mod gpu;
pub mod image;
pub mod job;
pub mod physics;
mod random;
pub mod renderer;
pub mod scene;
pub mod sky;
pub mod surface;
mod thread_scope;
pub mod tracer;
mod tracers;
pub mod window;
