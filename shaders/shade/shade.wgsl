// SPDX-License-Identifier: MIT OR Apache-2.0
// The linear radiance (or a view's value) of a ray record. Mirrors src/cpu/shade.rs. Does not know how the record was
// made.

#import constants
#import camera/observer
#import camera/projection
#import emit/moment
#import emit/occluder
#import emit/plane
#import emit/shift
#import records/record
#import shared/not_inlined
#import shared/frame
#import shared/math
#import shared/pass
#import sky/grid
#import sky/map
#import sky/shift
#import sky/stars
#requires fn next_crossing() -> Crossing
#requires fn medium_before(k: u32) -> vec4<f32>
#requires fn more_crossings() -> bool
#requires fn seen_crossing() -> Crossing
#requires fn seen_emission(here: Record, crossing: Crossing, open: f32) -> vec4<f32>
#requires fn lit_crossing(crossing: Crossing) -> Crossing
#requires fn seen_sky(here: Record) -> Record

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> pass_: Pass;
// Tables as textures, TABLE_WIDTH entries a row: software drivers reach into buffers lane by lane.
@group(0) @binding(2) var light_tables: texture_2d<f32>;
@group(0) @binding(3) var star_cells: texture_2d<u32>;
// Pyramids of sky/map.wgsl: the embedded one, and the host's.
@group(0) @binding(4) var milky_way: texture_2d<f32>;
@group(0) @binding(5) var sky_map: texture_2d<f32>;
// Linear between texels and levels, around in u, to the border in v.
@group(0) @binding(6) var map_sampler: sampler;

// Choices that a pipeline is made for; the host compiles one for each combination that it needs: lavapipe runs both
// sides of every `if`.
override SHOWS_LIGHT: bool = true;
override SHOWS_STARS: bool = true;
override SHOWS_MILKY_WAY: bool = true;
override SHOWS_MAP: bool = true;
override SHOWS_GRID: bool = true;
override OPAQUE: bool = false;
override REFINES: bool = true;

fn light_table(i: u32) -> vec4<f32> {
    return textureLoad(light_tables, vec2<u32>(i % TABLE_WIDTH, i / TABLE_WIDTH), 0);
}

fn star_cell(i: u32) -> u32 {
    return textureLoad(star_cells, vec2<u32>(i % TABLE_WIDTH, i / TABLE_WIDTH), 0).x;
}

fn sampled(map: texture_2d<f32>, place: vec2<f32>, level: f32) -> vec3<f32> {
    return textureSampleLevel(map, map_sampler, place, level).xyz;
}

// Light and alpha of the tile's pixel `id`, or the view's value first; nothing where the projection shows nothing.
fn shade_record(id: vec2<u32>, record: Record) -> vec4<f32> {
    let seen = has_look_direction(pixel_place(id));
    if SHOWS_LIGHT {
        moment = pass_.moment;
        if OCCLUDED {
            set_occluder(pixel_place(id));
        }
        return select(vec4<f32>(0.0), pixel_light(record), seen);
    }
    return vec4<f32>(select(no_value(), view_value(record, id), seen), 0.0, 0.0, 1.0);
}

// NaN, which may not be written as a constant.
fn no_value() -> f32 {
    return bitcast<f32>(0x7fc00000u | frame.view);
}

fn to_sky(d: vec3<f32>) -> vec3<f32> {
    return frame.sky_x * d.x + frame.sky_y * d.y + frame.sky_z * d.z;
}

// The least patch of src/sky/stars.rs.
fn least_patch() -> f32 {
    return frame.least_patch;
}

// Whether the host's things hide a crossing.
fn is_occluded(crossing: Crossing) -> bool {
    return select(occluder_ends, crossing_distance(crossing) > occluder_farthest, crossing.order == 0u);
}

// At the pixel shaded last: the share of the light from behind that matter lets pass, and the turn of the sky's
// direction (turn_of); 0 where the sky is hidden.
var<private> seen_through: f32;
var<private> seen_turn: f32;

