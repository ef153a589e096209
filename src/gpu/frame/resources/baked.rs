// SPDX-License-Identifier: MIT OR Apache-2.0
//! The structure of a frame's volumes as textures, made anew by emit/bake.wgsl where it is another than the last
//! frame's. Kernels write words of two texels into a buffer, which is copied into the texture: not every device stores
//! halves into one.

use super::cached_uniform::CachedUniform;
use super::filaments::FilamentTexture;
use crate::emit::baking::{BakeKey, Baking};
use crate::emit::grid::{GRID_LEVELS, Grid};
use crate::emit::volume::Volume;
use crate::error::{Error, Result};
use crate::gpu::device::buffer::{Buffer, uniform_stride};
use crate::gpu::device::texture::Texture;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::frame::uniforms::bake::BakeUniform;
use crate::gpu::kernel::kernels::Kernels;
use crate::gpu::kernel::key::KernelKind;
use crate::gpu::kernel::slots::BAKED;
use crate::gpu::kernel::stage::{Stage, check_groups, pixel_groups};
use wgpu::BufferUsages as Usage;

/// Columns of a thread of emit/bake.wgsl.
const COLUMNS: u32 = 4;

/// The structure of all volumes.
pub struct BakedTextures {
    /// The structure of each volume; `None` for even ones.
    volumes: [Option<BakedVolume>; Volume::MOST],
    /// A texel for volumes without.
    nothing: Texture,
    /// Linear between texels and levels; goes on around and across, and ends with the last row.
    sampler: wgpu::Sampler,
}

/// A level in the buffer of words.
#[derive(Clone, Copy)]
struct LevelWords {
    sides: [u32; 3],
    begin: u64,
    row_words: u32,
}

struct BakedVolume {
    /// The grid and the finest level, on which all sizes depend.
    size: (Grid, usize),
    /// The key of the structure in the texture, as far as that is known.
    held: Option<BakeKey>,
    levels: Vec<LevelWords>,
    texture: Texture,
    words: Buffer,
    uniforms: CachedUniform,
    generations: CachedUniform,
    motions: CachedUniform,
    /// The sizes of the last two.
    rows: [usize; 2],
}

/// The work that a frame begins with.
pub struct Bake {
    volumes: Vec<BakeVolume>,
    stride: u32,
}

struct BakeVolume {
    stage: Stage,
    levels: Vec<LevelWords>,
    words: wgpu::Buffer,
    texture: wgpu::Texture,
}

impl LevelWords {
    /// The place of each level, one after the other, in rows that copies into textures take.
    fn all(grid: &Grid, finest: usize) -> Vec<Self> {
        let mut begin = 0;
        let level = |level: usize| {
            let sides @ [columns, rows, layers] = grid.sides(level).map(|side| side as u32);
            let row_words = (columns / 2).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT / 4);
            let made = Self { sides, begin, row_words };
            begin += u64::from(row_words) * u64::from(rows) * u64::from(layers);
            made
        };
        (finest..GRID_LEVELS).map(level).collect()
    }

    fn end(&self) -> u64 {
        self.begin + u64::from(self.row_words) * u64::from(self.sides[1]) * u64::from(self.sides[2])
    }

    /// Threads across, and lines.
    fn threads(&self) -> [u32; 2] {
        [self.sides[0].div_ceil(COLUMNS), self.sides[1] * self.sides[2]]
    }
}

impl BakedVolume {
    fn new(device: &Device, key: &BakeKey, baking: &Baking) -> Result<Self> {
        let levels = LevelWords::all(&key.clouds.grid, key.finest);
        let finest = levels.first().ok_or_else(|| Error::internal("structure without levels"))?;
        let end = levels.last().map_or(0, LevelWords::end);
        let rows = [size_of_val(&baking.generations[..]), size_of_val(&baking.motions[..])];
        let stride = uniform_stride::<BakeUniform>(device);
        let storage = |label: &str, bytes: usize| CachedUniform::in_storage(device, label, bytes as u64);
        Ok(Self {
            size: (key.clouds.grid, key.finest),
            held: None,
            texture: device.block("structure", BAKED, finest.sides, levels.len() as u32)?,
            words: device.buffer("structure's words", 4 * end, Usage::STORAGE | Usage::COPY_SRC)?,
            uniforms: CachedUniform::new(device, "structure's levels", stride * levels.len() as u64)?,
            generations: storage("structure's generations", rows[0])?,
            motions: storage("structure's motions", rows[1])?,
            rows,
            levels,
        })
    }

    fn write(&mut self, device: &Device, baking: &Baking) -> Result<()> {
        let stride = uniform_stride::<BakeUniform>(device) as usize;
        let mut bytes = vec![0; stride * self.levels.len()];
        for ((level, words), bytes) in baking.levels.iter().zip(&self.levels).zip(bytes.chunks_exact_mut(stride)) {
            let uniform = BakeUniform::new(level, words.begin as u32, words.row_words);
            bytes[..size_of::<BakeUniform>()].copy_from_slice(bytemuck::bytes_of(&uniform));
        }
        self.uniforms.write(device, &bytes)?;
        self.generations.write(device, bytemuck::cast_slice(&baking.generations))?;
        self.motions.write(device, bytemuck::cast_slice(&baking.motions))
    }
}

