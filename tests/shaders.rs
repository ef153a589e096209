//! Translates every shader of the GPU tracer into the languages of Vulkan, Metal, D3D12 and GL, as wgpu does when
//! it makes a pipeline, so that an interface which nobody here can run is no surprise. Needs no adapter.

use naga::back::{glsl, hlsl, msl, pipeline_constants::process_overrides, spv};
use naga::proc::BoundsCheckPolicies;
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{Module, ShaderStage};
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
        let at = |what: &str, error: &dyn Error| format!("{shader}, {} to {what}: {error}", point.name);
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
        @compute @workgroup_size(size) fn main(@builtin(global_invocation_id) id: vec3<u32>) { data[id.x] = f32(size); }";
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
