// SPDX-License-Identifier: MIT OR Apache-2.0
//! The fields and the constants of include/bhr.json for the example programs: examples-c/fields.c is made here.

use crate::bindings::{Member, bits, is_up_to_date, members, sentence};
use crate::json::{committed, entries, text};
use serde_json::Value;
use std::fmt::Write;

/// The structs whose fields are options, keys of --volume and --hot-spot, and widgets of the panel.
const STRUCTS: [&str; 6] = ["BhrDisk", "BhrVolume", "BhrHotSpot", "BhrSky", "BhrFilm", "BhrQuality"];

/// Enumerations of which no program chooses a constant by its name.
const UNCHOSEN: [&str; 10] = [
    "BhrStatus",
    "BhrLogLevel",
    "BhrWindowKind",
    "BhrFormat",
    "BhrPresentMode",
    "BhrOutputKind",
    "BhrFate",
    "BhrChart",
    "BhrTransport",
    "BhrWorldLineEnd",
];

/// Lists that are not named after their enumerations.
const LISTS: [(&str, &str); 1] = [("BhrVolumeShape", "VOLUME_KINDS")];

/// Constants that are not named by their words; programs of earlier releases took these.
const NAMES: [(&str, &str); 4] = [
    ("BHR_MOTION_FREE_FALL", "freefall"),
    ("BHR_VIEW_OPTICAL_DEPTH", "optical_depth"),
    ("BHR_DISK_AT_HOTTEST", "hottest"),
    ("BHR_DISK_AT_MEDIAN", "median"),
];

const OPENING: &str = "/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* fields.c -- see fields.h. Made by tests/header/example_fields.rs from include/bhr.json; do not edit. */
#include \"fields.h\"
";

/// A name like BhrHotSpot as C has it in names of lists, HOT_SPOT.
fn upper(name: &str) -> String {
    let mut words = String::new();
    for (at, letter) in name.trim_start_matches("Bhr").char_indices() {
        if at > 0 && letter.is_ascii_uppercase() {
            words.push('_');
        }
        words.push(letter.to_ascii_uppercase());
    }
    words
}

fn list_name(enumeration: &str) -> String {
    let own = LISTS.iter().find(|(of, _)| *of == enumeration).map(|(_, name)| (*name).to_owned());
    own.unwrap_or_else(|| upper(enumeration) + "S")
}

fn dashed(name: &str) -> String {
    name.to_lowercase().replace('_', "-")
}

/// Rows of an array, as many on a line as it holds.
fn rows(opening: &str, rows: &[String]) -> String {
    let mut lines = vec![format!("{opening} = {{")];
    lines.push("   ".into());
    for row in rows {
        let last = lines.last_mut().unwrap();
        if last.len() + row.len() + 2 > 118 {
            lines.push(format!("    {row},"));
        } else {
            *last += &format!(" {row},");
        }
    }
    lines.join("\n").trim_end_matches(',').to_owned() + "};\n"
}

fn choices(opening: &str, members: &[Member]) -> String {
    let name = |member: &Member| {
        let own = NAMES.iter().find(|(of, _)| *of == member.name).map(|(_, name)| (*name).to_owned());
        own.unwrap_or_else(|| dashed(&member.word))
    };
    let mut list: Vec<_> = members.iter().map(|member| format!("{{\"{}\", {}}}", name(member), member.name)).collect();
    list.push("{NULL, 0}".into());
    rows(opening, &list)
}

/// The first sentence of a comment as --help has it: in small letters but for names, and without the default, which
/// it says by itself.
fn about(documentation: &str) -> String {
    let said = sentence(documentation).trim_end_matches('.').replace(" (default)", "").replace('"', "\\\"");
    let is_name = said.chars().nth(1).is_some_and(|second| !second.is_lowercase() && second != ' ');
    let said = if is_name { said } else { said[..1].to_lowercase() + &said[1..] };
    let Some((before, after)) = said.split_once(", default ") else { return said };
    let number = after.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(after.len());
    before.to_owned() + &after[number..]
}

/// A number as C and people write it.
pub fn short(value: f64) -> String {
    let size = value.abs();
    if size != 0.0 && !(1e-3..1e6).contains(&size) { format!("{value:e}") } else { value.to_string() }
}

