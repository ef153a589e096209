// SPDX-License-Identifier: MIT OR Apache-2.0
// The matter with depth, along a ray while it is traced. Mirrors src/emit/volumes.rs, where the reasons are, but for
// this: samples come from the dense output of a step, not from steps of their own; pieces are not parted where matter
// bends, but cells are finer; and the last stretch before the horizon, a millionth of its radius, is left out.

#import constants
#import emit/clouds
#import emit/flow
#import emit/glow
#import shared/matter
#import emit/medium
#import emit/shape
#import emit/shift
#import geodesic/geodesic
#import geodesic/integrator
#import geodesic/trace
#import shared/frame
#import shared/not_inlined

// Whether the view shows I_nu and optical depth, not light.
override SHOWS_DEPTH: bool = false;
// Whether some matter has structure.
override STRUCTURE: bool = false;
// Cells of even matter for each that the CPU tracer takes, whose cells end where matter bends: these reach across.
const FINENESS: f32 = 1.7;
// Less light from behind than this share is not looked for.
const DARKEST: f32 = 1e-6;

// The medium since the last crossing that was kept.
var<private> medium: vec4<f32>;
// The angle about the hole that the ray has swept so far.
var<private> ray_swept: f32;
// Texels of each volume's structure along the stretch at hand.
var<private> texels_passed: array<f32, MOST_VOLUMES>;

// A ray begins.
fn begin_medium() {
    medium = NO_MEDIUM;
    ray_swept = 0.0;
}

// Dense output over a step: 1/r, N, and the values and slopes (times the step) of drag and delay at its ends.
struct StepCourse {
    u: Quintic,
    n_x: Quintic,
    n_y: Quintic,
    n_z: Quintic,
    drag: vec4<f32>,
    delay: vec4<f32>,
}

fn step_course(c: Constants, a: State, b: State, h: f32) -> StepCourse {
    let hh = h * h;
    let f = n_acceleration(c, a.n) * hh;
    let g = n_acceleration(c, b.n) * hh;
    return StepCourse(
        quintic_of_u(c, a, b, h),
        quintic(a.n.x, a.dn.x * h, f.x, b.n.x, b.dn.x * h, g.x),
        quintic(a.n.y, a.dn.y * h, f.y, b.n.y, b.dn.y * h, g.y),
        quintic(a.n.z, a.dn.z * h, f.z, b.n.z, b.dn.z * h, g.z),
        vec4<f32>(a.drag, drag_rate(c, a.u) * h, b.drag, drag_rate(c, b.u) * h),
        vec4<f32>(a.delay, delay_rate(c, a.u, a.n.z) * h, b.delay, delay_rate(c, b.u, b.n.z) * h),
    );
}

fn quintic_at(q: Quintic, x: f32) -> f32 {
    return q.low.x + x * (q.low.y + x * (q.low.z + x * (q.high.x + x * (q.high.y + x * q.high.z))));
}

fn quintic_slope(q: Quintic, x: f32) -> f32 {
    return q.low.y + x * (2.0 * q.low.z + x * (3.0 * q.high.x + x * (4.0 * q.high.y + x * 5.0 * q.high.z)));
}

// Cubic Hermite interpolation: value and slope at 0, value and slope at 1. It keeps slopes even from step to step,
// without which rings would show (a clock that is linear within steps makes them).
fn cubic_at(ends: vec4<f32>, x: f32) -> f32 {
    let rise = ends.z - ends.x;
    return ends.x + x * (ends.y + x * (3.0 * rise - 2.0 * ends.y - ends.w + x * (ends.y + ends.w - 2.0 * rise)));
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
    let wanted = max(abs(log(quotient)) / PIECE_LN_R, swept / PIECE_ANGLE);
    // u32 of NaN may be any number.
    let count = clamp(u32(min(ceil(wanted), MOST_PIECES)), 1u, u32(MOST_PIECES));
    var at = from_share;
    var before = vec2<f32>(quintic_at(course.u, first + run * at), quintic_at(course.n_z, first + run * at));
    var width = width_at(c, observer, course, first + run * at, h, before_swept + turned * at, ratio);
    for (var k = 1u; k <= count; k += 1u) {
        let even = f32(k) / f32(count);
        let rise = quotient - 1.0;
        let share = select((pow(quotient, even) - 1.0) / rise, even, abs(rise) < 1e-4);
        let next = from_share + (to_share - from_share) * share;
        let last = vec2<f32>(quintic_at(course.u, first + run * next), quintic_at(course.n_z, first + run * next));
        let next_width = width_at(c, observer, course, first + run * next, h, before_swept + turned * next, ratio);
        let cut = cells_between(vec2<f32>(before.x, last.x), vec2<f32>(before.y, last.y), swept * (next - at),
            0.5 * (width + next_width));
        if cut.z > 0.0 {
            let low = at + (next - at) * cut.x;
            let high = at + (next - at) * cut.y;
            let grain = Grain(width + (next_width - width) * cut.x, width + (next_width - width) * cut.y,
                (cut.y - cut.x) / (3.0 * cut.z));
            add_piece(c, observer, course, first + run * low, first + run * high, h, cut.z, grain, ratio);
        }
        at = next;
        before = last;
        width = next_width;
    }
}