impl BakedTextures {
    pub fn new(device: &Device) -> Result<Self> {
        let filter = wgpu::FilterMode::Linear;
        let sampler = wgpu::SamplerDescriptor {
            address_mode_u: wgpu::AddressMode::Repeat,
            address_mode_v: wgpu::AddressMode::ClampToEdge,
            address_mode_w: wgpu::AddressMode::Repeat,
            mag_filter: filter,
            min_filter: filter,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        };
        Ok(Self {
            volumes: Default::default(),
            nothing: device.block("no structure", BAKED, [1; 3], 1)?,
            sampler: device.scoped("structure", |device| device.create_sampler(&sampler))?,
        })
    }

    /// Makes room for the structure of volumes, and writes what it is made from where it is not there. Errors: as
    /// [`Device::scoped`]; OUT_OF_MEMORY.
    pub fn update(&mut self, device: &Device, keys: &[Option<BakeKey>]) -> Result<()> {
        for (volume, key) in self.volumes.iter_mut().zip(keys.iter().chain(std::iter::repeat(&None))) {
            let Some(key) = key else {
                if volume.take().is_some() {
                    device.bindings.clear();
                }
                continue;
            };
            if volume.as_ref().is_some_and(|held| held.held.as_ref() == Some(key)) {
                continue;
            }
            let baking = Baking::new(key)?;
            let rows = [size_of_val(&baking.generations[..]), size_of_val(&baking.motions[..])];
            let fits = |held: &BakedVolume| held.size == (key.clouds.grid, key.finest) && held.rows == rows;
            if !volume.as_ref().is_some_and(fits) {
                // The old one goes first: both together need not fit.
                *volume = None;
                device.bindings.clear();
            }
            let volume = match volume {
                Some(volume) => volume,
                None => volume.insert(BakedVolume::new(device, key, &baking)?),
            };
            volume.held = None;
            volume.write(device, &baking)?;
        }
        Ok(())
    }

    /// The work that a frame with these volumes begins with, after [`Self::update`]; `None`: the textures hold their
    /// structure. A frame that is not submitted must be followed by [`Self::forget`]. Errors: as [`Device::scoped`].
    pub fn bake(
        &mut self,
        device: &Device,
        kernels: &Kernels,
        filaments: &FilamentTexture,
        keys: &[Option<BakeKey>],
    ) -> Result<Option<Bake>> {
        let mut bake = Bake { volumes: Vec::new(), stride: uniform_stride::<BakeUniform>(device) as u32 };
        for (volume, key) in self.volumes.iter_mut().zip(keys) {
            let (Some(volume), Some(key)) = (volume, key) else { continue };
            if volume.held.as_ref() == Some(key) {
                continue;
            }
            let [texture, sampler] = filaments.resources();
            let size = std::num::NonZeroU64::new(size_of::<BakeUniform>() as u64);
            let level = wgpu::BufferBinding { buffer: volume.uniforms.buffer(), offset: 0, size };
            let bound = [
                wgpu::BindingResource::Buffer(level),
                volume.generations.buffer.as_entire_binding(),
                volume.motions.buffer.as_entire_binding(),
                texture,
                sampler,
                volume.words.as_entire_binding(),
            ];
            for level in &volume.levels {
                check_groups(device, pixel_groups(level.threads()))?;
            }
            bake.volumes.push(BakeVolume {
                stage: kernels.get(KernelKind::Bake)?.stage(device, &[&bound])?,
                levels: volume.levels.clone(),
                words: (*volume.words).clone(),
                texture: volume.texture.clone_raw(),
            });
            volume.held = Some(*key);
        }
        Ok((!bake.volumes.is_empty()).then_some(bake))
    }

    /// After a frame that failed or was left, nobody knows what the textures hold.
    pub fn forget(&mut self) {
        for volume in self.volumes.iter_mut().flatten() {
            volume.held = None;
            for written in [&mut volume.uniforms, &mut volume.generations, &mut volume.motions] {
                written.forget();
            }
        }
    }

    /// The textures of all volumes, and their sampler.
    pub fn resources(&self) -> [wgpu::BindingResource<'_>; 1 + Volume::MOST] {
        std::array::from_fn(|i| match self.volumes.get(i) {
            Some(volume) => {
                let texture = volume.as_ref().map_or(&self.nothing, |volume| &volume.texture);
                wgpu::BindingResource::TextureView(&texture.view)
            }
            None => wgpu::BindingResource::Sampler(&self.sampler),
        })
    }
}

