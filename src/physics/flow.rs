// SPDX-License-Identifier: MIT OR Apache-2.0
//! The motion of matter with depth, anywhere outside the horizon, and the frequency that it measures of light. Knows no
//! light's colour, no density and no tracer.
//!
//! A flow is stated by what the local ZAMO measures of it: v = (v_th, v_ph), its velocity along th and ph, and u_r, the
//! radial component of its four-velocity, in the ZAMO's orthonormal frame. Then U.U = -1 for any |v| < 1 and any u_r:
//! with gamma = sqrt((1 + u_r^2) / (1 - v^2)), U = (gamma, u_r, gamma v_th, gamma v_ph). None of the laws of motion
//! here has a v_th; bodies in free fall have one (`rain_motion`).
//!
//! `a` is the spin, Sg = r^2 + a^2 cos^2 th, Delta = r^2 - 2 r + a^2, A = (r^2 + a^2)^2 - Delta a^2 sin^2 th, the lapse
//! al = sqrt(Sg Delta / A), g_phph = A sin^2 th / Sg and the ZAMO's angular velocity om = 2 a r / A (Bardeen, Press &
//! Teukolsky 1972, eq. 2.1 to 2.5). Matter that moves towards -ph is that of the mirror image: a -> -a, ph -> -ph.

use super::geodesic::{Constants, State};
use super::orbit::{horizon_inner, horizon_outer, isco};

/// Squares of sin th below this are taken for it: nothing is divided by 0 on the axis, where no flow turns.
pub(crate) const LEAST_SIN2: f64 = 1e-24;

/// The metric at a place outside the horizon.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    pub r: f64,
    pub cos: f64,
    /// sin^2 th.
    pub sin2: f64,
    /// Sg.
    pub sigma: f64,
    pub delta: f64,
    /// A.
    pub big_a: f64,
    /// al.
    pub lapse: f64,
    /// sqrt(g_phph).
    pub around: f64,
}

impl Place {
    /// 1/r = `u`, outside the horizon; `cos` of theta.
    pub fn new(a: f64, u: f64, cos: f64) -> Self {
        Self::beside(a, [horizon_outer(a), horizon_inner(a)], u, cos)
    }

    /// A place at 1/r = `u` along a ray, whose constants know the radii of the horizons; `cos` of theta.
    pub fn on_ray(c: &Constants, u: f64, cos: f64) -> Self {
        Self::beside(c.a, [c.r_plus, c.r_minus], u, cos)
    }

    fn beside(a: f64, [r_plus, r_minus]: [f64; 2], u: f64, cos: f64) -> Self {
        let r = 1.0 / u;
        let sin2 = ((1.0 - cos) * (1.0 + cos)).max(LEAST_SIN2);
        let sum = r * r + a * a;
        let delta = (1.0 - r_plus * u) * (r - r_minus) * r;
        let big_a = sum * sum - delta * a * a * sin2;
        let sigma = r * r + (a * cos).powi(2);
        Self {
            r,
            cos,
            sin2,
            sigma,
            delta,
            big_a,
            lapse: (sigma * delta / big_a).sqrt(),
            around: (big_a * sin2 / sigma).sqrt(),
        }
    }

    /// om.
    pub fn omega(&self, a: f64) -> f64 {
        2.0 * a * self.r / self.big_a
    }
}

/// Light at a place as the ZAMO there measures it, in the units of `Constants::energy`.
#[derive(Clone, Copy, Debug)]
pub struct ZamoLight {
    /// Its frequency, (E - om L) / al.
    pub frequency: f64,
    /// Its momentum outwards, along ph and along th.
    pub radial: f64,
    pub azimuthal: f64,
    pub polar: f64,
    /// The square of its momentum across the radius.
    pub across2: f64,
}

impl ZamoLight {
    /// The light of the ray `c` where u' = `du` and (cos th)' = `turn`: rays are traced backward, so that the light's
    /// own momentum has p_r = u' / D with D = Delta / r^2, and p_th = (cos th)' / sin th. Across the radius it has
    /// ((Q + (L - a E)^2) - (a E sin th - L / sin th)^2) / Sg (Carter 1968), and the part along ph besides.
    pub fn new(c: &Constants, at: &Place, du: f64, turn: f64) -> Self {
        let l2 = c.angular_momentum * c.angular_momentum;
        let sin = at.sin2.sqrt();
        let polar2 = c.b - (c.a * c.energy * sin - c.angular_momentum / sin).powi(2);
        // Beside the axis, where (cos th)' / sin th is 0 / 0, it is no more than this.
        let polar_most = (polar2.max(0.0) / at.sigma).sqrt();
        Self {
            frequency: (c.energy - at.omega(c.a) * c.angular_momentum) / at.lapse,
            radial: du * at.r * at.r / (at.sigma * at.delta).sqrt(),
            azimuthal: c.angular_momentum / at.around,
            polar: (turn / (at.sin2 * at.sigma).sqrt()).clamp(-polar_most, polar_most),
            across2: polar_most * polar_most + l2 / (at.around * at.around),
        }
    }

