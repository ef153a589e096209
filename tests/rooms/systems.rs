// SPDX-License-Identifier: MIT OR Apache-2.0
//! Systems and processors are told from each other in src/platform. Elsewhere only the files below ask for which one
//! they are compiled.

use crate::written::written;
use std::collections::BTreeSet;
use std::path::Path;

/// The files besides src/platform, by their paths below src/.
const FILES: [&str; 10] = [
    // These choose a file for a module: what a crate has on some systems only, or its stand-in.
    "cpu/mod.rs",
    "gpu/device/mod.rs",
    "window/memory.rs",
    "window/mod.rs",
    // Types of wgpu's that are there on some systems only.
    "gpu/device/interfaces.rs",
    // Rooms that only pages have.
    "gpu/mod.rs",
    "lib.rs",
    // Tests of what one system or processor has.
    "gpu/device/driver_lock.rs",
    "image/file/tests.rs",
    "thread_state/tests.rs",
];

/// Whether a line of code, which may be a part of an attribute, names a system or a processor.
fn asks(line: &str) -> bool {
    let code = line.trim_start();
    let names_one = ["_os =", "_vendor =", "_arch =", "_family =", "_env =", "_abi ="]
        .iter()
        .any(|key| code.contains(&format!("target{key}")))
        || code.split(['(', ',', ')']).any(|word| matches!(word.trim(), "unix" | "windows"));
    !code.starts_with("//")
        && names_one
        && (code.contains("cfg") || code.starts_with("not(") || code.starts_with("all("))
}

#[test]
fn systems_are_told_apart_in_one_room() {
    let found = written().into_iter().filter_map(|(path, _, text)| {
        let place = path.strip_prefix("src").ok().filter(|place| !place.starts_with("platform"))?;
        text.lines().any(asks).then(|| place.to_owned())
    });
    let (found, listed) = (found.collect::<BTreeSet<_>>(), FILES.map(|file| Path::new(file).to_owned()).into());
    assert_eq!(found, listed, "what differs by system belongs in src/platform; FILES has what cannot stand there");
}

#[test]
fn questions_for_systems_are_found() {
    for line in [
        "#[cfg(unix)]",
        "    #[cfg(all(feature = \"gl\", not(target_vendor = \"apple\")))]",
        "    if cfg!(windows) {",
        "    not(all(feature = \"window\", unix, not(target_os = \"android\"))),",
        "#[cfg_attr(target_vendor = \"apple\", path = \"vulkan_absent.rs\")]",
    ] {
        assert!(asks(line), "{line}");
    }
    for line in ["// #[cfg(unix)]", "#[cfg(test)]", "cfg!(target_endian = \"big\")", "for pair in list.windows(2) {"] {
        assert!(!asks(line), "{line}");
    }
}
