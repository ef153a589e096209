// SPDX-License-Identifier: MIT OR Apache-2.0
//! Compute pipelines from WGSL. Knows no shader.

use super::wgpu_device::Device;
use crate::error::Result;
use crate::platform::Instant;

/// The reason why the loops of a shader are finite, which drivers rely on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Loops {
    /// wgpu counts each loop's turns and ends it after 2^64: safe for every shader, and slow in short loops.
    Counted,
    /// Somebody proved it.
    Proven(ProvenFinite),
}

/// The promise that every loop of a shader ends, whatever its input.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ProvenFinite(());

impl ProvenFinite {
    /// # Safety
    /// In every shader that is compiled with the value, every loop ends after finitely many turns for every input, NaN
    /// included. A driver may draw any conclusion from one that does not.
    pub const unsafe fn promise() -> Self {
        Self(())
    }
}

/// A compute shader's entry point and what it is compiled with.
#[derive(Clone, Copy, Debug)]
pub struct Kernel<'a> {
    pub label: &'a str,
    /// WGSL, joined with line ends; declarations may stand in any order.
    pub source: &'a [&'a str],
    pub loops: Loops,
    pub entry_point: &'a str,
    /// Values of the shader's `override` constants, by name; the others keep their defaults.
    pub constants: &'a [(&'a str, f64)],
    /// False: `var<workgroup>` begins undefined, and the kernel writes it before it reads it.
    pub zero_workgroup_memory: bool,
    /// The layouts of `@group(0)`, `@group(1)` ...
    pub groups: &'a [&'a wgpu::BindGroupLayout],
}

impl Device {
    /// Compiles a kernel; the driver may put its own part off to the first dispatch. Several threads may, whoever uses
    /// the device meanwhile.
    ///
    /// Errors: `Internal` with naga's message for source that is not valid or an unknown constant, with wgpu's for an
    /// unknown entry point or a layout that does not fit, or when the device was lost a moment ago (`Device::explain`
    /// tells); `OutOfMemory`; `DeviceLost`.
    pub fn compute_pipeline(&self, kernel: &Kernel<'_>) -> Result<wgpu::ComputePipeline> {
        let started = Instant::now();
        let text = kernel.source.join("\n");
        let (source, constants) = self.shaders.translated(kernel.label, text, kernel.entry_point, kernel.constants)?;
        let checks = wgpu::ShaderRuntimeChecks {
            force_loop_bounding: kernel.loops == Loops::Counted,
            ..wgpu::ShaderRuntimeChecks::checked()
        };
        let module = self.scoped_off_thread(kernel.label, |device| {
            let descriptor = wgpu::ShaderModuleDescriptor { label: Some(kernel.label), source };
            // SAFETY: the one check that may be off is that of the loops, and whoever made the ProvenFinite vouches
            // for them.
            unsafe { device.create_shader_module_trusted(descriptor, checks) }
        })?;
        let translated = started.elapsed();
        let groups = kernel.groups.iter().map(|group| Some(*group)).collect::<Vec<_>>();
        let pipeline = self.scoped_off_thread(kernel.label, |device| {
            let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(kernel.label),
                bind_group_layouts: &groups,
                immediate_size: 0,
            });
            let descriptor = wgpu::ComputePipelineDescriptor {
                label: Some(kernel.label),
                layout: Some(&layout),
                module: &module,
                entry_point: Some(kernel.entry_point),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants,
                    zero_initialize_workgroup_memory: kernel.zero_workgroup_memory,
                },
                cache: None,
            };
            self.compiling(|| device.create_compute_pipeline(&descriptor))
        })?;
        log::debug!(
            "kernel {}: module {} ms, pipeline {} ms",
            kernel.label,
            translated.as_millis(),
            (started.elapsed() - translated).as_millis()
        );
        Ok(pipeline)
    }
}
