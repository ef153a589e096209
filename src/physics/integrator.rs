// SPDX-License-Identifier: MIT OR Apache-2.0
//! Steps of light and of bodies in Mino time: classic RK4, the embedded Dormand-Prince 5(4) pair, and the Nystrom
//! method of order 5 that the renderer uses; their common dense output; the step limit beside the horizon. Knows the
//! equations only through `geodesic`. Mirrored by `shaders/geodesic/integrator.wgsl`.

use super::geodesic::{Clock, Constants, State};
use super::quadrature::gauss_legendre;
use glam::{DVec2, DVec3};

/// A one-step method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Order 5, four evaluations a step (Nystrom 1925; Hairer, Norsett & Wanner, Solving ODEs I, II.14).
    Nystrom,
    /// The classic fourth-order Runge-Kutta method (Kutta 1901).
    Rk4,
    /// Dormand & Prince 1980, RK5(4)7M; the step carries an error estimate.
    DormandPrince,
}

/// The state after `h` (in tau), and the error estimate of an embedded method (0 for the others), relative to what
/// `error_norm` takes for 1.
pub fn step(method: Method, c: &Constants, s: &State, h: f64, with_delay: bool) -> (State, f64) {
    match method {
        Method::Nystrom => (nystrom_step(c, s, h, with_delay), 0.0),
        Method::Rk4 => (rk4_step(c, s, h), 0.0),
        Method::DormandPrince => dormand_prince_step(c, s, h),
    }
}

/// y weights of Nystrom's method at its first three nodes (the fourth's is 0), and y' weights at all four.
pub(crate) const B: [f64; 3] = [1.0 / 24.0, 25.0 / 84.0, 9.0 / 56.0];
pub(crate) const D: [f64; 4] = [1.0 / 24.0, 125.0 / 336.0, 27.0 / 56.0, 5.0 / 48.0];

/// Nystrom's method for y'' = f(y); without spin N turns evenly, which is exact. Drag and delay, z' = f(u, N), take
/// the weights of y', which keeps order 5.
#[inline]
pub fn nystrom_step(c: &Constants, s: &State, h: f64, with_delay: bool) -> State {
    let h2 = h * h;
    let f1 = c.u_acceleration(s.u);
    let u2 = s.u + 0.2 * h * s.du + h2 * f1 / 50.0;
    let f2 = c.u_acceleration(u2);
    let u3 = s.u + 2.0 / 3.0 * h * s.du + h2 * (7.0 * f2 - f1) / 27.0;
    let f3 = c.u_acceleration(u3);
    let u4 = s.u + h * s.du + h2 * (0.3 * f1 - 2.0 / 35.0 * f2 + 9.0 / 35.0 * f3);
    let f4 = c.u_acceleration(u4);
    let sum = |y: [f64; 4]| h * (D[0] * y[0] + D[1] * y[1] + D[2] * y[2] + D[3] * y[3]);
    let nodes = [s.u, u2, u3, u4];
    let (n, dn, n_z) = if c.a == 0.0 { turn_n(c, s, h) } else { nystrom_step_of_n(c, s, h) };
    let mut end = State {
        u: s.u + h * s.du + h2 * (B[0] * f1 + B[1] * f2 + B[2] * f3),
        du: s.du + sum([f1, f2, f3, f4]),
        n,
        dn,
        drag: s.drag,
        delay: s.delay,
    };
    if c.clock == Clock::Rain {
        if c.a != 0.0 || with_delay {
            let rain = rain_step(c, s, &end, h, with_delay);
            (end.drag, end.delay) = (end.drag + rain.x, end.delay + rain.y);
        }
        return end;
    }
    if c.a != 0.0 {
        end.drag += sum(nodes.map(|u| c.drag_rate(u)));
    }
    if with_delay {
        end.delay += sum(std::array::from_fn(|i| c.delay_rate(nodes[i], 0.0, n_z[i])));
    }
    end
}

