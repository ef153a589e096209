// SPDX-License-Identifier: MIT OR Apache-2.0
//! Tables that shading reads on the GPU: blackbody colours, stars, the mean sky (made anew when the scene shows other
//! stars), the disk's temperature profile (made anew when the matter's spin changes), and the places
//! of hot spots in free fall, of each frame. Textures of TABLE_WIDTH
//! entries a row (shade/shade.wgsl says why). Beside them lie pictures: sky maps, the streaks of the disk, and the
//! filaments and the structure of matter with depth, and the film's LUT.

use super::baked::{Bake, BakedTextures};
use super::filaments::FilamentTexture;
use super::lut_texture::LutTexture;
use super::occluder::OccluderTexture;
use super::sky_maps::SkyMaps;
use super::streaks::StreakTexture;
use crate::allocate::{collected, with_room};
use crate::emit::thin_disk::profile_row;
use crate::emit::volume::Volume;
use crate::error::{Error, Result};
use crate::gpu::device::texture::Texture;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::frame::plan::setup::Setup;
use crate::gpu::kernel::kernels::Kernels;
use crate::gpu::kernel::sizes::TABLE_WIDTH;
use crate::physics::disk_flux::TemperatureProfile;
use crate::scene::Scene;
use crate::sky::StarIndex;
use crate::sky::index::{PLACES_OFFSET, PLACES_SIZE, PROFILE_OFFSET, PROFILE_SIZE};
use std::sync::Arc;

/// Rows that are written at once: 4 MiB.
const WRITTEN_ROWS: usize = 128;

const PROFILE_ROW: u32 = (PROFILE_OFFSET / TABLE_WIDTH) as u32;
const PLACES_ROW: u32 = (PLACES_OFFSET / TABLE_WIDTH) as u32;
const _: () = assert!(PLACES_OFFSET.is_multiple_of(TABLE_WIDTH) && PLACES_SIZE.is_multiple_of(TABLE_WIDTH));
const _: () = assert!(PROFILE_OFFSET.is_multiple_of(TABLE_WIDTH) && PROFILE_SIZE == TABLE_WIDTH);
const _: () = assert!(PROFILE_SIZE == TemperatureProfile::SIZE);

pub struct Tables {
    /// The stars that the textures hold.
    stars: Arc<StarIndex>,
    /// Blackbodies, mean sky, profile, places of hot spots, stars: `light_tables` of the shaders.
    light: Texture,
    star_cells: Texture,
    sky_maps: SkyMaps,
    streaks: StreakTexture,
    filaments: FilamentTexture,
    baked: BakedTextures,
    occluder: OccluderTexture,
    lut: LutTexture,
    /// Spin as the disk's matter meets it, of the profile in the texture.
    profile_spin: Option<f64>,
    /// `Uploads::lost` when they were made: after another number nobody knows what they hold.
    lost_uploads: u64,
}

/// A part of the tables beside the stars; a page updates each in a task of its own.
#[derive(Clone, Copy)]
pub enum TablePart {
    SkyMaps,
    Streaks,
    Filaments,
    Others,
}

impl TablePart {
    pub const ALL: [Self; 4] = [Self::SkyMaps, Self::Streaks, Self::Filaments, Self::Others];
}

/// The pictures that are kept when the stars change.
type Pictures = (SkyMaps, StreakTexture, (FilamentTexture, BakedTextures), (OccluderTexture, LutTexture));

/// A texture of `size` entries in rows, the last one filled up.
fn table<T: bytemuck::Pod>(
    device: &Device,
    label: &str,
    format: wgpu::TextureFormat,
    size: usize,
    entries: impl Iterator<Item = T>,
) -> Result<Texture> {
    let (rows, limit) = (size.div_ceil(TABLE_WIDTH), device.limits().max_texture_dimension_2d);
    if rows > limit as usize {
        let message = format!("the sky's {label} take a texture of {rows} rows; this device's limit is {limit}");
        return Err(Error::unsupported(message));
    }
    let texture = device.table(label, format, [TABLE_WIDTH as u32, rows as u32])?;
    let mut entries = entries.take(size).fuse();
    let mut written = with_room(WRITTEN_ROWS.min(rows) * TABLE_WIDTH, label)?;
    for first_row in (0..rows).step_by(WRITTEN_ROWS) {
        written.clear();
        written.extend(entries.by_ref().take(WRITTEN_ROWS * TABLE_WIDTH));
        written.resize(written.len().next_multiple_of(TABLE_WIDTH), T::zeroed());
        device.write_rows(&texture, first_row as u32, bytemuck::cast_slice(&written))?;
    }
    Ok(texture)
}

