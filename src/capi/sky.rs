// SPDX-License-Identifier: MIT OR Apache-2.0
//! BhrSky: the stars, the Milky Way, a map and a grid at infinity.

use super::call::on_context;
use super::context::BhrContext;
use super::entry::anywhere;
use super::image::{self, BhrImage, path_of};
use super::state::State;
use super::status::BhrStatus;
use super::versioned::{self, OutStruct, Versioned};
use crate::error::{Error, Result};
use crate::scene::Sky;
use crate::sky::{MapFile, SkyMap};
use glam::DQuat;
use std::ffi::c_char;
use std::sync::Arc;

/// BhrSky.flags: the real sky, from the embedded star catalogue.
pub const BHR_SKY_STARS: u32 = 1u32;
/// BhrSky.flags: a random field of a million stars to V = 11, with the real sky's numbers and colours, the same on
/// every machine for the same seed. Together with STARS only those fainter than V = 8. 110 MB of device memory.
/// docs/maps.md.
pub const BHR_SKY_PROCEDURAL: u32 = 2u32;
/// BhrSky.flags: the glow of the Milky Way, true to about a degree, and next to the stars eight times as bright as
/// the eye sees it. docs/maps.md.
pub const BHR_SKY_MILKY_WAY: u32 = 4u32;
/// BhrSky.flags: the map that bhr_set_sky_map was given; nothing without one.
pub const BHR_SKY_MAP: u32 = 8u32;
/// BhrSky.flags: a grid in sky axes, which shows the lensing: right ascension every hour, declination every 15
/// degrees, lines 1.3 pixels wide. docs/maps.md.
pub const BHR_SKY_GRID: u32 = 16u32;

/// The sky: everything that lies at infinity.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct BhrSky {
    /// sizeof(BhrSky).
    pub struct_size: u32,
    /// BHR_SKY_* bits; 0: black. Default STARS | MILKY_WAY.
    pub flags: u32,
    /// A factor on the light of the stars, 0 .. 1e6. Default 1.
    pub stars_brightness: f64,
    /// A factor on the light of the Milky Way and the map, 0 .. 1e6. Default 1.
    pub map_brightness: f64,
    /// Unit quaternion x y z w that takes sky axes (J2000 equatorial: +x vernal equinox, +z north celestial pole) to
    /// scene axes. Default (0, 0, 0, 1).
    pub orientation: [f64; 4],
    /// Selects the stars of BHR_SKY_PROCEDURAL: any number. Default 0.
    pub seed: u64,
}

// SAFETY: repr(C), size first, no padding, numbers only.
unsafe impl Versioned for BhrSky {
    const NAME: &'static str = "BhrSky";
    const SIZES: &'static [usize] = &[64];
    fn defaults() -> Self {
        Sky::default().into()
    }
}

impl From<Sky> for BhrSky {
    fn from(sky: Sky) -> Self {
        Self {
            struct_size: 0,
            flags: sky.flags,
            stars_brightness: sky.stars_brightness,
            map_brightness: sky.map_brightness,
            orientation: sky.orientation.to_array(),
            seed: sky.seed,
        }
    }
}

impl TryFrom<BhrSky> for Sky {
    type Error = Error;

    fn try_from(given: BhrSky) -> Result<Self> {
        let sky = Self {
            flags: given.flags,
            stars_brightness: given.stars_brightness,
            map_brightness: given.map_brightness,
            orientation: DQuat::from_array(given.orientation),
            seed: given.seed,
        };
        sky.check()?;
        Ok(sky)
    }
}

/// Fills in the defaults.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_sky_init(sky: *mut BhrSky, struct_size: usize) -> BhrStatus {
    // SAFETY: NULL or struct_size writable bytes, by the header's conventions.
    anywhere("bhr_sky_init", || unsafe { versioned::init(sky, "sky", struct_size) })
}

/// Sets the sky; NULL: black.
/// Errors: INVALID_ARGUMENT also for an orientation whose length is not 1 to within 1e-3.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_set_sky(context: *mut BhrContext, sky: *const BhrSky) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_context("bhr_set_sky", context, |state| {
            state.renderer.scene.sky = match sky.is_null() {
                true => Sky::black(),
                false => versioned::read(sky, "sky")?.try_into()?,
            };
            Ok(())
        })
    }
}

