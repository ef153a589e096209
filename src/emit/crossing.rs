//! A crossing of the equatorial plane, as emitters see it, and the light that they add there. Plain data.

/// The place and time at which the light of a crossing left, or the change of both from pixel to pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmissionPoint {
    pub ln_r: f64,
    /// Azimuth in the chart.
    pub azimuth: f64,
    /// M (`Constants::retardation`); 0 where light is not delayed.
    pub delay: f64,
}

/// A crossing of the equatorial plane where emitters shine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// 1/r.
    pub u: f64,
    /// Number of the crossing of the plane, from 0.
    pub order: u32,
    /// g of matter on the circular geodesic there, the camera's motion included.
    pub g: f64,
    /// The place and time; known where an emitter needs them (`Needs` of `emit`).
    pub place: EmissionPoint,
    /// Change of `place` to the next pixel right and down; ln_r 1e30 where it is not known.
    pub footprint: [EmissionPoint; 2],
    /// How much of the pixel, or of a sample's cell of it, the disk covers here, 0 .. 1.
    pub share: f64,
}

/// How the effects let frequency shifts show: the shift that colours, and the one that beams.
#[derive(Clone, Copy, Debug)]
pub struct Shift {
    pub colour: f64,
    pub beaming: f64,
}

/// The light that an emitter in the plane sends along a ray, and the share of the light behind that it hides.
#[derive(Clone, Copy, Debug)]
pub struct Emission {
    pub light: [f64; 3],
    pub opacity: f64,
}
