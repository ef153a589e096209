// SPDX-License-Identifier: MIT OR Apache-2.0
// A piece of a ray in one volume: in even layers if it has structure, else in cells. Mirrors `Sum::layers` and
// `Sum::piece` of src/emit/volumes.rs, but for this: what changes slowly (place, delay, angular velocity, redshift
// factor g, blur) is found at three places of the piece, between which parabolas tell it; each place of the sum has its
// density, its filaments and its light for itself.

#import constants
#import emit/clouds
#import emit/course
#import emit/flow
#import emit/generations
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
// Whether one volume is all the matter that there is, in a picture with all effects.
override ALONE: bool = false;
// Nearer to the axis (sin^2 theta) and to the horizon (1 - r+ / r) parabolas do not tell azimuth and g.
const ROUND_AXIS: f32 = 0.1;
const ROUND_HORIZON: f32 = 0.1;
// Nor do they tell levels of blur, which go as ln of a pixel's width, where that grows by more than this factor along a
// piece: next to an observer within the matter, where it grows from 0.
const MOST_WIDENING: f32 = 4.0;

// Whether so much matter is in front that what is behind does not matter.
fn is_dark() -> bool {
    if SHOWS_DEPTH {
        return medium.y > DARK;
    }
    return medium.w < exp(-DARK_PICTURE);
}

// All that changes slowly: ln r, cos th, azimuth, M after the reference time; the angular velocity times r^(3/2), g.
struct Slow {
    place: vec4<f32>,
    motion: vec2<f32>,
}

// M after the reference time at which light with no delay is seen: that of a ray's begin.
var<private> seen_later: f32;
// The end of the piece that was summed last, as a share of the step at hand, before which it may lie; what is there.
var<private> last_end: f32;
var<private> last_slow: Slow;

// A ray begins at `observer`.
fn begin_layers(c: Constants, observer: State) {
    last_end = -1e9;
    if DELAY {
        seen_later = frame.matter_delay + observer.delay + delay_boundary(c, observer.u, observer.du);
    }
}

// The ray goes on to its next step.
fn next_step() {
    last_end -= 1.0;
}

fn slow_at(c: Constants, course: StepCourse, x: f32, h: f32, ratio: f32) -> Slow {
    let exact = quintic_at(course.u, x);
    // None is past infinity, nor within the horizon.
    let u = clamp(exact, 1e-9, (1.0 - HORIZON_ROOM) / c.r_plus);
    let cosine = clamp(quintic_at(course.n_z, x), -1.0, 1.0);
    let du = quintic_slope(course.u, x) / h;
    let azimuth = arctan2(quintic_at(course.n_y, x), quintic_at(course.n_x, x)) + cubic_at(course.drag, x);
    var later = 0.0;
    if DELAY {
        // The retardation, whose part at the observer is that of all places.
        later = seen_later - delay_boundary(c, u, du) - cubic_at(course.delay, x) - clock_offset(c, u);
    }
    let at = place_at(c, u, cosine);
    let velocity = flow_velocity(c, at, frame.matter[0]);
    let nu = measured_by(zamo_light(c, at, du), velocity) / c.nu_local;
    // No motion has such a frequency where this fails; NaN fails it as well.
    let g = select(0.0, ratio / nu, nu > 0.0 && nu < 1e30 && u == exact);
    let r = 1.0 / u;
    return Slow(vec4<f32>(log(r), cosine, azimuth, later),
        vec2<f32>(angular_velocity(c.a, at, velocity) * r * sqrt(r), g));
}

// All that changes slowly along a piece, as parabolas: at its begin, and the factors of the share of it and of its
// square; and the blur.
struct SlowCourse {
    begin: Slow,
    rise: Slow,
    bend: Slow,
    levels: mat3x4<f32>,
    lost: mat3x2<f32>,
    // The generations that show, as bits.
    shown: u32,
}

// The parabolas through what is at the begin, in the middle and at the end.
fn slow_course(slow: array<Slow, 3>, blurs: array<PieceBlur, 3>) -> SlowCourse {
    // The azimuth has no seam between them.
    let turns = vec4<f32>(0.0, 0.0, TAU, 0.0);
    let begin = slow[0];
    let to_middle = slow[1].place - begin.place;
    let to_end = slow[2].place - begin.place;
    let m = Slow(to_middle - turns * round(to_middle.z / TAU), slow[1].motion - begin.motion);
    let e = Slow(to_end - turns * round(to_end.z / TAU), slow[2].motion - begin.motion);
    let k = blurs[1].levels - blurs[0].levels;
    let l = blurs[2].levels - blurs[0].levels;
    let p = blurs[1].lost - blurs[0].lost;
    let q = blurs[2].lost - blurs[0].lost;
    return SlowCourse(
        begin,
        Slow(4.0 * m.place - e.place, 4.0 * m.motion - e.motion),
        Slow(2.0 * e.place - 4.0 * m.place, 2.0 * e.motion - 4.0 * m.motion),
        mat3x4<f32>(blurs[0].levels, 4.0 * k - l, 2.0 * l - 4.0 * k),
        mat3x2<f32>(blurs[0].lost, 4.0 * p - q, 2.0 * q - 4.0 * p),
        blurs[0].shown | blurs[1].shown | blurs[2].shown,
    );
}

