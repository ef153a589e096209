// SPDX-License-Identifier: MIT OR Apache-2.0
//! The densities of matter with depth, where they are not nothing, and the lengths over which they change. Plain
//! functions of numbers, lengths in M, c = cos th; knows no light and no motion.

use super::volume::{Shape, Volume};
use crate::physics::orbit::horizon_outer;

/// The edges of a disk, in its inner radius, between which it begins, and, in its outer radius, between which it ends.
pub const INNER_FADE: [f64; 2] = [0.9, 1.25];
pub const OUTER_FADE: [f64; 2] = [0.5, 1.0];

/// The greatest width in c over which structure changes.
pub const WIDEST: f64 = 0.35;
/// The heights in a jet and in its counterjet differ by twice this, so that they are not alike.
pub const OPPOSITE: f64 = 0.7;

/// A shape with its radii.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cloud {
    pub shape: Shape,
    pub inner: f64,
    pub outer: f64,
    pub radius: f64,
    /// The width of the Gaussian in R.
    pub width: f64,
    /// The width of the Gaussian in c.
    pub thickness: f64,
    pub opening: f64,
    pub slope: f64,
}

/// The ranges of 1/r, outer end first, and of |cos th| outside which a shape is nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    pub u: [f64; 2],
    pub cos: f64,
}

/// A stretch of a ray: 1/r and cos th at its ends, and the angle about the hole that it sweeps at most, rad.
#[derive(Clone, Copy, Debug)]
pub struct Stretch {
    pub u: [f64; 2],
    pub cos: [f64; 2],
    pub swept: f64,
}

/// The greatest changes over a cell, whatever the shape: of ln r, and of the angle about the hole, rad.
pub(crate) const CELL_LN_R: f64 = 0.5;
pub(crate) const CELL_ANGLE: f64 = 0.8;

/// 0 below `low`, 1 above `high`, 3 t^2 - 2 t^3 between.
pub fn smooth_step([low, high]: [f64; 2], x: f64) -> f64 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// e^(-x^2 / 2).
pub fn gaussian(x: f64) -> f64 {
    (-0.5 * x * x).exp()
}

/// n = (r / inner)^-slope e^(-(c / thickness)^2 / 2), faded out at both edges.
pub fn disk_density(r: f64, cos: f64, inner: f64, outer: f64, slope: f64, thickness: f64) -> f64 {
    let fade = smooth_step(INNER_FADE, r / inner) * (1.0 - smooth_step(OUTER_FADE, r / outer));
    fade * (r / inner).powf(-slope) * gaussian(cos / thickness)
}

/// n = e^(-((R - radius) / width)^2 / 2 - (z / (thickness radius))^2 / 2).
pub fn torus_density(r: f64, cos: f64, radius: f64, width: f64, thickness: f64) -> f64 {
    let sin = ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt();
    gaussian((r * sin - radius) / width) * gaussian(r * cos / (thickness * radius))
}

/// n = e^(-(r / radius)^2 / 2 - (c / thickness)^2 / 2), as in Gold et al. 2020 with thickness 1 / h.
pub fn halo_density(r: f64, cos: f64, radius: f64, thickness: f64) -> f64 {
    gaussian(r / radius) * gaussian(cos / thickness)
}

/// n = (r / radius)^-slope e^(-((|c| - cos psi) / thickness)^2 / 2), faded out at both edges as a disk is; the walls of
/// a parabola, R^2 ~ r: psi = opening sqrt(radius / r), but at most a right angle.
pub fn jet_density(r: f64, cos: f64, cloud: &Cloud) -> f64 {
    let fade = smooth_step(INNER_FADE, r / cloud.inner) * (1.0 - smooth_step(OUTER_FADE, r / cloud.outer));
    fade * (r / cloud.radius).powf(-cloud.slope)
        * gaussian((cos.abs() - jet_wall(r, cloud.opening, cloud.radius)) / cloud.thickness)
}

/// cos psi.
pub fn jet_wall(r: f64, opening: f64, radius: f64) -> f64 {
    (opening * (radius / r).sqrt()).min(std::f64::consts::FRAC_PI_2).cos()
}

impl Stretch {
    /// r and cos th halfway.
    pub fn middle(&self) -> [f64; 2] {
        [2.0 / (self.u[0] + self.u[1]), 0.5 * (self.cos[0] + self.cos[1])]
    }

