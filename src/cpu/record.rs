//! The ray record of a pixel: the one interface between lensing and shading. `frame.wgsl` has the same fields.

use crate::physics::geodesic::Constants;
use crate::physics::trace::{CROSSINGS_KEPT, Fate, RayTrace, Settings, trace_look};
use crate::scene::observer::Lens;
use crate::scene::{Disk, Scene};
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
    disk: Option<Disk>,
    isco: f64,
}

impl<'a> Recorder<'a> {
    pub fn new(scene: &Scene, lens: &'a Lens) -> Self {
        Self { lens, settings: scene.pixel_settings(), disk: scene.disk, isco: scene.disk_isco() }
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
        let Some(disk) = self.disk else { return };
        let inner = disk.inner_radius.max(self.isco);
        let within = |u: f64| u * inner <= 1.0 && u * disk.outer_radius >= 1.0;
        record.crossings.extend(traced.crossings.iter().filter(|x| within(x.u)).map(|x| DiskCrossing {
            u: x.u,
            order: x.order,
            g: frequency_ratio * x.redshift(c, disk.retrograde, self.isco),
        }));
    }
}
