// SPDX-License-Identifier: MIT OR Apache-2.0
// A piece of a ray in one volume: in even layers if it has structure, else in cells. Mirrors `Sum::alone` of
// src/emit/volumes.rs. What changes slowly (place, motion, redshift factor g) is found at three places of the piece,
// between which parabolas tell it; each place of the sum has its density, its structure and its luminance for itself,
// and each block of places its colour.

#import constants
#import camera/chart
#import emit/clouds
#import emit/course
#import emit/flow
#import emit/glow
#import emit/medium
#import emit/moment
#import emit/shape
#import geodesic/geodesic
#import shared/blackbody
#import shared/frame
#import shared/matter

// Whether the view shows I_nu and optical depth, not light.
override SHOWS_DEPTH: bool = false;
// Whether some matter has structure.
override STRUCTURE: bool = false;
// Whether one volume is all the matter that there is, in a picture with all effects.
override ALONE: bool = false;
// Whether so much matter is in front that what is behind does not matter.
fn is_dark() -> bool {
    if SHOWS_DEPTH {
        return medium.y > DARK;
    }
    return medium.w < exp(-DARK_PICTURE);
}

// All that changes slowly. `place`: share of the grid's rows, cos th, turns, and ln of the temperature seen, T g, or of
// g of a power law. `matter`: r; the column of the matter in the plane, or of a torus or halo at its densest, per tau,
// but for a disk's edges; and what of the logarithm of the density falls off as the square of a length, but for a
// disk's height.
struct Slow {
    place: vec4<f32>,
    matter: vec3<f32>,
}

// M after the reference time at which light with no delay is seen: that of a ray's begin.
var<private> seen_later: f32;
// The end of the piece that was summed last, as a share of the step at hand, before which it may lie; what is there.
var<private> last_end: f32;
var<private> last_slow: Slow;

// A ray begins at `observer`.
fn begin_layers(c: Constants, observer: State) {
    last_end = -1e9;
    seen_later = moment;
    if DELAY {
        seen_later += frame.matter_delay + observer.delay + delay_boundary(c, observer.u, observer.du);
    }
}

// The ray goes on to its next step.
fn next_step() {
    last_end -= 1.0;
}

fn is_power_law(matter: Matter) -> bool {
    return POWER_LAW && (!THERMAL || matter.power_law != 0u);
}

fn slow_at(c: Constants, course: StepCourse, x: f32, h: f32, ratio: f32) -> Slow {
    let matter = frame.matter[0];
    let exact = quintic_at(course.u, x);
    // None is past infinity, nor within the horizon.
    let u = clamp(exact, 1e-9, (1.0 - HORIZON_ROOM) / c.r_plus);
    let cosine = clamp(quintic_at(course.n_z, x), -1.0, 1.0);
    let du = quintic_slope(course.u, x) / h;
    let at = place_at(c, u, cosine);
    let velocity = flow_velocity(c, at, matter);
    let nu = measured_by(zamo_light(c, at, du, 0.0), vec3<f32>(velocity, 0.0)) / c.nu_local;
    // No motion has such a frequency where this fails; NaN fails it as well.
    let moves = nu > 0.0 && nu < 1e30 && u == exact;
    let g = select(1.0, ratio / nu, moves);
    let r = 1.0 / u;
    let ln_r = log(r);
    var row = 0.0;
    var turns = 0.0;
    if STRUCTURE {
        let offsets = chart_offsets(c, u);
        let azimuth = arctan2(quintic_at(course.n_y, x), quintic_at(course.n_x, x)) + cubic_at(course.drag, x)
            - offsets.x;
        var later = seen_later;
        if DELAY {
            // The retardation, whose part at the observer is that of all places.
            later = seen_later - delay_boundary(c, u, du) - cubic_at(course.delay, x) - clock_offset(c, u)
                - offsets.y;
        }
        let carried = vec2<f32>(angular_velocity(c.a, at, velocity), drift_rate(at, velocity));
        let there = cloud_place(0u, CloudPlace(r, cosine, azimuth, later), carried);
        turns = there.x;
        row = there.y;
    }
    // d lambda / d tau = Sigma.
    var column = select(0.0, nu, moves) * (r * r + c.a * c.a * cosine * cosine);
    var falls = 0.0;
    if has_shape(matter.shape, SHAPE_DISK) {
        column *= exp(-matter.slope * (ln_r - log(matter.inner)));
    } else {
        let disk_like = has_shape(matter.shape, SHAPE_HALO);
        let sine = sqrt(max((1.0 - cosine) * (1.0 + cosine), 0.0));
        let out = select((r * sine - matter.radius) / matter.width, r / matter.radius, disk_like);
        let up = select(r / matter.radius, 1.0, disk_like) * cosine / matter.thickness;
        falls = 0.5 * (out * out + up * up);
    }
    let heat = log(matter.temperature) - matter.temperature_slope * (ln_r - log(matter.reference_radius));
    let ln_seen = log(g) + select(heat, 0.0, is_power_law(matter));
    return Slow(vec4<f32>(row, cosine, turns, ln_seen), vec3<f32>(r, column, falls));
}

