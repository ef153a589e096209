// SPDX-License-Identifier: MIT OR Apache-2.0
//! Structs that may grow: they begin with `struct_size`, the size the host was compiled with. The rule in the header's
//! preface is implemented here, and nowhere else. Structs are copied in and out; no reference into the host's memory is
//! ever made.

use super::pointer::is_null;
use crate::error::{Error, Result};
use std::fmt::Display;
use std::mem::size_of;

/// Larger than any struct will ever be: a greater `struct_size` is memory that nobody initialised.
const MAX_SIZE: usize = 16 * 1024;

/// A struct of the header that begins with `uint32_t struct_size`.
///
/// # Safety
/// `repr(C)`, its first field is `struct_size: u32`, it has no padding but that of [`pointers_before_u64`], and every
/// bit pattern is a value of it.
pub(super) unsafe trait Versioned: Copy {
    /// The struct's name in the header.
    const NAME: &'static str;
    /// Its size in the first release that had it, then its size in each later release in which it had grown; the last
    /// one is today's. Numbers, not `size_of`: hosts compiled back then go on saying them. Append only.
    const SIZES: &'static [usize];
    /// The values that `*_init` fills in.
    fn defaults() -> Self;
    /// The defaults for a host whose struct has `size` bytes: what the header of its release documented, and, in fields
    /// that the host lacks, what the library did when it lacked them. A release that gives a field another default, or
    /// adds one whose default does something new, says here what those before it had.
    fn defaults_of(_size: usize) -> Self {
        Self::defaults()
    }
}

/// Bytes of a pointer in a struct: the part of [`Versioned::SIZES`] that is not the same on every platform.
pub(super) const POINTER: usize = size_of::<*const ()>();

/// Bytes of so many pointers before a number of 64 bits, which begins where it is aligned: pointers of 32 bits may have
/// padding behind them.
pub(super) const fn pointers_before_u64(count: usize) -> usize {
    (count * POINTER).next_multiple_of(align_of::<u64>())
}

/// The size of the first release, with `SIZES` checked: a struct that has grown without a new entry there, or has
/// shrunk, does not compile.
const fn first_size<T: Versioned>() -> usize {
    let sizes = T::SIZES;
    assert!(!sizes.is_empty() && sizes[0] >= size_of::<u32>(), "a struct has its first release's size");
    assert!(
        sizes[sizes.len() - 1] == size_of::<T>(),
        "the last of SIZES is today's size; a struct that grows appends it"
    );
    let mut i = 1;
    while i < sizes.len() {
        assert!(sizes[i - 1] < sizes[i], "structs only grow");
        i += 1;
    }
    sizes[0]
}

pub(super) fn check_size<T: Versioned>(size: usize, name: &str) -> Result<usize> {
    // Without allocating: there may be no memory left, and nothing may be wrong.
    check_named_size::<T>(size, format_args!("{name} struct_size"))
}

/// Checks a size whose whole name is `name`.
pub(super) fn check_named_size<T: Versioned>(size: usize, name: impl Display) -> Result<usize> {
    let first = const { first_size::<T>() };
    if size < first {
        return Err(Error::argument(format!("{name} is {size}; it must be sizeof({}), at least {first}", T::NAME)));
    }
    if size > MAX_SIZE {
        return Err(Error::argument(format!(
            "{name} is {size}, more than any struct has ({MAX_SIZE}): was it initialised?"
        )));
    }
    Ok(size)
}

/// The checked `struct_size` in the host's struct.
///
/// # Safety
/// `pointer` is NULL or points to a struct whose `struct_size` is readable.
pub(super) unsafe fn caller_size<T: Versioned>(pointer: *const T, name: &str) -> Result<usize> {
    if pointer.is_null() {
        return Err(is_null(name));
    }
    // SAFETY: `struct_size` is the first field of every `Versioned`.
    let size = unsafe { pointer.cast::<u32>().read_unaligned() };
    check_size::<T>(size as usize, name)
}

