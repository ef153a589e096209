//! The sky maps of a scene as textures: the Milky Way's, made when it is first shown, and the host's, made anew when it is another.

use super::kernels::SKY_MAP;
use super::{Device, Texture};
use crate::error::{Error, Result};
use crate::scene::Scene;
use crate::sky::SkyMap;
use std::sync::{Arc, Weak};

/// Bytes that are written in one submission, about: until it has run, the driver keeps a copy of them.
const BAND_BYTES: usize = 16 << 20;

pub struct SkyMaps {
    milky_way: Option<Texture>,
    /// Together with what it was made from.
    map: Option<(Weak<SkyMap>, Texture)>,
    /// A dark texel, bound in the place of what is not shown.
    nothing: Texture,
}

impl SkyMaps {
    pub fn new(device: &Device) -> Result<Self> {
        let nothing = device.pyramid("no sky map", SKY_MAP.format, [1, 1], 1)?;
        device.write_level(&nothing, 0, 0, &[0; 4])?;
        Ok(Self { milky_way: None, map: None, nothing })
    }

    pub fn milky_way(&self) -> &Texture {
        self.milky_way.as_ref().unwrap_or(&self.nothing)
    }

    /// The host's.
    pub fn map(&self) -> &Texture {
        self.map.as_ref().map_or(&self.nothing, |(_, texture)| texture)
    }

    /// Brings them up to the scene: a map that is not shown keeps its texture as long as the scene has it. Errors: as
    /// [`Device::scoped`]; the texture is then made when it is needed next.
    pub fn update(&mut self, device: &Device, scene: &Scene) -> Result<()> {
        if scene.shows_milky_way() && self.milky_way.is_none() {
            self.milky_way = Some(upload(device, SkyMap::milky_way()?)?);
        }
        let made_from = self.map.as_ref().map(|(map, _)| map.as_ptr());
        if made_from.is_some() && made_from != scene.sky_map.as_ref().map(Arc::as_ptr) {
            // Before the next one is made: both together need not fit.
            self.map = None;
            device.bindings.clear();
        }
        if let (Some(map), None) = (scene.shown_map(), &self.map) {
            self.map = Some((Arc::downgrade(map), upload(device, map)?));
        }
        Ok(())
    }
}

/// Levels that are larger than a texture can be are left out.
fn upload(device: &Device, map: &SkyMap) -> Result<Texture> {
    let limit = device.limits().max_texture_dimension_2d;
    let first = map.levels().iter().position(|level| level.size.iter().all(|side| *side <= limit));
    let levels = first.and_then(|first| map.levels().get(first..)).unwrap_or(&[]);
    let finest = levels.first().ok_or_else(|| Error::internal("a sky map without levels"))?;
    let texture = device.pyramid("sky map", SKY_MAP.format, finest.size, levels.len() as u32)?;
    let mut written = 0;
    for (level, number) in levels.iter().zip(0..) {
        let row_texels = level.size[0] as usize;
        let band_rows = (BAND_BYTES / size_of::<u32>() / row_texels).max(1);
        for (band, first) in level.texels.chunks(band_rows * row_texels).zip((0..).step_by(band_rows)) {
            device.write_level(&texture, number, first, bytemuck::cast_slice(band))?;
            written += size_of_val(band);
            if written >= BAND_BYTES {
                written = 0;
                device.submit_and_wait(device.encoder("sky map")?)?;
            }
        }
    }
    Ok(texture)
}
