// SPDX-License-Identifier: MIT OR Apache-2.0
//! The binary interface of each release holds. abidiff (libabigail) compares today's header, without what says that it
//! came later, with the baseline of the release, tests/abi/bhr-X.Y.Z.abi; the two must be alike to the last field.
//! Headers that are broken on purpose show that each kind of break is found. And programs that were compiled and linked
//! at a release run with the library of the day, under the names that they ask the system for. docs/abi.md has the
//! rules.
//!
//! When a version is released its header comes there as bhr-X.Y.Z.h, and BHR_NEW_BASELINE=1 makes the baseline.

#![cfg(target_os = "linux")]

#[path = "header/c_header.rs"]
mod c_header;
#[path = "header/model.rs"]
mod model;

use c_header::{HEADER, compiler, functions, library, root, run, scratch};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_else(|| panic!("{value} is no text"))
}

fn version(text: &str) -> Vec<u32> {
    text.split('.').map(|part| part.parse().unwrap()).collect()
}

/// The releases whose headers are kept here.
fn releases() -> Vec<String> {
    let names = std::fs::read_dir(root().join("tests/abi")).unwrap();
    let names = names.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut found: Vec<String> =
        names.filter_map(|name| Some(name.strip_prefix("bhr-")?.strip_suffix(".h")?.to_owned())).collect();
    found.sort_by_key(|release| version(release));
    assert!(!found.is_empty());
    found
}

fn file(kind: &str, release: &str, ending: &str) -> PathBuf {
    root().join(format!("tests/abi/{kind}-{release}.{ending}"))
}

/// Structs without struct_size, whose size is told to no call or not to all; BhrHit's is (bhr_trace_rays).
const OF_ONE_SIZE: [&str; 2] = ["BhrRay", "BhrCrossing"];

/// A C file with all types of `header` and a pointer to each function, without what came after `release`. From it the
/// compiler makes the types of the interface, which abidw then finds; the library has Rust's only. Fails where a struct
/// grew that must not, or not at its end.
fn probe(header: &str, release: &str) -> Result<String, String> {
    let constants = c_header::constants(header).into_iter().map(|name| (name, "int32_t".to_owned())).collect();
    let json = model::of_header(header, &constants, &BTreeMap::new());
    let is_there = |entry: &&Value| version(text(&entry["since"])) <= version(release);
    let entries: Vec<&Value> = ["enumerations", "opaque_types", "callbacks", "structs", "functions"]
        .iter()
        .flat_map(|list| json[*list].as_array().unwrap())
        .collect();
    let mut program = String::from("#include <stddef.h>\n#include <stdint.h>\n");
    for declaration in json["declarations"].as_array().unwrap() {
        let entry = entries.iter().find(|entry| entry["declaration"] == *declaration).unwrap();
        if !is_there(entry) {
            continue;
        }
        if let Some(fields) = entry["fields"].as_array() {
            let name = text(&entry["name"]);
            let kept = fields.iter().take_while(is_there).count();
            if fields[kept..].iter().any(|field| is_there(&field)) {
                return Err(format!("{name} has a new field that is not at its end"));
            }
            if kept < fields.len() && OF_ONE_SIZE.contains(&name) {
                return Err(format!("{name} has grown"));
            }
            writeln!(program, "typedef struct {name} {{").unwrap();
            for field in &fields[..kept] {
                let array = field["array"].as_u64().map_or(String::new(), |length| format!("[{length}]"));
                writeln!(program, "    {} {}{array};", text(&field["type"]), text(&field["name"])).unwrap();
            }
            writeln!(program, "}} {name};").unwrap();
        } else {
            writeln!(program, "{}", text(declaration)).unwrap();
        }
    }
    for function in json["functions"].as_array().unwrap().iter().filter(is_there) {
        let name = text(&function["name"]);
        writeln!(program, "__typeof__(&{name}) probe_{name} = &{name};").unwrap();
    }
    Ok(program)
}

