// SPDX-License-Identifier: MIT OR Apache-2.0
//! The part of a context that its calls share. Knows no calls.

use super::progress::Callback;
use crate::error::Result;
use crate::image::LutFile;
use crate::renderer::Renderer;
use crate::scene::{Region, Scene};
use crate::sky::MapFile;
use std::path::Path;

/// The pictures that a scene's text asks for.
pub(super) struct Pictures {
    pub size: [u32; 2],
    pub count: u32,
    /// Pictures a second.
    pub rate: f64,
}

/// The files that the tables of a scene are from, where they are from any.
#[derive(Clone, Default)]
pub struct Files {
    /// The file of the sky's map.
    pub map: Option<MapFile>,
    /// The file of the film's LUT.
    pub lut: Option<LutFile>,
}

/// A scene that was loaded, as a context knows it: it stands below the structs that the scene's text is made of.
pub(super) trait Loaded: Send {
    /// The scene, in which what moves is as it is at a time in seconds.
    fn moved(&self, seconds: f64, scene: &Scene, region: Option<Region>) -> Result<(Scene, Option<Region>)>;
    /// The text of the scene as it is, with what moves as it was loaded; paths below `folder` are relative to it.
    fn text(&self, scene: &Scene, region: Option<Region>, files: &Files, folder: Option<&Path>) -> Result<String>;
    fn pictures(&self) -> Pictures;
}

/// The part of a context that its lock protects.
pub(super) struct State {
    pub renderer: Renderer,
    /// `None`: images are whole frames.
    pub region: Option<Region>,
    pub progress: Option<Callback>,
    /// The scene that was loaded last.
    pub loaded: Option<Box<dyn Loaded>>,
    pub files: Files,
}
