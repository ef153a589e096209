// SPDX-License-Identifier: MIT OR Apache-2.0
//! How an X11 window's pixels are written: where the bits of each colour are, and in which bytes. Knows no server.

use x11rb::protocol::xproto::{ImageOrder, Setup, VisualClass, Visualid};

/// The widest colour of a window: frames have 8 bits of each.
const MOST_BITS: u32 = 16;

/// The form of the pixels of a window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelForm {
    /// Bytes of a pixel, and what a row's bytes are a multiple of.
    pixel: usize,
    row: usize,
    big_endian: bool,
    /// Blue, green and red.
    colours: [Colour; 3],
    /// The bits that are no colour's, which are set: an alpha channel, where there is one, is opaque.
    rest: u32,
}

/// Where a colour's bits are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Colour {
    shift: u32,
    /// All of them set.
    most: u32,
}

impl Colour {
    fn of(mask: u32) -> Option<Self> {
        let most = mask.checked_shr(mask.trailing_zeros())?;
        let bits = most.trailing_ones();
        (most.count_ones() == bits && (1..=MOST_BITS).contains(&bits))
            .then(|| Self { shift: mask.trailing_zeros(), most })
    }

    /// The code 0 .. 255, on this colour's scale, in its place.
    fn bits(self, code: u8) -> u32 {
        ((u32::from(code) * self.most + 127) / 255) << self.shift
    }
}

impl PixelForm {
    /// For windows of a depth and a visual. Errors: what about them is not served.
    pub fn new(setup: &Setup, depth: u8, visual: Visualid) -> Result<Self, String> {
        let all = setup.roots.iter().flat_map(|screen| &screen.allowed_depths).flat_map(|allowed| &allowed.visuals);
        let found = all.into_iter().find(|one| one.visual_id == visual);
        let visual = found.ok_or_else(|| format!("its visual, {visual:#x}, is none of the server's"))?;
        if ![VisualClass::TRUE_COLOR, VisualClass::DIRECT_COLOR].contains(&visual.class) {
            return Err(format!("its depth is {depth}, and its pixels are numbers of a palette's colours"));
        }
        let format = setup.pixmap_formats.iter().find(|format| format.depth == depth);
        let (bits, pad) = format.map_or((0, 0), |format| (format.bits_per_pixel, format.scanline_pad));
        let masks = [visual.blue_mask, visual.green_mask, visual.red_mask];
        let [Some(blue), Some(green), Some(red)] = masks.map(Colour::of) else {
            return Err(format!("its depth is {depth}, and the masks of its colours are {masks:x?}"));
        };
        if !matches!(bits, 8 | 16 | 24 | 32) || !matches!(pad, 8 | 16 | 32) {
            return Err(format!("its depth is {depth}, of {bits} bits a pixel and rows of a multiple of {pad} bits"));
        }
        let used = u32::MAX.checked_shr(32u32.saturating_sub(depth.into())).unwrap_or(0);
        Ok(Self {
            pixel: usize::from(bits) / 8,
            row: usize::from(pad) / 8,
            big_endian: setup.image_byte_order == ImageOrder::MSB_FIRST,
            colours: [blue, green, red],
            rest: used & !masks.iter().fold(0, |all, mask| all | mask),
        })
    }

    /// Whether pixels of blue, green, red and 255, a byte each, are written as they are.
    pub fn is_bgra(&self) -> bool {
        let bytes = [0, 8, 16].map(|shift| Colour { shift, most: 0xff });
        self.pixel == 4 && !self.big_endian && self.colours == bytes
    }

    /// Bytes of a row of `width` pixels.
    pub fn row_bytes(&self, width: usize) -> usize {
        (self.pixel * width).next_multiple_of(self.row)
    }

