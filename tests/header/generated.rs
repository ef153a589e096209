//! include/bhr.h is the header that cbindgen makes from `src/capi`, one section per source file, and every dialect of C
//! and C++ takes it without a warning.

use crate::c_header::{HEADER, compiler, functions, root, run, scratch};
use std::path::Path;

/// The header's sections in order (a type stands before its first use): source file, title.
const SECTIONS: [(&str, &str); 21] = [
    ("version", "version"),
    ("status", "status, messages"),
    ("log", "log"),
    ("adapter", "adapters"),
    ("window", "windows of the host"),
    ("context", "context"),
    ("hole", "the black hole"),
    ("camera", "the camera: an observer with a lens"),
    ("disk", "accretion disk"),
    ("image", "images in the host's memory"),
    ("sky", "sky"),
    ("film", "film"),
    ("effects", "relativistic effects, time"),
    ("quality", "quality"),
    ("view", "what a pixel shows"),
    ("region", "parts of a larger frame"),
    ("render", "rendering into memory"),
    ("job", "rendering in the background"),
    ("surface", "rendering into windows"),
    ("rays", "rays: the same tracer, asked directly"),
    ("stats", "numbers about the last finished frame"),
];

/// Between the preface and the first section.
const OPENING: &str = r#"
#ifndef BHR_H
#define BHR_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif
"#;

/// After the last section.
const CLOSING: &str = "
#ifdef __cplusplus
}
#endif

#endif
";

/// With BHR_UPDATE_HEADER set, this is the command that brings include/bhr.h up to date.
#[test]
fn the_committed_header_is_the_generated_one() {
    let (committed, generated) = (root().join("include/bhr.h"), generate());
    if std::env::var_os("BHR_UPDATE_HEADER").is_some() {
        std::fs::write(&committed, &generated).unwrap();
    }
    let text = std::fs::read_to_string(&committed).unwrap_or_default();
    assert!(
        text == generated,
        "include/bhr.h is not what the sources say; bring it up to date with\n\
         BHR_UPDATE_HEADER=1 cargo test --test header committed"
    );
}

#[test]
fn every_dialect_takes_the_header() {
    let folder = scratch("header_dialects");
    let warnings = ["-Wall", "-Wextra", "-Wpedantic", "-Wundef", "-Werror", "-fsyntax-only"];
    let c_only = ["-Wstrict-prototypes", "-Wmissing-prototypes"];
    let cpp_only = ["-Wold-style-cast", "-Wzero-as-null-pointer-constant"];
    for (name, cpp, dialects, more) in
        [("use.c", false, ["c99", "c11", "c17"], c_only), ("use.cpp", true, ["c++11", "c++17", "c++20"], cpp_only)]
    {
        let source = folder.join(name);
        // Twice, for the guard; used, for the linkage.
        let include = "#include \"bhr.h\"\n";
        let text = format!("{include}{include}uint32_t used(void);\nuint32_t used(void) {{ return bhr_version(); }}\n");
        std::fs::write(&source, text).unwrap();
        for dialect in dialects {
            let mut command = compiler(cpp);
            command.arg(format!("-std={dialect}")).args(warnings).args(more).arg("-I").arg(root().join("include"));
            run(command.arg(&source));
        }
    }
}

/// A function is declared with C linkage in C++: an object that uses all of them asks for their plain names.
#[test]
fn cpp_programs_link_to_the_plain_names() {
    let folder = scratch("header_linkage");
    let names = functions(HEADER);
    let list = names.iter().map(|name| format!("    reinterpret_cast<void (*)()>({name}),\n")).collect::<String>();
    let source = folder.join("all.cpp");
    std::fs::write(
        &source,
        format!("#include \"bhr.h\"\nextern void (*const all[])();\nvoid (*const all[])() = {{\n{list}}};\n"),
    )
    .unwrap();
    let object = folder.join("all.o");
    run(compiler(true).arg("-I").arg(root().join("include")).arg("-c").arg(&source).arg("-o").arg(&object));
    let bytes = std::fs::read(&object).unwrap();
    let file = object::File::parse(bytes.as_slice()).unwrap();
    let wanted = object::Object::symbols(&file)
        .filter(object::ObjectSymbol::is_undefined)
        .filter_map(|symbol| object::ObjectSymbol::name(&symbol).ok().map(plain))
        .filter(|name| !name.is_empty() && !name.starts_with("_GLOBAL_"))
        .collect::<std::collections::BTreeSet<_>>();
    assert_eq!(wanted, names);
}

/// Mach-O puts an underscore before every C name.
fn plain(name: &str) -> String {
    if cfg!(target_vendor = "apple") { name.trim_start_matches('_').into() } else { name.into() }
}

// ---- making it ----

fn generate() -> String {
    let mut config = cbindgen::Config::from_file(root().join("cbindgen.toml")).unwrap();
    let preface = config.header.take().unwrap_or_default();
    let mut header = format!("{}\n{OPENING}", preface.trim());
    for (file, title) in SECTIONS {
        let path = root().join("src/capi").join(file).with_extension("rs");
        header += &format!("\n/* ---- {title} ---- */\n\n{}\n", section(&path, &config).trim());
    }
    header + CLOSING
}

/// What one source file adds. Types of other sections are named without being known, which is all that C needs.
fn section(path: &Path, config: &cbindgen::Config) -> String {
    let bindings = cbindgen::Builder::new().with_config(config.clone()).with_src(path).generate();
    let mut text = Vec::new();
    bindings.unwrap_or_else(|error| panic!("{}: {error}", path.display())).write(&mut text);
    tidy(&String::from_utf8(text).unwrap())
}

/// Comments of one line on one line, and structs by their typedef, which every struct has.
fn tidy(text: &str) -> String {
    let text = text.replace("typedef struct Bhr", "typedef-Bhr").replace("struct Bhr", "Bhr");
    let text = text.replace("typedef-Bhr", "typedef struct Bhr");
    let lines: Vec<&str> = text.lines().collect();
    let mut tidied = String::new();
    let mut rest = lines.as_slice();
    while let [first, after @ ..] = rest {
        rest = match after {
            [line, end, after @ ..] if first.trim() == "/**" && end.trim() == "*/" => {
                let comment = line.trim().trim_start_matches("* ");
                tidied += &format!("{}{comment} */\n", first.replace("/**", "/** "));
                after
            }
            _ => {
                tidied += &format!("{first}\n");
                after
            }
        };
    }
    tidied
}
