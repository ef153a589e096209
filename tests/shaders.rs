// SPDX-License-Identifier: MIT OR Apache-2.0
//! Translates every shader of the GPU tracer into the languages of Vulkan, Metal, D3D12 and GL, as wgpu does when
//! it makes a pipeline, so that an interface which nobody here can run is no surprise; and holds every loop against a
//! list that says why it ends. Needs no adapter.

use naga::back::{glsl, hlsl, msl, pipeline_constants::process_overrides, spv};
use naga::proc::BoundsCheckPolicies;
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{Block, Module, ShaderStage, Statement};
use std::collections::BTreeSet;
use std::error::Error;

/// One entry point, its overrides at their defaults.
struct Entry<'a> {
    module: &'a Module,
    info: &'a ModuleInfo,
    stage: ShaderStage,
    name: &'a str,
}

type Translation = Result<String, Box<dyn Error>>;
type Translator = fn(&Entry<'_>) -> Translation;

/// The oldest dialects that wgpu uses.
const LANGUAGES: [(&str, Translator); 6] = [
    ("SPIR-V 1.0", to_spirv),
    ("MSL 2.0", to_msl),
    ("HLSL 5.1", |entry| to_hlsl(entry, hlsl::ShaderModel::V5_1)),
    ("HLSL 6.0", |entry| to_hlsl(entry, hlsl::ShaderModel::V6_0)),
    ("GLSL ES 3.10", |entry| to_glsl(entry, glsl::Version::new_gles(310))),
    ("GLSL 4.30", |entry| to_glsl(entry, glsl::Version::Desktop(430))),
];

fn to_spirv(entry: &Entry<'_>) -> Translation {
    let pipeline = spv::PipelineOptions { shader_stage: entry.stage, entry_point: entry.name.into() };
    let words = spv::write_vec(entry.module, entry.info, &spv::Options::default(), Some(&pipeline))?;
    Ok(format!("{words:x?}"))
}

fn to_msl(entry: &Entry<'_>) -> Translation {
    let options = msl::Options { lang_version: (2, 0), ..Default::default() };
    let pipeline = msl::PipelineOptions { entry_point: Some((entry.stage, entry.name.into())), ..Default::default() };
    let (text, names) = msl::write_string(entry.module, entry.info, &options, &pipeline)?;
    names.entry_point_names.into_iter().collect::<Result<Vec<_>, _>>()?;
    Ok(text)
}

fn to_hlsl(entry: &Entry<'_>, shader_model: hlsl::ShaderModel) -> Translation {
    let options = hlsl::Options { shader_model, ..Default::default() };
    let pipeline = hlsl::PipelineOptions { entry_point: Some((entry.stage, entry.name.into())) };
    let mut text = String::new();
    let names = hlsl::Writer::new(&mut text, &options, &pipeline).write(entry.module, entry.info, None)?;
    names.entry_point_names.into_iter().collect::<Result<Vec<_>, _>>()?;
    Ok(text)
}

fn to_glsl(entry: &Entry<'_>, version: glsl::Version) -> Translation {
    let options = glsl::Options { version, ..Default::default() };
    let pipeline = glsl::PipelineOptions { shader_stage: entry.stage, entry_point: entry.name.into(), multiview: None };
    let policies = BoundsCheckPolicies::default();
    let mut text = String::new();
    glsl::Writer::new(&mut text, entry.module, entry.info, &options, &pipeline, policies)?.write()?;
    Ok(text)
}

/// Every entry point in every language; the message of the first failure begins with `shader`.
fn translate(shader: &str, source: &str) -> Result<usize, String> {
    let module = naga::front::wgsl::parse_str(source).map_err(|e| format!("{shader}: {}", e.emit_to_string(source)))?;
    // No capability: what every device without optional features accepts.
    let info = Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .map_err(|e| format!("{shader}: {}", e.emit_to_string(source)))?;
    for point in &module.entry_points {
        let at = |what: &str, error: &dyn Error| {
            let (mut message, mut cause) = (format!("{shader}, {} to {what}: {error}", point.name), error.source());
            while let Some(error) = cause {
                message += &format!(": {error}");
                cause = error.source();
            }
            message
        };
        let (module, info) = process_overrides(&module, &info, Some((point.stage, &point.name)), &Default::default())
            .map_err(|error| at("constants", &error))?;
        let entry = Entry { module: &module, info: &info, stage: point.stage, name: &point.name };
        for (language, to) in LANGUAGES {
            let text = to(&entry).map_err(|error| at(language, &*error))?;
            assert!(!text.is_empty(), "{shader}, {} to {language} is empty", point.name);
        }
    }
    Ok(module.entry_points.len())
}

#[test]
fn every_shader_translates_to_every_language() {
    let sources = bhr::gpu::shader_sources().expect("WGSL that can be joined");
    assert!(!sources.is_empty(), "the GPU tracer has shaders");
    for (name, source) in sources {
        match translate(name, &source) {
            Ok(entry_points) => assert!(entry_points > 0, "{name} has no entry point"),
            Err(message) => panic!("{message}"),
        }
    }
}

#[test]
fn a_shader_that_some_language_cannot_say_is_found() {
    let good = "override size: u32 = 8u;
        @group(0) @binding(0) var<storage, read_write> data: array<f32>;
        @compute @workgroup_size(size) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
            data[id.x] = f32(size);
        }";
    assert_eq!(translate("good", good), Ok(1));
    let no_type = good.replace("array<f32>", "array<f23>");
    let no_default = good.replace(" = 8u", "");
    // GLSL ES cannot ask a texture how many levels it has.
    let no_glsl = "@group(0) @binding(0) var image: texture_2d<f32>;
        @group(0) @binding(1) var<storage, read_write> levels: u32;
        @compute @workgroup_size(1) fn main() { levels = textureNumLevels(image); }";
    for (name, source) in [("no type", no_type.as_str()), ("no default", &no_default), ("no GLSL", no_glsl)] {
        match translate(name, source) {
            Ok(_) => panic!("{name} was translated"),
            Err(message) => assert!(message.starts_with(name), "{message}"),
        }
    }
}

