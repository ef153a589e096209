// SPDX-License-Identifier: MIT OR Apache-2.0
//! Sets the shared library's link options, and lists the files of shaders/ for src/gpu/kernel/fragments.rs.

use std::io;
use std::path::{Path, PathBuf};

fn main() -> io::Result<()> {
    println!("cargo:rerun-if-changed=build.rs");
    // Where there is Vulkan, by which hosts share memory: not on Apple's systems, and not in pages. Elsewhere files
    // with stand-ins take the places of those that are about it.
    println!("cargo:rustc-check-cfg=cfg(shares_memory)");
    let target = |key: &str| std::env::var(format!("CARGO_CFG_TARGET_{key}")).unwrap_or_default();
    if target("VENDOR") != "apple" && target("ARCH") != "wasm32" {
        println!("cargo:rustc-cfg=shares_memory");
    }
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
            // The library, and the program bhr.
            println!("cargo:rustc-cdylib-link-arg=-Wl,--wrap={name}");
            println!("cargo:rustc-link-arg-bins=-Wl,--wrap={name}");
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
            let text = if std::env::var("CARGO_CFG_TARGET_ARCH").is_ok_and(|arch| arch == "wasm32") {
                format!("{:?}", without_comments(&std::fs::read_to_string(&path)?))
            } else {
                format!("include_str!(concat!(env!(\"CARGO_MANIFEST_DIR\"), \"/shaders/{room}/{file}.wgsl\"))")
            };
            list.push(format!("(\"{room}/{file}\", {text}),\n"));
        }
    }
    list.sort();
    std::fs::write(variable("OUT_DIR")?.join("shaders.rs"), format!("&[\n{}]\n", list.concat()))
}

/// WGSL, which has no strings, without comments and indents: a third less for a page to load.
fn without_comments(text: &str) -> String {
    let bare = text.lines().map(|line| line.split("//").next().unwrap_or_default().trim());
    bare.filter(|line| !line.is_empty()).map(|line| format!("{line}\n")).collect()
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
