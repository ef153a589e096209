//! Sets the shared library's link options.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    // Drivers leave handlers that run at thread exit; unmapping the library under them would crash the host. No soname
    // is set: a program linked with -lbhr finds libbhr.so by the name that cargo gives it.
    if matches!(std::env::var("CARGO_CFG_TARGET_OS").as_deref(), Ok("linux" | "android" | "freebsd")) {
        println!("cargo:rustc-cdylib-link-arg=-Wl,-z,nodelete");
    }
}
