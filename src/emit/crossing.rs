// SPDX-License-Identifier: MIT OR Apache-2.0
//! A crossing of the equatorial plane, as emitters see it, and the light that they add there. Plain data.

/// The place and time at which the light of a crossing left, or the change of both from pixel to pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmissionPoint {
    /// ln(r / M).
    pub ln_r: f64,
    /// Azimuth in the chart, rad.
    pub azimuth: f64,
    /// M (`Constants::retardation`); 0 where light is not delayed.
    pub delay: f64,
}

/// A crossing of the equatorial plane where emitters shine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// 1/r, 1/M; above 0.
    pub u: f64,
    /// Number of the crossing of the plane, from 0.
    pub order: u32,
    /// g of the matter there (`physics::plunge::Matter`), the camera's motion included.
    pub g: f64,
    /// The place and time; known where an emitter needs them (`Needs` of `emit`).
    pub place: EmissionPoint,
    /// Change of `place` to the next pixel right and down; ln_r 1e30 where it is not known.
    pub footprint: [EmissionPoint; 2],
    /// How much of the pixel, or of a sample's cell of it, the disk covers here, 0 .. 1.
    pub share: f64,
}

/// A change of ln r that is at least this great stands for one that is not known.
pub(crate) const UNKNOWN_STEP: f64 = 1e15;

impl Crossing {
    /// The crossing with place and footprint of the light that leaves about 1/r = `u`, within the pixel or the cell of
    /// a sample: as far along the steepest change of ln r as this takes, with the azimuth and delay that the way there
    /// has. `extent`: the share that this light has of the change of 1/r over the pixel or cell. Where a side of the
    /// footprint is not known, only ln r of the place is set.
    pub fn lit_about(&self, u: f64, extent: f64) -> Self {
        let [dx, dy] = self.footprint;
        let ln_r = -u.ln();
        let steepness = dx.ln_r * dx.ln_r + dy.ln_r * dy.ln_r;
        let known = steepness > 0.0 && dx.ln_r.abs().max(dy.ln_r.abs()) < UNKNOWN_STEP;
        if !known {
            return Self { place: EmissionPoint { ln_r, ..self.place }, ..*self };
        }
        // By steps of (dx.ln_r, dy.ln_r): the way to the place, and what the footprint loses along it.
        let per_step = 1.0 / steepness;
        let (way, less) = (per_step * (ln_r - self.place.ln_r), per_step * (extent - 1.0));
        let along = |x: f64, y: f64| dx.ln_r * x + dy.ln_r * y;
        let [azimuth, delay] = [along(dx.azimuth, dy.azimuth), along(dx.delay, dy.delay)];
        let shorter = |step: EmissionPoint| EmissionPoint {
            ln_r: extent * step.ln_r,
            azimuth: step.azimuth + less * azimuth * step.ln_r,
            delay: step.delay + less * delay * step.ln_r,
        };
        let place =
            EmissionPoint { ln_r, azimuth: self.place.azimuth + way * azimuth, delay: self.place.delay + way * delay };
        Self { place, footprint: [shorter(dx), shorter(dy)], ..*self }
    }
}

/// How the effects let frequency shifts show. Both numbers are the redshift factor g with all effects on, and above 0.
#[derive(Clone, Copy, Debug)]
pub struct Shift {
    /// The factor on the frequency of light, which changes its colour.
    pub colour: f64,
    /// The factor whose powers make light brighter or darker.
    pub beaming: f64,
}

/// The light that an emitter in the plane sends along a ray, and the share of the light behind that it hides.
#[derive(Clone, Copy, Debug)]
pub struct Emission {
    /// Linear Rec. 709, 0 and more, weakened already by the matter in front.
    pub light: [f64; 3],
    /// 0 .. 1.
    pub opacity: f64,
}
