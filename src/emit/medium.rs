// SPDX-License-Identifier: MIT OR Apache-2.0
//! The matter that a ray passes between two crossings of the plane, summed up: the light that it sends to the observer
//! and the share of the light from behind that it lets through. Knows no kind of matter.

use super::glow::Coefficients;
use crate::physics::quadrature::{GAUSS_BEFORE, GAUSS_WEIGHTS};
use crate::physics::trace::CROSSINGS_KEPT;
use arrayvec::ArrayVec;

/// A stretch of a ray, from the observer's end of it to the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    /// The light that leaves the observer's end of the stretch, linear Rec. 709 as the camera measures it.
    pub light: [f64; 3],
    /// The share of the light from behind that passes, 0 .. 1.
    pub through: f64,
    /// Its optical depth; kept besides, because `through` vanishes.
    pub depth: f64,
    /// I_nu that leaves the observer's end, at the camera's frequency (`Coefficients::intensity`).
    pub intensity: f64,
}

/// A stretch with nothing in it.
impl Default for Medium {
    fn default() -> Self {
        Self { light: [0.0; 3], through: 1.0, depth: 0.0, intensity: 0.0 }
    }
}

impl Medium {
    /// Adds matter behind what is there already, of which the coefficients are known at the three nodes of
    /// Gauss-Legendre quadrature, each as if all of the stretch were as it is there (`Coefficients::along`).
    ///
    /// Where the stretch is thin the optical depth in front of each node is the integral of the polynomial through all
    /// three, as in Kuntzmann's and Butcher's method (Butcher 1964; Hairer, Norsett & Wanner, Solving ODEs I, table
    /// II.7.4), so that light is right to the sixth order. Where it is thick that would not hold: there each node
    /// stands for an even layer, which is right for any depth, to the second order.
    pub fn add_nodes(&mut self, nodes: &[Coefficients; 3]) {
        let depths = [0, 1, 2].map(|i| nodes[i].absorption);
        let depth: f64 = (0..3).map(|i| GAUSS_WEIGHTS[i] * depths[i]).sum();
        let gains = if depth < THICK { thin_gains(depths) } else { layer_gains(depths) };
        for (node, gain) in nodes.iter().zip(gains) {
            let seen = self.through * gain;
            (0..3).for_each(|c| self.light[c] += seen * node.light[c]);
            self.intensity += seen * node.intensity;
        }
        self.through *= (-depth).exp();
        self.depth += depth;
    }
}

impl Medium {
    /// Adds an even layer behind what is there already.
    pub fn add_layer(&mut self, layer: &Coefficients) {
        let depth = layer.absorption;
        let seen = self.through * own_share(depth);
        (0..3).for_each(|c| self.light[c] += seen * layer.light[c]);
        self.intensity += seen * layer.intensity;
        self.through *= (-depth).exp();
        self.depth += depth;
    }
}

/// (1 - e^-t) / t: the share of its light that leaves an even layer of the optical depth t.
pub(crate) fn own_share(t: f64) -> f64 {
    if t > 1e-5 { -(-t).exp_m1() / t } else { 1.0 - 0.5 * t }
}

/// The stretch whose optical depth is larger is summed in layers.
pub(crate) const THICK: f64 = 2.0;

/// The share of each node's light that leaves a stretch, weights included; `depths`: of the whole stretch, if it were
/// as at the node.
pub(crate) fn thin_gains(depths: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| {
        let before: f64 = (0..3).map(|k| GAUSS_BEFORE[i][k] * depths[k]).sum();
        GAUSS_WEIGHTS[i] * (-before.max(0.0)).exp()
    })
}

/// The share of each node's light that leaves a stretch, each node being an even layer of its weight: of a layer's own
/// light (1 - e^-t) / t leaves it.
pub(crate) fn layer_gains(depths: [f64; 3]) -> [f64; 3] {
    let mut through = 1.0;
    [0, 1, 2].map(|i| {
        let t = GAUSS_WEIGHTS[i] * depths[i];
        let gain = GAUSS_WEIGHTS[i] * through * own_share(t);
        through *= (-t).exp();
        gain
    })
}

/// All media of a ray as one, nothing being at the crossings between them.
pub fn media_in_order(media: &[Medium]) -> Medium {
    media.iter().fold(Medium::default(), |front, back| Medium {
        light: [0, 1, 2].map(|c| front.light[c] + front.through * back.light[c]),
        through: front.through * back.through,
        depth: front.depth + back.depth,
        intensity: front.intensity + front.through * back.intensity,
    })
}

/// The medium before each kept crossing of a ray, then the one behind the last.
pub type Media = ArrayVec<Medium, { CROSSINGS_KEPT + 1 }>;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::quadrature::GAUSS_NODES;

    /// The error of cells of matter that grows denser falls with the sixth power of their size, and thick cells go on
    /// where thin ones end.
    #[test]
    fn nodes_are_right_to_the_sixth_order() {
        // Absorption 1 + x, and a source that waves, over a length of 1.5.
        let at = |x: f64| (1.0 + x, (1.0 + x) * (1.0 + (4.0 * x).sin()));
        let seen = |cells: u32| {
            let mut medium = Medium::default();
            let size = 1.5 / f64::from(cells);
            for i in 0..cells {
                medium.add_nodes(&GAUSS_NODES.map(|node| {
                    let (absorption, intensity) = at((f64::from(i) + node) * size);
                    Coefficients { light: [intensity; 3], intensity, absorption }.along(size)
                }));
            }
            assert!((medium.depth - 2.625).abs() < 1e-12 && (medium.through - (-2.625_f64).exp()).abs() < 1e-13);
            assert!((medium.light[2] - medium.intensity).abs() < 1e-15);
            medium.intensity
        };
        let exact = seen(400);
        let errors = [3, 6, 12].map(|n| (seen(n) - exact).abs());
        assert!(errors[0] / errors[1] > 30.0 && errors[1] / errors[2] > 30.0 && errors[2] < 1e-7, "{errors:?}");
        for depth in [1e-9, 0.4, THICK * 0.999, THICK * 1.001, 1e4, 1e30] {
            let mut medium = Medium::default();
            medium.add_nodes(&[Coefficients { light: [0.0; 3], intensity: 3.0 * depth, absorption: depth }; 3]);
            let expected = -3.0 * (-depth).exp_m1();
            assert!((medium.intensity / expected - 1.0).abs() < 2e-4, "{depth}: {medium:?}");
        }
    }
}
