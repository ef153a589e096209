// The structure of the disk. Mirrors src/emit/turbulence.rs, where the reasons are. Knows no colours.

#import constants
#import records/record
#import shared/frame
#import shared/math

// The factor on the disk's radiance. dx, dy: the change of `at` to the next pixel.
fn turbulent_brightness(at: EmissionPoint, dx: EmissionPoint, dy: EmissionPoint) -> f32 {
    let since = frame.turbulence.y + (frame.turbulence.z - at.delay);
    let births = floor(since / (0.5 * LIFETIME));
    let generation = frame.pattern.y + bitcast<u32>(i32(births));
    let age = since - births * (0.5 * LIFETIME);
    let young = turbulent_octaves(generation, age, at, dx, dy);
    let old = turbulent_octaves(generation - 1u, age + 0.5 * LIFETIME, at, dx, dy);
    let factors = 1.0 + frame.turbulence.x * AMPLITUDES * clamp(young + old, vec4<f32>(-1.0), vec4<f32>(1.0));
    return factors.x * factors.y * factors.z * factors.w;
}

// The share of one generation in each octave.
fn turbulent_octaves(generation: u32, age: f32, at: EmissionPoint, dx: EmissionPoint, dy: EmissionPoint) -> vec4<f32> {
    let sense = sign(frame.hole.w);
    let root_cube = exp(1.5 * at.ln_r);
    let omega = sense / (root_cube + sense * frame.hole.x);
    let shear = -1.5 * root_cube * omega * omega * sense;
    let turn = (at.azimuth - omega * age) / TAU;
    let footprint = max(cells_across(dx, shear * age, omega), cells_across(dy, shear * age, omega));
    let weight = GAIN * sincos(PI * age / LIFETIME).x;
    var shares = vec4<f32>(0.0);
    for (var i = 0u; i < 4u; i += 1u) {
        let finer = 1u << i;
        let key = mix_bits(i + mix_bits(generation + frame.pattern.x));
        let visible = clamp(2.0 - 2.0 * footprint * f32(finer), 0.0, 1.0);
        let along = at.ln_r * CELLS_PER_E_FOLD * f32(finer);
        shares[i] = weight * visible * gradient_noise(along, turn, CELLS_AROUND * finer, key);
    }
    return shares;
}

// Cells of the coarsest octave in a change of place.
fn cells_across(d: EmissionPoint, sheared: f32, omega: f32) -> f32 {
    let turn = (d.azimuth - sheared * d.ln_r + omega * d.delay) / TAU;
    let x = abs(d.ln_r * CELLS_PER_E_FOLD);
    let y = abs(turn * f32(CELLS_AROUND));
    // length() would not do: a square may overflow.
    let most = max(max(x, y), 1e-30);
    return most * length(vec2<f32>(x, y) / most);
}

fn mix_bits(bits: u32) -> u32 {
    var x = (bits ^ (bits >> 16u)) * 0x7feb352du;
    x = (x ^ (x >> 15u)) * 0x846ca68bu;
    return x ^ (x >> 16u);
}

fn gradient_noise(along: f32, turns: f32, around: u32, key: u32) -> f32 {
    let x = along + f32(key & 0xffffu) / 65536.0;
    let turn = turns + f32(key >> 16u) / 65536.0;
    let y = (turn - floor(turn)) * f32(around);
    let column = floor(x);
    let row = min(u32(y), around - 1u);
    let d = vec2<f32>(x - column, y - f32(row));
    let first = bitcast<u32>(i32(column));
    let here = mix_bits(row + key);
    let next = mix_bits((row + 1u) % around + key);
    let s = d * d * d * (d * (d * 6.0 - 15.0) + 10.0);
    let low = mix(slope(first + here, d), slope(first + 1u + here, d - vec2<f32>(1.0, 0.0)), s.x);
    let high = mix(slope(first + next, d - vec2<f32>(0.0, 1.0)), slope(first + 1u + next, d - 1.0), s.x);
    return mix(low, high, s.y);
}

// The gradient of a corner, times the offset from it.
fn slope(corner: u32, offset: vec2<f32>) -> f32 {
    let h = mix_bits(corner);
    return dot(vec2<f32>(f32(h & 0xffffu), f32(h >> 16u)) / 32767.5 - 1.0, offset);
}
