// SPDX-License-Identifier: MIT OR Apache-2.0
//! The rooms of src/ and who may use whom: every room imports from the rooms below it only, files that import each
//! other in a circle are at most three, and no file that people write is long or wide. It tests what ARCHITECTURE.md
//! says.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

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

/// The folders of shaders/, in the same way. The fragment `constants`, which is printed from Rust, lies below them all.
const SHADER_ROOMS: [&[&str]; 8] = [
    &["shared"],
    &["geodesic"],
    &["camera"],
    &["records"],
    &["bloom", "emit", "film", "sky", "window"],
    &["lens", "traced"],
    &["shade"],
    &["refine"],
];

const LONGEST_FILE: usize = 600;
const WIDEST_LINE: usize = 120;
const LARGEST_CIRCLE: usize = 3;

/// A module's path below the crate, such as ["gpu", "device", "texture"].
type Module = Vec<String>;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).to_owned()
}

fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files(&path, found);
        } else {
            found.push(path);
        }
    }
}

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

fn height(rooms: &[&[&str]], room: &str) -> usize {
    rooms.iter().position(|line| line.contains(&room)).unwrap_or_else(|| panic!("room {room} is not in the list"))
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
fn shaders_import_downward() {
    let mut found = Vec::new();
    let shaders = root().join("shaders");
    files(&shaders, &mut found);
    let (mut upward, mut folders) = (Vec::new(), BTreeSet::new());
    for path in found {
        let name = path.strip_prefix(&shaders).unwrap().with_extension("").to_str().unwrap().to_owned();
        let room = |fragment: &str| fragment.split('/').next().unwrap().to_owned();
        folders.insert(room(&name));
        let text = fs::read_to_string(&path).unwrap();
        for import in text.lines().filter_map(|line| line.strip_prefix("#import ")).filter(|i| *i != "constants") {
            let (from, to) = (room(&name), room(import));
            if from != to && height(&SHADER_ROOMS, &to) >= height(&SHADER_ROOMS, &from) {
                upward.push(format!("{name} -> {import}"));
            }
        }
    }
    assert!(upward.is_empty(), "{upward:#?}");
    let listed = SHADER_ROOMS.iter().flat_map(|line| line.iter().map(ToString::to_string)).collect();
    assert_eq!(folders, listed);
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

/// Files that are kept as they were once written, and those that Doxygen writes.
const AS_THEY_ARE: [&str; 5] = ["tests/abi", "tests/contract.h", "tests/golden", "src/sky/data", "docs/site"];

/// The marks that begin a comment in a file; `None` for data, which nobody reads.
fn comment_marks(path: &Path) -> Option<&'static [&'static str]> {
    let name = path.file_name()?.to_str()?;
    match name.rsplit_once('.').map_or(name, |(_, extension)| extension) {
        "rs" | "wgsl" | "c" | "cpp" | "h" | "hpp" | "js" | "go" => Some(&["///", "//!", "//", "/*", "* "]),
        "lua" => Some(&["--"]),
        "py" | "pyi" => Some(&["\"\"\"", "#"]),
        "run" | "sh" | "toml" | "supp" => Some(&["#"]),
        // Scripts without an extension, and what packagers' tools read.
        "install" | "deb" | "tarball" | "manpage" | "bare-container" | "rules" | "cmake" | "yml" | "rb" => Some(&["#"]),
        "txt" => name.starts_with("CMake").then_some(&["#"]),
        "md" => Some(&[]),
        "awk" | "build" | "check-links" | "Doxyfile" => Some(&["#"]),
        _ => None,
    }
}

/// Every file that people read and write, with its marks of a comment and its text.
fn written() -> Vec<(PathBuf, &'static [&'static str], String)> {
    let mut found = fs::read_dir(root()).unwrap().map(|entry| entry.unwrap().path()).collect::<Vec<_>>();
    found.retain(|path| path.is_file());
    for folder in [
        ".ci",
        "benches",
        "docs",
        "examples-c",
        "examples-other",
        "include",
        "packaging",
        "python",
        "shaders",
        "src",
        "tests",
    ] {
        files(&root().join(folder), &mut found);
    }
    let read = |path: PathBuf| {
        let name = path.strip_prefix(root()).unwrap().to_owned();
        let kept = AS_THEY_ARE.iter().any(|kept| name.starts_with(kept));
        comment_marks(&path).filter(|_| !kept).map(|marks| (name, marks, fs::read_to_string(&path).unwrap()))
    };
    found.into_iter().filter_map(read).collect()
}

#[test]
fn no_source_is_long_or_wide() {
    let mut wrong = Vec::new();
    for (name, _, text) in written() {
        let lines = text.lines().count();
        // The header is one file because hosts read it so.
        if lines > LONGEST_FILE && name != Path::new("include/bhr.h") {
            wrong.push(format!("{} has {lines} lines", name.display()));
        }
        // A row of a table in Markdown is one line, whatever it holds.
        let row = |line: &str| name.extension().is_some_and(|e| e == "md") && line.starts_with('|');
        let wide = text.lines().zip(1..).filter(|(line, _)| line.chars().count() > WIDEST_LINE && !row(line));
        wrong.extend(wide.map(|(_, number)| format!("{}:{number} is wide", name.display())));
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

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

/// Words that leave a reader asking for the noun that they belong to.
const DANGLING: [&str; 4] = ["Of ", "What ", "Who ", "Which "];

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

/// Documents and data have theirs in REUSE.toml.
#[test]
fn every_source_names_its_licence() {
    const LINE: &str = "SPDX-License-Identifier: MIT OR Apache-2.0";
    let mut without = written();
    without.retain(|(_, marks, text)| !marks.is_empty() && !text.lines().take(3).any(|line| line.contains(LINE)));
    let names = without.iter().map(|(path, ..)| path.display().to_string()).collect::<Vec<_>>();
    assert!(names.is_empty(), "without a line of their licence: {names:#?}");
}

/// The rules find what they are for.
#[test]
fn every_kind_of_file_is_read() {
    let names = written().into_iter().map(|(name, ..)| name).collect::<BTreeSet<_>>();
    let kinds = [
        ".ci/run",
        "ARCHITECTURE.md",
        "Cargo.toml",
        "build.rs",
        "docs/numerics.md",
        "examples-c/CMakeLists.txt",
        "examples-c/panel.cpp",
        "examples-other/hole.go",
        "examples-other/hole.js",
        "examples-other/hole.lua",
        "include/bhr.h",
        "include/bhr.hpp",
        "python/src/bhr/__init__.py",
        "shaders/shared/math.wgsl",
        "tests/c/check.c",
        "tests/lib.sh",
        "tests/run",
    ];
    for kind in kinds {
        assert!(names.contains(Path::new(kind)), "{kind} is not checked");
    }
}
