// SPDX-License-Identifier: MIT OR Apache-2.0
//! THIRD-PARTY.txt is made here, from Cargo.lock and the crates' own licence files: it names all that a built library
//! contains, on one platform or another. A licence that nobody has agreed to fails. Security advisories are not
//! checked: the tests run offline, without a database of them.

use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

/// One target for each platform: which crates are linked does not depend on the processor.
const PLATFORMS: [&str; 7] = [
    "x86_64-unknown-linux-gnu",
    "x86_64-unknown-freebsd",
    "x86_64-pc-windows-msvc",
    "aarch64-apple-darwin",
    "aarch64-apple-ios",
    "aarch64-linux-android",
    "wasm32-unknown-unknown",
];

/// Licences, as crates state them, that let a library of MIT or Apache-2.0 contain their work, for its notice alone.
const ALLOWED: [&str; 18] = [
    "(MIT OR Apache-2.0) AND Unicode-3.0",
    "0BSD OR MIT OR Apache-2.0",
    "Apache-2.0",
    "Apache-2.0 OR MIT",
    "Apache-2.0 WITH LLVM-exception OR Apache-2.0 OR MIT",
    "Apache-2.0/MIT",
    "BSD-2-Clause OR Apache-2.0 OR MIT",
    "BSD-3-Clause",
    "BSD-3-Clause OR MIT OR Apache-2.0",
    "ISC",
    "MIT",
    "MIT OR Apache-2.0",
    "MIT OR Apache-2.0 OR Zlib",
    "MIT OR Zlib OR Apache-2.0",
    "MIT/Apache-2.0",
    "Unlicense OR MIT",
    "Zlib",
    "Zlib OR Apache-2.0 OR MIT",
];

/// Crates that only build or test the library, with their licences.
const ALLOWED_TOOLS: [(&str, &str); 2] = [("cbindgen", "MPL-2.0"), ("r-efi", "MIT OR Apache-2.0 OR LGPL-2.1-or-later")];

const HEAD: &str = "\
Third-party notices of bhr

A library that is built from this repository (libbhr.so, libbhr.dylib, bhr.dll, libbhr.a), and the program bhr, contain
the works named here, on one platform or another, and these notices go where they go. Made from Cargo.lock by
tests/header/third_party.rs; do not edit.

