// SPDX-License-Identifier: MIT OR Apache-2.0
//! The constants and the plain structs of include/bhr.json in C++ and in Python: include/bhr/constants.hpp,
//! include/bhr/structs.hpp and python/src/bhr/_constants.py are made here.

use crate::c_header::root;
use crate::json::{committed, entries, text};
use serde_json::Value;
use std::fmt::Write;

/// Enumerations whose constants share more of their names than their words leave out.
const PREFIXES: [(&str, &str); 1] = [("BhrDiskReference", "BHR_DISK_")];

/// Enumerations that C++ has by hand (result.hpp), and that Python has other means for.
const BY_HAND_IN_CPP: [&str; 1] = ["BhrStatus"];
const NOT_IN_PYTHON: [&str; 3] = ["BhrLogLevel", "BhrWindowKind", "BhrPresentMode"];
const BITS_NOT_IN_PYTHON: [&str; 2] = ["ContextFlags", "ImageFlags"];
/// Enumerations that are told and never given: their members go by no names.
const ONLY_TOLD: [&str; 3] = ["Status", "Fate", "WorldLineEnd"];

/// The structs that a C++ program fills in, with the defaults of their *_init functions; of the camera the fields,
/// which camera.hpp gives methods.
const STRUCTS: [&str; 8] =
    ["BhrCamera", "BhrDisk", "BhrVolume", "BhrHotSpot", "BhrSky", "BhrFilm", "BhrPresetOptions", "BhrQuality"];

/// The words of files that are made here.
const MADE: &str = "Made by tests/header/bindings.rs from include/bhr.json; do not edit.";

/// A constant as bindings have it.
pub struct Member {
    /// The end of its name, `LIMB_DARKENED`.
    pub word: String,
    /// Its name in C.
    pub name: String,
    pub value: i64,
    /// The first sentence of its comment.
    pub about: String,
}

/// The first sentence of a comment, without the place of bits that it begins with.
pub fn sentence(documentation: &str) -> String {
    // A number alone is a list's item to Doxygen.
    if documentation.trim() == "0." {
        return "Reserved: 0.".into();
    }
    let plain = documentation.split_once(".flags: ").map_or(documentation, |(_, rest)| rest);
    // Two dots are those of a range; "Rec. 709" and "et al. 2020" go on.
    let goes_on = |before: &str| [".", "Rec", "et al"].iter().any(|end| before.ends_with(end));
    let is_end = |(at, _): &(usize, &str)| !goes_on(&plain[..*at]);
    let mut ends = plain.match_indices(". ").filter(is_end);
    let end = ends.next().map_or(plain.len(), |(at, _)| at + 1);
    let sentence = plain[..end].split('\n').next().unwrap().trim();
    let mut letters = sentence.chars();
    let first = letters.next().map(|first| first.to_uppercase().to_string()).unwrap_or_default();
    format!("{first}{}", letters.as_str())
}

fn members_of(json: &Value, names: &[&str], prefix: Option<&str>) -> Vec<Member> {
    let common = names.iter().fold(names[0].len(), |common, name| {
        names[0].bytes().zip(name.bytes()).take(common).take_while(|(a, b)| a == b).count()
    });
    let begin = prefix.map_or_else(|| names[0][..common].rfind('_').unwrap() + 1, str::len);
    let member = |name: &&str| {
        let constant = entries(json, "constants").iter().find(|constant| constant["name"] == **name).unwrap();
        Member {
            word: name[begin..].to_owned(),
            name: (*name).to_owned(),
            value: constant["value"].as_i64().unwrap(),
            about: sentence(text(&constant["documentation"])),
        }
    };
    names.iter().map(member).collect()
}

/// The constants of an enumeration.
pub fn members(json: &Value, enumeration: &str) -> Vec<Member> {
    let list = entries(json, "enumerations").iter().find(|entry| entry["name"] == enumeration).unwrap();
    let names = list["constants"].as_array().unwrap().iter().map(text).collect::<Vec<_>>();
    let prefix = PREFIXES.iter().find(|(name, _)| *name == enumeration).map(|(_, prefix)| *prefix);
    members_of(json, &names, prefix)
}

/// The bits of a field or a parameter, by its place, such as `BhrDisk.flags`; none: it is a number.
pub fn bits(json: &Value, place: &str) -> Vec<Member> {
    let is_its = |constant: &&Value| constant["bits_of"] == place;
    let names = entries(json, "constants").iter().filter(is_its).map(|constant| text(&constant["name"]));
    let names = names.collect::<Vec<_>>();
    let single = names.len() == 1;
    // One constant alone tells nothing of what is common: its prefix is that of its struct.
    let prefix = single.then(|| &names[0][..names[0].rfind('_').unwrap() + 1]);
    if names.is_empty() { Vec::new() } else { members_of(json, &names, prefix) }
}

