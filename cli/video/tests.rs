// SPDX-License-Identifier: MIT OR Apache-2.0
//! What can be tested of videos without ffmpeg.

use super::boxes::{self, Video};
use super::*;

#[test]
fn rates_are_ratios() {
    for (rate, over_under) in [
        (24.0, [24, 1]),
        (23.976, [24000, 1001]),
        (29.97, [30000, 1001]),
        (59.94, [60000, 1001]),
        (12.5, [12500, 1000]),
        (0.5, [500, 1000]),
        (1000.0, [1000, 1]),
    ] {
        assert_eq!(ratio(rate), over_under, "{rate}");
        let ticks = u64::from(ticks_per_second(over_under[0]));
        assert!(ticks >= 10_000 && ticks.is_multiple_of(u64::from(over_under[0])), "{rate}: {ticks}");
    }
}

#[test]
fn pieces_cover_a_video_and_none_is_short() {
    let codec = Codec::of(Some("mp4"), None, None, bhr::image::PixelFormat::Rgba8Srgb).unwrap().unwrap();
    for (frames, rate) in [(1, 24.0), (47, 24.0), (48, 24.0), (95, 24.0), (96, 24.0), (1000, 29.97), (40, 1.0)] {
        let shape =
            Shape { size: [2, 2], rate, frames, codec, transparent: false, keyframes: None, description: Vec::new() };
        let (mut begin, piece) = (0, shape.piece());
        while begin < frames {
            let end = shape.end_of_piece(begin);
            assert!(
                end > begin && end - begin >= piece.min(frames) && end - begin < 2 * piece,
                "{frames} {begin} {end}"
            );
            begin = end;
        }
        assert_eq!(begin, frames);
    }
}

fn boxed(kind: &[u8; 4], content: &[u8]) -> Vec<u8> {
    let mut bytes = ((content.len() + 8) as u32).to_be_bytes().to_vec();
    bytes.extend(kind);
    bytes.extend(content);
    bytes
}

/// A track with a clock of 12 ticks a second and one description of frames.
fn header() -> Vec<u8> {
    let mut clock = vec![0; 20];
    clock[15] = 12;
    let table = boxed(b"stsd", &[&[0, 0, 0, 0, 0, 0, 0, 1], &boxed(b"avc1", &[7; 5])[..]].concat());
    let information = boxed(b"minf", &boxed(b"stbl", &[table, boxed(b"stts", &[0; 4])].concat()));
    let media = boxed(b"mdia", &[boxed(b"mdhd", &clock), information].concat());
    boxed(b"moov", &boxed(b"trak", &media))
}

fn fragment(frames: u8, version: u8) -> Vec<u8> {
    let time = if version == 1 { vec![1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 3] } else { vec![0, 0, 0, 0, 0, 0, 0, 3] };
    let run = boxed(b"trun", &[0, 0, 0, 0, 0, 0, 0, frames]);
    let track = boxed(b"traf", &[boxed(b"tfdt", &time), run].concat());
    let table = boxed(b"moof", &[boxed(b"mfhd", &[0, 0, 0, 0, 0, 0, 0, 1]), track].concat());
    [table, boxed(b"mdat", &[frames; 9])].concat()
}

fn read(bytes: &[u8]) -> std::io::Result<Video> {
    let mut file = tempfile::tempfile()?;
    std::io::Write::write_all(&mut file, bytes)?;
    Video::read(file)
}

#[test]
fn fragments_are_appended_at_their_times() {
    for version in [0, 1] {
        let video = [boxed(b"ftyp", b"isom"), header(), fragment(4, version), fragment(2, version)].concat();
        let mut video = read(&[video, boxed(b"mfra", &[0; 3])].concat()).unwrap();
        assert_eq!(video.ticks_per_second().unwrap(), 12);
        let mut to = tempfile::tempfile().unwrap();
        assert_eq!(video.append(&mut to, 100, 5).unwrap(), 6);
        to.seek(SeekFrom::Start(0)).unwrap();
        let mut bytes = Vec::new();
        to.read_to_end(&mut bytes).unwrap();
        let times = bytes.windows(4).enumerate().filter(|(_, kind)| kind == b"tfdt").map(|(at, _)| {
            let last = at + if version == 1 { 12 } else { 8 };
            u32::from_be_bytes(bytes[last..last + 4].try_into().unwrap())
        });
        // Both said 3; the frames before took 500 ticks.
        assert_eq!(times.collect::<Vec<_>>(), [503, 503]);
        let sequence = bytes.windows(4).enumerate().filter(|(_, kind)| kind == b"mfhd");
        let sequence = sequence.map(|(at, _)| bytes[at + 11]).collect::<Vec<_>>();
        assert_eq!(sequence, [101, 105]);
        assert_eq!(bytes.len(), fragment(4, version).len() + fragment(2, version).len());
    }
}

