// SPDX-License-Identifier: MIT OR Apache-2.0
// The matter with depth, along a ray while it is traced. Mirrors src/emit/volumes.rs, where the reasons are, but for
// this: samples come from the dense output of a step, not from steps of their own; pieces are not parted where matter
// bends, but cells are finer; and the last stretch before the horizon, a millionth of its radius, is left out.

#import constants
#import camera/chart
#import emit/clouds
#import emit/course
#import emit/flow
#import emit/free_spot
#import emit/glow
#import emit/layers
#import shared/matter
#import emit/medium
#import emit/moment
#import emit/shape
#import emit/shift
#import geodesic/geodesic
#import geodesic/integrator
#import geodesic/trace
#import shared/frame
#import shared/not_inlined

// Cells of even matter for each that the CPU tracer takes, whose cells end where matter bends: these reach across.
// That is for views of matter, which are measured; pictures differ by 1 of 255 at most if they have as many as that
// tracer's.
const FINENESS: f32 = 1.7;

// The angle about the hole that the ray has swept so far.
var<private> ray_swept: f32;
// Whether MANY_RAYS are traced for its pixel.
var<private> among_many: bool;
// The width of a pixel where the last part ended, M; negative where that is not known.
var<private> known_width: f32;

// A ray begins at `observer`, one of `rays` of a pixel.
fn begin_medium(c: Constants, observer: State, rays: u32) {
    medium = NO_MEDIUM;
    ray_swept = 0.0;
    known_width = -1.0;
    among_many = rays >= MANY_RAYS;
    if ALONE {
        begin_layers(c, observer);
    }
}

// A part of a ray begins, `begin` in tau since the begin of its step, whether or not matter is seen in it.
fn next_part(begin: f32) {
    if ALONE && begin == 0.0 {
        next_step();
    }
}

// Adds the matter along a part of a ray to the medium: the step of the length `h` in tau from `from_state` to
// `to_state`, from `begin` to `end` in tau since its begin. `observer`: the state there; `ratio`: nu(camera) / nu(local
// frame).
fn add_part(
    c: Constants,
    observer: State,
    from_state: State,
    to_state: State,
    h: f32,
    begin: f32,
    end: f32,
    ratio: f32,
) {
    let outer = frame.depth_u.x;
    let before_swept = ray_swept;
    // N turns by sqrt(K) per tau.
    let turned = abs(end - begin) * min(sqrt(max(c.k, 0.0)), c.scale);
    ray_swept += turned;
    if max(from_state.u, to_state.u) * MARGIN_STEP < outer || is_dark() {
        known_width = -1.0;
        return;
    }
    // cos th goes as a sine along a ray: between crossings of the plane it is nowhere less than at the nearer end.
    let heights = vec2<f32>(from_state.n.z, to_state.n.z);
    let least = select(0.0, min(abs(heights.x), abs(heights.y)), heights.x * heights.y > 0.0);
    if ALONE && least > frame.matter[0].most_cosine * (1.0 + MARGIN_U) + MARGIN_COS {
        known_width = -1.0;
        return;
    }
    let course = step_course(c, from_state, to_state, h);
    let first = begin / h;
    let run = (end - begin) / h;
    let swept = abs(end - begin) * c.scale;
    // The pieces' borders, as Pieces of the Rust.
    let u = quintic_at(course.u, first);
    let v = quintic_at(course.u, first + run);
    let edge = outer * (1.0 - MARGIN_U);
    let enters = abs((edge - u) / (v - u));
    let from_share = select(0.0, enters, u < edge && v > edge);
    let to_share = select(1.0, enters, v < edge && u > edge);
    let quotient = max(v, edge) / max(u, edge);
    // Steps are as long as a piece may be, give or take a rounding, which is not to make two of one.
    let wanted = max(abs(log(quotient)) / PIECE_LN_R, swept / PIECE_ANGLE) - PIECE_SLACK;
    // u32 of NaN may be any number.
    let count = clamp(u32(min(ceil(wanted), MOST_PIECES)), 1u, u32(MOST_PIECES));
    var at = from_share;
    var before = vec2<f32>(quintic_at(course.u, first + run * at), quintic_at(course.n_z, first + run * at));
    // The width of a pixel changes evenly along a part.
    let last_width = width_at(c, observer, course, first + run, h, before_swept + turned, ratio);
    if known_width < 0.0 {
        known_width = width_at(c, observer, course, first, h, before_swept, ratio);
    }
    let first_width = known_width;
    known_width = last_width;
    var width = first_width + (last_width - first_width) * at;
    for (var k = 1u; k <= count; k += 1u) {
        let even = f32(k) / f32(count);
        let rise = quotient - 1.0;
        let share = select((pow(quotient, even) - 1.0) / rise, even, abs(rise) < 1e-4);
        let next = from_share + (to_share - from_share) * share;
        let last = vec2<f32>(quintic_at(course.u, first + run * next), quintic_at(course.n_z, first + run * next));
        let next_width = first_width + (last_width - first_width) * next;
        let cut = cut_of(vec2<f32>(before.x, last.x), vec2<f32>(before.y, last.y), swept * (next - at),
            0.5 * (width + next_width));
        if cut.count > 0.0 {
            let ends = first + run * (at + (next - at) * cut.share);
            let widths = width + (next_width - width) * cut.share;
            if ALONE {
                add_alone(c, course, ends, h, cut.count, widths, ratio);
            } else {
                add_piece(c, observer, course, ends, h, cut, widths, ratio);
            }
        }
        at = next;
        before = last;
        width = next_width;
    }
}

