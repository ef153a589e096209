// SPDX-License-Identifier: MIT OR Apache-2.0
//! `physics` alone against the reference values in tests/golden that need no tracer of pictures: shadows, redshifts,
//! Kerr radii, Bardeen's curve, Luminet's isoradials and the Page-Thorne flux; to 1e-9 relative, flux to 1e-11. In
//! files of their own: the inside of spinning holes, and bodies. Files are found from the package's root, where cargo
//! runs tests.

mod bodies;
mod inside;
#[path = "../random/mod.rs"]
mod random;

use bhr::physics::disk_flux::{page_thorne, page_thorne_maximum};
use bhr::physics::geodesic::{Constants, State};
use bhr::physics::observer::{LocalFrame, Observer};
use bhr::physics::orbit::{circular_orbit, horizon_outer, isco, photon_orbit, redshift, zamo_omega};
use bhr::physics::shadow::{CRITICAL_IMPACT_PARAMETER, shadow};
use bhr::physics::trace::{Settings, trace};
use glam::DVec3;
use serde_json::Value;

fn golden(file: &str) -> Value {
    serde_json::from_str(&std::fs::read_to_string(format!("tests/golden/{file}")).unwrap()).unwrap()
}

fn list<'a>(value: &'a Value, key: &str) -> &'a [Value] {
    let list = value[key].as_array().unwrap();
    assert!(!list.is_empty(), "{key} is empty");
    list
}

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("{key} in {value}"))
}

fn vector(value: &Value) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|i| value[i].as_f64().unwrap()))
}

#[track_caller]
fn close(found: f64, expected: f64, tolerance: f64, what: &str) {
    let error = (found - expected).abs() / expected.abs().max(1.0);
    assert!(error <= tolerance, "{what}: {found}, not {expected}: {error:.2e}");
}

fn frame(r: f64) -> LocalFrame {
    LocalFrame::new(0.0, DVec3::new(r, 0.0, 0.0)).unwrap()
}

#[test]
fn shadows() {
    let file = golden("shadow.json");
    for case in list(&file, "static") {
        let r = number(case, "r");
        close(shadow(&Observer::at_rest(frame(r))).radius, number(case, "psi_shadow"), 1e-12, &format!("static {r}"));
    }
    for key in ["freefall", "freefall_inside_horizon"] {
        for case in list(&file, key) {
            let r = number(case, "r");
            let observer = Observer::free_fall(frame(r));
            close(shadow(&observer).radius, number(case, "psi_shadow"), 1e-12, &format!("{key} {r}"));
            if r > 2.0 {
                // The falling observer, stated as one that moves against the static frame.
                let boosted = Observer::moving(frame(r), DVec3::new(-number(case, "beta"), 0.0, 0.0));
                close(shadow(&boosted).radius, number(case, "psi_shadow"), 1e-9, &format!("{key} {r} boosted"));
            }
        }
    }
    for case in list(&file, "circular") {
        let r = number(case, "r");
        let observer = Observer::orbiting(frame(r)).unwrap();
        close(observer.beta.z, number(case, "beta"), 1e-14, "beta");
        let found = shadow(&observer);
        close(found.radius, number(case, "angular_radius"), 1e-12, &format!("circular {r}"));
        assert!((found.center - vector(&case["center"])).length() < 1e-12, "circular {r}: {}", found.center);
        for point in list(case, "boundary") {
            let (n, ratio) = observer.aberrate(vector(&point["n_moving"]));
            assert!((n - vector(&point["n_static"])).length() < 1e-12, "aberration at {r}: {n}");
            close(ratio, number(point, "nu_moving_over_nu_static"), 1e-12, "frequency ratio");
        }
    }
}

