// SPDX-License-Identifier: MIT OR Apache-2.0
//! The colours of a PNG: which of its chunks says how its codes are meant, as the standard orders them (Portable
//! Network Graphics, third edition, section 4.3): cICP, iCCP, sRGB, then gAMA and cHRM. A PNG without any is sRGB.

use super::colour::{Colours, Curve, Range};
use super::icc;
use super::support::io_error;
use crate::error::{Error, Result};
use crate::image::primaries::Primaries;
use ::png::{CodingIndependentCodePoints, Info, ScaledFloat, SourceChromaticities};
use std::io::{BufRead, Read, Seek, SeekFrom};

/// Longest packed profile that is unpacked. Those that `icc` reads have some hundred bytes, rarely 50,000; profiles of
/// printers, which it does not read, have megabytes.
const MAX_PROFILE_BYTES: u64 = 64 << 10;
/// zlib makes at most so many bytes of one.
pub(super) const MAX_GROWTH: u64 = 1032;
/// The gamma that programs write for sRGB, which is no power: 1 / 2.2.
const SRGB_GAMMA: f64 = 0.45455;
/// libpng takes gammas for the same that differ by less than a twentieth; writers round to three digits at least.
const GAMMA_ROUNDING: f64 = 0.005;
/// Gammas beyond are broken chunks: displays and films have had 0.2 to 3.
const GAMMAS: std::ops::RangeInclusive<f64> = 0.05..=20.0;

/// A file's profile, told without reading it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Profile {
    Absent,
    /// Bytes of its chunk.
    Packed(u64),
    TooLong,
}

/// Looks for a profile before the first IDAT, and goes back to the beginning. Files that end early or are no PNG have
/// none. Errors: IO; UNSUPPORTED for a cICP chunk that no PNG may have, which the decoder refuses without a name.
pub(super) fn find_profile(file: &mut (impl BufRead + Seek)) -> Result<Profile> {
    let mut found = Profile::Absent;
    // The decoder passes over a second cICP, and over one after the palette.
    let mut heeds_cicp = true;
    file.seek(SeekFrom::Start(8)).map_err(io_error)?;
    loop {
        let mut head = Vec::with_capacity(8);
        Read::take(&mut *file, 8).read_to_end(&mut head).map_err(io_error)?;
        let Some(([a, b, c, d], name)) = head.split_first_chunk() else { break };
        let length = u64::from(u32::from_be_bytes([*a, *b, *c, *d]));
        match name {
            // The first one counts; the decoder passes over others.
            b"iCCP" if !matches!(found, Profile::Absent) => {}
            b"iCCP" if length > MAX_PROFILE_BYTES => found = Profile::TooLong,
            b"iCCP" => found = Profile::Packed(length),
            b"PLTE" => heeds_cicp = false,
            b"cICP" if length == 4 && heeds_cicp => {
                heeds_cicp = false;
                let mut points = [0; 4];
                file.read_exact(&mut points).map_err(io_error)?;
                check_code_points(points)?;
                file.seek_relative(-4).map_err(io_error)?;
            }
            b"IDAT" | b"IEND" => break,
            name if name.len() < 4 => break,
            _ => {}
        }
        // Past its data and its sum, without a new look at the disk for each small chunk.
        file.seek_relative(length as i64 + 4).map_err(io_error)?;
    }
    file.rewind().map_err(io_error)?;
    Ok(found)
}

/// The last two numbers of a cICP chunk: PNGs hold RGB, and the range is full or that of video.
fn check_code_points([_, _, matrix, range]: [u8; 4]) -> Result<()> {
    if matrix == 0 && range <= 1 {
        return Ok(());
    }
    Err(Error::unsupported(format!(
        "its cICP chunk has the matrix coefficients {matrix} and the range {range}; a PNG has the matrix coefficients \
         0 (RGB) and the range 0 or 1"
    )))
}

