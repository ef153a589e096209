// SPDX-License-Identifier: MIT OR Apache-2.0
//! Runs kernels of WGSL functions on whatever Vulkan adapter there is (a software one will do; with none it fails).
//! What a kernel binds is read from its module by naga.

use super::inputs::{INPUTS, OUTPUTS};
use std::collections::BTreeMap;
use wgpu::naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use wgpu::naga::{
    AddressSpace, GlobalVariable, ImageClass, ImageDimension, Module, ScalarKind, StorageAccess, TypeInner, front::wgsl,
};
use wgpu::util::DeviceExt;

/// A texture that functions read, by its name in WGSL.
pub struct Image {
    pub name: &'static str,
    pub format: wgpu::TextureFormat,
    /// Width, height, layers.
    pub size: [u32; 3],
    /// The layers are those of a block, not of an array.
    pub solid: bool,
    /// Each half as wide and high as the one before.
    pub levels: u32,
    pub bytes: Vec<u8>,
}

/// A storage buffer that functions read, by its name in WGSL.
pub struct Table {
    pub name: &'static str,
    pub bytes: Vec<u8>,
}

/// A module that has been read and checked.
pub struct Source {
    pub text: String,
    pub module: Module,
    info: ModuleInfo,
}

impl Source {
    pub fn new(text: String) -> Self {
        let module = wgsl::parse_str(&text).unwrap_or_else(|error| panic!("{}", error.emit_to_string(&text)));
        let info = Validator::new(ValidationFlags::all(), Capabilities::empty())
            .validate(&module)
            .unwrap_or_else(|error| panic!("{}", error.emit_to_string(&text)));
        Self { text, module, info }
    }

    /// The resources that an entry point uses.
    fn bound(&self, entry: &str) -> Vec<&GlobalVariable> {
        let index = self.module.entry_points.iter().position(|point| point.name == entry).expect("an entry point");
        let info = self.info.get_entry_point(index);
        let used = self.module.global_variables.iter().filter(|(handle, _)| !info[*handle].is_empty());
        used.map(|(_, variable)| variable).filter(|variable| variable.binding.is_some()).collect()
    }
}

pub struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
}

