// SPDX-License-Identifier: MIT OR Apache-2.0
//! Sets the shared library's link options, and lists the files of shaders/ for src/gpu/kernel/fragments.rs.

use std::io;
use std::path::{Path, PathBuf};

fn main() -> io::Result<()> {
    println!("cargo:rerun-if-changed=build.rs");
    if matches!(std::env::var("CARGO_CFG_TARGET_OS").as_deref(), Ok("linux" | "android" | "freebsd")) {
        // Drivers leave handlers that run at thread exit; unmapping the library under them would crash the host.
        println!("cargo:rustc-cdylib-link-arg=-Wl,-z,nodelete");
        // Without a soname, a program that names the library's file when it is linked would look for it at that path
        // for ever. The name is that of the file that cargo makes. An installed library is libbhr.so.N: ./install and
        // cargo-c give it that name.
        if std::env::var_os("CARGO_FEATURE_CAPI").is_none() {
            println!("cargo:rustc-cdylib-link-arg=-Wl,-soname,libbhr.so");
        }
    }
    take_late_functions();
    list_shaders()
}

/// The functions of src/platform/windows/late.rs take the places of imports. Microsoft's linker has no such option.
fn take_late_functions() {
    let is = |key: &str, values: &[&str]| std::env::var(key).is_ok_and(|value| values.contains(&value.as_str()));
    if is("CARGO_CFG_TARGET_OS", &["windows"])
        && is("CARGO_CFG_TARGET_ENV", &["gnu"])
        && is("CARGO_CFG_TARGET_ARCH", &["x86_64", "aarch64"])
    {
        for name in [
            "CreateDXGIFactory1",
            "wglCreateContext",
            "wglDeleteContext",
            "wglGetCurrentContext",
            "wglGetProcAddress",
            "wglMakeCurrent",
        ] {
            println!("cargo:rustc-cdylib-link-arg=-Wl,--wrap={name}");
        }
    }
}

/// Writes shaders.rs: name and text of every file of shaders/, in order. The compiler completes the paths, because
/// checkouts may share a target folder and this list with it.
fn list_shaders() -> io::Result<()> {
    println!("cargo:rerun-if-changed=shaders");
    println!("cargo:rerun-if-env-changed=CARGO_MANIFEST_DIR");
    let variable = |name: &str| std::env::var(name).map(PathBuf::from).map_err(io::Error::other);
    let mut list = Vec::new();
    for (room, path) in entries(&variable("CARGO_MANIFEST_DIR")?.join("shaders"))? {
        if !path.is_dir() {
            return Err(io::Error::other(format!("{} is no folder of shaders", path.display())));
        }
        for (file, path) in entries(&path)? {
            let Some(file) = file.strip_suffix(".wgsl").filter(|_| path.is_file()) else {
                return Err(io::Error::other(format!("{} is no file of WGSL", path.display())));
            };
            let text = format!("include_str!(concat!(env!(\"CARGO_MANIFEST_DIR\"), \"/shaders/{room}/{file}.wgsl\"))");
            list.push(format!("(\"{room}/{file}\", {text}),\n"));
        }
    }
    list.sort();
    std::fs::write(variable("OUT_DIR")?.join("shaders.rs"), format!("&[\n{}]\n", list.concat()))
}

/// Names and paths of what a folder holds, but for hidden files, which editors and desktops leave.
fn entries(folder: &Path) -> io::Result<Vec<(String, PathBuf)>> {
    let about = |error| io::Error::other(format!("{}: {error}", folder.display()));
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(about)? {
        let entry = entry.map_err(about)?;
        let name = entry.file_name().to_string_lossy().into_owned();
        if !name.starts_with('.') {
            found.push((name, entry.path()));
        }
    }
    Ok(found)
}
