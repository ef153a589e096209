// SPDX-License-Identifier: MIT OR Apache-2.0
//! OpenEXR files as other programs write them, by their channels and primaries, and as bhr saves them.

use super::tests::Folder;
use super::*;
use crate::error::{ErrorKind, Result};
use crate::image::{ColourSpace, ImageRef, Layout, PixelFormat};
use ::exr::block;
use ::exr::block::writer::ChunksWriter;
use ::exr::compression::Compression;
use ::exr::math::Vec2;
use ::exr::meta::attribute::{ChannelDescription, Chromaticities, IntegerBounds, LineOrder, SampleType};
use ::exr::meta::header::{Header, ImageAttributes};
use ::exr::meta::{BlockDescription, MetaData};
use half::f16;
use std::fs::{self, File};
use std::path::Path;

/// Parts of 2 x 1 pixels, whose channels, sorted by name, are the first and second of these values.
fn write(path: &Path, parts: &[&[(&str, [f32; 2])]], chromaticities: Option<Chromaticities>) {
    let headers = parts.iter().zip(["a", "b", "c"]).map(|(channels, name)| {
        let list = channels.iter().map(|(name, _)| ChannelDescription::new(*name, SampleType::F32, false)).collect();
        let mut shared = ImageAttributes::new(IntegerBounds::from_dimensions(Vec2(2, 1)));
        shared.chromaticities = chromaticities;
        Header::new(name.into(), Vec2(2, 1), list).with_shared_attributes(shared)
    });
    let file = File::create(path).unwrap();
    block::write(file, headers.collect(), false, |meta, chunks| {
        let mut compressor = chunks.sequential_blocks_compressor(&meta);
        for (index, block) in meta.collect_ordered_block_data(|index| {
            parts[index.layer].iter().flat_map(|(_, values)| values.map(f32::to_ne_bytes)).flatten().collect()
        }) {
            compressor.compress_block(index, block)?;
        }
        Ok(())
    })
    .unwrap();
}

/// The first pixel of a file of these parts.
fn pixel(parts: &[&[(&str, [f32; 2])]], chromaticities: Option<Chromaticities>) -> Result<[f32; 4]> {
    let folder = Folder::new("channels");
    write(&folder.file("a.exr"), parts, chromaticities);
    let loaded = load(&folder.file("a.exr"))?;
    let floats: &[f32] = bytemuck::cast_slice(loaded.pixels.as_bytes());
    Ok(*floats.first_chunk().unwrap())
}

#[test]
fn a_file_is_read_by_the_channels_that_are_its_picture() {
    // Channels that hold what the picture does not have are 9.
    const OTHER: [f32; 2] = [9.0; 2];
    let (one, two, three, half) = ([1.0, 5.0], [2.0, 5.0], [3.0, 5.0], [0.5, 5.0]);
    for (channels, wanted) in [
        (&[("Y", two)][..], [2.0, 2.0, 2.0, 1.0]),
        (&[("A", half), ("Y", two)], [2.0, 2.0, 2.0, 0.5]),
        (&[("A", half), ("B", three), ("G", two), ("R", one), ("Y", OTHER)], [1.0, 2.0, 3.0, 0.5]),
        // Another layer's alpha is none of the picture's.
        (&[("beauty.B", three), ("beauty.G", two), ("beauty.R", one), ("id.A", OTHER)], [1.0, 2.0, 3.0, 1.0]),
        (&[(".B", three), (".G", two), (".R", one)], [1.0, 2.0, 3.0, 1.0]),
        // Blender's layers: ambient occlusion comes first by the alphabet.
        (
            &[
                ("ViewLayer.AO.B", OTHER),
                ("ViewLayer.AO.G", OTHER),
                ("ViewLayer.AO.R", OTHER),
                ("ViewLayer.Combined.A", half),
                ("ViewLayer.Combined.B", three),
                ("ViewLayer.Combined.G", two),
                ("ViewLayer.Combined.R", one),
                ("ViewLayer.Depth.Z", OTHER),
            ],
            [1.0, 2.0, 3.0, 0.5],
        ),
        // Without a known name the first that has all three.
        (
            &[
                ("a.G", OTHER),
                ("a.R", OTHER),
                ("b.B", three),
                ("b.G", two),
                ("b.R", one),
                ("c.B", OTHER),
                ("c.G", OTHER),
                ("c.R", OTHER),
            ],
            [1.0, 2.0, 3.0, 1.0],
        ),
        (&[("depth.Z", OTHER), ("intensity.Y", two)], [2.0, 2.0, 2.0, 1.0]),
    ] {
        assert_eq!(pixel(&[channels], None).unwrap(), wanted, "{channels:?}");
    }
    // Colour in a later part comes before grey in an earlier one.
    let parts: &[&[(&str, [f32; 2])]] = &[&[("Y", OTHER)], &[("B", three), ("G", two), ("R", one)], &[("Z", OTHER)]];
    assert_eq!(pixel(parts, None).unwrap(), [1.0, 2.0, 3.0, 1.0]);
}

