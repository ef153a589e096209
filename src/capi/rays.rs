// SPDX-License-Identifier: MIT OR Apache-2.0
//! BhrRay, BhrHit: the tracer, asked directly. Arrays of the host's are packed with the struct sizes it was
//! compiled with.

use super::call::on_context;
use super::context::BhrContext;
use super::pointer::{Out, check_finite, is_null};
use super::status::BhrStatus;
use crate::allocate::{filled, with_room};
use crate::error::{Error, ErrorKind, Result};
use crate::image::MAX_SIDE;
use crate::renderer::Renderer;
use crate::scene::{Crossing, Hit, MAX_CROSSINGS, Ray};
use bytemuck::{Pod, Zeroable};
use glam::DVec3;
use std::mem::size_of;

/// A ray, followed backward in time from an observer. It does not grow within one BHR_ABI_VERSION.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct BhrRay {
    /// Scene axes and lengths.
    pub position: [f64; 3],
    /// The direction in which the observer looks, opposite to the photon's momentum; any non-zero length. Components
    /// are along the frame that Directions, above, gives, in the chart of the context's camera.
    pub direction: [f64; 3],
    /// nu(camera) / nu(observer of the local frame), > 0; 1 for an observer at rest in it. Multiplies the hit's
    /// redshifts.
    pub frequency_ratio: f64,
}

/// Crossings that a BhrHit lists.
pub const BHR_MAX_CROSSINGS: usize = 4;

const _: () = assert!(BHR_MAX_CROSSINGS == MAX_CROSSINGS);

/// A crossing of the equatorial plane outside the horizon. Within one BHR_ABI_VERSION it does not grow.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct BhrCrossing {
    /// Boyer-Lindquist r, scene lengths.
    pub radius: f64,
    /// Boyer-Lindquist ph in the chart, (-pi, pi], of rays in chart RAIN too.
    pub azimuth: f64,
    /// g = nu(camera) / nu(emitter on the disk's circular orbit); inside the ISCO that of falling matter with
    /// BHR_DISK_PLUNGES, else NaN.
    pub redshift: f64,
    /// Coordinate time since the photon left, scene lengths; NaN from inside the horizon. In chart RAIN: rain time T
    /// at the ray's begin less the coordinate time t at which the photon left.
    pub delay: f64,
}

/// How a ray ends.
pub type BhrFate = i32;
/// The ray ends at the horizon.
pub const BHR_FATE_CAPTURED: BhrFate = 0;
/// The ray reaches the sky.
pub const BHR_FATE_ESCAPED: BhrFate = 1;
/// BhrQuality.max_steps ran out.
pub const BHR_FATE_UNRESOLVED: BhrFate = 2;
/// The ray is not valid: not finite, direction zero, or no frame at its place.
pub const BHR_FATE_INVALID: BhrFate = 3;

/// The end of a ray, and its crossings of the equatorial plane. It may grow: bhr_trace_rays is told hit_size.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct BhrHit {
    /// BHR_FATE_*.
    pub fate: BhrFate,
    /// 0 .. BHR_MAX_CROSSINGS.
    pub crossing_count: u32,
    /// Asymptotic, unit, scene axes; 0 unless escaped.
    pub sky_direction: [f64; 3],
    /// nu(camera) / nu(at infinity); NaN unless escaped.
    pub sky_redshift: f64,
    /// Spin 0: orbit angle to infinity, or to the horizon, radians; with spin NaN.
    pub swept_angle: f64,
    /// Integration steps.
    pub steps: u32,
    /// Reserved: 0.
    pub reserved: u32,
    /// In order along the ray; 0 beyond crossing_count.
    pub crossings: [BhrCrossing; BHR_MAX_CROSSINGS],
}

impl From<Ray> for BhrRay {
    fn from(ray: Ray) -> Self {
        Self {
            position: ray.position.to_array(),
            direction: ray.direction.to_array(),
            frequency_ratio: ray.frequency_ratio,
        }
    }
}

impl From<BhrRay> for Ray {
    fn from(ray: BhrRay) -> Self {
        Self { position: ray.position.into(), direction: ray.direction.into(), frequency_ratio: ray.frequency_ratio }
    }
}

impl From<Crossing> for BhrCrossing {
    fn from(crossing: Crossing) -> Self {
        Self { radius: crossing.radius, azimuth: crossing.azimuth, redshift: crossing.redshift, delay: crossing.delay }
    }
}

impl From<Hit> for BhrHit {
    fn from(hit: Hit) -> Self {
        Self {
            fate: hit.fate as BhrFate,
            crossing_count: hit.crossing_count,
            sky_direction: hit.sky_direction.to_array(),
            sky_redshift: hit.sky_redshift,
            swept_angle: hit.swept_angle,
            steps: hit.steps,
            reserved: 0,
            crossings: hit.crossings.map(BhrCrossing::from),
        }
    }
}

