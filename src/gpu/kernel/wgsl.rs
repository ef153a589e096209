// SPDX-License-Identifier: MIT OR Apache-2.0
//! The WGSL of every kernel: which fragments of shaders/ make it, for which choices. Knows neither bindings nor
//! devices.

use super::fragments::{join, join_with};
use super::variant::{DevelopedLight, OutputPlace, OutputPlaces, PixelTarget, RecordMaker, StoredFormat};
use crate::error::Result;
use crate::scene::{RayOutput, RayOutputKind};

impl RecordMaker {
    /// The fragment that makes the records of pixels.
    fn fragment(self) -> &'static str {
        match self {
            Self::Traced => "traced/record",
            Self::Schwarzschild => "lens/schwarzschild_record",
            Self::Kerr => "lens/kerr_pixel",
            Self::KerrDeferred => "lens/kerr_deferred",
        }
    }

    /// The fragment that makes the records of the samples that refine/refine.wgsl takes of a pixel.
    fn sample_fragment(self) -> &'static str {
        match self {
            Self::Traced => "refine/traced",
            Self::Schwarzschild => "lens/schwarzschild_record",
            Self::Kerr | Self::KerrDeferred => "refine/kerr",
        }
    }

    /// The kernel that goes over the pixels: its entry point and its fragment.
    pub(in crate::gpu) fn driver(self, target: Option<PixelTarget>) -> (&'static str, &'static str) {
        match (self, target) {
            (Self::KerrDeferred, _) => ("each_deferred", "lens/each_deferred"),
            (_, Some(PixelTarget::Rows)) => ("each_pixel", "film/each_pixel_rows"),
            _ => ("each_pixel", "records/each_pixel"),
        }
    }
}

impl PixelTarget {
    /// The fragment that writes pixels there.
    fn fragment(self) -> &'static str {
        match self {
            Self::Image(StoredFormat::Rgba8) => "film/screen",
            Self::Image(StoredFormat::Rgba16F) => "film/image_rgba16f",
            Self::Image(StoredFormat::Rgba32F) => "film/image_rgba32f",
            Self::Image(StoredFormat::R32F) => "film/image_r32f",
            Self::Packed => "film/packed",
            Self::Rows => "film/packed_rows",
            Self::Light => "film/light",
        }
    }
}

pub fn shade_sample(maker: RecordMaker) -> Result<String> {
    join(&[maker.driver(None).1, maker.fragment(), "shade/record", "shade/sample"])
}

pub fn shade_only(maker: RecordMaker, target: PixelTarget) -> Result<String> {
    let (_, driver) = maker.driver(Some(target));
    join(&[driver, maker.fragment(), "shade/record", "shade/only", target.fragment()])
}

/// `target`: of pixels with one sample.
pub fn refine(maker: RecordMaker, target: Option<PixelTarget>) -> Result<String> {
    let samples = maker.sample_fragment();
    match target {
        Some(target) => join(&["refine/refine", samples, "shade/only", target.fragment()]),
        None => join(&["refine/refine", samples, "shade/sample"]),
    }
}

pub fn export(maker: RecordMaker) -> Result<String> {
    join(&[maker.driver(None).1, maker.fragment(), "records/export"])
}

pub fn sky_level(in_parts: bool) -> Result<String> {
    join(&["sky/pyramid", if in_parts { "sky/source_parts" } else { "sky/source_whole" }])
}

pub fn outputs(maker: RecordMaker, places: OutputPlaces) -> Result<String> {
    let roots = [maker.driver(None).1, maker.fragment(), "shade/outputs"];
    if places == OutputPlaces::default() {
        return join(&[&roots[..], &["shade/packed_outputs"]].concat());
    }
    join_with(&roots, ("the outputs' targets", wanted_outputs(places) + &put_numbers(places)))
}

