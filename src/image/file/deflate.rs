// SPDX-License-Identifier: MIT OR Apache-2.0
//! zlib streams (RFC 1950, RFC 1951) by zlib-rs, of bytes whose parts are known. The low bytes of samples are often
//! noise, of which deflate takes most of its time to save a few percent: with little effort these parts are stored as
//! they are, and what is between them is deflated. Knows no images.

use super::layer::Effort;
use simd_adler32::adler32;
use zlib_rs::{Deflate, DeflateConfig, DeflateFlush, ReturnCode, Strategy};

/// A part is noise if two of its bytes are equal in fewer than one of so many cases; 256 with random bytes.
const RARELY_EQUAL: u64 = 24;
/// One of so many bytes of a part is looked at: odd, so that no sample's bytes are favoured.
const LOOKED_AT: usize = 5;
/// The most bytes of a stored block (RFC 1951, 3.2.4).
const MOST_STORED: usize = 65535;
/// Bytes of a stored block beside its own, and those that the end of what was deflated before it takes at most.
const BESIDE: usize = 16;
/// The window of zlib, 2^15 bytes; negative without a header.
const WINDOW: i32 = 15;

/// Makes one stream after the other.
pub(super) struct Deflater {
    config: DeflateConfig,
    /// Deflates what is between stored parts; `None`: nothing is stored.
    between: Option<Deflate>,
    bytes: Vec<u8>,
}

impl Deflater {
    pub(super) fn new(effort: Effort) -> Self {
        // Bytes that repeat, as those of alpha and of even light do, are all that is worth finding in differences.
        let repeats = |level| DeflateConfig { strategy: Strategy::Rle, ..DeflateConfig::new(level) };
        let (config, stores) = match effort.0 {
            ..=1 => (DeflateConfig::new(1), true),
            2 => (repeats(1), true),
            3 => (repeats(1), false),
            level => (DeflateConfig::new(level.min(9)), false),
        };
        let raw = DeflateConfig { window_bits: -WINDOW, ..config };
        Self { config, between: stores.then(|| Deflate::new_with_config(raw)), bytes: Vec::new() }
    }

    /// The stream of these bytes, which consist of parts of such lengths; `None` if it is not made.
    pub(super) fn stream(&mut self, bytes: &[u8], parts: impl Iterator<Item = usize>) -> Option<&[u8]> {
        let Some(between) = &mut self.between else {
            self.bytes.resize(zlib_rs::compress_bound(bytes.len()), 0);
            let (stream, done) = zlib_rs::compress_slice(&mut self.bytes, bytes, self.config);
            return (done == ReturnCode::Ok).then_some(stream);
        };
        self.bytes.clear();
        // A stream of a window of 2^15 bytes, made with the least effort.
        self.bytes.extend([0x78, 0x01]);
        let mut rest = bytes;
        let mut parts = parts.scan(bytes, |left, length| {
            let (part, after) = left.split_at_checked(length)?;
            *left = after;
            Some((part.len(), is_noise(part)))
        });
        let mut next = parts.next();
        while let Some((mut length, noise)) = next {
            next = parts.next();
            while let Some((more, _)) = next.filter(|(_, other)| *other == noise) {
                length += more;
                next = parts.next();
            }
            let (run, after) = rest.split_at_checked(length)?;
            rest = after;
            match noise {
                true => store(&mut self.bytes, run, next.is_none()),
                false => deflate(between, &mut self.bytes, run, next.is_none())?,
            }
        }
        self.bytes.extend(adler32(&bytes).to_be_bytes());
        rest.is_empty().then_some(&self.bytes)
    }
}

/// Whether it hardly gets shorter: two of its bytes are seldom equal. That is the sum of the squares of their values'
/// shares, 2 to the power of minus Renyi's entropy of order 2, in bits, which is at most Shannon's (Renyi 1961).
fn is_noise(part: &[u8]) -> bool {
    let mut counts = [0_u32; 256];
    part.iter().step_by(LOOKED_AT).for_each(|byte| counts[usize::from(*byte)] += 1);
    let pairs = |count: u64| count * count.saturating_sub(1);
    let equal = counts.iter().map(|count| pairs(u64::from(*count))).sum::<u64>();
    RARELY_EQUAL * equal < pairs(part.len().div_ceil(LOOKED_AT) as u64)
}

