// SPDX-License-Identifier: MIT OR Apache-2.0
//! The glow of the Milky Way as a sky map, made at first use from an embedded picture of nested outlines
//! (`data/README.md`): smooth brightness from the picture, colour from the galactic longitude, and dust and star clouds
//! finer than the picture by noise that is always the same. Plausible, not measured; where things are is true to about
//! a degree.

use super::galaxy::{GALACTIC_CENTRE, GALACTIC_EAST, GALACTIC_POLE};
use super::index::{REFERENCE_SOLID_ANGLE, STAR_REFERENCE_RADIANCE};
use super::map::{GrowingMap, SkyMap};
use crate::allocate::collected;
use crate::error::{Error, Result};
use crate::image::file::decode_png;
use crate::physics::blackbody::BlackbodyTable;
use crate::random::mix;
use glam::{DMat3, DVec3, UVec3};
use std::f64::consts::{LN_10, PI, TAU};
use std::sync::OnceLock;

static HEIGHTS: &[u8] = include_bytes!("data/milky_way.png");

/// Outlines' numbers that the picture's code 255 stands for: 1 on the outermost outline, 5 on the innermost.
const HIGHEST: f64 = 6.0;
/// Texels of the map.
const MAP_SIZE: [u32; 2] = [2048, 1024];
/// Surface brightness at height 5, V magnitudes per square arc second: that of the bright star clouds (Leinert et al.
/// 1998, A&AS 127, 1, section 10: 20.5 to 21 with the faint stars). Towards 0 each height is this much fainter than the
/// next, and in the end nothing: 23.1 on the outermost outline, where an eye in the dark still tells the Milky Way from
/// the sky beside it.
const BRIGHTEST: f64 = 20.6;
const MAGNITUDES_A_HEIGHT: f64 = 0.42;
/// Display convention: the glow is this much brighter next to the stars than it is to the eye. A screen shows fewer
/// steps between its white and its black than a dark-adapted eye sees in the sky.
const MILKY_WAY_GAIN: f64 = 8.0;
/// Solid angle, sr.
const SQUARE_ARC_SECOND: f64 = (PI / 648_000.0) * (PI / 648_000.0);

/// Temperatures, K, of the light of the bulge, whose stars are K giants seen through some dust, and of the light far
/// from it.
const BULGE_TEMPERATURE: f64 = 3900.0;
const ARM_TEMPERATURE: f64 = 6300.0;
/// How much hotter or cooler the light of star clouds is where their noise is 1 or -1: young, hot stars make the bright
/// ones.
const CLOUD_HEAT: f64 = 0.28;
/// The reach of the bulge, rad.
const BULGE_RADIUS: f64 = 0.45;

/// Octaves of the dust, the cells of the first per radian, and how much smaller the cells of the next are, and its
/// amplitude.
const DUST_OCTAVES: usize = 6;
const DUST_CELLS: f64 = 7.0;
const DUST_FINER: f64 = 2.03;
const DUST_FAINTER: f64 = 0.76;
/// Magnitudes of extinction in the plane where the noise is 1, none where it is negative; rad: the layer's height.
/// (The true layer is half as high in the distance; what is near us reaches to 10 degrees.)
const DUST_DEPTH: f64 = 2.0;
const DUST_HEIGHT: f64 = 0.11;
/// Extinction at the primaries of Rec. 709, about 610, 550 and 465 nm, over that in V (Cardelli, Clayton & Mathis
/// 1989, R_V = 3.1).
const EXTINCTION: [f64; 3] = [0.88, 1.0, 1.24];
const DUST_SEED: u32 = 0x4d57;
/// Star clouds: octaves of noise, from cells of 4 degrees down to a quarter of one, and magnitudes by which the light
/// is brighter where the noise is 1 and fainter where it is -1.
const CLOUD_OCTAVES: usize = 5;
const CLOUD_CELLS: f64 = 14.0;
const CLOUD_FAINTER: f64 = 0.8;
const CLOUD_DEPTH: f64 = 0.5;
const CLOUD_SEED: u32 = 0x534b;

static SHARED: OnceLock<SkyMap> = OnceLock::new();

impl SkyMap {
    /// The Milky Way of this process, made at first use (0.1 to 0.3 s). Errors: OUT_OF_MEMORY.
    pub fn milky_way() -> Result<&'static Self> {
        let mut left = Drawing::begun()?;
        while let Some(drawing) = left {
            left = drawing.draw(u32::MAX)?;
        }
        SHARED.get().ok_or_else(|| Error::internal("the Milky Way is drawn, and is not there"))
    }
}

