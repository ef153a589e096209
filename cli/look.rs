// SPDX-License-Identifier: MIT OR Apache-2.0
//! Commands that render nothing: what a scene is, whether it is one, what adapters there are, where a pixel's light
//! came from.

use crate::ending::Ending;
use crate::frames;
use crate::open::{self, Opened};
use crate::progress::say;
use bhr::renderer::adapters as all_adapters;
use bhr::scene::{Hit, Scene};
use clap::ArgMatches;
use serde_json::{Value, json};

/// The scene at a time, without a renderer.
fn at(opened: &Opened, seconds: f64) -> Result<Scene, Ending> {
    Ok(opened.file.at(seconds, &Scene::default())?.scene)
}

/// Tries every frame, and that its camera can be where it is.
pub fn check(given: &ArgMatches) -> Result<(), Ending> {
    let opened = open::scene(given)?;
    let render = opened.render();
    for frame in 0..render.frames() {
        let seconds = f64::from(frame) / render.frames_per_second;
        let about = |error: bhr::error::Error| Ending::data(format!("frame {frame}, {seconds} s: {error}"));
        let scene = opened.file.at(seconds, &Scene::default()).map_err(about)?.scene;
        scene.observer().map_err(about)?;
        open::check_frames(&scene)?;
    }
    say(&format!(
        "{} frames of {} x {}, {} a second: all of them can be rendered",
        render.frames(),
        render.width,
        render.height,
        render.frames_per_second
    ));
    Ok(())
}

/// A number for JSON, which has no NaN.
fn number(value: f64) -> Value {
    if value.is_finite() { json!(value) } else { Value::Null }
}

pub fn info(given: &ArgMatches) -> Result<(), Ending> {
    let opened = open::scene(given)?;
    let seconds = *given.get_one::<f64>("at").unwrap_or(&0.0);
    let scene = at(&opened, seconds)?;
    let (render, hole) = (opened.render(), scene.hole_info()?);
    let camera = scene.camera;
    say(&format!(
        "{:#}",
        json!({
            "width": render.width,
            "height": render.height,
            "frames": render.frames(),
            "frames_per_second": render.frames_per_second,
            "seconds": seconds,
            "time": scene.time,
            "mass": scene.hole.mass,
            "spin": scene.hole.spin,
            "disk": scene.disk.is_some(),
            "volumes": scene.volumes.len(),
            "hot_spots": scene.hot_spots.len(),
            "camera": {
                "position": camera.position.to_array(),
                "forward": camera.forward.to_array(),
                "radius": number(hole.camera_radius),
                "time_rate": number(hole.camera_time_rate),
            },
            "horizon_radius": number(hole.horizon_radius),
            "isco_prograde": number(hole.isco_prograde),
            "isco_retrograde": number(hole.isco_retrograde),
            "shadow_angular_radius": number(hole.shadow_angular_radius),
        })
    ));
    Ok(())
}

pub fn adapters() -> Result<(), Ending> {
    for (index, adapter) in all_adapters().iter().enumerate() {
        let kind = match (adapter.software, adapter.discrete) {
            (true, _) => "software",
            (false, true) => "discrete",
            (false, false) => "integrated",
        };
        say(&format!("{index}: {} ({}, {kind}) {}", adapter.name, adapter.backend, adapter.driver));
    }
    Ok(())
}

pub fn trace(given: &ArgMatches) -> Result<(), Ending> {
    let opened = open::scene(given)?;
    let render = opened.render();
    let text = |name: &str| given.get_one::<String>(name).map(String::as_str);
    let [width, height] = text("size").map(frames::size).transpose()?.unwrap_or([render.width, render.height]);
    let pixel = text("pixel").ok_or_else(|| Ending::usage("no --pixel"))?;
    let [x, y] = frames::numbers::<2, f64>("pixel", pixel, "960.5,540.5")?;
    let mut renderer = open::renderer(given)?;
    let region = opened.show(*given.get_one::<f64>("at").unwrap_or(&0.0), &mut renderer)?;
    let ray = renderer.scene.camera_ray(width, height, region, x, y)?;
    let mut hits = [Hit::default()];
    renderer.trace_rays(&[ray], &mut hits)?;
    let [hit] = &hits;
    let crossings = hit.crossings.iter().take(hit.crossing_count as usize).map(|crossing| {
        json!({"radius": number(crossing.radius), "azimuth": number(crossing.azimuth), "g": number(crossing.redshift),
               "delay": number(crossing.delay)})
    });
    say(&format!(
        "{:#}",
        json!({
            "position": ray.position.to_array(),
            "direction": ray.direction.to_array(),
            "fate": format!("{:?}", hit.fate).to_uppercase(),
            "sky_direction": hit.sky_direction.to_array().map(number),
            "crossings": crossings.collect::<Vec<_>>(),
        })
    ));
    Ok(())
}
