// SPDX-License-Identifier: MIT OR Apache-2.0
//! The sky maps of a scene as textures: the Milky Way's, made when it is first shown, and the host's, made anew when
//! it is another.

use super::sky_target::{SkyFetch, SkyTarget};
use super::sky_texture::{MapTexture, level_place, texture_height};
use crate::allocate::filled;
use crate::error::{Error, Result};
use crate::gpu::device::texture::Texture;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::kernel::kernels::Kernels;
use crate::gpu::kernel::slots::SKY_MAP;
use crate::image::bc6h::{Blocks, SIDE};
use crate::scene::Scene;
use crate::sky::{CompressedMap, RowReader, SkyMap, StoredMap};
use std::ops::Range;
use std::sync::{Arc, Weak};

/// Bytes that are written in one submission, about: until it has run, the driver keeps a copy of them.
const BAND_BYTES: usize = 16 << 20;

pub struct SkyMaps {
    milky_way: Option<MapTexture>,
    /// Together with what it was made from.
    map: Option<(Weak<StoredMap>, MapTexture)>,
    /// In its place: one that lies in a target of the host's.
    target: Option<SkyTarget>,
    /// A dark texel, bound in the place of what is not shown.
    nothing: MapTexture,
    sampler: wgpu::Sampler,
    /// The maps have their levels as textures do, for the sampler.
    for_sampler: bool,
}

impl SkyMaps {
    pub fn new(device: &Device) -> Result<Self> {
        let texture = device.table("no sky map", SKY_MAP.format, [1, 1])?;
        device.write_rows(&texture, 0, &[0; 4])?;
        let filter = wgpu::FilterMode::Linear;
        let sampler = wgpu::SamplerDescriptor {
            label: Some("sky maps"),
            address_mode_u: wgpu::AddressMode::Repeat,
            mag_filter: filter,
            min_filter: filter,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        };
        Ok(Self {
            milky_way: None,
            map: None,
            target: None,
            nothing: MapTexture { texture, finest: [1, 1] },
            sampler: device.scoped("sky maps", |device| device.create_sampler(&sampler))?,
            for_sampler: false,
        })
    }

    /// The Milky Way's and the host's.
    fn bound(&self) -> [&MapTexture; 2] {
        let map = self.target.as_ref().map(|target| &target.map).or(self.map.as_ref().map(|(_, map)| map));
        [self.milky_way.as_ref(), map].map(|map| map.unwrap_or(&self.nothing))
    }

    /// The Milky Way's and the host's.
    pub fn textures(&self) -> [&Texture; 2] {
        self.bound().map(|map| &map.texture)
    }

    pub fn sampler(&self) -> &wgpu::Sampler {
        &self.sampler
    }

    /// Columns and rows of their finest levels.
    pub fn sizes(&self) -> [[u32; 2]; 2] {
        self.bound().map(|map| map.finest)
    }

    /// Brings them up to the scene: a map that is not shown keeps its texture as long as the scene has it.
    /// `for_sampler`: a sampler is to filter them. Errors: as [`Device::scoped`]; the texture is then made when it is
    /// needed next.
    pub fn update(&mut self, device: &Device, scene: &Scene, for_sampler: bool) -> Result<()> {
        if for_sampler != self.for_sampler {
            (self.milky_way, self.map, self.target) = (None, None, None);
            self.for_sampler = for_sampler;
            device.bindings.clear();
        }
        if scene.shows_milky_way() && self.milky_way.is_none() {
            self.milky_way = Some(upload(device, SkyMap::milky_way()?, for_sampler)?);
        }
        let made_from = self.map.as_ref().map(|(map, _)| map.as_ptr());
        if made_from.is_some() && made_from != scene.sky_map.as_ref().map(Arc::as_ptr) {
            // Before the next one is made: both together need not fit.
            self.map = None;
            device.bindings.clear();
        }
        let serves =
            |target: &SkyTarget| scene.sky_picture.as_ref().is_some_and(|picture| target.serves(picture, for_sampler));
        if self.target.as_ref().is_some_and(|target| !serves(target)) {
            self.target = None;
            device.bindings.clear();
        }
        if let (Some(picture), None) = (scene.shown_picture(), &self.target) {
            self.target = Some(SkyTarget::new(device, picture, for_sampler)?);
        }
        if let (Some(map), None) = (scene.shown_map(), &self.map) {
            self.map = Some((Arc::downgrade(map), upload_stored(device, map, for_sampler)?));
        }
        Ok(())
    }
}

impl SkyMaps {
    /// The work that a frame of the scene begins with; `None`: the host's map is no target, or not shown. Errors: as
    /// [`SkyTarget::fetch`].
    pub fn fetch(&self, device: &Device, kernels: &Kernels, scene: &Scene) -> Result<Option<SkyFetch>> {
        let shown = scene.shown_picture().zip(self.target.as_ref());
        shown.map(|(picture, target)| target.fetch(device, kernels, picture)).transpose()
    }
}

