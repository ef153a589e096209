//! The compute kernels: their keys, their WGSL, and the pipelines made of them, at once or in the background. Knows no
//! scene.

pub(in crate::gpu) mod compilers;
pub(in crate::gpu) mod kernels;
pub(in crate::gpu) mod key;
pub(in crate::gpu) mod slots;
pub(in crate::gpu) mod wgsl;
