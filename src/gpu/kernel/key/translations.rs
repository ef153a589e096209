// SPDX-License-Identifier: MIT OR Apache-2.0
//! Kernels of every kind, with every value of each of their choices, in the languages of Direct3D 12 and of Metal: with
//! the options and the bindings of wgpu-hal, which makes its pipelines of such text. `BHR_HLSL_FOLDER` names a folder
//! that gets the HLSL, for a compiler (tests/hlsl/run).

use super::super::slots::Slot;
use super::super::variant::{OutputPlace, OutputPlaces, RecordMaker};
use super::super::wgsl;
use super::tests::{Given, Random, kinds};
use super::{KernelKey, KernelKind};
use crate::gpu::device::specialise::Parsed;
use crate::scene::{RayOutput, RayOutputKind};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use wgpu::naga::back::pipeline_constants::process_overrides;
use wgpu::naga::back::{hlsl, msl};
use wgpu::naga::proc::{BoundsCheckPolicies, BoundsCheckPolicy};
use wgpu::naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use wgpu::naga::{Module, ResourceBinding, ShaderStage};

/// Draws of choices, of which the one goes into a list that has the most values which the list lacks.
const DRAWS: usize = 512;

/// Kernels of a kind that everyday runs translate: they have most of the values.
const EVERYDAY: usize = 2;

/// Kernels of a kind that have every value of every choice which the kind reads and which is not folded away.
fn covering(kind: KernelKind) -> Vec<KernelKey> {
    let (mut random, mut seen, mut keys) = (Random(3), BTreeSet::new(), Vec::new());
    loop {
        let keys_drawn = (0..DRAWS).map(|_| KernelKey::new(kind, &[&Given::random(&mut random)]));
        let lacking = |key: &KernelKey| {
            let pairs = key.values.constants().map(|(constant, value)| (constant, value as u64));
            pairs.filter(|pair| !seen.contains(pair)).collect::<Vec<_>>()
        };
        let best = keys_drawn.map(|key| (lacking(&key), key)).max_by_key(|(lacking, _)| lacking.len());
        let Some((lacking, key)) = best.filter(|(lacking, _)| !lacking.is_empty() || keys.is_empty()) else {
            return keys;
        };
        seen.extend(lacking);
        keys.push(key);
    }
}

/// Targets of every kind of outputs, in every form.
fn places() -> OutputPlaces {
    use OutputPlace::{AlignedNumbers, Number, NumberImage, Numbers, NumbersImage};
    use RayOutputKind::{Depth, Disk, Order, Position, Sky};
    let all = [(Depth, Number), (Sky, NumbersImage), (Position, Numbers), (Order, NumberImage), (Disk, AlignedNumbers)];
    let mut places = OutputPlaces::default();
    let all = all.map(|(kind, place)| (RayOutput { kind, index: 0 }, place));
    places.iter_mut().zip(all).for_each(|(to, place)| *to = Some(place));
    places
}

fn all_kernels(most: usize) -> Vec<KernelKey> {
    let makers = [RecordMaker::Traced, RecordMaker::Schwarzschild, RecordMaker::Kerr, RecordMaker::KerrDeferred];
    let into_targets = makers.map(|maker| KernelKind::Outputs(maker, places()));
    kinds().into_iter().chain(into_targets).flat_map(|kind| covering(kind).into_iter().take(most)).collect()
}

