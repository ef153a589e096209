// SPDX-License-Identifier: MIT OR Apache-2.0
//! Joins WGSL from fragments that say what they need, in the manner of vello's preprocessor. Two directives do so, each
//! on a line of its own:
//!
//! - `#import NAME`: the fragment NAME is joined as well, before this one, and once however many import it.
//! - `#requires DECLARATION`: another fragment of the kernel declares just this, `fn f(i: u32) -> f32` or `var name:
//!   Type` (in whatever address space). Such a hook lets one text serve several kernels.
//!
//! Knows no fragment by name.

use std::borrow::Cow;
use std::collections::BTreeMap;

type Text = Cow<'static, str>;

/// The meaning of one line of a fragment.
enum SourceLine<'a> {
    Import(&'a str),
    Requires(&'a str),
    Wgsl,
}

/// Errors: a line that begins with `#` and is neither directive.
fn parse_line(text: &str) -> Result<SourceLine<'_>, String> {
    let Some(directive) = text.strip_prefix('#') else { return Ok(SourceLine::Wgsl) };
    match directive.split_once(' ') {
        Some(("import", name)) => Ok(SourceLine::Import(name.trim())),
        Some(("requires", declaration)) => Ok(SourceLine::Requires(declaration)),
        _ => Err(format!("`{text}` is neither `#import NAME` nor `#requires DECLARATION`")),
    }
}

/// Fragments that are to be one module.
pub struct JoinedFragments<'a> {
    find: &'a dyn Fn(&str) -> Option<Text>,
    /// In the order in which they are joined.
    fragments: Vec<(String, Text)>,
    /// Fragments whose imports are being joined, each imported by the one before it.
    open: Vec<String>,
}

/// A requirement of a fragment that is not met, and what there is instead: nothing, or another declaration of the name.
pub struct UnmetRequirement<'a> {
    pub fragment: &'a str,
    pub required: &'a str,
    pub found: Option<String>,
}

impl<'a> JoinedFragments<'a> {
    /// Every fragment of `roots` and all that they import, as `find` has them by name; each once, imports first.
    ///
    /// Errors, with the names: a fragment that is not there, imports in a circle, and a line that is no directive.
    pub fn new(find: &'a dyn Fn(&str) -> Option<Text>, roots: &[&str]) -> Result<Self, String> {
        let mut joined = JoinedFragments { find, fragments: Vec::new(), open: Vec::new() };
        for root in roots {
            joined.add(root)?;
        }
        Ok(joined)
    }

    /// Joins a fragment, its imports before it.
    fn add(&mut self, name: &str) -> Result<(), String> {
        if self.fragments.iter().any(|(joined, _)| joined == name) {
            return Ok(());
        }
        let importer = self.open.last().map_or("a kernel", String::as_str);
        if self.open.iter().any(|open| open == name) {
            return Err(format!("{importer} imports {name}, which imports it: {}", self.open.join(" > ")));
        }
        let text = (self.find)(name).ok_or_else(|| format!("there is no fragment {name}, which {importer} imports"))?;
        self.open.push(name.into());
        for text in text.lines() {
            if let SourceLine::Import(import) = parse_line(text).map_err(|error| format!("{name}: {error}"))? {
                self.add(import)?;
            }
        }
        self.open.pop();
        self.fragments.push((name.into(), text));
        Ok(())
    }

    /// All that is required, and declared by none of the fragments, or otherwise.
    pub fn unmet(&self) -> Vec<UnmetRequirement<'_>> {
        let declared: BTreeMap<_, _> = self.fragments.iter().flat_map(|(_, text)| declarations(text)).collect();
        let required = self.fragments.iter().flat_map(|(name, text)| text.lines().map(move |text| (name, text)));
        let unmet = required.filter_map(|(fragment, text)| {
            let Ok(SourceLine::Requires(required)) = parse_line(text) else { return None };
            let found = declared.get(name_of(required)).cloned();
            (found.as_ref() != Some(&normal(required))).then_some(UnmetRequirement { fragment, required, found })
        });
        unmet.collect()
    }

    /// The WGSL, without directives.
    pub fn source(&self) -> String {
        let mut source = String::new();
        for (name, text) in &self.fragments {
            source += &format!("// {name}.wgsl\n");
            for text in text.lines().filter(|text| matches!(parse_line(text), Ok(SourceLine::Wgsl))) {
                source.extend([text, "\n"]);
            }
        }
        source
    }
}

