// SPDX-License-Identifier: MIT OR Apache-2.0
//! Matter with depth in the layout of the shaders' uniforms: `Matter` of shared/matter.wgsl, field by field; and the
//! choices that kernels are compiled with for it.

use crate::allocate::collected;
use crate::emit::free_spot::Centre;
use crate::emit::glow::Glow;
use crate::emit::matter::{SpotMatter, VolumeMatter};
use crate::emit::shape::Reach;
use crate::emit::volumes::Volumes;
use crate::error::Result;
use crate::gpu::kernel::sizes::MOST_MATTER;
use crate::gpu::kernel::variant::{MatterVariant, MotionCode, SHAPE_FREE_SPOT, SHAPE_SPOT};
use crate::physics::flow::{Flow, Motion};
use crate::scene::{Scene, View};
use crate::sky::index::{PLACES_OFFSET, SPOT_PLACES};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct MatterUniform {
    shape: u32,
    motion: u32,
    power_law: u32,
    size: f32,
    u_outer: f32,
    u_inner: f32,
    most_cosine: f32,
    sense: f32,
    inner: f32,
    outer: f32,
    radius: f32,
    width: f32,
    thickness: f32,
    opening: f32,
    slope: f32,
    isco: f32,
    law: [f32; 2],
    azimuth: f32,
    angular_velocity: f32,
    absorption: f32,
    temperature: f32,
    reference_radius: f32,
    temperature_slope: f32,
    log_reference: f32,
    spectral_index: f32,
    brightness: f32,
    least_density: f32,
    tint: Vec3,
    places: u32,
}

#[cfg(test)]
pub(in crate::gpu) fn layout() -> crate::gpu::kernel::layout::Layout {
    use crate::gpu::kernel::layout::layout;
    layout!(MatterUniform as "Matter": shape, motion, power_law, size, u_outer, u_inner, most_cosine, sense, inner,
        outer, radius, width, thickness, opening, slope, isco, law, azimuth, angular_velocity, absorption,
        temperature, reference_radius, temperature_slope, log_reference, spectral_index, brightness, least_density,
        tint, places)
}

fn motion_of(flow: &Flow) -> (MotionCode, [f64; 2]) {
    match flow.motion {
        Motion::Keplerian { sub_keplerian, infall } => (MotionCode::Keplerian, [sub_keplerian, infall]),
        Motion::AngularMomentum { l0 } => (MotionCode::AngularMomentum, [l0, 0.0]),
        Motion::Rigid { angular_velocity } => (MotionCode::Rigid, [angular_velocity, 0.0]),
        Motion::Outflow { speed, base } => (MotionCode::Outflow, [speed, base]),
    }
}

impl MatterUniform {
    /// The numbers that volumes and spots share; those of the shape are 0.
    fn new(shape: u32, flow: &Flow, glow: &Glow, reach: &Reach, least_density: f64) -> Self {
        let (motion, law) = motion_of(flow);
        Self {
            shape,
            motion: motion as u32,
            power_law: glow.power_law.into(),
            u_outer: reach.u[0] as f32,
            u_inner: reach.u[1] as f32,
            most_cosine: reach.cos as f32,
            sense: flow.sense as f32,
            isco: flow.isco as f32,
            law: law.map(|v| v as f32),
            absorption: glow.absorption as f32,
            temperature: glow.temperature as f32,
            reference_radius: glow.reference_radius as f32,
            temperature_slope: glow.temperature_slope as f32,
            log_reference: glow.log_reference as f32,
            spectral_index: glow.spectral_index as f32,
            brightness: glow.brightness as f32,
            least_density: least_density as f32,
            tint: Vec3::from_array(glow.tint.map(|v| v as f32)),
            ..Self::zeroed()
        }
    }
}

