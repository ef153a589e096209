// SPDX-License-Identifier: MIT OR Apache-2.0
//! The boxes of fragmented MP4 files (ISO/IEC 14496-12): videos that ffmpeg made one after the other are appended to
//! one file, each fragment under its own number and at its own time. Knows no codec and no process.

use std::fs::File;
use std::io::{Error, ErrorKind, Read, Result, Seek, SeekFrom, Write};
use std::ops::Range;

/// The tables before a file's first fragment and at the beginning of each are small; ffmpeg makes no larger ones.
const MOST_TABLE: u64 = 64 << 20;

fn broken(what: &str) -> Error {
    Error::new(ErrorKind::InvalidData, format!("ffmpeg's video is not as expected: {what}"))
}

/// A box in a piece of memory: its kind, the whole of it, and its content.
#[derive(Clone, Debug)]
struct Found {
    kind: [u8; 4],
    whole: Range<usize>,
    content: Range<usize>,
}

fn number(bytes: &[u8], at: usize) -> Result<u32> {
    let four = bytes.get(at..at.saturating_add(4)).and_then(|bytes| bytes.try_into().ok());
    four.map(u32::from_be_bytes).ok_or_else(|| broken("a box is too short"))
}

fn put(bytes: &mut [u8], at: usize, number: &[u8]) -> Result<()> {
    let place = bytes.get_mut(at..at.saturating_add(number.len())).ok_or_else(|| broken("a box is too short"))?;
    place.copy_from_slice(number);
    Ok(())
}

/// The boxes of a part of some bytes, in their order.
fn boxes(bytes: &[u8], part: Range<usize>) -> Result<Vec<Found>> {
    let (mut at, mut found) = (part.start, Vec::new());
    while at < part.end {
        let size = number(bytes, at)? as usize;
        let kind = number(bytes, at + 4)?.to_be_bytes();
        if size < 8 || size > part.end - at {
            return Err(broken("a box does not fit where it lies"));
        }
        found.push(Found { kind, whole: at..at + size, content: at + 8..at + size });
        at += size;
    }
    Ok(found)
}

/// The first box of a kind.
fn child(bytes: &[u8], part: Range<usize>, kind: &[u8; 4]) -> Result<Found> {
    let found = boxes(bytes, part)?.into_iter().find(|found| found.kind == *kind);
    found.ok_or_else(|| broken(&format!("it has no box {}", String::from_utf8_lossy(kind))))
}

/// One video of one track, as ffmpeg makes it with empty_moov.
pub struct Video {
    file: File,
    /// The boxes before the fragments.
    pub header: Vec<u8>,
    /// The place of each fragment's table, and of its data, in the file.
    fragments: Vec<[Range<u64>; 2]>,
}

impl Video {
    /// Reads where everything lies. Errors: those of the file; INVALID_DATA for another kind of file.
    pub fn read(mut file: File) -> Result<Self> {
        let end = file.metadata()?.len();
        let (mut at, mut header, mut fragments, mut table) = (0, Vec::new(), Vec::new(), None);
        while at < end {
            let (kind, whole) = top(&mut file, at, end)?;
            at = whole.end;
            match (&kind, table.take()) {
                (b"ftyp" | b"moov", None) if fragments.is_empty() => header.extend(read(&mut file, whole)?),
                (b"moof", None) => table = Some(whole),
                (b"mdat", Some(table)) => fragments.push([table, whole]),
                // An index at the end, of places in this file alone.
                (b"mfra" | b"free" | b"sidx" | b"styp", None) => {}
                (kind, _) => {
                    return Err(broken(&format!("a box {} where none is", String::from_utf8_lossy(kind))));
                }
            }
        }
        if table.is_some() || fragments.is_empty() {
            return Err(broken("a fragment is missing"));
        }
        Ok(Self { file, header, fragments })
    }

    /// Ticks of its clock in a second.
    pub fn ticks_per_second(&self) -> Result<u32> {
        let bytes = &self.header;
        let mut part = 0..bytes.len();
        for kind in [b"moov", b"trak", b"mdia", b"mdhd"] {
            part = child(bytes, part, kind)?.content;
        }
        let version = bytes.get(part.start).copied().unwrap_or(0);
        number(bytes, part.start + if version == 1 { 20 } else { 12 })
    }

    /// Writes the fragments behind what `to` holds: frames `before` and on, each of so many ticks. Returns how many
    /// frames there are. Errors: those of the files; INVALID_DATA.
    pub fn append(&mut self, to: &mut File, before: u64, ticks_per_frame: u64) -> Result<u64> {
        let mut frames = 0;
        for [table, data] in self.fragments.clone() {
            let mut bytes = read(&mut self.file, table)?;
            frames += place(&mut bytes, before + frames, before * ticks_per_frame)?;
            to.write_all(&bytes)?;
            self.file.seek(SeekFrom::Start(data.start))?;
            let length = data.end - data.start;
            if std::io::copy(&mut Read::by_ref(&mut self.file).take(length), to)? != length {
                return Err(broken("a fragment is missing"));
            }
        }
        Ok(frames)
    }
}

/// The kind and the place of the box that begins at a place of a file.
fn top(file: &mut File, at: u64, end: u64) -> Result<([u8; 4], Range<u64>)> {
    file.seek(SeekFrom::Start(at))?;
    let mut start = [0; 16];
    file.read_exact(&mut start[..8])?;
    let mut size = u64::from(number(&start, 0)?);
    if size == 1 {
        file.read_exact(&mut start[8..])?;
        size = (u64::from(number(&start, 8)?) << 32) | u64::from(number(&start, 12)?);
    }
    if size < 8 || size > end - at {
        return Err(broken("it is cut off, as on a full disk"));
    }
    Ok((number(&start, 4)?.to_be_bytes(), at..at + size))
}

