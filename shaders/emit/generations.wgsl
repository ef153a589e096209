// SPDX-License-Identifier: MIT OR Apache-2.0
// The structure of matter with depth along a piece of a ray, as emit/clouds.wgsl tells it at one place: which bands and
// generations show is the same all along, and how far they are blurred changes slowly, so that a place needs little but
// the filaments themselves. Knows no light and no ray.

#import constants
#import emit/bands
#import emit/clouds
#import emit/filaments

// Weights below it do not show.
const LEAST_WEIGHT: f32 = 1e-4;

// The two bands that meet nearest to a piece, the inner one first, and two generations of each, the younger one first.
// A piece crosses no more than BANDS_APART of ln r, so that no third band shows.
struct PieceClouds {
    // ln r where the bands meet, over BAND.
    border: f32,
    // 1 over the time in which a generation of each band fades in.
    fading: vec2<f32>,
    // At the reference time: before its birth a generation's age is negative, and it does not show.
    ages: vec4<f32>,
    // How fast ln r changes, per M.
    drifts: vec4<f32>,
    // The places of the generations in the block, in periods (azimuth, ln r, height).
    turns: vec4<f32>,
    rows: vec4<f32>,
    layers: vec4<f32>,
}

// How a place is blurred: the level of each generation; ln of the means of the factors on density and temperature. And
// the generations that show there, as bits.
struct PieceBlur {
    levels: vec4<f32>,
    lost: vec2<f32>,
    shown: u32,
}

// The clouds of a piece whose middle is at `ln_r`, and whose light left its near end, that of the latest light, `later`
// than the reference time.
fn piece_clouds(index: u32, ln_r: f32, later: f32) -> PieceClouds {
    let seed = clouds.volumes[index].seed;
    let first = clouds.volumes[index].first_band;
    let border = floor(ln_r / BAND + 0.5);
    let number = i32(border) - 1;
    let inner = clouds.volumes[index].bands[band_index(number, first)];
    let outer = clouds.volumes[index].bands[band_index(number + 1, first)];
    let spacings = vec2<f32>(inner.spacing, outer.spacing);
    let since = vec2<f32>(inner.age, outer.age);
    let births = floor((since + later) / spacings);
    let young = since - births * spacings;
    let old = young + spacings;
    let youngest = vec2<u32>(inner.generation, outer.generation) + bitcast<vec2<u32>>(vec2<i32>(births));
    let a = cloud_shift(generation_key(number, youngest.x, seed));
    let b = cloud_shift(generation_key(number, youngest.x - 1u, seed));
    let c = cloud_shift(generation_key(number + 1, youngest.y, seed));
    let d = cloud_shift(generation_key(number + 1, youngest.y - 1u, seed));
    return PieceClouds(
        border,
        1.0 / (GENERATION_FADE * spacings),
        vec4<f32>(young.x, old.x, young.y, old.y),
        vec2<f32>(inner.drift, outer.drift).xxyy,
        vec4<f32>(a.x, b.x, c.x, d.x),
        vec4<f32>(a.y, b.y, c.y, d.y),
        vec4<f32>(a.z, b.z, c.z, d.z),
    );
}

// The weights of the generations.
fn piece_weights(piece: PieceClouds, ln_r: f32, later: f32) -> vec4<f32> {
    let across = 0.25 * PI * clamp((ln_r / BAND - piece.border) * (2.0 / BAND_FADE) + 1.0, 0.0, 2.0);
    let grown = (0.5 * PI) * clamp((piece.ages.xz + later) * piece.fading, vec2<f32>(0.0), vec2<f32>(1.0));
    let shown = vec2<f32>(cos(across), sin(across)).xxyy;
    return shown * vec4<f32>(sin(grown.x), cos(grown.x), sin(grown.y), cos(grown.y));
}

