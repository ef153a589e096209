// SPDX-License-Identifier: MIT OR Apache-2.0
//! Primaries of light: where red, green, blue and white lie, and the matrices from one set to another. Knows no pixels
//! and no files.

use glam::{DMat3, DVec3};

/// Chromaticities that differ by less in each number are taken for the same: files round them.
const SAME_PRIMARIES: f64 = 0.002;
/// Numbers of a matrix at most. Real primaries have fewer; those of CIE XYZ have 3.3.
const MAX_FACTOR: f64 = 64.0;

/// Places of red, green, blue and white in the CIE 1931 diagram, x and y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Primaries(pub [[f64; 2]; 4]);

const D65: [f64; 2] = [0.3127, 0.329];

impl Primaries {
    pub const REC709: Self = Self([[0.64, 0.33], [0.3, 0.6], [0.15, 0.06], D65]);
    /// ITU-R BT.2020 and BT.2100.
    pub const REC2020: Self = Self([[0.708, 0.292], [0.17, 0.797], [0.131, 0.046], D65]);

    /// SMPTE EG 432-1, with the white of Rec. 709.
    pub const P3_D65: Self = Self([[0.68, 0.32], [0.265, 0.69], [0.15, 0.06], D65]);
    /// ACES's AP1 (S-2014-004).
    pub const AP1: Self = Self([[0.713, 0.293], [0.165, 0.83], [0.128, 0.044], [0.32168, 0.33767]]);

    /// Whether these are the same, as files round them.
    pub fn is_near(self, other: Self) -> bool {
        let pairs = self.0.as_flattened().iter().zip(other.0.as_flattened());
        pairs.into_iter().all(|(a, b)| (a - b).abs() < SAME_PRIMARIES)
    }

    /// Rows of the matrix from light of these primaries to light of Rec. 709.
    pub fn rows_to_rec709(self) -> [[f64; 3]; 3] {
        self.to_rec709().ok().flatten().unwrap_or(DMat3::IDENTITY).transpose().to_cols_array_2d()
    }

    /// Rows of the matrix from light of Rec. 709 to light of these primaries; white stays white.
    pub fn rows_from_rec709(self) -> [[f64; 3]; 3] {
        let to_rec709 = self.to_rec709().ok().flatten().unwrap_or(DMat3::IDENTITY);
        to_rec709.inverse().transpose().to_cols_array_2d()
    }

    /// Light of these primaries to light of Rec. 709; white stays white. `None`: they are the same. Errors: `()` for
    /// places that no three lights and their white have.
    pub fn to_rec709(self) -> std::result::Result<Option<DMat3>, ()> {
        if self.is_near(Self::REC709) {
            return Ok(None);
        }
        let to_xyz = self.to_xyz().ok_or(())?;
        from_xyz(to_xyz, self.white()).map(Some).ok_or(())
    }

    fn white(self) -> DVec3 {
        xyz(self.0[3]) / self.0[3][1]
    }

    /// Columns: red, green and blue, as much of each as makes white, whose Y is 1.
    fn to_xyz(self) -> Option<DMat3> {
        let [r, g, b, _] = self.0.map(xyz);
        let lights = DMat3::from_cols(r, g, b);
        let shares = lights.inverse() * self.white();
        let scaled = lights * DMat3::from_diagonal(shares);
        (lights.determinant().abs() > 1e-6 && shares.min_element() > 0.0 && is_sound(scaled)).then_some(scaled)
    }
}

fn xyz([x, y]: [f64; 2]) -> DVec3 {
    DVec3::new(x, y, 1.0 - x - y)
}

fn is_sound(matrix: DMat3) -> bool {
    matrix.to_cols_array().iter().all(|number| number.abs() <= MAX_FACTOR)
}

/// Light in CIE XYZ as it is when the white `from` has become `to`, as Bradford has it (Lam 1985, as in ICC.1:2022,
/// annex E).
fn adapted(from: DVec3, to: DVec3) -> DMat3 {
    // The answers of three kinds of cones, sharpened, by rows.
    const BRADFORD: [[f64; 3]; 3] = [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]];
    let cones = DMat3::from_cols_array_2d(&BRADFORD).transpose();
    cones.inverse() * DMat3::from_diagonal((cones * to) / (cones * from)) * cones
}

/// Lights given in CIE XYZ, by columns, to Rec. 709, whose white takes the place of `white`. `None` where numbers are
/// not finite or too large for colours, and where the three lights do not span a space.
pub fn from_xyz(lights: DMat3, white: DVec3) -> Option<DMat3> {
    let rec709 = Primaries::REC709.to_xyz()?.inverse();
    let matrix = rec709 * adapted(white, Primaries::REC709.white()) * lights;
    (lights.determinant().abs() > 1e-6 && is_sound(matrix)).then_some(matrix)
}

/// Light of Rec. 709 as it is when `white`, given in CIE XYZ with a Y of 1, has become the white of Rec. 709: a matrix
/// by columns. `None` as for `from_xyz`.
pub fn white_balance(white: [f64; 3]) -> Option<[[f64; 3]; 3]> {
    from_xyz(Primaries::REC709.to_xyz()?, white.into()).map(|matrix| matrix.to_cols_array_2d())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// B. Lindbloom's table of Bradford's adaptation between CIE illuminants, by rows, and its whites (ASTM E308).
    #[test]
    fn adaptation_is_that_of_the_published_matrices() {
        let d65 = [0.95047, 1.0, 1.08883];
        let published = [
            (
                [1.09850, 1.0, 0.35585],
                [
                    [0.8446965, -0.1179225, 0.3948108],
                    [-0.1366303, 1.1041226, 0.1291718],
                    [0.0798489, -0.1348999, 3.1924009],
                ],
            ),
            (
                [0.96422, 1.0, 0.82521],
                [
                    [0.9555766, -0.0230393, 0.0631636],
                    [-0.0282895, 1.0099416, 0.0210077],
                    [0.0122982, -0.0204830, 1.3299098],
                ],
            ),
        ];
        for (white, rows) in published {
            let ours = adapted(white.into(), d65.into()).transpose().to_cols_array();
            for (ours, theirs) in ours.iter().zip(rows.as_flattened()) {
                assert!((ours - theirs).abs() < 1e-6, "{white:?}: {ours}, not {theirs}");
            }
        }
    }
}
