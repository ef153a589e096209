// SPDX-License-Identifier: MIT OR Apache-2.0
//! Images in the host's memory: formats and strides. Bytes between rows are never touched, not even borrowed:
//! images may lie side by side in one block and be written by different threads. Outside `capi` this is the only
//! file with raw pointers.

pub use super::pixel_format::PixelFormat;

use super::Copiers;
use crate::error::{Error, Result};
use std::marker::PhantomData;
use std::ops::Range;
use std::sync::Arc;

/// Longest side of an image, pixels. A larger one is more than any format's header or any address space holds well.
pub const MAX_SIDE: u32 = 1 << 20;

/// How pixels lie in a block of memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    pub format: PixelFormat,
    /// 1 .. [`MAX_SIDE`].
    pub width: u32,
    /// 1 .. [`MAX_SIDE`].
    pub height: u32,
    /// Bytes to the next row down; 0: packed; < 0: bottom-up, the block beginning at the last row.
    pub row_stride: i64,
}

impl Layout {
    /// Rows without gaps, top-down.
    pub fn packed(format: PixelFormat, width: u32, height: u32) -> Self {
        Self { format, width, height, row_stride: 0 }
    }

    /// Bytes of one row's pixels.
    fn row_bytes(&self) -> u64 {
        u64::from(self.width) * self.format.bytes_per_pixel() as u64
    }

    /// Bytes of the block, (height - 1) |stride| + one row, and the stride. Errors: sides or stride out of their
    /// ranges.
    pub fn check(&self) -> Result<(usize, isize)> {
        for (name, side) in [("width", self.width), ("height", self.height)] {
            if side == 0 || side > MAX_SIDE {
                return Err(Error::argument(format!("image {name} is {side}; it must lie in [1, {MAX_SIDE}]")));
            }
        }
        let row = self.row_bytes();
        let stride = if self.row_stride == 0 { row as i64 } else { self.row_stride };
        let step = stride.unsigned_abs();
        if step < row {
            return Err(Error::argument(format!(
                "image row_stride is {stride}; a row of {} pixels {} takes {row} bytes",
                self.width, self.format
            )));
        }
        let channel = self.format.channel_bytes() as u64;
        if !step.is_multiple_of(channel) {
            return Err(Error::argument(format!(
                "image row_stride is {stride}; for {} it must be a multiple of {channel}",
                self.format
            )));
        }
        let bytes = u128::from(self.height - 1) * u128::from(step) + u128::from(row);
        match (isize::try_from(bytes), isize::try_from(stride)) {
            (Ok(bytes), Ok(stride)) => Ok((bytes.unsigned_abs(), stride)),
            _ => Err(Error::argument(format!(
                "image row_stride is {stride}; {} rows take {bytes} bytes, more than there can be",
                self.height
            ))),
        }
    }

    /// Checks as `check` does, for a picture whose bottom row comes first in memory: `BHR_IMAGE_BOTTOM_UP`. Errors:
    /// those of `check`, or a negative stride.
    pub fn check_bottom_up(&self) -> Result<(usize, isize)> {
        let given = self.row_stride;
        if given < 0 {
            return Err(Error::argument(format!(
                "image row_stride is {given}; where BHR_IMAGE_BOTTOM_UP says that the bottom row comes first it is 0 \
                 or more, and pixels the lowest address"
            )));
        }
        self.check()
    }
}

/// The row of a picture that begins at the pixels that a host names.
enum FirstRow {
    /// `row_stride` leads to the next row down; where it is negative, the pixels are the block's last row.
    Top,
    /// `row_stride`, not negative, leads to the next row up: `BHR_IMAGE_BOTTOM_UP`.
    Bottom,
}

/// A checked layout and its top-left pixel.
#[derive(Clone, Copy)]
struct Rows {
    format: PixelFormat,
    width: u32,
    height: u32,
    stride: isize,
    top_left: *mut u8,
}

