// SPDX-License-Identifier: MIT OR Apache-2.0
//! The files of shaders/, embedded in the library, by their names there without the ending; and `constants`, which Rust
//! writes. Knows nothing of what is in them.

use super::{constants, preprocess};
use crate::error::{Error, Result};
use std::borrow::Cow;

/// Name and text of every file of shaders/, as build.rs lists them.
pub const FILES: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/shaders.rs"));

/// The text of a fragment.
fn find(name: &str) -> Option<Cow<'static, str>> {
    if name == "constants" {
        return Some(constants::fragment().into());
    }
    FILES.iter().find(|(file, _)| *file == name).map(|(_, text)| (*text).into())
}

/// The WGSL of `roots` and of all that they import. Errors: INTERNAL, with the names, where a fragment is missing or
/// something that one requires.
pub fn join(roots: &[&str]) -> Result<String> {
    preprocess::join(&find, roots).map_err(|error| Error::internal(format!("WGSL of {error}")))
}

/// [`join`] with a further root that is no file. Errors: as [`join`].
pub fn join_with(roots: &[&str], (name, text): (&'static str, String)) -> Result<String> {
    let find = |wanted: &str| if wanted == name { Some(text.clone().into()) } else { find(wanted) };
    preprocess::join(&find, &[roots, &[name]].concat()).map_err(|error| Error::internal(format!("WGSL of {error}")))
}

/// The WGSL of a fragment that is no file, and of all that it imports; for tests. Errors: as [`join`].
#[doc(hidden)]
pub fn join_wgsl(text: &str) -> Result<String> {
    const NAME: &str = "a test";
    let find = |name: &str| if name == NAME { Some(text.to_string().into()) } else { find(name) };
    preprocess::join(&find, &[NAME]).map_err(Error::internal)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;
    use wgpu::naga::front::wgsl;
    use wgpu::naga::valid::{Capabilities, ValidationFlags, Validator};

    #[test]
    fn every_file_is_part_of_some_shader() {
        let sources = crate::gpu::shader_sources().expect("WGSL that can be joined");
        for (name, _) in FILES {
            let begin = format!("// {name}.wgsl\n");
            assert!(sources.iter().any(|(_, source)| source.contains(&begin)), "{name} is part of no shader");
        }
    }

    #[test]
    fn lines_are_short_and_comments_are_sentences() {
        for (name, text) in FILES {
            let mut inside = false;
            for (line, number) in text.lines().zip(1..) {
                assert!(line.chars().count() <= 120, "{name}, line {number} has more than 120 columns");
                let comment = line.trim_start().strip_prefix("//");
                let first = comment.and_then(|text| text.split_whitespace().next()).unwrap_or_default();
                let leans = !inside && ["Of", "What", "Who", "Which"].contains(&first);
                assert!(!leans, "{name}, line {number} is no sentence: {line}");
                inside = comment.is_some();
            }
        }
    }

    /// A declaration that stands in for one that a fragment requires.
    fn stub(required: &str) -> String {
        match (required.strip_prefix("var "), required.split_once("->")) {
            (Some(variable), _) => format!("var<private> {variable};\n"),
            (None, Some((_, given))) => format!("{required} {{ var value: {given}; return value; }}\n"),
            (None, None) => format!("{required} {{ }}\n"),
        }
    }

    /// A fragment with all that it imports, and stubs for what is required then.
    fn alone(find: &dyn Fn(&str) -> Option<Cow<'static, str>>, name: &str) -> std::result::Result<(), String> {
        let joined = preprocess::JoinedFragments::new(find, &[name])?;
        let mut required = BTreeSet::new();
        for unmet in joined.unmet() {
            if let Some(found) = unmet.found {
                return Err(format!("{} requires `{}`, but there is `{found}`", unmet.fragment, unmet.required));
            }
            required.insert(unmet.required);
        }
        let source = joined.source() + &required.into_iter().map(stub).collect::<String>();
        let module = wgsl::parse_str(&source).map_err(|error| format!("{name}: {}", error.emit_to_string(&source)))?;
        let checked = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module);
        checked.map_err(|error| format!("{name}: {}", error.emit_to_string(&source)))?;
        Ok(())
    }

    #[test]
    fn every_fragment_imports_and_requires_what_it_uses() {
        for (name, text) in FILES {
            alone(&find, name).unwrap_or_else(|error| panic!("{error}"));
            let code: String = text.lines().filter(|line| !line.starts_with('#') && !line.contains("//")).collect();
            for hook in text.lines().filter_map(|line| line.strip_prefix("#requires fn ")) {
                let (hook, _) = hook.split_once('(').expect("a function");
                assert!(code.contains(&format!("{hook}(")), "{name} has no use for {hook}");
            }
        }
    }
}
