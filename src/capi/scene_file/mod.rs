// SPDX-License-Identifier: MIT OR Apache-2.0
//! Scenes as text: all that setters take, under the API's names, in TOML, with values that change with time.
//! docs/scenes.md describes it. Text is read into plain structs of the API, and those into a scene by the same checks
//! as the setters'; the list of names is `field_list`, made from the structs. Knows no context and no pointers.

mod values;
mod tracks;
mod read;
mod write;
mod attributes;
#[cfg(test)]
mod tests;

use super::state::Files;
use crate::error::{Error, Result};
use crate::image::{self, KeptFile};
use crate::scene::{Region, Scene};
pub use attributes::parameters;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tracks::Track;
pub use values::Render;
use values::{Misfit, Section, Values};

/// The format that is written, and the newest that is read.
pub const FORMAT: u64 = 1;

/// The largest text that is read.
pub const MOST_BYTES: usize = 4 << 20;

/// A scene as text has it: values, and what moves.
#[derive(Clone)]
pub struct SceneFile {
    values: Values,
    tracks: Vec<Track>,
    map: Option<PathBuf>,
    lut: Option<PathBuf>,
}

/// A scene at a moment, with what a context holds beside it.
pub struct Moment {
    pub scene: Scene,
    pub region: Option<Region>,
}

impl SceneFile {
    /// Reads a scene's text; paths in it are relative to `folder`. Errors: INVALID_ARGUMENT with line and column for
    /// text that is no scene: unknown names, other types, numbers out of range, also of keys; INVALID_STATE where a
    /// camera cannot move as it is to.
    pub fn parse(text: &str, folder: &Path) -> Result<Self> {
        read::read(text, folder)
    }

    /// Reads a scene's file, as [`Self::parse`]. Errors: as there, with the path; IO.
    pub fn load(path: &Path) -> Result<Self> {
        let text = image::load_text(path, MOST_BYTES)?;
        let about = |error: Error| Error::new(error.kind, format!("{}: {}", path.display(), error.message));
        Self::parse(&text, path.parent().unwrap_or(Path::new(""))).map_err(about)
    }

    /// The scene as it is, without anything that moves.
    pub fn of(scene: &Scene, region: Option<Region>, files: &Files) -> Result<Self> {
        let map = path_of(scene.sky_map.as_ref(), files.map.as_ref(), ["the sky's map", "bhr_set_sky_map_file"])?;
        let lut = path_of(scene.film_lut.as_ref(), files.lut.as_ref(), ["the film's LUT", "bhr_set_film_lut_file"])?;
        if scene.sky_picture.is_some() {
            return Err(Error::unsupported("the sky's map is a target on the GPU, which has no path"));
        }
        Ok(Self { values: Values::of(scene, region), tracks: Vec::new(), map, lut })
    }

    /// The scene as it is; what moves in `self` moves on, and is as it was read.
    pub fn updated(&self, scene: &Scene, region: Option<Region>, files: &Files) -> Result<Self> {
        let mut now = Self::of(scene, region, files)?;
        now.values.render = self.values.render;
        if self.values.grain_moves {
            now.values.grain_moves = true;
            now.values.film.grain_seed = self.values.film.grain_seed;
        }
        self.put_shots(&mut now.values);
        let is_there = |track: &&Track| now.values.bytes(track.section).is_some();
        now.tracks = self.tracks.iter().filter(is_there).cloned().collect();
        Ok(now)
    }

    /// The scene's text. Paths below `folder`, where one is given, are relative to it. Errors: UNSUPPORTED for a path
    /// that is not UTF-8.
    pub fn text(&self, folder: Option<&Path>) -> Result<String> {
        write::write(self, folder)
    }

    /// The text without what decides pixels by its content, or by the moment: the paths of the map and the LUT, and the
    /// pictures that are asked for. For fingerprints.
    pub fn text_of_pixels(&self) -> Result<String> {
        let mut bare = self.clone();
        (bare.map, bare.lut, bare.values.render) = (None, None, None);
        bare.text(None)
    }

    /// The pictures that the text asks for, if it does.
    pub fn render(&self) -> Option<Render> {
        self.values.render
    }

