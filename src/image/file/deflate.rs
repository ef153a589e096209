// SPDX-License-Identifier: MIT OR Apache-2.0
//! zlib streams (RFC 1950, RFC 1951): those of zlib-rs, or, with little effort, runs of equal bytes and Huffman codes
//! alone. The differences of a picture's samples hardly repeat in any other way, so that such streams are a few percent
//! longer, and made several times as fast. Knows no images.

use super::layer::Effort;
use simd_adler32::adler32;
use zlib_rs::{DeflateConfig, ReturnCode};

/// The most effort with which only runs are found.
const RUNS_ALONE: i32 = 3;
/// The bytes of a block, which has codes of its own, because statistics change from row to row: the most that a stored
/// block may have (RFC 1951, 3.2.4).
const PIECE: usize = 65535;
/// Literals, the end of a block, and lengths.
const SYMBOLS: usize = 286;
const END: usize = 256;
const LONGEST_CODE: u32 = 15;
/// The longest repeat.
const LONGEST_MATCH: usize = 258;
/// Bits of a block's header: its kind, how many codes it has, 19 lengths of 3 bits and 287 of 4.
const HEADER_BITS: u64 = 3 + 14 + 3 * 19 + 4 * (SYMBOLS as u64 + 1);
/// Bytes that each flush writes, though not all of them count.
const ROOM: usize = 8;

/// Makes one stream after the other.
pub(super) struct Deflater {
    effort: Effort,
    bytes: Vec<u8>,
    runs: Vec<Run>,
}

impl Deflater {
    pub(super) fn new(effort: Effort) -> Self {
        Self { effort, bytes: Vec::new(), runs: Vec::new() }
    }

    /// The stream of these bytes; `None`: it was not made.
    pub(super) fn stream(&mut self, bytes: &[u8]) -> Option<&[u8]> {
        let Self { effort: Effort(effort), bytes: stream, runs } = self;
        if *effort > RUNS_ALONE {
            stream.resize(zlib_rs::compress_bound(bytes.len()), 0);
            let (stream, done) = zlib_rs::compress_slice(stream, bytes, DeflateConfig::new((*effort).min(9)));
            return (done == ReturnCode::Ok).then_some(stream);
        }
        // No piece takes more than a stored block: 5 bytes beside its own, and one that is begun.
        stream.resize(bytes.len() + 6 * (bytes.len() / PIECE + 1) + 6 + ROOM, 0);
        let mut bits = Bits { out: stream, at: 0, held: 0, count: 0, all_fits: true };
        // A window of 2^15 bytes, the least effort (RFC 1950, 2.2).
        bits.bytes(&[0x78, 0x01]);
        let count = bytes.len().div_ceil(PIECE).max(1);
        for number in 1..=count {
            let piece = &bytes[(number - 1) * PIECE..(number * PIECE).min(bytes.len())];
            find(piece, runs);
            put(piece, runs, number == count, &mut bits);
        }
        bits.fill_byte();
        bits.bytes(&adler32(&bytes).to_be_bytes());
        let (end, all_fits) = (bits.at, bits.all_fits);
        stream.get(..end).filter(|_| all_fits)
    }
}

/// Bytes of a piece that are all equal.
#[derive(Clone, Copy)]
struct Run {
    begin: usize,
    end: usize,
}

impl Run {
    /// The number of longest repeats of its first byte, and the length of one more: at least 3, or 0. Up to two bytes
    /// are left as literals.
    fn repeats(self) -> (usize, usize) {
        let repeated = self.end - self.begin - 1;
        let (whole, rest) = (repeated / LONGEST_MATCH, repeated % LONGEST_MATCH);
        (whole, if rest < 3 { 0 } else { rest })
    }

    /// Bytes after its first one that no repeat stands for.
    fn left(self) -> usize {
        let (whole, rest) = self.repeats();
        self.end - self.begin - 1 - whole * LONGEST_MATCH - rest
    }
}

/// Finds the runs of a piece that fill eight bytes from a multiple of eight on, as all of 15 bytes or more do.
fn find(piece: &[u8], runs: &mut Vec<Run>) {
    runs.clear();
    let (words, _) = piece.as_chunks::<8>();
    let word = |number: usize| words.get(number).map(|word| u64::from_le_bytes(*word));
    let mut number = 0;
    while let Some(here) = word(number) {
        let byte = here as u8;
        let same = u64::from(byte) * 0x0101_0101_0101_0101;
        if here != same {
            number += 1;
            continue;
        }
        let begin = 8 * number - piece[..8 * number].iter().rev().take_while(|before| **before == byte).count();
        while word(number) == Some(same) {
            number += 1;
        }
        let end = 8 * number + piece[8 * number..].iter().take_while(|after| **after == byte).count();
        runs.push(Run { begin, end });
    }
}

