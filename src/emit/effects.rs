// SPDX-License-Identifier: MIT OR Apache-2.0
//! The parts of relativity that a host can switch off, and the shift of light that is left. Plain numbers.

use super::crossing::Shift;

/// The relativistic effects that colour the light: the bits of `BHR_EFFECT_*`. Unknown bits are ignored. The redshift g
/// = g_gravity g_doppler is split at the local static observer (ZAMO) of emitter and camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effects(pub u32);

/// All of them.
impl Default for Effects {
    fn default() -> Self {
        Self(Self::ALL)
    }
}

impl Effects {
    /// Frequency shift by motion colours the light.
    pub const DOPPLER_SHIFT: u32 = 1;
    /// Gravitational redshift colours the light.
    pub const GRAVITY_SHIFT: u32 = 2;
    /// Intensity follows g^3 (I_nu), g^4 (bolometric).
    pub const BEAMING: u32 = 4;
    /// Moving matter is seen at its retarded time.
    pub const LIGHT_DELAY: u32 = 8;
    pub const ALL: u32 = u32::MAX;

    /// The bits that change the colour or brightness of light, without unknown ones.
    pub fn light(self) -> u32 {
        self.0 & (Self::DOPPLER_SHIFT | Self::GRAVITY_SHIFT | Self::BEAMING)
    }

    /// Whether light is shown as it arrives, no effect left out.
    pub fn all_light(self) -> bool {
        self.light() == Self(Self::ALL).light()
    }

    pub fn has(self, bit: u32) -> bool {
        self.0 & bit != 0
    }

    /// The shift that shows. g = g_gravity g_doppler, split at the local static observers (ZAMOs); `gravity` gives the
    /// former.
    pub fn visible_shift(self, g: f64, gravity: impl Fn() -> f64) -> Shift {
        if self.all_light() {
            return Shift { colour: g, beaming: g };
        }
        let gravity = gravity();
        let mut colour = if self.has(Self::DOPPLER_SHIFT) { g } else { gravity };
        if !self.has(Self::GRAVITY_SHIFT) {
            colour /= gravity;
        }
        Shift { colour, beaming: if self.has(Self::BEAMING) { g } else { 1.0 } }
    }
}