/// Reads the host's struct: fields that a shorter one lacks have what `defaults_of` says, bytes of a longer one beyond
/// ours must be zero.
///
/// # Safety
/// `pointer` is NULL or points to `struct_size` readable bytes.
pub(super) unsafe fn read<T: Versioned>(pointer: *const T, name: &str) -> Result<T> {
    // SAFETY: this function's contract.
    let size = unsafe { caller_size(pointer, name) }?;
    let mut value = T::defaults_of(size);
    let known = size.min(size_of::<T>());
    // SAFETY: `known` bytes are readable at `pointer` and writable at `value`; any bytes are a `T`.
    unsafe { std::ptr::copy_nonoverlapping(pointer.cast::<u8>(), (&raw mut value).cast::<u8>(), known) };
    for offset in known..size {
        // SAFETY: `offset < struct_size`.
        if unsafe { pointer.cast::<u8>().add(offset).read() } != 0 {
            return Err(Error::argument(format!(
                "{name} struct_size is {size} and byte {offset} is not 0; this library knows {known} bytes of {}",
                T::NAME
            )));
        }
    }
    Ok(value)
}

/// Fills the host's struct: its `struct_size` stays, its bytes beyond ours become zero.
///
/// # Safety
/// `pointer` is NULL or points to `struct_size` writable bytes.
pub(super) unsafe fn write<T: Versioned>(pointer: *mut T, name: &str, value: &T) -> Result<()> {
    // SAFETY: this function's contract.
    let size = unsafe { caller_size(pointer, name) }?;
    // SAFETY: as above.
    unsafe { fill(pointer, size, value) };
    Ok(())
}

/// A struct that a call fills: cleared when it is taken, but for `struct_size`, so that every failure leaves it so.
pub(super) struct OutStruct<T> {
    pointer: *mut T,
    size: Result<usize>,
}

impl<T: Versioned> OutStruct<T> {
    /// # Safety
    /// `pointer` is NULL or points to `struct_size` writable bytes until the entry point returns.
    pub(super) unsafe fn cleared(pointer: *mut T, name: &str) -> Self {
        // SAFETY: this function's contract.
        let size = unsafe { caller_size(pointer, name) };
        if let Ok(size) = size {
            // SAFETY: as above; the first four bytes, `struct_size`, stay.
            unsafe { pointer.cast::<u8>().add(4).write_bytes(0, size - 4) };
        }
        Self { pointer, size }
    }

    /// Errors: INVALID_ARGUMENT when the host passed NULL or a wrong `struct_size`.
    pub(super) fn set(&self, value: &T) -> Result<()> {
        let size = self.size.clone()?;
        // SAFETY: `size` writable bytes by the contract of `cleared`.
        unsafe { fill(self.pointer, size, value) };
        Ok(())
    }

    /// Sets the values of `*_init`.
    pub(super) fn set_defaults(&self) -> Result<()> {
        self.set(&T::defaults_of(self.size.clone()?))
    }
}

/// `*_init`: clears `size` bytes and fills in the defaults.
///
/// # Safety
/// `pointer` is NULL or points to `size` writable bytes.
pub(super) unsafe fn init<T: Versioned>(pointer: *mut T, name: &str, size: usize) -> Result<()> {
    if pointer.is_null() {
        return Err(is_null(name));
    }
    let size = check_size::<T>(size, name)?;
    // SAFETY: this function's contract.
    unsafe { fill(pointer, size, &T::defaults_of(size)) };
    Ok(())
}

