// SPDX-License-Identifier: MIT OR Apache-2.0
//! `bhr map` writes a picture of the whole sky as a map in blocks of BC6H. Knows no scene.

use crate::ending::Ending;
use crate::progress::say;
use bhr::image::FromFile;
use bhr::sky::StoredMap;
use clap::ArgMatches;
use std::path::PathBuf;

pub fn run(given: &ArgMatches) -> Result<(), Ending> {
    let path = |name: &str| given.get_one::<PathBuf>(name).ok_or_else(|| Ending::usage(format!("no {name}")));
    let (picture, out) = (path("picture")?, path("out")?);
    let is_map = |ending: &std::ffi::OsStr| ending.eq_ignore_ascii_case("ktx2");
    if !out.extension().is_some_and(is_map) {
        return Err(Ending::usage(format!("--out {}: maps are .ktx2 files", out.display())));
    }
    let map = StoredMap::from_file(picture)?;
    map.save(out)?;
    let [width, height] = map.size();
    say(&format!("{}: {width} x {height} texels in blocks of BC6H", out.display()));
    Ok(())
}