impl Rows {
    /// `pixels` as `first_row` says. Errors: as `Layout::check` or `Layout::check_bottom_up`; a block
    /// of fewer bytes than that needs; NULL or misaligned pixels, or ones whose rows would lie outside the address
    /// space.
    fn new(layout: Layout, first_row: FirstRow, pixels: *mut u8, byte_size: u64) -> Result<Self> {
        let (bytes, stride) = match first_row {
            FirstRow::Top => layout.check()?,
            FirstRow::Bottom => layout.check_bottom_up()?,
        };
        if pixels.is_null() {
            return Err(Error::argument("image pixels is NULL"));
        }
        let channel = layout.format.channel_bytes();
        if !pixels.addr().is_multiple_of(channel) {
            return Err(Error::argument(format!(
                "image pixels is {pixels:p}; for {} it must be a multiple of {channel}",
                layout.format
            )));
        }
        if byte_size < bytes as u64 {
            return Err(Error::argument(format!(
                "image byte_size is {byte_size}; {} x {} {} at stride {stride} needs {bytes}",
                layout.width, layout.height, layout.format
            )));
        }
        let Layout { format, width, height, .. } = layout;
        let to_last = (height as usize - 1) * stride.unsigned_abs();
        let lowest = if stride < 0 { pixels.addr().checked_sub(to_last) } else { Some(pixels.addr()) };
        if lowest.and_then(|address| address.checked_add(bytes)).is_none() {
            return Err(Error::argument(format!(
                "image pixels is {pixels:p}; {bytes} bytes at stride {stride} reach outside the address space"
            )));
        }
        match first_row {
            FirstRow::Top => Ok(Self { format, width, height, stride, top_left: pixels }),
            // The address is in range: the last row, which is the top one, lies in the address space.
            FirstRow::Bottom => {
                Ok(Self { format, width, height, stride: -stride, top_left: pixels.wrapping_add(to_last) })
            }
        }
    }

    /// The rows of a whole block. Errors: as `new`.
    fn of_block(layout: Layout, begin: *mut u8, byte_size: usize) -> Result<Self> {
        let (_, stride) = layout.check()?;
        let lead = if stride < 0 { (layout.height as usize - 1) * stride.unsigned_abs() } else { 0 };
        // A block that ends before its top-left pixel is refused by its size.
        Self::new(layout, FirstRow::Top, begin.wrapping_add(lead), byte_size as u64)
    }

    fn row_bytes(&self) -> usize {
        self.width as usize * self.format.bytes_per_pixel()
    }

    /// Where row `y` begins; `None` past the last.
    fn row(&self, y: u32) -> Option<*mut u8> {
        // The address is in range: `Rows::new` saw that every row lies in the address space.
        (y < self.height).then(|| self.top_left.wrapping_offset(y as isize * self.stride))
    }
}

/// An image to read from.
pub struct ImageRef<'a> {
    rows: Rows,
    memory: PhantomData<&'a [u8]>,
}

// SAFETY: it stands for a `&'a [u8]`, which is Send and Sync.
unsafe impl Send for ImageRef<'_> {}
// SAFETY: as above.
unsafe impl Sync for ImageRef<'_> {}

impl<'a> ImageRef<'a> {
    /// Errors: a layout out of its ranges, or a block too small or misaligned for it.
    pub fn new(layout: Layout, block: &'a [u8]) -> Result<Self> {
        let rows = Rows::of_block(layout, block.as_ptr().cast_mut(), block.len())?;
        Ok(Self { rows, memory: PhantomData })
    }

    pub fn width(&self) -> u32 {
        self.rows.width
    }

    pub fn height(&self) -> u32 {
        self.rows.height
    }

    pub fn format(&self) -> PixelFormat {
        self.rows.format
    }

    /// The pixels of row `y`; empty past the last.
    pub fn row(&self, y: u32) -> &'a [u8] {
        match self.rows.row(y) {
            // SAFETY: `Rows::new` saw that the block holds this row; nobody writes it during 'a.
            Some(begin) => unsafe { std::slice::from_raw_parts(begin, self.rows.row_bytes()) },
            None => &[],
        }
    }

    /// All pixels, where rows lie top-down without gaps.
    pub fn packed(&self) -> Option<&'a [u8]> {
        let row = self.rows.row_bytes();
        // SAFETY: as in `row`, and no byte lies between rows.
        (self.rows.stride == row as isize)
            .then(|| unsafe { std::slice::from_raw_parts(self.rows.top_left, row * self.rows.height as usize) })
    }
}

/// An image to write to.
pub struct ImageMut<'a> {
    rows: Rows,
    touched: bool,
    /// The threads that help to write large tiles.
    copiers: Option<Arc<Copiers>>,
    memory: PhantomData<&'a mut [u8]>,
}

/// A tile that lies inside an image, on its way into it.
struct Copying<'t> {
    rows: Rows,
    /// Bytes from the image's left edge to the tile's left column.
    left: usize,
    /// The row of the image that is the tile's first.
    top: u32,
    /// Bytes of a row of the tile.
    row_bytes: usize,
    pixels: &'t [u8],
    bytes_per_row: usize,
}

// SAFETY: threads share it to write rows that are not another's (`Copying::write`); what they read nobody writes.
unsafe impl Sync for Copying<'_> {}

