// SPDX-License-Identifier: MIT OR Apache-2.0
//! The structs and constants of include/bhr.json that say what a scene is, as types of TypeScript, under the names that
//! scenes as text have (docs/scenes.md): web/scene.d.ts and web/words.d.ts are made here.

use crate::bindings::{Member, bits, is_up_to_date, members, places};
use crate::example_fields::short;
use crate::json::{committed, entries, text};
use crate::python_structs::{Kind, is_hidden, kind, translated};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// A scene's, and after them those of answers about it.
const STRUCTS: [&str; 11] = [
    "BhrCamera",
    "BhrDisk",
    "BhrVolume",
    "BhrHotSpot",
    "BhrSky",
    "BhrFilm",
    "BhrQuality",
    "BhrRegion",
    "BhrHoleInfo",
    "BhrRay",
    "BhrCrossing",
];

/// Enumerations that no field of these has, and bits of a function's.
const WORDS: [&str; 4] = ["BhrView", "BhrPreset", "BhrPresetMatter", "BhrBackend"];
const BITS: [&str; 1] = ["bhr_set_effects.effects"];

const OPENING: &str = "// SPDX-License-Identifier: MIT OR Apache-2.0\n";

/// The end of each file's opening.
const MADE: &str = "under the names of scenes as text (docs/scenes.md).
// Made by tests/header/typescript.rs from include/bhr.json; do not edit.
";

/// A comment with lines of at most 120 columns; each of `tags` has its own.
fn comment(margin: &str, words: &str, tags: &[String]) -> String {
    let mut lines = vec![String::new()];
    for word in words.split_whitespace() {
        if margin.len() + 4 + lines.last().unwrap().len() + word.len() > 120 {
            lines.push(String::new());
        }
        let last = lines.last_mut().unwrap();
        last.push_str(if last.is_empty() { "" } else { " " });
        last.push_str(word);
    }
    lines.extend_from_slice(tags);
    if let [line] = &lines[..]
        && margin.len() + line.len() + 7 <= 120
    {
        return format!("{margin}/** {line} */\n");
    }
    let lines = lines.iter().map(|line| format!("{margin} * {line}\n")).collect::<String>();
    format!("{margin}/**\n{lines}{margin} */\n")
}

/// The types of all words, and the constants' names as words, `"torus"`.
struct Words {
    kinds: BTreeMap<String, String>,
    names: BTreeMap<String, String>,
}

impl Words {
    fn all(json: &Value) -> Self {
        let enumerations = entries(json, "enumerations").iter().map(|entry| text(&entry["name"]));
        let values = enumerations.flat_map(|name| members(json, name));
        let all = values.chain(places(json).into_iter().flat_map(|(place, _)| bits(json, &place)));
        let names = all.map(|member| (member.name, format!("\"{}\"", member.word.to_lowercase()))).collect();
        Self { kinds: BTreeMap::new(), names }
    }

    /// The type of a field's words, written once.
    fn add(&mut self, kind: &Kind, about: &str) {
        let name = &kind.class;
        let member = |member: &Member| {
            let about = translated(&member.about, None, &self.names);
            comment("    ", &about, &[]) + &format!("    | \"{}\"\n", member.word.to_lowercase())
        };
        let members = kind.members.iter().map(member).collect::<String>();
        let about = comment("", &translated(about, None, &self.names), &[]);
        let code = format!("\n{about}export type {name} =\n{};\n", members.trim_end());
        self.kinds.insert(name.to_owned(), code);
    }
}

fn type_of(field: &Value, word: Option<&Kind>) -> String {
    match (word, text(&field["base"]), field["array"].as_u64()) {
        (Some(kind), ..) if kind.is_bits => format!("readonly {}[]", kind.class),
        (Some(kind), ..) => kind.class.clone(),
        // 64 bits are more than a number holds.
        (None, "uint64_t", None) => "number | bigint".into(),
        (None, "double" | "uint32_t", None) => "number".into(),
        (None, "double", Some(3)) => "Vector".into(),
        (None, "double", Some(count)) => {
            format!("readonly [{}]", vec!["number"; usize::try_from(count).unwrap()].join(", "))
        }
        (None, base, array) => panic!("TypeScript has no type for {base} {array:?}"),
    }
}

