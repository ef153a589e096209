// SPDX-License-Identifier: MIT OR Apache-2.0
// Stops of light, and by how many metering changes them. Mirrors src/film/metering.rs.

#import constants
#import film/colour_map
#import metering/params

fn stop_of(light: vec3<f32>) -> f32 {
    return log2(max(luminance(light), LEAST_BASE)) + METER_DARKEST;
}

fn wanted_stops(stop: f32) -> f32 {
    // No `clamp`, as `least` may be above `most`, which then counts.
    return min(max(meter.strength * (meter.aim + METER_DARKEST - stop), meter.least), meter.most);
}

fn smooth_above(stops: f32) -> f32 {
    let near = clamp(stops, -1.0, 1.0) + 1.0;
    return 0.25 * near * near + max(stops - 1.0, 0.0);
}

fn local_stops(stops: f32) -> f32 {
    return meter.shadows * smooth_above(-stops) - meter.highlights * smooth_above(stops);
}