impl Tables {
    fn new(device: &Device, stars: Arc<StarIndex>, pictures: Pictures) -> Result<Self> {
        let (sky_maps, streaks, (filaments, baked), (occluder, lut)) = pictures;
        let (entries, cells) = (stars.light_table_size(), stars.star_cells.len());
        let format = wgpu::TextureFormat::Rgba32Float;
        let light = table(device, "light tables", format, entries, stars.light_tables())?;
        let star_cells = table(device, "star cells", wgpu::TextureFormat::R32Uint, cells, stars.cell_tables())?;
        let lost_uploads = device.uploads.lost();
        let profile_spin = None;
        Ok(Self {
            stars,
            light,
            star_cells,
            sky_maps,
            streaks,
            filaments,
            baked,
            occluder,
            lut,
            profile_spin,
            lost_uploads,
        })
    }

    /// Brings the tables up to the scene's stars, maps, disk and volumes, the frame being set up. Errors: UNSUPPORTED
    /// where the device's textures are too small; OUT_OF_MEMORY.
    pub fn prepare<'a>(
        tables: &'a mut Option<Self>,
        device: &Device,
        scene: &Scene,
        setup: &Setup,
    ) -> Result<&'a mut Self> {
        let tables = Self::with_stars(tables, device, scene)?;
        TablePart::ALL.into_iter().try_for_each(|part| tables.update(part, device, scene, setup))?;
        Ok(tables)
    }

    /// The tables, with the scene's stars. Errors: as [`Self::prepare`].
    pub fn with_stars<'a>(tables: &'a mut Option<Self>, device: &Device, scene: &Scene) -> Result<&'a mut Self> {
        let stars = scene.stars()?;
        let held = tables.take().filter(|held| held.lost_uploads == device.uploads.lost());
        if held.is_none() {
            // Groups that hold tables from before.
            device.bindings.clear();
        }
        let made = match held {
            Some(held) if Arc::ptr_eq(&held.stars, &stars) => held,
            // The old stars go first: both together need not fit.
            Some(held) => {
                let pictures = held.into_pictures();
                Self::new(device, stars, pictures)?
            }
            None => {
                let (maps, streaks) = (SkyMaps::new(device)?, StreakTexture::new(device)?);
                let structure = (FilamentTexture::new(device)?, BakedTextures::new(device)?);
                let occluder = (OccluderTexture::new(device)?, LutTexture::new(device)?);
                Self::new(device, stars, (maps, streaks, structure, occluder))?
            }
        };
        Ok(tables.insert(made))
    }

    fn into_pictures(self) -> Pictures {
        (self.sky_maps, self.streaks, (self.filaments, self.baked), (self.occluder, self.lut))
    }

    /// Group 0 of emit/streaks.wgsl.
    pub fn streaks(&self) -> &StreakTexture {
        &self.streaks
    }

    /// `occluder` of shade/shade.wgsl.
    pub fn occluder(&self) -> &OccluderTexture {
        &self.occluder
    }

    /// `film_lut` of film/lut.wgsl.
    pub fn lut(&self) -> &wgpu::TextureView {
        self.lut.view()
    }

    /// `sky_map` of shade/shade.wgsl, and the Milky Way's.
    pub fn sky_maps(&self) -> &SkyMaps {
        &self.sky_maps
    }

    /// The textures that `baked_factor` of emit/clouds.wgsl reads, and their sampler.
    pub fn structure(&self) -> [wgpu::BindingResource<'_>; 1 + Volume::MOST] {
        self.baked.resources()
    }

    /// The work that a frame begins with, as [`BakedTextures::bake`].
    pub fn bake(&mut self, device: &Device, kernels: &Kernels, setup: &Setup) -> Result<Option<Bake>> {
        self.baked.bake(device, kernels, &self.filaments, &setup.structure)
    }

    /// After a frame that failed or was left.
    pub fn forget(&mut self) {
        self.baked.forget();
    }

    /// In the order of group 0 of shade/shade.wgsl.
    pub fn resources(&self) -> [wgpu::BindingResource<'_>; 5] {
        let [milky_way, map] = self.sky_maps.textures();
        let [light, cells, milky_way, map] =
            [&self.light, &self.star_cells, milky_way, map].map(|t| wgpu::BindingResource::TextureView(&t.view));
        [light, cells, milky_way, map, wgpu::BindingResource::Sampler(self.sky_maps.sampler())]
    }

    /// `milky_way_size` and `map_size` of shared/frame.wgsl.
    pub fn map_sizes(&self) -> [[u32; 2]; 2] {
        self.sky_maps.sizes()
    }

    /// Updates a part for the scene. Errors: as [`Self::prepare`].
    pub fn update(&mut self, part: TablePart, device: &Device, scene: &Scene, setup: &Setup) -> Result<()> {
        match part {
            TablePart::SkyMaps => self.sky_maps.update(device, scene, setup.variants.shade.map_sampler),
            TablePart::Streaks => self.streaks.update(device, scene),
            TablePart::Filaments if setup.clouds.is_some() => self.filaments.make(device),
            TablePart::Filaments => Ok(()),
            TablePart::Others => self.update_others(device, scene, setup),
        }
    }

    /// The profile of the scene's disk, the places of its hot spots, and what a host may set anew in each frame.
    fn update_others(&mut self, device: &Device, scene: &Scene, setup: &Setup) -> Result<()> {
        self.baked.update(device, &setup.structure)?;
        self.occluder.update(device, scene)?;
        self.lut.update(device, scene)?;
        if !setup.places.is_empty() {
            // Whole rows: what a last one has left over is no spot's.
            let rows = setup.places.len().next_multiple_of(TABLE_WIDTH);
            let mut written = with_room(rows, "the places of hot spots")?;
            written.extend_from_slice(&setup.places);
            written.resize(rows, [0.0_f32; 4]);
            device.write_rows(&self.light, PLACES_ROW, bytemuck::cast_slice(&written))?;
        }
        let spin = scene.matter_spin();
        if self.profile_spin == Some(spin) {
            return Ok(());
        }
        let profile = TemperatureProfile::new(spin);
        let row = collected(profile_row(&profile), "the disk's profile")?;
        device.write_rows(&self.light, PROFILE_ROW, bytemuck::cast_slice(&row))?;
        self.profile_spin = Some(spin);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use crate::error::ErrorKind;
    use crate::gpu::{Adapter, FrameTarget, GpuTracer, Search, adapters};
    use crate::image::PixelFormat;
    use crate::scene::{Region, Scene, Volume};
    use crate::tracer::{Backend, FrameRequest, Tile};
    use wgpu::BufferUsages;

    fn adapter() -> Adapter {
        adapters(Search::Only(Backend::Vulkan), false).into_iter().next().expect("a Vulkan adapter; lavapipe will do")
    }

    /// A submission that fails takes with it what was written for it: tables, streaks, filaments and uniforms are all
    /// written again.
    #[test]
    fn what_a_failed_submission_was_to_write_is_written_again() {
        const SIDE: u32 = 48;
        let mut scene = Scene::default();
        scene.volumes.push(Volume { outer_radius: 12.0, ..Volume::default() });
        let region = Region { full_width: SIDE, full_height: SIDE, x: 0, y: 0 };
        let request =
            FrameRequest { width: SIDE, height: SIDE, region, format: PixelFormat::Rgba8Srgb, transparent: false };
        let picture = |tracer: &mut GpuTracer| {
            let mut bytes = vec![0; (4 * SIDE * SIDE) as usize];
            let mut sink = |tile: Tile, pixels: &[u8], bytes_per_row: usize| {
                for (y, row) in (tile.y..).zip(pixels.chunks(bytes_per_row)) {
                    let at = (4 * (y * SIDE + tile.x)) as usize;
                    bytes[at..][..4 * tile.width as usize].copy_from_slice(&row[..4 * tile.width as usize]);
                }
                Ok(())
            };
            tracer.render(&scene, &request, &mut sink, &mut |_| true).unwrap();
            bytes
        };
        let expected = picture(&mut GpuTracer::new(adapter()).unwrap());
        let mut tracer = GpuTracer::new(adapter()).unwrap();
        let small = tracer.device().buffer("small", 16, BufferUsages::COPY_SRC | BufferUsages::COPY_DST).unwrap();
        let mut overrun = |encoder: &mut wgpu::CommandEncoder| {
            encoder.copy_buffer_to_buffer(&small, 0, &small, 64, 64);
            Ok(())
        };
        let mut frame = tracer.begin(&scene, &request, FrameTarget::Host).unwrap();
        // The frame's last step is the one that fails.
        let error = loop {
            match tracer.submit_and(&mut frame, &mut overrun) {
                Ok(step) => drop(step.expect("a step that fails")),
                Err(error) => break error,
            }
        };
        assert_eq!(error.kind, ErrorKind::Internal, "{error}");
        assert!(picture(&mut tracer) == expected, "the next frame differs from that of a new tracer");
    }
}