/// Compiles a probe into `folder`, with debugging information.
fn compiled(folder: &Path, probe: &str) -> PathBuf {
    std::fs::write(folder.join("probe.c"), probe).unwrap();
    // By its name alone: the debugging information, and a baseline with it, has the path that the compiler is told.
    let options = ["-std=gnu11", "-g", "-fPIC", "-shared", "probe.c", "-o", "probe.so"];
    run(compiler(false).current_dir(folder).args(options));
    folder.join("probe.so")
}

fn libabigail(program: &str) -> Command {
    let found = Command::new(program).arg("--version").output();
    assert!(found.is_ok(), "{program} is missing (Debian package abigail-tools)");
    let mut command = Command::new(program);
    command.arg("--no-architecture");
    command
}

/// The differences of a header from a release; "" for none.
fn difference(name: &str, release: &str, header: &str) -> String {
    let object = match probe(header, release) {
        Ok(probe) => compiled(&scratch(&format!("abidiff_{name}")), &probe),
        Err(said) => return said,
    };
    let mut command = libabigail("abidiff");
    let found = command.arg("--harmless").arg(file("bhr", release, "abi")).arg(object).output().unwrap();
    let said = format!("{}{}", String::from_utf8_lossy(&found.stdout), String::from_utf8_lossy(&found.stderr));
    // 0: alike; 4: there are changes, 8: harmful ones; 1 and 2: abidiff itself failed.
    let status = found.status.code().unwrap();
    assert_eq!(status & 3, 0, "{said}");
    if status == 0 { String::new() } else { said }
}

#[test]
fn the_interface_of_each_release_is_kept() {
    for release in releases() {
        let baseline = file("bhr", &release, "abi");
        if std::env::var_os("BHR_NEW_BASELINE").is_some() && !baseline.exists() {
            let released = std::fs::read_to_string(file("bhr", &release, "h")).unwrap();
            let object = compiled(&scratch("abidiff_baseline"), &probe(&released, &release).unwrap());
            let mut command = libabigail("abidw");
            command.args(["--no-corpus-path", "--no-comp-dir-path", "--no-show-locs"]).arg(object);
            std::fs::write(&baseline, run(&mut command)).unwrap();
        }
        let said = difference("today", &release, HEADER);
        assert!(said.is_empty(), "left: {release}, right: today\n{said}");
    }
}

