// SPDX-License-Identifier: MIT OR Apache-2.0
//! Numbers and words about adapters and frames, as plain objects of a page under the C API's names.

use crate::tracer::{AdapterInfo, FrameStats};
use js_sys::{JsString, Object, Reflect};
use wasm_bindgen::JsValue;

fn object(fields: &[(&str, JsValue)]) -> Object {
    let object = Object::new();
    for (name, value) in fields {
        // Setting a property of an object that is new does not fail.
        let _ = Reflect::set(&object, &JsString::from(*name), value);
    }
    object
}

/// BhrFrameStats.
pub fn of_stats(stats: &FrameStats) -> Object {
    let number = |value: u64| JsValue::from(value as f64);
    object(&[
        ("frame_index", number(stats.frame_index)),
        ("rays", number(stats.rays)),
        ("steps", number(stats.steps)),
        ("cpu_ns", number(stats.cpu_ns)),
        ("gpu_ns", number(stats.gpu_ns)),
        ("readback_ns", number(stats.readback_ns)),
        ("device_bytes", number(stats.device_bytes)),
        ("lens_tables", number(stats.lens_tables)),
        ("auto_ev", JsValue::from(stats.auto_ev)),
    ])
}

/// BhrAdapterInfo, but for the ids that pages are not told.
pub fn of_adapter(info: &AdapterInfo) -> Object {
    object(&[
        ("backend", JsValue::from(info.backend.to_string().to_lowercase())),
        ("name", JsValue::from(info.name.as_str())),
        ("driver", JsValue::from(info.driver.as_str())),
        ("discrete", JsValue::from(info.discrete)),
        ("software", JsValue::from(info.software)),
    ])
}
