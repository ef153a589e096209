//! Tables that shading reads on the GPU: blackbody colours, stars, the mean sky (made once), and the disk's temperature profile
//! (made anew when the matter's spin changes).

use super::{Buffer, Device};
use crate::error::Result;
use crate::physics::disk_flux::TemperatureProfile;
use crate::scene::Scene;
use crate::sky::StarIndex;

pub struct Tables {
    /// Blackbodies, stars, mean sky, profile: `light_tables` of the shaders.
    pub light: Buffer,
    pub star_cells: Buffer,
    profile_offset: u64,
    /// Spin as the disk's matter meets it, of the profile in the buffer.
    profile_spin: Option<f64>,
}

impl Tables {
    pub fn new(device: &Device) -> Result<Self> {
        let index = StarIndex::shared();
        let fixed = index.light_tables();
        let fixed_bytes: &[u8] = bytemuck::cast_slice(&fixed);
        let cells: &[u8] = bytemuck::cast_slice(&index.star_cells);
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST;
        let profile_offset = fixed_bytes.len() as u64;
        let profile_bytes = (TemperatureProfile::SIZE * size_of::<f32>()) as u64;
        let light = device.buffer("light tables", profile_offset + profile_bytes, usage)?;
        let star_cells = device.buffer("star cells", cells.len() as u64, usage)?;
        device.write(&light, 0, fixed_bytes)?;
        device.write(&star_cells, 0, cells)?;
        Ok(Self { light, star_cells, profile_offset, profile_spin: None })
    }

    /// Brings the profile up to the scene's disk.
    pub fn update(&mut self, device: &Device, scene: &Scene) -> Result<()> {
        let spin = scene.matter_spin();
        if self.profile_spin == Some(spin) {
            return Ok(());
        }
        let profile = TemperatureProfile::new(spin);
        let entries = profile.entries().iter().map(|&t| t as f32).collect::<Vec<_>>();
        device.write(&self.light, self.profile_offset, bytemuck::cast_slice(&entries))?;
        self.profile_spin = Some(spin);
        Ok(())
    }
}
