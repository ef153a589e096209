// SPDX-License-Identifier: MIT OR Apache-2.0
//! Every kernel of the tracer by what decides how it is compiled: its entry point, WGSL, constants and bindings. Knows
//! neither devices nor pipelines; two equal keys are the same kernel.

use super::sizes::{LEVEL_COLUMNS, SKY_PARTS};
use super::slots::{
    LENS_COLUMNS, LENS_FLAGS, LENS_ROWS, LIGHT, OCCLUDER, RADIANCE, Slot, TABLES, TRACED, edge_slots, output_slots,
    pixel_slots, refine_slots, shade_slots, sum_slots,
};
use super::variant::{
    FROM_UNIFORM, FilmVariant, GROUP, MatterVariant, OutputPlaces, RecordSource, RefineVariant, ShadeVariant,
    TraceVariant,
};
use super::wgsl;
use crate::error::Result;
use crate::scene::Projection;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum KernelKey {
    Pixels(TraceVariant),
    /// The blocks of half resolution, the pixels that they do not tell, and what fills the others in.
    Blocks(TraceVariant),
    Listed(TraceVariant),
    /// Whether media are I_nu and optical depth.
    Fill(bool, Option<Projection>),
    Rays(TraceVariant),
    Count,
    ShadeSample(RecordSource, ShadeVariant),
    ShadeOnly(RecordSource, ShadeVariant, FilmVariant),
    Refine(RefineVariant, ShadeVariant, Option<FilmVariant>),
    /// Develops a sum of samples, or light that has spread over a grid of cells of so many pixels' side.
    Develop(FilmVariant, Option<u32>),
    /// Finer cells, or pixels, along a cell's side; whether they are cells.
    Gather(u32, bool),
    GatherBase,
    Upsample,
    Beam,
    /// A level of the pyramid of a sky map that lies in a target; whether what it is made from is bound in parts.
    SkyLevel(bool),
    /// The distances of a target whose rows no copy takes.
    OccluderRows,
    Export(RecordSource, bool, Option<Projection>),
    /// Whether something shines in the plane, and whether matter with depth lies between crossings.
    Outputs(RecordSource, bool, bool, Option<Projection>, OutputPlaces),
    SchwarzschildEnds,
    SchwarzschildColumns {
        delay: bool,
    },
    KerrNodes {
        delay: bool,
        pattern: bool,
    },
    KerrFlags {
        pattern: bool,
    },
}

impl KernelKey {
    /// Group 3, the list of pixels with edges, is for the caller to set.
    pub fn shade_sample(source: RecordSource, shade: ShadeVariant) -> Self {
        Self::ShadeSample(source, shade)
    }

    /// Groups 2, which writes the pixels, and 3, the list of those with edges, are for the caller to set.
    pub fn shade_only(source: RecordSource, shade: ShadeVariant, film: FilmVariant) -> Self {
        Self::ShadeOnly(source, shade, film.over(source))
    }

    /// Groups 2 and 3 as `shade_only`, or, without `film`, `shade_sample`.
    pub fn refine(refined: RefineVariant, shade: ShadeVariant, film: Option<FilmVariant>) -> Self {
        // The disk may cover but a part of a sample's cell.
        Self::Refine(refined, ShadeVariant { opaque: false, ..shade }, film.map(FilmVariant::scattered))
    }

    pub fn export(source: RecordSource, shade: ShadeVariant) -> Self {
        Self::Export(source, shade.footprints, shade.projection)
    }

    /// With targets for `places`, group 2 is for the caller to set.
    pub fn outputs(source: RecordSource, shade: ShadeVariant, places: OutputPlaces) -> Self {
        Self::Outputs(source, shade.plane, shade.volumes, shade.projection, places)
    }