/// The Milky Way while it is drawn.
pub struct Drawing {
    way: MilkyWay,
    columns: Vec<Column>,
    map: GrowingMap,
}

impl Drawing {
    /// The drawing that [`SkyMap::milky_way`] waits for; `None`: it is complete. Errors: OUT_OF_MEMORY.
    pub fn begun() -> Result<Option<Self>> {
        if SHARED.get().is_some() {
            return Ok(None);
        }
        let (way, width) = (MilkyWay::decode()?, MAP_SIZE[0]);
        let columns = (0..width).map(|x| way.column((f64::from(x) + 0.5) / f64::from(width)));
        let columns = collected(columns, "the columns of the Milky Way")?;
        Ok(Some(Self { way, columns, map: GrowingMap::new(MAP_SIZE)? }))
    }

    /// Draws up to `rows` more rows. Returns what is left to draw; `None`: it is complete. Errors: OUT_OF_MEMORY.
    pub fn draw(mut self, rows: u32) -> Result<Option<Self>> {
        if !self.map.grow(&|y, out| self.way.row(&self.columns, y, out), rows)? {
            return Ok(Some(self));
        }
        SHARED.get_or_init(|| self.map.done());
        Ok(None)
    }
}

/// The picture, and the numbers that turn it into light.
struct MilkyWay {
    width: u32,
    height: u32,
    /// The picture's codes row by row, in `SkyMap`'s projection.
    codes: Vec<u8>,
    to_galactic: DMat3,
    colours: &'static BlackbodyTable,
    /// Luminance at height 5.
    brightest: f64,
}

/// Numbers that all texels of a column share: the picture's columns that it lies between, where, and cosine and sine of
/// the right ascension.
struct Column {
    between: [u32; 2],
    share: f64,
    right_ascension: [f64; 2],
}

/// Takes sky axes to galactic ones: +x towards the galactic centre, +z the galactic north pole.
fn equatorial_to_galactic() -> DMat3 {
    DMat3::from_cols(GALACTIC_CENTRE, GALACTIC_EAST, GALACTIC_POLE).transpose()
}

impl MilkyWay {
    fn decode() -> Result<Self> {
        let grey = decode_png(HEIGHTS)?;
        let codes = grey.pixels.as_bytes().iter().copied().step_by(4);
        Ok(Self {
            width: grey.width,
            height: grey.height,
            codes: collected(codes, "the picture of the Milky Way")?,
            to_galactic: equatorial_to_galactic(),
            colours: BlackbodyTable::shared(),
            brightest: brightest(),
        })
    }

    /// A row of the map.
    fn row(&self, columns: &[Column], y: u32, out: &mut [[f32; 3]]) {
        let v = (f64::from(y) + 0.5) / f64::from(MAP_SIZE[1]);
        let (sin_dec, cos_dec) = (PI * (0.5 - v)).sin_cos();
        let mut noise = RowNoise::new();
        for (column, out) in columns.iter().zip(out) {
            let outline_height = self.outline_height(column, v);
            if outline_height > 0.0 {
                let [cos_ra, sin_ra] = column.right_ascension;
                let towards = DVec3::new(cos_dec * cos_ra, cos_dec * sin_ra, sin_dec);
                *out = self.light(outline_height, self.to_galactic * towards, &mut noise).map(|c| c as f32);
            }
        }
    }

    fn column(&self, u: f64) -> Column {
        let x = u * f64::from(self.width) - 0.5;
        let left = x.floor();
        let wrapped = |x: f64| x.rem_euclid(f64::from(self.width)) as u32;
        let (sin_ra, cos_ra) = (TAU * (0.5 - u)).sin_cos();
        Column { between: [wrapped(left), wrapped(left + 1.0)], share: x - left, right_ascension: [cos_ra, sin_ra] }
    }

    /// The height between the outlines at a column and at v of the picture, bilinear.
    fn outline_height(&self, column: &Column, v: f64) -> f64 {
        let y = v * f64::from(self.height) - 0.5;
        let top = y.floor();
        let across = |y: f64| {
            let row = (y.max(0.0) as u32).min(self.height - 1) * self.width;
            let code = |x: u32| self.codes.get((row + x) as usize).copied().map_or(0.0, f64::from);
            let [low, high] = column.between.map(code);
            low + (high - low) * column.share
        };
        let (above, below) = (across(top), across(top + 1.0));
        (above + (below - above) * (y - top)) * HIGHEST / 255.0
    }

