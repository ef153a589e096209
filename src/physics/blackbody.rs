// SPDX-License-Identifier: MIT OR Apache-2.0
//! Thermal light as the eye sees it: Planck's law through the CIE 1931 observer to linear Rec. 709 colour, the table
//! of it that both tracers read, and the one rule by which a redshift changes it. Knows nothing of disks, stars or
//! film. `shaders/shared/blackbody.wgsl` mirrors `BlackbodyTable` under the same names.

use super::cie1931::{COLOUR_MATCHING, FIRST_WAVELENGTH, WAVELENGTH_STEP};
use std::sync::OnceLock;

/// SI 2019: exact.
const PLANCK: f64 = 6.626_070_15e-34;
const LIGHT_SPEED: f64 = 299_792_458.0;
const BOLTZMANN: f64 = 1.380_649e-23;
/// h c / k, metre kelvin.
pub const SECOND_RADIATION_CONSTANT: f64 = PLANCK * LIGHT_SPEED / BOLTZMANN;

/// CIE XYZ -> linear Rec. 709: the inverse of the matrix that the primaries (0.64, 0.33), (0.30, 0.60), (0.15, 0.06)
/// and the white (0.3127, 0.3290) of ITU-R BT.709 define.
const XYZ_TO_RGB: [[f64; 3]; 3] = [
    [3.240_969_941_904_522_6, -1.537_383_177_570_094, -0.498_610_760_293_003_4],
    [-0.969_243_636_280_879_6, 1.875_967_501_507_720_2, 0.041_555_057_407_175_59],
    [0.055_630_079_696_993_66, -0.203_976_958_888_976_52, 1.056_971_514_242_878_6],
];

/// The luminance of linear Rec. 709 red, green and blue: the Y row of the inverse of `XYZ_TO_RGB`.
pub const LUMINANCE: [f64; 3] = [0.212_639_005_871_510_27, 0.715_168_678_767_756, 0.072_192_315_360_733_71];

/// CIE XYZ of a blackbody's radiance, W sr^-1 m^-2 weighted by the colour matching functions (times 683: cd m^-2).
/// `temperature` in K; 0 for one that is not positive.
pub fn radiance_xyz(temperature: f64) -> [f64; 3] {
    if temperature > 0.0 { reduced_xyz(1.0 / temperature).map(|v| v * temperature) } else { [0.0; 3] }
}

/// The light of `radiance_xyz` in linear Rec. 709; components outside the gamut are negative. Its luminance is the Y of
/// `radiance_xyz`.
pub fn linear_rgb(temperature: f64) -> [f64; 3] {
    xyz_to_rgb(radiance_xyz(temperature))
}

fn xyz_to_rgb(xyz: [f64; 3]) -> [f64; 3] {
    XYZ_TO_RGB.map(|row| row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2])
}

/// XYZ / T, a function of 1 / T that is analytic at 0, where it is the Rayleigh-Jeans limit: with x = c2 / (lambda T),
/// B_lambda = 2 h c^2 / (lambda^5 (e^x - 1)) = T (2 c k / lambda^4) (x / (e^x - 1)).
fn reduced_xyz(inverse_temperature: f64) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for (row, weights) in COLOUR_MATCHING.iter().enumerate() {
        let wavelength = FIRST_WAVELENGTH + row as f64 * WAVELENGTH_STEP;
        let x = SECOND_RADIATION_CONSTANT / wavelength * inverse_temperature;
        // e^x beyond f64: the quotient's limit, 0, without inf / inf.
        let bose = if x == 0.0 {
            1.0
        } else if x < 700.0 {
            x / x.exp_m1()
        } else {
            0.0
        };
        let radiance = 2.0 * LIGHT_SPEED * BOLTZMANN / wavelength.powi(4) * bose;
        for (total, weight) in sum.iter_mut().zip(weights) {
            *total += radiance * weight * WAVELENGTH_STEP;
        }
    }
    sum
}