// Light and alpha of a record. seen_crossing gives next_crossing, seen_emission the crossing_emission of what the disk
// covers there, lit_crossing after that the crossing where most of its light comes from, and seen_sky the record with
// its sky.
fn pixel_light(here: Record) -> vec4<f32> {
    var light = vec3<f32>(0.0);
    var open = 1.0;
    var given = 0u;
    // max_crossings bounds what next_crossing gives; behind an opaque crossing nothing is seen.
    for (var k = 0u; k < select(not_inlined(frame.max_crossings), 1u, OPAQUE); k += 1u) {
        let crossing = seen_crossing();
        if crossing.u <= 0.0 {
            break;
        }
        if VOLUMES {
            let medium = medium_before(k);
            light += open * medium.xyz;
            open *= medium.w;
            given = k + 1u;
        }
        var emission = seen_emission(here, crossing, open);
        if OCCLUDED && is_occluded(crossing) {
            emission = vec4<f32>(0.0);
        }
        if emission.w > 0.0 {
            light += structure_at_crossing(lit_crossing(crossing)) * emission.xyz;
        }
        open *= 1.0 - emission.w;
        // Behind an opaque crossing no other is looked for. If the loop found at its begin that there is none, lavapipe
        // would run all of the body once more.
        if open <= 0.0 || !more_crossings() {
            break;
        }
    }
    if VOLUMES {
        let medium = medium_before(given);
        light += open * medium.xyz;
        open *= medium.w;
    }
    seen_through = open;
    seen_turn = 0.0;
    if OCCLUDED && occluder_ends {
        seen_through = 0.0;
        return vec4<f32>(light, 1.0 - open);
    }
    if here.fate == FATE_ESCAPED && open > 0.0 {
        let whole = seen_sky(here);
        seen_turn = turn_of(whole);
        if SHOWS_STARS || SHOWS_MILKY_WAY || SHOWS_MAP || SHOWS_GRID {
            light += open * sky_light(whole);
        }
    }
    return vec4<f32>(light, select(1.0, 1.0 - open, here.fate == FATE_ESCAPED));
}

// The light that a crossing adds to a ray of which the share `open` comes this far, without structure; w: its opacity.
fn crossing_emission(here: Record, crossing: Crossing, open: f32) -> vec4<f32> {
    let mu = min(here.polar_momentum * crossing.u * crossing.g, 1.0);
    return emitted_at_crossing(crossing, crossing_shift(here, crossing), mu, open);
}

fn crossing_shift(here: Record, crossing: Crossing) -> Shift {
    if ALL_EFFECTS {
        return Shift(crossing.g, crossing.g);
    }
    let seen = nu_static_observer(here.energy, here.angular_momentum);
    return visible_shift(crossing.g, seen / zamo_frequency(crossing.u, 0.0, here.energy, here.angular_momentum));
}

fn sky_light(here: Record) -> vec3<f32> {
    var shift = Shift(here.sky_redshift, here.sky_redshift);
    if !ALL_EFFECTS {
        let seen = nu_static_observer(here.energy, here.angular_momentum);
        shift = visible_shift(here.sky_redshift, seen / here.energy);
    }
    var light = vec3<f32>(0.0);
    if SHOWS_STARS {
        light = star_light(here.sky, here.footprint, shift.colour, shift.beaming) * frame.stars_brightness;
    }
    if SHOWS_MILKY_WAY || SHOWS_MAP {
        light += extended_light(here, shift) * frame.map_brightness;
    }
    if SHOWS_GRID {
        light = under_grid(light, to_sky(here.sky), here.footprint);
    }
    return light;
}

// The light of the Milky Way and of the host's map.
fn extended_light(here: Record, shift: Shift) -> vec3<f32> {
    let d = to_sky(here.sky);
    let seen = map_patch(here.footprint);
    var light = vec3<f32>(0.0);
    if SHOWS_MILKY_WAY {
        light = shifted_map_light(map_light(milky_way, frame.milky_way_size, d, seen), shift.colour, shift.beaming);
    }
    if SHOWS_MAP {
        light += shifted_map_light(map_light(sky_map, frame.map_size, d, seen), shift.colour, shift.beaming);
    }
    return light;
}

// I_nu and optical depth of all matter with depth along the ray; views of it have no crossings.
fn seen_matter() -> vec2<f32> {
    if VOLUMES {
        return medium_before(0u).xy;
    }
    return vec2<f32>(0.0);
}

// The value that BHR_VIEW_* shows; NaN where there is nothing.
fn view_value(here: Record, id: vec2<u32>) -> f32 {
    let nothing = no_value();
    let first = next_crossing();
    let on_disk = first.u > 0.0;
    let in_sky = here.fate == FATE_ESCAPED;
    switch not_inlined(frame.view) {
        case VIEW_REDSHIFT: {
            return select(select(nothing, here.sky_redshift, in_sky), first.g, on_disk);
        }
        case VIEW_ORDER: {
            let elsewhere = select(select(nothing, -2.0, here.fate == FATE_CAPTURED), -1.0, in_sky);
            return select(elsewhere, f32(first.order), on_disk);
        }
        case VIEW_DEFLECTION: {
            let place = pixel_place(id);
            let n = look_direction(place.x, place.y);
            let look = frame.placed_r * n.x + frame.placed_theta * n.y + frame.placed_phi * n.z;
            var sky = here.sky;
            if in_sky {
                sky = seen_sky(here).sky;
            }
            return select(nothing, arctan2(length(cross(look, sky)), dot(look, sky)), in_sky);
        }
        case VIEW_STEPS: {
            return f32(here.steps);
        }
        case VIEW_OPTICAL_DEPTH: {
            return select(nothing, seen_matter().y, in_sky);
        }
        case VIEW_INTENSITY: {
            return seen_matter().x;
        }
        default: {
            // METRIC: -g_tt = 1 - 2/r in the plane.
            return select(nothing, 1.0 - 2.0 * here.plane_u, here.plane_u > 0.0);
        }
    }
}
