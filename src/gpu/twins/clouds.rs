// SPDX-License-Identifier: MIT OR Apache-2.0
//! Twins of emit/bands, emit/filaments and emit/clouds: structure of matter with depth.

use super::inputs::Inputs;
use super::run::{Image, Table};
use super::{Group, ROUNDING, SAME, TRANSCENDENTAL, twin};
use crate::emit::baked::Baked;
use crate::emit::baking::BakeKey;
use crate::emit::bands::When;
use crate::emit::bands::{GENERATION_FADE, Generations, bands_at, generation_key};
use crate::emit::clouds::{Blur, Carried, CloudPlace, Clouds, bend, footprint, worth};
use crate::emit::effects::EffectStrengths;
use crate::emit::filaments::{
    FILAMENT_LAST, FILAMENT_SIDES, Filaments, filament_log_mean, filament_variance, level_variances,
};
use crate::emit::grid::GRID_LEVELS;
use crate::emit::matter::{Accuracy, VolumeMatter};
use crate::emit::shape::{Cloud, Stretch};
use crate::emit::volume::{FlowLaw, Shape, Volume};
use crate::emit::volumes::Volumes;
use crate::gpu::frame::uniforms::clouds::CloudsUniform;
use crate::random::mix;
use std::f64::consts::PI;
use std::sync::OnceLock;

/// The hooks of a kernel, and the volumes of `volumes`.
const HOOKS: &str = "
#import emit/bands
#import emit/clouds
#import emit/filaments
@group(1) @binding(15) var<storage, read> clouds: Clouds;
@group(1) @binding(16) var filaments: texture_3d<f32>;
@group(1) @binding(17) var repeating: sampler;
@group(1) @binding(18) var baked: texture_3d<f32>;
@group(1) @binding(19) var<storage, read> variances: array<vec4<f32>>;
fn filament_texel(place: vec3<f32>, level: f32) -> f32 {
    return textureSampleLevel(filaments, repeating, place, level).x;
}
fn level_variances(level: u32) -> vec2<f32> {
    return variances[level].xy;
}
fn baked_factor(index: u32, place: vec3<f32>, level: f32) -> f32 {
    return textureSampleLevel(baked, repeating, place, level).x;
}
";

/// One of each shape, of which the last is a jet and the third even.
fn volumes() -> &'static Volumes {
    static VOLUMES: OnceLock<Volumes> = OnceLock::new();
    VOLUMES.get_or_init(|| {
        let disk = Volume { turbulence: 1.0, outer_radius: 40.0, seed: 7, ..Volume::default() };
        let flow = FlowLaw::AngularMomentum;
        let torus = Volume { shape: Shape::Torus, flow, retrograde: true, thickness: 0.3, ..disk };
        let halo = Volume { shape: Shape::Halo, turbulence: 0.0, ..disk };
        let (flow, thickness) = (FlowLaw::Outflow, 0.02);
        let jet = Volume { shape: Shape::Jet, flow, thickness, turbulence: 0.6, seed: u64::MAX, ..disk };
        let when = When { time: 12_345.0, reference_delay: 100.0, delayed: true, shutter: 0.0 };
        Volumes::new(&[disk, torus, halo, jet], &[], 0.7, EffectStrengths::default(), when, Accuracy::PICTURE)
    })
}

fn images() -> Vec<Image> {
    let levels = Filaments::shared().expect("filaments").levels().map(|level| level.expect("a level").1);
    let texels = levels.flatten().map(half::f16::to_bits).collect::<Vec<_>>();
    let baked = baked().texels().iter().flatten().map(|texel| half::f16::from_f32(*texel).to_bits());
    let baked = baked.collect::<Vec<_>>();
    let image = |name, size: [usize; 3], levels: usize, texels: &[u16]| Image {
        name,
        format: wgpu::TextureFormat::R16Float,
        size: size.map(|side| side as u32),
        solid: true,
        levels: levels as u32,
        bytes: bytemuck::cast_slice(texels).to_vec(),
    };
    let key = key(0).expect("structure");
    vec![
        image("filaments", FILAMENT_SIDES, FILAMENT_LAST + 1, &texels),
        image("baked", key.clouds.grid.sides(key.finest), GRID_LEVELS - key.finest, &baked),
    ]
}