/// A part of a file that fits into memory.
fn read(file: &mut File, part: Range<u64>) -> Result<Vec<u8>> {
    let length = part.end - part.start;
    if length > MOST_TABLE {
        return Err(broken("a table is too large"));
    }
    file.seek(SeekFrom::Start(part.start))?;
    let mut bytes = vec![0; length as usize];
    file.read_exact(&mut bytes)?;
    Ok(bytes)
}

/// Gives a fragment its number, which only has to increase, and moves its time on; its frames.
fn place(moof: &mut [u8], before: u64, ticks: u64) -> Result<u64> {
    let content = child(moof, 0..moof.len(), b"moof")?.content;
    let mut frames = 0;
    for found in boxes(moof, content)? {
        match &found.kind {
            b"mfhd" => {
                let sequence = u32::try_from(before + 1).map_err(|_| broken("it has too many frames"))?;
                put(moof, found.content.start + 4, &sequence.to_be_bytes())?;
            }
            b"traf" => {
                let time = child(moof, found.content.clone(), b"tfdt")?.content.start;
                if moof.get(time) == Some(&1) {
                    let now = (u64::from(number(moof, time + 4)?) << 32) | u64::from(number(moof, time + 8)?);
                    put(moof, time + 4, &(now + ticks).to_be_bytes())?;
                } else {
                    let now = u64::from(number(moof, time + 4)?) + ticks;
                    let now = u32::try_from(now).map_err(|_| broken("its clock runs over"))?;
                    put(moof, time + 4, &now.to_be_bytes())?;
                }
                for run in boxes(moof, found.content)?.iter().filter(|run| run.kind == *b"trun") {
                    frames += u64::from(number(moof, run.content.start + 4)?);
                }
            }
            _ => {}
        }
    }
    Ok(frames)
}

/// The boxes that lead to a track's tables, from the outside to the inside.
const TABLES: [&[u8; 4]; 5] = [b"moov", b"trak", b"mdia", b"minf", b"stbl"];

/// The places of boxes that lie in each other, and the content of the last one.
fn path(bytes: &[u8], kinds: &[&[u8; 4]]) -> Result<(Vec<usize>, Range<usize>)> {
    let (mut part, mut places) = (0..bytes.len(), Vec::new());
    for kind in kinds {
        let found = child(bytes, part, kind)?;
        places.push(found.whole.start);
        part = found.content;
    }
    Ok((places, part))
}

/// Replaces a part of some bytes by others, which all boxes at `places` hold.
fn replace(bytes: &mut Vec<u8>, places: &[usize], part: Range<usize>, by: &[u8]) -> Result<()> {
    for at in places {
        let size = (number(bytes, *at)? as usize + by.len()).checked_sub(part.len());
        let size = size.and_then(|size| u32::try_from(size).ok()).ok_or_else(|| broken("a table is too large"))?;
        put(bytes, *at, &size.to_be_bytes())?;
    }
    bytes.splice(part, by.iter().copied());
    Ok(())
}

/// Adds boxes to the description of the video's frames. Errors: INVALID_DATA.
pub fn describe(header: &mut Vec<u8>, description: &[u8]) -> Result<()> {
    let (mut places, tables) = path(header, &TABLES)?;
    let table = child(header, tables, b"stsd")?;
    // A version, flags and a count stand before the descriptions, of which a video has one.
    let entries = table.content.start + 8..table.content.end;
    let entry = boxes(header, entries)?.into_iter().next().ok_or_else(|| broken("it describes no frames"))?;
    places.extend([table.whole.start, entry.whole.start]);
    replace(header, &places, entry.whole.end..entry.whole.end, description)
}

/// Removes the table of which frames others are made from (sdtp). ffmpeg makes one of no frames, and only where some
/// frame of the piece is of no use to others, so that headers of one film would differ.
pub fn remove_dependencies(header: &mut Vec<u8>) -> Result<()> {
    let (places, tables) = path(header, &TABLES)?;
    match boxes(header, tables)?.into_iter().find(|found| found.kind == *b"sdtp") {
        Some(found) => replace(header, &places, found.whole, &[]),
        None => Ok(()),
    }
}

/// Checks that an ordinary video is whole and has so many frames: on a full disk ffmpeg may leave a part of one, and
/// say nothing. Errors: those of the file; INVALID_DATA.
pub fn check_whole(mut file: File, frames: u64) -> Result<()> {
    let end = file.metadata()?.len();
    let (mut at, mut tables, mut data) = (0, None, 0);
    while at < end {
        let (kind, whole) = top(&mut file, at, end)?;
        match &kind {
            b"moov" => tables = Some(read(&mut file, whole.clone())?),
            b"mdat" => data += whole.end - whole.start,
            _ => {}
        }
        at = whole.end;
    }
    let tables = tables.ok_or_else(|| broken("it has no box moov"))?;
    let (_, track) = path(&tables, &TABLES)?;
    // A size of all frames, or 0; their number; the size of each.
    let sizes = child(&tables, track, b"stsz")?.content.start + 4;
    let (same, count) = (u64::from(number(&tables, sizes)?), u64::from(number(&tables, sizes + 4)?));
    let mut bytes = same * count;
    if same == 0 {
        for frame in 0..count as usize {
            bytes += u64::from(number(&tables, sizes + 8 + 4 * frame)?);
        }
    }
    if count != frames || data < bytes {
        return Err(broken(&format!("it has {count} frames of {frames}, and {data} bytes of {bytes}")));
    }
    Ok(())
}
