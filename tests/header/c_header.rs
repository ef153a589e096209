// SPDX-License-Identifier: MIT OR Apache-2.0
//! Shared by the tests of the C header: reading a header's declarations and running the C compiler.

#![allow(dead_code)]

use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::PathBuf;
use std::process::Command;

pub const HEADER: &str = include_str!("../../include/bhr.h");
pub const INTEROP: &str = include_str!("../../include/bhr_interop.h");

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
    code = code.replace("\\\n", " ");
    code.lines().filter(|line| !line.trim_start().starts_with('#')).map(|line| format!("{line}\n")).collect()
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').filter(|word| !word.is_empty())
}

/// The functions that a header declares.
pub fn functions(text: &str) -> BTreeSet<String> {
    words(&code_of(text)).filter(|word| word.starts_with("bhr_")).map(str::to_owned).collect()
}

/// The constants that a header defines: not its macros.
pub fn constants(text: &str) -> BTreeSet<String> {
    text.lines()
        .filter_map(|line| line.strip_prefix("#define "))
        .filter_map(|definition| words(definition).next().filter(|name| !definition[name.len()..].starts_with('(')))
        .filter(|name| !["BHR_H", "BHR_NODISCARD", "BHR_INIT_MORE"].contains(name))
        .map(str::to_owned)
        .collect()
}

/// Structs with their fields in order.
pub fn structs(text: &str) -> Vec<(String, Vec<String>)> {
    let code = code_of(text);
    let mut found: Vec<_> = code
        .split("typedef struct ")
        .skip(1)
        .filter_map(|rest| {
            let (name, body) = rest.split_once('{')?;
            // An opaque type ends before any brace opens.
            (!name.contains(';')).then(|| (name.trim().to_owned(), fields(body.split_once('}').unwrap().0)))
        })
        .collect();
    found.sort();
    found
}

fn fields(body: &str) -> Vec<String> {
    let names = body.split(';').flat_map(|declaration| declaration.split(',')).map(|declarator| {
        let declarator = declarator.split('[').next().unwrap_or_default();
        declarator.rsplit([' ', '*', '\n']).next().unwrap_or_default().to_owned()
    });
    names.filter(|name| !name.is_empty()).collect()
}

/// A program that prints every constant's value and every struct's and field's place, size and type, as `header` has
/// them: those that `text` declares.
pub fn table(text: &str, header: &str) -> String {
    let mut program = format!(
        "#include <stdio.h>\n#include \"{header}\"\n\
         #define TYPE(x) _Generic((x), int32_t: \"int32\", uint32_t: \"uint32\", int64_t: \"int64\", \
         uint64_t: \"uint64\", double: \"double\", void *: \"void*\", double *: \"double[]\", char *: \"char[]\", \
         BhrLogFn: \"log\", const BhrWindow *: \"window\", BhrCrossing *: \"crossings\", \
         const BhrImage *: \"image\", BhrRay: \"ray\", default: \"?\")\n\
         int main(void) {{\n"
    );
    for name in constants(text) {
        writeln!(program, "printf(\"{name} %lld %zu\\n\", (long long)({name}), sizeof({name}));").unwrap();
    }
    for (name, fields) in structs(text) {
        writeln!(program, "printf(\"{name} %zu\\n\", sizeof({name}));").unwrap();
        for field in fields {
            let place = format!("((({name} *)0)->{field})");
            writeln!(
                program,
                "printf(\"{name}.{field} %zu %zu %s\\n\", offsetof({name}, {field}), sizeof{place}, TYPE{place});"
            )
            .unwrap();
        }
    }
    program + "return 0; }\n"
}

/// The typedefs and prototypes of a header without its structs.
pub fn prototypes(text: &str) -> String {
    let code = code_of(text).replace("extern \"C\" {", "");
    let (mut repeated, mut statement, mut depth) = (String::new(), String::new(), 0);
    for c in code.chars() {
        statement.push(c);
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ';' if depth == 0 => {
                if !statement.contains('{') {
                    repeated += &statement;
                }
                statement.clear();
            }
            _ => {}
        }
    }
    repeated
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

/// The library that cargo built for this test: beside the test itself, in `deps`.
pub fn library() -> PathBuf {
    let deps = std::env::current_exe().unwrap().parent().unwrap().to_owned();
    let name = format!("{}bhr{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    let path = deps.join(name);
    assert!(path.is_file(), "{} is not there: cargo builds it with crate-type cdylib", path.display());
    path
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

/// Compiles a C program and runs it with the library; its output.
pub fn output_of(name: &str, program: &str) -> String {
    let folder = scratch("bhr_json");
    let (source, binary) = (folder.join(name).with_extension("c"), folder.join(name));
    std::fs::write(&source, program).unwrap();
    let library = library();
    let mut command = compiler(false);
    command.args(["-std=c11", "-I"]).arg(root().join("include")).arg(&source).arg(&library);
    run(command.arg(format!("-Wl,-rpath,{}", library.parent().unwrap().display())).arg("-lm").arg("-o").arg(&binary));
    run(&mut Command::new(binary))
}
