// SPDX-License-Identifier: MIT OR Apache-2.0
//! Looks whose matter has depth where the tracer is fast enough: frames that are timed and thrown away. Knows no
//! values of presets, and nothing of C.

use super::{Renderer, RunsOn};
use crate::error::Result;
use crate::image::PixelFormat;
use crate::scene::{Preset, PresetMatter, Quality, Region, Scene};
use crate::tracer::FrameRequest;
use std::time::{Duration, Instant};

/// The sizes of the frames that are timed. The next one is taken while a frame is done so soon that its fixed costs
/// may be a good part of it.
const SIZES: [[u32; 2]; 3] = [[480, 270], [960, 540], [1920, 1080]];
const SOON_NS: f64 = 4e6;

/// Frames of a size that are timed, of which the fastest counts; once this long has gone by no more are.
const FRAMES: usize = 3;
const ENOUGH: Duration = Duration::from_secs(1);

/// The spin of the hole that is timed: rays about one that spins take longer.
const SPIN: f64 = 0.5;

/// The matter that a host wants a preset to have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MatterChoice {
    This(PresetMatter),
    /// `Deep` where a frame of so many pixels takes at most so long.
    WithinNs {
        pixels: f64,
        ns: f64,
    },
}

/// How long a preset's frame with depth takes, for each sample of a pixel, at a quality.
#[derive(Clone, Copy)]
pub(super) struct DepthCost {
    quality: Quality,
    ns: f64,
}

impl Renderer {
    /// Gives the scene a look with its volumes; says which matter it has. Errors: those of frames, where one has to be
    /// timed; the scene is then as it was.
    pub fn set_preset(&mut self, preset: Preset, choice: MatterChoice) -> Result<PresetMatter> {
        let matter = match choice {
            MatterChoice::This(matter) => matter,
            MatterChoice::WithinNs { .. } if !preset.has_depth() => PresetMatter::Thin,
            MatterChoice::WithinNs { pixels, ns } => {
                let samples = f64::from(self.scene.quality.samples_per_pixel) * pixels;
                if samples * self.depth_cost(preset)? <= ns { PresetMatter::Deep } else { PresetMatter::Thin }
            }
        };
        Ok(preset.apply_with(matter, &mut self.scene))
    }

    /// In ns for each sample of a pixel; measured once for each quality.
    fn depth_cost(&mut self, preset: Preset) -> Result<f64> {
        // Windows' alone is the scale, and samples are what the cost is of.
        let quality = Quality { samples_per_pixel: 1, render_scale: 1.0, ..self.scene.quality };
        let known = self.depth_costs[preset as usize].filter(|known| known.quality == quality);
        if let Some(known) = known {
            return Ok(known.ns);
        }
        let mut scene = Scene { quality, ..Scene::default() };
        scene.hole.spin = SPIN;
        preset.apply_with(PresetMatter::Deep, &mut scene);
        let ns = self.time_pixel(&scene)?;
        log::info!("a frame of {preset:?} with depth takes {ns:.3} ns a pixel");
        self.depth_costs[preset as usize] = Some(DepthCost { quality, ns });
        Ok(ns)
    }

    fn time_pixel(&self, scene: &Scene) -> Result<f64> {
        let mut cost = f64::INFINITY;
        for [width, height] in SIZES {
            let frame = self.time_frame(scene, [width, height])?;
            cost = frame / (f64::from(width) * f64::from(height));
            if frame >= SOON_NS {
                break;
            }
        }
        Ok(cost)
    }

    /// The least time of some frames, ns: on the GPU if its clock is there to be asked.
    fn time_frame(&self, scene: &Scene, [width, height]: [u32; 2]) -> Result<f64> {
        let region = Region { full_width: width, full_height: height, x: 0, y: 0 };
        let request = FrameRequest { width, height, region, format: PixelFormat::Rgba8Srgb, transparent: false };
        // A GPU's first frame makes kernels and buffers.
        let unmeasured = usize::from(!matches!(self.runs_on, RunsOn::Cpu));
        let mut tracer = self.tracer.lock();
        let (mut least, mut spent) = (f64::INFINITY, Duration::ZERO);
        for number in 0..unmeasured + FRAMES {
            if spent > ENOUGH {
                break;
            }
            let start = Instant::now();
            let stats = tracer.render(scene, &request, &mut |_, _, _| Ok(()), &mut |_| true)?;
            let took = if stats.gpu_ns > 0 { stats.gpu_ns } else { start.elapsed().as_nanos() as u64 };
            if number >= unmeasured {
                spent += start.elapsed();
                least = least.min(took as f64);
            }
        }
        Ok(least)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::renderer::RendererOptions;
    use crate::tracer::Backend;

    fn on_cpu() -> Renderer {
        Renderer::new(RendererOptions { backend: Some(Backend::Cpu), ..RendererOptions::default() }).unwrap()
    }

    fn within(ns: f64) -> MatterChoice {
        MatterChoice::WithinNs { pixels: 640.0 * 360.0, ns }
    }

    /// The same measurement serves every goal, until the quality is another; frames for it are not counted.
    #[test]
    fn depth_is_taken_where_it_fits() {
        let mut renderer = on_cpu();
        assert_eq!(renderer.set_preset(Preset::Physical, within(1.0)).unwrap(), PresetMatter::Thin);
        assert!(renderer.scene.disk.is_some() && renderer.scene.volumes.is_empty());
        let ns = renderer.depth_costs[Preset::Physical as usize].unwrap().ns;
        assert!(ns > 10.0 && ns < 1e9, "{ns}");
        let fits = 640.0 * 360.0 * ns * 1.001;
        assert_eq!(renderer.set_preset(Preset::Physical, within(fits)).unwrap(), PresetMatter::Deep);
        assert_eq!(renderer.depth_costs[Preset::Physical as usize].unwrap().ns, ns);
        assert!(renderer.scene.disk.is_none() && renderer.scene.volumes.len() == 1);
        renderer.scene.quality.samples_per_pixel = 2;
        assert_eq!(renderer.set_preset(Preset::Physical, within(fits)).unwrap(), PresetMatter::Thin);
        assert_eq!(renderer.set_preset(Preset::Physical, within(2.0 * fits)).unwrap(), PresetMatter::Deep);
        assert_eq!(renderer.depth_costs[Preset::Physical as usize].unwrap().ns, ns);
        assert_eq!(renderer.stats().frame_index, 0);
    }

    /// A look without depth, and one whose matter is stated, are never timed.
    #[test]
    fn only_choices_are_timed() {
        let mut renderer = on_cpu();
        assert_eq!(renderer.set_preset(Preset::Teaching, within(1e18)).unwrap(), PresetMatter::Thin);
        for matter in [PresetMatter::Deep, PresetMatter::Thin] {
            assert_eq!(renderer.set_preset(Preset::Cinematic, MatterChoice::This(matter)).unwrap(), matter);
        }
        assert!(renderer.depth_costs.iter().all(Option::is_none));
    }
}
