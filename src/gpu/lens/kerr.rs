// SPDX-License-Identifier: MIT OR Apache-2.0
//! The tables of a Kerr lens on the device: nodes traced and cells judged by compute passes when the observer or the
//! disk has changed, read by lens/kerr_record.wgsl; and the pixels that they leave to integration. Knows observers and
//! kernels, no scene.

use crate::error::{Error, Result};
use crate::gpu::device::buffer::Buffer;
use crate::gpu::device::texture::Texture;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::kernel::choices::Choice;
use crate::gpu::kernel::kernels::Kernels;
use crate::gpu::kernel::key::{KernelKey, KernelKind};
use crate::gpu::kernel::sizes::{KERR_COLUMNS, KERR_PER_OCTAVE};
use crate::gpu::kernel::slots::{LENS_COLUMNS, LENS_FLAGS, LENS_ROWS, TextureKind};
use crate::gpu::kernel::stage::{self, Stage};
use crate::physics::lens::critical::CRITICAL_NODES;
use crate::physics::lens::kerr::{Branch, Crossings, Grid, Resolution};
use crate::physics::observer::LocalFrame;
use crate::recent::Recent;
use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec4};
use wgpu::BufferUsages as Usage;

/// Orders in a layer without pattern.
const ORDERS_A_LAYER: u32 = 4;
/// Rows are made in so many at once: an observer that moves changes their number.
const ROWS_STEP: u32 = 64;
/// `Deferred` of lens/kerr_record.wgsl: bytes before the pixels, and of a pixel.
const DEFERRED_HEAD: u64 = 68;
const DEFERRED_PIXEL: u64 = 4;

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
struct KerrUniform {
    k: Vec4,
    e1: Vec4,
    e2: Vec4,
    rows: [u32; 2],
    orders: u32,
    capture_u: f32,
}

#[cfg(test)]
pub(in crate::gpu) fn layout() -> crate::gpu::kernel::layout::Layout {
    crate::gpu::kernel::layout::layout!(KerrUniform as "KerrLens": k, e1, e2, outer_rows = rows + 0,
        inner_rows = rows + 4, orders,
        capture_u)
}

/// The contents that are asked of the tables.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KerrContents {
    /// Orders of crossings; 0 without a disk.
    pub orders: u32,
    pub plane_u: [f64; 2],
    pub pattern: bool,
    pub delay: bool,
}

/// Everything that decides the nodes' content.
#[derive(Clone, Copy, Debug, PartialEq)]
struct KerrKey {
    a: f64,
    place: [f64; 3],
    /// Azimuth.
    e_phi: DVec3,
    rain: bool,
    orders: u32,
    pattern: bool,
    delay: bool,
}

impl KerrKey {
    fn new(frame: &LocalFrame, contents: &KerrContents) -> Self {
        Self {
            a: frame.a,
            place: [frame.r, frame.sin, frame.cos],
            e_phi: frame.e_phi,
            rain: frame.rain,
            orders: contents.orders,
            pattern: contents.pattern,
            delay: contents.delay,
        }
    }
}

/// The tables, of several observers by turns; made when first needed.
#[derive(Default)]
pub struct KerrTables {
    kept: Recent<KerrKey, KerrResources>,
    deferred: Option<Buffer>,
}

struct KerrResources {
    /// Counts of the outer rows and of all rows.
    rows: [u32; 2],
    layers: u32,
    uniform: Buffer,
    curve: Texture,
    sky: Texture,
    crossings: Texture,
    flags: Texture,
    /// The counts of rows that are in use.
    used: [u32; 2],
    /// The interval in 1/r of the plane for which cells are judged.
    flagged: Option<[f64; 2]>,
}

/// The passes that bring tables up to date.
pub struct KerrStages {
    trace_nodes: Option<Stage>,
    flag_cells: Stage,
    size: [u32; 2],
}

impl KerrTables {
    /// Bytes of a tile's pixel on the device.
    pub const BYTES_PER_PIXEL: u64 = DEFERRED_PIXEL;

