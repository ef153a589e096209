// SPDX-License-Identifier: MIT OR Apache-2.0
//! The structs of include/bhr.json as Python's dataclasses: python/src/bhr/_fields.py is made here.

use crate::bindings::{Member, bits, is_up_to_date, members, places, wrapped};
use crate::json::{committed, entries, text};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fmt::Write;

/// The structs that Python has, each with the fields that come first there, in this order; the others follow as C has
/// them. Hosts give fields by their positions, too, so that a struct keeps its order.
const STRUCTS: [(&str, &[&str]); 12] = [
    ("BhrCamera", &["position", "forward", "up", "fov_y"]),
    ("BhrDisk", &["inner_radius", "outer_radius", "temperature", "opacity", "brightness", "turbulence", "seed"]),
    ("BhrVolume", &["shape", "flow"]),
    ("BhrHotSpot", &["radius", "size", "azimuth"]),
    ("BhrSky", &[]),
    ("BhrFilm", &[]),
    ("BhrQuality", &[]),
    ("BhrRegion", &[]),
    ("BhrProjectedPoint", &[]),
    ("BhrHoleInfo", &[]),
    ("BhrFrameStats", &[]),
    ("BhrAdapterInfo", &["name", "driver"]),
];

/// Structs that have methods of their own, with the classes that have those and their modules.
const METHODS: [(&str, &str, &str); 1] = [("BhrCamera", "CameraMethods", "_camera")];

/// Fields that Python has a default for, and C has none.
const DEFAULTS: [(&str, &str); 2] = [("BhrRegion.x", "0"), ("BhrRegion.y", "0")];

const OPENING: &str = "# SPDX-License-Identifier: MIT OR Apache-2.0
\"\"\"The structs of bhr.h as frozen dataclasses, with the library's defaults.
Made by tests/header/python_structs.rs from include/bhr.json; do not edit.\"\"\"

from __future__ import annotations

import dataclasses
from typing import Any, ClassVar

";

/// An enumeration or a set of bits of a field.
pub struct Kind {
    pub class: String,
    pub is_bits: bool,
    pub members: Vec<Member>,
}

pub fn kind(json: &Value, object: &str, field: &Value) -> Option<Kind> {
    let (base, place) = (text(&field["base"]), format!("{object}.{}", text(&field["name"])));
    if entries(json, "enumerations").iter().any(|entry| entry["name"] == base) {
        return Some(Kind { class: base.replacen("Bhr", "", 1), is_bits: false, members: members(json, base) });
    }
    let class = places(json).into_iter().find(|(of, _)| *of == place)?.1;
    Some(Kind { class, is_bits: true, members: bits(json, &place) })
}

/// The names that constants have in Python, by those that they have in C.
fn python_names(json: &Value) -> BTreeMap<String, String> {
    let enumerations = entries(json, "enumerations").iter().map(|entry| text(&entry["name"]));
    let of_values = enumerations.map(|name| (name.replacen("Bhr", "", 1), members(json, name)));
    let of_bits = places(json).into_iter().map(|(place, name)| (name, bits(json, &place)));
    let all = of_values.chain(of_bits).collect::<Vec<_>>();
    let names = all.iter().flat_map(|(class, members)| {
        members.iter().map(move |member| (member.name.clone(), format!("{class}.{}", member.word)))
    });
    names.collect()
}

/// A comment of the header in another language's words: constants by their `names` there, and a field's enumeration by
/// its own.
pub fn translated(documentation: &str, kind: Option<&Kind>, names: &BTreeMap<String, String>) -> String {
    let mut said = String::new();
    let mut rest = documentation;
    while let Some(at) = rest.find("BHR_") {
        said += &rest[..at];
        let name = &rest[at..];
        let end = name.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(name.len());
        (said, rest) = match (names.get(&name[..end]), kind) {
            (Some(python), _) => (said + python, &name[end..]),
            (None, Some(kind)) if name[end..].starts_with('*') => {
                (said + if kind.is_bits { "" } else { "One of " } + &kind.class, &name[end + 1..])
            }
            _ => (said + &name[..end], &name[end..]),
        };
    }
    said += rest;
    // Further constants of a list are written by their ends alone.
    if kind.is_some() { said.replace(", _", ", ") } else { said }
}

fn annotation(field: &Value, kind: Option<&Kind>, is_input: bool) -> String {
    match (kind, text(&field["base"]), field["array"].as_u64()) {
        (Some(Kind { class, .. }), ..) if !is_input => class.clone(),
        (Some(Kind { class, is_bits: true, .. }), ..) => format!("Named[{class}, str]"),
        (Some(Kind { class, .. }), ..) => format!("Named[{class}, {class}Name]"),
        (None, "double", None) => "float".into(),
        (None, "double", Some(2)) => "tuple[float, float]".into(),
        (None, "double", Some(3)) => "Vector".into(),
        (None, "double", Some(4)) => "Quaternion".into(),
        (None, "char", Some(_)) => "str".into(),
        (None, "uint32_t" | "uint64_t", None) => "int".into(),
        (None, "BhrRay", None) => "Any".into(),
        (None, base, array) => panic!("Python has no type for {base} {array:?}"),
    }
}