// All that changes slowly along a piece, as parabolas: at its begin, and the factors of the share of it and of its
// square.
struct SlowCourse {
    begin: Slow,
    rise: Slow,
    bend: Slow,
}

// The parabolas through what is at the begin, in the middle and at the end.
fn slow_course(slow: array<Slow, 3>) -> SlowCourse {
    let begin = slow[0];
    var to_middle = slow[1].place - begin.place;
    var to_end = slow[2].place - begin.place;
    // Turns have no seam between them.
    to_middle.z -= round(to_middle.z);
    to_end.z -= round(to_end.z - 2.0 * to_middle.z);
    let m = slow[1].matter - begin.matter;
    let e = slow[2].matter - begin.matter;
    return SlowCourse(
        begin,
        Slow(4.0 * to_middle - to_end, 4.0 * m - e),
        Slow(2.0 * to_end - 4.0 * to_middle, 2.0 * e - 4.0 * m),
    );
}

// Four places side by side: optical depths, luminances that leave them were they opaque or, of a power law, that they
// send, and ln of the temperatures seen.
struct Places {
    depths: vec4<f32>,
    luminances: vec4<f32>,
    ln_seen: vec4<f32>,
}

// The places at four shares of a piece, each as if the length `tau` were as it is there. `blur`: of the structure.
fn places_at(matter: Matter, slow: SlowCourse, t: vec4<f32>, tau: f32, blur: f32) -> Places {
    let r = slow.begin.matter.x + t * (slow.rise.matter.x + t * slow.bend.matter.x);
    let cosine = slow.begin.place.y + t * (slow.rise.place.y + t * slow.bend.place.y);
    var ln_seen = slow.begin.place.w + t * (slow.rise.place.w + t * slow.bend.place.w);
    var column = slow.begin.matter.y + t * (slow.rise.matter.y + t * slow.bend.matter.y);
    var falls = slow.begin.matter.z + t * (slow.rise.matter.z + t * slow.bend.matter.z);
    if has_shape(matter.shape, SHAPE_DISK) {
        let heights = cosine / matter.thickness;
        falls = 0.5 * heights * heights;
        // No parabola tells of soft edges, of which a piece may hold the greater part.
        let begun = clamp((r / matter.inner - INNER_FADE.x) / (INNER_FADE.y - INNER_FADE.x), vec4<f32>(0.0),
            vec4<f32>(1.0));
        let ended = clamp((r / matter.outer - OUTER_FADE.x) / (OUTER_FADE.y - OUTER_FADE.x), vec4<f32>(0.0),
            vec4<f32>(1.0));
        column *= begun * begun * (3.0 - 2.0 * begun) * (1.0 - ended * ended * (3.0 - 2.0 * ended));
    }
    column = select(column, vec4<f32>(0.0), r > vec4<f32>(matter.outer));
    column = max(column, vec4<f32>(0.0)) * tau * exp(-falls);
    if STRUCTURE {
        let rows = slow.begin.place.x + t * (slow.rise.place.x + t * slow.bend.place.x);
        let turns = slow.begin.place.z + t * (slow.rise.place.z + t * slow.bend.place.z);
        let layers = cosine * (clouds.volumes[0].per_thickness / FILAMENT_HEIGHT);
        let factors = vec4<f32>(
            cloud_factor(0u, vec3<f32>(turns.x, rows.x, layers.x), blur),
            cloud_factor(0u, vec3<f32>(turns.y, rows.y, layers.y), blur),
            cloud_factor(0u, vec3<f32>(turns.z, rows.z, layers.z), blur),
            cloud_factor(0u, vec3<f32>(turns.w, rows.w, layers.w), blur),
        );
        column *= factors;
        if !is_power_law(matter) {
            ln_seen += clouds.volumes[0].heat_power * log(max(factors, vec4<f32>(LEAST_FACTOR)))
                + clouds.volumes[0].heat_log;
        }
    }
    if is_power_law(matter) {
        let depths = matter.absorption * column * exp((ABSORPTION_INDEX + matter.spectral_index) * ln_seen);
        let sent = matter.brightness * column * exp((3.0 + matter.spectral_index) * ln_seen);
        return Places(min(depths, vec4<f32>(LARGEST_COEFFICIENT)), min(sent, vec4<f32>(LARGEST_COEFFICIENT)), ln_seen);
    }
    let depths = min(matter.absorption * column, vec4<f32>(LARGEST_COEFFICIENT));
    return Places(depths, matter.brightness * blackbody_luminances(ln_seen, matter.log_reference), ln_seen);
}

