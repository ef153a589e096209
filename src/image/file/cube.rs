// SPDX-License-Identifier: MIT OR Apache-2.0
//! Reads .cube files: three-dimensional LUTs as text, by Adobe's Cube LUT Specification 1.0 (2013). Its lines are
//! comments, which begin with #, keywords, and then the nodes, red changing fastest. Each keyword may come once; an
//! unknown one is an error, as in the reader that the specification has, because it may say what the numbers mean.
//! Beside those of the specification LUT_3D_INPUT_RANGE is read, in which DaVinci Resolve has one domain for all
//! components. One-dimensional tables are not read.

use super::load::load_text;
use super::support::{about, io_error};
use crate::allocate::with_room;
use crate::error::{Error, Number, Result};
use crate::image::kept::FromFile;
use crate::image::lut::{Lut, NODES};
use std::path::Path;

/// The largest file that is read: 120 bytes for each node of the largest table, of which programs write 27 to 40.
const MOST_BYTES: usize = 32 << 20;

/// Text from a file is shown in messages up to this number of characters.
const SHOWN: usize = 40;

impl FromFile for Lut {
    /// Reads a .cube file. Errors: IO for a file that is not there, not readable, larger than 32 MiB, not UTF-8 or no
    /// LUT of three dimensions, with the line; OUT_OF_MEMORY.
    fn from_file(path: &Path) -> Result<Self> {
        let text = load_text(path, MOST_BYTES)?;
        Self::of_cube(&text).map_err(|error| about("read", path, &error))
    }
}

impl Lut {
    /// The LUT in the text of a .cube file. Errors: IO, with the line; OUT_OF_MEMORY.
    pub fn of_cube(text: &str) -> Result<Self> {
        parse(text)
    }
}

/// The keywords before the nodes.
#[derive(Default)]
struct Header {
    title: Option<()>,
    side: Option<u32>,
    low: Option<[f32; 3]>,
    high: Option<[f32; 3]>,
}

impl Header {
    /// Takes a line of a keyword and what follows it.
    fn take(&mut self, keyword: &str, rest: &str) -> Result<()> {
        match keyword {
            "TITLE" => once(keyword, &mut self.title, ()),
            "LUT_3D_SIZE" => {
                let side = rest.parse().ok().filter(|side| Lut::check_side(*side).is_ok());
                let (least, most) = (Lut::LEAST_SIDE, Lut::MOST_SIDE);
                let wrong =
                    || io_error(format!("LUT_3D_SIZE is {}; it must be an integer in [{least}, {most}]", shown(rest)));
                once(keyword, &mut self.side, side.ok_or_else(wrong)?)
            }
            "DOMAIN_MIN" => once(keyword, &mut self.low, numbers(keyword, rest)?),
            "DOMAIN_MAX" => once(keyword, &mut self.high, numbers(keyword, rest)?),
            "LUT_3D_INPUT_RANGE" => {
                let [low, high] = numbers(keyword, rest)?;
                once(keyword, &mut self.low, [low; 3])?;
                once(keyword, &mut self.high, [high; 3])
            }
            "LUT_1D_SIZE" => {
                Err(io_error("LUT_1D_SIZE: tables of one dimension are not read; LUT_3D_SIZE must be there alone"))
            }
            _ => Err(io_error(format!(
                "the keyword {} is unknown; known are TITLE, LUT_3D_SIZE, DOMAIN_MIN, DOMAIN_MAX, LUT_3D_INPUT_RANGE",
                shown(keyword)
            ))),
        }
    }

    fn domain(&self) -> Result<[[f32; 3]; 2]> {
        let [low, high] = Lut::UNIT;
        let domain = [self.low.unwrap_or(low), self.high.unwrap_or(high)];
        Lut::check_domain(domain).map_err(|error| io_error(error.message))?;
        Ok(domain)
    }
}

