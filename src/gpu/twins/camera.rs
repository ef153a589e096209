// SPDX-License-Identifier: MIT OR Apache-2.0
//! Twins of camera/projection and camera/observer: from a place of the frame to the start of its ray.

use super::inputs::{Inputs, Outputs};
use super::scenes::{self, FRAME, FRAMES, Kind, View, push_look, push_place, view};
use super::{Group, ROUNDING, SAME, twin};
use crate::physics::geodesic::{Clock, Constants, State};
use crate::physics::orbit::{horizon_outer, redshift};
use crate::physics::rain::{doran_turn, kerr_offset, offsets};
use crate::scene::Projection;
use crate::scene::observer::Lens;
use crate::scene::record::polar_momentum;

/// The uniform is rounded, and what f64 has at hand is computed anew from it.
pub const UNIFORM: f64 = 2e-6;

fn place_in_any_scene(i: &mut Inputs) {
    let kind = [Kind::Spinning, Kind::Static, Kind::Rain][i.random.below(3) as usize];
    let view = kind.push(i);
    push_place(i, view);
}

fn place_in(i: &mut Inputs, projection: Projection) {
    loop {
        let kind = [Kind::Spinning, Kind::Static, Kind::Rain][i.random.below(3) as usize];
        let view = kind.push(i);
        if view.lens.mapping.projection == projection {
            return push_place(i, view);
        }
        i.clear();
    }
}

fn point(i: &Inputs, o: &mut Outputs) {
    let (mapping, x, y) = (view(i).lens.mapping, i.x(1), i.x(2));
    // Directions in radians: a pixel's changes come at a pixel's size.
    o.all(mapping.point(x, y).to_array(), 1.0);
    mapping.changes(x, y).into_iter().for_each(|change| o.all(change.to_array(), mapping.pixel_angle));
}

fn moving_look(i: &mut Inputs) {
    let kind = [Kind::Spinning, Kind::Static][i.random.below(2) as usize];
    kind.push(i);
    i.direction();
    let d = i.random.direction();
    i.vector(d * 0.01);
}

/// |u'| of light in the plane at 1/r = `u`; `None` where it does not come: u'^2 = W^2 - D B u^2 of
/// `physics::plunge`.
fn radial(c: &Constants, u: f64) -> Option<f64> {
    let w = c.energy - c.a * (c.angular_momentum - c.a * c.energy) * u * u;
    let square = w * w - c.horizon_function(u) * c.b * u * u;
    (square > 0.0).then(|| square.sqrt())
}

fn look(kind: Kind) -> fn(&mut Inputs) {
    match kind {
        Kind::Spinning => |i| {
            let view = Kind::Spinning.push(i);
            push_look(i, view);
        },
        Kind::Static => |i| {
            let view = Kind::Static.push(i);
            push_look(i, view);
        },
        Kind::Rain => |i| {
            let view = Kind::Rain.push(i);
            push_look(i, view);
        },
        Kind::SpinningRain => |i| {
            let view = Kind::SpinningRain.push(i);
            push_look(i, view);
        },
    }
}

/// A ray's constants and start, both at nu_local = 1: WGSL has most rays so, f64 those of E = 1.
fn begun(i: &Inputs, o: &mut Outputs) {
    let Some((c, s)) = view(i).lens.observer.frame.start(i.v3(1).normalize()) else { unreachable!("E > 0") };
    put_begun(&c, &s, o);
}

fn put_begun(c: &Constants, s: &State, o: &mut Outputs) {
    let (nu, square) = (c.nu_local, c.nu_local * c.nu_local);
    let momentum = c.scale / nu;
    o.near(c.energy / nu, 1.0);
    o.near(c.angular_momentum / nu, momentum);
    [c.k, c.b, c.a2e2, c.a * c.a * c.carter].into_iter().for_each(|v| o.near(v / square, momentum * momentum));
    o.near(momentum, 0.0);
    o.all([c.r_plus, c.r_minus, c.a], 0.0);
    // The root of a difference: its square is as exact as what it is the difference of.
    o.near(polar_momentum(c, 2.0).powi(2), 0.25 * momentum * momentum);
    o.near(s.u, 0.0);
    o.near(s.du / nu, 1.0);
    o.all(s.n.to_array(), 1.0);
    o.all((s.dn / nu).to_array(), momentum);
    // The shaders' drag leads to Kerr's azimuth, f64's from the observer's.
    let is_doran = c.clock == Clock::Rain;
    o.near(s.drag - if is_doran { doran_turn(c.a, s.u) } else { 0.0 }, 1.0);
    o.word(c.clock as u32);
}

