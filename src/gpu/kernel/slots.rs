// SPDX-License-Identifier: MIT OR Apache-2.0
//! The bindings of kernels: their kinds, the formats of textures as the shaders declare them, and groups that kernels
//! share.

use super::variant::{OutputPlace, OutputPlaces, PixelTarget, RecordMaker, StoredFormat};
use crate::emit::volume::Volume;
pub use crate::gpu::device::texture::{SCREEN, TextureKind};
use crate::scene::RayOutput;

/// The kind of a binding.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub enum Slot {
    Uniform,
    /// A uniform of which each dispatch chooses a part.
    UniformPart,
    Read,
    Write,
    Texture(TextureKind),
    /// A texture that a sampler filters.
    Filtered(TextureKind),
    Sampler,
    TextureWrite(TextureKind),
}

/// `record_sky`, `record_meta` and `record_disk` of traced/layout.wgsl.
pub const TRACED: [TextureKind; 3] = [
    TextureKind { format: wgpu::TextureFormat::Rgba32Float, dimension: wgpu::TextureViewDimension::D2 },
    TextureKind { format: wgpu::TextureFormat::Rgba32Uint, dimension: wgpu::TextureViewDimension::D2 },
    TextureKind { format: wgpu::TextureFormat::Rgba32Float, dimension: wgpu::TextureViewDimension::D2Array },
];

/// Radiance of shade/sample.wgsl and film/develop.wgsl.
pub const RADIANCE: TextureKind =
    TextureKind { format: wgpu::TextureFormat::Rgba32Float, dimension: wgpu::TextureViewDimension::D2 };

/// Light that bloom spreads, of frames and of grids: exposed_light, finer, coarser and glare of the shaders.
pub const LIGHT: TextureKind =
    TextureKind { format: wgpu::TextureFormat::Rgba16Float, dimension: wgpu::TextureViewDimension::D2 };

/// The blocks of metering: `smoothed` of the shaders.
pub const METER_BLOCKS: TextureKind =
    TextureKind { format: wgpu::TextureFormat::Rgba16Float, dimension: wgpu::TextureViewDimension::D3 };

/// Tables of a lens: a row for each branch; and columns, a layer for each branch.
pub const LENS_ROWS: TextureKind =
    TextureKind { format: wgpu::TextureFormat::Rgba32Float, dimension: wgpu::TextureViewDimension::D2 };
pub const LENS_COLUMNS: TextureKind =
    TextureKind { format: wgpu::TextureFormat::Rgba32Float, dimension: wgpu::TextureViewDimension::D2Array };
/// Flags of a lens's cells.
pub const LENS_FLAGS: TextureKind =
    TextureKind { format: wgpu::TextureFormat::R32Uint, dimension: wgpu::TextureViewDimension::D2 };
/// `light_tables` and `star_cells` of shade/shade.wgsl.
pub(super) const TABLES: [TextureKind; 2] = [
    TextureKind { format: wgpu::TextureFormat::Rgba32Float, dimension: wgpu::TextureViewDimension::D2 },
    TextureKind { format: wgpu::TextureFormat::R32Uint, dimension: wgpu::TextureViewDimension::D2 },
];

/// `streaks` of emit/streaks.wgsl.
pub const STREAKS: TextureKind =
    TextureKind { format: wgpu::TextureFormat::Rg16Float, dimension: wgpu::TextureViewDimension::D2 };

/// `occluder` of shade/shade.wgsl.
pub const OCCLUDER: TextureKind =
    TextureKind { format: wgpu::TextureFormat::R32Float, dimension: wgpu::TextureViewDimension::D2 };

/// `filaments` of emit/bake.wgsl, and what that makes: `baked_0` and the others of traced/pixels.wgsl.
pub const FILAMENTS: TextureKind =
    TextureKind { format: wgpu::TextureFormat::R16Float, dimension: wgpu::TextureViewDimension::D3 };
pub const BAKED: TextureKind = FILAMENTS;

/// `film_lut` of film/lut.wgsl.
pub const LUT: TextureKind =
    TextureKind { format: wgpu::TextureFormat::Rgba32Float, dimension: wgpu::TextureViewDimension::D3 };

/// `milky_way` and `sky_map` of shade/shade.wgsl.
pub const SKY_MAP: TextureKind =
    TextureKind { format: wgpu::TextureFormat::Rgb9e5Ufloat, dimension: wgpu::TextureViewDimension::D2 };

impl Slot {
    pub(in crate::gpu) fn binding_type(self) -> wgpu::BindingType {
        let buffer =
            |ty, has_dynamic_offset| wgpu::BindingType::Buffer { ty, has_dynamic_offset, min_binding_size: None };
        match self {
            Self::Uniform => buffer(wgpu::BufferBindingType::Uniform, false),
            Self::UniformPart => buffer(wgpu::BufferBindingType::Uniform, true),
            Self::Read => buffer(wgpu::BufferBindingType::Storage { read_only: true }, false),
            Self::Write => buffer(wgpu::BufferBindingType::Storage { read_only: false }, false),
            Self::Texture(of) => wgpu::BindingType::Texture {
                sample_type: match of.format {
                    wgpu::TextureFormat::Rgba32Uint | wgpu::TextureFormat::R32Uint => wgpu::TextureSampleType::Uint,
                    _ => wgpu::TextureSampleType::Float { filterable: false },
                },
                view_dimension: of.dimension,
                multisampled: false,
            },
            Self::Filtered(of) => wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Float { filterable: true },
                view_dimension: of.dimension,
                multisampled: false,
            },
            Self::Sampler => wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
            Self::TextureWrite(of) => wgpu::BindingType::StorageTexture {
                access: wgpu::StorageTextureAccess::WriteOnly,
                format: of.format,
                view_dimension: of.dimension,
            },
        }
    }
}

