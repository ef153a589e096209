// SPDX-License-Identifier: MIT OR Apache-2.0
//! The headers are pleasant to read: comments are short, say nothing twice that the preface says for all of them, and
//! have their parts in one form that programs read as well.

use crate::c_header::{HEADER, INTEROP};

/// The longest header: lines.
const LONGEST: [(&str, &str, usize); 2] = [("bhr.h", HEADER, 1970), ("bhr_interop.h", INTEROP, 500)];
/// The longest comment, and the longest section of a preface: words. More belongs into docs/.
const MAX_WORDS: usize = 150;

/// A header's comments as one line each, and the sections of its preface but for the example.
fn comments(header: &str) -> Vec<String> {
    let (preface, rest) = header.split_once("*/").expect("a preface ends");
    let sections = preface.split("\n *\n * ").filter(|section| !section.starts_with("Example\n"));
    let documented = rest.split("/**").skip(1).map(|text| text.split_once("*/").expect("a comment ends").0);
    let plain = |text: &str| {
        let lines = text.trim_start_matches('<').lines().map(|line| line.trim_start().trim_start_matches('*').trim());
        lines.collect::<Vec<_>>().join(" ").trim().to_owned()
    };
    sections.chain(documented).map(plain).collect()
}

#[test]
fn headers_and_their_comments_are_short() {
    for (name, header, lines) in LONGEST {
        let found = header.lines().count();
        assert!(found <= lines, "{name} has {found} lines, more than {lines}");
        let comments = comments(header);
        assert!(comments.len() > 60, "{name}: {} comments", comments.len());
        for comment in comments {
            let words = comment.split_whitespace().count();
            assert!(words <= MAX_WORDS, "{name}: {words} words, more than {MAX_WORDS}; docs/ has room:\n{comment}");
        }
    }
}

/// `@since X.Y.Z` ends a comment, and nothing says it in prose.
#[test]
fn versions_are_tags() {
    for (name, header, _) in LONGEST {
        for comment in comments(header) {
            let prose = comment.split_once("@since ").map_or(comment.as_str(), |(before, version)| {
                let numbers: Vec<_> = version.split('.').map(str::parse::<u32>).collect();
                let is_version = numbers.len() == 3 && numbers.iter().all(Result::is_ok);
                // The preface explains the tag.
                assert!(is_version || version.starts_with("X.Y.Z"), "{name}: not @since X.Y.Z at its end: {comment}");
                before
            });
            assert!(!prose.contains("Since "), "{name}: @since X.Y.Z at the end says it: {comment}");
        }
    }
}

/// The preface says it once for all functions: where they may be called, and that NULL is refused.
#[test]
fn comments_do_not_repeat_the_preface() {
    const SAID: [&str; 5] = [
        "INVALID_ARGUMENT for NULL",
        "or a wrong struct_size",
        "Any thread",
        "inside callbacks too",
        "Clears struct_size bytes",
    ];
    for (name, header, _) in LONGEST {
        let rest = header.split_once("*/").expect("a preface ends").1;
        for said in SAID {
            let found = rest.find(said).map(|at| &rest[at.saturating_sub(200)..at + said.len()]);
            assert!(found.is_none(), "{name} says {said:?} once more than the preface: {}", found.unwrap_or_default());
        }
    }
}
