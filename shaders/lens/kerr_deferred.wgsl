// SPDX-License-Identifier: MIT OR Apache-2.0
// Ray records with spin of pixels that the tables of lens/kerr.wgsl do not hold, integrated. Footprints, of the sky and
// of crossings, are the tables' all the same: those of the next pixels' rays took twice as long, and changed the light
// of a turbulent disk by 0.08 of 255 (root mean square, spin 0.9 and 0.998).

#import constants
#import camera/chart
#import camera/observer
#import camera/projection
#import geodesic/geodesic
#import geodesic/trace
#import lens/kerr
#import lens/kerr_record
#import lens/media
#import records/record
#import shared/frame
#import shared/math
#import shared/pass

// u, azimuth and delay of the crossings of the plane by order. u is 0 where there is none.
var<private> deferred_crossings: array<vec3<f32>, CROSSINGS_KEPT>;
var<private> deferred_order: u32;
// The number of orders up to the last crossing.
var<private> deferred_count: u32;

fn on_crossing(c: Constants, crossing: PlaneCrossing) {
    var azimuth = 0.0;
    var delay = crossing.delay;
    if PATTERN {
        let offsets = chart_offsets(c, crossing.u);
        azimuth = wrap_angle(arctan2(crossing.n.y, crossing.n.x) + crossing.drag - offsets.x);
        delay += offsets.y;
    }
    deferred_count = min(crossing.order + 1u, CROSSINGS_KEPT);
    deferred_crossings[min(crossing.order, CROSSINGS_KEPT - 1u)] = vec3<f32>(crossing.u, azimuth, delay);
}

// No matter is summed along these rays.
fn on_part(c: Constants, observer: State, from_state: State, to_state: State, h: f32, begin: f32, end: f32) {
}

fn ray_record(id: vec2<u32>) -> Record {
    set_media_pixel(id);
    var record = look_up(id);
    if lookup.cell.y < lens.outer_rows {
        record = with_looked_up_sky(record);
    }
    let settings = Settings(frame.step, frame.tolerance, frame.max_steps, frame.max_crossings, frame.capture_u,
        frame.opaque_u);
    for (var i = 0u; i < CROSSINGS_KEPT; i += 1u) {
        deferred_crossings[i] = vec3<f32>(0.0);
    }
    deferred_count = 0u;
    let begin = begin_local(lookup.seen.n);
    record.fate = FATE_CAPTURED;
    if begin.has_light {
        let traced = trace(begin.c, begin.state, settings);
        record.fate = traced.fate;
        record.steps = traced.steps;
        if traced.fate == FATE_ESCAPED {
            let end = escape(begin.c, traced);
            record.sky = chart_direction(end.n, end.drag);
        }
    }
    deferred_order = 0u;
    atomicAdd(&deferred.steps, record.steps);
    return record;
}

// A deferred pixel's record comes with its sky.
fn with_sky(record: Record) -> Record {
    return record;
}

fn next_crossing() -> Crossing {
    var crossing: Crossing;
    var at: Interpolated;
    while more_crossings() && crossing.u <= 0.0 {
        let u = deferred_crossings[deferred_order].x;
        if u > 0.0 {
            // The tables' slope is nearly right all the same.
            at = interpolate(select(deferred_order / 4u, deferred_order, PATTERN));
            let change = looked_up_change(at, select(deferred_order % 4u, 0u, PATTERN));
            lookup.on_edge = lookup.on_edge || near_disk_edge(u, change);
        }
        if u >= frame.plane_u.x && u <= frame.plane_u.y {
            crossing.u = u;
            crossing.order = deferred_order;
        }
        deferred_order += 1u;
    }
    if crossing.u > 0.0 {
        crossing.g = lookup.seen.frequency_ratio * redshift_of(begin_local(lookup.seen.n).c, crossing.u);
        if PATTERN {
            let own = deferred_crossings[crossing.order];
            crossing.place = EmissionPoint(-log(own.x), own.y, own.z);
        }
        if PATTERN && FOOTPRINTS {
            crossing.dx = place_change(crossing.u, at, lookup.dx);
            crossing.dy = place_change(crossing.u, at, lookup.dy);
        }
    }
    return crossing;
}

fn more_crossings() -> bool {
    return deferred_order < deferred_count;
}
