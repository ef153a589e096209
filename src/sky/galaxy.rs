// SPDX-License-Identifier: MIT OR Apache-2.0
//! Where the Milky Way's plane lies, and how stars crowd towards it: one law for the procedural field, for the mean
//! light of faint stars and for `shaders/sky/stars.wgsl`.

use super::catalogue::Star;
use glam::DVec3;

/// The galactic pole and, at right angles to it, galactic longitudes 0 and 90 degrees, in sky axes: rows of the matrix
/// of The Hipparcos and Tycho Catalogues (ESA SP-1200, 1997), volume 1, eq. 1.5.11.
pub const GALACTIC_POLE: DVec3 = DVec3::new(-0.867_666_135_7, -0.198_076_389_6, 0.455_983_795_0);
pub const GALACTIC_CENTRE: DVec3 = DVec3::new(-0.054_875_539_4, -0.873_437_104_7, -0.483_834_991_8);
pub const GALACTIC_EAST: DVec3 = DVec3::new(0.494_109_453_6, -0.444_829_594_3, 0.746_982_248_7);

/// Stars at a galactic latitude b relative to their mean over the sky, for `sine` = |sin b|: 2 in the plane, 1/2 at
/// the poles, 1 on average over the sphere. Of the real stars a share does so (`crowding`) and the rest is spread
/// evenly.
pub fn crowded_density(sine: f64) -> f64 {
    2.0 / ((1.0 + sine) * (1.0 + sine))
}

/// The |sin b| below which the share `share` of the stars of `crowded_density` lies: the inverse of the integral 2 s /
/// (1 + s).
pub fn crowded_sine(share: f64) -> f64 {
    share / (2.0 - share)
}

/// The share, 0 .. 1, of `stars` that follows `crowded_density` while the others are spread evenly, by the mean of the
/// density where they are: it is 1 for even spread, and 7 / 6, the mean of the density's square, if all follow it.
/// (0.7 for the catalogue.)
pub fn crowding(stars: &[Star]) -> f64 {
    let sum = stars.iter().map(|star| crowded_density(star.direction.dot(GALACTIC_POLE).abs())).sum::<f64>();
    // Without stars the share is 0.
    (6.0 * (sum / stars.len().max(1) as f64 - 1.0)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pole_is_where_it_belongs() {
        let (ra, dec) = (192.85948_f64.to_radians(), 27.12825_f64.to_radians());
        let pole = DVec3::new(dec.cos() * ra.cos(), dec.cos() * ra.sin(), dec.sin());
        assert!(pole.distance(GALACTIC_POLE) < 1e-7, "{}", pole.distance(GALACTIC_POLE));
        assert!(GALACTIC_CENTRE.cross(GALACTIC_EAST).distance(GALACTIC_POLE) < 1e-9);
        assert!(GALACTIC_CENTRE.dot(GALACTIC_EAST).abs() < 1e-9);
    }

    #[test]
    fn the_density_has_mean_1_and_its_integral_is_turned_round() {
        let steps = 10_000;
        let middle = |i: i32| (f64::from(i) + 0.5) / f64::from(steps);
        let moment =
            |power: i32| (0..steps).map(|i| crowded_density(middle(i)).powi(power)).sum::<f64>() / f64::from(steps);
        assert!((moment(1) - 1.0).abs() < 1e-8 && (moment(2) - 7.0 / 6.0).abs() < 1e-8);
        for share in [0.0, 0.2, 0.5, 0.9, 1.0] {
            let sine = crowded_sine(share);
            let below = (0..steps).map(|i| crowded_density(middle(i) * sine)).sum::<f64>() * sine / f64::from(steps);
            assert!((below - share).abs() < 1e-8, "{share}: {below}");
        }
    }
}