    /// -p.U, the frequency that matter with `velocity` measures.
    ///
    /// By definition that is gamma nu - u_r p_r - gamma v.p, with p across the radius. Where matter and light both
    /// move inwards, or both outwards, the first two terms are close to each other near the horizon, and (with nu^2 =
    /// p_r^2 + p_across^2)
    ///
    /// ```text
    /// gamma nu - u_r p_r = ((1 + gamma^2 v^2) nu^2 + u_r^2 p_across^2) / (gamma nu + u_r p_r)
    /// ```
    ///
    /// has no difference in it.
    pub fn measured_by(&self, velocity: Velocity) -> f64 {
        let (Velocity { around, polar, radial }, gamma) = (velocity, velocity.gamma());
        let (time, along) = (gamma * self.frequency, radial * self.radial);
        let v2 = around * around + polar * polar;
        let square = (1.0 + gamma * gamma * v2) * self.frequency * self.frequency + radial * radial * self.across2;
        let outwards = if along > 0.0 { square / (time + along) } else { time - along };
        outwards - gamma * (around * self.azimuthal + polar * self.polar)
    }
}

/// The motion of matter as the local ZAMO measures it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Velocity {
    /// Along ph and along th, as velocities; matter is where both together lie within 1.
    pub around: f64,
    pub polar: f64,
    /// Outwards, the component of the four-velocity: any number.
    pub radial: f64,
}

impl Velocity {
    /// The Lorentz factor.
    fn gamma(self) -> f64 {
        let v2 = self.around * self.around + self.polar * self.polar;
        ((1.0 + self.radial * self.radial) / (1.0 - v2)).sqrt()
    }

    /// dph/dt of matter that moves so, about the hole of spin `a`.
    pub fn angular_velocity(self, a: f64, at: &Place) -> f64 {
        at.omega(a) + at.lapse * self.around / at.around
    }

    /// dr/dt of it.
    pub fn radial_velocity(self, at: &Place) -> f64 {
        at.lapse * self.radial / self.gamma() * (at.delta / at.sigma).sqrt()
    }
}

/// The laws of motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    /// On circles about the axis, and inside the ISCO inwards besides, mixed with free fall.
    ///
    /// The angular velocity at r is that of matter of the angular momentum l = -u_ph / u_t = `sub_keplerian` l_K in the
    /// plane, the same at all theta; l_K is that of the circular geodesic (Bardeen, Press & Teukolsky 1972, eq. 2.12,
    /// 2.13), inside the ISCO that of the ISCO. Inside, u^r = -sqrt(2 / (3 r_I)) (r_I / r - 1)^(3/2) (Cunningham 1975,
    /// ApJ 202, 788; `physics::plunge`). With `infall` = b both are mixed with matter that falls from rest at infinity
    /// without angular momentum: u^r -> (1 - b) u^r - b sqrt(2 r (r^2 + a^2)) / Sg, Omega -> (1 - b) Omega + b om.
    /// (Such mixtures: Pu, Akiyama & Asada 2016, ApJ 831, 4.)
    Keplerian { sub_keplerian: f64, infall: f64 },
    /// l = -u_ph / u_t = `l0` R^(3/2) / (1 + R), R = r sin th, without radial motion: the model of Gold et al. 2020
    /// (ApJ 897, 148).
    AngularMomentum { l0: f64 },
    /// Everything turns with one angular velocity dph/dt, counted along the matter's sense of motion. Where that would
    /// be faster than light there is no matter.
    Rigid { angular_velocity: f64 },
    /// Outwards from the stagnation surface r = `base`, inwards inside it, and round with the hole.
    ///
    /// The ZAMO measures the radial velocity `speed` (r^2 - base^2) / (r^2 + base^2), which passes from a fall through
    /// rest to `speed` far away, and the azimuthal one sqrt(1 - v_r^2) x / (1 + x^2), x = Omega_F sqrt(g_phph), with
    /// the angular velocity of field lines that Blandford & Znajek 1977 found to carry away most, Omega_F = a / (4 r+),
    /// half of the horizon's. So matter turns with the lines near the axis and as 1 / R outside their light cylinder,
    /// R = 1 / Omega_F; x / (1 + x^2) <= 1/2 keeps it slower than light everywhere. (A model in closed form. It has
    /// in outline what the jets of Broderick & Loeb 2009, ApJ 697, 1164, do.)
    Outflow { speed: f64, base: f64 },
}