// How a piece is blurred at ln r, cos th and M after the reference time, where matter turns by `omega` and a pixel is
// `footprint` wide, M.
fn piece_blur(
    index: u32,
    piece: PieceClouds,
    ln_r: f32,
    cosine: f32,
    later: f32,
    omega: f32,
    footprint: f32,
) -> PieceBlur {
    let strength = clouds.volumes[index].strength;
    let clumps = clouds.volumes[index].clumping;
    let r = exp(ln_r);
    let sin2 = max((1.0 - cosine) * (1.0 + cosine), 1e-12);
    let sin = sqrt(sin2);
    let texels = cloud_texels(index);
    let around = texels.x / sin;
    let across = texels.z * cloud_height(index, r, cosine).y * sin;
    let least = around / max(texels.y, across);
    let widest = CLOUD_SHARP * footprint / r;
    let lean2 = select(0.0, cosine * cosine / sin2, clouds.volumes[index].leans == 1u);
    let wound_texels = 1.0 / (WOUND * texels.y);
    let wound = (texels.x * SHEAR * abs(omega)) * (piece.ages + later);
    let wound2 = wound * wound;
    let leaning2 = lean2 * wound2;
    let finest2 = max(max(texels.y * texels.y + wound2, across * across + leaning2), vec4<f32>(around * around));
    let seen2 = max(widest * widest * finest2, wound_texels * wound_texels * max(wound2, leaning2));
    let levels = max(0.5 * log2(max(seen2, vec4<f32>(least * least))), vec4<f32>(0.0));
    let weights = piece_weights(piece, ln_r, later);
    let bits = select(vec4<u32>(0u), vec4<u32>(1u, 2u, 4u, 8u), weights > vec4<f32>(LEAST_WEIGHT));
    var lost = vec2<f32>(0.0);
    for (var i = 0u; i < 4u; i += 1u) {
        let deviation = strength * weights[i] * sqrt(filament_variance(levels[i]));
        lost += vec2<f32>(filament_log_mean(clumps * deviation), filament_log_mean(deviation));
    }
    return PieceBlur(levels, lost, bits.x | bits.y | bits.z | bits.w);
}

// Four places of a piece: a component for each.
struct FourPlaces {
    ln_r: vec4<f32>,
    cos: vec4<f32>,
    azimuth: vec4<f32>,
    later: vec4<f32>,
    omega: vec4<f32>,
}

// The sum of ln P of the generations `shown`, bits, at four places: the pattern without its strength. The level of
// each is a parabola, of which `levels` has the coefficients, over the shares `t` of the piece.
fn piece_filaments(
    piece: PieceClouds,
    shown: u32,
    places: FourPlaces,
    rows: vec4<f32>,
    layers: vec4<f32>,
    drift: f32,
    levels: mat3x4<f32>,
    t: vec4<f32>,
) -> vec4<f32> {
    let across = clamp((places.ln_r / BAND - piece.border) * (2.0 / BAND_FADE) + 1.0, vec4<f32>(0.0), vec4<f32>(2.0));
    var sum = vec4<f32>(0.0);
    var left = shown;
    while left != 0u {
        let k = firstTrailingBit(left);
        left &= left - 1u;
        let one = select(vec4<f32>(0.0), vec4<f32>(1.0), vec4<u32>(k) == vec4<u32>(0u, 1u, 2u, 3u));
        let inner = k < 2u;
        let young = (k & 1u) == 0u;
        let band = select(piece.ages.z, piece.ages.x, inner);
        let grown = clamp((band + places.later) * select(piece.fading.y, piece.fading.x, inner), vec4<f32>(0.0),
            vec4<f32>(1.0));
        let weights = sin((0.25 * PI) * select(across, 2.0 - across, inner))
            * sin((0.5 * PI) * select(1.0 - grown, grown, young));
        let ages = dot(piece.ages, one) + places.later;
        let x = (places.azimuth - places.omega * ages) / TAU + dot(piece.turns, one);
        let y = rows - (dot(piece.drifts, one) * drift) * ages + dot(piece.rows, one);
        let z = layers + dot(piece.layers, one);
        let level = dot(levels[0], one) + t * (dot(levels[1], one) + t * dot(levels[2], one));
        sum += weights * vec4<f32>(
            filament_value(vec3<f32>(x.x, y.x, z.x), level.x),
            filament_value(vec3<f32>(x.y, y.y, z.y), level.y),
            filament_value(vec3<f32>(x.z, y.z, z.z), level.z),
            filament_value(vec3<f32>(x.w, y.w, z.w), level.w),
        );
    }
    return sum;
}
