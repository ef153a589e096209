// SPDX-License-Identifier: MIT OR Apache-2.0
//! Buffers of rows that are larger than what a kernel binds at once: the rows are taken in bands, or a whole buffer in
//! parts. Plain numbers.

use crate::gpu::device::wgpu_device::Device;
use std::num::NonZeroU64;
use std::ops::Range;

/// The limits of a device.
#[derive(Clone, Copy, Debug)]
pub struct Reach {
    /// Bytes of a binding.
    pub largest: u64,
    /// A binding begins at a multiple of it.
    pub alignment: u64,
}

impl Reach {
    pub fn of(device: &Device) -> Self {
        let limits = device.limits();
        let alignment = limits.min_storage_buffer_offset_alignment.into();
        Self { largest: limits.max_storage_buffer_binding_size, alignment }
    }
}

/// Rows in a buffer.
#[derive(Clone, Copy, Debug)]
pub struct Rows {
    pub count: u32,
    /// Bytes from row to row, a multiple of 4.
    pub stride: u64,
    /// Bytes of a row itself, a multiple of 4. The last row may end where the buffer does.
    pub row: u64,
}

/// The part of a buffer that is bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    pub offset: u64,
    pub size: u64,
}

impl Window {
    /// Words before it.
    pub fn begin(&self) -> u32 {
        (self.offset / 4) as u32
    }

    /// The whole buffer of so many bytes, if that begins alike and can be bound.
    pub fn widest(self, bytes: u64, reach: &Reach) -> Self {
        if self.offset == 0 && bytes <= reach.largest { Self { size: bytes, ..self } } else { self }
    }

    pub fn binding<'a>(&self, buffer: &'a wgpu::Buffer) -> wgpu::BindingResource<'a> {
        let size = NonZeroU64::new(self.size);
        wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer, offset: self.offset, size })
    }
}

impl Rows {
    /// The binding that holds some of them, from the first byte of the first to the last byte of the last; `None`: no
    /// binding does, or there are none.
    pub fn window(&self, rows: Range<u32>, reach: &Reach) -> Option<Window> {
        let begin = u64::from(rows.start) * self.stride;
        let offset = begin - begin % reach.alignment.max(1);
        let last = rows.end.checked_sub(1).filter(|last| *last >= rows.start)?;
        let size = u64::from(last) * self.stride + self.row - offset;
        (size <= reach.largest).then_some(Window { offset, size })
    }

    /// All of them in parts of equal numbers of rows, but for the last, each of which begins where a binding may: the
    /// number, and the parts. `None`: not in so few.
    pub fn parts(&self, most: usize, reach: &Reach) -> Option<(u32, Vec<Window>)> {
        // Rows begin at multiples of the alignment once in so many.
        let even = reach.alignment.max(1) / common_divisor(reach.alignment.max(1), self.stride);
        // Behind the last row no other one follows.
        let held = 1 + reach.largest.checked_sub(self.row)? / self.stride.max(1);
        if u64::from(self.count) <= held && most > 0 {
            return Some((self.count, vec![self.window(0..self.count, reach)?]));
        }
        let rows = (held / even * even).min(u64::from(self.count).next_multiple_of(even));
        let rows = u32::try_from(rows).ok().filter(|rows| *rows > 0)?;
        let count = self.count.div_ceil(rows);
        if count as usize > most {
            return None;
        }
        let part = |i: u32| self.window(i * rows..((i + 1) * rows).min(self.count), reach);
        Some((rows, (0..count).map(part).collect::<Option<_>>()?))
    }
}

/// The greatest common divisor, by Euclid; of 0 and a number that number.
fn common_divisor(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { common_divisor(b, a % b) }
}

/// Rows that one dispatch makes, and what it binds for that.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Band {
    pub rows: Range<u32>,
    pub from: Window,
    pub to: Window,
}

