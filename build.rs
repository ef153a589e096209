//! Sets the shared library's link options, and lists the files of shaders/ for src/gpu/kernel/fragments.rs.

use std::io;
use std::path::{Path, PathBuf};

fn main() -> io::Result<()> {
    println!("cargo:rerun-if-changed=build.rs");
    // Drivers leave handlers that run at thread exit; unmapping the library under them would crash the host. No soname
    // is set: a program linked with -lbhr finds libbhr.so by the name that cargo gives it.
    if matches!(std::env::var("CARGO_CFG_TARGET_OS").as_deref(), Ok("linux" | "android" | "freebsd")) {
        println!("cargo:rustc-cdylib-link-arg=-Wl,-z,nodelete");
    }
    list_shaders()
}

/// Writes shaders.rs: name and text of every file of shaders/, in order.
fn list_shaders() -> io::Result<()> {
    println!("cargo:rerun-if-changed=shaders");
    let variable = |name: &str| std::env::var(name).map(PathBuf::from).map_err(io::Error::other);
    let folder = variable("CARGO_MANIFEST_DIR")?.join("shaders");
    let mut list = Vec::new();
    for room in entries(&folder)? {
        for file in entries(&room)?.into_iter().filter(|path| path.extension().is_some_and(|e| e == "wgsl")) {
            let name = file.with_extension("").strip_prefix(&folder).map_err(io::Error::other)?.to_owned();
            let name = name.iter().map(|part| part.to_string_lossy()).collect::<Vec<_>>().join("/");
            list.push(format!("({name:?}, include_str!({file:?})),\n"));
        }
    }
    list.sort();
    std::fs::write(variable("OUT_DIR")?.join("shaders.rs"), format!("&[\n{}]\n", list.concat()))
}

fn entries(folder: &Path) -> io::Result<Vec<PathBuf>> {
    std::fs::read_dir(folder)?.map(|entry| entry.map(|entry| entry.path())).collect()
}
