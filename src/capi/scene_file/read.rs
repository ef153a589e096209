// SPDX-License-Identifier: MIT OR Apache-2.0
//! A scene's text, read: TOML into values and tracks. Every mistake is told by line and column.

use super::tracks::{Curve, Key, Track};
use super::values::{Aim, Misfit, Orbit, Path as WorldLine, Render, Section, Shot, Turn, Values};
use super::{FORMAT, MOST_BYTES, SceneFile};
use crate::capi::camera::BhrCamera;
use crate::capi::disk::BhrDisk;
use crate::capi::field_list::{PRESET_MATTERS, PRESETS};
use crate::capi::fields::{Field, Kind, Value, Words};
use crate::capi::preset;
use crate::capi::region::BhrRegion;
use crate::capi::versioned::Versioned;
use crate::capi::volume::{BhrHotSpot, BhrVolume};
use crate::error::{Error, Number, Result};
use crate::image;
use crate::scene::{HotSpot, Scene, Volume};
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};
use toml_parser::Source;
use toml_parser::lexer::TokenKind;

type Given<'t> = Spanned<DeValue<'t>>;

/// A mistake, and the bytes of the text that it is in.
struct Mistake {
    span: Range<usize>,
    message: String,
}

type Checked<T> = std::result::Result<T, Mistake>;

fn mistake<T>(span: Range<usize>, message: impl Into<String>) -> Checked<T> {
    Err(Mistake { span, message: message.into() })
}

/// [`SceneFile::parse`].
pub(super) fn read(text: &str, folder: &Path) -> Result<SceneFile> {
    if text.len() > MOST_BYTES {
        let size = text.len();
        return Err(Error::argument(format!("the scene's text has {size} bytes; it may have {MOST_BYTES}")));
    }
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    image::probe(text.len() as u64 * BYTES_A_BYTE)?;
    check_depth(text).map_err(|mistake| told(text, &mistake))?;
    let table = DeTable::parse(text).map_err(|error| {
        let whole = Mistake { span: error.span().unwrap_or_default(), message: one_line(error.message()) };
        told(text, &whole)
    })?;
    let mut reader = Reader::default();
    let file = reader.scene(table.get_ref(), folder).map_err(|mistake| told(text, &mistake))?;
    reader.check(&file).map_err(|(misfit, seconds)| {
        let span = reader.place_of(&misfit);
        let when = seconds.map(|seconds| format!(" at {seconds} s")).unwrap_or_default();
        let (section, error) = misfit;
        let told = told(text, &Mistake { span, message: format!("{}{when}: {}", section.name(), error.message) });
        Error::new(error.kind, told.message)
    })?;
    Ok(file)
}

/// The most memory that the parser takes for a byte of text: a list in a list is two.
const BYTES_A_BYTE: u64 = 160;

/// The deepest nesting of lists and tables, and the longest chain of dotted names. Scenes have 4 and 2.
const DEEPEST: usize = 16;
const LONGEST_CHAIN: usize = 8;

/// The parser's tables are dropped one within another, on the caller's stack.
fn check_depth(text: &str) -> Checked<()> {
    let (mut depth, mut dots) = (0_usize, 0_usize);
    for token in Source::new(text).lex() {
        match token.kind() {
            TokenKind::LeftSquareBracket | TokenKind::LeftCurlyBracket => (depth, dots) = (depth + 1, 0),
            TokenKind::RightSquareBracket | TokenKind::RightCurlyBracket => depth = depth.saturating_sub(1),
            TokenKind::Dot => dots += 1,
            TokenKind::Comma | TokenKind::Equals | TokenKind::Newline => dots = 0,
            _ => {}
        }
        if depth > DEEPEST || dots > LONGEST_CHAIN {
            let span = token.span().start()..token.span().end();
            return mistake(
                span,
                format!("nested too deeply: {DEEPEST} lists or tables, {LONGEST_CHAIN} dots are allowed"),
            );
        }
    }
    Ok(())
}

/// The parser's messages go on over lines, for terminals.
fn one_line(message: &str) -> String {
    message.split('\n').map(str::trim).filter(|line| !line.is_empty()).collect::<Vec<_>>().join(", ")
}

/// The mistake with its line and column, which count from 1, columns in characters.
fn told(text: &str, Mistake { span, message }: &Mistake) -> Error {
    let before = text.get(..span.start).unwrap_or(text);
    let line = before.bytes().filter(|byte| *byte == b'\n').count() + 1;
    let column = before.rsplit('\n').next().map_or(0, |last| last.chars().count()) + 1;
    Error::argument(format!("line {line}, column {column}: {message}"))
}

