// SPDX-License-Identifier: MIT OR Apache-2.0
//! The header of an OpenEXR file of one part with its attributes in the order of their names: exr keeps them in a hash
//! map, whose order is another each time, and files of one picture are to be equal. Knows no attribute.

use std::io::{self, Seek, SeekFrom, Write};

/// Magic number and version.
const BEGIN: usize = 8;

/// Passes a file on, the header when it is whole: attributes are a name, a type, each with a NUL, the size of the value
/// in four bytes, and the value; an empty name ends them (OpenEXR, "File Layout").
pub struct Ordered<W> {
    file: W,
    /// The header until it is whole; `None`: it has been passed on.
    header: Option<Vec<u8>>,
    /// The places of the attributes that are whole.
    attributes: Vec<std::ops::Range<usize>>,
}

impl<W: Write> Ordered<W> {
    pub fn new(file: W) -> Self {
        Self { file, header: Some(Vec::new()), attributes: Vec::new() }
    }

    /// Passes the header on once it is whole.
    fn pass_on(&mut self) -> io::Result<()> {
        let Some(header) = &self.header else { return Ok(()) };
        loop {
            let begin = self.attributes.last().map_or(BEGIN, |last| last.end);
            let Some(rest) = header.get(begin..).filter(|rest| !rest.is_empty()) else { return Ok(()) };
            if rest[0] == 0 {
                break;
            }
            let Some(length) = length(rest) else { return Ok(()) };
            self.attributes.push(begin..begin + length);
        }
        let end = self.attributes.last().map_or(BEGIN, |last| last.end);
        self.attributes.sort_by_key(|place| header.get(place.clone()));
        let mut ordered = header.get(..BEGIN).unwrap_or_default().to_vec();
        ordered.extend(self.attributes.iter().filter_map(|place| header.get(place.clone())).flatten());
        ordered.extend(header.get(end..).unwrap_or_default());
        self.header = None;
        self.file.write_all(&ordered)
    }
}

/// The length of the attribute that some bytes begin with; `None`: it is not whole.
fn length(bytes: &[u8]) -> Option<usize> {
    let name = bytes.iter().position(|byte| *byte == 0)? + 1;
    let kind = bytes.get(name..)?.iter().position(|byte| *byte == 0)? + 1;
    let size = bytes.get(name + kind..name + kind + 4)?;
    let value = u32::from_le_bytes(size.try_into().ok()?) as usize;
    let whole = name + kind + 4 + value;
    (whole <= bytes.len()).then_some(whole)
}

impl<W: Write> Write for Ordered<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let Some(header) = &mut self.header else { return self.file.write(bytes) };
        header.extend_from_slice(bytes);
        self.pass_on()?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl<W: Write + Seek> Seek for Ordered<W> {
    /// Within the file's header the place is that behind what is kept of it.
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match (&self.header, to) {
            (Some(header), SeekFrom::Current(0)) => Ok(header.len() as u64),
            (Some(_), _) => Err(io::Error::other("the header is not whole yet")),
            (None, _) => self.file.seek(to),
        }
    }
}
