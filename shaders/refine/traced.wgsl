// SPDX-License-Identifier: MIT OR Apache-2.0
// Ray records of samples of traced pixels: integrated.

#import records/record
#import refine/integrated

fn ray_record(id: vec2<u32>) -> Record {
    return integrated_record(id);
}

// A traced sample's record comes with its sky.
fn with_sky(record: Record) -> Record {
    return record;
}

fn sample_turn() -> f32 {
    return kept_turn;
}

fn next_crossing() -> Crossing {
    return next_integrated();
}

fn more_crossings() -> bool {
    return more_integrated();
}

// Makes next_crossing begin again with the first crossing.
fn rewind_crossings() {
    kept_order = 0u;
}