/// The registers of a pipeline's bindings, as wgpu-hal deals them out (`create_pipeline_layout` of its module `dx12`).
fn hlsl_options(groups: &[Vec<Slot>], shader_model: hlsl::ShaderModel) -> hlsl::Options {
    let mut options = hlsl::Options {
        shader_model,
        fake_missing_bindings: false,
        zero_initialize_workgroup_memory: false,
        restrict_indexing: true,
        force_loop_bounding: false,
        ..Default::default()
    };
    let [mut constants, mut views, mut writes] = [hlsl::BindTarget::default(); 3];
    let next = |target: &mut hlsl::BindTarget| {
        target.register += 1;
        hlsl::BindTarget { register: target.register - 1, ..*target }
    };
    for (slots, group) in groups.iter().zip(0..) {
        let place = |binding| ResourceBinding { group, binding };
        let mut samplers = 0;
        for (slot, binding) in slots.iter().zip(0..) {
            let target = match slot {
                Slot::Uniform => next(&mut constants),
                Slot::Read | Slot::Texture(_) | Slot::Filtered(_) => next(&mut views),
                Slot::Write | Slot::TextureWrite(_) => next(&mut writes),
                Slot::Sampler => {
                    samplers += 1;
                    hlsl::BindTarget { space: 255, register: samplers - 1, ..Default::default() }
                }
                Slot::UniformPart => continue,
            };
            options.binding_map.insert(place(binding), target);
        }
        if samplers > 0 {
            options.sampler_buffer_binding_map.insert(hlsl::SamplerIndexBufferKey { group }, next(&mut views));
        }
        for (_, binding) in slots.iter().zip(0..).filter(|(slot, _)| **slot == Slot::UniformPart) {
            let target = hlsl::BindTarget { restrict_indexing: true, ..next(&mut constants) };
            options.binding_map.insert(place(binding), target);
        }
    }
    options.special_constants_binding = Some(constants);
    options
}

/// The slots of a pipeline's bindings, as wgpu-hal deals them out (`create_pipeline_layout` of its module `metal`).
fn msl_options(groups: &[Vec<Slot>], entry_point: &str) -> msl::Options {
    let (mut buffers, mut textures, mut samplers, mut sized) = (0, 0, 0, false);
    let next = |slot: &mut msl::Slot| {
        *slot += 1;
        *slot - 1
    };
    let mut resources = msl::EntryPointResources::default();
    for (slots, group) in groups.iter().zip(0..) {
        for (slot, binding) in slots.iter().zip(0..) {
            sized |= matches!(slot, Slot::Read | Slot::Write);
            let mut target = msl::BindTarget::default();
            match slot {
                Slot::Uniform | Slot::UniformPart | Slot::Read | Slot::Write => {
                    target.buffer = Some(next(&mut buffers))
                }
                Slot::Texture(_) | Slot::Filtered(_) | Slot::TextureWrite(_) => {
                    target.texture = Some(next(&mut textures));
                }
                Slot::Sampler => target.sampler = Some(msl::BindSamplerTarget::Resource(next(&mut samplers))),
            }
            target.mutable = matches!(slot, Slot::Write | Slot::TextureWrite(_));
            resources.resources.insert(ResourceBinding { group, binding }, target);
        }
    }
    resources.sizes_buffer = sized.then_some(buffers);
    let checks = BoundsCheckPolicy::Restrict;
    msl::Options {
        // The oldest one that wgpu uses.
        lang_version: (2, 0),
        per_entry_point_map: [(entry_point.to_owned(), resources)].into(),
        fake_missing_bindings: false,
        bounds_check_policies: BoundsCheckPolicies {
            index: checks,
            buffer: checks,
            image_load: checks,
            binding_array: BoundsCheckPolicy::Unchecked,
        },
        zero_initialize_workgroup_memory: false,
        force_loop_bounding: false,
        ..Default::default()
    }
}

/// A shader for one entry point, valid on devices without optional features.
struct Shader<'a> {
    module: Module,
    info: ModuleInfo,
    stage: ShaderStage,
    entry_point: &'a str,
    groups: Vec<Vec<Slot>>,
}

impl<'a> Shader<'a> {
    fn new(module: Module, stage: ShaderStage, entry_point: &'a str, groups: Vec<Vec<Slot>>) -> Result<Self, String> {
        let info = Validator::new(ValidationFlags::all(), Capabilities::empty())
            .validate(&module)
            .map_err(|error| format!("{error:?}"))?;
        Ok(Self { module, info, stage, entry_point, groups })
    }

    /// The name of the function in HLSL, and the text.
    fn hlsl(
        &self,
        shader_model: hlsl::ShaderModel,
        next: Option<&hlsl::FragmentEntryPoint<'_>>,
    ) -> Result<[String; 2], String> {
        let options = hlsl_options(&self.groups, shader_model);
        let pipeline = hlsl::PipelineOptions { entry_point: Some((self.stage, self.entry_point.into())) };
        let mut text = String::new();
        let written = hlsl::Writer::new(&mut text, &options, &pipeline).write(&self.module, &self.info, next);
        let mut names = written.map_err(|error| format!("HLSL: {error:?}"))?.entry_point_names;
        let name = names.pop().expect("an entry point").map_err(|error| format!("HLSL: {error}"))?;
        Ok([name, text])
    }

