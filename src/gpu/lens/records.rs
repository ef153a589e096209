// SPDX-License-Identifier: MIT OR Apache-2.0
//! Where a frame's ray records come from: traced pixel by pixel into textures, or looked up in the tables of a lens.
//! Gives shading its group 1 and knows nothing else of it.

use super::half::{self, HalfBlocks, HalfStages};
use super::kerr::{KerrContents, KerrStages, KerrTables};
use super::schwarzschild::{SchwarzschildStages, SchwarzschildTables};
use super::traced::{Shared, TracedRecords, pixel_group};
use crate::error::Result;
use crate::gpu::device::buffer::Buffer;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::kernel::kernels::Kernels;
use crate::gpu::kernel::key::{KernelKey, KernelKind};
use crate::gpu::kernel::sizes::COUNT_RUN;
use crate::gpu::kernel::stage::Stage;
use crate::gpu::kernel::variant::{RecordMaker, RecordSource, TraceVariant};
use crate::physics::observer::LocalFrame;

/// Bytes of a texel of the record textures.
const TEXEL: u64 = 16;

/// How a frame's records are to be made.
#[derive(PartialEq)]
pub struct RecordSetup {
    pub source: RecordSource,
    /// How rays are traced.
    pub variant: TraceVariant,
    /// Whether matter with depth is summed along the rays of blocks, and `variant` is theirs.
    pub half: bool,
    /// Crossings that a record holds at most.
    pub crossings: u32,
    /// The fewest layers that an array of textures has.
    pub least_layers: u32,
    pub observer: LocalFrame,
    pub contents: KerrContents,
}

/// The tables and textures from which records come, kept from frame to frame.
#[derive(Default)]
pub struct RecordStore {
    traced: TracedRecords,
    half: HalfBlocks,
    schwarzschild: SchwarzschildTables,
    kerr: KerrTables,
}

/// The passes that make the records of a tile, or the tables that they are looked up in, and those that give pixels
/// their media at half resolution.
pub struct RecordStages {
    maker: MakerStages,
    half: Option<HalfStages>,
}

enum MakerStages {
    Traced(TraceStages),
    /// Before the frame's first tile, if the tables are stale.
    Schwarzschild(Option<SchwarzschildStages>),
    Kerr(Option<KerrStages>),
}

impl RecordSetup {
    /// The layers in which traced records keep crossings and, behind those, the media before each and behind the last.
    fn layers(&self) -> u32 {
        let media = if self.variant.matter.is_some() { self.crossings + 1 } else { 0 };
        (self.crossings + media).max(self.least_layers)
    }

    /// Bytes of a tile's pixel on the device.
    pub fn bytes_per_pixel(&self) -> u64 {
        let texels = TEXEL * (2 + u64::from(self.layers()));
        let media = if self.half { TEXEL } else { 0 };
        let own = match self.source.maker {
            RecordMaker::Traced => texels,
            RecordMaker::Schwarzschild => media,
            RecordMaker::Kerr | RecordMaker::KerrDeferred => media + KerrTables::BYTES_PER_PIXEL,
        };
        if self.half { own + texels.div_ceil(4) + HalfBlocks::BYTES_PER_PIXEL } else { own }
    }

    fn is_traced(&self) -> bool {
        self.source.maker == RecordMaker::Traced
    }

    /// How the rays of pixels are traced before shading.
    pub fn pixel_variant(&self) -> TraceVariant {
        TraceVariant { matter: self.variant.matter.filter(|_| !self.half), ..self.variant }
    }

    /// The kernels that make records, or the tables that they are looked up in.
    pub fn keys(&self) -> Vec<KernelKey> {
        let tables = |kinds: [KernelKind; 2]| kinds.map(|kind| KernelKey::new(kind, &[&self.source]));
        let made = match self.source.maker {
            RecordMaker::Traced => {
                [KernelKey::new(KernelKind::Pixels, &[&self.pixel_variant()]), KernelKind::Count.into()]
            }
            RecordMaker::Schwarzschild => tables([KernelKind::SchwarzschildEnds, KernelKind::SchwarzschildColumns]),
            RecordMaker::Kerr | RecordMaker::KerrDeferred => tables([KernelKind::KerrNodes, KernelKind::KerrFlags]),
        };
        let half = self.half.then(|| half::keys(self.variant, self.is_traced()));
        made.into_iter().chain(half.into_iter().flatten()).collect()
    }

