// SPDX-License-Identifier: MIT OR Apache-2.0
//! The WGSL of colour, stars and film: parses, validates with no capability, and agrees with the Rust that it
//! mirrors on whatever Vulkan adapter there is (a software one will do; with none it fails).

use bhr::film::{FilmParams, develop};
use bhr::image::PixelFormat;
use bhr::physics::blackbody::{BlackbodyTable, MIN_TEMPERATURE};
use bhr::scene::{Film, Grade, ToneMap, View};
use bhr::sky::StarField;
use glam::DVec3;
use wgpu::util::DeviceExt;

const BINDINGS: &str = "
#import film/film
#import shared/blackbody
#import shared/frame
#import sky/stars
@group(0) @binding(0) var<storage, read> light_tables: array<vec4<f32>>;
@group(0) @binding(1) var<storage, read> star_cells: array<u32>;
@group(0) @binding(2) var<storage, read> inputs: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read_write> outputs: array<vec4<u32>>;
@group(0) @binding(4) var<uniform> film: FilmParams;
fn light_table(i: u32) -> vec4<f32> { return light_tables[i]; }
fn star_cell(i: u32) -> u32 { return star_cells[i]; }
fn to_sky(d: vec3<f32>) -> vec3<f32> { return d; }
fn least_patch() -> f32 { return 1e-3; }
var<private> frame: Frame;
";

/// Every item is four vectors; its result is one.
const ENTRIES: &str = "
@compute @workgroup_size(64) fn run_blackbody(@builtin(global_invocation_id) id: vec3<u32>) {
    if 4u * id.x >= arrayLength(&inputs) { return; }
    let a = inputs[4u * id.x];
    outputs[id.x] = bitcast<vec4<u32>>(vec4<f32>(shifted_blackbody(a.x, a.y, a.z, a.w), 0.0));
}
@compute @workgroup_size(64) fn run_stars(@builtin(global_invocation_id) id: vec3<u32>) {
    if 4u * id.x >= arrayLength(&inputs) { return; }
    let i = 4u * id.x;
    let d = inputs[i].xyz;
    let g = inputs[i + 3u];
    outputs[id.x] = bitcast<vec4<u32>>(
        vec4<f32>(star_light(d, footprint_of(d, inputs[i + 1u].xyz, inputs[i + 2u].xyz), g.x, g.y), 0.0));
}
@compute @workgroup_size(64) fn run_film(@builtin(global_invocation_id) id: vec3<u32>) {
    if 4u * id.x >= arrayLength(&inputs) { return; }
    let place = bitcast<vec4<u32>>(inputs[4u * id.x + 1u]);
    outputs[id.x] = develop(inputs[4u * id.x], place.x, place.y);
}
";

type Item = [[f32; 4]; 4];

fn source() -> String {
    let joined = bhr::gpu::join_wgsl(&[BINDINGS, ENTRIES].concat()).expect("WGSL that can be joined");
    joined.replace("@group(2) @binding(2) var film_lut", "@group(0) @binding(5) var film_lut")
}

#[test]
fn snippets_are_valid_without_any_capability() {
    let source = source();
    let module = naga::front::wgsl::parse_str(&source).unwrap_or_else(|e| panic!("{}", e.emit_to_string(&source)));
    naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty())
        .validate(&module)
        .unwrap_or_else(|e| panic!("{}", e.emit_to_string(&source)));
}

/// A device with the shaders of this file, or why there is none.
struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
    module: wgpu::ShaderModule,
}