impl Copying<'_> {
    /// Copies some rows of the tile.
    ///
    /// # Safety
    /// No other thread copies any of these rows meanwhile, and the image is the caller's to write.
    unsafe fn write(&self, lines: Range<u32>) {
        let packed = self.bytes_per_row == self.row_bytes && self.rows.stride == self.row_bytes as isize;
        // Without gaps on both sides (the tile is as wide as the image then) rows are copied as one.
        let at_once = if packed { lines.end.saturating_sub(lines.start) } else { 1 };
        for line in lines.step_by(at_once.max(1) as usize) {
            let begin = line as usize * self.bytes_per_row;
            let bytes = at_once as usize * self.row_bytes;
            if let (Some(to), Some(from)) = (self.rows.row(self.top + line), self.pixels.get(begin..begin + bytes)) {
                // SAFETY: the tile lies inside the image, and the image's rows inside the host's block, which is no
                // part of `pixels`; rows do not overlap, since `Layout::check` sees that the stride is no shorter than
                // a row.
                unsafe { std::ptr::copy_nonoverlapping(from.as_ptr(), to.add(self.left), bytes) };
            }
        }
    }
}

// SAFETY: it stands for a `&'a mut [u8]`, which is Send.
unsafe impl Send for ImageMut<'_> {}

impl<'a> ImageMut<'a> {
    /// Errors: a layout out of its ranges, or a block too small or misaligned for it.
    pub fn new(layout: Layout, block: &'a mut [u8]) -> Result<Self> {
        Self::begin(Rows::of_block(layout, block.as_mut_ptr(), block.len()))
    }

    /// Errors: as `new`, or `pixels` NULL.
    ///
    /// # Safety
    /// `pixels` is the top-left pixel of a block of `byte_size` bytes, laid out as `layout` says; its rows (not the
    /// bytes between them) are readable and writable, and nobody else's, during `'a`.
    pub unsafe fn from_raw(layout: Layout, pixels: *mut u8, byte_size: u64) -> Result<Self> {
        Self::begin(Rows::new(layout, FirstRow::Top, pixels, byte_size))
    }

    /// An image with the bottom row first in memory: `BHR_IMAGE_BOTTOM_UP`. Errors: as `from_raw`, or a negative
    /// stride.
    ///
    /// # Safety
    /// The contract is that of `from_raw`, except that `pixels` is the bottom-left pixel, where the block begins.
    pub unsafe fn from_raw_bottom_up(layout: Layout, pixels: *mut u8, byte_size: u64) -> Result<Self> {
        Self::begin(Rows::new(layout, FirstRow::Bottom, pixels, byte_size))
    }

    fn begin(rows: Result<Rows>) -> Result<Self> {
        Ok(Self { rows: rows?, touched: false, copiers: None, memory: PhantomData })
    }

    pub fn width(&self) -> u32 {
        self.rows.width
    }

    pub fn height(&self) -> u32 {
        self.rows.height
    }

    pub fn format(&self) -> PixelFormat {
        self.rows.format
    }

    /// A tile has been written.
    pub fn is_touched(&self) -> bool {
        self.touched
    }

    /// Has large tiles written with others' help.
    pub fn write_with(&mut self, copiers: Arc<Copiers>) {
        self.copiers = Some(copiers);
    }

    /// The pixels of row `y`; empty past the last.
    pub fn row_mut(&mut self, y: u32) -> &mut [u8] {
        match self.rows.row(y) {
            // SAFETY: `Rows::new` saw that the block holds this row, and `&mut self` is alone with the image.
            Some(begin) => unsafe { std::slice::from_raw_parts_mut(begin, self.rows.row_bytes()) },
            None => &mut [],
        }
    }

    /// The address of the top-left pixel.
    pub fn address(&self) -> usize {
        self.rows.top_left.addr()
    }

