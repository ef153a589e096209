// SPDX-License-Identifier: MIT OR Apache-2.0
//! BhrVolume, BhrHotSpot: matter with depth.

use super::array::{Names, read_array, write_array};
use super::call::on_context;
use super::context::BhrContext;
use super::entry::anywhere;
use super::pointer::{Out, check_flags, unknown};
use super::status::BhrStatus;
use super::versioned::{self, Versioned};
use crate::error::{Error, Result};
use crate::scene::{Body, Chart, FlowLaw, HotSpot, Shape, Volume};

/// The place of a volume's matter: its density n, with c = cos th, R = r sin th, z = r c, and lengths in M. n is 1
/// at inner_radius (DISK), at radius (JET) or in the middle (TORUS, HALO), but for soft edges at inner_radius and
/// outer_radius (docs/matter.md). @since 0.2.0
pub type BhrVolumeShape = i32;
/// About the equatorial plane: n = (r / inner_radius)^-slope e^(-(c / thickness)^2 / 2), with soft edges.
pub const BHR_VOLUME_DISK: BhrVolumeShape = 0;
/// A ring about the axis: n = e^(-((R - radius) / width)^2 / 2 - (z / (thickness radius))^2 / 2).
pub const BHR_VOLUME_TORUS: BhrVolumeShape = 1;
/// About the hole: n = e^(-(r / radius)^2 / 2 - (c / thickness)^2 / 2), with thickness = 1e6 a sphere.
pub const BHR_VOLUME_HALO: BhrVolumeShape = 2;
/// A hollow jet along the axis and one opposite: matter in the wall of a cone about the axis, n = (r /
/// radius)^-slope e^(-((|c| - cos psi) / thickness)^2 / 2), psi = opening sqrt(radius / r), at most pi / 2, with
/// soft edges. With the default flow its matter orbits: BHR_FLOW_OUTFLOW moves it along the jet.
pub const BHR_VOLUME_JET: BhrVolumeShape = 3;

/// The motion of a volume's matter. Every flow is slower than light everywhere; docs/matter.md has the laws.
/// @since 0.2.0
pub type BhrFlow = i32;
/// On circles, inside the ISCO plunging with the energy and the angular momentum of the orbit there. sub_keplerian
/// takes angular momentum from it, infall goes over to free fall.
pub const BHR_FLOW_KEPLERIAN: BhrFlow = 0;
/// -u_ph / u_t = angular_momentum R^(3/2) / (1 + R), without radial motion: the flow of Gold et al. 2020.
pub const BHR_FLOW_ANGULAR_MOMENTUM: BhrFlow = 1;
/// Away from the hole, the faster the farther, as the matter of a jet: at rest at r = inner_radius, at speed far
/// away, falling in nearer to the hole. A spinning hole turns it in the hole's own sense, whatever
/// BHR_VOLUME_RETROGRADE says.
pub const BHR_FLOW_OUTFLOW: BhrFlow = 2;

/// BhrVolume.flags: the matter moves towards -ph.
pub const BHR_VOLUME_RETROGRADE: u32 = 1u32;
/// BhrVolume.flags: the light is a power law of the frequency, not a blackbody's.
pub const BHR_VOLUME_POWER_LAW: u32 = 2u32;

