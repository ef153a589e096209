// SPDX-License-Identifier: MIT OR Apache-2.0
//! Numbers and words about adapters, frames, holes and rays, as plain objects of a page under the C API's names.

use crate::scene::query::HoleInfo;
use crate::scene::{Fate, Hit, Ray};
use crate::tracer::{AdapterInfo, FrameStats};
use glam::DVec3;
use js_sys::{Array, Float64Array, JsString, Object, Reflect};
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

/// BhrHoleInfo.
pub fn of_hole(info: &HoleInfo) -> Object {
    let number = |value: f64| JsValue::from(value);
    object(&[
        ("horizon_radius", number(info.horizon_radius)),
        ("ergosphere_equatorial_radius", number(info.ergosphere_equatorial_radius)),
        ("photon_orbit_prograde", number(info.photon_orbit_prograde)),
        ("photon_orbit_retrograde", number(info.photon_orbit_retrograde)),
        ("isco_prograde", number(info.isco_prograde)),
        ("isco_retrograde", number(info.isco_retrograde)),
        ("critical_impact_parameter", number(info.critical_impact_parameter)),
        ("shadow_angular_radius", number(info.shadow_angular_radius)),
        ("camera_radius", number(info.camera_radius)),
        ("camera_time_rate", number(info.camera_time_rate)),
        ("inner_horizon_radius", number(info.inner_horizon_radius)),
    ])
}

fn vector(vector: DVec3) -> JsValue {
    vector.to_array().into_iter().map(JsValue::from).collect::<Array>().into()
}

/// The end of the name of the C API's fate (BHR_FATE_*), as a word.
fn word(fate: Fate) -> &'static str {
    match fate {
        Fate::Captured => "captured",
        Fate::Escaped => "escaped",
        Fate::Unresolved => "unresolved",
        Fate::Invalid => "invalid",
    }
}

/// BhrRay and BhrHit in one object, and the path: x, y, z and t of each point.
pub fn of_ray(ray: &Ray, hit: &Hit, path: &[[f64; 4]]) -> Object {
    let crossings = hit.crossings.iter().take(hit.crossing_count as usize).map(|crossing| {
        object(&[
            ("radius", JsValue::from(crossing.radius)),
            ("azimuth", JsValue::from(crossing.azimuth)),
            ("redshift", JsValue::from(crossing.redshift)),
            ("delay", JsValue::from(crossing.delay)),
        ])
    });
    object(&[
        ("position", vector(ray.position)),
        ("direction", vector(ray.direction)),
        ("frequency_ratio", JsValue::from(ray.frequency_ratio)),
        ("fate", JsValue::from(word(hit.fate))),
        ("steps", JsValue::from(hit.steps)),
        ("sky_direction", vector(hit.sky_direction)),
        ("sky_redshift", JsValue::from(hit.sky_redshift)),
        ("swept_angle", JsValue::from(hit.swept_angle)),
        ("crossings", crossings.collect::<Array>().into()),
        ("path", Float64Array::from(path.as_flattened()).into()),
    ])
}