/// Nodes of the table.
pub const BLACKBODY_SIZE: usize = 512;
/// Light of a colder body is exactly 0: it is 1e-63 of the faintest disk's (500 K), below f32.
pub const MIN_TEMPERATURE: f64 = 100.0;
/// Light of a hotter body is that of this one: keeps it finite in f32 next to the faintest reference, 500 K.
pub const MAX_TEMPERATURE: f64 = 1e20;
/// K. The table's coordinate is T0 / (T + T0): 0 at infinite temperature, where everything tabulated is analytic in 1
/// / T. The value puts the nodes where the residual bends most.
pub(crate) const COORDINATE_TEMPERATURE: f64 = 1000.0;
/// Metres. The wavelength of Wien's exponent that is taken out of ln Y; deep red, so that little remains when cold.
const WIEN_WAVELENGTH: f64 = 650e-9;
pub(crate) const WIEN_TEMPERATURE: f64 = SECOND_RADIATION_CONSTANT / WIEN_WAVELENGTH;
/// Largest luminance ratio, about e^80: leaves f32 room for colour, brightness and sums.
pub(crate) const MAX_RATIO: f64 = 5e34;
pub(crate) const MAX_LN_RATIO: f64 = 80.0;
/// Largest g_beaming / g_colour: its fourth power is finite in f32.
pub(crate) const MAX_BEAMING: f64 = 1e9;

/// Colour and luminance of blackbodies, linearly interpolated. From 500 K up to any temperature: luminance within 1e-4
/// relative, rgb per luminance within 5e-5; down to 100 K luminance within 6e-3.
pub struct BlackbodyTable {
    /// rgb / Y, not clamped to the gamut; ln(Y / T) + WIEN_TEMPERATURE / T.
    nodes: [[f64; 4]; BLACKBODY_SIZE],
}

