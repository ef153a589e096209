// SPDX-License-Identifier: MIT OR Apache-2.0
//! Versions: the header's (constants) and the loaded library's (functions). The crate's version in Cargo.toml must
//! agree.

use std::ffi::c_char;

/// This header's major version. Before 1.0, minor versions only add.
pub const BHR_VERSION_MAJOR: u32 = 0;
/// This header's minor version.
pub const BHR_VERSION_MINOR: u32 = 2;
/// This header's patch version.
pub const BHR_VERSION_PATCH: u32 = 0;
/// The value to pass to bhr_context_create: N of libbhr.so.N.
pub const BHR_ABI_VERSION: u32 = 0u32;

const fn number(text: &str) -> u32 {
    match u32::from_str_radix(text, 10) {
        Ok(number) => number,
        Err(_) => u32::MAX,
    }
}

const _: () = assert!(
    number(env!("CARGO_PKG_VERSION_MAJOR")) == BHR_VERSION_MAJOR
        && number(env!("CARGO_PKG_VERSION_MINOR")) == BHR_VERSION_MINOR
        && number(env!("CARGO_PKG_VERSION_PATCH")) == BHR_VERSION_PATCH,
    "the BHR_VERSION_* constants and Cargo.toml disagree"
);

/// The loaded library's version: major << 16 | minor << 8 | patch.
#[unsafe(no_mangle)]
pub extern "C" fn bhr_version() -> u32 {
    BHR_VERSION_MAJOR << 16 | BHR_VERSION_MINOR << 8 | BHR_VERSION_PATCH
}

/// BHR_ABI_VERSION of the loaded library.
#[unsafe(no_mangle)]
pub extern "C" fn bhr_abi_version() -> u32 {
    BHR_ABI_VERSION
}

/// The loaded library's version, such as "0.2.0"; static.
#[unsafe(no_mangle)]
pub extern "C" fn bhr_version_string() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}
