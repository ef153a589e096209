//! What the tests of the C header share: reading a header's declarations and running the C compiler.

#![allow(dead_code)]

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::process::Command;

pub const HEADER: &str = include_str!("../../include/bhr.h");

/// The repository as cargo names it when it runs the test: it may have been moved since the test was built.
pub fn root() -> PathBuf {
    std::env::var_os("CARGO_MANIFEST_DIR").expect("cargo runs the tests").into()
}

/// `text` without comments and preprocessor lines.
pub fn code_of(text: &str) -> String {
    let mut code = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once("/*") {
        code += before;
        rest = after.split_once("*/").expect("a comment ends").1;
    }
    code += rest;
    code.lines().filter(|line| !line.trim_start().starts_with('#')).map(|line| format!("{line}\n")).collect()
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').filter(|word| !word.is_empty())
}

/// The functions that a header declares.
pub fn functions(text: &str) -> BTreeSet<String> {
    words(&code_of(text)).filter(|word| word.starts_with("bhr_")).map(str::to_owned).collect()
}

/// The constants that a header defines.
pub fn constants(text: &str) -> BTreeSet<String> {
    text.lines()
        .filter_map(|line| line.strip_prefix("#define "))
        .filter_map(|definition| words(definition).next())
        .filter(|name| *name != "BHR_H")
        .map(str::to_owned)
        .collect()
}

/// A folder of the calling test's own, inside cargo's target folder.
pub fn scratch(name: &str) -> PathBuf {
    let deps = std::env::current_exe().unwrap();
    let folder = deps.ancestors().nth(3).unwrap().join("tmp").join(name);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// The C (or C++) compiler that `CC` (`CXX`) names, else `cc` (`c++`).
pub fn compiler(cpp: bool) -> Command {
    let (variable, default) = if cpp { ("CXX", "c++") } else { ("CC", "cc") };
    Command::new(std::env::var(variable).unwrap_or_else(|_| default.into()))
}

/// Runs `command`; its stdout. Fails with all it said when it fails.
pub fn run(command: &mut Command) -> String {
    let output = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    assert!(
        output.status.success(),
        "{command:?}: {}\n{}{}",
        output.status,
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8(output.stdout).unwrap()
}
