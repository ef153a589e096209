// SPDX-License-Identifier: MIT OR Apache-2.0
// Kernel: finds the exposure by the histogram of the frame's light, which it clears for the next frame. One workgroup,
// with a thread for each bin.

#import constants
#import metering/exposure
#import metering/params
#import metering/stops

@group(0) @binding(0) var<uniform> meter: MeterParams;
@group(0) @binding(1) var<storage, read_write> histogram: array<u32>;
@group(0) @binding(2) var<storage, read_write> exposure: Exposure;

// The sum of the counts up to each bin.
var<workgroup> sums: array<u32, METER_BINS>;

@compute @workgroup_size(METER_BINS)
fn expose(@builtin(local_invocation_index) bin: u32) {
    let count = histogram[bin];
    histogram[bin] = 0u;
    sums[bin] = count;
    workgroupBarrier();
    for (var reach = 1u; reach < METER_BINS; reach *= 2u) {
        var below = 0u;
        if bin >= reach {
            below = sums[bin - reach];
        }
        workgroupBarrier();
        sums[bin] += below;
        workgroupBarrier();
    }
    let total = sums[METER_BINS - 1u];
    let wanted = max(meter.percentile * f32(total), 0.5);
    let before = f32(sums[bin] - count);
    // A black frame has no exposure of its own; where frames adapt it keeps that of the one before.
    let at_once = meter.adaptation >= 1.0;
    if total == 0u && bin == 0u && at_once {
        exposure.stops = 0.0;
    }
    if count > 0u && before < wanted && wanted <= f32(sums[bin]) {
        let stops = wanted_stops((f32(bin) + (wanted - before) / f32(count)) / METER_BINS_PER_STOP);
        let last = select(stops, exposure.stops, exposure.measured != 0u && !at_once);
        exposure.stops = last + meter.adaptation * (stops - last);
        exposure.measured = 1u;
    }
}
