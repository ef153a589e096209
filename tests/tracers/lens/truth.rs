// SPDX-License-Identifier: MIT OR Apache-2.0
//! The fate of a ray in truth: integrated in f64 with small steps, with how well that is conditioned, and whether
//! rounding alone may decide otherwise.

use bhr::physics::orbit::redshift;
use bhr::physics::shadow::CRITICAL_IMPACT_PARAMETER;
use bhr::physics::trace::{Fate, PlaneCrossing, Settings, trace_look};
use bhr::scene::observer::Lens;
use bhr::scene::record::Record;
use bhr::scene::{Region, Scene};
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Step of the true rays in sigma: errors of 1e-10, divided by (1 + conditioning).
const TRUE_STEP: f64 = 0.05;

/// The true image in a look direction.
#[derive(Clone)]
pub struct Sight {
    pub fate: Fate,
    pub direction: DVec3,
    pub sky_redshift: f64,
    /// |b / b_c - 1|; NaN with spin.
    pub from_critical: f64,
    /// Crossings of the plane at any radius, of the disk's orders only.
    pub crossings: Vec<(PlaneCrossing, f64)>,
}

/// A look direction, what it sees, and how well that is conditioned.
pub type TrueRay = (DVec3, Sight, Conditioning);

/// The true lens of a scene's camera.
pub struct Truth<'a> {
    pub scene: &'a Scene,
    pub lens: Lens,
    pub settings: Settings,
    disk_u: [f64; 2],
}

impl<'a> Truth<'a> {
    pub fn new(scene: &'a Scene, width: u32, height: u32) -> Self {
        let region = Region { full_width: width, full_height: height, x: 0, y: 0 };
        let settings = Settings {
            step: TRUE_STEP,
            max_crossings: scene.quality.max_disk_order as usize + 1,
            delay: scene.emitters().needs().delays,
            ..Settings::exact(scene.hole.spin)
        };
        Self { scene, lens: scene.lens(&region).unwrap(), settings, disk_u: scene.emitters().disk_u().unwrap() }
    }

    /// Through the centre of pixel `index`, counted row by row.
    pub fn look(&self, index: usize) -> DVec3 {
        let width = self.lens.mapping.width as usize;
        self.lens.look_direction((index % width) as f64 + 0.5, (index / width) as f64 + 0.5)
    }

    pub fn sight(&self, look: DVec3) -> Sight {
        let observer = &self.lens.observer;
        let (n, ratio) = observer.aberrate(look);
        let (constants, traced) = trace_look(&observer.frame, n, &self.settings);
        let Some(c) = constants else {
            return Sight {
                fate: Fate::Captured,
                direction: DVec3::ZERO,
                sky_redshift: f64::NAN,
                from_critical: f64::INFINITY,
                crossings: Vec::new(),
            };
        };
        let retrograde = self.scene.retrograde();
        let g = |u: f64| ratio * redshift(c.a, u, retrograde, c.energy, c.angular_momentum, c.nu_local);
        let spin_zero = c.a == 0.0;
        Sight {
            fate: traced.fate,
            direction: traced.direction,
            sky_redshift: if traced.fate == Fate::Escaped { ratio * c.nu_local / c.energy } else { f64::NAN },
            from_critical: if spin_zero {
                (c.k.max(0.0).sqrt() / (c.energy * CRITICAL_IMPACT_PARAMETER) - 1.0).abs()
            } else {
                f64::NAN
            },
            crossings: traced.crossings.iter().map(|x| (*x, g(x.u))).collect(),
        }
    }

    /// The true rays of all pixels.
    pub fn rays(&self) -> Vec<TrueRay> {
        let pixels = self.lens.mapping.width as usize * self.lens.mapping.height as usize;
        let ray = |i| {
            let look = self.look(i);
            let here = self.sight(look);
            let conditioning = self.conditioning(look, &here);
            (look, here, conditioning)
        };
        (0..pixels).into_par_iter().map(ray).collect()
    }

    pub fn within_disk(&self, u: f64) -> bool {
        u >= self.disk_u[0] && u <= self.disk_u[1]
    }