impl From<&VolumeMatter> for MatterUniform {
    fn from(volume: &VolumeMatter) -> Self {
        let cloud = &volume.cloud;
        Self {
            inner: cloud.inner as f32,
            outer: cloud.outer as f32,
            radius: cloud.radius as f32,
            width: cloud.width as f32,
            thickness: cloud.thickness as f32,
            opening: cloud.opening as f32,
            slope: cloud.slope as f32,
            ..Self::new(cloud.shape as u32, &volume.flow, &volume.glow, &volume.reach, volume.least)
        }
    }
}

impl From<&SpotMatter> for MatterUniform {
    fn from(spot: &SpotMatter) -> Self {
        // Shaders leave out what is less; beyond its cut a spot is nothing.
        let least = f64::from(f32::MIN_POSITIVE);
        if let Some(centre) = &spot.free {
            let [begin, end] = centre.times();
            return Self {
                motion: MotionCode::Free as u32,
                law: [begin as f32, (end - begin) as f32],
                size: spot.size as f32,
                radius: spot.lingers.map_or(0.0, |[r_plus, _]| r_plus) as f32,
                width: spot.lingers.map_or(0.0, |[_, time]| time) as f32,
                inner: f32::from(centre.is_denser_at_end()),
                angular_velocity: centre.pace as f32,
                thickness: 1.0,
                ..Self::new(SHAPE_FREE_SPOT, &spot.flow, &spot.glow, &spot.reach, least)
            };
        }
        Self {
            radius: spot.radius as f32,
            size: spot.size as f32,
            azimuth: spot.azimuth as f32,
            angular_velocity: spot.angular_velocity as f32,
            // Shaders divide by the thickness of everything.
            thickness: 1.0,
            ..Self::new(SHAPE_SPOT, &spot.flow, &spot.glow, &spot.reach, least)
        }
    }
}

/// The places of spots in free fall as `spot_centre` of emit/free_spot.wgsl reads them: of each its places one by one,
/// position and share, then rate and time. Errors: OUT_OF_MEMORY.
pub fn places_of(volumes: &Volumes) -> Result<Vec<[f32; 4]>> {
    let entries = |(time, centre): (f64, Centre)| {
        let (position, rate) = (centre.position.as_vec3(), centre.rate.as_vec3());
        [position.extend(centre.share as f32), rate.extend(time as f32)].map(|entry| entry.to_array())
    };
    let tables = volumes.hot_spots.iter().filter_map(|spot| spot.free.as_ref()).flat_map(|centre| centre.table());
    collected(tables.flat_map(entries), "the places of hot spots")
}

/// The matter of a frame, volumes first, and how much there is.
pub fn uniforms_of(volumes: &Volumes) -> ([MatterUniform; MOST_MATTER], u32) {
    let mut all = [MatterUniform::zeroed(); MOST_MATTER];
    let found =
        volumes.volumes.iter().map(MatterUniform::from).chain(volumes.hot_spots.iter().map(MatterUniform::from));
    let mut count = 0;
    let mut places = PLACES_OFFSET;
    for (uniform, matter) in all.iter_mut().zip(found) {
        *uniform = matter;
        if matter.shape == SHAPE_FREE_SPOT {
            uniform.places = places as u32;
            places += SPOT_PLACES;
        }
        count += 1;
    }
    (all, count)
}

/// `None`: there is no matter with depth.
pub fn matter_variant(volumes: &Volumes, scene: &Scene) -> Option<MatterVariant> {
    if volumes.is_empty() {
        return None;
    }
    let (all, count) = uniforms_of(volumes);
    let mut variant = MatterVariant {
        all_effects: scene.shown_effects().are_whole(),
        shows_depth: scene.view.shows_depth_only(),
        structure: volumes.has_structure(),
        occluded: scene.view == View::Light && scene.occluder.is_some(),
        ..MatterVariant::default()
    };
    variant.alone = volumes.is_alone();
    for matter in &all[..count as usize] {
        variant.shapes |= 1 << matter.shape;
        variant.motions |= 1 << matter.motion;
        variant.power_law |= matter.power_law != 0;
        variant.thermal |= matter.power_law == 0;
    }
    Some(variant)
}
