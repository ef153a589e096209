// SPDX-License-Identifier: MIT OR Apache-2.0
//! Rays that a host asks for, on the GPU: started and judged in f64 on the host (`Scene::start`, `Scene::hit`), traced
//! in f32. Four kinds of rays the f64 tracer takes: those of observers so near to the horizon that f32 cannot tell
//! them from it, those that wind about the hole, along which the rounding of f32 grows too large, those in the chart
//! RAIN, and those about holes that spin faster than those of frames.

use super::tracer::GpuTracer;
use crate::allocate::{collected, with_room};
use crate::error::{Error, Result};
use crate::gpu::frame::plan::f32_settings::{ray_settings, variant};
use crate::gpu::frame::uniforms::rays::{RayEnd, RayStart, RaysUniform};
use crate::gpu::kernel::key::{KernelKey, KernelKind};
use crate::physics::geodesic::{Constants, State, wrap_angle};
use crate::physics::observer::LocalFrame;
use crate::physics::orbit::{horizon_inner, horizon_outer};
use crate::physics::trace::{self, PlaneCrossing, RayTrace};
use crate::scene::host_rays::trace_some;
use crate::scene::{Chart, Fate, Hit, MAX_CROSSINGS, Ray, Scene};
use glam::DVec3;
use wgpu::BufferUsages as Usage;

/// Rays of one submission.
const CHUNK: usize = 1 << 14;
/// Distance of an observer from the horizon, relative to its radius, below which u in f32 is off by more than 1e-3 of
/// that distance.
const TOO_NEAR: f64 = 1e-4;
/// `Constants::critical_margin` below which f32 is not enough. It holds all rays that go once round the hole, and those
/// without spin whose impact parameter is within 2.5 % of the critical one; the others pass a point within 2e-5 of
/// its distance (tests/tracers/points.rs).
const WINDS: f64 = 0.05;
/// `RayEnd`s of a ray: its end and its crossings.
const ENDS: usize = 1 + MAX_CROSSINGS;

/// A valid ray of the batch.
struct StartedRay {
    index: usize,
    frame: LocalFrame,
    constants: Constants,
}

impl GpuTracer {
    /// Traces `rays` in submissions of bounded size. Errors: whatever the device reports.
    pub fn trace_rays(&mut self, scene: &Scene, rays: &[Ray], hits: &mut [Hit]) -> Result<()> {
        for (rays, hits) in rays.chunks(CHUNK).zip(hits.chunks_mut(CHUNK)) {
            self.trace_chunk(scene, rays, hits)?;
        }
        Ok(())
    }

    fn trace_chunk(&mut self, scene: &Scene, rays: &[Ray], hits: &mut [Hit]) -> Result<()> {
        let horizon = horizon_outer(scene.hole.spin);
        let all_exact = scene.camera.chart == Chart::Rain || scene.hole.spins_too_fast();
        let mut exact = with_room(rays.len(), "rays to trace")?;
        let mut started = with_room(rays.len(), "rays to trace")?;
        let mut starts = with_room(rays.len(), "rays to trace")?;
        for (index, (ray, hit)) in rays.iter().zip(hits.iter_mut()).enumerate() {
            *hit = Hit::default();
            match scene.start(ray) {
                None => {}
                Some((frame, None)) => {
                    let nothing = RayTrace { swept: 0.0, ..RayTrace::of(trace::Fate::Captured) };
                    *hit = scene.hit(ray, &frame, None, &nothing);
                }
                Some((frame, Some((constants, state))))
                    if all_exact
                        || (frame.r / horizon - 1.0).abs() < TOO_NEAR
                        || constants.critical_margin(&state) < WINDS =>
                {
                    exact.push(index);
                }
                Some((frame, Some((constants, state)))) => {
                    starts.push(ray_start(&constants, &state));
                    started.push(StartedRay { index, frame, constants });
                }
            }
        }
        trace_some(scene, rays, &exact, hits)?;
        if starts.is_empty() {
            return Ok(());
        }
        let ends = self.run(scene, &starts)?;
        for (ray, ends) in started.iter().zip(ends.chunks_exact(ENDS)) {
            hits[ray.index] = finish(scene, &rays[ray.index], ray, ends);
        }
        Ok(())
    }

