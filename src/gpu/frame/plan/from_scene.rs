// SPDX-License-Identifier: MIT OR Apache-2.0
//! The setup of a frame from its scene: which records, which shader variants, which film. Knows no buffers.

use super::f32_settings::{for_f32, variant};
use super::setup::{Setup, ShadingVariants};
use crate::emit::Emitters;
use crate::emit::baking::BakeKey;
use crate::emit::grid::GRID_LAST;
use crate::error::Result;
use crate::film::FilmParams;
use crate::film::bloom::Bloom;
use crate::film::metering::MeterParams;
use crate::gpu::frame::uniforms::clouds::CloudsUniform;
use crate::gpu::frame::uniforms::frame::FrameUniform;
use crate::gpu::frame::uniforms::matter::{matter_variant, places_of};
use crate::gpu::kernel::variant::{FilmVariant, PixelTarget, RecordMaker, RecordSource, ShadeVariant, TraceVariant};
use crate::gpu::lens::kerr::KerrContents;
use crate::gpu::lens::records::RecordSetup;
use crate::physics::trace::Settings;
use crate::scene::observer::Lens;
use crate::scene::{KerrThreshold, Lensing, Projection, Region, Scene, View};
use crate::tracer::{AdapterInfo, Backend, FrameRequest};
use glam::DVec3;
use std::sync::Arc;

/// The device, as far as plans depend on it.
#[derive(Clone, Copy)]
pub struct Planner<'a> {
    pub info: &'a AdapterInfo,
    /// Whether kernels can write buffers that the host maps.
    pub maps_storage: bool,
    /// The longest side of a texture with three.
    pub block_side: u32,
}

