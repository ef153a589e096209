// SPDX-License-Identifier: MIT OR Apache-2.0
// A piece of a ray in one volume that has structure, in even layers. Mirrors `Sum::layers` of src/emit/volumes.rs, but
// for this: what changes slowly (place, delay, angular velocity, redshift factor g) is found at three places of the
// piece, between which parabolas tell it; a layer has its density, its structure and its light for itself.

#import constants
#import emit/clouds
#import emit/course
#import emit/flow
#import emit/glow
#import emit/medium
#import emit/shape
#import emit/shift
#import geodesic/geodesic
#import shared/frame
#import shared/matter

// Whether the view shows I_nu and optical depth, not light.
override SHOWS_DEPTH: bool = false;
// Whether some matter has structure.
override STRUCTURE: bool = false;
// Whether a volume with structure is all the matter that there is, in a picture with all effects.
override ALONE: bool = false;
// Nearer to the axis (sin^2 theta) and to the horizon (1 - r+ / r) parabolas do not tell azimuth and g.
const ROUND_AXIS: f32 = 0.1;
const ROUND_HORIZON: f32 = 0.1;

// Whether so much matter is in front that what is behind does not matter.
fn is_dark() -> bool {
    if SHOWS_DEPTH {
        return medium.y > DARK;
    }
    return medium.w < exp(-DARK_PICTURE);
}

// All that changes slowly: 1/r, cos th, azimuth, M after the reference time; the angular velocity times r^(3/2), g.
struct Slow {
    place: vec4<f32>,
    motion: vec2<f32>,
}

fn slow_at(c: Constants, observer: State, course: StepCourse, x: f32, h: f32, ratio: f32) -> Slow {
    let exact = quintic_at(course.u, x);
    // None is past infinity, nor within the horizon.
    let u = clamp(exact, 1e-9, (1.0 - HORIZON_ROOM) / c.r_plus);
    let cosine = clamp(quintic_at(course.n_z, x), -1.0, 1.0);
    let du = quintic_slope(course.u, x) / h;
    let azimuth = arctan2(quintic_at(course.n_y, x), quintic_at(course.n_x, x)) + cubic_at(course.drag, x);
    var later = 0.0;
    if DELAY {
        let integral = cubic_at(course.delay, x) - observer.delay;
        later = frame.matter_delay - retardation(c, observer.u, observer.du, u, du, integral);
    }
    let at = place_at(c, u, cosine);
    let velocity = flow_velocity(c, at, frame.matter[0]);
    let nu = measured_by(zamo_light(c, at, du), velocity) / c.nu_local;
    // Nothing can move so where this fails, NaN among it.
    let g = select(0.0, ratio / nu, nu > 0.0 && nu < 1e30 && u == exact);
    let r = 1.0 / u;
    return Slow(vec4<f32>(u, cosine, azimuth, later), vec2<f32>(angular_velocity(c.a, at, velocity) * r * sqrt(r), g));
}

// Adds a piece between two shares of a step in `count` even layers. `widths`: of a pixel at its ends.
fn add_layers(
    c: Constants,
    observer: State,
    course: StepCourse,
    ends: vec2<f32>,
    h: f32,
    count: f32,
    widths: vec2<f32>,
    ratio: f32,
) {
    let matter = frame.matter[0];
    let u = vec2<f32>(quintic_at(course.u, ends.x), quintic_at(course.u, ends.y));
    let cosines = vec2<f32>(quintic_at(course.n_z, ends.x), quintic_at(course.n_z, ends.y));
    let is_smooth = max(u.x, u.y) * c.r_plus < 1.0 - ROUND_HORIZON
        && max(cosines.x * cosines.x, cosines.y * cosines.y) < 1.0 - ROUND_AXIS;
    // u32 of NaN may be any number.
    let layers = clamp(u32(count), 1u, u32(MOST_CELLS));
    let each = (ends.y - ends.x) / count;
    // Where they are not smooth each layer has a span of its own.
    let spans = select(layers, 1u, is_smooth);
    let tau = each * h * c.nu_local;
    for (var span = 0u; span < spans && !is_dark(); span += 1u) {
        var slow = array<Slow, 3>();
        let nodes = select(1u, 3u, is_smooth);
        for (var i = 0u; i < nodes; i += 1u) {
            let share = select((f32(span) + 0.5) / count, 0.5 * f32(i), is_smooth);
            let found = slow_at(c, observer, course, ends.x + (ends.y - ends.x) * share, h, ratio);
            slow[0] = slow[1];
            slow[1] = slow[2];
            slow[2] = found;
        }
        var begin = slow[2];
        var rise = Slow();
        var bend = Slow();
        if is_smooth {
            begin = slow[0];
            // The azimuth has no seam between them.
            let turns = vec4<f32>(0.0, 0.0, TAU, 0.0);
            let middle = slow[1].place - begin.place;
            let end = slow[2].place - begin.place;
            let m = middle - turns * round(middle.z / TAU);
            let e = end - turns * round(end.z / TAU);
            let n = slow[1].motion - begin.motion;
            let f = slow[2].motion - begin.motion;
            rise = Slow(4.0 * m - e, 4.0 * n - f);
            bend = Slow(2.0 * (e - 2.0 * m), 2.0 * (f - 2.0 * n));
        }
        let last = select(span + 1u, layers, is_smooth);
        for (var layer = span; layer < last && !is_dark(); layer += 1u) {
            let t = (f32(layer) + 0.5) / count;
            let place = begin.place + t * (rise.place + t * bend.place);
            let motion = begin.motion + t * (rise.motion + t * bend.motion);
            let r = 1.0 / place.x;
            let g = motion.y;
            let even = density_at(r, place.y, place.z, place.w, matter);
            if even >= matter.light.w && g > 0.0 {
                let nu = ratio / g;
                let a_cosine = c.a * place.y;
                let length = tau * (r * r + a_cosine * a_cosine);
                let omega = motion.x * place.x * sqrt(place.x);
                let structure = cloud_pattern(0u, CloudPlace(r, place.y, place.z, place.w), omega,
                    Blur(widths.x + (widths.y - widths.x) * t, 0.0));
                let found = glow_coefficients(matter, even * structure.x, structure.y, r, nu, g, Shift(g, g));
                let depth = found.absorption * length;
                medium = vec4<f32>(medium.xyz + found.light * (length * own_share(depth) * medium.w),
                    medium.w * exp(-depth));
            }
        }
    }
}