/// A row of a list: the field's name, its kind, place, unit and range, what it is for, and the names of its values.
fn row(option: &str, kind: &str, place: &str, field: &Value, about: &str, choices: &str) -> String {
    let quoted = |text: Option<String>| text.map_or("NULL".into(), |text| format!("\"{text}\""));
    let range = field["range"].as_array().map(|ends| [0, 1].map(|end| short(ends[end].as_f64().unwrap())));
    let [low, high] = range.clone().unwrap_or(["0".into(), "0".into()]);
    let mut row = format!("    {{\"--{option}\", {kind}, {place}, ");
    let unit = quoted(field["unit"].as_str().map(str::to_owned));
    let in_degrees = |end: f64| short((end.to_degrees() * 100.0).round() / 100.0);
    let range = match field["range"].as_array() {
        // Ends of angles in degrees are rounded, and more than some turns are none to a reader.
        Some(ends) if kind == "OPTION_DEGREES" => {
            let [low, high] = [0, 1].map(|end| ends[end].as_f64().unwrap());
            (high < 100.0).then(|| format!("{} .. {}", in_degrees(low), in_degrees(high)))
        }
        _ => range.map(|[low, high]| format!("{low} .. {high}")),
    };
    let range = quoted(range);
    row += &format!("{unit}, {low}, {high}, {range},\n");
    // A literal for each line that a long sentence needs.
    let mut lines = vec![String::from("     \"")];
    for word in about.split_inclusive(' ') {
        if lines.last().unwrap().len() + word.len() > 116 {
            lines.push("     \"".into());
        }
        *lines.last_mut().unwrap() += word;
    }
    let last = lines.last().unwrap().len();
    row += &lines.join("\"\n");
    row += if last + choices.len() + 5 > 120 { "\",\n     " } else { "\", " };
    row + choices + "},\n"
}

/// The rows of a field. Bits that are clear by default are words of their own; others are a list of the field's.
fn rows_of(json: &Value, object: &str, field: &Value) -> String {
    let (name, base) = (text(&field["name"]), text(&field["base"]));
    let (place, said) = (format!("offsetof({object}, {name})"), about(text(&field["documentation"])));
    let one = |kind: &str, said: &str, choices: &str| row(&dashed(name), kind, &place, field, said, choices);
    if entries(json, "enumerations").iter().any(|entry| entry["name"] == base) {
        let enumeration = entries(json, "enumerations").iter().find(|entry| entry["name"] == base).unwrap();
        return one("OPTION_CHOICE", &about(text(&enumeration["documentation"])), &list_name(base));
    }
    let bits = bits(json, &format!("{object}.{name}"));
    let list = format!("{}_{}", upper(object), name.to_uppercase());
    match (base, field["array"].as_u64()) {
        ("uint32_t", None) if bits.is_empty() => one("OPTION_UINT", &said, "NULL"),
        ("uint32_t", None) if field["default"] != 0 => one("OPTION_BITS", &said, &list),
        ("uint32_t", None) => {
            let word = |(at, bit): (usize, &Member)| {
                let choice = format!("&{list}[{at}]");
                row(&dashed(&bit.word), "OPTION_BIT", &place, field, &about(&bit.about), &choice)
            };
            bits.iter().enumerate().map(word).collect()
        }
        ("uint64_t", None) => one("OPTION_UINT64", &said, "NULL"),
        // Options take degrees: the header's radians and their range would mislead.
        ("double", None) if field["unit"] == "rad" => {
            one("OPTION_DEGREES", said.split(", radians").next().unwrap(), "NULL")
        }
        ("double", None) => one("OPTION_DOUBLE", &said, "NULL"),
        ("double", Some(2)) => one("OPTION_PAIR", &said, "NULL"),
        ("double", Some(3)) => one("OPTION_VECTOR", &said, "NULL"),
        ("double", Some(4)) => one("OPTION_FOUR", &said, "NULL"),
        _ => panic!("options have no kind for {object}.{name}"),
    }
}

pub fn fields_c(json: &Value) -> String {
    let mut code = OPENING.to_owned();
    for enumeration in entries(json, "enumerations").iter().map(|entry| text(&entry["name"])) {
        if !UNCHOSEN.contains(&enumeration) {
            let opening = format!("const Choice {}[]", list_name(enumeration));
            write!(code, "\n{}", choices(&opening, &members(json, enumeration))).unwrap();
        }
    }
    for name in STRUCTS {
        let object = entries(json, "structs").iter().find(|object| object["name"] == name).unwrap();
        let mut list = String::new();
        for field in object["fields"].as_array().unwrap() {
            let member = text(&field["name"]);
            if member == "struct_size" || member.starts_with("reserved") {
                continue;
            }
            let bits = bits(json, &format!("{name}.{member}"));
            if !bits.is_empty() {
                let opening = format!("static const Choice {}_{}[]", upper(name), member.to_uppercase());
                write!(code, "\n{}", choices(&opening, &bits)).unwrap();
            }
            list += &rows_of(json, name, field);
        }
        let end = "    {NULL, OPTION_FLAG, 0, NULL, 0, 0, NULL, NULL, NULL}};\n";
        write!(code, "\nconst Field {}_FIELDS[] = {{\n{list}{end}", upper(name)).unwrap();
    }
    code
}

#[test]
fn the_committed_fields_of_examples_are_the_generated_ones() {
    is_up_to_date("examples-c/fields.c", &fields_c(&committed()));
}