/// Reads the sky as it is set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_get_sky(context: *const BhrContext, sky: *mut BhrSky) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let sky = OutStruct::cleared(sky, "sky");
        on_context("bhr_get_sky", context, |state| sky.set(&state.renderer.scene.sky.into()))
    }
}

/// Gives BHR_SKY_MAP its picture, copied before return (a second or two for 16384 x 8192); NULL removes it. The next
/// frames that are asked for show it. It covers the whole sky whatever its aspect: at x of width and y of height,
/// from the top left, right ascension is 360 deg (1/2 - x / width), declination 180 deg (1/2 - y / height). Light is
/// linear Rec. 709, 8-bit formats are decoded; NaN and negative numbers are 0, alpha is ignored. Pictures of more
/// than 16384 x 8192, or of more rows than 1024 and four times their columns, are reduced to that, and on the device
/// to its largest texture. Memory a texel: 5.4 bytes in the context and on a GPU, 6 on a software device; 1.34 for
/// maps in blocks (bhr_save_sky_map), until a tracer unpacks them. docs/maps.md.
/// Errors: INVALID_ARGUMENT for R32F and RGB10A2.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_set_sky_map(context: *mut BhrContext, equirect: *const BhrImage) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_context("bhr_set_sky_map", context, |state| {
            state.renderer.scene.sky_map = match equirect.is_null() {
                true => None,
                false => {
                    let picture = image::read(equirect, "equirect")?;
                    Some(Arc::new(SkyMap::new(&picture.pixels.as_image_ref())?.into()))
                }
            };
            (state.renderer.scene.sky_picture, state.files.map) = (None, None);
            Ok(())
        })
    }
}

/// Gives BHR_SKY_MAP the picture in a file that bhr_image_load reads, as bhr_set_sky_map does one in memory. The path
/// is kept, so that bhr_scene_save can name it; a file that is given again and has not changed is not read again.
/// Blocks of BC6H in a .ktx2 file stay blocks, in the context and on most GPUs (docs/maps.md).
/// Errors: those of bhr_image_load and bhr_set_sky_map, after which the map is as it was. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_set_sky_map_file(context: *mut BhrContext, path: *const c_char) -> BhrStatus {
    // SAFETY: NULL or a C string, by the header's conventions.
    unsafe {
        on_context("bhr_set_sky_map_file", context, |state| {
            let path = path_of(path)?;
            let path = std::path::absolute(&path).unwrap_or(path);
            let map = MapFile::load(&path, state.files.map.as_ref())?;
            show_map(state, Some(map));
            Ok(())
        })
    }
}

/// Writes the map that bhr_set_sky_map or bhr_set_sky_map_file gave to a .ktx2 file in blocks of BC6H with all its
/// levels: 1.34 bytes a texel. bhr_set_sky_map_file and GPUs take the blocks as they are; docs/maps.md says how exact
/// they are. A map of 16384 x 8192 takes some seconds. Errors: INVALID_STATE without a map, or with one on the GPU
/// (bhr_interop.h); UNSUPPORTED for another ending of the path; IO, after which an older file is as it was.
/// @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_save_sky_map(context: *const BhrContext, path: *const c_char) -> BhrStatus {
    // SAFETY: NULL or a C string, by the header's conventions.
    unsafe {
        on_context("bhr_save_sky_map", context, |state| {
            let path = path_of(path)?;
            let scene = &state.renderer.scene;
            if scene.sky_picture.is_some() {
                return Err(Error::state("the sky's map is a target on the GPU, which is not saved"));
            }
            let map = scene.sky_map.as_ref().ok_or_else(|| Error::state("there is no sky map"))?;
            map.save(&path)
        })
    }
}

/// Shows the map of a file, or none.
pub(super) fn show_map(state: &mut State, map: Option<MapFile>) {
    state.renderer.scene.sky_map = map.as_ref().map(|map| map.value().clone());
    state.renderer.scene.sky_picture = None;
    state.files.map = map;
}
