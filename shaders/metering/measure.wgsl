// SPDX-License-Identifier: MIT OR Apache-2.0
// Kernel: counts the cells of the finest grid by their stop, in a workgroup for each block, and all of them in a
// histogram. Sums of whole numbers are the same in whatever order threads add.

#import constants
#import metering/params
#import metering/stops

@group(0) @binding(0) var<uniform> meter: MeterParams;
@group(0) @binding(1) var gathered: texture_2d<f32>;
@group(0) @binding(2) var glare: texture_2d<f32>;
// For each stop of each block the cells, and the sum of how far theirs are above it, both in parts of a cell.
@group(0) @binding(3) var<storage, read_write> counts: array<vec2<i32>>;
@group(0) @binding(4) var<storage, read_write> histogram: array<atomic<u32>>;

const THREADS: u32 = 128u;

var<workgroup> block_counts: array<atomic<i32>, BLOCK_STOPS>;
var<workgroup> block_moments: array<atomic<i32>, BLOCK_STOPS>;
var<workgroup> block_histogram: array<atomic<u32>, METER_BINS>;

fn count_cell(stop: f32) {
    if stop >= 0.0 {
        atomicAdd(&block_histogram[min(u32(stop * METER_BINS_PER_STOP), METER_BINS - 1u)], 1u);
        let place = min(stop, f32(BLOCK_STOPS - 1u));
        let first = u32(place);
        let share = place - f32(first);
        let second = i32(share * CELL_PARTS + 0.5);
        let moment = i32(share * (1.0 - share) * CELL_PARTS + 0.5);
        let beyond = min(first + 1u, BLOCK_STOPS - 1u);
        atomicAdd(&block_counts[first], i32(CELL_PARTS) - second);
        atomicAdd(&block_moments[first], moment);
        atomicAdd(&block_counts[beyond], second);
        atomicAdd(&block_moments[beyond], -moment);
    }
}

@compute @workgroup_size(8, 16)
fn measure(@builtin(workgroup_id) block: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    for (var bin = thread; bin < METER_BINS; bin += THREADS) {
        atomicStore(&block_histogram[bin], 0u);
    }
    if thread < BLOCK_STOPS {
        atomicStore(&block_counts[thread], 0);
        atomicStore(&block_moments[thread], 0);
    }
    workgroupBarrier();
    let corner = block.xy * meter.side;
    for (var i = thread; i < meter.side * meter.side; i += THREADS) {
        let cell = corner + vec2<u32>(i % meter.side, i / meter.side);
        if all(cell < meter.cells) {
            let own = textureLoad(gathered, cell, 0).xyz;
            count_cell(stop_of(meter.own * own + meter.above * textureLoad(glare, cell, 0).xyz));
        }
    }
    workgroupBarrier();
    for (var bin = thread; bin < METER_BINS; bin += THREADS) {
        let count = atomicLoad(&block_histogram[bin]);
        if count > 0u {
            atomicAdd(&histogram[bin], count);
        }
    }
    if thread < BLOCK_STOPS {
        let found = vec2<i32>(atomicLoad(&block_counts[thread]), atomicLoad(&block_moments[thread]));
        counts[(block.y * meter.blocks.x + block.x) * BLOCK_STOPS + thread] = found;
    }
}
