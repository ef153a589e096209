// SPDX-License-Identifier: MIT OR Apache-2.0
//! Image files that are broken, or made to do harm: each is an image or an error, within the memory there is. An
//! allocation that fails inside a decoder ends the process, and nothing can catch that; so files are read in children
//! that have little memory, and a child that dies is a failed test. Files are the same in every run. BHR_TESTS_ALL=1:
//! 100,000 files of each kind instead of some thousand.
#![cfg(target_os = "linux")]

mod cubes;
mod hostile;
mod ktx2;
#[path = "../random/mod.rs"]
mod random;
mod seeds;

use bhr::error::ErrorKind;
use bhr::image::{self, FromFile, Loaded};
use bhr::sky::StoredMap;
use random::{Random, count_from};
use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;
use std::process::Command;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Bytes of address space that a child has for files, besides what it begins with.
const CHILD_BYTES: u64 = 2 << 30;

/// A folder of this process's own, removed at its end.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Self {
        static NEXT: std::sync::atomic::AtomicU32 = std::sync::atomic::AtomicU32::new(0);
        let next = NEXT.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("bhr-files-{}-{next}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn load(&self, bytes: &[u8]) -> bhr::error::Result<Loaded> {
        let path = self.0.join("file");
        fs::write(&path, bytes).unwrap();
        image::load(&path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Bytes of address space that this process has taken.
fn address_space() -> u64 {
    let pages = fs::read_to_string("/proc/self/statm").unwrap();
    pages.split(' ').next().unwrap().parse::<u64>().unwrap() * 4096
}

/// Limits this process to `more` bytes from now on.
fn limit_memory(more: u64) {
    let mut limit = libc::rlimit { rlim_cur: 0, rlim_max: 0 };
    // SAFETY: `limit` is writable, then readable.
    unsafe {
        assert_eq!(libc::getrlimit(libc::RLIMIT_AS, &mut limit), 0);
        limit.rlim_cur = address_space() + more;
        assert_eq!(libc::setrlimit(libc::RLIMIT_AS, &limit), 0);
    }
}

/// Runs an ignored test of this program in a process of its own; what it printed.
fn child(test: &str, environment: &[(&str, String)]) -> String {
    let child = Command::new(std::env::current_exe().unwrap())
        .args(["--ignored", "--exact", test, "--nocapture", "--test-threads=1"])
        .envs(environment.iter().map(|(name, value)| (name, value)))
        .output()
        .unwrap();
    let (out, err) = (String::from_utf8_lossy(&child.stdout), String::from_utf8_lossy(&child.stderr));
    assert!(child.status.success() && out.contains("1 passed"), "{test}: {}\n{out}{err}", child.status);
    out.into_owned()
}

fn seeds(kind: &str) -> Vec<seeds::Seed> {
    match kind {
        "png" => seeds::png(),
        "pnm" => seeds::pnm(),
        "ktx2" => ktx2::seeds(),
        #[cfg(feature = "exr")]
        "exr" => seeds::exr(),
        _ => panic!("seeds of {kind}"),
    }
}

const KINDS: &[&str] = if cfg!(feature = "exr") { &["png", "pnm", "ktx2", "exr"] } else { &["png", "pnm", "ktx2"] };

#[test]
fn valid_files_of_every_kind_are_read() {
    let folder = Folder::new();
    for kind in KINDS {
        for seed in seeds(kind) {
            let loaded = folder.load(&seed.bytes).unwrap_or_else(|error| panic!("{}: {error}", seed.name));
            let bytes = u64::from(loaded.width) * u64::from(loaded.height) * loaded.format.bytes_per_pixel() as u64;
            assert_eq!(loaded.pixels.as_bytes().len() as u64, bytes, "{}", seed.name);
        }
    }
}

#[test]
fn ktx2_files_hold_the_same_picture() {
    let folder = Folder::new();
    for (name, file) in ktx2::pictures() {
        let loaded = folder.load(&file.bytes()).unwrap_or_else(|error| panic!("{name}: {error}"));
        let floats = bytemuck::cast_slice::<u8, f32>(loaded.pixels.as_bytes());
        assert_eq!((loaded.width, loaded.height, floats.len()), (6, 5, 4 * 30), "{name}");
        for (pixel, i) in floats.chunks(4).zip(0..) {
            let [r, g, b] = ktx2::light(i % 6, i / 6);
            assert_eq!(pixel, [r, g, b, 1.0], "{name}: {i}");
        }
    }
}

/// Codes keep their order and alpha, unless their primaries make them light of Rec. 709.
#[test]
fn ktx2_files_hold_the_same_codes() {
    let folder = Folder::new();
    for (name, file) in ktx2::codes() {
        let loaded = folder.load(&file.bytes()).unwrap_or_else(|error| panic!("{name}: {error}"));
        let bytes = loaded.pixels.as_bytes();
        match name {
            "wide codes" => {
                // The first texel is 0, 1, 2; the matrix of BT.2087 takes more of green than there is from red.
                let floats = bytemuck::cast_slice::<u8, f32>(bytes);
                let light = |code: f32| code / 255.0 / 12.92;
                let green = -0.1246 * light(0.0) + 1.1329 * light(1.0) - 0.0083 * light(2.0);
                assert!((floats[1] / green - 1.0).abs() < 1e-3 && floats[0] == 0.0 && floats[3] == 1.0, "{floats:?}");
            }
            "blue codes" => assert_eq!(bytes[..8], [2, 1, 0, 3, 6, 5, 4, 7]),
            "codes with alpha" => assert_eq!(bytes[..8], [0, 1, 2, 3, 4, 5, 6, 7]),
            _ => assert_eq!(bytes[..8], [0, 1, 2, 255, 3, 4, 5, 255]),
        }
    }
}

/// Blocks lie where they belong in pictures that end within them, whichever way up.
#[test]
fn ktx2_files_hold_the_same_blocks() {
    let folder = Folder::new();
    for orientation in ["rd", "ru"] {
        let loaded = folder.load(&ktx2::numbered([10, 7], orientation).bytes()).unwrap();
        let floats = bytemuck::cast_slice::<u8, f32>(loaded.pixels.as_bytes());
        for (pixel, i) in floats.chunks(4).zip(0..) {
            let (x, y) = (i % 10, if orientation == "rd" { i / 10 } else { 6 - i / 10 });
            let end = ktx2::number(x / 4, y / 4) as u32;
            let wanted = half::f16::from_bits((((end * 64 + 32) * 31) >> 6) as u16).to_f32();
            assert_eq!(pixel, [wanted, wanted, wanted, 1.0], "{orientation}: {x}, {y}");
        }
    }
}

/// Maps of blocks have the light of their file, and levels that a file lacks are made of it.
#[test]
fn blocks_become_maps() {
    let folder = Folder::new();
    for (levels, compressed) in [(1, false), (6, false), (6, true)] {
        let path = folder.0.join("map.ktx2");
        fs::write(&path, ktx2::map([32, 16], levels, compressed).bytes()).unwrap();
        let map = StoredMap::from_file(&path).unwrap();
        assert!(map.blocks().is_some() && map.size() == [32, 16]);
        assert_eq!(map.blocks().unwrap().levels().len(), 6);
        // Each level of a file has a light of its own; those that it lacks have the first's.
        for (level, number) in map.texels().unwrap().levels().iter().zip(0_u32..) {
            let end = 400 + if levels > 1 { number } else { 0 };
            let wanted = half::f16::from_bits((((end * 64 + 32) * 31) >> 6) as u16).to_f32();
            for texel in &level.texels {
                let [r, g, b] = bhr::image::rgb9e5::unpack(*texel);
                assert!((r / wanted - 1.0).abs() < 0.004 && r == g && g == b, "{number}: {r} {g} {b}, wanted {wanted}");
            }
        }
    }
}

/// Files in lines or tiles, with any compression, hold the same picture.
#[cfg(feature = "exr")]
#[test]
fn lossless_exr_files_hold_the_same_picture() {
    let folder = Folder::new();
    let mut first = std::collections::BTreeMap::new();
    for seed in seeds("exr").into_iter().filter(|seed| !seed.name.contains("b44") && !seed.name.contains("parts")) {
        let kind = seed.name.split(", ").nth(1).unwrap().to_owned();
        let loaded = folder.load(&seed.bytes).unwrap();
        let pixels = bytemuck::cast_slice::<u8, f32>(loaded.pixels.as_bytes()).to_vec();
        assert_eq!((loaded.width, loaded.height, pixels.len()), (37, 21, 4 * 37 * 21));
        let wanted = first.entry(kind.clone()).or_insert_with(|| pixels.clone());
        assert!(*wanted == pixels, "{}", seed.name);
        // Pixel (5, 2): x + y is 7 of 64, of whole numbers x; alpha is the first channel of the file.
        let at = &pixels[4 * (2 * 37 + 5)..][..4];
        let (value, x) = (7.0 / 64.0, 5.0);
        let wanted = if kind == "mixed" { [value, x, value, value] } else { [value; 4] };
        assert_eq!(at, wanted, "{}", seed.name);
    }
    assert_eq!(first.len(), 3);
}

#[test]
#[ignore = "run by the tests below, in a process of its own"]
fn child_reads_bombs() {
    limit_memory(CHILD_BYTES);
    let folder = Folder::new();
    for bomb in hostile::bombs() {
        let begin = Instant::now();
        let error = match folder.load(&bomb.bytes) {
            Ok(loaded) => panic!("{} was read: {} x {}", bomb.name, loaded.width, loaded.height),
            Err(error) => error,
        };
        let kinds = [ErrorKind::Io, ErrorKind::OutOfMemory, ErrorKind::Unsupported];
        assert!(kinds.contains(&error.kind), "{}: {error}", bomb.name);
        assert!(bomb.words.iter().any(|words| error.message.contains(words)), "{}: {error}", bomb.name);
        assert!(begin.elapsed() < Duration::from_secs(60), "{}: {:?}", bomb.name, begin.elapsed());
    }
}

/// Among them the 341-byte EXR whose data window, not its display window, was 103 GB in size, and a PNG that grows
/// fourfold as it is read.
#[test]
fn small_files_that_claim_to_be_large_are_refused() {
    child("child_reads_bombs", &[]);
}

/// The most memory of the machine's that this process has had at a time, bytes.
#[cfg(feature = "exr")]
fn peak_resident() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap();
    line.trim().trim_end_matches(" kB").parse::<u64>().unwrap() * 1024
}

#[cfg(feature = "exr")]
#[test]
#[ignore = "run by the test below, in a process of its own"]
fn child_reads_one_pixel_of_a_large_picture() {
    limit_memory(CHILD_BYTES);
    let folder = Folder::new();
    let before = peak_resident();
    let loaded = folder.load(&hostile::exr_pixel()).unwrap();
    let taken = peak_resident() - before;
    assert!(taken < 32 << 20, "{taken} bytes became resident");
    assert_eq!((loaded.width, loaded.height), (8192, 8192));
    let floats: &[f32] = bytemuck::cast_slice(loaded.pixels.as_bytes());
    assert_eq!(floats[..8], [1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
    assert_eq!(floats[floats.len() - 4..], [0.0; 4]);
}

/// Pixels that no block reaches are not written, alpha neither: they take no memory of the machine's.
#[cfg(feature = "exr")]
#[test]
fn a_small_file_takes_little_memory_however_large_its_display_window() {
    child("child_reads_one_pixel_of_a_large_picture", &[]);
}

/// A part with half channels R, G, B, A, and so many more that are not used.
#[cfg(feature = "exr")]
fn part_with_more(
    size: [usize; 2],
    more: usize,
    compression: exr::compression::Compression,
) -> exr::meta::header::Header {
    use exr::meta::attribute::{ChannelDescription, ChannelList, SampleType::F16};
    let mut part = seeds::part("a", size, [F16; 4], compression, None);
    let more = (0..more).map(|i| ChannelDescription::new(format!("Z{i:02}").as_str(), F16, false));
    part.channels = ChannelList::new(part.channels.list.into_iter().chain(more).collect());
    part
}

/// A file with many lines and channels that are not shown may lack all but its first lines.
#[cfg(feature = "exr")]
#[test]
fn blocks_past_the_display_window_are_not_read() {
    let mut part = part_with_more([64, 512], 60, exr::compression::Compression::ZIP16);
    let whole = seeds::exr_file(vec![part.clone()]);
    part.shared_attributes.display_window = exr::meta::attribute::IntegerBounds::from_dimensions((64, 20));
    let mut first = seeds::exr_file(vec![part]);
    first.truncate(first.len() / 2);
    let folder = Folder::new();
    let (whole, first) = (folder.load(&whole).unwrap(), folder.load(&first).unwrap());
    assert_eq!((first.width, first.height), (64, 20));
    assert_eq!(first.pixels.as_bytes(), &whole.pixels.as_bytes()[..64 * 20 * 16]);
}

/// A map of the sky with eight channels besides RGBA: with BHR_TESTS_ALL=1 the largest that graphics cards take, which
/// is 2 GiB when it is read.
#[cfg(feature = "exr")]
#[test]
fn a_large_map_with_unused_channels_is_read() {
    let all = random::runs_all();
    let size = if all { [16384, 8192] } else { [2048, 1024] };
    let file = seeds::exr_file(vec![part_with_more(size, 8, exr::compression::Compression::RLE)]);
    let begin = Instant::now();
    let loaded = Folder::new().load(&file).unwrap();
    println!("{} bytes read in {:?}", file.len(), begin.elapsed());
    assert_eq!([loaded.width as usize, loaded.height as usize], size);
    let floats: &[f32] = bytemuck::cast_slice(loaded.pixels.as_bytes());
    let pixel = |x: usize, y: usize| floats[4 * (y * size[0] + x)];
    assert_eq!([pixel(1, 0), pixel(size[0] - 1, size[1] - 1)], [1.0 / 64.0, 62.0 / 64.0]);
}

#[test]
#[ignore = "run by the tests below, in a process of its own"]
fn child_reads_faulty_files() {
    let kind = std::env::var("BHR_FILES_KIND").unwrap();
    let count = count_from("BHR_FILES_COUNT", 1000, 1000);
    let seeds = seeds(&kind);
    let folder = Folder::new();
    static PLACES: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());
    std::panic::set_hook(Box::new(|info| {
        PLACES.lock().unwrap().extend(info.location().map(ToString::to_string));
    }));
    limit_memory(CHILD_BYTES);
    let mut random = Random(count_from("BHR_FILES_SEED", 1, 1) as u64);
    let kinds = [ErrorKind::Io, ErrorKind::OutOfMemory, ErrorKind::Unsupported];
    let (mut read, mut panics) = (0, 0);
    let mut slowest = (Duration::ZERO, 0);
    for i in 0..count {
        let bytes = hostile::faulty(&seeds, &mut random);
        // The file is left there if this process dies: it is the one that killed it.
        let begin = Instant::now();
        match folder.load(&bytes) {
            Ok(loaded) => {
                read += 1;
                let size = u64::from(loaded.width) * u64::from(loaded.height);
                let bytes = size * loaded.format.bytes_per_pixel() as u64;
                assert_eq!(loaded.pixels.as_bytes().len() as u64, bytes, "file {i}");
            }
            Err(error) => {
                assert!(kinds.contains(&error.kind), "file {i}: {error}");
                panics += usize::from(error.message.contains("the codec failed"));
            }
        }
        if kind == "ktx2"
            && let Err(error) = StoredMap::from_file(&folder.0.join("file"))
        {
            assert!(kinds.contains(&error.kind), "map {i}: {error}");
        }
        slowest = slowest.max((begin.elapsed(), i));
    }
    for place in PLACES.lock().unwrap().iter() {
        println!("a codec panicked at {place}");
    }
    println!("{kind}: {count} files, {read} of them read, {panics} caught panics, the slowest {slowest:?}");
    assert!(read > count / 100 && read < count, "{read} of {count} were read: faults are too many or too few");
}

fn faulty_files(kind: &str) {
    let all = random::runs_all();
    let count = if all { 100_000 } else { 2_000 };
    let environment = [("BHR_FILES_KIND", kind.to_owned()), ("BHR_FILES_COUNT", count.to_string())];
    let out = child("child_reads_faulty_files", &environment);
    println!("{}", out.lines().find(|line| line.starts_with(kind)).unwrap_or_default());
}

#[test]
fn faulty_png_files_are_images_or_errors() {
    faulty_files("png");
}

#[test]
fn faulty_pnm_files_are_images_or_errors() {
    faulty_files("pnm");
}

#[test]
fn faulty_ktx2_files_are_images_or_errors() {
    faulty_files("ktx2");
}

#[cfg(feature = "exr")]
#[test]
fn faulty_exr_files_are_images_or_errors() {
    faulty_files("exr");
}

/// Files with a block of 4 MiB, read with more and more memory: at first there is too little, and no amount in
/// between ends the process.
#[test]
#[ignore = "run by the tests below, in a process of its own"]
fn child_reads_with_more_and_more_memory() {
    const STEP: u64 = 2 << 20;
    let folder = Folder::new();
    for (name, bytes) in large_files() {
        let (mut refused, mut read) = (0, 0);
        for step in 0..256 {
            limit_memory(step * STEP);
            // Blocks also become a map, and that texels.
            let is_map = bytes.starts_with(b"\xabKTX");
            let map = || StoredMap::from_file(&folder.0.join("file"))?.texels().map(drop);
            match folder.load(&bytes).and_then(|_| if is_map { map() } else { Ok(()) }) {
                Ok(()) => read += 1,
                Err(error) => {
                    assert!(error.kind == ErrorKind::OutOfMemory, "{name} with {} bytes: {error}", step * STEP);
                    refused += 1;
                }
            }
            if read == 3 {
                break;
            }
        }
        assert!(refused > 1 && read > 1, "{name}: {refused} refused, {read} read");
        limit_memory(4 << 30);
    }
}

fn large_files() -> Vec<(String, Vec<u8>)> {
    let mut files = Vec::new();
    #[cfg(feature = "exr")]
    {
        use exr::compression::Compression::*;
        use exr::meta::attribute::{LevelMode, SampleType};
        for compression in [Uncompressed, RLE, ZIP1, ZIP16, PIZ, PXR24, B44, B44A] {
            for kind in [SampleType::F16, SampleType::F32] {
                let tiles = Some((512, LevelMode::Singular));
                let part = seeds::part("a", [512, 512], [kind; 4], compression, tiles);
                files.push((format!("{compression}, {kind:?}"), seeds::exr_file(vec![part])));
            }
        }
    }
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 1024, 1024);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Sixteen);
    encoder.write_header().unwrap().write_image_data(&vec![7; 1024 * 1024 * 6]).unwrap();
    files.push(("png".into(), bytes));
    files.push(("pnm".into(), [&b"P6 1024 1024 65535\n"[..], &vec![7; 1024 * 1024 * 6]].concat()));
    files.push(("ktx2".into(), ktx2::map([2048, 2048], 1, true).bytes()));
    files.push(("bits".into(), [&b"P4 8192 4096\n"[..], &vec![7; 1024 * 4096]].concat()));
    files
}

