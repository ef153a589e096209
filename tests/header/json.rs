// SPDX-License-Identifier: MIT OR Apache-2.0
//! include/bhr.json is the header for machines: made with it, and it says what a C compiler says. docs/bhr-json.md
//! describes it.

use crate::c_header::{HEADER, compiler, constants, functions, output_of, root, run, scratch, structs, table};
use crate::generated::{generate, types_of_constants};
use crate::model::of_header;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

pub fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_else(|| panic!("{value} is no text"))
}

pub fn entries<'a>(json: &'a Value, list: &str) -> &'a [Value] {
    json[list].as_array().unwrap_or_else(|| panic!("bhr.json has no list {list}"))
}

fn names(entries: &[Value]) -> Vec<&str> {
    entries.iter().map(|entry| text(&entry["name"])).collect()
}

pub fn committed() -> Value {
    serde_json::from_str(&std::fs::read_to_string(root().join("include/bhr.json")).unwrap()).unwrap()
}

/// Structs that calls fill, and those that the host has to: their *_init functions clear them, and give no defaults.
const CLEARED: [&str; 7] =
    ["BhrAdapterInfo", "BhrBody", "BhrFrameStats", "BhrHoleInfo", "BhrProjectedPoint", "BhrRegion", "BhrWindow"];

/// The values that the *_init functions fill in, by "Struct.field": the library's own word for the defaults. Adding 0
/// turns -0 into 0.
fn defaults(json: &Value) -> BTreeMap<String, Value> {
    let mut program = String::from(
        "#include <stdio.h>\n#include \"bhr.h\"\n\
         #define I(x) printf(\"%lld\", (long long)(x))\n#define D(x) printf(\"%.17g\", (x) + 0.0)\nint main(void) {\n",
    );
    for function in entries(json, "functions").iter().filter(|function| text(&function["name"]).ends_with("_init")) {
        let name = text(&function["parameters"][0]["base"]);
        if CLEARED.contains(&name) {
            continue;
        }
        let object = entries(json, "structs").iter().find(|object| object["name"] == name).unwrap();
        writeln!(program, "{{ {name} s; if ({}(&s, sizeof s) < 0) return 1;", text(&function["name"])).unwrap();
        for field in object["fields"].as_array().unwrap() {
            let member = text(&field["name"]);
            if member == "struct_size" || member == "reserved" {
                continue;
            }
            let print = if field["base"] == "double" { "D" } else { "I" };
            let is_pointer = field["pointers"] != 0 || text(&field["base"]).ends_with("Fn");
            write!(program, "printf(\"{name}.{member} \");").unwrap();
            match field["array"].as_u64() {
                _ if is_pointer => write!(program, "if (s.{member}) return 2; printf(\"null\");"),
                Some(length) => (0..length).try_for_each(|i| {
                    let before = if i == 0 { "[" } else { "," };
                    write!(program, "printf(\"{before}\"); {print}(s.{member}[{i}]);")
                }),
                None => write!(program, "{print}(s.{member});"),
            }
            .unwrap();
            program += if field["array"].is_null() { "puts(\"\");\n" } else { "puts(\"]\");\n" };
        }
        program += "}\n";
    }
    let said = output_of("defaults", &(program + "return 0; }\n"));
    let line = |line: &str| {
        let (place, value) = line.split_once(' ').unwrap();
        (place.to_owned(), serde_json::from_str(value).unwrap())
    };
    said.lines().map(line).collect()
}

/// With BHR_UPDATE_HEADER set, this brings include/bhr.json up to date, with the header (tests/header/generated.rs).
#[test]
fn the_committed_json_is_the_generated_one() {
    let (header, types, path) = (generate(), types_of_constants(), root().join("include/bhr.json"));
    let defaults = defaults(&of_header(&header, &types, &BTreeMap::new()));
    let generated = written(&of_header(&header, &types, &defaults), 0) + "\n";
    if std::env::var_os("BHR_UPDATE_HEADER").is_some() {
        std::fs::write(&path, &generated).unwrap();
    }
    assert!(
        std::fs::read_to_string(&path).unwrap_or_default() == generated,
        "include/bhr.json is not what the sources say; bring it up to date with\n\
         BHR_UPDATE_HEADER=1 cargo test --profile checked --locked --test header committed"
    );
}

