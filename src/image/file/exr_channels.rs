// SPDX-License-Identifier: MIT OR Apache-2.0
//! The channels of an OpenEXR file that are its picture. Layers are told by the words before a channel's last dot:
//! `ViewLayer.Combined.R`, `beauty.R`, or none.

use super::support::io_error;
use crate::error::Result;
use ::exr::meta::header::Header;

/// The last words of layers that programs give the finished picture, in lower case; other layers hold parts of it.
const FINISHED: [&str; 7] = ["combined", "composite", "beauty", "rgba", "rgb", "color", "main"];
/// Most channels that a message names, and most bytes of a name.
const MOST_NAMES: usize = 12;
const NAME_BYTES: usize = 40;

/// The part that is read and, for red, green, blue and alpha, the number of its channel; the alpha of a picture that
/// has none is missing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Chosen {
    pub part: usize,
    pub rgb: [usize; 3],
    pub alpha: Option<usize>,
}

/// The first part's picture: R, G, B outside of layers; a layer with those whose name says that it is the picture; any
/// layer with those, in the order of the file, which is that of the alphabet; and then Y, which is grey, in the same
/// order. Errors: IO, with the names of the channels that there are.
pub(super) fn choose(parts: &[Header]) -> Result<Chosen> {
    let of_colour = parts.iter().enumerate().flat_map(|(part, header)| layers(part, header, b"R"));
    let of_grey = parts.iter().enumerate().flat_map(|(part, header)| layers(part, header, b"Y"));
    let best = |layers: &mut dyn Iterator<Item = Layer>| {
        // The first of those that are best.
        layers.min_by_key(|layer| layer.rank).map(|layer| layer.chosen)
    };
    best(&mut of_colour.into_iter()).or_else(|| best(&mut of_grey.into_iter())).ok_or_else(|| io_error(nothing(parts)))
}

struct Layer {
    chosen: Chosen,
    /// 0: outside of layers.
    rank: usize,
}

/// A part's layers that have the channel `first`, R or Y, and what a picture needs beside it.
fn layers<'a>(part: usize, header: &'a Header, first: &'static [u8; 1]) -> impl Iterator<Item = Layer> + 'a {
    header.channels.list.iter().enumerate().filter_map(move |(index, channel)| {
        let layer = channel.name.as_slice().strip_suffix(first)?;
        if !(layer.is_empty() || layer.ends_with(b".")) {
            return None;
        }
        let beside = |name: &[u8]| find(header, &[layer, name].concat());
        let rgb = match first {
            b"Y" if beside(b"RY").is_some() || beside(b"BY").is_some() => return None,
            b"Y" => [index; 3],
            _ => [index, beside(b"G")?, beside(b"B")?],
        };
        Some(Layer { chosen: Chosen { part, rgb, alpha: beside(b"A") }, rank: rank(layer) })
    })
}

fn rank(layer: &[u8]) -> usize {
    let Some(layer) = layer.strip_suffix(b".").filter(|layer| !layer.is_empty()) else { return 0 };
    let last = layer.rsplit(|byte| *byte == b'.').next().unwrap_or_default();
    1 + FINISHED.iter().position(|name| last.eq_ignore_ascii_case(name.as_bytes())).unwrap_or(FINISHED.len())
}

/// Channels are sorted by name, as the decoder has checked.
fn find(header: &Header, name: &[u8]) -> Option<usize> {
    header.channels.list.binary_search_by(|channel| channel.name.as_slice().cmp(name)).ok()
}

fn nothing(parts: &[Header]) -> String {
    let channels = parts.iter().flat_map(|part| &part.channels.list);
    let count = channels.clone().count();
    let mut names = channels.take(MOST_NAMES).map(|channel| {
        let bytes = channel.name.as_slice();
        String::from_utf8_lossy(&bytes[..bytes.len().min(NAME_BYTES)]).escape_debug().to_string()
    });
    let mut list = names.by_ref().collect::<Vec<_>>().join(", ");
    if count > MOST_NAMES {
        list += &format!(" and {} more", count - MOST_NAMES);
    }
    format!("it has no channels R, G and B of one layer, and no Y without RY and BY; it has {list}")
}
