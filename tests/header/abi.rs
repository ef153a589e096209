// SPDX-License-Identifier: MIT OR Apache-2.0
//! Programs that were compiled against a release's header (tests/abi) run with today's library, and what that header
//! declares is declared today: the same values, places, types and prototypes. Structs may have grown at their end,
//! and more may have been added.

use crate::c_header::{
    HEADER, compiler, constants, functions, library, prototypes, root, run, scratch, structs, table,
};
use crate::json::{committed, entries, text};
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::process::Command;

/// A release and its header's fingerprint, FNV-1a of 64 bits. Append only.
const RELEASES: [(&str, u64); 1] = [("0.1.0", 0x1ebe720255e772a3)];

fn path(kind: &str, release: &str, ending: &str) -> PathBuf {
    root().join(format!("tests/abi/{kind}-{release}.{ending}"))
}

fn header(release: &str) -> String {
    std::fs::read_to_string(path("bhr", release, "h")).unwrap()
}

/// Fowler, Noll, Vo: offset 14695981039346656037, prime 2^40 + 2^8 + 0xb3.
fn fingerprint(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

/// The compiler with a release's header, and warnings that find what C would convert in silence.
fn compiler_for(release: &str) -> Command {
    let mut command = compiler(false);
    command.args(["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-I"]).arg(root().join("tests/abi"));
    command.arg(path("host", release, "c"));
    command
}

#[test]
fn released_headers_are_as_they_were_released() {
    assert_eq!(fingerprint("foobar"), 0x8594_4171_f739_67e8, "the reference value of FNV-1a");
    for (release, released) in RELEASES {
        assert_eq!(fingerprint(&header(release)), released, "tests/abi/bhr-{release}.h was changed");
    }
}

#[test]
fn hosts_use_every_function_and_struct_of_their_header() {
    for (release, _) in RELEASES {
        let object = scratch("abi_objects").join(format!("host-{release}.o"));
        run(compiler_for(release).arg("-c").arg("-o").arg(&object));
        let bytes = std::fs::read(&object).unwrap();
        let file = object::File::parse(bytes.as_slice()).unwrap();
        let used = object::Object::symbols(&file)
            .filter(object::ObjectSymbol::is_undefined)
            .filter_map(|symbol| object::ObjectSymbol::name(&symbol).ok().map(|name| name.trim_start_matches('_')))
            .filter(|name| name.starts_with("bhr_"))
            .map(str::to_owned)
            .collect::<BTreeSet<_>>();
        assert_eq!(used, functions(&header(release)), "host-{release}.c");
        let host = std::fs::read_to_string(path("host", release, "c")).unwrap();
        for (name, _) in structs(&header(release)) {
            assert!(host.contains(&name), "host-{release}.c does without {name}");
        }
    }
}

#[test]
fn hosts_of_every_release_run_with_todays_library() {
    let library = library();
    let folder = library.parent().unwrap();
    for (release, _) in RELEASES {
        let scratch = scratch(&format!("abi_host_{release}"));
        let host = scratch.join("host");
        run(compiler_for(release).arg("-o").arg(&host).arg("-L").arg(folder).args(["-lbhr", "-lm"]));
        let paths = ["LD_LIBRARY_PATH", "DYLD_LIBRARY_PATH"].map(|name| (name, folder));
        let said = run(Command::new(&host).arg(&scratch).envs(paths).env_remove("DISPLAY"));
        assert_eq!(said.trim(), "0 failed");
    }
}

/// A host that must run with older libraries too finds out here what they have not.
#[test]
fn what_the_last_release_has_not_says_since_when_it_is_there() {
    let (release, _) = RELEASES[RELEASES.len() - 1];
    let old = header(release);
    let json = committed();
    let today = env!("CARGO_PKG_VERSION");
    let new = |list: &str, names: &BTreeSet<String>| {
        for name in names {
            assert_ne!(today, release, "{name} is not in the release of this version: raise the version");
            let entry = entries(&json, list).iter().find(|entry| entry["name"] == **name).unwrap();
            assert_eq!(entry["since"], today, "{name}: its comment, or that of its type, ends with @since {today}");
        }
    };
    new("functions", &(&functions(HEADER) - &functions(&old)));
    new("constants", &(&constants(HEADER) - &constants(&old)));
    let olds: BTreeMap<_, _> = structs(&old).into_iter().collect();
    for object in entries(&json, "structs") {
        let name = text(&object["name"]);
        let kept = olds.get(name).map_or(0, Vec::len);
        for field in &object["fields"].as_array().unwrap()[kept..] {
            let field_name = text(&field["name"]);
            assert_eq!(field["since"], today, "{name}.{field_name}: its comment ends with @since {today}");
        }
    }
}

/// The constants and fields that `text` declares, with their values and places in the header `name` of `folder`, as a
/// C compiler sees them.
fn places(text: &str, folder: &str, name: &str) -> Vec<String> {
    let (source, binary) = (scratch("abi_places").join(format!("{name}.c")), scratch("abi_places").join(name));
    std::fs::write(&source, table(text, &format!("{name}.h"))).unwrap();
    run(compiler(false).args(["-std=c11", "-I"]).arg(root().join(folder)).arg(&source).arg("-o").arg(&binary));
    run(&mut Command::new(binary)).lines().map(str::to_owned).collect()
}

#[test]
fn what_a_release_declared_is_declared_today() {
    for (release, _) in RELEASES {
        let old = header(release);
        assert!(functions(&old).is_subset(&functions(HEADER)) && constants(&old).is_subset(&constants(HEADER)));
        // A struct's own size, a line of two words without a dot, may have grown; versions are what releases change.
        let kept = |folder: &str, name: &str| {
            let mut lines = places(&old, folder, name);
            lines.retain(|line| line.contains('.') || line.split(' ').count() != 2);
            lines.retain(|line| !line.starts_with("BHR_VERSION_"));
            lines
        };
        let (then, now) = (kept("tests/abi", &format!("bhr-{release}")), kept("include", "bhr"));
        assert!(then.len() > 180, "{then:?}");
        assert_eq!(then, now, "left: {release}, right: today");
        let source = scratch("abi_prototypes").join(format!("repeat-{release}.c"));
        std::fs::write(&source, format!("#include \"bhr.h\"\n{}", prototypes(&old))).unwrap();
        let mut command = compiler(false);
        command.args(["-std=c11", "-Wall", "-Werror", "-fsyntax-only", "-I"]).arg(root().join("include"));
        run(command.arg(&source));
    }
}