    pub fn entry_point(self) -> &'static str {
        match self {
            Self::Pixels(_) => "trace_pixels",
            Self::Blocks(_) => "trace_blocks",
            Self::Listed(_) => "trace_listed",
            Self::Fill(..) => "fill_media",
            Self::Rays(_) => "trace_rays",
            Self::Count => "count_steps",
            Self::ShadeSample(source, _) | Self::Export(source, ..) | Self::Outputs(source, ..) => {
                source.driver(None).0
            }
            Self::ShadeOnly(source, _, film) => source.driver(Some(film.target)).0,
            Self::Refine(..) => "refine",
            Self::Develop(..) => "develop_tile",
            Self::Gather(..) | Self::GatherBase => "gather",
            Self::Upsample => "upsample",
            Self::Beam => "spread_beam",
            Self::SkyLevel(_) => "make_level",
            Self::OccluderRows => "take_distances",
            Self::SchwarzschildEnds => "find_ends",
            Self::SchwarzschildColumns { .. } => "fill_columns",
            Self::KerrNodes { .. } => "trace_nodes",
            Self::KerrFlags { .. } => "flag_cells",
        }
    }

    /// The WGSL that declares the entry point. Errors: as [`wgsl::kernel`].
    pub fn wgsl(self) -> Result<String> {
        match self {
            Self::Pixels(_) => wgsl::kernel("traced/each"),
            Self::Blocks(_) => wgsl::kernel("traced/blocks"),
            Self::Listed(_) => wgsl::kernel("traced/listed"),
            Self::Fill(..) => wgsl::kernel("traced/fill"),
            Self::Rays(_) => wgsl::kernel("geodesic/rays"),
            Self::Count => wgsl::kernel("traced/count"),
            Self::ShadeSample(source, _) => wgsl::shade_sample(source),
            Self::ShadeOnly(source, _, film) => wgsl::shade_only(source, film),
            Self::Refine(refined, _, film) => wgsl::refine(refined.source, film),
            Self::Develop(film, glare) => wgsl::develop(film, glare.is_some()),
            Self::Gather(..) => wgsl::kernel("bloom/gather"),
            Self::GatherBase => wgsl::kernel("bloom/base"),
            Self::Upsample => wgsl::kernel("bloom/upsample"),
            Self::Beam => wgsl::kernel("bloom/beam"),
            Self::SkyLevel(in_parts) => wgsl::sky_level(in_parts),
            Self::OccluderRows => wgsl::kernel("emit/occluder_rows"),
            Self::Export(source, ..) => wgsl::export(source),
            Self::Outputs(source, .., places) => wgsl::outputs(source, places),
            Self::SchwarzschildEnds => wgsl::kernel("lens/schwarzschild_ends"),
            Self::SchwarzschildColumns { .. } => wgsl::kernel("lens/schwarzschild_columns"),
            Self::KerrNodes { .. } => wgsl::kernel("lens/kerr_nodes"),
            Self::KerrFlags { .. } => wgsl::kernel("lens/kerr_flags"),
        }
    }

    /// The kernel's groups of bindings, those for the caller to set among them.
    pub fn groups(self) -> Vec<Vec<Slot>> {
        let disk = Slot::TextureWrite(TRACED[2]);
        let [rows, columns] = [LENS_ROWS, LENS_COLUMNS].map(Slot::TextureWrite);
        match self {
            Self::Pixels(_) | Self::Blocks(_) => vec![pixel_slots()],
            Self::Listed(_) => vec![pixel_slots(), vec![Slot::Write]],
            Self::Fill(..) => {
                let [pixels, blocks, media] = [TRACED[1], TRACED[1], TRACED[2]].map(Slot::Texture);
                vec![vec![Slot::Uniform, Slot::UniformPart, pixels, blocks, media, disk], vec![Slot::Write]]
            }
            Self::Count => vec![vec![Slot::UniformPart, Slot::Texture(TRACED[1]), Slot::Write]],
            Self::Rays(_) => vec![vec![Slot::Uniform, Slot::Read, Slot::Write]],
            Self::ShadeSample(source, _) => vec![shade_slots(), source.slots(), sum_slots(), edge_slots()],
            Self::ShadeOnly(source, _, film) => vec![shade_slots(), source.slots(), film.slots(), edge_slots()],
            Self::Refine(refined, _, film) => {
                let target = film.map_or_else(sum_slots, FilmVariant::slots);
                vec![refine_slots(), refined.source.slots(), target, edge_slots()]
            }
            Self::Develop(film, glare) => {
                let light = match glare {
                    Some(_) => vec![Slot::Texture(LIGHT), Slot::Filtered(LIGHT), Slot::Sampler, Slot::Uniform],
                    None => vec![Slot::Texture(RADIANCE)],
                };
                vec![vec![Slot::UniformPart], light, film.slots()]
            }
            Self::Beam => vec![vec![Slot::UniformPart, Slot::Texture(LIGHT), Slot::TextureWrite(LIGHT)]],
            Self::SkyLevel(in_parts) => {
                let first = vec![Slot::UniformPart, Slot::Read, Slot::Write];
                vec![[first, vec![Slot::Read; if in_parts { SKY_PARTS - 1 } else { 0 }]].concat()]
            }
            Self::OccluderRows => vec![vec![Slot::UniformPart, Slot::Read, Slot::TextureWrite(OCCLUDER)]],
            Self::Gather(..) | Self::GatherBase => {
                vec![vec![Slot::UniformPart, Slot::Filtered(LIGHT), Slot::Sampler, Slot::TextureWrite(LIGHT)]]
            }
            Self::Upsample => {
                let [finer, coarser] = [Slot::Texture(LIGHT), Slot::Filtered(LIGHT)];
                vec![vec![Slot::UniformPart, finer, coarser, Slot::Sampler, Slot::TextureWrite(LIGHT)]]
            }
            Self::Export(source, ..) => {
                vec![vec![Slot::Uniform, Slot::UniformPart], source.slots(), vec![Slot::Write]]
            }
            Self::Outputs(source, .., places) => {
                let first = vec![Slot::Uniform, Slot::UniformPart, Slot::Texture(TABLES[0])];
                vec![first, source.slots(), output_slots(places)]
            }
            Self::SchwarzschildEnds => vec![vec![Slot::Uniform, Slot::Uniform, rows]],
            Self::SchwarzschildColumns { .. } => {
                vec![vec![Slot::Uniform, Slot::Uniform, Slot::Texture(LENS_ROWS), rows, columns, columns]]
            }
            Self::KerrNodes { .. } => {
                vec![vec![Slot::Uniform, Slot::Uniform, Slot::Texture(LENS_ROWS), rows, columns]]
            }
            Self::KerrFlags { .. } => {
                let [curve, sky, crossings] = [LENS_ROWS, LENS_ROWS, LENS_COLUMNS].map(Slot::Texture);
                vec![vec![Slot::Uniform, Slot::Uniform, curve, sky, crossings, Slot::TextureWrite(LENS_FLAGS)]]
            }
        }
    }

    /// Threads of a workgroup, for kernels that go over pixels.
    pub fn workgroup(self) -> [u32; 2] {
        match self {
            Self::ShadeOnly(_, _, film) | Self::Develop(film, _) => film.group(),
            Self::SkyLevel(_) => [LEVEL_COLUMNS, 1],
            _ => GROUP,
        }
    }

    /// Values of the `override` constants that the kernel's source declares.
    pub fn constants(self) -> Vec<(&'static str, f64)> {
        match self {
            Self::Pixels(variant) | Self::Blocks(variant) => pixel_constants(variant),
            Self::Listed(variant) => [pixel_constants(variant), vec![("KEEPS_RECORD", 0.0)]].concat(),
            Self::Fill(depth, projection) => vec![("SHOWS_DEPTH", flag(depth)), projection_constant(projection)],
            Self::Rays(variant) => trace_constants(variant),
            Self::ShadeSample(source, shade) => [source.constants(), shade_constants(shade)].concat(),
            Self::ShadeOnly(source, shade, film) => {
                [source.constants(), shade_constants(shade), film_constants(film)].concat()
            }
            Self::Refine(refined, shade, film) => {
                let traced = match refined.source {
                    RecordSource::Traced => {
                        let matter = refined.variant.matter.unwrap_or_default();
                        [trace_constants(refined.variant), matter_constants(matter)].concat()
                    }
                    _ => refined.source.constants(),
                };
                let film = film.map_or_else(Vec::new, film_constants);
                [traced, shade_constants(shade), film, vec![("WHOLE_PLANE", 1.0)]].concat()
            }
            Self::Develop(film, None) => film_constants(film),
            Self::Develop(film, Some(step)) => [film_constants(film), vec![("STEP", step.into())]].concat(),
            Self::Gather(step, grid) => vec![("STEP", step.into()), ("GRID", flag(grid))],
            Self::GatherBase | Self::Upsample | Self::Beam | Self::SkyLevel(_) | Self::OccluderRows => Vec::new(),
            Self::Export(source, footprints, projection) => {
                let export = vec![("FOOTPRINTS", flag(footprints)), projection_constant(projection)];
                [source.constants(), export].concat()
            }
            Self::Outputs(source, plane, volumes, projection, _) => {
                let places = [("FOOTPRINTS", 0.0), ("PLACES", 1.0)];
                let shade = [&[("PLANE", flag(plane)), ("VOLUMES", flag(volumes))][..], &places].concat();
                [source.constants(), shade, vec![projection_constant(projection)]].concat()
            }
            Self::SchwarzschildEnds => vec![("SPINNING", 0.0), ("DELAY", 0.0)],
            Self::SchwarzschildColumns { delay } => vec![("SPINNING", 0.0), ("DELAY", flag(delay))],
            Self::KerrNodes { delay, pattern } => vec![("DELAY", flag(delay)), ("PATTERN", flag(pattern))],
            Self::KerrFlags { pattern } => vec![("PATTERN", flag(pattern))],
            Self::Count => Vec::new(),
        }
    }
}