impl BlackbodyTable {
    /// The one of this process, made at first use (about a millisecond).
    pub fn shared() -> &'static Self {
        static SHARED: OnceLock<BlackbodyTable> = OnceLock::new();
        SHARED.get_or_init(|| Self { nodes: std::array::from_fn(Self::node) })
    }

    /// The table of light that is no blackbody's but dims and reddens like one: `light(g)`, linear Rec. 709, is it
    /// under the shift g, and `temperature` (K) is to be at most that of its coolest part. Looked up at g
    /// `temperature` with the `log_reference` 0, the table gives `light`.
    pub fn of_light(temperature: f64, light: impl Fn(f64) -> [f64; 3]) -> Self {
        let node = |index: usize| {
            // Far beyond the last finite node; there luminance is proportional to temperature.
            let inverse_temperature = Self::inverse_temperature(index).max(1e-15);
            let rgb = light(1.0 / (inverse_temperature * temperature));
            let luminance: f64 = (0..3).map(|i| LUMINANCE[i] * rgb[i]).sum();
            let [r, g, b] = rgb.map(|v| v / luminance);
            [r, g, b, (luminance * inverse_temperature).ln() + WIEN_TEMPERATURE * inverse_temperature]
        };
        Self { nodes: std::array::from_fn(node) }
    }

    /// 1 / T of a node.
    fn inverse_temperature(index: usize) -> f64 {
        let last = COORDINATE_TEMPERATURE / (MIN_TEMPERATURE + COORDINATE_TEMPERATURE);
        let coordinate = last * index as f64 / (BLACKBODY_SIZE - 1) as f64;
        coordinate / (COORDINATE_TEMPERATURE * (1.0 - coordinate))
    }

    fn node(index: usize) -> [f64; 4] {
        let inverse_temperature = Self::inverse_temperature(index);
        let xyz = reduced_xyz(inverse_temperature);
        let [r, g, b] = xyz_to_rgb(xyz).map(|v| v / xyz[1]);
        [r, g, b, xyz[1].ln() + WIEN_TEMPERATURE * inverse_temperature]
    }

    /// The nodes in f32, for `light_tables` on the GPU.
    pub fn gpu_table(&self) -> Vec<[f32; 4]> {
        self.nodes.iter().map(|node| node.map(|v| v as f32)).collect()
    }

    /// rgb / Y of a blackbody, not clamped, and ln(Y / T). MIN_TEMPERATURE <= `temperature` <= MAX_TEMPERATURE.
    pub(crate) fn blackbody_lookup(&self, temperature: f64) -> [f64; 4] {
        let scale = (BLACKBODY_SIZE - 1) as f64 * (MIN_TEMPERATURE + COORDINATE_TEMPERATURE);
        let position = scale / (temperature + COORDINATE_TEMPERATURE);
        let index = (position as usize).min(BLACKBODY_SIZE - 2);
        let share = position - index as f64;
        let (low, high) = (self.nodes[index], self.nodes[index + 1]);
        let mut value: [f64; 4] = std::array::from_fn(|i| low[i] + (high[i] - low[i]) * share);
        value[3] -= WIEN_TEMPERATURE / temperature;
        value
    }

    /// ln Y of a blackbody as the table has it, Y as in `radiance_xyz`: the `log_reference` of the functions below.
    /// `temperature` in K, taken into [MIN_TEMPERATURE, MAX_TEMPERATURE].
    pub fn ln_luminance(&self, temperature: f64) -> f64 {
        // NaN also becomes the lower end.
        let taken = if temperature > MIN_TEMPERATURE { temperature.min(MAX_TEMPERATURE) } else { MIN_TEMPERATURE };
        self.blackbody_lookup(taken)[3] + taken.ln()
    }

    /// Linear Rec. 709 light of a blackbody at `temperature` (K), where a luminance of e^`log_reference` counts as 1.
    /// Inside the gamut, finite; 0 below MIN_TEMPERATURE and for NaN.
    pub fn blackbody_rgb(&self, temperature: f64, log_reference: f64) -> [f64; 3] {
        self.shifted_blackbody(temperature, log_reference, 1.0, 1.0)
    }

    /// Light of a blackbody at `temperature_observed`, in units of the luminance of one at `temperature_reference` (K).
    pub fn shade(&self, temperature_observed: f64, temperature_reference: f64) -> [f64; 3] {
        self.blackbody_rgb(temperature_observed, self.ln_luminance(temperature_reference))
    }

    /// Light of a blackbody at `temperature` (K) seen under a redshift, in units of the luminance e^`log_reference`.
    /// I_nu / nu^3 is invariant, so it is that of a blackbody at g T. Colour and brightness can be told apart, for
    /// teaching: `g_colour` is the product of the shifts that colour the light; of the factor g^4 that the whole
    /// spectrum gains, B(g_colour T) carries g_colour^4, and it is replaced by `g_beaming`^4 (1 without beaming). Both
    /// equal to g: `blackbody_rgb(g T)`.
    pub fn shifted_blackbody(&self, temperature: f64, log_reference: f64, g_colour: f64, g_beaming: f64) -> [f64; 3] {
        let observed = temperature * g_colour;
        // The condition is positive so that it is false for NaN.
        if observed >= MIN_TEMPERATURE && g_beaming > 0.0 {
            let taken = observed.min(MAX_TEMPERATURE);
            let [r, g, b, ln_slope] = self.blackbody_lookup(taken);
            let beaming = (g_beaming / g_colour).min(MAX_BEAMING);
            let gain = (beaming * beaming) * (beaming * beaming);
            // The factors are multiplied in this order so that no product is 0 times infinity, in f32 either.
            let luminance = (ln_slope - log_reference).min(MAX_LN_RATIO).exp() * gain * taken;
            into_gamut([r, g, b]).map(|v| v * luminance.min(MAX_RATIO))
        } else {
            [0.0; 3]
        }
    }
}