/// The motion of one emitter's matter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flow {
    pub motion: Motion,
    /// +1: it moves towards +ph; -1: towards -ph.
    pub sense: f64,
    /// The ISCO of matter that moves so.
    pub isco: f64,
}

impl Flow {
    pub fn new(spin: f64, retrograde: bool, motion: Motion) -> Self {
        let sense = if retrograde { -1.0 } else { 1.0 };
        Self { motion, sense, isco: isco(sense * spin) }
    }

    /// The velocity of the matter at a place of the hole of spin `a`.
    pub fn velocity(&self, a: f64, at: &Place) -> Velocity {
        let spin = self.sense * a;
        let Velocity { around, polar, radial } = match self.motion {
            Motion::Keplerian { sub_keplerian, infall } => keplerian(spin, at, self.isco, sub_keplerian, infall),
            Motion::AngularMomentum { l0 } => with_angular_momentum(spin, at, l0),
            Motion::Rigid { angular_velocity } => {
                let around = at.around / at.lapse * (angular_velocity - at.omega(spin));
                Velocity { around, polar: 0.0, radial: 0.0 }
            }
            Motion::Outflow { speed, base } => outflow(spin, at, speed, base),
        };
        Velocity { around: self.sense * around, polar, radial }
    }

    /// The frequency that the matter measures of light; NaN or 0 where no matter can move so.
    pub fn frequency(&self, c: &Constants, at: &Place, light: &ZamoLight) -> f64 {
        light.measured_by(self.velocity(c.a, at))
    }
}

/// `Motion::Keplerian`, towards +ph.
pub fn keplerian(a: f64, at: &Place, isco: f64, sub_keplerian: f64, infall: f64) -> Velocity {
    if sub_keplerian == 1.0 && infall == 0.0 && at.r >= isco {
        // Circular geodesics: Omega is that of the plane (Bardeen, Press & Teukolsky 1972, equation 2.16). Most matter
        // has it, at half the cost of what follows.
        let around = 1.0 / (at.r * at.r.sqrt() + a);
        return Velocity { around: (around - at.omega(a)) * at.around / at.lapse, polar: 0.0, radial: 0.0 };
    }
    let orbit = at.r.max(isco);
    let root = orbit.sqrt();
    let l = sub_keplerian * (orbit * orbit - 2.0 * a * root + a * a) / (orbit * root - 2.0 * root + a);
    // A and om in the plane, and al^2 / g_phph = Delta r^4 / A^2 there.
    let (r2, a2) = (at.r * at.r, a * a);
    let equator = (r2 + a2) * (r2 + a2) - at.delta * a2;
    let ratio = at.delta * r2 * r2 / (equator * equator);
    let omega = 2.0 * a * at.r / equator;
    // Omega - om, in which om(equator) - om is written without the difference: near the horizon both vanish with Delta.
    let drag = 2.0 * a * at.r * at.delta * (a * at.cos).powi(2) / (at.big_a * equator);
    let over = drag + ratio * l / (1.0 - omega * l);
    let excess = (isco / at.r - 1.0).max(0.0);
    let plunge = -(2.0 / (3.0 * isco)).sqrt() * excess * excess.sqrt();
    let rain = -(2.0 * at.r * (at.r * at.r + a * a)).sqrt() / at.sigma;
    Velocity {
        around: (1.0 - infall) * over * at.around / at.lapse,
        polar: 0.0,
        radial: ((1.0 - infall) * plunge + infall * rain) * (at.sigma / at.delta).sqrt(),
    }
}

/// `Motion::AngularMomentum`, towards +ph. u_ph = -l u_t makes the ZAMO measure al l / (sqrt(g_phph) (1 - om l)).
pub fn with_angular_momentum(a: f64, at: &Place, l0: f64) -> Velocity {
    let axis = at.r * at.sin2.sqrt();
    let l = l0 * axis * axis.sqrt() / (1.0 + axis);
    Velocity { around: at.lapse * l / (at.around * (1.0 - at.omega(a) * l)), polar: 0.0, radial: 0.0 }
}

