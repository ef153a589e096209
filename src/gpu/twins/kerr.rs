// SPDX-License-Identifier: MIT OR Apache-2.0
//! Twins of the lens with spin: where a look direction lies in its tables, and what their nodes hold.

use super::geodesic::{RAYS, STATE, constants, push_state, spinning_ray, state};
use super::inputs::{Inputs, Outputs};
use super::run::Image;
use super::scenes::{self, FRAMES, Kind, view, views};
use super::{Group, ROUNDING, TRANSCENDENTAL, twin};
use crate::gpu::kernel::sizes::{KERR_COLUMNS, KERR_PER_OCTAVE};
use crate::physics::integrator::nystrom_step;
use crate::physics::lens::critical::{CRITICAL_NODES, radial_potential};
use crate::physics::lens::kerr::{Branch, Crossings, Grid, Resolution, delay_from, delay_to, divergent_delay};
use glam::DVec3;
use std::f64::consts::TAU;
use std::sync::OnceLock;

/// Looking up reads flags and nodes, of which there are none here.
const HEAD: &str = "
#import lens/kerr_record
var<private> frame: Frame;
var<private> pass_: Pass;
fn enter_lens() {
    enter_scene();
    lens = KerrLens(in4(1u), vec4<f32>(in3(5u), 0.0), vec4<f32>(in3(8u), 0.0), word(11u), word(12u), 0u, 1.0);
}
";

/// Places behind the lens.
const COLUMN: usize = 13;
const ROW: usize = 16;

/// The tables' coordinates for each scene with spin, as the GPU has them.
fn grids() -> &'static [Grid] {
    static GRIDS: OnceLock<Vec<Grid>> = OnceLock::new();
    GRIDS.get_or_init(|| {
        let resolution = Resolution { chi_nodes: KERR_COLUMNS as usize, nodes_per_octave: [KERR_PER_OCTAVE; 2] };
        let wanted = Crossings { orders: 0, plane_u: [1.0, 0.0], pattern: false };
        let spinning = views().iter().take(scenes::EACH as usize);
        spinning.map(|view| Grid::new(&view.lens.observer.frame, resolution, wanted).expect("a grid")).collect()
    })
}

fn grid(i: &Inputs) -> &'static Grid {
    &grids()[i.word(0) as usize]
}

fn rows(grid: &Grid) -> [u32; 2] {
    [Branch::Outer, Branch::Inner].map(|branch| grid.rows(branch) as u32)
}

fn push_lens(i: &mut Inputs) {
    let (grid, curve) = (grid(i), grid(i).curve());
    i.vector(curve.k);
    i.push(grid.epsilon());
    i.vector(curve.e1);
    i.vector(curve.e2);
    rows(grid).into_iter().for_each(|rows| {
        i.push_word(rows);
    });
}

/// A node of a lens.
fn push_node(i: &mut Inputs) {
    Kind::Spinning.push(i);
    push_lens(i);
    let grid = grid(i);
    let column = i.random.below(KERR_COLUMNS);
    let chi = grid.column_angles()[column as usize];
    i.push(chi.sin());
    i.push(chi.cos());
    i.push(grid.curve().at(chi).0);
    i.pick(rows(grid).into_iter().sum());
    i.pick(2);
    i.push_word(column);
}

fn direction(i: &Inputs, o: &mut Outputs) {
    let (grid, row) = (grid(i), i.word(ROW));
    let [outer, _] = rows(grid);
    let (branch, row) = if row >= outer { (Branch::Inner, row - outer) } else { (Branch::Outer, row) };
    let row = f64::from(row) + 0.5 * f64::from(i.word(ROW + 1));
    o.all(grid.direction(branch, i.word(ROW + 2) as usize, row).to_array(), 1.0);
}

/// A place of the frame of the first scene, whose curve is bound, that its tables hold.
fn push_pixel(i: &mut Inputs) {
    loop {
        i.clear();
        i.push_word(0);
        push_lens(i);
        let mapping = &view(i).lens.mapping;
        i.even(0.0, mapping.width);
        i.even(0.0, mapping.height);
        let (n, _) = seen(i);
        if let Some(place) = grid(i).locate(n)
            && place.t.abs() > 1e-2
        {
            let below = if place.branch == Branch::Inner { rows(grid(i))[0] } else { 0 };
            i.push_word(place.column as u32);
            i.push_word(place.row as u32 + below);
            return;
        }
    }
}

/// The look direction of that place in the local frame, and its changes to the next pixels.
fn seen(i: &Inputs) -> (DVec3, [DVec3; 2]) {
    let lens = &view(i).lens;
    let (look, changes) = lens.look_direction_and_changes(i.x(COLUMN), i.x(COLUMN + 1));
    let seen = lens.observer.aberrate(look);
    (seen.0, changes.map(|change| lens.observer.aberrate_change(seen, change)))
}

fn looked_up(i: &Inputs, o: &mut Outputs) {
    let (n, changes) = seen(i);
    let place = grid(i).locate(n).expect("a place in the tables");
    let below = if place.branch == Branch::Inner { rows(grid(i))[0] } else { 0 };
    let column = place.column as f64 - f64::from(i.word(COLUMN + 2)) + place.column_fraction;
    let row = (place.row as u32 + below) as f64 - f64::from(i.word(COLUMN + 3)) + place.row_fraction;
    o.near(column, 1.0);
    o.near(row, 1.0);
    let [across, up] = [place.column_gradient, place.row_gradient];
    let steps = changes.map(|change| [across.dot(change), up.dot(change)]);
    let size = changes.map(|change| change.length() * across.length().max(up.length()));
    steps.into_iter().zip(size).for_each(|(step, size)| o.all(step, size));
    o.near((0.5 * (place.t.abs().max(1.0) + 1.0 / place.t.abs().max(1.0))).min(1e3), 1.0);
}