#[test]
fn redshifts_and_orbits() {
    let file = golden("redshift.json");
    for case in list(&file, "static_emitter") {
        let (emitter, observer) = (frame(number(case, "r_em")), frame(number(case, "r_obs")));
        close(emitter.lapse / observer.lapse, number(case, "g"), 1e-14, "g");
        close(emitter.lapse, number(case, "g_inf"), 1e-14, "g_inf");
    }
    for case in list(&file, "disk_face_on") {
        close(redshift(0.0, 1.0 / number(case, "r"), false, 1.0, 0.0, 1.0), number(case, "g_inf"), 1e-14, "face on");
    }
    for case in list(&file, "disk_edge_on") {
        let (u, b) = (1.0 / number(case, "r"), number(case, "b_tangent"));
        let g = |lambda| redshift(0.0, u, false, 1.0, lambda, 1.0);
        close(g(0.0), number(case, "g_transverse"), 1e-14, "transverse");
        close(g(b), number(case, "g_tangent_approaching"), 1e-13, "approaching");
        close(g(-b), number(case, "g_tangent_receding"), 1e-13, "receding");
        let retrograde = redshift(0.0, u, true, 1.0, b, 1.0);
        close(retrograde, number(case, "g_tangent_receding"), 1e-13, "retrograde");
    }
    for case in list(&file, "circular_observer") {
        let observer = Observer::orbiting(frame(number(case, "r"))).unwrap();
        close(observer.beta.z, number(case, "beta"), 1e-14, "beta");
        let (n, ratio) = observer.aberrate(vector(&case["n_moving"]));
        assert!((n - vector(&case["n_static"])).length() < 1e-13);
        close(ratio, number(case, "nu_moving_over_nu_static"), 1e-13, "ratio");
        let (c, _) = observer.frame.start(n).unwrap();
        close(ratio * c.nu_local / c.energy, number(case, "nu_moving_over_nu_infinity"), 1e-13, "against the sky");
    }
    for case in list(&file, "kerr_circular") {
        let (a, r) = (number(case, "a"), number(case, "r"));
        let orbit = circular_orbit(a, r).unwrap();
        close(orbit.angular_velocity, number(case, "Omega"), 1e-13, "Omega");
        close(orbit.ut, number(case, "ut"), 1e-9, "ut");
        close(zamo_omega(a, r, 1.0), number(case, "omega_zamo"), 1e-13, "omega");
        close(isco(a), number(case, "isco"), 1e-13, "isco");
        close(
            redshift(a, 1.0 / r, false, 1.0, 0.0, 1.0),
            number(case, "g_axis_observer_infinity"),
            1e-9,
            "g on the axis",
        );
        // E u^t - L Omega u^t = 1 for unit mass, and the ZAMO's speed from u^t: gamma = alpha u^t.
        let rest = orbit.ut * (orbit.energy - orbit.angular_velocity * orbit.angular_momentum);
        close(rest, 1.0, 1e-9, "normalisation");
        let zamo = LocalFrame::new(a, DVec3::new(r, 0.0, 0.0)).unwrap();
        close(1.0 / (1.0 - orbit.beta.powi(2)).sqrt(), zamo.lapse * orbit.ut, 1e-9, "speed");
    }
    let orbits = &file["orbits"];
    let last = circular_orbit(0.0, 6.0).unwrap();
    close(CRITICAL_IMPACT_PARAMETER, number(orbits, "b_c"), 1e-15, "b_c");
    close(isco(0.0), number(orbits, "isco_r"), 1e-15, "isco");
    for (found, key) in [
        (last.angular_velocity, "isco_Omega"),
        (last.energy, "isco_E"),
        (last.angular_momentum, "isco_L"),
        (1.0 - last.energy, "isco_efficiency"),
        (last.beta, "isco_beta"),
        (last.ut, "isco_ut"),
    ] {
        close(found, number(orbits, key), 1e-14, key);
    }
}

/// A point of the critical curve on the sky of an observer at infinity.
#[derive(Clone, Copy, Debug)]
struct CriticalPoint {
    /// Sky coordinates, M: alpha right, beta up (projected spin axis).
    alpha: f64,
    beta: f64,
}

/// lambda and eta of the spherical photon orbit of radius `r`, a != 0. (Bardeen 1973.)
fn spherical_photon_orbit(a: f64, r: f64) -> (f64, f64) {
    let lambda = -(r * r * (r - 3.0) + a * a * (r + 1.0)) / (a * (r - 1.0));
    let eta = r * r * r * (4.0 * a * a - r * (r - 3.0).powi(2)) / (a * (r - 1.0)).powi(2);
    (lambda, eta)
}

/// Upper half (beta >= 0) of Bardeen's curve at inclination `inclination` from the spin axis, `count` points; a != 0.
/// The lower half mirrors it. beta^2 = eta + a^2 cos^2 i - lambda^2 cot^2 i.
fn bardeen_curve(a: f64, inclination: f64, count: usize) -> Vec<CriticalPoint> {
    let (sin, cos) = inclination.sin_cos();
    let beta2 = |r: f64| {
        let (lambda, eta) = spherical_photon_orbit(a, r);
        eta + (a * cos).powi(2) - (lambda * cos / sin).powi(2)
    };
    // beta^2 > 0 between two radii, which lie about the polar photon orbit (lambda = 0).
    let polar = bisect(|r| spherical_photon_orbit(a, r).0 * a, horizon_outer(a) + 1e-9, 4.0);
    let low = bisect(beta2, photon_orbit(a.abs()) * (1.0 - 1e-12), polar);
    let high = bisect(beta2, photon_orbit(-a.abs()) * (1.0 + 1e-12), polar);
    (0..count)
        .map(|i| {
            let x = (std::f64::consts::PI * i as f64 / (count - 1).max(1) as f64).cos();
            let r_photon = 0.5 * (low + high) - 0.5 * (high - low) * x;
            let (lambda, _) = spherical_photon_orbit(a, r_photon);
            CriticalPoint { alpha: -lambda / sin, beta: beta2(r_photon).max(0.0).sqrt() }
        })
        .collect()
}