fn parse(text: &str) -> Result<Lut> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    // Lines end with LF or CR LF, in files of old systems with CR alone.
    let end = if text.contains('\n') { '\n' } else { '\r' };
    let (mut header, mut nodes) = (Header::default(), Vec::new());
    let mut wanted = 0;
    for (line, number) in text.split(end).zip(1_u64..) {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let here = |error: Error| Error::new(error.kind, format!("line {number}: {}", error.message));
        let (first, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        if nodes.is_empty() && first.parse::<f32>().is_err() && !first.starts_with(NUMERIC) {
            header.take(first, rest.trim()).map_err(here)?;
            continue;
        }
        let Some(side) = header.side else {
            return Err(here(io_error(format!("{}: LUT_3D_SIZE must come before the colours", shown(line)))));
        };
        if nodes.is_empty() {
            header.domain().map_err(here)?;
            wanted = Lut::node_count(side);
            nodes = with_room(wanted, NODES)?;
        }
        if nodes.len() == wanted {
            let message = format!("{} follows {wanted} colours; LUT_3D_SIZE {side} has no more", shown(line));
            return Err(here(io_error(message)));
        }
        let [r, g, b] = numbers("the colour", line).map_err(here)?;
        nodes.push([r, g, b, 0.0]);
    }
    let Some(side) = header.side else { return Err(io_error("it has no LUT_3D_SIZE")) };
    if nodes.len() != Lut::node_count(side) {
        let (count, wanted) = (nodes.len(), Lut::node_count(side));
        return Err(io_error(format!("it ends after {count} colours; LUT_3D_SIZE {side} has {wanted}")));
    }
    Ok(Lut::over(side, header.domain()?, nodes))
}

/// Characters that numbers begin with.
const NUMERIC: [char; 13] = ['+', '-', '.', '0', '1', '2', '3', '4', '5', '6', '7', '8', '9'];

/// Keeps what a keyword says. Errors: IO for one that comes again.
fn once<T>(keyword: &str, kept: &mut Option<T>, value: T) -> Result<()> {
    match kept.replace(value) {
        None => Ok(()),
        Some(_) => Err(io_error(format!("{keyword}: the file has said this before; it may do so once"))),
    }
}

/// Numbers, and nothing else. `what`: their name.
fn numbers<const COUNT: usize>(what: &str, text: &str) -> Result<[f32; COUNT]> {
    let mut all = [0.0; COUNT];
    let mut words = text.split_whitespace();
    for (number, index) in all.iter_mut().zip(0..) {
        let Some(word) = words.next() else {
            return Err(io_error(format!("{what} has {index} numbers; it must have {COUNT}")));
        };
        let Ok(value) = word.parse::<f32>() else {
            return Err(io_error(format!("{what} has {}; it must be a number", shown(word))));
        };
        if !value.is_finite() {
            let value = Number(value.into());
            return Err(io_error(format!("{what} has {}, which is {value}; it must be finite", shown(word))));
        }
        *number = value;
    }
    match words.next() {
        None => Ok(all),
        Some(more) => Err(io_error(format!("{what} has {} after {COUNT} numbers; it must have no more", shown(more)))),
    }
}