/// N and N' after the step, and N_z at the nodes.
#[inline]
fn nystrom_step_of_n(c: &Constants, s: &State, h: f64) -> (DVec3, DVec3, [f64; 4]) {
    let h2 = h * h;
    let f1 = c.n_acceleration(s.n);
    let n2 = s.n + s.dn * (0.2 * h) + f1 * (h2 / 50.0);
    let f2 = c.n_acceleration(n2);
    let n3 = s.n + s.dn * (2.0 / 3.0 * h) + (f2 * 7.0 - f1) * (h2 / 27.0);
    let f3 = c.n_acceleration(n3);
    let n4 = s.n + s.dn * h + (f1 * 0.3 - f2 * (2.0 / 35.0) + f3 * (9.0 / 35.0)) * h2;
    let f4 = c.n_acceleration(n4);
    let n = s.n + s.dn * h + (f1 * B[0] + f2 * B[1] + f3 * B[2]) * h2;
    let dn = s.dn + (f1 * D[0] + f2 * D[1] + f3 * D[2] + f4 * D[3]) * h;
    (n, dn, [s.n.z, n2.z, n3.z, n4.z])
}

/// a = 0: N'' = -K N turns N by sqrt(K) h in the ray's plane. (N_z enters no rate then.)
#[inline]
fn turn_n(c: &Constants, s: &State, h: f64) -> (DVec3, DVec3, [f64; 4]) {
    let kappa = c.k.max(1e-300).sqrt();
    let (sin, cos) = (kappa * h).sin_cos();
    (s.n * cos + s.dn * (sin / kappa), s.dn * cos - s.n * (sin * kappa), [0.0; 4])
}

/// Drag and delay in Doran's chart over one step: their rates need u', which Nystrom stages do not have; Gauss-Legendre
/// on the dense output.
fn rain_step(c: &Constants, from: &State, to: &State, h: f64, with_delay: bool) -> DVec2 {
    // The dense output's slope is by the step.
    if h == 0.0 {
        return DVec2::ZERO;
    }
    let dense = Quintic::of_u(c, from, to, h);
    if c.a == 0.0 {
        let delay = gauss_legendre(|x| {
            let (u, du) = dense.at(x);
            c.delay_rate(u, du, 0.0)
        });
        return DVec2::new(0.0, h * delay);
    }
    let n_z = Quintic::of_n_z(c, from, to, h);
    let sum = gauss_legendre(|x| {
        let (u, du) = dense.at(x);
        DVec2::new(c.rain_drag_rate(u, du), if with_delay { c.delay_rate(u, du, n_z.at(x).0) } else { 0.0 })
    });
    sum * h + DVec2::new(c.rain_drag_boundary(to.u) - c.rain_drag_boundary(from.u), 0.0)
}

/// u, u', N, N', drag, delay as one vector, for the methods that treat the system as of first order.
type Vector = [f64; 10];

fn to_vector(s: &State) -> Vector {
    [s.u, s.du, s.n.x, s.n.y, s.n.z, s.dn.x, s.dn.y, s.dn.z, s.drag, s.delay]
}

fn from_vector(v: &Vector) -> State {
    State {
        u: v[0],
        du: v[1],
        n: DVec3::new(v[2], v[3], v[4]),
        dn: DVec3::new(v[5], v[6], v[7]),
        drag: v[8],
        delay: v[9],
    }
}

fn derivative(c: &Constants, v: &Vector) -> Vector {
    let s = from_vector(v);
    let f = c.n_acceleration(s.n);
    [
        s.du,
        c.u_acceleration(s.u),
        s.dn.x,
        s.dn.y,
        s.dn.z,
        f.x,
        f.y,
        f.z,
        if c.clock == Clock::Rain { c.rain_drag_rate(s.u, s.du) } else { c.drag_rate(s.u) },
        c.delay_rate(s.u, s.du, s.n.z),
    ]
}

