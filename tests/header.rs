//! include/bhr.h is the header that build.rs makes from the sources, and every dialect of C and C++ takes it
//! without a warning.

mod c_header;

use c_header::{HEADER, compiler, functions, root, run, scratch};

const GENERATED: &str = include_str!(concat!(env!("OUT_DIR"), "/bhr.h"));

/// With BHR_UPDATE_HEADER set, this is the command that brings include/bhr.h up to date.
#[test]
fn the_committed_header_is_the_generated_one() {
    let committed = root().join("include/bhr.h");
    if std::env::var_os("BHR_UPDATE_HEADER").is_some() {
        std::fs::write(&committed, GENERATED).unwrap();
    }
    let text = std::fs::read_to_string(&committed).unwrap_or_default();
    assert!(
        text == GENERATED,
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
