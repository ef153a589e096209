//! Versions: of the header (constants), of the loaded library (functions). The crate's version in Cargo.toml must
//! agree.

use std::ffi::c_char;

/// Of this header. Before 1.0 a greater minor version may add functions and grow structs; it removes nothing within
/// one BHR_ABI_VERSION.
pub const BHR_VERSION_MAJOR: u32 = 0;
/// Of this header.
pub const BHR_VERSION_MINOR: u32 = 1;
/// Of this header.
pub const BHR_VERSION_PATCH: u32 = 0;
/// What bhr_context_create wants to be told: N of libbhr.so.N.
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

/// Of the loaded library: major << 16 | minor << 8 | patch. Any thread, inside callbacks too.
#[unsafe(no_mangle)]
pub extern "C" fn bhr_version() -> u32 {
    BHR_VERSION_MAJOR << 16 | BHR_VERSION_MINOR << 8 | BHR_VERSION_PATCH
}

/// BHR_ABI_VERSION of the loaded library. Any thread, inside callbacks too.
#[unsafe(no_mangle)]
pub extern "C" fn bhr_abi_version() -> u32 {
    BHR_ABI_VERSION
}

/// Of the loaded library, such as "0.1.0"; static. Any thread, inside callbacks too.
#[unsafe(no_mangle)]
pub extern "C" fn bhr_version_string() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}
