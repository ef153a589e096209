// SPDX-License-Identifier: MIT OR Apache-2.0
//! src/capi/field_list.rs has the fields of the structs that say what a scene is, as include/bhr.json has them: scene
//! files and the attributes of saved outputs know a field as soon as its struct has it.

use crate::bindings::{Member, bits, is_up_to_date, members};
use crate::c_header::{root, run};
use crate::json::{committed, entries, text};
use serde_json::Value;
use std::fmt::Write;
use std::process::Command;

/// The structs, with the file of src/capi that has each.
const STRUCTS: [(&str, &str); 8] = [
    ("BhrCamera", "camera"),
    ("BhrDisk", "disk"),
    ("BhrVolume", "volume"),
    ("BhrHotSpot", "volume"),
    ("BhrSky", "sky"),
    ("BhrFilm", "film"),
    ("BhrQuality", "quality"),
    ("BhrRegion", "region"),
];

/// Enumerations and bits that no field of these has.
const WORDS: [(&str, &str); 3] =
    [("VIEWS", "BhrView"), ("PRESETS", "BhrPreset"), ("PRESET_MATTERS", "BhrPresetMatter")];

const OPENING: &str = "// SPDX-License-Identifier: MIT OR Apache-2.0
//! The fields of structs of the API that say what a scene is, and the words of its constants. Made by
//! tests/header/field_list.rs from include/bhr.json; do not edit.

";

/// Words with their values, as a list of Rust.
fn words(members: &[Member]) -> String {
    let word = |member: &Member| format!("(\"{}\", {})", member.word.to_lowercase(), member.value);
    format!("&[{}]", members.iter().map(word).collect::<Vec<_>>().join(", "))
}

fn kind(json: &Value, object: &str, field: &Value) -> String {
    let is_angle = text(&field["documentation"]).to_lowercase().contains("radians");
    match text(&field["base"]) {
        "double" if is_angle => "Kind::Angle".into(),
        "double" => format!("Kind::Numbers({})", field["array"].as_u64().unwrap_or(1)),
        "uint64_t" => "Kind::Seed".into(),
        "uint32_t" => match &bits(json, &format!("{object}.{}", text(&field["name"])))[..] {
            [] => "Kind::Count".into(),
            bits => format!("Kind::Bits({})", words(bits)),
        },
        enumeration => format!("Kind::Word({})", words(&members(json, enumeration))),
    }
}

pub fn generate(json: &Value) -> String {
    let mut file = OPENING.to_owned();
    let mut uses = STRUCTS.map(|(name, module)| format!("use super::{module}::{name};")).to_vec();
    uses.push("use super::fields::{Described, Field, Kind, Words};".into());
    uses.push("use std::mem::offset_of;".into());
    file += &uses.join("\n");
    for (constant, enumeration) in WORDS {
        let words = words(&members(json, enumeration));
        write!(file, "\n\n/// The words of {enumeration}.\npub(super) const {constant}: Words<i32> = {words};")
            .unwrap();
    }
    let effects = words(&bits(json, "bhr_set_effects.effects"));
    write!(file, "\n\n/// The words of BHR_EFFECT_*.\npub(super) const EFFECTS: Words<u32> = {effects};").unwrap();
    for (name, _) in STRUCTS {
        write!(
            file,
            "\n\n// SAFETY: repr(C), without padding, numbers only, as for Versioned.\n\
             unsafe impl Described for {name} {{ const FIELDS: &'static [Field] = &["
        )
        .unwrap();
        let object = entries(json, "structs").iter().find(|object| object["name"] == name).unwrap();
        for field in object["fields"].as_array().unwrap() {
            let member = text(&field["name"]);
            if member != "struct_size" && !member.starts_with("reserved") {
                let kind = kind(json, name, field);
                write!(file, "Field {{ name: \"{member}\", offset: offset_of!({name}, {member}), kind: {kind} }},")
                    .unwrap();
            }
        }
        file += "]; }";
    }
    file + "\n"
}

#[test]
fn the_committed_field_list_is_the_generated_one() {
    let file = crate::c_header::scratch("field_list").join("field_list.rs");
    std::fs::write(&file, generate(&committed())).unwrap();
    run(Command::new("rustfmt").args(["--edition", "2024", "--config-path"]).arg(root()).arg(&file));
    is_up_to_date("src/capi/field_list.rs", &std::fs::read_to_string(&file).unwrap());
}
