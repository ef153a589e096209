// SPDX-License-Identifier: MIT OR Apache-2.0
//! No file is long, and no line wide.

use crate::written::written;
use std::path::Path;

const LONGEST_FILE: usize = 600;
const WIDEST_LINE: usize = 120;

#[test]
fn no_source_is_long_or_wide() {
    let mut wrong = Vec::new();
    for (name, _, text) in written() {
        let lines = text.lines().count();
        // The header is one file because hosts read it so, and so are the types that are made of it.
        let one_file = ["include/bhr.h", "web/scene.d.ts"].iter().any(|file| name == Path::new(file));
        if lines > LONGEST_FILE && !one_file {
            wrong.push(format!("{} has {lines} lines", name.display()));
        }
        // A row of a table in Markdown is one line, whatever it holds.
        let row = |line: &str| name.extension().is_some_and(|e| e == "md") && line.starts_with('|');
        let wide = text.lines().zip(1..).filter(|(line, _)| line.chars().count() > WIDEST_LINE && !row(line));
        wrong.extend(wide.map(|(_, number)| format!("{}:{number} is wide", name.display())));
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
