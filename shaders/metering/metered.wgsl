// SPDX-License-Identifier: MIT OR Apache-2.0
// Changes light as metering found: by the frame's exposure, and by the base of the light about a pixel. Mirrors
// `Metered` of src/film/metering.rs.

#import constants
#import metering/exposure
#import metering/params
#import metering/stops

// Whether light is changed by its surroundings, and not by the exposure alone.
override LOCAL: bool = false;

@group(1) @binding(4) var<uniform> meter: MeterParams;
@group(1) @binding(5) var<storage, read> exposure: Exposure;
@group(1) @binding(6) var smoothed: texture_3d<f32>;
@group(1) @binding(7) var between_blocks: sampler;

// The stop of the base at a pixel whose own is `own`.
fn base_at(own: f32, place: vec2<i32>) -> f32 {
    let stop = clamp(own, 0.0, f32(BLOCK_STOPS - 1u));
    let across = (vec2<f32>(place) + 0.5) * meter.per_pixel / vec2<f32>(meter.blocks);
    let at = vec3<f32>(across, (stop + 0.5) / f32(BLOCK_STOPS));
    let sum = textureSampleLevel(smoothed, between_blocks, at, 0.0).xy;
    return (sum.y + OWN_WEIGHT * (stop - BLOCK_MIDDLE)) / (sum.x + OWN_WEIGHT) + BLOCK_MIDDLE;
}

fn as_metered(light: vec4<f32>, place: vec2<i32>) -> vec4<f32> {
    var stops = exposure.stops;
    if LOCAL {
        stops += local_stops(base_at(stop_of(light.xyz), place) - (GREY_STOP + METER_DARKEST - exposure.stops));
    }
    return vec4<f32>(min(light.xyz * exp2(stops), vec3<f32>(MAX_SCENE_LIGHT)), light.w);
}