/// `width * height`. Errors: a side that is 0 or longer than an image's; more rays than memory has addresses for.
pub(super) fn frame_pixels(width: u32, height: u32) -> Result<usize> {
    for (name, side) in [("width", width), ("height", height)] {
        if side == 0 || side > MAX_SIDE {
            return Err(Error::argument(format!("frame {name} is {side}; it must lie in [1, {MAX_SIDE}]")));
        }
    }
    // At most 2^40 rays of 56 bytes: no overflow in 64 bits.
    let count = u64::from(width) * u64::from(height);
    match isize::try_from(count * size_of::<BhrRay>() as u64) {
        Ok(_) => Ok(count as usize),
        Err(_) => {
            Err(Error::argument(format!("frame size is {width} x {height}; there is no memory for so many rays")))
        }
    }
}

/// The rays of a width x height frame (with a region: of the image that is this part of it), row by row, through the
/// pixel centres; out_rays has room for width * height. Where a projection shows nothing (outside a FISHEYE's
/// circle): direction 0, frequency_ratio 1, which is traced to BHR_FATE_INVALID. out_rays is left alone by
/// INVALID_ARGUMENT and cleared by other errors.
/// Errors: INVALID_ARGUMENT for a side of 0 or above 2^20, or an image that reaches out of the region's frame;
/// INVALID_STATE and UNSUPPORTED as bhr_render_image.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_camera_rays(
    context: *const BhrContext,
    width: u32,
    height: u32,
    out_rays: *mut BhrRay,
) -> BhrStatus {
    // SAFETY: NULL or room for width * height rays, by the header's conventions.
    unsafe {
        on_context("bhr_camera_rays", context, |state| {
            let count = frame_pixels(width, height)?;
            if out_rays.is_null() {
                return Err(is_null("out_rays"));
            }
            let mut write = |index: usize, ray: Ray| {
                if index < count {
                    out_rays.add(index).write_unaligned(ray.into());
                }
            };
            let result = state.renderer.scene.camera_rays(width, height, state.region, &mut write);
            if result.as_ref().is_err_and(|error| error.kind != ErrorKind::InvalidArgument) {
                out_rays.cast::<u8>().write_bytes(0, count * size_of::<BhrRay>());
            }
            result
        })
    }
}

/// One of those rays, at pixel position x, y: (0, 0) is the top-left corner of the frame (with a region: of the
/// image). Outside the frame the image plane, the angles (EQUIRECT) or the nearest face (CUBE) continue.
/// Errors: those of bhr_camera_rays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_camera_ray(
    context: *const BhrContext,
    width: u32,
    height: u32,
    x: f64,
    y: f64,
    out_ray: *mut BhrRay,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let out = Out::cleared(out_ray);
        on_context("bhr_camera_ray", context, |state| {
            out.required("out_ray")?;
            frame_pixels(width, height)?;
            let (x, y) = (check_finite(x, "x")?, check_finite(y, "y")?);
            out.set(state.renderer.scene.camera_ray(width, height, state.region, x, y)?.into());
            Ok(())
        })
    }
}

/// The number of rays that are copied and traced at a time; it bounds the library's own memory.
pub(super) const CHUNK: usize = 65_536;

/// A size that the structs will never reach.
const MAX_ELEMENT: usize = 16 * 1024;

// Neither may grow: `bhr_camera_rays` and others fill a BhrRay in without being told its size, and a BhrHit holds
// crossings.
const _: () = assert!(size_of::<BhrRay>() == 56 && size_of::<BhrCrossing>() == 32);

/// The sizes of a BhrHit, as `Versioned::SIZES` of structs that hold theirs.
const HIT_SIZES: [usize; 1] = [184];
const FIRST_HIT: usize = HIT_SIZES[0];

const _: () = assert!(HIT_SIZES[HIT_SIZES.len() - 1] == size_of::<BhrHit>());

/// A packed array of the host's, of elements that may be longer than ours.
#[derive(Clone, Copy)]
pub(super) struct Array {
    begin: *mut u8,
    element: usize,
}

impl Array {
    /// Errors: NULL unless `count` is 0; an element shorter than `first`; more bytes than memory has.
    pub(super) fn new(begin: *mut u8, element: usize, first: usize, count: usize, names: [&str; 2]) -> Result<Self> {
        let [name, size_name] = names;
        if !(first..=MAX_ELEMENT).contains(&element) {
            return Err(Error::argument(format!("{size_name} is {element}; it must lie in [{first}, {MAX_ELEMENT}]")));
        }
        if element.checked_mul(count).and_then(|bytes| isize::try_from(bytes).ok()).is_none() {
            return Err(Error::argument(format!("count is {count}; that many {name} do not fit into memory")));
        }
        if begin.is_null() && count > 0 {
            return Err(is_null(name));
        }
        Ok(Self { begin, element })
    }

