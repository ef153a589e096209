//! Makes the C header, OUT_DIR/bhr.h, from `src/capi` through cbindgen, one section per source file, and sets the
//! shared library's link options. `tests/header.rs` holds include/bhr.h against it.

use std::path::{Path, PathBuf};
use std::{env, fs};

/// The header's sections in order (a type stands before its first use): source file, title.
const SECTIONS: [(&str, &str); 21] = [
    ("version", "version"),
    ("status", "status, messages"),
    ("log", "log"),
    ("adapter", "adapters"),
    ("window", "windows of the host"),
    ("context", "context"),
    ("hole", "the black hole"),
    ("camera", "the camera: an observer with a lens"),
    ("disk", "accretion disk"),
    ("image", "images in the host's memory"),
    ("sky", "sky"),
    ("film", "film"),
    ("effects", "relativistic effects, time"),
    ("quality", "quality"),
    ("view", "what a pixel shows"),
    ("region", "parts of a larger frame"),
    ("render", "rendering into memory"),
    ("job", "rendering in the background"),
    ("surface", "rendering into windows"),
    ("rays", "rays: the same tracer, asked directly"),
    ("stats", "numbers about the last finished frame"),
];

/// Between the preface and the first section.
const OPENING: &str = r#"
#ifndef BHR_H
#define BHR_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif
"#;

/// After the last section.
const CLOSING: &str = "
#ifdef __cplusplus
}
#endif

#endif
";

fn main() -> Result<(), String> {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=cbindgen.toml");
    println!("cargo:rerun-if-changed=src/capi");
    // Drivers leave handlers that run at thread exit; unmapping the library under them would crash the host. No soname
    // is set: a program linked with -lbhr finds libbhr.so by the name that cargo gives it.
    if matches!(env::var("CARGO_CFG_TARGET_OS").as_deref(), Ok("linux" | "android" | "freebsd")) {
        println!("cargo:rustc-cdylib-link-arg=-Wl,-z,nodelete");
    }
    let out_dir = env::var("OUT_DIR").map_err(|error| format!("OUT_DIR: {error}"))?;
    let header = PathBuf::from(out_dir).join("bhr.h");
    fs::write(&header, make_header()?).map_err(|error| format!("{}: {error}", header.display()))
}

fn make_header() -> Result<String, String> {
    let mut config = cbindgen::Config::from_file("cbindgen.toml")?;
    let preface = config.header.take().unwrap_or_default();
    let mut header = format!("{}\n{OPENING}", preface.trim());
    for (file, title) in SECTIONS {
        let path = Path::new("src/capi").join(file).with_extension("rs");
        header += &format!("\n/* ---- {title} ---- */\n\n{}\n", section(&path, &config)?.trim());
    }
    Ok(header + CLOSING)
}

/// What one source file adds. Types of other sections are named without being known, which is all that C needs.
fn section(path: &Path, config: &cbindgen::Config) -> Result<String, String> {
    let bindings = cbindgen::Builder::new()
        .with_config(config.clone())
        .with_src(path)
        .generate()
        .map_err(|error| format!("{}: {error}", path.display()))?;
    let mut text = Vec::new();
    bindings.write(&mut text);
    let text = String::from_utf8(text).map_err(|error| format!("{}: {error}", path.display()))?;
    Ok(tidy(&text))
}

/// Comments of one line on one line, and structs by their typedef, which every struct has.
fn tidy(text: &str) -> String {
    let text = text.replace("typedef struct Bhr", "typedef-Bhr").replace("struct Bhr", "Bhr");
    let text = text.replace("typedef-Bhr", "typedef struct Bhr");
    let lines: Vec<&str> = text.lines().collect();
    let mut tidied = String::new();
    let mut rest = lines.as_slice();
    while let [first, after @ ..] = rest {
        rest = match after {
            [line, end, after @ ..] if first.trim() == "/**" && end.trim() == "*/" => {
                let comment = line.trim().trim_start_matches("* ");
                tidied += &format!("{}{comment} */\n", first.replace("/**", "/** "));
                after
            }
            _ => {
                tidied += &format!("{first}\n");
                after
            }
        };
    }
    tidied
}
