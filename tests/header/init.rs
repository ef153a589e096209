// SPDX-License-Identifier: MIT OR Apache-2.0
//! BHR_INIT fills in every struct that grows, by the variable's type, in every dialect of C and C++.

use crate::c_header::{HEADER, INTEROP, code_of, compiler, library, root, run, scratch, structs};
use std::fmt::Write;
use std::process::Command;

/// The structs of a header whose first field is struct_size.
fn growing(header: &str) -> Vec<String> {
    let all = structs(header).into_iter();
    all.filter(|(_, fields)| fields.first().is_some_and(|field| field == "struct_size")).map(|(name, _)| name).collect()
}

/// The function that fills in a struct: bhr_frame_stats_init for BhrFrameStats.
fn function_of(name: &str) -> String {
    let snake = name.chars().fold(String::new(), |mut text, c| {
        if c.is_uppercase() && !text.is_empty() {
            text.push('_');
        }
        text.push(c.to_ascii_lowercase());
        text
    });
    format!("{snake}_init")
}

#[test]
fn every_struct_that_grows_has_its_function() {
    for (header, least) in [(HEADER, 17), (INTEROP, 6)] {
        let (names, code) = (growing(header), code_of(header));
        assert!(names.len() >= least, "{names:?}");
        for name in names {
            let start = format!(" {}({name} *", function_of(&name));
            assert!(code.contains(&start), "no {start}");
        }
    }
}

/// A program that ends with the number of the first struct that BHR_INIT has not filled in as the function does.
fn program(names: &[String], header: &str) -> String {
    let mut text = format!("#include \"{header}\"\n#include <string.h>\nint main(void) {{\n");
    for (number, name) in (1..).zip(names) {
        let init = function_of(name);
        writeln!(
            text,
            "    {{ {name} a[2], b, *third = a;\n    memset(a, 0xa5, sizeof a); memset(&b, 0x5a, sizeof b);\n    \
             BHR_INIT(a[1]); BHR_INIT(*third);\n    if ({init}(&b, sizeof b) != BHR_OK) return 100;\n    \
             if (memcmp(a, &b, sizeof b) != 0 || memcmp(a + 1, &b, sizeof b) != 0) return {number}; }}"
        )
        .unwrap();
    }
    text + "    return 0;\n}\n"
}

#[test]
fn a_variable_is_filled_in_by_one_line_in_every_dialect() {
    let folder = scratch("header_init");
    let library = library();
    let both = [growing(HEADER), growing(INTEROP)].concat();
    let warnings = ["-Wall", "-Wextra", "-Wpedantic", "-Wundef", "-Werror", "-O0", "-DBHR_WARN_UNUSED", "-I"];
    for (cpp, dialect) in
        [(false, "c99"), (false, "c11"), (false, "gnu17"), (true, "c++11"), (true, "c++17"), (true, "c++20")]
    {
        for (header, names) in [("bhr.h", growing(HEADER)), ("bhr_interop.h", both.clone())] {
            let source = folder.join(if cpp { "init.cpp" } else { "init.c" });
            let binary = folder.join("init");
            std::fs::write(&source, program(&names, header)).unwrap();
            let mut command = compiler(cpp);
            command.arg(format!("-std={dialect}")).args(warnings).arg(root().join("include")).arg(&source);
            command.arg(&library).arg(format!("-Wl,-rpath,{}", library.parent().unwrap().display()));
            run(command.arg("-o").arg(&binary));
            run(&mut Command::new(&binary));
        }
    }
}

/// A type that BHR_INIT does not know is refused by the compiler, and so is a pointer.
#[test]
fn other_variables_do_not_compile() {
    let folder = scratch("header_init_refused");
    for (cpp, dialect) in [(false, "c99"), (false, "c11"), (true, "c++11")] {
        let compiles = |declaration: &str| {
            let source = folder.join(if cpp { "refused.cpp" } else { "refused.c" });
            let text = format!("#include \"bhr.h\"\nvoid f(void);\nvoid f(void) {{ {declaration} BHR_INIT(v); }}\n");
            std::fs::write(&source, text).unwrap();
            let mut command = compiler(cpp);
            command.arg(format!("-std={dialect}")).args(["-fsyntax-only", "-I"]).arg(root().join("include"));
            command.arg(&source).output().unwrap().status.success()
        };
        assert!(compiles("BhrCamera v;"), "{dialect}");
        for declaration in ["BhrCamera c, *v = &c;", "int v;", "BhrRay v;"] {
            assert!(!compiles(declaration), "{dialect}: {declaration}");
        }
    }
}