/// `Motion::Outflow`, the hole's spin `a` being counted along +ph.
pub fn outflow(a: f64, at: &Place, speed: f64, base: f64) -> Velocity {
    let (r2, base2) = (at.r * at.r, base * base);
    let outwards = speed * (r2 - base2) / (r2 + base2);
    let x = a / (4.0 * horizon_outer(a)) * at.around;
    let around = ((1.0 - outwards) * (1.0 + outwards)).sqrt() * x / (1.0 + x * x);
    // u_r = gamma v_r, with gamma of the whole velocity.
    Velocity { around, polar: 0.0, radial: outwards / (1.0 - outwards * outwards - around * around).sqrt() }
}

/// The state of a ray in terms of the place that it is at.
pub fn place_of(c: &Constants, there: &State) -> Place {
    Place::on_ray(c, there.u, there.n.z / there.n.length())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::metric::Kerr;
    use crate::physics::observer::LocalFrame;
    use crate::physics::orbit::{circular_orbit, redshift};
    use crate::physics::plunge::Plunge;
    use glam::DVec3;

    const SPINS: [f64; 7] = [0.0, 0.3, -0.5, 0.9, -0.9, 0.998, -0.998];
    const MOTIONS: [Motion; 8] = [
        Motion::Keplerian { sub_keplerian: 1.0, infall: 0.0 },
        Motion::Keplerian { sub_keplerian: 0.6, infall: 0.0 },
        Motion::Keplerian { sub_keplerian: 0.8, infall: 0.3 },
        Motion::Keplerian { sub_keplerian: 0.0, infall: 1.0 },
        Motion::AngularMomentum { l0: 1.0 },
        Motion::AngularMomentum { l0: 0.0 },
        Motion::Outflow { speed: 0.995, base: 3.0 },
        Motion::Outflow { speed: 0.5, base: 1.1 },
    ];

    /// U^t, U^r, U^th, U^ph of a velocity, by the ZAMO's tetrad.
    fn four_velocity(a: f64, at: &Place, velocity: Velocity) -> [f64; 4] {
        let Velocity { around, polar, radial } = velocity;
        let gamma = ((1.0 + radial * radial) / (1.0 - around * around - polar * polar)).sqrt();
        let time = gamma / at.lapse;
        let turn = time * at.omega(a) + gamma * around / at.around;
        [time, radial * (at.delta / at.sigma).sqrt(), gamma * polar / at.sigma.sqrt(), turn]
    }

    fn product(a: f64, at: &Place, u: [f64; 4], v: [f64; 4]) -> f64 {
        let g = Kerr { a }.metric(at.r, at.cos.acos());
        (0..4).flat_map(|i| (0..4).map(move |k| (i, k))).map(|(i, k)| g[i][k] * u[i] * v[k]).sum()
    }

    /// Places all over, from beside the horizon to far away, the axis among them.
    fn places(a: f64) -> impl Iterator<Item = Place> {
        let far = [1.0 + 1e-6, 1.001, 1.05, 1.4, 2.0, 3.3, 7.0, 40.0, 1e3, 1e5];
        let angles = [0.0, 0.01, -0.3, 0.6, -0.9, 0.999, 1.0];
        far.into_iter()
            .flat_map(move |r| angles.into_iter().map(move |cos| Place::new(a, 1.0 / (r * horizon_outer(a)), cos)))
    }

    #[test]
    fn every_flow_is_slower_than_light_everywhere() {
        for spin in SPINS {
            for (motion, retrograde) in MOTIONS.into_iter().flat_map(|m| [(m, false), (m, true)]) {
                let flow = Flow::new(spin, retrograde, motion);
                for at in places(spin) {
                    let velocity = flow.velocity(spin, &at);
                    assert!(velocity.around.abs() < 0.999 && velocity.radial.is_finite(), "{spin} {flow:?} {at:?}");
                    let u = four_velocity(spin, &at, velocity);
                    let rates = [velocity.radial_velocity(&at), velocity.angular_velocity(spin, &at)];
                    for (rate, expected) in rates.into_iter().zip([u[1] / u[0], u[3] / u[0]]) {
                        assert!((rate - expected).abs() < 1e-12 * (1.0 + expected.abs()), "{spin} {flow:?} {at:?}");
                    }
                    // The metric's terms cancel beside the horizon as 1 / Delta, and far away as r^2.
                    let scale = 1.0 + u.iter().map(|u| u * u).sum::<f64>();
                    let norm = product(spin, &at, u, u);
                    assert!((norm + 1.0).abs() < 1e-12 * scale, "{spin} {motion:?} {at:?}: {norm}");
                }
            }
        }
    }

    /// Against -p.U of the full metric, light of all kinds, and against the mirror image.
    #[test]
    fn frequencies_are_those_of_the_full_metric() {
        let mut compared = 0;
        for spin in SPINS {
            for motion in MOTIONS {
                for (r, theta) in [(30.0_f64, 1.3_f64), (6.5, 0.4), (2.3, 1.5), (9.0, 2.9)] {
                    let position = DVec3::new(r * theta.sin(), 0.0, r * theta.cos());
                    let frame = LocalFrame::new(spin, position).unwrap();
                    let mirror = LocalFrame::new(-spin, position).unwrap();
                    for i in 0..40 {
                        let turn = 2.4 * f64::from(i);
                        let cos = -1.0 + f64::from(i) / 19.75;
                        let sin = (1.0 - cos * cos).max(0.0).sqrt();
                        let n = DVec3::new(cos, sin * turn.cos(), sin * turn.sin());
                        let (c, state) = frame.start(n).unwrap();
                        let at = place_of(&c, &state);
                        let flow = Flow::new(spin, false, motion);
                        let velocity = flow.velocity(spin, &at);
                        let light = ZamoLight::new(&c, &at, state.du, state.dn.z);
                        let nu = flow.frequency(&c, &at, &light);
                        // The tetrad's momentum, -n of the local frame, in coordinates.
                        let (p, local) = (-n * c.nu_local, c.nu_local / at.lapse);
                        let root = [(at.delta / at.sigma).sqrt(), 1.0 / at.sigma.sqrt()];
                        let around = local * at.omega(spin) + p.z / at.around;
                        let p = [local, p.x * root[0], p.y * root[1], around];
                        let u = four_velocity(spin, &at, velocity);
                        let expected = -product(spin, &at, p, u);
                        assert!((nu / expected - 1.0).abs() < 1e-9, "{spin} {motion:?} {r}: {nu} {expected}");
                        for polar in [-0.3, 0.45] {
                            let tilted = Velocity { polar, around: 0.6 * velocity.around, ..velocity };
                            let nu = light.measured_by(tilted);
                            let expected = -product(spin, &at, p, four_velocity(spin, &at, tilted));
                            assert!((nu / expected - 1.0).abs() < 1e-9, "{spin} {tilted:?} {r}: {nu} {expected}");
                        }
                        let (c, state) = mirror.start(DVec3::new(n.x, n.y, -n.z)).unwrap();
                        let at = place_of(&c, &state);
                        let flow = Flow::new(-spin, true, motion);
                        let mirrored = flow.frequency(&c, &at, &ZamoLight::new(&c, &at, state.du, 0.0));
                        assert!((nu / mirrored - 1.0).abs() < 1e-12, "{spin} {motion:?} {r}: {nu} {mirrored}");
                        compared += 1;
                    }
                }
            }
        }
        assert_eq!(compared, 7 * 8 * 4 * 40);
    }

    /// Circular geodesics outside the ISCO, Cunningham's plunge inside it; frequencies of light in the plane too.
    #[test]
    fn keplerian_matter_in_the_plane_is_that_of_thin_disks() {
        let motion = Motion::Keplerian { sub_keplerian: 1.0, infall: 0.0 };
        for (spin, retrograde) in SPINS.into_iter().flat_map(|a| [(a, false), (a, true)]) {
            let flow = Flow::new(spin, retrograde, motion);
            let matter_spin = flow.sense * spin;
            let plunge = Plunge::new(spin, retrograde);
            let at_isco = circular_orbit(matter_spin, flow.isco).unwrap();
            for part in [0.02, 0.3, 0.7, 0.999, 1.001, 2.0, 40.0] {
                let horizon = horizon_outer(spin);
                let r = if part < 1.0 { horizon + (flow.isco - horizon) * part } else { flow.isco * part };
                let at = Place::new(spin, 1.0 / r, 0.0);
                let u = four_velocity(spin, &at, flow.velocity(spin, &at));
                let lower = |k: usize| {
                    let g = Kerr { a: spin }.metric(at.r, at.cos.acos());
                    (0..4).map(|i| g[k][i] * u[i]).sum::<f64>()
                };
                let orbit = circular_orbit(matter_spin, r.max(flow.isco)).unwrap_or(at_isco);
                let slack = 1e-10 * (1.0 + u[0]);
                assert!((-lower(0) - orbit.energy).abs() < slack, "{spin} {r}: energy {}", -lower(0));
                let l = flow.sense * lower(3);
                assert!((l - orbit.angular_momentum).abs() < slack * r, "{spin} {r}: {l}");
                for (l, q) in [(1.0, 4.0), (-2.0, 1.0), (0.3, 20.0), (0.0, 0.0)] {
                    let c = Constants::new(spin, 1.0, l, q, 1.3, 0.01);
                    let w = 1.0 - spin * (l - spin) / (r * r);
                    let square = w * w - c.horizon_function(1.0 / r) * c.b / (r * r);
                    if square < 0.0 {
                        continue;
                    }
                    for du in [square.sqrt(), -square.sqrt()] {
                        let nu = flow.frequency(&c, &at, &ZamoLight::new(&c, &at, du, 0.0));
                        let expected = match part < 1.0 {
                            true => plunge.frequency(&c, 1.0 / r, du),
                            false => 1.3 / redshift(spin, 1.0 / r, retrograde, 1.0, l, 1.3),
                        };
                        assert!((nu / expected - 1.0).abs() < 1e-9, "{spin} {r} {l}: {nu} {expected}");
                    }
                }
            }
        }
    }

    /// Matter that falls from rest at infinity has E = 1 and L = 0.
    #[test]
    fn rain_falls_from_rest() {
        let motion = Motion::Keplerian { sub_keplerian: 1.0, infall: 1.0 };
        for spin in SPINS {
            let flow = Flow::new(spin, false, motion);
            for at in places(spin).filter(|at| at.delta > 1e-3) {
                let u = four_velocity(spin, &at, flow.velocity(spin, &at));
                let g = Kerr { a: spin }.metric(at.r, at.cos.acos());
                let energy = -(g[0][0] * u[0] + g[0][3] * u[3]);
                let l = g[3][0] * u[0] + g[3][3] * u[3];
                assert!((energy - 1.0).abs() < 1e-9 && l.abs() < 1e-9 * at.r, "{spin} {at:?}: {energy} {l}");
            }
        }
    }

    /// Light that comes in from outside has a finite frequency for matter that falls, at the horizon itself.
    #[test]
    fn falling_matter_is_stable_beside_the_horizon() {
        for spin in SPINS {
            for (motion, cos) in MOTIONS[..4].iter().flat_map(|m| [(*m, 0.0), (*m, 0.35)]) {
                let flow = Flow::new(spin, false, motion);
                let c = Constants::new(spin, 1.0, 0.7, 3.0, 1.0, 0.01);
                let nu = |margin: f64| {
                    let u = 1.0 / (c.r_plus * (1.0 + margin));
                    let w = 1.0 - spin * (0.7 - spin) * u * u;
                    let du = -(w * w - c.horizon_function(u) * c.b * u * u).sqrt();
                    let at = Place::new(spin, u, cos);
                    flow.frequency(&c, &at, &ZamoLight::new(&c, &at, du, 0.0))
                };
                let [near, nearer] = [nu(1e-7), nu(1e-10)];
                assert!(near > 0.0 && near < 1e3, "{spin} {motion:?}: {near}");
                assert!((nearer / near - 1.0).abs() < 1e-3, "{spin} {motion:?}: {near} {nearer}");
            }
        }
    }

    /// Far away the jet has its stated speed; at its base it does not move outwards; it turns with the hole.
    #[test]
    fn the_outflow_accelerates_from_its_base() {
        for spin in [0.9, -0.9] {
            let flow = Flow::new(spin, false, Motion::Outflow { speed: 0.9, base: 4.0 });
            let far = flow.velocity(spin, &Place::new(spin, 1e-6, 0.9));
            assert!((far.radial - 0.9 / (1.0 - 0.81_f64).sqrt()).abs() < 1e-4, "{far:?}");
            let base = flow.velocity(spin, &Place::new(spin, 0.25, 0.9));
            assert!(base.radial.abs() < 1e-12 && base.around * spin > 0.0, "{base:?}");
            assert!(flow.velocity(spin, &Place::new(spin, 0.5, 0.9)).radial < 0.0);
        }
    }
}