/// Why a loop ends after finitely many turns, whatever the input, NaN included.
#[derive(Clone, Copy, Debug)]
#[allow(dead_code, reason = "the text is for whoever reads the list")]
struct Because(&'static str);

const CONSTANT: Because = Because("it counts to a constant of the shader or of its pipeline");
const CROSSINGS: Because = Because("it counts crossings, of which the host allows 16 at most (MAX_DISK_ORDER + 1)");
const ORDERS: Because = Because("it counts crossings that a table holds, of which the host asks for 16 at most");
const SAMPLES: Because = Because("it counts a pixel's samples, of which the host asks for 4 or 32");
const TEXELS: Because = Because("it counts the texels of a row or a column of a sky map, 16384 at most");
const WORDS: Because = Because("it counts the 32-bit words of a pixel, 4 at most");
const OUTPUTS: Because = Because("it counts outputs, of which there are 8 at most (MOST_OUTPUTS)");
const TURBULENCE: Because = Because("it counts bands or generations, 2 at most, or taps, 8 at most");
const PIECES: Because = Because("it counts the pieces of a part of a ray, of which there are 96 at most");
const MATTER: Because = Because("it counts volumes and hot spots, of which there are 12 at most");
const LAYERS: Because = Because("it counts the layers of a piece, of which there are 256 at most");
const CELLS: Because = Because(
    "a turn that goes on leaves `cuts` above 1; every other one adds to `cut` or `cell`: 16 times 256 turns at most",
);
const BLOCK: Because = Because("it counts the cells of a block, of which the host allows 84 along a side");
const ELEMENT: Because = Because("it counts the cells of an element, of which the host allows 4");
const SOURCE: Because = Because("it counts the cells of a grid along one side, of which the host allows 4000");
const LISTED: Because = Because("it counts by 1 or more to the length of a list of pixels, which is below 2^31");
const BITS: Because = Because("it goes over the bits of a word, which loses one in every turn");

/// Every loop: fragment, function, the loop's head, and why it ends. Loops of a function stand in their order.
const LOOPS: &[(&str, &str, &str, Because)] = &[
    ("bloom/beam", "spread_beam", "for (var quarter = 0; quarter < BEAM_QUARTERS; quarter += 1)", CONSTANT),
    ("bloom/gather", "gathered_within", "for (var i = 0u; i < 3u; i += 1u)", CONSTANT),
    ("bloom/gather", "gather", "for (var y = first.y; y < taps.y; y += 1)", CONSTANT),
    ("bloom/gather", "gather", "for (var x = first.x; x < taps.x; x += 1)", CONSTANT),
    ("bloom/ghosts", "inside", "for (var pair = 0u; pair < GHOST_PAIRS; pair += 1u)", CONSTANT),
    ("bloom/ghosts", "ghost_light", "for (var y = cells.y + i32(part); y < cells.w; y += i32(THREADS_A_CELL))", SOURCE),
    ("bloom/ghosts", "ghost_light", "for (var x = cells.x; x < cells.z; x += 4)", SOURCE),
    ("bloom/ghosts", "draw_ghosts", "for (var i = 0u; i < min(flare.count, MOST_GHOSTS); i += 1u)", CONSTANT),
    ("bloom/spikes", "element_light", "for (var j = first; j < end; j += 1u)", ELEMENT),
    ("bloom/spikes", "spread_line", "for (var term = 0u; term < SPIKE_TERMS; term += 1u)", CONSTANT),
    ("bloom/spikes", "spread_line", "for (var away = 1u; away < THREADS && power > LEAST_POWER; away *= 2u)", CONSTANT),
    ("camera/chart", "doran_turn", "for (var i = 0u; i < 12u; i += 1u)", CONSTANT),
    ("camera/chart", "rain_offsets", "for (var i = OFFSET_PAIRS - 1u; i > 0u; i--)", CONSTANT),
    ("emit/bake", "bake_texels", "for (var k = 0u; k < ROW_GENERATIONS; k += 1u)", CONSTANT),
    ("emit/layers", "add_alone", "for (var span = 0u; span < spans && !is_dark(); span += 1u)", LAYERS),
    ("emit/layers", "add_alone", "for (var i = select(0u, 1u, reuses); i < 3u; i += 1u)", CONSTANT),
    ("emit/layers", "add_alone", "for (var block = 0u; block < parts && !is_dark(); block += 1u)", LAYERS),
    ("emit/layers", "add_cells", "while cell < count && !is_dark()", CELLS),
    ("emit/shown_part", "shown_stretch", "for (var i = 0u; i < not_inlined(LIMIT_SECANTS); i += 1u)", CONSTANT),
    ("emit/streaks", "streak_exponents", "for (var i = 0u; i < u32(count); i += 1u)", TURBULENCE),
    ("emit/turbulence", "turbulent_brightness", "for (var k = 0u; k < shown.count; k += 1u)", TURBULENCE),
    ("emit/turbulence", "turbulent_brightness", "for (var old = 0u; old < alive.count; old += 1u)", TURBULENCE),
    ("emit/volumes", "add_part", "for (var k = 1u; k <= count; k += 1u)", PIECES),
    (
        "emit/volumes",
        "cut_of",
        "for (var k = 0u; k < select(not_inlined(frame.matter_count), 1u, ALONE); k += 1u)",
        MATTER,
    ),
    ("emit/volumes", "add_piece", "while cell < count && !is_dark()", CELLS),
    ("emit/volumes", "add_piece", "for (var node = 0u; node < nodes; node += 1u)", CONSTANT),
    ("emit/volumes", "coefficients_at", "for (var k = 0u; k < not_inlined(frame.matter_count); k += 1u)", MATTER),
    ("film/packed_rows", "write_rows", "for (var k = 0u; k < pixel_words(); k += 1u)", WORDS),
    ("geodesic/integrator", "rain_step", "for (var i = 0; i < 3; i++)", CONSTANT),
    ("geodesic/integrator", "quintic_root", "for (var i = 0; i < 4; i++)", CONSTANT),
    ("geodesic/trace", "tau_at_horizon", "for (var i = 0; i < 4; i++)", CONSTANT),
    (
        "geodesic/trace",
        "trace",
        "loop",
        Because("it ends unless the inner loop has taken a step, of which there are max_steps"),
    ),
    (
        "geodesic/trace",
        "trace",
        "while steps < settings.max_steps",
        Because("every turn adds 1 to `steps` before it can `continue`; the host keeps max_steps at 100000 or less"),
    ),
    ("geodesic/trace", "trace", "for (var part = select(1u, 0u, meets); part < 2u; part += 1u)", CONSTANT),
    ("metering/expose", "expose", "for (var reach = 1u; reach < METER_BINS; reach *= 2u)", CONSTANT),
    ("metering/measure", "measure", "for (var bin = thread; bin < METER_BINS; bin += THREADS)", CONSTANT),
    ("metering/measure", "measure", "for (var i = thread; i < meter.side * meter.side; i += THREADS)", BLOCK),
    ("metering/measure", "measure", "for (var bin = thread; bin < METER_BINS; bin += THREADS)", CONSTANT),
    ("metering/smooth", "smooth_blocks", "for (var dy = -2; dy <= 2; dy += 1)", CONSTANT),
    ("metering/smooth", "smooth_blocks", "for (var dx = -2; dx <= 2; dx += 1)", CONSTANT),
    ("lens/kerr_flags", "flag_cells", "for (var order = 0u; order < orders; order += 1u)", ORDERS),
    ("lens/kerr_flags", "flag_cells", "for (var order = 0u; order < orders; order += 4u)", ORDERS),
    ("lens/kerr_flags", "flag_cells", "for (var k = 0u; k < 4u && order + k < orders; k += 1u)", CONSTANT),
    ("lens/kerr_flags", "patch_of", "for (var k = 2u; k < 4u; k += 1u)", CONSTANT),
    ("lens/kerr_flags", "patch_of", "for (var m = 0u; m < 2u; m += 1u)", CONSTANT),
    ("lens/kerr_flags", "patch_of", "for (var i = 0u; i < 6u; i += 1u)", CONSTANT),
    ("lens/kerr_flags", "patch_of", "for (var i = 1u; i < 5u; i += 1u)", CONSTANT),
    ("lens/kerr_flags", "patch_of", "for (var j = 1u; j < 5u; j += 1u)", CONSTANT),
    ("lens/kerr_nodes", "delay_over", "for (var i = 0; i < 3; i++)", CONSTANT),
    ("lens/kerr_nodes", "trace_nodes", "for (var i = 0u; i < steps; i += 1u)", CONSTANT),
    ("lens/kerr_nodes", "trace_nodes", "while found < lens.orders", ORDERS),
    ("lens/kerr_record", "interpolate", "for (var j = 0u; j < 4u; j += 1u)", CONSTANT),
    ("lens/kerr_record", "interpolate", "for (var i = 0u; i < 4u; i += 1u)", CONSTANT),
    ("lens/kerr_record", "next_looked_up", "while orders != 0u && crossing.u <= 0.0", BITS),
    ("lens/kerr_deferred", "next_crossing", "while more_crossings() && crossing.u <= 0.0", CROSSINGS),
    ("lens/kerr_deferred", "ray_record", "for (var i = 0u; i < CROSSINGS_KEPT; i += 1u)", CONSTANT),
    ("lens/schwarzschild_columns", "fill_columns", "for (var j = 0u; j < LENS_INTERVALS; j += 2u)", CONSTANT),
    ("lens/schwarzschild_ends", "find_ends", "for (var i = 0u; i < END_STEPS; i += 1u)", CONSTANT),
    ("lens/schwarzschild_ends", "find_ends", "for (var i = 0u; i < 4u; i += 1u)", CONSTANT),
    ("lens/schwarzschild_record", "column_at", "for (var i = 0u; i < 4u; i += 1u)", CONSTANT),
    ("lens/schwarzschild_record", "next_crossing", "loop", CROSSINGS),
    ("traced/fill", "fill_media", "for (var k = 0u; k < 4u; k += 1u)", CONSTANT),
    ("traced/fill", "fill_quad", "for (var i = 0u; i < 4u; i += 1u)", CONSTANT),
    ("traced/fill", "fill_quad", "for (var k = 0u; k <= countOneBits(key >> 16u) && told != 0u; k += 1u)", CROSSINGS),
    ("traced/fill", "fill_quad", "for (var i = 0u; i < 4u; i += 1u)", CONSTANT),
    ("traced/fill", "fill_quad", "for (var i = 0u; i < 4u; i += 1u)", CONSTANT),
    ("traced/fill", "block_key", "for (var i = 1u; i < 15u; i += 1u)", CONSTANT),
    ("traced/listed", "trace_listed", "for (var i = id.x; i < count; i += groups.x * OWN_GROUP)", LISTED),
    (
        "traced/pixels",
        "keep_nothing_more",
        "for (var k = countOneBits(disk_orders) + 1u; k <= not_inlined(frame.medium_layer); k += 1u)",
        CROSSINGS,
    ),
    ("lens/each_deferred", "each_deferred", "for (var i = id.x; i < count; i += groups.x * DEFERRED_GROUP)", LISTED),
    ("records/export", "take_record", "for (var k = 0u; k < EXPORT_CROSSINGS; k += 1u)", CONSTANT),
    ("refine/integrated", "integrated_record", "for (var i = 0u; i < CROSSINGS_KEPT; i += 1u)", CONSTANT),
    ("refine/integrated", "next_integrated", "while more_integrated() && crossing.u <= 0.0", CROSSINGS),
    (
        "refine/refine",
        "quarters_evenness",
        "for (var k = 0u; k < min(not_inlined(frame.max_crossings), LANE_ORDERS); k += 1u)",
        CONSTANT,
    ),
    ("refine/refine", "quarters_evenness", "for (var s = 0u; s < 4u; s += 1u)", CONSTANT),
    ("refine/refine", "quarters_evenness", "for (var s = 1u; s < 4u; s += 1u)", CONSTANT),
    ("refine/refine", "mean_light", "for (var k = 0u; k < samples; k += 1u)", SAMPLES),
    (
        "refine/refine",
        "refine",
        "for (var first = ends.x + group.x * pixels; first < ends.y; first += groups.x * pixels)",
        LISTED,
    ),
    ("refine/refine", "refine_sample", "for (var k = 0u; k < LANE_ORDERS; k += 1u)", CONSTANT),
    ("refine/refine", "seen_emission", "for (var i = 0u; i < not_inlined(2u); i += 1u)", CONSTANT),
    ("refine/strips", "level_about", "for (var i = 0u; i < 5u; i += 1u)", CONSTANT),
    ("refine/strips", "strips_of", "for (var i = 0u; i < SEARCH_STEPS + 5u; i += 1u)", CONSTANT),
    ("refine/refine", "refine_sample", "for (var k = 0u; k < not_inlined(frame.max_crossings); k += 1u)", CROSSINGS),
    ("shade/outputs", "take_record", "for (var k = 0u; k < output_crossings(); k += 1u)", CROSSINGS),
    ("shade/outputs", "take_record", "for (var i = 0u; i < output_count(); i += 1u)", OUTPUTS),
    ("shade/outputs", "take_record", "for (var i = 0u; i < output_count(); i += 1u)", OUTPUTS),
    (
        "shade/shade",
        "pixel_light",
        "for (var k = 0u; k < select(not_inlined(frame.max_crossings), 1u, OPAQUE); k += 1u)",
        CROSSINGS,
    ),
    ("sky/pyramid", "resampled_light", "for (var i = 0u; i < 4u; i += 1u)", Because("it takes four places")),
    ("sky/pyramid", "column_light", "for (var j = first.y; j < last.y; j += 1u)", TEXELS),
    ("sky/pyramid", "column_light", "for (var i = first.x; i < last.x; i += 1u)", TEXELS),
    ("sky/pyramid", "make_level", "for (var at = begin; at <= end; at += i32(LEVEL_COLUMNS))", TEXELS),
    (
        "sky/pyramid",
        "make_level",
        "for (var half = LEVEL_COLUMNS / 2u; half > 0u; half /= 2u)",
        Because("it halves the columns of a workgroup, 7 times"),
    ),
    ("sky/pyramid", "make_level", "for (var k = from_column; k <= to_column; k += 1)", TEXELS),
    (
        "sky/map",
        "map_light",
        "for (var k = 0u; k < count; k += 1u)",
        Because("it counts a pixel's taps, 129 at most (MOST_SPREAD), on two levels"),
    ),
    (
        "sky/stars",
        "star_light",
        "loop",
        Because("every turn uses up a star of the cell's list or one of two mean skies, or ends the loop"),
    ),
    ("sky/stars", "star_light", "while i < end", Because("it counts the stars of a cell's list, 255 at most")),
    ("traced/count", "count_steps", "for (var x = begin; x < end; x += 1u)", CONSTANT),
];

/// Fragment, function and head of every loop of a block, in their order.
fn loops_of(block: &Block, function: &str, source: &str, found: &mut Vec<(String, String, String)>) {
    for (statement, span) in block.span_iter() {
        match statement {
            Statement::Loop { body, continuing, .. } => {
                let place = span.to_range().expect("a place in the source");
                let (before, here) = source.split_at(place.start);
                let head = here.split('{').next().expect("a head").trim();
                let begin = before
                    .rsplit("// ")
                    .find(|text| text.lines().next().is_some_and(|l| l.ends_with(".wgsl") && !l.contains(' ')));
                let fragment = begin.and_then(|text| text.lines().next()?.strip_suffix(".wgsl")).expect("a fragment");
                found.push((fragment.into(), function.into(), head.into()));
                loops_of(body, function, source, found);
                loops_of(continuing, function, source, found);
            }
            Statement::Block(block) => loops_of(block, function, source, found),
            Statement::If { accept, reject, .. } => {
                loops_of(accept, function, source, found);
                loops_of(reject, function, source, found);
            }
            Statement::Switch { cases, .. } => {
                cases.iter().for_each(|case| loops_of(&case.body, function, source, found));
            }
            _ => (),
        }
    }
}

/// wgpu is told that every loop of the shaders ends (`Loops::Proven` in src/gpu/kernel/kernels.rs): a new loop, or one
/// with another head, goes on the list once somebody knows why it does.
#[test]
fn every_loop_ends_for_a_reason() {
    let mut listed = BTreeSet::new();
    for (shader, source) in bhr::gpu::shader_sources().expect("WGSL that can be joined") {
        let module = naga::front::wgsl::parse_str(&source).expect("WGSL");
        let entries = module.entry_points.iter().map(|entry| &entry.function);
        for function in module.functions.iter().map(|(_, function)| function).chain(entries) {
            let name = function.name.as_deref().expect("a name");
            let mut found = Vec::new();
            loops_of(&function.body, name, &source, &mut found);
            let Some((fragment, ..)) = found.first() else { continue };
            let known = LOOPS.iter().filter(|(file, of, ..)| file == fragment && *of == name);
            let known = known.map(|(file, of, head, _)| (file.to_string(), of.to_string(), head.to_string()));
            assert_eq!(found, known.collect::<Vec<_>>(), "{shader}");
            listed.insert((fragment.clone(), name.to_string()));
        }
    }
    let gone = LOOPS.iter().find(|(file, of, ..)| !listed.contains(&(file.to_string(), of.to_string())));
    assert!(gone.is_none(), "a loop that no shader has: {gone:?}");
}