/// Range with its unit, and default, as far as bhr.json has them.
fn tags(field: &Value, word: Option<&Kind>) -> Vec<String> {
    let unit = field["unit"].as_str();
    let range = field["range"].as_array().map(|ends| {
        let [low, high] = [0, 1].map(|end| short(ends[end].as_f64().unwrap()));
        format!("@range {low} .. {high} {}", unit.unwrap_or_default()).trim_end().to_owned()
    });
    let mut tags: Vec<_> = range.or(unit.map(|unit| format!("@unit {unit}"))).into_iter().collect();
    let named = |value: &Value, kind: &Kind| {
        let number = value.as_i64().unwrap();
        let is_its = |value: i64| if kind.is_bits { number & value != 0 } else { number == value };
        let words = kind.members.iter().filter(|member| is_its(member.value));
        let words = words.map(|member| format!("\"{}\"", member.word.to_lowercase())).collect::<Vec<_>>().join(", ");
        if kind.is_bits { format!("[{words}]") } else { words }
    };
    tags.extend(field.get("default").map(|value| match word {
        Some(kind) => format!("@default {}", named(value, kind)),
        None => format!("@default {}", value.to_string().replace(',', ", ")),
    }));
    tags
}

/// A list of bits is named in the plural, each in the singular.
fn in_singular(kind: Kind) -> Kind {
    let class = if kind.is_bits { kind.class.trim_end_matches('s').to_owned() } else { kind.class };
    Kind { class, ..kind }
}

/// The files of the structs and of their words.
pub fn files(json: &Value) -> (String, String) {
    let mut words = Words::all(json);
    let about_of = |list: &str, name: &str| {
        let entry = entries(json, list).iter().find(|entry| entry["name"] == name);
        entry.map(|entry| text(&entry["documentation"]).to_owned())
    };
    let (mut structs, mut used) = (String::new(), BTreeSet::new());
    for name in STRUCTS {
        let object = entries(json, "structs").iter().find(|object| object["name"] == name).unwrap();
        let about = translated(text(&object["documentation"]), None, &words.names);
        structs += &format!("\n{}export interface {} {{\n", comment("", &about, &[]), name.replacen("Bhr", "", 1));
        let fields = object["fields"].as_array().unwrap().iter();
        for field in fields.filter(|field| !is_hidden(text(&field["name"]))) {
            let member = text(&field["name"]);
            let kind = kind(json, name, field).map(in_singular);
            if let Some(kind) = &kind {
                let about = about_of("enumerations", text(&field["base"]));
                words.add(kind, &about.unwrap_or_else(|| format!("Bits of {name}.{member}.")));
                used.insert(kind.class.clone());
            }
            let said = translated(text(&field["documentation"]), kind.as_ref(), &words.names);
            structs += &comment("    ", &said, &tags(field, kind.as_ref()));
            structs += &format!("    {member}: {};\n", type_of(field, kind.as_ref()));
        }
        structs += "}\n";
    }
    for name in WORDS {
        let class = name.replacen("Bhr", "", 1);
        let kind = Kind { class, is_bits: false, members: members(json, name) };
        words.add(&kind, &about_of("enumerations", name).unwrap());
    }
    for place in BITS {
        let (_, class) = places(json).into_iter().find(|(of, _)| of == place).unwrap();
        let kind = in_singular(Kind { class, is_bits: true, members: bits(json, place) });
        words.add(&kind, &format!("Bits of {place}."));
    }
    let used = used.into_iter().collect::<Vec<_>>().join(",\n    ");
    let vector = "/** Components along x, y and z, or red, green and blue. */\n\
                  export type Vector = readonly [number, number, number];\n";
    let import = format!("import type {{\n    {used},\n}} from \"./words\";\n");
    let scene = format!("{OPENING}// scene.d.ts -- what a scene is made of, {MADE}\n{import}\n{vector}{structs}");
    let kinds = words.kinds.values().cloned().collect::<String>();
    (scene, format!("{OPENING}// words.d.ts -- the words of a scene's choices and flags, {MADE}{kinds}"))
}

#[test]
fn the_committed_types_of_typescript_are_the_generated_ones() {
    let (scene, words) = files(&committed());
    is_up_to_date("web/scene.d.ts", &scene);
    is_up_to_date("web/words.d.ts", &words);
}
