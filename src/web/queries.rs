// SPDX-License-Identifier: MIT OR Apache-2.0
//! Questions about a scene that need no frame: numbers about the hole, and the ray through a pixel. Answered at once,
//! in double precision.

use super::message::thrown;
use super::numbers;
use super::text::scene_of;
use crate::capi::scene_file::Moment;
use crate::error::Result;
use crate::scene::host_rays::{trace_path, trace_ray};
use js_sys::Object;
use wasm_bindgen::prelude::wasm_bindgen;

/// Points of a ray's path.
const PATH_POINTS: usize = 2048;

/// BhrHoleInfo of a scene's text. Throws as `checkScene`.
#[wasm_bindgen(js_name = holeInfo)]
pub fn hole_info(text: &str, seconds: f64) -> Result<Object, js_sys::Error> {
    let info = scene_of(text, seconds).and_then(|Moment { scene, .. }| scene.hole_info()).map_err(thrown)?;
    Ok(numbers::of_hole(&info))
}

/// The ray through a pixel position of a frame, what it hits, and the points of its path (bhr_camera_ray,
/// bhr_trace_rays, bhr_trace_path). Throws the messages of these.
#[wasm_bindgen(js_name = tracedRay)]
pub fn traced_ray(text: &str, seconds: f64, x: f64, y: f64, width: u32, height: u32) -> Result<Object, js_sys::Error> {
    try_traced_ray(text, seconds, [x, y], [width, height]).map_err(thrown)
}

fn try_traced_ray(text: &str, seconds: f64, [x, y]: [f64; 2], [width, height]: [u32; 2]) -> Result<Object> {
    let Moment { scene, region } = scene_of(text, seconds)?;
    let ray = scene.camera_ray(width, height, region, x, y)?;
    let hit = trace_ray(&scene, &scene.quality.ray_settings(scene.hole.spin), &ray);
    let path = trace_path(&scene, &ray, PATH_POINTS)?;
    Ok(numbers::of_ray(&ray, &hit, &path))
}
