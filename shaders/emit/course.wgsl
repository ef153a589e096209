// SPDX-License-Identifier: MIT OR Apache-2.0
// Where a ray is within a step, by dense output. Used by emit/layers.wgsl and emit/volumes.wgsl; knows no matter.

#import geodesic/geodesic
#import geodesic/integrator

// Dense output over a step: 1/r, N, and the values and slopes (times the step) of drag and delay at its ends.
struct StepCourse {
    u: Quintic,
    n_x: Quintic,
    n_y: Quintic,
    n_z: Quintic,
    drag: vec4<f32>,
    delay: vec4<f32>,
}

fn step_course(c: Constants, a: State, b: State, h: f32) -> StepCourse {
    let hh = h * h;
    let f = n_acceleration(c, a.n) * hh;
    let g = n_acceleration(c, b.n) * hh;
    // Slopes of drag and delay at both ends.
    let slopes = vec4<f32>(drag_slope(c, a), drag_slope(c, b), delay_slope(c, a), delay_slope(c, b)) * h;
    return StepCourse(
        quintic_of_u(c, a, b, h),
        quintic(a.n.x, a.dn.x * h, f.x, b.n.x, b.dn.x * h, g.x),
        quintic(a.n.y, a.dn.y * h, f.y, b.n.y, b.dn.y * h, g.y),
        quintic(a.n.z, a.dn.z * h, f.z, b.n.z, b.dn.z * h, g.z),
        vec4<f32>(a.drag, slopes.x, b.drag, slopes.y),
        vec4<f32>(a.delay, slopes.z, b.delay, slopes.w),
    );
}

fn drag_slope(c: Constants, s: State) -> f32 {
    if SPINNING && RAIN {
        return kerr_drag_rate(c, s.u, s.du);
    }
    return drag_rate(c, s.u);
}

fn delay_slope(c: Constants, s: State) -> f32 {
    if SPINNING && RAIN {
        return rain_delay_rate(c, s.u, s.du, s.n.z);
    }
    return delay_rate(c, s.u, s.n.z);
}

// Cubic Hermite interpolation: value and slope at 0, value and slope at 1. It keeps slopes even from step to step,
// without which rings would show (a clock that is linear within steps makes them).
fn cubic_at(ends: vec4<f32>, x: f32) -> f32 {
    let rise = ends.z - ends.x;
    return ends.x + x * (ends.y + x * (3.0 * rise - 2.0 * ends.y - ends.w + x * (ends.y + ends.w - 2.0 * rise)));
}
