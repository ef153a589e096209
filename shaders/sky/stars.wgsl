// SPDX-License-Identifier: MIT OR Apache-2.0
// The stars of a pixel. Mirrors src/sky/index.rs (cell_of, level_for, margin) and src/sky/stars.rs (the drawing rule),
// where the reasons are.

#import constants
#import records/record
#import shared/blackbody
#import shared/math
#requires fn light_table(i: u32) -> vec4<f32>
#requires fn star_cell(i: u32) -> u32
#requires fn to_sky(d: vec3<f32>) -> vec3<f32>
#requires fn least_patch() -> f32

fn star_side(level: u32) -> u32 {
    return STAR_FINEST >> level;
}

fn star_margin(level: u32) -> f32 {
    return STAR_MARGIN / f32(star_side(level));
}

// The level by the exponent of radius / margin(0), rounded up; STAR_LEVELS, none, beyond the coarsest one and for NaN
// and infinity.
fn star_level_for(radius: f32) -> u32 {
    let bits = bitcast<u32>(radius / star_margin(0u)) & 0x7fffffffu;
    return min(max((bits + 0x7fffffu) >> 23u, 127u) - 127u, STAR_LEVELS);
}

fn star_fade(level: u32, radius: f32) -> f32 {
    return 1.0 - smoothstep(0.5 * star_margin(level), star_margin(level), radius);
}

fn star_column(u: f32, side: u32) -> u32 {
    let w = u * (1.0 + STAR_WARP - STAR_WARP * abs(u));
    return min(u32(max((w + 1.0) * 0.5 * f32(side), 0.0)), side - 1u);
}

fn cell_of(direction: vec3<f32>, level: u32) -> u32 {
    let a = abs(direction);
    var axis = 2u;
    var local = direction.zxy;
    if a.x >= a.y && a.x >= a.z {
        axis = 0u;
        local = direction;
    } else if a.y >= a.z {
        axis = 1u;
        local = direction.yzx;
    }
    let face = 2u * axis + select(0u, 1u, local.x < 0.0);
    let side = star_side(level);
    let before = 8u * (STAR_FINEST * STAR_FINEST - side * side);
    let plane = local.yz / abs(local.x);
    return before + (face * side + star_column(plane.y, side)) * side + star_column(plane.x, side);
}

// The share of a star's light that a pixel at `p` from it gets: a round bump over what it sums to.
fn star_footprint(p: vec2<f32>) -> f32 {
    let bump = max(1.0 - dot(p, p) / (STAR_RADIUS * STAR_RADIUS), 0.0);
    // The footprint is to be known to some 1e-4, so that the driver's cos will do.
    let c = cos(TAU * p);
    let sum = 1.0 + STAR_RIPPLE.x * (c.x + c.y) + STAR_RIPPLE.y * c.x * c.y + 2.0 * STAR_RIPPLE.z * (dot(c, c) - 1.0);
    return STAR_PEAK * bump * bump * bump / sum;
}

// The mean sky's brightness in a direction, relative to its mean over the sky (StarIndex::mean_sky_density).
fn mean_sky_density(crowding: f32, direction: vec3<f32>) -> f32 {
    let height = 1.0 + abs(dot(direction, GALACTIC_POLE));
    return 1.0 + crowding * (2.0 / (height * height) - 1.0);
}

// Linear Rec. 709 radiance of the stars in a pixel, for stars_brightness 1: of the chart direction `seen` and its
// footprint.
fn star_light(seen: vec3<f32>, footprint: Footprint, g_colour: f32, g_beaming: f32) -> vec3<f32> {
    let d = to_sky(seen);
    let dx = footprint.dx;
    let dy = footprint.dy;
    let stretch2 = dot(dx, dx) + dot(dy, dy);
    let radius = STAR_RADIUS * sqrt(stretch2 + 2.0 * abs(dot(dx, dy)));
    let found = star_level_for(radius);
    let indexed = found < STAR_LEVELS;
    // Beyond the coarsest level nothing is left of its stars.
    let level = min(found, STAR_LEVELS - 1u);
    let fade = select(0.0, star_fade(level, radius), indexed);
    let list = star_cell(cell_of(d, level));
    let mean = light_table(MEAN_SKY_OFFSET + level);
    var i = list >> 8u;
    let end = i + select(0u, list & 255u, indexed);
    // Bit 0: this level's mean sky is to be shaded; bit 1: the next one's.
    var means = select(0u, 1u, mean.x > 0.0 && fade > 0.0) | select(0u, 2u, mean.y > 0.0 && fade < 1.0);
    var light = vec3<f32>(0.0);
    if i >= end && means == 0u {
        return light;
    }
    // The vectors that take a distance from the direction to pixels across and down, times the pixel's area on the sky.
    let p_axis = to_sky(footprint.p);
    let q_axis = to_sky(footprint.q);
    let across = p_axis * dy.y - q_axis * dy.x;
    let down = q_axis * dx.x - p_axis * dx.y;
    let area = abs(dx.x * dy.y - dx.y * dy.x);
    let density = mean_sky_density(mean.w, d);
    let magnification = 1.0 / max(max(area, least_patch() * stretch2), STAR_TINY_AREA);
    // The inner loop only looks; a star that is hit, and after the stars each mean sky, is shaded outside it: lavapipe
    // runs whatever stands in a loop in every turn, and every loop once. (An inner loop that ends in `if .. { break;
    // }` finds no star there, Mesa 22.3.)
    loop {
        var star = vec4<f32>(0.0);
        var p = vec2<f32>(0.0);
        var hit = false;
        while i < end {
            star = light_table(i);
            i += 1u;
            let e = star.xyz - d;
            p = vec2<f32>(dot(e, across), dot(e, down));
            hit = max(abs(p.x), abs(p.y)) < STAR_RADIUS * area;
            if hit {
                break;
            }
        }
        if hit || means != 0u {
            let own = (means & 1u) != 0u;
            var table = MEAN_SKY_TABLES + select(level + 1u, level, own) * BLACKBODY_SIZE;
            var temperature = select(mean.y, mean.x, own);
            var log_reference = 0.0;
            var share = density * select(1.0 - fade, fade, own);
            if hit {
                let kind = light_table(STARS_OFFSET + u32(star.w));
                table = BLACKBODY_OFFSET;
                temperature = kind.y;
                log_reference = kind.z;
                let spread = star_footprint(p / area) * magnification;
                share = select(fade, 1.0, kind.x >= mean.z) * spread * kind.x;
            } else {
                means &= means - 1u;
            }
            light += share * shifted_light(table, temperature, log_reference, g_colour, g_beaming);
        }
        if i >= end && means == 0u {
            break;
        }
    }
    return min(light, vec3<f32>(MAX_STAR_LIGHT));
}
