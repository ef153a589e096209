// SPDX-License-Identifier: MIT OR Apache-2.0
// The structure of the disk. Mirrors src/emit/turbulence.rs, where the reasons are. Knows no colours.

#import constants
#import emit/bands
#import emit/moment
#import emit/streaks
#import records/record
#import shared/frame
#import shared/math

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
    let along_right = abs(right.y) >= abs(down.y);
    let cut = select(down, right, along_right);
    let other = select(right, down, along_right);
    let apart = part_of_side(cut, other);

    let left = clamp(1.0 + (at.ln_r - frame.turbulence_fades_inside) / PLUNGE_FADE, 0.0, 1.0);
    let beside = select(0.0, apart * cut.y / TEXELS_ACROSS, apart > 0.0);
    // One band shows or two, of one generation or two: as many turns as are needed, since lavapipe runs whatever an
    // `if` leaves out.
    let shown = bands_at(at.ln_r + vec3<f32>(-beside, 0.0, beside));
    var exponents = vec3<f32>(0.0);
    for (var k = 0u; k < shown.count; k += 1u) {
        let number = shown.first + i32(k);
        let band = frame.bands[band_index(number, frame.first_band)];
        let alive = generations(band, frame.turbulence_delay - at.delay + moment);
        for (var old = 0u; old < alive.count; old += 1u) {
            let weight = select(alive.weights.x, alive.weights.y, old == 1u);
            let age = alive.young + f32(old) * band.spacing;
            let key = generation_key(number, alive.youngest - old, frame.pattern_seed);
            let from_seed = vec2<f32>(vec2<u32>(key & 0xffffu, key >> 16u)) / 65536.0;
            let shift = vec2<f32>(-sheared * age, 0.0);
            exponents += streak_exponents(
                frame.turbulence_strength * left * weight * band_weights(shown, k == 1u),
                vec2<f32>((at.azimuth - omega * age) / TAU, at.ln_r / STREAK_PERIOD) + from_seed,
                apart,
                cut + shift * cut.y,
                other + shift * other.y,
            );
        }
    }
    return dot(exp(exponents), vec3<f32>(1.0 / 3.0));
}

// How far the middles of a pixel's three parts are from each other, as a share of its side `cut`. A pixel that is
// small, or of unknown size, has one part: 0. Sides in texels.
fn part_of_side(cut: vec2<f32>, other: vec2<f32>) -> f32 {
    let across = abs(cut.y);
    let size = max(across, 0.5 * max(abs(cut.x), abs(other.x)));
    // False where the side is no number.
    let large = size > LARGE_PIXEL && dot(cut, cut) < STREAK_WHOLE;
    return select(0.0, min(1.0 / 3.0, BAND / 3.0 * TEXELS_ACROSS / max(across, 1e-30)), large);
}
