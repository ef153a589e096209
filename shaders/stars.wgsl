// The stars of a pixel: mirrors src/sky/index.rs (cell_of, level_for, margin) and src/sky/stars.rs (the drawing rule), where the reasons are.
// Reads light_table(i) and star_cell(i), defined where the bindings are; the constants in capitals that are not here come from
// StarIndex::wgsl_constants.

const STAR_MIN_AREA: f32 = 1e-3;
const STAR_TINY_AREA: f32 = 1e-30;
const MAX_STAR_LIGHT: f32 = 1e9;

fn star_side(level: u32) -> u32 {
    return STAR_FINEST >> level;
}

fn star_margin(level: u32) -> f32 {
    return STAR_MARGIN / f32(star_side(level));
}

// STAR_LEVELS: none.
fn star_level_for(radius: f32) -> u32 {
    var level = 0u;
    while level < STAR_LEVELS && !(star_margin(level) >= radius) {
        level += 1u;
    }
    return level;
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

// Quadratic B-spline, support [-1.5, 1.5].
fn star_footprint(t: f32) -> f32 {
    let a = abs(t);
    let skirt = max(1.5 - a, 0.0);
    return select(0.5 * skirt * skirt, 0.75 - a * a, a < 0.5);
}

// Linear Rec. 709 radiance of the stars in a pixel, for stars_brightness 1: d unit direction in sky axes, dx and dy its derivatives by
// pixel.
fn star_light(d: vec3<f32>, dx: vec3<f32>, dy: vec3<f32>, g_colour: f32, g_beaming: f32) -> vec3<f32> {
    let xx = dot(dx, dx);
    let yy = dot(dy, dy);
    let xy = dot(dx, dy);
    let stretch2 = 0.5 * (xx + yy) + sqrt(0.25 * (xx - yy) * (xx - yy) + xy * xy);
    let radius = 2.1213203 * sqrt(stretch2);
    // By its bits: not NaN, not infinite.
    let finite = (bitcast<u32>(radius) & 0x7fffffffu) < 0x7f800000u;
    let found = select(STAR_LEVELS, star_level_for(radius), finite);
    let indexed = found < STAR_LEVELS;
    // Beyond the coarsest level nothing is left of its stars.
    let level = min(found, STAR_LEVELS - 1u);
    let fade = select(0.0, star_fade(level, radius), indexed);
    let mean = MEAN_SKY_OFFSET + level * MEAN_SKY_PARTS;
    let next_limit = light_table(mean + MEAN_SKY_PARTS).w;

    let across = cross(dy, d);
    let down = cross(d, dx);
    let area = abs(dot(cross(dx, dy), d));
    let magnification = 1.0 / max(max(area, STAR_MIN_AREA * stretch2), STAR_TINY_AREA);
    let cell = cell_of(d, level);
    var i = star_cell(cell);
    let end = select(i, star_cell(cell + 1u), indexed);
    // Parts of this level's mean sky, then of the next one's: the first two levels leave nothing out.
    var part = select(0u, MEAN_SKY_PARTS, fade == 0.0 || level < 2u);
    let parts = select(2u * MEAN_SKY_PARTS, MEAN_SKY_PARTS, fade == 1.0 || level == 0u);
    var light = vec3<f32>(0.0);
    // The inner loop only looks; a star that is hit, and after the stars each part of the mean sky, is shaded outside it:
    // lavapipe runs whatever stands in a loop in every turn.
    loop {
        var at = 0u;
        var p = vec2<f32>(0.0);
        var flux = 0.0;
        var hit = false;
        while i < end {
            at = STARS_OFFSET + 2u * star_cell(i);
            i += 1u;
            let star = light_table(at);
            let e = star.xyz - d;
            p = vec2<f32>(dot(e, across), dot(e, down));
            flux = star.w;
            hit = max(abs(p.x), abs(p.y)) < 1.5 * area;
            if hit {
                break;
            }
        }
        if !hit && part >= parts {
            break;
        }
        let kind = light_table(select(mean + part, at + 1u, hit));
        let shown = select(fade, 1.0, flux >= next_limit);
        let share = shown * star_footprint(p.x / area) * star_footprint(p.y / area) * magnification * flux;
        let mean_share = select(1.0 - fade, fade, part < MEAN_SKY_PARTS) * kind.z;
        part += select(1u, 0u, hit);
        light += select(mean_share, share, hit) * shifted_blackbody(kind.x, kind.y, g_colour, g_beaming);
    }
    return min(light, vec3<f32>(MAX_STAR_LIGHT));
}