#[test]
fn where_no_channel_fits_the_message_names_those_that_are_there() {
    for (channels, words) in [
        (&[("Z", [1.0; 2]), ("beauty.G", [1.0; 2]), ("beauty.R", [1.0; 2])][..], "it has Z, beauty.G, beauty.R"),
        (&[("BY", [0.0; 2]), ("RY", [0.0; 2]), ("Y", [1.0; 2])], "it has BY, RY, Y"),
        // Ends of names are none.
        (&[("MyB", [0.0; 2]), ("MyG", [0.0; 2]), ("MyR", [0.0; 2])], "it has MyB, MyG, MyR"),
    ] {
        let error = pixel(&[channels], None).unwrap_err();
        assert!(error.kind == ErrorKind::Io && error.message.contains(words), "{error}");
    }
    let names = (10..40).map(|i| format!("layer{i}.Z")).collect::<Vec<_>>();
    let many = names.iter().map(|name| (name.as_str(), [0.0; 2])).collect::<Vec<_>>();
    let error = pixel(&[&many], None).unwrap_err();
    assert!(error.message.contains("layer21.Z and 18 more"), "{error}");
}

/// Chroma of half the picture's size, as rgba files of luminance and chroma have it.
#[test]
fn subsampled_chroma_is_refused_with_what_to_do() {
    let folder = Folder::new("chroma");
    let path = folder.file("a.exr");
    write(&path, &[&[("BY", [0.0; 2]), ("RY", [0.0; 2]), ("Y", [1.0; 2])]], None);
    let mut bytes = fs::read(&path).unwrap();
    for name in [b"BY\0", b"RY\0"] {
        let at = bytes.windows(3).position(|window| window == name).unwrap();
        // The name, its type, four bytes, and then how many pixels have one value, along x and y.
        bytes[at + 11] = 2;
        bytes[at + 15] = 2;
    }
    fs::write(&path, bytes).unwrap();
    let error = load(&path).unwrap_err();
    assert!(error.kind == ErrorKind::Io && error.message.contains("save it with R, G and B"), "{error}");
}

/// BT.2020, by the matrix of ITU-R BT.2087; ACES, whose white stays white.
#[test]
fn chromaticities_are_heeded() {
    let of = |[red, green, blue, white]: [[f32; 2]; 4]| {
        let [red, green, blue, white] = [red, green, blue, white].map(|[x, y]| Vec2(x, y));
        Some(Chromaticities { red, green, blue, white })
    };
    let rgb = |[r, g, b]: [f32; 3], places| pixel(&[&[("B", [b; 2]), ("G", [g; 2]), ("R", [r; 2])]], places).unwrap();
    let near = |found: [f32; 4], wanted: [f32; 3]| {
        assert!((0..3).all(|c| (found[c] - wanted[c]).abs() < 2e-4) && found[3] == 1.0, "{found:?} {wanted:?}");
    };
    let bt2020 = of([[0.708, 0.292], [0.17, 0.797], [0.131, 0.046], [0.3127, 0.329]]);
    near(rgb([0.0, 1.0, 0.0], bt2020), [0.0, 1.1329, 0.0]);
    near(rgb([0.5, 0.25, 0.25], bt2020), [0.665_12, 0.218_85, 0.245_45]);
    let aces = of([[0.7347, 0.2653], [0.0, 1.0], [0.0001, -0.077], [0.32168, 0.33767]]);
    near(rgb([7.0; 3], aces), [7.0; 3]);
    // Numbers stay as they are, also negative ones, in Rec. 709 and where the places are none.
    let rec709 = of([[0.64, 0.33], [0.3, 0.6], [0.15, 0.06], [0.3127, 0.329]]);
    for places in [None, rec709, of([[0.0; 2]; 4]), of([[f32::NAN; 2]; 4]), of([[1e30, -1e30]; 4])] {
        assert_eq!(rgb([-1.0, 0.5, 1e4], places), [-1.0, 0.5, 1e4, 1.0]);
    }
    let grey = pixel(&[&[("Y", [0.25; 2])]], bt2020).unwrap();
    near(grey, [0.25; 3]);
}