/// The kind of a value, for messages.
fn kind_of(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "text",
        DeValue::Integer(_) => "an integer",
        DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a table",
    }
}

fn expected<T>(name: &str, what: &str, given: &Given<'_>) -> Checked<T> {
    mistake(given.span(), format!("{name} is {}; it must be {what}", kind_of(given.get_ref())))
}

fn number(name: &str, what: &str, given: &Given<'_>) -> Checked<f64> {
    let value = match given.get_ref() {
        // Digits that overflow are no infinity, which is written "inf".
        DeValue::Float(float) => {
            let value = float.as_str().parse::<f64>().ok();
            value.filter(|value| !value.is_infinite() || float.as_str().ends_with("inf"))
        }
        DeValue::Integer(integer) => i128::from_str_radix(integer.as_str(), integer.radix()).ok().map(|n| n as f64),
        _ => return expected(name, what, given),
    };
    value.map_or_else(|| mistake(given.span(), format!("{name} is no number of 64 bits")), Ok)
}

/// A time of the film, in seconds.
fn seconds(name: &str, given: &Given<'_>) -> Checked<f64> {
    let value = number(name, "a time in seconds", given)?;
    match value.abs() <= MOST_SECONDS {
        true => Ok(value),
        false => mistake(given.span(), format!("{name} is {}; it must lie within +-{MOST_SECONDS:e} s", Number(value))),
    }
}

fn integer(name: &str, most: u64, given: &Given<'_>) -> Checked<u64> {
    let DeValue::Integer(integer) = given.get_ref() else { return expected(name, "an integer", given) };
    match i128::from_str_radix(integer.as_str(), integer.radix()) {
        Ok(value) if (0..=i128::from(most)).contains(&value) => Ok(value as u64),
        _ => mistake(given.span(), format!("{name} is {integer}; it must lie in [0, {most}]")),
    }
}

fn boolean(name: &str, given: &Given<'_>) -> Checked<bool> {
    given.get_ref().as_bool().map_or_else(|| expected(name, "true or false", given), Ok)
}

fn list<'g, 't>(name: &str, what: &str, given: &'g Given<'t>) -> Checked<&'g DeArray<'t>> {
    given.get_ref().as_array().map_or_else(|| expected(name, what, given), Ok)
}

fn table<'g, 't>(name: &str, given: &'g Given<'t>) -> Checked<&'g DeTable<'t>> {
    given.get_ref().as_table().map_or_else(|| expected(name, "a table", given), Ok)
}

/// The path that a table has by a name, if it has one.
fn path(name: &str, table: &Given<'_>, folder: &Path) -> Checked<Option<PathBuf>> {
    let Some(given) = table.get_ref().get(name) else { return Ok(None) };
    match given.get_ref().as_str() {
        None => expected(name, "a path", given),
        Some(text) if text.is_empty() || text.contains('\0') => mistake(given.span(), format!("{name} is no path")),
        Some(text) => Ok(Some(folder.join(text))),
    }
}

