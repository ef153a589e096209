// SPDX-License-Identifier: MIT OR Apache-2.0
//! include/bhr.h keeps the contract that programs are written against (tests/contract.h): the same names,
//! constants, layouts and prototypes. What is compared is what a C compiler makes of the two.

use crate::c_header::{HEADER, compiler, constants, functions, prototypes, root, run, scratch, structs, table};

const CONTRACT: &str = include_str!("../contract.h");

#[test]
fn names_are_the_contracts() {
    assert_eq!(constants(HEADER), constants(CONTRACT));
    assert_eq!(functions(HEADER), functions(CONTRACT));
    assert_eq!(structs(HEADER), structs(CONTRACT));
}

#[test]
fn constants_and_layouts_are_the_contracts() {
    let folder = scratch("contract_tables");
    let print = |name: &str, header: &str, include: &str| {
        let (source, binary) = (folder.join(name).with_extension("c"), folder.join(name));
        std::fs::write(&source, table(CONTRACT, header)).unwrap();
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
    let repeated = prototypes(CONTRACT);
    assert_eq!(functions(&repeated), functions(CONTRACT));
    let source = scratch("contract_prototypes").join("repeat.c");
    std::fs::write(&source, format!("#include \"bhr.h\"\n{repeated}")).unwrap();
    run(compiler(false)
        .args(["-std=c11", "-Wall", "-Werror", "-fsyntax-only", "-I"])
        .arg(root().join("include"))
        .arg(&source));
}