/// All rows of `to` in as few bands as bindings allow, of which each reads those of `from` that `sources` says. `None`:
/// there is a row that takes more than a binding.
pub fn bands(from: &Rows, to: &Rows, sources: impl Fn(&Range<u32>) -> Range<u32>, reach: &Reach) -> Option<Vec<Band>> {
    let band = |rows: Range<u32>| {
        let (from, to) = (from.window(sources(&rows), reach)?, to.window(rows.clone(), reach)?);
        Some(Band { rows, from, to })
    };
    let mut height = to.count.max(1);
    loop {
        let begins = (0..to.count).step_by(height as usize);
        let found = begins.map(|y| band(y..y.saturating_add(height).min(to.count))).collect::<Option<_>>();
        if found.is_some() || height == 1 {
            return found;
        }
        height = height.div_ceil(2);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const REACH: Reach = Reach { largest: 10_000, alignment: 256 };

    #[test]
    fn bands_hold_what_they_read_and_write() {
        for (count, stride, made) in [(40, 512, 20), (40, 1004, 40), (33, 2052, 16), (7, 3000, 3), (1, 9000, 1)] {
            let from = Rows { count, stride, row: 500 };
            let to = Rows { count: made, stride: 512, row: 508 };
            let sources = |rows: &Range<u32>| rows.start * count / made..(rows.end * count).div_ceil(made).min(count);
            let found = bands(&from, &to, sources, &REACH).unwrap();
            let mut next = 0;
            for Band { rows, from: source, to: place } in &found {
                assert_eq!(rows.start, next);
                next = rows.end;
                let read = sources(rows);
                assert!(source.offset <= u64::from(read.start) * stride && source.offset % 256 == 0);
                assert_eq!(source.offset + source.size, u64::from(read.end - 1) * stride + 500);
                assert!(place.offset <= u64::from(rows.start) * 512);
                assert_eq!(place.offset + place.size, u64::from(rows.end - 1) * 512 + 508);
                assert!(source.size <= REACH.largest && place.size <= REACH.largest);
            }
            assert_eq!(next, made);
        }
        let wide = Rows { count: 2, stride: 10_004, row: 10_004 };
        assert_eq!(bands(&wide, &wide, Range::clone, &REACH), None);
    }

    #[test]
    fn rows_far_apart_are_bound_one_by_one() {
        let far = Rows { count: 3, stride: 1_000_004, row: 9_000 };
        let found = bands(&far, &far, Range::clone, &REACH).unwrap();
        let offsets = found.iter().map(|band| (band.rows.clone(), band.from.offset, band.from.size));
        let expected = [(0..1, 0, 9_000), (1..2, 999_936, 9_068), (2..3, 1_999_872, 9_136)];
        assert!(offsets.eq(expected), "{found:?}");
        assert_eq!(far.window(1..1, &REACH), None);
        assert_eq!(far.window(0..0, &REACH), None);
    }

    #[test]
    fn parts_hold_every_row() {
        let reach = Reach { largest: 1 << 17, alignment: 256 };
        for (count, stride, row) in
            [(1000, 516, 512), (64, 2048, 2048), (130, 2044, 2000), (1, 4, 4), (6, 1 << 20, 800)]
        {
            let rows = Rows { count, stride, row };
            let (height, parts) = rows.parts(6, &reach).unwrap();
            assert!(parts.len() <= 6 && parts.len() as u32 == count.div_ceil(height));
            for (i, part) in (0_u64..).zip(&parts) {
                assert_eq!(part.offset, i * u64::from(height) * stride);
                let end = ((i + 1) * u64::from(height)).min(count.into());
                assert_eq!(part.offset + part.size, (end - 1) * stride + row);
                assert!(part.size <= reach.largest && part.offset % 256 == 0);
            }
        }
        // One part that has room for all, though no second one could begin where a binding may.
        let all =
            Rows { count: 2, stride: 65_532, row: 65_532 }.parts(6, &reach).map(|(rows, parts)| (rows, parts.len()));
        assert_eq!(all, Some((2, 1)));
        assert!(Rows { count: 1000, stride: 1024, row: 1024 }.parts(6, &reach).is_none());
        // A row that is larger than a binding, and rows of which no second one begins where a binding may.
        assert!(Rows { count: 1, stride: 1 << 18, row: (1 << 17) + 4 }.parts(6, &reach).is_none());
        assert!(Rows { count: 4, stride: 65_532, row: 65_532 }.parts(6, &reach).is_none());
    }

    #[test]
    fn parts_take_as_many_rows_as_begin_where_bindings_may() {
        let reach = Reach { largest: 1 << 17, alignment: 256 };
        // Rows of 2^14 - 64 bytes begin at multiples of 256 once in four.
        let (height, parts) = Rows { count: 24, stride: (1 << 14) - 64, row: (1 << 14) - 64 }.parts(6, &reach).unwrap();
        assert_eq!((height, parts.len()), (8, 3));
        // Eight rows fit, since behind the eighth no bytes count.
        let (height, _) = Rows { count: 16, stride: 18_432, row: 100 }.parts(6, &reach).unwrap();
        assert_eq!(height, 8);
    }
}