/// The zero of `f` between `x0` and `x1`, where it has opposite signs.
fn bisect(f: impl Fn(f64) -> f64, mut x0: f64, mut x1: f64) -> f64 {
    let sign = f(x1) > 0.0;
    for _ in 0..200 {
        let middle = 0.5 * (x0 + x1);
        if (f(middle) > 0.0) == sign { x1 = middle } else { x0 = middle }
    }
    0.5 * (x0 + x1)
}

#[test]
fn kerr_radii_and_bardeens_curve() {
    let file = golden("kerr_shadow.json");
    for case in list(&file, "cases") {
        let (a, inclination) = (number(case, "a"), number(case, "inclination"));
        let name = format!("a {a} i {inclination}");
        for (found, key) in [
            (horizon_outer(a), "horizon"),
            (isco(a), "isco_prograde"),
            (isco(-a), "isco_retrograde"),
            (photon_orbit(a), "photon_prograde"),
            (photon_orbit(-a), "photon_retrograde"),
        ] {
            close(found, number(case, key), 1e-12, &format!("{name} {key}"));
        }
        for point in list(case, "boundary") {
            let (lambda, eta) = spherical_photon_orbit(a, number(point, "r_ph"));
            close(lambda, number(point, "lam"), 1e-9, &name);
            close(eta, number(point, "eta"), 1e-9, &name);
        }
        let curve = bardeen_curve(a, inclination, 33);
        let alphas = curve.iter().map(|p| p.alpha);
        close(alphas.clone().fold(f64::INFINITY, f64::min), number(case, "alpha_left"), 1e-9, &name);
        close(alphas.fold(f64::NEG_INFINITY, f64::max), number(case, "alpha_right"), 1e-9, &name);
        assert!(curve.iter().all(|p| p.beta >= 0.0 && p.beta < 5.5));
    }
}

/// The backward ray from infinity at plate coordinates (b, chi): u = 0, u' = E = 1, N' along the displacement.
fn ray_from_infinity(inclination: f64, b: f64, chi: f64) -> (Constants, State) {
    let (sin, cos) = inclination.sin_cos();
    let (polar, w) = (b * chi.sin(), -b * chi.cos());
    let c = Constants::new(0.0, 1.0, sin * w, polar * polar + (cos * w).powi(2), 1.0, 0.0);
    let e_theta = DVec3::new(cos, 0.0, -sin);
    let state = State {
        u: 0.0,
        du: 1.0,
        n: DVec3::new(sin, 0.0, cos),
        dn: -(e_theta * polar + DVec3::Y * w),
        drag: 0.0,
        delay: 0.0,
    };
    (c, state)
}

#[test]
fn luminets_isoradials() {
    let file = golden("luminet.json");
    let settings = Settings { delay: false, ..Settings::exact(0.0) };
    for curve in list(&file, "isoradials") {
        let (r, inclination, order) =
            (number(curve, "r"), number(curve, "inclination"), number(curve, "order") as usize);
        for point in list(curve, "points") {
            let name = format!("r {r} i {inclination} order {order} chi {}", point["chi"]);
            let (c, start) = ray_from_infinity(inclination, number(point, "b"), number(point, "chi"));
            let traced = trace(&c, &start, &settings);
            let crossing =
                traced.crossings.get(order).unwrap_or_else(|| panic!("{name}: {} crossings", traced.crossings.len()));
            // b is rounded to a double: near the critical curve that alone moves r.
            let nudged = ray_from_infinity(inclination, number(point, "b") * (1.0 + 1e-9), number(point, "chi"));
            let nudged = trace(&nudged.0, &nudged.1, &settings).crossings.get(order).map_or(0.0, |x| x.u);
            let conditioning = (nudged / crossing.u - 1.0).abs() / 1e-9;
            let error = (1.0 / (crossing.u * r) - 1.0).abs() / (1.0 + conditioning);
            assert!(error < 1e-9, "{name}: r {} ({error:.1e})", 1.0 / crossing.u);
            // At the curve's own radius: that of the crossing is off by the conditioning.
            close(redshift(0.0, 1.0 / r, false, 1.0, c.angular_momentum, 1.0), number(point, "g"), 1e-12, &name);
            let phi = number(point, "phi_disk");
            let turn = (crossing.azimuth - phi).rem_euclid(std::f64::consts::TAU);
            assert!(turn.min(std::f64::consts::TAU - turn) < 1e-7, "{name}: azimuth {}, not {phi}", crossing.azimuth);
        }
    }
}

#[test]
fn page_thorne_flux() {
    let file = golden("luminet.json");
    for case in list(&file, "flux") {
        let (found, expected) = (page_thorne(0.0, number(case, "r")), number(case, "f"));
        assert!((found - expected).abs() <= 1e-11 * expected.max(1e-4), "r {}: {found}, not {expected}", case["r"]);
    }
    let (r, f) = page_thorne_maximum(0.0);
    close(r, number(&file["flux_max"], "r"), 1e-7, "r of the maximum");
    close(f * 1e4, number(&file["flux_max"], "f") * 1e4, 1e-12, "maximum");
}
