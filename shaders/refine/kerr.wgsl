// Ray records about a spinning hole for the extra rays of pixels that are refined: looked up in the tables of
// lens/kerr.wgsl, or integrated where the tables are not exact enough. Footprints always come from the tables; an
// integrated crossing that the tables do not have has none.

#import constants
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
        let footprint = record.footprint;
        let known = record.sky_redshift != 0.0;
        record = integrated_record(id);
        if known {
            record.footprint = footprint;
        }
    }
    return record;
}

fn next_crossing() -> Crossing {
    if !integrated {
        return next_looked_up();
    }
    var crossing = next_integrated();
    if PATTERN && crossing.u > 0.0 {
        // A footprint need not be as exact as u: that of the tables serves if their crossing of this order is the same.
        let alike = interpolate(crossing.order);
        if abs(alike.value.x / crossing.u - 1.0) < SAME_CROSSING {
            crossing.dx = place_change(crossing.u, alike, lookup.dx);
            crossing.dy = place_change(crossing.u, alike, lookup.dy);
        }
    }
    return crossing;
}

fn more_crossings() -> bool {
    return !integrated || more_integrated();
}

// Makes next_crossing begin again with the first crossing.
fn rewind_crossings() {
    kept_order = 0u;
    lookup.flags = lookup.all_flags;
}
