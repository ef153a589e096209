// SPDX-License-Identifier: MIT OR Apache-2.0
//! Where a frame's records come from: traced, or looked up in the tables of a lens.

use super::lens::LensLookup;
use super::record::Recorder;

/// The maker of a frame's records.
pub enum RecordSource<'a> {
    Traced(Recorder<'a>),
    LensLookup(LensLookup<'a>),
}

impl<'a> RecordSource<'a> {
    /// The recorder that traces the rays of which no table holds the records.
    pub fn recorder(&self) -> &Recorder<'a> {
        match self {
            Self::Traced(recorder) => recorder,
            Self::LensLookup(lookup) => lookup.recorder(),
        }
    }
}
