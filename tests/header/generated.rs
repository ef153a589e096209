// SPDX-License-Identifier: MIT OR Apache-2.0
//! include/bhr.h is the header that cbindgen makes from `src/capi`, one section per source file, and every dialect of C
//! and C++ takes it without a warning.

use crate::c_header::{HEADER, INTEROP, compiler, functions, library, root, run, scratch};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;

/// The header's sections in order (a type stands before its first use): source file, title.
const SECTIONS: [(&str, &str); 32] = [
    ("version", "version"),
    ("status", "status, messages"),
    ("log", "log"),
    ("adapter", "adapters"),
    ("window", "windows of the host"),
    ("context", "context"),
    ("hole", "the black hole"),
    ("chart", "charts"),
    ("camera", "the camera: an observer with a lens"),
    ("matrix", "cameras as matrices"),
    ("disk", "accretion disk"),
    ("volume", "matter with depth: volumes and hot spots"),
    ("image", "images in the host's memory"),
    ("sky", "sky"),
    ("film", "film"),
    ("effects", "relativistic effects, time"),
    ("preset", "presets: named looks"),
    ("quality", "quality"),
    ("view", "what a pixel shows"),
    ("region", "parts of a larger frame"),
    ("scene", "scenes as text"),
    ("render", "rendering into memory"),
    ("accumulation", "the mean of several frames"),
    ("job", "rendering in the background"),
    ("output", "outputs beside the picture"),
    ("occluder", "the host's things before the camera"),
    ("surface", "rendering into windows"),
    ("rays", "rays: the same tracer, asked directly"),
    ("project", "points on the screen"),
    ("transfer", "the matter with depth along rays"),
    ("body", "bodies in free fall"),
    ("stats", "numbers about the last finished frame"),
];

/// The sections of include/bhr_interop.h: the file of src/capi that each is made from, and its title.
const INTEROP_SECTIONS: [(&str, &str); 7] = [
    ("interop_info", "what can be shared"),
    ("interop_target", "targets"),
    ("interop_semaphore", "semaphores"),
    ("interop_render", "rendering into targets"),
    ("interop_occluder", "the host's things, from a target"),
    ("interop_sky", "the sky, from a target"),
    ("interop_vulkan", "the host's Vulkan device"),
];

/// Between the preface of include/bhr_interop.h and its first section.
const INTEROP_OPENING: &str = r#"
#ifndef BHR_INTEROP_H
#define BHR_INTEROP_H

#include "bhr.h"

#ifdef __cplusplus
extern "C" {
#endif
"#;

/// Between the preface and the first section.
const OPENING: &str = r#"
#ifndef BHR_H
#define BHR_H

#include <stddef.h>
#include <stdint.h>

/* A program that defines BHR_WARN_UNUSED before it includes this header is warned where it ignores a BhrStatus. It has
 * to ask, because programs whose warnings are errors must go on compiling. */
#if !defined(BHR_WARN_UNUSED)
#define BHR_NODISCARD
#elif defined(__cplusplus) && __cplusplus >= 201703L
#define BHR_NODISCARD [[nodiscard]]
#elif defined(__STDC_VERSION__) && __STDC_VERSION__ >= 202311L
#define BHR_NODISCARD [[nodiscard]]
#elif defined(__GNUC__)
#define BHR_NODISCARD __attribute__((warn_unused_result))
#else
#define BHR_NODISCARD
#endif

#ifdef __cplusplus
extern "C" {
#endif
"#;

/// After the last section of include/bhr.h: {} is a line for each struct with a function *_init.
const CLOSING: &str = r#"
#ifdef __cplusplus
}
#endif

/**
 * BHR_INIT(camera); is bhr_camera_init(&camera, sizeof camera); and likewise for a variable of every other struct that
 * begins with struct_size: the variable's type says which. It takes no pointer: write BHR_INIT(*camera). It gives no
 * status, because it cannot fail. A program that must run with an older library, which may lack the _init function,
 * sets such a struct up itself. For C++, C from C11 on, and GCC's and Clang's C99; elsewhere it is not defined.
 * @since 0.2.0
 */
#if defined(__cplusplus)
#define BHR_INIT(variable) BhrInit(variable)
#elif defined(__STDC_VERSION__) && __STDC_VERSION__ >= 201112L
#define BHR_INIT(variable) ((void)(BHR_INIT_BY_TYPE(variable) == BHR_OK))
#elif defined(__GNUC__)
#define BHR_INIT(variable) ((void)(__extension__ BHR_INIT_BY_TYPE(variable) == BHR_OK))
#endif

/** The structs that BHR_INIT knows, and their functions. */
#define BHR_INIT_STRUCTS(EACH) \
{}
/** The structs of bhr_interop.h, where that is included. */
#define BHR_INIT_MORE
/** The struct's case in BHR_INIT. */
#define BHR_INIT_CASE(Struct, init) , Struct : init
/** The function that the variable's type asks for, called. */
#define BHR_INIT_BY_TYPE(variable) \
    _Generic((variable)BHR_INIT_STRUCTS(BHR_INIT_CASE) BHR_INIT_MORE)(&(variable), sizeof(variable))
/** The struct's function in C++. */
#define BHR_INIT_FUNCTION(Struct, init) \
    inline void BhrInit(Struct &variable) { static_cast<void>(init(&variable, sizeof variable) == BHR_OK); }

#ifdef __cplusplus
BHR_INIT_STRUCTS(BHR_INIT_FUNCTION)
#endif

#endif
"#;

/// After the last section of include/bhr_interop.h.
const INTEROP_CLOSING: &str = r#"
#ifdef __cplusplus
}
#endif

