// SPDX-License-Identifier: MIT OR Apache-2.0
// The structure of the disk. Mirrors src/emit/turbulence.rs, where the reasons are. Knows no colours.

#import constants
#import emit/bands
#import emit/streaks
#import records/record
#import shared/frame
#import shared/math

// Texels in a radian, and in an e-fold of the radius.
const TEXELS_AROUND: f32 = f32(STREAK_COLUMNS) / TAU;
const TEXELS_ACROSS: f32 = f32(STREAK_ROWS) / STREAK_PERIOD;

// The factor on the disk's radiance. dx, dy: the change of `at` to the next pixel.
fn turbulent_brightness(at: EmissionPoint, dx: EmissionPoint, dy: EmissionPoint) -> f32 {
    let sense = sign(frame.signed_isco);
    let root_cube = exp(1.5 * at.ln_r);
    let omega = sense / (root_cube + sense * frame.spin);
    let shear = -1.5 * root_cube * omega * omega * sense;
    // Azimuth fixed to the matter, and ln r, in texels.
    let right = vec2<f32>((dx.azimuth + omega * dx.delay) * TEXELS_AROUND, dx.ln_r * TEXELS_ACROSS);
    let down = vec2<f32>((dy.azimuth + omega * dy.delay) * TEXELS_AROUND, dy.ln_r * TEXELS_ACROSS);
    let sheared = shear * (TEXELS_AROUND / TEXELS_ACROSS);

    let left = clamp(1.0 + (at.ln_r - frame.turbulence_fades_inside) / PLUNGE_FADE, 0.0, 1.0);
    // One band shows or two, of one generation or two: as many turns as are needed, since lavapipe runs whatever an
    // `if` leaves out.
    let shown = bands_at(at.ln_r);
    var exponent = 0.0;
    for (var k = 0u; k < shown.count; k += 1u) {
        let number = shown.first + i32(k);
        let band = frame.bands[band_index(number, frame.first_band)];
        let alive = generations(band, frame.turbulence_delay - at.delay);
        for (var old = 0u; old < alive.count; old += 1u) {
            let weight = select(shown.shares.x, shown.shares.y, k == 1u)
                * select(alive.weights.x, alive.weights.y, old == 1u);
            let age = alive.young + f32(old) * band.spacing;
            let key = generation_key(number, alive.youngest - old, frame.pattern_seed);
            let from_seed = vec2<f32>(vec2<u32>(key & 0xffffu, key >> 16u)) / 65536.0;
            let shift = vec2<f32>(-sheared * age, 0.0);
            exponent += streak_exponent(
                frame.turbulence_strength * left * weight,
                vec2<f32>((at.azimuth - omega * age) / TAU, at.ln_r / STREAK_PERIOD) + from_seed,
                right + shift * right.y,
                down + shift * down.y,
            );
        }
    }
    return exp(exponent);
}