    /// Whether both are looked up in the same tables.
    pub fn shares_tables(&self, other: &Self) -> bool {
        self.observer == other.observer
            && match (self.source.maker, other.source.maker) {
                (RecordMaker::Schwarzschild, RecordMaker::Schwarzschild) => self.source.delay == other.source.delay,
                (RecordMaker::Kerr, RecordMaker::Kerr) => self.contents == other.contents,
                _ => false,
            }
    }

    /// The source of the records of samples that are taken of a pixel anew. Matter is summed along integrated rays.
    pub fn sample_source(&self) -> RecordSource {
        match self.variant.matter {
            Some(_) => RecordSource { maker: RecordMaker::Traced, ..self.source },
            None => self.deferred_source().unwrap_or(self.source),
        }
    }

    /// The source of the records of those pixels that this one leaves pending.
    pub fn deferred_source(&self) -> Option<RecordSource> {
        let deferred = RecordSource { maker: RecordMaker::KerrDeferred, ..self.source };
        (self.source.maker == RecordMaker::Kerr).then_some(deferred)
    }
}

impl RecordStore {
    /// Makes room for a tile.
    pub fn prepare(&mut self, device: &Device, record_setup: &RecordSetup, tile: [u32; 2]) -> Result<()> {
        let layers = record_setup.layers();
        match record_setup.source.maker {
            RecordMaker::Traced => self.traced.prepare(device, tile.map(|side| side + 2), layers)?,
            RecordMaker::Schwarzschild => {}
            RecordMaker::Kerr | RecordMaker::KerrDeferred => self.kerr.prepare(device, tile)?,
        }
        if !record_setup.is_traced() {
            self.half.prepare_media(device, record_setup.half.then_some(tile), record_setup.least_layers)?;
        }
        if record_setup.half { self.half.prepare(device, tile, layers) } else { Ok(()) }
    }

    /// The stages that `record_setup` asks for; tables are brought up to its observer.
    pub fn stages(
        &mut self,
        device: &Device,
        kernels: &Kernels,
        record_setup: &RecordSetup,
        shared: &Shared<'_>,
    ) -> Result<RecordStages> {
        let frame = shared.frame.clone();
        let pixels = if record_setup.is_traced() { Some(self.traced.resources()?) } else { None };
        let half = || self.half.stages(device, kernels, record_setup.variant, pixels.as_ref(), shared);
        let half = if record_setup.half { Some(half()?) } else { None };
        let maker = match record_setup.source.maker {
            RecordMaker::Traced => {
                let pixels = self.traced.resources()?;
                let trace = trace_stages(device, kernels, record_setup.pixel_variant(), &pixels, shared)?;
                MakerStages::Traced(trace)
            }
            // Only lenses of one kind are kept: both together could take half as much again.
            RecordMaker::Schwarzschild => {
                self.kerr.release();
                MakerStages::Schwarzschild(self.schwarzschild.update(
                    device,
                    kernels,
                    &record_setup.observer,
                    record_setup.source.delay,
                    frame,
                )?)
            }
            RecordMaker::Kerr | RecordMaker::KerrDeferred => {
                self.schwarzschild = SchwarzschildTables::default();
                MakerStages::Kerr(self.kerr.update(
                    device,
                    kernels,
                    &record_setup.observer,
                    &record_setup.contents,
                    frame,
                )?)
            }
        };
        Ok(RecordStages { maker, half })
    }

