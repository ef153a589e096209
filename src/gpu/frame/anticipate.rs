// SPDX-License-Identifier: MIT OR Apache-2.0
//! Kernels of frames that may come: of the default scene, and of scenes that are one change away from what is shown.
//! They are made in the background.

use super::tracer::GpuTracer;
use crate::gpu::kernel::key::KernelKey;
use crate::gpu::kernel::variant::PixelTarget;
use crate::image::PixelFormat;
use crate::scene::{Disk, Effects, Motion, Projection, Region, Scene, Sky, ToneMap, View, VolumeResolution};
use crate::sky::SkyMap;
use crate::tracer::{Backend, FrameRequest};

/// Scenes one change away from `scene`, in the order of how often hosts make the change and how long its kernels take.
fn neighbours(scene: &Scene) -> Vec<Scene> {
    let changed = |change: &dyn Fn(&mut Scene)| {
        let mut scene = scene.clone();
        change(&mut scene);
        scene
    };
    let spin = |scene: &mut Scene| scene.hole.spin = if scene.hole.spin == 0.0 { 0.7 } else { 0.0 };
    let bloom = |scene: &mut Scene| scene.film.bloom = if scene.film.bloom == 0.0 { 0.2 } else { 0.0 };
    let turbulence = |scene: &mut Scene| {
        if let Some(disk) = &mut scene.disk {
            disk.turbulence = if disk.turbulence == 0.0 { 1.0 } else { 0.0 };
        }
    };
    let motion = |motion| move |scene: &mut Scene| scene.camera.motion = motion;
    let view = |view| move |scene: &mut Scene| scene.view = view;
    let projection = |projection| move |scene: &mut Scene| scene.camera.projection = projection;
    let sky = |flag| move |scene: &mut Scene| scene.sky.flags ^= flag;
    let tone_map = |tone_map| move |scene: &mut Scene| scene.film.tone_map = tone_map;
    // One of each kind is enough where one kernel serves all: films and projections but the usual ones, views.
    let mut list = vec![changed(&spin), changed(&turbulence), changed(&bloom)];
    if scene.emitters().needs().parts {
        // A host whose frames are late may give up this first.
        list.push(changed(&|scene| {
            scene.quality.volume_resolution = match scene.quality.volume_resolution {
                VolumeResolution::Full => VolumeResolution::Half,
                VolumeResolution::Half => VolumeResolution::Full,
            }
        }));
    }
    list.extend([ToneMap::Agx, ToneMap::Aces].map(|to| changed(&tone_map(to))));
    list.extend([Projection::Fisheye, Projection::Perspective].map(|to| changed(&projection(to))));
    list.extend([Motion::FreeFall, Motion::Static].map(|to| changed(&motion(to))));
    list.extend([View::Redshift, View::Light].map(|to| changed(&view(to))));
    list.push(changed(&|scene| {
        let samples = &mut scene.quality.samples_per_pixel;
        *samples = if *samples == 1 { 4 } else { 1 };
    }));
    list.push(changed(&|scene| {
        spin(scene);
        bloom(scene);
    }));
    list.push(changed(&|scene| {
        bloom(scene);
        projection(Projection::Fisheye)(scene);
    }));
    list.push(changed(&|scene| {
        bloom(scene);
        turbulence(scene);
    }));
    list.push(changed(&|scene| {
        spin(scene);
        turbulence(scene);
    }));
    list.push(changed(&|scene| scene.disk = if scene.disk.is_some() { None } else { Some(Disk::default()) }));
    list.extend([Sky::MILKY_WAY, Sky::GRID, Sky::STARS].map(|flag| changed(&sky(flag))));
    list.push(changed(&|scene| scene.effects = Effects(scene.effects.0 ^ Effects::LIGHT_DELAY)));
    list.push(changed(&|scene| scene.effects = Effects(scene.effects.0 ^ Effects::BEAMING)));
    list
}

/// Kinds of frames whose followers are anticipated, at most.
const MOST_KINDS: usize = 64;

/// The size that many hosts begin with.
const FIRST_SIZE: [u32; 2] = [1920, 1080];

impl GpuTracer {
    /// Begins to make the kernels of the default scene, while the host still sets up its own. Not on a software driver:
    /// its frames want the same cores, and most hosts set another scene.
    pub(in crate::gpu) fn expect_first_frame(&mut self) {
        if self.adapter.info.software {
            return;
        }
        let scene = Scene::default();
        let [width, height] = FIRST_SIZE;
        let region = Region { full_width: width, full_height: height, x: 0, y: 0 };
        let request = FrameRequest { width, height, region, format: PixelFormat::Rgba8Srgb, transparent: false };
        if let Ok(setup) = self.planner().set_up(&scene, &request, self.planner().host_pixels(&scene)) {
            self.kernels.anticipate(setup.kernels().into_iter().rev().collect());
        }
        // Kept for the process; a frame that comes first waits for them, or makes them itself.
        self.kernels.run_in_background(move || {
            let _ = (scene.stars(), SkyMap::milky_way());
        });
    }

    /// Kernels of the frames that may follow a frame of `scene`, which takes `needed`, to be made in the background.
    /// Only for the first frame of its kind.
    pub(in crate::gpu) fn anticipate(
        &mut self,
        scene: &Scene,
        request: &FrameRequest,
        target: PixelTarget,
        needed: Vec<KernelKey>,
    ) {
        let info = &self.adapter.info;
        let anticipates = scene.quality.anticipates.unwrap_or(!info.software && info.backend != Backend::Gl);
        // A host that has shown more kinds of frames than these has been to where it goes.
        let known = self.anticipated.contains(&needed) || self.anticipated.len() >= MOST_KINDS;
        if known || !anticipates {
            return;
        }
        let next = neighbours(scene).into_iter().filter_map(|next| self.planner().set_up(&next, request, target).ok());
        // Hosts that began with another format may come to the usual one.
        let usual = FrameRequest { format: PixelFormat::Rgba8Srgb, ..*request };
        let usual = (!target.is_image()).then(|| self.planner().set_up(scene, &usual, target).ok()).flatten();
        let next = next.chain(usual);
        let mut keys = Vec::<KernelKey>::new();
        for key in next.flat_map(|setup| setup.kernels().into_iter().rev()) {
            if !keys.contains(&key) {
                keys.push(key);
            }
        }
        self.anticipated.insert(needed);
        self.kernels.anticipate(keys);
    }
}
