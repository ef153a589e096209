// SPDX-License-Identifier: MIT OR Apache-2.0
//! Every kernel of the tracer by what decides how it is compiled: its entry point, WGSL, constants and bindings. Knows
//! neither devices nor pipelines; two equal keys are the same kernel.

use super::choices::{Choice, Values, Variant, readers};
use super::sizes::{LEVEL_COLUMNS, SKY_PARTS};
use super::slots::{
    LENS_COLUMNS, LENS_FLAGS, LENS_ROWS, LIGHT, METER_BLOCKS, OCCLUDER, RADIANCE, Slot, TABLES, TRACED, bake_slots,
    edge_slots, output_slots, pixel_slots, refine_slots, sample_slots, shade_slots, sum_slots,
};
use super::variant::{
    DevelopedLight, FilmVariant, GROUP, OutputPlaces, PixelTarget, RecordMaker, RecordSource, ShadeVariant,
    StoredFormat, TRACE_GROUP, TraceVariant,
};
use super::wgsl;
use crate::error::Result;

/// The kinds of kernels, each with WGSL, an entry point and bindings of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum KernelKind {
    Pixels,
    /// The blocks of half resolution, the pixels that they do not tell, and what fills the others in.
    Blocks,
    Listed,
    Fill,
    Rays,
    Count,
    ShadeSample(RecordMaker),
    ShadeOnly(RecordMaker, PixelTarget),
    /// `None`: adds to a sum of samples.
    Refine(RecordMaker, Option<PixelTarget>),
    Develop(PixelTarget, DevelopedLight),
    Gather,
    GatherBase,
    Upsample,
    Beam,
    /// Lens flare: finds the light that reaches ghosts, draws them, adds them to the finest grid's light.
    ReflectLight,
    DrawGhosts,
    AddGhosts,
    /// Spikes: spreads light along a line, adds it to the finest grid's.
    SpreadLine,
    AddLine,
    /// Metering: counts the cells of the finest grid, finds the exposure, smooths the counts.
    Measure,
    Expose,
    Smooth,
    /// A level of the pyramid of a sky map that lies in a target; whether what it is made from is bound in parts.
    SkyLevel(bool),
    /// The distances of a target whose rows no copy takes.
    OccluderRows,
    /// A level of the structure of matter with depth.
    Bake,
    Export(RecordMaker),
    Outputs(RecordMaker, OutputPlaces),
    SchwarzschildEnds,
    SchwarzschildColumns,
    KerrNodes,
    KerrFlags,
}

/// A kernel: its kind, and the choices that it is compiled with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct KernelKey {
    pub kind: KernelKind,
    values: Values,
}

/// Kernels without a choice.
impl From<KernelKind> for KernelKey {
    fn from(kind: KernelKind) -> Self {
        Self::new(kind, &[])
    }
}

impl KernelKey {
    /// The kernel of a kind for `variants`, of which later ones count first.
    pub fn new(kind: KernelKind, variants: &[&dyn Variant]) -> Self {
        Self { kind, values: Values::of(kind.readers(), variants) }
    }

    /// Group 3, the list of pixels with edges, is for the caller to set.
    pub fn shade_sample(source: RecordSource, shade: ShadeVariant) -> Self {
        Self::new(KernelKind::ShadeSample(source.maker), &[&source, &shade])
    }

    /// Groups 2, which writes the pixels, and 3, the list of those with edges, are for the caller to set.
    pub fn shade_only(source: RecordSource, shade: ShadeVariant, film: FilmVariant) -> Self {
        Self::new(KernelKind::ShadeOnly(source.maker, film.over(source).target), &[&source, &shade, &film])
    }

    /// Groups 2 and 3 as `shade_only`, or, without `film`, `shade_sample`. `trace`: how rays are traced that no table
    /// holds.
    pub fn refine(
        (source, trace): (RecordSource, TraceVariant),
        shade: ShadeVariant,
        film: Option<FilmVariant>,
    ) -> Self {
        let kind = KernelKind::Refine(source.maker, film.map(|film| film.scattered().target));
        let film = film.as_ref().map(|film| film as &dyn Variant);
        let variants: [&dyn Variant; 3] = [&trace, &source, &shade];
        Self::new(kind, &variants.into_iter().chain(film).collect::<Vec<_>>())
    }

    /// A sum of samples.
    pub fn develop(film: FilmVariant) -> Self {
        Self::new(KernelKind::Develop(film.target, DevelopedLight::Summed), &[&film])
    }

