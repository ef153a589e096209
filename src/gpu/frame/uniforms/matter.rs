// SPDX-License-Identifier: MIT OR Apache-2.0
//! Matter with depth in the layout of the shaders' uniforms: `Matter` of shared/matter.wgsl, field by field; and the
//! choices that kernels are compiled with for it.

use crate::emit::glow::Glow;
use crate::emit::matter::{SpotMatter, VolumeMatter};
use crate::emit::volumes::Volumes;
use crate::gpu::kernel::sizes::MOST_MATTER;
use crate::gpu::kernel::variant::{MatterVariant, MotionCode, SHAPE_SPOT};
use crate::physics::flow::{Flow, Motion};
use crate::scene::{Scene, View};
use bytemuck::{Pod, Zeroable};
use glam::{DVec4, Vec4};

#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct MatterUniform {
    kind: [u32; 4],
    reach: Vec4,
    radii: Vec4,
    form: Vec4,
    motion: Vec4,
    glow: Vec4,
    light: Vec4,
    tint: Vec4,
}

#[cfg(test)]
pub(in crate::gpu) fn layout() -> crate::gpu::kernel::layout::Layout {
    use crate::gpu::kernel::layout::layout;
    layout!(MatterUniform as "Matter": kind, reach, radii, form, motion, glow, light, tint)
}

fn four(x: f64, y: f64, z: f64, w: f64) -> Vec4 {
    DVec4::new(x, y, z, w).as_vec4()
}

fn motion_of(flow: &Flow) -> (MotionCode, Vec4) {
    match flow.motion {
        Motion::Keplerian { sub_keplerian, infall } => (MotionCode::Keplerian, four(sub_keplerian, infall, 0.0, 0.0)),
        Motion::AngularMomentum { l0 } => (MotionCode::AngularMomentum, four(l0, 0.0, 0.0, 0.0)),
        Motion::Rigid { angular_velocity } => (MotionCode::Rigid, four(angular_velocity, 0.0, 0.0, 0.0)),
        Motion::Outflow { speed, base } => (MotionCode::Outflow, four(speed, base, 0.0, 0.0)),
    }
}

impl MatterUniform {
    /// `reach`: 1/r, outer end first, |cos th|, and the least density.
    fn new(shape: u32, flow: &Flow, glow: &Glow, reach: [f64; 4], radii: Vec4, form: Vec4) -> Self {
        let [u_outer, u_inner, cos, least] = reach;
        let (motion, numbers) = motion_of(flow);
        let [red, green, blue] = glow.tint;
        Self {
            kind: [shape, motion as u32, u32::from(glow.power_law), 0],
            reach: four(u_outer, u_inner, cos, flow.sense),
            radii,
            form: form.with_w(flow.isco as f32),
            motion: numbers,
            glow: four(glow.absorption, glow.temperature, glow.reference_radius, glow.temperature_slope),
            light: four(glow.log_reference, glow.spectral_index, glow.brightness, least),
            tint: four(red, green, blue, 0.0),
        }
    }
}

impl From<&VolumeMatter> for MatterUniform {
    fn from(volume: &VolumeMatter) -> Self {
        let (cloud, reach) = (&volume.cloud, &volume.reach);
        Self::new(
            cloud.shape as u32,
            &volume.flow,
            &volume.glow,
            [reach.u[0], reach.u[1], reach.cos, volume.least],
            four(cloud.inner, cloud.outer, cloud.radius, cloud.width),
            four(cloud.thickness, cloud.opening, cloud.slope, 0.0),
        )
    }
}

impl From<&SpotMatter> for MatterUniform {
    fn from(spot: &SpotMatter) -> Self {
        let reach = &spot.reach;
        Self::new(
            SHAPE_SPOT,
            &spot.flow,
            &spot.glow,
            // Shaders leave out what is less; beyond its cut a spot is nothing.
            [reach.u[0], reach.u[1], reach.cos, f64::from(f32::MIN_POSITIVE)],
            four(spot.radius, spot.size, spot.azimuth, spot.angular_velocity),
            // Shaders divide by the thickness of everything.
            four(1.0, 0.0, 0.0, 0.0),
        )
    }
}

/// The matter of a frame, volumes first, and how much there is.
pub fn uniforms_of(volumes: &Volumes) -> ([MatterUniform; MOST_MATTER], u32) {
    let mut all = [MatterUniform::zeroed(); MOST_MATTER];
    let found =
        volumes.volumes.iter().map(MatterUniform::from).chain(volumes.hot_spots.iter().map(MatterUniform::from));
    let mut count = 0;
    for (uniform, matter) in all.iter_mut().zip(found) {
        *uniform = matter;
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
        all_effects: scene.effects.all_light(),
        shows_depth: scene.view.shows_depth_only(),
        structure: volumes.has_structure(),
        occluded: scene.view == View::Light && scene.occluder.is_some(),
        ..MatterVariant::default()
    };
    variant.alone = volumes.is_alone();
    for matter in &all[..count as usize] {
        let [shape, motion, power_law, _] = matter.kind;
        variant.shapes |= 1 << shape;
        variant.motions |= 1 << motion;
        variant.power_law |= power_law != 0;
        variant.thermal |= power_law == 0;
    }
    Some(variant)
}