    /// Its length, M, as if space were flat.
    pub fn length(&self) -> f64 {
        ((1.0 / self.u[0] - 1.0 / self.u[1]).powi(2) + (self.swept * self.middle()[0]).powi(2)).sqrt()
    }
}

impl Cloud {
    /// `isco`: that of the volume's matter, for inner edges that are not stated.
    pub fn new(volume: &Volume, isco: f64) -> Self {
        Self {
            shape: volume.shape,
            inner: if volume.inner_radius > 0.0 { volume.inner_radius } else { isco },
            outer: volume.outer_radius,
            radius: volume.radius,
            width: volume.width,
            thickness: volume.thickness,
            opening: volume.opening,
            slope: volume.slope,
        }
    }

    /// The density where 1/r = 1 / `r`.
    pub fn density(&self, r: f64, cos: f64) -> f64 {
        match self.shape {
            _ if r > self.outer => 0.0,
            Shape::Disk => disk_density(r, cos, self.inner, self.outer, self.slope, self.thickness),
            Shape::Torus => torus_density(r, cos, self.radius, self.width, self.thickness),
            Shape::Halo => halo_density(r, cos, self.radius, self.thickness),
            Shape::Jet => jet_density(r, cos, self),
        }
    }

    /// A coordinate across the shape that matter keeps while it moves, and its change with c: the distance from the
    /// plane, or from a jet's wall, in thicknesses, of which those of a shape that fills all latitudes are no wider
    /// than `WIDEST`.
    pub fn height(&self, r: f64, cos: f64) -> [f64; 2] {
        let thickness = self.thickness.min(WIDEST);
        let wall = |r: f64| jet_wall(r, self.opening, self.radius);
        match self.shape {
            Shape::Disk | Shape::Torus | Shape::Halo => [cos / thickness, 1.0 / thickness],
            Shape::Jet => [(cos.abs() - wall(r)) / thickness + OPPOSITE.copysign(cos), 1.0 / thickness],
        }
    }

    /// cos th in the middle of the shape at r: on the plane, or on the wall of the jet above it.
    pub fn middle_cos(&self, r: f64) -> f64 {
        if self.shape == Shape::Jet { jet_wall(r, self.opening, self.radius) } else { 0.0 }
    }

    /// The radius at which the temperature is the stated one.
    pub fn reference_radius(&self) -> f64 {
        match self.shape {
            Shape::Disk | Shape::Jet => self.inner,
            Shape::Torus | Shape::Halo => self.radius,
        }
    }

    /// Where Gaussians are at least `least`, about a hole of spin `spin`. `None`: all of it lies inside the horizon.
    pub fn reach(&self, spin: f64, least: f64) -> Option<Reach> {
        let horizon = horizon_outer(spin);
        let widths = (-2.0 * least.ln()).sqrt();
        let height = self.thickness * self.radius;
        let [low, high] = match self.shape {
            Shape::Disk | Shape::Jet => [INNER_FADE[0] * self.inner, self.outer],
            // A place of the ring's Gaussian has R and |z| below these.
            Shape::Torus => {
                let around = self.radius + widths * self.width;
                [(self.radius - widths * self.width).max(0.0), around.hypot(widths * height)]
            }
            Shape::Halo => [0.0, widths * self.radius],
        };
        let (low, high) = (low.max(horizon), high.min(self.outer));
        let cos = match self.shape {
            Shape::Disk | Shape::Halo => (widths * self.thickness).min(1.0),
            Shape::Torus => (widths * height / low).min(1.0),
            Shape::Jet => 1.0,
        };
        (low < high).then_some(Reach { u: [1.0 / high, 1.0 / low], cos })
    }

    /// The radii at which the density bends or jumps: the ends of the fading at its edges, the outer radius, and where
    /// a jet's wall leaves the plane. 0 for none.
    pub fn bends(&self) -> [f64; 5] {
        let [[begin, begun], [end, ended]] = [INNER_FADE.map(|x| x * self.inner), OUTER_FADE.map(|x| x * self.outer)];
        let wall = self.radius * (self.opening / std::f64::consts::FRAC_PI_2).powi(2);
        match self.shape {
            Shape::Disk => [begin, begun, end, ended, 0.0],
            Shape::Jet => [begin, begun, end, ended, wall],
            // Where they are cut off.
            Shape::Torus | Shape::Halo => [0.0, 0.0, 0.0, ended, 0.0],
        }
    }

