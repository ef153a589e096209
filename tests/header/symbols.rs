// SPDX-License-Identifier: MIT OR Apache-2.0
//! The shared library exports exactly the header's functions, and stays mapped when a host closes it.

use crate::c_header::{HEADER, INTEROP, functions, library};
use object::Object;
use std::collections::BTreeSet;

#[test]
fn exported_symbols_are_the_headers_functions() {
    let bytes = std::fs::read(library()).unwrap();
    let file = object::File::parse(bytes.as_slice()).unwrap();
    let exported = file
        .exports()
        .unwrap()
        .map(|export| String::from_utf8(export.unwrap().name().into_name().unwrap().to_vec()).unwrap())
        .map(|name| if cfg!(target_vendor = "apple") { name.trim_start_matches('_').into() } else { name })
        .collect::<BTreeSet<String>>();
    let declared = functions(HEADER).into_iter().chain(functions(INTEROP)).collect::<BTreeSet<_>>();
    assert!(declared.len() > 60, "the header declares {} functions", declared.len());
    assert_eq!(exported, declared);
}

/// Graphics drivers leave handlers that run when a thread ends; a library unmapped by then would take the host down.
#[cfg(target_os = "linux")]
#[test]
fn the_library_stays_mapped_after_dlclose() {
    use object::elf::{DF_1_NODELETE, DT_FLAGS_1, FileHeader64};
    use object::read::elf::{Dyn, FileHeader, ProgramHeader};

    let bytes = std::fs::read(library()).unwrap();
    let header = FileHeader64::<object::Endianness>::parse(bytes.as_slice()).unwrap();
    let endian = header.endian().unwrap();
    let flags = header
        .program_headers(endian, bytes.as_slice())
        .unwrap()
        .iter()
        .filter_map(|segment| segment.dynamic(endian, bytes.as_slice()).unwrap())
        .flatten()
        .find(|entry| entry.d_tag(endian) == DT_FLAGS_1)
        .map(|entry| entry.d_val(endian))
        .expect("the library has DT_FLAGS_1");
    assert_ne!(flags & DF_1_NODELETE.0, 0, "flags are {flags:#x}");
}
