// SPDX-License-Identifier: MIT OR Apache-2.0
// The densities of matter with depth, and the lengths over which they change. Mirrors src/emit/shape.rs and the spots
// of src/emit/matter.rs, where the formulas are. Knows no light and no motion.

#import constants
#import shared/matter
#import shared/math

// The shapes that a kernel's matter has, as bits of SHAPE_*: others are left out when it is compiled.
override SHAPES: u32 = 63u;

// Whether matter of `shape` is `one`. Where a kernel knows one shape it is known when that is compiled.
fn has_shape(shape: u32, one: u32) -> bool {
    return (SHAPES & (1u << one)) != 0u && (SHAPES == (1u << one) || shape == one);
}

fn gaussian(x: f32) -> f32 {
    // Beyond, e^-x is no number that shows, and x^2 might be none at all.
    let cut = min(abs(x), 15.0);
    return exp(-0.5 * cut * cut);
}

// 0 below `low`, 1 above `high`.
fn smooth_step(low: f32, high: f32, x: f32) -> f32 {
    let t = clamp((x - low) / (high - low), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

fn faded(r: f32, inner: f32, outer: f32) -> f32 {
    let begun = smooth_step(INNER_FADE.x, INNER_FADE.y, r / inner);
    return begun * (1.0 - smooth_step(OUTER_FADE.x, OUTER_FADE.y, r / outer));
}

fn disk_density(r: f32, cosine: f32, inner: f32, outer: f32, slope: f32, thickness: f32) -> f32 {
    return faded(r, inner, outer) * pow(r / inner, -slope) * gaussian(cosine / thickness);
}

fn torus_density(r: f32, cosine: f32, radius: f32, width: f32, thickness: f32) -> f32 {
    let sine = sqrt(max((1.0 - cosine) * (1.0 + cosine), 0.0));
    return gaussian((r * sine - radius) / width) * gaussian(r * cosine / (thickness * radius));
}

fn halo_density(r: f32, cosine: f32, radius: f32, thickness: f32) -> f32 {
    return gaussian(r / radius) * gaussian(cosine / thickness);
}

fn jet_density(r: f32, cosine: f32, matter: Matter) -> f32 {
    return faded(r, matter.inner, matter.outer) * pow(r / matter.radius, -matter.slope)
        * gaussian((abs(cosine) - jet_wall(r, matter.opening, matter.radius)) / matter.thickness);
}

fn jet_wall(r: f32, opening: f32, radius: f32) -> f32 {
    return cos(min(opening * sqrt(radius / r), 0.5 * PI));
}

// `later`: the time at which the light left, less the frame's.
fn spot_density(r: f32, cosine: f32, azimuth: f32, later: f32, matter: Matter) -> f32 {
    let radius = matter.radius;
    let axis = r * sqrt(max((1.0 - cosine) * (1.0 + cosine), 0.0));
    let half_turn = sin(0.5 * (azimuth - matter.azimuth - matter.angular_velocity * later));
    let across = axis - radius;
    let height = r * cosine;
    let widths = sqrt(across * across + 4.0 * axis * radius * half_turn * half_turn + height * height) / matter.size;
    return select(0.0, gaussian(widths), widths < SPOT_CUT);
}

// The density of matter at a place.
fn density_at(r: f32, cosine: f32, azimuth: f32, later: f32, matter: Matter) -> f32 {
    let shape = matter.shape;
    var density = 0.0;
    if has_shape(shape, SHAPE_DISK) {
        density = disk_density(r, cosine, matter.inner, matter.outer, matter.slope, matter.thickness);
    }
    if has_shape(shape, SHAPE_TORUS) {
        density = torus_density(r, cosine, matter.radius, matter.width, matter.thickness);
    }
    if has_shape(shape, SHAPE_HALO) {
        density = halo_density(r, cosine, matter.radius, matter.thickness);
    }
    if has_shape(shape, SHAPE_JET) {
        density = jet_density(r, cosine, matter);
    }
    if has_shape(shape, SHAPE_SPOT) {
        return spot_density(r, cosine, azimuth, later, matter);
    }
    return select(density, 0.0, r > matter.outer);
}

// The number of cells that a stretch should be cut into: u and cos theta at its ends, and the angle that it sweeps.
fn cells_of(u: vec2<f32>, cosines: vec2<f32>, swept: f32, matter: Matter) -> f32 {
    let near = 1.0 / u.x;
    let far = 1.0 / u.y;
    if has_shape(matter.shape, SHAPE_SPOT) || has_shape(matter.shape, SHAPE_FREE_SPOT) {
        let run = near - far;
        let across = swept / max(min(u.x, u.y), 1e-30);
        var passed = 0.0;
        if has_shape(matter.shape, SHAPE_FREE_SPOT) {
            let beside = max(1.0 - matter.radius * u, vec2<f32>(LEAST_BESIDE));
            passed = matter.width * abs(log(beside.x / beside.y));
        }
        return (sqrt(run * run + across * across) + passed) / matter.size;
    }
    let thickness = matter.thickness;
    let change = abs(cosines.y - cosines.x);
    var cells = abs(log(u.x / u.y)) / CELL_LN_R + swept / CELL_ANGLE;
    if matter.motion == MOTION_ANGULAR_MOMENTUM {
        // Velocities by angular momentum bend without end towards the axis.
        let most = max(abs(cosines.x), abs(cosines.y));
        cells += 0.5 * swept / sqrt(max(1.0 - most * most, NEAR_AXIS * NEAR_AXIS));
    }
    if has_shape(matter.shape, SHAPE_TORUS) {
        let sines = sqrt(max(1.0 - cosines * cosines, vec2<f32>(0.0)));
        return cells + abs(sines.y * far - sines.x * near) / (1.5 * matter.width)
            + abs(cosines.y * far - cosines.x * near) / (1.5 * thickness * matter.radius);
    }
    if has_shape(matter.shape, SHAPE_JET) {
        let wall = jet_wall(far, matter.opening, matter.radius) - jet_wall(near, matter.opening, matter.radius);
        return cells + (change + abs(wall)) / thickness;
    }
    if has_shape(matter.shape, SHAPE_HALO) {
        cells += abs(near - far) / (1.5 * matter.radius);
    }
    return cells + change / (1.5 * thickness);
}
