// SPDX-License-Identifier: MIT OR Apache-2.0
//! The rules of the house that a program can hold: who may import whom, how long files and lines are, the words that
//! comments begin with, files that documents name. ARCHITECTURE.md and CONTRIBUTING.md say them. A rule on written
//! text has a file of its own here, and reads [`written::written`].

mod imports;
mod lengths;
mod licences;
mod mirrors;
mod modules;
mod names;
mod shaders;
mod systems;
mod words;
mod written;

use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).to_owned()
}

fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files(&path, found);
        } else {
            found.push(path);
        }
    }
}

/// The place of a room in a list of them, from the lowest to the highest; rooms of one line do not import each other.
fn height(rooms: &[&[&str]], room: &str) -> usize {
    rooms.iter().position(|line| line.contains(&room)).unwrap_or_else(|| panic!("room {room} is not in the list"))
}