/// The places of bits, in the order of the header, with the names of their types.
pub fn places(json: &Value) -> Vec<(String, String)> {
    let mut places: Vec<(String, String)> = Vec::new();
    for constant in entries(json, "constants") {
        let Some(place) = constant["bits_of"].as_str() else { continue };
        let name = match place {
            "bhr_set_effects.effects" => "Effects".to_owned(),
            "bhr_camera_matrices.flags" => "MatrixFlags".to_owned(),
            _ => {
                let owner = place.split('.').next().unwrap().trim_start_matches("Bhr");
                format!("{}Flags", owner.trim_end_matches("Info").trim_end_matches("Options"))
            }
        };
        if !places.iter().any(|(known, _)| known == place) {
            places.push((place.to_owned(), name));
        }
    }
    places
}

/// Text in lines of at most 120 columns, each after `begin`.
pub fn wrapped(begin: &str, words: &str) -> String {
    let mut lines = vec![begin.to_owned()];
    for word in words.split_whitespace() {
        let last = lines.last_mut().unwrap();
        if last.len() + word.len() + 1 > 120 {
            lines.push(format!("{begin} {word}"));
        } else {
            *last += &format!(" {word}");
        }
    }
    lines.join("\n") + "\n"
}

// ---- C++ ----

fn cpp_opening(file: &str, about: &str, includes: &str) -> String {
    let guard = format!("BHR_{}_HPP", file.to_uppercase());
    let head = wrapped(" *", &format!("bhr/{file}.hpp -- {about} Include bhr.hpp. {MADE} */"));
    let head = head.replacen(" * ", "/* ", 1);
    format!(
        "// SPDX-License-Identifier: MIT OR Apache-2.0\n{head}#ifndef {guard}\n#define {guard}\n\n{includes}\n\
         namespace bhr {{\n"
    )
}

fn cpp_word(word: &str) -> String {
    match word.to_lowercase().as_str() {
        // Words of the language.
        "auto" => "automatic".into(),
        "static" => "static_".into(),
        word => word.into(),
    }
}

fn cpp_enumeration(name: &str, about: &str, base: &str, members: &[Member], has_none: bool) -> String {
    let mut code = "\n".to_owned() + &wrapped("///", about);
    writeln!(code, "enum class {name} : {base} {{").unwrap();
    if has_none {
        code += "    none = 0,\n";
    }
    for member in members {
        code += &wrapped("    ///", &member.about);
        writeln!(code, "    {} = {},", cpp_word(&member.word), member.name).unwrap();
    }
    code + "};\n"
}

fn constants_hpp(json: &Value) -> String {
    let mut code = cpp_opening(
        "constants",
        "the constants of bhr.h as enum classes, and sets of bits.",
        "#include <bhr.h>\n\n#include <cstddef>\n#include <cstdint>\n#include <type_traits>\n",
    );
    for entry in entries(json, "enumerations") {
        let name = text(&entry["name"]);
        if !BY_HAND_IN_CPP.contains(&name) {
            let about = format!("{name}: {}", sentence(text(&entry["documentation"])));
            code += &cpp_enumeration(&name.replacen("Bhr", "", 1), &about, "std::int32_t", &members(json, name), false);
        }
    }
    let places = places(json);
    for (place, name) in &places {
        code += &cpp_enumeration(name, &format!("Bits of {place}."), "std::uint32_t", &bits(json, place), true);
    }
    for constant in entries(json, "constants") {
        let name = text(&constant["name"]);
        if let Some(rest) = name.strip_prefix("BHR_MAX_") {
            code += &format!("\n{}", wrapped("///", &sentence(text(&constant["documentation"]))));
            let kind = text(&constant["type"]);
            writeln!(code, "inline constexpr std::{kind} max_{} = {name};", rest.to_lowercase()).unwrap();
        }
    }
    let same = places.iter().map(|(_, name)| format!("std::is_same_v<E, {name}>")).collect::<Vec<_>>();
    let same = same.join(" ||\n    ");
    writeln!(
        code,
        "\nnamespace detail {{\n/// Whether a type is a set of bits.\n\
         template <class E>\ninline constexpr bool is_bits =\n    {same};\n}} // namespace detail\n\n\
         }} // namespace bhr\n\n#endif"
    )
    .unwrap();
    code
}

/// A field's type in C++.
fn cpp_type(json: &Value, object: &str, field: &Value) -> String {
    let place = format!("{object}.{}", text(&field["name"]));
    let base = match text(&field["base"]) {
        base if base.starts_with("Bhr") => base.replacen("Bhr", "", 1),
        "double" => "double".into(),
        base => places(json).into_iter().find(|(of, _)| *of == place).map_or(format!("std::{base}"), |(_, name)| name),
    };
    match field["array"].as_u64() {
        Some(3) if base == "double" => "Vector".into(),
        Some(count) => format!("std::array<{base}, {count}>"),
        None => base,
    }
}

