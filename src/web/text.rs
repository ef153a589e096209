// SPDX-License-Identifier: MIT OR Apache-2.0
//! Scenes as a page hands them over: text, as scene files have it (docs/scenes.md), which web/settings.ts writes of
//! plain objects.

use super::message::thrown;
use crate::capi::scene_file::{Moment, SceneFile};
use crate::error::{Error, Result};
use crate::scene::{HotSpot, Scene, Volume};
use std::path::Path;
use wasm_bindgen::prelude::wasm_bindgen;

/// The scene of a text at a moment of what moves in it, in seconds. Errors: INVALID_ARGUMENT without line and column,
/// as an object has none; UNSUPPORTED for files.
pub fn scene_of(text: &str, seconds: f64) -> Result<Moment> {
    let placeless = |error: Error| Error::new(error.kind, without_place(&error.message));
    let file = SceneFile::parse(text, Path::new("")).map_err(placeless)?;
    if file.map().is_some() || file.lut().is_some() {
        return Err(Error::unsupported("a page has no files: set no sky map and no LUT by a path"));
    }
    file.at(seconds, &Scene::default())
}

/// A message without the line and the column that it begins with.
fn without_place(message: &str) -> &str {
    match message.strip_prefix("line ").and_then(|rest| rest.split_once(": ")) {
        Some((_, rest)) => rest,
        None => message,
    }
}

/// Throws the C API's message for a text that is no scene.
#[wasm_bindgen(js_name = checkScene)]
pub fn check_scene(text: &str, seconds: f64) -> Result<(), js_sys::Error> {
    scene_of(text, seconds).map(|_| ()).map_err(thrown)
}

/// The text of a scene with every field. Throws as `checkScene`.
#[wasm_bindgen(js_name = wholeScene)]
pub fn whole_scene(text: &str, seconds: f64) -> Result<String, js_sys::Error> {
    let Moment { scene, region } = scene_of(text, seconds).map_err(thrown)?;
    written(&scene, region).map_err(thrown)
}

/// The text of the scene that a page begins with, with every field, and those of a volume and of a hot spot besides, as
/// these are when they are added.
#[wasm_bindgen(js_name = defaultScene)]
pub fn default_scene() -> Result<String, js_sys::Error> {
    let mut scene = Scene::default();
    scene.volumes.push(Volume::default());
    scene.hot_spots.push(HotSpot::default());
    written(&scene, None).map_err(thrown)
}

fn written(scene: &Scene, region: Option<crate::scene::Region>) -> Result<String> {
    SceneFile::of(scene, region, &Default::default())?.text(None)
}
