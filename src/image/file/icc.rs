// SPDX-License-Identifier: MIT OR Apache-2.0
//! ICC profiles of the simple kind, three lights and their curves (ICC.1:2022, section 8.3.3), or a curve of grey:
//! those of sRGB, Display P3, Adobe RGB, ProPhoto and linear pictures. Libraries for colour bring transformations of
//! 8-bit pixels, or more code than all of bhr's readers of files.

use super::colour::{Colours, Curve, Range};
use crate::image::primaries::from_xyz;
use glam::{DMat3, DVec3};

/// Most entries of a profile's list; usual ones have 9 to 20.
const MAX_TAGS: u32 = 256;
/// Most steps of a curve that is a table; usual ones have 256 to 4096.
const MAX_STEPS: usize = 1 << 16;
/// White of the space that profiles lead to, D50 as ICC.1:2022 rounds it in section 7.2.16.
const D50: DVec3 = DVec3::new(0.9642, 1.0, 0.8249);

/// The colours that a profile gives a picture with `channels` of colour, 1 or 3; `None` for one of another kind.
pub(super) fn read(profile: &[u8], channels: usize) -> Option<Colours> {
    let space = profile.get(16..20)?;
    if profile.get(36..40)? != b"acsp" {
        return None;
    }
    match (space, channels) {
        (b"GRAY", 1) if profile.get(20..24)? == b"XYZ " => Some(Colours::of_curve(curve(tag(profile, b"kTRC")?)?)),
        (b"RGB ", 3) if profile.get(20..24)? == b"XYZ " => {
            let curves = [b"rTRC", b"gTRC", b"bTRC"].into_iter().map(|name| curve(tag(profile, name)?));
            let mut curves = curves.collect::<Option<Vec<_>>>()?;
            if curves.iter().all(|curve| *curve == curves[0]) {
                curves.truncate(1);
            }
            let [r, g, b] = [b"rXYZ", b"gXYZ", b"bXYZ"].map(|name| xyz(tag(profile, name)?));
            let matrix = from_xyz(DMat3::from_cols(r?, g?, b?), D50)?;
            // sRGB's own profile, by profile makers' different roundings.
            let is_same = matrix.abs_diff_eq(DMat3::IDENTITY, 0.004);
            Some(Colours { curves, range: Range::Full, matrix: (!is_same).then_some(matrix) })
        }
        _ => None,
    }
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_be_bytes(*bytes.get(at..)?.first_chunk()?))
}

fn half_word(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_be_bytes(*bytes.get(at..)?.first_chunk()?))
}

/// A number with 16 bits behind the point.
fn fixed(bytes: &[u8], at: usize) -> Option<f64> {
    word(bytes, at).map(|number| f64::from(number.cast_signed()) / 65536.0)
}

fn tag<'a>(profile: &'a [u8], name: &[u8; 4]) -> Option<&'a [u8]> {
    let count = word(profile, 128)?.min(MAX_TAGS) as usize;
    let entry = (0..count).map(|i| 132 + 12 * i).find(|at| profile.get(*at..at + 4) == Some(name))?;
    let (from, size) = (word(profile, entry + 4)? as usize, word(profile, entry + 8)? as usize);
    profile.get(from..from.checked_add(size)?)
}

fn xyz(tag: &[u8]) -> Option<DVec3> {
    if !tag.starts_with(b"XYZ ") {
        return None;
    }
    Some(DVec3::new(fixed(tag, 8)?, fixed(tag, 12)?, fixed(tag, 16)?))
}

/// A power of 0 would make all codes but black white: the profile is broken.
fn exponent(power: f64) -> Option<f64> {
    (power > 0.0).then_some(power)
}

fn curve(tag: &[u8]) -> Option<Curve> {
    match tag.first_chunk()? {
        b"curv" => Some(match word(tag, 8)? as usize {
            0 => Curve::Power(1.0),
            1 => Curve::Power(exponent(f64::from(half_word(tag, 12)?) / 256.0)?),
            count if count > MAX_STEPS => return None,
            count => {
                let steps = tag.get(12..12_usize.checked_add(count.checked_mul(2)?)?)?.as_chunks::<2>().0;
                Curve::Table(steps.iter().map(|step| f32::from(u16::from_be_bytes(*step)) / 65535.0).collect())
            }
        }),
        b"para" => {
            let at = |i: usize| fixed(tag, 12 + 4 * i);
            let g = exponent(at(0)?)?;
            // From d on (a x + b)^g + e, below c x + f.
            Some(Curve::Parametric(match half_word(tag, 8)? {
                0 => [g, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
                1 | 2 => {
                    let (a, b) = (at(1)?, at(2)?);
                    let rest = if half_word(tag, 8)? == 2 { at(3)? } else { 0.0 };
                    if a == 0.0 {
                        return None;
                    }
                    [g, a, b, 0.0, -b / a, rest, rest]
                }
                3 => [g, at(1)?, at(2)?, at(3)?, at(4)?, 0.0, 0.0],
                4 => [g, at(1)?, at(2)?, at(3)?, at(4)?, at(5)?, at(6)?],
                _ => return None,
            }))
        }
        _ => None,
    }
}
