// SPDX-License-Identifier: MIT OR Apache-2.0
//! A scene file and a renderer for it, as arguments name them.

use crate::ending::Ending;
use bhr::error::{Error, ErrorKind};
use bhr::image::LutFile;
use bhr::renderer::{Backend, Renderer, RendererOptions, adapters};
use bhr::scene_file::{Render, SceneFile};
use bhr::sky::MapFile;
use bhr::tracer::AdapterInfo;
use clap::ArgMatches;
use std::path::PathBuf;

/// A scene file with its map and its LUT, which are read once.
pub struct Opened {
    pub file: SceneFile,
    map: Option<MapFile>,
    lut: Option<LutFile>,
}

/// Reads the scene that an argument names.
pub fn scene(given: &ArgMatches) -> Result<Opened, Ending> {
    let path = given.get_one::<PathBuf>("scene").ok_or_else(|| Ending::usage("no scene"))?;
    let path = std::path::absolute(path).map_err(|error| Ending::io(path, error))?;
    let file = SceneFile::load(&path)?;
    let map = file.map().map(|map| MapFile::load(map, None)).transpose()?;
    let lut = file.lut().map(|lut| LutFile::load(lut, None)).transpose()?;
    Ok(Opened { file, map, lut })
}

impl Opened {
    pub fn render(&self) -> Render {
        self.file.render().unwrap_or_default()
    }

    /// Puts the scene of a time into a renderer; the region that the file asks for.
    pub fn show(&self, seconds: f64, renderer: &mut Renderer) -> Result<Option<bhr::scene::Region>, Ending> {
        let moment = self.file.at(seconds, &renderer.scene)?;
        renderer.scene = moment.scene;
        renderer.scene.sky_map = self.map.as_ref().map(|map| map.value().clone());
        renderer.scene.film_lut = self.lut.as_ref().map(|lut| lut.value().clone());
        Ok(moment.region)
    }
}

/// Whether frames of a scene can be rendered in any order. Errors: they depend on each other.
pub fn check_frames(scene: &bhr::scene::Scene) -> Result<(), Ending> {
    let auto = &scene.film.auto_exposure;
    if auto.strength > 0.0 && auto.adaptation < 1.0 {
        return Err(Ending::data(format!(
            "film auto_adaptation is {}: frames of `bhr render` are made in any order and know no other; leave it at \
             1, or turn auto_exposure off and key exposure_ev",
            auto.adaptation
        )));
    }
    Ok(())
}

/// The adapters that `--adapter` names; `None`: the first that fits.
fn adapter_indices(given: &ArgMatches, backend: Option<Backend>) -> Result<Vec<Option<u32>>, Ending> {
    let Some(text) = given.get_one::<String>("adapter") else { return Ok(vec![None]) };
    if text == "all" {
        let all = adapters();
        let is_gpu = |adapter: &AdapterInfo| !adapter.software && backend.is_none_or(|only| adapter.backend == only);
        // A GPU is there once for each backend: the first one's is the best. Beside one with memory of its own a
        // processor's is too slow to help.
        let first = all.iter().find(|adapter| is_gpu(adapter)).map(|adapter| adapter.backend);
        let gpus = all.iter().zip(0..).filter(|(adapter, _)| is_gpu(adapter) && Some(adapter.backend) == first);
        let discrete = gpus.clone().any(|(adapter, _)| adapter.discrete);
        let gpus = gpus.filter(|(adapter, _)| adapter.discrete || !discrete).map(|(_, index)| Some(index));
        let gpus = gpus.collect::<Vec<_>>();
        return match gpus.is_empty() {
            true => Err(Error::new(ErrorKind::NoAdapter, "--adapter all: this machine has no GPU").into()),
            false => Ok(gpus),
        };
    }
    let wrong = || Ending::usage(format!("--adapter {text}: it must be a number, numbers as 0,1, or all"));
    let list = text.split(',').map(|number| number.trim().parse::<u32>().ok());
    let list = list.collect::<Option<Vec<u32>>>().ok_or_else(wrong)?;
    if list.len() > MOST_RENDERERS {
        return Err(Ending::usage(format!("--adapter {text}: it must name {MOST_RENDERERS} at most")));
    }
    Ok(list.into_iter().map(Some).collect())
}

/// More adapters than machines have.
const MOST_RENDERERS: usize = 64;

/// The one renderer that arguments ask for.
pub fn renderer(given: &ArgMatches) -> Result<Renderer, Ending> {
    let mut renderers = renderers(given)?;
    match (renderers.pop(), renderers.is_empty()) {
        (Some(renderer), true) => Ok(renderer),
        _ => Err(Ending::usage("--adapter: this command takes one")),
    }
}

/// The renderers that arguments ask for, one at least.
pub fn renderers(given: &ArgMatches) -> Result<Vec<Renderer>, Ending> {
    let backend = backend(given)?;
    adapter_indices(given, backend)?.into_iter().map(|index| Ok(open(backend, index)?)).collect()
}

fn open(backend: Option<Backend>, adapter_index: Option<u32>) -> bhr::error::Result<Renderer> {
    Renderer::new(RendererOptions { backend, adapter_index, ..RendererOptions::default() })
}

fn backend(given: &ArgMatches) -> Result<Option<Backend>, Ending> {
    let name = given.get_one::<String>("backend").map_or("auto", String::as_str);
    Ok(match name {
        "auto" => None,
        "cpu" => Some(Backend::Cpu),
        "vulkan" => Some(Backend::Vulkan),
        "metal" => Some(Backend::Metal),
        "d3d12" => Some(Backend::D3d12),
        "gl" => Some(Backend::Gl),
        _ => {
            return Err(Ending::usage(format!("--backend {name}: it must be auto, cpu, vulkan, metal, d3d12 or gl")));
        }
    })
}

/// Opens one more renderer, if it can be had.
pub type Opener = Box<dyn FnOnce() -> Option<Renderer> + Send>;

/// The frames that a GPU renders at a time, and those of a processor, where one frame uses all cores.
const AT_A_TIME: [usize; 2] = [2, 1];
/// For fewer frames another renderer is not worth opening.
const WORTH_ANOTHER: usize = 8;

/// Openers of more renderers beside each of those that [`renderers`] gives, by its number, on the adapter that it has.
pub fn more_renderers(given: &ArgMatches, frames: usize) -> Result<impl Fn(usize, &Renderer) -> Vec<Opener>, Ending> {
    let (asked, backend) = (given.get_one::<u32>("at-a-time").copied(), backend(given)?);
    let indices = adapter_indices(given, backend)?;
    Ok(move |number: usize, beside: &Renderer| {
        let [gpu, software] = AT_A_TIME;
        let count = match asked {
            Some(asked) => asked as usize,
            None if frames < WORTH_ANOTHER => 1,
            None if beside.adapter().software => software,
            None => gpu,
        };
        let index = indices.get(number).copied().flatten();
        let open_one = |_| -> Opener {
            let adapter = beside.adapter().clone();
            Box::new(move || open(backend, index).ok().filter(|renderer| *renderer.adapter() == adapter))
        };
        (1..count).map(open_one).collect()
    })
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
