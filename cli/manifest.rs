// SPDX-License-Identifier: MIT OR Apache-2.0
//! The file beside the frames that says how each was made: one JSON object a line, appended in one write, so that
//! several programs may write to one file; of several lines for a file the last one counts. Knows no scene.

use crate::ending::Ending;
use bhr::scene::Region;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::collections::HashMap;
use std::fs::OpenOptions;
use std::io::Write;
use std::path::{Path, PathBuf};

/// How a frame was made.
#[derive(Clone)]
pub struct Made {
    pub frame: u32,
    pub file: PathBuf,
    /// [`hash`] of all that its bytes depend on.
    pub scene: String,
    pub adapter: String,
    pub backend: String,
    /// The part of the full frame that it is.
    pub region: Option<Region>,
    pub size: [u32; 2],
    pub seconds: f64,
}

/// The SHA-256 of some bytes, in hexadecimal digits.
pub fn hash(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

fn name_of(file: &Path) -> String {
    file.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

impl Made {
    /// The frame's line: its file is there, whole.
    fn line(&self) -> std::io::Result<String> {
        let tile = self.region.map(|region| {
            let [width, height] = self.size;
            json!({"x": region.x, "y": region.y, "width": width, "height": height,
                   "full_width": region.full_width, "full_height": region.full_height})
        });
        let line = json!({
            "frame": self.frame,
            "file": name_of(&self.file),
            "sha256": hash(&std::fs::read(&self.file)?),
            "scene": self.scene,
            "bhr": env!("CARGO_PKG_VERSION"),
            "backend": self.backend,
            "adapter": self.adapter,
            "tile": tile,
            "seconds": self.seconds,
        });
        Ok(format!("{line}\n"))
    }

    /// Appends the frame's line to a manifest.
    pub fn note(&self, manifest: &Path) -> Result<(), Ending> {
        let append = || {
            let line = self.line()?;
            OpenOptions::new().create(true).append(true).open(manifest)?.write_all(line.as_bytes())
        };
        append().map_err(|error| Ending::io(manifest, error))
    }
}

/// The last line of each file in a manifest. Lines that are no object, such as one that a program was killed in, count
/// as none.
pub struct Manifest(HashMap<String, Value>);

impl Manifest {
    pub fn read(path: &Path) -> Self {
        let text = std::fs::read(path).unwrap_or_default();
        let text = String::from_utf8_lossy(&text);
        let lines = text.lines().filter_map(|line| serde_json::from_str::<Value>(line).ok());
        Self(lines.filter_map(|line| Some((line["file"].as_str()?.to_owned(), line))).collect())
    }

    /// The hash of the scene that a file shows; `None` where nobody has noted it.
    pub fn scene_of(&self, file: &Path) -> Option<&str> {
        self.0.get(&name_of(file))?["scene"].as_str()
    }

    /// Where a tile belongs: the part of the frame that it is.
    pub fn region_of(&self, file: &Path) -> Option<Region> {
        let tile = &self.0.get(&name_of(file))?["tile"];
        let side = |name: &str| tile[name].as_u64().and_then(|side| u32::try_from(side).ok());
        Some(Region {
            full_width: side("full_width")?,
            full_height: side("full_height")?,
            x: side("x")?,
            y: side("y")?,
        })
    }
}