/// The state of `end`, with the closed-form part of the drag since `begin`.
fn with_drag_boundary(c: &Constants, begin: &State, end: State) -> State {
    if c.clock == Clock::Coordinate || c.a == 0.0 {
        return end;
    }
    State { drag: end.drag + c.rain_drag_boundary(end.u) - c.rain_drag_boundary(begin.u), ..end }
}

/// y + h sum_i weights[i] k[i].
fn combine(y: &Vector, h: f64, weights: &[f64], k: &[Vector]) -> Vector {
    std::array::from_fn(|i| y[i] + h * weights.iter().zip(k).map(|(w, k)| w * k[i]).sum::<f64>())
}

pub fn rk4_step(c: &Constants, s: &State, h: f64) -> State {
    let y = to_vector(s);
    let k1 = derivative(c, &y);
    let k2 = derivative(c, &combine(&y, h, &[0.5], &[k1]));
    let k3 = derivative(c, &combine(&y, h, &[0.5], &[k2]));
    let k4 = derivative(c, &combine(&y, h, &[1.0], &[k3]));
    let end = combine(&y, h / 6.0, &[1.0, 2.0, 2.0, 1.0], &[k1, k2, k3, k4]);
    with_drag_boundary(c, s, from_vector(&end))
}

/// Stage weights, fifth-order weights (row 7 of the tableau: first same as last), and fifth minus fourth order.
const DP_STAGES: [&[f64]; 6] = [
    &[1.0 / 5.0],
    &[3.0 / 40.0, 9.0 / 40.0],
    &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
    &[19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0],
    &[9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0],
    &[35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];
const DP_ERROR: [f64; 7] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0];

pub fn dormand_prince_step(c: &Constants, s: &State, h: f64) -> (State, f64) {
    let y = to_vector(s);
    let mut k = [[0.0; 10]; 7];
    k[0] = derivative(c, &y);
    let mut end = y;
    for (i, weights) in DP_STAGES.iter().enumerate() {
        end = combine(&y, h, weights, &k[..=i]);
        k[i + 1] = derivative(c, &end);
    }
    let error = combine(&[0.0; 10], h, &DP_ERROR, &k);
    let end = with_drag_boundary(c, s, from_vector(&end));
    (end, error_norm(c, &end, &from_vector(&error)))
}

/// The effect of an error in each component on directions (rad) and radii (relative). The delay is left out: where it
/// is ill conditioned, beside the horizon, the step limit holds it.
fn error_norm(c: &Constants, s: &State, error: &State) -> f64 {
    // At the far end of a ray an error in u moves the escape: 1e-3 keeps that in proportion with the direction.
    let u_scale = s.u.abs() + 1e-3;
    (error.u.abs() / u_scale)
        .max(error.du.abs() / (c.scale * u_scale))
        .max(error.n.abs().max_element())
        .max(error.dn.abs().max_element() / c.scale)
        .max(error.drag.abs())
}

/// Largest step in tau at this state.
///
/// Outside, beside the horizon (u > 0.3 u+): k (u+ - u) / (|u'| + sqrt(|u''| (u+ - u))), which cannot overshoot u+:
/// drag and delay diverge there. k = 1.2 `h`, `h` being the step in sigma: rays that start or pass there lose no
/// accuracy; but at most 0.35, and not below 0.03, which gives 1e-10. For what leaves by rain time nothing diverges
/// there: `advance_limit` with 1.5 `h`, and with spin `relative_limit` with as much. Inside: `relative_limit`, as u is
/// large, and `advance_limit`, or, where W < 0, the limit above from the nearer horizon, because there x diverges at
/// both.
#[inline]
pub fn step_limit(c: &Constants, s: &State, h: f64) -> f64 {
    let u_plus = 1.0 / c.r_plus;
    if s.u <= 0.3 * u_plus {
        return f64::INFINITY;
    }
    let room_limit = |room: f64| {
        let curvature = c.u_acceleration(s.u).abs();
        (1.2 * h).clamp(0.03, 0.35) * room / (s.du.abs() + (curvature * room).sqrt())
    };
    if s.u >= u_plus {
        let inside = relative_limit(c, s, h);
        if c.radial_energy(s.u) >= 0.0 {
            return inside.min(advance_limit(c, s, 1.5 * h));
        }
        return inside.min(room_limit((s.u - u_plus).min((1.0 - c.r_minus * s.u).max(0.0) / c.r_minus)));
    }
    if c.clock == Clock::Rain && s.du < 0.0 {
        let advance = advance_limit(c, s, 1.5 * h);
        return if c.a == 0.0 { advance } else { advance.min(relative_limit(c, s, 1.5 * h)) };
    }
    room_limit(u_plus - s.u)
}