/// All levels of a map of texels in one texture: as its own, or, without a sampler, the finest on top, below it the
/// others side by side (`level_place` of sky/map.wgsl), because lavapipe (Mesa 22.3) takes the size of a texture's
/// level for the size of another where pixels of a workgroup read texels of different ones. Levels that do not fit into
/// a texture are left out.
fn upload(device: &Device, map: &SkyMap, for_sampler: bool) -> Result<MapTexture> {
    let sizes = map.levels().iter().map(|level| level.size).collect::<Vec<_>>();
    upload_texels(device, &sizes, for_sampler, &mut |level, rows, texels| {
        let level = &map.levels()[level];
        rows.zip(texels.chunks_mut(level.size[0] as usize)).for_each(|(y, row)| row.copy_from_slice(level.row(y)));
        Ok(())
    })
}

/// A map of the host's: in its blocks where device and sampler read them, else in texels.
fn upload_stored(device: &Device, map: &StoredMap, for_sampler: bool) -> Result<MapTexture> {
    let Some(blocks) = map.blocks() else { return upload(device, map.texels()?, for_sampler) };
    if for_sampler && let Some(texture) = upload_blocks(device, blocks)? {
        return Ok(texture);
    }
    let sizes = blocks.levels().iter().map(|level| level.size).collect::<Vec<_>>();
    let mut reader = None;
    upload_texels(device, &sizes, for_sampler, &mut |number, rows, texels| {
        let level = &blocks.levels()[number];
        let kept = reader.take().filter(|(of, _)| *of == number);
        let (_, rows_of) = reader.insert(match kept {
            Some(kept) => kept,
            None => (number, RowReader::new(level)?),
        });
        rows.zip(texels.chunks_mut(level.size[0] as usize)).for_each(|(y, row)| rows_of.read_texels(y, row));
        Ok(())
    })
}

/// `None` where the device has no such textures, or where four does not divide a side of the finest level that fits.
fn upload_blocks(device: &Device, map: &CompressedMap) -> Result<Option<MapTexture>> {
    let limit = device.limits().max_texture_dimension_2d;
    let levels = map.levels();
    let first = levels.iter().position(|level| level.size.iter().all(|side| *side <= limit)).unwrap_or(levels.len());
    let levels = levels.get(first..).unwrap_or(&[]);
    let whole = |level: &&Blocks| level.size.iter().all(|side| side.is_multiple_of(SIDE));
    let Some(finest) = levels.first().filter(whole).filter(|_| device.has_blocks()) else { return Ok(None) };
    let format = wgpu::TextureFormat::Bc6hRgbUfloat;
    let texture = device.table_of_levels("sky map", format, finest.size, levels.len() as u32)?;
    let mut written = Written::default();
    for (level, number) in levels.iter().zip(0..) {
        let across = Blocks::count(level.size)[0];
        let band_rows = (BAND_BYTES / size_of::<[u8; 16]>() / across).max(1);
        let tops = (0..).step_by(band_rows * SIDE as usize);
        for (band, top) in level.blocks.chunks(band_rows * across).zip(tops) {
            device.write_part(&texture, number, [0, top], level.size[0], band.as_flattened())?;
            written.add(device, size_of_val(band))?;
        }
    }
    Ok(Some(MapTexture { texture, finest: finest.size }))
}

/// Bytes that have been written since a submission.
#[derive(Default)]
struct Written(usize);

impl Written {
    /// Errors: as [`Device::submit_and_wait`].
    fn add(&mut self, device: &Device, bytes: usize) -> Result<()> {
        self.0 += bytes;
        if self.0 < BAND_BYTES {
            return Ok(());
        }
        self.0 = 0;
        device.submit_and_wait(device.encoder("sky map")?)
    }
}

/// Writes some rows of the level of this number into texels.
type TexelReader<'a> = dyn FnMut(usize, Range<u32>, &mut [u32]) -> Result<()> + 'a;

/// The texture of [`upload`], of levels of these sizes.
fn upload_texels(
    device: &Device,
    sizes: &[[u32; 2]],
    for_sampler: bool,
    read: &mut TexelReader<'_>,
) -> Result<MapTexture> {
    let limit = device.limits().max_texture_dimension_2d;
    let height = |size: [u32; 2]| if for_sampler { size[1] } else { texture_height(size) };
    let first = sizes.iter().position(|size| size[0] <= limit && height(*size) <= limit).unwrap_or(sizes.len());
    let sizes = sizes.get(first..).unwrap_or(&[]);
    let finest = *sizes.first().ok_or_else(|| Error::internal("a sky map without levels"))?;
    let texture = match for_sampler {
        true => device.table_of_levels("sky map", SKY_MAP.format, finest, sizes.len() as u32)?,
        false => device.table("sky map", SKY_MAP.format, [finest[0], texture_height(finest)])?,
    };
    let mut written = Written::default();
    let band_texels = (BAND_BYTES / size_of::<u32>()).max(finest[0] as usize);
    let mut texels = filled(band_texels.min(finest[0] as usize * finest[1] as usize), 0, "texels of a sky map")?;
    for (size, number) in sizes.iter().zip(0_u32..) {
        let (own, [left, top]) = if for_sampler { (number, [0, 0]) } else { (0, level_place(finest, number)) };
        let width = size[0] as usize;
        let band_rows = (band_texels / width) as u32;
        for row in (0..size[1]).step_by(band_rows as usize) {
            let rows = row..(row + band_rows).min(size[1]);
            let band = &mut texels[..rows.len() * width];
            read(first + number as usize, rows, band)?;
            device.write_part(&texture, own, [left, top + row], size[0], bytemuck::cast_slice(band))?;
            written.add(device, size_of_val(band))?;
        }
    }
    Ok(MapTexture { texture, finest })
}
