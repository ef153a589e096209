// SPDX-License-Identifier: MIT OR Apache-2.0
//! The sky maps of a scene as textures: the Milky Way's, made when it is first shown, and the host's, made anew when
//! it is another.

use super::sky_target::{SkyFetch, SkyTarget};
use super::sky_texture::{MapTexture, level_place, texture_height};
use crate::error::{Error, Result};
use crate::gpu::device::texture::Texture;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::kernel::kernels::Kernels;
use crate::gpu::kernel::slots::SKY_MAP;
use crate::scene::Scene;
use crate::sky::{Level, SkyMap};
use std::sync::{Arc, Weak};

/// Bytes that are written in one submission, about: until it has run, the driver keeps a copy of them.
const BAND_BYTES: usize = 16 << 20;

pub struct SkyMaps {
    milky_way: Option<MapTexture>,
    /// Together with what it was made from.
    map: Option<(Weak<SkyMap>, MapTexture)>,
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
            self.map = Some((Arc::downgrade(map), upload(device, map, for_sampler)?));
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

/// All levels in one texture: as its own, or, without a sampler, the finest on top, below it the others side by side
/// (`level_place` of sky/map.wgsl), because lavapipe (Mesa 22.3) takes the size of a texture's level for the size of
/// another where pixels of a workgroup read texels of different ones. Levels that do not fit into a texture are left
/// out.
fn upload(device: &Device, map: &SkyMap, for_sampler: bool) -> Result<MapTexture> {
    let limit = device.limits().max_texture_dimension_2d;
    let height = |level: &Level| if for_sampler { level.size[1] } else { texture_height(level.size) };
    let fitting = |level: &&Level| level.size[0] <= limit && height(level) <= limit;
    let levels = map.levels();
    let first = levels.iter().position(|level| fitting(&level)).unwrap_or(levels.len());
    let levels = levels.get(first..).unwrap_or(&[]);
    let finest = levels.first().ok_or_else(|| Error::internal("a sky map without levels"))?.size;
    let texture = match for_sampler {
        true => device.table_of_levels("sky map", SKY_MAP.format, finest, levels.len() as u32)?,
        false => device.table("sky map", SKY_MAP.format, [finest[0], texture_height(finest)])?,
    };
    let mut written = 0;
    for (level, number) in levels.iter().zip(0..) {
        let (own, [left, top]) = if for_sampler { (number, [0, 0]) } else { (0, level_place(finest, number)) };
        let width = level.size[0] as usize;
        let band_rows = (BAND_BYTES / size_of::<u32>() / width).max(1);
        for (band, row) in level.texels.chunks(band_rows * width).zip((top..).step_by(band_rows)) {
            device.write_part(&texture, own, [left, row], level.size[0], bytemuck::cast_slice(band))?;
            written += size_of_val(band);
            if written >= BAND_BYTES {
                written = 0;
                device.submit_and_wait(device.encoder("sky map")?)?;
            }
        }
    }
    Ok(MapTexture { texture, finest })
}
