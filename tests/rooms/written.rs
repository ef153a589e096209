// SPDX-License-Identifier: MIT OR Apache-2.0
//! The files that people read and write.

use crate::{files, root};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Files that are kept as they were once written, and those that Doxygen writes.
const AS_THEY_ARE: [&str; 5] = ["tests/abi", "tests/contract.h", "tests/golden", "src/sky/data", "docs/site"];

/// The marks that begin a comment in a file; `None` for data, which nobody reads.
fn comment_marks(path: &Path) -> Option<&'static [&'static str]> {
    let name = path.file_name()?.to_str()?;
    match name.rsplit_once('.').map_or(name, |(_, extension)| extension) {
        "rs" | "wgsl" | "c" | "cpp" | "h" | "hpp" | "js" | "ts" | "go" => Some(&["///", "//!", "//", "/*", "* "]),
        "lua" => Some(&["--"]),
        "py" | "pyi" => Some(&["\"\"\"", "#"]),
        "run" | "sh" | "toml" | "supp" => Some(&["#"]),
        // Scripts without an extension, and what packagers' tools read.
        "install" | "deb" | "tarball" | "release" | "manpage" | "bare-container" | "rules" | "cmake" | "yml"
        | "yaml" | "rb" => Some(&["#"]),
        "txt" => name.starts_with("CMake").then_some(&["#"]),
        "md" => Some(&[]),
        "awk" | "build" | "check-links" | "Doxyfile" | "fetch-toolkits" | "fetch-dxc" => Some(&["#"]),
        _ => None,
    }
}

/// Every file that people read and write, with its marks of a comment and its text.
pub fn written() -> Vec<(PathBuf, &'static [&'static str], String)> {
    let mut found = fs::read_dir(root()).unwrap().map(|entry| entry.unwrap().path()).collect::<Vec<_>>();
    found.retain(|path| path.is_file());
    for folder in [
        ".ci",
        "benches",
        "cli",
        "docs",
        "examples-c",
        "examples-other",
        "farm",
        "include",
        "packaging",
        "python",
        "shaders",
        "src",
        "tests",
        "web",
    ] {
        files(&root().join(folder), &mut found);
    }
    let read = |path: PathBuf| {
        let name = path.strip_prefix(root()).unwrap().to_owned();
        let kept = AS_THEY_ARE.iter().any(|kept| name.starts_with(kept));
        comment_marks(&path).filter(|_| !kept).map(|marks| (name, marks, fs::read_to_string(&path).unwrap()))
    };
    found.into_iter().filter_map(read).collect()
}

/// The rules find what they are for.
#[test]
fn every_kind_of_file_is_read() {
    let names = written().into_iter().map(|(name, ..)| name).collect::<BTreeSet<_>>();
    let kinds = [
        ".ci/run",
        "ARCHITECTURE.md",
        "Cargo.toml",
        "build.rs",
        "docs/numerics.md",
        "examples-c/CMakeLists.txt",
        "examples-c/panel.cpp",
        "examples-other/hole.go",
        "examples-other/hole.js",
        "examples-other/hole.lua",
        "include/bhr.h",
        "include/bhr.hpp",
        "python/src/bhr/__init__.py",
        "shaders/shared/math.wgsl",
        "tests/c/check.c",
        "tests/lib.sh",
        "tests/run",
    ];
    for kind in kinds {
        assert!(names.contains(Path::new(kind)), "{kind} is not checked");
    }
}
