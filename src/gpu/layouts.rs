// SPDX-License-Identifier: MIT OR Apache-2.0
//! Compiled for tests only: the structs which Rust writes for shaders, and reads from them, lie in memory as WGSL has
//! them.

use super::frame::resources::{bloom_textures, ghost_buffers, meter_buffers, occluder, sky_target, spike_buffers};
use super::frame::uniforms::{bake, band, clouds, frame, matter, outputs, rays};
use super::kernel::layout::{Layout, layout};
use super::kernel::wgsl::shader_sources;
use super::lens::{kerr, schwarzschild};
use std::collections::{BTreeMap, BTreeSet};
use wgpu::naga::{AddressSpace, Module, TypeInner, front::wgsl};

/// Every struct that Rust shares with shaders.
fn shared() -> Vec<Layout> {
    let film = layout!(crate::film::FilmParams as "FilmParams": exposure, tone_map, format, false_colour, view_low,
        view_scale, transparent, colour_map, graded = grade + 0, contrast = grade + 4, contrast_factor = grade + 8,
        saturation = grade + 12, vignette_centre = grade + 16, vignette_scale = grade + 24, vignette = grade + 28,
        white_balance = grade + 32, grain = grade + 80, grain_cells = grade + 84, grain_seed = grade + 88,
        unused = grade + 92, filmic_toe = filmic + 0, filmic_line = filmic + 16, filmic_shoulder = filmic + 32,
        lut_low = lut + 0, lut_side = lut + 12, lut_scale = lut + 16, lut_strength = lut + 28,
        primaries_red = hdr + 0, primaries_green = hdr + 16, primaries_blue = hdr + 32, hdr_white = hdr + 48,
        hdr_peak = hdr + 52, hdr_knee = hdr + 56, hlg_peak = hdr + 60, hlg_exponent = hdr + 64, unused_1 = hdr + 68,
        unused_2 = hdr + 72, unused_3 = hdr + 76);
    let [scene, pass] = frame::layouts();
    let [given, start, end] = rays::layouts();
    let [ghost, ghosts] = ghost_buffers::layouts();
    let [level, beam] = bloom_textures::layouts();
    let [meter, exposure] = meter_buffers::layouts();
    let [cloud, clouds] = clouds::layouts();
    let (matter, kerr, schwarzschild) = (matter::layout(), kerr::layout(), schwarzschild::layout());
    vec![
        film,
        scene,
        pass,
        outputs::layout(),
        sky_target::layout(),
        occluder::layout(),
        matter,
        band::layout(),
        bake::layout(),
        cloud,
        clouds,
        given,
        start,
        end,
        kerr,
        schwarzschild,
        level,
        beam,
        ghost,
        ghosts,
        spike_buffers::layout(),
        meter,
        exposure,
    ]
}

type Members<'a> = Vec<(&'a str, usize)>;

/// The structs of a module by name: size, and members with their offsets.
fn structs(module: &Module) -> BTreeMap<&str, (usize, Members<'_>)> {
    let named = module.types.iter().filter_map(|(_, ty)| match (&ty.inner, ty.name.as_deref()) {
        (TypeInner::Struct { members, span }, Some(name)) => {
            let members = members.iter().filter_map(|m| Some((m.name.as_deref()?, m.offset as usize))).collect();
            Some((name, (*span as usize, members)))
        }
        _ => None,
    });
    named.collect()
}

#[test]
fn structs_lie_in_memory_as_in_wgsl() {
    let sources = shader_sources().expect("WGSL that can be joined");
    let modules = sources.iter().map(|(_, source)| wgsl::parse_str(source).expect("WGSL")).collect::<Vec<_>>();
    let shared = shared();
    let mut uniforms = BTreeSet::new();
    let mut compared = BTreeSet::new();
    for module in &modules {
        let structs = structs(module);
        let names = module.global_variables.iter().filter(|(_, variable)| variable.space == AddressSpace::Uniform);
        uniforms.extend(names.filter_map(|(_, variable)| module.types[variable.ty].name.as_deref()));
        for layout in &shared {
            if let Some((size, members)) = structs.get(layout.name) {
                assert_eq!((size, members), (&layout.size, &layout.members), "{}", layout.name);
                compared.insert(layout.name);
            }
        }
    }
    assert_eq!(compared, shared.iter().map(|layout| layout.name).collect(), "structs that no shader has");
    assert!(uniforms.is_subset(&compared), "a uniform that is compared with none: {uniforms:?}, {compared:?}");
}
