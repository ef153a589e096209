// SPDX-License-Identifier: MIT OR Apache-2.0
//! Scenes as text, and what moves in them.

use super::call::on_context;
use super::context::BhrContext;
use super::film;
use super::image::path_of;
use super::pointer::{Out, check_finite, is_null};
use super::scene_file::{MOST_BYTES, Moment, SceneFile};
use super::sky;
use super::state::{Files, Loaded, Pictures, State};
use super::status::BhrStatus;
use crate::error::{Error, Result};
use crate::image::{self, LutFile};
use crate::scene::{Region, Scene};
use crate::sky::MapFile;
use std::ffi::c_char;
use std::path::{Path, PathBuf};

impl Loaded for SceneFile {
    fn moved(&self, seconds: f64, scene: &Scene, region: Option<Region>) -> Result<(Scene, Option<Region>)> {
        let Moment { scene, region } = Self::moved(self, seconds, scene, region)?;
        Ok((scene, region))
    }

    fn text(&self, scene: &Scene, region: Option<Region>, files: &Files, folder: Option<&Path>) -> Result<String> {
        self.updated(scene, region, files)?.text(folder)
    }

    fn pictures(&self) -> Pictures {
        let render = self.render().unwrap_or_default();
        Pictures { size: [render.width, render.height], count: render.frames(), rate: render.frames_per_second }
    }
}

/// Shows what a file has, at its beginning. Errors: as [`SceneFile::at`], [`MapFile::load`] and [`LutFile::load`]; the
/// state is then as it was.
fn show(state: &mut State, file: SceneFile) -> Result<()> {
    let map = file.map().map(|path| MapFile::load(path, state.files.map.as_ref())).transpose()?;
    let lut = file.lut().map(|path| LutFile::load(path, state.files.lut.as_ref())).transpose()?;
    let Moment { scene, region } = file.at(0.0, &state.renderer.scene)?;
    state.renderer.scene = scene;
    sky::show_map(state, map);
    film::show_lut(state, lut);
    state.region = region;
    state.loaded = Some(Box::new(file));
    Ok(())
}

/// The text of the scene as it is set, with what moves in it.
fn text_of(state: &State, folder: Option<&Path>) -> Result<String> {
    let State { renderer, region, files, .. } = state;
    match &state.loaded {
        Some(loaded) => loaded.text(&renderer.scene, *region, files, folder),
        None => SceneFile::of(&renderer.scene, *region, files)?.text(folder),
    }
}

fn loaded(state: &State) -> Result<&dyn Loaded> {
    let none = || Error::state("no scene was loaded by bhr_scene_load or bhr_scene_load_file");
    state.loaded.as_deref().ok_or_else(none)
}

/// Sets the whole scene from text: everything that setters take, under the names of this header, in TOML, as
/// docs/scenes.md describes it. What it does not name has the value of a new context, or of the preset that it names;
/// values may change with time, and the scene is that of 0 seconds. Frames show all of it or nothing. The text has
/// size bytes of UTF-8, at most 4 MiB. Paths are relative to the current folder. Occluders and callbacks are left
/// alone.
/// Errors, after which the scene is as it was: INVALID_ARGUMENT, with line and column, for text that is no TOML, an
/// unknown name, a value of another type or out of its range, at any of the times that it names; INVALID_STATE and
/// UNSUPPORTED for a camera that cannot move as it is to; IO and those of bhr_set_sky_map for map and LUT.
/// @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_scene_load(context: *mut BhrContext, text: *const c_char, size: usize) -> BhrStatus {
    // SAFETY: NULL or size readable bytes, by the header's conventions.
    unsafe {
        on_context("bhr_scene_load", context, |state| {
            if text.is_null() {
                return Err(is_null("text"));
            }
            if size > MOST_BYTES {
                return Err(Error::argument(format!("size is {size}; it must lie in [0, {MOST_BYTES}]")));
            }
            let bytes = std::slice::from_raw_parts(text.cast::<u8>(), size);
            let text = std::str::from_utf8(bytes)
                .map_err(|error| Error::argument(format!("text is not UTF-8 from byte {} on", error.valid_up_to())))?;
            show(state, SceneFile::parse(text, &std::env::current_dir().unwrap_or_default())?)
        })
    }
}

