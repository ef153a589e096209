// SPDX-License-Identifier: MIT OR Apache-2.0
//! The part of a context that its calls share. Knows no calls.

use super::progress::Callback;
use crate::renderer::Renderer;
use crate::scene::Region;

/// The part of a context that its lock protects.
pub(super) struct State {
    pub renderer: Renderer,
    /// `None`: images are whole frames.
    pub region: Option<Region>,
    pub progress: Option<Callback>,
}
