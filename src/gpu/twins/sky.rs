// SPDX-License-Identifier: MIT OR Apache-2.0
//! Twins of sky: stars, maps, the grid.

use super::inputs::Inputs;
use super::run::{Image, Table};
use super::{Group, ROUNDING, SAME, twin};
use crate::gpu::frame::resources::sky_texture::{level_place, texture_height};
use crate::gpu::kernel::slots::SKY_MAP;
use crate::random::mix;
use crate::sky::filter;
use crate::sky::index::{STAR_LEVELS, cell_of, level_for, margin, side};
use crate::sky::{SkyMap, StarField, StoredMap, shifted_map_light, stars, under_grid};
use glam::DVec3;
use std::sync::{Arc, OnceLock};

const HEAD: &str = "
#import records/record
#import shared/frame
#import sky/stars
#import sky/map
#import sky/shift
#import sky/grid
@group(1) @binding(0) var<storage, read> light_tables: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read> star_cells: array<u32>;
@group(1) @binding(2) var map: texture_2d<f32>;
var<private> frame: Frame;
fn light_table(i: u32) -> vec4<f32> { return light_tables[i]; }
fn star_cell(i: u32) -> u32 { return star_cells[i]; }
fn to_sky(d: vec3<f32>) -> vec3<f32> { return d; }
fn sampled(map: texture_2d<f32>, place: vec2<f32>, level: f32) -> vec3<f32> { return vec3<f32>(0.0); }
fn least_patch() -> f32 { return 0.001; }
const MAP_SIZE = vec2<u32>(128u, 64u);
fn in_footprint() -> Footprint { return footprint_of(in3(0u), in3(3u), in3(6u)); }
";

const LEAST_PATCH: f64 = 0.001_f32 as f64;

/// A map of noise, as a scene has it.
pub fn stored_map() -> &'static Arc<StoredMap> {
    static MAP: OnceLock<Arc<StoredMap>> = OnceLock::new();
    MAP.get_or_init(|| {
        let texel = |x: u32, y: u32, c: u32| (mix(x + 1000 * y + 77_777_777 * c) >> 16) as f32 / 65536.0;
        let row = |y: u32, out: &mut [[f32; 3]]| {
            (0..).zip(out).for_each(|(x, out)| *out = [0, 1, 2].map(|c| texel(x, y, c)));
        };
        Arc::new(SkyMap::of_rows([128, 64], &row).expect("a map").into())
    })
}

/// The map of noise.
pub fn map() -> &'static SkyMap {
    stored_map().texels().expect("a map of texels")
}

/// A map as the GPU tracer lays its levels out.
pub fn map_image(name: &'static str, map: &SkyMap) -> Image {
    let finest = map.levels()[0].size;
    let [width, height] = [finest[0], texture_height(finest)];
    let mut texels = vec![0_u32; (width * height) as usize];
    for (level, number) in map.levels().iter().zip(0..) {
        let [left, top] = level_place(finest, number);
        for (row, y) in level.texels.chunks(level.size[0] as usize).zip(top..) {
            let first = (y * width + left) as usize;
            texels[first..first + row.len()].copy_from_slice(row);
        }
    }
    Image {
        name,
        format: SKY_MAP.format,
        size: [width, height, 0],
        levels: 1,
        solid: false,
        bytes: bytemuck::cast_slice(&texels).to_vec(),
    }
}

fn tables() -> Vec<Table> {
    let index = StarField::catalogue().expect("an index");
    let light = index.light_tables().collect::<Vec<_>>();
    let cells = index.cell_tables().collect::<Vec<_>>();
    vec![
        Table { name: "light_tables", bytes: bytemuck::cast_slice(&light).to_vec() },
        Table { name: "star_cells", bytes: bytemuck::cast_slice(&cells).to_vec() },
    ]
}

/// A direction, and its changes to the next pixels, across it.
fn push_pixel(i: &mut Inputs, d: DVec3, [low, high]: [f64; 2]) {
    let d = i.vector(d);
    let (p, q) = d.normalize().any_orthonormal_pair();
    let (sin, cos) = i.random.even(0.0, 6.3).sin_cos();
    let (long, squeeze, lean) = (i.random.log(low, high), i.random.log(0.05, 1.0), i.random.even(-0.5, 0.5));
    i.vector((p * cos + q * sin) * long);
    i.vector((q * cos - p * sin) * (long * squeeze) + (p * cos + q * sin) * (long * lean));
}

/// Across the direction, as f64 has footprints.
fn pixel(i: &Inputs) -> (DVec3, DVec3, DVec3) {
    let d = i.v3(0);
    let across = |v: DVec3| v - d * d.dot(v);
    (d, across(i.v3(3)), across(i.v3(6)))
}

fn any_pixel(i: &mut Inputs) {
    let d = i.random.direction();
    push_pixel(i, d, [1e-4, 8.0]);
}