It also contains the Rust standard library, in the version of the compiler that built it: Apache-2.0 OR MIT, copyright
The Rust Project Developers (https://thanks.rust-lang.org), with parts under Unicode-3.0 (copyright Unicode, Inc.) and,
in compiler_builtins, Apache-2.0 WITH LLVM-exception. The texts of these licences are below; the notices of its own
parts are the compiler's file share/doc/rust/COPYRIGHT-library.html.
";

/// The embedded stars and Milky Way (src/sky/data).
const DATA: &str = "d3-celestial 0.7.35  BSD-3-Clause  https://github.com/ofrohn/d3-celestial";

struct Crate {
    name: String,
    version: String,
    licence: String,
    authors: Vec<String>,
    repository: String,
    folder: PathBuf,
}

impl Crate {
    fn title(&self) -> String {
        format!("{} {}", self.name, self.version)
    }

    /// The licences and notices in its folder, sorted by file name.
    fn texts(&self) -> Vec<(String, String)> {
        let begins = ["licen", "unlicen", "copying", "copyright", "notice"];
        let mut texts = Vec::new();
        for entry in std::fs::read_dir(&self.folder).unwrap().map(Result::unwrap) {
            let name = entry.file_name().into_string().unwrap();
            if begins.iter().any(|begin| name.to_lowercase().starts_with(begin)) && entry.path().is_file() {
                texts.push((name, std::fs::read_to_string(entry.path()).unwrap()));
            }
        }
        texts.sort();
        texts
    }

    /// The standard words of the licence, for a crate that comes without a licence file: MIT's where there is a
    /// choice, as it is the shortest.
    fn standard_text(&self) -> String {
        if !self.licence.contains("MIT") {
            assert!(self.licence.contains("Apache-2.0"), "{} has no licence text: {}", self.title(), self.licence);
            return read(&root().join("LICENSE-APACHE"));
        }
        let mit = read(&root().join("LICENSE-MIT"));
        let (_, terms) = mit.split_once("bhr developers\n").expect("LICENSE-MIT names bhr's developers");
        let without_address = |author: &String| author.split(" <").next().unwrap_or_default().to_owned();
        let authors = self.authors.iter().map(without_address).collect::<Vec<_>>().join(", ");
        let holder = if authors.is_empty() { format!("the developers of {}", self.name) } else { authors };
        format!("MIT License\n\nCopyright (c) {holder}\n{terms}")
    }
}

fn root() -> PathBuf {
    std::env::var_os("CARGO_MANIFEST_DIR").expect("cargo runs the tests").into()
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Cargo's output for the repository, with its lock file.
fn cargo(arguments: &[&str]) -> String {
    let cargo = std::env::var_os("CARGO").expect("cargo runs the tests");
    let out = Command::new(cargo).current_dir(root()).args(arguments).arg("--locked").output().unwrap();
    assert!(out.status.success(), "cargo {arguments:?}: {}", String::from_utf8_lossy(&out.stderr));
    String::from_utf8(out.stdout).unwrap()
}

/// Everything in Cargo.lock, without bhr itself.
fn crates() -> Vec<Crate> {
    let said: Value = serde_json::from_str(&cargo(&["metadata", "--all-features", "--format-version", "1"])).unwrap();
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let packages = said["packages"].as_array().unwrap().iter().map(|package| Crate {
        name: text(&package["name"]),
        version: text(&package["version"]),
        licence: text(&package["license"]),
        authors: package["authors"].as_array().unwrap().iter().map(text).collect(),
        repository: text(&package["repository"]),
        folder: Path::new(&text(&package["manifest_path"])).parent().unwrap().to_owned(),
    });
    let mut crates = packages.filter(|package| package.name != "libbhr").collect::<Vec<_>>();
    crates.sort_by_key(Crate::title);
    crates
}

/// The titles of the crates that are linked into the library, with all its features, on any platform.
fn linked() -> BTreeSet<String> {
    let mut linked = BTreeSet::new();
    for platform in PLATFORMS {
        let edges = ["tree", "--all-features", "--edges", "normal,no-proc-macro", "--target", platform];
        let tree = cargo(&[&edges[..], &["--prefix", "none", "--format", "{p}"]].concat());
        for line in tree.lines() {
            let mut words = line.split(' ');
            if let (Some(name), Some(version)) = (words.next(), words.next()) {
                linked.insert(format!("{name} {}", version.trim_start_matches('v')));
            }
        }
    }
    linked
}

/// Letters and digits alone: the same for texts that differ in line breaks and markup.
fn letters(text: &str) -> String {
    text.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

fn notices() -> String {
    let linked = linked();
    let crates = crates().into_iter().filter(|one| linked.contains(&one.title())).collect::<Vec<_>>();
    let mut out = format!("{HEAD}\n{DATA}\n");
    // For each text: the form that came first, and the crates that have it.
    let mut texts = BTreeMap::<String, (String, Vec<String>)>::new();
    let mut order = Vec::new();
    let mut add = |text: String, whose: String| {
        let key = letters(&text);
        order.push(key.clone());
        texts.entry(key).or_insert((text, Vec::new())).1.push(whose);
    };
    add(read(&root().join("src/sky/data/LICENSE-d3-celestial.txt")), "d3-celestial 0.7.35".into());
    for one in &crates {
        out += &format!("{}  {}  {}\n", one.title(), one.licence, one.repository);
        let found = one.texts();
        if found.is_empty() {
            add(one.standard_text(), format!("{} (the crate comes without a licence file)", one.title()));
        }
        for (file, text) in found {
            add(text, format!("{} ({file})", one.title()));
        }
    }
    for key in order {
        let Some((text, whose)) = texts.remove(&key) else { continue };
        let text = text.lines().map(str::trim_end).collect::<Vec<_>>().join("\n");
        let line = "-".repeat(100);
        out += &format!("\n{line}\n{}\n{line}\n\n{}\n", whose.join("\n"), text.trim_matches('\n'));
    }
    out
}

/// With BHR_UPDATE_NOTICES set, this test brings THIRD-PARTY.txt up to date.
#[test]
fn the_committed_notices_name_what_is_linked() {
    let (committed, made) = (root().join("THIRD-PARTY.txt"), notices());
    if std::env::var_os("BHR_UPDATE_NOTICES").is_some() {
        std::fs::write(&committed, &made).unwrap();
    }
    assert!(
        std::fs::read_to_string(&committed).unwrap_or_default() == made,
        "THIRD-PARTY.txt is not what Cargo.lock says; bring it up to date with\n\
         BHR_UPDATE_NOTICES=1 cargo test --test header notices"
    );
}

#[test]
fn every_licence_is_allowed() {
    let (crates, linked) = (crates(), linked());
    assert!(linked.len() > 80 && crates.len() > linked.len(), "{} of {} are linked", linked.len(), crates.len());
    for one in &crates {
        let is_tool = !linked.contains(&one.title());
        let of_a_tool = is_tool && ALLOWED_TOOLS.contains(&(one.name.as_str(), one.licence.as_str()));
        let allowed = ALLOWED.contains(&one.licence.as_str()) || of_a_tool;
        assert!(allowed, "the licence of {} is '{}': see whether bhr may have it", one.title(), one.licence);
    }
    for allowed in ALLOWED.iter().chain(ALLOWED_TOOLS.iter().map(|(_, licence)| licence)) {
        assert!(crates.iter().any(|one| one.licence == *allowed), "no crate is '{allowed}' any more");
    }
}