    /// Light that has spread over cells of `step` pixels along a side. `local`: it has been measured, and whether its
    /// surroundings then change it.
    pub fn develop_spread(film: FilmVariant, step: u32, local: Option<bool>) -> Self {
        let light = if local.is_some() { DevelopedLight::Metered } else { DevelopedLight::Glare };
        let choices = [(Choice::STEP, step), (Choice::LOCAL, local.unwrap_or(false).into())];
        Self::new(KernelKind::Develop(film.target, light), &[&film, &choices])
    }

    /// `step`: finer cells, or pixels, along a cell's side; `grid`: whether they are cells.
    pub fn gather(step: u32, grid: bool) -> Self {
        Self::new(KernelKind::Gather, &[&[(Choice::STEP, step), (Choice::GRID, grid.into())]])
    }

    pub fn export(source: RecordSource, shade: ShadeVariant) -> Self {
        Self::new(KernelKind::Export(source.maker), &[&source, &shade])
    }

    /// With targets for `places`, group 2 is for the caller to set.
    pub fn outputs(source: RecordSource, shade: ShadeVariant, places: OutputPlaces) -> Self {
        Self::new(KernelKind::Outputs(source.maker, places), &[&source, &shade])
    }

    /// Values of the `override` constants of the kernel's source.
    pub fn constants(self) -> Vec<(&'static str, f64)> {
        self.values.constants().collect()
    }
}

impl KernelKind {
    /// The kind's bits in the table of choices.
    pub fn readers(self) -> u32 {
        use readers::*;
        match self {
            Self::Pixels | Self::Blocks => PIXELS,
            Self::Listed => PIXELS | LISTED,
            Self::Fill => FILL,
            Self::Rays => RAYS,
            Self::ShadeSample(maker) => SHADE & maker.readers(),
            Self::ShadeOnly(maker, target) => SHADE & maker.readers() | target.readers(),
            Self::Refine(maker, target) => REFINE & maker.readers() | target.map_or(0, PixelTarget::readers),
            Self::Develop(target, DevelopedLight::Summed) => target.readers(),
            Self::Develop(target, DevelopedLight::Glare) => target.readers() | GLARE,
            Self::Develop(target, DevelopedLight::Metered) => target.readers() | GLARE | METERED,
            Self::Gather => GATHER,
            Self::Export(maker) => EXPORT & maker.readers(),
            Self::Outputs(maker, _) => OUTPUTS & maker.readers(),
            Self::SchwarzschildEnds => ENDS,
            Self::SchwarzschildColumns => COLUMNS,
            Self::KerrNodes => NODES,
            Self::KerrFlags => FLAGS,
            Self::Count
            | Self::GatherBase
            | Self::Upsample
            | Self::Beam
            | Self::ReflectLight
            | Self::DrawGhosts
            | Self::AddGhosts
            | Self::SpreadLine
            | Self::AddLine
            | Self::Measure
            | Self::Expose
            | Self::Smooth
            | Self::SkyLevel(_)
            | Self::OccluderRows
            | Self::Bake => 0,
        }
    }

