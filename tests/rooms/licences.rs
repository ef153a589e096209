// SPDX-License-Identifier: MIT OR Apache-2.0
//! Every source names its licence.

use crate::written::written;

/// Documents and data have theirs in REUSE.toml.
#[test]
fn every_source_names_its_licence() {
    const LINE: &str = "SPDX-License-Identifier: MIT OR Apache-2.0";
    let mut without = written();
    without.retain(|(_, marks, text)| !marks.is_empty() && !text.lines().take(3).any(|line| line.contains(LINE)));
    let names = without.iter().map(|(path, ..)| path.display().to_string()).collect::<Vec<_>>();
    assert!(names.is_empty(), "without a line of their licence: {names:#?}");
}
