// SPDX-License-Identifier: MIT OR Apache-2.0
//! The things that are written: a layer of a file, the attributes that go with layers, and the meaning of alpha. Knows
//! no kind of file.

use crate::image::ColourSpace;
use crate::image::memory::ImageRef;
use half::f16;

/// An image as layers of a file have it.
pub struct Layer<'a> {
    /// The channels' names, as many as a pixel has values.
    pub channels: Vec<String>,
    pub image: ImageRef<'a>,
}

/// A value of a file's attribute.
#[derive(Clone, Debug, PartialEq)]
pub enum Attribute {
    Number(f64),
    Text(String),
}

/// One channel's values, row by row.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    Halves(Vec<f16>),
    Floats(Vec<f32>),
}

/// A file's channels, sorted by name, byte by byte, and its attributes that are a number or a text, sorted by name.
#[derive(Debug)]
pub struct Channels {
    pub width: u32,
    pub height: u32,
    pub list: Vec<(String, Values)>,
    pub attributes: Vec<(String, Attribute)>,
    /// The primaries of light, as the file says; Rec. 709 where it names none, or others than this library's.
    pub space: ColourSpace,
}

/// The work that is done to make a file of layers small, 1 .. 9. Up to 3 only runs of equal bytes are found; above, it
/// is a level of zlib, which takes several times as long to save a few percent.
#[derive(Clone, Copy, Debug)]
pub struct Effort(pub i32);

impl Default for Effort {
    /// Runs only.
    fn default() -> Self {
        Self(1)
    }
}

/// How an image's colours go with its alpha.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alpha {
    /// The kind of file that the image goes to says how.
    AsInFile,
    /// Transparent frames are so: black where alpha is 0, but for glare.
    Premultiplied,
}
