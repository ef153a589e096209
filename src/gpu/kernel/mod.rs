// SPDX-License-Identifier: MIT OR Apache-2.0
//! The compute kernels: their keys, their WGSL, and the pipelines made of them, at once or in the background. Knows no
//! scene.

pub(in crate::gpu) mod preprocess;
pub(in crate::gpu) mod sizes;
pub(in crate::gpu) mod choices;
pub(in crate::gpu) mod variant;
pub(in crate::gpu) mod constants;
pub(in crate::gpu) mod slots;
pub(in crate::gpu) mod stage;
pub(in crate::gpu) mod fragments;
pub(in crate::gpu) mod wgsl;
pub(in crate::gpu) mod key;
pub(in crate::gpu) mod cache;
pub(in crate::gpu) mod compilers;
pub(in crate::gpu) mod kernels;
#[cfg(test)]
pub(in crate::gpu) mod layout;