    /// The file of the sky's map.
    pub fn map(&self) -> Option<&Path> {
        self.map.as_deref()
    }

    /// The file of the film's LUT.
    pub fn lut(&self) -> Option<&Path> {
        self.lut.as_deref()
    }

    /// Whether anything is another at another time.
    pub fn moves(&self) -> bool {
        self.values.shots.len() > 1 || !self.tracks.is_empty() || self.values.grain_moves
    }

    /// Whether the camera is another one at another time, or its place is: then it is the text's, whatever a host has
    /// set. A camera of which other fields move, as its field of view, is the scene's with these fields.
    fn places_camera(&self) -> bool {
        let derived = self.values.shots.iter().any(values::Shot::is_derived);
        let walks = self.values.shots.iter().any(|shot| shot.path.is_some());
        self.values.shots.len() > 1
            || self.tracks.iter().any(|track| match track.section {
                Section::Orbit(_) | Section::Path(_) | Section::Aim(_) | Section::Turn(_) => true,
                Section::Camera(_) => {
                    derived && ["position", "forward", "up", "motion", "velocity"].contains(&track.field.name)
                }
                // A world line adds its time to the scene's.
                Section::Moment => walks && track.field.name == "time",
                _ => false,
            })
    }

    /// Puts the text's cameras into a scene's values, if it places them. Time that passes on a world line is in the
    /// scene's time, but not in the text's.
    fn put_shots(&self, values: &mut Values) {
        if self.places_camera() {
            values.shots.clone_from(&self.values.shots);
            if self.values.shots.iter().any(|shot| shot.path.is_some()) {
                values.moment.time = self.values.moment.time;
            }
        }
    }

    /// The whole scene at a time, in seconds. What no text holds (the sky's map, the LUT, occluders) is that of
    /// `scene`. Errors:
    /// as [`Self::parse`], without line and column.
    pub fn at(&self, seconds: f64, scene: &Scene) -> Result<Moment> {
        self.evaluated(self.values.clone(), seconds, scene).map_err(|misfit| explained(misfit, seconds))
    }

    /// The scene, in which what moves is as it is at a time, and the rest as it was. Errors: as [`Self::at`];
    /// INVALID_STATE where what moves is no more there.
    pub fn moved(&self, seconds: f64, scene: &Scene, region: Option<Region>) -> Result<Moment> {
        let mut values = Values::of(scene, region);
        self.put_shots(&mut values);
        values.grain_moves = self.values.grain_moves;
        self.evaluated(values, seconds, scene).map_err(|misfit| explained(misfit, seconds))
    }

    fn evaluated(&self, mut values: Values, seconds: f64, scene: &Scene) -> Result<Moment, Misfit> {
        let shown = values.shot_at(seconds);
        for track in self.tracks.iter().filter(|track| track.section.shot().is_none_or(|shot| shot == shown)) {
            let Some(value) = track.value_at(seconds) else { continue };
            let Some(bytes) = values.bytes_mut(track.section) else {
                let gone = format!("the scene file moves its {}, and the scene has none now", track.field.name);
                return Err((track.section, Error::state(gone)));
            };
            track.field.set(bytes, &value);
        }
        if values.grain_moves {
            values.film.grain_seed = seconds;
        }
        let (scene, region) = values.set_in(scene, seconds)?;
        Ok(Moment { scene, region })
    }
}

/// The path of what a scene shows, `named` and set by a call; `None`: it shows none. Errors: UNSUPPORTED for what is
/// from no file.
fn path_of<T>(shown: Option<&Arc<T>>, file: Option<&KeptFile<T>>, [named, call]: [&str; 2]) -> Result<Option<PathBuf>> {
    match (shown, file) {
        (None, _) => Ok(None),
        (Some(shown), Some(file)) if file.is_of(shown) => Ok(Some(file.path().to_owned())),
        (Some(_), _) => {
            Err(Error::unsupported(format!("{named} has no path, as it was set from memory: set it by {call} instead")))
        }
    }
}

/// A misfit as hosts read it.
fn explained((section, error): Misfit, seconds: f64) -> Error {
    Error::new(error.kind, format!("{} at {seconds} s: {}", section.name(), error.message))
}
