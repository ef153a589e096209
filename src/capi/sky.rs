// SPDX-License-Identifier: MIT OR Apache-2.0
//! BhrSky: the stars, the Milky Way, a map and a grid at infinity.

use super::call::on_context;
use super::context::BhrContext;
use super::entry::anywhere;
use super::image::{self, BhrImage};
use super::status::BhrStatus;
use super::versioned::{self, OutStruct, Versioned};
use crate::error::{Error, Result};
use crate::scene::Sky;
use crate::sky::SkyMap;
use glam::DQuat;
use std::sync::Arc;

/// BhrSky.flags: the real sky, from the embedded star catalogue.
pub const BHR_SKY_STARS: u32 = 1u32;
/// BhrSky.flags: a random star field of a million stars to V = 11, with the real sky's numbers in each magnitude, its
/// crowding towards the Milky Way, and its colours. The same seed gives the same stars on every machine. Together with
/// STARS it adds the stars that are fainter than the catalogue's (V > 8). It is made when it is first drawn, within
/// about a second, and takes 110 MB of device memory.
pub const BHR_SKY_PROCEDURAL: u32 = 2u32;
/// BhrSky.flags: the glow of the Milky Way, made from embedded outlines at first use (0.1 to 0.5 s). It is true to
/// about a degree, finer clouds and dust are made up, and next to the stars eight times as bright as the eye sees it.
pub const BHR_SKY_MILKY_WAY: u32 = 4u32;
/// BhrSky.flags: the map that bhr_set_sky_map was given; nothing without one.
pub const BHR_SKY_MAP: u32 = 8u32;
/// BhrSky.flags: a grid in sky axes, which shows the lensing: right ascension every hour (15 degrees; every 6 hours
/// within 15 degrees of the poles), declination every 15 degrees, the equator and right ascension 0 in another
/// colour. Lines are 1.3 pixels wide and laid over the sky, whatever its brightness and the shift of its light; where
/// less than 10 pixels apart they fade into an even tint.
pub const BHR_SKY_GRID: u32 = 16u32;

/// The sky: everything that lies at infinity.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct BhrSky {
    /// sizeof(BhrSky).
    pub struct_size: u32,
    /// BHR_SKY_* bits; 0: black. Default STARS | MILKY_WAY.
    pub flags: u32,
    /// 0 .. 1e6. Default 1.
    pub stars_brightness: f64,
    /// A factor on the light of the Milky Way and the map, 0 .. 1e6. Default 1.
    pub map_brightness: f64,
    /// Unit quaternion x y z w that takes sky axes (J2000 equatorial: +x vernal equinox, +z north celestial pole)
    /// to scene axes. Default (0, 0, 0, 1).
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

/// Clears struct_size bytes and fills in the defaults. Any thread, inside callbacks too. Errors: INVALID_ARGUMENT
/// for NULL or a wrong struct_size.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_sky_init(sky: *mut BhrSky, struct_size: usize) -> BhrStatus {
    // SAFETY: NULL or struct_size writable bytes, by the header's conventions.
    anywhere("bhr_sky_init", || unsafe { versioned::init(sky, "sky", struct_size) })
}

/// Sets the sky; NULL: black. Errors: INVALID_ARGUMENT for a number outside its range, an orientation that is no
/// unit quaternion, or an unknown flag; UNSUPPORTED for flags that this version cannot draw.
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

/// The sky as it is set. Errors: INVALID_ARGUMENT for NULL or a wrong struct_size.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_get_sky(context: *const BhrContext, sky: *mut BhrSky) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let sky = OutStruct::cleared(sky, "sky");
        on_context("bhr_get_sky", context, |state| sky.set(&state.renderer.scene.sky.into()))
    }
}

/// Gives BHR_SKY_MAP its picture, copied before return (a second or two for 16384 x 8192); NULL removes it. The next
/// frames that are asked for show it. It covers the whole sky whatever its aspect: at x of width and y of height, from
/// the top left, right ascension is 360 deg (1/2 - x / width), declination 180 deg (1/2 - y / height). So the north
/// pole is at the top, right ascension 0 (+x of the sky axes) in the middle, and +y at a quarter of the width: the
/// picture looks as the sky does from inside, as astronomers' maps do.
///
/// Light at rest is what the picture holds, linear Rec. 709, 8-bit formats decoded, to within 0.2 % of the brightest
/// channel: black up to 2^-25, 65408 at most; NaN and negative numbers are 0, alpha is ignored. Its frequency shift
/// is that of the blackbody of its blue-to-red ratio, of 2500 K to 25000 K: each channel changes as that blackbody's
/// does. Pixels get the mean of the map over their patch of sky, the first and the last row in each case their mean.
/// Pictures of more than 16384 x 8192, or of more rows than 1024 and four times their columns, are reduced to that,
/// and on the device to its largest texture. Memory: 5.4 bytes a texel in the context and 6 on the device. Errors:
/// INVALID_ARGUMENT for a bad image or R32F; OUT_OF_MEMORY.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_set_sky_map(context: *mut BhrContext, equirect: *const BhrImage) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_context("bhr_set_sky_map", context, |state| {
            state.renderer.scene.sky_map = match equirect.is_null() {
                true => None,
                false => Some(Arc::new(SkyMap::new(&image::read(equirect, "equirect")?.pixels.as_image_ref())?)),
            };
            state.renderer.scene.sky_picture = None;
            Ok(())
        })
    }
}
