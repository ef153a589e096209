// SPDX-License-Identifier: MIT OR Apache-2.0
//! Errors as pages get them, and what goes to the browser's console.

use crate::error::{Error, ErrorKind};
use js_sys::{Function, JsString, Reflect};
use std::cell::RefCell;
use std::sync::Once;
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

/// The end of the name of the C API's status (BHR_ERROR_*).
fn code(kind: ErrorKind) -> &'static str {
    match kind {
        ErrorKind::InvalidArgument => "INVALID_ARGUMENT",
        ErrorKind::InvalidState => "INVALID_STATE",
        ErrorKind::IncompatibleAbi => "INCOMPATIBLE_ABI",
        ErrorKind::Unsupported => "UNSUPPORTED",
        ErrorKind::NoAdapter => "NO_ADAPTER",
        ErrorKind::OutOfMemory => "OUT_OF_MEMORY",
        ErrorKind::Cancelled => "CANCELLED",
        ErrorKind::SurfaceLost => "SURFACE_LOST",
        ErrorKind::DeviceLost => "DEVICE_LOST",
        ErrorKind::Io => "IO",
        ErrorKind::Internal => "INTERNAL",
    }
}

/// The error that a script catches: the message, and `code`.
pub fn thrown(error: Error) -> js_sys::Error {
    let thrown = js_sys::Error::new(&error.message);
    // Setting a property of an object that is new does not fail.
    let _ = Reflect::set(&thrown, &JsString::from("code"), &JsString::from(code(error.kind)));
    thrown
}

thread_local! {
    /// The function of the page's that hears of the module's end.
    static END: RefCell<Option<Function>> = const { RefCell::new(None) };
}

/// Sends panics, and the log's warnings and errors, to the browser's console. A panic ends the module, and leaves every
/// promise of it open: `tell` is called with its message, so that the page can settle them.
#[wasm_bindgen(js_name = onEnd)]
pub fn on_end(tell: Function) {
    END.set(Some(tell));
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        std::panic::set_hook(Box::new(|panic| {
            let message = JsValue::from(format!("bhr: {panic}"));
            web_sys::console::error_1(&message);
            if let Some(tell) = END.take() {
                // One that throws changes nothing any more.
                let _ = tell.call1(&JsValue::NULL, &message);
            }
        }));
        // A program that links this crate may have a logger of its own.
        if log::set_logger(&Console).is_ok() {
            log::set_max_level(log::LevelFilter::Warn);
        }
    });
}

struct Console;

impl log::Log for Console {
    fn enabled(&self, about: &log::Metadata<'_>) -> bool {
        about.level() <= log::Level::Warn
    }

    fn log(&self, record: &log::Record<'_>) {
        if !self.enabled(record.metadata()) {
            return;
        }
        let text = JsValue::from(format!("bhr: {}", record.args()));
        match record.level() {
            log::Level::Error => web_sys::console::error_1(&text),
            _ => web_sys::console::warn_1(&text),
        }
    }

    fn flush(&self) {}
}
