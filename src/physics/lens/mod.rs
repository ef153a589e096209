//! Lens tables: what becomes of a ray as a function of its look direction, for one eye.

pub mod critical;
pub mod kerr;