    /// The number of cells that a stretch should be cut into: as many as the lengths over which density, temperature
    /// and Doppler shift change fit into it.
    pub fn cells(&self, stretch: &Stretch) -> f64 {
        let ([u, v], [c, d]) = (stretch.u, stretch.cos);
        let turns = (u / v).ln().abs() / CELL_LN_R + stretch.swept / CELL_ANGLE;
        let across = (d - c).abs();
        turns
            + match self.shape {
                Shape::Disk => across / (1.5 * self.thickness),
                Shape::Jet => {
                    let [near, far] = [u, v].map(|u| jet_wall(1.0 / u, self.opening, self.radius));
                    (across + (far - near).abs()) / self.thickness
                }
                Shape::Torus => {
                    let place = |u: f64, c: f64| [((1.0 - c * c).max(0.0)).sqrt() / u, c / u];
                    let ([a, z], [b, w]) = (place(u, c), place(v, d));
                    ((b - a) / (1.5 * self.width)).abs() + ((w - z) / (1.5 * self.thickness * self.radius)).abs()
                }
                Shape::Halo => across / (1.5 * self.thickness) + (1.0 / u - 1.0 / v).abs() / (1.5 * self.radius),
            }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::orbit::isco;

    fn shapes() -> Vec<Volume> {
        let disk = Volume { outer_radius: 40.0, thickness: 0.1, ..Volume::default() };
        [Shape::Disk, Shape::Torus, Shape::Halo, Shape::Jet].map(|shape| Volume { shape, ..disk }).to_vec()
    }

    /// Outside its reach a shape is nothing that shows, and its reach is no larger than it has to be.
    #[test]
    fn nothing_is_outside_the_reach() {
        for volume in shapes() {
            let cloud = Cloud::new(&volume, isco(0.5));
            let reach = cloud.reach(0.5, 1e-13).unwrap();
            let mut most = [0.0_f64; 2];
            for i in 0..400 {
                let r = 1.87 * 1.01_f64.powi(i);
                for k in -100..=100 {
                    let cos = f64::from(k) / 100.0;
                    let within = reach.u[0] * r <= 1.0 && reach.u[1] * r >= 1.0 && cos.abs() <= reach.cos;
                    let most = &mut most[usize::from(within)];
                    *most = most.max(cloud.density(r, cos));
                }
            }
            assert!(most[0] < 2e-13 && most[1] > 0.3, "{:?}: {most:?}", volume.shape);
        }
        let hidden = Volume { outer_radius: 1.5, inner_radius: 1.0, ..Volume::default() };
        assert_eq!(Cloud::new(&hidden, 6.0).reach(0.0, 1e-13), None);
    }

    /// Each shape is densest where it says: in the plane, on its ring, at the centre, on the cone's walls.
    #[test]
    fn shapes_are_where_they_say() {
        let [disk, torus, halo, jet] = [0, 1, 2, 3].map(|i| Cloud::new(&shapes()[i], 4.0));
        assert!((disk.density(8.0, 0.0) - 2.0_f64.powf(-0.7)).abs() < 1e-12);
        assert!((disk.density(8.0, 0.1) / disk.density(8.0, 0.0) - (-0.5_f64).exp()).abs() < 1e-12);
        assert!(disk.density(3.5, 0.0) == 0.0 && disk.density(41.0, 0.0) == 0.0);
        assert!((torus.density(8.0, 0.0) - 1.0).abs() < 1e-12);
        assert!((torus.density(10.0, 0.0) - (-0.5_f64).exp()).abs() < 1e-12);
        assert!((torus.density(8.0_f64.hypot(0.8), 0.8 / 8.0_f64.hypot(0.8)) - (-0.5_f64).exp()).abs() < 1e-12);
        assert!((halo.density(8.0, 0.1) - (-1.0_f64).exp()).abs() < 1e-12);
        for r in [8.0, 16.0] {
            let wall = (0.3 * (8.0_f64 / r).sqrt()).cos();
            for cos in [wall, -wall] {
                assert!((jet.density(r, cos) - (r / 8.0).powf(-0.7)).abs() < 1e-12, "{r} {cos}");
            }
            assert!(jet.density(r, 0.0) < 1e-10 && jet.density(r, 1.0) < jet.density(r, wall));
        }
    }

    /// The inner edge that is not stated is the ISCO of the matter.
    #[test]
    fn the_unstated_inner_edge_is_the_isco() {
        let edge = |volume: Volume| Cloud::new(&volume, 4.25).inner;
        assert_eq!(edge(Volume::default()), 4.25);
        assert_eq!(edge(Volume { inner_radius: 3.0, ..Volume::default() }), 3.0);
    }
}
