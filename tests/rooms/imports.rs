// SPDX-License-Identifier: MIT OR Apache-2.0
//! The rooms of src/ and who may use whom: every room imports from the rooms below it only, and files that import each
//! other in a circle are at most three.

use crate::{files, height, root};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;

/// From the lowest to the highest; rooms of one line do not import each other.
const ROOMS: [&[&str]; 15] = [
    &["error"],
    &["allocate", "deferred", "random", "recent", "thread_scope"],
    &["physics"],
    &["emit", "image"],
    &["sky"],
    &["scene"],
    &["film"],
    &["tracer"],
    &["window"],
    &["cpu", "gpu"],
    &["interop", "tracers"],
    &["job", "surface"],
    &["renderer"],
    &["capi"],
    &["lib"],
];

/// The same within `gpu`.
const GPU_ROOMS: [&[&str]; 6] = [&["device"], &["kernel"], &["lens"], &["frame", "window"], &["gl_tracer"], &["mod"]];

const LARGEST_CIRCLE: usize = 3;

/// A module's path below the crate, such as ["gpu", "device", "texture"].
type Module = Vec<String>;

/// The modules of the crate and their text, without comments and tests.
fn modules() -> BTreeMap<Module, String> {
    let all = modules_with_tests();
    let declared_for_tests = |module: &[String]| {
        let Some((name, parent)) = module.split_last() else { return false };
        let declared = all.get(parent).is_some_and(|code| {
            let code = code.replace("#[cfg(test)]\n", "#[cfg(test)] ").replace("pub ", "");
            code.contains(&format!("#[cfg(test)] mod {name};"))
        });
        declared || name == "memory_absent"
    };
    // Modules within one that only tests have are theirs as well.
    let only_tests = |module: &Module| (1..=module.len()).any(|depth| declared_for_tests(&module[..depth]));
    all.iter().filter(|(module, _)| !only_tests(module)).map(|(m, code)| (m.clone(), code.clone())).collect()
}

fn modules_with_tests() -> BTreeMap<Module, String> {
    let source = root().join("src");
    let mut found = Vec::new();
    files(&source, &mut found);
    let rust = found.into_iter().filter(|path| path.extension().is_some_and(|e| e == "rs"));
    rust.map(|path| {
        let place = path.strip_prefix(&source).unwrap().with_extension("");
        let mut module = place.iter().map(|part| part.to_str().unwrap().to_owned()).collect::<Module>();
        if matches!(module.last().map(String::as_str), Some("mod" | "lib")) {
            module.pop();
        }
        let text = fs::read_to_string(&path).unwrap();
        let tests = text.match_indices("#[cfg(test)]\n").map(|(at, _)| at);
        let end = tests
            .into_iter()
            .find(|at| text[*at..].lines().nth(1).is_some_and(|line| line.contains("mod ") && line.ends_with('{')));
        let code = &text[..end.unwrap_or(text.len())];
        // A visibility imports nothing.
        let code = code.replace("pub(in crate::gpu)", "pub").replace("pub(crate)", "pub");
        (module, code.lines().map(|line| line.split("//").next().unwrap()).collect::<Vec<_>>().join("\n"))
    })
    .collect()
}

/// `a::{b, c::{d, e}}` to `a::b`, `a::c::d`, `a::c::e`.
fn expanded(tree: &str) -> Vec<String> {
    let Some((head, rest)) = tree.split_once('{') else { return vec![tree.to_owned()] };
    let (mut depth, mut item, mut items) = (0, String::new(), Vec::new());
    for c in rest[..rest.rfind('}').unwrap()].chars() {
        match c {
            ',' if depth == 0 => items.push(std::mem::take(&mut item)),
            _ => {
                depth += i32::from(c == '{') - i32::from(c == '}');
                item.push(c);
            }
        }
    }
    items.push(item);
    items.iter().filter(|item| !item.is_empty()).flat_map(|item| expanded(&format!("{head}{item}"))).collect()
}

