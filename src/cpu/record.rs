//! The ray record of a pixel: the one interface between lensing and shading. `frame.wgsl` has the same fields.

use crate::physics::geodesic::Constants;
use crate::physics::orbit::redshift;
use crate::physics::trace::{CROSSINGS_KEPT, Fate, RayTrace, Settings, trace_look};
use crate::scene::Scene;
use crate::scene::observer::Lens;
use arrayvec::ArrayVec;
use glam::DVec3;

/// A crossing within the disk's radii.
#[derive(Clone, Copy, Debug)]
pub struct DiskCrossing {
    pub u: f64,
    /// Number of the crossing of the plane, from 0.
    pub order: u32,
    /// g, the camera's motion included.
    pub g: f64,
    /// Chart, (-pi, pi].
    pub azimuth: f64,
    /// M; 0 unless the scene needs it.
    pub delay: f64,
}

#[derive(Clone, Debug)]
pub struct Record {
    pub fate: Fate,
    /// Sky direction, chart; 0 unless escaped.
    pub direction: DVec3,
    /// nu(camera) / nu(at infinity); of an escaped ray.
    pub sky_redshift: f64,
    /// E and L, scaled so that the local frame's observer measures 1.
    pub energy: f64,
    pub angular_momentum: f64,
    pub steps: u32,
    /// 1/r of the first crossing of the plane wherever it is; 0 without one.
    pub plane: f64,
    pub crossings: ArrayVec<DiskCrossing, CROSSINGS_KEPT>,
}

/// What makes records of a frame.
pub struct Recorder<'a> {
    pub lens: &'a Lens,
    settings: Settings,
    disk_u: Option<[f64; 2]>,
    retrograde: bool,
}

impl<'a> Recorder<'a> {
    pub fn new(scene: &Scene, lens: &'a Lens) -> Self {
        Self { lens, settings: scene.pixel_settings(), disk_u: scene.disk_u(), retrograde: scene.retrograde() }
    }

    /// The record of position (x, y) of the full frame.
    pub fn record(&self, x: f64, y: f64) -> Record {
        let observer = &self.lens.observer;
        let (n, frequency_ratio) = observer.look(self.lens.look(x, y));
        let (constants, traced) = trace_look(&observer.frame, n, &self.settings);
        let mut record = Record {
            fate: traced.fate,
            direction: traced.direction,
            sky_redshift: f64::NAN,
            energy: 1.0,
            angular_momentum: 0.0,
            steps: traced.steps,
            plane: traced.crossings.first().map_or(0.0, |c| c.u),
            crossings: ArrayVec::new(),
        };
        if let Some(c) = constants {
            self.complete(&mut record, &c, &traced, frequency_ratio);
        }
        record
    }

    fn complete(&self, record: &mut Record, c: &Constants, traced: &RayTrace, frequency_ratio: f64) {
        record.energy = c.energy / c.nu_local;
        record.angular_momentum = c.angular_momentum / c.nu_local;
        if record.fate == Fate::Escaped {
            record.sky_redshift = frequency_ratio / record.energy;
        }
        let Some([outer, inner]) = self.disk_u else { return };
        let within = |u: f64| u >= outer && u <= inner;
        record.crossings.extend(traced.crossings.iter().filter(|x| within(x.u)).map(|x| DiskCrossing {
            u: x.u,
            order: x.order,
            g: frequency_ratio * redshift(c.a, x.u, self.retrograde, c.energy, c.angular_momentum, c.nu_local),
            azimuth: x.azimuth,
            delay: x.delay,
        }));
    }
}
