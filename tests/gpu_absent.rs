// SPDX-License-Identifier: MIT OR Apache-2.0
//! Searches for adapters where there is no loader, and where there is no driver: each in a process of its own, in
//! silence.
#![cfg(target_os = "linux")]

use bhr::gpu::{Search, adapters};
use bhr::renderer::Backend;
use std::process::Command;

#[test]
#[ignore = "run by the tests below, with the drivers hidden"]
fn child_finds_nothing() {
    for search in [Search::All, Search::Auto, Search::Only(Backend::Vulkan), Search::Only(Backend::Gl)] {
        for validation in [false, true] {
            let found = adapters(search, validation).into_iter().map(|a| a.info).collect::<Vec<_>>();
            assert!(found.is_empty(), "{search:?}: {found:?}");
        }
    }
}

/// Runs the test above with `hide` in its environment.
fn silent_child(hide: &[(&str, &str)]) {
    let child = Command::new(std::env::current_exe().unwrap())
        .args(["--ignored", "--exact", "child_finds_nothing", "--nocapture"])
        .envs(hide.iter().copied())
        .output()
        .unwrap();
    let (out, err) = (String::from_utf8_lossy(&child.stdout), String::from_utf8_lossy(&child.stderr));
    assert!(child.status.success(), "{out}{err}");
    assert!(out.contains("1 passed"), "{out}");
    assert_eq!(err, "", "something was printed");
}

#[test]
fn without_a_driver_the_list_is_empty() {
    silent_child(&[
        ("VK_DRIVER_FILES", "/nonexistent"),
        ("VK_ICD_FILENAMES", "/nonexistent"),
        ("__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent"),
        ("XDG_RUNTIME_DIR", "/nonexistent"),
    ]);
}

#[test]
fn without_a_loader_the_list_is_empty() {
    let folder = std::env::temp_dir().join(format!("bhr-no-loader-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    // The dynamic linker stops at the first file of the name, and these are no libraries.
    for name in ["libvulkan.so.1", "libvulkan.so", "libEGL.so.1", "libEGL.so"] {
        std::fs::write(folder.join(name), "").unwrap();
    }
    silent_child(&[("LD_LIBRARY_PATH", folder.to_str().unwrap())]);
    std::fs::remove_dir_all(folder).unwrap();
}
