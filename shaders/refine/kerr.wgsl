// SPDX-License-Identifier: MIT OR Apache-2.0
// Ray records about a spinning hole for the extra rays of pixels that are refined: looked up in the tables of
// lens/kerr.wgsl, or integrated where the tables are not exact enough.

#import lens/kerr
#import lens/kerr_record
#import records/record
#import refine/integrated
#import shared/fate

var<private> integrated: bool;

fn ray_record(id: vec2<u32>) -> Record {
    var record = look_up(id);
    integrated = record.fate == FATE_PENDING;
    if integrated {
        record = integrated_record(id);
    }
    return record;
}

fn with_sky(record: Record) -> Record {
    if integrated {
        return record;
    }
    return with_looked_up_sky(record);
}

fn sample_turn() -> f32 {
    return select(UNKNOWN_TURN, kept_turn, integrated);
}

fn next_crossing() -> Crossing {
    if !integrated {
        return next_looked_up();
    }
    return next_integrated();
}

fn more_crossings() -> bool {
    return !integrated || more_integrated();
}

// Makes next_crossing begin again with the first crossing.
fn rewind_crossings() {
    kept_order = 0u;
    lookup.flags = lookup.all_flags;
}
