// SPDX-License-Identifier: MIT OR Apache-2.0
//! Twins of emit/flow, emit/shape, emit/glow, emit/medium and emit/volumes: matter with depth.

use super::geodesic::{RAYS, STATE, constants, push_constants, push_state, random_ray, state};
use super::inputs::{Inputs, Outputs};
use super::run::Table;
use super::scenes::{self, FRAME};
use super::{Group, ROUNDING, TRANSCENDENTAL, twin};
use crate::emit::Shift;
use crate::emit::bands::When;
use crate::emit::glow::Glow;
use crate::emit::matter::{Accuracy, SpotMatter, VolumeMatter};
use crate::emit::medium::{THICK, layer_gains, thin_gains};
use crate::emit::shape::{
    Cloud, Reach, Stretch, disk_density, gaussian, halo_density, jet_density, smooth_step, torus_density,
};
use crate::emit::volumes::{Seen, clip};
use crate::gpu::kernel::variant::{MotionCode, SHAPE_SPOT};
use crate::physics::blackbody::BlackbodyTable;
use crate::physics::flow::{Flow, Motion, Place, Velocity, ZamoLight, keplerian, outflow, with_angular_momentum};
use crate::physics::geodesic::State;
use crate::physics::integrator::Quintic;
use crate::physics::orbit::{horizon_outer, isco};
use crate::physics::quadrature::GAUSS_WEIGHTS;
use crate::scene::{FlowLaw, HotSpot, Shape, Volume};
use crate::sky::StarField;

const HOOKS: &str = "
@group(1) @binding(13) var<storage, read> light_tables: array<vec4<f32>>;
fn light_table(i: u32) -> vec4<f32> { return light_tables[i]; }
var<private> clouds: Clouds;
fn baked_factor(index: u32, place: vec3<f32>, level: f32) -> f32 { return 1.0; }
fn out_place(p: Place) { out4(vec4<f32>(p.sigma, p.delta, p.big_a, p.lapse)); out1(p.around); }
";

/// Where the place begins, behind a ray's constants and a state.
const PLACE: usize = 23;

fn tables() -> Vec<Table> {
    let light = StarField::catalogue().expect("an index").light_tables().collect::<Vec<_>>();
    let mut tables = scenes::tables();
    tables.push(Table { name: "light_tables", bytes: bytemuck::cast_slice(&light).to_vec() });
    tables
}

/// A ray with spin, a state of it, and a place: 1/r and cos th.
fn place(i: &mut Inputs) {
    let (c, s) = random_ray(i, true);
    push_constants(i, &c);
    push_state(i, &s);
    let r = i.random.log(1.2 * horizon_outer(c.a), 100.0);
    i.push(1.0 / r);
    i.even(-0.98, 0.98);
}

fn place_of(i: &Inputs) -> (f64, Place) {
    let a = i.x(0);
    (a, Place::new(a, i.x(PLACE), i.x(PLACE + 1)))
}

fn out_velocity(o: &mut Outputs, velocity: Velocity) {
    o.near(velocity.around, 1.0);
    o.near(velocity.radial, 1.0 + velocity.radial.abs());
}

/// The volume of a shape whose numbers are at inputs `k` to `k` + 7: inner, outer, radius, width, thickness, opening,
/// slope.
fn push_shape(i: &mut Inputs) {
    i.log(1.5, 8.0);
    i.log(10.0, 60.0);
    i.log(3.0, 20.0);
    i.log(0.5, 5.0);
    i.log(0.03, 1.0);
    i.even(0.1, 0.8);
    i.even(0.0, 2.0);
}

fn shape_at(i: &Inputs, k: usize, shape: Shape) -> Volume {
    Volume {
        shape,
        inner_radius: i.x(k),
        outer_radius: i.x(k + 1),
        radius: i.x(k + 2),
        width: i.x(k + 3),
        thickness: i.x(k + 4),
        opening: i.x(k + 5),
        slope: i.x(k + 6),
        ..Volume::default()
    }
}