pub fn structs_hpp(json: &Value) -> String {
    let mut code = cpp_opening(
        "structs",
        "the structs that programs fill in, with the defaults of bhr.h.",
        "#include \"constants.hpp\"\n#include \"layout.hpp\"\n\n#include <array>\n",
    );
    code += "\n/// Components along x, y and z.\nusing Vector = std::array<double, 3>;\n";
    for name in STRUCTS {
        let object = entries(json, "structs").iter().find(|object| object["name"] == name).unwrap();
        let init = entries(json, "functions")
            .iter()
            .find(|function| text(&function["name"]).ends_with("_init") && function["parameters"][0]["base"] == name)
            .unwrap();
        let (init, is_camera) = (text(&init["name"]), name == "BhrCamera");
        let plain = name.replacen("Bhr", "", 1);
        let cpp = if is_camera { format!("{plain}Fields") } else { plain };
        let defaults = if is_camera { "Its fields; Camera has the rest.".into() } else { format!("Defaults: {init}.") };
        let about = format!("{name}: {} {defaults}", sentence(text(&object["documentation"])));
        code += &format!("\n{}struct {cpp} {{\n", wrapped("///", &about));
        for field in object["fields"].as_array().unwrap() {
            code += &wrapped("    ///", &sentence(text(&field["documentation"])));
            writeln!(code, "    {} {};", cpp_type(json, name, field), text(&field["name"])).unwrap();
        }
        if !is_camera {
            write!(
                code,
                "\n    {cpp}() noexcept {{ detail::defaults(*this, {init}); }}\n    \
                 {name} c() const noexcept {{ return detail::as_c<{name}>(*this); }}\n"
            )
            .unwrap();
        }
        code += "};\n";
    }
    code + "\n} // namespace bhr\n\n#endif\n"
}

// ---- Python ----

fn python_class(name: &str, base: &str, about: &str, members: &[Member]) -> String {
    let mut code = format!("\n\nclass {name}(enum.{base}):\n");
    code += &wrapped("   ", &format!("\"\"\"{about}\"\"\"\n"));
    code += "\n";
    for member in members {
        code += &wrapped("    #:", &member.about);
        writeln!(code, "    {} = {}", member.word, member.value).unwrap();
    }
    code
}

fn constants_py(json: &Value) -> String {
    let mut code = format!(
        "# SPDX-License-Identifier: MIT OR Apache-2.0\n\
         \"\"\"The constants of bhr.h as enumerations, and the names that \
         stand for their members. bhr.h says at length what each\none means. {MADE}\"\"\"\n\n\
         from __future__ import annotations\n\nimport enum\nfrom typing import Any, Literal, Union\n"
    );
    let mut named = Vec::new();
    for entry in entries(json, "enumerations") {
        let (c_name, about) = (text(&entry["name"]), sentence(text(&entry["documentation"])));
        if NOT_IN_PYTHON.contains(&c_name) {
            continue;
        }
        let name = c_name.replacen("Bhr", "", 1);
        let mut members = members(json, c_name);
        members.iter_mut().for_each(|member| member.word = member.word.replacen("ERROR_", "", 1));
        code += &python_class(&name, "IntEnum", &about, &members);
        if !ONLY_TOLD.contains(&name.as_str()) {
            named.push((name, members));
        }
    }
    for (place, name) in places(json).iter().filter(|(_, name)| !BITS_NOT_IN_PYTHON.contains(&name.as_str())) {
        code += &python_class(name, "IntFlag", &format!("Bits of {place} in bhr.h."), &bits(json, place));
    }
    code += "\n\n";
    for (name, members) in &named {
        let words = members.iter().map(|member| format!("\"{}\"", member.word.to_lowercase())).collect::<Vec<_>>();
        let line = format!("{name}Name = Literal[{}]", words.join(", "));
        code +=
            &if line.len() <= 120 { line } else { format!("{name}Name = Literal[\n    {},\n]", words.join(",\n    ")) };
        write!(code, "\n{name}Like = Union[{name}, {name}Name]\n").unwrap();
    }
    code += "\n#: The types of the names of each enumeration; names of flags are any text, as several may be joined.\n\
             NAMES: dict[type[enum.IntEnum], Any] = {\n";
    named.iter().for_each(|(name, _)| writeln!(code, "    {name}: {name}Name,").unwrap());
    code + "}\n"
}

/// With BHR_UPDATE_HEADER set, this brings a file that is made from include/bhr.json up to date, with the header
/// (tests/header/generated.rs).
pub fn is_up_to_date(path: &str, generated: &str) {
    let file = root().join(path);
    if std::env::var_os("BHR_UPDATE_HEADER").is_some() {
        std::fs::write(&file, generated).unwrap();
    }
    assert!(
        std::fs::read_to_string(&file).unwrap_or_default() == generated,
        "{path} is not what include/bhr.json says; bring it up to date with\n\
         BHR_UPDATE_HEADER=1 cargo test --profile checked --locked --test header committed, twice"
    );
}

#[test]
fn the_committed_bindings_are_the_generated_ones() {
    let json = committed();
    is_up_to_date("include/bhr/constants.hpp", &constants_hpp(&json));
    is_up_to_date("include/bhr/structs.hpp", &structs_hpp(&json));
    is_up_to_date("python/src/bhr/_constants.py", &constants_py(&json));
}
