// SPDX-License-Identifier: MIT OR Apache-2.0
//! Files that text names are there.

use crate::root;
use crate::written::written;
use std::path::Path;

/// A file that is named with its folder is there: below the root, src, shaders or tests, or beside the file that names
/// it. NAME stands for any.
#[test]
fn files_that_are_named_are_there() {
    let mut missing = Vec::new();
    for (name, _, text) in written() {
        let beside = name.parent().unwrap().to_owned();
        for (line, number) in text.lines().zip(1..) {
            let is_part = |c: char| c.is_ascii_alphanumeric() || "_-./$".contains(c);
            let named = line.split(|c| !is_part(c)).map(|word| word.trim_end_matches('.'));
            let paths = named.filter(|word| [".rs", ".wgsl", ".md"].iter().any(|end| word.ends_with(end)));
            for path in paths
                .filter(|path| path.contains('/') && !path.starts_with(['/', '.', '-', '$']) && !path.contains("NAME"))
            {
                let places = [Path::new(""), "src".as_ref(), "shaders".as_ref(), "tests".as_ref(), &beside];
                if !places.iter().any(|place| root().join(place).join(path).is_file()) {
                    missing.push(format!("{}:{number} {path}", name.display()));
                }
            }
        }
    }
    assert!(missing.is_empty(), "{missing:#?}");
}
