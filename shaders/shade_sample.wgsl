// Shades one of several samples of a tile's pixels and adds it to the sum of those before.

// Of the tile: the sum of the samples before, and with this one.
@group(2) @binding(0) var radiance_before: texture_2d<f32>;
@group(2) @binding(1) var radiance: texture_storage_2d<rgba32float, write>;

fn seen_crossing() -> Crossing {
    var crossing = next_crossing();
    crossing.share = 1.0;
    return crossing;
}

fn take_record(id: vec2<u32>, record: Record) {
    var sum = shade_record(id, record) * pass_.weight;
    if deciding(pass_.first) == 0u {
        sum += textureLoad(radiance_before, id, 0);
    }
    textureStore(radiance, id, sum);
}
