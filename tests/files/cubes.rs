// SPDX-License-Identifier: MIT OR Apache-2.0
//! LUTs in .cube files: valid ones with faults put in are a LUT or an error, and ones that are made to do harm are an
//! error, soon and without much memory.

use crate::random::{Random, count_from};
use bhr::error::ErrorKind;
use bhr::image::{FromFile, Lut};
use std::time::{Duration, Instant};

/// Words and numbers that files may have where others belong.
const ODD: [&str; 20] = [
    "",
    "#",
    "nan",
    "-inf",
    "1e999",
    "-1e-320",
    "0x10",
    "1,5",
    "\"",
    "\u{feff}",
    "\u{0}",
    "4294967296",
    "-1",
    "65",
    "66",
    "LUT_3D_SIZE",
    "LUT_1D_SIZE",
    "DOMAIN_MAX",
    "DOMAIN_MIN 1 1 1",
    "TITLE",
];

/// A valid file of three nodes a side.
fn seed() -> Vec<String> {
    let head = ["TITLE \"seed\"", "# a comment", "LUT_3D_SIZE 3", "DOMAIN_MIN 0 0 0", "DOMAIN_MAX 1 2 1", ""];
    let nodes = (0..27).map(|i| format!("{} {} {}", i % 3, f64::from(i / 3 % 3) * 0.4, f64::from(i / 9) - 0.5));
    head.into_iter().map(str::to_owned).chain(nodes).collect()
}

fn below(random: &mut Random, count: usize) -> usize {
    (random.next() * count as f64) as usize
}

/// Puts one to four faults into the lines of a file.
fn broken(random: &mut Random) -> String {
    let mut lines = seed();
    for _ in 0..1 + below(random, 4) {
        let (at, other) = (below(random, lines.len()), below(random, lines.len()));
        let odd = random.pick(&ODD);
        match below(random, 6) {
            0 => drop(lines.remove(at)),
            1 => lines.insert(at, odd.to_owned()),
            2 => lines.swap(at, other),
            3 => lines.insert(at, lines[other].clone()),
            4 => {
                let mut words: Vec<_> = lines[at].split(' ').map(str::to_owned).collect();
                let word = below(random, words.len());
                words[word] = odd.to_owned();
                lines[at] = words.join(" ");
            }
            _ => lines[at] = lines[at].chars().take(below(random, 8)).collect(),
        }
    }
    lines.join(random.pick(&["\n", "\r\n", "\r"]))
}

#[test]
fn broken_cubes_are_luts_or_errors() {
    assert_eq!(Lut::of_cube(&seed().join("\n")).unwrap().side(), 3);
    let mut random = Random(20_261_130);
    let (mut read, mut refused) = (0, 0);
    for _ in 0..count_from("BHR_TEST_CUBES", 4000, 100_000) {
        let text = broken(&mut random);
        match Lut::of_cube(&text) {
            Ok(lut) => {
                let [low, high] = lut.domain();
                assert!((0..3).all(|c| low[c] < high[c]), "{text}");
                assert_eq!(lut.nodes().len(), Lut::node_count(lut.side()), "{text}");
                assert!(lut.nodes().iter().flatten().all(|number| number.is_finite()), "{text}");
                read += 1;
            }
            Err(error) => {
                assert!(error.kind == ErrorKind::Io && error.message.len() < 400, "{text}\n{error}");
                refused += 1;
            }
        }
    }
    assert!(read > 100 && refused > 100, "{read} {refused}");
}

#[test]
fn cubes_that_are_made_to_do_harm_are_errors_soon() {
    let folder = crate::Folder::new();
    let path = folder.0.join("look.cube");
    let node = "0.5 0.5 0.5\n";
    let cases: [(&str, Vec<u8>, &str); 7] = [
        ("a size beyond numbers", b"LUT_3D_SIZE 99999999999999999999\n0 0 0\n".to_vec(), "LUT_3D_SIZE"),
        ("a size without nodes", b"LUT_3D_SIZE 65\n".to_vec(), "0 colours"),
        ("more nodes than its size", ["LUT_3D_SIZE 2\n", &node.repeat(1 << 20)].concat().into(), "follows 8 colours"),
        ("a line without end", [b"LUT_3D_SIZE 2\n".to_vec(), vec![b'1'; 1 << 24]].concat(), "line 2"),
        ("a title without end", [b"TITLE ".to_vec(), vec![b'x'; 1 << 24]].concat(), "LUT_3D_SIZE"),
        ("a file that is too large", vec![b'#'; 40 << 20], "33554432"),
        ("bytes that are no text", vec![0xff; 1 << 16], "UTF-8"),
    ];
    for (name, bytes, words) in cases {
        std::fs::write(&path, bytes).unwrap();
        let begin = Instant::now();
        let error = Lut::from_file(&path).unwrap_err();
        assert!(error.message.contains(words) && error.message.len() < 600, "{name}: {error}");
        assert!(begin.elapsed() < Duration::from_secs(10), "{name}: {:?}", begin.elapsed());
    }
}
