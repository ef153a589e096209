// SPDX-License-Identifier: MIT OR Apache-2.0
//! A layer of a file, and the attributes that go with layers. Knows no kind of file.

use crate::image::memory::ImageRef;

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
