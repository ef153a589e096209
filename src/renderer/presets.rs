// SPDX-License-Identifier: MIT OR Apache-2.0
//! Looks whose matter has depth where the tracer is fast enough: frames that are timed and thrown away. Knows no
//! values of presets, and nothing of C.

use super::{Renderer, RunsOn};
use crate::error::{ErrorKind, Result};
use crate::image::PixelFormat;
use crate::scene::{Preset, PresetMatter, Quality, Region, Scene, VolumeResolution};
use crate::tracer::FrameRequest;
use std::time::{Duration, Instant};

/// A frame that was broken off counts as done to this share at least, so that its cost stays finite.
const LEAST_DONE: f64 = 0.01;
/// The sizes of the frames that are timed. The next one is taken while the time allows it and a frame is done so soon
/// that its fixed costs may be a good part of it.
const SIZES: [[u32; 2]; 7] = [[4, 2], [16, 9], [48, 27], [160, 90], [480, 270], [960, 540], [1920, 1080]];
const SOON_NS: f64 = 4e6;
/// Frames of fewer pixels are not believed while there is time for more.
const FEW: f64 = 480.0 * 270.0;

/// Frames of a size that are timed, of which the fastest counts.
const FRAMES: usize = 3;

/// The time for all that is timed. Frames that would take longer are not begun, or are broken off.
const TIME: Duration = Duration::from_millis(400);
/// A frame that takes less may be all but fixed costs, and does not tell that the next size would not fit.
const LITTLE_NS: f64 = 4e7;

/// The spin of the hole that is timed: rays about one that spins take longer.
const SPIN: f64 = 0.5;

/// The matter that a host wants a preset to have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MatterChoice {
    This(PresetMatter),
    /// `Deep` where a frame takes no longer than the goal.
    Within(FrameGoal),
}