/// Sets the whole scene from a file, as bhr_scene_load does from text. Paths in it are relative to its folder. A struct
/// is a table, a field a line, a constant the end of its name; what changes with time has keys of [seconds, value]:
/// ```toml
/// preset = "cinematic"
/// [hole]
/// spin = { keys = [[0, 0.0], [10, 0.9]] }
/// [camera]
/// motion = "static"
/// orbit = { distance = 20, azimuth = 0, elevation = "8 deg" }
/// ```
/// Errors: those of bhr_scene_load; IO for a file that is not there, not readable, not UTF-8 or larger than 4 MiB.
/// @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_scene_load_file(context: *mut BhrContext, path: *const c_char) -> BhrStatus {
    // SAFETY: NULL or a C string, by the header's conventions.
    unsafe {
        on_context("bhr_scene_load_file", context, |state| {
            let path = path_of(path)?;
            show(state, SceneFile::load(&absolute(&path))?)
        })
    }
}

/// A path that means the same in another folder.
fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned())
}

/// Sets the scene to a time, in seconds: what changes with time in the text that was loaded last gets its value of that
/// time, whatever setters have made of it since, and nothing else changes; a camera whose place moves is set as a
/// whole. Before the first key of a value it is the first one's, after the last key the last one's. This is the time of
/// a film; the scene's own time, which bhr_set_time takes, is one of the values that may change with it.
/// Errors, after which the scene is as it was: INVALID_STATE where no scene was loaded, where a camera cannot move as
/// it is to, and where a disk, a volume or a spot that changes is no longer there; INVALID_ARGUMENT for values that
/// leave their range between their keys. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_scene_at(context: *mut BhrContext, seconds: f64) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_context("bhr_scene_at", context, |state| {
            let seconds = check_finite(seconds, "seconds")?;
            let (scene, region) = loaded(state)?.moved(seconds, &state.renderer.scene, state.region)?;
            (state.renderer.scene, state.region) = (scene, region);
            Ok(())
        })
    }
}

/// Reads the pictures that the text that was loaded last asks for: their size in pixels, their number, 1 for one that
/// does not move, and the rate of the film. Picture n, from 0, shows the scene at n / rate seconds. Where the text says
/// nothing of it they are 1920 x 1080, 1 picture, 24 a second. Pointers may be NULL.
/// Errors: INVALID_STATE where no scene was loaded. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_scene_pictures(
    context: *const BhrContext,
    out_width: *mut u32,
    out_height: *mut u32,
    out_count: *mut u32,
    out_rate: *mut f64,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let [width, height, count] = [out_width, out_height, out_count].map(|out| Out::cleared(out));
        let rate = Out::cleared(out_rate);
        on_context("bhr_scene_pictures", context, |state| {
            let asked = loaded(state)?.pictures();
            width.set(asked.size[0]);
            height.set(asked.size[1]);
            count.set(asked.count);
            rate.set(asked.rate);
            Ok(())
        })
    }
}

/// Writes the scene as it is set as text that bhr_scene_load reads back bit by bit: *out_size becomes the length of the
/// text in bytes without the NUL that ends it, and buffer, unless it is NULL, gets both. What changes with time in the
/// text that was loaded last is written as it was read, so that the scene that is read is that of 0 seconds. Occluders
/// are not part of it; paths are absolute.
/// Errors: INVALID_ARGUMENT for a buffer of fewer than *out_size + 1 bytes, which then stays as it was; UNSUPPORTED
/// for a map of the sky or a LUT whose path is not UTF-8, or that has none: one that was set from memory or by
/// bhr_set_sky_target. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_scene_save(
    context: *const BhrContext,
    buffer: *mut c_char,
    size: usize,
    out_size: *mut usize,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let out = Out::cleared(out_size);
        on_context("bhr_scene_save", context, |state| {
            out.required("out_size")?;
            let text = text_of(state, None)?;
            if !buffer.is_null() {
                if size <= text.len() {
                    let needed = text.len() + 1;
                    return Err(Error::argument(format!("size is {size}; the scene's text needs {needed} bytes")));
                }
                buffer.cast::<u8>().copy_from_nonoverlapping(text.as_ptr(), text.len());
                buffer.cast::<u8>().add(text.len()).write(0);
            }
            out.set(text.len());
            Ok(())
        })
    }
}

/// Writes the scene as it is set to a file, as bhr_scene_save does to memory. Paths of a map and a LUT in the file's
/// folder, or below it, are relative to that. A file is replaced as bhr_image_save does it.
/// Errors: UNSUPPORTED as bhr_scene_save; IO. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_scene_save_file(context: *const BhrContext, path: *const c_char) -> BhrStatus {
    // SAFETY: NULL or a C string, by the header's conventions.
    unsafe {
        on_context("bhr_scene_save_file", context, |state| {
            let path = absolute(&path_of(path)?);
            image::save_text(&text_of(state, path.parent())?, &path)
        })
    }
}
