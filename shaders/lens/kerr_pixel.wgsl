// SPDX-License-Identifier: MIT OR Apache-2.0
// Ray records with spin, as the tables of lens/kerr.wgsl have them; rays that the tables do not hold are left to
// lens/kerr_deferred.wgsl.

#import lens/kerr_record
#import lens/media
#import records/record
#import shared/pass

fn ray_record(id: vec2<u32>) -> Record {
    set_media_pixel(id);
    return look_up(id);
}

fn with_sky(record: Record) -> Record {
    return with_looked_up_sky(record);
}

fn next_crossing() -> Crossing {
    return next_looked_up();
}

// Whether there is one only next_crossing finds out.
fn more_crossings() -> bool {
    return true;
}

fn defer_pixel(id: vec2<u32>) {
    let i = atomicAdd(&deferred.counts[pass_.slot], 1u);
    deferred.pixels[i] = id.x | (id.y << 16u);
}