/// Stored blocks.
fn store(stream: &mut Vec<u8>, run: &[u8], last: bool) {
    let blocks = run.len().div_ceil(MOST_STORED);
    for (block, number) in run.chunks(MOST_STORED).zip(1..) {
        let length = block.len() as u16;
        stream.push(u8::from(last && number == blocks));
        stream.extend(length.to_le_bytes().into_iter().chain((!length).to_le_bytes()));
        stream.extend_from_slice(block);
    }
}

/// Deflated blocks, which end with a byte and refer to nothing before them. `None`: zlib refuses.
fn deflate(between: &mut Deflate, stream: &mut Vec<u8>, run: &[u8], last: bool) -> Option<()> {
    let begin = stream.len();
    stream.resize(begin + zlib_rs::compress_bound(run.len()) + BESIDE, 0);
    between.reset();
    let flush = if last { DeflateFlush::Finish } else { DeflateFlush::SyncFlush };
    between.compress(run, &mut stream[begin..], flush).ok()?;
    let end = begin + between.total_out() as usize;
    // With room left all of it is written.
    let whole = between.total_in() == run.len() as u64 && end < stream.len();
    stream.truncate(end);
    whole.then_some(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::mix;
    use zlib_rs::{InflateConfig, decompress_slice};

    /// Parts of 1000 bytes: noise, zeros, a slope, noise.
    fn mixed() -> Vec<u8> {
        let noise = |seed: u32| (0..1000_u32).map(move |i| (mix(i.wrapping_add(seed)) >> 24) as u8);
        let slope = (0..1000_u32).map(|i| (i / 100) as u8);
        noise(1).chain(std::iter::repeat_n(0, 1000)).chain(slope).chain(noise(77_777)).collect()
    }

    fn inflated(stream: &[u8], length: usize) -> Vec<u8> {
        let mut bytes = vec![0; length + 1];
        let (found, done) = decompress_slice(&mut bytes, stream, InflateConfig::default());
        assert_eq!(done, ReturnCode::Ok, "{length} bytes");
        found.to_vec()
    }

    #[test]
    fn noise_is_told_from_what_gets_shorter() {
        let parts = mixed().chunks(1000).map(is_noise).collect::<Vec<_>>();
        assert_eq!(parts, [true, false, false, true]);
        assert!(!is_noise(&[]) && !is_noise(&[7]));
    }

    #[test]
    fn streams_are_those_of_zlib() {
        let all = mixed();
        // Long runs of noise have several blocks.
        let long = all.iter().chain(&all[..1000].repeat(150)).copied().collect::<Vec<_>>();
        for effort in 1..=9 {
            let mut deflater = Deflater::new(Effort(effort));
            for bytes in [&all[..], &all[1000..3000], &all[..1000], &all[2999..], &[], &long] {
                for part in [1000, 1, 7000] {
                    let parts = std::iter::repeat_n(part, bytes.len() / part)
                        .chain(Some(bytes.len() % part).filter(|rest| *rest > 0));
                    if bytes.is_empty() {
                        continue;
                    }
                    let stream = deflater.stream(bytes, parts).expect("a stream");
                    assert!(stream.len() < bytes.len() + bytes.len() / 8 + 40 * bytes.len().div_ceil(part) + 40);
                    assert!(inflated(stream, bytes.len()) == bytes, "effort {effort}, parts of {part}");
                }
            }
            let stream = deflater.stream(&all, std::iter::repeat_n(1000, 4)).expect("a stream");
            assert!(stream.len() < 2100, "effort {effort}: {} bytes", stream.len());
        }
        // Parts that are not all of it.
        assert!(Deflater::new(Effort(1)).stream(&all, std::iter::once(1000)).is_none());
        assert!(Deflater::new(Effort(1)).stream(&all, std::iter::once(5000)).is_none());
    }
}
