//! include/bhr.h keeps the contract that programs are written against (tests/contract.h): the same names,
//! constants, layouts and prototypes. What is compared is what a C compiler makes of the two.

mod c_header;

use c_header::{HEADER, code_of, compiler, constants, functions, root, run, scratch};
use std::fmt::Write;

const CONTRACT: &str = include_str!("contract.h");

#[test]
fn names_are_the_contracts() {
    assert_eq!(constants(HEADER), constants(CONTRACT));
    assert_eq!(functions(HEADER), functions(CONTRACT));
    assert_eq!(structs(HEADER), structs(CONTRACT));
}

/// Structs with their fields in order.
fn structs(text: &str) -> Vec<(String, Vec<String>)> {
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

/// A program that prints every constant's value and every field's place, size and type, as `header` has them.
fn table(header: &str) -> String {
    let mut program = format!(
        "#include <stdio.h>\n#include \"{header}\"\n\
         #define TYPE(x) _Generic((x), int32_t: \"int32\", uint32_t: \"uint32\", int64_t: \"int64\", \
         uint64_t: \"uint64\", double: \"double\", void *: \"void*\", double *: \"double[]\", char *: \"char[]\", \
         BhrLogFn: \"log\", const BhrWindow *: \"window\", BhrCrossing *: \"crossings\", default: \"?\")\n\
         int main(void) {{\n"
    );
    for name in constants(CONTRACT) {
        writeln!(program, "printf(\"{name} %lld %zu\\n\", (long long)({name}), sizeof({name}));").unwrap();
    }
    for (name, fields) in structs(CONTRACT) {
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

#[test]
fn constants_and_layouts_are_the_contracts() {
    let folder = scratch("contract_tables");
    let print = |name: &str, header: &str, include: &str| {
        let (source, binary) = (folder.join(name).with_extension("c"), folder.join(name));
        std::fs::write(&source, table(header)).unwrap();
        run(compiler(false).args(["-std=c11", "-I"]).arg(root().join(include)).arg(&source).arg("-o").arg(&binary));
        run(&mut std::process::Command::new(binary))
    };
    let (header, contract) = (print("header", "bhr.h", "include"), print("contract", "contract.h", "tests"));
    assert!(contract.lines().count() > 200 && !contract.contains('?'), "{contract}");
    for (ours, theirs) in header.lines().zip(contract.lines()) {
        assert_eq!(ours, theirs, "left: include/bhr.h, right: the contract");
    }
    assert_eq!(header, contract);
}

/// C11 lets a typedef or a prototype be repeated when it says the same, and only then.
#[test]
fn prototypes_and_typedefs_are_the_contracts() {
    let code = code_of(CONTRACT).replace("extern \"C\" {", "");
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
    assert_eq!(functions(&repeated), functions(CONTRACT));
    let source = scratch("contract_prototypes").join("repeat.c");
    std::fs::write(&source, format!("#include \"bhr.h\"\n{repeated}")).unwrap();
    run(compiler(false)
        .args(["-std=c11", "-Wall", "-Werror", "-fsyntax-only", "-I"])
        .arg(root().join("include"))
        .arg(&source));
}