/// Matter with depth, which shines and absorbs by the equation of transfer; nothing is scattered. Radii are in units
/// of M, other lengths those that the matter itself measures. Thermal matter absorbs alike at all frequencies, and
/// without absorption does not shine. A power law emits j = n (nu / nu_camera)^-spectral_index per M, and its
/// absorption per M is absorption n (nu / nu_camera)^-(2.5 + spectral_index), nu being the frequency that the matter
/// measures: a picture shows its light at the one frequency nu_camera, in the colour tint. No matter is inside the
/// horizon. Fields that shape and flow do not use are checked all the same. docs/matter.md. @since 0.2.0
#[repr(C)]
#[derive(Clone, Copy)]
pub struct BhrVolume {
    /// sizeof(BhrVolume).
    pub struct_size: u32,
    /// Any of BHR_VOLUME_RETROGRADE | BHR_VOLUME_POWER_LAW. Default 0.
    pub flags: u32,
    /// BHR_VOLUME_DISK (default), _TORUS, _HALO, _JET.
    pub shape: BhrVolumeShape,
    /// BHR_FLOW_KEPLERIAN (default), _ANGULAR_MOMENTUM, _OUTFLOW.
    pub flow: BhrFlow,
    /// In M, 1e-6 .. 1e4, or 0 (default): the ISCO of matter that moves as flags say. DISK, JET: the inner edge;
    /// OUTFLOW: the place where matter is at rest.
    pub inner_radius: f64,
    /// In M, 0 .. 1e4, greater than inner_radius. There is nothing beyond it, whatever the shape, and nothing at all
    /// of a DISK or JET whose outer_radius is less than 0.9 times its inner edge, be that the ISCO. Default 17.
    pub outer_radius: f64,
    /// In M, 0.1 .. 1e4. TORUS: the ring's; HALO: the scale; JET: where psi = opening. Default 8.
    pub radius: f64,
    /// In M, 1e-3 .. 1e4, of a TORUS at least radius / 100: its Gaussian width in R. Default 2.
    pub width: f64,
    /// 0.01 .. 1e6: the Gaussian width in c; TORUS: in z, over radius. Default 0.05, a soft disk; 0.14 is thick.
    pub thickness: f64,
    /// JET: the wall's angle from the axis at `radius`, radians, 0.01 .. 1.5. Default 0.3.
    pub opening: f64,
    /// DISK, JET: 0 .. 4. Default 0.7.
    pub slope: f64,
    /// Per M at density 1, 0 .. 1e6. Default 3; less than 0.5 is mist, more than 5 a surface.
    pub absorption: f64,
    /// Kelvin, 500 .. 1e9, at inner_radius (DISK, JET) or at radius (TORUS, HALO). Default 4800.
    pub temperature: f64,
    /// 0 .. 2: the temperature goes as r^-temperature_slope. Default 0.35; 0.75 is like a thin disk.
    pub temperature_slope: f64,
    /// POWER_LAW: -4 .. 4. Default 1.
    pub spectral_index: f64,
    /// POWER_LAW: the colour of its light at every shift, linear Rec. 709, each 0 .. 1. Default 1, 1, 1.
    pub tint: [f64; 3],
    /// A factor on the light, 0 .. 1e6, which changes neither its colour nor what is absorbed. At 1 the light is as
    /// bright as white without exposure and tone map: of thermal matter of `temperature` at rest that is so thick
    /// that nothing shines through; of a power law, of 1 M of density 1 at rest which absorbs nothing. Default 1.
    pub brightness: f64,
    /// KEPLERIAN: the share of the orbit's angular momentum, 0 .. 1. Default 1.
    pub sub_keplerian: f64,
    /// KEPLERIAN: a share without a unit, 0 .. 1: 0 (default) is orbits, 1 free fall from rest at infinity.
    pub infall: f64,
    /// ANGULAR_MOMENTUM: 0 .. 1. Default 1.
    pub angular_momentum: f64,
    /// OUTFLOW: the velocity far away in units of c, 0 .. 0.995. Default 0.9.
    pub speed: f64,
    /// 0 .. 1: the contrast of structure that the matter carries along: a pattern P = e^(turbulence G) over its
    /// mean, G being noise of mean 0 and about variance 1. Default 1; 0 is even matter, as is that of a host whose
    /// BhrVolume ends before this field.
    pub turbulence: f64,
    /// 0.5 .. 3: the density is multiplied by P^clumping over its mean; more makes filaments. Default 1.8.
    pub clumping: f64,
    /// 0 .. 0.5: the temperature is multiplied by P^heating, so that dense matter is hotter. Default 0.15.
    pub heating: f64,
    /// Selects the structure: the same seed always gives the same one. Any number. Default 0.
    pub seed: u64,
}

/// Most volumes of a scene. @since 0.2.0
pub const BHR_MAX_VOLUMES: usize = 4;

const _: () = assert!(BHR_MAX_VOLUMES == Volume::MOST);

// SAFETY: repr(C), size first, no padding, numbers only.
unsafe impl Versioned for BhrVolume {
    const NAME: &'static str = "BhrVolume";
    // 168: of the days of 0.2.0's making in which matter was even.
    const SIZES: &'static [usize] = &[168, 200];
    fn defaults() -> Self {
        Volume::default().into()
    }
    fn defaults_of(size: usize) -> Self {
        // Before structure had its fields, matter was even.
        let even = Volume { turbulence: 0.0, ..Volume::default() };
        if size < size_of::<Self>() { even.into() } else { Self::defaults() }
    }
}

