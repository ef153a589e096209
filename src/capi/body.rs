// SPDX-License-Identifier: MIT OR Apache-2.0
//! BhrBody: bodies in free fall about the hole, and their world lines. Knows no camera.

use super::call::on_context;
use super::chart::{BhrChart, chart};
use super::context::BhrContext;
use super::entry::anywhere;
use super::pointer::{check_finite, check_finite_vector, check_reserved};
use super::rays::Array;
use super::status::BhrStatus;
use super::versioned::{self, Versioned, check_named_size};
use crate::allocate::collected;
use crate::error::{Error, Result};
use crate::scene::{Body, BodyEvent, Hole, WorldLineEnd};
use std::mem::size_of;

/// Whether and where a world line has ended. @since 0.2.0
pub type BhrWorldLineEnd = i32;
/// The line goes on.
pub const BHR_WORLD_LINE_GOES_ON: BhrWorldLineEnd = 0;
/// At r- (1 + 1e-6); without spin in the centre, at r = 1e-9 M.
pub const BHR_WORLD_LINE_INNER_HORIZON: BhrWorldLineEnd = 1;
/// At r+, within 1e-6 of it: in STATIC, or backward in time.
pub const BHR_WORLD_LINE_HORIZON: BhrWorldLineEnd = 2;

/// A body in free fall, at an event. bhr_world_line gives all its fields. @since 0.2.0
#[repr(C)]
#[derive(Clone, Copy)]
pub struct BhrBody {
    /// sizeof(BhrBody).
    pub struct_size: u32,
    /// BHR_CHART_*; at r <= r+ (1 + 1e-6) RAIN, without spin too.
    pub chart: BhrChart,
    /// Scene axes and lengths, in that chart.
    pub position: [f64; 3],
    /// v / c against the chart's observer, |v| < 1; components as for a direction.
    pub velocity: [f64; 3],
    /// The chart's time, scene lengths.
    pub time: f64,
    /// Output: scene lengths since the start: as asked for, or of the line's end.
    pub proper_time: f64,
    /// Output: BHR_WORLD_LINE_*.
    pub end: BhrWorldLineEnd,
    /// Reserved: 0.
    pub reserved: u32,
}

// SAFETY: repr(C), size first, no padding, numbers only.
unsafe impl Versioned for BhrBody {
    const NAME: &'static str = "BhrBody";
    const SIZES: &'static [usize] = &[80];
    fn defaults() -> Self {
        Self {
            struct_size: 0,
            chart: super::chart::BHR_CHART_STATIC,
            position: [0.0; 3],
            velocity: [0.0; 3],
            time: 0.0,
            proper_time: 0.0,
            end: BHR_WORLD_LINE_GOES_ON,
            reserved: 0,
        }
    }
}

impl TryFrom<BhrBody> for Body {
    type Error = Error;

    fn try_from(given: BhrBody) -> Result<Self> {
        check_reserved(given.reserved, "body")?;
        Ok(Self {
            chart: chart(given.chart, "body")?,
            position: check_finite_vector(given.position.into(), "body position")?,
            velocity: check_finite_vector(given.velocity.into(), "body velocity")?,
            time: check_finite(given.time, "body time")?,
        })
    }
}

/// An event on the world line of a body that was told in `chart`.
fn told(chart: BhrChart, event: &BodyEvent) -> BhrBody {
    BhrBody {
        struct_size: 0,
        chart,
        position: event.body.position.to_array(),
        velocity: event.body.velocity.to_array(),
        time: event.body.time,
        proper_time: event.proper_time,
        end: match event.end {
            None => BHR_WORLD_LINE_GOES_ON,
            Some(WorldLineEnd::InnerHorizon) => BHR_WORLD_LINE_INNER_HORIZON,
            Some(WorldLineEnd::Horizon) => BHR_WORLD_LINE_HORIZON,
        },
        reserved: 0,
    }
}

/// Sets struct_size and clears the rest: chart STATIC; the position has no default. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_body_init(body: *mut BhrBody, struct_size: usize) -> BhrStatus {
    // SAFETY: NULL or struct_size writable bytes, by the header's conventions.
    anywhere("bhr_body_init", || unsafe { versioned::init(body, "body", struct_size) })
}

/// # Safety
/// `body` is NULL or valid; `times` and `out` hold `count` elements, those of `out` of `size` bytes.
unsafe fn follow(hole: &Hole, body: *const BhrBody, times: Array, out: Array, count: usize, size: usize) -> Result<()> {
    // SAFETY: this function's contract.
    let given = unsafe { versioned::read(body, "body") }?;
    let start = Body::try_from(given)?;
    // SAFETY: the indices are below `count`. All are read before the first body is written.
    let times = collected((0..count).map(|index| unsafe { times.read_double(index) }), "proper times")?;
    hole.world_line(&start, &times, &mut |index, event| {
        // SAFETY: the index is that of a proper time.
        unsafe { versioned::fill(out.at(index).cast(), size, &told(given.chart, &event)) }
    })
}

/// Where a body in free fall is, and how it moves, after each of count proper times: scene lengths, any sign and order,
/// within 1e12 M. body_size: sizeof(BhrBody) as the caller was compiled; out_bodies has room for count, packed, each
/// in body's chart, and gets that size as its struct_size; body may be one of them. A line that ends before gives its
/// end. With count 0 the call does nothing. Computed in double precision on this thread; other calls of the context
/// wait until it returns. Errors of body, of a time and of the line clear out_bodies, others leave them alone.
/// docs/cameras.md.
/// Errors: INVALID_ARGUMENT for a place beyond 1e12 M; UNSUPPORTED for one that the chart does not hold, or at or
/// inside r- (1 + 1e-6), and for lines of more than 300,000 steps. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_world_line(
    context: *const BhrContext,
    body: *const BhrBody,
    proper_times: *const f64,
    count: usize,
    out_bodies: *mut BhrBody,
    body_size: usize,
) -> BhrStatus {
    // SAFETY: NULL or count elements, by the header's conventions.
    unsafe {
        on_context("bhr_world_line", context, |state| {
            let element = size_of::<f64>();
            let names = ["proper_times", "size of a proper time"];
            let times = Array::new(proper_times.cast_mut().cast(), element, element, count, names)?;
            check_named_size::<BhrBody>(body_size, "body_size")?;
            let names = ["out_bodies", "body_size"];
            let out = Array::new(out_bodies.cast(), body_size, BhrBody::SIZES[0], count, names)?;
            if count == 0 {
                return Ok(());
            }
            let result = follow(&state.renderer.scene.hole, body, times, out, count, body_size);
            if result.is_err() {
                out.clear(count);
            }
            result
        })
    }
}