    pub fn entry_point(self) -> &'static str {
        match self {
            Self::Pixels => "trace_pixels",
            Self::Blocks => "trace_blocks",
            Self::Listed => "trace_listed",
            Self::Fill => "fill_media",
            Self::Rays => "trace_rays",
            Self::Count => "count_steps",
            Self::ShadeSample(maker) | Self::Export(maker) | Self::Outputs(maker, _) => maker.driver(None).0,
            Self::ShadeOnly(maker, target) => maker.driver(Some(target)).0,
            Self::Refine(..) => "refine",
            Self::Develop(..) => "develop_tile",
            Self::Gather | Self::GatherBase => "gather",
            Self::Upsample => "upsample",
            Self::Beam => "spread_beam",
            Self::ReflectLight => "reflect_light",
            Self::DrawGhosts => "draw_ghosts",
            Self::AddGhosts => "add_ghosts",
            Self::SpreadLine => "spread_line",
            Self::AddLine => "add_line",
            Self::Measure => "measure",
            Self::Expose => "expose",
            Self::Smooth => "smooth_blocks",
            Self::SkyLevel(_) => "make_level",
            Self::OccluderRows => "take_distances",
            Self::Bake => "bake_texels",
            Self::SchwarzschildEnds => "find_ends",
            Self::SchwarzschildColumns => "fill_columns",
            Self::KerrNodes => "trace_nodes",
            Self::KerrFlags => "flag_cells",
        }
    }

    /// The WGSL that declares the entry point. Errors: as [`wgsl::kernel`].
    pub fn wgsl(self) -> Result<String> {
        match self {
            Self::Pixels => wgsl::kernel("traced/each"),
            Self::Blocks => wgsl::kernel("traced/blocks"),
            Self::Listed => wgsl::kernel("traced/listed"),
            Self::Fill => wgsl::kernel("traced/fill"),
            Self::Rays => wgsl::kernel("geodesic/rays"),
            Self::Count => wgsl::kernel("traced/count"),
            Self::ShadeSample(maker) => wgsl::shade_sample(maker),
            Self::ShadeOnly(maker, target) => wgsl::shade_only(maker, target),
            Self::Refine(maker, target) => wgsl::refine(maker, target),
            Self::Develop(target, light) => wgsl::develop(target, light),
            Self::Gather => wgsl::kernel("bloom/gather"),
            Self::GatherBase => wgsl::kernel("bloom/base"),
            Self::Upsample => wgsl::kernel("bloom/upsample"),
            Self::Beam => wgsl::kernel("bloom/beam"),
            Self::ReflectLight => wgsl::kernel("bloom/reflected"),
            Self::DrawGhosts => wgsl::kernel("bloom/ghosts"),
            Self::AddGhosts => wgsl::kernel("bloom/ghosted"),
            Self::SpreadLine => wgsl::kernel("bloom/spikes"),
            Self::AddLine => wgsl::kernel("bloom/spiked"),
            Self::Measure => wgsl::kernel("metering/measure"),
            Self::Expose => wgsl::kernel("metering/expose"),
            Self::Smooth => wgsl::kernel("metering/smooth"),
            Self::SkyLevel(in_parts) => wgsl::sky_level(in_parts),
            Self::OccluderRows => wgsl::kernel("emit/occluder_rows"),
            Self::Bake => wgsl::kernel("emit/bake"),
            Self::Export(maker) => wgsl::export(maker),
            Self::Outputs(maker, places) => wgsl::outputs(maker, places),
            Self::SchwarzschildEnds => wgsl::kernel("lens/schwarzschild_ends"),
            Self::SchwarzschildColumns => wgsl::kernel("lens/schwarzschild_columns"),
            Self::KerrNodes => wgsl::kernel("lens/kerr_nodes"),
            Self::KerrFlags => wgsl::kernel("lens/kerr_flags"),
        }
    }

    /// The kernel's groups of bindings, those for the caller to set among them.
    pub fn groups(self) -> Vec<Vec<Slot>> {
        let disk = Slot::TextureWrite(TRACED[2]);
        let [rows, columns] = [LENS_ROWS, LENS_COLUMNS].map(Slot::TextureWrite);
        match self {
            Self::Pixels | Self::Blocks => vec![pixel_slots()],
            Self::Listed => vec![pixel_slots(), vec![Slot::Write]],
            Self::Fill => {
                let [pixels, blocks, media] = [TRACED[1], TRACED[1], TRACED[2]].map(Slot::Texture);
                vec![vec![Slot::Uniform, Slot::UniformPart, pixels, blocks, media, disk], vec![Slot::Write]]
            }
            Self::Count => vec![vec![Slot::UniformPart, Slot::Texture(TRACED[1]), Slot::Write]],
            Self::Rays => vec![vec![Slot::Uniform, Slot::Read, Slot::Write]],
            Self::ShadeSample(source) => vec![shade_slots(), source.slots(), sum_slots(), edge_slots()],
            Self::ShadeOnly(source, target) => vec![shade_slots(), source.slots(), target.slots(), edge_slots()],
            Self::Refine(source, target) => {
                let target = target.map_or_else(sum_slots, PixelTarget::slots);
                vec![refine_slots(), sample_slots(source), target, edge_slots()]
            }
            Self::Develop(target, light) => {
                let spread = [Slot::Texture(LIGHT), Slot::Filtered(LIGHT), Slot::Sampler, Slot::Uniform];
                let metered = [Slot::Uniform, Slot::Read, Slot::Filtered(METER_BLOCKS), Slot::Sampler];
                let light = match light {
                    DevelopedLight::Summed => vec![Slot::Texture(RADIANCE)],
                    DevelopedLight::Glare => spread.into(),
                    DevelopedLight::Metered => [&spread[..], &metered].concat(),
                };
                vec![vec![Slot::UniformPart], light, target.slots()]
            }
            Self::Beam | Self::ReflectLight | Self::DrawGhosts => {
                vec![vec![Slot::UniformPart, Slot::Texture(LIGHT), Slot::TextureWrite(LIGHT)]]
            }
            Self::SpreadLine => vec![vec![Slot::UniformPart, Slot::Texture(LIGHT), Slot::Write]],
            Self::AddLine => {
                vec![vec![Slot::UniformPart, Slot::Texture(LIGHT), Slot::Read, Slot::TextureWrite(LIGHT)]]
            }
            Self::Measure => {
                let [cells, glare] = [Slot::Texture(LIGHT); 2];
                vec![vec![Slot::Uniform, cells, glare, Slot::Write, Slot::Write]]
            }
            Self::Expose => vec![vec![Slot::Uniform, Slot::Write, Slot::Write]],
            Self::Smooth => vec![vec![Slot::Uniform, Slot::Read, Slot::TextureWrite(METER_BLOCKS)]],
            Self::SkyLevel(in_parts) => {
                let first = vec![Slot::UniformPart, Slot::Read, Slot::Write];
                vec![[first, vec![Slot::Read; if in_parts { SKY_PARTS - 1 } else { 0 }]].concat()]
            }
            Self::OccluderRows => vec![vec![Slot::UniformPart, Slot::Read, Slot::TextureWrite(OCCLUDER)]],
            Self::Bake => vec![bake_slots()],
            Self::Gather | Self::GatherBase => {
                vec![vec![Slot::UniformPart, Slot::Filtered(LIGHT), Slot::Sampler, Slot::TextureWrite(LIGHT)]]
            }
            Self::Upsample | Self::AddGhosts => {
                let [finer, coarser] = [Slot::Texture(LIGHT), Slot::Filtered(LIGHT)];
                vec![vec![Slot::UniformPart, finer, coarser, Slot::Sampler, Slot::TextureWrite(LIGHT)]]
            }
            Self::Export(source) => {
                vec![vec![Slot::Uniform, Slot::UniformPart], source.slots(), vec![Slot::Write]]
            }
            Self::Outputs(source, places) => {
                let first = vec![Slot::Uniform, Slot::UniformPart, Slot::Texture(TABLES[0])];
                vec![first, source.slots(), output_slots(places)]
            }
            Self::SchwarzschildEnds => vec![vec![Slot::Uniform, Slot::Uniform, rows]],
            Self::SchwarzschildColumns => {
                vec![vec![Slot::Uniform, Slot::Uniform, Slot::Texture(LENS_ROWS), rows, columns, columns]]
            }
            Self::KerrNodes => {
                vec![vec![Slot::Uniform, Slot::Uniform, Slot::Texture(LENS_ROWS), rows, columns]]
            }
            Self::KerrFlags => {
                let [curve, sky, crossings] = [LENS_ROWS, LENS_ROWS, LENS_COLUMNS].map(Slot::Texture);
                vec![vec![Slot::Uniform, Slot::Uniform, curve, sky, crossings, Slot::TextureWrite(LENS_FLAGS)]]
            }
        }
    }

    /// Threads of a workgroup, for kernels that go over pixels.
    pub fn workgroup(self) -> [u32; 2] {
        match self {
            Self::ShadeOnly(_, target) | Self::Develop(target, _) => target.group(),
            Self::SkyLevel(_) => [LEVEL_COLUMNS, 1],
            Self::Pixels | Self::Blocks => TRACE_GROUP,
            _ => GROUP,
        }
    }
}

impl RecordMaker {
    /// The bits of all kernels that read its records.
    fn readers(self) -> u32 {
        match self {
            Self::Traced => readers::TRACED,
            Self::Schwarzschild => readers::SPIN_0,
            Self::Kerr => readers::KERR,
            Self::KerrDeferred => readers::DEFERRED,
        }
    }
}

impl PixelTarget {
    fn readers(self) -> u32 {
        match self {
            Self::Packed | Self::Rows => readers::PACKED,
            Self::Image(StoredFormat::Rgba8) => readers::SCREEN,
            Self::Image(StoredFormat::Rgba32F) => readers::RGBA32F,
            Self::Image(StoredFormat::R32F) => readers::R32F,
            Self::Light | Self::Image(StoredFormat::Rgba16F) => 0,
        }
    }
}

#[cfg(test)]
mod tests;
#[cfg(test)]
mod translations;
