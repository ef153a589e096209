//! The part of a frame that an image holds.

use crate::error::{Error, Result};

/// The image is this part of a larger frame of `full_width` x `full_height` pixels: its top-left pixel is (x, y).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    pub full_width: u32,
    pub full_height: u32,
    pub x: u32,
    pub y: u32,
}

impl Region {
    /// Largest frame side: f32 still tells pixels apart.
    pub const MAX_FRAME_SIDE: u32 = 1 << 20;

    /// Errors: a zero or too large frame, an origin outside it.
    pub fn check(&self) -> Result<()> {
        let max = Self::MAX_FRAME_SIDE;
        if self.full_width == 0 || self.full_height == 0 || self.full_width > max || self.full_height > max {
            return Err(Error::argument(format!(
                "region frame is {} x {}; each side must lie in [1, {max}]",
                self.full_width, self.full_height
            )));
        }
        if self.x >= self.full_width || self.y >= self.full_height {
            return Err(Error::argument(format!(
                "region begins at ({}, {}), outside its {} x {} frame",
                self.x, self.y, self.full_width, self.full_height
            )));
        }
        Ok(())
    }
}

impl Region {
    /// Errors: as `check`, or a `width` x `height` image at (x, y) that reaches outside the frame.
    pub fn check_image(&self, width: u32, height: u32) -> Result<()> {
        self.check()?;
        let overrun = |name: &str, begin: u32, size: u32, full: u32| {
            if u64::from(begin) + u64::from(size) <= u64::from(full) {
                return Ok(());
            }
            Err(Error::argument(format!("region {name} {begin} + image size {size} exceeds the frame's {full}")))
        };
        overrun("x", self.x, width, self.full_width)?;
        overrun("y", self.y, height, self.full_height)
    }
}

/// Where in its pixel sample `index` of `count` lies, 0 .. 1 each way: the centre for one sample, else even steps in x and
/// steps of the golden ratio, modulo 1, in y: evenly spread for any count, the same for every pixel and machine.
pub fn sample_offset(index: u32, count: u32) -> [f64; 2] {
    let (i, n) = (f64::from(index), f64::from(count));
    let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
    // The lattice's mean lies at the pixel's centre in x exactly, in y by the turn that centres it.
    let turn = 0.5 - golden * (n - 1.0) / 2.0;
    [(i + 0.5) / n, (i * golden + turn).rem_euclid(1.0)]
}
