// SPDX-License-Identifier: MIT OR Apache-2.0
// The structure of the disk. Mirrors src/emit/turbulence.rs, where the reasons are. Knows no colours.

#import constants
#import emit/streaks
#import records/record
#import shared/frame
#import shared/math

// Texels in a radian, and in an e-fold of the radius.
const TEXELS_AROUND: f32 = f32(STREAK_COLUMNS) / TAU;
const TEXELS_ACROSS: f32 = f32(STREAK_ROWS) / STREAK_PERIOD;

// The factor on the disk's radiance. dx, dy: the change of `at` to the next pixel.
fn turbulent_brightness(at: EmissionPoint, dx: EmissionPoint, dy: EmissionPoint) -> f32 {
    let sense = sign(frame.hole.w);
    let root_cube = exp(1.5 * at.ln_r);
    let omega = sense / (root_cube + sense * frame.hole.x);
    let shear = -1.5 * root_cube * omega * omega * sense;
    // Azimuth fixed to the matter, and ln r, in texels.
    let right = vec2<f32>((dx.azimuth + omega * dx.delay) * TEXELS_AROUND, dx.ln_r * TEXELS_ACROSS);
    let down = vec2<f32>((dy.azimuth + omega * dy.delay) * TEXELS_AROUND, dy.ln_r * TEXELS_ACROSS);
    let sheared = shear * (TEXELS_AROUND / TEXELS_ACROSS);

    let left = clamp(1.0 + (at.ln_r - frame.turbulence.z) / PLUNGE_FADE, 0.0, 1.0);
    let place = at.ln_r / BAND;
    let border = floor(place + 0.5);
    let across = (place - border) * (2.0 / BAND_FADE);
    let blends = abs(across) < 1.0;
    let shares = sincos(0.25 * PI * (across + 1.0));
    // One band shows or two, of one generation or two: as many turns as are needed, since lavapipe runs whatever an
    // `if` leaves out.
    let first = i32(border) - select(1, 0, across >= 1.0);
    let bands = select(1u, 2u, blends);
    var exponent = 0.0;
    for (var k = 0u; k < bands; k += 1u) {
        let share = select(1.0, select(shares.y, shares.x, k == 1u), blends);
        let number = first + i32(k);
        let band = frame.bands[clamp(number - bitcast<i32>(frame.pattern.y), 0, i32(MOST_BANDS) - 1)];
        let spacing = bitcast<f32>(band.y);
        let since = bitcast<f32>(band.x) + (frame.turbulence.y - at.delay);
        let births = floor(since / spacing);
        let young = since - births * spacing;
        let generation = band.z + bitcast<u32>(i32(births));
        let grown = min(young / (GENERATION_FADE * spacing), 1.0);
        let fades = sincos(0.5 * PI * grown);
        let alive = select(1u, 2u, grown < 1.0);
        for (var old = 0u; old < alive; old += 1u) {
            let weight = share * select(1.0, select(fades.x, fades.y, old == 1u), alive == 2u);
            let age = young + f32(old) * spacing;
            let key = mix_bits(bitcast<u32>(number) + mix_bits(generation - old + frame.pattern.x));
            let from_seed = vec2<f32>(vec2<u32>(key & 0xffffu, key >> 16u)) / 65536.0;
            let shift = vec2<f32>(-sheared * age, 0.0);
            exponent += streak_exponent(
                frame.turbulence.x * left * weight,
                vec2<f32>((at.azimuth - omega * age) / TAU, at.ln_r / STREAK_PERIOD) + from_seed,
                right + shift * right.y,
                down + shift * down.y,
            );
        }
    }
    return exp(exponent);
}

fn mix_bits(bits: u32) -> u32 {
    var x = (bits ^ (bits >> 16u)) * 0x7feb352du;
    x = (x ^ (x >> 15u)) * 0x846ca68bu;
    return x ^ (x >> 16u);
}