/// Errors: UNSUPPORTED for colours that are not read, a curve or primaries of cICP or a profile of another kind, in a
/// file that says nothing beside them: the chunk that counts is the first in the standard's order that is understood.
pub(super) fn colours(info: &Info<'_>, profile: Profile) -> Result<Colours> {
    let unread = match info.coding_independent_code_points.map(|points| of_code_points(points, info.bit_depth as u32)) {
        Some(Ok(colours)) => return Ok(colours),
        Some(Err(error)) => Some(error),
        None => None,
    };
    let channels = if info.color_type.samples() < 3 && info.palette.is_none() { 1 } else { 3 };
    // A broken profile is passed over, as broken chunks that may be missing are.
    let profile = match profile {
        Profile::Absent => None,
        Profile::TooLong => Some(None),
        Profile::Packed(_) => info.icc_profile.as_deref().map(|bytes| icc::read(bytes, channels)),
    };
    match profile {
        Some(Some(colours)) => return Ok(colours),
        _ if info.srgb.is_some() => return Ok(Colours::srgb()),
        _ => {}
    }
    let gamma = info.gama_chunk.and_then(of_gamma);
    match (unread, profile) {
        (Some(error), _) if gamma.is_none() => return Err(error),
        (None, Some(None)) if gamma.is_none() => {
            return Err(Error::unsupported(
                "its ICC profile is none of three lights and their curves, and no sRGB or gAMA chunk stands beside it: \
                 convert the picture to sRGB, or remove the profile",
            ));
        }
        _ => {}
    }
    let curve = gamma.unwrap_or(Curve::Srgb);
    // Places that are no primaries' are passed over, as a broken chunk is.
    let matrix = info.chrm_chunk.and_then(|places| primaries_of(places).to_rec709().ok().flatten());
    Ok(Colours { matrix, ..Colours::of_curve(curve) })
}

/// `None`: a broken chunk, which is passed over.
fn of_gamma(gamma: ScaledFloat) -> Option<Curve> {
    let gamma = f64::from(gamma.into_scaled()) / 100_000.0;
    let is_srgb = (gamma - SRGB_GAMMA).abs() < GAMMA_ROUNDING;
    GAMMAS.contains(&gamma).then(|| if is_srgb { Curve::Srgb } else { Curve::Power(1.0 / gamma) })
}

fn primaries_of(places: SourceChromaticities) -> Primaries {
    let SourceChromaticities { white, red, green, blue } = places;
    let number = |scaled: ScaledFloat| f64::from(scaled.into_scaled()) / 100_000.0;
    Primaries([red, green, blue, white].map(|(x, y)| [number(x), number(y)]))
}

/// The numbers of ITU-T H.273, tables 2 and 3. Curves of video are those of its camera: its light is the scene's.
fn of_code_points(points: CodingIndependentCodePoints, bits: u32) -> Result<Colours> {
    let curve = match points.transfer_function {
        1 | 6 | 14 | 15 => Curve::Rec709,
        // Unspecified.
        2 | 13 => Curve::Srgb,
        4 => Curve::Power(2.2),
        5 => Curve::Power(2.8),
        8 => Curve::Power(1.0),
        16 => Curve::Pq,
        17 => Curve::Cinema,
        18 => Curve::Hlg,
        other => {
            return Err(Error::unsupported(format!(
                "its cICP chunk has the transfer function {other}; linear (8), sRGB (13), PQ (16), HLG (18) and those \
                 of video and film (1, 4, 5, 6, 14, 15, 17) are read"
            )));
        }
    };
    const D65: [f64; 2] = [0.3127, 0.329];
    const C: [f64; 2] = [0.31, 0.316];
    let primaries = match points.color_primaries {
        1 | 2 => Primaries::REC709,
        4 => Primaries([[0.67, 0.33], [0.21, 0.71], [0.14, 0.08], C]),
        5 => Primaries([[0.64, 0.33], [0.29, 0.6], [0.15, 0.06], D65]),
        6 | 7 => Primaries([[0.63, 0.34], [0.31, 0.595], [0.155, 0.07], D65]),
        8 => Primaries([[0.681, 0.319], [0.243, 0.692], [0.145, 0.049], C]),
        9 => Primaries::REC2020,
        10 => Primaries([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0], [1.0 / 3.0; 2]]),
        11 => Primaries([[0.68, 0.32], [0.265, 0.69], [0.15, 0.06], [0.314, 0.351]]),
        12 => Primaries([[0.68, 0.32], [0.265, 0.69], [0.15, 0.06], D65]),
        22 => Primaries([[0.63, 0.34], [0.295, 0.605], [0.155, 0.077], D65]),
        other => {
            return Err(Error::unsupported(format!(
                "its cICP chunk has the colour primaries {other}; 1, 2, 4 to 12 and 22 are read, as BT.709 (1), \
                 BT.2020 (9) and Display P3 (12)"
            )));
        }
    };
    let range = if points.is_video_full_range_image { Range::Full } else { Range::Video { bits: bits.max(8) } };
    let matrix = primaries.to_rec709().ok().flatten();
    Ok(Colours { curves: vec![curve], range, matrix })
}