    /// # Safety
    /// `index` is less than the count, and the host's array is readable.
    pub(super) unsafe fn read_ray(self, index: usize) -> Result<Ray> {
        let known = size_of::<BhrRay>();
        // SAFETY: this function's contract; `element >= known` by `new`.
        unsafe {
            let at = self.begin.add(index * self.element);
            if (known..self.element).any(|offset| at.add(offset).read() != 0) {
                return Err(Error::argument(format!(
                    "rays[{index}] is longer than this library's BhrRay ({known} bytes) and not 0 there"
                )));
            }
            Ok(at.cast::<BhrRay>().read_unaligned().into())
        }
    }

    /// # Safety
    /// `index` is less than the count, and elements are three doubles or longer.
    pub(super) unsafe fn read_vector(self, index: usize) -> DVec3 {
        // SAFETY: this function's contract.
        unsafe { self.at(index).cast::<[f64; 3]>().read_unaligned() }.into()
    }

    /// # Safety
    /// `index` is less than the count, and elements are doubles or longer.
    pub(super) unsafe fn read_double(self, index: usize) -> f64 {
        // SAFETY: this function's contract.
        unsafe { self.at(index).cast::<f64>().read_unaligned() }
    }

    /// # Safety
    /// `index` is less than the count.
    pub(super) unsafe fn at(self, index: usize) -> *mut u8 {
        // SAFETY: this function's contract.
        unsafe { self.begin.add(index * self.element) }
    }

    /// # Safety
    /// The host's array is writable and has `count` elements.
    pub(super) unsafe fn clear(self, count: usize) {
        if count > 0 {
            // SAFETY: this function's contract; NULL goes with a count of 0.
            unsafe { self.begin.write_bytes(0, count * self.element) }
        }
    }

    /// Writes as much of the hit as the host's element holds; the rest of a longer element becomes zero.
    ///
    /// # Safety
    /// `index` is less than the count, and the host's array is writable.
    unsafe fn write_hit(self, index: usize, hit: Hit) {
        // SAFETY: this function's contract.
        unsafe { self.write(index, bytemuck::bytes_of(&BhrHit::from(hit))) }
    }

    /// # Safety
    /// `index` is less than the count, and the host's array is writable.
    pub(super) unsafe fn write(self, index: usize, value: &[u8]) {
        let known = value.len().min(self.element);
        // SAFETY: this function's contract; `known` is no longer than the element or the value.
        unsafe {
            let at = self.begin.add(index * self.element);
            std::ptr::copy_nonoverlapping(value.as_ptr(), at, known);
            at.add(known).write_bytes(0, self.element - known);
        }
    }
}

/// # Safety
/// `rays` and `hits` hold `count` elements.
unsafe fn trace_all(renderer: &mut Renderer, rays: Array, hits: Array, count: usize) -> Result<()> {
    let most = CHUNK.min(count);
    let mut chunk = with_room(most, "rays to trace")?;
    let mut found = filled(most, Hit::default(), "what rays hit")?;
    let mut begin = 0;
    while begin < count {
        let length = CHUNK.min(count - begin);
        chunk.clear();
        for index in begin..begin + length {
            // SAFETY: the indices are below `count`.
            chunk.push(unsafe { rays.read_ray(index) }?);
        }
        renderer.trace_rays(&chunk, &mut found[..length])?;
        for (index, hit) in (begin..).zip(&found[..length]) {
            // SAFETY: as above.
            unsafe { hits.write_hit(index, *hit) };
        }
        begin += length;
    }
    Ok(())
}

/// Traces count rays on the context's backend. The scene's disk does not matter: crossings are those of the bare
/// equatorial plane, down to r+ (1 + 1e-5), and the first BHR_MAX_CROSSINGS are listed. Their emitter moves as the
/// disk's flags say, prograde without a disk; a start in the plane is no crossing. One bad ray is BHR_FATE_INVALID,
/// not an error of the batch. ray_size = sizeof(BhrRay) and hit_size = sizeof(BhrHit) as the caller was compiled, at
/// least 56 and 184; both arrays are packed. A ray that is longer than this library's must be 0 beyond it; a longer
/// hit is cleared there. With count 0 the call does nothing. An error while tracing clears out_hits.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_trace_rays(
    context: *mut BhrContext,
    rays: *const BhrRay,
    ray_size: usize,
    count: usize,
    out_hits: *mut BhrHit,
    hit_size: usize,
) -> BhrStatus {
    // SAFETY: NULL or count elements, by the header's conventions.
    unsafe {
        on_context("bhr_trace_rays", context, |state| {
            let from = Array::new(rays.cast_mut().cast(), ray_size, size_of::<BhrRay>(), count, ["rays", "ray_size"])?;
            let to = Array::new(out_hits.cast(), hit_size, FIRST_HIT, count, ["out_hits", "hit_size"])?;
            let result = trace_all(&mut state.renderer, from, to, count);
            if result.is_err() {
                to.clear(count);
            }
            result
        })
    }
}