pub fn group() -> Group {
    let [any, spinning, plain, rain] =
        [Kind::Rain, Kind::Spinning, Kind::Static, Kind::SpinningRain].map(Kind::constants);
    let (projection, observer) = ("camera/projection", "camera/observer");
    let points = [
        ("camera_point", (|i| place_in(i, Projection::Perspective)) as fn(&mut Inputs)),
        ("fisheye_point is_fisheye", |i| place_in(i, Projection::Fisheye)),
        ("equirect_point is_equirect", |i| place_in(i, Projection::Equirect)),
        ("cube_point is_cube cube_face turned_to_face", |i| place_in(i, Projection::Cube)),
    ];
    let mut twins = Vec::new();
    for (functions, inputs) in points {
        const POINT: &str =
            "enter_scene(); let p = camera_point(in1(1u), in1(2u)); out3(p.at); out3(p.dx); out3(p.dy);";
        // The bound is that of sincos.
        twins.push(twin(projection, functions, POINT, inputs, point, ROUNDING).with(&any));
    }
    twins.extend([
        twin(
            projection,
            "look_direction in_frame",
            "enter_scene(); out3(look_direction(in1(1u), in1(2u)));",
            place_in_any_scene,
            |i, o| o.v3(view(i).lens.look_direction(i.x(1), i.x(2))),
            UNIFORM,
        )
        .with(&any),
        twin(
            projection,
            "camera_view is_perspective",
            "enter_scene(); let v = camera_view(in1(1u), in1(2u)); out3(v.look);
             out3(v.dx - v.look * dot(v.look, v.dx)); out3(v.dy - v.look * dot(v.look, v.dy));",
            place_in_any_scene,
            |i, o| {
                let (look, changes) = view(i).lens.look_direction_and_changes(i.x(1), i.x(2));
                o.v3(look);
                changes.into_iter().for_each(|change| o.all(change.to_array(), view(i).lens.mapping.pixel_angle));
            },
            UNIFORM,
        )
        .with(&any),
        twin(
            projection,
            "has_look_direction",
            "enter_scene(); out_flag(has_look_direction(in2(1u)));",
            place_in_any_scene,
            |i, o| o.flag(view(i).lens.mapping.has_look_direction(i.x(1), i.x(2))),
            SAME,
        )
        .with(&any),
        twin(
            projection,
            "same_face",
            "enter_scene(); out_flag(same_face(in1(1u), in1(3u)));",
            |i| {
                place_in_any_scene(i);
                let width = view(i).lens.mapping.width;
                i.even(0.0, width);
            },
            |i, o| o.flag(view(i).lens.mapping.same_face(i.x(1), i.x(3))),
            SAME,
        )
        .with(&any),
        twin(
            observer,
            "aberrate one_less_beta",
            "enter_scene(); let seen = aberrate(in3(1u)); out3(seen.n); out1(seen.frequency_ratio);",
            moving_look,
            |i, o| {
                let (n, ratio) = view(i).lens.observer.aberrate(i.v3(1));
                o.v3(n);
                o.put(ratio);
            },
            UNIFORM,
        )
        .with(&plain),
        twin(
            observer,
            "aberrate_change",
            "enter_scene(); let seen = aberrate(in3(1u)); let d = aberrate_change(seen, in3(4u));
             out3(d - seen.n * dot(seen.n, d));",
            moving_look,
            |i, o| {
                let (observer, look) = (view(i).lens.observer, i.v3(1));
                let dn = i.v3(4) - look * look.dot(i.v3(4));
                let seen = observer.aberrate(look);
                let change = observer.aberrate_change(seen, dn);
                o.all((change - seen.0 * seen.0.dot(change)).to_array(), 0.01 * observer.gamma * seen.1);
            },
            UNIFORM,
        )
        .with(&plain),
        twin(
            observer,
            "closest_approach",
            "enter_scene(); out1(closest_approach(normalize(in3(1u))));",
            |i| {
                let view = Kind::Spinning.push(i);
                push_look(i, view);
            },
            |i, o| {
                let lens = &view(i).lens;
                o.near(lens.closest_approach_towards(i.v3(1).normalize()), lens.place.r);
            },
            UNIFORM,
        )
        .with(&spinning),
        twin(
            observer,
            "begin_ray",
            "enter_scene(); let b = begin_ray(in3(1u)); out1(b.frequency_ratio); out1(b.c.energy / b.c.nu_local);",
            moving_look,
            |i, o| {
                let Lens { observer, .. } = &view(i).lens;
                let (n, ratio) = observer.aberrate(i.v3(1));
                let (c, _) = observer.frame.start(n).expect("a ray");
                o.put(ratio);
                o.near(c.energy / c.nu_local, 1.0);
            },
            UNIFORM,
        )
        .with(&spinning),
    ]);
    const BEGIN: &str = "
        enter_scene();
        let b = begin_local(normalize(in3(1u)));
        let nu = b.c.nu_local;
        out2(vec2<f32>(b.c.energy, b.c.angular_momentum) / nu);
        out4(vec4<f32>(b.c.k, b.c.b, b.c.a2e2, b.c.a2q) / (nu * nu));
        out1(b.c.scale / nu); out3(vec3<f32>(b.c.r_plus, b.c.r_minus, b.c.a));
        let p = polar_momentum(b, 2.0); out1(p * p);
        out1(b.state.u); out1(b.state.du / nu); out3(b.state.n); out3(b.state.dn / nu);
        out1(b.state.drag); out_word(b.c.clock);";
    let begins = [
        ("begin_local begin_zamo constants polar_momentum", Kind::Spinning, spinning),
        ("begin_local begin_zamo constants polar_momentum", Kind::Static, plain),
        ("begin_local begin_rain constants polar_momentum", Kind::Rain, any),
        ("begin_local begin_spinning_rain constants polar_momentum", Kind::SpinningRain, rain),
    ];
    for (functions, kind, constants) in begins {
        twins.push(twin(observer, functions, BEGIN, look(kind), begun, UNIFORM).with(&constants));
    }
    twins.push(
        twin(
            observer,
            "begin_spinning_rain",
            "enter_scene(); out_flag(begin_local(normalize(in3(1u))).has_light);",
            |i| {
                Kind::SpinningRain.push(i);
                i.direction();
            },
            |i, o| o.flag(view(i).lens.observer.frame.start(i.v3(1).normalize()).is_some()),
            SAME,
        )
        .with(&rain),
    );
    twins.push(
        twin(
            "camera/chart",
            "chart_offsets kerr_offset rain_offsets doran_turn",
            "enter_scene(); let c = begin_local(normalize(in3(1u))).c; let u = in1(4u);
             let offsets = chart_offsets(c, u); out1(offsets.x);
             let dorans = rain_offsets(c, u); out2(dorans); out1(doran_turn(c, u));",
            |i| {
                let view = Kind::SpinningRain.push(i);
                push_look(i, view);
                // Nearer to the horizon u does not tell how near it is.
                i.even(1e-3, 0.99 / horizon_outer(view.scene.hole.spin));
            },
            |i, o| {
                let (a, u) = (view(i).scene.hole.spin, i.x(4));
                let expected = offsets(a, u);
                // Terms of the size of 1 / (r+ - r-) cancel.
                let size = 2.0 / ((1.0 - a) * (1.0 + a)).sqrt();
                o.near(kerr_offset(a, u), size);
                o.near(expected.azimuth, size);
                o.near(expected.time, size + 3.0 / u.sqrt());
                o.near(doran_turn(a, u), 1.0);
            },
            // Terms of the series that f32 leaves out, and the uniform.
            UNIFORM,
        )
        .with(&rain),
    );
    twins.push(
        twin(
            observer,
            "redshift_of orbital_redshift redshift_beside",
            "enter_scene(); let c = begin_local(normalize(in3(1u))).c; out1(redshift_of(c, in1(4u)));
             out1(redshift_beside(c.energy / c.nu_local, c.angular_momentum / c.nu_local, 0.7, in1(5u), in2(6u)));",
            |i| {
                let view = Kind::Spinning.push(i);
                push_look(i, view);
                let [far, near] = view.scene.emitters().disk_u().expect("a disk");
                i.even(far, near.min(1.0 / view.scene.disk_isco()));
                i.even(far, near.min(1.0 / view.scene.disk_isco()));
                // Its crossing, where matter may plunge, and any g.
                i.even(far, 2.0 * near);
                i.even(0.1, 2.0);
            },
            |i, o| {
                let View { scene, lens, .. } = view(i);
                let (c, _) = lens.observer.frame.start(i.v3(1).normalize()).expect("a ray");
                let g = redshift(c.a, i.x(4), scene.retrograde(), c.energy, c.angular_momentum, c.nu_local);
                // E - Omega L cancels: g is as uncertain as it is large.
                let uncertain =
                    |g: f64, u: f64| g * (c.energy.abs() + u.powf(1.5) * c.angular_momentum.abs()) / c.nu_local;
                o.near(g, g * uncertain(g, i.x(4)));
                let ray = [c.energy / c.nu_local, c.angular_momentum / c.nu_local, 0.7];
                let g = scene.matter().redshift_beside(c.a, ray, i.x(5), [i.x(6), i.x(7)]);
                o.near(g, g * uncertain(g, i.x(5)));
            },
            UNIFORM,
        )
        .with(&spinning),
    );
    twins.push(
        twin(
            observer,
            "redshift_at plunging_frequency",
            "enter_scene(); let c = begin_local(normalize(in3(1u))).c;
             out1(redshift_at(c, in1(4u), in1(5u) * c.nu_local));",
            |i| {
                let view = Kind::Spinning.push(i);
                let Some(plunge) = view.scene.matter().plunge else {
                    push_look(i, view);
                    let [far, near] = view.scene.emitters().disk_u().expect("a disk");
                    i.even(far, near);
                    i.even(-1.0, 1.0);
                    return;
                };
                // Light that comes so far in, on its way in or out.
                loop {
                    i.truncate(1);
                    let n = push_look(i, view);
                    let (c, _) = view.lens.observer.frame.start(n).expect("a ray");
                    let [far, near] = view.scene.emitters().disk_u().expect("a disk");
                    let u = if i.random.below(4) == 0 { i.even(far, near) } else { i.even(1.0 / plunge.isco, near) };
                    if let Some(du) = radial(&c, u) {
                        let side = if i.random.below(2) == 0 { -1.0 } else { 1.0 };
                        i.push(side * du / c.nu_local);
                        return;
                    }
                }
            },
            |i, o| {
                let View { scene, lens, .. } = view(i);
                let (c, _) = lens.observer.frame.start(i.v3(1).normalize()).expect("a ray");
                let (u, matter) = (i.x(4), scene.matter());
                let g = matter.redshift(&c, u, i.x(5) * c.nu_local);
                // The terms of the frequency may cancel.
                let d = c.horizon_function(u);
                let size = (c.energy.abs() + u.powf(1.5) * c.angular_momentum.abs()) / c.nu_local + i.x(5).abs();
                o.near(g, g * g * size / d);
            },
            UNIFORM,
        )
        .with(&spinning),
    );
    let head = ["#import camera/projection\n#import camera/observer\n#import camera/chart\n", FRAME, FRAMES].concat();
    Group { name: "camera", head, twins, images: Vec::new, tables: scenes::tables }
}
