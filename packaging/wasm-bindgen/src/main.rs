// SPDX-License-Identifier: MIT OR Apache-2.0
//! Makes the JavaScript that calls a module of WebAssembly, and its types, as `wasm-bindgen --target web
//! --remove-name-section --remove-producers-section --out-dir FOLDER MODULE` does. Knows nothing of bhr.

use std::process::ExitCode;
use wasm_bindgen_cli_support::Bindgen;

fn main() -> ExitCode {
    let arguments = std::env::args_os().skip(1).collect::<Vec<_>>();
    let [module, folder] = &arguments[..] else {
        eprintln!("usage: bhr-wasm-bindgen MODULE FOLDER");
        return ExitCode::from(2);
    };
    let mut bindgen = Bindgen::new();
    let bindgen = bindgen.input_path(module).typescript(true).omit_default_module_path(false);
    let bindgen = bindgen.remove_name_section(true).remove_producers_section(true);
    match bindgen.web(true).and_then(|bindgen| bindgen.generate(folder)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error:#}");
            ExitCode::FAILURE
        }
    }
}
