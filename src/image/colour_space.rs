// SPDX-License-Identifier: MIT OR Apache-2.0
//! The primaries that float images hold their light in. Knows neither files nor tracers.

use super::memory::{ImageMut, PixelFormat};
use super::primaries::Primaries;
use crate::error::{Error, Result};

/// Primaries and white of linear light (`BHR_COLOUR_SPACE_*`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(i32)]
pub enum ColourSpace {
    #[default]
    Rec709 = 0,
    /// SMPTE EG 432-1 with the white of Rec. 709.
    P3D65 = 1,
    Rec2020 = 2,
    /// AP1 of S-2014-004, the Academy's.
    AcesCg = 3,
}

impl ColourSpace {
    pub(crate) fn primaries(self) -> Primaries {
        match self {
            Self::Rec709 => Primaries::REC709,
            Self::P3D65 => Primaries::P3_D65,
            Self::Rec2020 => Primaries::REC2020,
            Self::AcesCg => Primaries::AP1,
        }
    }

    /// The space of these primaries; `None`: they are of no space that has a name here.
    #[cfg(feature = "exr")]
    pub(crate) fn of(primaries: Primaries) -> Option<Self> {
        let all = [Self::Rec709, Self::P3D65, Self::Rec2020, Self::AcesCg];
        all.into_iter().find(|space| space.primaries().is_near(primaries))
    }

    /// Rows of the matrix from light in this space to light in another; white stays white, by Bradford's adaptation.
    pub fn to(self, other: Self) -> [[f64; 3]; 3] {
        let (there, here) = (other.primaries().rows_from_rec709(), self.primaries().rows_to_rec709());
        // Zeros that rounding has made others would make light negative.
        let sound = |v: f64| if v.abs() < 1e-12 { 0.0 } else { v };
        there.map(|row| std::array::from_fn(|c| sound((0..3).map(|k| row[k] * here[k][c]).sum())))
    }

    /// Errors: INVALID_ARGUMENT for a format without linear light.
    pub fn check_format(format: PixelFormat) -> Result<()> {
        if matches!(format, PixelFormat::Rgba16F | PixelFormat::Rgba32F) {
            return Ok(());
        }
        Err(Error::argument(format!(
            "image format is {format}; only RGBA16F and RGBA32F hold linear light, which has a colour space"
        )))
    }

    /// Converts an image's light in place. Alpha stays; values that are no numbers stay so. Errors: INVALID_ARGUMENT
    /// for a format without linear light.
    pub fn convert(self, image: &mut ImageMut<'_>, to: Self) -> Result<()> {
        let format = image.format();
        Self::check_format(format)?;
        if self == to {
            return Ok(());
        }
        let matrix = self.to(to);
        let converted = |light: [f64; 3]| matrix.map(|row| (0..3).map(|c| row[c] * light[c]).sum::<f64>());
        for y in 0..image.height() {
            let row = image.row_mut(y);
            match format {
                PixelFormat::Rgba16F => row.as_chunks_mut::<8>().0.iter_mut().for_each(|pixel| {
                    let [r, g, b, a]: [half::f16; 4] = bytemuck::pod_read_unaligned(&pixel[..]);
                    let [r, g, b] = converted([r, g, b].map(f64::from)).map(half::f16::from_f64);
                    *pixel = bytemuck::cast([r, g, b, a]);
                }),
                _ => row.as_chunks_mut::<16>().0.iter_mut().for_each(|pixel| {
                    let [r, g, b, a]: [f32; 4] = bytemuck::pod_read_unaligned(&pixel[..]);
                    let [r, g, b] = converted([r, g, b].map(f64::from)).map(|v| v as f32);
                    *pixel = bytemuck::cast([r, g, b, a]);
                }),
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Layout;

    /// ITU-R BT.2087, table 2; S-2014-004 by Bradford from D65, as OpenColorIO's configurations have it; and SMPTE EG
    /// 432-1 (W3C, CSS Color 4, section 10.9).
    #[test]
    fn matrices_are_the_published_ones() {
        let published = [
            (ColourSpace::Rec2020, [[0.6274, 0.3293, 0.0433], [0.0691, 0.9195, 0.0114], [0.0164, 0.0880, 0.8956]]),
            (
                ColourSpace::AcesCg,
                [[0.613097, 0.339523, 0.047379], [0.070194, 0.916354, 0.013452], [0.020616, 0.109570, 0.869815]],
            ),
            (
                ColourSpace::P3D65,
                [[0.822462, 0.177538, 0.0], [0.033194, 0.966806, 0.0], [0.017083, 0.072397, 0.910520]],
            ),
        ];
        for (space, wanted) in published {
            let matrix = ColourSpace::Rec709.to(space);
            for (row, wanted) in matrix.iter().zip(wanted) {
                assert!((0..3).all(|c| (row[c] - wanted[c]).abs() < 1e-4), "{space:?}: {row:?}, not {wanted:?}");
                assert!((row.iter().sum::<f64>() - 1.0).abs() < 1e-9, "{space:?}: white does not stay white");
            }
        }
    }

    #[test]
    fn light_comes_back_from_every_space() {
        use ColourSpace::{AcesCg, P3D65, Rec709, Rec2020};
        let light = [[0.3_f32, 7.0, 1e-4, 0.25], [1.0, 1.0, 1.0, 1.0]];
        for space in [Rec709, P3D65, Rec2020, AcesCg] {
            let mut block: Vec<u8> = bytemuck::cast_slice(&light).to_vec();
            let layout = Layout::packed(PixelFormat::Rgba32F, 2, 1);
            let mut image = ImageMut::new(layout, &mut block).unwrap();
            Rec709.convert(&mut image, space).unwrap();
            space.convert(&mut image, Rec709).unwrap();
            let back: Vec<f32> = bytemuck::pod_collect_to_vec(&block);
            for (back, light) in back.iter().zip(light.as_flattened()) {
                assert!((back - light).abs() < 1e-6 * 7.0, "{space:?}: {back}, not {light}");
            }
        }
        let mut codes = [0; 4];
        let mut image = ImageMut::new(Layout::packed(PixelFormat::Rgba8Srgb, 1, 1), &mut codes).unwrap();
        assert!(Rec709.convert(&mut image, AcesCg).is_err());
    }
}