/// A pixel beside a star.
fn starry_pixel(i: &mut Inputs) {
    let index = StarField::catalogue().expect("an index");
    let number = 2 * i.random.below(index.stars.len() as u32 / 2) as usize;
    let star = index.stars[number];
    let star = DVec3::new(star[0].into(), star[1].into(), star[2].into()).normalize();
    let scale = i.random.log(2e-4, 0.1);
    let d = (star + i.random.direction() * (scale * i.random.share())).normalize();
    push_pixel(i, d, [scale, scale * 1.01]);
    let g = i.random.log(0.5, 2.0);
    i.push(g);
    i.push(g);
}

fn level_and_radius(i: &mut Inputs) {
    i.pick(STAR_LEVELS);
    i.log(margin(0) * 0.3, margin(STAR_LEVELS - 1) * 3.0);
}

fn level_of(i: &Inputs) -> u32 {
    level_for(i.x(1)).unwrap_or(STAR_LEVELS)
}

pub fn group() -> Group {
    let (star, map_file, grid) = ("sky/stars", "sky/map", "sky/grid");
    let twins = vec![
        twin(
            star,
            "star_side star_margin",
            "out_word(star_side(word(0u))); out1(star_margin(word(0u)));",
            level_and_radius,
            |i, o| {
                o.word(side(i.word(0)));
                o.put(margin(i.word(0)));
            },
            ROUNDING,
        ),
        twin(
            star,
            "star_level_for",
            "out_word(star_level_for(in1(1u)));",
            level_and_radius,
            |i, o| o.word(level_of(i)),
            SAME,
        ),
        twin(
            star,
            "star_fade",
            "out1(star_fade(word(0u), in1(1u)));",
            level_and_radius,
            |i, o| o.near(stars::fade(i.word(0), i.x(1)), 1.0),
            ROUNDING,
        ),
        twin(
            star,
            "cell_of star_column",
            "out_word(cell_of(in3(0u), word(3u)));",
            |i| {
                i.direction();
                i.pick(STAR_LEVELS);
            },
            |i, o| o.word(cell_of(i.v3(0), i.word(3))),
            SAME,
        ),
        twin(
            star,
            "star_footprint",
            "out1(star_footprint(in2(0u)));",
            |i| {
                i.evens(2, -2.0, 2.0);
            },
            |i, o| o.near(stars::footprint(i.x(0), i.x(1)), 1.0),
            // The driver's cosine.
            3e-5,
        ),
        twin(
            star,
            "mean_sky_density",
            "out1(mean_sky_density(light_table(MEAN_SKY_OFFSET).w, in3(0u)));",
            |i| {
                i.direction();
            },
            |i, o| o.put(StarField::catalogue().expect("an index").mean_sky_density(i.v3(0))),
            ROUNDING,
        ),
        twin(
            star,
            "star_light",
            "out3(star_light(in3(0u), in_footprint(), in1(9u), in1(10u)));",
            starry_pixel,
            |i, o| {
                let (d, dx, dy) = pixel(i);
                let index = StarField::catalogue().expect("an index");
                o.all(index.star_light(d, [dx, dy], i.x(9), i.x(10), LEAST_PATCH), 1e-6);
            },
            // Places are known to 6e-8 rad: 1e-3 of the finest pixel here.
            3e-3,
        ),
        twin(
            map_file,
            "map_light map_patch row_of_taps map_place straight_step level_place map_bilinear",
            "out3(map_light(map, MAP_SIZE, in3(0u), map_patch(in_footprint())));",
            any_pixel,
            |i, o| {
                let (d, dx, dy) = pixel(i);
                o.all(map().light(d, dx, dy), 1.0);
            },
            // Texels differ by 1, and places are known to 6e-8 of 128 texels; taps move with the patch's axes.
            1e-4,
        ),
        twin(
            "sky/shift",
            "shifted_map_light shift_root",
            "out3(shifted_map_light(in3(0u), in1(3u), in1(4u)));",
            |i| {
                (0..3).for_each(|_| {
                    i.log(0.02, 5.0);
                });
                i.log(0.3, 3.0);
                i.log(0.3, 3.0);
            },
            |i, o| o.all(shifted_map_light(i.v3(0).to_array(), i.x(3), i.x(4)), 0.0),
            3e-5,
        ),
        twin(
            map_file,
            "level_of",
            "out1(level_of(in1(0u)));",
            |i| {
                i.log(0.3, 1e5);
            },
            |i, o| o.near(filter::level_of(i.x(0)), 1.0),
            ROUNDING,
        ),
        twin(
            grid,
            "under_grid under_lines grid_lines grid_rank",
            "out3(under_grid(in3(9u), in3(0u), in_footprint()));",
            |i| {
                any_pixel(i);
                i.evens(3, 0.0, 1.0);
            },
            |i, o| {
                let (d, dx, dy) = pixel(i);
                o.all(under_grid(i.v3(9).to_array(), d, dx, dy), 1.0);
            },
            // A line's distance is counted in pixels, 1e4 of which are an angle of 1.
            3e-3,
        ),
    ];
    let images = || vec![map_image("map", map())];
    Group { name: "sky", head: HEAD.into(), twins, images, tables }
}