    /// Within a factor of two of the disk's radii.
    fn near_disk(&self, u: f64) -> bool {
        u >= 0.5 * self.disk_u[0] && u <= 2.0 * self.disk_u[1]
    }

    /// Whether a crossing lies so near to an edge of the disk that rounding decides on which side.
    pub fn at_an_edge(&self, u: f64, conditioning: f64) -> bool {
        self.disk_u.iter().any(|edge| (u / edge - 1.0).abs() < 1e-5 * (1.0 + conditioning))
    }

    /// Whether rays `angle` away have another fate than `fate`.
    fn near_another_fate(&self, look: DVec3, fate: Fate, angle: f64) -> bool {
        let (right, up) = around(look);
        (0..8).any(|i| {
            let (s, c) = (PI / 4.0 * f64::from(i)).sin_cos();
            self.sight((look + (right * c + up * s) * angle).normalize()).fate != fate
        })
    }

    /// How strongly what `here` sees changes with the look direction: differences over an angle so small that they are
    /// linear.
    fn conditioning(&self, look: DVec3, here: &Sight) -> Conditioning {
        let (right, up) = around(look);
        for h in [1e-6, 1e-7, 1e-8, 1e-9, 1e-10] {
            let beside = [right, up].map(|d| self.sight((look + d * h).normalize()));
            let found = Conditioning::new(here, &beside, h, |u| self.near_disk(u));
            if found.sky.max(found.ln_r.iter().copied().fold(0.0, f64::max)) * h < 0.02 {
                return found;
            }
        }
        Conditioning {
            sky: f64::INFINITY,
            sky_redshift: f64::INFINITY,
            ln_r: vec![f64::INFINITY; here.crossings.len()],
        }
    }
}

/// Two unit vectors orthogonal to a look direction and to each other.
pub fn around(look: DVec3) -> (DVec3, DVec3) {
    let right = look.any_orthonormal_vector();
    (right, look.cross(right))
}

/// |d . / d look|, per rad.
pub struct Conditioning {
    /// Stretch of the lens.
    pub sky: f64,
    /// Conditioning of the logarithm of the redshift.
    pub sky_redshift: f64,
    /// For each crossing; 0 far from the disk.
    pub ln_r: Vec<f64>,
}

impl Conditioning {
    fn new(here: &Sight, beside: &[Sight; 2], h: f64, matters: impl Fn(f64) -> bool) -> Self {
        let largest = |f: &dyn Fn(&Sight) -> f64| beside.iter().map(f).fold(0.0, f64::max) / h;
        let same = |there: &Sight| there.fate == here.fate;
        Self {
            sky: largest(&|s| if same(s) { (s.direction - here.direction).length() } else { f64::INFINITY }),
            sky_redshift: largest(&|s| (s.sky_redshift / here.sky_redshift).ln().abs()),
            ln_r: here
                .crossings
                .iter()
                .enumerate()
                .map(|(k, (x, _))| {
                    let change = |s: &Sight| s.crossings.get(k).map_or(f64::INFINITY, |(y, _)| (y.u / x.u).ln().abs());
                    if matters(x.u) { largest(&change) } else { 0.0 }
                })
                .collect(),
        }
    }
}

/// Records of one frame beside the truth, ray by ray.
pub struct Frame<'a> {
    pub truth: &'a Truth<'a>,
    pub scene_index: usize,
    /// Whether directions were rounded to f32.
    pub single: bool,
}

impl Frame<'_> {
    /// Whether rounding alone may decide what becomes of the ray: |b / b_c - 1| < 1e-6 (1e-5 where it is integrated at
    /// the step of pixels), or, in f32, a look direction less than three roundings from the edge; with spin 2e-6 of
    /// the look direction.
    pub fn at_critical(&self, look: DVec3, here: &Sight, record: &Record) -> bool {
        if here.from_critical < if record.steps > 0 { 1e-5 } else { 1e-6 } {
            return true;
        }
        let spin_zero = self.truth.scene.hole.spin == 0.0;
        let angle = if spin_zero { 2e-7 } else { 2e-6 };
        (self.single || !spin_zero) && self.truth.near_another_fate(look, here.fate, angle)
    }
}
