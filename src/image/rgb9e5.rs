// SPDX-License-Identifier: MIT OR Apache-2.0
//! RGB9E5: light in texels of 32 bits, as sky maps keep it. Knows no pictures.

/// Largest number that RGB9E5 holds: 511 / 512 2^16.
const MAX_LIGHT: f32 = 65408.0;

/// The light that can be stored: NaN and negative light become 0, infinite light the largest.
pub fn limited(v: f32) -> f32 {
    // The condition is positive so that it is false for NaN.
    if v > 0.0 { v.min(MAX_LIGHT) } else { 0.0 }
}

/// RGB9E5 (EXT_texture_shared_exponent, section 3.8.x.1): three mantissas of 9 bits, red lowest, and one exponent of 5:
/// mantissa 2^(exponent - 24). Rounded to the nearest.
pub fn pack(rgb: [f32; 3]) -> u32 {
    let rgb = rgb.map(limited);
    let top = rgb[0].max(rgb[1]).max(rgb[2]);
    // floor(log2(top)) + 16, at least 0; multiplied by 2^(24 - exponent) the mantissas come out.
    let exponent = ((top.to_bits() >> 23).max(111) - 111).min(31);
    let rounded = |v: f32, exponent: u32| (v * f32::from_bits((151 - exponent) << 23) + 0.5) as u32;
    let exponent = if rounded(top, exponent) > 511 { exponent + 1 } else { exponent };
    let [r, g, b] = rgb.map(|v| rounded(v, exponent).min(511));
    r | g << 9 | b << 18 | exponent << 27
}

/// Linear Rec. 709 of a texel: exact in f32, as a GPU reads it.
pub fn unpack(texel: u32) -> [f32; 3] {
    // 2^(exponent - 24), from its bits.
    let scale = f32::from_bits(((texel >> 27) + 103) << 23);
    [0, 9, 18].map(|shift| ((texel >> shift) & 511) as f32 * scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packing_is_exact_to_nine_bits_and_takes_anything() {
        let mut largest = 0.0_f32;
        for i in 0..200_000_u32 {
            let top = 2.0_f32.powf(i as f32 / 200_000.0 * 40.0 - 24.0).min(MAX_LIGHT);
            let rgb = [top, top * 0.37, top * (i % 7) as f32 / 7.0];
            let back = unpack(pack(rgb));
            for c in 0..3 {
                largest = largest.max((back[c] - rgb[c]).abs() / top.max(2.0_f32.powi(-16)));
            }
        }
        assert!(largest <= 1.0 / 512.0, "{largest}");
        for exact in [0.0, 1.0, 0.5, 65408.0, 2.0_f32.powi(-24), 511.0 / 512.0] {
            assert_eq!(unpack(pack([exact; 3])), [exact; 3]);
        }
        let odd = unpack(pack([f32::NAN, -1.0, f32::INFINITY]));
        assert_eq!(odd, [0.0, 0.0, 65408.0]);
        // A mantissa that rounds up to 512 goes over into the next exponent.
        assert_eq!(unpack(pack([0.9999, 0.0, 0.0])), [1.0, 0.0, 0.0]);
    }
}