// The light and the optical depth, in w, of the length `tau` of a ray at each of four shares of a piece: side by side,
// so that GPUs wait for all four texels at once.
fn lights_of(
    c: Constants,
    matter: Matter,
    slow: SlowCourse,
    piece: PieceClouds,
    t: vec4<f32>,
    tau: f32,
    ratio: f32,
) -> mat4x4<f32> {
    let ln_r = slow.begin.place.x + t * (slow.rise.place.x + t * slow.bend.place.x);
    let cosine = slow.begin.place.y + t * (slow.rise.place.y + t * slow.bend.place.y);
    let azimuth = slow.begin.place.z + t * (slow.rise.place.z + t * slow.bend.place.z);
    let later = slow.begin.place.w + t * (slow.rise.place.w + t * slow.bend.place.w);
    let g = slow.begin.motion.y + t * (slow.rise.motion.y + t * slow.bend.motion.y);
    let r = exp(ln_r);
    let even = vec4<f32>(
        density_at(r.x, cosine.x, azimuth.x, later.x, matter),
        density_at(r.y, cosine.y, azimuth.y, later.y, matter),
        density_at(r.z, cosine.z, azimuth.z, later.z, matter),
        density_at(r.w, cosine.w, azimuth.w, later.w, matter),
    );
    let sends = (even >= vec4<f32>(matter.least_density)) & (g > vec4<f32>(0.0));
    if !any(sends) {
        return mat4x4<f32>();
    }
    var thicker = vec4<f32>(1.0);
    var hotter = vec4<f32>(1.0);
    if STRUCTURE {
        let period = clouds.volumes[0].period;
        let motion = slow.begin.motion.x + t * (slow.rise.motion.x + t * slow.bend.motion.x);
        let places = FourPlaces(ln_r, cosine, azimuth, later, motion / (r * sqrt(r)));
        let layers = vec4<f32>(cloud_height(0u, r.x, cosine.x).x, cloud_height(0u, r.y, cosine.y).x,
            cloud_height(0u, r.z, cosine.z).x, cloud_height(0u, r.w, cosine.w).x) / FILAMENT_HEIGHT;
        let sum = clouds.volumes[0].strength * piece_filaments(piece, slow.shown, places, ln_r / period, layers,
            1.0 / period, slow.levels, t);
        let lost_density = slow.lost[0].x + t * (slow.lost[1].x + t * slow.lost[2].x);
        let lost_heat = slow.lost[0].y + t * (slow.lost[1].y + t * slow.lost[2].y);
        thicker = exp(clouds.volumes[0].clumping * sum - lost_density);
        hotter = exp(clouds.volumes[0].heating * (sum - lost_heat));
    }
    let seen = select(vec4<f32>(1.0), g, sends);
    let density = select(vec4<f32>(0.0), even * thicker, sends);
    // d lambda / d tau = Sigma.
    let lengths = tau * (r * r + c.a * c.a * cosine * cosine);
    return mat4x4<f32>(
        light_at(matter, density.x, hotter.x, r.x, seen.x, ratio) * lengths.x,
        light_at(matter, density.y, hotter.y, r.y, seen.y, ratio) * lengths.y,
        light_at(matter, density.z, hotter.z, r.z, seen.z, ratio) * lengths.z,
        light_at(matter, density.w, hotter.w, r.w, seen.w, ratio) * lengths.w,
    );
}

fn light_at(matter: Matter, density: f32, heat: f32, r: f32, g: f32, ratio: f32) -> vec4<f32> {
    let found = glow_coefficients(matter, density, heat, r, ratio / g, g, Shift(g, g));
    return vec4<f32>(found.light, found.absorption);
}