    fn msl(&self) -> Result<String, String> {
        let options = msl_options(&self.groups, self.entry_point);
        let pipeline = msl::PipelineOptions {
            entry_point: Some((self.stage, self.entry_point.into())),
            vertex_pulling_transform: true,
            ..Default::default()
        };
        let (text, mut names) = msl::write_string(&self.module, &self.info, &options, &pipeline)
            .map_err(|error| format!("MSL: {error:?}"))?;
        names.entry_point_names.pop().expect("an entry point").map_err(|error| format!("MSL: {error}"))?;
        Ok(text)
    }
}

/// The stages of the pipeline that fills windows, with each value of its constants.
fn present(each: &mut dyn FnMut(&Shader<'_>, Option<&hlsl::FragmentEntryPoint<'_>>, &str)) {
    let source = wgsl::kernel("window/present").unwrap();
    let parsed = wgpu::naga::front::wgsl::parse_str(&source).unwrap();
    let of_any_device = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&parsed).unwrap();
    let texture = Slot::Filtered(crate::gpu::device::texture::SCREEN);
    for (stretched, linear) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        let constants = [("STRETCHED".to_owned(), stretched.into()), ("LINEAR".to_owned(), linear.into())];
        let constants = constants.into_iter().collect();
        let shader = |stage, entry_point| {
            let (module, _) =
                process_overrides(&parsed, &of_any_device, Some((stage, entry_point)), &constants).unwrap();
            Shader::new(module.into_owned(), stage, entry_point, vec![vec![texture, Slot::Sampler]]).unwrap()
        };
        let [cover, show] =
            [(ShaderStage::Vertex, "cover"), (ShaderStage::Fragment, "show")].map(|(s, e)| shader(s, e));
        let next = hlsl::FragmentEntryPoint::new(&show.module, "show").expect("an entry point");
        let what = format!("present, STRETCHED {stretched}, LINEAR {linear}");
        each(&cover, Some(&next), &what);
        each(&show, None, &what);
    }
}

#[test]
fn kernels_translate_for_direct3d_12_and_metal() {
    let folder = std::env::var_os("BHR_HLSL_FOLDER");
    let all = folder.is_some() || std::env::var_os("BHR_TESTS_ALL").is_some_and(|value| value == "1");
    let (mut count, mut bytes, mut wrong) = (0, [0, 0], Vec::new());
    let mut translate = |shader: &Shader<'_>, next: Option<&hlsl::FragmentEntryPoint<'_>>, what: &str| {
        let profile = match shader.stage {
            ShaderStage::Vertex => "vs_6_0",
            ShaderStage::Fragment => "ps_6_0",
            _ => "cs_6_0",
        };
        let texts = shader.hlsl(hlsl::ShaderModel::V6_0, next).and_then(|hlsl| Ok((hlsl, shader.msl()?)));
        let ([name, hlsl], msl) = match texts {
            Ok(texts) => texts,
            Err(error) => return wrong.push(format!("{what}: {error}")),
        };
        if let Some(folder) = &folder {
            let file = Path::new(folder).join(format!("{count:04}.{profile}.{name}.hlsl"));
            std::fs::write(file, format!("// {what}\n{hlsl}")).expect("BHR_HLSL_FOLDER can be written to");
        }
        count += 1;
        bytes = [bytes[0] + hlsl.len(), bytes[1] + msl.len()];
    };
    let mut sources = BTreeMap::new();
    for key in all_kernels(if all { usize::MAX } else { EVERYDAY }) {
        let what = format!("{:?} {:?}", key.kind, key.constants());
        let parsed = sources.entry(key.kind.wgsl().unwrap()).or_insert_with_key(|wgsl| Parsed::new("", wgsl).unwrap());
        let module = parsed.specialised("", key.kind.entry_point(), &key.constants()).unwrap();
        match Shader::new(module, ShaderStage::Compute, key.kind.entry_point(), key.kind.groups()) {
            Ok(shader) => translate(&shader, None, &what),
            Err(error) => panic!("{what}: {error}"),
        }
    }
    present(&mut translate);
    println!("{count} shaders: {} bytes of HLSL, {} of MSL", bytes[0], bytes[1]);
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(count > kinds().len(), "{count} shaders");
}
