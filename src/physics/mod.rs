//! Light and matter around a black hole, in f64 and units G = c = M = 1: usable alone, tested alone.
//! Knows neither scenes nor tracers; the WGSL in `shaders/` mirrors it, function by function, under the same names.

pub mod blackbody;
pub mod cie1931;
