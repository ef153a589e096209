// SPDX-License-Identifier: MIT OR Apache-2.0
//! The folders of shaders/: each imports from those below it only.

use crate::{files, height, root};
use std::collections::BTreeSet;
use std::fs;

/// The folders of shaders/, in the same way. The fragment `constants`, which is printed from Rust, lies below them all.
const SHADER_ROOMS: [&[&str]; 9] = [
    &["shared"],
    &["geodesic"],
    &["camera"],
    &["records"],
    &["bloom", "emit", "film", "sky", "window"],
    &["metering"],
    &["lens", "traced"],
    &["shade"],
    &["refine"],
];

#[test]
fn shaders_import_downward() {
    let mut found = Vec::new();
    let shaders = root().join("shaders");
    files(&shaders, &mut found);
    let (mut upward, mut folders) = (Vec::new(), BTreeSet::new());
    for path in found {
        let name = path.strip_prefix(&shaders).unwrap().with_extension("").to_str().unwrap().to_owned();
        let room = |fragment: &str| fragment.split('/').next().unwrap().to_owned();
        folders.insert(room(&name));
        let text = fs::read_to_string(&path).unwrap();
        for import in text.lines().filter_map(|line| line.strip_prefix("#import ")).filter(|i| *i != "constants") {
            let (from, to) = (room(&name), room(import));
            if from != to && height(&SHADER_ROOMS, &to) >= height(&SHADER_ROOMS, &from) {
                upward.push(format!("{name} -> {import}"));
            }
        }
    }
    assert!(upward.is_empty(), "{upward:#?}");
    let listed = SHADER_ROOMS.iter().flat_map(|line| line.iter().map(ToString::to_string)).collect();
    assert_eq!(folders, listed);
}