/// The imports of a module: the paths behind its `use`, and whether they are exported. Inline modules lie in their
/// file.
fn imports(code: &str) -> Vec<(String, bool)> {
    let mut found = Vec::new();
    for (at, _) in code.match_indices("use ") {
        let before = &code[code[..at].rfind('\n').map_or(0, |n| n + 1)..at];
        let exported = before.trim_start().starts_with("pub");
        let indented = before.starts_with(' ');
        if !(before.trim().is_empty() || exported) {
            continue;
        }
        let end = code[at..].find(';').map_or(code.len(), |n| at + n);
        let tree = code[at + 4..end].replace(" as ", "@").split_whitespace().collect::<String>();
        if !(indented && tree.starts_with("super")) {
            found.extend(expanded(&tree).into_iter().map(|path| (path, exported)));
        }
    }
    for (at, _) in code.match_indices("crate::") {
        let path = code[at..].split(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':')).next().unwrap();
        found.push((path.trim_end_matches(':').to_owned(), false));
    }
    found
}

/// The module of this crate in which what `path`, written in `from`, names is defined.
fn resolved(all: &BTreeMap<Module, String>, from: &Module, path: &str, depth: u32) -> Option<Module> {
    let mut parts = path.split("::").map(|part| part.split('@').next().unwrap()).peekable();
    let mut module = match *parts.peek()? {
        "crate" => Vec::new(),
        "self" | "super" => from.clone(),
        first => {
            let child = [from.as_slice(), &[first.to_owned()]].concat();
            return all.contains_key(&child).then(|| resolved(all, from, &format!("self::{path}"), depth)).flatten();
        }
    };
    while matches!(parts.peek(), Some(&"crate" | &"self" | &"super")) {
        if parts.next() == Some("super") {
            module.pop();
        }
    }
    while let Some(part) = parts.peek() {
        let child = [module.as_slice(), &[(*part).to_owned()]].concat();
        if !all.contains_key(&child) {
            break;
        }
        module = child;
        parts.next();
    }
    // A name that the module has from another one.
    if let Some(name) = parts.next().filter(|_| depth < 4) {
        for (export, _) in imports(&all[&module]).into_iter().filter(|(_, exported)| *exported) {
            let shown = export.rsplit("::").next().unwrap().rsplit('@').next().unwrap().to_owned();
            if shown == name
                && let Some(home) = resolved(all, &module, &export, depth + 1)
            {
                return Some(home);
            }
        }
    }
    Some(module)
}

/// The modules that each module imports from.
fn arrows() -> BTreeMap<Module, BTreeSet<Module>> {
    let all = modules();
    let of = |module: &Module, code: &str| {
        let targets = imports(code).into_iter().filter_map(|(path, _)| resolved(&all, module, &path, 0));
        targets.filter(|target| target != module).collect()
    };
    all.iter().map(|(module, code)| (module.clone(), of(module, code))).collect()
}

#[test]
fn rooms_import_downward() {
    let mut upward = Vec::new();
    let room = |module: &Module, level: usize| module.get(level).map_or("lib", String::as_str).to_owned();
    let inner = |module: &Module| module.get(1).map_or("mod", String::as_str).to_owned();
    for (from, targets) in arrows() {
        for to in targets.iter().filter(|to| !to.is_empty()) {
            let (a, b) = (room(&from, 0), room(to, 0));
            let outer = a != b && height(&ROOMS, &b) >= height(&ROOMS, &a);
            let (c, d) = (inner(&from), inner(to));
            let within = a == "gpu" && b == "gpu" && c != d && height(&GPU_ROOMS, &d) >= height(&GPU_ROOMS, &c);
            if outer || within {
                upward.push(format!("{} -> {}", from.join("::"), to.join("::")));
            }
        }
    }
    assert!(upward.is_empty(), "{upward:#?}");
}

#[test]
fn circles_of_files_are_small() {
    let arrows = arrows();
    let reached = |from: &Module| {
        let (mut seen, mut left) = (BTreeSet::new(), vec![from.clone()]);
        while let Some(module) = left.pop() {
            left.extend(arrows[&module].iter().filter(|next| seen.insert((*next).clone())).cloned());
        }
        seen
    };
    let all = arrows.keys().map(|module| (module, reached(module))).collect::<BTreeMap<_, _>>();
    for (module, reach) in &all {
        let circle = reach.iter().filter(|other| all[other].contains(*module)).collect::<Vec<_>>();
        assert!(circle.len() <= LARGEST_CIRCLE, "{circle:?}");
    }
}
