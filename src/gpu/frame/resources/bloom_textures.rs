// SPDX-License-Identifier: MIT OR Apache-2.0
//! The textures and uniforms of bloom: the light of a frame, or of a tile of it, and the grids that it spreads over.
//! What goes where, and why, is in src/film/bloom.rs. Knows no kernels.

use super::cached_uniform::CachedUniform;
use super::ghost_buffers::GhostResources;
use super::spike_buffers::SpikeResources;
use crate::error::{Error, Result};
use crate::film::bloom::{BEAM_SHARES, Beam, Bloom, Level, MOST_LEVELS, TAIL};
use crate::gpu::device::buffer::uniform_stride;
use crate::gpu::device::texture::Texture;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::kernel::slots::{LIGHT, TextureKind};
use crate::tracer::Tile;
use bytemuck::{Pod, Zeroable};

/// Bytes of a pixel's light.
pub const LIGHT_BYTES: u64 = 8;

/// `BloomLevel` of bloom/level.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct LevelUniform {
    fine: [u32; 2],
    cells: [u32; 2],
    origin: [i32; 2],
    first: [u32; 2],
    count: [u32; 2],
    own: f32,
    above: f32,
    tails: [[f32; TAIL]; 2],
}

/// `BeamPass` of bloom/beam.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct BeamUniform {
    cells: [u32; 2],
    next: [i32; 2],
    shares: [f32; BEAM_SHARES],
}

#[cfg(test)]
pub(in crate::gpu) fn layouts() -> [crate::gpu::kernel::layout::Layout; 2] {
    use crate::gpu::kernel::layout::layout;
    let level = layout!(LevelUniform as "BloomLevel": fine, cells, origin, first, count, own, above,
        tail_x = tails + 0, tail_y = tails + 16);
    [level, layout!(BeamUniform as "BeamPass": cells, next, shares)]
}

/// Textures that frames with bloom share; they grow and stay.
#[derive(Default)]
pub struct BloomBuffers {
    resources: Option<BloomResources>,
}

pub struct BloomResources {
    /// Exposed, of a frame or a tile.
    pub light: Texture,
    /// Mean light, from the finest grid on.
    pub gathered: Vec<Texture>,
    /// Light that each grid but the last, and those above it, spread.
    pub spread: Vec<Texture>,
    /// Linear between the centres of cells.
    smooth: wgpu::Sampler,
    /// A `LevelUniform` for each grid, `uniform_stride` apart.
    levels: CachedUniform,
    pub beam: Option<BeamResources>,
    pub ghosts: Option<GhostResources>,
    pub spikes: Option<SpikeResources>,
}

pub struct BeamResources {
    /// The light of the beam's grid once it is spread along rows.
    pub rows: Texture,
    /// A `BeamUniform` for rows and one for columns, `uniform_stride` apart.
    pub passes: CachedUniform,
}

/// Sizes of the frame or grid that each level lies over.
fn finer(bloom: &Bloom) -> impl Iterator<Item = [u32; 2]> {
    std::iter::once(bloom.frame).chain(bloom.levels.iter().map(|level| level.size))
}