fn flag(on: bool) -> f64 {
    f64::from(u8::from(on))
}

impl RecordSource {
    /// Values of the `override` constants that the parts declare.
    fn constants(self) -> Vec<(&'static str, f64)> {
        match self {
            Self::Traced => Vec::new(),
            Self::Schwarzschild { delay, moving } => {
                vec![("SPINNING", 0.0), ("DELAY", flag(delay)), ("MOVING", flag(moving))]
            }
            Self::Kerr { delay, pattern, moving, deferred } => {
                let mut list = vec![("DELAY", flag(delay)), ("PATTERN", flag(pattern)), ("MOVING", flag(moving))];
                if deferred {
                    // The rest of the constants' defaults are what AUTO takes.
                    list.push(("STEP_LIMIT", 1.0));
                }
                list
            }
        }
    }
}

fn trace_constants(variant: TraceVariant) -> Vec<(&'static str, f64)> {
    vec![
        ("METHOD", f64::from(variant.method.0)),
        ("SPINNING", flag(variant.spinning)),
        ("DELAY", flag(variant.delay)),
        ("STEP_LIMIT", flag(variant.step_limit)),
        ("PARTS", flag(variant.matter.is_some())),
    ]
}

/// The constants of traced/pixels.wgsl.
fn pixel_constants(variant: TraceVariant) -> Vec<(&'static str, f64)> {
    let pixels = vec![("AZIMUTH", flag(variant.azimuth)), projection_constant(variant.projection)];
    let matter = variant.matter.unwrap_or_default();
    let effects = vec![("ALL_EFFECTS", flag(matter.all_effects)), ("OCCLUDED", flag(matter.occluded))];
    [trace_constants(variant), matter_constants(matter), pixels, effects].concat()
}

