// SPDX-License-Identifier: MIT OR Apache-2.0
//! The ray records of a frame, for tests: has records/export.wgsl write them, and reads them back.

use super::tracer::GpuTracer;
use crate::allocate::collected;
use crate::emit::medium::Media;
use crate::emit::moment::Shutter;
use crate::emit::{Crossing, EmissionPoint};
use crate::error::{Error, Result};
use crate::gpu::frame::passes::picture::RecordConsumer;
use crate::gpu::frame::resources::frame_buffers::Size;
use crate::gpu::frame::resources::tables::Tables;
use crate::gpu::frame::uniforms::frame::pass_of;
use crate::gpu::kernel::kernels::Kernels;
use crate::gpu::kernel::key::KernelKey;
use crate::gpu::kernel::sizes::EXPORT_VECTORS;
use crate::gpu::kernel::variant::PixelTarget;
use crate::gpu::lens::traced::{Shared, structure_group};
use crate::physics::trace::Fate;
use crate::scene::Scene;
use crate::scene::record::Record;
use crate::scene::refine::Edge;
use crate::tracer::{FrameRequest, Tile};
use glam::DVec3;

/// Bytes of a record.
pub const EXPORT_BYTES: u64 = 16 * EXPORT_VECTORS as u64;

/// The record in `bytes`, EXPORT_BYTES of them.
pub fn imported(bytes: &[u8]) -> Record {
    let mut v = [[0.0_f64; 4]; EXPORT_VECTORS];
    for (out, word) in v.as_flattened_mut().iter_mut().zip(bytes.chunks_exact(4)) {
        *out = bytemuck::pod_read_unaligned::<f32>(word).into();
    }
    let [[fate, steps, count, plane_u], [x, y, z, redshift], [xx, xy, xz, energy], [yx, yy, yz, momentum], rest @ ..] =
        v;
    let fate = match fate as u32 {
        0 => Fate::Captured,
        1 => Fate::Escaped,
        2 => Fate::Unresolved,
        _ => Fate::Hidden,
    };
    let place = |[ln_r, azimuth, delay, _]: [f64; 4]| EmissionPoint { ln_r, azimuth, delay };
    let crossing = |[at, dx, dy]: &[[f64; 4]; 3]| Crossing {
        u: dx[3],
        order: at[3] as u32,
        g: dy[3],
        place: place(*at),
        footprint: [place(*dx), place(*dy)],
        share: 1.0,
    };
    Record {
        fate,
        direction: DVec3::new(x, y, z),
        footprint: [DVec3::new(xx, xy, xz), DVec3::new(yx, yy, yz)],
        turned: f64::NAN,
        sky_redshift: if fate == Fate::Escaped { redshift } else { f64::NAN },
        energy,
        angular_momentum: momentum,
        // The polar momentum does not leave the GPU.
        polar_momentum: 0.0,
        steps: steps as u32,
        plane_u,
        beside_disk: 0,
        edge: Edge::None,
        crossings: rest.as_chunks().0.iter().take(count as usize).map(crossing).collect(),
        media: Media::new(),
    }
}

impl GpuTracer {
    /// The records of a frame, row by row; for tests. Errors: as `render`; INTERNAL for more than one tile holds.
    pub fn ray_records(&mut self, scene: &Scene, request: &FrameRequest) -> Result<Vec<Record>> {
        let records = self.try_records(scene, request);
        if records.is_err() {
            self.forget();
        }
        records
    }

    fn try_records(&mut self, scene: &Scene, request: &FrameRequest) -> Result<Vec<Record>> {
        let setup = self.planner().set_up(scene, request, PixelTarget::Packed)?;
        let tile = [request.width, request.height];
        let device = &self.device;
        let size = Size { tile, pixel_bytes: EXPORT_BYTES, several_samples: false };
        self.buffers.prepare(device, size, &setup, self.adapter.info.software)?;
        let buffers = &mut self.buffers;
        let (fixed, sized) = buffers
            .fixed
            .as_ref()
            .zip(buffers.sized.as_ref())
            .ok_or_else(|| Error::internal("a frame without buffers"))?;
        let (frame, pass) = (fixed.frame.buffer.as_entire_binding(), fixed.pass());
        let (common, exported) = ([frame.clone(), pass.clone()], [sized.packed.as_entire_binding()]);
        let tables = Tables::prepare(&mut self.tables, device, scene, &setup)?;
        let [light_tables, ..] = tables.resources();
        let step_sum = fixed.step_sum.as_entire_binding();
        let software = self.adapter.info.software;
        let structure = structure_group(fixed.clouds.buffer(), tables.structure());
        let (frame, pass, occluder) = (frame.clone(), pass.clone(), tables.occluder().resource());
        let shared = Shared { frame, pass, step_sum, light_tables, structure, occluder, software };
        let records = buffers.record_store.stages(device, &self.kernels, &setup.record_setup, &shared)?;
        let group = buffers.record_store.group(setup.record_setup.source)?;
        let take = |kernels: &Kernels, source| {
            kernels.get(KernelKey::export(source, setup.variants.shade))?.stage(device, &[&common, &group, &exported])
        };
        let consumer = RecordConsumer::new(&self.kernels, &setup.record_setup, self.adapter.info.software, take)?;

        let whole = Tile { x: 0, y: 0, width: request.width, height: request.height };
        let fixed = buffers.fixed.as_mut().ok_or_else(|| Error::internal("a frame without buffers"))?;
        let lens = (scene.camera.projection, Shutter::default());
        let pass = pass_of(request, whole, (0, 1), lens, 0, [0, 0]);
        fixed.passes.write(device, bytemuck::bytes_of(&pass))?;
        let mut encoder = device.encoder("records")?;
        if let Some(bake) = tables.bake(device, &self.kernels, &setup)? {
            bake.encode(&mut encoder);
        }
        buffers.record_store.reset(setup.record_setup.source, &fixed.step_sum, &mut encoder);
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            records.encode(&mut pass, true, 0, tile);
            consumer.dispatch(&mut pass, 0, tile);
        }
        let bytes = u64::from(request.width) * u64::from(request.height) * EXPORT_BYTES;
        let copied = buffers.readback.copy(device, &mut encoder, &sized.packed, bytes)?;
        let submission = device.submit(encoder)?;
        copied.read(device, &submission, |bytes| {
            collected(bytes.chunks_exact(EXPORT_BYTES as usize).map(imported), "the records of a frame's rays")
        })
    }
}