impl BloomResources {
    fn new(device: &Device, bloom: &Bloom, light: [u32; 2]) -> Result<Self> {
        let TextureKind { format, dimension } = LIGHT;
        let texture = |label: &str, size: [u32; 2]| device.texture(label, format, dimension, size, 1);
        let grids = |label: &str, levels: &[Level]| {
            levels.iter().map(|level| texture(label, level.size)).collect::<Result<Vec<_>>>()
        };
        let but_last = &bloom.levels[..bloom.levels.len().saturating_sub(1)];
        let beam = bloom.beam.as_ref().zip(beam_size(bloom)).map(|(beam, size)| {
            let mut passes = CachedUniform::new(device, "beam", 2 * uniform_stride::<BeamUniform>(device))?;
            passes.write(device, &beam_uniforms(device, beam, size))?;
            Ok::<_, Error>(BeamResources { rows: texture("light of a beam", size)?, passes })
        });
        let cells = bloom.levels.first().map_or([1, 1], |base| base.size);
        let ghosts = bloom.ghosts.as_ref().map(|ghosts| GhostResources::new(device, ghosts, cells));
        let spikes = bloom.spikes.as_ref().map(|spikes| SpikeResources::new(device, spikes, cells));
        let bytes = MOST_LEVELS as u64 * uniform_stride::<LevelUniform>(device);
        let filter = wgpu::FilterMode::Linear;
        let sampler = wgpu::SamplerDescriptor { mag_filter: filter, min_filter: filter, ..Default::default() };
        Ok(Self {
            smooth: device.scoped("bloom", |device| device.create_sampler(&sampler))?,
            light: texture("light", light)?,
            gathered: grids("gathered light", &bloom.levels)?,
            spread: grids("spread light", but_last)?,
            levels: CachedUniform::new(device, "bloom levels", bytes)?,
            beam: beam.transpose()?,
            ghosts: ghosts.transpose()?,
            spikes: spikes.transpose()?,
        })
    }

    /// Textures of exactly these sizes: how samplers round depends on them, and bytes must not depend on earlier
    /// frames.
    fn serves(&self, device: &Device, bloom: &Bloom, light: [u32; 2]) -> bool {
        let spikes = match (&self.spikes, &bloom.spikes) {
            (Some(made), Some(spikes)) => made.serves(device, spikes),
            (made, spikes) => made.is_none() && spikes.is_none(),
        };
        let ghosts = self.ghosts.as_ref().map(|made| made.drawn.size());
        let sizes = self.gathered.iter().map(Texture::size);
        spikes
            && ghosts == bloom.ghosts.as_ref().map(|ghosts| ghosts.numbers.target_cells)
            && self.light.size() == light
            && sizes.eq(bloom.levels.iter().map(|level| level.size))
            && self.beam.as_ref().map(|beam| beam.rows.size()) == beam_size(bloom)
    }

    /// The light that the finest grid spreads.
    fn glare(&self, bloom: &Bloom) -> Result<&Texture> {
        match (&bloom.spikes, &self.spikes) {
            (Some(spikes), Some(made)) => made.sum(spikes),
            _ => self.glare_before_spikes(bloom),
        }
    }

    /// The light that the finest grid spreads before any is thrown along lines.
    pub fn glare_before_spikes(&self, bloom: &Bloom) -> Result<&Texture> {
        match &self.ghosts {
            Some(ghosts) => Ok(&ghosts.sum),
            None => self.glare_before_ghosts(bloom),
        }
    }

    /// The light that the finest grid spreads before what a lens reflects or throws along lines.
    pub fn glare_before_ghosts(&self, bloom: &Bloom) -> Result<&Texture> {
        let grids = if bloom.levels.len() > 1 { &self.spread } else { &self.gathered };
        grids.first().ok_or_else(|| Error::internal("bloom without a grid"))
    }

    pub fn smooth(&self) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::Sampler(&self.smooth)
    }

    pub fn level(&self) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: self.levels.buffer(),
            offset: 0,
            size: std::num::NonZeroU64::new(size_of::<LevelUniform>() as u64),
        })
    }
}

pub fn view(texture: &Texture) -> wgpu::BindingResource<'_> {
    wgpu::BindingResource::TextureView(&texture.view)
}

impl BloomBuffers {
    pub fn resources(&self) -> Result<&BloomResources> {
        self.resources.as_ref().ok_or_else(|| Error::internal("bloom without textures"))
    }

    /// Makes room for a frame of which `light` pixels are held at once.
    pub fn prepare(&mut self, device: &Device, bloom: &Bloom, light: [u32; 2]) -> Result<()> {
        if !self.resources.as_ref().is_some_and(|resources| resources.serves(device, bloom, light)) {
            // The old ones go first: both together need not fit.
            self.resources = None;
            self.resources = Some(BloomResources::new(device, bloom, light)?);
        }
        Ok(())
    }

