// SPDX-License-Identifier: MIT OR Apache-2.0
//! The Kerr lens table against tracing. Part of `kerr`, whose insides it looks at.

use super::grid::*;
use super::lookup::*;
use super::*;
use crate::physics::geodesic::RAIN_CLOCK_RADIUS;
use crate::physics::lens::critical::*;
use crate::physics::metric::chart;
use crate::physics::observer::LocalFrame;
use crate::physics::orbit::{horizon_inner, horizon_outer, isco, redshift};
use crate::physics::trace::{Fate, Settings, trace};
use crate::random::runs_all;
use glam::{DVec3, Vec4};
use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A pixel of a frame 4096 wide that shows 90 degrees, about: what errors of directions are measured in.
const PIXEL: f64 = 4.85e-4;

/// splitmix64 (Steele, Lea & Flood 2014), to [0, 1).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn sphere(&mut self) -> DVec3 {
        let z = 2.0 * self.next() - 1.0;
        let (sin, cos) = (TAU * self.next()).sin_cos();
        let rho = (1.0 - z * z).sqrt();
        DVec3::new(rho * cos, rho * sin, z)
    }
}

/// A table of which only the nodes are computed that are looked at.
struct LazyTable {
    grid: Grid,
    nodes: HashMap<(usize, usize, usize), Node>,
    rows: [Vec<Vec4>; 4],
}

impl LazyTable {
    fn new(frame: &LocalFrame, resolution: Resolution, wanted: Crossings) -> Option<Self> {
        Some(Self { grid: Grid::new(frame, resolution, wanted)?, nodes: HashMap::new(), rows: Default::default() })
    }

    fn look_up(&mut self, n: DVec3) -> (Option<GridPosition>, Option<KerrLookup<'_>>) {
        let Some(place) = self.grid.locate(n) else { return (None, None) };
        let (branch, columns) = (place.branch, self.grid.columns());
        for i in 0..6 {
            let column = (place.column + columns + i - 2) % columns;
            for row in place.row - 2..place.row + 4 {
                self.nodes.entry((branch as usize, column, row)).or_insert_with(|| self.grid.node(branch, column, row));
            }
        }
        let node = |i: usize, j: usize| self.nodes[&(branch as usize, i, j)].as_slice();
        let flags = self.grid.flags(branch, place.column, place.row, node);
        for (j, packed) in self.rows.iter_mut().enumerate() {
            let nodes = (0..4).map(|i| node((place.column + columns + i - 1) % columns, place.row + j - 1));
            *packed = nodes.flat_map(|node| self.grid.pack(node)).collect();
        }
        (Some(place), self.grid.look_up_at(place, flags, self.rows.each_ref().map(|row| row.as_slice())))
    }
}

/// The part of the sky that a test ray was aimed at.
#[derive(Clone, Copy, PartialEq)]
enum Aim {
    /// log-uniform distance from the curve.
    Curve,
    /// Uniform within three radii of the shadow.
    Shadow,
    /// Anywhere.
    Sky,
}

fn aim(curve: &CriticalCurve, random: &mut Random) -> (Aim, DVec3) {
    let pick = random.next();
    if pick < 0.2 {
        return (Aim::Sky, random.sphere());
    }
    let chi = TAU * random.next();
    let t = curve.at(chi).0;
    if pick < 0.5 {
        let tangent = t * (-14.0 * random.next()).exp2();
        let away = if random.next() < 0.5 { tangent.atan() } else { -tangent.atan() };
        return (Aim::Curve, curve.direction(2.0 * (t.atan() + away), chi));
    }
    let psi = (6.0 * t.atan()).min(PI) * random.next().sqrt();
    (Aim::Shadow, curve.direction(psi, chi))
}

#[derive(Default)]
struct Measured {
    rays: usize,
    core: usize,
    /// Aimed at within three radii of the shadow: all, and direct beyond the core.
    about: usize,
    about_direct: usize,
    wrong_fate: usize,
    wrong_crossings: usize,
    sky: Vec<f64>,
    radius: Vec<f64>,
    redshift: Vec<f64>,
    azimuth: Vec<f64>,
    delay: Vec<f64>,
    worst: String,
}

fn quantile(values: &mut [f64], q: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let last = values.len().saturating_sub(1);
    values.get((q * last as f64).round() as usize).copied().unwrap_or(0.0)
}

impl Measured {
    fn add(&mut self, other: Self) {
        self.rays += other.rays;
        self.core += other.core;
        self.about += other.about;
        self.about_direct += other.about_direct;
        self.wrong_fate += other.wrong_fate;
        self.wrong_crossings += other.wrong_crossings;
        self.sky.extend(other.sky);
        self.radius.extend(other.radius);
        self.redshift.extend(other.redshift);
        self.azimuth.extend(other.azimuth);
        self.delay.extend(other.delay);
        self.worst += &other.worst;
    }

