// SPDX-License-Identifier: MIT OR Apache-2.0
//! The boundary to a page's scripts, beside `capi`: a class of two tracers, scenes as text under the C API's names,
//! promises for all that takes time. web/index.ts is what programs see of it. Checks arguments by the calls that check
//! them for C; knows no physics and no pixels.
//!
//! A page has one thread. Nothing here waits: a frame is submitted whole, and awaited.

mod message;
mod numbers;
mod text;
mod queries;
mod tracer;

pub use message::on_end;
pub use queries::{hole_info, traced_ray};
pub use text::{check_scene, default_scene, whole_scene};
pub use tracer::Tracer;

/// The version of the library.
#[wasm_bindgen::prelude::wasm_bindgen]
pub fn version() -> String {
    env!("CARGO_PKG_VERSION").into()
}

/// Names and WGSL of all kernels, in turn: for tests, as browsers read WGSL otherwise than naga does. Throws what joins
/// no kernel.
#[wasm_bindgen::prelude::wasm_bindgen]
pub fn kernels() -> Result<Vec<String>, js_sys::Error> {
    let all = crate::gpu::shader_sources().map_err(message::thrown)?;
    Ok(all.into_iter().flat_map(|(name, text)| [name.to_owned(), text]).collect())
}
