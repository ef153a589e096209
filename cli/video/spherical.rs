// SPDX-License-Identifier: MIT OR Apache-2.0
//! The boxes that tell players of 360-degree video how frames are to be shown: Google's Spherical Video V2 RFC
//! (st3d for stereo, sv3d for the projection). Knows no file.

use crate::order::Stereo;

fn boxed(kind: &[u8; 4], contents: &[&[u8]]) -> Vec<u8> {
    let size = 8 + contents.iter().map(|content| content.len()).sum::<usize>();
    let mut bytes = Vec::with_capacity(size);
    bytes.extend((size as u32).to_be_bytes());
    bytes.extend(kind);
    contents.iter().for_each(|content| bytes.extend(*content));
    bytes
}

/// Version 0, no flags, as most boxes begin.
const PLAIN: &[u8] = &[0; 4];

/// The boxes of an equirectangular panorama of which `margins` are not in the frame: parts of the sphere's width or
/// height from its left, top, right and bottom border.
pub fn equirect(stereo: Option<Stereo>, margins: [f64; 4]) -> Vec<u8> {
    let mode: u8 = match stereo {
        None => 0,
        Some(Stereo::TopBottom) => 1,
        Some(Stereo::SideBySide) => 2,
    };
    // Fixed point, 32 bits behind the point.
    let fixed = |part: f64| ((part * 4_294_967_296.0).round() as u32).to_be_bytes();
    let [left, top, right, bottom] = margins.map(fixed);
    let header = boxed(b"svhd", &[PLAIN, b"bhr\0"]);
    // The frame's middle is ahead, and no pose is given.
    let pose = boxed(b"prhd", &[PLAIN, &[0; 12]]);
    let bounds = boxed(b"equi", &[PLAIN, &top, &bottom, &left, &right]);
    let projection = boxed(b"proj", &[&pose, &bounds]);
    let mut bytes = boxed(b"st3d", &[PLAIN, &[mode]]);
    bytes.extend(boxed(b"sv3d", &[&header, &projection]));
    bytes
}