/// Text of a file as messages have it: in quotes, without control characters, and not long.
fn shown(text: &str) -> String {
    let begin = text.chars().take(SHOWN).collect::<String>();
    if begin.len() < text.len() { format!("{begin:?}...") } else { format!("{begin:?}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ErrorKind;

    const EIGHT: &str = "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 0 1\n1 0 1\n0 1 1\n1 1 1\n";

    fn read(text: &str) -> Lut {
        parse(text).unwrap_or_else(|error| panic!("{text}: {error}"))
    }

    #[test]
    fn a_table_is_read_with_its_domain_in_any_form() {
        let plain = read(&format!("LUT_3D_SIZE 2\n{EIGHT}"));
        assert_eq!((plain.side(), plain.domain()), (2, Lut::UNIT));
        assert_eq!(plain.nodes()[1], [1.0, 0.0, 0.0, 0.0], "red changes fastest");
        assert_eq!(plain.nodes()[6], [0.0, 1.0, 1.0, 0.0]);
        let long = format!(
            "\u{feff}# by hand\r\nTITLE \"a look # of \u{e4}\"\r\n\r\nDOMAIN_MAX 1 2.5 3e0\r\n\
             DOMAIN_MIN -1 .5 +0.25\r\n\tLUT_3D_SIZE\t2  \r\n#\r\n{}# the end",
            EIGHT.replace('\n', "\r\n").replace(' ', " \t ")
        );
        let whole = read(&long);
        assert_eq!(whole.domain(), [[-1.0, 0.5, 0.25], [1.0, 2.5, 3.0]]);
        assert_eq!(whole.nodes(), plain.nodes());
        assert_eq!(read(&long.replace("\r\n", "\r")).nodes(), plain.nodes());
        let range = read(&format!("LUT_3D_SIZE 2\nLUT_3D_INPUT_RANGE -0.5 2\n{EIGHT}"));
        assert_eq!(range.domain(), [[-0.5; 3], [2.0; 3]]);
        let numbers = read(&format!("LUT_3D_SIZE 2\n{}", EIGHT.replacen("0 0 0", "-1e3 1e30 .5", 1)));
        assert_eq!(numbers.nodes()[0], [-1000.0, 1e30, 0.5, 0.0], "no limit to what colours become");
    }

    #[test]
    fn mistakes_are_told_with_line_value_and_limit() {
        let seven = EIGHT.replacen("0 0 0\n", "", 1);
        let table = format!("LUT_3D_SIZE 2\n{EIGHT}");
        let long = "x".repeat(1000);
        let cases: [(&str, &[&str]); 27] = [
            ("", &["no LUT_3D_SIZE"]),
            ("# nothing\n", &["no LUT_3D_SIZE"]),
            ("LUT_3D_SIZE 2\n", &["after 0 colours", "has 8"]),
            (EIGHT, &["line 1", "\"0 0 0\"", "LUT_3D_SIZE must come before"]),
            (&format!("LUT_3D_SIZE 2\n{seven}"), &["after 7 colours", "has 8"]),
            (&format!("{table}0.25 0.5 0.75\n"), &["line 10", "\"0.25 0.5 0.75\"", "no more"]),
            (&format!("{table}TITLE \"late\"\n"), &["line 10", "TITLE", "no more"]),
            ("LUT_3D_SIZE 1\n", &["line 1", "\"1\"", "[2, 65]"]),
            ("\n\nLUT_3D_SIZE 66\n", &["line 3", "\"66\"", "[2, 65]"]),
            ("LUT_3D_SIZE 4000000000\n", &["line 1", "\"4000000000\"", "[2, 65]"]),
            ("LUT_3D_SIZE 99999999999999999999\n", &["[2, 65]"]),
            ("LUT_3D_SIZE -2\n", &["\"-2\"", "[2, 65]"]),
            ("LUT_3D_SIZE 2.5\n", &["\"2.5\"", "an integer"]),
            ("LUT_3D_SIZE\n", &["line 1", "an integer"]),
            ("LUT_3D_SIZE 2 2\n", &["\"2 2\"", "an integer"]),
            ("LUT_3D_SIZE 2\nLUT_3D_SIZE 2\n", &["line 2", "LUT_3D_SIZE", "once"]),
            ("DOMAIN_MIN 0 0 0\nLUT_3D_INPUT_RANGE 0 1\n", &["line 2", "once"]),
            ("LUT_1D_SIZE 33\n", &["line 1", "LUT_1D_SIZE", "one dimension"]),
            ("LUT_3D_SIZES 33\n", &["line 1", "\"LUT_3D_SIZES\"", "known are"]),
            (&long, &["line 1", "xxx\"..."]),
            (&table.replacen("1 1 1", "1 nan 1", 1), &["line 9", "\"nan\"", "NaN", "finite"]),
            (&table.replacen("0 0 0", "inf 0 0", 1), &["line 2", "\"inf\"", "finite"]),
            (&table.replacen("0 0 0", "0 0 -1e99", 1), &["line 2", "\"-1e99\"", "finite"]),
            (&table.replacen("0 0 0", "0 0", 1), &["line 2", "2 numbers", "3"]),
            (&table.replacen("0 0 0", "0 0 0 0", 1), &["line 2", "\"0\" after 3"]),
            (&table.replacen("0 1 0", "0 one\u{1b} 0", 1), &["line 4", "\"one\\u{1b}\"", "a number"]),
            ("DOMAIN_MIN 0 0\n", &["line 1", "DOMAIN_MIN", "2 numbers"]),
        ];
        for (text, words) in cases {
            let error = parse(text).expect_err(text);
            assert_eq!(error.kind, ErrorKind::Io);
            assert!(words.iter().all(|word| error.message.contains(word)), "{}, not {words:?}", error.message);
            assert!(error.message.len() < 250 && !error.message.contains(char::is_control), "{}", error.message);
        }
    }

    #[test]
    fn domains_have_a_width() {
        for (domain, words) in [
            ("DOMAIN_MIN 0 1 0", ["green", "1"]),
            ("DOMAIN_MIN 0 0 2", ["blue", "2"]),
            ("DOMAIN_MAX 1e-7 1 1", ["red", "1e-7"]),
            ("DOMAIN_MAX 1 2e6 1", ["green", "2000000"]),
            ("DOMAIN_MIN -1e38 0 0", ["red", "-1e38"]),
        ] {
            for text in [format!("LUT_3D_SIZE 2\n{domain}\n{EIGHT}"), format!("{domain}\nLUT_3D_SIZE 2\n{EIGHT}")] {
                let error = parse(&text).expect_err(domain);
                assert!(words.iter().all(|word| error.message.contains(word)), "{}", error.message);
                assert!(error.message.contains("line 3"), "{}", error.message);
            }
        }
    }

    /// Texts that are broken at random are errors that fit on a line, or tables of finite numbers.
    #[test]
    fn broken_texts_are_errors() {
        let bits =
            ["\n", " ", "nan", "1e99", "-", "#", "\"", "LUT_3D_SIZE 65\n", "TITLE", "\u{0}", "\u{fffd}", "1 1 1\n"];
        let whole = format!("TITLE \"a\"\nDOMAIN_MIN 0 0 0\nLUT_3D_SIZE 2\nDOMAIN_MAX 1 1 1\n{EIGHT}");
        let mut state = 1_u32;
        let mut pick = |count: usize| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as usize % count
        };
        let (mut good, mut bad) = (0, 0);
        for _ in 0..5000 {
            let mut text = whole.clone();
            for _ in 0..=pick(3) {
                let begin = pick(text.len());
                let Some(begin) = (begin..=text.len()).find(|at| text.is_char_boundary(*at)) else { continue };
                let end = (begin + pick(6)..=text.len()).find(|at| text.is_char_boundary(*at)).unwrap_or(begin);
                text.replace_range(begin..end, if pick(2) == 0 { bits[pick(bits.len())] } else { "" });
                if text.is_empty() {
                    break;
                }
            }
            match parse(&text) {
                Ok(lut) => {
                    assert_eq!(lut.nodes().len(), Lut::node_count(lut.side()));
                    assert!(lut.nodes().iter().flatten().all(|number| number.is_finite()), "{text}");
                    good += 1;
                }
                Err(error) => {
                    assert!(error.message.len() < 300 && !error.message.contains('\n'), "{}", error.message);
                    bad += 1;
                }
            }
        }
        assert!(good > 100 && bad > 1000, "{good} {bad}");
    }

    #[test]
    fn files_that_are_none_are_refused() {
        let folder = tempfile_folder();
        let (lut, folder_itself) = (folder.join("a.cube"), folder.clone());
        assert_eq!(Lut::from_file(&lut).expect_err("no file").kind, ErrorKind::Io);
        let error = Lut::from_file(&folder_itself).expect_err("a folder");
        assert!(error.message.contains("regular file"), "{error}");
        std::fs::write(&lut, b"LUT_3D_SIZE 2\n\xff").expect("a file");
        let error = Lut::from_file(&lut).expect_err("no UTF-8");
        assert!(error.message.contains("UTF-8") && error.message.contains("a.cube"), "{error}");
        std::fs::File::create(&lut).and_then(|file| file.set_len(MOST_BYTES as u64 + 1)).expect("a file");
        let error = Lut::from_file(&lut).expect_err("a large file");
        assert!(error.message.contains(&MOST_BYTES.to_string()), "{error}");
        std::fs::write(&lut, format!("LUT_3D_SIZE 2\n{EIGHT}")).expect("a file");
        assert_eq!(Lut::from_file(&lut).expect("a table").side(), 2);
        std::fs::remove_dir_all(folder).expect("a folder that was made here");
    }

    fn tempfile_folder() -> std::path::PathBuf {
        let folder = std::env::temp_dir().join(format!("bhr-cube-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        folder
    }
}