/// The key of the structure of a volume.
fn key(index: usize) -> Option<BakeKey> {
    let key = volumes().volumes[index].bake_key(0.7, 1.0, 0.0);
    key.map(|key| BakeKey { finest: 2, ..key })
}

/// The structure of the first volume.
fn baked() -> &'static Baked {
    static BAKED: OnceLock<Baked> = OnceLock::new();
    BAKED.get_or_init(|| Baked::new(&key(0).expect("structure")).expect("texels"))
}

fn tables() -> Vec<Table> {
    let clouds = CloudsUniform::new(&[0, 1, 2, 3].map(key));
    let variances = level_variances().map(|[fine, coarse]| [fine as f32, coarse as f32, 0.0, 0.0]);
    vec![
        Table { name: "clouds", bytes: bytemuck::bytes_of(&clouds).to_vec() },
        Table { name: "variances", bytes: bytemuck::cast_slice(&variances).to_vec() },
    ]
}

fn volume(i: &Inputs) -> (&'static VolumeMatter, Option<&'static Clouds>, Cloud) {
    let volume = &volumes().volumes[i.word(0) as usize];
    (volume, volume.clouds.as_ref(), volume.cloud)
}

/// A volume that has structure.
fn structured(i: &mut Inputs) {
    let picked = [0, 1, 3][i.random.below(3) as usize];
    i.push_word(picked);
}

/// A volume that has structure, a place and a time, how matter is carried there, and the width of a pixel.
fn push_place(i: &mut Inputs) {
    structured(i);
    push_place_between(i, 2.5, 40.0);
}

fn push_place_between(i: &mut Inputs, low: f64, high: f64) {
    let r = i.log(low, high);
    i.even(-0.99, 0.99);
    i.even(-PI, PI);
    i.even(-50.0, 50.0);
    i.push(1.0 / (r * r.sqrt() + 0.7));
    i.even(-0.01, 0.01);
    i.log(1e-3, 1.0);
}

fn place(i: &Inputs) -> (CloudPlace, Carried) {
    let at = CloudPlace { r: i.x(1), cos: i.x(2), azimuth: i.x(3), later: i.x(4) };
    (at, Carried { omega: i.x(5), drift: i.x(6) })
}

/// A band's age, time from birth to birth and number, as bits are given, and how much later.
fn push_band(i: &mut Inputs) {
    let spacing = i.random.log(5.0, 1e3);
    let age = spacing * i.random.share();
    i.push(age);
    i.push(spacing);
    i.bits();
    i.even(-3.0 * spacing, 3.0 * spacing);
}

fn band(i: &Inputs) -> crate::emit::bands::Band {
    crate::emit::bands::Band {
        age: i.x(0),
        spacing: i.x(1),
        generation: i.word(2),
        drift: 0.0,
        fade: GENERATION_FADE,
        eased: false,
    }
}