/// The symbol of a repeat's length, 3 .. 258, the number of bits that follow it, and these.
fn of_length(length: usize) -> (usize, u32, u64) {
    match length - 3 {
        255 => (285, 0, 0),
        short @ ..8 => (257 + short, 0, 0),
        long => {
            let extra = long.ilog2() - 2;
            let symbol = 257 + 4 * (extra as usize + 1) + (long >> extra & 3);
            (symbol, extra, long as u64 & ((1 << extra) - 1))
        }
    }
}

/// How often each symbol of a piece comes.
fn counted(piece: &[u8], runs: &[Run]) -> [u32; SYMBOLS] {
    // Bytes that come one after the other are counted apart, so that no count waits for the one before.
    let mut apart = [[0_u32; 256]; 4];
    let mut literals = |bytes: &[u8]| {
        let (fours, rest) = bytes.as_chunks::<4>();
        for four in fours {
            apart.iter_mut().zip(four).for_each(|(counts, byte)| counts[usize::from(*byte)] += 1);
        }
        rest.iter().for_each(|byte| apart[0][usize::from(*byte)] += 1);
    };
    let mut counts = [0; SYMBOLS];
    let mut at = 0;
    for run in runs {
        literals(&piece[at..=run.begin]);
        literals(&piece[run.end - run.left()..run.end]);
        let (whole, rest) = run.repeats();
        counts[285] += whole as u32;
        if rest > 0 {
            counts[of_length(rest).0] += 1;
        }
        at = run.end;
    }
    literals(&piece[at..]);
    counts[END] = 1;
    for of_some in apart {
        counts.iter_mut().zip(of_some).for_each(|(count, some)| *count += some);
    }
    counts
}

/// The lengths of Huffman's code (Huffman 1952): the two rarest symbols share all bits but their last, and stand for
/// one symbol from then on.
fn code_lengths(counts: &[u32; SYMBOLS]) -> [u32; SYMBOLS] {
    let mut scale = 0;
    loop {
        let lengths = unlimited_code_lengths(counts, scale);
        if lengths.iter().all(|length| *length <= LONGEST_CODE) {
            return lengths;
        }
        // Lengths differ less where counts do; for equal counts they are at most 9.
        scale += 1;
    }
}

/// [`code_lengths`] of counts / 2^`scale`, without their limit.
fn unlimited_code_lengths(counts: &[u32; SYMBOLS], scale: u32) -> [u32; SYMBOLS] {
    // Leaves by their counts, then the parents of two nodes each, whose counts ascend as well.
    let mut nodes = [(0_u32, 0_usize); 2 * SYMBOLS];
    let mut leaves = 0;
    for (symbol, count) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
        nodes[leaves] = ((count >> scale).max(1), symbol);
        leaves += 1;
    }
    nodes[..leaves].sort_unstable();
    let mut parents = [0; 2 * SYMBOLS];
    let (mut leaf, mut inner, mut end) = (0, leaves, leaves);
    while leaves - leaf + end - inner > 1 {
        let mut sum = 0;
        for _ in 0..2 {
            let takes_leaf = leaf < leaves && (inner == end || nodes[leaf].0 <= nodes[inner].0);
            let next = if takes_leaf { &mut leaf } else { &mut inner };
            sum += nodes[*next].0;
            parents[*next] = end;
            *next += 1;
        }
        nodes[end].0 = sum;
        end += 1;
    }
    let mut lengths = [0; SYMBOLS];
    let mut depths = [0; 2 * SYMBOLS];
    for node in (0..end - 1).rev() {
        depths[node] = depths[parents[node]] + 1;
    }
    for (node, depth) in nodes[..leaves].iter().zip(depths) {
        // A code of one symbol has a bit, too.
        lengths[node.1] = depth.max(1);
    }
    lengths
}

