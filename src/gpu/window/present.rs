// SPDX-License-Identifier: MIT OR Apache-2.0
//! The full-screen triangle that fills an image with a texture of 8-bit codes. Knows no window.

use crate::error::Result;
use crate::gpu::device::texture::Texture;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::kernel::wgsl;

/// Pipelines for images of one format.
pub struct Presenter {
    layout: wgpu::BindGroupLayout,
    sampler: wgpu::Sampler,
    /// For a texture as large as the image, and for one that is stretched to it.
    pipelines: [wgpu::RenderPipeline; 2],
}

impl Presenter {
    /// Errors: as [`Device::scoped`] and [`wgsl::kernel`].
    pub fn new(device: &Device, format: wgpu::TextureFormat) -> Result<Self> {
        device.with_deep_stack(|| Self::made(device, format))
    }

    fn made(device: &Device, format: wgpu::TextureFormat) -> Result<Self> {
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty,
            count: None,
        };
        let texture = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: true },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
        let entries = [entry(0, texture), entry(1, sampler)];
        let source = wgsl::kernel("window/present")?;
        device.scoped("present", |d| {
            let layout = d.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some("present"),
                entries: &entries,
            });
            let pipeline_layout = d.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some("present"),
                bind_group_layouts: &[Some(&layout)],
                immediate_size: 0,
            });
            let module = d.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some("present"),
                source: wgpu::ShaderSource::Wgsl(source.into()),
            });
            // A format that the GPU encodes wants linear light.
            let linear = format.is_srgb() || format == wgpu::TextureFormat::Rgba16Float;
            let pipeline = |stretched: bool| {
                let constants =
                    [("STRETCHED", f64::from(u8::from(stretched))), ("LINEAR", f64::from(u8::from(linear)))];
                let options = wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() };
                d.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                    label: Some("present"),
                    layout: Some(&pipeline_layout),
                    vertex: wgpu::VertexState {
                        module: &module,
                        entry_point: Some("cover"),
                        compilation_options: options.clone(),
                        buffers: &[],
                    },
                    primitive: wgpu::PrimitiveState::default(),
                    depth_stencil: None,
                    multisample: wgpu::MultisampleState::default(),
                    fragment: Some(wgpu::FragmentState {
                        module: &module,
                        entry_point: Some("show"),
                        compilation_options: options,
                        targets: &[Some(format.into())],
                    }),
                    multiview_mask: None,
                    cache: None,
                })
            };
            let pipelines = device.compiling(|| [pipeline(false), pipeline(true)]);
            let filter = wgpu::FilterMode::Linear;
            let sampler = d.create_sampler(&wgpu::SamplerDescriptor {
                mag_filter: filter,
                min_filter: filter,
                ..Default::default()
            });
            Self { layout, sampler, pipelines }
        })
    }

    /// Records the filling of `image`, `size` pixels, with `screen`. Errors: as [`Device::scoped`].
    pub fn draw(
        &self,
        device: &Device,
        encoder: &mut wgpu::CommandEncoder,
        screen: &Texture,
        image: &wgpu::TextureView,
        size: [u32; 2],
        timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) -> Result<()> {
        let resources =
            [wgpu::BindingResource::TextureView(&screen.view), wgpu::BindingResource::Sampler(&self.sampler)];
        let group = device.bind(&self.layout, &resources)?;
        let [same, stretched] = &self.pipelines;
        // SAFETY: the triangle covers the image (window/present.wgsl), and nothing discards a part of it.
        let written = unsafe { wgpu::LoadOpDontCare::enabled() };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("present"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: image,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::DontCare(written), store: wgpu::StoreOp::Store },
            })],
            timestamp_writes: timestamps,
            ..Default::default()
        });
        pass.set_pipeline(if screen.size() == size { same } else { stretched });
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
        Ok(())
    }
}