/// WGSL with the place of `place`, and with the shape of `push_shape`.
macro_rules! at_place {
    ($call:literal) => {
        concat!("let c = ray_constants(); let p = place_at(c, in1(23u), in1(24u)); ", $call)
    };
}
macro_rules! with_shape {
    ($call:literal) => {
        concat!(
            "var m: Matter; m.inner = in1(0u); m.outer = in1(1u); m.radius = in1(2u); m.width = in1(3u);
             m.thickness = in1(4u); m.opening = in1(5u); m.slope = in1(6u); m.isco = 6.0; ",
            $call
        )
    };
}

/// r and cos th behind a shape.
fn shape_and_place(i: &mut Inputs) {
    push_shape(i);
    i.log(1.3, 80.0);
    i.even(-0.99, 0.99);
}

/// Densities smaller than this say nothing.
const FAINT: f64 = 1e-3;

fn flows() -> Vec<super::Twin> {
    let flow = "emit/flow";
    let velocity = 3e-6;
    vec![
        twin(
            flow,
            "place_at place_omega",
            at_place!("out_place(p); out1(place_omega(c.a, p));"),
            place,
            |i, o| {
                let (a, p) = place_of(i);
                o.all([p.sigma, p.delta, p.big_a, p.lapse, p.around], 0.0);
                o.put(p.omega(a));
            },
            ROUNDING * 4.0,
        ),
        twin(
            flow,
            "zamo_light",
            at_place!(
                "let s = ray_state(13u); let l = zamo_light(c, p, s.du, s.dn.z);
                 out4(vec4<f32>(l.frequency, l.radial, l.azimuthal, l.across2)); out1(l.polar);"
            ),
            |i| {
                place(i);
                // Where the ray itself is, as elsewhere its momentum may be no light's.
                let (c, s) = (constants(i), state(i, 13));
                i.truncate(PLACE);
                i.push(s.u.min(0.9 / c.r_plus));
                i.push(s.n.z / s.n.length());
            },
            |i, o| {
                let (_, p) = place_of(i);
                let light = ZamoLight::new(&constants(i), &p, i.x(14), state(i, 13).dn.z);
                let size = light.frequency.abs();
                o.all([light.frequency, light.radial, light.azimuthal], size);
                o.near(light.across2, size * size);
                // Beside the axis and where theta turns it is the root of a small difference.
                o.near(light.polar, size / p.sin2.sqrt());
            },
            1e-5,
        ),
        twin(
            flow,
            "measured_by",
            "out1(measured_by(ZamoLight(in1(0u), in1(1u), in1(2u), in1(7u), in1(3u)), vec3<f32>(in2(4u), in1(6u))));",
            |i| {
                let n = i.random.direction();
                let frequency = i.log(0.1, 10.0);
                i.push(frequency * n.x);
                i.push(frequency * n.y);
                i.push(frequency * frequency * (1.0 - n.x * n.x));
                i.even(-0.8, 0.8);
                i.even(-3.0, 3.0);
                i.even(-0.4, 0.4);
                i.push(frequency * n.z);
            },
            |i, o| {
                let [frequency, radial, azimuthal, across2, polar] = [i.x(0), i.x(1), i.x(2), i.x(3), i.x(7)];
                let light = ZamoLight { frequency, radial, azimuthal, polar, across2 };
                let velocity = Velocity { around: i.x(4), polar: i.x(6), radial: i.x(5) };
                o.near(light.measured_by(velocity), i.x(0));
            },
            1e-5,
        ),
        twin(
            flow,
            "keplerian",
            at_place!("out2(keplerian(c, c.a, p, in1(25u), in1(26u), in1(27u)));"),
            |i| {
                place(i);
                let inner = isco(i.x(0));
                i.push(inner);
                i.even(0.0, 1.0);
                i.even(0.0, 1.0);
            },
            |i, o| {
                let (a, p) = place_of(i);
                out_velocity(o, keplerian(a, &p, i.x(25), i.x(26), i.x(27)));
            },
            velocity,
        ),
        twin(
            flow,
            "with_angular_momentum",
            at_place!("out2(with_angular_momentum(c.a, p, in1(25u)));"),
            |i| {
                place(i);
                i.even(0.0, 1.0);
            },
            |i, o| {
                let (a, p) = place_of(i);
                out_velocity(o, with_angular_momentum(a, &p, i.x(25)));
            },
            velocity,
        ),
        twin(
            flow,
            "outflow",
            at_place!("out2(outflow(c, c.a, p, in1(25u), in1(26u)));"),
            |i| {
                place(i);
                i.even(0.0, 0.98);
                i.log(1e-25, 10.0);
            },
            |i, o| {
                let (a, p) = place_of(i);
                out_velocity(o, outflow(a, &p, i.x(25), i.x(26)));
            },
            1e-5,
        ),
        twin(
            flow,
            "angular_velocity",
            at_place!("out1(angular_velocity(c.a, p, in2(25u)));"),
            |i| {
                place(i);
                i.even(-0.9, 0.9);
                i.even(-1.0, 1.0);
            },
            |i, o| {
                let (a, p) = place_of(i);
                let found = Velocity { around: i.x(25), polar: 0.0, radial: i.x(26) }.angular_velocity(a, &p);
                o.near(found, p.lapse / p.around);
            },
            1e-5,
        ),
        twin(
            flow,
            "drift_rate",
            at_place!("out1(drift_rate(p, in2(25u)));"),
            |i| {
                place(i);
                i.even(-0.9, 0.9);
                i.even(-1.0, 1.0);
            },
            |i, o| {
                let (_, p) = place_of(i);
                let found = Velocity { around: i.x(25), polar: 0.0, radial: i.x(26) }.radial_velocity(&p) / p.r;
                o.near(found, p.lapse / p.around);
            },
            1e-5,
        ),
        twin(
            flow,
            "flow_velocity",
            at_place!(
                "var m: Matter; m.motion = word(25u); m.sense = in1(26u); m.isco = in1(27u);
                  m.law = in2(28u); out2(flow_velocity(c, p, m));"
            ),
            |i| {
                place(i);
                let motion = i.pick(4);
                let sense = if i.random.below(2) == 0 { 1.0 } else { -1.0 };
                i.push(sense);
                let inner = isco(sense * i.x(0));
                i.push(inner);
                i.even(0.0, if motion == MotionCode::Rigid as u32 { 0.1 } else { 0.95 });
                i.even(0.1, 1.0);
            },
            |i, o| {
                let (a, p) = place_of(i);
                let [x, y] = [i.x(28), i.x(29)];
                let motion = match i.word(25) {
                    0 => Motion::Keplerian { sub_keplerian: x, infall: y },
                    1 => Motion::AngularMomentum { l0: x },
                    2 => Motion::Rigid { angular_velocity: x },
                    _ => Motion::Outflow { speed: x, base: y },
                };
                let flow = Flow { isco: i.x(27), ..Flow::new(a, i.x(26) < 0.0, motion) };
                let velocity = flow.velocity(a, &p);
                o.near(velocity.around, 1.0 + velocity.around.abs());
                o.near(velocity.radial, 1.0 + velocity.radial.abs());
            },
            1e-5,
        ),
    ]
}

