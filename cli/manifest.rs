// SPDX-License-Identifier: MIT OR Apache-2.0
//! The file beside the frames that says how each was made: one JSON object a line, appended under a lock, so that
//! several programs may write to one file; of several lines for a file the last one counts. A line without a hash is
//! written before a file is: who was killed in between leaves a file that does not count. Knows no scene.

use crate::ending::Ending;
use bhr::scene::Region;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::collections::HashMap;
use std::fs::{File, OpenOptions};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// All that decides the bytes of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Fingerprint {
    pub frame: u32,
    /// [`hash`] of the scene at the frame's moment, and of the settings that decide pixels.
    pub scene: String,
    pub tile: Option<Tile>,
}

/// A part of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tile {
    pub region: Region,
    pub size: [u32; 2],
}

/// How a frame was made.
#[derive(Clone)]
pub struct Made {
    pub file: PathBuf,
    pub of: Fingerprint,
    pub adapter: String,
    pub backend: String,
    pub seconds: f64,
}

/// The SHA-256 of some bytes, in hexadecimal digits.
pub fn hash(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The [`hash`] of a file's content, which need not fit into memory.
fn hash_of(file: &Path) -> std::io::Result<String> {
    let mut hasher = Sha256::new();
    std::io::copy(&mut File::open(file)?, &mut hasher)?;
    Ok(hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect())
}

fn name_of(file: &Path) -> String {
    file.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

impl Made {
    /// Says that the file is about to be written.
    pub fn announce(&self, manifest: &Path) -> Result<(), Ending> {
        append(manifest, &json!({"file": name_of(&self.file), "frame": self.of.frame}))
    }

    /// Says that the file is there.
    pub fn note(&self, manifest: &Path) -> Result<(), Ending> {
        let sha256 = hash_of(&self.file).map_err(|error| Ending::io(&self.file, error))?;
        let tile = self.of.tile.map(|Tile { region, size: [width, height] }| {
            json!({"x": region.x, "y": region.y, "width": width, "height": height,
                   "full_width": region.full_width, "full_height": region.full_height})
        });
        let line = json!({
            "frame": self.of.frame,
            "file": name_of(&self.file),
            "sha256": sha256,
            "scene": self.of.scene,
            "bhr": env!("CARGO_PKG_VERSION"),
            "backend": self.backend,
            "adapter": self.adapter,
            "tile": tile,
            "seconds": self.seconds,
        });
        append(manifest, &line)
    }
}

/// Appends a line, behind the end of one that another program was killed in.
fn append(manifest: &Path, line: &Value) -> Result<(), Ending> {
    let write = || {
        let mut file = OpenOptions::new().create(true).read(true).append(true).open(manifest)?;
        // Where the file system has no locks, one write at the end has to be enough.
        let _ = file.lock();
        let mut last = [b'\n'];
        if file.seek(SeekFrom::End(0))? > 0 {
            file.seek(SeekFrom::End(-1))?;
            file.read_exact(&mut last)?;
        }
        let begin = if last == *b"\n" { "" } else { "\n" };
        file.write_all(format!("{begin}{line}\n").as_bytes())
    };
    write().map_err(|error| Ending::io(manifest, error))
}

/// How much of a video is there, of which other programs or machines may have made a part: whole fragments, and their
/// bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Part {
    pub frames: usize,
    pub bytes: u64,
}

impl Part {
    /// Says that so much of the video `of` is there, flushed to disk.
    pub fn note(self, file: &Path, of: &Fingerprint, manifest: &Path) -> Result<(), Ending> {
        let line = json!({"file": name_of(file), "video": of.scene, "frames": self.frames, "bytes": self.bytes});
        append(manifest, &line)
    }
}

/// The last line of each file in a manifest. Lines that are no object, such as one that a program was killed in, count
/// as none.
pub struct Manifest {
    path: PathBuf,
    lines: HashMap<String, Line>,
    /// Bytes that have been read.
    end: u64,
}

impl Manifest {
    pub fn read(path: &Path) -> Self {
        let mut manifest = Self { path: path.to_owned(), lines: HashMap::new(), end: 0 };
        manifest.refresh();
        manifest
    }

    /// Reads what has been appended since.
    pub fn refresh(&mut self) {
        let mut bytes = Vec::new();
        let read = |bytes: &mut Vec<u8>| {
            let mut file = File::open(&self.path)?;
            file.seek(SeekFrom::Start(self.end))?;
            file.read_to_end(bytes)
        };
        // One that is not there says nothing.
        if read(&mut bytes).is_err() {
            return;
        }
        // A line that is being written is read when it is whole.
        let whole = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
        self.end += whole as u64;
        for line in String::from_utf8_lossy(bytes.get(..whole).unwrap_or_default()).lines() {
            let Ok(line) = serde_json::from_str::<Value>(line) else { continue };
            if let Some(file) = line["file"].as_str() {
                self.lines.insert(file.to_owned(), Line::of(&line));
            }
        }
    }

    /// Whether a file is there, whole, and of this frame as far as that is known. A tile that nobody has noted could
    /// not be joined.
    pub fn has(&self, file: &Path, of: &Fingerprint) -> bool {
        let is_file = std::fs::metadata(file).is_ok_and(|found| found.is_file() && found.len() > 0);
        is_file
            && match self.frame_of(file) {
                None => of.tile.is_none(),
                Some(noted) => noted.is_some_and(|noted| noted == *of),
            }
    }

    /// Whether some line speaks of a file.
    pub fn knows(&self, file: &Path) -> bool {
        self.lines.contains_key(&name_of(file))
    }

    /// How much of a video is there, of one that is like `of` in all.
    pub fn part_of(&self, file: &Path, of: &Fingerprint) -> Option<Part> {
        match self.lines.get(&name_of(file))? {
            Line::Part { video, part } if **video == of.scene => Some(*part),
            _ => None,
        }
    }

    /// The frame that a file shows. The outer `None`: nobody has noted it; the inner one: it was being written.
    pub fn frame_of(&self, file: &Path) -> Option<Option<Fingerprint>> {
        match self.lines.get(&name_of(file))? {
            Line::Whole { frame, scene, tile } => {
                let tile = tile.as_deref().copied();
                Some(Some(Fingerprint { frame: *frame, scene: scene.as_ref().into(), tile }))
            }
            Line::Part { .. } | Line::Announced => Some(None),
        }
    }
}

/// The part of a line that counts. Films of many frames have many lines.
enum Line {
    Announced,
    Whole { frame: u32, scene: Box<str>, tile: Option<Box<Tile>> },
    Part { video: Box<str>, part: Part },
}

impl Line {
    fn of(line: &Value) -> Self {
        let number = |value: &Value| value.as_u64().and_then(|number| u32::try_from(number).ok());
        let side = |name: &str| number(&line["tile"][name]);
        let tile = || {
            let (full_width, full_height) = (side("full_width")?, side("full_height")?);
            let region = Region { full_width, full_height, x: side("x")?, y: side("y")? };
            Some(Box::new(Tile { region, size: [side("width")?, side("height")?] }))
        };
        let part = || {
            let frames = usize::try_from(line["frames"].as_u64()?).ok()?;
            Some(Part { frames, bytes: line["bytes"].as_u64()? })
        };
        match (line["scene"].as_str(), number(&line["frame"]), line["video"].as_str(), part()) {
            (Some(scene), Some(frame), _, _) => Self::Whole { frame, scene: scene.into(), tile: tile() },
            (_, _, Some(video), Some(part)) => Self::Part { video: video.into(), part },
            _ => Self::Announced,
        }
    }
}