#[test]
fn it_has_what_the_header_has_and_nothing_more() {
    let json = committed();
    let set = |list: &str| names(entries(&json, list)).into_iter().map(str::to_owned).collect::<BTreeSet<_>>();
    assert_eq!(set("constants"), constants(HEADER));
    assert_eq!(set("functions"), functions(HEADER));
    let mut found: Vec<_> = entries(&json, "structs")
        .iter()
        .map(|object| {
            let fields = names(object["fields"].as_array().unwrap()).into_iter().map(str::to_owned).collect();
            (text(&object["name"]).to_owned(), fields)
        })
        .collect();
    found.sort();
    assert_eq!(found, structs(HEADER));
    let types = ["structs", "opaque_types", "enumerations", "callbacks"].map(set);
    let listed: usize = types.iter().map(BTreeSet::len).sum();
    assert_eq!(listed, HEADER.matches("\ntypedef ").count(), "{types:?}");
    for entry in ["constants", "functions", "structs", "opaque_types", "enumerations", "callbacks"]
        .iter()
        .flat_map(|list| entries(&json, list))
    {
        assert!(!text(&entry["documentation"]).is_empty(), "{} has no documentation", entry["name"]);
    }
}

/// Values, places and sizes are those that a compiler finds.
#[test]
fn a_c_compiler_agrees_with_it() {
    let json = committed();
    let mut said = String::new();
    for line in output_of("places", &table(HEADER, "bhr.h")).lines() {
        let mut words: Vec<_> = line.split(' ').collect();
        // A constant's line ends with its size, a field's with the name of its type.
        if words.len() == 4 || words[0].starts_with("BHR_") {
            words.pop();
        }
        writeln!(said, "{}", words.join(" ")).unwrap();
    }
    let mut expected = BTreeSet::new();
    for constant in entries(&json, "constants") {
        expected.insert(format!("{} {}", text(&constant["name"]), constant["value"]));
    }
    for object in entries(&json, "structs") {
        let name = text(&object["name"]);
        expected.insert(format!("{name} {}", object["size"]));
        for field in object["fields"].as_array().unwrap() {
            expected.insert(format!("{name}.{} {} {}", text(&field["name"]), field["offset"], field["size"]));
        }
    }
    assert!(expected.len() > 180);
    assert_eq!(said.lines().map(str::to_owned).collect::<BTreeSet<_>>(), expected, "left: the compiler");
}

/// A value goes in, whatever its name: bindings would make an address of it.
#[test]
fn what_comes_out_has_an_address() {
    let json = committed();
    for function in entries(&json, "functions").iter().chain(entries(&json, "callbacks")) {
        for parameter in function["parameters"].as_array().unwrap() {
            let address = parameter["pointers"].as_u64().unwrap() > 0 || !parameter["array"].is_null();
            assert!(address || parameter["direction"] == "in", "{}: {parameter}", function["name"]);
        }
    }
}

/// The types that it names, in C behind the real header: C11 lets a prototype or a typedef be repeated only when it
/// says the same. A field's type is compared through a pointer to the field.
#[test]
fn its_types_are_the_headers() {
    let json = committed();
    let mut program = String::from("#include \"bhr.h\"\n");
    let spelled = |parameter: &Value| match parameter["array"].as_u64() {
        // Compilers warn where one declaration has a pointer and the other an array.
        Some(length) => format!("{}[{length}]", text(&parameter["type"]).strip_suffix(" *").unwrap()),
        None => text(&parameter["type"]).to_owned(),
    };
    let parameters = |entry: &Value| {
        let types: Vec<_> = entry["parameters"].as_array().unwrap().iter().map(spelled).collect();
        if types.is_empty() { "void".into() } else { types.join(", ") }
    };
    for function in entries(&json, "functions") {
        let (name, result) = (text(&function["name"]), text(&function["result"]["type"]));
        writeln!(program, "{result} {name}({});\n{}", parameters(function), text(&function["declaration"])).unwrap();
    }
    for callback in entries(&json, "callbacks") {
        let (name, result) = (text(&callback["name"]), text(&callback["result"]["type"]));
        writeln!(program, "typedef {result} (*{name})({});\n{}", parameters(callback), text(&callback["declaration"]))
            .unwrap();
    }
    for kind in ["enumerations", "opaque_types"].iter().flat_map(|list| entries(&json, list)) {
        writeln!(program, "{}", text(&kind["declaration"])).unwrap();
    }
    for object in entries(&json, "structs") {
        let name = text(&object["name"]);
        writeln!(program, "_Static_assert(_Alignof({name}) == {}, \"\");", object["alignment"]).unwrap();
        for field in object["fields"].as_array().unwrap() {
            let member = text(&field["name"]);
            let pointer = match field["array"].as_u64() {
                Some(length) => format!("{} (*{name}_{member}(void))[{length}]", text(&field["type"])),
                None => format!("{} *{name}_{member}(void)", text(&field["type"])),
            };
            writeln!(program, "{pointer};\n{pointer} {{ return &(({name} *)0)->{member}; }}").unwrap();
        }
    }
    for constant in entries(&json, "constants").iter().filter(|constant| text(&constant["type"]).starts_with("Bhr")) {
        let kind = text(&constant["type"]);
        let list = entries(&json, "enumerations").iter().find(|entry| entry["name"] == kind);
        let list = list.unwrap_or_else(|| panic!("{constant}"))["constants"].as_array().unwrap();
        assert!(list.contains(&constant["name"]), "{constant}");
    }
    let source = scratch("bhr_json").join("types.c");
    std::fs::write(&source, program).unwrap();
    let mut command = compiler(false);
    command.args(["-std=c11", "-Wall", "-Werror", "-fsyntax-only", "-I"]).arg(root().join("include"));
    run(command.arg(&source));
}

