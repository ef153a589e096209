// SPDX-License-Identifier: MIT OR Apache-2.0
//! The words that comments begin with.

use crate::written::written;

/// Words that leave a reader asking for the noun that they belong to.
const DANGLING: [&str; 9] = ["Of ", "What ", "Who ", "Which ", "The same", "Those", "It ", "As ", "Nothing"];

#[test]
fn no_comment_begins_with_a_dangling_word() {
    let mut wrong = Vec::new();
    for (name, marks, text) in written() {
        let comment = |line: &str| {
            let line = line.trim_start();
            marks.iter().find_map(|mark| line.strip_prefix(mark)).map(|rest| rest.trim_start().to_owned())
        };
        let mut before = None;
        for (line, number) in text.lines().zip(1..) {
            let said = comment(line);
            // An empty comment line ends a paragraph.
            let begins = before.as_deref().is_none_or(str::is_empty);
            if begins && said.as_deref().is_some_and(|said| DANGLING.iter().any(|w| said.starts_with(w))) {
                wrong.push(format!("{}:{number} {}", name.display(), line.trim()));
            }
            before = said;
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
