// SPDX-License-Identifier: MIT OR Apache-2.0
//! Saving and loading by the Rust face: round trips, names, modes, links, broken files.

use super::*;
use crate::error::{ErrorKind, Result};
use crate::image::{ColourSpace, ImageMut, ImageRef, Layout, PixelFormat};
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

/// A folder of this test's own, removed at its end.
pub(super) struct Folder(PathBuf);

impl Folder {
    pub(super) fn new(name: &str) -> Self {
        static NEXT: AtomicU32 = AtomicU32::new(0);
        let next = NEXT.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("bhr-file-{name}-{}-{next}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    pub(super) fn file(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    fn names(&self) -> Vec<OsString> {
        fs::read_dir(&self.0).unwrap().map(|entry| entry.unwrap().file_name()).collect()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// A block for a 3 x 2 image whose row `y`, at any stride, repeats `rows[y]`.
fn block<T: bytemuck::Pod>(layout: Layout, rows: [&[T]; 2]) -> Vec<u32> {
    let mut words = vec![0xabab_abab_u32; 64];
    let mut image = ImageMut::new(layout, bytemuck::cast_slice_mut(&mut words)).unwrap();
    for (y, row) in (0..).zip(rows) {
        let bytes: &[u8] = bytemuck::cast_slice(row);
        image.write_tile(0, y, 3, 1, bytes, bytes.len()).unwrap();
    }
    words
}

fn save_block(layout: Layout, words: &[u32], path: &Path) -> Result<()> {
    save(&ImageRef::new(layout, bytemuck::cast_slice(words)).unwrap(), Alpha::AsInFile, ColourSpace::Rec709, path)
}

fn layout(format: PixelFormat, row_stride: i64) -> Layout {
    Layout { format, width: 3, height: 2, row_stride }
}

const TOP: [u8; 12] = [1, 2, 3, 255, 5, 6, 7, 255, 9, 10, 11, 128];
const BOTTOM: [u8; 12] = [13, 14, 15, 255, 17, 18, 19, 255, 21, 22, 23, 0];

#[test]
fn eight_bit_files_keep_every_byte_whatever_the_stride() {
    let folder = Folder::new("png");
    for stride in [0, 12, 17, -12, -19] {
        let l = layout(PixelFormat::Rgba8Srgb, stride);
        save_block(l, &block(l, [&TOP[..], &BOTTOM]), &folder.file("a.PNG")).unwrap();
        let loaded = load(&folder.file("a.PNG")).unwrap();
        assert_eq!((loaded.format, loaded.width, loaded.height), (PixelFormat::Rgba8Srgb, 3, 2));
        assert_eq!(loaded.pixels.as_bytes(), [TOP, BOTTOM].concat());
    }
    assert_eq!(folder.names(), ["a.PNG"]);
}

#[test]
fn blue_and_red_change_places_and_ppm_drops_alpha() {
    let folder = Folder::new("ppm");
    let l = layout(PixelFormat::Bgra8Srgb, -12);
    let words = block(l, [&TOP[..], &BOTTOM]);
    for (name, alpha) in [("a.png", 128), ("a.ppm", 255)] {
        save_block(l, &words, &folder.file(name)).unwrap();
        let loaded = load(&folder.file(name)).unwrap();
        assert_eq!(loaded.pixels.as_bytes()[8..12], [11, 10, 9, alpha], "{name}");
    }
}

#[cfg(feature = "exr")]
#[test]
fn float_files_keep_every_value() {
    use half::f16;
    let folder = Folder::new("exr");
    let top: Vec<f32> = (0..12).map(|i| i as f32 * 0.25 - 1.0).collect();
    let bottom: Vec<f32> = (0..12).map(|i| 1e4 + i as f32 * 8.0).collect();
    let wanted = [top.clone(), bottom.clone()].concat();
    let l = layout(PixelFormat::Rgba32F, -52);
    save_block(l, &block(l, [&top, &bottom]), &folder.file("a.exr")).unwrap();
    let loaded = load(&folder.file("a.exr")).unwrap();
    assert_eq!(loaded.format, PixelFormat::Rgba32F);
    assert_eq!(bytemuck::cast_slice::<u8, f32>(loaded.pixels.as_bytes()), wanted);

    let half = |row: &[f32]| row.iter().map(|value| f16::from_f32(*value)).collect::<Vec<_>>();
    let l = layout(PixelFormat::Rgba16F, 26);
    save_block(l, &block(l, [&half(&top), &half(&bottom)]), &folder.file("b.exr")).unwrap();
    let loaded = load(&folder.file("b.exr")).unwrap();
    assert_eq!(bytemuck::cast_slice::<u8, f32>(loaded.pixels.as_bytes()), wanted);

    let l = layout(PixelFormat::R32F, 0);
    save_block(l, &block(l, [&top[..3], &bottom[..3]]), &folder.file("c.exr")).unwrap();
    let loaded = load(&folder.file("c.exr")).unwrap();
    assert_eq!(bytemuck::cast_slice::<u8, f32>(loaded.pixels.as_bytes())[..4], [-1.0, -1.0, -1.0, 1.0]);
}

/// Layers as another program would read them: every channel by its name, and the attributes.
#[cfg(feature = "exr")]
#[test]
fn layers_keep_every_channel_and_attribute() {
    use ::exr::meta::attribute::{AttributeValue, Text};
    use ::exr::prelude::{FlatSamples, read_all_flat_layers_from_file};
    use half::f16;
    let folder = Folder::new("layers");
    let values = |first: usize| (first..first + 12).map(|i| i as f32 * 0.5 - 3.0).collect::<Vec<f32>>();
    let halves = values(40).into_iter().map(f16::from_f32).collect::<Vec<_>>();
    let (sky, depth, light) =
        (layout(PixelFormat::Rgba32F, 52), layout(PixelFormat::R32F, -12), layout(PixelFormat::Rgba16F, 0));
    let blocks = [
        block(sky, [&values(0), &values(12)]),
        block(depth, [&[1.0_f32, f32::INFINITY, 3.0], &[f32::NAN, 5.0, 6.0]]),
        block(light, [&halves, &halves]),
    ];
    let names: [&[&str]; 3] = [&["sky.x", "sky.y", "sky.z", "sky.g"], &["depth.Z"], &["R", "G", "B", "A"]];
    let layers = || {
        let images = [sky, depth, light].into_iter().zip(&blocks).zip(names).map(|((layout, block), names)| Layer {
            channels: names.iter().map(|name| name.to_string()).collect(),
            image: ImageRef::new(layout, bytemuck::cast_slice(block)).unwrap(),
        });
        images.collect::<Vec<_>>()
    };
    let attributes =
        [("bhr.hole.spin".into(), Attribute::Number(0.1)), ("bhr.adapter".into(), Attribute::Text("a\u{e9}b".into()))];
    let path = folder.file("layers.exr");
    save_layers(&layers(), (&attributes, ColourSpace::Rec709), Effort::default(), &path).unwrap();
    // Files of one picture are equal: a hash map would have another order each time.
    let first = fs::read(&path).unwrap();
    for _ in 0..4 {
        save_layers(&layers(), (&attributes, ColourSpace::Rec709), Effort::default(), &path).unwrap();
        assert!(fs::read(&path).unwrap() == first);
    }
    let read = read_all_flat_layers_from_file(&path).unwrap();
    let [layer] = &read.layer_data[..] else { panic!("{} layers", read.layer_data.len()) };
    let found = |name: &str| {
        let channel = layer.channel_data.list.iter().find(|channel| channel.name.eq(name)).unwrap();
        match &channel.sample_data {
            FlatSamples::F32(values) => values.clone(),
            FlatSamples::F16(values) => values.iter().map(|value| value.to_f32()).collect(),
            FlatSamples::U32(_) => panic!("{name} has whole numbers"),
        }
    };
    for (c, name) in names[0].iter().enumerate() {
        assert_eq!(found(name), values(0).chunks(4).chain(values(12).chunks(4)).map(|p| p[c]).collect::<Vec<_>>());
    }
    let depth = found("depth.Z");
    assert!(depth[1] == f32::INFINITY && depth[3].is_nan() && depth[2] == 3.0 && depth[5] == 6.0, "{depth:?}");
    assert_eq!(found("A")[..3], [18.5, 20.5, 22.5]);
    assert_eq!(layer.channel_data.list.len(), 9);
    let other = &layer.attributes.other;
    assert_eq!(other.get(&Text::from("bhr.hole.spin")), Some(&AttributeValue::F64(0.1)));
    assert_eq!(other.get(&Text::from("bhr.adapter")), Some(&AttributeValue::Text("a??b".into())));
    // Two channels of one name, and formats that are none of layers.
    let twice = layers().into_iter().chain(layers()).collect::<Vec<_>>();
    assert_eq!(
        save_layers(&twice, (&[], ColourSpace::Rec709), Effort::default(), &path).unwrap_err().kind,
        ErrorKind::InvalidArgument
    );
    let bytes = layout(PixelFormat::Rgba8Srgb, 0);
    let words = block(bytes, [&TOP, &BOTTOM]);
    let image = ImageRef::new(bytes, bytemuck::cast_slice(&words)).unwrap();
    let colours = Layer { channels: names[2].iter().map(|name| name.to_string()).collect(), image };
    assert_eq!(
        save_layers(&[colours], (&[], ColourSpace::Rec709), Effort::default(), &path).unwrap_err().kind,
        ErrorKind::Unsupported
    );
    assert_eq!(folder.names(), ["layers.exr"]);
}

#[test]
fn sixteen_bit_files_become_linear() {
    let folder = Folder::new("ppm16");
    // Maximum 65535, one pixel: white, the curve's 0.5, black.
    fs::write(folder.file("a.ppm"), b"P6 1 1 65535\n\xff\xff\x80\x00\x00\x00").unwrap();
    let loaded = load(&folder.file("a.ppm")).unwrap();
    let pixel: Vec<f32> = bytemuck::cast_slice(loaded.pixels.as_bytes()).to_vec();
    // 0.21404 is the linear value of the sRGB code 0.5.
    assert!((pixel[1] - 0.21404).abs() < 2e-5 && [pixel[0], pixel[2], pixel[3]] == [1.0, 0.0, 1.0], "{pixel:?}");
}

#[test]
fn formats_go_to_the_files_that_hold_them() {
    let folder = Folder::new("kinds");
    for (format, name, instead) in [
        (PixelFormat::Rgba8Srgb, "a.exr", ".png or .ppm"),
        (PixelFormat::Rgba8Srgb, "a.jpg", ".png or .ppm"),
        (PixelFormat::Rgba8Srgb, "png", ".png or .ppm"),
        (PixelFormat::Rgba32F, "a.png", ".exr"),
        (PixelFormat::R32F, "a.ppm", ".exr"),
    ] {
        let error = save_block(layout(format, 0), &[0; 64], &folder.file(name)).unwrap_err();
        assert_eq!(error.kind, ErrorKind::Unsupported);
        assert!(error.message.contains(instead) && error.message.contains(name), "{error}");
    }
    assert!(folder.names().is_empty());
}

#[test]
fn a_failed_save_or_load_names_the_path_and_leaves_nothing() {
    let folder = Folder::new("fail");
    let l = layout(PixelFormat::Rgba8Srgb, 0);
    fs::create_dir(folder.file("d.png")).unwrap();
    fs::write(folder.file("r.png"), "precious").unwrap();
    let mut permissions = fs::metadata(folder.file("r.png")).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(folder.file("r.png"), permissions).unwrap();
    for name in ["missing/a.png", "d.png", "r.png"] {
        let error = save_block(l, &[0; 64], &folder.file(name)).unwrap_err();
        assert_eq!(error.kind, ErrorKind::Io);
        assert!(error.message.contains(name), "{error}");
    }
    assert_eq!(fs::read(folder.file("r.png")).unwrap(), b"precious");
    assert_eq!(folder.names().len(), 2);
    fs::write(folder.file("text.png"), "no picture at all").unwrap();
    for name in ["missing.png", "d.png", "text.png"] {
        let error = load(&folder.file(name)).unwrap_err();
        assert_eq!(error.kind, ErrorKind::Io);
        assert!(error.message.contains(name), "{error}");
    }
}

#[test]
fn a_file_that_claims_to_be_huge_is_refused_before_memory_is_taken() {
    let folder = Folder::new("huge");
    fs::write(folder.file("a.ppm"), "P6 1000000 1000000 255\n").unwrap();
    let error = load(&folder.file("a.ppm")).unwrap_err();
    assert_eq!(error.kind, ErrorKind::Io);
}

/// Every byte of a small file of each kind changed, and every length cut: an image or an IO error, never a panic.
#[test]
fn broken_files_are_errors() {
    let folder = Folder::new("broken");
    let eight = layout(PixelFormat::Rgba8Srgb, 0);
    let mut kinds = vec![(eight, "a.png"), (eight, "a.ppm")];
    if cfg!(feature = "exr") {
        kinds.push((layout(PixelFormat::Rgba32F, 0), "a.exr"));
    }
    for (l, name) in kinds {
        let path = folder.file(name);
        save_block(l, &[0x3f3f_3f3f; 64], &path).unwrap();
        let whole = fs::read(&path).unwrap();
        let check = |bytes: &[u8]| {
            fs::write(&path, bytes).unwrap();
            if let Err(error) = load(&path) {
                assert!(matches!(error.kind, ErrorKind::Io | ErrorKind::OutOfMemory), "{error}");
                assert!(!error.message.contains("the codec failed"), "{error}");
                return false;
            }
            true
        };
        assert!(check(&whole));
        for length in 0..whole.len() {
            assert!(!check(&whole[..length]) || name == "a.png", "{name} cut to {length} bytes was read");
        }
        for index in 0..whole.len() {
            for change in [0x01, 0x80, 0xff] {
                let mut bytes = whole.clone();
                bytes[index] ^= change;
                check(&bytes);
            }
        }
    }
}

#[cfg(not(feature = "exr"))]
#[test]
fn a_library_without_exr_says_so() {
    let folder = Folder::new("without-exr");
    fs::write(folder.file("a.exr"), [0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0]).unwrap();
    let loaded = load(&folder.file("a.exr")).unwrap_err();
    let saved = save_block(layout(PixelFormat::Rgba32F, 0), &[0; 64], &folder.file("b.exr")).unwrap_err();
    for error in [loaded, saved] {
        assert!(error.kind == ErrorKind::Unsupported && error.message.contains("without EXR"), "{error}");
    }
    assert_eq!(folder.names(), ["a.exr"]);
}

/// The codec's panic is an error above this; here the panic is the test's own.
#[test]
fn a_panic_while_a_file_is_written_leaves_no_file() {
    let folder = Folder::new("panic");
    let path = folder.file("a.png");
    fs::write(&path, "old").unwrap();
    let saved = std::panic::catch_unwind(|| replace::with(&path, |_| panic!("in the test of a codec that panics")));
    assert!(saved.is_err());
    assert_eq!(folder.names(), ["a.png"]);
    assert_eq!(fs::read(&path).unwrap(), b"old");
}

#[test]
fn pam_comments_may_be_in_any_encoding() {
    let folder = Folder::new("latin");
    let header = b"P7\n# caf\xe9\nWIDTH 1\nHEIGHT 1\nDEPTH 1\nMAXVAL 255\nENDHDR\n\x07";
    fs::write(folder.file("a.pam"), header).unwrap();
    assert_eq!(load(&folder.file("a.pam")).unwrap().pixels.as_bytes(), [7, 7, 7, 255]);
}

/// A process of the same number may have left temporary files when it was killed.
#[test]
fn left_over_temporary_files_are_passed_over() {
    let folder = Folder::new("left-over");
    let old = (0..300).map(|i| format!(".bhr-{}-{i}.tmp", std::process::id())).collect::<Vec<_>>();
    for name in &old {
        fs::write(folder.file(name), "left").unwrap();
    }
    for _ in 0..3 {
        save_block(layout(PixelFormat::Rgba8Srgb, 0), &[0; 64], &folder.file("a.png")).unwrap();
    }
    load(&folder.file("a.png")).unwrap();
    assert_eq!(folder.names().len(), old.len() + 1);
    assert!(old.iter().all(|name| fs::read(folder.file(name)).unwrap() == b"left"));
}

/// Modes and links, which are made by calls of Unix.
#[cfg(unix)]
mod on_unix {
    use super::*;
    use std::os::unix::fs::{PermissionsExt, symlink};

    #[test]
    fn an_older_file_keeps_its_mode() {
        let folder = Folder::new("mode");
        let path = folder.file("a.png");
        let mode = || fs::metadata(&path).unwrap().permissions().mode() & 0o7777;
        fs::write(folder.file("plain"), "").unwrap();
        let plain = fs::metadata(folder.file("plain")).unwrap().permissions().mode() & 0o7777;
        save_block(layout(PixelFormat::Rgba8Srgb, 0), &[0; 64], &path).unwrap();
        assert_eq!(mode(), plain, "a new file's mode");
        for wanted in [0o600, 0o640, 0o666, 0o604, 0o777] {
            fs::set_permissions(&path, fs::Permissions::from_mode(wanted)).unwrap();
            save_block(layout(PixelFormat::Rgba8Srgb, 0), &[0; 64], &path).unwrap();
            assert_eq!(mode(), wanted);
        }
    }

    /// Links lead to another folder, by relative and absolute paths, through several links, and to places where nothing
    /// is yet.
    #[test]
    fn the_target_of_a_link_is_written() {
        let folder = Folder::new("links");
        fs::create_dir(folder.file("far")).unwrap();
        fs::write(folder.file("far/there.png"), "old").unwrap();
        for (link, target) in [
            ("relative.png", PathBuf::from("far/there.png")),
            ("absolute.png", folder.file("far/there.png")),
            ("chain.png", "relative.png".into()),
            ("dangling.png", "far/not yet.png".into()),
        ] {
            symlink(target, folder.file(link)).unwrap();
            save_block(layout(PixelFormat::Rgba8Srgb, 0), &[0; 64], &folder.file(link)).unwrap();
            assert!(fs::symlink_metadata(folder.file(link)).unwrap().is_symlink(), "{link} was replaced");
            load(&folder.file(link)).unwrap();
        }
        assert_eq!(fs::read_dir(folder.file("far")).unwrap().count(), 2);
        load(&folder.file("far/there.png")).unwrap();
        load(&folder.file("far/not yet.png")).unwrap();

        symlink("b.png", folder.file("a.png")).unwrap();
        symlink("a.png", folder.file("b.png")).unwrap();
        let error = save_block(layout(PixelFormat::Rgba8Srgb, 0), &[0; 64], &folder.file("a.png")).unwrap_err();
        assert!(error.kind == ErrorKind::Io && error.message.contains("symbolic links"), "{error}");
    }
}

#[test]
fn names_may_be_as_long_as_names_can_be() {
    let folder = Folder::new("long");
    let name = format!("{}.png", "x".repeat(251));
    save_block(layout(PixelFormat::Rgba8Srgb, 0), &[0; 64], &folder.file(&name)).unwrap();
    assert_eq!(folder.names(), [OsString::from(name)]);
}

/// An RGB file has alpha 1 in its data window; what that leaves free of the display window is 0 with alpha, and what
/// lies outside is cut.
#[cfg(feature = "exr")]
#[test]
fn data_windows_are_placed_in_display_windows() {
    use ::exr::block::writer::ChunksWriter;
    use ::exr::math::Vec2;
    use ::exr::meta::attribute::{ChannelDescription, IntegerBounds, SampleType};
    use ::exr::meta::header::{Header, ImageAttributes, LayerAttributes};
    let folder = Folder::new("windows");
    for channels in [&["A", "B", "G", "R"][..], &["B", "G", "R"]] {
        let list = channels.iter().map(|name| ChannelDescription::new(*name, SampleType::F32, false)).collect();
        let display = IntegerBounds::new(Vec2(10, -5), Vec2(4, 3));
        // The data window reaches from one column left of the display window to its second column, and from its second
        // row to below.
        let place = LayerAttributes { layer_position: Vec2(9, -4), ..Default::default() };
        let header = Header::new("a".into(), Vec2(3, 5), list)
            .with_attributes(place)
            .with_shared_attributes(ImageAttributes::new(display));
        let file = fs::File::create(folder.file("a.exr")).unwrap();
        ::exr::block::write(file, std::iter::once(header).collect(), false, |meta, chunks| {
            let mut compressor = chunks.sequential_blocks_compressor(&meta);
            for (index, block) in meta.collect_ordered_block_data(|_| {
                let rows =
                    (0..5).flat_map(|y| channels.iter().flat_map(move |_| (0..3).map(move |x| (x + 10 * y) as f32)));
                rows.flat_map(f32::to_ne_bytes).collect()
            }) {
                compressor.compress_block(index, block)?;
            }
            Ok(())
        })
        .unwrap();
        let loaded = load(&folder.file("a.exr")).unwrap();
        let pixel = |value: Option<f32>| match value {
            Some(value) if channels.len() == 4 => [value; 4],
            Some(value) => [value, value, value, 1.0],
            None => [0.0; 4],
        };
        let rows = [[None; 4], [Some(1.0), Some(2.0), None, None], [Some(11.0), Some(12.0), None, None]];
        let wanted = rows.as_flattened().iter().flat_map(|value| pixel(*value)).collect::<Vec<_>>();
        assert_eq!((loaded.width, loaded.height), (4, 3));
        assert_eq!(bytemuck::cast_slice::<u8, f32>(loaded.pixels.as_bytes()), wanted);
    }
}

#[test]
fn pam_has_every_depth() {
    let folder = Folder::new("pam");
    let load_pam = |depth: u32, most: u32, kind: &str, raster: &[u8]| {
        let header = format!("P7\nWIDTH 2\n# a comment\nHEIGHT 1\nDEPTH {depth}\nMAXVAL {most}\n{kind}\nENDHDR\n");
        fs::write(folder.file("a.pam"), [header.as_bytes(), raster].concat()).unwrap();
        load(&folder.file("a.pam"))
    };
    let bytes = |loaded: Loaded| loaded.pixels.as_bytes().to_vec();
    for (depth, most, kind, raster, wanted) in [
        (1, 1, "TUPLTYPE BLACKANDWHITE", &[0, 1][..], [0, 0, 0, 255, 255, 255, 255, 255]),
        (1, 255, "", &[7, 9], [7, 7, 7, 255, 9, 9, 9, 255]),
        (2, 15, "TUPLTYPE GRAYSCALE_ALPHA", &[1, 15, 14, 0], [17, 17, 17, 255, 238, 238, 238, 0]),
        (3, 255, "TUPLTYPE RGB", &[1, 2, 3, 4, 5, 6], [1, 2, 3, 255, 4, 5, 6, 255]),
        (4, 255, "TUPLTYPE RGB_ALPHA", &[1, 2, 3, 4, 5, 6, 7, 8], [1, 2, 3, 4, 5, 6, 7, 8]),
    ] {
        assert_eq!(bytes(load_pam(depth, most, kind, raster).unwrap()), wanted, "{kind}");
        let error = load_pam(depth, most, kind, &raster[1..]).unwrap_err();
        assert_eq!(error.kind, ErrorKind::Io);
    }
    let wide = load_pam(4, 65535, "", &[255, 255, 0, 0, 128, 0, 128, 0].repeat(2)).unwrap();
    assert_eq!(wide.format, PixelFormat::Rgba32F);
    let pixel: &[f32] = bytemuck::cast_slice(&wide.pixels.as_bytes()[16..]);
    assert!((pixel[2] - 0.21404).abs() < 2e-5 && pixel[..2] == [1.0, 0.0], "{pixel:?}");
    assert_eq!(pixel[3], 32768.0 / 65535.0);
    for (depth, most, kind, words) in [
        (5, 255, "", "DEPTH is 5"),
        (3, 0, "", "MAXVAL 0"),
        (3, 70000, "", "MAXVAL 70000"),
        (3, 255, "TUPLTYPE RGB_ALPHA", "TUPLTYPE is RGB_ALPHA"),
        (3, 255, "COLOUR 3", "line COLOUR"),
    ] {
        let error = load_pam(depth, most, kind, &[0; 16]).unwrap_err();
        assert!(error.kind == ErrorKind::Io && error.message.contains(words), "{error}");
    }
}
