//! The WGSL of every kernel, joined from the files of shaders/. Knows neither bindings nor devices.

use super::key::{FilmLook, PixelTarget, Source};
use crate::sky;

const MATH: &str = include_str!("../../../shaders/math.wgsl");
const FATE: &str = include_str!("../../../shaders/fate.wgsl");
const GEODESIC: &str = include_str!("../../../shaders/geodesic.wgsl");
const NYSTROM: &str = include_str!("../../../shaders/nystrom.wgsl");
const CAMERA: &str = include_str!("../../../shaders/camera.wgsl");
const LENS_AXIS: &str = include_str!("../../../shaders/lens_axis.wgsl");
const KERR: &str = include_str!("../../../shaders/lens_kerr.wgsl");
const SCHWARZSCHILD: &str = include_str!("../../../shaders/lens_schwarzschild.wgsl");
const INTEGRATION: [&str; 3] =
    [NYSTROM, include_str!("../../../shaders/integrator.wgsl"), include_str!("../../../shaders/trace.wgsl")];
const PASS: &str = include_str!("../../../shaders/pass.wgsl");
const DECIDING: &str = include_str!("../../../shaders/deciding.wgsl");
const FRAME: &str =
    concat!(include_str!("../../../shaders/deciding.wgsl"), "\n", include_str!("../../../shaders/frame.wgsl"));
const PROJECTION: &str = include_str!("../../../shaders/projection.wgsl");
const TRACED_LAYOUT: &str = include_str!("../../../shaders/traced_layout.wgsl");
const TRACED_FOOTPRINTS: &str = include_str!("../../../shaders/traced_footprints.wgsl");
const INTEGRATED: &str = include_str!("../../../shaders/samples_integrated.wgsl");
const RECORD: &str = include_str!("../../../shaders/record.wgsl");
const EDGES: &str = include_str!("../../../shaders/edges.wgsl");
const SHADE_RECORD: &str = include_str!("../../../shaders/shade_record.wgsl");
const SHADE_ONLY: &str = include_str!("../../../shaders/shade_only.wgsl");
const SHADE_SAMPLE: &str = include_str!("../../../shaders/shade_sample.wgsl");

fn join(parts: &[&[&str]]) -> String {
    parts.concat().join("\n")
}

pub fn rays() -> String {
    join(&[&[MATH, FATE, GEODESIC], &INTEGRATION, &[include_str!("../../../shaders/rays.wgsl")]])
}

pub fn pixels() -> String {
    let pixels = [PASS, TRACED_LAYOUT, FRAME, PROJECTION, CAMERA, include_str!("../../../shaders/pixels.wgsl")];
    join(&[&[MATH, FATE, GEODESIC], &INTEGRATION, &pixels])
}

pub fn count() -> String {
    join(&[&[PASS, TRACED_LAYOUT, include_str!("../../../shaders/count.wgsl")]])
}

impl Source {
    /// The WGSL that makes records, without what shading needs as well.
    fn parts(self) -> Vec<&'static str> {
        match self {
            Self::Traced => vec![TRACED_LAYOUT, TRACED_FOOTPRINTS, include_str!("../../../shaders/traced.wgsl")],
            Self::Schwarzschild { .. } => {
                let record = include_str!("../../../shaders/lens_schwarzschild_record.wgsl");
                vec![GEODESIC, CAMERA, LENS_AXIS, SCHWARZSCHILD, record]
            }
            Self::Kerr { rest, .. } => {
                let record = include_str!("../../../shaders/lens_kerr_record.wgsl");
                let mut parts = vec![GEODESIC, CAMERA, LENS_AXIS, KERR, record];
                if rest {
                    parts.extend(INTEGRATION);
                    parts.push(include_str!("../../../shaders/lens_kerr_rest.wgsl"));
                } else {
                    parts.push(include_str!("../../../shaders/lens_kerr_pixel.wgsl"));
                }
                parts
            }
        }
    }

    /// The WGSL that makes records of refine.wgsl's samples.
    fn sample_parts(self) -> Vec<&'static str> {
        match self {
            Self::Traced => {
                let samples = [INTEGRATED, include_str!("../../../shaders/samples_traced.wgsl")];
                [&[GEODESIC, CAMERA, TRACED_LAYOUT, TRACED_FOOTPRINTS], &INTEGRATION[..], &samples].concat()
            }
            Self::Schwarzschild { .. } => self.parts(),
            Self::Kerr { .. } => {
                let record = include_str!("../../../shaders/lens_kerr_record.wgsl");
                let samples = [INTEGRATED, include_str!("../../../shaders/samples_kerr.wgsl")];
                [&[GEODESIC, CAMERA, LENS_AXIS, KERR, record], &INTEGRATION[..], &samples].concat()
            }
        }
    }

    /// What goes over the pixels: the entry point, and its WGSL.
    pub(in crate::gpu) fn driver(self, target: Option<PixelTarget>) -> (&'static str, &'static str) {
        match (self, target) {
            (Self::Kerr { rest: true, .. }, _) => {
                ("each_deferred", include_str!("../../../shaders/each_deferred.wgsl"))
            }
            (_, Some(PixelTarget::Rows)) => ("each_pixel", include_str!("../../../shaders/each_pixel_rows.wgsl")),
            _ => ("each_pixel", include_str!("../../../shaders/each_pixel.wgsl")),
        }
    }
}