/// Every reader takes scan lines from the top down, ZIP, and primaries that are told; half floats stay half floats.
#[test]
fn files_are_saved_as_every_program_reads_them() {
    let folder = Folder::new("zip");
    let path = folder.file("a.exr");
    let words = [0x3c00_3800_u32; 4 * 70 * 40];
    for (format, kind, names) in [
        (PixelFormat::Rgba32F, SampleType::F32, &["A", "B", "G", "R"][..]),
        (PixelFormat::Rgba16F, SampleType::F16, &["A", "B", "G", "R"]),
        (PixelFormat::R32F, SampleType::F32, &["B", "G", "R"]),
    ] {
        let image = ImageRef::new(Layout::packed(format, 70, 40), bytemuck::cast_slice(&words)).unwrap();
        save(&image, Alpha::Premultiplied, ColourSpace::Rec709, &path).unwrap();
        let meta = MetaData::read_from_file(&path, true).unwrap();
        let [header] = &meta.headers[..] else { panic!("{} parts", meta.headers.len()) };
        assert_eq!(header.compression, Compression::ZIP16);
        assert_eq!((header.blocks, header.line_order), (BlockDescription::ScanLines, LineOrder::Increasing));
        let white = header.shared_attributes.chromaticities.map(|places| (places.white, places.green));
        assert_eq!(white, Some((Vec2(0.3127, 0.329), Vec2(0.3, 0.6))));
        let channels = header.channels.list.iter().map(|channel| (channel.name.to_string(), channel.sample_type));
        assert_eq!(channels.collect::<Vec<_>>(), names.iter().map(|name| (name.to_string(), kind)).collect::<Vec<_>>());
        // Blocks follow one another from the top down.
        let mut chunks = block::read(File::open(&path).unwrap(), true).unwrap().all_chunks(true).unwrap();
        let rows = std::iter::from_fn(|| chunks.next()).map(|chunk| match chunk.unwrap().compressed_block {
            block::chunk::CompressedBlock::ScanLine(lines) => lines.y_coordinate,
            other => panic!("{other:?}"),
        });
        assert_eq!(rows.collect::<Vec<_>>(), [0, 16, 32]);
    }
}

/// Layers of halves and floats come back as they are, with their attributes, and are saved as the same bytes again.
#[test]
fn all_channels_of_a_file_come_back() {
    let folder = Folder::new("all-channels");
    let (path, again) = (folder.file("a.exr"), folder.file("b.exr"));
    let halves = (0..4 * 70 * 40).map(|i| f16::from_f32(i as f32 - 300.5)).collect::<Vec<_>>();
    let floats = (0..70 * 40).map(|i| 1.0 / i as f32).collect::<Vec<_>>();
    let light = Layout::packed(PixelFormat::Rgba16F, 70, 40);
    let depth = Layout::packed(PixelFormat::R32F, 70, 40);
    let layers = [
        Layer {
            channels: ["R", "G", "B", "A"].map(String::from).into(),
            image: ImageRef::new(light, bytemuck::cast_slice(&halves)).unwrap(),
        },
        Layer { channels: vec!["depth.Z".into()], image: ImageRef::new(depth, bytemuck::cast_slice(&floats)).unwrap() },
    ];
    let attributes = vec![("a".into(), Attribute::Number(0.1)), ("b".into(), Attribute::Text("KERR".into()))];
    save_layers(&layers, (&attributes, ColourSpace::AcesCg), Effort::default(), &path).unwrap();
    let mut all = load_channels(&path).unwrap();
    assert_eq!((all.width, all.height, &all.attributes, all.space), (70, 40, &attributes, ColourSpace::AcesCg));
    let names = all.list.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>();
    assert_eq!(names, ["A", "B", "G", "R", "depth.Z"]);
    let green = halves.iter().skip(1).step_by(4).copied().collect();
    assert!(all.list[2].1 == Values::Halves(green) && all.list[4].1 == Values::Floats(floats));
    save_channels(&all, Effort::default(), &again).unwrap();
    assert!(fs::read(&path).unwrap() == fs::read(&again).unwrap());
    // A file that lacks an end, and channels of another size.
    let bytes = fs::read(&path).unwrap();
    fs::write(&again, &bytes[..bytes.len() - 9]).unwrap();
    assert_eq!(load_channels(&again).unwrap_err().kind, ErrorKind::Io);
    all.list[3].1 = Values::Floats(vec![0.0; 7]);
    let error = save_channels(&all, Effort::default(), &path).unwrap_err();
    assert!(error.kind == ErrorKind::InvalidArgument && error.message.contains("R has 7 values"), "{error}");
    assert!(fs::read(&path).unwrap() == bytes);
    // Two parts are two pictures.
    write(&path, &[&[("R", [1.0; 2])], &[("G", [1.0; 2])]], None);
    assert_eq!(load_channels(&path).unwrap_err().kind, ErrorKind::Unsupported);
}