impl From<Volume> for BhrVolume {
    fn from(volume: Volume) -> Self {
        Self {
            struct_size: 0,
            flags: if volume.retrograde { BHR_VOLUME_RETROGRADE } else { 0 }
                | if volume.power_law { BHR_VOLUME_POWER_LAW } else { 0 },
            shape: volume.shape as BhrVolumeShape,
            flow: volume.flow as BhrFlow,
            inner_radius: volume.inner_radius,
            outer_radius: volume.outer_radius,
            radius: volume.radius,
            width: volume.width,
            thickness: volume.thickness,
            opening: volume.opening,
            slope: volume.slope,
            absorption: volume.absorption,
            temperature: volume.temperature,
            temperature_slope: volume.temperature_slope,
            spectral_index: volume.spectral_index,
            tint: volume.tint,
            brightness: volume.brightness,
            sub_keplerian: volume.sub_keplerian,
            infall: volume.infall,
            angular_momentum: volume.angular_momentum,
            speed: volume.speed,
            turbulence: volume.turbulence,
            clumping: volume.clumping,
            heating: volume.heating,
            seed: volume.seed,
        }
    }
}

impl TryFrom<BhrVolume> for Volume {
    type Error = Error;

    fn try_from(given: BhrVolume) -> Result<Self> {
        let flags = check_flags(given.flags, BHR_VOLUME_RETROGRADE | BHR_VOLUME_POWER_LAW, "volume flags")?;
        let shape = match given.shape {
            BHR_VOLUME_DISK => Shape::Disk,
            BHR_VOLUME_TORUS => Shape::Torus,
            BHR_VOLUME_HALO => Shape::Halo,
            BHR_VOLUME_JET => Shape::Jet,
            value => return unknown(value, "volume shape", "BHR_VOLUME_DISK (0) to BHR_VOLUME_JET (3)"),
        };
        let flow = match given.flow {
            BHR_FLOW_KEPLERIAN => FlowLaw::Keplerian,
            BHR_FLOW_ANGULAR_MOMENTUM => FlowLaw::AngularMomentum,
            BHR_FLOW_OUTFLOW => FlowLaw::Outflow,
            value => return unknown(value, "volume flow", "BHR_FLOW_KEPLERIAN (0) to BHR_FLOW_OUTFLOW (2)"),
        };
        let volume = Self {
            retrograde: flags & BHR_VOLUME_RETROGRADE != 0,
            power_law: flags & BHR_VOLUME_POWER_LAW != 0,
            shape,
            flow,
            inner_radius: given.inner_radius,
            outer_radius: given.outer_radius,
            radius: given.radius,
            width: given.width,
            thickness: given.thickness,
            opening: given.opening,
            slope: given.slope,
            absorption: given.absorption,
            temperature: given.temperature,
            temperature_slope: given.temperature_slope,
            spectral_index: given.spectral_index,
            tint: given.tint,
            brightness: given.brightness,
            sub_keplerian: given.sub_keplerian,
            infall: given.infall,
            angular_momentum: given.angular_momentum,
            speed: given.speed,
            turbulence: given.turbulence,
            clumping: given.clumping,
            heating: given.heating,
            seed: given.seed,
        };
        volume.check()?;
        Ok(volume)
    }
}

/// BhrHotSpot.flags: the spot moves towards -ph.
pub const BHR_HOT_SPOT_RETROGRADE: u32 = 1u32;
/// BhrHotSpot.flags: the light is a blackbody's, not a power law's; without absorption there is none.
pub const BHR_HOT_SPOT_THERMAL: u32 = 2u32;

/// BhrHotSpot.flags: the centre is a body in free fall, which position, velocity and time tell; radius, azimuth and
/// RETROGRADE have no meaning.
pub const BHR_HOT_SPOT_FREE: u32 = 4u32;
/// BhrHotSpot.flags: with FREE, these are told in BHR_CHART_RAIN instead of BHR_CHART_STATIC.
pub const BHR_HOT_SPOT_RAIN: u32 = 8u32;

