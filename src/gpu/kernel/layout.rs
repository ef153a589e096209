// SPDX-License-Identifier: MIT OR Apache-2.0
//! How tests say where the members of a Rust struct lie that WGSL has too.

/// A Rust struct as WGSL should have it: name there, size, and members with their offsets.
pub struct Layout {
    pub name: &'static str,
    pub size: usize,
    pub members: Vec<(&'static str, usize)>,
}

/// The layout of a Rust struct. Members bear the same name in WGSL, or stand as `name = field + bytes`.
macro_rules! layout {
    ($rust:ty as $name:literal: $($member:ident $(= $field:ident + $bytes:literal)?),* $(,)?) => {
        $crate::gpu::kernel::layout::Layout {
            name: $name,
            size: size_of::<$rust>(),
            members: vec![$((
                stringify!($member),
                $crate::gpu::kernel::layout::layout!(@offset $rust, $member $(, $field, $bytes)?),
            )),*],
        }
    };
    (@offset $rust:ty, $member:ident) => { std::mem::offset_of!($rust, $member) };
    (@offset $rust:ty, $member:ident, $field:ident, $bytes:literal) => {
        std::mem::offset_of!($rust, $field) + $bytes
    };
}
pub(crate) use layout;
