//! BhrSky: what lies at infinity.

use super::context::BhrContext;
use super::entry::{anywhere, on_context};
use super::image::{self, BhrImage};
use super::status::BhrStatus;
use super::versioned::{self, OutStruct, Versioned};
use crate::error::{Error, Result};
use crate::scene::Sky;
use glam::DQuat;

/// BhrSky.flags: the real sky, from the embedded star catalogue.
pub const BHR_SKY_STARS: u32 = 1u32;
/// BhrSky.flags: a random star field: a million stars to V = 11, as many of each magnitude, as much crowded towards the
/// Milky Way and of such colours as in the real sky; the same ones for the same seed on every machine. With STARS the real
/// ones, and random ones that are fainter (V > 8). Made when it is first drawn, within about a second and 110 MB of device
/// memory.
pub const BHR_SKY_PROCEDURAL: u32 = 2u32;
/// BhrSky.flags: the embedded glow of the Milky Way. Accepted, being part of the default, but not drawn by this
/// version.
pub const BHR_SKY_MILKY_WAY: u32 = 4u32;
/// BhrSky.flags: the map that bhr_set_sky_map was given. UNSUPPORTED in this version.
pub const BHR_SKY_MAP: u32 = 8u32;
/// BhrSky.flags: a coordinate grid, which shows the lensing. UNSUPPORTED in this version.
pub const BHR_SKY_GRID: u32 = 16u32;

/// What lies at infinity.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct BhrSky {
    /// sizeof(BhrSky).
    pub struct_size: u32,
    /// BHR_SKY_* bits; 0: black. Default STARS | MILKY_WAY.
    pub flags: u32,
    /// 0 .. 1e6. Default 1.
    pub stars_brightness: f64,
    /// Of the Milky Way and the map, 0 .. 1e6. Default 1.
    pub map_brightness: f64,
    /// Unit quaternion x y z w that takes sky axes (J2000 equatorial: +x vernal equinox, +z north celestial pole)
    /// to scene axes. Default (0, 0, 0, 1).
    pub orientation: [f64; 4],
    /// Of BHR_SKY_PROCEDURAL: any number. Default 0.
    pub seed: u64,
}

// SAFETY: repr(C), size first, no padding, numbers only.
unsafe impl Versioned for BhrSky {
    const NAME: &'static str = "BhrSky";
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

/// Gives BHR_SKY_MAP its picture, copied before return; NULL removes it. Errors: INVALID_ARGUMENT for a bad image;
/// UNSUPPORTED for every other image in this version.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_set_sky_map(context: *mut BhrContext, equirect: *const BhrImage) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_context("bhr_set_sky_map", context, |_state| {
            if equirect.is_null() {
                return Ok(());
            }
            image::read(equirect, "equirect")?;
            Err(Error::unsupported("sky maps are not drawn by this version"))
        })
    }
}