// Adds a piece between two shares of a step in `count` cells, or so many layers in blocks. `widths`: of a pixel at its
// ends.
fn add_alone(
    c: Constants,
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
        && max(cosines.x * cosines.x, cosines.y * cosines.y) < 1.0 - ROUND_AXIS
        && max(widths.x, widths.y) <= MOST_WIDENING * min(widths.x, widths.y);
    // A block is a cell, or four layers. u32 of NaN may be any number.
    let blocks = clamp(u32(round(select(count, count / BLOCK_LAYERS, STRUCTURE))), 1u, u32(MOST_CELLS));
    // Where they are not smooth each block has what changes slowly for itself, at places within it: the last block
    // before the horizon has none at its end.
    let spans = select(blocks, 1u, is_smooth);
    let margin = select(select(GAUSS_NODES.x, 0.125, STRUCTURE), 0.0, is_smooth);
    let tau = (ends.y - ends.x) / f32(blocks) * h * c.nu_local;
    for (var span = 0u; span < spans && !is_dark(); span += 1u) {
        // The begin is as the end of the piece before was, which lies within it where that was not smooth.
        var slow = array<Slow, 3>(Slow(), Slow(), last_slow);
        var piece: PieceClouds;
        var blurs = array<PieceBlur, 3>();
        let reuses = is_smooth && abs(ends.x - last_end) < 1e-4;
        for (var i = select(0u, 1u, reuses); i < 3u; i += 1u) {
            let share = (f32(span) + margin + (1.0 - 2.0 * margin) * (0.5 * f32(i))) / f32(spans);
            slow[0] = slow[1];
            slow[1] = slow[2];
            slow[2] = slow_at(c, course, ends.x + (ends.y - ends.x) * share, h, ratio);
        }
        if STRUCTURE {
            piece = piece_clouds(0u, slow[1].place.x, slow[0].place.w);
            for (var i = 0u; i < 3u; i += 1u) {
                // Arrays that are indexed by variables cost GPUs a tenth of the frame's time.
                var there = slow[0];
                if i == 1u {
                    there = slow[1];
                }
                if i == 2u {
                    there = slow[2];
                }
                let at = there.place;
                let share = (f32(span) + margin + (1.0 - 2.0 * margin) * (0.5 * f32(i))) / f32(spans);
                blurs[0] = blurs[1];
                blurs[1] = blurs[2];
                blurs[2] = piece_blur(0u, piece, at.x, at.y, at.w, there.motion.x * exp(-1.5 * at.x),
                    widths.x + (widths.y - widths.x) * share);
            }
        }
        last_slow = slow[2];
        last_end = select(-1e9, ends.y, is_smooth);
        let along = slow_course(slow, blurs);
        let parts = select(1u, blocks, is_smooth);
        if STRUCTURE {
            for (var layer = 0u; layer < parts && !is_dark(); layer += 1u) {
                let share = (f32(layer) + vec4<f32>(0.125, 0.375, 0.625, 0.875)) / f32(parts);
                let t = (share - margin) / (1.0 - 2.0 * margin);
                let found = lights_of(c, matter, along, piece, t, 0.25 * tau, ratio);
                for (var i = 0u; i < 4u; i += 1u) {
                    let there = found[i];
                    medium = vec4<f32>(medium.xyz + there.xyz * (own_share(there.w) * medium.w),
                        medium.w * exp(-there.w));
                }
            }
        } else {
            add_cells(c, matter, along, piece, parts, margin, tau, ratio);
        }
    }
}

// Adds `count` cells of even matter, of which one of too great an optical depth is cut again.
fn add_cells(
    c: Constants,
    matter: Matter,
    along: SlowCourse,
    piece: PieceClouds,
    count: u32,
    margin: f32,
    tau: f32,
    ratio: f32,
) {
    var cell = 0u;
    var cut = 0u;
    var cuts = 1u;
    while cell < count && !is_dark() {
        let share = (f32(cell) + (f32(cut) + GAUSS_NODES) / f32(cuts)) / f32(count);
        let t = (share - margin) / (1.0 - 2.0 * margin);
        let light = lights_of(c, matter, along, piece, t.xyzz, tau / f32(cuts), ratio);
        let depths = vec3<f32>(light[0].w, light[1].w, light[2].w);
        let depth = dot(GAUSS_WEIGHTS, depths);
        if cuts == 1u && depth > 1.0 {
            cuts = u32(min(ceil(depth), MOST_CUTS));
            continue;
        }
        let gains = node_gains(depths) * medium.w;
        let sent = light[0].xyz * gains.x + light[1].xyz * gains.y + light[2].xyz * gains.z;
        medium = vec4<f32>(medium.xyz + sent, medium.w * exp(-depth));
        cut += 1u;
        if cut >= cuts {
            cut = 0u;
            cuts = 1u;
            cell += 1u;
        }
    }
}