fn images() -> Vec<Image> {
    let curve = grids()[0].curve();
    let node = |i: usize| curve.at(TAU * i as f64 / CRITICAL_NODES as f64);
    let nodes = (0..=CRITICAL_NODES).map(node).collect::<Vec<_>>();
    let table = nodes.windows(2).flat_map(|pair| pair.iter().flat_map(|(t, slope)| [*t as f32, *slope as f32]));
    let table = table.collect::<Vec<_>>();
    let nothing = |name, format, layers| Image {
        name,
        format,
        size: [1, 1, layers],
        levels: 1,
        solid: false,
        bytes: vec![0; 16],
    };
    let float = wgpu::TextureFormat::Rgba32Float;
    let mut flags = nothing("kerr_flags", wgpu::TextureFormat::R32Uint, 0);
    flags.bytes.truncate(4);
    vec![
        Image {
            name: "kerr_curve",
            format: float,
            size: [CRITICAL_NODES as u32, 1, 0],
            levels: 1,
            solid: false,
            bytes: bytemuck::cast_slice(&table).to_vec(),
        },
        nothing("kerr_sky", float, 0),
        nothing("kerr_crossings", float, 1),
        flags,
    ]
}

pub fn group() -> Group {
    let (kerr, record) = ("lens/kerr", "lens/kerr_record");
    let constants = [("SPINNING", 1.0), ("DELAY", 1.0)];
    let twins = vec![
        twin(
            kerr,
            "kerr_node_direction kerr_direction kerr_radial kerr_first_row",
            "enter_lens(); out3(kerr_node_direction(vec4<f32>(in3(13u), 0.0), word(16u), word(17u) == 1u));",
            push_node,
            direction,
            2e-6,
        ),
        twin(
            record,
            "critical_tangent",
            "out2(critical_tangent(in1(0u)));",
            |i| {
                i.even(0.0, CRITICAL_NODES as f64 - 1e-3);
            },
            |i, o| {
                let (t, slope) = grids()[0].curve().at(TAU * i.x(0) / CRITICAL_NODES as f64);
                o.put(t);
                o.near(slope, t);
            },
            // Slopes come from differences between nodes 0.012 apart.
            3e-5,
        ),
        twin(
            record,
            "look_up",
            "enter_lens(); pass_.origin = vec2<i32>(-1); pass_.offset = in2(13u);
             let record = look_up(vec2<u32>(0u));
             out1(f32(i32(lookup.cell.x) - i32(word(15u))) + lookup.shares.x);
             out1(f32(i32(lookup.cell.y) - i32(word(16u))) + lookup.shares.y);
             out2(lookup.dx); out2(lookup.dy); out1(min(lookup.beyond, 1e3));",
            push_pixel,
            looked_up,
            // Rows are 16 an octave of the distance from the curve, which is known to 1e-7 of 0.01 and more.
            1e-3,
        )
        .with(&constants),
    ];
    let head = [HEAD, FRAMES].concat();
    Group { name: "kerr", head, twins, images, tables: scenes::tables }
}

/// A ray, and where it is some steps later.
fn push_later(i: &mut Inputs) {
    loop {
        i.clear();
        spinning_ray(i);
        let (c, mut s) = (constants(i), state(i, STATE));
        let first = s;
        for _ in 0..1 + i.random.below(10) {
            let next = nystrom_step(&c, &s, 0.25 / c.scale, true);
            if next.u <= 1e-3 || next.u * c.r_plus > 0.8 {
                break;
            }
            s = next;
        }
        if s.u != first.u {
            push_state(i, &s);
            return;
        }
    }
}

pub fn nodes() -> Group {
    let file = "lens/kerr_nodes";
    let spinning = [("SPINNING", 1.0), ("DELAY", 1.0)];
    let twins = vec![
        twin(
            file,
            "delay_from delay_to beyond_energy",
            "let c = ray_constants(); out1(delay_from(c, ray_state(23u)) + delay_to(c, ray_state(13u)));",
            push_later,
            |i, o| {
                let (c, observer, there) = (constants(i), state(i, STATE), state(i, STATE + 10));
                o.near(
                    delay_from(&c, &there) + delay_to(&observer),
                    1.0 + c.k * (observer.u + there.u) + there.delay.abs(),
                );
            },
            TRANSCENDENTAL,
        )
        .with(&spinning),
        twin(
            "lens/kerr",
            "divergent_delay",
            "out1(divergent_delay(in1(0u), in1(1u)));",
            |i| {
                i.log(1e-3, 2.0);
                i.log(1e-5, 2.0);
            },
            |i, o| {
                let [u, observer] = [i.x(0), i.x(1)];
                o.near(divergent_delay(u, observer), 1.0 / u + 1.0 / observer + 40.0);
            },
            TRANSCENDENTAL,
        ),
        twin(
            file,
            "beyond_energy",
            "out1(beyond_energy(ray_constants(), in1(13u)));",
            spinning_ray,
            |i, o| {
                let (c, u) = (constants(i), i.x(STATE));
                o.near((radial_potential(&c, u) - c.energy * c.energy) / u, c.k * u);
            },
            ROUNDING,
        )
        .with(&spinning),
    ];
    Group {
        name: "kerr nodes",
        head: ["#import lens/kerr_nodes\n", RAYS].concat(),
        twins,
        images: Vec::new,
        tables: Vec::new,
    }
}
