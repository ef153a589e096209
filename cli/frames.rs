// SPDX-License-Identifier: MIT OR Apache-2.0
//! Lists of frames, sizes and tiles as they are written on the command line, and the names of frames' files. Knows no
//! scene.

use crate::ending::Ending;
use bhr::scene::Region;
use std::path::{Path, PathBuf};

/// More frames than this in one list are a slip.
const MOST_FRAMES: usize = 1_000_000;

/// The frames of a list such as `5,7,20-30x2`, in its order, none twice.
pub fn list(text: &str) -> Result<Vec<u32>, Ending> {
    let wrong =
        |part: &str| Ending::usage(format!("--frames {text}: \"{part}\" is no frame, nor a range as 0-99 or 0-99x3"));
    let mut frames = Vec::new();
    for part in text.split(',').map(str::trim) {
        let number = |digits: &str| digits.trim().parse::<u32>().map_err(|_| wrong(part));
        // OpenJD writes a step behind a colon.
        let (range, step) = match part.split_once(['x', ':']) {
            Some((range, step)) => (range, number(step)?),
            None => (part, 1),
        };
        let (first, last) = match range.split_once('-') {
            Some((first, last)) => (number(first)?, number(last)?),
            None => (number(range)?, number(range)?),
        };
        if step == 0 || last < first {
            return Err(wrong(part));
        }
        if frames.len() + ((last - first) / step) as usize >= MOST_FRAMES {
            return Err(Ending::usage(format!("--frames {text}: there are more than {MOST_FRAMES} frames")));
        }
        frames.extend((first..=last).step_by(step as usize));
    }
    let mut seen = std::collections::HashSet::new();
    frames.retain(|frame| seen.insert(*frame));
    Ok(frames)
}

/// A size such as `1920x1080`.
pub fn size(text: &str) -> Result<[u32; 2], Ending> {
    let most = Region::MAX_FRAME_SIDE;
    let side = |digits: &str| digits.trim().parse::<u32>().ok().filter(|side| (1..=most).contains(side));
    text.split_once('x')
        .and_then(|(width, height)| Some([side(width)?, side(height)?]))
        .ok_or_else(|| Ending::usage(format!("--size {text}: it must be as 1920x1080, each side in [1, {most}]")))
}

/// So many numbers with commas between them.
pub fn numbers<const N: usize, T: std::str::FromStr>(name: &str, text: &str, example: &str) -> Result<[T; N], Ending> {
    let parts = text.split(',').map(|part| part.trim().parse::<T>().ok()).collect::<Option<Vec<T>>>();
    parts
        .and_then(|parts| parts.try_into().ok())
        .ok_or_else(|| Ending::usage(format!("--{name} {text}: it must be as {example}")))
}

/// The file's name of a frame: the last run of # becomes its number. Errors: a list of frames, and no #.
pub struct Names {
    before: String,
    digits: usize,
    after: String,
    folder: PathBuf,
}

impl Names {
    pub fn new(path: &Path, several: bool) -> Result<Self, Ending> {
        let name = path.file_name().and_then(|name| name.to_str());
        let name = name.ok_or_else(|| Ending::usage(format!("--out {}: it is no file's name", path.display())))?;
        let folder = path.parent().map(Path::to_path_buf).unwrap_or_default();
        let Some(end) = name.rfind('#') else {
            if several {
                return Err(Ending::usage(format!(
                    "--out {name}: of several frames it needs the place of their number, as frame.######.png"
                )));
            }
            return Ok(Self { before: name.into(), digits: 0, after: String::new(), folder });
        };
        let begin = name[..end].trim_end_matches('#').len();
        Ok(Self { before: name[..begin].into(), digits: end + 1 - begin, after: name[end + 1..].into(), folder })
    }

    /// The name of one video for all frames. Errors: it has a #, no stem, or the one of unfinished videos.
    pub fn of_one(path: &Path) -> Result<Self, Ending> {
        let names = Self::new(path, false)?;
        let stem = names.before.rsplit_once('.').map_or("", |(stem, _)| stem);
        let wrong = if names.digits > 0 {
            "a video has all frames, and no place for a #"
        } else if stem.trim_start_matches('.').is_empty() {
            "it has nothing before its ending"
        } else if stem.ends_with(".part") {
            "such names are for videos that are not finished"
        } else {
            return Ok(names);
        };
        Err(Ending::usage(format!("--out {}: {wrong}", path.display())))
    }

    pub fn of(&self, frame: u32) -> PathBuf {
        let number = if self.digits == 0 { String::new() } else { format!("{frame:0digits$}", digits = self.digits) };
        self.folder.join(format!("{}{number}{}", self.before, self.after))
    }

    /// The file that says how the frames were made, beside them, under the name before their number.
    pub fn manifest(&self) -> PathBuf {
        let stem = match self.digits {
            0 => self.before.rsplit_once('.').map_or(self.before.as_str(), |(stem, _)| stem),
            _ => self.before.trim_end_matches(['.', '-', '_', ' ']),
        };
        self.folder.join(if stem.is_empty() { "manifest.jsonl".into() } else { format!("{stem}.manifest.jsonl") })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_have_every_frame_once() {
        assert_eq!(list("0-9x3, 4,5-6:1").unwrap(), [0, 3, 6, 9, 4, 5]);
        assert_eq!(list("7").unwrap(), [7]);
        for wrong in ["", "a", "3-1", "1-9x0", "1-", "-3", "1,,2", "0-4294967295"] {
            assert!(list(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn the_last_run_of_marks_is_the_number() {
        let names = Names::new(Path::new("a#b/shot##.v2.######.exr"), true).unwrap();
        assert_eq!(names.of(12), Path::new("a#b/shot##.v2.000012.exr"));
        assert_eq!(names.of(12_345_678), Path::new("a#b/shot##.v2.12345678.exr"));
        assert_eq!(names.manifest(), Path::new("a#b/shot##.v2.manifest.jsonl"));
        assert!(Names::new(Path::new("frame.png"), true).is_err());
        assert_eq!(Names::new(Path::new("frame.png"), false).unwrap().of(3), Path::new("frame.png"));
    }

    #[test]
    fn sizes_and_tiles_are_numbers() {
        assert_eq!(size("64x32").unwrap(), [64, 32]);
        assert!(["64", "0x3", "3x", "64x32x1", "-1x3", "1048577x1"].iter().all(|wrong| size(wrong).is_err()));
        assert_eq!(numbers::<4, u32>("tile", "1, 2,3,4", "0,0,9,9").unwrap(), [1, 2, 3, 4]);
        assert!(numbers::<4, u32>("tile", "1,2,3", "0,0,9,9").is_err());
    }
}
