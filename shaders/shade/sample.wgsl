// What becomes of the light of one of a pixel's samples: it is added to the sum of those before.

#import shared/deciding
#import shared/pass

// Of the tile: the sum of the samples before, and with this one.
@group(2) @binding(0) var radiance_before: texture_2d<f32>;
@group(2) @binding(1) var radiance: texture_storage_2d<rgba32float, write>;

fn take_light(id: vec2<u32>, light: vec4<f32>) {
    var sum = light * pass_.weight;
    if deciding(pass_.first) == 0u {
        sum += textureLoad(radiance_before, id, 0);
    }
    textureStore(radiance, id, sum);
}
