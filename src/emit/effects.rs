// SPDX-License-Identifier: MIT OR Apache-2.0
//! The parts of relativity that a host can switch off, and the shift of light that is left. Plain numbers.

use super::crossing::Shift;
use crate::error::{Result, out_of_range};

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

    pub fn has(self, bit: u32) -> bool {
        self.0 & bit != 0
    }

    /// How strongly effects show of which `set` are the strengths: those that are switched off do not.
    pub fn shown(self, set: EffectStrengths) -> EffectStrengths {
        let of = |bit, strength| if self.has(bit) { strength } else { 0.0 };
        EffectStrengths {
            doppler_shift: of(Self::DOPPLER_SHIFT, set.doppler_shift),
            gravity_shift: of(Self::GRAVITY_SHIFT, set.gravity_shift),
            beaming: of(Self::BEAMING, set.beaming),
        }
    }
}

/// How strongly the effects show that colour light or change its brightness, each from 0, not at all, to 1, as physics
/// has it. Between them, the part of the frequency ratio that is the effect's counts to the power of its strength, so
/// that half a strength is half the shift in log frequency. (For "Interstellar" such shifts were left out altogether:
/// James, von Tunzelmann, Franklin & Thorne 2015, Class. Quantum Grav. 32, 065001.)
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EffectStrengths {
    pub doppler_shift: f64,
    pub gravity_shift: f64,
    pub beaming: f64,
}

/// Physics.
impl Default for EffectStrengths {
    fn default() -> Self {
        Self { doppler_shift: 1.0, gravity_shift: 1.0, beaming: 1.0 }
    }
}

/// v^strength, exact where the strength is 0 or 1.
fn to_strength(v: f64, strength: f64) -> f64 {
    match strength {
        0.0 => 1.0,
        1.0 => v,
        _ => v.powf(strength),
    }
}

impl EffectStrengths {
    /// From the strengths of the Doppler shift, gravity's shift and beaming. Errors: one is not in [0, 1].
    pub fn checked(strengths: [f64; 3]) -> Result<Self> {
        match strengths.into_iter().find(|strength| !(0.0..=1.0).contains(strength)) {
            Some(strength) => Err(out_of_range("effect_strengths", strength, 0.0, 1.0)),
            None => {
                let [doppler_shift, gravity_shift, beaming] = strengths;
                Ok(Self { doppler_shift, gravity_shift, beaming })
            }
        }
    }

    pub fn to_array(self) -> [f64; 3] {
        [self.doppler_shift, self.gravity_shift, self.beaming]
    }

    /// Whether light is shown as it arrives, no effect weakened.
    pub fn are_whole(&self) -> bool {
        *self == Self::default()
    }

    /// The shift that shows. g = g_gravity g_doppler, split at the local static observers (ZAMOs); `gravity` gives the
    /// former. Beaming takes all of g.
    pub fn visible_shift(&self, g: f64, gravity: impl Fn() -> f64) -> Shift {
        if self.are_whole() {
            return Shift { colour: g, beaming: g };
        }
        let gravity = gravity();
        // g_doppler^d g_gravity^s = g^d g_gravity^(s - d).
        let colour = to_strength(g, self.doppler_shift);
        let beyond = self.gravity_shift - self.doppler_shift;
        let part = to_strength(gravity, beyond.abs());
        let colour = if beyond < 0.0 { colour / part } else { colour * part };
        Shift { colour, beaming: to_strength(g, self.beaming) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strengths_between_are_powers_of_the_parts() {
        let (g, gravity) = (1.7, 0.6);
        for (bits, colour, beaming) in [
            (Effects::ALL, g, g),
            (0, 1.0, 1.0),
            (Effects::DOPPLER_SHIFT, g / gravity, 1.0),
            (Effects::GRAVITY_SHIFT | Effects::BEAMING, gravity, g),
        ] {
            let shift = Effects(bits).shown(EffectStrengths::default()).visible_shift(g, || gravity);
            assert_eq!((shift.colour, shift.beaming), (colour, beaming), "{bits:x}");
        }
        let half = EffectStrengths { doppler_shift: 0.5, gravity_shift: 0.25, beaming: 0.75 };
        let shift = Effects(Effects::ALL).shown(half).visible_shift(g, || gravity);
        let expected = (g / gravity).sqrt() * gravity.sqrt().sqrt();
        assert!((shift.colour / expected - 1.0).abs() < 1e-15, "{shift:?}");
        assert!((shift.beaming / g.powf(0.75) - 1.0).abs() < 1e-15, "{shift:?}");
        let shift = Effects(Effects::BEAMING).shown(half).visible_shift(g, || gravity);
        assert_eq!((shift.colour, shift.beaming), (1.0, g.powf(0.75)));
    }
}