// The colour of places of which each sends so much.
fn colour_of(matter: Matter, ln_seen: vec4<f32>, sent: vec4<f32>, total: f32) -> vec3<f32> {
    if is_power_law(matter) {
        return matter.tint;
    }
    return blackbody_colour(dot(sent, ln_seen) / max(total, 1e-30));
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
        && max(cosines.x * cosines.x, cosines.y * cosines.y) < 1.0 - ROUND_AXIS;
    // A block is a cell, or four layers. u32 of NaN may be any number.
    let blocks = clamp(u32(round(select(count, count / BLOCK_LAYERS, STRUCTURE))), 1u, u32(MOST_CELLS));
    // Where they are not smooth each block has what changes slowly for itself, at places within it: the last block
    // before the horizon has none at its end.
    let spans = select(blocks, 1u, is_smooth);
    let margin = select(select(GAUSS_NODES.x, 0.125, STRUCTURE), 0.0, is_smooth);
    let tau = (ends.y - ends.x) / f32(blocks) * h * c.nu_local;
    var blurs = vec2<f32>(1.0);
    if STRUCTURE {
        blurs.x = cloud_blur(0u, 1.0 / u.x, cosines.x, widths.x);
        blurs.y = cloud_blur(0u, 1.0 / u.y, cosines.y, widths.y);
    }
    for (var span = 0u; span < spans && !is_dark(); span += 1u) {
        // The begin is as the end of the piece before was, which lies within it where that was not smooth.
        var slow = array<Slow, 3>(Slow(), Slow(), last_slow);
        let reuses = is_smooth && abs(ends.x - last_end) < 1e-4;
        for (var i = select(0u, 1u, reuses); i < 3u; i += 1u) {
            let share = (f32(span) + margin + (1.0 - 2.0 * margin) * (0.5 * f32(i))) / f32(spans);
            slow[0] = slow[1];
            slow[1] = slow[2];
            slow[2] = slow_at(c, course, ends.x + (ends.y - ends.x) * share, h, ratio);
        }
        last_slow = slow[2];
        last_end = select(-1e9, ends.y, is_smooth);
        let along = slow_course(slow);
        let parts = select(1u, blocks, is_smooth);
        if STRUCTURE {
            for (var block = 0u; block < parts && !is_dark(); block += 1u) {
                let share = (f32(block) + vec4<f32>(0.125, 0.375, 0.625, 0.875)) / f32(parts);
                let t = (share - margin) / (1.0 - 2.0 * margin);
                let middle = (f32(span) * f32(parts) + f32(block) + 0.5) / f32(blocks);
                add_block(matter, places_at(matter, along, t, 0.25 * tau, blurs.x + (blurs.y - blurs.x) * middle));
            }
        } else {
            add_cells(matter, along, parts, margin, tau);
        }
    }
}

// Adds four even layers.
fn add_block(matter: Matter, places: Places) {
    let left = exp(-places.depths);
    var shares = 1.0 - left;
    if is_power_law(matter) {
        shares = vec4<f32>(own_share(places.depths.x), own_share(places.depths.y), own_share(places.depths.z),
            own_share(places.depths.w));
    }
    let second = left.x;
    let third = second * left.y;
    let fourth = third * left.z;
    let sent = shares * vec4<f32>(1.0, second, third, fourth) * places.luminances;
    let total = sent.x + sent.y + sent.z + sent.w;
    let colour = colour_of(matter, places.ln_seen, sent, total);
    medium = vec4<f32>(medium.xyz + colour * (total * medium.w), medium.w * fourth * left.w);
}

// Adds `count` cells of even matter, of which one of too great an optical depth is cut again.
fn add_cells(matter: Matter, along: SlowCourse, count: u32, margin: f32, tau: f32) {
    var cell = 0u;
    var cut = 0u;
    var cuts = 1u;
    while cell < count && !is_dark() {
        let share = (f32(cell) + (f32(cut) + GAUSS_NODES) / f32(cuts)) / f32(count);
        let t = (share - margin) / (1.0 - 2.0 * margin);
        let places = places_at(matter, along, t.xyzz, tau / f32(cuts), 1.0);
        let depths = places.depths.xyz;
        let depth = dot(GAUSS_WEIGHTS, depths);
        if cuts == 1u && depth > 1.0 {
            cuts = u32(min(ceil(depth), MOST_CUTS));
            continue;
        }
        // A blackbody's source is in units of its own opacity.
        let coefficients = select(depths, vec3<f32>(1.0), is_power_law(matter)) * places.luminances.xyz;
        let sent = vec4<f32>(coefficients * node_gains(depths), 0.0);
        let total = sent.x + sent.y + sent.z;
        let colour = colour_of(matter, places.ln_seen, sent, total);
        medium = vec4<f32>(medium.xyz + colour * (total * medium.w), medium.w * exp(-depth));
        cut += 1u;
        if cut >= cuts {
            cut = 0u;
            cuts = 1u;
            cell += 1u;
        }
    }
}