fn shapes() -> Vec<super::Twin> {
    let shape = "emit/shape";
    let density = |name: &'static str, call: &'static str, expected: fn(&Inputs, &mut Outputs)| {
        twin(shape, name, call, shape_and_place, expected, 2e-5)
    };
    vec![
        twin(
            shape,
            "gaussian",
            "out1(gaussian(in1(0u)));",
            |i| {
                i.even(-6.0, 6.0);
            },
            |i, o| o.near(gaussian(i.x(0)), FAINT),
            TRANSCENDENTAL,
        ),
        twin(
            shape,
            "smooth_step",
            "out1(smooth_step(in1(0u), in1(1u), in1(2u)));",
            |i| {
                i.even(0.0, 1.0);
                i.even(1.1, 2.0);
                i.even(-1.0, 3.0);
            },
            |i, o| o.near(smooth_step([i.x(0), i.x(1)], i.x(2)), 1.0),
            ROUNDING,
        ),
        density(
            "disk_density faded",
            "out1(disk_density(in1(7u), in1(8u), in1(0u), in1(1u), in1(6u), in1(4u)));",
            |i, o| o.near(disk_density(i.x(7), i.x(8), i.x(0), i.x(1), i.x(6), i.x(4)), FAINT),
        ),
        density("torus_density", "out1(torus_density(in1(7u), in1(8u), in1(2u), in1(3u), in1(4u)));", |i, o| {
            o.near(torus_density(i.x(7), i.x(8), i.x(2), i.x(3), i.x(4)), FAINT)
        }),
        density("halo_density", "out1(halo_density(in1(7u), in1(8u), in1(2u), in1(4u)));", |i, o| {
            o.near(halo_density(i.x(7), i.x(8), i.x(2), i.x(4)), FAINT)
        }),
        twin(
            shape,
            "jet_density jet_wall",
            with_shape!("out1(jet_density(in1(7u), in1(8u), m));"),
            shape_and_place,
            |i, o| o.near(jet_density(i.x(7), i.x(8), &Cloud::new(&shape_at(i, 0, Shape::Jet), 6.0)), FAINT),
            2e-5,
        ),
        twin(
            shape,
            "density_at",
            with_shape!("m.shape = word(9u); out1(density_at(in1(7u), in1(8u), 0.0, 0.0, m));"),
            |i| {
                shape_and_place(i);
                i.pick(4);
            },
            |i, o| {
                let shape = [Shape::Disk, Shape::Torus, Shape::Halo, Shape::Jet][i.word(9) as usize];
                // Beside the outer radius either is right.
                let beside = (i.x(7) / i.x(1) - 1.0).abs() < 1e-6;
                let density = Cloud::new(&shape_at(i, 0, shape), 6.0).density(i.x(7), i.x(8));
                o.near(density, if beside { 1e6 } else { FAINT });
            },
            2e-5,
        ),
        twin(
            shape,
            "spot_density",
            "var m: Matter; m.radius = in1(0u); m.size = in1(1u); m.azimuth = in1(2u); m.angular_velocity = in1(3u);
             out1(spot_density(in1(4u), in1(5u), in1(6u), in1(7u), m));",
            |i| {
                let radius = i.log(5.0, 30.0);
                i.log(0.1, radius / 4.0);
                i.even(-3.0, 3.0);
                i.even(-0.1, 0.1);
                let near = i.random.even(0.8, 1.2);
                i.push(radius * near);
                i.even(-0.1, 0.1);
                i.even(-3.0, 3.0);
                i.even(-20.0, 20.0);
            },
            |i, o| {
                let spot = HotSpot { radius: i.x(0), size: i.x(1), ..HotSpot::default() };
                let when = When::default();
                let spot = SpotMatter::new(&spot, 0.0, &when, None).expect("it is on a circle");
                let spot =
                    SpotMatter { radius: i.x(0), size: i.x(1), azimuth: i.x(2), angular_velocity: i.x(3), ..spot };
                o.near(spot.density(i.x(4), i.x(5), i.x(6), i.x(7)), FAINT);
            },
            1e-4,
        ),
        twin(
            shape,
            "cells_of",
            with_shape!(
                "m.shape = word(12u); m.motion = word(13u); m.size = in1(1u);
                 out1(cells_of(in2(7u), in2(9u), in1(11u), m));"
            ),
            |i| {
                push_shape(i);
                let u = i.log(0.01, 0.5);
                let ratio = i.random.even(0.85, 1.18);
                i.push(u * ratio);
                let cos = i.even(-0.9, 0.9);
                let change = i.random.even(-0.08, 0.08);
                i.push(cos + change);
                i.even(0.0, 0.3);
                i.pick(SHAPE_SPOT + 1);
                i.pick(2);
            },
            |i, o| {
                let stretch = Stretch { u: [i.x(7), i.x(8)], cos: [i.x(9), i.x(10)], swept: i.x(11) };
                if i.word(12) == SHAPE_SPOT {
                    let when = When::default();
                    let spot = SpotMatter::new(&HotSpot::default(), 0.0, &when, None).expect("it is on a circle");
                    o.near(SpotMatter { size: i.x(1), ..spot }.cells(&stretch), 1.0);
                    return;
                }
                let shape = [Shape::Disk, Shape::Torus, Shape::Halo, Shape::Jet][i.word(12) as usize];
                let flow = [FlowLaw::Keplerian, FlowLaw::AngularMomentum][i.word(13) as usize];
                // Numbers of other shapes may leave nothing outside the horizon, which this does not ask.
                let wide = Volume { flow, outer_radius: 1e4, inner_radius: 3.0, radius: 8.0, ..shape_at(i, 0, shape) };
                let matter = VolumeMatter::new(&wide, 0.0, &When::default(), Accuracy::PICTURE).expect("matter");
                let cloud = Cloud::new(&shape_at(i, 0, shape), 6.0);
                o.near(VolumeMatter { cloud, ..matter }.cells(&stretch), 1.0);
            },
            3e-5,
        ),
    ]
}

