// SPDX-License-Identifier: MIT OR Apache-2.0
//! LUTs: developed colours, sRGB-encoded, become what a table has for them. In f32, as `shaders/film/lut.wgsl`, which
//! has the same function. Knows nothing of files.
//!
//! Between nodes by tetrahedral interpolation, which J. M. Kasson, S. I. Nin, W. Plouffe and J. L. Hafner (Performing
//! color space conversions with three-dimensional linear interpolation, Journal of Electronic Imaging 4, 226, 1995)
//! find more exact than trilinear interpolation, of the eight corners of a cell, at about half the cost: the diagonal
//! of a cell from its darkest corner to its brightest one is an edge of six tetrahedra, in each of which the components
//! of the place in the cell have another order, and the colour is that of the four corners by their barycentric
//! coordinates. Colours of the same share of red, green and blue lie on the diagonals: greys that the table keeps grey
//! stay grey between nodes.

use crate::image::Lut;

/// A frame's LUT, without its nodes: the last part of the uniform `film`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct LutParams {
    /// The colour of the first node.
    pub low: [f32; 3],
    /// Nodes along each side; 0: there is no LUT.
    pub side: u32,
    /// Cells of each component from 0 to 1.
    pub scale: [f32; 3],
    /// The share of the table's colours, beside which the colours that it was given have the rest.
    pub strength: f32,
}

impl LutParams {
    /// `strength` in [0, 1].
    pub fn new(lut: &Lut, strength: f64) -> Self {
        let [low, high] = lut.domain();
        let cells = f64::from(lut.side() - 1);
        let scale = [0, 1, 2].map(|c| (cells / (f64::from(high[c]) - f64::from(low[c]))) as f32);
        Self { low, side: lut.side(), scale, strength: strength as f32 }
    }
}