// The width of a pixel at the share x of a step, M, where the ray has swept the angle `swept`. 0 without structure.
fn width_at(
    c: Constants,
    observer: State,
    course: StepCourse,
    x: f32,
    h: f32,
    swept: f32,
    ratio: f32,
) -> f32 {
    if !STRUCTURE {
        return 0.0;
    }
    let n = vec3<f32>(quintic_at(course.n_x, x), quintic_at(course.n_y, x), quintic_at(course.n_z, x));
    let u = max(quintic_at(course.u, x), 1e-9);
    // Aberration makes angles as much smaller as frequencies larger.
    let pixel_angle = frame.pixel_angle * ratio;
    return pixel_width(c, observer, u, quintic_slope(course.u, x) * h, n, swept, pixel_angle);
}

// The width of a pixel of an angle in the local frame at the place n / u, M, where the ray has swept the angle `swept`
// and 1/r changes with the sign of `du`.
fn pixel_width(
    c: Constants,
    observer: State,
    u: f32,
    du: f32,
    n: vec3<f32>,
    swept: f32,
    pixel_angle: f32,
) -> f32 {
    let b = sqrt(max(c.k, 0.0)) / max(abs(c.energy), 1e-3);
    let passed = observer.du > 0.0 && du < 0.0;
    let bend = cloud_bend(swept, b, 1.0 / observer.u, 1.0 / u, passed);
    let distance = length(normalize(n) / u - normalize(observer.n) / observer.u);
    return cloud_footprint(pixel_angle, distance, b, 1.0 / observer.u, 1.0 / u, bend);
}

// How a stretch is cut: the share of it that has matter, and the number of cells, 0 without matter, or, if it has
// structure, of even layers. `width` is that of a pixel there.
struct Cut {
    share: vec2<f32>,
    count: f32,
    layers: bool,
}

fn cut_of(u: vec2<f32>, cosines: vec2<f32>, swept: f32, width: f32) -> Cut {
    var share = vec2<f32>(1.0, 0.0);
    var cells = 0.0;
    var places = 0.0;
    // The most that some matter of it sends, of what it might.
    var most = 0.0;
    for (var k = 0u; k < select(not_inlined(frame.matter_count), 1u, ALONE); k += 1u) {
        let matter = frame.matter[k];
        let within = clip(matter, u, cosines);
        if within.x < within.y {
            share = vec2<f32>(min(share.x, within.x), max(share.y, within.y));
            cells = max(cells, cells_of(u, cosines, swept, matter));
            if STRUCTURE && k < MOST_VOLUMES {
                let passed = cloud_passed(k, u, cosines, swept);
                // Matter without structure passes none.
                if passed > 0.0 {
                    let wanted = cloud_samples(k, passed, 2.0 / (u.x + u.y), width);
                    let weight = weight_of(u, cosines, swept, matter);
                    most = max(most, weight);
                    places = max(places, wanted * cloud_worth(medium.w, weight));
                }
            }
        }
    }
    let layers = STRUCTURE && (ALONE || places > 0.0);
    let wants = select(1.0, MANY_SHARE, among_many);
    let wanted = select(select(1.0, FINENESS, SHOWS_DEPTH) * cells, max(wants * places, LAYERS * cells), layers);
    let part = share.y - share.x;
    // One that is alone comes in blocks of layers (emit/layers.wgsl).
    let blocks = BLOCK_LAYERS * clamp(ceil(wanted * part / BLOCK_LAYERS - BLOCK_ROUNDING), 1.0,
        MOST_CELLS / BLOCK_LAYERS);
    let count = select(clamp(ceil(wanted * part), 1.0, MOST_CELLS), blocks, ALONE && STRUCTURE);
    // A stretch that hardly shows is passed over, where the one volume is all that it has.
    let shows = part > 0.0 && (!(ALONE && STRUCTURE) || most * medium.w > LEAST_SEEN);
    return Cut(share, select(0.0, count, shows), layers);
}