    fn report(&mut self, title: &str) {
        let qs = [0.5, 0.99, 0.999, 0.9999, 1.0];
        let line = |v: &mut Vec<f64>| qs.map(|q| format!("{:.0e}", quantile(v, q))).join(" ");
        println!(
            "{title}: {} rays, core {:.4}, direct about the shadow {:.4}, fates {}, crossings {} of {}; \
             sky px {}; u {}; g {}; az {}; t {}",
            self.rays,
            self.core as f64 / self.rays as f64,
            self.about_direct as f64 / self.about as f64,
            self.wrong_fate,
            self.wrong_crossings,
            self.radius.len(),
            line(&mut self.sky),
            line(&mut self.radius),
            line(&mut self.redshift),
            line(&mut self.azimuth),
            line(&mut self.delay),
        );
    }
}

fn compare(lazy: &mut LazyTable, count: usize, random: &mut Random) -> Measured {
    let mut m = Measured::default();
    let frame = lazy.grid.frame;
    for _ in 0..count {
        let (kind, n) = aim(&lazy.grid.curve, random);
        let grid = lazy.grid.clone();
        let (place, lookup) = lazy.look_up(n);
        m.rays += 1;
        m.core += usize::from(place.is_none());
        let direct = !lookup.as_ref().is_some_and(KerrLookup::crossings_are_good);
        if kind == Aim::Shadow {
            m.about += 1;
            m.about_direct += usize::from(direct && place.is_some());
        }
        let Some(seen) = lookup.filter(|_| !direct) else { continue };
        compare_ray(&frame, &grid, n, &seen, &mut m);
    }
    m
}

fn compare_ray(frame: &LocalFrame, grid: &Grid, n: DVec3, seen: &KerrLookup, m: &mut Measured) {
    let place = &seen.place;
    let Some((c, start)) = frame.start(n) else {
        m.wrong_fate += usize::from(seen.sky().is_some());
        return;
    };
    let truth = trace(&c, &start, &Settings::exact(c.a));
    let title = || {
        format!(
            "  a {} r {} cos {} {:?} column {:.2} row {:.2}",
            c.a,
            frame.r,
            frame.cos,
            place.branch,
            place.column as f64 + place.column_fraction,
            place.row as f64 + place.row_fraction
        )
    };
    let found_crossings: Vec<_> = seen.crossings().collect();
    if seen.sky().is_some() != (truth.fate == Fate::Escaped) {
        m.wrong_fate += 1;
        m.worst += &format!("{} fate {:?}\n", title(), truth.fate);
        return;
    }
    let (t1, t2) = n.any_orthonormal_pair();
    let steps = [t1, t2].map(|t| place.step(t));
    if let Some(sky) = seen.sky() {
        let stretch = sky.change(&steps[0]).length().hypot(sky.change(&steps[1]).length()).max(1.0);
        let error = sky.direction.distance(truth.direction) / stretch / PIXEL;
        if error > 0.05 {
            m.worst += &format!("{} sky {error:.1e} stretch {stretch:.1e}\n", title());
        }
        m.sky.push(error);
    }
    let [far, near] = grid.wanted.plane_u;
    let p = grid.curve.at(grid.columns.chi[place.column]).0;
    let critical = 2.0 * p / (1.0 + p * p);
    for crossing in truth.crossings.iter().filter(|x| (x.order as usize) < grid.wanted.orders) {
        let found = found_crossings.iter().find(|x| x.order == crossing.order);
        let Some(found) = found else {
            // Beside the disk's edge either is right.
            if crossing.u > far * 1.001 && crossing.u < near * 0.999 {
                m.wrong_crossings += 1;
                m.worst += &format!("{} no crossing {} {}\n", title(), crossing.order, crossing.u);
            }
            continue;
        };
        let gradient = found.change(&steps[0]).u.hypot(found.change(&steps[1]).u);
        let found = found.image;
        let conditioning = 1.0 + critical * gradient / crossing.u;
        let error = (found.u / crossing.u - 1.0).abs() / conditioning;
        if error > 1e-4 {
            m.worst += &format!("{} u {error:.1e} order {} conditioning {conditioning:.1e}\n", title(), crossing.order);
        }
        m.radius.push(error);
        let g = |u| redshift(c.a, u, false, c.energy, c.angular_momentum, c.nu_local);
        let g_error = (g(found.u) / g(crossing.u) - 1.0).abs() / conditioning;
        if g_error.is_finite() {
            m.redshift.push(g_error);
        }
        if grid.wanted.pattern {
            let turn = crossing.u * crossing.u.sqrt();
            let azimuth = crate::physics::geodesic::wrap_angle(found.azimuth - crossing.azimuth).abs();
            m.azimuth.push(azimuth / conditioning);
            m.delay.push((found.delay - crossing.delay).abs() * turn / conditioning);
        }
    }
    for found in &found_crossings {
        let there = truth.crossings.iter().any(|x| x.order == found.order);
        if !there {
            m.wrong_crossings += 1;
            m.worst += &format!("{} invented crossing {} {}\n", title(), found.order, found.image.u);
        }
    }
}