/// The step in tau over which x of what falls in (`Constants::advanced_rate`), and with it drag and delay, changes by
/// about the part `h` of itself: at the horizon x is 1 / W, where W may be next to nothing. No limit for light without
/// spin, whose W is 1.
#[inline]
fn advance_limit(c: &Constants, s: &State, h: f64) -> f64 {
    if c.a == 0.0 && c.mu2 == 0.0 {
        return f64::INFINITY;
    }
    let slope = 2.0 * c.a * (c.a * c.energy - c.angular_momentum) * s.u * s.du - c.u_acceleration(s.u);
    h * (c.radial_energy(s.u) - s.du) / slope.abs()
}

/// The step in tau over which u changes by about the part `h` of itself: `h` u / (|u'| + sqrt(|u''| u)).
#[inline]
pub fn relative_limit(c: &Constants, s: &State, h: f64) -> f64 {
    h * s.u / (s.du.abs() + (c.u_acceleration(s.u).abs() * s.u).sqrt())
}

/// Inside the horizon with u' from the first integral, u'^2 = W^2 - D (mu^2 + B u^2): its other terms grow so much
/// larger than E^2 there that what steps leave of their difference would make it another ray's. Between the horizons D
/// < 0, and u' < 0 of all that comes from outside: it turns nowhere.
#[inline]
pub fn held_inside(c: &Constants, s: State) -> State {
    if (c.a != 0.0 && c.clock == Clock::Coordinate) || s.du >= 0.0 || s.u * c.r_plus < 1.0 {
        return s;
    }
    State { du: -c.radial_speed_squared(s.u).max(0.0).sqrt(), ..s }
}

/// Quintic Hermite interpolation over one step: value, slope and curvature at both ends. Error O(h^6).
pub struct Quintic {
    coefficients: [f64; 6],
    h: f64,
}

impl Quintic {
    pub fn new(y0: f64, d0: f64, c0: f64, y1: f64, d1: f64, c1: f64, h: f64) -> Self {
        let (d0, d1, c0, c1) = (d0 * h, d1 * h, c0 * h * h, c1 * h * h);
        let rise = y1 - y0;
        Self {
            coefficients: [
                y0,
                d0,
                0.5 * c0,
                10.0 * rise - 6.0 * d0 - 4.0 * d1 - 1.5 * c0 + 0.5 * c1,
                -15.0 * rise + 8.0 * d0 + 7.0 * d1 + 1.5 * c0 - c1,
                6.0 * rise - 3.0 * (d0 + d1) - 0.5 * (c0 - c1),
            ],
            h,
        }
    }

    pub fn of_u(c: &Constants, from: &State, to: &State, h: f64) -> Self {
        Self::new(from.u, from.du, c.u_acceleration(from.u), to.u, to.du, c.u_acceleration(to.u), h)
    }

    pub fn of_n_z(c: &Constants, from: &State, to: &State, h: f64) -> Self {
        Self::new(from.n.z, from.dn.z, c.n_acceleration(from.n).z, to.n.z, to.dn.z, c.n_acceleration(to.n).z, h)
    }

