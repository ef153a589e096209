// SPDX-License-Identifier: MIT OR Apache-2.0
//! The ways in which the program ends: a status that a farm can act on, by the numbers of BSD's sysexits.h, and a
//! message. Knows no command.

use bhr::error::{Error, ErrorKind};
use std::fmt::Display;
use std::io::Write;
use std::path::Path;

#[derive(Debug)]
pub struct Ending {
    pub status: u8,
    /// Memory was lacking, of the machine or of its GPU.
    pub no_memory: bool,
    message: String,
}

impl Ending {
    /// EX_USAGE, EX_DATAERR, EX_SOFTWARE, EX_IOERR, EX_TEMPFAIL.
    pub const USAGE: u8 = 64;
    const DATA: u8 = 65;
    pub const SOFTWARE: u8 = 70;
    const IO: u8 = 74;
    const TRY_AGAIN: u8 = 75;

    fn new(status: u8, message: impl Into<String>) -> Self {
        Self { status, no_memory: false, message: message.into() }
    }

    pub fn usage(message: impl Into<String>) -> Self {
        Self::new(Self::USAGE, message)
    }

    pub fn data(message: impl Into<String>) -> Self {
        Self::new(Self::DATA, message)
    }

    pub fn io(path: &Path, error: impl Display) -> Self {
        Self::new(Self::IO, format!("{}: {error}", path.display()))
    }

    /// After a signal of this number, as shells say it.
    pub fn signal(number: usize) -> Self {
        Self::new(128 + u8::try_from(number).unwrap_or(0), "interrupted; run it again to go on")
    }

    /// Writes the message to stderr, where somebody may read it.
    pub fn tell(&self) {
        let _ = writeln!(std::io::stderr(), "bhr: {}", self.message);
    }
}

impl From<Error> for Ending {
    fn from(error: Error) -> Self {
        let status = match error.kind {
            ErrorKind::InvalidArgument | ErrorKind::InvalidState | ErrorKind::Unsupported => Self::DATA,
            ErrorKind::Io => Self::IO,
            ErrorKind::NoAdapter
            | ErrorKind::OutOfMemory
            | ErrorKind::DeviceLost
            | ErrorKind::SurfaceLost
            | ErrorKind::Cancelled => Self::TRY_AGAIN,
            ErrorKind::IncompatibleAbi | ErrorKind::Internal => Self::SOFTWARE,
        };
        Self { no_memory: error.kind == ErrorKind::OutOfMemory, ..Self::new(status, error.message) }
    }
}
