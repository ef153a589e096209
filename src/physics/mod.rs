// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light and matter around a black hole, in f64 and units G = c = M = 1 (r_s = 2): usable alone, tested alone.
//! Knows neither scenes nor tracers; the WGSL in `shaders/` mirrors it, function by function, under the same names.
//!
//! Chart: x = r sin(th) cos(ph), y = r sin(th) sin(ph), z = r cos(th) with r, th, ph the Boyer-Lindquist coordinates
//! about the spin axis +z. `a` is signed: a < 0 turns the hole towards -ph. Prograde means towards +ph.

pub mod cie1931;
pub mod limb_darkening;
pub mod orbit;
pub mod bound;
pub mod blackbody;
pub mod disk_flux;
pub mod quadrature;
pub mod rain;
pub mod geodesic;
pub mod metric;
pub mod flow;
pub mod integrator;
pub mod observer;
pub mod rain_motion;
mod transport;
pub mod world_line;
pub mod plunge;
pub mod images;
pub mod shadow;
pub mod trace;
pub mod lens;
