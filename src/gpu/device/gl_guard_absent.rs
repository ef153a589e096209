// SPDX-License-Identifier: MIT OR Apache-2.0
//! Takes the place of `gl_guard` where contexts are not EGL's, or are not there: there is nothing to guard against.

/// There is none.
pub enum ContextGuard {}

impl ContextGuard {
    pub fn of(_: &wgpu::Adapter) -> Option<Self> {
        None
    }
}