/// A glowing blob, by default on a circular geodesic in the equatorial plane: n = e^(-(d / size)^2 / 2), cut off at 7
/// sizes, d being the distance from its centre in chart coordinates. It is rigid: all of it turns as its centre does,
/// at dph/dt = 1 / (radius^(3/2) + a), with RETROGRADE -1 / (radius^(3/2) - a), per M; parts that would be faster than
/// light, beside the hole, are left out. It shines and absorbs as BhrVolume says, and its delay matters
/// (docs/matter.md).
///
/// With BHR_HOT_SPOT_FREE the centre moves on any geodesic, for some six hundred turns about the hole before and
/// after `time` and out to 1e4 M, and distances are those of Doran's chart. @since 0.2.0
#[repr(C)]
#[derive(Clone, Copy)]
pub struct BhrHotSpot {
    /// sizeof(BhrHotSpot).
    pub struct_size: u32,
    /// Any of BHR_HOT_SPOT_RETROGRADE | BHR_HOT_SPOT_THERMAL | BHR_HOT_SPOT_FREE | BHR_HOT_SPOT_RAIN. Default 0.
    pub flags: u32,
    /// In M, 1 .. 1000. Inside the ISCO no orbit is stable: there the spot is taken to be at the ISCO. Default 8.
    pub radius: f64,
    /// In M, 0.05 .. radius / 4, and at least radius / 200; FREE: from 0.05 to 250. Default 0.8.
    pub size: f64,
    /// The centre at scene time 0, radians within +-1e6. Default 0.
    pub azimuth: f64,
    /// Per M at the centre, 0 .. 1e6. Default 0.
    pub absorption: f64,
    /// Kelvin, 500 .. 1e9. Default 10000.
    pub temperature: f64,
    /// Without THERMAL: -4 .. 4. Default 1.
    pub spectral_index: f64,
    /// Without THERMAL: the colour of its light at every shift, linear Rec. 709, each 0 .. 1. Default 1, 1, 1.
    pub tint: [f64; 3],
    /// 0 .. 1e6, as BhrVolume.brightness. Default 1.
    pub brightness: f64,
    /// FREE: where the centre is at `time`, scene axes and lengths, as BhrBody has it. Default 0, 0, 0, which FREE
    /// refuses.
    pub position: [f64; 3],
    /// FREE: its velocity there in units of c, |v| < 1, scene axes, as BhrBody has it. Default 0, 0, 0.
    pub velocity: [f64; 3],
    /// FREE: scene time, in scene lengths, that position and velocity are of; RAIN: rain time. Default 0.
    pub time: f64,
}

/// Most hot spots of a scene. @since 0.2.0
pub const BHR_MAX_HOT_SPOTS: usize = 8;

const _: () = assert!(BHR_MAX_HOT_SPOTS == HotSpot::MOST);

// SAFETY: repr(C), size first, no padding, numbers only.
unsafe impl Versioned for BhrHotSpot {
    const NAME: &'static str = "BhrHotSpot";
    const SIZES: &'static [usize] = &[88, 144];
    fn defaults() -> Self {
        HotSpot::default().into()
    }
}

impl From<HotSpot> for BhrHotSpot {
    fn from(spot: HotSpot) -> Self {
        Self {
            struct_size: 0,
            flags: if spot.retrograde { BHR_HOT_SPOT_RETROGRADE } else { 0 }
                | if spot.thermal { BHR_HOT_SPOT_THERMAL } else { 0 }
                | spot.free.map_or(0, |body| match Body::of_falling(&body).chart {
                    Chart::Static => BHR_HOT_SPOT_FREE,
                    Chart::Rain => BHR_HOT_SPOT_FREE | BHR_HOT_SPOT_RAIN,
                }),
            radius: spot.radius,
            size: spot.size,
            azimuth: spot.azimuth,
            absorption: spot.absorption,
            temperature: spot.temperature,
            spectral_index: spot.spectral_index,
            tint: spot.tint,
            brightness: spot.brightness,
            position: spot.free.map_or([0.0; 3], |body| body.position.to_array()),
            velocity: spot.free.map_or([0.0; 3], |body| body.velocity.to_array()),
            time: spot.free.map_or(0.0, |body| body.time),
        }
    }
}

impl TryFrom<BhrHotSpot> for HotSpot {
    type Error = Error;

    fn try_from(given: BhrHotSpot) -> Result<Self> {
        let known = BHR_HOT_SPOT_RETROGRADE | BHR_HOT_SPOT_THERMAL | BHR_HOT_SPOT_FREE | BHR_HOT_SPOT_RAIN;
        let flags = check_flags(given.flags, known, "hot spot flags")?;
        let chart = if flags & BHR_HOT_SPOT_RAIN != 0 { Chart::Rain } else { Chart::Static };
        let body = Body { chart, position: given.position.into(), velocity: given.velocity.into(), time: given.time };
        let spot = Self {
            free: (flags & BHR_HOT_SPOT_FREE != 0).then(|| body.falling()),
            retrograde: flags & BHR_HOT_SPOT_RETROGRADE != 0,
            thermal: flags & BHR_HOT_SPOT_THERMAL != 0,
            radius: given.radius,
            size: given.size,
            azimuth: given.azimuth,
            absorption: given.absorption,
            temperature: given.temperature,
            spectral_index: given.spectral_index,
            tint: given.tint,
            brightness: given.brightness,
        };
        spot.check()?;
        Ok(spot)
    }
}

