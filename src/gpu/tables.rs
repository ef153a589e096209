//! Tables that shading reads on the GPU: blackbody colours, stars, the mean sky (made once), and the disk's temperature profile
//! (made anew when the matter's spin changes). Textures of TABLE_WIDTH entries a row (shade.wgsl says why).

use super::sky_maps::SkyMaps;
use super::{Device, Texture};
use crate::error::Result;
use crate::physics::disk_flux::TemperatureProfile;
use crate::scene::Scene;
use crate::sky::StarIndex;

/// Entries of a row: a width that every device takes.
const TABLE_WIDTH: usize = 2048;

pub struct Tables {
    /// Blackbodies, stars, mean sky, and in its last row the profile: `light_tables` of the shaders.
    light: Texture,
    star_cells: Texture,
    sky_maps: SkyMaps,
    profile_row: u32,
    /// Spin as the disk's matter meets it, of the profile in the texture.
    profile_spin: Option<f64>,
}

/// A table in rows, the last one filled up.
fn rows<T: Copy + Default>(table: &[T]) -> Vec<T> {
    let mut rows = table.to_vec();
    rows.resize(table.len().next_multiple_of(TABLE_WIDTH), T::default());
    rows
}

impl Tables {
    pub fn new(device: &Device) -> Result<Self> {
        let index = StarIndex::shared();
        let fixed = rows(&index.light_tables());
        let cells = rows(&index.star_cells);
        let profile_row = (fixed.len() / TABLE_WIDTH) as u32;
        let table = |label: &str, format: wgpu::TextureFormat, rows: u32| {
            device.table(label, format, [TABLE_WIDTH as u32, rows])
        };
        let light = table("light tables", wgpu::TextureFormat::Rgba32Float, profile_row + 1)?;
        let cell_rows = (cells.len() / TABLE_WIDTH) as u32;
        let star_cells = table("star cells", wgpu::TextureFormat::R32Uint, cell_rows)?;
        device.write_rows(&light, 0, bytemuck::cast_slice(&fixed))?;
        device.write_rows(&star_cells, 0, bytemuck::cast_slice(&cells))?;
        let sky_maps = SkyMaps::new(device)?;
        Ok(Self { light, star_cells, sky_maps, profile_row, profile_spin: None })
    }

    /// In the order of group 0 of shade.wgsl.
    pub fn textures(&self) -> [&Texture; 4] {
        let [milky_way, map] = self.sky_maps.textures();
        [&self.light, &self.star_cells, milky_way, map]
    }

    /// `Frame::map_sizes` of frame.wgsl.
    pub fn map_sizes(&self) -> [u32; 4] {
        self.sky_maps.sizes()
    }

    /// Brings the profile up to the scene's disk, and the maps up to its sky.
    pub fn update(&mut self, device: &Device, scene: &Scene) -> Result<()> {
        self.sky_maps.update(device, scene)?;
        let spin = scene.matter_spin();
        if self.profile_spin == Some(spin) {
            return Ok(());
        }
        let profile = TemperatureProfile::new(spin);
        let mut row = vec![[0.0_f32; 4]; TABLE_WIDTH];
        for (out, pair) in row.iter_mut().zip(profile.entries().windows(2)) {
            *out = [pair[0] as f32, (pair[1] - pair[0]) as f32, 0.0, 0.0];
        }
        device.write_rows(&self.light, self.profile_row, bytemuck::cast_slice(&row))?;
        self.profile_spin = Some(spin);
        Ok(())
    }
}
