// Ray records of samples with spin: as the tables of lens_kerr.wgsl have them, else integrated. The sky's footprint is the tables'
// in either case; integrated crossings have none.

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
    if integrated {
        return next_integrated();
    }
    return next_looked_up();
}

// Gives the crossings once more from the first.
fn rewind_crossings() {
    kept_order = 0u;
    looked.flags = looked.all_flags;
}
