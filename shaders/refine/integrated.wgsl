// SPDX-License-Identifier: MIT OR Apache-2.0
// A ray that is integrated for one sample of a pixel, and its crossings of the whole plane. Used by
// refine/traced.wgsl and refine/kerr.wgsl; knows no tables and no textures.

#import constants
#import camera/chart
#import camera/observer
#import camera/projection
#import emit/moment
#import emit/occluder
#import emit/shown_part
#import emit/volumes
#import geodesic/geodesic
#import geodesic/trace
#import records/record
#import shared/frame
#import shared/math
#import shared/pass
#requires var samples: u32

// u, azimuth, delay and u' by order; u is 0 where there is none.
var<private> kept_crossings: array<vec4<f32>, CROSSINGS_KEPT>;
var<private> kept_order: u32;
// Orders up to that of the last crossing.
var<private> kept_count: u32;
// With PARTS: the media before the crossings that are given, and behind the last; the number of those crossings.
var<private> kept_media: array<vec4<f32>, CROSSINGS_KEPT + 1u>;
var<private> kept_given: u32;
// The constants of the ray.
var<private> kept_constants: Constants;
var<private> kept_ratio: f32;
// RayTrace::turned of the ray; UNKNOWN_TURN without spin, and unless it escaped.
var<private> kept_turn: f32;

fn on_crossing(c: Constants, crossing: PlaneCrossing) {
    var azimuth = 0.0;
    var delay = crossing.delay;
    if FOOTPRINTS {
        let offsets = chart_offsets(c, crossing.u);
        azimuth = wrap_angle(arctan2(crossing.n.y, crossing.n.x) + crossing.drag - offsets.x);
        delay += offsets.y;
    }
    if PARTS && PLANE && is_wanted(crossing.u) {
        kept_media[min(kept_given, CROSSINGS_KEPT)] = medium;
        kept_given += 1u;
        medium = NO_MEDIUM;
    }
    kept_count = min(crossing.order + 1u, CROSSINGS_KEPT);
    kept_crossings[min(crossing.order, CROSSINGS_KEPT - 1u)] =
        vec4<f32>(crossing.u, azimuth, delay, crossing.du);
}

fn on_part(c: Constants, observer: State, from_state: State, to_state: State, h: f32, begin: f32, end: f32) {
    next_part(begin);
    var seen = vec2<f32>(begin, end);
    if OCCLUDED {
        seen = shown_stretch(c, from_state, begin, end);
    }
    if !OCCLUDED || seen.x < seen.y {
        add_part(c, observer, from_state, to_state, h, seen.x, seen.y, kept_ratio);
    }
}

fn medium_before(k: u32) -> vec4<f32> {
    return kept_media[min(k, CROSSINGS_KEPT)];
}

// The record of the sample at pixel_place(id), without footprints.
fn integrated_record(id: vec2<u32>) -> Record {
    for (var i = 0u; i < CROSSINGS_KEPT; i += 1u) {
        kept_crossings[i] = vec4<f32>(0.0);
    }
    kept_order = 0u;
    kept_count = 0u;
    kept_turn = UNKNOWN_TURN;
    if PARTS {
        kept_given = 0u;
    }
    let place = pixel_place(id);
    moment = pass_.moment;
    if OCCLUDED {
        set_occluder(place);
    }
    let begin = begin_ray(look_direction(place.x, place.y));
    kept_constants = begin.c;
    kept_ratio = begin.frequency_ratio;
    if PARTS {
        begin_medium(begin.c, begin.state, samples);
    }
    var record = Record(FATE_CAPTURED, 0u, begin.c.energy / begin.c.nu_local,
        begin.c.angular_momentum / begin.c.nu_local, polar_momentum(begin, begin.frequency_ratio), 0.0,
        begin.frequency_ratio * begin.c.nu_local / begin.c.energy, vec3<f32>(0.0), UNKNOWN_FOOTPRINT);
    if begin.has_light {
        // The disk may cover but a part of the sample's cell, and then hides nothing behind it.
        let opaque_u = select(opaque_u_at(), vec2<f32>(1.0, 0.0), whole_plane);
        let settings = Settings(frame.step, frame.tolerance, frame.max_steps, frame.max_crossings,
            frame.capture_u, opaque_u);
        let traced = trace(begin.c, begin.state, settings);
        record.fate = traced.fate;
        if traced.fate == FATE_ESCAPED {
            let end = escape(begin.c, traced);
            record.sky = chart_direction(end.n, end.drag);
            if SPINNING {
                kept_turn = azimuth_turned(begin.c, end.drag - begin.state.drag, end.delay);
            }
            // Unknown, but in directions that exist.
            record.footprint = footprint_of(record.sky, vec3<f32>(0.0), vec3<f32>(0.0));
            record.footprint.dx = vec2<f32>(1e30);
            record.footprint.dy = vec2<f32>(1e30);
        }
    }
    if PARTS {
        kept_media[min(kept_given, CROSSINGS_KEPT)] = medium;
    }
    return record;
}

// Constants::azimuth_turned of a ray about a spinning hole.
fn azimuth_turned(c: Constants, drag: f32, tau: f32) -> f32 {
    let root = sqrt(max(c.k, 0.0));
    let turned = drag + root * tau * select(1.0, -1.0, c.angular_momentum < 0.0);
    return select(UNKNOWN_TURN, turned, abs(c.angular_momentum) > AROUND_AXIS * root);
}

fn more_integrated() -> bool {
    return kept_order < kept_count;
}

// Without footprint.
fn next_integrated() -> Crossing {
    var crossing: Crossing;
    if !PLANE {
        return crossing;
    }
    while more_integrated() && crossing.u <= 0.0 {
        let at = kept_crossings[kept_order];
        if is_wanted(at.x) {
            crossing.u = at.x;
            crossing.order = kept_order;
            crossing.g = kept_ratio * redshift_at(kept_constants, at.x, at.w);
            crossing.place = EmissionPoint(-log(at.x), at.y, at.z);
            crossing.dx = EmissionPoint(1e30, 0.0, 0.0);
            crossing.dy = EmissionPoint(1e30, 0.0, 0.0);
        }
        kept_order += 1u;
    }
    return crossing;
}