/// Fills in the curve that a ray follows: x, y, z (scene axes) and t (scene lengths, t <= 0: backward) for each
/// point. out_points has room for 4 capacity doubles. *out_count becomes the number of points: 2 or more, at most
/// capacity, never more than 65536. The last point is the curve's end: just outside the horizon, or, for a ray that
/// escapes, at ten times the observer's radius, but at least 1000 M; a ray that needs more than max_steps ends where
/// they ran out. The curve is traced in double precision on the CPU, whatever the backend.
/// Errors: INVALID_ARGUMENT for capacity < 2, or a ray that is not valid, as from inside a spinning hole's horizon
/// in chart STATIC.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_trace_path(
    context: *mut BhrContext,
    ray: *const BhrRay,
    capacity: u32,
    out_points: *mut f64,
    out_count: *mut u32,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let out = Out::cleared(out_count);
        on_context("bhr_trace_path", context, |state| {
            out.required("out_count")?;
            for (missing, name) in [(ray.is_null(), "ray"), (out_points.is_null(), "out_points")] {
                if missing {
                    return Err(is_null(name));
                }
            }
            if capacity < 2 {
                return Err(Error::argument(format!("capacity is {capacity}; a path has at least 2 points")));
            }
            let mut points = state.renderer.trace_path(&ray.read_unaligned().into(), capacity as usize)?;
            points.truncate(capacity as usize);
            std::ptr::copy_nonoverlapping(
                points.as_ptr().cast::<u8>(),
                out_points.cast::<u8>(),
                size_of_val(points.as_slice()),
            );
            out.set(points.len() as u32);
            Ok(())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_longer_ray_must_be_zero_beyond_what_is_known() {
        let known = size_of::<BhrRay>();
        let mut bytes = vec![0u8; 2 * (known + 8)];
        let array = Array::new(bytes.as_mut_ptr(), known + 8, known, 2, ["rays", "ray_size"]).unwrap();
        // SAFETY: two elements are there.
        assert!(unsafe { array.read_ray(1) }.is_ok());
        bytes[2 * known + 15] = 1;
        // SAFETY: as above.
        let error = unsafe { array.read_ray(1) }.unwrap_err();
        assert!(error.message.contains("rays[1]"), "{error}");
    }

    #[test]
    fn a_longer_hit_gets_a_zeroed_tail() {
        let known = size_of::<BhrHit>();
        let mut bytes = vec![7u8; known + 8];
        let array = Array::new(bytes.as_mut_ptr(), known + 4, known, 1, ["hits", "hit_size"]).unwrap();
        // SAFETY: one element is there.
        unsafe { array.write_hit(0, Hit::default()) };
        assert_eq!(bytes[known..], [0, 0, 0, 0, 7, 7, 7, 7]);
    }

    /// A hit that is longer than the host's, as if it had grown after the host was compiled.
    #[test]
    fn a_shorter_hit_is_written_no_further_than_it_is_long() {
        let mut bytes = [7u8; 3 * FIRST_HIT];
        let array = Array::new(bytes.as_mut_ptr(), FIRST_HIT, FIRST_HIT, 2, ["hits", "hit_size"]).unwrap();
        let grown = (0..FIRST_HIT + 16).map(|i| i as u8).collect::<Vec<_>>();
        // SAFETY: two elements are there.
        unsafe { array.write(1, &grown) };
        assert_eq!(bytes[..FIRST_HIT], [7; FIRST_HIT]);
        assert_eq!(bytes[FIRST_HIT..2 * FIRST_HIT], grown[..FIRST_HIT]);
        assert_eq!(bytes[2 * FIRST_HIT..], [7; FIRST_HIT]);
    }

    #[test]
    fn arrays_that_cannot_be_are_refused() {
        let one = std::ptr::dangling_mut();
        for (begin, element, count) in
            [(one, 55, 1), (one, MAX_ELEMENT + 1, 1), (one, 56, usize::MAX / 40), (std::ptr::null_mut(), 56, 1)]
        {
            assert!(Array::new(begin, element, 56, count, ["rays", "ray_size"]).is_err());
        }
        assert!(Array::new(std::ptr::null_mut(), 56, 56, 0, ["rays", "ray_size"]).is_ok());
        for (width, height) in [(0, 1), (1, 0), (1, MAX_SIDE + 1), (u32::MAX, u32::MAX)] {
            assert!(frame_pixels(width, height).is_err());
        }
        assert_eq!(frame_pixels(MAX_SIDE, 2).unwrap(), 2 << 20);
    }
}