/// A change of the header: its name, text that is replaced, what by, and a word of what is then said; "" where the
/// interface of the release stays as it is.
type Change = [&'static str; 4];

const CHANGES: [Change; 17] = [
    ["a new function", "\n#define BHR_OK ", "\n/** @since 9.0.0 */\nvoid bhr_new(void);\n\n#define BHR_OK ", ""],
    ["a new field at the end", "\n} BhrQuality;", "\n    double more; /**< @since 9.0.0 */\n} BhrQuality;", ""],
    ["the same without since when", "\n} BhrQuality;", "\n    double more;\n} BhrQuality;", "BhrQuality"],
    [
        "a new field before others",
        "    uint32_t x; ",
        "    double u; /**< @since 9.0.0 */\n    uint32_t x; ",
        "its end",
    ],
    ["the same without since when", "    uint32_t x; ", "    double u;\n    uint32_t x; ", "BhrRegion"],
    ["a longer BhrRay", "\n} BhrRay;", "\n    double more; /**< @since 9.0.0 */\n} BhrRay;", "BhrRay has grown"],
    ["a longer BhrHit", "\n} BhrHit;", "\n    double more; /**< @since 9.0.0 */\n} BhrHit;", ""],
    ["no field any more", "    double opacity; ", "", "BhrDisk"],
    ["a field by another name", "double opacity; ", "double density; ", "opacity"],
    ["a wider field", "    uint32_t x; ", "    uint64_t x; ", "BhrRegion"],
    ["no function any more", "const char *bhr_version_string(void);", "typedef int32_t BhrGone;", "bhr_version_string"],
    ["a function by another name", "Status bhr_set_spin(", "Status bhr_set_rotation(", "bhr_set_spin"],
    ["another parameter", "double spin);", "int32_t spin);", "bhr_set_spin"],
    ["one parameter more", "double spin);", "double spin, double rate);", "bhr_set_spin"],
    ["another result", "uint32_t bhr_version(", "uint64_t bhr_version(", "bhr_version"],
    ["another callback", "typedef int32_t (*BhrProgressFn)", "typedef int64_t (*BhrProgressFn)", "bhr_set_progress"],
    ["a wider enumeration", "typedef int32_t BhrView;", "typedef int64_t BhrView;", "bhr_set_view"],
];

#[test]
fn breaks_are_found_and_additions_are_none() {
    let release = &releases()[0];
    for (number, [name, what, by, word]) in CHANGES.into_iter().enumerate() {
        let header = HEADER.replacen(what, by, 1);
        assert_ne!(header, HEADER, "{name}: the header has no {what:?}");
        let said = difference(&format!("change_{number}"), release, &header);
        assert!(if word.is_empty() { said.is_empty() } else { said.contains(word) }, "{name}: {said}");
    }
}

/// A program of a release, linked with a library that has the functions of the release alone, as a linker saw them
/// then, runs with the library of the day under the name that it was linked with.
#[test]
fn programs_of_each_release_run_with_the_library_of_the_day() {
    for release in releases() {
        let header = std::fs::read_to_string(file("bhr", &release, "h")).unwrap();
        let stubs: String = functions(&header).iter().map(|name| format!("void {name}(void) {{}}\n")).collect();
        for name in ["libbhr.so", "libbhr.so.0"] {
            let folder = scratch(&format!("abi_{release}_{name}"));
            let (then, now, files) = (folder.join("then"), folder.join("now"), folder.join("files"));
            for folder in [&then, &now, &files] {
                std::fs::create_dir_all(folder).unwrap();
            }
            std::fs::write(then.join("bhr.c"), &stubs).unwrap();
            let stub = then.join("libbhr.so");
            let soname = format!("-Wl,-soname,{name}");
            run(compiler(false).args(["-shared", "-fPIC", &soname]).arg(then.join("bhr.c")).arg("-o").arg(&stub));
            let host = folder.join("host");
            let mut command = compiler(false);
            command.args(["-std=c99", "-Wall", "-Werror"]).arg(file("host", &release, "c")).arg("-o").arg(&host);
            run(command.arg("-L").arg(&then).args(["-lbhr", "-lm"]));
            assert_eq!(needed(&host, "libbhr"), [name]);
            let _ = std::fs::remove_file(now.join(name));
            std::os::unix::fs::symlink(library(), now.join(name)).unwrap();
            let said = run(Command::new(&host).arg(&files).env("LD_LIBRARY_PATH", &now).env_remove("DISPLAY"));
            assert_eq!(said.trim(), "0 failed");
        }
    }
}

/// The names of libraries, those that hold `word`, that a program asks the system for.
fn needed(program: &Path, word: &str) -> Vec<String> {
    use object::elf::{DT_NEEDED, DT_STRTAB, FileHeader64};
    use object::read::elf::{Dyn, FileHeader, ProgramHeader};

    let bytes = std::fs::read(program).unwrap();
    let header = FileHeader64::<object::Endianness>::parse(bytes.as_slice()).unwrap();
    let endian = header.endian().unwrap();
    let segments = header.program_headers(endian, bytes.as_slice()).unwrap();
    let dynamic: Vec<_> =
        segments.iter().filter_map(|segment| segment.dynamic(endian, bytes.as_slice()).unwrap()).flatten().collect();
    let strings = dynamic.iter().find(|entry| entry.d_tag(endian) == DT_STRTAB).unwrap().d_val(endian);
    let at = |address: u64| {
        let bytes = segments.iter().find_map(|s| s.data_range(endian, bytes.as_slice(), address, 256).ok().flatten());
        let text: Vec<u8> = bytes.unwrap().iter().copied().take_while(|byte| *byte != 0).collect();
        String::from_utf8(text).unwrap()
    };
    let names = dynamic.iter().filter(|entry| entry.d_tag(endian) == DT_NEEDED);
    names.map(|entry| at(strings + entry.d_val(endian))).filter(|name| name.contains(word)).collect()
}