/// The WGSL of `roots` and all that they import. Errors: as [`JoinedFragments::new`], and what is unmet, with the
/// names.
pub fn join(find: &dyn Fn(&str) -> Option<Text>, roots: &[&str]) -> Result<String, String> {
    let joined = JoinedFragments::new(find, roots)?;
    let unmet = joined.unmet().into_iter().map(|UnmetRequirement { fragment, required, found }| match found {
        Some(found) => format!("{fragment} requires `{required}`, but there is `{found}`"),
        None => format!("{fragment} requires `{required}`, which no fragment declares"),
    });
    let unmet = unmet.collect::<Vec<_>>();
    if unmet.is_empty() { Ok(joined.source()) } else { Err(format!("{}: {}", roots.join(", "), unmet.join("; "))) }
}

/// Functions and variables of a module, by name, as `#requires` would have them. Their declarations begin a line.
fn declarations(text: &str) -> Vec<(String, String)> {
    let starts = text.match_indices('\n').map(|(at, _)| at + 1);
    let starts = std::iter::once(0).chain(starts).filter_map(|at| text.get(at..));
    let found = starts.filter(|rest| ["fn ", "var", "@"].iter().any(|start| rest.starts_with(start)));
    let texts = found.filter_map(|rest| {
        let declaration = without_attributes(rest);
        let end = if declaration.starts_with("fn ") { declaration.find('{') } else { declaration.find(['=', ';']) };
        let is_one = declaration.starts_with("fn ") || declaration.starts_with("var");
        end.filter(|_| is_one).and_then(|end| declaration.get(..end))
    });
    texts.map(|declaration| (name_of(declaration).to_string(), normal(declaration))).collect()
}

/// A declaration without the attributes before it, such as `@group(0) @binding(1)`.
fn without_attributes(mut text: &str) -> &str {
    while text.starts_with('@') {
        text = text.split_once([' ', '\n']).map_or("", |(_, rest)| rest.trim_start());
    }
    text
}

/// The name that a declaration declares.
fn name_of(declaration: &str) -> &str {
    let named = declaration.split_once(' ').map_or("", |(_, rest)| rest);
    // An address space and access mode may stand between: `var<storage, read_write> name: Type`.
    let named =
        if declaration.starts_with("var<") { declaration.split_once('>').map_or("", |(_, rest)| rest) } else { named };
    named.trim_start().split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or("")
}

/// A declaration with one space between words, and a variable's without its address space.
fn normal(declaration: &str) -> String {
    let variable = declaration.strip_prefix("var<").and_then(|rest| rest.split_once('>'));
    let plain = variable.map_or(declaration.to_string(), |(_, rest)| format!("var {rest}"));
    plain.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn joined(fragments: &[(&str, &'static str)], roots: &[&str]) -> Result<String, String> {
        let find = |name: &str| fragments.iter().find(|(known, _)| *known == name).map(|(_, text)| Text::from(*text));
        join(&find, roots)
    }

    #[test]
    fn imports_come_first_and_once() {
        let fragments = [("base", "B"), ("left", "#import base\nL"), ("right", "#import base\nR"), ("other", "O")];
        let source = "// base.wgsl\nB\n// left.wgsl\nL\n// right.wgsl\nR\n";
        assert_eq!(joined(&fragments, &["left", "right", "left"]).as_deref(), Ok(source));
    }

    #[test]
    fn what_is_required_is_declared_just_so() {
        let asks = "#requires var frame: Frame\n#requires fn put(i: u32) -> f32\nfn ask() {}";
        let uniform = "@group(0) @binding(1) var<storage, read_write> frame: Frame;";
        let kernel = "@compute @workgroup_size(8, 16)\nfn run(i: u32) {\n    fn put(i: u32) -> f32 {}\n}";
        let put = "fn put(i: u32)\n    -> f32 { }";
        let run = |text| {
            joined(
                &[("asks", asks), ("kernel", kernel), ("uniform", uniform), ("put", text)],
                &["asks", "kernel", "uniform", "put"],
            )
        };
        assert!(run(put).is_ok(), "{:?}", run(put));
        let none = "asks, kernel, uniform, put: asks requires `fn put(i: u32) -> f32`, which no fragment declares";
        assert_eq!(run("fn other() {}"), Err(none.into()));
        let other = "asks, kernel, uniform, put: asks requires `fn put(i: u32) -> f32`, but there is `fn put(x: f32)`";
        assert_eq!(run("fn put(x: f32) {}"), Err(other.into()));
    }

    #[test]
    fn what_cannot_be_joined_is_named() {
        let fragments = [("a", "#import b"), ("b", "#import c"), ("c", "#import a"), ("d", "#import none")];
        assert_eq!(joined(&fragments, &["a"]), Err("c imports a, which imports it: a > b > c".into()));
        assert_eq!(joined(&fragments, &["d"]), Err("there is no fragment none, which d imports".into()));
        assert_eq!(joined(&fragments, &["none"]), Err("there is no fragment none, which a kernel imports".into()));
        let error = joined(&[("e", "#include x")], &["e"]).expect_err("no directive");
        assert!(error.starts_with("e: `#include x` is neither"), "{error}");
    }
}