// How much of the light it may send that a stretch sends, at most, if it were even.
fn weight_of(u: vec2<f32>, cosines: vec2<f32>, swept: f32, matter: Matter) -> f32 {
    let r = 2.0 / (u.x + u.y);
    let near = density_at(1.0 / u.x, cosines.x, 0.0, 0.0, matter);
    let far = density_at(1.0 / u.y, cosines.y, 0.0, 0.0, matter);
    // All shapes but jets are densest nearest to the plane.
    let nearest = clamp(0.0, min(cosines.x, cosines.y), max(cosines.x, cosines.y));
    let between = select(nearest, 0.5 * (cosines.x + cosines.y), has_shape(matter.shape, SHAPE_JET));
    let most = max(max(near, far), density_at(r, between, 0.0, 0.0, matter));
    if matter.power_law != 0u {
        return min(most, 1.0);
    }
    let run = 1.0 / u.x - 1.0 / u.y;
    let across = swept * r;
    return 1.0 - exp(-CLUMPED * matter.absorption * most * sqrt(run * run + across * across));
}

// The share of a stretch, of which the straight lines between its ends lie within a matter's reach; (1, 0) for none.
fn clip(matter: Matter, u: vec2<f32>, cosines: vec2<f32>) -> vec2<f32> {
    let most = matter.most_cosine * (1.0 + MARGIN_U) + MARGIN_COS;
    let radial = clip_between(u, matter.u_outer * (1.0 - MARGIN_U), matter.u_inner * (1.0 + MARGIN_U));
    let polar = clip_between(cosines, -most, most);
    return vec2<f32>(max(radial.x, polar.x), min(radial.y, polar.y));
}

// The share of the way between two values that lies within limits; (1, 0) for none.
fn clip_between(ends: vec2<f32>, low: f32, high: f32) -> vec2<f32> {
    let change = ends.y - ends.x;
    let a = (low - ends.x) / change;
    let b = (high - ends.x) / change;
    let still = abs(change) < 1e-7 * high;
    let moving = vec2<f32>(max(min(a, b), 0.0), min(max(a, b), 1.0));
    return select(moving, select(vec2<f32>(1.0, 0.0), vec2<f32>(0.0, 1.0), ends.x >= low && ends.x <= high), still);
}

// Adds a piece between two shares of a step, in cells, of which one of too great an optical depth is cut again, or in
// even layers. `widths`: of a pixel at its ends.
fn add_piece(
    c: Constants,
    observer: State,
    course: StepCourse,
    ends: vec2<f32>,
    h: f32,
    piece: Cut,
    widths: vec2<f32>,
    ratio: f32,
) {
    let size = (ends.y - ends.x) / piece.count;
    var cell = 0u;
    var cut = 0u;
    var cuts = 1u;
    // u32 of NaN may be any number.
    let count = clamp(u32(piece.count), 1u, u32(MOST_CELLS));
    let nodes = select(3u, 1u, piece.layers);
    while cell < count && !is_dark() {
        let part = size / f32(cuts);
        let low = ends.x + size * f32(cell) + part * f32(cut);
        var light = array<vec3<f32>, 3>();
        var depths = vec3<f32>(0.0);
        for (var node = 0u; node < nodes; node += 1u) {
            let place = select(GAUSS_NODES[node], 0.5, piece.layers);
            let along = (f32(cell) + (f32(cut) + place) / f32(cuts)) / piece.count;
            let width = widths.x + (widths.y - widths.x) * along;
            let there = coefficients_at(c, observer, course, low + part * place, h, part * h, width, ratio);
            light[node] = there.xyz;
            depths[node] = there.w;
        }
        let depth = select(dot(GAUSS_WEIGHTS, depths), depths.x, piece.layers);
        if cuts == 1u && depth > 1.0 && !piece.layers {
            cuts = u32(min(ceil(depth), MOST_CUTS));
            continue;
        }
        let gains = select(node_gains(depths), vec3<f32>(own_share(depth), 0.0, 0.0), piece.layers) * medium.w;
        let seen = light[0] * gains.x + light[1] * gains.y + light[2] * gains.z;
        medium.x += seen.x;
        if SHOWS_DEPTH {
            medium.y += depth;
        } else {
            medium.y += seen.y;
            medium.z += seen.z;
        }
        medium.w *= exp(-depth);
        cut += 1u;
        if cut >= cuts {
            cut = 0u;
            cuts = 1u;
            cell += 1u;
        }
    }
}

