// SPDX-License-Identifier: MIT OR Apache-2.0
//! Fields of the API's structs by name, as data: what scene files and the attributes of saved outputs are read and
//! written by. `field_list`, made from the structs themselves, has them. Knows no struct, no file and no scene.

use arrayvec::ArrayVec;
use std::mem::size_of;

/// The most numbers of a field: an orientation's.
pub(super) const MOST_NUMBERS: usize = 4;

/// Words with what each stands for, in lower case: the ends of the names of constants.
pub(super) type Words<T> = &'static [(&'static str, T)];

/// The kinds of values that fields hold.
#[derive(Clone, Copy, Debug)]
pub(super) enum Kind {
    /// So many doubles: a number, or a vector.
    Numbers(usize),
    /// A double that is an angle, in radians.
    Angle,
    /// One constant of an enumeration.
    Word(Words<i32>),
    /// Any of some bits, in 32.
    Bits(Words<u32>),
    /// An integer of 32 bits without a sign.
    Count,
    /// An integer of 64 bits without a sign.
    Seed,
}

/// A field of a struct of the header: its name there, and where it lies.
#[derive(Debug)]
pub(super) struct Field {
    pub name: &'static str,
    pub offset: usize,
    pub kind: Kind,
}

/// A field's value.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Numbers(ArrayVec<f64, MOST_NUMBERS>),
    Word(i32),
    Bits(u32),
    Count(u32),
    Seed(u64),
}

/// A struct with a list of its fields, but for `struct_size` and those that are reserved.
///
/// # Safety
/// As `Versioned`: `repr(C)`, without padding, and every bit pattern is a value of it. The list's offsets are those of
/// fields of the kinds that it says.
pub(super) unsafe trait Described: Copy {
    const FIELDS: &'static [Field];
}

/// The bytes of a struct.
pub(super) fn bytes_of<T: Described>(value: &T) -> &[u8] {
    // SAFETY: without padding, by the contract of `Described`.
    unsafe { std::slice::from_raw_parts((&raw const *value).cast(), size_of::<T>()) }
}

/// The bytes of a struct, to be changed.
pub(super) fn bytes_of_mut<T: Described>(value: &mut T) -> &mut [u8] {
    // SAFETY: as above, and any bytes are a value.
    unsafe { std::slice::from_raw_parts_mut((&raw mut *value).cast(), size_of::<T>()) }
}

impl Kind {
    /// Whether there are values between any two of it.
    pub(super) fn is_continuous(self) -> bool {
        matches!(self, Self::Numbers(_) | Self::Angle)
    }

    fn size(self) -> usize {
        match self {
            Self::Numbers(count) => 8 * count,
            Self::Angle | Self::Seed => 8,
            Self::Word(_) | Self::Bits(_) | Self::Count => 4,
        }
    }
}

impl Field {
    /// The field's value in a struct's bytes. Bytes that end before it, which no struct's do, give zeros.
    pub(super) fn get(&self, bytes: &[u8]) -> Value {
        let four = || u32::from_ne_bytes(part(bytes, self.offset));
        match self.kind {
            Kind::Numbers(count) => Value::Numbers((0..count).map(|i| number(bytes, self.offset + 8 * i)).collect()),
            Kind::Angle => Value::Numbers(std::iter::once(number(bytes, self.offset)).collect()),
            Kind::Word(_) => Value::Word(four() as i32),
            Kind::Bits(_) => Value::Bits(four()),
            Kind::Count => Value::Count(four()),
            Kind::Seed => Value::Seed(u64::from_ne_bytes(part(bytes, self.offset))),
        }
    }

    /// Puts a value of the field's kind into a struct's bytes.
    pub(super) fn set(&self, bytes: &mut [u8], value: &Value) {
        let Some(place) = bytes.get_mut(self.offset..self.offset + self.kind.size()) else { return };
        match value {
            Value::Numbers(numbers) => {
                for (place, number) in place.chunks_exact_mut(8).zip(numbers) {
                    place.copy_from_slice(&number.to_ne_bytes());
                }
            }
            Value::Word(word) if place.len() == 4 => place.copy_from_slice(&word.to_ne_bytes()),
            Value::Bits(four) | Value::Count(four) if place.len() == 4 => place.copy_from_slice(&four.to_ne_bytes()),
            Value::Seed(seed) if place.len() == 8 => place.copy_from_slice(&seed.to_ne_bytes()),
            _ => {}
        }
    }
}

fn part<const N: usize>(bytes: &[u8], offset: usize) -> [u8; N] {
    bytes.get(offset..offset + N).and_then(|part| part.try_into().ok()).unwrap_or([0; N])
}

fn number(bytes: &[u8], offset: usize) -> f64 {
    f64::from_ne_bytes(part(bytes, offset))
}

/// The words of some bits, and the rest that has no word. A word for several bits comes before those for each.
pub(super) fn words_of(bits: u32, words: Words<u32>) -> (Vec<&'static str>, u32) {
    let mut order = words.to_vec();
    order.sort_by_key(|(_, of)| std::cmp::Reverse(of.count_ones()));
    let (mut rest, mut found) = (bits, Vec::new());
    for (word, of) in order {
        if of != 0 && rest & of == of {
            found.push(word);
            rest &= !of;
        }
    }
    (found, rest)
}

/// The word for a value of an enumeration.
pub(super) fn word_of(value: i32, words: Words<i32>) -> Option<&'static str> {
    words.iter().find(|(_, of)| *of == value).map(|(word, _)| *word)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capi::versioned::Versioned;
    use crate::capi::volume::BhrVolume;

    #[test]
    fn fields_are_read_and_set_where_they_lie() {
        let mut volume = BhrVolume::defaults();
        let field = |name: &str| BhrVolume::FIELDS.iter().find(|field| field.name == name).unwrap();
        let bytes = bytes_of_mut(&mut volume);
        field("tint").set(bytes, &Value::Numbers([0.1, 0.2, 0.3].into_iter().collect()));
        field("seed").set(bytes, &Value::Seed(u64::MAX));
        field("shape").set(bytes, &Value::Word(2));
        field("flags").set(bytes, &Value::Bits(3));
        assert_eq!((volume.tint, volume.seed, volume.shape, volume.flags), ([0.1, 0.2, 0.3], u64::MAX, 2, 3));
        assert_eq!(field("slope").get(bytes_of(&volume)), Value::Numbers(std::iter::once(volume.slope).collect()));
        // A value of another kind changes nothing.
        field("seed").set(bytes_of_mut(&mut volume), &Value::Word(1));
        assert_eq!(volume.seed, u64::MAX);
    }

    #[test]
    fn bits_have_words_and_a_rest() {
        const WORDS: Words<u32> = &[("one", 1), ("two", 2), ("all", u32::MAX)];
        assert_eq!(words_of(u32::MAX, WORDS), (vec!["all"], 0));
        assert_eq!(words_of(3, WORDS), (vec!["one", "two"], 0));
        assert_eq!(words_of(6, WORDS), (vec!["two"], 4));
        assert_eq!(words_of(0, WORDS), (vec![], 0));
    }
}
