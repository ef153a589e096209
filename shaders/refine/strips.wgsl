// SPDX-License-Identifier: MIT OR Apache-2.0
// The strips of a pixel along the critical curve, and where in them samples lie. Mirrors `Strips` of
// src/scene/refine.rs and `LevelAbout` of src/cpu/refine.rs, where the reasons are. Knows no records and no light.

#import constants
#import camera/critical
#import camera/observer
#import camera/projection
#import refine/cell
#requires var lane: u32
#requires var samples: u32

// The strips of a pixel along the critical curve. Distances are in pixels, positive where rays escape.
struct Strips {
    // Unit vector from the curve outwards, in pixels right and down.
    normal: vec2<f32>,
    // The distance of the pixel's centre.
    level: f32,
    // The change of the curve's level in a pixel, at the curve.
    slope: f32,
    // `spread` of the least and the greatest distance in the pixel.
    range: vec2<f32>,
    // The number of strips where rays are captured.
    captured: u32,
}

struct Cell {
    // Place in the pixel, 0 .. 1, were the curve straight.
    place: vec2<f32>,
    // The distance from the curve that it is meant to have.
    distance: f32,
    // The cell's share of the pixel, and of that the share of its first half, that towards captured rays.
    weight: f32,
    first_half: f32,
}

fn strip_count() -> u32 {
    return samples / 2u;
}

fn sample_index() -> u32 {
    return lane % samples;
}

// A point in the direction seen at the pixel's centre, and its changes to the next pixel right and down: the image
// plane, or its tangent, which goes on beyond the border of a cube's face.
var<private> level_origin: vec3<f32>;
var<private> level_right: vec3<f32>;
var<private> level_down: vec3<f32>;

// Goes to the pixel about `at`.
fn go_to_pixel(at: vec2<f32>) {
    let p = camera_point(at.x, at.y);
    level_origin = in_frame(p.at);
    level_right = in_frame(p.dx);
    level_down = in_frame(p.dy);
}

// The level of the critical curve at so many pixels right of the pixel's centre and below it.
fn level_at(off: vec2<f32>) -> f32 {
    return curve_level(aberrate(normalize(level_origin + level_right * off.x + level_down * off.y)).n);
}

// The scale on which strips are of equal width, and back.
fn spread(distance: f32) -> f32 {
    let x = abs(distance) / narrowest();
    let size = log(x + sqrt(x * x + 1.0));
    return select(size, -size, distance < 0.0);
}

fn gathered(x: f32) -> f32 {
    return 0.5 * narrowest() * (exp(x) - exp(-x));
}

// The width of the narrowest strips, pixels.
fn narrowest() -> f32 {
    return select(MATTER_NARROWEST, NARROWEST, samples == CURVE_SAMPLES);
}

// The level at the centre of the pixel that go_to_pixel went to, and its change to the next pixel right and down.
// (Compilers inline level_at at every call: the loop keeps calls few.)
fn level_about() -> vec3<f32> {
    var centre = 0.0;
    var change = vec2<f32>(0.0);
    for (var i = 0u; i < 5u; i += 1u) {
        let is_centre = i == 4u;
        let axis = select(select(vec2<f32>(1.0, 0.0), vec2<f32>(0.0, 1.0), i >= 2u), vec2<f32>(0.0), is_centre);
        let side = select(-1.0, 1.0, (i & 1u) == 1u);
        let level = level_at(axis * (side * LEVEL_STEP));
        centre = level;
        change += select(axis * (side * level / (2.0 * LEVEL_STEP)), vec2<f32>(0.0), is_centre);
    }
    return vec3<f32>(centre, change);
}

// The curve's distance from the centre of a pixel, pixels, if the level is linear; `about`: its level_about.
fn curve_distance(about: vec3<f32>) -> f32 {
    return abs(about.x) / max(length(about.yz), 1e-20);
}