fn number(value: &Value) -> String {
    format!("{:?}", value.as_f64().unwrap())
}

fn default(place: &str, field: &Value, kind: Option<&Kind>) -> Option<String> {
    if let Some((_, value)) = DEFAULTS.iter().find(|(of, _)| *of == place) {
        return Some((*value).into());
    }
    let value = field.get("default")?;
    Some(match (kind, value) {
        (Some(Kind { class, is_bits: true, members }), _) => {
            let set = members.iter().filter(|member| value.as_i64().unwrap() & member.value != 0);
            let set = set.map(|member| format!("{class}.{}", member.word)).collect::<Vec<_>>();
            format!("named({})", if set.is_empty() { format!("{class}(0)") } else { set.join(" | ") })
        }
        (Some(Kind { class, members, .. }), _) => {
            let member = members.iter().find(|member| member.value == value.as_i64().unwrap()).unwrap();
            format!("named({class}.{})", member.word)
        }
        (None, Value::Array(values)) => format!("({})", values.iter().map(number).collect::<Vec<_>>().join(", ")),
        (None, _) if field["base"] == "double" => number(value),
        (None, _) => value.to_string(),
    })
}

/// The fields of a struct in Python's order.
fn ordered<'a>(object: &'a Value, first: &[&str]) -> Vec<&'a Value> {
    let fields = object["fields"].as_array().unwrap().iter();
    let mut fields: Vec<_> = fields.filter(|field| !is_hidden(text(&field["name"]))).collect();
    let place = |field: &&Value| first.iter().position(|name| field["name"] == *name).unwrap_or(first.len());
    fields.sort_by_key(place);
    fields
}

pub fn is_hidden(name: &str) -> bool {
    name == "struct_size" || name.starts_with("reserved")
}

pub fn fields_py(json: &Value) -> String {
    let names = python_names(json);
    let (mut classes, mut imports) = (String::new(), Vec::new());
    for (c_name, first) in STRUCTS {
        let object = entries(json, "structs").iter().find(|object| object["name"] == c_name).unwrap();
        let class = c_name.replacen("Bhr", "", 1);
        let base = METHODS.iter().find(|(of, ..)| *of == c_name).map_or("Struct", |(_, methods, _)| methods);
        let about =
            wrapped("   ", &format!("\"\"\"{}\"\"\"", translated(text(&object["documentation"]), None, &names)));
        let fields = ordered(object, first);
        let is_input = fields.iter().any(|field| field.get("default").is_some());
        let (mut lines, mut enumerations) = (String::new(), Vec::new());
        for field in fields {
            let name = text(&field["name"]);
            let (place, kind) = (format!("{c_name}.{name}"), kind(json, c_name, field));
            lines += &wrapped("    #:", &translated(text(&field["documentation"]), kind.as_ref(), &names));
            write!(lines, "    {name}: {}", annotation(field, kind.as_ref(), is_input)).unwrap();
            let default = default(&place, field, kind.as_ref());
            lines += &default.map_or("\n".into(), |default| format!(" = {default}\n"));
            if let Some(Kind { class, is_bits, .. }) = kind {
                enumerations.push(format!("\"{name}\": {class}"));
                imports.extend((is_input && !is_bits).then(|| format!("{class}Name")));
                imports.push(class);
            }
        }
        write!(
            classes,
            "\n\n@dataclasses.dataclass(frozen=True)\nclass {class}({base}):\n{about}\n    \
             c_name: ClassVar[str] = \"{c_name}\"\n"
        )
        .unwrap();
        if !enumerations.is_empty() {
            writeln!(classes, "    c_enums = {{{}}}", enumerations.join(", ")).unwrap();
        }
        classes += &format!("\n{lines}");
    }
    imports.sort();
    imports.dedup();
    let methods = METHODS.map(|(_, methods, module)| format!("from .{module} import {methods}\n")).concat();
    format!(
        "{OPENING}{methods}from ._constants import (\n    {},\n)\nfrom ._names import Named, named\n\
         from ._struct import Quaternion, Struct, Vector\n{classes}",
        imports.join(",\n    ")
    )
}

#[test]
fn the_committed_python_structs_are_the_generated_ones() {
    is_up_to_date("python/src/bhr/_fields.py", &fields_py(&committed()));
}

/// Every field that comes first somewhere is a field, so that no other takes its place.
#[test]
fn python_orders_fields_that_there_are() {
    let json = committed();
    for (c_name, first) in STRUCTS {
        let object = entries(&json, "structs").iter().find(|object| object["name"] == c_name).unwrap();
        let begin = ordered(object, first).into_iter().take(first.len());
        assert!(begin.map(|field| text(&field["name"])).eq(first.iter().copied()), "{c_name}: {first:?}");
    }
}
