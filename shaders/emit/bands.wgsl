// SPDX-License-Identifier: MIT OR Apache-2.0
// The bands of radius in which structure is renewed, and the generations that follow each other there. Mirrors
// src/emit/bands.rs, where the reasons are. Knows no pattern.

#import constants
#import shared/band
#import shared/math

// The number of the first band that shows at three radii close to each other, how many do, and the angles whose cosines
// and sines are the weights of the first and the next there: three angles take less room than six weights.
struct BandsAt {
    first: i32,
    count: u32,
    turns: vec3<f32>,
}

// The age and the number of a band's youngest generation, how many live, the weights of the youngest and the one
// before it.
struct Generations {
    young: f32,
    youngest: u32,
    count: u32,
    weights: vec2<f32>,
}

// The bands that show at three values of ln r, of which the middle one tells the border: one band, or two about it.
fn bands_at(ln_r: vec3<f32>) -> BandsAt {
    let border = floor(ln_r.y / BAND + 0.5);
    let across = (ln_r / BAND - border) * (2.0 / BAND_FADE);
    let outside = all(across >= vec3<f32>(1.0));
    let single = outside || all(across <= vec3<f32>(-1.0));
    let turns = 0.25 * PI * clamp(across + 1.0, vec3<f32>(0.0), vec3<f32>(2.0));
    return BandsAt(i32(border) - select(1, 0, outside), select(2u, 1u, single),
        select(turns, vec3<f32>(0.0), single));
}

// The weights of the first band, or, with `next`, of the one after it.
fn band_weights(at: BandsAt, next: bool) -> vec3<f32> {
    return cos(at.turns - select(0.0, 0.5 * PI, next));
}

// The index of a band among those of a frame, which begin with the number `first`: beyond the last one it goes on.
fn band_index(number: i32, first: i32) -> u32 {
    return u32(clamp(number - first, 0, i32(MOST_BANDS) - 1));
}

// The generations of a band that live `later` than the reference time.
fn generations(band: Band, later: f32) -> Generations {
    let since = band.age + later;
    let births = floor(since / band.spacing);
    let young = since - births * band.spacing;
    let grown = young / (GENERATION_FADE * band.spacing);
    let grows = grown < 1.0;
    let turn = 0.5 * PI * min(grown, 1.0);
    return Generations(young, band.generation + bitcast<u32>(i32(births)), select(1u, 2u, grows),
        select(vec2<f32>(1.0, 0.0), vec2<f32>(sin(turn), cos(turn)), grows));
}

// The bits of a generation of a band, from which it has its part of the pattern.
fn generation_key(band: i32, generation: u32, seed: u32) -> u32 {
    return mix_bits(bitcast<u32>(band) + mix_bits(generation + seed));
}

fn mix_bits(bits: u32) -> u32 {
    var x = (bits ^ (bits >> 16u)) * 0x7feb352du;
    x = (x ^ (x >> 15u)) * 0x846ca68bu;
    return x ^ (x >> 16u);
}