impl Gpu {
    fn new() -> Self {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            backends: wgpu::Backends::VULKAN,
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        });
        let adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::VULKAN));
        let adapter = adapters.into_iter().next().expect("a Vulkan adapter (lavapipe counts)");
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            required_limits: wgpu::Limits::downlevel_defaults(),
            ..Default::default()
        }))
        .expect("device");
        let shader = wgpu::ShaderModuleDescriptor { label: None, source: wgpu::ShaderSource::Wgsl(source().into()) };
        let module = device.create_shader_module(shader);
        Self { device, queue, module }
    }

    fn run(&self, entry: &str, film: FilmParams, items: &[Item]) -> Vec<[u32; 4]> {
        let storage = |contents: &[u8], usage| {
            self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
        };
        let index = StarField::catalogue().expect("an index");
        let size = items.len() as u64 * 16;
        let output = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let readback = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let buffers = [
            storage(bytemuck::cast_slice(&index.light_tables().collect::<Vec<_>>()), wgpu::BufferUsages::STORAGE),
            storage(bytemuck::cast_slice(&index.cell_tables().collect::<Vec<_>>()), wgpu::BufferUsages::STORAGE),
            storage(bytemuck::cast_slice(items), wgpu::BufferUsages::STORAGE),
            output.clone(),
            storage(bytemuck::bytes_of(&film), wgpu::BufferUsages::UNIFORM),
        ];
        let kinds = [true, true, true, false].map(|read_only| wgpu::BufferBindingType::Storage { read_only });
        let kinds = kinds.into_iter().chain([wgpu::BufferBindingType::Uniform]);
        let buffer_of = |ty| wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
        let lut_type = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: false },
            view_dimension: wgpu::TextureViewDimension::D3,
            multisampled: false,
        };
        let entries: Vec<_> = kinds
            .map(buffer_of)
            .chain([lut_type])
            .zip(0..)
            .map(|(ty, binding)| wgpu::BindGroupLayoutEntry {
                binding,
                visibility: wgpu::ShaderStages::COMPUTE,
                ty,
                count: None,
            })
            .collect();
        let layout =
            self.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries });
        let pipeline_layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &[Some(&layout)],
            ..Default::default()
        });
        let pixels = match film.format {
            1 | 2 => 0,
            3 | 4 => 1,
            5 => 2,
            other => panic!("which kernel develops format {other}?"),
        };
        let constants = [
            ("PIXELS", f64::from(pixels)),
            ("TONE_MAP", f64::from(film.tone_map)),
            ("COLOUR_MAP", f64::from(film.colour_map)),
            ("GRADE", f64::from(film.grade.graded)),
            ("LUT", 0.0),
            ("FALSE_COLOUR", f64::from(u32::from(film.false_colour != 0))),
        ];
        let pipeline = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: None,
            layout: Some(&pipeline_layout),
            module: &self.module,
            entry_point: Some(entry),
            compilation_options: wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() },
            cache: None,
        });
        // These films have no LUT; src/gpu/twins has.
        let lut = self.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D3,
            format: wgpu::TextureFormat::Rgba32Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let lut = lut.create_view(&wgpu::TextureViewDescriptor::default());
        let resources = buffers.iter().map(|buffer| buffer.as_entire_binding());
        let entries: Vec<_> = resources
            .chain([wgpu::BindingResource::TextureView(&lut)])
            .zip(0..)
            .map(|(resource, binding)| wgpu::BindGroupEntry { binding, resource })
            .collect();
        let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &layout,
            entries: &entries,
        });
        let mut encoder = self.device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.dispatch_workgroups((items.len() as u32).div_ceil(64), 1, 1);
        }
        encoder.copy_buffer_to_buffer(&output, 0, &readback, 0, size);
        self.queue.submit([encoder.finish()]);
        readback.slice(..).map_async(wgpu::MapMode::Read, |result| result.expect("map"));
        self.device.poll(wgpu::PollType::wait_indefinitely()).expect("poll");
        bytemuck::pod_collect_to_vec(&readback.slice(..).get_mapped_range().expect("range"))
    }
}

fn no_film() -> FilmParams {
    FilmParams::new(&Film::plain(), View::Light, PixelFormat::Rgba8Srgb, false)
}

fn xyz0(v: DVec3) -> [f32; 4] {
    [v.x as f32, v.y as f32, v.z as f32, 0.0]
}

fn widened(v: [f32; 4]) -> DVec3 {
    DVec3::new(v[0].into(), v[1].into(), v[2].into())
}

#[test]
fn gpu_blackbody_agrees() {
    let gpu = Gpu::new();
    let table = BlackbodyTable::shared();
    let mut items: Vec<Item> = Vec::new();
    for i in 0..600 {
        let temperature = 150.0 * 1.05_f32.powi(i);
        for (g_colour, g_beaming) in [(1.0, 1.0), (0.3, 0.3), (3.0, 1.0), (1.0, 0.5)] {
            let reference = table.ln_luminance(f64::from(temperature).max(500.0)) as f32;
            items.push([[temperature, reference, g_colour, g_beaming], [0.0; 4], [0.0; 4], [0.0; 4]]);
        }
    }
    for (item, bits) in items.iter().zip(gpu.run("run_blackbody", no_film(), &items)) {
        let [temperature, reference, g_colour, g_beaming] = item[0].map(f64::from);
        let rgb = table.shifted_blackbody(temperature, reference, g_colour, g_beaming);
        let scale = rgb.iter().fold(1e-30_f64, |a, &b| a.max(b));
        // Cold light is the exponential of a large number, known to 2^-24 of itself.
        let cold = 2e-7 * 22135.0 / (temperature * g_colour).max(MIN_TEMPERATURE);
        for c in 0..3 {
            let got = f64::from(f32::from_bits(bits[c]));
            assert!((got - rgb[c]).abs() <= (1e-5 + cold) * scale, "{item:?}: {got} for {}", rgb[c]);
        }
    }
}