/// The colour that takes the place of one. Both in [0, 1]: beyond the table's domain the colour at its edge, beyond 0
/// and 1 these. `nodes`: those of the table.
pub fn through_lut(lut: &LutParams, nodes: &[[f32; 4]], colour: [f32; 3]) -> [f32; 3] {
    let cells = lut.side.saturating_sub(1) as f32;
    let place = [0, 1, 2].map(|c| ((colour[c] - lut.low[c]) * lut.scale[c]).clamp(0.0, cells));
    let corner = place.map(|v| v.floor().min(cells - 1.0));
    let [x, y, z] = [0, 1, 2].map(|c| place[c] - corner[c]);
    // From corner to corner: along the axis of the largest part, then of the middle one, then of the least.
    let largest = if x >= y && x >= z { 0 } else { 1 + usize::from(y < z) };
    let least = if z <= x && z <= y { 2 } else { usize::from(y <= x) };
    let (most, fewest) = (x.max(y).max(z), x.min(y).min(z));
    let middle = (x.min(y)).max(x.max(y).min(z));
    let node = |step: fn(usize, usize, usize) -> bool| {
        let [i, j, k] = [0, 1, 2].map(|c| corner[c] as usize + usize::from(step(c, largest, least)));
        let side = lut.side as usize;
        nodes.get(i + side * (j + side * k)).copied().unwrap_or_default()
    };
    let [a, b, c, d] = [
        node(|_, _, _| false),
        node(|axis, largest, _| axis == largest),
        node(|axis, _, least| axis != least),
        node(|_, _, _| true),
    ];
    [0, 1, 2].map(|i| {
        let found = (1.0 - most) * a[i] + (most - middle) * b[i] + (middle - fewest) * c[i] + fewest * d[i];
        (1.0 - lut.strength) * colour[i] + lut.strength * found.clamp(0.0, 1.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{FilmParams, develop, develop_through};
    use crate::image::PixelFormat;
    use crate::scene::{ColourMap, Film, Grade, ToneMap, View};
    use serde_json::Value;

    fn table(side: u32, domain: [[f32; 3]; 2], colour: impl Fn([f32; 3]) -> [f32; 3]) -> Lut {
        let at = |i: u32| i as f32 / (side - 1) as f32;
        let indices = (0..side).flat_map(|b| (0..side).flat_map(move |g| (0..side).map(move |r| [r, g, b])));
        let nodes = indices.map(|index| colour(index.map(at))).map(|[r, g, b]| [r, g, b, 0.0]);
        Lut::over(side, domain, nodes.collect())
    }

    fn identity(side: u32) -> Lut {
        table(side, Lut::UNIT, |colour| colour)
    }

    fn params(film: &Film, lut: &Lut) -> FilmParams {
        FilmParams::new(film, View::Light, PixelFormat::Rgba8Srgb, false).with_lut(Some(lut), film)
    }

    /// Number `n` of the tables of tests/golden/lut.py.
    fn number(n: u32) -> f32 {
        let m = n.wrapping_mul(2_654_435_761).wrapping_add(12_345);
        let m = (m ^ (m >> 15)).wrapping_mul(2_246_822_519);
        (m >> 20) as f32 / 4096.0 * 1.5 - 0.25
    }

    fn floats(value: &Value) -> [f64; 3] {
        [0, 1, 2].map(|c| value[c].as_f64().expect("a number"))
    }

    /// Against tests/golden/lut.json, which numpy has computed in another way.
    #[test]
    fn colours_between_nodes_are_those_of_an_independent_program() {
        let text = std::fs::read_to_string("tests/golden/lut.json").expect("the reference values");
        let golden: Value = serde_json::from_str(&text).expect("JSON");
        let (mut count, mut worst) = (0, 0.0_f64);
        for case in golden["cases"].as_array().expect("cases") {
            let side = case["side"].as_u64().expect("a side") as u32;
            let nodes = (0..Lut::node_count(side) as u32).map(|i| [0, 1, 2].map(|c| number(3 * i + c)));
            let domain = [&case["low"], &case["high"]].map(|bound| floats(bound).map(|v| v as f32));
            let lut = Lut::over(side, domain, nodes.map(|[r, g, b]| [r, g, b, 0.0]).collect());
            let params = LutParams::new(&lut, case["strength"].as_f64().expect("a strength"));
            let (colours, found) = (case["colours"].as_array().expect("colours"), case["become"].as_array());
            for (colour, wanted) in colours.iter().zip(found.expect("colours")) {
                let got = through_lut(&params, lut.nodes(), floats(colour).map(|v| v as f32));
                let wanted = floats(wanted);
                let error = (0..3).map(|c| (f64::from(got[c]) - wanted[c]).abs()).fold(0.0, f64::max);
                assert!(error <= 1e-6, "side {side}, {colour}: {got:?}, not {wanted:?}");
                (count, worst) = (count + 1, worst.max(error));
            }
        }
        println!("{count} colours, the worst by {worst:e}");
        assert_eq!(count, 356);
    }

    /// All codes of 8 bits, greys and others: a table that changes nothing changes no code.
    #[test]
    fn identities_keep_colours() {
        for side in [2, 3, 17, 33, 65] {
            let (lut, film) = (identity(side), Film { tone_map: ToneMap::None, ..Film::plain() });
            let (with, params) = (params(&film, &lut), LutParams::new(&lut, 1.0));
            let plain = FilmParams::new(&film, View::Light, PixelFormat::Rgba8Srgb, false);
            for code in 0..=255_u32 {
                let colour = [code, 255 - code, (code * 37) % 256].map(|v| v as f32 / 255.0);
                let got = through_lut(&params, lut.nodes(), colour);
                assert!((0..3).all(|c| (got[c] - colour[c]).abs() < 1e-6), "{side}, {colour:?}: {got:?}");
                let light = [colour[0] * colour[0], colour[1], colour[2].powi(3), 1.0];
                let [got, wanted] =
                    [develop_through(&with, Some(&lut), light, code, 7), develop(&plain, light, code, 7)];
                assert!(got.iter().zip(&wanted).all(|(a, b)| a.abs_diff(*b) <= 1), "{got:?}, not {wanted:?}");
            }
            for (light, codes) in [(0.0, [0, 0, 0, 255]), (1e9, [255; 4])] {
                for i in 0..4096 {
                    let pixel = develop_through(&with, Some(&lut), [light; 4], i % 64, i / 64);
                    assert_eq!(pixel.as_slice(), codes, "black and white take no dither");
                }
            }
        }
    }

    #[test]
    fn greys_stay_grey_between_nodes() {
        let lut = table(5, Lut::UNIT, |[r, g, b]| [r * r, g * g, b * b]);
        let params = LutParams::new(&lut, 1.0);
        for i in 0..=1000 {
            let [r, g, b] = through_lut(&params, lut.nodes(), [i as f32 / 1000.0; 3]);
            assert!(r == g && g == b, "{r}, {g}, {b}");
        }
    }

    /// White and black change places, in transparent pictures as well; at half the strength all is grey.
    #[test]
    fn black_and_white_become_what_the_table_has_for_them() {
        let lut = table(9, Lut::UNIT, |colour| colour.map(|v| 1.0 - v));
        for (strength, black, white) in [(1.0, 255, 0), (0.5, 127, 127), (0.0, 0, 255)] {
            let film = Film { tone_map: ToneMap::Aces, lut_strength: strength, ..Film::plain() };
            for transparent in [false, true] {
                let params = FilmParams::new(&film, View::Light, PixelFormat::Bgra8Srgb, transparent);
                let params = params.with_lut(Some(&lut), &film);
                for (light, code) in [(0.0, black), (1e9, white)] {
                    let pixel = develop_through(&params, Some(&lut), [light, light, light, 0.0], 5, 5);
                    assert!(pixel[..3].iter().all(|v| v.abs_diff(code) <= 1), "{strength}, {light}: {pixel:?}");
                    assert_eq!(pixel[3], if transparent { 0 } else { 255 });
                }
            }
        }
    }

    #[test]
    fn a_domain_is_where_the_nodes_lie_and_beyond_it_the_edge_goes_on() {
        // Red beside the middle is cut off, green is halved, blue lies in the upper half of the table.
        let lut = table(33, [[0.25, 0.0, -1.0], [0.75, 2.0, 1.0]], |colour| colour);
        let params = LutParams::new(&lut, 1.0);
        for (colour, wanted) in [([0.1, 0.5, 0.0], [0.0, 0.25, 0.5]), ([0.5, 1.0, 1.0], [0.5, 0.5, 1.0])] {
            let got = through_lut(&params, lut.nodes(), colour);
            assert!((0..3).all(|c| (got[c] - wanted[c]).abs() < 1e-6), "{colour:?}: {got:?}");
        }
        let odd = table(2, [[-1e6; 3], [1e6; 3]], |colour| colour.map(|v| if v > 0.5 { 3e38 } else { -3e38 }));
        for colour in [[0.0; 3], [1.0; 3], [0.3, 0.9, 0.1], [f32::NAN, f32::INFINITY, -1.0]] {
            let got = through_lut(&LutParams::new(&odd, 1.0), odd.nodes(), colour);
            assert!(!colour[0].is_finite() || got.iter().all(|v| (0.0..=1.0).contains(v)), "{got:?}");
        }
    }

    /// Float formats, views, colour maps, and films whose LUT is off, have the bytes that they had.
    #[test]
    fn a_table_that_is_not_shown_changes_no_bit() {
        use crate::scene::Scene;
        use std::sync::Arc;
        let lut = Arc::new(table(3, Lut::UNIT, |_| [0.5; 3]));
        let shown = |change: fn(&mut Scene)| {
            let mut scene = Scene { film_lut: Some(lut.clone()), ..Scene::plain() };
            change(&mut scene);
            scene.shown_lut().is_some()
        };
        assert!(shown(|_| ()));
        assert!(!shown(|scene| scene.film.lut_strength = 0.0));
        assert!(!shown(|scene| scene.film.colour_map = ColourMap::Afmhot));
        assert!(!shown(|scene| scene.view = View::Redshift));
        assert!(!shown(|scene| scene.film_lut = None));
        let grade = Grade { contrast: 2.0, ..Grade::default() };
        for format in [PixelFormat::Rgba16F, PixelFormat::Rgba32F, PixelFormat::R32F] {
            let film = Film { grade, ..Film::plain() };
            let plain = FilmParams::new(&film, View::Light, format, true);
            let light = [0.1, 0.2, 0.3, 0.4];
            let with = develop_through(&plain.with_lut(Some(&lut), &film), Some(&lut), light, 3, 4);
            assert_eq!(with, develop(&plain, light, 3, 4), "{format}");
        }
    }

    #[test]
    fn nodes_in_memory_are_checked() {
        let mut numbers = [0.5_f32; 24];
        assert_eq!(Lut::new(2, numbers.into_iter()).expect("a table").nodes()[7], [0.5, 0.5, 0.5, 0.0]);
        let refused = |side, numbers: &[f32]| Lut::new(side, numbers.iter().copied()).expect_err("refused").message;
        assert_eq!(refused(1, &numbers), "side is 1; it must lie in [2, 65]");
        assert_eq!(refused(66, &numbers), "side is 66; it must lie in [2, 65]");
        assert_eq!(refused(3, &numbers), "count is 24; for a side of 3 it must be 81");
        assert_eq!(refused(2, &numbers[..23]), "count is 23; for a side of 2 it must be 24");
        numbers[13] = f32::NAN;
        assert_eq!(refused(2, &numbers), "nodes[13] is NaN; it must be finite");
        numbers[13] = f32::NEG_INFINITY;
        assert_eq!(refused(2, &numbers), "nodes[13] is -inf; it must be finite");
    }
}
