// SPDX-License-Identifier: MIT OR Apache-2.0
//! The modules of src/ and who may use whom: every room imports from the rooms below it only; within a room every file
//! and folder imports only from those that its mod.rs declares before it, so that the order of a room's `mod` lines is
//! the order of the room, lowest first. Files that import each other in a circle, as a file and those in its folder
//! may, are few.

use crate::height;
use crate::modules::{Crate, Module, sources};
use std::collections::{BTreeMap, BTreeSet};

/// From the lowest to the highest; rooms of one line do not import each other.
const ROOMS: [&[&str]; 16] = [
    &["error", "platform"],
    &["allocate", "attempt", "deferred", "parallel", "random", "recent", "thread_scope", "thread_state"],
    &["physics"],
    &["emit", "image"],
    &["sky"],
    &["scene"],
    &["film"],
    &["tracer"],
    &["window"],
    &["cpu", "gpu"],
    &["interop", "tracers"],
    &["accumulation", "job", "surface"],
    &["renderer"],
    &["capi"],
    &["web"],
    &["lib"],
];

/// Folders of one parent that do not import each other at all.
const APART: [[&str; 2]; 1] = [["gpu/frame", "gpu/window"]];

const LARGEST_CIRCLE: usize = 3;

/// An import: the file that it leads to, and a path that makes it.
type Arrows = BTreeMap<String, BTreeMap<String, String>>;

fn arrows(all: &Crate) -> Arrows {
    let of = |name: &String| {
        let file = &all.files[name];
        let mut targets = BTreeMap::new();
        for path in &file.paths {
            if let Some(home) = all.home(file, path).filter(|home| home != name) {
                targets.entry(home.to_owned()).or_insert_with(|| path.text());
            }
        }
        (name.clone(), targets)
    };
    all.files.keys().map(of).collect()
}

/// The reason why one module may not import from another; `None`: it may.
fn refusal(all: &Crate, from: &Module, to: &Module) -> Option<String> {
    let common = from.iter().zip(to).take_while(|(a, b)| a == b).count();
    // A file and those in its folder are one thing in parts.
    let (a, b) = (from.get(common)?, to.get(common)?);
    let parent = &from[..common];
    let Some(room) = parent.last() else {
        let upward = height(&ROOMS, b) >= height(&ROOMS, a);
        return upward.then(|| format!("the room {b} does not lie below {a}"));
    };
    let place = |name: &String| all.children(parent).iter().position(|child| child.name == *name);
    let names =
        [[parent, std::slice::from_ref(a)].concat().join("/"), [parent, std::slice::from_ref(b)].concat().join("/")];
    let apart = APART.iter().any(|pair| pair.iter().all(|one| names.iter().any(|name| name == one)));
    match () {
        () if apart => Some(format!("{a} and {b} are apart")),
        () if place(b) >= place(a) => Some(format!("{room} declares {b} after {a}: what is imported comes before")),
        () => None,
    }
}

#[test]
fn rooms_and_their_files_import_downward() {
    let all = Crate::read();
    let mut upward = Vec::new();
    for (name, targets) in arrows(&all) {
        let from = &all.files[&name].module;
        for (target, path) in targets {
            if let Some(why) = refusal(&all, from, &all.files[&target].module).filter(|_| target != "lib") {
                upward.push(format!("src/{name}.rs -> src/{target}.rs ({path}): {why}"));
            }
        }
    }
    assert!(
        upward.is_empty(),
        "the modules of a room are declared lowest first; where two import each other, what both need belongs in a \
         file below them: {upward:#?}"
    );
}

#[test]
fn circles_of_files_are_small() {
    fn reached<'a>(arrows: &'a Arrows, from: &'a String) -> BTreeSet<&'a String> {
        let (mut seen, mut left) = (BTreeSet::new(), vec![from]);
        while let Some(file) = left.pop() {
            left.extend(arrows[file].keys().filter(|next| seen.insert(*next)));
        }
        seen
    }
    let arrows = arrows(&Crate::read());
    let all = arrows.keys().map(|file| (file, reached(&arrows, file))).collect::<BTreeMap<_, _>>();
    let circle = |file, reach: &BTreeSet<&String>| {
        reach.iter().copied().filter(|other| all[other].contains(file)).cloned().collect::<Vec<_>>()
    };
    let circles = all.iter().map(|(file, reach)| circle(file, reach)).collect::<BTreeSet<_>>();
    let large = circles.iter().filter(|circle| circle.len() > LARGEST_CIRCLE).collect::<Vec<_>>();
    assert!(large.is_empty(), "circles of more than {LARGEST_CIRCLE} files: {large:#?}");
}

#[test]
fn every_source_is_a_module() {
    let all = Crate::read();
    let modules = all.files.keys().chain(&all.for_tests).cloned().collect::<BTreeSet<_>>();
    assert_eq!(modules, sources().into_iter().collect());
}
