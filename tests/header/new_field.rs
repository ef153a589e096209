// SPDX-License-Identifier: MIT OR Apache-2.0
//! A field that include/bhr.json gains is in everything that is made from it, without a line of anybody's.

use crate::json::{committed, text};
use crate::{bindings, example_fields, field_list, python_structs, typescript};
use serde_json::json;

#[test]
fn a_new_field_is_in_every_list() {
    for (name, list) in [("BhrFilm", "FILM"), ("BhrDisk", "DISK"), ("BhrVolume", "VOLUME")] {
        let mut json = committed();
        let objects = json["structs"].as_array_mut().unwrap();
        let object = objects.iter_mut().find(|object| object["name"] == name).unwrap();
        object["fields"].as_array_mut().unwrap().push(json!({
            "name": "sparkle_size", "type": "double", "base": "double", "pointers": 0, "const": false,
            "unit": "M", "range": [0.5, 40.0], "default": 2.5, "documentation": "Sparks, 0.5 .. 40. Default 2.5.",
        }));
        let class = text(&object["name"]).replacen("Bhr", "", 1);
        // The text from where a struct begins, up to the end that its language gives it.
        let part = |whole: &str, begin: &str, end: &str| {
            whole.split_once(begin).unwrap_or_else(|| panic!("no {begin}")).1.split(end).next().unwrap().to_owned()
        };
        let python = part(&python_structs::fields_py(&json), &format!("\nclass {class}("), "\n\n\n");
        assert!(python.contains("    #: Sparks, 0.5 .. 40. Default 2.5.\n    sparkle_size: float = 2.5"), "{python}");
        let c = part(&example_fields::fields_c(&json), &format!("\nconst Field {list}_FIELDS[]"), "}};");
        let row = format!(
            "{{\"--sparkle-size\", OPTION_DOUBLE, offsetof({name}, sparkle_size), \"M\", 0.5, 40, \"0.5 .. 40\""
        );
        assert!(c.contains(&row) && c.contains("\"sparks, 0.5 .. 40\", NULL}"), "{c}");
        let (scene, _) = typescript::files(&json);
        let types = part(&scene, &format!("export interface {class} {{"), "\n}");
        assert!(
            types.contains("@range 0.5 .. 40 M\n     * @default 2.5\n     */\n    sparkle_size: number;"),
            "{types}"
        );
        let cpp = part(&bindings::structs_hpp(&json), &format!("\nstruct {class} {{"), "};");
        assert!(cpp.contains("    double sparkle_size;\n"), "{cpp}");
        let rust = part(&field_list::generate(&json), &format!("impl Described for {name} "), "];");
        assert!(rust.contains("name: \"sparkle_size\""), "{rust}");
    }
}
