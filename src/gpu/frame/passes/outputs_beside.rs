// SPDX-License-Identifier: MIT OR Apache-2.0
//! Outputs beside a picture, in the submissions of the frame that they belong to: each tile's, after its picture. They
//! go into targets on the GPU, or are packed tile by tile, from where each submission copies them for the host. Where
//! the picture's records and tables serve outputs as well, they read those; else rays are traced for them, or tables
//! made. Knows no host memory.

use super::picture::RecordConsumer;
use crate::error::{Error, Result};
use crate::gpu::device::target::{GpuTarget, TargetResource};
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::frame::plan::from_scene::Planner;
use crate::gpu::frame::plan::setup::Setup;
use crate::gpu::frame::plan::target_rows::FrameRows;
use crate::gpu::frame::resources::frame_buffers::FrameBuffers;
use crate::gpu::frame::resources::output_buffers::OutputBuffers;
use crate::gpu::frame::resources::tables::Tables;
use crate::gpu::frame::uniforms::outputs::OutputsUniform;
use crate::gpu::kernel::kernels::Kernels;
use crate::gpu::kernel::key::KernelKey;
use crate::gpu::kernel::variant::{OutputPlace, OutputPlaces, PixelTarget, RecordMaker, RecordSource};
use crate::gpu::lens::records::{RecordStages, RecordStore};
use crate::gpu::lens::traced::{Shared, structure_group};
use crate::scene::{RayOutput, Scene};
use crate::tracer::{FrameRequest, Tile};

/// The place that an output goes to.
#[derive(Clone, Copy)]
pub enum OutputTo<'a> {
    Target(&'a GpuTarget),
    /// To the host, which knows it by this number.
    Host(usize),
}

/// An output and where it goes.
pub type PlacedOutput<'a> = (RayOutput, OutputTo<'a>);

/// Every device binds buffers from a multiple of this on.
const PACKED_ALIGNMENT: u64 = 256;

/// The place of an output's numbers.
enum Place {
    Rows(wgpu::Buffer, FrameRows),
    Image(wgpu::TextureView),
    /// A tile's, in a buffer of all those for the host; each begins where the one before ends on the largest tile.
    Packed {
        number: usize,
        words: u64,
    },
}

/// A tile's numbers of an output for the host, packed.
#[derive(Clone, Copy)]
pub struct PackedOutput {
    /// The number by which the host knows it.
    pub number: usize,
    /// Bytes before it in the buffer.
    pub offset: u64,
    /// Bytes of a pixel.
    pub pixel_bytes: u64,
}

/// How the outputs of a frame are made, before its buffers are there.
pub(in crate::gpu) struct BesideSetup {
    pub setup: Setup,
    uniform: OutputsUniform,
    kinds: OutputPlaces,
    places: Vec<Place>,
    /// The records that the picture is made from serve, and are there.
    reads_again: bool,
    /// The picture is looked up in other tables, which stay.
    own_tables: bool,
}

/// The kernels of a frame's outputs, and where they write.
pub(in crate::gpu) struct Beside {
    source: RecordSource,
    /// `None`: the picture's are read again.
    records: Option<RecordStages>,
    own_tables: bool,
    consumer: RecordConsumer,
    layout: wgpu::BindGroupLayout,
    uniform: OutputsUniform,
    places: Vec<Place>,
    /// Pixels of the largest tile.
    most_pixels: u64,
    /// A tile was made.
    pub begun: bool,
}

impl Place {
    /// The place, and how kernels write there. Errors: UNSUPPORTED for an image that they cannot write.
    fn of(output: RayOutput, to: OutputTo<'_>) -> Result<(Self, OutputPlace)> {
        let single = output.words() == 1;
        let target = match to {
            OutputTo::Target(target) => target,
            OutputTo::Host(number) => {
                let kind = if single { OutputPlace::Number } else { OutputPlace::AlignedNumbers };
                return Ok((Self::Packed { number, words: output.words() as u64 }, kind));
            }
        };
        Ok(match &target.resource {
            TargetResource::Buffer(buffer) => {
                let rows = FrameRows::of(target, buffer);
                let kind = match single {
                    true => OutputPlace::Number,
                    false if rows.row_stride.is_multiple_of(16) => OutputPlace::AlignedNumbers,
                    false => OutputPlace::Numbers,
                };
                (Self::Rows(buffer.clone(), rows), kind)
            }
            TargetResource::Written(_, view) => {
                let kind = if single { OutputPlace::NumberImage } else { OutputPlace::NumbersImage };
                (Self::Image(view.clone()), kind)
            }
            TargetResource::Copied(_) => {
                return Err(Error::unsupported(
                    "an image that a copy fills takes the output LIGHT only; others need an image with STORAGE usage",
                ));
            }
        })
    }
}