pub fn group() -> Group {
    let mut twins = flows();
    twins.extend(shapes());
    twins.extend([
        twin(
            "emit/glow",
            "glow_coefficients",
            "var m: Matter; m.power_law = word(0u); m.absorption = in1(1u); m.temperature = in1(2u);
             m.reference_radius = in1(3u); m.temperature_slope = in1(4u); m.log_reference = in1(5u);
             m.spectral_index = in1(6u); m.brightness = in1(7u); m.tint = in3(8u);
             let s = glow_coefficients(m, in1(11u), in1(12u), in1(13u), in1(14u), in1(15u), Shift(in1(16u), in1(17u)));
             out3(s.light); out2(vec2<f32>(s.intensity, s.absorption));",
            |i| {
                i.pick(2);
                i.log(0.01, 10.0);
                let temperature = i.log(2000.0, 50_000.0);
                i.log(2.0, 10.0);
                i.even(0.0, 1.5);
                i.push(BlackbodyTable::shared().ln_luminance(temperature));
                i.even(-1.0, 3.0);
                i.log(0.1, 10.0);
                i.evens(3, 0.0, 1.0);
                i.log(1e-3, 1.0);
                i.even(0.8, 1.3);
                i.log(2.0, 10.0);
                i.log(0.5, 2.0);
                i.log(0.4, 2.0);
                i.log(0.4, 2.0);
                i.log(0.4, 2.0);
            },
            |i, o| {
                let glow = Glow {
                    power_law: i.word(0) != 0,
                    absorption: i.x(1),
                    temperature: i.x(2),
                    reference_radius: i.x(3),
                    temperature_slope: i.x(4),
                    log_reference: i.x(5),
                    spectral_index: i.x(6),
                    brightness: i.x(7),
                    tint: i.v3(8).to_array(),
                };
                let shift = Shift { colour: i.x(16), beaming: i.x(17) };
                let sample = glow.coefficients(i.x(11), i.x(12), i.x(13), i.x(14), i.x(15), shift);
                let peak = sample.light.into_iter().fold(0.0, f64::max);
                o.all(sample.light, peak);
                o.put(sample.intensity);
                o.put(sample.absorption);
            },
            // The table's Y goes as e^(14000 K / T).
            1e-4,
        ),
        twin(
            "emit/medium",
            "node_gains thin_gains layer_gains own_share",
            "out3(node_gains(in3(0u)));",
            |i| {
                let size = i.random.log(1e-6, 60.0);
                for _ in 0..3 {
                    let depth = size * i.random.even(0.3, 1.7);
                    i.push(depth);
                }
            },
            |i, o| {
                let depths = i.v3(0).to_array();
                let depth: f64 = (0..3).map(|k| GAUSS_WEIGHTS[k] * depths[k]).sum();
                // Either is right beside the limit.
                let beside = (depth / THICK - 1.0).abs() < 1e-5;
                let gains = if depth < THICK { thin_gains(depths) } else { layer_gains(depths) };
                o.all(gains, if beside { 1e6 } else { 1.0 });
            },
            TRANSCENDENTAL,
        ),
        twin(
            "emit/volumes",
            "pixel_width",
            "let c = ray_constants(); let s = ray_state(13u);
             out1(pixel_width(c, s, in1(23u), in1(24u), in3(25u), in1(28u), in1(29u)));",
            |i| {
                let (c, s) = random_ray(i, true);
                push_constants(i, &c);
                push_state(i, &s);
                i.log(0.01, 0.5);
                i.signed(0.01, 1.0);
                i.direction();
                i.even(0.0, 9.0);
                i.log(1e-4, 1e-2);
            },
            |i, o| {
                let (c, observer) = (constants(i), state(i, STATE));
                let seen = Seen {
                    frequency_ratio: 1.0,
                    static_observer: None,
                    pixel_angle: i.x(29),
                    swept: i.x(28),
                    rays: 1,
                    moment: 0.0,
                };
                let there = State { u: i.x(23), du: i.x(24), n: i.v3(25), ..observer };
                let width = seen.footprint(&c, &observer, &there);
                // Rays that come straight from where they are bend by the difference of two angles.
                o.near(width, width + 1e-3 * i.x(29));
            },
            1e-3,
        ),
        twin(
            "emit/volumes",
            "clip clip_between",
            "var m: Matter; m.u_outer = in1(0u); m.u_inner = in1(1u); m.most_cosine = in1(2u);
             let s = clip(m, in2(3u), in2(5u)); out2(select(vec2<f32>(0.0), s, s.x < s.y));",
            |i| {
                let outer = i.log(0.01, 0.1);
                let ratio = i.random.log(1.5, 10.0);
                i.push(outer * ratio);
                i.even(0.05, 0.8);
                let u = i.log(0.005, 0.5);
                let change = i.random.even(0.8, 1.25);
                i.push(u * change);
                let cos = i.even(-0.9, 0.9);
                let change = i.random.even(-0.2, 0.2);
                i.push(cos + change);
            },
            |i, o| {
                let reach = Reach { u: [i.x(0), i.x(1)], cos: i.x(2) };
                let stretch = Stretch { u: [i.x(3), i.x(4)], cos: [i.x(5), i.x(6)], swept: 0.0 };
                o.all(clip(&reach, &stretch).unwrap_or([0.0; 2]), 1.0);
            },
            1e-5,
        ),
        twin(
            "emit/course",
            "cubic_at",
            "let q = quintic(in1(0u), in1(1u), in1(2u), in1(3u), in1(4u), in1(5u)); out1(quintic_at(q, in1(6u)));
             out1(quintic_slope(q, in1(6u))); out1(cubic_at(in4(0u), in1(6u)));",
            |i| {
                i.evens(6, -1.0, 1.0);
                i.even(0.0, 1.0);
            },
            |i, o| {
                let (value, slope) = Quintic::new(i.x(0), i.x(1), i.x(2), i.x(3), i.x(4), i.x(5), 1.0).at(i.x(6));
                o.near(value, 1.0);
                o.near(slope, 10.0);
                // Hermite's basis (Abramowitz & Stegun 1964, 25.2.71 has it for one variable).
                let x = i.x(6);
                let (a, b) = ((1.0 - x) * (1.0 - x), x * x);
                let low = i.x(0) * a * (1.0 + 2.0 * x) + i.x(1) * a * x;
                let cubic = low + i.x(2) * b * (3.0 - 2.0 * x) - i.x(3) * b * (1.0 - x);
                o.near(cubic, 1.0);
            },
            1e-5,
        ),
    ]);
    Group {
        name: "matter",
        head: [
            "#import emit/volumes\n",
            FRAME,
            RAYS,
            HOOKS,
            "fn on_crossing(c: Constants, crossing: PlaneCrossing) {}\n\
             fn on_part(c: Constants, observer: State, from_state: State, to_state: State, h: f32, begin: f32,
             end: f32) {}\n",
        ]
        .concat(),
        twins,
        images: Vec::new,
        tables,
    }
}