fn matter_constants(matter: MatterVariant) -> Vec<(&'static str, f64)> {
    vec![
        ("SHAPES", matter.shapes.into()),
        ("MOTIONS", matter.motions.into()),
        ("THERMAL", flag(matter.thermal)),
        ("POWER_LAW", flag(matter.power_law)),
        ("SHOWS_DEPTH", flag(matter.shows_depth)),
        ("STRUCTURE", flag(matter.structure)),
        ("ALONE", flag(matter.alone)),
    ]
}

fn projection_constant(projection: Option<Projection>) -> (&'static str, f64) {
    ("PROJECTION", projection.map_or(FROM_UNIFORM, |projection| projection as u32).into())
}

fn shade_constants(shade: ShadeVariant) -> Vec<(&'static str, f64)> {
    vec![
        ("SHOWS_LIGHT", flag(shade.light)),
        ("SHOWS_STARS", flag(shade.stars)),
        ("SHOWS_MILKY_WAY", flag(shade.milky_way)),
        ("SHOWS_MAP", flag(shade.map)),
        ("SHOWS_GRID", flag(shade.grid)),
        ("MAP_SAMPLER", flag(shade.map_sampler)),
        ("ALL_EFFECTS", flag(shade.all_effects)),
        ("PLANE", flag(shade.plane)),
        ("OPAQUE", flag(shade.opaque)),
        ("FOOTPRINTS", flag(shade.footprints)),
        ("VOLUMES", flag(shade.volumes)),
        projection_constant(shade.projection),
        ("REFINES", flag(shade.refines)),
        ("TURBULENT", flag(shade.turbulent)),
        ("OCCLUDED", flag(shade.occluded)),
    ]
}

fn film_constants(film: FilmVariant) -> Vec<(&'static str, f64)> {
    vec![
        ("PIXELS", film.pixels.map_or(FROM_UNIFORM, |pixels| pixels as u32).into()),
        ("FALSE_COLOUR", flag(film.false_colour)),
        ("TONE_MAP", film.tone_map.map_or(FROM_UNIFORM, |tone_map| tone_map as u32).into()),
        ("COLOUR_MAP", film.colour_map.map_or(FROM_UNIFORM, |colour_map| colour_map as u32).into()),
    ]
}