    /// Value and slope (by tau) at the fraction `x` of the step.
    pub fn at(&self, x: f64) -> (f64, f64) {
        let k = &self.coefficients;
        let value = k[0] + x * (k[1] + x * (k[2] + x * (k[3] + x * (k[4] + x * k[5]))));
        let slope = k[1] + x * (2.0 * k[2] + x * (3.0 * k[3] + x * (4.0 * k[4] + x * 5.0 * k[5])));
        (value, slope / self.h)
    }

    /// The fraction in [0, 1] where the value is 0, for end values of opposite sign (or 0): Newton's method inside a
    /// shrinking bracket.
    pub fn root(&self) -> f64 {
        let rising = self.at(1.0).0 > self.coefficients[0];
        let (mut low, mut high) = (0.0, 1.0);
        let mut x = 0.5;
        for _ in 0..60 {
            let (value, slope) = self.at(x);
            if (value > 0.0) == rising {
                high = x
            } else {
                low = x
            }
            let newton = x - value / (slope * self.h);
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            if (next - x).abs() <= f64::EPSILON * 2.0 {
                return next;
            }
            x = next;
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::observer::LocalFrame;

    fn start(a: f64) -> (Constants, State) {
        let frame = LocalFrame::new(a, DVec3::new(9.0, 0.0, 4.0)).unwrap();
        frame.start(DVec3::new(-0.8, 0.3, -0.52).normalize()).unwrap()
    }

    fn integrate(method: Method, c: &Constants, s: State, tau: f64, n: usize) -> State {
        (0..n).fold(s, |s, _| step(method, c, &s, tau / n as f64, true).0)
    }

    /// Halving the step divides the error by 2^order.
    #[test]
    fn methods_have_their_order() {
        let (c, s) = start(0.9);
        let tau = 0.12;
        let truth = integrate(Method::Nystrom, &c, s, tau, 4000);
        let error = |method, n| {
            let e = integrate(method, &c, s, tau, n);
            (e.n - truth.n).length()
                + (e.u - truth.u).abs()
                + (e.drag - truth.drag).abs()
                + (e.delay - truth.delay).abs()
        };
        for (method, order) in [(Method::Nystrom, 5.0), (Method::Rk4, 4.0), (Method::DormandPrince, 5.0)] {
            let measured = (error(method, 12) / error(method, 24)).log2();
            assert!((measured - order).abs() < 0.5, "{method:?}: order {measured}");
        }
    }

    #[test]
    fn error_estimate_follows_the_error() {
        let (c, s) = start(0.5);
        let estimate = |h| step(Method::DormandPrince, &c, &s, h, true).1;
        let ratio = (estimate(0.02) / estimate(0.01)).log2();
        assert!(ratio > 4.0 && ratio < 6.0, "{ratio}");
    }

    #[test]
    fn quintic_reproduces_a_quintic_and_finds_its_root() {
        let f = |t: f64| 1.0 - 3.0 * t + t.powi(3) - 0.2 * t.powi(5);
        let d = |t: f64| -3.0 + 3.0 * t * t - t.powi(4);
        let c = |t: f64| 6.0 * t - 4.0 * t.powi(3);
        let h = 0.8;
        let q = Quintic::new(f(0.0), d(0.0), c(0.0), f(h), d(h), c(h), h);
        let (value, slope) = q.at(0.3);
        assert!((value - f(0.24)).abs() < 1e-14 && (slope - d(0.24)).abs() < 1e-13);
        assert!(f(q.root() * h).abs() < 1e-14);
    }

    /// u'^2 = E^2 + (a^2 E^2 - K) u^2 + 2 B u^3 - a^2 Q u^4 and |N| = 1 stay.
    #[test]
    fn first_integrals_are_kept() {
        let (c, s) = start(0.7);
        let e = integrate(Method::Nystrom, &c, s, 0.15, 400);
        let u = e.u;
        let squared = c.energy.powi(2) + u * u * (c.a2e2 - c.k + u * (2.0 * c.b - u * c.a * c.a * c.carter));
        assert!((e.du * e.du / squared - 1.0).abs() < 1e-10);
        assert!((e.n.length() - 1.0).abs() < 1e-12);
    }
}