pub fn group() -> Group {
    let (bands, filaments, clouds) = ("emit/bands", "emit/filaments", "emit/clouds");
    let twins = vec![
        twin(
            bands,
            "bands_at band_weights",
            "let at = bands_at(in3(0u)); out3(band_weights(at, false)); out3(band_weights(at, true));",
            |i| {
                let middle = i.random.even(-1.0, 9.0);
                let apart = [0.0, 0.01, 0.1][i.random.below(3) as usize];
                i.push(middle - apart);
                i.push(middle);
                i.push(middle + apart);
            },
            |i, o| {
                let [first, next] = bands_at([0, 1, 2].map(|k| i.x(k))).shares;
                o.all(first, 1.0);
                o.all(next, 1.0);
            },
            ROUNDING,
        ),
        twin(
            bands,
            "bands_at band_index",
            "let at = bands_at(vec3<f32>(in1(0u))); out1(f32(at.first)); out1(f32(at.count));
             out1(f32(band_index(i32(word(1u)), 3)));",
            |i| {
                // Away from where one band becomes two.
                let border = f64::from(i.random.below(30));
                let across = [0.05, 0.1, 0.3, 0.5, 0.7, 0.9][i.random.below(6) as usize];
                i.push((border + across) * crate::emit::bands::BAND);
                i.pick(80);
            },
            |i, o| {
                let at = bands_at([i.x(0)]);
                o.put(f64::from(at.first));
                o.put(at.count as f64);
                o.put((f64::from(i.word(1)) - 3.0).clamp(0.0, crate::emit::bands::MOST_BANDS as f64 - 1.0));
            },
            SAME,
        )
        .exactly(),
        twin(
            bands,
            "generations",
            "let there = generations(Band(in1(0u), in1(1u), word(2u), 0.0), in1(3u));
             out1(there.young); out2(there.weights); out_word(there.youngest);",
            push_band,
            |i, o| {
                let Generations { young, youngest, weights, .. } = band(i).generations(i.x(3));
                o.near(young, i.x(1));
                o.all(weights, 1.0);
                o.word(youngest);
            },
            TRANSCENDENTAL,
        ),
        twin(
            bands,
            "generation_key",
            "out_word(generation_key(bitcast<i32>(word(0u)), word(1u), word(2u)));",
            |i| {
                i.bits();
                i.bits();
                i.bits();
            },
            |i, o| o.word(generation_key(i.word(0) as i32, i.word(1), i.word(2))),
            SAME,
        ),
        twin(
            bands,
            "mix_bits",
            "out_word(mix_bits(word(0u)));",
            |i| {
                i.bits();
            },
            |i, o| o.word(mix(i.word(0))),
            SAME,
        ),
        twin(
            filaments,
            "filament_value faded_level",
            "out1(filament_value(in3(0u), in1(3u)));",
            |i| {
                i.evens(3, -2.0, 3.0);
                i.even(-0.5, 7.5);
            },
            |i, o| {
                let place = i.v3(0).to_array();
                o.near(Filaments::shared().expect("filaments").value(place, i.x(3)), 1.0);
            },
            // Samplers weigh texels, and levels, in steps of 1/256.
            2e-2,
        ),
        twin(
            filaments,
            "filament_variance",
            "out1(filament_variance(in1(0u)));",
            |i| {
                i.even(-0.5, 7.5);
            },
            |i, o| o.near(filament_variance(i.x(0)), 1.0),
            ROUNDING,
        ),
        twin(
            filaments,
            "filament_log_mean",
            "out1(filament_log_mean(in1(0u)));",
            |i| {
                i.even(0.0, 3.0);
            },
            |i, o| o.near(filament_log_mean(i.x(0)), 0.01),
            ROUNDING,
        ),
        twin(
            clouds,
            "cloud_place",
            "out3(cloud_place(word(0u), CloudPlace(in1(1u), in1(2u), in1(3u), in1(4u)), in2(5u)));",
            push_place,
            |i, o| {
                let (_, clouds, cloud) = volume(i);
                let (at, carried) = place(i);
                let [turns, row, layer] = clouds.expect("structure").place(&cloud, &at, carried);
                // Turns of 100 M and more.
                o.near(turns, 10.0);
                o.near(row, 1.0);
                o.near(layer, 1.0);
            },
            TRANSCENDENTAL,
        ),
        twin(
            clouds,
            "cloud_blur",
            "out1(cloud_blur(word(0u), in1(1u), in1(2u), in1(7u)));",
            push_place,
            |i, o| {
                let (_, clouds, cloud) = volume(i);
                let blur = Blur { footprint: i.x(7), spacing: 0.0 };
                o.put(clouds.expect("structure").level(&cloud, i.x(1), i.x(2), blur).exp2());
            },
            TRANSCENDENTAL,
        ),
        twin(
            clouds,
            "cloud_pattern cloud_factor",
            "let at = CloudPlace(in1(1u), in1(2u), in1(3u), in1(4u)); out2(cloud_pattern(0u, at, in2(5u), in1(7u)));",
            |i| {
                // Not where the rows end: this sampler goes around there as well.
                i.push_word(0);
                push_place_between(i, 6.0, 25.0);
            },
            |i, o| {
                let (_, clouds, cloud) = volume(i);
                let (at, carried) = place(i);
                let blur = Blur { footprint: i.x(7), spacing: 0.0 };
                let seen = baked().pattern((clouds.expect("structure"), &cloud), &at, carried, blur);
                o.near(seen.density, seen.density.max(1.0));
                o.near(seen.heat, 1.0);
            },
            // Samplers weigh texels, and levels, in steps of 1/256.
            2e-2,
        ),
        twin(
            clouds,
            "cloud_worth",
            "out1(cloud_worth(in1(0u), in1(1u)));",
            |i| {
                i.log(1e-6, 1.0);
                i.log(1e-6, 1.0);
            },
            |i, o| o.put(worth(i.x(0), i.x(1))),
            TRANSCENDENTAL,
        ),
        twin(
            clouds,
            "cloud_height cloud_texels",
            "out2(cloud_height(word(0u), in1(1u), in1(2u))); out3(cloud_texels(word(0u)));",
            |i| {
                structured(i);
                i.log(2.0, 40.0);
                i.even(-1.0, 1.0);
            },
            |i, o| {
                let (_, clouds, cloud) = volume(i);
                // A difference of cosines.
                o.all(cloud.height(i.x(1), i.x(2)), 1.0);
                o.all(clouds.expect("structure").texels(), 1.0);
            },
            ROUNDING,
        ),
        twin(
            clouds,
            "cloud_passed",
            "out1(cloud_passed(word(0u), in2(1u), in2(3u), in1(5u)));",
            |i| {
                i.pick(4);
                i.log(0.02, 0.5);
                i.log(0.02, 0.5);
                i.evens(2, -0.99, 0.99);
                i.even(0.0, 0.3);
            },
            |i, o| {
                let (_, clouds, cloud) = volume(i);
                let stretch = Stretch { u: [i.x(1), i.x(2)], cos: [i.x(3), i.x(4)], swept: i.x(5) };
                o.put(clouds.map_or(0.0, |clouds| clouds.passed(&cloud, &stretch)));
            },
            TRANSCENDENTAL,
        ),
        twin(
            clouds,
            "cloud_samples",
            "out1(cloud_samples(word(0u), in1(1u), in1(2u), in1(3u)));",
            |i| {
                structured(i);
                i.log(1.0, 1e3);
                i.log(2.0, 40.0);
                i.log(1e-3, 1.0);
            },
            |i, o| {
                let (_, clouds, cloud) = volume(i);
                o.put(clouds.expect("structure").samples(&cloud, i.x(1), i.x(2), i.x(3)));
            },
            ROUNDING,
        ),
        twin(
            clouds,
            "cloud_bend",
            "out1(cloud_bend(in1(0u), in1(1u), in1(2u), in1(3u), word(4u) == 1u));",
            |i| {
                i.even(0.0, 10.0);
                i.log(1e-3, 50.0);
                i.log(2.0, 1e3);
                i.log(1.1, 60.0);
                i.pick(2);
            },
            |i, o| o.near(bend(i.x(0), i.x(1), i.x(2), i.x(3), i.word(4) == 1), 6.0),
            TRANSCENDENTAL,
        ),
        twin(
            clouds,
            "cloud_footprint",
            "out1(cloud_footprint(in1(0u), in1(1u), in1(2u), in1(3u), in1(4u), in1(5u)));",
            |i| {
                i.log(1e-5, 0.1);
                i.log(0.1, 1e3);
                i.log(1e-3, 50.0);
                i.log(2.0, 1e3);
                i.log(1.1, 60.0);
                i.even(0.0, 20.0);
            },
            |i, o| o.put(footprint(i.x(0), i.x(1), i.x(2), i.x(3), i.x(4), i.x(5))),
            // The exponential of a number as large.
            2e-5,
        ),
    ];
    Group { name: "clouds", head: HOOKS.into(), twins, images, tables }
}

/// The uniform lies in memory as WGSL has it.
#[test]
fn clouds_lie_in_memory_as_in_wgsl() {
    use wgpu::naga::TypeInner;
    let source = group().source();
    for layout in crate::gpu::frame::uniforms::clouds::layouts() {
        let found = source.module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(layout.name));
        let Some((_, TypeInner::Struct { members, span })) = found.map(|(_, ty)| (0, ty.inner.clone())) else {
            panic!("no struct {}", layout.name);
        };
        let members = members.iter().map(|m| (m.name.as_deref().expect("a name"), m.offset as usize));
        assert_eq!((span as usize, members.collect::<Vec<_>>()), (layout.size, layout.members), "{}", layout.name);
    }
}