// The strips of the pixel that go_to_pixel went to; `about`: its level_about.
fn strips_of(about: vec3<f32>) -> Strips {
    let here = about.x;
    let change = about.yz;
    let steepness = max(length(change), 1e-20);
    let normal = select(vec2<f32>(1.0, 0.0), change / steepness, steepness > 1e-20);
    let step = -here / steepness;
    var distance = -step;
    var slope = steepness;
    // Place and level on both sides of the curve; the place looked at last; -1 if that replaced `low`, 1 if `high`, and
    // 0 before the search.
    var low = vec2<f32>(0.0);
    var high = vec2<f32>(0.0);
    var found = 0.0;
    var side = 0.0;
    var rise = 0.0;
    // Turn 0 is a step of Newton's method, which suffices nearly everywhere; turns 1 and 2 look at both ends; then
    // SEARCH_STEPS turns search by the Illinois method, and the last two take the slope there. One loop, so that
    // level_at is inlined once.
    for (var i = 0u; i < SEARCH_STEPS + 5u; i += 1u) {
        // So far from the curve strips are even.
        if abs(step) >= FARTHEST {
            break;
        }
        let met = (low.x * high.y - high.x * low.y) / max(high.y - low.y, 1e-20);
        let searching = i > 2u && i < SEARCH_STEPS + 3u;
        let beyond = select(-1.0, 1.0, i == SEARCH_STEPS + 4u);
        var place = select(found + beyond * LEVEL_STEP, met, searching);
        place = select(select(select(place, SEARCH_REACH, i == 2u), -SEARCH_REACH, i == 1u), step, i == 0u);
        let value = level_at(normal * place);
        if i == 0u {
            if abs(step) < SEARCH_REACH && abs(value) <= EVEN_LEVEL * steepness {
                distance = value / steepness - step;
                break;
            }
            continue;
        }
        if i > SEARCH_STEPS + 2u {
            rise += beyond * value;
            distance = -found;
            slope = max(rise / (2.0 * LEVEL_STEP), 1e-20);
            continue;
        }
        found = place;
        let outside = value > 0.0;
        // While the ends are looked at: `low` and `high` are they, and then one of them the centre.
        low.y *= select(1.0, 0.5, searching && outside && side > 0.0);
        high.y *= select(1.0, 0.5, searching && !outside && side < 0.0);
        high = select(high, vec2<f32>(place, value), i == 2u || (searching && outside));
        low = select(low, vec2<f32>(place, value), i == 1u || (searching && !outside));
        side = select(0.0, select(-1.0, 1.0, outside), searching);
        if i == 2u {
            if !(low.y < 0.0 && high.y > 0.0) {
                break;
            }
            high = select(high, vec2<f32>(0.0, here), here > 0.0);
            low = select(vec2<f32>(0.0, here), low, here > 0.0);
        }
    }
    return strips_at(distance, normal, slope);
}

fn strips_at(distance: f32, normal: vec2<f32>, slope: f32) -> Strips {
    let level = clamp(distance, -FARTHEST, FARTHEST);
    let reach = 0.5 * (abs(normal.x) + abs(normal.y));
    let range = vec2<f32>(spread(level - reach), spread(level + reach));
    let inside = max(-range.x, 0.0) * select(MATTER_CAPTURED_DENSITY, CAPTURED_DENSITY, samples == CURVE_SAMPLES);
    let count = strip_count();
    let share = f32(count) * inside / max(inside + max(range.y, 0.0), 1e-20);
    let fewest = FEWEST_STRIPS * count / 16u;
    let both = clamp(u32(round(share)), fewest, count - fewest);
    let captured = select(select(both, count, range.y <= 0.0), 0u, range.x >= 0.0);
    return Strips(normal, level, slope, range, captured);
}

// The distance at `strip`, a whole number at the begin of one of those on the side `outside` of the curve.
fn strip_distance(strips: Strips, outside: bool, strip: f32) -> f32 {
    let captured = f32(strips.captured);
    let first = select(strips.range.x, max(strips.range.x, 0.0), outside);
    let last = select(min(strips.range.y, 0.0), strips.range.y, outside);
    let outer = (strip - captured) / max(f32(strip_count()) - captured, 1.0);
    let share = select(strip / max(captured, 1.0), outer, outside);
    return gathered(first + (last - first) * share);
}

// The cell of this thread's sample.
fn strip_cell(strips: Strips) -> Cell {
    let strip = f32(sample_index() / 2u);
    let outside = sample_index() / 2u >= strips.captured;
    let normal = strips.normal;
    let begin = strip_distance(strips, outside, strip) - strips.level;
    let middle = strip_distance(strips, outside, strip + 0.5) - strips.level;
    let end = strip_distance(strips, outside, strip + 1.0) - strips.level;
    let tangent = vec2<f32>(-normal.y, normal.x);
    let foot = normal * middle;
    let across = select(vec2<f32>(1e-6), tangent, abs(tangent) > vec2<f32>(1e-6));
    let one = (-0.5 - foot) / across;
    let other = (0.5 - foot) / across;
    let begins = max(min(one, other), vec2<f32>(-1.0));
    let ends = min(max(one, other), vec2<f32>(1.0));
    let share = 0.25 + 0.5 * f32(lane & 1u);
    let along = mix(max(begins.x, begins.y), min(ends.x, ends.y), share);
    let before = share_below(begin, normal);
    let wide = share_below(end, normal) - before;
    let first = (share_below(middle, normal) - before) / max(wide, 1e-20);
    return Cell(0.5 + foot + tangent * along, strips.level + middle, 0.5 * wide, select(0.5, first, wide > 0.0));
}

// The place of a cell's sample in its pixel, the curve being bent.
fn corrected_place(strips: Strips, cell: Cell) -> vec2<f32> {
    let foot = cell.place - strips.normal * cell.distance;
    let off = clamp(level_at(foot - 0.5) / strips.slope, -0.25, 0.25);
    return cell.place - strips.normal * select(0.0, off, abs(strips.level) < BENT);
}
