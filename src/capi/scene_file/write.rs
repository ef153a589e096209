// SPDX-License-Identifier: MIT OR Apache-2.0
//! A scene's text, written: every field, so that no default of a later release changes what it means. Numbers are the
//! shortest that are read back as they were (Rust's `{:?}` of f64).

use super::tracks::{Curve, Key, Track};
use super::values::Section;
use super::{FORMAT, SceneFile};
use crate::capi::fields::{Field, Kind, Value, word_of, words_of};
use crate::error::{Error, Result};
use std::fmt::Write;
use std::path::Path;

/// [`SceneFile::text`].
pub(super) fn write(file: &SceneFile, folder: Option<&Path>) -> Result<String> {
    let mut text = format!("# A scene of bhr {}. docs/scenes.md\nversion = {FORMAT}\n", env!("CARGO_PKG_VERSION"));
    if file.values.disk.is_none() {
        text += "disk = false\n";
    }
    // Tables come after all keys that are in none.
    let empty = [("volumes", file.values.volumes.is_empty()), ("hot_spots", file.values.hot_spots.is_empty())];
    empty.iter().filter(|(_, is_empty)| *is_empty).for_each(|(name, _)| text += &format!("{name} = []\n"));
    for section in file.values.sections() {
        if let Section::Path(_) | Section::Aim(_) = section {
            continue;
        }
        write_section(file, section, &mut text);
        match section {
            Section::Volume(i) if file.values.of_preset == Some(i) => text += "of_preset = true\n",
            Section::Film => {
                if file.values.glare_is_optional {
                    text += "glare_is_optional = true\n";
                }
                if file.values.grain_moves {
                    text += "grain_moves = true\n";
                }
                write_path(("lut", "the film's LUT"), file.lut.as_deref(), folder, &mut text)?;
            }
            Section::Sky => write_path(("map", "the sky's map"), file.map.as_deref(), folder, &mut text)?,
            _ => {}
        }
    }
    Ok(text)
}

/// Writes the path of a file, if there is one: its key, and what it holds, for messages.
fn write_path(
    (key, named): (&str, &str),
    given: Option<&Path>,
    folder: Option<&Path>,
    text: &mut String,
) -> Result<()> {
    let Some(given) = given else { return Ok(()) };
    let relative = folder.and_then(|folder| given.strip_prefix(folder).ok()).unwrap_or(given);
    let Some(path) = relative.to_str() else {
        let path = relative.display();
        return Err(Error::unsupported(format!("the path of {named}, {path}, is not UTF-8, which scenes are")));
    };
    *text += &format!("{key} = {}\n", quoted(path));
    Ok(())
}

/// A string of TOML's basic kind.
fn quoted(text: &str) -> String {
    let mut quoted = String::from('"');
    for c in text.chars() {
        match c {
            '"' | '\\' => quoted.extend(['\\', c]),
            c if c.is_control() => {
                // Writing to a String does not fail.
                let _ = write!(quoted, "\\u{:04x}", u32::from(c));
            }
            c => quoted.push(c),
        }
    }
    quoted + "\""
}

fn title(section: Section, file: &SceneFile) -> String {
    match section {
        Section::Moment => String::new(),
        Section::Camera(0) => "\n[camera]\n".into(),
        Section::Camera(i) => {
            let at = file.values.shots.get(i).map_or(0.0, |shot| shot.at);
            format!("\n[[cuts]]\nat = {at:?}\n\n[cuts.camera]\n")
        }
        Section::Orbit(0) => "\n[camera.orbit]\n".into(),
        Section::Orbit(_) => "\n[cuts.camera.orbit]\n".into(),
        Section::Turn(0) => "\n[camera.turn]\n".into(),
        Section::Turn(_) => "\n[cuts.camera.turn]\n".into(),
        Section::Volume(_) => "\n[[volumes]]\n".into(),
        Section::HotSpot(_) => "\n[[hot_spots]]\n".into(),
        section => format!("\n{}\n", section.name()),
    }
}

fn write_section(file: &SceneFile, section: Section, text: &mut String) {
    *text += &title(section, file);
    for field in section.fields() {
        write_field(file, section, field, text);
    }
    if let Section::Camera(i) = section {
        for more in [Section::Path(i), Section::Aim(i)] {
            more.fields().iter().for_each(|field| write_field(file, more, field, text));
        }
    }
}

/// Whether another section says what the field is: an orbit where the camera is and where it looks, a place to look at
/// the latter.
fn is_derived(file: &SceneFile, section: Section, field: &Field) -> bool {
    let Section::Camera(i) = section else { return false };
    let Some(shot) = file.values.shots.get(i) else { return false };
    match field.name {
        "position" | "up" => shot.orbit.is_some(),
        "forward" => shot.orbit.is_some() || shot.aim.is_some(),
        _ => false,
    }
}

fn write_field(file: &SceneFile, section: Section, field: &'static Field, text: &mut String) {
    let Some(bytes) = file.values.bytes(section).filter(|_| !is_derived(file, section, field)) else { return };
    let track = file.tracks.iter().rfind(|track| track.section == section && track.field.name == field.name);
    let written = match track {
        Some(track) => keys(track),
        None => value(field.kind, &field.get(bytes)),
    };
    *text += &format!("{} = {written}\n", field.name);
}

fn keys(track: &Track) -> String {
    let usual = track.keys.first().map_or(Curve::Hold, |key| key.curve);
    let key = |key: &Key| {
        let curve = if key.curve == usual { String::new() } else { format!(", \"{}\"", key.curve.word()) };
        format!("[{:?}, {}{curve}]", key.time, value(track.field.kind, &key.value))
    };
    let keys = track.keys.iter().map(key).collect::<Vec<_>>().join(", ");
    format!("{{ keys = [{keys}], curve = \"{}\" }}", usual.word())
}

/// The shortest digits that are read back as they were. Fields that others make meaningless may be set to NaN.
fn number(number: f64) -> String {
    if number.is_nan() { "nan".into() } else { format!("{number:?}") }
}

fn value(kind: Kind, value: &Value) -> String {
    match (kind, value) {
        (Kind::Numbers(1) | Kind::Angle, Value::Numbers(numbers)) => {
            numbers.first().copied().map_or_else(|| "0.0".into(), number)
        }
        (_, Value::Numbers(numbers)) => {
            let parts = numbers.iter().copied().map(number).collect::<Vec<_>>();
            format!("[{}]", parts.join(", "))
        }
        (Kind::Word(words), Value::Word(of)) => {
            word_of(*of, words).map_or_else(|| of.to_string(), |word| format!("\"{word}\""))
        }
        (Kind::Bits(words), Value::Bits(bits)) => {
            let (found, rest) = words_of(*bits, words);
            let found = found.into_iter().map(|word| format!("\"{word}\""));
            let rest = (rest != 0).then(|| rest.to_string());
            format!("[{}]", found.chain(rest).collect::<Vec<_>>().join(", "))
        }
        (_, Value::Word(number)) => number.to_string(),
        (_, Value::Bits(number) | Value::Count(number)) => number.to_string(),
        (_, Value::Seed(number)) => number.to_string(),
    }
}