impl FilmLook {
    /// The WGSL that takes radiance: film, and where its pixels go.
    fn parts(self) -> [&'static str; 3] {
        let target = match self.target {
            PixelTarget::Screen => include_str!("../../../shaders/screen.wgsl"),
            PixelTarget::Packed => include_str!("../../../shaders/packed.wgsl"),
            PixelTarget::Rows => include_str!("../../../shaders/packed_rows.wgsl"),
            PixelTarget::Light => {
                concat!(include_str!("../../../shaders/f16.wgsl"), "\n", include_str!("../../../shaders/light.wgsl"))
            }
        };
        [include_str!("../../../shaders/film.wgsl"), include_str!("../../../shaders/false_colour.wgsl"), target]
    }
}

/// The kernels that fill a spin-0 lens: `kernel` on top of the rays of the nodes.
fn schwarzschild_build(kernel: &str) -> String {
    let curve = include_str!("../../../shaders/lens_schwarzschild_curve.wgsl");
    join(&[&[MATH, GEODESIC, NYSTROM, FRAME, CAMERA, LENS_AXIS, SCHWARZSCHILD, curve, kernel]])
}

pub fn kerr_nodes() -> String {
    // Nodes keep their crossings by themselves.
    const ON_CROSSING: &str = "fn on_crossing(c: Constants, crossing: PlaneCrossing) {}";
    let parts = [FRAME, CAMERA, LENS_AXIS, KERR, ON_CROSSING, include_str!("../../../shaders/lens_kerr_nodes.wgsl")];
    join(&[&[MATH, FATE, GEODESIC], &INTEGRATION, &parts])
}

pub fn kerr_flags() -> String {
    join(&[&[MATH, FRAME, LENS_AXIS, KERR, include_str!("../../../shaders/lens_kerr_flags.wgsl")]])
}

pub fn schwarzschild_ends() -> String {
    schwarzschild_build(include_str!("../../../shaders/lens_schwarzschild_ends.wgsl"))
}

pub fn schwarzschild_columns() -> String {
    schwarzschild_build(include_str!("../../../shaders/lens_schwarzschild_columns.wgsl"))
}

/// `parts`: what makes the records.
fn shade(parts: &[&str], rest: &[&str]) -> String {
    let shade = [
        include_str!("../../../shaders/blackbody.wgsl"),
        include_str!("../../../shaders/stars.wgsl"),
        include_str!("../../../shaders/sky_map.wgsl"),
        include_str!("../../../shaders/sky_grid.wgsl"),
        include_str!("../../../shaders/disk.wgsl"),
        include_str!("../../../shaders/turbulence.wgsl"),
        include_str!("../../../shaders/shade.wgsl"),
    ];
    let constants = sky::StarIndex::wgsl_constants();
    join(&[&[constants.as_str(), MATH, FATE, PASS, RECORD, FRAME, PROJECTION], parts, &shade, rest])
}

pub fn shade_sample(source: Source) -> String {
    let (_, driver) = source.driver(None);
    shade(&source.parts(), &[driver, EDGES, SHADE_RECORD, SHADE_SAMPLE])
}

pub fn shade_only(source: Source, film: FilmLook) -> String {
    let [develop, colour, put] = film.parts();
    let (_, driver) = source.driver(Some(film.target));
    let rest = [driver, develop, colour, put, EDGES, SHADE_RECORD, SHADE_ONLY];
    shade(&source.parts(), &rest)
}

/// `film`: of pixels with one sample.
pub fn refine(source: Source, film: Option<FilmLook>) -> String {
    let mut rest = vec![EDGES, include_str!("../../../shaders/refine.wgsl")];
    match film {
        Some(film) => rest.extend(film.parts().into_iter().chain([SHADE_ONLY])),
        None => rest.push(SHADE_SAMPLE),
    }
    shade(&source.sample_parts(), &rest)
}

