// SPDX-License-Identifier: MIT OR Apache-2.0
//! The ranges that include/bhr.json has of fields are those of the setters: beyond them a value is refused, with the
//! field's name and both limits in sight, and at them it is taken.

use crate::c_header::output_of;
use crate::json::{committed, entries, text};
use std::fmt::Write;

/// The structs that a scene is set with, and the calls that take one as `&s`.
const SETTERS: [(&str, &str); 7] = [
    ("BhrCamera", "bhr_set_camera(context, &s)"),
    ("BhrDisk", "bhr_set_disk(context, &s)"),
    ("BhrVolume", "bhr_set_volumes(context, &s, sizeof s, 1)"),
    ("BhrHotSpot", "bhr_set_hot_spots(context, &s, sizeof s, 1)"),
    ("BhrSky", "bhr_set_sky(context, &s)"),
    ("BhrFilm", "bhr_set_film(context, &s)"),
    ("BhrQuality", "bhr_set_quality(context, &s)"),
];

/// Limits that other fields narrow, whose defaults are in the way: they are not tried.
const NARROWED: [&str; 8] = [
    "BhrDisk.inner_radius 1",
    "BhrDisk.outer_radius 0",
    "BhrVolume.inner_radius 1",
    "BhrVolume.outer_radius 0",
    "BhrVolume.radius 1",
    "BhrHotSpot.radius 0",
    "BhrHotSpot.radius 1",
    "BhrCamera.tan_left 1",
];

/// Numbers that the projection, which is none of these by default, leaves alone.
const UNREAD: [&str; 2] = ["BhrCamera.tan_left", "BhrCamera.eye_distance"];

#[test]
fn values_beyond_a_range_are_refused_and_its_ends_are_taken() {
    let json = committed();
    let mut program = String::from(
        "#include <math.h>\n#include <stdio.h>\n#include \"bhr.h\"\nint main(void) {\n\
         BhrContextOptions options; BHR_INIT(options); options.backend = BHR_BACKEND_CPU;\n\
         BhrContext *context; if (bhr_context_create(BHR_ABI_VERSION, &options, &context) < 0) return 1;\n",
    );
    let mut count = 0;
    for (name, setter) in SETTERS {
        let object = entries(&json, "structs").iter().find(|object| object["name"] == name).unwrap();
        for field in object["fields"].as_array().unwrap() {
            let Some(range) = field["range"].as_array() else { continue };
            let place = format!("{name}.{}", text(&field["name"]));
            let ends = [range[0].as_f64().unwrap(), range[1].as_f64().unwrap()];
            assert!(ends[0] < ends[1], "{place}: {ends:?}");
            if UNREAD.contains(&place.as_str()) {
                continue;
            }
            let element = if field["array"].is_null() { "" } else { "[0]" };
            let set = |value: &str| {
                format!(
                    "{{ {name} s; BHR_INIT(s); s.{}{element} = {value}; status = {setter}; }}",
                    text(&field["name"])
                )
            };
            let is_double = field["base"] == "double";
            for (end, way) in ends.iter().zip([-1.0, 1.0]) {
                let beyond = match is_double {
                    true => format!("nextafter({end:?}, {:?})", way * f64::MAX),
                    false if way < 0.0 && *end == 0.0 => continue,
                    false => format!("{}u", (end + way) as u32),
                };
                let which = format!("{place} {}", u8::from(way > 0.0));
                // 0 may stand for a default below the range.
                let beyond = if way < 0.0 && is_double && *end > 0.0 { format!("{end:?} / 2") } else { beyond };
                let at = if is_double { format!("{end:?}") } else { format!("{}u", *end as u32) };
                let taken = if NARROWED.contains(&which.as_str()) {
                    String::new()
                } else {
                    format!(
                        "{} if (status < 0) printf(\"{which}: {end} is refused: %s\\n\", bhr_error_message());\n",
                        set(&at)
                    )
                };
                writeln!(
                    program,
                    "{{ BhrStatus status;\n{} if (status >= 0) printf(\"{which}: beyond {end} is taken\\n\");\n\
                     {taken} }}",
                    set(&beyond)
                )
                .unwrap();
                count += 1;
            }
        }
    }
    let said = output_of("ranges", &(program + "bhr_context_destroy(context); return 0; }\n"));
    assert!(said.is_empty(), "{said}");
    assert!(count > 60, "only {count} ends of ranges were tried");
}
