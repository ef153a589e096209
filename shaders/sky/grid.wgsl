// SPDX-License-Identifier: MIT OR Apache-2.0
// The coordinate grid laid over the sky. Mirrors src/sky/grid.rs, where the reasons are.

#import constants
#import records/record
#import shared/math
#requires fn to_sky(d: vec3<f32>) -> vec3<f32>

struct GridLines {
    tint: f32,
    coverage: f32,
    is_origin: bool,
}

fn grid_rank(coordinate: f32, change: f32, spacing: f32) -> GridLines {
    let number = round(coordinate / spacing);
    let gap = spacing / max(change, 1e-12);
    let distance = abs(coordinate / spacing - number) * gap;
    let sharp = clamp(0.5 * GRID_WIDTH + 0.5 - distance, 0.0, 1.0);
    let open = clamp((gap - GRID_DENSE) / (GRID_OPEN - GRID_DENSE), 0.0, 1.0);
    return GridLines(GRID_TINT * (1.0 - open), sharp * open, number == 0.0);
}

fn grid_lines(coordinate: f32, change: f32, sparse: bool) -> GridLines {
    var lines = grid_rank(coordinate, change, GRID_RANKS.x * GRID_SPACING);
    let second = grid_rank(coordinate, change, GRID_RANKS.y * GRID_SPACING);
    let third = grid_rank(coordinate, change, GRID_RANKS.z * GRID_SPACING);
    if second.coverage >= lines.coverage {
        lines = GridLines(lines.tint, second.coverage, second.is_origin);
    }
    if third.coverage >= lines.coverage {
        lines = GridLines(lines.tint, third.coverage, third.is_origin);
    }
    if sparse {
        lines = third;
    }
    return lines;
}

// `light` under the tint and the lines of a family.
fn under_lines(light: vec3<f32>, lines: GridLines) -> vec3<f32> {
    let tinted = light + (GRID_COLOUR - light) * lines.tint;
    return tinted + (select(GRID_COLOUR, GRID_ORIGIN_COLOUR, lines.is_origin) - tinted) * lines.coverage;
}

// `light` of the sky under the grid. `d`: sky axes.
fn under_grid(light: vec3<f32>, d: vec3<f32>, footprint: Footprint) -> vec3<f32> {
    let dx = footprint.dx;
    let dy = footprint.dy;
    let stretch2 = dot(dx, dx) + dot(dy, dy);
    let p = to_sky(footprint.p);
    let q = to_sky(footprint.q);
    let rho = max(sqrt(d.x * d.x + d.y * d.y), 1e-6);
    // Changes of right ascension and of declination, in the tangent plane.
    let east = vec2<f32>(d.x * p.y - d.y * p.x, d.x * q.y - d.y * q.x) / (rho * rho);
    let north = vec2<f32>(p.z, q.z) / rho;
    let sparse = abs(d.z) >= GRID_CAP;
    var meridians = grid_lines(arctan2(d.y, d.x), length(vec2<f32>(dot(dx, east), dot(dy, east))), sparse);
    var parallels = grid_lines(arctan2(d.z, rho), length(vec2<f32>(dot(dx, north), dot(dy, north))), false);
    if !(stretch2 < GRID_WHOLE_SKY) {
        meridians = GridLines(GRID_TINT, 0.0, false);
        parallels = GridLines(GRID_TINT, 0.0, false);
    }
    return under_lines(under_lines(light, meridians), parallels);
}