impl Planner<'_> {
    /// How pixels for the host's memory, and for buffers that it shares, are written.
    pub(in crate::gpu) fn host_pixels(&self, scene: &Scene) -> PixelTarget {
        if self.maps_pixels(scene) { PixelTarget::Rows } else { PixelTarget::Packed }
    }

    /// Whether kernels write pixels into the host's memory themselves, which hides the copy behind the tracing (a
    /// device of wgpu's runs one thing after another). Other interfaces than Vulkan may keep such memory out of
    /// kernels' reach, or reach it slowly.
    fn maps_pixels(&self, scene: &Scene) -> bool {
        let info = self.info;
        let pays = info.backend == Backend::Vulkan && !info.software;
        self.maps_storage && scene.quality.mapped_pixels.unwrap_or(pays)
    }

    /// Whether a sampler filters sky maps. On software drivers it costs more than to read the texels.
    fn samples_maps(&self, scene: &Scene) -> bool {
        scene.quality.map_sampler.unwrap_or(!self.info.software)
    }

    pub(in crate::gpu) fn set_up(&self, scene: &Scene, request: &FrameRequest, target: PixelTarget) -> Result<Setup> {
        let lens = scene.lens(&request.region)?;
        let emitters = scene.emitters();
        let settings = for_f32(scene.pixel_settings_of(&emitters));
        let samples = if scene.view == View::Light { scene.quality.samples_per_pixel } else { 1 };
        let film = FilmParams::new(&scene.film, scene.view, request.format, request.transparent)
            .over_frame(request.region.full_width, request.region.full_height)
            .with_lut(scene.shown_lut().map(Arc::as_ref), &scene.film);
        let bloom = Bloom::new(scene, request.format, [request.width, request.height], request.is_whole())?;
        let meter = bloom.as_ref().and_then(|bloom| MeterParams::new(&scene.film, bloom));
        // On hardware, whose branches cost little, all but the usual projection and film share kernels, so that a host
        // that goes through them does not wait for the driver's compiler each time. Their frames pay up to 4 % for it
        // (H200). Software drivers run both sides of every branch.
        let shares = scene.quality.shares_kernels.unwrap_or(!self.info.software);
        let film_variant = FilmVariant::new(scene, request.format, target);
        let formula = lens.mapping.projection;
        let (usual_view, usual_film) = (formula == Projection::Perspective, film_variant.is_usual());
        // Where one kernel both looks and develops, what is unusual in either is left open in both.
        let both = bloom.is_none() && samples == 1;
        let own_view = !shares || (usual_view && (usual_film || !both));
        let own_film = !shares || (usual_film && (usual_view || !both));
        let developed = if own_film { film_variant } else { film_variant.of_any() };
        let projection = own_view.then_some(formula);
        let variants = ShadingVariants {
            shade: ShadeVariant {
                light: scene.view == View::Light,
                stars: scene.shows_stars() && !request.transparent,
                milky_way: scene.shows_milky_way() && !request.transparent,
                map: scene.shows_map() && !request.transparent,
                grid: scene.shows_grid() && !request.transparent,
                map_sampler: self.samples_maps(scene),
                all_effects: scene.shown_effects().are_whole(),
                plane: emitters.plane_u().is_some(),
                opaque: emitters.hides_all(),
                footprints: emitters.needs().places,
                volumes: emitters.needs().parts,
                projection,
                refines: scene.refines(request.transparent),
                turbulent: emitters.disk.is_some_and(|disk| disk.turbulence.is_some()),
                occluded: scene.view == View::Light && scene.occluder.is_some(),
            },
            film: if bloom.is_some() { FilmVariant::of_light() } else { developed },
            developed: bloom.is_some().then_some(developed),
            several_samples: samples > 1,
            refines: scene.refines(request.transparent) && !scene.quality.edges_later,
            rows: target == PixelTarget::Rows,
        };
        let record_setup = self.record_setup(scene, &emitters, &lens, &settings, &request.region, projection);
        // The kernel that integrates what Kerr's tables do not hold knows no things of the host's: it looks behind all.
        let blind = scene.occluder.is_some() && record_setup.source.maker == RecordMaker::Kerr;
        let settings = Settings { opaque_u: settings.opaque_u.filter(|_| !blind), ..settings };
        let uniform = FrameUniform::new(scene, &emitters, &lens, &settings, record_setup.crossings)?;
        let structure = self.structure(&emitters, scene.hole.spin, &lens);
        let clouds = structure.iter().any(Option::is_some).then(|| CloudsUniform::new(&structure));
        let places = places_of(&emitters.volumes)?;
        Ok(Setup { record_setup, variants, samples, uniform, clouds, structure, places, film, bloom, meter })
    }

    /// The key of the structure of each volume, as far as the device's textures hold it.
    fn structure(&self, emitters: &Emitters, spin: f64, lens: &Lens) -> Vec<Option<BakeKey>> {
        let (r, pixel_angle) = (lens.observer.frame.r, lens.least_pixel_angle());
        let held = |key: BakeKey| {
            let fits = |level: &usize| key.clouds.grid.sides(*level)[1] <= self.block_side as usize;
            BakeKey { finest: (key.finest..GRID_LAST).find(fits).unwrap_or(GRID_LAST), ..key }
        };
        emitters.volumes.volumes.iter().map(|volume| volume.bake_key(spin, r, pixel_angle).map(held)).collect()
    }

    /// How the records of a frame are made.
    fn record_setup(
        &self,
        scene: &Scene,
        emitters: &Emitters,
        lens: &Lens,
        settings: &Settings,
        region: &Region,
        projection: Option<Projection>,
    ) -> RecordSetup {
        let observer = lens.observer.frame;
        let pattern = emitters.needs().places;
        let (delay, moving) = (settings.delay, lens.observer.beta != DVec3::ZERO);
        let pixels = u64::from(region.full_width) * u64::from(region.full_height);
        let plane_u = emitters.plane_u();
        // Blocks tell the matter along the rays of half resolution, and lenses what is behind.
        let half = scene.half_resolution().is_some();
        let lensing = if half && plane_u.is_none() { Scene::lensing_of_sky } else { Scene::lensing };
        let maker = match lensing(scene, &observer, pixels, KerrThreshold::GPU) {
            Lensing::Traced => RecordMaker::Traced,
            Lensing::Schwarzschild => RecordMaker::Schwarzschild,
            Lensing::Kerr => RecordMaker::Kerr,
        };
        let hidden = settings.opaque_u.is_some() && emitters.hides_all();
        let crossings = match plane_u {
            // Where nothing shines in the plane no crossing is kept.
            None => 0,
            Some(_) if hidden => 1,
            Some(_) => settings.max_crossings as u32,
        };
        let variant = TraceVariant {
            azimuth: pattern,
            matter: matter_variant(&emitters.volumes, scene),
            projection,
            ..variant(scene, settings, Some(&observer))
        };
        RecordSetup {
            source: RecordSource { delay, pattern, moving, rain: variant.rain, maker },
            variant,
            half,
            crossings,
            // wgpu makes no array texture of one layer on GL.
            least_layers: if self.info.backend == Backend::Gl { 2 } else { 1 },
            observer,
            contents: KerrContents {
                orders: if plane_u.is_some() { settings.max_crossings as u32 } else { 0 },
                plane_u: plane_u.unwrap_or([1.0, 0.0]),
                pattern,
                delay,
            },
        }
    }
}