/// The declarations by themselves are C that needs no header but those of the basic types.
#[test]
fn its_declarations_stand_by_themselves() {
    let json = committed();
    let declarations: Vec<_> = entries(&json, "declarations").iter().map(text).collect();
    let program = format!("#include <stddef.h>\n#include <stdint.h>\n{}\n", declarations.join("\n"));
    let found = functions(&program);
    assert_eq!(found, functions(HEADER));
    let source = scratch("bhr_json").join("declarations.c");
    std::fs::write(&source, program).unwrap();
    run(compiler(false).args(["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fsyntax-only"]).arg(&source));
}

/// Bits have a place where they go: every constant is a value of an enumeration or says so, but for these.
#[test]
fn constants_say_what_they_are_for() {
    const OTHERS: [&str; 9] = [
        "BHR_VERSION_MAJOR",
        "BHR_VERSION_MINOR",
        "BHR_VERSION_PATCH",
        "BHR_ABI_VERSION",
        "BHR_MAX_VOLUMES",
        "BHR_MAX_HOT_SPOTS",
        "BHR_MAX_OUTPUTS",
        "BHR_MAX_CROSSINGS",
        "BHR_MAX_IMAGE_ORDER",
    ];
    let json = committed();
    let mut others = Vec::new();
    for constant in entries(&json, "constants").iter().filter(|constant| !text(&constant["type"]).starts_with("Bhr")) {
        let Some(bits) = constant["bits_of"].as_str() else {
            others.push(text(&constant["name"]));
            continue;
        };
        let (owner, member) = bits.split_once('.').unwrap();
        let lists = ["structs", "functions"].iter().flat_map(|list| entries(&json, list));
        let owner = lists.filter(|entry| entry["name"] == owner).collect::<Vec<_>>();
        let parts = ["fields", "parameters"].iter().filter_map(|list| owner[0][list].as_array()).flatten();
        assert!(parts.into_iter().any(|part| part["name"] == member), "{constant}");
    }
    assert_eq!(others, OTHERS);
}

/// JSON as text: what fits on a line is on one line.
fn written(value: &Value, depth: usize) -> String {
    let compact = serde_json::to_string(value).unwrap();
    if depth > 1 && compact.len() + 2 * depth <= 118 {
        return spaced(value);
    }
    let (inner, outer) = ("  ".repeat(depth + 1), "  ".repeat(depth));
    match value {
        Value::Object(parts) if !parts.is_empty() => {
            let line = |(key, value): (&String, &Value)| format!("{inner}\"{key}\": {}", written(value, depth + 1));
            format!("{{\n{}\n{outer}}}", parts.iter().map(line).collect::<Vec<_>>().join(",\n"))
        }
        Value::Array(elements) if !elements.is_empty() => {
            let line = |value: &Value| format!("{inner}{}", written(value, depth + 1));
            format!("[\n{}\n{outer}]", elements.iter().map(line).collect::<Vec<_>>().join(",\n"))
        }
        _ => compact,
    }
}

/// JSON on one line, with spaces behind commas and colons.
fn spaced(value: &Value) -> String {
    match value {
        Value::Object(parts) => {
            let part = |(key, value): (&String, &Value)| format!("\"{key}\": {}", spaced(value));
            format!("{{{}}}", parts.iter().map(part).collect::<Vec<_>>().join(", "))
        }
        Value::Array(elements) => format!("[{}]", elements.iter().map(spaced).collect::<Vec<_>>().join(", ")),
        _ => serde_json::to_string(value).unwrap(),
    }
}