    fn run(&mut self, scene: &Scene, starts: &[RayStart]) -> Result<Vec<RayEnd>> {
        let device = &self.device;
        let settings = ray_settings(scene);
        let compiled = self.kernels.get(KernelKey::new(KernelKind::Rays, &[&variant(scene, &settings, None)]))?;
        if self.ray_buffers.resources.is_none() {
            let bytes = |size: usize| (CHUNK * size) as u64;
            self.ray_buffers.resources = Some([
                device.buffer("rays", size_of::<RaysUniform>() as u64, Usage::UNIFORM | Usage::COPY_DST)?,
                device.buffer("ray starts", bytes(size_of::<RayStart>()), Usage::STORAGE | Usage::COPY_DST)?,
                device.buffer("ray ends", bytes(size_of::<RayEnd>() * ENDS), Usage::STORAGE | Usage::COPY_SRC)?,
            ]);
        }
        let Some([uniform, input, output]) = &self.ray_buffers.resources else {
            return Err(Error::internal("rays without buffers"));
        };
        let a = scene.hole.spin;
        let values = RaysUniform {
            step: settings.step as f32,
            tolerance: settings.tolerance as f32,
            max_steps: settings.max_steps,
            count: starts.len() as u32,
            a: a as f32,
            r_plus: horizon_outer(a) as f32,
            r_minus: horizon_inner(a) as f32,
            capture_u: settings.capture_u as f32,
        };
        device.write(uniform, 0, bytemuck::bytes_of(&values))?;
        device.write(input, 0, bytemuck::cast_slice(starts))?;
        let stage = compiled
            .stage(device, &[&[uniform.as_entire_binding(), input.as_entire_binding(), output.as_entire_binding()]])?;
        let mut encoder = device.encoder("rays")?;
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            stage.run(&mut pass, None, [values.count.div_ceil(64), 1]);
        }
        let size = (starts.len() * ENDS * size_of::<RayEnd>()) as u64;
        let copied = self.ray_buffers.readback.copy(device, &mut encoder, output, size)?;
        let submission = device.submit(encoder)?;
        copied.read(device, &submission, |bytes| {
            collected(bytes.chunks_exact(size_of::<RayEnd>()).map(bytemuck::pod_read_unaligned), "what rays hit")
        })
    }
}

fn ray_start(c: &Constants, s: &State) -> RayStart {
    let four = |x: f64, y: f64, z: f64, w: f64| [x as f32, y as f32, z as f32, w as f32];
    RayStart {
        light: four(c.energy, c.angular_momentum, c.nu_local, s.du),
        curve: four(c.k, c.b, c.a2e2, c.a * c.a * c.carter),
        n: four(s.n.x, s.n.y, s.n.z, s.u),
        dn: four(s.dn.x, s.dn.y, s.dn.z, c.scale),
    }
}

fn unresolved() -> RayTrace {
    RayTrace::of(trace::Fate::Unresolved)
}

/// N and drag as f64, a state without the rest.
fn place(end: &RayEnd) -> State {
    let [x, y, z, drag] = end.n.map(f64::from);
    State { u: 0.0, du: 0.0, n: DVec3::new(x, y, z), dn: DVec3::ZERO, drag, delay: 0.0 }
}

fn finish(scene: &Scene, ray: &Ray, started: &StartedRay, ends: &[RayEnd]) -> Hit {
    let Some((end, crossings)) = ends.split_first() else { return Hit { fate: Fate::Unresolved, ..Hit::default() } };
    let [fate, steps, count, tau] = end.rest;
    let mut traced = RayTrace { steps, ..unresolved() };
    let swept = || {
        let tau = f64::from(f32::from_bits(tau));
        if started.constants.a == 0.0 { started.constants.k.max(0.0).sqrt() * tau } else { f64::NAN }
    };
    match fate {
        0 => (traced.fate, traced.swept) = (trace::Fate::Captured, swept()),
        1 => {
            (traced.fate, traced.swept) = (trace::Fate::Escaped, swept());
            traced.direction = place(end).chart_direction();
            if !traced.direction.is_finite() {
                traced = RayTrace { steps, ..unresolved() };
            }
        }
        _ => {}
    }
    for x in crossings.iter().take(count as usize) {
        let at = place(x);
        let _ = traced.crossings.try_push(PlaneCrossing {
            u: f64::from(f32::from_bits(x.rest[0])),
            azimuth: wrap_angle(at.n.y.atan2(at.n.x) + at.drag),
            delay: f64::from(f32::from_bits(x.rest[1])),
            order: x.rest[2],
            du: f64::from(f32::from_bits(x.rest[3])),
        });
    }
    scene.hit(ray, &started.frame, Some(&started.constants), &traced)
}
