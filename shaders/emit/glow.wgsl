// SPDX-License-Identifier: MIT OR Apache-2.0
// The light that matter with depth sends and absorbs. Mirrors src/emit/glow.rs, where the formulas are.

#import constants
#import emit/shift
#import shared/blackbody
#import shared/matter

// Whether a kernel's matter has blackbodies and power laws among it.
override THERMAL: bool = true;
override POWER_LAW: bool = true;

// Coefficients are no larger: what is behind an opaque cell is taken times 0, which must not meet infinity.
const LARGEST_COEFFICIENT: f32 = 1e24;

// Per unit of affine length: light in linear Rec. 709, I_nu of power laws, optical depth.
struct Coefficients {
    light: vec3<f32>,
    intensity: f32,
    absorption: f32,
}

// Matter of a density at the radius r, which measures the frequency nu, that of the local frame's observer being 1.
// `heat`: a factor on the temperature; g = nu(camera) / nu(matter), `shift`: as the effects let it show.
fn glow_coefficients(matter: Matter, density: f32, heat: f32, r: f32, nu: f32, g: f32, shift: Shift) -> Coefficients {
    let column = density * nu;
    if POWER_LAW && (!THERMAL || matter.power_law != 0u) {
        let ln_g = log(g);
        let index = matter.spectral_index;
        let column_seen = column * shift.beaming * shift.beaming * shift.beaming * pow(shift.colour, index);
        let seen = min(column_seen, LARGEST_COEFFICIENT) * matter.brightness;
        return Coefficients(matter.tint * min(seen, LARGEST_COEFFICIENT),
            min(column * exp(ln_g * (3.0 + index)), LARGEST_COEFFICIENT),
            min(matter.absorption * column * exp(ln_g * (ABSORPTION_INDEX + index)), LARGEST_COEFFICIENT));
    }
    let absorption = min(matter.absorption * column, LARGEST_COEFFICIENT);
    let temperature = heat * matter.temperature * pow(r / matter.reference_radius, -matter.temperature_slope);
    let rgb = shifted_blackbody(temperature, matter.log_reference, shift.colour, shift.beaming);
    return Coefficients(min(rgb * (matter.brightness * absorption), vec3<f32>(LARGEST_COEFFICIENT)), 0.0, absorption);
}