    /// Before a submission that gathers `cells` of the finest grid, of light that begins at `origin`, or develops.
    pub fn write(&mut self, device: &Device, bloom: &Bloom, origin: [u32; 2], cells: Tile) -> Result<()> {
        let stride = uniform_stride::<LevelUniform>(device) as usize;
        let mut bytes = vec![0; bloom.levels.len() * stride];
        for (index, ((slot, level), fine)) in
            bytes.chunks_exact_mut(stride).zip(&bloom.levels).zip(finer(bloom)).enumerate()
        {
            let below = index.checked_sub(1).and_then(|below| bloom.levels.get(below));
            let base = below.is_none();
            let uniform = LevelUniform {
                fine,
                cells: level.size,
                origin: if base { origin.map(|v| v as i32) } else { [0, 0] },
                first: if base { [cells.x, cells.y] } else { [0, 0] },
                count: if base { [cells.width, cells.height] } else { level.size },
                own: below.map_or(bloom.direct, |below| below.weight),
                above: bloom.weight_above(index),
                tails: below.map_or([[1.0; TAIL]; 2], Level::tails),
            };
            slot[..size_of::<LevelUniform>()].copy_from_slice(bytemuck::bytes_of(&uniform));
        }
        let resources = self.resources.as_mut().ok_or_else(|| Error::internal("bloom without textures"))?;
        if let Some(((beam, size), made)) = bloom.beam.as_ref().zip(beam_size(bloom)).zip(resources.beam.as_mut()) {
            made.passes.write(device, &beam_uniforms(device, beam, size))?;
        }
        if let Some((ghosts, made)) = bloom.ghosts.as_ref().zip(resources.ghosts.as_mut()) {
            made.write(device, ghosts)?;
        }
        if let Some((spikes, made)) = bloom.spikes.as_ref().zip(resources.spikes.as_mut()) {
            made.write(device, spikes)?;
        }
        resources.levels.write(device, &bytes)
    }

    /// After a submission that failed, nobody knows what the buffers hold.
    pub fn forget(&mut self) {
        if let Some(resources) = &mut self.resources {
            resources.levels.forget();
            resources.beam.iter_mut().for_each(|beam| beam.passes.forget());
            resources.ghosts.iter_mut().for_each(GhostResources::forget);
            resources.spikes.iter_mut().for_each(SpikeResources::forget);
        }
    }

    /// The texture that takes the shaded light.
    pub fn light(&self) -> Result<wgpu::BindingResource<'_>> {
        Ok(view(&self.resources()?.light))
    }

    /// The mean light of the finest grid's cells, and what spreads from there; both once all light is there.
    pub fn cells(&self, bloom: &Bloom) -> Result<[wgpu::BindingResource<'_>; 2]> {
        let resources = self.resources()?;
        let gathered = resources.gathered.first().ok_or_else(|| Error::internal("bloom without a grid"))?;
        Ok([view(gathered), view(resources.glare(bloom)?)])
    }

    /// The begin of group 1 of development.
    pub fn group(&self, bloom: &Bloom) -> Result<[wgpu::BindingResource<'_>; 4]> {
        let resources = self.resources()?;
        Ok([view(&resources.light), view(resources.glare(bloom)?), resources.smooth(), resources.level()])
    }
}

/// The size of the grid that the beam spreads.
fn beam_size(bloom: &Bloom) -> Option<[u32; 2]> {
    bloom.levels.get(bloom.beam.as_ref()?.level).map(|level| level.size)
}

fn beam_uniforms(device: &Device, beam: &Beam, cells: [u32; 2]) -> Vec<u8> {
    let stride = uniform_stride::<BeamUniform>(device) as usize;
    let mut bytes = vec![0; 2 * stride];
    for (slot, next) in bytes.chunks_exact_mut(stride).zip([[1, 0], [0, 1]]) {
        let uniform = BeamUniform { cells, next, shares: beam.shares };
        slot[..size_of::<BeamUniform>()].copy_from_slice(bytemuck::bytes_of(&uniform));
    }
    bytes
}