/// K. Beside the table: polynomials of x = T0 / (T + T0), for places of which there are many. They are Chebyshev's
/// approximations of the same functions from 500 K up, where x is `FIT_END`: red and blue of luminance 1 within 2e-4,
/// luminance within 1.1e-3 relative; colder bodies have the colour of one of 500 K. (With T0 = 1500 K the degree is
/// least.)
pub(crate) const FIT_TEMPERATURE: f64 = 1500.0;
pub(crate) const FIT_END: f64 = 0.75;
/// Red and blue of luminance 1, not clamped; ln(Y / T) + WIEN_TEMPERATURE / T.
pub(crate) const FIT_RED: [f64; 8] =
    [0.663_625_606, 0.894_545_352, 3.465_490_6, 17.122_026_9, -14.157_047_8, -46.695_072_5, 152.429_494, -114.024_739];
pub(crate) const FIT_BLUE: [f64; 10] = [
    2.229_198_27,
    -4.563_300_01,
    -11.937_947_9,
    -65.622_293_4,
    792.779_955,
    -2_857.431_66,
    5_572.286_17,
    -6_349.954_27,
    3_974.247_81,
    -1_055.206_29,
];
pub(crate) const FIT_LUMINANCE: [f64; 10] = [
    9.160_229_82,
    6.039_616_87,
    -10.946_834_4,
    47.473_255_5,
    -525.120_433,
    2_577.725_95,
    -6_770.700_71,
    10_066.457_8,
    -8_018.125_99,
    2_676.730_95,
];

/// Even and odd powers apart, so that a processor finds both at the same time.
fn fitted<const N: usize>(coefficients: &[f64; N], x: f64) -> f64 {
    let square = x * x;
    let [mut even, mut odd] = [0.0, 0.0];
    for [one, other] in coefficients.as_chunks::<2>().0.iter().rev() {
        (even, odd) = (even * square + one, odd * square + other);
    }
    even + x * odd
}

/// The coordinate of the fit, and 1 / T.
fn fit_place(ln_temperature: f64) -> [f64; 2] {
    let inverse = rounded_exp(-ln_temperature);
    [(FIT_TEMPERATURE * inverse / (1.0 + FIT_TEMPERATURE * inverse)).min(FIT_END), inverse]
}

/// The luminance of a blackbody at e^`ln_temperature` K over e^`log_reference`.
pub fn fitted_luminance(ln_temperature: f64, log_reference: f64) -> f64 {
    let [x, inverse] = fit_place(ln_temperature);
    let ln_ratio = fitted(&FIT_LUMINANCE, x) + ln_temperature - WIEN_TEMPERATURE * inverse - log_reference;
    rounded_exp(ln_ratio.min(MAX_LN_RATIO))
}

/// e^x to the precision of f32, which takes half as long.
pub(crate) fn rounded_exp(x: f64) -> f64 {
    f64::from((x as f32).exp())
}

/// The colour of luminance 1 of a blackbody at e^`ln_temperature` K, inside the gamut.
pub fn fitted_colour(ln_temperature: f64) -> [f64; 3] {
    let [x, _] = fit_place(ln_temperature);
    let (red, blue) = (fitted(&FIT_RED, x), fitted(&FIT_BLUE, x));
    into_gamut([red, (1.0 - LUMINANCE[0] * red - LUMINANCE[2] * blue) / LUMINANCE[1], blue])
}