    /// Linear Rec. 709 radiance towards a galactic direction.
    fn light(&self, height: f64, galactic: DVec3, noise: &mut RowNoise) -> [f64; 3] {
        let clouds = noise.clouds(galactic);
        let radiance = self.brightest * steps(height) * (0.4 * LN_10 * CLOUD_DEPTH * clouds).exp();
        let from_centre = galactic.x.clamp(-1.0, 1.0).acos() / BULGE_RADIUS;
        let bulge = (-from_centre * from_centre).exp();
        let arms = ARM_TEMPERATURE * (CLOUD_HEAT * clouds.clamp(-2.0, 2.0)).exp();
        let temperature = arms + (BULGE_TEMPERATURE - arms) * bulge;
        let rgb = self.colours.shade(temperature, temperature);
        let magnitudes = noise.extinction(galactic);
        if magnitudes == 0.0 {
            return rgb.map(|v| radiance * v);
        }
        std::array::from_fn(|c| radiance * rgb[c] * (-0.4 * LN_10 * EXTINCTION[c] * magnitudes).exp())
    }
}

/// Luminance at a height between the outlines over that at height 5.
fn steps(height: f64) -> f64 {
    const LN_RATIO: f64 = 0.4 * MAGNITUDES_A_HEIGHT * LN_10;
    (LN_RATIO * height).exp_m1() / (LN_RATIO * 5.0).exp_m1()
}

/// Luminance at height 5, on the stars' scale.
fn brightest() -> f64 {
    let flux = 10.0_f64.powf(-0.4 * BRIGHTEST) / SQUARE_ARC_SECOND * REFERENCE_SOLID_ANGLE;
    MILKY_WAY_GAIN * STAR_REFERENCE_RADIANCE * flux
}

/// Dust and star clouds, which the picture does not have, for texels one after another along a row.
struct RowNoise {
    dust: Octaves<DUST_OCTAVES>,
    clouds: Octaves<CLOUD_OCTAVES>,
}

impl RowNoise {
    fn new() -> Self {
        Self { dust: Octaves::new(DUST_FAINTER, DUST_SEED), clouds: Octaves::new(CLOUD_FAINTER, CLOUD_SEED) }
    }

    /// V magnitudes of the dust.
    fn extinction(&mut self, galactic: DVec3) -> f64 {
        // The layer ends at 2 heights.
        let layer = ((-(galactic.z / DUST_HEIGHT).powi(2)).exp() - 0.02).max(0.0);
        if layer == 0.0 {
            return 0.0;
        }
        // Clouds are drawn out along the plane.
        let place = DVec3::new(galactic.x, galactic.y, 1.8 * galactic.z) * DUST_CELLS;
        DUST_DEPTH * layer * self.dust.at(place).max(0.0)
    }

    /// The noise of the star clouds.
    fn clouds(&mut self, galactic: DVec3) -> f64 {
        self.clouds.at(galactic * CLOUD_CELLS)
    }
}

/// Noise of `N` sizes, the cells of the first 1 wide, and of each the cell that was asked for last: places that follow
/// one another along a row mostly lie in the same one, and its random numbers take longer to find than all the rest.
struct Octaves<const N: usize> {
    fainter: f64,
    cells: [Cell; N],
}

impl<const N: usize> Octaves<N> {
    fn new(fainter: f64, seed: u32) -> Self {
        Self { fainter, cells: std::array::from_fn(|octave| Cell::new(mix(seed + octave as u32))) }
    }

    fn at(&mut self, mut place: DVec3) -> f64 {
        let mut noise = 0.0;
        let mut amplitude = 1.0;
        for cell in &mut self.cells {
            noise += amplitude * cell.value_noise(place + DVec3::splat(1024.0));
            amplitude *= self.fainter;
            place *= DUST_FINER;
        }
        noise
    }
}

/// A cell of a lattice of random numbers in [-1, 1], one at each point of whole coordinates.
struct Cell {
    key: u32,
    low: UVec3,
    /// The numbers at its corners, x fastest.
    corners: [f64; 8],
}

impl Cell {
    fn new(key: u32) -> Self {
        let low = UVec3::ZERO;
        Self { key, low, corners: corners(low, key) }
    }

    /// Smooth noise: the lattice's numbers, cubic between them. Coordinates are positive.
    fn value_noise(&mut self, at: DVec3) -> f64 {
        let low = at.as_uvec3();
        if low != self.low {
            *self = Self { key: self.key, low, corners: corners(low, self.key) };
        }
        let t = at - low.as_dvec3();
        let s = t * t * (DVec3::splat(3.0) - 2.0 * t);
        let between = |a: f64, b: f64, s: f64| a + (b - a) * s;
        let [a, b, c, d, e, f, g, h] = self.corners;
        let along_y = |a, b, c, d| between(between(a, b, s.x), between(c, d, s.x), s.y);
        between(along_y(a, b, c, d), along_y(e, f, g, h), s.z)
    }
}