    /// Makes room for the deferred pixels of a tile.
    pub fn prepare(&mut self, device: &Device, tile: [u32; 2]) -> Result<()> {
        let size = DEFERRED_HEAD + u64::from(tile[0]) * u64::from(tile[1]) * DEFERRED_PIXEL;
        if self.deferred.as_ref().is_none_or(|d| d.size() < size) {
            self.deferred = None;
            let usage = Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST;
            self.deferred = Some(device.buffer("deferred pixels", size, usage)?);
        }
        Ok(())
    }

    /// Empties the list of deferred pixels and the sum of their steps.
    pub fn reset(&self, encoder: &mut wgpu::CommandEncoder) {
        if let Some(deferred) = &self.deferred {
            encoder.clear_buffer(deferred, 0, Some(DEFERRED_HEAD));
        }
    }

    /// Begins with the sum of the steps of deferred pixels.
    pub fn deferred(&self) -> Option<&Buffer> {
        self.deferred.as_ref()
    }

    /// Brings the tables up to the observer and the disk; the stages to run before they are read, `None` if they are as
    /// needed already. `frame_uniform` holds the observer. Errors: INTERNAL for an observer that has no tables.
    pub fn update(
        &mut self,
        device: &Device,
        kernels: &Kernels,
        frame: &LocalFrame,
        contents: &KerrContents,
        frame_uniform: wgpu::BindingResource<'_>,
    ) -> Result<Option<KerrStages>> {
        let key = KerrKey::new(frame, contents);
        let traced = self.kept.find(&key);
        if traced && self.kept.first().is_some_and(|m| m.flagged == Some(contents.plane_u)) {
            return Ok(None);
        }
        if !traced {
            let goes = self.kept.make_room(&key);
            self.kept.put(key, KerrResources::remade(goes, device, frame, contents)?);
        }
        let resources = self.kept.first_mut().ok_or_else(|| Error::internal("a lens without tables"))?;
        resources.flagged = Some(contents.plane_u);
        let used = resources.used;
        let view = |texture: &Texture| texture.view.clone();
        let (curve, sky, crossings, flags) =
            (view(&resources.curve), view(&resources.sky), view(&resources.crossings), view(&resources.flags));
        let texture = wgpu::BindingResource::TextureView;
        let lens = resources.uniform.as_entire_binding();
        let shared = [frame_uniform, lens, texture(&curve), texture(&sky), texture(&crossings)];
        let choices = [
            (Choice::DELAY, contents.delay.into()),
            (Choice::PATTERN, contents.pattern.into()),
            (Choice::RAIN, frame.rain.into()),
        ];
        let trace_nodes = match traced {
            true => None,
            false => Some(kernels.get(KernelKey::new(KernelKind::KerrNodes, &[&choices]))?.stage(device, &[&shared])?),
        };
        let all = [shared.as_slice(), &[texture(&flags)]].concat();
        let flag_cells = kernels.get(KernelKey::new(KernelKind::KerrFlags, &[&choices]))?.stage(device, &[&all])?;
        Ok(Some(KerrStages { trace_nodes, flag_cells, size: [KERR_COLUMNS, used[0] + used[1]] }))
    }

    /// Frees the tables.
    pub fn release(&mut self) {
        self.kept.clear();
    }

    /// After a submission that failed, nobody knows what the tables hold.
    pub fn forget(&mut self) {
        self.kept.clear();
    }

    /// Group 1 of a shading kernel, after the media.
    pub fn group(&self) -> Result<Vec<wgpu::BindingResource<'_>>> {
        let parts = self.kept.first().zip(self.deferred.as_ref());
        let (resources, deferred) = parts.ok_or_else(|| Error::internal("a lens without tables"))?;
        let tables = [&resources.curve, &resources.sky, &resources.crossings, &resources.flags];
        let tables = tables.map(|t| wgpu::BindingResource::TextureView(&t.view));
        let (uniform, deferred) = (resources.uniform.as_entire_binding(), deferred.as_entire_binding());
        Ok([uniform].into_iter().chain(tables).chain([deferred]).collect())
    }
}