    /// The image's pixels, for reading.
    pub fn as_image_ref(&self) -> ImageRef<'_> {
        ImageRef { rows: self.rows, memory: PhantomData }
    }

    /// Copies a `width` x `height` tile, whose rows lie `bytes_per_row` apart in `pixels`, to (x, y). Errors:
    /// INTERNAL for a tile that is not inside the image or not in `pixels`, which is a tracer's mistake; nothing is
    /// written then.
    pub fn write_tile(
        &mut self,
        x: u32,
        y: u32,
        width: u32,
        height: u32,
        pixels: &[u8],
        bytes_per_row: usize,
    ) -> Result<()> {
        let pixel = self.rows.format.bytes_per_pixel();
        let inside = |begin: u32, size: u32, full: u32| u64::from(begin) + u64::from(size) <= u64::from(full);
        let fits = inside(x, width, self.rows.width) && inside(y, height, self.rows.height);
        if width == 0 || height == 0 {
            return Ok(());
        }
        let row = width as usize * pixel;
        let needed = (height as usize - 1).checked_mul(bytes_per_row).and_then(|bytes| bytes.checked_add(row));
        if !fits || bytes_per_row < row || needed.is_none_or(|needed| pixels.len() < needed) {
            return Err(Error::internal(format!(
                "tile {width} x {height} at ({x}, {y}), {} bytes in rows of {bytes_per_row}, does not fit {} x {}",
                pixels.len(),
                self.rows.width,
                self.rows.height
            )));
        }
        self.touched = true;
        let left = x as usize * pixel;
        let copying = Copying { rows: self.rows, left, top: y, row_bytes: row, pixels, bytes_per_row };
        // SAFETY: `&mut self` is alone with the image, and `share` hands out each row once.
        let copy = |lines| unsafe { copying.write(lines) };
        match &self.copiers {
            Some(copiers) => copiers.share(height, row * height as usize, copy),
            None => copy(0..height),
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ErrorKind;
    use PixelFormat::*;

    fn layout(format: PixelFormat, width: u32, height: u32, row_stride: i64) -> Layout {
        Layout { format, width, height, row_stride }
    }

    #[test]
    fn tiles_fill_every_row_and_nothing_between() {
        for stride in [0i64, 8, 11, -8, -13] {
            let step = if stride == 0 { 8 } else { stride.unsigned_abs() as usize };
            let mut block = vec![0xee; 2 * step + 8];
            let mut image = ImageMut::new(layout(Rgba8Srgb, 2, 3, stride), &mut block).unwrap();
            for y in 0..3u8 {
                for x in 0..2u8 {
                    image.write_tile(x.into(), y.into(), 1, 1, &[10 * y + x; 4], 4).unwrap();
                }
            }
            let seen = image.as_image_ref();
            let wanted = |y: u8| [[10 * y; 4], [10 * y + 1; 4]].concat();
            for y in 0..3u8 {
                assert_eq!(seen.row(y.into()), wanted(y), "stride {stride}");
            }
            for y in 0..3u8 {
                let from_below = if stride < 0 { 2 - y } else { y } as usize;
                assert_eq!(block[from_below * step..][..8], wanted(y), "stride {stride}");
            }
            assert_eq!(block.iter().filter(|byte| **byte == 0xee).count(), 2 * (step - 8));
        }
    }

    #[test]
    fn pictures_whose_bottom_row_comes_first_begin_at_their_lowest_address() {
        for stride in [0i64, 8, 12] {
            let step = if stride == 0 { 8 } else { stride as usize };
            let mut block = vec![0xee; 2 * step + 8];
            let (begin, size) = (block.as_mut_ptr(), block.len() as u64);
            let l = layout(Rgba8Srgb, 2, 3, stride);
            // SAFETY: `begin` is a block of `size` bytes that nobody else uses meanwhile.
            let mut image = unsafe { ImageMut::from_raw_bottom_up(l, begin, size) }.unwrap();
            for y in 0..3u8 {
                image.write_tile(0, y.into(), 2, 1, &[y; 8], 8).unwrap();
                assert_eq!(image.as_image_ref().row(y.into()), [y; 8], "stride {stride}");
            }
            assert_eq!([0, step, 2 * step].map(|at| block[at..at + 8] == [block[at]; 8]), [true; 3]);
            assert_eq!([block[0], block[step], block[2 * step]], [2, 1, 0], "stride {stride}");
            assert_eq!(block.iter().filter(|byte| **byte == 0xee).count(), 2 * (step - 8));
        }
        // SAFETY: refused, or never written to.
        let raw = |stride, address: usize, size| unsafe {
            let pixels = std::ptr::without_provenance_mut(address);
            ImageMut::from_raw_bottom_up(layout(Rgba32F, 1, 2, stride), pixels, size).map(|_| ())
        };
        for (stride, address, size, word) in [
            (-16, 1024, 32, "row_stride is -16"),
            (16, 1024, 31, "byte_size is 31"),
            (0, 0, 32, "NULL"),
            (0, 1026, 32, "0x402"),
            (0, usize::MAX - 27, 32, "address space"),
        ] {
            let error = raw(stride, address, size).err().unwrap();
            assert!(error.message.contains(word), "{error}");
        }
        raw(0, 8, 32).unwrap();
    }

    #[test]
    fn a_tile_with_padded_rows_is_copied_row_by_row() {
        let mut block = [0u8; 4 * 4 * 4];
        let mut image = ImageMut::new(Layout::packed(Bgra8Srgb, 4, 4), &mut block).unwrap();
        let tile: Vec<u8> = (0..28).collect();
        image.write_tile(1, 2, 2, 2, &tile, 20).unwrap();
        assert_eq!(image.as_image_ref().row(2)[4..12], tile[..8]);
        assert_eq!(image.as_image_ref().row(3)[4..12], tile[20..28]);
        assert_eq!(block.iter().filter(|byte| **byte != 0).count(), 15);
    }

    #[test]
    fn threads_that_share_a_tile_write_what_one_writes() {
        let (width, height) = (700, 500);
        let tile = (0..width * height).flat_map(|i: u32| i.wrapping_mul(2654435761).to_le_bytes()).collect::<Vec<u8>>();
        let row = width as usize * 4;
        for stride in [0, row as i64, row as i64 + 12, -(row as i64), -(row as i64) - 4] {
            // The whole tile, and one that is narrower than the image and has padded rows.
            for (x, w) in [(0, width), (3, width - 10)] {
                let written = |threads: usize| {
                    let mut block = vec![0xee; (row + 12) * height as usize];
                    let mut image = ImageMut::new(layout(Rgba8Srgb, width, height, stride), &mut block).unwrap();
                    image.write_with(Arc::new(Copiers::new(threads)));
                    image.write_tile(x, 0, w, height, &tile, row).unwrap();
                    assert_eq!(image.as_image_ref().row(499)[x as usize * 4..][..8], tile[499 * row..][..8]);
                    block
                };
                assert!(written(1) == written(3), "stride {stride}, width {w}");
            }
        }
    }

    #[test]
    fn a_tile_outside_the_image_writes_nothing() {
        let mut block = [7u8; 16];
        let mut image = ImageMut::new(Layout::packed(R32F, 2, 2), &mut block).unwrap();
        let tile = [0u8; 64];
        for (x, y, w, h, row) in
            [(1, 0, 2, 1, 8), (0, 2, 1, 1, 4), (u32::MAX, 0, 2, 1, 8), (0, 0, 2, 2, 7), (0, 0, 2, 2, 60)]
        {
            let error = image.write_tile(x, y, w, h, &tile, row).unwrap_err();
            assert_eq!(error.kind, ErrorKind::Internal);
        }
        image.write_tile(2, 2, 0, 0, &[], 0).unwrap();
        assert!(!image.is_touched());
        assert_eq!(block, [7; 16]);
    }

    #[test]
    fn the_block_may_be_exactly_as_large_as_needed_and_no_smaller() {
        for (format, stride) in [(Rgba16F, 0), (Rgba16F, 26), (Rgba32F, -48), (Rgba32F, 64)] {
            let l = layout(format, 3, 2, stride);
            let (needed, _) = l.check().unwrap();
            let mut words = vec![0u32; 64];
            let block: &mut [u8] = bytemuck::cast_slice_mut(&mut words);
            ImageMut::new(l, &mut block[..needed]).unwrap();
            let error = ImageMut::new(l, &mut block[..needed - 1]).err().unwrap();
            assert!(error.message.contains(&needed.to_string()), "{error}");
        }
    }

    #[test]
    fn impossible_layouts_are_refused() {
        let bad = [
            layout(Rgba8Srgb, 0, 1, 0),
            layout(Rgba8Srgb, 1, 0, 0),
            layout(Rgba8Srgb, MAX_SIDE + 1, 1, 0),
            layout(Rgba8Srgb, 1, u32::MAX, 0),
            layout(Rgba8Srgb, 4, 4, 15),
            layout(Rgba8Srgb, 4, 4, -15),
            layout(Rgba16F, 4, 4, 33),
            layout(R32F, 4, 4, 18),
            layout(Rgba8Srgb, 4, 4, i64::MIN),
            layout(Rgba8Srgb, 4, 4, i64::MAX),
        ];
        for l in bad {
            let error = l.check().unwrap_err();
            assert_eq!(error.kind, ErrorKind::InvalidArgument, "{l:?}");
        }
    }

    #[test]
    fn misaligned_null_and_impossible_pixels_are_refused() {
        let l = layout(Rgba32F, 1, 2, -16);
        let raw = |address: usize| {
            // SAFETY: refused, or never written to.
            unsafe { ImageMut::from_raw(l, std::ptr::without_provenance_mut(address), 32) }
        };
        for (address, word) in
            [(0, "NULL"), (1026, "multiple of 4"), (8, "address space"), (usize::MAX - 3, "address space")]
        {
            let error = raw(address).err().unwrap();
            assert!(error.message.contains(word), "{error}");
        }
        assert!(raw(1024).is_ok());
    }
}