/** The structs of this header that BHR_INIT knows, and their functions. */
#define BHR_INIT_INTEROP(EACH) \
{}
#ifdef __cplusplus
BHR_INIT_INTEROP(BHR_INIT_FUNCTION)
#else
#undef BHR_INIT_MORE
/** The structs of this header, which BHR_INIT knows as well. */
#define BHR_INIT_MORE BHR_INIT_INTEROP(BHR_INIT_CASE)
#endif

#endif
"#;

/// The longest line of the header.
const MAX_LINE: usize = 120;

/// With BHR_UPDATE_HEADER set, this is the command that brings include/bhr.h up to date.
#[test]
fn the_committed_header_is_the_generated_one() {
    is_up_to_date("include/bhr.h", &generate());
}

/// include/bhr_interop.h is up to date as well.
#[test]
fn the_committed_interop_header_is_the_generated_one() {
    is_up_to_date("include/bhr_interop.h", &generate_interop());
}

fn is_up_to_date(path: &str, generated: &str) {
    let committed = root().join(path);
    if std::env::var_os("BHR_UPDATE_HEADER").is_some() {
        std::fs::write(&committed, generated).unwrap();
    }
    let text = std::fs::read_to_string(&committed).unwrap_or_default();
    for (number, line) in (1..).zip(text.lines()) {
        assert!(line.chars().count() <= MAX_LINE, "{path}:{number} has more than {MAX_LINE} columns: {line}");
    }
    assert!(
        text == generated,
        "{path} is not what the sources say; bring it up to date with\n\
         BHR_UPDATE_HEADER=1 cargo test --profile checked --locked --test header committed"
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
        // Twice, for the guards; used, for the linkage.
        let include = "#include \"bhr_interop.h\"\n#include \"bhr.h\"\n";
        let text = format!("{include}{include}uint32_t used(void);\nuint32_t used(void) {{ return bhr_version(); }}\n");
        std::fs::write(&source, text).unwrap();
        for dialect in dialects {
            let mut command = compiler(cpp);
            command.arg(format!("-std={dialect}")).args(warnings).args(more).arg("-I").arg(root().join("include"));
            run(command.arg(&source));
        }
    }
}

/// BHR_WARN_UNUSED asks for a warning where a status is ignored, in C and in C++; nobody gets one unasked. (GCC finds
/// these when it makes code, not while it checks the syntax.)
#[test]
fn ignored_statuses_are_warned_of_on_request() {
    let source = scratch("header_unused").join("ignores.c");
    let ignores = "#include \"bhr.h\"\nvoid ignores(BhrContext *context);\n\
                   void ignores(BhrContext *context) { bhr_set_spin(context, 0.5); }\n";
    std::fs::write(&source, ignores).unwrap();
    for (cpp, language, dialect) in
        [(false, "c", "c99"), (false, "c", "c11"), (true, "c++", "c++11"), (true, "c++", "c++17")]
    {
        let compile = |asked: bool| {
            let mut command = compiler(cpp);
            command.args(["-x", language, &format!("-std={dialect}"), "-Wall", "-Wextra", "-Werror", "-S"]);
            command
                .args(asked.then_some("-DBHR_WARN_UNUSED"))
                .arg("-I")
                .arg(root().join("include"))
                .arg(&source)
                .args(["-o", "/dev/null"]);
            command.output().unwrap()
        };
        let (silent, warned) = (compile(false), compile(true));
        assert!(silent.status.success(), "{dialect}: {}", String::from_utf8_lossy(&silent.stderr));
        let said = String::from_utf8_lossy(&warned.stderr);
        assert!(!warned.status.success() && said.contains("unused-result"), "{dialect}: {said}");
    }
}

