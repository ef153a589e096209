// SPDX-License-Identifier: MIT OR Apache-2.0
// The matter along a part of a ray as far as the host's things let it be seen. Mirrors `Limit` of src/emit/along.rs.

#import constants
#import camera/chart
#import emit/occluder
#import emit/volumes
#import geodesic/geodesic
#import geodesic/integrator
#import shared/frame
#import shared/not_inlined

// How far the place at `tau` since a step's begin is beyond the host's things, in d / (d + r) of distances d, r being
// the eye's: along radial rays outwards that grows evenly in Mino time.
fn beyond_occluder(c: Constants, from_state: State, tau: f32) -> f32 {
    let there = step_ray(c, from_state, tau).state;
    // Near infinity, and past it, where u < 0, everything is; squares of such distances are beyond single precision.
    var distance = 1e30;
    if there.u > 1e-16 {
        // The host's things are told in the observer's chart.
        var drag = there.drag;
        if SPINNING && RAIN {
            drag += doran_turn(c, there.u);
        }
        distance = length(chart_direction(there.n, drag) / there.u - frame.e_r.xyz / frame.observer_u);
    }
    let eye = 1.0 / frame.observer_u;
    // Beyond infinite distances nothing is, nor beyond NaN; all is beyond those below 0.
    let farthest = select(1e30, clamp(occluder_farthest, 0.0, 1e30), occluder_farthest < 1e30);
    return distance / (distance + eye) - farthest / (farthest + eye);
}

// The stretch of a part of a ray, tau from `begin` to `end` since the begin of its step, of which matter is seen; an
// empty one where none is.
fn shown_stretch(c: Constants, from_state: State, begin: f32, end: f32) -> vec2<f32> {
    var low = begin;
    var high = end;
    var at_low = beyond_occluder(c, from_state, low);
    var at_high = beyond_occluder(c, from_state, high);
    let before = at_low > 0.0;
    let after = at_high > 0.0;
    let hidden = occluder_passed || (before && (after || occluder_ends));
    occluder_passed = occluder_passed || (occluder_ends && (before || after));
    var seen = vec2<f32>(begin, select(end, begin, hidden));
    if !hidden && before != after {
        for (var i = 0u; i < not_inlined(LIMIT_SECANTS); i += 1u) {
            // A border that stays counts by half of its value: the Illinois variant of false position.
            let x = low + (high - low) * (at_low / (at_low - at_high));
            let here = beyond_occluder(c, from_state, x);
            if (here > 0.0) == before {
                low = x;
                at_low = here;
                at_high *= 0.5;
            } else {
                high = x;
                at_high = here;
                at_low *= 0.5;
            }
        }
        let x = low + (high - low) * (at_low / (at_low - at_high));
        seen = select(vec2<f32>(begin, x), vec2<f32>(x, end), before);
    }
    // The part left out turns the ray as well: add_part counts the part that is seen.
    let left_out = abs(end - begin) - abs(seen.y - seen.x);
    ray_swept += left_out * min(sqrt(max(c.k, 0.0)), c.scale);
    return seen;
}