/// Errors: UNSUPPORTED for more targets than a kernel of this device binds.
fn check_bound(device: &Device, places: &[Place], source: RecordSource) -> Result<()> {
    let limits = device.limits();
    let images = places.iter().filter(|place| matches!(place, Place::Image(_))).count() as u32;
    let listed = u32::from(matches!(source.maker, RecordMaker::Kerr | RecordMaker::KerrDeferred));
    let found = [
        ("IMAGE", images, limits.max_storage_textures_per_shader_stage),
        ("BUFFER", places.len() as u32 - images, limits.max_storage_buffers_per_shader_stage.saturating_sub(listed)),
    ];
    for (name, count, most) in found {
        if count > most {
            return Err(Error::unsupported(format!(
                "{count} outputs go into {name} targets, or as those into the host's memory; kernels of this device \
                 write {most} at most"
            )));
        }
    }
    Ok(())
}

impl BesideSetup {
    /// The setup of `outputs`; `scene` is `Scene::for_outputs` of them. `picture`: that of the picture beside them;
    /// `None`: there is none, and the frame's records are those of the outputs. Errors: as `Renderer::render`;
    /// UNSUPPORTED for targets that kernels do not reach.
    pub fn new(
        planner: &Planner<'_>,
        device: &Device,
        scene: &Scene,
        request: &FrameRequest,
        (outputs, picture): (&[PlacedOutput<'_>], Option<&Setup>),
    ) -> Result<Self> {
        let setup = planner.set_up(scene, request, PixelTarget::Packed)?;
        let mut kinds = OutputPlaces::default();
        let mut places = Vec::with_capacity(outputs.len());
        for (kind, (output, to)) in kinds.iter_mut().zip(outputs) {
            let (place, found) = Place::of(*output, *to)?;
            places.push(place);
            *kind = Some((*output, found));
        }
        check_bound(device, &places, setup.record_setup.source)?;
        let (own, looked_up) =
            (&setup.record_setup, |setup: &Setup| setup.record_setup.source.maker != RecordMaker::Traced);
        let reads_again = picture.is_none_or(|picture| {
            let stays = picture.samples == 1 || looked_up(picture);
            stays && *own == picture.record_setup && setup.uniform.is_same(&picture.uniform)
        });
        let own_tables = picture.is_some_and(|picture| {
            looked_up(picture) && looked_up(&setup) && !own.shares_tables(&picture.record_setup)
        });
        let asked = outputs.iter().map(|(output, _)| *output).collect::<Vec<_>>();
        let uniform = OutputsUniform::new(scene, &asked);
        Ok(Self { uniform, kinds, places, reads_again, own_tables, setup })
    }

    pub fn kernels(&self) -> Vec<KernelKey> {
        self.setup.output_kernels(self.kinds)
    }

    /// Bytes of a tile's pixel on the device beside the picture's.
    pub fn bytes_per_pixel(&self) -> u64 {
        let records = if self.reads_again { 0 } else { self.setup.record_setup.bytes_per_pixel() };
        // Packed numbers have two staging buffers.
        records + 3 * self.packed_bytes()
    }

    /// Bytes of a pixel's numbers for the host.
    fn packed_bytes(&self) -> u64 {
        self.places.iter().map(|place| if let Place::Packed { words, .. } = place { 4 * words } else { 0 }).sum()
    }

    /// Whether rays are traced, or looked up with a share of them traced, beside those of the picture.
    pub fn takes_rays(&self) -> bool {
        !self.reads_again
    }

    /// The most rows of a tile. Errors: UNSUPPORTED for rows that no kernel reaches.
    pub fn most_rows(&self, device: &Device) -> Result<u32> {
        let rows = self.places.iter().filter_map(|place| match place {
            Place::Rows(_, rows) => Some(rows.most_rows(device)),
            Place::Image(_) | Place::Packed { .. } => None,
        });
        rows.collect::<Result<Vec<u32>>>().map(|rows| rows.into_iter().min().unwrap_or(u32::MAX))
    }

    /// Makes room for tiles, and writes what all of them share; before the picture's stages are made.
    pub fn prepare(
        &self,
        device: &Device,
        buffers: &mut FrameBuffers,
        own: &mut OutputBuffers,
        tile: [u32; 2],
        software: bool,
    ) -> Result<()> {
        own.uniform(device)?;
        let most_pixels = tile.map(u64::from).iter().product::<u64>();
        let count = self.places.len() as u64;
        if self.packed_bytes() > 0 {
            own.make_room(device, self.packed_bytes() * most_pixels + count * PACKED_ALIGNMENT)?;
        }
        if self.reads_again {
            return Ok(());
        }
        let store = if self.own_tables { &mut own.frame.record_store } else { &mut buffers.record_store };
        store.prepare(device, &self.setup.record_setup, tile)?;
        own.frame.write_fixed(device, &self.setup, software)
    }

    pub fn stages(
        self,
        device: &Device,
        kernels: &Kernels,
        tables: &Tables,
        buffers: &mut FrameBuffers,
        own: &mut OutputBuffers,
        (tile, software): ([u32; 2], bool),
    ) -> Result<Beside> {
        let missing = || Error::internal("outputs without buffers");
        let record_setup = &self.setup.record_setup;
        let fixed = buffers.fixed.as_ref().ok_or_else(missing)?;
        let uniforms = if self.reads_again { fixed } else { own.frame.fixed.as_ref().ok_or_else(missing)? };
        let (frame, pass) = (uniforms.frame.buffer.as_entire_binding(), fixed.pass());
        let [light_tables, ..] = tables.resources();
        let structure = structure_group(uniforms.clouds.buffer(), tables.structure());
        let step_sum = fixed.step_sum.as_entire_binding();
        let common = [frame.clone(), pass.clone(), light_tables.clone()];
        let occluder = tables.occluder().resource();
        let shared = Shared { frame, pass, step_sum, light_tables, structure, occluder, software };
        let store = if self.own_tables { &mut own.frame.record_store } else { &mut buffers.record_store };
        let records = match self.reads_again {
            true => None,
            false => Some(store.stages(device, kernels, record_setup, &shared)?),
        };
        let group = store.group(record_setup.source)?;
        let key = |source| KernelKey::outputs(source, self.setup.variants.shade, self.kinds);
        let take = |kernels: &Kernels, source| kernels.get(key(source))?.stage(device, &[&common, &group]);
        let consumer = RecordConsumer::new(kernels, record_setup, software, take)?;
        let layout = kernels.get(key(record_setup.source))?.target()?.clone();
        let Self { own_tables, uniform, places, .. } = self;
        let (source, most_pixels) = (record_setup.source, tile.map(u64::from).iter().product());
        Ok(Beside { source, records, own_tables, consumer, layout, uniform, places, most_pixels, begun: false })
    }
}

impl Beside {
    /// The group of a tile's targets; where in them the tile lies is written for the next submission.
    pub fn group(&self, device: &Device, own: &mut OutputBuffers, tile: Tile) -> Result<wgpu::BindGroup> {
        let mut uniform = self.uniform;
        own.uniform(device)?;
        let missing = || Error::internal("outputs without buffers");
        let held = own.uniform.as_mut().ok_or_else(missing)?;
        let mut packed = self.packed();
        let mut bound = vec![held.buffer.as_entire_binding()];
        for (to, place) in uniform.places.iter_mut().zip(&self.places) {
            bound.push(match place {
                Place::Packed { words, .. } => {
                    *to = [0, *words as u32 * tile.width, 0, 0];
                    let buffer = own.packed.as_ref().ok_or_else(missing)?;
                    let offset = packed.next().ok_or_else(missing)?.offset;
                    let size = std::num::NonZeroU64::new(4 * words * self.most_pixels);
                    wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer, offset, size })
                }
                Place::Rows(buffer, rows) => {
                    let at = rows.place(device, tile);
                    *to = [at.first, at.row, 0, 0];
                    let size = at.size.and_then(std::num::NonZeroU64::new);
                    wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer, offset: at.offset, size })
                }
                Place::Image(view) => {
                    *to = [0, 0, tile.x, tile.y];
                    wgpu::BindingResource::TextureView(view)
                }
            });
        }
        let group = device.bind(&self.layout, &bound)?;
        drop(bound);
        held.write(device, bytemuck::bytes_of(&uniform))?;
        Ok(group)
    }

    /// The tile's numbers for the host, in the buffer that [`OutputBuffers::packed`] is.
    pub fn packed(&self) -> impl Iterator<Item = PackedOutput> {
        let most_pixels = self.most_pixels;
        let packed = self.places.iter().filter_map(|place| match place {
            Place::Packed { number, words } => Some((*number, 4 * words)),
            Place::Rows(..) | Place::Image(_) => None,
        });
        packed.scan(0_u64, move |end, (number, pixel_bytes)| {
            let offset = end.next_multiple_of(PACKED_ALIGNMENT);
            *end = offset + pixel_bytes * most_pixels;
            Some(PackedOutput { number, offset, pixel_bytes })
        })
    }

    /// Before the tile's outputs, after its picture. What will hold the steps of their rays; `None`: they take none.
    pub fn reset<'a>(
        &'a self,
        buffers: &'a RecordStore,
        own: &'a OutputBuffers,
        step_sum: &'a crate::gpu::device::buffer::Buffer,
        encoder: &mut wgpu::CommandEncoder,
    ) -> Option<&'a crate::gpu::device::buffer::Buffer> {
        if self.records.is_none() && self.source.maker == RecordMaker::Traced {
            return None;
        }
        let store = if self.own_tables { &own.frame.record_store } else { buffers };
        store.reset(self.source, step_sum, encoder)
    }

    /// `offset`: of the `PassUniform` of rays through pixels' centres.
    pub fn encode(&self, pass: &mut wgpu::ComputePass<'_>, offset: u32, tile: [u32; 2], group: &wgpu::BindGroup) {
        if let Some(records) = &self.records {
            records.encode(pass, !self.begun, offset, tile);
        }
        pass.set_bind_group(2, group, &[]);
        self.consumer.dispatch(pass, offset, tile);
    }

    /// Whether tables of a lens are made for the outputs alone.
    pub fn make_tables(&self) -> bool {
        self.records.as_ref().is_some_and(RecordStages::make_tables)
    }

    /// Whether rays are traced, or looked up, beside those of the picture.
    pub fn takes_rays(&self) -> bool {
        self.records.is_some()
    }
}