    /// Writes a row of BGRA pixels into one of this form.
    pub fn write_row(&self, bgra: &[u8], row: &mut [u8]) {
        for (pixel, out) in bgra.as_chunks::<4>().0.iter().zip(row.chunks_exact_mut(self.pixel)) {
            let colours = self.colours.iter().zip(pixel);
            let value = colours.fold(self.rest, |value, (colour, code)| value | colour.bits(*code));
            let (little, big) = (value.to_le_bytes(), value.to_be_bytes());
            let bytes = if self.big_endian { &big[4 - self.pixel..] } else { &little[..self.pixel] };
            out.copy_from_slice(bytes);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use x11rb::protocol::xproto::{Depth, Format, Screen, Visualtype};

    /// A server with one visual.
    fn server(
        depth: u8,
        bits: u8,
        pad: u8,
        order: ImageOrder,
        class: VisualClass,
        [red, green, blue]: [u32; 3],
    ) -> Setup {
        let visual = Visualtype {
            visual_id: 7,
            class,
            bits_per_rgb_value: 8,
            colormap_entries: 256,
            red_mask: red,
            green_mask: green,
            blue_mask: blue,
        };
        let screen = Screen { allowed_depths: vec![Depth { depth, visuals: vec![visual] }], ..Screen::default() };
        let format = Format { depth, bits_per_pixel: bits, scanline_pad: pad };
        Setup { image_byte_order: order, pixmap_formats: vec![format], roots: vec![screen], ..Setup::default() }
    }

    const WHITE_THEN_RED: [u8; 8] = [255, 255, 255, 255, 0, 0, 255, 255];

    #[test]
    fn pixels_are_written_as_the_visual_has_them() {
        let (lsb, msb, colours) = (ImageOrder::LSB_FIRST, ImageOrder::MSB_FIRST, VisualClass::TRUE_COLOR);
        let written = |depth, bits, pad, order, masks| {
            let form = PixelForm::new(&server(depth, bits, pad, order, colours, masks), depth, 7).unwrap();
            let mut row = vec![0; form.row_bytes(2)];
            form.write_row(&WHITE_THEN_RED, &mut row);
            (form.is_bgra(), row)
        };
        let bytes = [0xff_0000, 0xff00, 0xff];
        assert_eq!(written(24, 32, 32, lsb, bytes), (true, vec![255, 255, 255, 0, 0, 0, 255, 0]));
        assert_eq!(written(32, 32, 32, lsb, bytes), (true, vec![255, 255, 255, 255, 0, 0, 255, 255]));
        assert_eq!(written(24, 32, 32, msb, bytes), (false, vec![0, 255, 255, 255, 0, 255, 0, 0]));
        // Three bytes a pixel, and rows of a multiple of four.
        assert_eq!(written(24, 24, 32, lsb, bytes), (false, vec![255, 255, 255, 0, 0, 255, 0, 0]));
        assert_eq!(written(16, 16, 32, lsb, [0xf800, 0x7e0, 0x1f]), (false, vec![0xff, 0xff, 0, 0xf8]));
        assert_eq!(written(15, 16, 32, msb, [0x7c00, 0x3e0, 0x1f]), (false, vec![0x7f, 0xff, 0x7c, 0]));
        let ten = [0x3ff << 20, 0x3ff << 10, 0x3ff];
        assert_eq!(written(30, 32, 32, lsb, ten), (false, vec![0xff, 0xff, 0xff, 0x3f, 0, 0, 0xf0, 0x3f]));
    }

    #[test]
    fn codes_are_rounded_and_keep_their_order() {
        for most in [1, 7, 31, 63, 255, 1023, 65535] {
            let colour = Colour { shift: 3, most };
            assert_eq!((colour.bits(0), colour.bits(255)), (0, most << 3));
            for code in 0..=255 {
                let exact = f64::from(code) * f64::from(most) / 255.0;
                assert!((f64::from(colour.bits(code) >> 3) - exact).abs() <= 0.5, "{code} of {most}");
            }
        }
    }

    #[test]
    fn what_is_not_served_is_named() {
        let refused = |class, bits, masks, visual| {
            PixelForm::new(&server(8, bits, 32, ImageOrder::LSB_FIRST, class, masks), 8, visual).unwrap_err()
        };
        let masks = [0xe0, 0x1c, 0x3];
        assert!(refused(VisualClass::PSEUDO_COLOR, 8, masks, 7).contains("palette"));
        assert!(refused(VisualClass::TRUE_COLOR, 4, masks, 7).contains("4 bits a pixel"));
        assert!(refused(VisualClass::TRUE_COLOR, 8, [0xa0, 0x1c, 0x3], 7).contains("a0"));
        assert!(refused(VisualClass::TRUE_COLOR, 8, [0, 0x1c, 0x3], 7).contains("masks"));
        assert!(refused(VisualClass::TRUE_COLOR, 8, masks, 8).contains("0x8"));
    }
}
