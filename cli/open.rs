// SPDX-License-Identifier: MIT OR Apache-2.0
//! A scene file and a renderer for it, as arguments name them.

use crate::ending::Ending;
use bhr::error::ErrorKind;
use bhr::renderer::{Backend, Renderer, RendererOptions};
use bhr::scene_file::{Render, SceneFile};
use bhr::sky::MapFile;
use clap::ArgMatches;
use std::path::PathBuf;

/// A scene file with its map, which is read once.
pub struct Opened {
    pub file: SceneFile,
    map: Option<MapFile>,
}

/// Reads the scene that an argument names.
pub fn scene(given: &ArgMatches) -> Result<Opened, Ending> {
    let path = given.get_one::<PathBuf>("scene").ok_or_else(|| Ending::usage("no scene"))?;
    let path = std::path::absolute(path).map_err(|error| Ending::io(path, error))?;
    let file = SceneFile::load(&path)?;
    let map = file.map().map(|map| MapFile::load(map, None)).transpose()?;
    Ok(Opened { file, map })
}

impl Opened {
    pub fn render(&self) -> Render {
        self.file.render().unwrap_or_default()
    }

    /// Puts the scene of a time into a renderer; the region that the file asks for.
    pub fn show(&self, seconds: f64, renderer: &mut Renderer) -> Result<Option<bhr::scene::Region>, Ending> {
        let moment = self.file.at(seconds, &renderer.scene)?;
        renderer.scene = moment.scene;
        renderer.scene.sky_map = self.map.as_ref().map(|map| map.map().clone());
        Ok(moment.region)
    }
}

/// The renderer that arguments ask for.
pub fn renderer(given: &ArgMatches) -> Result<Renderer, Ending> {
    let name = given.get_one::<String>("backend").map_or("auto", String::as_str);
    let backend = match name {
        "auto" => None,
        "cpu" => Some(Backend::Cpu),
        "vulkan" => Some(Backend::Vulkan),
        "metal" => Some(Backend::Metal),
        "d3d12" => Some(Backend::D3d12),
        "gl" => Some(Backend::Gl),
        _ => {
            return Err(Ending::usage(format!("--backend {name}: it must be auto, cpu, vulkan, metal, d3d12 or gl")));
        }
    };
    let adapter_index = given.get_one::<u32>("adapter").copied();
    Ok(Renderer::new(RendererOptions { backend, adapter_index, ..RendererOptions::default() })?)
}

/// How often a device that was lost is opened anew.
const RECOVERIES: u32 = 3;

/// Runs something that a lost device may break off, and again after that was opened anew. Errors: those of `run`; a
/// device that goes on being lost.
pub fn recovering<T>(
    renderer: &mut Renderer,
    lost: &mut u32,
    mut run: impl FnMut(&mut Renderer) -> bhr::error::Result<T>,
) -> Result<T, Ending> {
    loop {
        match run(renderer) {
            Err(error) if error.kind == ErrorKind::DeviceLost && *lost < RECOVERIES => {
                *lost += 1;
                renderer.recover()?;
            }
            result => return Ok(result?),
        }
    }
}
