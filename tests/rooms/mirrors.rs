// SPDX-License-Identifier: MIT OR Apache-2.0
//! The lists of ARCHITECTURE.md that say where a field of a struct is changed name all its mirrors: the files that
//! declare the field once more, in Rust, WGSL, C++, Python and the example programs.

use crate::root;
use crate::written::written;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Structs whose fields stand in many files, each with the fields that have names of their own: `radius` or `flags`
/// would be found everywhere. Every mirror of such a struct has at least one of these.
const STRUCTS: [(&str, &[&str]); 3] = [
    ("BhrFilm", &["tone_map", "exposure_ev", "beam_fwhm", "colour_map"]),
    ("BhrDisk", &["edge_softness", "emission_law"]),
    ("BhrVolume", &["temperature_slope", "sub_keplerian", "clumping", "heating"]),
];

/// Folders that mirrors lie in. Tests, the twins among them, compare all fields, and fail by themselves.
const FOLDERS: [&str; 6] = ["examples-c", "examples-other", "include", "python/src", "shaders", "src"];

/// Files that are generated, what tests only, scenes, which set fields and declare none, and what names a few fields
/// that users see under other names.
fn is_left_out(path: &Path) -> bool {
    let known = [
        "examples-c/fields.c",
        "examples-c/panel/field_look.cpp",
        "examples-c/scene_options.c",
        "include/bhr.h",
        "include/bhr.json",
        "include/bhr_interop.h",
        "include/bhr/structs.hpp",
        "python/src/bhr/_fields.py",
        "src/capi/field_list.rs",
    ];
    known.iter().any(|name| path == Path::new(name))
        || path.starts_with("src/gpu/twins")
        || path.starts_with("examples-c/scenes")
        || path.ends_with("tests.rs")
}

/// Whether code declares a field of this name, or lists it in a table. A field that is read or set (`film.exposure_ev`,
/// `.exposure_ev = 1`) is no mirror, nor is a module or a function of that name.
fn declares(line: &str, name: &str) -> bool {
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    line.match_indices(name).any(|(at, _)| {
        let (before, after) = (&line[..at], &line[at + name.len()..]);
        !before.ends_with(is_part)
            && !after.starts_with(is_part)
            && !after.starts_with("::")
            && !["fn ", "mod ", ".", "->"].iter().any(|used| before.ends_with(used) && !before.ends_with(".."))
    })
}

/// The text without comments and imports, and in Rust without the tests at its end.
fn code<'a>(path: &Path, marks: &[&str], text: &'a str) -> Vec<&'a str> {
    let is_rust = path.extension().is_some_and(|extension| extension == "rs");
    let text = text.split("#[cfg(test)]\nmod ").next().filter(|_| is_rust).unwrap_or(text);
    let lines = text.lines().filter(|line| {
        let begin = line.trim_start();
        !marks.iter().any(|mark| begin.starts_with(mark)) && !begin.starts_with("use ")
    });
    lines.map(|line| line.split(" // ").next().unwrap().split(" /* ").next().unwrap()).collect()
}

/// The files in which the name of a field stands, as a declaration.
fn mirrors(fields: &[&str]) -> BTreeSet<PathBuf> {
    let dashed: Vec<String> = fields.iter().map(|field| field.replace('_', "-")).collect();
    let names: Vec<&str> = fields.iter().copied().chain(dashed.iter().map(String::as_str)).collect();
    let has = |(path, marks, text): &(PathBuf, &[&str], String)| {
        code(path, marks, text).iter().any(|line| names.iter().any(|name| declares(line, name)))
    };
    let lies_there = |path: &Path| FOLDERS.iter().any(|folder| path.starts_with(folder)) && !is_left_out(path);
    written().into_iter().filter(|file| lies_there(&file.0) && has(file)).map(|file| file.0).collect()
}

/// The files that a list of ARCHITECTURE.md names.
fn listed(page: &str, name: &str) -> BTreeSet<PathBuf> {
    let begin = format!("- **A field of {name}**:");
    let list = page.split_once(&begin).unwrap_or_else(|| panic!("ARCHITECTURE.md has no list \"{begin}\"")).1;
    let list = list.split("\n- ").next().unwrap().split("\n\n").next().unwrap();
    let is_file = |word: &&str| [".c", ".cpp", ".hpp", ".py", ".rs", ".wgsl"].iter().any(|end| word.ends_with(end));
    let quoted = list.split('`').skip(1).step_by(2).filter(is_file);
    let place = |word: &str| {
        let below_root = FOLDERS.iter().any(|folder| Path::new(word).starts_with(folder));
        if below_root { PathBuf::from(word) } else { Path::new("src").join(word) }
    };
    quoted.map(place).collect()
}

#[test]
fn lists_of_fields_name_every_mirror() {
    let page = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let mut wrong = Vec::new();
    for (name, fields) in STRUCTS {
        let (found, list) = (mirrors(fields), listed(&page, name));
        assert!(found.len() > 4, "{name}: {found:?}");
        let missing = found.difference(&list).map(|path| format!("{name}: its list lacks {}", path.display()));
        wrong.extend(missing);
        for path in &list {
            if !root().join(path).is_file() {
                wrong.push(format!("{name}: its list names {}, which is not there", path.display()));
            } else if !path.starts_with("src") && !path.starts_with("shaders") && !found.contains(path) {
                // Rust and WGSL may hold numbers that are derived of fields; a mirror for hosts has the names.
                wrong.push(format!("{name}: {} has none of its fields any more", path.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "ARCHITECTURE.md, Where to change what:\n{}", wrong.join("\n"));
}

/// The fields by which mirrors are found are fields, and each struct has all of them.
#[test]
fn mirrors_are_found_by_fields_that_there_are() {
    for (name, fields) in STRUCTS {
        let file = format!("src/capi/{}.rs", name.trim_start_matches("Bhr").to_lowercase());
        let text = fs::read_to_string(root().join(&file)).unwrap();
        let body = text.split_once(&format!("pub struct {name} {{")).unwrap().1.split_once("\n}").unwrap().0;
        for field in fields {
            assert!(body.contains(&format!("    pub {field}: ")), "{name} has no field {field}");
        }
    }
}

#[test]
fn declarations_are_told_from_uses() {
    for line in [
        "    pub beam_fwhm: f64,",
        "    beam_fwhm: f32,",
        "    beam_fwhm: float = 0.0",
        "    double beam_fwhm;",
        "    Film &beam_fwhm(double frame_heights) noexcept {",
        "    {\"--beam-fwhm\", OPTION_NUMBER},",
        "        Film { beam_fwhm, ..Film::default() }",
    ] {
        assert!(["beam_fwhm", "beam-fwhm"].iter().any(|name| declares(line, name)), "{line}");
    }
    for line in [
        "    film.beam_fwhm = 0.1;",
        "    film->beam_fwhm = 0.1;",
        "    .beam_fwhm = 0.1,",
        "    fn beam_fwhm() -> f64 {",
        "    beam_fwhm::MAX,",
        "    half_beam_fwhm: f32,",
        "    beam_fwhm_x: f32,",
    ] {
        assert!(!declares(line, "beam_fwhm"), "{line}");
    }
}