#[test]
fn too_little_memory_is_an_error() {
    child("child_reads_with_more_and_more_memory", &[]);
}

/// A write past the limit raises SIGXFSZ, which ends a process that does not expect it.
#[test]
#[ignore = "run by the test below, in a process of its own"]
fn child_saves_past_the_file_size_limit() {
    use bhr::image::{ImageRef, Layout, PixelFormat};
    let folder = Folder::new();
    let picture = (0..256 * 256 * 16_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8).collect::<Vec<_>>();
    let layouts = [PixelFormat::Rgba8Srgb, PixelFormat::Rgba32F].map(|format| Layout::packed(format, 256, 256));
    let mut files = vec![("a.png", layouts[0]), ("a.ppm", layouts[0])];
    if cfg!(feature = "exr") {
        files.push(("a.exr", layouts[1]));
    }
    for (name, layout) in files {
        let path = folder.0.join(name);
        fs::write(&path, "old").unwrap();
        let mut limit = libc::rlimit { rlim_cur: 0, rlim_max: 0 };
        // SAFETY: `limit` is writable, then readable.
        let saved = unsafe {
            assert_eq!(libc::getrlimit(libc::RLIMIT_FSIZE, &mut limit), 0);
            let before = limit.rlim_cur;
            limit.rlim_cur = 10_000;
            assert_eq!(libc::setrlimit(libc::RLIMIT_FSIZE, &limit), 0);
            let bytes = bytemuck::cast_slice(&picture);
            let saved = image::save(
                &ImageRef::new(layout, bytes).unwrap(),
                image::Alpha::Premultiplied,
                image::ColourSpace::Rec709,
                &path,
            );
            limit.rlim_cur = before;
            assert_eq!(libc::setrlimit(libc::RLIMIT_FSIZE, &limit), 0);
            saved
        };
        let error = saved.unwrap_err();
        assert!(error.kind == ErrorKind::Io && error.message.contains("too large"), "{name}: {error}");
        assert_eq!(fs::read(&path).unwrap(), b"old", "{name}");
    }
    assert_eq!(fs::read_dir(&folder.0).unwrap().count(), if cfg!(feature = "exr") { 3 } else { 2 });
}

#[test]
fn a_file_past_the_hosts_size_limit_is_an_error() {
    child("child_saves_past_the_file_size_limit", &[]);
}