const SPINS: [f64; 8] = [0.1, -0.5, 0.9, -0.9, 0.95, 0.998, -0.9999, 0.9999];

/// Observer number `i`: spins in turn, r log-uniform, theta over the sphere, every fifth in the plane or on the axis or
/// near.
fn observer(i: usize, random: &mut Random) -> LocalFrame {
    let a = SPINS[i % SPINS.len()];
    let r = 4.5 * (1000.0_f64 / 4.5).powf(random.next());
    let theta = match i % 10 {
        3 => FRAC_PI_2,
        5 => 0.0,
        7 => PI,
        9 => FRAC_PI_2 + 1e-3,
        _ => (2.0 * random.next() - 1.0_f64).acos(),
    };
    let mut place = chart(r, theta, TAU * random.next());
    if i % 10 == 3 {
        place.z = 0.0;
    }
    LocalFrame::new(a, place).unwrap()
}

fn wanted(a: f64, pattern: bool) -> Crossings {
    Crossings { orders: 4, plane_u: [1.0 / 30.0, 1.0 / isco(a)], pattern }
}

fn measure(observers: std::ops::Range<usize>, rays: usize, resolution: Option<Resolution>, pattern: bool) -> Measured {
    let mut all = Measured::default();
    for i in observers {
        let mut random = Random(1 + i as u64);
        let frame = observer(i, &mut random);
        let resolution = resolution.unwrap_or(Resolution::COARSE);
        let mut lazy = LazyTable::new(&frame, resolution, wanted(frame.a, pattern)).unwrap();
        all.add(compare(&mut lazy, rays, &mut random));
    }
    all
}

/// The table against integration with steps five times finer, for random observers and rays.
#[test]
fn table_agrees_with_integration() {
    let mut m = measure(0..40, 250, None, true);
    m.report("coarse");
    println!("{}", m.worst);
    // A quarter of the observers are at spin 0.9999, where more rays come beside the horizon.
    assert!(m.about_direct * 25 < m.about, "{} of {} direct", m.about_direct, m.about);
    assert!(m.radius.len() > 4000 && m.sky.len() > 5000);
    assert_eq!((m.wrong_fate, m.wrong_crossings), (0, 0));
    assert!(quantile(&mut m.sky, 0.9999) < 0.01 && quantile(&mut m.sky, 1.0) < 0.1);
    assert!(quantile(&mut m.radius, 0.999) < 1e-5 && quantile(&mut m.redshift, 0.999) < 1e-5);
}

/// Tables of rain observers agree with integration, from the inner horizon to where scenes leave Doran's chart, half of
/// them beside the outer horizon. (Stretches below 1 count as 1, and inside most of the sky is drawn together.)
#[test]
fn rain_tables_agree_with_integration() {
    let mut m = Measured::default();
    let (count, [radii, skies]) = if runs_all() { (80, [4000, 6000]) } else { (24, [1000, 1400]) };
    for i in 0..count {
        let mut random = Random(100 + i as u64);
        let a = SPINS[i / 2 % SPINS.len()];
        let inner = horizon_inner(a) * (1.0 + 1e-6);
        let far = if i % 2 == 0 { RAIN_CLOCK_RADIUS } else { 1.1 * horizon_outer(a) };
        let r = inner + (far - inner) * random.next();
        let frame = LocalFrame::rain(a, chart(r, PI * random.next(), TAU * random.next())).unwrap();
        let mut lazy = LazyTable::new(&frame, Resolution::COARSE, wanted(a, true)).unwrap();
        let mut here = compare(&mut lazy, 250, &mut random);
        here.report(&format!("a {a} r {r:.3} (r- {inner:.3}) cos {:.2}", frame.cos));
        m.add(here);
    }
    m.report("rain");
    println!("{}", m.worst);
    assert!(m.about_direct * 12 < m.about, "{} of {} direct", m.about_direct, m.about);
    assert!(m.radius.len() > radii && m.sky.len() > skies);
    assert_eq!((m.wrong_fate, m.wrong_crossings), (0, 0));
    assert!(quantile(&mut m.radius, 0.99) < 1e-5 && quantile(&mut m.redshift, 0.99) < 2e-5);
    assert!(quantile(&mut m.azimuth, 0.99) < 3e-5 && quantile(&mut m.delay, 0.99) < 3e-5);
    assert!(quantile(&mut m.sky, 0.99) < 0.03 && quantile(&mut m.sky, 1.0) < 0.1);
    assert!(quantile(&mut m.radius, 1.0) < 1e-4 && quantile(&mut m.redshift, 1.0) < 2e-4);
    assert!(quantile(&mut m.azimuth, 1.0) < 3e-4 && quantile(&mut m.delay, 1.0) < 5e-4);
}