// How fine the structure of a piece's matter may be: how wide a pixel is at its ends, M, and the share of
// `texels_passed` from place to place.
struct Grain {
    from_width: f32,
    to_width: f32,
    spacing: f32,
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
    let pixel_angle = frame.right.w * ratio;
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

// The share of a stretch that has matter, and the number of cells that it should be cut into: 0 without matter. `width`
// is that of a pixel there.
fn cells_between(u: vec2<f32>, cosines: vec2<f32>, swept: f32, width: f32) -> vec3<f32> {
    var share = vec2<f32>(1.0, 0.0);
    var cells = 0.0;
    for (var k = 0u; k < not_inlined(frame.matter_count); k += 1u) {
        let matter = frame.matter[k];
        let within = clip(matter, u, cosines);
        if within.x < within.y {
            share = vec2<f32>(min(share.x, within.x), max(share.y, within.y));
            var fineness = FINENESS;
            if STRUCTURE && k < MOST_VOLUMES {
                texels_passed[k] = cloud_passed(k, u, cosines, swept);
                // Three places a cell. Structure is rough: what cells that reach across bends lose is lost in it.
                cells = max(cells, cloud_samples(k, texels_passed[k], 2.0 / (u.x + u.y), width) / 3.0);
                fineness = select(FINENESS, 1.0, clouds.volumes[k].structure.x > 0.0);
            }
            cells = max(cells, fineness * cells_of(u, cosines, swept, matter));
        }
    }
    let part = share.y - share.x;
    return vec3<f32>(share, select(0.0, clamp(ceil(cells * part), 1.0, MOST_CELLS), part > 0.0));
}

// The share of a stretch, of which the straight lines between its ends lie within a matter's reach; (1, 0) for none.
fn clip(matter: Matter, u: vec2<f32>, cosines: vec2<f32>) -> vec2<f32> {
    let most = matter.reach.z * (1.0 + MARGIN_U) + MARGIN_COS;
    let radial = clip_between(u, matter.reach.x * (1.0 - MARGIN_U), matter.reach.y * (1.0 + MARGIN_U));
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

// Adds a piece between two shares of a step in cells; one of too great an optical depth is cut again.
fn add_piece(
    c: Constants,
    observer: State,
    course: StepCourse,
    begin: f32,
    end: f32,
    h: f32,
    cells: f32,
    grain: Grain,
    ratio: f32,
) {
    let size = (end - begin) / cells;
    var cell = 0u;
    var cut = 0u;
    var cuts = 1u;
    // u32 of NaN may be any number.
    let count = clamp(u32(cells), 1u, u32(MOST_CELLS));
    while cell < count && !is_dark() {
        let part = size / f32(cuts);
        let low = begin + size * f32(cell) + part * f32(cut);
        var light = array<vec3<f32>, 3>();
        var depths = vec3<f32>(0.0);
        for (var node = 0u; node < 3u; node += 1u) {
            let along = (f32(cell) + (f32(cut) + GAUSS_NODES[node]) / f32(cuts)) / cells;
            let blur = Blur(grain.from_width + (grain.to_width - grain.from_width) * along, grain.spacing);
            let there = coefficients_at(c, observer, course, low + part * GAUSS_NODES[node], h, part * h, blur, ratio);
            light[node] = there.xyz;
            depths[node] = there.w;
        }
        let depth = dot(GAUSS_WEIGHTS, depths);
        if cuts == 1u && depth > 1.0 {
            cuts = u32(min(ceil(depth), MOST_CUTS));
            continue;
        }
        let gains = node_gains(depths) * medium.w;
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

// Whether so much matter is in front that what is behind does not matter.
fn is_dark() -> bool {
    if SHOWS_DEPTH {
        return medium.y > DARK;
    }
    return medium.w < DARKEST;
}

// All matter at the share x of a step of the length `h`, as if the length `tau` of it were as it is there: light, and
// in w the optical depth. In views of matter x of the light is I_nu. The spacing of `blur` is the share of
// `texels_passed`.
fn coefficients_at(
    c: Constants,
    observer: State,
    course: StepCourse,
    x: f32,
    h: f32,
    tau: f32,
    blur: Blur,
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
        var later = 0.0;
        if STRUCTURE || (SHAPES & (1u << SHAPE_SPOT)) != 0u {
            azimuth = arctan2(quintic_at(course.n_y, x), quintic_at(course.n_x, x)) + cubic_at(course.drag, x);
            if DELAY {
                let integral = cubic_at(course.delay, x) - observer.delay;
                later = frame.matter_delay - retardation(c, observer.u, observer.du, u, du, integral);
            }
        }
        for (var k = 0u; k < not_inlined(frame.matter_count); k += 1u) {
            let matter = frame.matter[k];
            let even = density_at(r, cosine, azimuth, later, matter);
            if !(even >= matter.light.w) {
                continue;
            }
            let at = place_at(c, u, cosine);
            let light = zamo_light(c, at, du);
            let velocity = flow_velocity(c, at, matter);
            let nu = measured_by(light, velocity) / c.nu_local;
            var structure = vec2<f32>(1.0);
            if STRUCTURE && k < MOST_VOLUMES {
                let there = CloudPlace(r, cosine, azimuth, later);
                let spaced = Blur(blur.footprint, blur.spacing * texels_passed[k]);
                structure = cloud_pattern(k, there, angular_velocity(c.a, at, velocity), spaced);
            }
            // Nothing can move so where this fails, NaN among it.
            if nu > 0.0 && nu < 1e30 {
                let g = ratio / nu;
                var shift = Shift(g, g);
                if !ALL_EFFECTS {
                    shift = visible_shift(g, nu_static_observer(c.energy / c.nu_local) * c.nu_local / light.frequency);
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
