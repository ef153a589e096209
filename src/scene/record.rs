// SPDX-License-Identifier: MIT OR Apache-2.0
//! The ray record of a pixel: the one interface between lensing and shading, on both tracers; its counterpart is
//! shaders/records/record.wgsl. However it was made, shading cannot tell. Plain data.

use super::refine::Edge;
use crate::emit::medium::Media;
use crate::emit::{Crossing, EmissionPoint};
use crate::physics::geodesic::Constants;
use crate::physics::trace::{CROSSINGS_KEPT, Fate};
use arrayvec::ArrayVec;
use glam::DVec3;

/// The end of a pixel's ray. Directions are in the chart.
#[derive(Clone, Debug)]
pub struct Record {
    pub fate: Fate,
    /// Sky direction; 0 unless escaped.
    pub direction: DVec3,
    /// Change of `direction` to the next pixel right and down; 1e30 where it is not known.
    pub footprint: [DVec3; 2],
    /// `RayTrace::turned`; NaN where it is not known, as of rays that were looked up.
    pub turned: f64,
    /// nu(camera) / nu(at infinity), as the energy has it whether the ray goes there or not. NaN where there is no ray,
    /// and in records that come from the GPU unless they escaped.
    pub sky_redshift: f64,
    /// E and L, scaled so that the local frame's observer measures 1. `sky_redshift` times `energy` is nu(camera) /
    /// nu(local frame).
    pub energy: f64,
    pub angular_momentum: f64,
    /// |p_theta| where the ray crosses the plane, which is sqrt(Q), M, of light that has frequency 1 at the camera. At
    /// a crossing `polar_momentum` u g is |cosine| of its angle to the plane's normal, as the matter there sees it:
    /// |p_theta| / r over the frequency that it measures. 0 where no emitter asks for it.
    pub polar_momentum: f64,
    /// Integration steps of the pixel's own ray; 0 where it was looked up.
    pub steps: u32,
    /// 1/r of the first crossing of the plane wherever it is, 0 without one; in the METRIC view only.
    pub plane_u: f64,
    /// Orders of crossings inside the disk's inner edge, within the horizon too, or kept outside its outer edge, a bit
    /// each.
    pub beside_disk: u16,
    /// The edge that runs through the pixel.
    pub edge: Edge,
    pub crossings: ArrayVec<Crossing, CROSSINGS_KEPT>,
    /// The matter before each crossing and behind the last; empty where no emitter has depth.
    pub media: Media,
}

impl Record {
    /// A captured ray of which nothing else is known.
    pub fn captured() -> Self {
        Self {
            fate: Fate::Captured,
            direction: DVec3::ZERO,
            footprint: [UNKNOWN_DIRECTION; 2],
            turned: f64::NAN,
            sky_redshift: f64::NAN,
            energy: 1.0,
            angular_momentum: 0.0,
            polar_momentum: 0.0,
            steps: 0,
            plane_u: 0.0,
            beside_disk: 0,
            edge: Edge::None,
            crossings: ArrayVec::new(),
            media: Media::new(),
        }
    }

    /// The orders of the crossings, a bit each.
    pub fn orders(&self) -> u32 {
        self.crossings.iter().fold(0, |bits, c| bits | 1 << (c.order & 31))
    }

    /// Makes it `captured`, in place.
    pub fn clear(&mut self) {
        self.crossings.clear();
        self.media.clear();
        self.fate = Fate::Captured;
        self.direction = DVec3::ZERO;
        self.footprint = [UNKNOWN_DIRECTION; 2];
        self.turned = f64::NAN;
        self.sky_redshift = f64::NAN;
        self.energy = 1.0;
        self.angular_momentum = 0.0;
        self.polar_momentum = 0.0;
        self.steps = 0;
        self.plane_u = 0.0;
        self.beside_disk = 0;
        self.edge = Edge::None;
    }
}

/// `Record::polar_momentum` of a ray. `frequency_ratio`: nu(camera) / nu(local frame). (Rays of which Carter's constant
/// is below 0 cross no plane.)
pub fn polar_momentum(c: &Constants, frequency_ratio: f64) -> f64 {
    c.carter.max(0.0).sqrt() / (c.nu_local * frequency_ratio)
}

/// A footprint that nothing is known of: only the mean sky can stand for it.
pub const UNKNOWN_DIRECTION: DVec3 = DVec3::splat(1e30);
/// A footprint of a crossing that nothing is known of.
pub const UNKNOWN_EMISSION_POINT: EmissionPoint = EmissionPoint { ln_r: 1e30, azimuth: 0.0, delay: 0.0 };
