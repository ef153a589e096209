// SPDX-License-Identifier: MIT OR Apache-2.0
// The coordinate grid laid over the sky. Mirrors src/sky/grid.rs, where the reasons are.

#import constants
#import records/record
#import shared/math
#requires fn to_sky(d: vec3<f32>) -> vec3<f32>

struct GridLines {
    coverage: f32,
    origin: f32,
}

fn grid_lines(coordinate: f32, change: f32, spacing: f32) -> GridLines {
    let number = round(coordinate / spacing);
    let gap = spacing / max(change, 1e-12);
    let distance = abs(coordinate / spacing - number) * gap;
    let sharp = clamp(0.5 * GRID_WIDTH + 0.5 - distance, 0.0, 1.0);
    let open = clamp((gap - GRID_DENSE) / (GRID_OPEN - GRID_DENSE), 0.0, 1.0);
    let tint = min(GRID_WIDTH / gap, GRID_TINT);
    return GridLines(tint + (sharp - tint) * open, select(0.0, open, number == 0.0));
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
    let spacing = select(GRID_CAP_SPACING, GRID_SPACING, abs(d.z) < GRID_CAP);
    var meridians = grid_lines(arctan2(d.y, d.x), length(vec2<f32>(dot(dx, east), dot(dy, east))), spacing);
    var parallels = grid_lines(arctan2(d.z, rho), length(vec2<f32>(dot(dx, north), dot(dy, north))), GRID_SPACING);
    if !(stretch2 < GRID_WHOLE_SKY) {
        meridians = GridLines(GRID_TINT, 0.0);
        parallels = GridLines(GRID_TINT, 0.0);
    }
    let over = light + (mix(GRID_COLOUR, GRID_ORIGIN_COLOUR, meridians.origin) - light) * meridians.coverage;
    return over + (mix(GRID_COLOUR, GRID_ORIGIN_COLOUR, parallels.origin) - over) * parallels.coverage;
}