fn word<T: Copy>(name: &str, words: &[(&'static str, T)], given: &Given<'_>) -> Checked<T> {
    let known = || words.iter().map(|(word, _)| format!("\"{word}\"")).collect::<Vec<_>>().join(", ");
    let Some(text) = given.get_ref().as_str() else { return expected(name, &format!("one of {}", known()), given) };
    match words.iter().find(|(word, _)| word.eq_ignore_ascii_case(text)) {
        Some((_, value)) => Ok(*value),
        None => mistake(given.span(), format!("{name} is \"{text}\"; known are {}", known())),
    }
}

fn bits(name: &str, words: Words<u32>, given: &Given<'_>) -> Checked<u32> {
    let mut all = 0;
    for one in list(name, "a list of words", given)? {
        all |= match one.get_ref() {
            DeValue::Integer(_) => integer(name, u32::MAX.into(), one)? as u32,
            _ => word(name, words, one)?,
        };
    }
    Ok(all)
}

/// An angle: a number of radians, or text such as "45 deg".
fn angle(name: &str, given: &Given<'_>) -> Checked<f64> {
    const WHAT: &str = "a number of radians, or degrees as in \"45 deg\"";
    let Some(text) = given.get_ref().as_str() else { return number(name, WHAT, given) };
    match text.strip_suffix("deg").and_then(|degrees| degrees.trim().parse::<f64>().ok()) {
        Some(degrees) if degrees.is_finite() => Ok(degrees.to_radians()),
        _ => mistake(given.span(), format!("{name} is \"{text}\"; it must be {WHAT}")),
    }
}

fn value(name: &str, kind: Kind, given: &Given<'_>) -> Checked<Value> {
    Ok(match kind {
        Kind::Numbers(1) => Value::Numbers(std::iter::once(number(name, "a number", given)?).collect()),
        Kind::Angle => Value::Numbers(std::iter::once(angle(name, given)?).collect()),
        Kind::Numbers(count) => {
            let what = format!("a list of {count} numbers");
            let parts = list(name, &what, given)?;
            if parts.len() != count {
                return mistake(given.span(), format!("{name} has {} numbers; it must be {what}", parts.len()));
            }
            Value::Numbers(parts.iter().map(|part| number(name, "numbers", part)).collect::<Checked<_>>()?)
        }
        Kind::Word(words) => Value::Word(word(name, words, given)?),
        Kind::Bits(words) => Value::Bits(bits(name, words, given)?),
        Kind::Count => Value::Count(integer(name, u32::MAX.into(), given)? as u32),
        Kind::Seed => Value::Seed(integer(name, u64::MAX, given)?),
    })
}

/// A key that a table may not have. Errors: always, with those that it may have.
fn unknown<T>(key: &Spanned<std::borrow::Cow<'_, str>>, of: Section, known: &[&str]) -> Checked<T> {
    let (name, known) = (key.get_ref(), known.join(", "));
    mistake(key.span(), format!("{} has no \"{name}\"; it has {known}", of.name()))
}

/// The places and the tracks that are read beside the values.
#[derive(Default)]
struct Reader {
    tracks: Vec<Track>,
    /// Where sections, and the fields in them (else ""), stand in the text.
    places: BTreeMap<(Section, &'static str), Range<usize>>,
}

impl Reader {
    fn scene(&mut self, given: &DeTable<'_>, folder: &Path) -> Checked<SceneFile> {
        if let Some(version) = given.get("version") {
            let version_given = integer("version", u64::MAX, version)?;
            if version_given != FORMAT {
                let message = format!("version is {version_given}; this library reads {FORMAT}");
                return mistake(version.span(), message);
            }
        }
        let mut values = Values::of(&base(given)?, None);
        let (mut map, mut lut) = (None, None);
        let moment = Section::Moment;
        for (key, one) in given {
            match key.get_ref().as_ref() {
                "version" | "preset" | "preset_matter" => {}
                "hole" => self.struct_of(&mut values, Section::Hole, one, &[])?,
                "camera" => self.camera(&mut values, 0, one)?,
                "disk" => match one.get_ref() {
                    DeValue::Boolean(false) => values.disk = None,
                    _ => {
                        values.disk.get_or_insert_with(BhrDisk::defaults);
                        self.struct_of(&mut values, Section::Disk, one, &[])?;
                    }
                },
                "volumes" => self.volumes(&mut values, one)?,
                "hot_spots" => {
                    let spots = array_of("hot_spots", HotSpot::MOST, one)?;
                    values.hot_spots = spots.iter().map(|_| BhrHotSpot::defaults()).collect();
                    for (i, spot) in spots.iter().enumerate() {
                        self.struct_of(&mut values, Section::HotSpot(i), spot, &[])?;
                    }
                }
                "sky" => {
                    self.struct_of(&mut values, Section::Sky, one, &["map"])?;
                    map = path("map", one, folder)?;
                }
                "film" => {
                    self.film(&mut values, one)?;
                    lut = path("lut", one, folder)?;
                }
                "quality" => self.struct_of(&mut values, Section::Quality, one, &[])?,
                "region" => {
                    values.region = Some(BhrRegion::defaults());
                    self.struct_of(&mut values, Section::Region, one, &[])?;
                }
                "render" => {
                    values.render = Some(Render::default());
                    self.struct_of(&mut values, Section::Render, one, &[])?;
                }
                "cuts" => {}
                name => match moment.fields().iter().find(|field| field.name == name) {
                    Some(field) => self.field(&mut values, moment, field, one)?,
                    None => return unknown(key, moment, &KNOWN),
                },
            }
        }
        if let Some(cuts) = given.get("cuts") {
            self.cuts(&mut values, cuts)?;
        }
        let keys = self.tracks.iter().map(|track| track.keys.len()).sum::<usize>();
        let times = times_of(&self.tracks, &values).len();
        if keys > MOST_KEYS || times > MOST_TIMES {
            let message =
                format!("the scene has {keys} keys of {times} times; {MOST_KEYS} of {MOST_TIMES} are allowed");
            return mistake(0..0, message);
        }
        Ok(SceneFile { values, tracks: std::mem::take(&mut self.tracks), map, lut })
    }

    /// Sets the fields of a section's struct from a table, whose other keys are `more`.
    fn struct_of(&mut self, values: &mut Values, section: Section, given: &Given<'_>, more: &[&str]) -> Checked<()> {
        self.places.insert((section, ""), given.span());
        let fields = section.fields();
        for (key, one) in table(&section.name(), given)? {
            let name = key.get_ref().as_ref();
            match fields.iter().find(|field| field.name == name) {
                Some(field) => self.field(values, section, field, one)?,
                None if more.contains(&name) => {}
                None => {
                    let known = fields.iter().map(|field| field.name).chain(more.iter().copied()).collect::<Vec<_>>();
                    return unknown(key, section, &known);
                }
            }
        }
        Ok(())
    }

    /// Sets a field, or keeps what it is at each of some times.
    fn field(
        &mut self,
        values: &mut Values,
        section: Section,
        field: &'static Field,
        given: &Given<'_>,
    ) -> Checked<()> {
        self.places.insert((section, field.name), given.span());
        let value = match given.get_ref() {
            DeValue::Table(track) if !matches!(section, Section::Render | Section::Region) => {
                let keys = keys(field, track, given.span())?;
                let first = keys.first().map(|key| key.value.clone());
                self.tracks.push(Track { section, field, keys });
                first
            }
            _ => Some(value(field.name, field.kind, given)?),
        };
        if let (Some(value), Some(bytes)) = (value, values.bytes_mut(section)) {
            field.set(bytes, &value);
        }
        Ok(())
    }

    fn camera(&mut self, values: &mut Values, shot: usize, given: &Given<'_>) -> Checked<()> {
        const MORE: [&str; 4] = ["orbit", "proper_time", "look_at", "turn"];
        self.struct_of(values, Section::Camera(shot), given, &MORE)?;
        let has = |name: &str| given.get_ref().get(name).is_some();
        if let Some(orbit) = given.get_ref().get("orbit") {
            if let Some(other) = ["position", "forward", "up"].iter().find(|name| has(name)) {
                return mistake(orbit.span(), format!("a camera has an orbit, or {other}; it must be one of them"));
            }
            self.add(values, shot, |shot| shot.orbit = Some(Orbit::default()));
            self.struct_of(values, Section::Orbit(shot), orbit, &[])?;
            if orbit.get_ref().get("distance").is_none() {
                return mistake(orbit.span(), "an orbit has no distance");
            }
        }
        if let Some(way) = given.get_ref().get("proper_time") {
            self.add(values, shot, |shot| shot.path = Some(WorldLine::default()));
            for field in Section::Path(shot).fields() {
                self.field(values, Section::Path(shot), field, way)?;
            }
        }
        let looks = given.get_ref().get("look_at");
        if let Some(look) = looks.filter(|_| has("forward")) {
            return mistake(look.span(), "a camera has look_at, or forward; it must be one of them");
        }
        // A camera that is set somewhere looks at the hole, unless it is said where to.
        if looks.is_some() || (has("position") && !has("forward")) {
            self.add(values, shot, |shot| shot.aim = Some(Aim::default()));
        }
        if let Some(look) = looks {
            for field in Section::Aim(shot).fields() {
                self.field(values, Section::Aim(shot), field, look)?;
            }
        }
        if let Some(turn) = given.get_ref().get("turn") {
            self.add(values, shot, |shot| shot.turn = Some(Turn::default()));
            self.struct_of(values, Section::Turn(shot), turn, &[])?;
        }
        Ok(())
    }

    fn add(&mut self, values: &mut Values, shot: usize, what: impl FnOnce(&mut Shot)) {
        if let Some(shot) = values.shots.get_mut(shot) {
            what(shot);
        }
    }

    fn cuts(&mut self, values: &mut Values, given: &Given<'_>) -> Checked<()> {
        for (cut, shot) in array_of("cuts", MOST_CUTS, given)?.iter().zip(1..) {
            let parts = table("a cut", cut)?;
            if let Some((key, _)) = parts.iter().find(|(key, _)| !["at", "camera"].contains(&key.get_ref().as_ref())) {
                return mistake(key.span(), format!("a cut has no \"{}\"; it has at, camera", key.get_ref()));
            }
            let (Some(at), Some(camera)) = (parts.get("at"), parts.get("camera")) else {
                return mistake(cut.span(), "a cut has at, a time in seconds, and a camera");
            };
            let begin = seconds("at", at)?;
            let before = values.shots.last().map_or(f64::NEG_INFINITY, |shot| shot.at);
            if begin <= before {
                return mistake(at.span(), format!("at is {begin}; it must be later than the cut before, {before}"));
            }
            values.shots.push(Shot { at: begin, ..Shot::of(BhrCamera::defaults()) });
            self.camera(values, shot, camera)?;
        }
        Ok(())
    }

    fn volumes(&mut self, values: &mut Values, given: &Given<'_>) -> Checked<()> {
        let volumes = array_of("volumes", Volume::MOST, given)?;
        values.volumes = volumes.iter().map(|_| BhrVolume::defaults()).collect();
        values.of_preset = None;
        for (i, volume) in volumes.iter().enumerate() {
            self.struct_of(values, Section::Volume(i), volume, &["of_preset"])?;
            if let Some(own) = volume.get_ref().get("of_preset")
                && boolean("of_preset", own)?
                && values.of_preset.replace(i).is_some()
            {
                return mistake(own.span(), "two volumes are of_preset; one may be");
            }
        }
        Ok(())
    }

    fn film(&mut self, values: &mut Values, given: &Given<'_>) -> Checked<()> {
        self.struct_of(values, Section::Film, given, &["glare_is_optional", "grain_moves", "lut"])?;
        let has = |name: &str| given.get_ref().get(name).is_some();
        values.glare_is_optional &= !(has("bloom") || has("beam_fwhm"));
        if let Some(optional) = given.get_ref().get("glare_is_optional") {
            values.glare_is_optional = boolean("glare_is_optional", optional)?;
        }
        let is_grain = |track: &Track| track.section == Section::Film && track.field.name == "grain";
        let has_grain = has("grain") && (values.film.grain != 0.0 || self.tracks.iter().any(is_grain));
        values.grain_moves = has_grain && !has("grain_seed");
        if let Some(moves) = given.get_ref().get("grain_moves") {
            values.grain_moves = boolean("grain_moves", moves)?;
        }
        Ok(())
    }

    /// Makes the scene, as it is at the beginning and at every key and cut. Errors: what does not fit, and the time,
    /// where the scene moves.
    fn check(&self, file: &SceneFile) -> std::result::Result<(), (Misfit, Option<f64>)> {
        let scene = Scene::default();
        let at = |seconds: f64| file.evaluated(file.values.clone(), seconds, &scene).map(|_| ());
        if file.tracks.is_empty() && file.values.shots.len() < 2 {
            return at(0.0).map_err(|misfit| (misfit, None));
        }
        let times = times_of(&file.tracks, &file.values);
        times.into_iter().try_for_each(|seconds| at(seconds).map_err(|misfit| (misfit, Some(seconds))))
    }

    /// Where a misfit stands: the field that its message names first, else its table.
    fn place_of(&self, (section, error): &Misfit) -> Range<usize> {
        let words = error.message.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').collect::<Vec<_>>();
        let near = |of: Section| of == *section || (of.shot().is_some() && of.shot() == section.shot());
        let named = self.places.iter().filter(|((of, name), _)| near(*of) && !name.is_empty());
        let named = named.filter_map(|((_, name), span)| Some((words.iter().position(|word| word == name)?, span)));
        let whole = || self.places.get(&(*section, ""));
        named.min_by_key(|(place, _)| *place).map(|(_, span)| span).or_else(whole).cloned().unwrap_or(0..0)
    }
}

/// The beginning, and all times of keys and cuts, each once.
fn times_of(tracks: &[Track], values: &Values) -> Vec<f64> {
    let keys = tracks.iter().flat_map(|track| &track.keys).map(|key| key.time);
    let cuts = values.shots.iter().map(|shot| shot.at).filter(|at| at.is_finite());
    let mut times = std::iter::once(0.0).chain(keys).chain(cuts).collect::<Vec<_>>();
    times.sort_by(f64::total_cmp);
    times.dedup();
    times
}

/// The keys of a scene's text that are no fields.
const KNOWN: [&str; 19] = [
    "version",
    "preset",
    "preset_matter",
    "time",
    "shutter",
    "effects",
    "effect_strengths",
    "view",
    "hole",
    "camera",
    "cuts",
    "disk",
    "volumes",
    "hot_spots",
    "sky",
    "film",
    "quality",
    "region",
    "render",
];

/// The most keys of a scene, the most times that they have, at each of which the scene is tried when it is read, and
/// the most cuts.
const MOST_KEYS: usize = 100_000;
const MOST_TIMES: usize = 20_000;
const MOST_CUTS: usize = 200;

/// The longest times of keys and cuts: thirty years.
const MOST_SECONDS: f64 = 1e9;

/// The scene that the text changes: that of a new context, with the look that the text names.
fn base(given: &DeTable<'_>) -> Checked<Scene> {
    let mut scene = Scene::default();
    let matter = given.get("preset_matter");
    let Some(look) = given.get("preset") else {
        return match matter {
            Some(matter) => mistake(matter.span(), "preset_matter is there, and no preset"),
            None => Ok(scene),
        };
    };
    let number = word("preset", PRESETS, look)?;
    let preset = preset::named(number).or_else(|error| mistake(look.span(), error.message))?;
    let Some(given) = matter else {
        preset.apply(&mut scene);
        return Ok(scene);
    };
    // AUTO depends on the machine, and a scene must not.
    let number = word("preset_matter", PRESET_MATTERS.get(1..).unwrap_or_default(), given)?;
    let matter = preset::matter_of(number).or_else(|error| mistake(given.span(), error.message))?;
    preset.apply_with(matter, &mut scene);
    Ok(scene)
}

fn array_of<'g, 't>(name: &str, most: usize, given: &'g Given<'t>) -> Checked<&'g DeArray<'t>> {
    let tables = list(name, "a list of tables", given)?;
    match tables.len() {
        count if count > most => mistake(given.span(), format!("{name} are {count}; there may be {most}")),
        _ => Ok(tables),
    }
}

/// The keys of a field: { keys = [[time, value], [time, value, "curve"]], curve = "linear" }.
fn keys(field: &Field, given: &DeTable<'_>, whole: Range<usize>) -> Checked<Vec<Key>> {
    let name = field.name;
    if let Some((key, _)) = given.iter().find(|(key, _)| !["keys", "curve"].contains(&key.get_ref().as_ref())) {
        let message = format!("{name} has no \"{}\"; what changes with time has keys, curve", key.get_ref());
        return mistake(key.span(), message);
    }
    let curve = |given: &Given<'_>| {
        let curve = word("curve", &Curve::WORDS, given)?;
        match field.kind.is_continuous() || curve == Curve::Hold {
            true => Ok(curve),
            false => {
                mistake(given.span(), format!("{name} has no values between its keys: its curve must be \"hold\""))
            }
        }
    };
    let usual = if field.kind.is_continuous() { Curve::Linear } else { Curve::Hold };
    let usual = given.get("curve").map_or(Ok(usual), curve)?;
    let Some(all) = given.get("keys") else {
        return mistake(whole, format!("{name} has no keys, as in {{ keys = [[0, VALUE], [5, VALUE]] }}"));
    };
    let mut keys: Vec<Key> = Vec::new();
    for one in list("keys", "a list of keys", all)? {
        const WHAT: &str = "[time, value] or [time, value, \"curve\"]";
        let parts = list("a key", WHAT, one)?;
        let (Some(time_given), Some(value_given), 2..=3) = (parts.first(), parts.get(1), parts.len()) else {
            return mistake(one.span(), format!("a key has {} parts; it must be {WHAT}", parts.len()));
        };
        let time = seconds("a key's time", time_given)?;
        if let Some(before) = keys.last().filter(|before| before.time > time) {
            let (time, before) = (Number(time), Number(before.time));
            return mistake(time_given.span(), format!("a key's time is {time}; the key before has {before}"));
        }
        let is_third = keys.len() > 1 && keys[keys.len() - 2].time == time;
        if is_third {
            return mistake(
                time_given.span(),
                format!("three keys have the time {}; two may, for a cut", Number(time)),
            );
        }
        let curve = parts.get(2).map_or(Ok(usual), curve)?;
        keys.push(Key { time, value: value(name, field.kind, value_given)?, curve });
    }
    if keys.is_empty() {
        return mistake(all.span(), format!("{name} has an empty list of keys"));
    }
    Ok(keys)
}