#[test]
fn a_description_grows_all_that_hold_it() {
    let (plain, mut grown) = (header(), header());
    boxes::describe(&mut grown, &boxed(b"st3d", &[0; 5])).unwrap();
    assert_eq!(grown.len(), plain.len() + 13);
    let size = |bytes: &[u8], kind: &[u8; 4]| {
        let at = bytes.windows(4).position(|four| four == kind).unwrap() - 4;
        u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap())
    };
    for kind in [b"moov", b"trak", b"mdia", b"minf", b"stbl", b"stsd", b"avc1"] {
        assert_eq!(size(&grown, kind), size(&plain, kind) + 13, "{}", String::from_utf8_lossy(kind));
    }
    assert_eq!((size(&grown, b"stts"), size(&grown, b"mdhd")), (12, 28));
    assert!(boxes::describe(&mut boxed(b"moov", &[]), b"x").is_err());
}

/// A video of frames of these sizes, so many bytes of them being there.
fn whole(sizes: &[u8], bytes: usize) -> Vec<u8> {
    let mut table = vec![0; 12];
    table[11] = sizes.len() as u8;
    table.extend(sizes.iter().flat_map(|size| [0, 0, 0, *size]));
    let tables = boxed(b"stbl", &boxed(b"stsz", &table));
    let track = boxed(b"trak", &boxed(b"mdia", &boxed(b"minf", &tables)));
    [boxed(b"ftyp", b"isom"), boxed(b"moov", &track), boxed(b"mdat", &vec![0; bytes])].concat()
}

#[test]
fn videos_that_are_cut_off_are_not_whole() {
    let check = |bytes: &[u8], frames| {
        let mut file = tempfile::tempfile().unwrap();
        std::io::Write::write_all(&mut file, bytes).unwrap();
        boxes::check_whole(file, frames)
    };
    let video = whole(&[100, 30, 20], 150);
    assert!(check(&video, 3).is_ok());
    assert!(check(&video, 2).is_err() && check(&video, 4).is_err());
    for end in 0..video.len() {
        assert!(check(&video[..end], 3).is_err(), "{end}");
    }
    assert!(check(&whole(&[100, 30, 20], 100), 3).is_err());
}

#[test]
fn headers_do_not_say_which_frames_others_need() {
    let mut with = header();
    let table = with.windows(4).position(|kind| kind == b"stts").unwrap() - 4;
    // Beside stts, in the same box: all that hold it are larger by twelve bytes.
    let plain = with.clone();
    for kind in [b"moov", b"trak", b"mdia", b"minf", b"stbl"] {
        let at = with.windows(4).position(|four| four == kind).unwrap() - 1;
        with[at] += 12;
    }
    with.splice(table..table, boxed(b"sdtp", &[0; 4]));
    boxes::remove_dependencies(&mut with).unwrap();
    assert_eq!(with, plain);
    boxes::remove_dependencies(&mut with).unwrap();
    assert_eq!(with, plain);
}

#[test]
fn broken_videos_are_errors() {
    let whole = [header(), fragment(4, 1)].concat();
    assert!(read(&whole).is_ok());
    for end in 0..whole.len() {
        assert!(read(&whole[..end]).is_err(), "{end}");
    }
    assert!(read(&[header(), boxed(b"mdat", &[])].concat()).is_err());
    assert!(read(&[fragment(1, 1), header()].concat()).is_err());
    // Sizes of nothing, and beyond the end, at any place.
    let mut random = bhr_random();
    for _ in 0..20_000 {
        let mut broken = whole.clone();
        let at = random() as usize % broken.len();
        broken[at] = random() as u8;
        if let Ok(mut video) = read(&broken) {
            let _ = video.ticks_per_second();
            let _ = video.append(&mut tempfile::tempfile().unwrap(), 1, 1);
            let _ = boxes::remove_dependencies(&mut video.header);
            let _ = boxes::describe(&mut video.header, b"12345678");
        }
    }
}

/// xorshift64 (Marsaglia 2003).
fn bhr_random() -> impl FnMut() -> u64 {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state
    }
}