/// The codes of these lengths, reversed: their highest bits are written first (RFC 1951, 3.1.1 and 3.2.2).
fn codes(lengths: &[u32; SYMBOLS]) -> [Code; SYMBOLS] {
    let mut of_length = [0_u32; LONGEST_CODE as usize + 1];
    lengths.iter().filter(|length| **length > 0).for_each(|length| of_length[*length as usize] += 1);
    let mut next = [0_u32; LONGEST_CODE as usize + 1];
    for length in 1..=LONGEST_CODE as usize {
        next[length] = (next[length - 1] + of_length[length - 1]) << 1;
    }
    lengths.map(|length| {
        let code = next[length as usize];
        next[length as usize] += 1;
        let bits = if length == 0 { 0 } else { u64::from(code.reverse_bits() >> (32 - length)) };
        Code { bits, length }
    })
}

#[derive(Clone, Copy)]
struct Code {
    bits: u64,
    length: u32,
}

/// Writes a piece as a block of codes, or as it is where that is shorter.
fn put(piece: &[u8], runs: &[Run], last: bool, out: &mut Bits<'_>) {
    let counts = counted(piece, runs);
    let lengths = code_lengths(&counts);
    let in_codes = counts.iter().zip(lengths).map(|(count, length)| u64::from(*count) * u64::from(length)).sum::<u64>();
    // A repeat has a bit for its distance, and up to five beside the symbol of its length.
    let in_repeats = 6 * counts[END + 1..].iter().map(|count| u64::from(*count)).sum::<u64>();
    if (HEADER_BITS + in_codes + in_repeats).div_ceil(8) >= piece.len() as u64 {
        return store(piece, last, out);
    }
    // A block with codes of its own: 286 for symbols, 1 for distances, 19 for the lengths of these.
    out.put(u64::from(last) | 2 << 1, 3);
    out.put(29 | 15 << 10, 14);
    // Lengths from 0 to 15 have codes of 4 bits; the codes that repeat one are not used.
    out.put(0, 9);
    (0..16).for_each(|_| out.put(4, 3));
    for length in lengths.into_iter().chain([1]) {
        out.put(u64::from(length.reverse_bits() >> 28), 4);
    }
    let codes = codes(&lengths);
    let mut at = 0;
    for run in runs {
        out.literals(&piece[at..=run.begin], &codes);
        let (whole, rest) = run.repeats();
        // The distance, which is always 1, has the code 0, of one bit.
        (0..whole).for_each(|_| out.put(codes[285].bits, codes[285].length + 1));
        if rest > 0 {
            let (symbol, extra, bits) = of_length(rest);
            out.put(codes[symbol].bits | bits << codes[symbol].length, codes[symbol].length + extra + 1);
        }
        out.literals(&piece[run.end - run.left()..run.end], &codes);
        at = run.end;
    }
    out.literals(&piece[at..], &codes);
    out.put(codes[END].bits, codes[END].length);
}

/// Writes a piece as it is.
fn store(piece: &[u8], last: bool, out: &mut Bits<'_>) {
    out.put(u64::from(last), 3);
    out.fill_byte();
    let length = piece.len() as u16;
    out.bytes(&length.to_le_bytes());
    out.bytes(&(!length).to_le_bytes());
    out.bytes(piece);
}

/// Bits that are written into bytes, lowest first.
struct Bits<'a> {
    out: &'a mut [u8],
    /// Where the next byte goes.
    at: usize,
    /// Bits that are not written yet, at most seven between two calls.
    held: u64,
    count: u32,
    /// False once there was no room.
    all_fits: bool,
}