    /// Group 1 of a kernel that reads records.
    pub fn group(&self, source: RecordSource) -> Result<Vec<wgpu::BindingResource<'_>>> {
        let tables = match source.maker {
            RecordMaker::Traced => return self.traced.group(),
            RecordMaker::Schwarzschild => self.schwarzschild.group()?,
            RecordMaker::Kerr | RecordMaker::KerrDeferred => self.kerr.group()?,
        };
        Ok([vec![self.half.media()?], tables].concat())
    }

    /// Group 1 of a kernel that takes samples of a pixel.
    pub fn sample_group(&self, source: RecordSource) -> Result<Vec<wgpu::BindingResource<'_>>> {
        if source.maker == RecordMaker::Traced { Ok(vec![]) } else { self.group(source) }
    }

    /// Before a submission. What will hold the steps of its rays, `step_sum` or a buffer that begins with them;
    /// `None`: they take none.
    pub fn reset<'a>(
        &'a self,
        source: RecordSource,
        step_sum: &'a Buffer,
        encoder: &mut wgpu::CommandEncoder,
    ) -> Option<&'a Buffer> {
        self.half.reset(encoder);
        match source.maker {
            RecordMaker::Traced => {
                encoder.clear_buffer(step_sum, 0, None);
                Some(step_sum)
            }
            RecordMaker::Schwarzschild => None,
            RecordMaker::Kerr | RecordMaker::KerrDeferred => {
                self.kerr.reset(encoder);
                self.kerr.deferred()
            }
        }
    }

    /// After a submission that failed, nobody knows what the tables hold.
    pub fn forget(&mut self) {
        self.schwarzschild.forget();
        self.kerr.forget();
    }
}

impl RecordStages {
    /// Whether the tables of a lens are made for the frame.
    pub fn make_tables(&self) -> bool {
        match &self.maker {
            MakerStages::Traced(_) => false,
            MakerStages::Schwarzschild(stages) => stages.is_some(),
            MakerStages::Kerr(stages) => stages.as_ref().is_some_and(KerrStages::make_tables),
        }
    }

    /// `begins`: these are the frame's first.
    pub fn encode(&self, pass: &mut wgpu::ComputePass<'_>, begins: bool, offset: u32, tile: [u32; 2]) {
        match &self.maker {
            MakerStages::Traced(stages) => stages.encode(pass, offset, tile),
            MakerStages::Schwarzschild(Some(stages)) if begins => stages.encode(pass),
            MakerStages::Kerr(Some(stages)) if begins => stages.encode(pass),
            MakerStages::Schwarzschild(_) | MakerStages::Kerr(_) => {}
        }
        if let Some(half) = &self.half {
            half.encode(pass, offset, tile);
        }
    }
}

/// The stages that make the records of a tile before they are shaded.
struct TraceStages {
    trace: Stage,
    count: Stage,
}

/// The stages that trace pixels into `textures`.
fn trace_stages(
    device: &Device,
    kernels: &Kernels,
    variant: TraceVariant,
    textures: &[wgpu::BindingResource<'_>; 3],
    shared: &Shared<'_>,
) -> Result<TraceStages> {
    let [_, meta, _] = textures.clone();
    let Shared { pass, step_sum, .. } = shared.clone();
    Ok(TraceStages {
        trace: kernels
            .get(KernelKey::new(KernelKind::Pixels, &[&variant]))?
            .stage(device, &[&pixel_group(textures, shared)])?,
        count: kernels.get(KernelKind::Count)?.stage(device, &[&[pass, meta, step_sum]])?,
    })
}

impl TraceStages {
    /// Traces a tile of `width` x `height` pixels and its margin.
    fn encode(&self, pass: &mut wgpu::ComputePass<'_>, offset: u32, [width, height]: [u32; 2]) {
        self.trace.dispatch(pass, offset, [width + 2, height + 2]);
        self.count.dispatch(pass, offset, [(width + 2).div_ceil(COUNT_RUN), height + 2]);
    }
}

/// Bytes of the step sum.
pub const STEP_SUM: u64 = 4;

/// Creates the step sum that `Shared` holds.
pub fn step_sum(device: &Device) -> Result<Buffer> {
    use wgpu::BufferUsages as Usage;
    device.buffer("step sum", STEP_SUM, Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST)
}