pub fn export(source: Source) -> String {
    let (_, driver) = source.driver(None);
    let parts = [MATH, FATE, PASS, RECORD, FRAME, PROJECTION, driver, include_str!("../../../shaders/export.wgsl")];
    join(&[&parts, &source.parts()])
}

pub fn develop(film: FilmLook, glare: bool) -> String {
    let driver = match film.target {
        PixelTarget::Screen | PixelTarget::Packed | PixelTarget::Light => include_str!("../../../shaders/develop.wgsl"),
        PixelTarget::Rows => include_str!("../../../shaders/develop_rows.wgsl"),
    };
    let light: &[&str] = match glare {
        true => &[BLOOM, include_str!("../../../shaders/glare.wgsl")],
        false => &[include_str!("../../../shaders/summed.wgsl")],
    };
    join(&[&[DECIDING, PASS], light, &film.parts(), &[driver]])
}

const BLOOM: &str = include_str!("../../../shaders/bloom.wgsl");

/// A kernel of bloom.
fn bloom(kernel: &str) -> String {
    join(&[&[BLOOM, include_str!("../../../shaders/f16.wgsl"), kernel]])
}

pub fn gather() -> String {
    bloom(include_str!("../../../shaders/bloom_gather.wgsl"))
}

pub fn gather_base() -> String {
    bloom(include_str!("../../../shaders/bloom_base.wgsl"))
}

pub fn give_back() -> String {
    bloom(include_str!("../../../shaders/bloom_return.wgsl"))
}

/// Every shader of this tracer, joined from its parts as the device gets it: name and WGSL.
pub fn shader_sources() -> Vec<(&'static str, String)> {
    let film = |target| FilmLook { target, ..FilmLook::of_light() };
    let kerr = |rest| Source::Kerr { delay: true, pattern: true, moving: true, rest };
    let sources = [
        ["shade sample, traced", "shade only, traced", "export, traced"],
        ["shade sample, spin-0 lens", "shade only, spin-0 lens", "export, spin-0 lens"],
        ["shade sample, Kerr lens", "shade only, Kerr lens", "export, Kerr lens"],
        ["shade sample, Kerr rest", "shade only, Kerr rest", "export, Kerr rest"],
    ]
    .into_iter()
    .zip([Source::Traced, Source::Schwarzschild { delay: true, moving: true }, kerr(false), kerr(true)]);
    let of_sources = sources.flat_map(|([in_sum, alone, exported], source)| {
        [
            (in_sum, shade_sample(source)),
            (alone, shade_only(source, film(PixelTarget::Packed))),
            (exported, export(source)),
        ]
    });
    let others = [
        ("rays", rays()),
        ("pixels", pixels()),
        ("count", count()),
        ("present", crate::gpu::window::present::present_source()),
        ("develop", develop(film(PixelTarget::Packed), false)),
        ("develop for a window", develop(film(PixelTarget::Screen), false)),
        ("develop by rows", develop(film(PixelTarget::Rows), false)),
        ("develop for bloom", develop(FilmLook::of_light(), false)),
        ("develop with glare", develop(film(PixelTarget::Packed), true)),
        ("develop with glare for a window", develop(film(PixelTarget::Screen), true)),
        ("develop with glare by rows", develop(film(PixelTarget::Rows), true)),
        ("bloom, gather", gather()),
        ("bloom, gather pixels", gather_base()),
        ("bloom, give back", give_back()),
        ("shade only for bloom", shade_only(kerr(false), FilmLook::of_light())),
        ("refine, traced", refine(Source::Traced, Some(film(PixelTarget::Packed)))),
        (
            "refine, spin-0 lens",
            refine(Source::Schwarzschild { delay: true, moving: true }, Some(film(PixelTarget::Packed))),
        ),
        ("refine, Kerr lens", refine(kerr(true), Some(film(PixelTarget::Packed)))),
        ("refine for a window", refine(kerr(true), Some(film(PixelTarget::Screen)))),
        ("refine one of several samples", refine(kerr(true), None)),
        ("shade only for a window", shade_only(kerr(false), film(PixelTarget::Screen))),
        ("shade only by rows", shade_only(kerr(false), film(PixelTarget::Rows))),
        ("spin-0 lens, ends", schwarzschild_ends()),
        ("spin-0 lens, columns", schwarzschild_columns()),
        ("Kerr lens, nodes", kerr_nodes()),
        ("Kerr lens, flags", kerr_flags()),
    ];
    others.into_iter().chain(of_sources).collect()
}
