// SPDX-License-Identifier: MIT OR Apache-2.0
//! Rays that a host asks for, traced side by side.

use crate::error::Result;
use crate::parallel::prelude::*;
use crate::scene::host_rays::{trace_ray, transfer_ray, transfer_setup};
use crate::scene::{Hit, Ray, Scene, Transfer};

/// Traces `rays` in parallel on the current pool.
pub fn trace_rays(scene: &Scene, rays: &[Ray], hits: &mut [Hit]) {
    let settings = scene.quality.ray_settings(scene.hole.spin);
    rays.par_iter().zip(hits).with_min_len(16).for_each(|(ray, hit)| *hit = trace_ray(scene, &settings, ray));
}

/// The matter along `rays`, in parallel on the current pool. Errors: OUT_OF_MEMORY.
pub fn transfer_rays(scene: &Scene, rays: &[Ray], found: &mut [Transfer]) -> Result<()> {
    let setup = transfer_setup(scene, rays)?;
    rays.par_iter().zip(found).for_each(|(ray, found)| *found = transfer_ray(scene, &setup, ray));
    Ok(())
}