/// Fills `size` bytes of the host's, `struct_size` among them.
///
/// # Safety
/// `pointer` points to `size` writable bytes; `size` went through `check_size`.
pub(super) unsafe fn fill<T: Versioned>(pointer: *mut T, size: usize, value: &T) {
    let known = size.min(size_of::<T>());
    // SAFETY: `known <= size` writable bytes, and as many readable ones in `value`; `size` fits a u32 by MAX_SIZE.
    unsafe {
        std::ptr::copy_nonoverlapping((&raw const *value).cast::<u8>(), pointer.cast::<u8>(), known);
        pointer.cast::<u8>().add(known).write_bytes(0, size - known);
        pointer.cast::<u32>().write_unaligned(size as u32);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ErrorKind;

    /// A struct that had 12 bytes, with 6 and 8 for defaults, and has grown to 16.
    #[repr(C)]
    #[derive(Clone, Copy, Debug, PartialEq)]
    struct Grown {
        struct_size: u32,
        old: [u32; 2],
        new: u32,
    }

    // SAFETY: repr(C), only u32, size first.
    unsafe impl Versioned for Grown {
        const NAME: &'static str = "Grown";
        const SIZES: &'static [usize] = &[12, 16];
        fn defaults() -> Self {
            Self { struct_size: 0, old: [7, 8], new: 9 }
        }
        fn defaults_of(size: usize) -> Self {
            if size < 16 { Self { struct_size: 0, old: [6, 8], new: 5 } } else { Self::defaults() }
        }
    }

    fn read_words(words: &[u32]) -> Result<Grown> {
        // SAFETY: tests state a size within `words`, or one that is refused before anything else is read.
        unsafe { read(words.as_ptr().cast(), "grown") }
    }

    #[test]
    fn an_old_struct_means_what_it_meant() {
        assert_eq!(read_words(&[12, 1, 2, 77]).unwrap(), Grown { struct_size: 12, old: [1, 2], new: 5 });
        let mut words = [12, 9, 9, 9];
        // SAFETY: 12 bytes are there.
        unsafe { init(words.as_mut_ptr().cast::<Grown>(), "grown", 12) }.unwrap();
        assert_eq!(words, [12, 6, 8, 9]);
        // SAFETY: as above.
        let out = unsafe { OutStruct::cleared(words.as_mut_ptr().cast::<Grown>(), "grown") };
        out.set_defaults().unwrap();
        assert_eq!(words, [12, 6, 8, 9]);
    }

    #[test]
    fn a_newer_caller_may_not_set_what_this_library_lacks() {
        assert_eq!(read_words(&[24, 1, 2, 3, 0, 0]).unwrap().new, 3);
        let error = read_words(&[24, 1, 2, 3, 0, 1 << 24]).unwrap_err();
        assert_eq!(error.kind, ErrorKind::InvalidArgument);
        assert!(error.message.contains("byte 23") || cfg!(target_endian = "big"), "{error}");
    }

    #[test]
    fn sizes_below_the_first_version_and_garbage_are_refused() {
        for size in [0, 4, 11, 16 * 1024 + 1, u32::MAX] {
            let error = read_words(&[size, 1, 2, 3]).unwrap_err();
            assert!(error.message.contains(&size.to_string()), "{error}");
        }
    }

    #[test]
    fn writing_keeps_the_size_and_clears_the_tail() {
        let value = Grown { struct_size: 0, old: [1, 2], new: 3 };
        let mut words = [24, 9, 9, 9, 9, 9, 9];
        // SAFETY: 24 bytes are there.
        unsafe { write(words.as_mut_ptr().cast::<Grown>(), "grown", &value) }.unwrap();
        assert_eq!(words, [24, 1, 2, 3, 0, 0, 9]);
        let mut words = [12, 9, 9, 9];
        // SAFETY: 12 bytes are there.
        let out = unsafe { OutStruct::cleared(words.as_mut_ptr().cast::<Grown>(), "grown") };
        assert_eq!(words, [12, 0, 0, 9]);
        out.set(&value).unwrap();
        assert_eq!(words, [12, 1, 2, 9]);
    }

    #[test]
    fn init_clears_and_fills() {
        let mut words = [9u32; 7];
        // SAFETY: 24 bytes are there.
        unsafe { init(words.as_mut_ptr().cast::<Grown>(), "grown", 24) }.unwrap();
        assert_eq!(words, [24, 7, 8, 9, 0, 0, 9]);
        // SAFETY: refused before anything is written.
        assert!(unsafe { init(words.as_mut_ptr().cast::<Grown>(), "grown", usize::MAX) }.is_err());
    }

    /// Stands for a real struct that has grown, in a later release, by fields whose defaults are not 0.
    #[repr(C)]
    #[derive(Clone, Copy)]
    struct Later<T> {
        known: T,
        added: [u32; 2],
    }

    const ADDED: [u32; 2] = [0x0102_0304, 0x0506_0708];

    // SAFETY: as `T`, whose size is a multiple of 4, with u32 after it.
    unsafe impl<T: Versioned> Versioned for Later<T> {
        const NAME: &'static str = T::NAME;
        const SIZES: &'static [usize] = &[T::SIZES[0], size_of::<Self>()];
        fn defaults() -> Self {
            Self { known: T::defaults(), added: ADDED }
        }
        fn defaults_of(size: usize) -> Self {
            Self { known: T::defaults_of(size), added: ADDED }
        }
    }

    fn bytes_of<T: Versioned>(value: &T) -> &[u8] {
        // SAFETY: no padding, by the contract of `Versioned`.
        unsafe { std::slice::from_raw_parts((&raw const *value).cast(), size_of::<T>()) }
    }

    /// A host compiled against the first release meets a library in which `T` has grown.
    fn hosts_of_the_first_release_go_on<T: Versioned>() {
        let (first, full) = (T::SIZES[0], size_of::<Later<T>>());
        assert!(full > first && align_of::<T>() <= align_of::<u64>());
        for size in first..=full {
            let defaults = Later::<T>::defaults_of(size);
            // The 8 bytes behind the host's struct belong to somebody else.
            let mut words = vec![u64::from_ne_bytes([0xa5; 8]); (full + 8).div_ceil(8)];
            let pointer = words.as_mut_ptr().cast::<Later<T>>();
            let host = || {
                // SAFETY: so many bytes are there.
                unsafe { std::slice::from_raw_parts(pointer.cast::<u8>(), full + 8) }.to_vec()
            };
            let is_default = |bytes: &[u8]| {
                bytes[..4] == (size as u32).to_ne_bytes()
                    && bytes[4..size] == bytes_of(&defaults)[4..size]
                    && bytes[size..].iter().all(|byte| *byte == 0xa5)
            };
            // SAFETY: `size` bytes are there, as in the rest of this function.
            unsafe { init(pointer, "struct", size) }.unwrap();
            assert!(is_default(&host()), "{}: init at {size}", T::NAME);
            // SAFETY: as above.
            let value = unsafe { read(pointer, "struct") }.unwrap();
            assert!(bytes_of(&value)[4..] == bytes_of(&defaults)[4..], "{}: read at {size}", T::NAME);
            // SAFETY: as above.
            let out = unsafe { OutStruct::cleared(pointer, "struct") };
            let cleared = host();
            assert!(cleared[4..size].iter().all(|byte| *byte == 0), "{}: cleared at {size}", T::NAME);
            assert!(cleared[size..].iter().all(|byte| *byte == 0xa5), "{}: cleared at {size}", T::NAME);
            out.set(&defaults).unwrap();
            assert!(is_default(&host()), "{}: filled at {size}", T::NAME);
            // SAFETY: as above.
            unsafe { write(pointer, "struct", &defaults) }.unwrap();
            assert!(is_default(&host()), "{}: written at {size}", T::NAME);
        }
        let mut small = [first as u32 - 1; 2];
        // SAFETY: refused before anything but the size is read.
        let error = unsafe { read(small.as_mut_ptr().cast::<Later<T>>(), "struct") }.err().unwrap();
        assert!(error.message.ends_with(&format!("sizeof({}), at least {first}", T::NAME)), "{error}");
    }

    #[test]
    fn every_struct_may_grow_under_hosts_of_the_first_release() {
        hosts_of_the_first_release_go_on::<crate::capi::adapter::BhrAdapterInfo>();
        hosts_of_the_first_release_go_on::<crate::capi::body::BhrBody>();
        hosts_of_the_first_release_go_on::<crate::capi::camera::BhrCamera>();
        hosts_of_the_first_release_go_on::<crate::capi::context::BhrContextOptions>();
        hosts_of_the_first_release_go_on::<crate::capi::disk::BhrDisk>();
        hosts_of_the_first_release_go_on::<crate::capi::film::BhrFilm>();
        hosts_of_the_first_release_go_on::<crate::capi::hole::BhrHoleInfo>();
        hosts_of_the_first_release_go_on::<crate::capi::image::BhrImage>();
        hosts_of_the_first_release_go_on::<crate::capi::preset::BhrPresetOptions>();
        hosts_of_the_first_release_go_on::<crate::capi::project::BhrProjectedPoint>();
        hosts_of_the_first_release_go_on::<crate::capi::quality::BhrQuality>();
        hosts_of_the_first_release_go_on::<crate::capi::region::BhrRegion>();
        hosts_of_the_first_release_go_on::<crate::capi::sky::BhrSky>();
        hosts_of_the_first_release_go_on::<crate::capi::stats::BhrFrameStats>();
        hosts_of_the_first_release_go_on::<crate::capi::volume::BhrHotSpot>();
        hosts_of_the_first_release_go_on::<crate::capi::volume::BhrVolume>();
        hosts_of_the_first_release_go_on::<crate::capi::window::BhrWindow>();
    }

    #[test]
    fn misaligned_structs_are_read_and_written() {
        let mut bytes = [0u8; 17];
        let pointer = bytes.as_mut_ptr().wrapping_add(1).cast::<Grown>();
        // SAFETY: 16 bytes follow the odd address.
        let value = unsafe {
            init(pointer, "grown", 16).unwrap();
            read(pointer, "grown").unwrap()
        };
        assert_eq!(value, Grown { struct_size: 16, ..Grown::defaults() });
    }
}
