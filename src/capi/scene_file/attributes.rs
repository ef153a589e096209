// SPDX-License-Identifier: MIT OR Apache-2.0
//! Every parameter of a scene by name, for files of pixels that say how they were made: the fields of the API's
//! structs, `bhr.disk.outer_radius`, words as in the constants, each bit of flags by its own name.

use super::values::{Section, Values};
use crate::capi::fields::{Kind, Value, word_of};
use crate::image::Attribute;
use crate::scene::Made;

/// All of them, in order.
pub fn parameters(made: &Made) -> Vec<(String, Attribute)> {
    let values = Values::of(made.scene(), Some(made.region()));
    let mut list = Vec::new();
    for section in values.sections() {
        let of = match section {
            Section::Moment => "bhr".to_owned(),
            Section::Hole => "bhr.hole".into(),
            Section::Camera(_) => "bhr.camera".into(),
            // A scene's camera is where it is; these belong to texts.
            Section::Orbit(_) | Section::Path(_) | Section::Aim(_) | Section::Turn(_) => continue,
            Section::Disk => "bhr.disk".into(),
            Section::Volume(i) => format!("bhr.volume{i}"),
            Section::HotSpot(i) => format!("bhr.hot_spot{i}"),
            Section::Sky => "bhr.sky".into(),
            Section::Film => "bhr.film".into(),
            Section::Quality => "bhr.quality".into(),
            Section::Region => "bhr.region".into(),
            Section::Render => "bhr.render".into(),
        };
        let Some(bytes) = values.bytes(section) else { continue };
        for field in section.fields() {
            let name = format!("{of}.{}", field.name);
            match (field.kind, field.get(bytes)) {
                (Kind::Bits(words), Value::Bits(bits)) => {
                    list.push((name, Attribute::Number(bits.into())));
                    for (word, bit) in words.iter().filter(|(_, bit)| bit.is_power_of_two()) {
                        let is_set = f64::from(u8::from(bits & bit != 0));
                        list.push((format!("{of}.{word}"), Attribute::Number(is_set)));
                    }
                }
                (Kind::Word(words), Value::Word(number)) => {
                    let word = word_of(number, words).map_or_else(|| number.to_string(), str::to_uppercase);
                    list.push((name, Attribute::Text(word)));
                }
                (_, Value::Numbers(numbers)) if numbers.len() == 1 => {
                    list.push((name, Attribute::Number(numbers.first().copied().unwrap_or_default())));
                }
                (_, Value::Numbers(numbers)) => {
                    let parts = numbers.iter().map(f64::to_string).collect::<Vec<_>>();
                    list.push((name, Attribute::Text(parts.join(" "))));
                }
                (_, Value::Count(number) | Value::Bits(number)) => list.push((name, Attribute::Number(number.into()))),
                (_, Value::Seed(number)) => list.push((name, Attribute::Text(number.to_string()))),
                (_, Value::Word(number)) => list.push((name, Attribute::Number(number.into()))),
            }
        }
    }
    if values.disk.is_none() {
        list.push(("bhr.disk".into(), Attribute::Text("NONE".into())));
    }
    for (name, is_there) in [("bhr.sky.has_map", made.has_map()), ("bhr.film.has_lut", made.has_lut())] {
        list.push((name.into(), Attribute::Number(f64::from(u8::from(is_there)))));
    }
    list
}