/// A colour of luminance 1 mixed with white of luminance 1 until no component is negative: keeps luminance and hue (in
/// the chromaticity diagram, the line through white), continuous.
pub fn into_gamut(rgb: [f64; 3]) -> [f64; 3] {
    let least = rgb[0].min(rgb[1]).min(rgb[2]).min(0.0);
    rgb.map(|v| (v - least) / (1.0 - least))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From 500 K up to any temperature: what is said of the fit.
    #[test]
    fn fits_are_near_the_table() {
        let table = BlackbodyTable::shared();
        let mut temperature = 500.0;
        while temperature < 1e9 {
            let ln = f64::ln(temperature);
            let ratio = fitted_luminance(ln, table.ln_luminance(temperature));
            assert!((ratio - 1.0).abs() < 1.2e-3, "{temperature} K: {ratio}");
            let [r, g, b, _] = table.blackbody_lookup(temperature);
            let (colour, expected) = (fitted_colour(ln), into_gamut([r, g, b]));
            let off = (0..3).map(|i| (colour[i] - expected[i]).abs()).fold(0.0, f64::max);
            assert!(off < 5e-4, "{temperature} K: {colour:?}, not {expected:?}");
            temperature *= 1.01;
        }
        // Cold bodies are dark, whatever their colour.
        assert!(fitted_luminance(f64::ln(100.0), table.ln_luminance(500.0)) < 1e-40);
        assert!(fitted_colour(-1e3).into_iter().chain(fitted_colour(1e3)).all(f64::is_finite));
    }

    fn luminance(rgb: [f64; 3]) -> f64 {
        (0..3).map(|i| LUMINANCE[i] * rgb[i]).sum()
    }

    /// Planckian locus: colour-science 0.4.7, CIE 1931 at 1 nm from 360 to 830 nm, c2 = 0.014387768775 m K.
    #[test]
    fn chromaticity_is_on_the_planckian_locus() {
        let locus = [
            (1000.0, 0.6527507, 0.3444617),
            (2000.0, 0.5266775, 0.4132970),
            (3000.0, 0.4369311, 0.4040740),
            (5800.0, 0.3259827, 0.3353191),
            (6500.0, 0.3135259, 0.3236283),
            (10000.0, 0.2806336, 0.2882878),
            (100000.0, 0.2425824, 0.2380275),
        ];
        for (temperature, x, y) in locus {
            let xyz = radiance_xyz(temperature);
            let sum = xyz.iter().sum::<f64>();
            assert!((xyz[0] / sum - x).abs() < 1e-5, "x at {temperature} K");
            assert!((xyz[1] / sum - y).abs() < 1e-5, "y at {temperature} K");
        }
    }

    /// Same source, W sr^-1 m^-2.
    #[test]
    fn luminance_is_absolute() {
        for (temperature, y) in [(1000.0, 0.00393406104585), (3000.0, 44243.2692235), (6500.0, 4498563.74639)] {
            assert!((radiance_xyz(temperature)[1] / y - 1.0).abs() < 1e-5, "Y at {temperature} K");
        }
        // Freezing platinum, 2041.4 K, defined the candela: 60 cd cm^-2 (CIPM 1946).
        let platinum = 683.0 * radiance_xyz(2041.4)[1];
        assert!((platinum / 60e4 - 1.0).abs() < 0.02, "{platinum} cd/m^2");
    }

    #[test]
    fn matrix_is_that_of_rec_709() {
        let white = xyz_to_rgb([0.3127 / 0.3290, 1.0, (1.0 - 0.3127 - 0.3290) / 0.3290]);
        assert!(white.iter().all(|v| (v - 1.0).abs() < 1e-12), "{white:?}");
        let red = xyz_to_rgb([0.64, 0.33, 0.03]);
        assert!(red[0] > 0.0 && red[1].abs() < 1e-12 && red[2].abs() < 1e-12, "{red:?}");
        for temperature in [1000.0, 6500.0, 1e6] {
            let y = radiance_xyz(temperature)[1];
            assert!((luminance(linear_rgb(temperature)) / y - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn limits_are_wien_and_rayleigh_jeans() {
        // d ln Y / d(1/T) = -c2 / lambda: the light of a cold body lies between the ends of the red.
        for temperature in [200.0, 400.0, 800.0] {
            let ln = |t: f64| radiance_xyz(t)[1].ln();
            let slope = (ln(temperature * 1.001) - ln(temperature / 1.001))
                / (1.0 / (temperature * 1.001) - 1.001 / temperature);
            let wavelength = -SECOND_RADIATION_CONSTANT / slope;
            assert!((600e-9..840e-9).contains(&wavelength), "{wavelength} at {temperature} K");
        }
        let hot = radiance_xyz(2e12)[1] / radiance_xyz(1e12)[1];
        assert!((hot - 2.0).abs() < 1e-7);
        assert_eq!(radiance_xyz(1.0), [0.0; 3]);
        assert_eq!(radiance_xyz(-5.0), [0.0; 3]);
        assert_eq!(radiance_xyz(f64::NAN), [0.0; 3]);
    }

    /// Worst errors of the table from `low` K to `high` K: of ln Y, of rgb / Y.
    fn worst_error(low: f64, high: f64) -> (f64, f64) {
        let table = BlackbodyTable::shared();
        let mut worst = (0.0_f64, 0.0_f64);
        for i in 0..=5000 {
            let temperature = low * (high / low).powf(f64::from(i) / 5000.0);
            let xyz = radiance_xyz(temperature);
            let exact = into_gamut(linear_rgb(temperature).map(|v| v / xyz[1]));
            let ln_luminance = table.ln_luminance(temperature);
            let rgb = table.blackbody_rgb(temperature, ln_luminance);
            worst.0 = worst.0.max((ln_luminance - xyz[1].ln()).abs());
            for c in 0..3 {
                worst.1 = worst.1.max((rgb[c] - exact[c]).abs());
            }
        }
        worst
    }

    #[test]
    fn table_agrees_with_the_integral() {
        let (luminance, chroma) = worst_error(500.0, 1e13);
        assert!(luminance < 1e-4 && chroma < 5e-5, "{luminance:e} {chroma:e}");
        let (luminance, chroma) = worst_error(MIN_TEMPERATURE, 500.0);
        assert!(luminance < 6e-3 && chroma < 5e-5, "{luminance:e} {chroma:e}");
    }

    #[test]
    fn shade_is_finite_inside_the_gamut_and_1_at_its_reference() {
        let table = BlackbodyTable::shared();
        let mut before = -1.0;
        for i in 0..2000 {
            let temperature = 10.0_f64.powf(1.0 + f64::from(i) * 0.02);
            for reference in [500.0, 6500.0, 1e9] {
                let rgb = table.shade(temperature, reference);
                assert!(rgb.iter().all(|v| (0.0..1e38).contains(v)), "{rgb:?} at {temperature} K over {reference} K");
            }
            let y = luminance(table.shade(temperature, 6500.0));
            assert!(y >= before, "luminance falls at {temperature} K");
            before = y;
        }
        for reference in [500.0, 6500.0, 1e9] {
            assert!((luminance(table.shade(reference, reference)) - 1.0).abs() < 1e-12);
        }
        assert_eq!(table.shade(99.0, 6500.0), [0.0; 3]);
        assert_eq!(table.shade(f64::NAN, 6500.0), [0.0; 3]);
        assert!(table.shade(f64::INFINITY, 500.0).iter().all(|v| v.is_finite()));
    }

    #[test]
    fn shift_rule_follows_the_effects() {
        let table = BlackbodyTable::shared();
        let reference = table.ln_luminance(5000.0);
        let all = table.shifted_blackbody(5000.0, reference, 1.3, 1.3);
        assert_eq!(all, table.blackbody_rgb(1.3 * 5000.0, reference));
        let beaming_alone = table.shifted_blackbody(5000.0, reference, 1.0, 1.3);
        assert!((luminance(beaming_alone) - 1.3_f64.powi(4)).abs() < 1e-12);
        let colour_alone = table.shifted_blackbody(5000.0, reference, 1.3, 1.0);
        for c in 0..3 {
            assert!((colour_alone[c] * 1.3_f64.powi(4) / all[c] - 1.0).abs() < 1e-12);
        }
        assert_eq!(table.shifted_blackbody(5000.0, reference, 0.0, 0.0), [0.0; 3]);
        assert_eq!(table.shifted_blackbody(5000.0, reference, f64::NAN, 1.0), [0.0; 3]);
        assert!(table.shifted_blackbody(5000.0, reference, 1e-3, 1e30).iter().all(|v| v.is_finite()));
    }
}