impl PixelTarget {
    /// The group of film/film.wgsl and what writes the pixels.
    pub(in crate::gpu) fn slots(self) -> Vec<Slot> {
        let pixels = match self {
            Self::Image(format) => Slot::TextureWrite(TextureKind {
                format: match format {
                    StoredFormat::Rgba8 => SCREEN.format,
                    StoredFormat::Rgba16F => wgpu::TextureFormat::Rgba16Float,
                    StoredFormat::Rgba32F => wgpu::TextureFormat::Rgba32Float,
                    StoredFormat::R32F => wgpu::TextureFormat::R32Float,
                },
                dimension: SCREEN.dimension,
            }),
            Self::Packed | Self::Rows => Slot::Write,
            // Light is developed later, by another kernel.
            Self::Light => return vec![Slot::Uniform, Slot::TextureWrite(LIGHT)],
        };
        vec![Slot::Uniform, pixels, Slot::Texture(LUT)]
    }
}

impl RecordMaker {
    /// Group 1. Those that look rays up begin with `media` of lens/media.wgsl.
    pub(in crate::gpu) fn slots(self) -> Vec<Slot> {
        let media = Slot::Texture(TRACED[2]);
        match self {
            Self::Traced => TRACED.map(Slot::Texture).into(),
            Self::Schwarzschild => {
                let [swept, u, delay] = [LENS_ROWS, LENS_COLUMNS, LENS_COLUMNS].map(Slot::Texture);
                vec![media, Slot::Uniform, swept, u, delay]
            }
            Self::Kerr | Self::KerrDeferred => {
                let [curve, sky, crossings, flags] =
                    [LENS_ROWS, LENS_ROWS, LENS_COLUMNS, LENS_FLAGS].map(Slot::Texture);
                vec![media, Slot::Uniform, curve, sky, crossings, flags, Slot::Write]
            }
        }
    }
}

/// Group 1 of refine/refine.wgsl: integrated samples need no records.
pub fn sample_slots(maker: RecordMaker) -> Vec<Slot> {
    if maker == RecordMaker::Traced { vec![] } else { maker.slots() }
}

/// Group 2 of shade/outputs.wgsl.
pub fn output_slots(places: OutputPlaces) -> Vec<Slot> {
    let image = |format| Slot::TextureWrite(TextureKind { format, dimension: wgpu::TextureViewDimension::D2 });
    let of = |(_, place): &(RayOutput, OutputPlace)| match place {
        OutputPlace::Number | OutputPlace::Numbers | OutputPlace::AlignedNumbers => Slot::Write,
        OutputPlace::NumberImage => image(wgpu::TextureFormat::R32Float),
        OutputPlace::NumbersImage => image(wgpu::TextureFormat::Rgba32Float),
    };
    let packed = (places == OutputPlaces::default()).then_some(Slot::Write);
    [Slot::Uniform].into_iter().chain(packed).chain(places.iter().flatten().map(of)).collect()
}

/// Group 0 of traced/pixels.wgsl.
pub fn pixel_slots() -> Vec<Slot> {
    let [sky, meta, disk] = TRACED.map(Slot::TextureWrite);
    let records = [Slot::Uniform, Slot::UniformPart, sky, meta, disk, Slot::Texture(TABLES[0])];
    let structure = structure_slots();
    [&records[..], &structure[..3], &[Slot::Texture(OCCLUDER)], &structure[3..]].concat()
}

/// Group 0 of shade/shade.wgsl and emit/streaks.wgsl.
pub fn shade_slots() -> Vec<Slot> {
    let ([light, cells], map, streaks) = (TABLES.map(Slot::Texture), Slot::Filtered(SKY_MAP), Slot::Filtered(STREAKS));
    let occluder = Slot::Texture(OCCLUDER);
    vec![Slot::Uniform, Slot::UniformPart, light, cells, map, map, Slot::Sampler, streaks, Slot::Sampler, occluder]
}

/// `clouds` of emit/clouds.wgsl, and the textures that its `baked_factor` reads, with their sampler.
pub fn structure_slots() -> [Slot; 2 + Volume::MOST] {
    let mut slots = [Slot::Filtered(BAKED); 2 + Volume::MOST];
    (slots[0], slots[1 + Volume::MOST]) = (Slot::Read, Slot::Sampler);
    slots
}

/// Group 0 of emit/bake.wgsl.
pub fn bake_slots() -> Vec<Slot> {
    vec![Slot::UniformPart, Slot::Read, Slot::Read, Slot::Filtered(FILAMENTS), Slot::Sampler, Slot::Write]
}

/// Group 0 of refine/refine.wgsl.
pub fn refine_slots() -> Vec<Slot> {
    [shade_slots(), structure_slots().into()].concat()
}

/// Group 2 of shade/sample.wgsl.
pub fn sum_slots() -> Vec<Slot> {
    vec![Slot::Texture(RADIANCE), Slot::TextureWrite(RADIANCE)]
}

/// Group 3 of records/edges.wgsl.
pub fn edge_slots() -> Vec<Slot> {
    vec![Slot::Write]
}