const VOLUMES: Names = Names { array: "volumes", size: "volume_size", count: "volume count" };
const HOT_SPOTS: Names = Names { array: "hot_spots", size: "hot_spot_size", count: "hot spot count" };

/// Fills in the defaults. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_volume_init(volume: *mut BhrVolume, struct_size: usize) -> BhrStatus {
    // SAFETY: NULL or struct_size writable bytes, by the header's conventions.
    anywhere("bhr_volume_init", || unsafe { versioned::init(volume, "volume", struct_size) })
}

/// Fills in the defaults. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_hot_spot_init(hot_spot: *mut BhrHotSpot, struct_size: usize) -> BhrStatus {
    // SAFETY: NULL or struct_size writable bytes, by the header's conventions.
    anywhere("bhr_hot_spot_init", || unsafe { versioned::init(hot_spot, "hot spot", struct_size) })
}

/// Sets all volumes of the scene: count of them, packed, at most BHR_MAX_VOLUMES; 0: none, as a new context has it,
/// and then volumes may be NULL. They may overlap each other, the thin disk and hot spots. volume_size =
/// sizeof(BhrVolume) as the caller was compiled; no volume's struct_size may be larger. Frames that are being
/// rendered keep the volumes that they began with. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_set_volumes(
    context: *mut BhrContext,
    volumes: *const BhrVolume,
    volume_size: usize,
    count: u32,
) -> BhrStatus {
    // SAFETY: NULL or count elements, by the header's conventions.
    unsafe {
        on_context("bhr_set_volumes", context, |state| {
            state.renderer.scene.set_volumes(read_array(volumes, volume_size, count, &VOLUMES)?);
            Ok(())
        })
    }
}

/// Reads the volumes as they are set: *out_count becomes their number, and the first `capacity` of them are written,
/// packed, each with volume_size as its struct_size. With capacity 0 volumes may be NULL. After an error volumes are
/// as they were. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_get_volumes(
    context: *const BhrContext,
    volumes: *mut BhrVolume,
    volume_size: usize,
    capacity: u32,
    out_count: *mut u32,
) -> BhrStatus {
    // SAFETY: NULL or capacity elements, by the header's conventions.
    unsafe {
        let out = Out::cleared(out_count);
        on_context("bhr_get_volumes", context, |state| {
            out.required("out_count")?;
            let set = &state.renderer.scene.volumes;
            write_array(volumes, volume_size, capacity, set.iter().map(|v| BhrVolume::from(*v)), &VOLUMES)?;
            out.set(set.len() as u32);
            Ok(())
        })
    }
}

/// Sets all hot spots of the scene, at most BHR_MAX_HOT_SPOTS, as bhr_set_volumes does the volumes. One in free fall
/// is checked against the hole as it is, with bhr_world_line's errors; where a later hole has no such place it is not
/// shown. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_set_hot_spots(
    context: *mut BhrContext,
    hot_spots: *const BhrHotSpot,
    hot_spot_size: usize,
    count: u32,
) -> BhrStatus {
    // SAFETY: NULL or count elements, by the header's conventions.
    unsafe {
        on_context("bhr_set_hot_spots", context, |state| {
            state.renderer.scene.set_hot_spots(read_array(hot_spots, hot_spot_size, count, &HOT_SPOTS)?)
        })
    }
}

/// Reads the hot spots as they are set, as bhr_get_volumes does the volumes. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_get_hot_spots(
    context: *const BhrContext,
    hot_spots: *mut BhrHotSpot,
    hot_spot_size: usize,
    capacity: u32,
    out_count: *mut u32,
) -> BhrStatus {
    // SAFETY: NULL or capacity elements, by the header's conventions.
    unsafe {
        let out = Out::cleared(out_count);
        on_context("bhr_get_hot_spots", context, |state| {
            out.required("out_count")?;
            let set = &state.renderer.scene.hot_spots;
            write_array(hot_spots, hot_spot_size, capacity, set.iter().map(|s| BhrHotSpot::from(*s)), &HOT_SPOTS)?;
            out.set(set.len() as u32);
            Ok(())
        })
    }
}