/// A time for frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameGoal {
    pub pixels: f64,
    pub ns: f64,
    /// Whether it is measured again how long frames take.
    pub measure_anew: bool,
    /// Whether volumes may be summed at half resolution, where frames take longer otherwise. The scene's quality has
    /// the resolution that was found then.
    pub may_halve: bool,
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
            MatterChoice::Within(_) if !preset.has_depth() => PresetMatter::Thin,
            MatterChoice::Within(goal) => match self.resolution_within(preset, goal)? {
                Some(resolution) => {
                    self.scene.quality.volume_resolution = resolution;
                    PresetMatter::Deep
                }
                None => PresetMatter::Thin,
            },
        };
        Ok(preset.apply_with(matter, &mut self.scene))
    }

    /// The resolution of volumes with which frames with depth take no longer than the goal, the scene's unless that is
    /// to be chosen. `None`: they take longer.
    fn resolution_within(&mut self, preset: Preset, goal: FrameGoal) -> Result<Option<VolumeResolution>> {
        if goal.measure_anew {
            self.depth_costs[preset as usize].clear();
        }
        let own = [self.scene.quality.volume_resolution];
        let resolutions: &[_] = if goal.may_halve { &[VolumeResolution::Full, VolumeResolution::Half] } else { &own };
        for &resolution in resolutions {
            let samples = f64::from(self.scene.quality.samples_per_pixel) * goal.pixels;
            let ns = samples * self.depth_cost(preset, resolution)?;
            let (ms, most, fits) = (1e-6 * ns, 1e-6 * goal.ns, ns <= goal.ns);
            let verdict = if fits { "it is taken" } else { "it is too slow" };
            log::info!("{preset:?} with depth, {resolution:?} resolution: {ms:.3} ms a frame of {most:.3}: {verdict}");
            if fits {
                return Ok(Some(resolution));
            }
        }
        Ok(None)
    }

    /// In ns for each sample of a pixel; measured once for each quality.
    fn depth_cost(&mut self, preset: Preset, volume_resolution: VolumeResolution) -> Result<f64> {
        // Windows' alone is the scale, and samples are what the cost is of.
        let quality = Quality { samples_per_pixel: 1, render_scale: 1.0, volume_resolution, ..self.scene.quality };
        let known = self.depth_costs[preset as usize].iter().find(|known| known.quality == quality);
        if let Some(known) = known {
            return Ok(known.ns);
        }
        let mut scene = Scene { quality, ..Scene::default() };
        scene.hole.spin = SPIN;
        preset.apply_with(PresetMatter::Deep, &mut scene);
        let ns = self.time_pixel(&scene)?;
        let known = &mut self.depth_costs[preset as usize];
        // One for each resolution of volumes, of one quality besides.
        let others = Quality { volume_resolution, ..quality };
        known.retain(|known| Quality { volume_resolution, ..known.quality } == others);
        known.push(DepthCost { quality, ns });
        Ok(ns)
    }

    fn time_pixel(&self, scene: &Scene) -> Result<f64> {
        let (mut cost, mut frame, mut left) = (f64::INFINITY, 0.0, TIME);
        if matches!(self.runs_on, RunsOn::Cpu) {
            // The first frame of all reads pictures and makes tables of noise.
            let usual = Scene { quality: Quality::default(), ..scene.clone() };
            self.time_frame(&usual, SIZES[0], &mut TIME.clone())?;
        }
        for [width, height] in SIZES {
            let pixels = f64::from(width) * f64::from(height);
            if left.is_zero() || (frame > LITTLE_NS && cost * pixels > left.as_nanos() as f64) {
                break;
            }
            frame = self.time_frame(scene, [width, height], &mut left)?;
            cost = frame / pixels;
            if frame >= SOON_NS && pixels >= FEW {
                break;
            }
        }
        Ok(cost)
    }

    /// The least time of some frames, ns: on the GPU if its clock is there to be asked. Takes `left`, and no longer,
    /// but for a GPU's first frame.
    fn time_frame(&self, scene: &Scene, [width, height]: [u32; 2], left: &mut Duration) -> Result<f64> {
        let region = Region { full_width: width, full_height: height, x: 0, y: 0 };
        let request = FrameRequest { width, height, region, format: PixelFormat::Rgba8Srgb, transparent: false };
        // A GPU's first frame makes kernels and buffers.
        let unmeasured = usize::from(!matches!(self.runs_on, RunsOn::Cpu));
        let mut tracer = self.tracer.lock();
        let mut least = f64::INFINITY;
        for number in 0..unmeasured + FRAMES {
            let start = Instant::now();
            let (measured, mut done) = (number >= unmeasured, 0.0);
            let mut progress = |fraction: f64| {
                done = fraction;
                !measured || start.elapsed() < *left
            };
            let rendered = tracer.render(scene, &request, &mut |_, _, _| Ok(()), &mut progress);
            let spent = start.elapsed();
            let took = match rendered {
                Ok(stats) if stats.gpu_ns > 0 => stats.gpu_ns as f64,
                Ok(_) => spent.as_nanos() as f64,
                // The frame was broken off: the whole is taken to last as long as the part lets expect.
                Err(error) if error.kind == ErrorKind::Cancelled => spent.as_nanos() as f64 / done.max(LEAST_DONE),
                Err(error) => return Err(error),
            };
            if measured {
                least = least.min(took);
                *left = left.saturating_sub(spent);
                // Another one would not fit.
                if *left < spent {
                    break;
                }
            }
        }
        Ok(least)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::renderer::RendererOptions;
    use crate::scene::Method;
    use crate::tracer::Backend;

    fn on_cpu() -> Renderer {
        Renderer::new(RendererOptions { backend: Some(Backend::Cpu), ..RendererOptions::default() }).unwrap()
    }

    fn within(ns: f64) -> MatterChoice {
        MatterChoice::Within(goal(ns))
    }

    fn goal(ns: f64) -> FrameGoal {
        FrameGoal { pixels: 640.0 * 360.0, ns, measure_anew: false, may_halve: false }
    }

    /// One measurement serves every goal, until the quality is another; frames for it are not counted.
    #[test]
    fn depth_is_taken_where_it_fits() {
        let mut renderer = on_cpu();
        assert_eq!(renderer.set_preset(Preset::Physical, within(1.0)).unwrap(), PresetMatter::Thin);
        assert!(renderer.scene.disk.is_some() && renderer.scene.volumes.is_empty());
        let ns = renderer.depth_costs[Preset::Physical as usize][0].ns;
        assert!(ns > 10.0 && ns < 1e9, "{ns}");
        let fits = 640.0 * 360.0 * ns * 1.001;
        assert_eq!(renderer.set_preset(Preset::Physical, within(fits)).unwrap(), PresetMatter::Deep);
        assert_eq!(renderer.depth_costs[Preset::Physical as usize][0].ns, ns);
        assert!(renderer.scene.disk.is_none() && renderer.scene.volumes.len() == 1);
        renderer.scene.quality.samples_per_pixel = 2;
        assert_eq!(renderer.set_preset(Preset::Physical, within(fits)).unwrap(), PresetMatter::Thin);
        assert_eq!(renderer.set_preset(Preset::Physical, within(2.0 * fits)).unwrap(), PresetMatter::Deep);
        assert_eq!(renderer.depth_costs[Preset::Physical as usize][0].ns, ns);
        assert_eq!(renderer.stats().frame_index, 0);
    }

    /// Half resolution is taken where full does not fit and that may be; both are measured once, and again if asked.
    #[test]
    fn half_resolution_is_taken_where_full_does_not_fit() {
        use VolumeResolution::{Full, Half};
        let mut renderer = on_cpu();
        let choose = |renderer: &mut Renderer, ns: f64, may_halve: bool, measure_anew: bool| {
            let goal = FrameGoal { may_halve, measure_anew, ..goal(ns) };
            let matter = renderer.set_preset(Preset::Cinematic, MatterChoice::Within(goal)).unwrap();
            (matter, renderer.scene.quality.volume_resolution)
        };
        assert_eq!(choose(&mut renderer, 1.0, true, false), (PresetMatter::Thin, Full));
        // A small frame of a slow machine may take longer in blocks.
        let costs = &mut renderer.depth_costs[Preset::Cinematic as usize];
        let found = costs.iter().map(|cost| cost.quality.volume_resolution).collect::<Vec<_>>();
        assert_eq!(found, [Full, Half]);
        costs.iter_mut().zip([2.0, 1.0]).for_each(|(cost, ns)| cost.ns = ns);
        let pixels = 640.0 * 360.0;
        assert_eq!(choose(&mut renderer, 1.5 * pixels, false, false), (PresetMatter::Thin, Full));
        assert_eq!(choose(&mut renderer, 1.5 * pixels, true, false), (PresetMatter::Deep, Half));
        assert_eq!(choose(&mut renderer, 0.5 * pixels, true, false), (PresetMatter::Thin, Half));
        assert_eq!(choose(&mut renderer, 2.5 * pixels, true, false), (PresetMatter::Deep, Full));
        // No CPU renders a pixel in 2 ns.
        assert_eq!(choose(&mut renderer, 2.5 * pixels, true, true), (PresetMatter::Thin, Full));
        let costs = &renderer.depth_costs[Preset::Cinematic as usize];
        assert!(costs.len() == 2 && costs.iter().all(|cost| cost.ns > 2.5));
    }

    /// However long its frames take, a look is timed for about half a second.
    #[test]
    fn timing_has_a_bound() {
        let mut renderer = on_cpu();
        renderer.scene.quality.method = Method::Rk4;
        renderer.scene.quality.step = 1e-3;
        renderer.scene.quality.max_steps = 100_000;
        let began = Instant::now();
        assert_eq!(renderer.set_preset(Preset::Cinematic, within(16e6)).unwrap(), PresetMatter::Thin);
        let took = began.elapsed();
        let ns = renderer.depth_costs[Preset::Cinematic as usize][0].ns;
        assert!(ns.is_finite() && ns * 640.0 * 360.0 > 16e6, "{ns} ns a pixel");
        // The frame of 480 x 270 that was timed before takes longer than this on any CPU, and the bound is missed by
        // one part of a frame at most, beside other work too.
        assert!(took < Duration::from_secs(60), "{took:?}, {ns} ns a pixel");
    }

    /// A look without depth, and one whose matter is stated, are never timed.
    #[test]
    fn only_choices_are_timed() {
        let mut renderer = on_cpu();
        assert_eq!(renderer.set_preset(Preset::Teaching, within(1e18)).unwrap(), PresetMatter::Thin);
        for matter in [PresetMatter::Deep, PresetMatter::Thin] {
            assert_eq!(renderer.set_preset(Preset::Cinematic, MatterChoice::This(matter)).unwrap(), matter);
        }
        assert!(renderer.depth_costs.iter().all(Vec::is_empty));
    }
}