/// The random numbers at the corners of a cell.
fn corners(low: UVec3, key: u32) -> [f64; 8] {
    // The key of a lattice point: the factors are odd and have no common pattern, so that each point has another key.
    let point = |x: u32, y: u32, z: u32| {
        x.wrapping_mul(0x9e37_79b1).wrapping_add(y.wrapping_mul(0x85eb_ca77)).wrapping_add(z.wrapping_mul(0xc2b2_ae3d))
    };
    let first = point(low.x, low.y, low.z).wrapping_add(key);
    std::array::from_fn(|corner| {
        let [i, j, k] = [0, 1, 2].map(|axis| corner as u32 >> axis & 1);
        f64::from(mix(first.wrapping_add(point(i, j, k)))) / 2_147_483_647.5 - 1.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::blackbody::LUMINANCE;

    fn towards(ra: f64, dec: f64) -> DVec3 {
        let (ra, dec) = (ra.to_radians(), dec.to_radians());
        DVec3::new(dec.cos() * ra.cos(), dec.cos() * ra.sin(), dec.sin())
    }

    fn seen(ra: f64, dec: f64) -> f64 {
        let d = towards(ra, dec);
        let patch = d.any_orthonormal_vector() * 0.03;
        let rgb = SkyMap::milky_way().unwrap().light(d, patch, d.cross(patch));
        (0..3).map(|c| LUMINANCE[c] * rgb[c]).sum()
    }

    /// J2000: the galactic centre, and Vega (l 67.4482, b 19.2372: SIMBAD).
    #[test]
    fn galactic_coordinates_are_right() {
        let galactic = equatorial_to_galactic();
        assert!((galactic * towards(266.404_996, -28.936_172) - DVec3::X).length() < 1e-5);
        let vega = galactic * towards(279.234_735, 38.783_689);
        assert!((vega - towards(67.4482, 19.2372)).length() < 1e-5, "{vega}");
        assert!((galactic.determinant() - 1.0).abs() < 1e-8);
    }

    #[test]
    fn the_glow_is_where_it_belongs() {
        let (cloud, cygnus, anticentre) = (seen(271.0, -28.0), seen(299.0, 35.5), seen(86.0, 28.9));
        assert!(cloud > cygnus && cygnus > anticentre && anticentre > 0.0, "{cloud} {cygnus} {anticentre}");
        // The Coalsack and the Great Rift beside bright clouds.
        assert!(seen(192.0, -62.7) < 0.4 * seen(160.0, -59.7), "Coalsack");
        assert!(seen(270.0, -6.0) < 0.5 * seen(281.0, -6.0), "Rift");
        // The galactic poles are dark.
        assert!(seen(192.86, 27.13) < 0.01 * anticentre && seen(12.86, -27.13) < 0.01 * anticentre);
    }

    #[test]
    fn brightness_is_on_the_stars_scale() {
        // A square degree of height 5 is as bright as a star of 20.6 - 2.5 log10(3600^2) magnitudes, times the gain.
        let degree = (PI / 180.0) * (PI / 180.0);
        let star = 10.0_f64.powf(-0.4 * (BRIGHTEST - 5.0 * 3600.0_f64.log10()));
        let flux = brightest() * degree / (STAR_REFERENCE_RADIANCE * REFERENCE_SOLID_ANGLE);
        assert!((flux / (MILKY_WAY_GAIN * star) - 1.0).abs() < 1e-9);
        assert!(steps(0.0) == 0.0 && (steps(5.0) - 1.0).abs() < 1e-12);
    }

    /// Nested outlines leave no steps: along the galactic equator and across it the glow changes smoothly.
    #[test]
    fn there_are_no_contours() {
        let map = MilkyWay::decode().unwrap();
        let mut steepest = 0.0_f64;
        for y in 0..400 {
            for x in 0..800 {
                let (u, v) = (f64::from(x) / 800.0, f64::from(y) / 400.0);
                let column = map.column(u);
                let here = map.outline_height(&column, v);
                // 0.1 degrees on.
                let there = map.outline_height(&column, v + 0.1 / 180.0);
                steepest = steepest.max((here - there).abs());
            }
        }
        assert!(steepest < 0.35, "{steepest} heights in 0.1 degrees");
    }
}
