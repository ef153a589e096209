// SPDX-License-Identifier: MIT OR Apache-2.0
//! Integrals over one step: Gauss-Legendre quadrature with three points. Knows nothing of what is integrated.

use std::ops::{Add, Div, Mul};

/// Nodes and weights of Gauss-Legendre quadrature over [0, 1] with three points.
pub(crate) const GAUSS_NODES: [f64; 3] = [0.112_701_665_379_258_31, 0.5, 0.887_298_334_620_741_7];
pub(crate) const GAUSS_WEIGHTS: [f64; 3] = [5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0];

/// The integrals from 0 to each node of the polynomials that are 1 at one node and 0 at the others: with the weights
/// the coefficients of the collocation method of order 6 (Butcher 1964, Math. Comp. 18, 50).
pub(crate) const GAUSS_BEFORE: [[f64; 3]; 3] = [
    [5.0 / 36.0, -0.035_976_667_524_938_92, 0.009_789_444_015_308_325],
    [0.300_263_194_980_864_6, 2.0 / 9.0, -0.022_485_417_203_086_82],
    [0.267_988_333_762_469_5, 0.480_421_111_969_383_35, 5.0 / 36.0],
];

/// The integral of `f` over [0, 1], f being a number or a vector: exact to the fifth degree.
pub fn gauss_legendre<T>(f: impl Fn(f64) -> T) -> T
where
    T: Add<Output = T> + Mul<f64, Output = T> + Div<f64, Output = T>,
{
    let offset = 0.6_f64.sqrt() / 2.0;
    (f(0.5 - offset) * 5.0 + f(0.5) * 8.0 + f(0.5 + offset) * 5.0) / 18.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    #[test]
    fn the_fifth_degree_is_exact() {
        let found = gauss_legendre(|x| DVec2::new(x.powi(5), 1.0 - 3.0 * x.powi(4)));
        assert!((found - DVec2::new(1.0 / 6.0, 0.4)).length() < 1e-15, "{found}");
        assert!((gauss_legendre(|x: f64| x.powi(6)) - 1.0 / 7.0).abs() > 1e-5);
    }

    /// The integral of a square up to each node, and to the end.
    #[test]
    fn polynomials_are_integrated_up_to_the_nodes() {
        let squares = GAUSS_NODES.map(|x| x * x);
        let sum = |weights: [f64; 3]| (0..3).map(|i| weights[i] * squares[i]).sum::<f64>();
        for (before, node) in GAUSS_BEFORE.into_iter().zip(GAUSS_NODES) {
            assert!((sum(before) - node.powi(3) / 3.0).abs() < 1e-16);
        }
        assert!((sum(GAUSS_WEIGHTS) - 1.0 / 3.0).abs() < 1e-16);
    }
}