/// Builds the table node by node, cell by cell, on this thread.
fn whole(frame: &LocalFrame, resolution: Resolution, wanted: Crossings) -> Option<KerrLens> {
    let grid = Grid::new(frame, resolution, wanted)?;
    let nodes = [Branch::Outer, Branch::Inner]
        .map(|branch| -> Vec<f64> { (0..grid.rows(branch)).flat_map(|row| grid.node_row(branch, row)).collect() });
    let flags = [Branch::Outer, Branch::Inner].map(|branch| -> Vec<u32> {
        grid.cell_rows(branch).flat_map(|row| grid.flag_row(branch, row, &nodes[branch as usize])).collect()
    });
    let packed = [Branch::Outer, Branch::Inner].map(|branch| -> Vec<Vec4> {
        (0..grid.rows(branch)).flat_map(|row| grid.packed_row(row, &nodes[branch as usize])).collect()
    });
    Some(KerrLens::assemble(grid, packed, flags))
}

/// A whole table, coarse so that it is quickly built, says what its cells say one by one.
#[test]
fn whole_table_is_its_nodes() {
    let frame = LocalFrame::new(0.9, chart(12.0, 1.2, 0.3)).unwrap();
    let resolution = Resolution { chi_nodes: 128, nodes_per_octave: [16; 2] };
    let lens = whole(&frame, resolution, wanted(0.9, true)).unwrap();
    let mut lazy = LazyTable::new(&frame, resolution, wanted(0.9, true)).unwrap();
    let mut random = Random(3);
    let (mut seen, mut crossings) = (0, 0);
    for _ in 0..2000 {
        let (_, n) = aim(lens.grid().curve(), &mut random);
        match (lens.look_up(n), lazy.look_up(n).1) {
            (None, None) => {}
            (Some(a), Some(b)) => {
                assert_eq!(a.sky().map(|s| s.direction), b.sky().map(|s| s.direction));
                assert_eq!(a.crossings_are_good(), b.crossings_are_good());
                let images = |seen: &KerrLookup| seen.crossings().map(|x| (x.order, x.image.u)).collect::<Vec<_>>();
                assert_eq!(images(&a), images(&b));
                seen += 1;
                crossings += images(&a).len();
            }
            (a, b) => panic!("{a:?} {b:?}"),
        }
    }
    assert!(seen > 100 && crossings > 0, "{seen} {crossings}");
}

/// The gradients against differences of what the table says.
#[test]
fn gradients_are_derivatives() {
    let frame = LocalFrame::new(0.95, chart(14.0, 1.3, 0.3)).unwrap();
    let mut lazy = LazyTable::new(&frame, Resolution::COARSE, wanted(0.95, false)).unwrap();
    let mut random = Random(8);
    let (mut skies, mut radii) = (0, 0);
    for _ in 0..300 {
        let (kind, n) = aim(&lazy.grid.curve, &mut random);
        if kind != Aim::Shadow {
            continue;
        }
        let dn = n.any_orthonormal_vector();
        let mut at = |d: f64| {
            let seen = lazy.look_up((n + dn * d).normalize()).1.filter(KerrLookup::crossings_are_good)?;
            let cell = (seen.place.branch, seen.place.column, seen.place.row);
            Some((cell, seen.place.step(dn), seen.sky(), seen.crossings().collect::<Vec<_>>()))
        };
        let d = 2e-5;
        let (Some(here), Some(before), Some(after)) = (at(0.0), at(-d), at(d)) else { continue };
        let (cell, step, sky, crossings) = here;
        if cell != before.0 || cell != after.0 {
            continue;
        }
        if let (Some(sky), Some(s1), Some(s2)) = (sky, before.2, after.2) {
            let difference = (s2.direction - s1.direction) / (2.0 * d);
            let error = (sky.change(&step) - difference).length() / difference.length().max(1.0);
            assert!(error < 2e-2, "sky {error:.1e}");
            skies += 1;
        }
        for crossing in &crossings {
            let u = |all: &[Crossing]| all.iter().find(|x| x.order == crossing.order).map(|x| x.image.u);
            if let (Some(u1), Some(u2)) = (u(&before.3), u(&after.3)) {
                let difference = (u2 - u1) / (2.0 * d);
                let error = (crossing.change(&step).u - difference).abs() / difference.abs().max(0.1);
                assert!(error < 2e-2, "u {error:.1e}");
                radii += 1;
            }
        }
    }
    assert!(skies > 50 && radii > 50, "{skies} {radii}");
}
