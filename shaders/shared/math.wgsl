// SPDX-License-Identifier: MIT OR Apache-2.0
// Elementary functions whose error the lens can bear: drivers' sin, cos and atan2 may be as loose as 5e-4 (Vulkan's
// precision table). Used by every other file; knows nothing of them.

const PI: f32 = 3.14159265358979;
const TAU: f32 = 6.28318530717959;

// (sin x, cos x) to 2e-7 for |x| < 1e3: x - k pi/2 in two parts (Cody & Waite 1980), then the minimax polynomials for
// |x| <= pi/4 that Cephes uses (Moshier 1992).
fn sincos(x: f32) -> vec2<f32> {
    let k = round(x * 0.636619772367581);
    return sincos_quarters((x - k * 1.5703125) - k * 4.83826794897e-4, k);
}

// (sin, cos) of 2 pi part / whole, to 2e-7: quarters of the whole are taken off exactly where whole and part are
// pixels, f32 turns would round.
fn sincos_turn(part: f32, whole: f32) -> vec2<f32> {
    let k = round(4.0 * part / whole);
    return sincos_quarters((part - k * (0.25 * whole)) * (TAU / whole), k);
}

// (sin, cos) of y + k pi/2, where |y| <= pi/4 and k is a whole number.
fn sincos_quarters(y: f32, k: f32) -> vec2<f32> {
    let y2 = y * y;
    let s = y + y * y2 * (-1.6666654611e-1 + y2 * (8.3321608736e-3 - y2 * 1.9515295891e-4));
    let c = 1.0 - 0.5 * y2
        + y2 * y2 * (4.166664568298827e-2 + y2 * (-1.388731625493765e-3 + y2 * 2.443315711809948e-5));
    let quadrant = i32(k) & 3;
    let swapped = select(vec2<f32>(s, c), vec2<f32>(c, s), (quadrant & 1) == 1);
    let sign = vec2<f32>(select(1.0, -1.0, quadrant >= 2), select(1.0, -1.0, quadrant == 1 || quadrant == 2));
    return swapped * sign;
}

// atan2(y, x) in (-pi, pi] to 3e-7: atan on [0, tan(pi/8)] by the polynomial Cephes uses, the rest by symmetry. 0 at
// (0, 0).
fn arctan2(y: f32, x: f32) -> f32 {
    let ax = abs(x);
    let ay = abs(y);
    let low = min(ax, ay);
    let high = max(ax, ay);
    if high == 0.0 {
        return 0.0;
    }
    let ratio = low / high;
    let beyond = ratio > 0.4142135623731;
    let t = select(ratio, (ratio - 1.0) / (ratio + 1.0), beyond);
    let t2 = t * t;
    var angle = t + t * t2 * (-3.33329491539e-1
        + t2 * (1.99777106478e-1 + t2 * (-1.38776856032e-1 + t2 * 8.05374449538e-2)));
    angle += select(0.0, 0.785398163397448, beyond);
    angle = select(angle, 1.5707963267949 - angle, ay > ax);
    angle = select(angle, PI - angle, x < 0.0);
    return select(angle, -angle, y < 0.0);
}

// `angle` brought into [-pi, pi].
fn wrap_angle(angle: f32) -> f32 {
    return angle - TAU * round(angle / TAU);
}