impl Bake {
    /// All of it.
    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder) {
        self.dispatch(&mut encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default()));
        self.copy(encoder);
    }

    /// Makes the texels.
    pub fn dispatch(&self, pass: &mut wgpu::ComputePass<'_>) {
        for volume in &self.volumes {
            for (level, number) in volume.levels.iter().zip(0..) {
                volume.stage.dispatch(pass, number * self.stride, level.threads());
            }
        }
    }

    /// After [`Self::dispatch`]: brings them into the textures.
    pub fn copy(&self, encoder: &mut wgpu::CommandEncoder) {
        for volume in &self.volumes {
            for (level, mip_level) in volume.levels.iter().zip(0..) {
                let [width, height, depth_or_array_layers] = level.sides;
                let layout = wgpu::TexelCopyBufferLayout {
                    offset: 4 * level.begin,
                    bytes_per_row: Some(4 * level.row_words),
                    rows_per_image: Some(height),
                };
                let to = wgpu::TexelCopyTextureInfo { mip_level, ..volume.texture.as_image_copy() };
                let extent = wgpu::Extent3d { width, height, depth_or_array_layers };
                let buffer = wgpu::TexelCopyBufferInfo { buffer: &volume.words, layout };
                encoder.copy_buffer_to_texture(buffer, to, extent);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emit::baked::Baked;
    use crate::emit::bands::When;
    use crate::emit::matter::{Accuracy, VolumeMatter};
    use crate::emit::volume::{FlowLaw, Shape, Volume};
    use crate::gpu::device::readback::Readback;
    use crate::gpu::{GpuTracer, Search, adapters};
    use crate::tracer::Backend;
    use half::f16;

    /// Every texel of every level is the CPU's, as far as samplers go, which weigh texels in steps of 1/256.
    #[test]
    fn texels_are_those_of_the_cpu() {
        let adapter = adapters(Search::Only(Backend::Vulkan), false).into_iter().next().expect("a Vulkan adapter");
        let tracer = GpuTracer::new(adapter).unwrap();
        let (device, kernels) = (&tracer.device, &tracer.kernels);
        let when = When { time: 777.0, reference_delay: 0.0, delayed: true, shutter: 0.0 };
        let disk = Volume { seed: 5, ..Volume::default() };
        let (flow, thickness) = (FlowLaw::AngularMomentum, 0.3);
        let torus = Volume { shape: Shape::Torus, flow, thickness, ..disk };
        let jet = Volume { shape: Shape::Jet, flow: FlowLaw::Outflow, thickness: 0.05, ..disk };
        let keys = [disk, torus, jet].map(|volume| {
            let matter = VolumeMatter::new(&volume, 0.7, &when, Accuracy::PICTURE).expect("matter");
            matter.bake_key(0.7, 1.0, 0.0).map(|key| BakeKey { finest: 1, ..key })
        });
        let mut filaments = FilamentTexture::new(device).unwrap();
        filaments.make(device).unwrap();
        let mut baked = BakedTextures::new(device).unwrap();
        baked.update(device, &keys).unwrap();
        let bake = baked.bake(device, kernels, &filaments, &keys).unwrap().expect("work");
        let mut encoder = device.encoder("structure").unwrap();
        bake.encode(&mut encoder);
        let readback = Readback::new();
        let copied = baked
            .volumes
            .iter()
            .flatten()
            .map(|volume| readback.copy(device, &mut encoder, &volume.words, volume.words.size()).unwrap());
        let copied = copied.collect::<Vec<_>>();
        let submission = device.submit(encoder).unwrap();
        for ((copied, volume), key) in copied.into_iter().zip(baked.volumes.iter().flatten()).zip(keys.iter().flatten())
        {
            let words = copied.read(device, &submission, |bytes| Ok(bytemuck::pod_collect_to_vec::<u8, u32>(bytes)));
            let words = words.unwrap();
            let expected = Baked::new(key).unwrap();
            for (level, texels) in volume.levels.iter().zip(expected.texels()) {
                let columns = level.sides[0] as usize;
                let (mut worst, mut sum) = (0.0_f64, 0.0);
                for (i, expected) in texels.iter().enumerate() {
                    let (line, column) = (i / columns, i % columns);
                    let word = words[level.begin as usize + line * level.row_words as usize + column / 2];
                    let half = f16::from_bits((word >> (16 * (column % 2))) as u16).to_f64();
                    let off = (half / f64::from(*expected)).ln().abs();
                    (worst, sum) = (worst.max(off), sum + off);
                }
                let mean = sum / texels.len() as f64;
                println!("{:?} {:?}: off by {mean:.5}, at worst {worst:.4}", key.cloud.shape, level.sides);
                assert!(worst < 0.1 && mean < 4e-3, "{:?} {:?}: {mean} {worst}", key.cloud.shape, level.sides);
            }
        }
        // The textures hold it now.
        assert!(baked.bake(device, kernels, &filaments, &keys).unwrap().is_none());
        baked.forget();
        baked.update(device, &keys).unwrap();
        assert!(baked.bake(device, kernels, &filaments, &keys).unwrap().is_some());
    }
}