/// One kernel to run: entry point, pipeline constants, and the words of its items.
pub struct Job {
    pub entry: String,
    pub constants: Vec<(&'static str, f64)>,
    pub inputs: Vec<u32>,
}

impl Gpu {
    pub fn new() -> Self {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            backends: wgpu::Backends::VULKAN,
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        });
        let adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::VULKAN));
        let adapter = adapters.into_iter().next().expect("a Vulkan adapter (lavapipe counts)");
        let (device, queue) = pollster::block_on(
            adapter.request_device(&wgpu::DeviceDescriptor { required_limits: adapter.limits(), ..Default::default() }),
        )
        .expect("a device");
        Self { device, queue }
    }

    /// The outputs of each job.
    pub fn run(&self, source: &Source, images: &[Image], tables: &[Table], jobs: &[Job]) -> Vec<Vec<f32>> {
        let text = wgpu::ShaderSource::Wgsl(source.text.as_str().into());
        let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source: text });
        let views = images.iter().map(|image| (image.name, self.view(image))).collect::<BTreeMap<_, _>>();
        let tables = tables.iter().map(|table| (table.name, self.buffer(&table.bytes))).collect::<BTreeMap<_, _>>();
        let sampler = |beyond| {
            self.device.create_sampler(&wgpu::SamplerDescriptor {
                address_mode_u: beyond,
                address_mode_v: beyond,
                address_mode_w: beyond,
                mipmap_filter: wgpu::MipmapFilterMode::Linear,
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..Default::default()
            })
        };
        let (smooth, repeating) = (sampler(wgpu::AddressMode::ClampToEdge), sampler(wgpu::AddressMode::Repeat));
        let mut encoder = self.device.create_command_encoder(&Default::default());
        let mut readbacks = Vec::new();
        for job in jobs {
            let items = job.inputs.len() / INPUTS;
            let inputs = self.buffer(bytemuck::cast_slice(&job.inputs));
            let size = (items * OUTPUTS * 4) as u64;
            let make = |usage| {
                self.device.create_buffer(&wgpu::BufferDescriptor {
                    label: None,
                    size,
                    usage,
                    mapped_at_creation: false,
                })
            };
            let outputs = make(wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
            let readback = make(wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
            let bound = source.bound(&job.entry);
            let resource = |name: &str| match name {
                "inputs" => inputs.as_entire_binding(),
                "outputs" => outputs.as_entire_binding(),
                _ if views.contains_key(name) => wgpu::BindingResource::TextureView(&views[name]),
                _ if tables.contains_key(name) => tables[name].as_entire_binding(),
                "smooth_" | "map_sampler" => wgpu::BindingResource::Sampler(&smooth),
                "repeating" => wgpu::BindingResource::Sampler(&repeating),
                _ => panic!("{} uses {name}, which its group does not give", job.entry),
            };
            // f32 textures are read texel by texel.
            let filterable = |v: &GlobalVariable| {
                let image = images.iter().find(|image| Some(image.name) == v.name.as_deref());
                use wgpu::TextureFormat::{R16Float, Rg16Float, Rgb9e5Ufloat, Rgba16Float};
                image.is_some_and(|image| [R16Float, Rg16Float, Rgb9e5Ufloat, Rgba16Float].contains(&image.format))
            };
            let groups = bound.iter().map(|v| v.binding.expect("a binding").group + 1).max().unwrap_or(0);
            let (mut layouts, mut sets) = (Vec::new(), Vec::new());
            for group in 0..groups {
                let here = || bound.iter().filter(|v| v.binding.expect("a binding").group == group);
                let entries = here().map(|v| layout_entry(&source.module, v, filterable(v))).collect::<Vec<_>>();
                let layout = self
                    .device
                    .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries });
                let entries = here().map(|v| wgpu::BindGroupEntry {
                    binding: v.binding.expect("a binding").binding,
                    resource: resource(v.name.as_deref().expect("a name")),
                });
                let entries = entries.collect::<Vec<_>>();
                sets.push(self.device.create_bind_group(&wgpu::BindGroupDescriptor {
                    label: None,
                    layout: &layout,
                    entries: &entries,
                }));
                layouts.push(layout);
            }
            let layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: None,
                bind_group_layouts: &layouts.iter().map(Some).collect::<Vec<_>>(),
                ..Default::default()
            });
            let pipeline = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: None,
                layout: Some(&layout),
                module: &module,
                entry_point: Some(&job.entry),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants: &job.constants,
                    ..Default::default()
                },
                cache: None,
            });
            {
                let mut pass = encoder.begin_compute_pass(&Default::default());
                pass.set_pipeline(&pipeline);
                for (set, number) in sets.iter().zip(0..) {
                    pass.set_bind_group(number, set, &[]);
                }
                pass.dispatch_workgroups((items as u32).div_ceil(64), 1, 1);
            }
            encoder.copy_buffer_to_buffer(&outputs, 0, &readback, 0, size);
            readbacks.push(readback);
        }
        self.queue.submit([encoder.finish()]);
        for readback in &readbacks {
            readback.slice(..).map_async(wgpu::MapMode::Read, |result| result.expect("a mapped buffer"));
        }
        self.device.poll(wgpu::PollType::wait_indefinitely()).expect("an end");
        let read = |buffer: &wgpu::Buffer| {
            bytemuck::pod_collect_to_vec(&buffer.slice(..).get_mapped_range().expect("a mapped buffer"))
        };
        readbacks.iter().map(read).collect()
    }

    fn buffer(&self, contents: &[u8]) -> wgpu::Buffer {
        let usage = wgpu::BufferUsages::STORAGE;
        self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
    }

    fn view(&self, image: &Image) -> wgpu::TextureView {
        let [width, height, layers] = image.size;
        let texture = self.device.create_texture_with_data(
            &self.queue,
            &wgpu::TextureDescriptor {
                label: None,
                size: wgpu::Extent3d { width, height, depth_or_array_layers: layers.max(1) },
                mip_level_count: image.levels,
                sample_count: 1,
                dimension: if image.solid { wgpu::TextureDimension::D3 } else { wgpu::TextureDimension::D2 },
                format: image.format,
                usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
                view_formats: &[],
            },
            Default::default(),
            &image.bytes,
        );
        // No layers: a plain image. Some: an array, if only of one.
        let dimension = match (image.solid, layers) {
            (true, _) => wgpu::TextureViewDimension::D3,
            (false, 0) => wgpu::TextureViewDimension::D2,
            (false, _) => wgpu::TextureViewDimension::D2Array,
        };
        texture.create_view(&wgpu::TextureViewDescriptor { dimension: Some(dimension), ..Default::default() })
    }
}

fn layout_entry(module: &Module, variable: &GlobalVariable, filterable: bool) -> wgpu::BindGroupLayoutEntry {
    let buffer = |ty| wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
    let ty = match (&module.types[variable.ty].inner, variable.space) {
        (TypeInner::Sampler { .. }, _) => wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
        (TypeInner::Image { dim: ImageDimension::D3, class: ImageClass::Sampled { .. }, .. }, _) => {
            wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Float { filterable },
                view_dimension: wgpu::TextureViewDimension::D3,
                multisampled: false,
            }
        }
        (TypeInner::Image { dim: ImageDimension::D2, arrayed, class: ImageClass::Sampled { kind, .. } }, _) => {
            wgpu::BindingType::Texture {
                sample_type: match kind {
                    ScalarKind::Uint => wgpu::TextureSampleType::Uint,
                    _ => wgpu::TextureSampleType::Float { filterable },
                },
                view_dimension: match arrayed {
                    true => wgpu::TextureViewDimension::D2Array,
                    false => wgpu::TextureViewDimension::D2,
                },
                multisampled: false,
            }
        }
        (_, AddressSpace::Storage { access }) => {
            buffer(wgpu::BufferBindingType::Storage { read_only: !access.contains(StorageAccess::STORE) })
        }
        (inner, space) => panic!("{:?}: no test binds {inner:?} in {space:?}", variable.name),
    };
    wgpu::BindGroupLayoutEntry {
        binding: variable.binding.expect("a binding").binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty,
        count: None,
    }
}