#[test]
fn gpu_stars_agree() {
    let gpu = Gpu::new();
    let index = StarField::catalogue().expect("an index");
    let mut items: Vec<Item> = Vec::new();
    for (i, star) in index.stars.iter().step_by(2 * 89).enumerate() {
        let near = widened(*star).normalize();
        let right = near.any_orthonormal_vector();
        let up = right.cross(near);
        let scale = [2e-4, 1.6e-3, 8e-3, 0.02, 0.1][i % 5];
        let squeeze = [1.0, 0.1, 3.0][i % 3];
        let d = (near + right * (0.4 * scale) + up * (0.7 * scale * squeeze)).normalize();
        let tangent = |t: DVec3| xyz0(t - d * d.dot(t));
        let g = [1.0, 0.7, 1.4][i / 5 % 3];
        items.push([xyz0(d), tangent(right * scale), tangent(up * -scale * squeeze), [g, g, 0.0, 0.0]]);
    }
    items.push([[1.0, 0.0, 0.0, 0.0], [f32::NAN; 4], [0.0; 4], [1.0; 4]]);
    items.push([[1.0, 0.0, 0.0, 0.0], [0.0, 1e30, 0.0, 0.0], [0.0; 4], [1.0; 4]]);
    items.push([[1.0, 0.0, 0.0, 0.0], [0.0; 4], [0.0; 4], [1.0; 4]]);
    let mut lit = 0;
    for (item, bits) in items.iter().zip(gpu.run("run_stars", no_film(), &items)) {
        let g = item[3][0].into();
        let rgb = index.star_light(widened(item[0]), [widened(item[1]), widened(item[2])], g, g, 1e-3);
        let scale = rgb.iter().fold(1e-6_f64, |a, &b| a.max(b));
        lit += u32::from(scale > 1e-6);
        for c in 0..3 {
            let got = f64::from(f32::from_bits(bits[c]));
            // Places are known to 6e-8 rad: 1e-3 of the finest pixel here.
            assert!((got - rgb[c]).abs() <= 3e-3 * scale, "{item:?}: {got} for {rgb:?}");
        }
    }
    assert!(lit as usize > items.len() / 2, "{lit} of {} directions show stars", items.len());
}

#[test]
fn gpu_film_agrees() {
    let gpu = Gpu::new();
    let mut items: Vec<Item> = Vec::new();
    for i in 0..4000_u32 {
        let value = |k: u32| 2.0_f32.powf((i * (2 * k + 3) % 997) as f32 / 997.0 * 24.0 - 14.0);
        let place = [f32::from_bits(i % 61), f32::from_bits(i * 7), 0.0, 0.0];
        items.push([[value(1), value(2), value(3), (i % 11) as f32 * 0.1], place, [0.0; 4], [0.0; 4]]);
    }
    let odd = [f32::NAN, -1.0, 0.0, f32::INFINITY, 1.0, 65504.0, 70000.0, 6.1e-5, 1e-7, 3e-8];
    items.extend(odd.map(|v| [[v, 0.0, 1.0, v], [0.0; 4], [0.0; 4], [0.0; 4]]));
    let tone_maps = [ToneMap::None, ToneMap::Aces, ToneMap::Agx, ToneMap::Filmic];
    let formats = [PixelFormat::Rgba8Srgb, PixelFormat::Bgra8Srgb, PixelFormat::Rgba16F, PixelFormat::Rgba32F];
    let mut cases = Vec::new();
    for tone_map in tone_maps {
        for format in formats {
            let film = Film { tone_map, exposure_ev: 0.5, ..Film::plain() };
            cases.push(FilmParams::new(&film, View::Light, format, format != PixelFormat::Rgba16F));
        }
        let grade = Grade {
            white_balance: 4200.0,
            tint: -0.2,
            contrast: 1.3,
            saturation: 1.4,
            vignette: 0.7,
            grain: 0.5,
            grain_seed: 3.0,
        };
        let film = Film { tone_map, grade, ..Film::plain() };
        cases.push(FilmParams::new(&film, View::Light, PixelFormat::Rgba8Srgb, false).over_frame(640, 480));
    }
    for view in [View::Redshift, View::Order, View::Deflection, View::Steps, View::Metric] {
        cases.push(FilmParams::new(&Film::plain(), view, PixelFormat::Rgba8Srgb, false));
    }
    cases.push(FilmParams::new(&Film::plain(), View::Redshift, PixelFormat::R32F, false));
    for params in cases {
        let tolerance = if params.format <= 2 { 1 } else { 0 };
        for (item, words) in items.iter().zip(gpu.run("run_film", params, &items)) {
            let wanted = develop(&params, item[0], item[1][0].to_bits(), item[1][1].to_bits());
            for (got, wanted) in words.iter().flat_map(|w| w.to_le_bytes()).zip(wanted) {
                assert!(got.abs_diff(wanted) <= tolerance, "{params:?} {item:?}: {words:x?}");
            }
        }
    }
}
