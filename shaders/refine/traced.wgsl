// Ray records of samples of traced pixels: integrated, with the footprints of the pixel's own record where it has them.

#import constants
#import records/record
#import refine/integrated
#import traced/footprints

fn ray_record(id: vec2<u32>) -> Record {
    set_traced_pixel(id);
    var record = integrated_record(id);
    let sky = textureLoad(record_sky, traced_pixel, 0);
    if record.fate == FATE_ESCAPED && sky.w != 0.0 {
        record.footprint = sky_footprint(sky.xyz, record.sky);
    }
    return record;
}

fn next_crossing() -> Crossing {
    var crossing = next_integrated();
    if FOOTPRINTS && crossing.u > 0.0 {
        let here = crossing_of_order(traced_pixel, crossing.order);
        if here.x > 0.0 {
            crossing.dx = derivative_of_place(here, crossing.order, vec2<u32>(1u, 0u));
            crossing.dy = derivative_of_place(here, crossing.order, vec2<u32>(0u, 1u));
        }
    }
    return crossing;
}

fn more_crossings() -> bool {
    return more_integrated();
}

// Makes next_crossing begin again with the first crossing.
fn rewind_crossings() {
    kept_order = 0u;
}