/// The functions of shade/packed_outputs.wgsl that say which outputs are wanted, for these. With them as constants a
/// kernel for DEPTH and SKY takes three quarters of the time (H200).
fn wanted_outputs(places: OutputPlaces) -> String {
    let wanted = places.iter().flatten().map(|(wanted, _)| wanted);
    let cases = wanted.clone().zip(0..).map(|(wanted, k)| {
        let RayOutput { kind, index } = wanted;
        format!("        case {k}u: {{ return vec4<u32>({}u, {index}u, {}u, 0u); }}\n", *kind as u32, wanted.words())
    });
    let head = "fn wanted_output(k: u32) -> vec4<u32> {\n    switch k {\n";
    let end = "        default: { return vec4<u32>(0u); }\n    }\n}\n";
    let count = format!("fn output_count() -> u32 {{\n    return {}u;\n}}\n", wanted.clone().count());
    // Without a constant 0 or 1 the loop over crossings stays one.
    let most = wanted.map(|output| output.crossings()).max().unwrap_or(0);
    let crossings = if most <= 1 { format!("{most}u") } else { "not_inlined(outputs.crossings)".to_owned() };
    let crossings = format!("fn output_crossings() -> u32 {{\n    return {crossings};\n}}\n");
    [head, &cases.collect::<String>(), end, &count, &crossings].concat()
}

/// `put_numbers` of shade/packed_outputs.wgsl for targets, each with a binding of its own. It is written here because
/// the format of an image that is stored to is no constant that a pipeline could set.
fn put_numbers(places: OutputPlaces) -> String {
    let (mut bindings, mut cases) = (String::new(), String::new());
    for (k, (_, place)) in places.iter().flatten().enumerate() {
        let (name, binding) = (format!("output_{k}"), k + 1);
        let declared = match place {
            OutputPlace::Number | OutputPlace::Numbers => format!("var<storage, read_write> {name}: array<u32>"),
            OutputPlace::AlignedNumbers => format!("var<storage, read_write> {name}: array<vec4<u32>>"),
            OutputPlace::NumberImage => format!("var {name}: texture_storage_2d<r32float, write>"),
            OutputPlace::NumbersImage => format!("var {name}: texture_storage_2d<rgba32float, write>"),
        };
        let put = match place {
            OutputPlace::Number => format!("{name}[at] = bits.x;"),
            OutputPlace::Numbers => format!(
                "{name}[at] = bits.x; {name}[at + 1u] = bits.y; {name}[at + 2u] = bits.z; {name}[at + 3u] = bits.w;"
            ),
            OutputPlace::AlignedNumbers => format!("{name}[at >> 2u] = bits;"),
            OutputPlace::NumberImage => {
                format!("textureStore({name}, place, vec4<f32>(bitcast<f32>(bits.x), 0.0, 0.0, 1.0));")
            }
            OutputPlace::NumbersImage => format!("textureStore({name}, place, bitcast<vec4<f32>>(bits));"),
        };
        bindings += &format!("@group(2) @binding({binding}) {declared};\n");
        cases += &format!("        case {k}u: {{ {put} }}\n");
    }
    let head = "fn put_numbers(k: u32, at: u32, place: vec2<u32>, bits: vec4<u32>) {\n    switch k {\n";
    format!("{bindings}\n{head}{cases}        default: {{ }}\n    }}\n}}\n")
}

pub fn develop(target: PixelTarget, light: DevelopedLight) -> Result<String> {
    let driver = match target {
        PixelTarget::Image(_) | PixelTarget::Packed | PixelTarget::Light => "film/develop",
        PixelTarget::Rows => "film/develop_rows",
    };
    let light: &[_] = match light {
        DevelopedLight::Summed => &["film/summed"],
        DevelopedLight::Glare => &["bloom/glare", "metering/none"],
        DevelopedLight::Metered => &["bloom/glare", "metering/metered"],
    };
    join(&[&[driver], light, &[target.fragment()]].concat())
}

/// A kernel of one fragment and what that imports.
pub fn kernel(fragment: &str) -> Result<String> {
    join(&[fragment])
}