// All matter at the share x of a step of the length `h`, as if the length `tau` of it were as it is there: light, and
// in w the optical depth. In views of matter x of the light is I_nu. `width`: of a pixel there, M.
fn coefficients_at(
    c: Constants,
    observer: State,
    course: StepCourse,
    x: f32,
    h: f32,
    tau: f32,
    width: f32,
    ratio: f32,
) -> vec4<f32> {
    let u = quintic_at(course.u, x);
    let cosine = clamp(quintic_at(course.n_z, x), -1.0, 1.0);
    var sum = vec4<f32>(0.0);
    // None is past infinity (u <= 0), where the last step of a ray may end, nor within the horizon.
    if u > 0.0 && u * c.r_plus < 1.0 - HORIZON_ROOM {
        let r = 1.0 / u;
        let du = quintic_slope(course.u, x) / h;
        var azimuth = 0.0;
        var later = moment;
        // Azimuth and time in Doran's chart.
        var rain = vec2<f32>(0.0);
        if STRUCTURE || (SHAPES & ((1u << SHAPE_SPOT) | (1u << SHAPE_FREE_SPOT))) != 0u {
            let offsets = chart_offsets(c, u);
            let n = vec2<f32>(quintic_at(course.n_x, x), quintic_at(course.n_y, x));
            azimuth = arctan2(n.y, n.x) + cubic_at(course.drag, x) - offsets.x;
            if DELAY {
                let integral = cubic_at(course.delay, x) - observer.delay + offsets.y;
                later += frame.matter_delay - retardation(c, observer.u, observer.du, u, du, integral);
            }
            if (SHAPES & (1u << SHAPE_FREE_SPOT)) != 0u {
                rain = vec2<f32>(azimuth, later) + rain_offsets(c, u);
            }
        }
        for (var k = 0u; k < not_inlined(frame.matter_count); k += 1u) {
            let matter = frame.matter[k];
            let is_free = has_shape(matter.shape, SHAPE_FREE_SPOT);
            var centre = SpotCentre();
            var even = 0.0;
            if is_free {
                // All of it is where it is at the sample's time if light does not take any.
                centre = spot_centre(select(moment * matter.angular_velocity, rain.y, DELAY), matter);
                even = free_density(r, cosine, rain.x, centre, matter);
            } else {
                even = density_at(r, cosine, azimuth, later, matter);
            }
            if !(even >= matter.least_density) {
                continue;
            }
            let at = place_at(c, u, cosine);
            var turn = 0.0;
            if (SHAPES & (1u << SHAPE_FREE_SPOT)) != 0u {
                turn = quintic_slope(course.n_z, x) / h;
            }
            let light = zamo_light(c, at, du, turn);
            let velocity = flow_velocity(c, at, matter);
            var motion = vec3<f32>(velocity, 0.0);
            if is_free {
                motion = zamo_velocity(at, rain_velocity(c.a, centre.position, centre.rate));
            }
            let nu = measured_by(light, motion) / c.nu_local;
            var structure = vec2<f32>(1.0);
            if STRUCTURE && k < MOST_VOLUMES {
                let there = CloudPlace(r, cosine, azimuth, later);
                let carried = vec2<f32>(angular_velocity(c.a, at, velocity), drift_rate(at, velocity));
                structure = cloud_pattern(k, there, carried, width);
            }
            // No motion has such a frequency where this fails; NaN fails it as well.
            if nu > 0.0 && nu < 1e30 {
                let g = ratio / nu;
                var shift = Shift(g, g);
                if !ALL_EFFECTS {
                    let seen = nu_static_observer(c.energy / c.nu_local, c.angular_momentum / c.nu_local);
                    shift = visible_shift(g, seen * c.nu_local / light.frequency);
                }
                let found = glow_coefficients(matter, even * structure.x, structure.y, r, nu, g, shift);
                if SHOWS_DEPTH {
                    sum += vec4<f32>(found.intensity, 0.0, 0.0, found.absorption);
                } else {
                    sum += vec4<f32>(found.light, found.absorption);
                }
            }
        }
        // d lambda / d tau = Sigma (`Part::length`).
        let a_cosine = c.a * cosine;
        sum *= tau * c.nu_local * (r * r + a_cosine * a_cosine);
    }
    return sum;
}