impl KerrResources {
    /// Room for an observer's tables, that of others if it serves, with what the host knows of them written.
    fn remade(goes: Option<Self>, device: &Device, frame: &LocalFrame, contents: &KerrContents) -> Result<Self> {
        let resolution = Resolution { chi_nodes: KERR_COLUMNS as usize, nodes_per_octave: [KERR_PER_OCTAVE; 2] };
        let crossings =
            Crossings { orders: contents.orders as usize, plane_u: contents.plane_u, pattern: contents.pattern };
        let grid = Grid::new(frame, resolution, crossings)
            .ok_or_else(|| Error::internal(format!("no lens tables for an observer at r = {} M", frame.r)))?;
        let rows = [Branch::Outer, Branch::Inner].map(|branch| grid.rows(branch) as u32);
        let needed = [rows[0], rows[0] + rows[1]];
        let layers = if contents.pattern { contents.orders } else { contents.orders.div_ceil(ORDERS_A_LAYER) };
        let serves = |m: &Self| (0..2).all(|i| m.rows[i] >= needed[i]) && m.layers >= layers;
        // Frees the old tables before making new ones, unless they are large enough.
        let mut resources = match goes.filter(serves) {
            Some(resources) => resources,
            None => Self::new(device, needed.map(|n| n.next_multiple_of(ROWS_STEP)), layers)?,
        };
        (resources.used, resources.flagged) = (rows, None);
        let curve = grid.curve();
        let local = |v: DVec3| v.as_vec3().extend(0.0);
        let uniform = KerrUniform {
            k: curve.k.as_vec3().extend(grid.epsilon() as f32),
            e1: local(curve.e1),
            e2: local(curve.e2),
            rows,
            orders: contents.orders,
            capture_u: grid.capture_u() as f32,
        };
        let node = |i: usize| curve.at(std::f64::consts::TAU * i as f64 / CRITICAL_NODES as f64);
        let nodes = (0..=CRITICAL_NODES).map(node).collect::<Vec<_>>();
        let table = nodes.windows(2).flat_map(|pair| pair.iter().flat_map(|(t, slope)| [*t as f32, *slope as f32]));
        let column = |chi: f64| [chi.sin(), chi.cos(), curve.at(chi).0, 0.0].map(|v| v as f32);
        let columns = grid.column_angles().iter().flat_map(|chi| column(*chi)).collect::<Vec<f32>>();
        device.write(&resources.uniform, 0, bytemuck::bytes_of(&uniform))?;
        device.write_rows(&resources.curve, 0, bytemuck::cast_slice(&table.collect::<Vec<f32>>()))?;
        device.write_rows(&resources.curve, 1, bytemuck::cast_slice(&columns))?;
        Ok(resources)
    }

    fn new(device: &Device, rows: [u32; 2], layers: u32) -> Result<Self> {
        let texture = |kind: TextureKind, label: &str, height: u32, layers: u32| {
            device.texture(label, kind.format, kind.dimension, [KERR_COLUMNS, height], layers)
        };
        // wgpu makes no array texture of one layer on GL.
        let layers = layers.max(2);
        Ok(Self {
            rows,
            layers,
            uniform: device.buffer("lens", size_of::<KerrUniform>() as u64, Usage::UNIFORM | Usage::COPY_DST)?,
            curve: device.table("critical curve", LENS_ROWS.format, [KERR_COLUMNS, 2])?,
            sky: texture(LENS_ROWS, "lens sky", rows[0], 1)?,
            crossings: texture(LENS_COLUMNS, "lens crossings", rows[1], layers)?,
            flags: texture(LENS_FLAGS, "lens flags", rows[1], 1)?,
            used: rows,
            flagged: None,
        })
    }
}

impl KerrStages {
    /// Whether nodes are traced: the tables are made, not only judged anew.
    pub fn make_tables(&self) -> bool {
        self.trace_nodes.is_some()
    }

    pub fn encode(&self, pass: &mut wgpu::ComputePass<'_>) {
        let groups = stage::pixel_groups(self.size);
        if let Some(trace) = &self.trace_nodes {
            trace.run(pass, None, groups);
        }
        self.flag_cells.run(pass, None, groups);
    }
}