impl Bits<'_> {
    /// Appends up to 56 bits.
    #[inline]
    fn put(&mut self, bits: u64, count: u32) {
        self.held |= bits << self.count;
        self.count += count;
        self.flush();
    }

    /// Writes the whole bytes that are held.
    #[inline]
    fn flush(&mut self) {
        match self.out.get_mut(self.at..self.at + ROOM) {
            Some(room) => room.copy_from_slice(&self.held.to_le_bytes()),
            None => self.all_fits = false,
        }
        self.at += (self.count >> 3) as usize;
        self.held >>= self.count & !7;
        self.count &= 7;
    }

    #[inline]
    fn literals(&mut self, bytes: &[u8], codes: &[Code; SYMBOLS]) {
        let (threes, rest) = bytes.as_chunks::<3>();
        for three in threes {
            // Three codes of up to 15 bits fit beside those that are held.
            for byte in three {
                let code = codes[usize::from(*byte)];
                self.held |= code.bits << self.count;
                self.count += code.length;
            }
            self.flush();
        }
        for byte in rest {
            let code = codes[usize::from(*byte)];
            self.put(code.bits, code.length);
        }
    }

    /// Fills up the byte that is begun, with zeros.
    fn fill_byte(&mut self) {
        self.count = self.count.next_multiple_of(8);
        self.flush();
    }

    /// Appends bytes where none is begun.
    fn bytes(&mut self, bytes: &[u8]) {
        match self.out.get_mut(self.at..self.at + bytes.len()) {
            Some(room) => room.copy_from_slice(bytes),
            None => self.all_fits = false,
        }
        self.at += bytes.len();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::mix;
    use zlib_rs::{InflateConfig, decompress_slice};

    fn inflated(stream: &[u8], length: usize) -> Vec<u8> {
        let mut bytes = vec![0; length + 1];
        let (found, done) = decompress_slice(&mut bytes, stream, InflateConfig::default());
        assert_eq!(done, ReturnCode::Ok, "{length} bytes");
        found.to_vec()
    }

    fn noise(count: u32, seed: u32) -> Vec<u8> {
        (0..count).map(|i| (mix(i.wrapping_add(mix(seed))) >> 24) as u8).collect()
    }

    /// Bytes as they occur in pictures, and those that meet the limits of the format: each with the most bytes that its
    /// stream may have, less a tenth of a percent.
    fn cases() -> Vec<(Vec<u8>, usize)> {
        let mut all = vec![(vec![], 11), (vec![7], 12), (vec![7, 7, 7], 14), (vec![9; 200], 180)];
        for count in [65_535, 65_536, 131_070, 200_000, 1_100_000] {
            all.push((noise(count, count), count as usize + 60));
        }
        all.push((vec![128; 500_000], 3000));
        // Runs of every length about the limits, between noise.
        let runs = (1..600_u32).flat_map(|length| [noise(5, length), vec![length as u8; length as usize]].concat());
        let runs = runs.collect::<Vec<_>>();
        let most = runs.len() / 10;
        all.push((runs, most));
        // Counts like Fibonacci's numbers, whose code is the deepest.
        let mut fibonacci = vec![];
        let (mut one, mut next) = (1_usize, 1);
        for symbol in 0..22_u8 {
            fibonacci.extend((0..one).flat_map(|_| [symbol, 255 - symbol]));
            (one, next) = (next, one + next);
        }
        let most = fibonacci.len() / 2;
        all.push((fibonacci, most));
        // A slope with noise in its lowest bits.
        let slope = (0..70_000_u32).map(|i| (i / 700) as u8 ^ (noise(1, i)[0] & 3));
        all.push((slope.collect(), 70_000));
        all
    }

    #[test]
    fn zlib_reads_the_streams() {
        for effort in [1, 3, 4, 9] {
            let mut deflater = Deflater::new(Effort(effort));
            for (number, (bytes, most)) in cases().into_iter().enumerate() {
                let stream = deflater.stream(&bytes).expect("a stream");
                assert!(inflated(stream, bytes.len()) == bytes, "effort {effort}, case {number}");
                assert!(stream.len() <= most + most / 1000, "effort {effort}, case {number}: {} bytes", stream.len());
            }
        }
    }

    #[test]
    fn random_bytes_and_runs_come_back() {
        let mut deflater = Deflater::new(Effort(1));
        for seed in 0..300_u32 {
            let mut bytes = Vec::new();
            for part in 0..mix(seed) % 40 {
                let chosen = mix(seed * 1000 + part);
                let length = (chosen >> 8) % [3, 20, 300, 9000][(chosen & 3) as usize];
                match chosen >> 2 & 3 {
                    0 => bytes.extend(noise(length, chosen)),
                    // Few values, whose codes are short.
                    1 => bytes.extend(noise(length, chosen).iter().map(|byte| byte >> 6)),
                    _ => bytes.extend(std::iter::repeat_n((chosen >> 4 & 3) as u8, length as usize)),
                }
            }
            let stream = deflater.stream(&bytes).expect("a stream");
            assert!(inflated(stream, bytes.len()) == bytes, "seed {seed}, {} bytes", bytes.len());
        }
    }

    #[test]
    fn lengths_have_the_symbols_of_the_format() {
        // RFC 1951, 3.2.5.
        let known =
            [(3, 257, 0, 0), (10, 264, 0, 0), (11, 265, 1, 0), (14, 266, 1, 1), (34, 272, 2, 3), (35, 273, 3, 0)];
        for (length, symbol, extra, bits) in known.into_iter().chain([(257, 284, 5, 30), (258, 285, 0, 0)]) {
            assert_eq!(of_length(length), (symbol, extra, bits), "{length}");
        }
    }
}