/// A function is declared with C linkage in C++: an object that uses all of them asks for their plain names.
#[test]
fn cpp_programs_link_to_the_plain_names() {
    let folder = scratch("header_linkage");
    let names = functions(HEADER).into_iter().chain(functions(INTEROP)).collect::<BTreeSet<_>>();
    let list = names.iter().map(|name| format!("    reinterpret_cast<void (*)()>({name}),\n")).collect::<String>();
    let source = folder.join("all.cpp");
    std::fs::write(
        &source,
        format!("#include \"bhr_interop.h\"\nextern void (*const all[])();\nvoid (*const all[])() = {{\n{list}}};\n"),
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

/// The program in the preface is the first one that a host developer copies.
#[test]
fn the_example_in_the_preface_compiles_links_and_runs() {
    let header = generate();
    let (_, example) = header.split_once("\n * Example\n").expect("the preface has an example");
    let (example, _) = example.split_once("\n *\n * Units\n").expect("Units follow the example");
    let program: String = example.lines().map(|line| format!("{}\n", line.trim_start_matches(" *"))).collect();
    let folder = scratch("header_example");
    let (source, binary) = (folder.join("example.c"), folder.join("example"));
    std::fs::write(&source, program).unwrap();
    let library = library();
    let mut command = compiler(false);
    command.args(["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-I"]).arg(root().join("include"));
    command.arg(&source).arg(&library).arg(format!("-Wl,-rpath,{}", library.parent().unwrap().display()));
    run(command.arg("-o").arg(&binary));
    let picture = folder.join("hole.png");
    let _ = std::fs::remove_file(&picture);
    run(Command::new(&binary).current_dir(&folder));
    assert!(std::fs::read(&picture).unwrap().starts_with(b"\x89PNG"));
}

/// Mach-O puts an underscore before every C name.
fn plain(name: &str) -> String {
    if cfg!(target_vendor = "apple") { name.trim_start_matches('_').into() } else { name.into() }
}

// ---- making it ----

pub fn generate() -> String {
    let mut config = config("cbindgen.toml");
    let preface = config.header.take().unwrap_or_default();
    let (begin, rest) = preface.trim().split_once("\n *\n * Example\n").expect("the preface has an example");
    let preface = format!("{begin}\n{}\n *\n * Example\n{rest}", contents());
    with_sections(format!("{preface}\n{OPENING}"), &SECTIONS, &config, CLOSING)
}

pub fn generate_interop() -> String {
    let preface = config("cbindgen-interop.toml").header.unwrap_or_default();
    let config = cbindgen::Config { header: None, ..config("cbindgen.toml") };
    with_sections(format!("{}\n{INTEROP_OPENING}", preface.trim()), &INTEROP_SECTIONS, &config, INTEROP_CLOSING)
}

fn config(file: &str) -> cbindgen::Config {
    cbindgen::Config::from_file(root().join(file)).unwrap()
}

/// The titles of all sections, as lines of the preface.
fn contents() -> String {
    let mut lines =
        vec![" *".to_string(), " * Sections, in this order, each after a line \"---- title ----\"".to_string()];
    for (i, (_, title)) in SECTIONS.iter().enumerate() {
        let end = if i + 1 < SECTIONS.len() { ";" } else { "." };
        let word = format!(" {title}{end}");
        match lines.last_mut().filter(|line| i > 0 && line.len() + word.len() <= MAX_LINE) {
            Some(line) => line.push_str(&word),
            None => lines.push(format!(" *  {word}")),
        }
    }
    lines.join("\n")
}

fn with_sections(mut header: String, sections: &[(&str, &str)], config: &cbindgen::Config, closing: &str) -> String {
    for (file, title) in sections {
        let path = root().join("src/capi").join(file).with_extension("rs");
        header += &format!("\n/* ---- {title} ---- */\n\n{}\n", section(&path, config));
    }
    let structs = structs_with_init(&header);
    header + &closing.replacen("{}", &structs, 1)
}

/// The entries of BHR_INIT_STRUCTS: each struct that a function bhr_*_init(*, size_t) of the header fills.
fn structs_with_init(header: &str) -> String {
    let entries = header.split("BhrStatus bhr_").skip(1).filter_map(|function| {
        let (name, parameters) = function.split_once(");")?.0.split_once("_init(")?;
        let (of, _) = parameters.strip_suffix(", size_t struct_size")?.split_once(" *")?;
        (!name.contains('(')).then(|| format!("    EACH({of}, bhr_{name}_init)"))
    });
    entries.collect::<Vec<_>>().join(" \\\n")
}

/// The declarations of one source file, in that file's order. Types of other sections are named without being known,
/// which is all that C needs.
fn section(path: &Path, config: &cbindgen::Config) -> String {
    let bindings = cbindgen::Builder::new().with_config(config.clone()).with_src(path).generate();
    let mut text = Vec::new();
    bindings.unwrap_or_else(|error| panic!("{}: {error}", path.display())).write(&mut text);
    let text = with_nodiscard(&tidy(&String::from_utf8(text).unwrap()));
    let mut blocks: Vec<&str> = text.trim().split("\n\n").map(str::trim).filter(|block| !block.is_empty()).collect();
    // cbindgen puts constants after the types; in the sources each one stands where a reader wants it.
    let order = public_items(&std::fs::read_to_string(path).unwrap());
    blocks.sort_by_key(|block| {
        let name = declared(block);
        let place = order.iter().position(|item| item == name);
        place.unwrap_or_else(|| panic!("{}: no public item declares {name:?}:\n{block}", path.display()))
    });
    in_tables(&blocks)
}

/// The Rust types of all constants, which a #define does not have.
pub fn types_of_constants() -> BTreeMap<String, String> {
    let mut types = BTreeMap::new();
    for (file, _) in SECTIONS {
        let source = std::fs::read_to_string(root().join("src/capi").join(file).with_extension("rs")).unwrap();
        let constants = source.lines().filter_map(|line| line.strip_prefix("pub const BHR_")?.split_once(" = "));
        types.extend(constants.filter_map(|(constant, _)| {
            let (name, kind) = constant.split_once(": ")?;
            let kind = match kind {
                "u32" => "uint32_t",
                "usize" => "size_t",
                kind => kind,
            };
            Some((format!("BHR_{name}"), kind.to_owned()))
        }));
    }
    types
}

/// The names of a source file's public items, in order.
fn public_items(source: &str) -> Vec<String> {
    let kinds = ["pub const ", "pub type ", "pub struct ", "pub unsafe extern \"C\" fn ", "pub extern \"C\" fn "];
    let names = source.lines().filter_map(|line| kinds.iter().find_map(|kind| line.strip_prefix(kind)));
    names.map(|rest| rest.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap().to_owned()).collect()
}

/// The name that a declaration with its comment introduces.
fn declared(block: &str) -> &str {
    let code = if block.starts_with("/**") { block.split_once("*/\n").unwrap().1 } else { block };
    let is_name = |c: char| c.is_alphanumeric() || c == '_';
    let first = |text: &'_ str| text.find(|c| !is_name(c)).unwrap_or(text.len());
    let after = |start: &str| code.find(start).map(|at| &code[at + start.len()..]).map(|text| &text[..first(text)]);
    let opaque_or_struct = || after("typedef struct ");
    let alias = || code.strip_prefix("typedef ")?.strip_suffix(';')?.rsplit(' ').next();
    let function = || code[..code.find('(')?].rsplit([' ', '*']).next();
    after("#define ").or_else(opaque_or_struct).or_else(|| after("(*")).or_else(alias).or_else(function).unwrap()
}

/// The blocks of a section, one blank line between them. Constants that follow each other and whose comments fit beside
/// them make a table; so do the fields of a struct with short comments.
fn in_tables(blocks: &[&str]) -> String {
    let (mut written, mut rest) = (Vec::new(), blocks);
    while let [block, after @ ..] = rest {
        let tables = (1..=rest.len()).map_while(|rows| Some((table(&rest[..rows])?, rows)));
        let (text, rows) = tables.last().unwrap_or_else(|| (with_fields_in_lines(block), rest.len() - after.len()));
        written.push(text);
        rest = &rest[rows..];
    }
    written.join("\n\n")
}

/// `text` with the comment of each struct's field beside it where it fits on the line.
fn with_fields_in_lines(text: &str) -> String {
    let lines: Vec<&str> = text.lines().collect();
    let field = |pair: &[&str]| {
        let comment = pair[0].strip_prefix("    /** ")?.strip_suffix(" */")?;
        Some((pair[1].to_owned(), format!("/**< {comment} */"))).filter(|_| pair[1].ends_with(';'))
    };
    let fits = |(code, comment): &(String, String)| code.len() + 1 + comment.len() <= MAX_LINE;
    let mut written = Vec::new();
    let mut rest = lines.as_slice();
    while let [line, after @ ..] = rest {
        let run: Vec<_> = rest.chunks_exact(2).map_while(|pair| field(pair).filter(fits)).collect();
        let width = run.iter().map(|(code, _)| code.len()).max().unwrap_or(0);
        let aligned = run.iter().all(|(_, comment)| width + 1 + comment.len() <= MAX_LINE);
        let width = if aligned { width } else { 0 };
        written.extend(run.iter().map(|(code, comment)| format!("{code:<width$} {comment}")));
        rest = if run.is_empty() { after } else { &rest[2 * run.len()..] };
        if run.is_empty() {
            written.push((*line).to_owned());
        }
    }
    written.join("\n")
}

/// Constants with short comments, one per line; `None` when `group` is something else.
fn table(group: &[&str]) -> Option<String> {
    let rows = group.iter().map(|block| block.strip_prefix("/** ")?.split_once(" */\n#define "));
    let rows = rows.collect::<Option<Vec<_>>>()?;
    let width = rows.iter().map(|(_, code)| code.len()).max()?;
    let line = |(comment, code): &(&str, &str)| format!("#define {code:<width$} /**< {comment} */");
    let lines: Vec<_> = rows.iter().map(line).collect();
    lines.iter().all(|line| line.len() <= MAX_LINE && !line.contains('\n')).then(|| lines.join("\n"))
}

/// BHR_NODISCARD before each function that returns a status; its parameters on as many lines as they need.
fn with_nodiscard(text: &str) -> String {
    let mut parts = text.split("\nBhrStatus bhr_");
    let mut marked = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (prototype, rest) = part.split_once(");").expect("a prototype ends");
        let line = prototype.split_whitespace().collect::<Vec<_>>().join(" ");
        marked += &format!("\n{}{rest}", filled(&format!("BHR_NODISCARD BhrStatus bhr_{line});")));
    }
    marked
}

/// A prototype with its parameters below each other's beginning, as many on a line as it holds.
fn filled(prototype: &str) -> String {
    let margin = " ".repeat(prototype.find('(').unwrap() + 1);
    let mut lines = vec![String::new()];
    for parameter in prototype.split_inclusive(", ") {
        let room = MAX_LINE - parameter.trim_end().len();
        match lines.last_mut().filter(|line| line.len() <= room) {
            Some(line) => line.push_str(parameter),
            None => lines.push(format!("{margin}{parameter}")),
        }
    }
    lines.iter().map(|line| line.trim_end()).collect::<Vec<_>>().join("\n")
}

/// Comments without lines of their own for begin and end, and structs by their typedef, which every struct has.
fn tidy(text: &str) -> String {
    let text = text.replace("typedef struct Bhr", "typedef-Bhr").replace("struct Bhr", "Bhr");
    let text = text.replace("typedef-Bhr", "typedef struct Bhr").replace("\n *\n */", "\n */");
    let lines: Vec<&str> = text.lines().collect();
    let mut tidied = String::new();
    let mut rest = lines.as_slice();
    while let [first, after @ ..] = rest {
        let end = after.iter().position(|line| line.trim() == "*/").filter(|_| first.trim() == "/**");
        let (body, code) = end.map_or((&[] as &[&str], after), |end| (&after[..end], &after[end + 1..]));
        if let [begin, more @ ..] = body {
            let begun = first.replace("/**", "/** ") + begin.trim().trim_start_matches("* ");
            let lines: Vec<_> = std::iter::once(begun.as_str()).chain(more.iter().copied()).collect();
            let fits = lines.last().is_some_and(|line| line.len() + " */".len() <= MAX_LINE);
            let margin = if fits { String::new() } else { format!("\n{}", first.replace("/**", "")) };
            tidied += &format!("{}{margin} */\n", lines.join("\n"));
            rest = code;
        } else {
            tidied += &format!("{first}\n");
            rest = after;
        }
    }
    tidied
}