/// Every shader of this tracer, joined as the device gets it: name and WGSL. Errors: as `join`.
pub fn shader_sources() -> Result<Vec<(&'static str, String)>> {
    use RecordMaker::{Kerr, KerrDeferred, Schwarzschild, Traced};
    let sources = [
        ["shade sample, traced", "shade only, traced", "export, traced", "outputs, traced"],
        ["shade sample, spin-0 lens", "shade only, spin-0 lens", "export, spin-0 lens", "outputs, spin-0 lens"],
        ["shade sample, Kerr lens", "shade only, Kerr lens", "export, Kerr lens", "outputs, Kerr lens"],
        ["shade sample, Kerr deferred", "shade only, Kerr deferred", "export, Kerr deferred", "outputs, Kerr deferred"],
    ]
    .into_iter()
    .zip([Traced, Schwarzschild, Kerr, KerrDeferred]);
    let of_sources = sources.flat_map(|([in_sum, alone, exported, outputs_of], source)| {
        [
            (in_sum, shade_sample(source)),
            (alone, shade_only(source, PixelTarget::Packed)),
            (exported, export(source)),
            (outputs_of, outputs(source, OutputPlaces::default())),
        ]
    });
    use OutputPlace::{AlignedNumbers, Number, NumberImage, Numbers, NumbersImage};
    use RayOutputKind::{Depth, Disk, Order, Position, Sky};
    let all = [(Depth, Number), (Sky, NumbersImage), (Position, Numbers), (Order, NumberImage), (Disk, AlignedNumbers)];
    let mut targets = OutputPlaces::default();
    let all = all.map(|(kind, place)| (RayOutput { kind, index: 0 }, place));
    targets.iter_mut().zip(all).for_each(|(to, place)| *to = Some(place));
    let others = [
        ("rays", kernel("geodesic/rays")),
        ("pixels", kernel("traced/each")),
        ("blocks", kernel("traced/blocks")),
        ("listed pixels", kernel("traced/listed")),
        ("media from blocks", kernel("traced/fill")),
        ("count", kernel("traced/count")),
        ("present", kernel("window/present")),
        ("develop", develop(PixelTarget::Packed, DevelopedLight::Summed)),
        ("develop for a window", develop(PixelTarget::SCREEN, DevelopedLight::Summed)),
        ("develop for an image of RGBA16F", develop(PixelTarget::Image(StoredFormat::Rgba16F), DevelopedLight::Summed)),
        ("develop for an image of RGBA32F", develop(PixelTarget::Image(StoredFormat::Rgba32F), DevelopedLight::Summed)),
        ("develop for an image of R32F", develop(PixelTarget::Image(StoredFormat::R32F), DevelopedLight::Summed)),
        ("develop by rows", develop(PixelTarget::Rows, DevelopedLight::Summed)),
        ("develop for bloom", develop(PixelTarget::Light, DevelopedLight::Summed)),
        ("develop with glare", develop(PixelTarget::Packed, DevelopedLight::Glare)),
        ("develop with glare for a window", develop(PixelTarget::SCREEN, DevelopedLight::Glare)),
        ("develop with glare by rows", develop(PixelTarget::Rows, DevelopedLight::Glare)),
        ("develop metered light", develop(PixelTarget::Packed, DevelopedLight::Metered)),
        ("metering, measure", kernel("metering/measure")),
        ("metering, expose", kernel("metering/expose")),
        ("metering, smooth", kernel("metering/smooth")),
        ("bloom, gather", kernel("bloom/gather")),
        ("bloom, gather pixels", kernel("bloom/base")),
        ("bloom, upsample", kernel("bloom/upsample")),
        ("bloom, beam", kernel("bloom/beam")),
        ("bloom, reflected", kernel("bloom/reflected")),
        ("bloom, ghosts", kernel("bloom/ghosts")),
        ("bloom, ghosted", kernel("bloom/ghosted")),
        ("bloom, spikes", kernel("bloom/spikes")),
        ("bloom, spiked", kernel("bloom/spiked")),
        ("sky map, level", sky_level(false)),
        ("sky map, level from parts", sky_level(true)),
        ("the host's distances", kernel("emit/occluder_rows")),
        ("structure of matter", kernel("emit/bake")),
        ("shade only for bloom", shade_only(Kerr, PixelTarget::Light)),
        ("refine, traced", refine(Traced, Some(PixelTarget::Packed))),
        ("refine, spin-0 lens", refine(Schwarzschild, Some(PixelTarget::Packed))),
        ("refine, Kerr lens", refine(KerrDeferred, Some(PixelTarget::Packed))),
        ("refine for a window", refine(KerrDeferred, Some(PixelTarget::SCREEN))),
        ("refine one of several samples", refine(KerrDeferred, None)),
        ("shade only for a window", shade_only(Kerr, PixelTarget::SCREEN)),
        ("shade only by rows", shade_only(Kerr, PixelTarget::Rows)),
        ("spin-0 lens, ends", kernel("lens/schwarzschild_ends")),
        ("spin-0 lens, columns", kernel("lens/schwarzschild_columns")),
        ("outputs into targets", outputs(Traced, targets)),
        ("Kerr lens, nodes", kernel("lens/kerr_nodes")),
        ("Kerr lens, flags", kernel("lens/kerr_flags")),
    ];
    others.into_iter().chain(of_sources).map(|(name, source)| Ok((name, source?))).collect()
}
