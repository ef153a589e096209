// SPDX-License-Identifier: MIT OR Apache-2.0
//! A video that may be broken off at any moment and gone on with. Its frames are encoded in pieces that know nothing of
//! each other, each by an ffmpeg of its own, so that no frame's bytes depend on where the work was broken off. Whole
//! pieces are appended, as fragments, to a file that plays as far as it goes (NAME.part.mp4); when all are there, it
//! becomes an ordinary video under the name asked for. Knows no scene and no tracer.

mod boxes;
pub mod codec;
mod ffmpeg;
pub mod spherical;
#[cfg(test)]
mod tests;

use crate::encode::Done;
use crate::ending::Ending;
use crate::manifest::{Fingerprint, Made, Part};
use crate::signals::Signals;
use boxes::Video;
use codec::Codec;
pub use ffmpeg::Running;
use ffmpeg::{Ffmpeg, arguments};
use std::collections::VecDeque;
use std::ffi::OsString;
use std::fs::{File, OpenOptions};
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Pieces that have got all of their frames and are still being encoded, beside the one that gets frames. Encoders
/// look ahead, and do most of their work only then.
const MOST_BEHIND: usize = 2;

/// A piece has this many frames at least: encoders describe shorter ones in another way.
const FEWEST_FRAMES: usize = 16;

/// Bytes of a fragment. ffmpeg holds one in memory until it is full, and loses what is beyond 2 GiB.
const FRAGMENT: &str = "268435456";

/// All that decides a video's bytes, beside its pictures.
pub struct Shape {
    pub size: [u32; 2],
    /// Frames a second.
    pub rate: f64,
    pub frames: usize,
    pub codec: Codec,
    pub transparent: bool,
    /// Frames of a piece; `None`: two seconds.
    pub keyframes: Option<u32>,
    /// Boxes that are added to the description of frames.
    pub description: Vec<u8>,
}

impl Shape {
    fn piece(&self) -> usize {
        let asked = self.keyframes.map_or((2.0 * self.rate).round() as usize, |frames| frames as usize);
        asked.max(FEWEST_FRAMES)
    }

    /// The end of the piece that begins at a frame. The last one is longer, rather than one too short behind it.
    fn end_of_piece(&self, begin: usize) -> usize {
        let piece = self.piece();
        if self.frames.saturating_sub(begin) < 2 * piece { self.frames } else { begin + piece }
    }

    /// ffmpeg's arguments, but for the file's.
    fn arguments(&self) -> Vec<OsString> {
        let Self { size: [width, height], rate, codec, transparent, .. } = self;
        let [over, under] = ratio(*rate);
        let mut list = arguments(["-f", "rawvideo", "-pixel_format", codec.input(), "-video_size"]);
        list.extend(arguments([format!("{width}x{height}"), "-framerate".into(), format!("{over}/{under}")]));
        // Pixels are those of sRGB, whose primaries are Rec. 709's, or of high dynamic range, with those of Rec. 2020.
        // By exact arithmetic they are converted alike on all processors. Each encoder takes what the colours are from
        // another of two places.
        let (pixels, curve) = (codec.pixels(*transparent), codec.curve());
        let [primaries, matrix, of_scale] = codec.primaries();
        let convert = format!(
            "scale=in_range=pc:out_range=tv:out_color_matrix={of_scale}:flags=bicubic+accurate_rnd+full_chroma_int+\
             bitexact,format={pixels},setparams=range=tv:colorspace={matrix}:color_primaries={primaries}:\
             color_trc={curve}"
        );
        list.extend(arguments(["-i", "pipe:0", "-vf", &convert]));
        list.extend(arguments(codec.arguments(*transparent)));
        let keys = (2 * self.piece()).to_string();
        list.extend(arguments([
            "-g",
            &keys,
            "-colorspace",
            matrix,
            "-color_primaries",
            primaries,
            "-color_range",
            "tv",
        ]));
        list.extend(arguments(["-color_trc", curve, "-fflags", "+bitexact", "-flags:v", "+bitexact"]));
        list
    }

    /// In words that differ where the bytes of videos do.
    pub fn words(&self) -> String {
        let Self { size, rate, frames, codec, transparent, description, .. } = self;
        let (codec, piece) = (codec.name(), self.piece());
        format!("{size:?} {rate} {frames} {codec} {transparent} {piece} {description:?}")
    }
}

/// Frames a second as a ratio: those of television exactly, others to a thousandth.
pub fn ratio(rate: f64) -> [u32; 2] {
    let near = |number: f64| (rate - number).abs() < 1e-3;
    let whole = rate.round();
    if near(whole) && whole >= 1.0 {
        [whole as u32, 1]
    } else if near(rate.ceil() / 1.001) {
        [rate.ceil() as u32 * 1000, 1001]
    } else {
        [((rate * 1000.0).round() as u32).max(1), 1000]
    }
}

/// A piece that is being encoded.
struct Piece {
    ffmpeg: Ffmpeg,
    /// The place of its first frame in the video.
    begin: usize,
    /// Its frames, with the seconds that each took.
    frames: Vec<(u32, f64)>,
}

/// The files of a video.
pub struct Files {
    pub ffmpeg: PathBuf,
    /// The video under its name.
    pub whole: PathBuf,
    pub manifest: PathBuf,
}

impl Files {
    /// The video as far as it is.
    pub fn part(&self) -> PathBuf {
        let ending = self.whole.extension().unwrap_or_default().to_string_lossy().into_owned();
        self.whole.with_extension(format!("part.{ending}"))
    }

    /// The format, which ffmpeg does not see in the names of files that come and go.
    fn format(&self) -> &'static str {
        if self.whole.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("mov")) { "mov" } else { "mp4" }
    }

    /// How the names of files begin that come and go.
    fn beginning(&self) -> String {
        format!(".{}.", self.whole.file_name().unwrap_or_default().to_string_lossy())
    }

    fn passing(&self, name: impl std::fmt::Display) -> PathBuf {
        self.whole.with_file_name(format!("{}{}-{name}{PASSING}", self.beginning(), std::process::id()))
    }

    /// Removes the pieces of a program that was killed.
    pub fn tidy(&self) {
        let folder = self.whole.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let beginning = self.beginning();
        for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
            let name = entry.file_name().to_string_lossy().into_owned();
            let middle = name.strip_prefix(&beginning).and_then(|rest| rest.strip_suffix(PASSING));
            // The pieces of a video whose name begins alike are another's.
            let is_number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
            if let Some((process, piece)) = middle.and_then(|middle| middle.split_once('-'))
                && is_number(process)
                && (is_number(piece) || piece == WHOLE)
            {
                let _ = std::fs::remove_file(entry.path());
            }
        }
    }
}

const PASSING: &str = ".piece";
const WHOLE: &str = "whole";

/// A video that is being made; the claim on its name is held.
pub struct Writer {
    shape: Shape,
    files: Files,
    of: Fingerprint,
    file: File,
    /// On disk.
    there: Part,
    /// The boxes before the first fragment, once they are known.
    header: Option<Vec<u8>>,
    /// Frames that pieces have got, with those that are there.
    given: usize,
    current: Option<Piece>,
    behind: VecDeque<Piece>,
    running: Running,
    /// After a mistake nothing is added.
    failed: bool,
}

/// Encodes some black frames into nothing, as the video's will be. Errors: ffmpeg is not there, or cannot do it.
pub fn try_ffmpeg(shape: &Shape, files: &Files) -> Result<(), Ending> {
    let mut list = shape.arguments();
    list.extend(arguments(["-f", "null"]));
    let mut ffmpeg = Ffmpeg::begin(&files.ffmpeg, &list, Path::new("-"), &Running::default())?;
    let [width, height] = shape.size;
    let row = vec![0; 4 * width as usize];
    for _ in 0..2 * height {
        ffmpeg.give(&row)?;
    }
    ffmpeg.finish()
}

impl Writer {
    /// Opens a video of which `there` is there already. Errors: IO.
    pub fn open(
        shape: Shape,
        files: Files,
        of: Fingerprint,
        there: Option<Part>,
        running: Running,
    ) -> Result<Self, Ending> {
        let path = files.part();
        let opened = || -> std::io::Result<_> {
            let file = OpenOptions::new().create(true).truncate(false).read(true).write(true).open(&path)?;
            // A note of frames that the disk has lost is none.
            let length = file.metadata()?.len();
            let there = there.filter(|part| part.bytes <= length && part.frames <= shape.frames);
            Ok((file, there.unwrap_or_default()))
        };
        let (file, there) = opened().map_err(|error| Ending::io(&path, error))?;
        // Before its content changes: what another video's note says of it is true no more.
        there.note(&path, &of, &files.manifest)?;
        file.set_len(there.bytes).map_err(|error| Ending::io(&path, error))?;
        Ok(Self {
            given: there.frames,
            shape,
            files,
            of,
            file,
            there,
            header: None,
            current: None,
            behind: VecDeque::new(),
            running,
            failed: false,
        })
    }

    /// The frames that are there.
    pub fn frames(&self) -> usize {
        self.there.frames
    }

    /// Adds a picture; the frames that have come to be there, on disk. Errors: ffmpeg's, and those of files.
    pub fn add(&mut self, frame: u32, seconds: f64, pixels: &[u8]) -> Result<Vec<Done>, Ending> {
        self.unless_failed(|video| video.add_frame(frame, seconds, pixels))
    }

    /// Runs something of which a mistake is this video's end in this run. The pieces before it may still be appended.
    fn unless_failed<T>(&mut self, run: impl FnOnce(&mut Self) -> Result<T, Ending>) -> Result<T, Ending> {
        if self.failed {
            return Err(Ending::io(&self.files.whole, "it has failed"));
        }
        let result = run(self);
        if result.is_err() {
            self.failed = true;
            self.current = None;
        }
        result
    }

    fn add_frame(&mut self, frame: u32, seconds: f64, pixels: &[u8]) -> Result<Vec<Done>, Ending> {
        let mut piece = match self.current.take() {
            Some(piece) => piece,
            None => Piece { ffmpeg: self.begin_piece()?, begin: self.given, frames: Vec::new() },
        };
        piece.ffmpeg.give(pixels)?;
        piece.frames.push((frame, seconds));
        self.given += 1;
        if self.given < self.shape.end_of_piece(piece.begin) {
            self.current = Some(piece);
        } else {
            piece.ffmpeg.close();
            self.behind.push_back(piece);
        }
        let mut done = Vec::new();
        while self.behind.len() > MOST_BEHIND || self.behind.front().is_some_and(|oldest| oldest.ffmpeg.has_ended()) {
            done.extend(self.append_oldest()?);
        }
        Ok(done)
    }

    /// Appends the pieces that have got all of their frames. Errors: as [`Self::add`].
    pub fn settle(&mut self) -> Result<Vec<Done>, Ending> {
        let mut done = Vec::new();
        while !self.behind.is_empty() {
            done.extend(self.append_oldest()?);
        }
        Ok(done)
    }

    /// Makes the ordinary video of all frames, under its name. Errors: as [`Self::add`]; the end that a signal asks
    /// for.
    pub fn end(&mut self, made: &Made, signals: &Signals) -> Result<Vec<Done>, Ending> {
        let done = self.settle()?;
        self.unless_failed(|video| video.make_whole(made, signals))?;
        Ok(done)
    }

    fn make_whole(&self, made: &Made, signals: &Signals) -> Result<(), Ending> {
        let (part, passing) = (self.files.part(), self.files.passing(WHOLE));
        if self.there.frames != self.shape.frames {
            let (there, all) = (self.there.frames, self.shape.frames);
            return Err(Ending::io(&part, format!("it has {there} frames of {all}")));
        }
        let mut list = arguments(["-i"]);
        list.push(ffmpeg::name_of(&part));
        // Boxes for 360-degree players are unofficial to ffmpeg. An index at the beginning lets browsers begin at once.
        let kept = ["-map", "0", "-c", "copy", "-strict", "unofficial", "-movflags", "+faststart"];
        list.extend(arguments(kept.into_iter().chain(["-fflags", "+bitexact", "-f", self.files.format()])));
        let mut ffmpeg = Ffmpeg::begin(&self.files.ffmpeg, &list, &passing, &self.running)?;
        ffmpeg.close();
        while !ffmpeg.has_ended() {
            signals.check()?;
            std::thread::sleep(Duration::from_millis(5));
        }
        ffmpeg.finish()?;
        let whole = &self.files.whole;
        let check = || -> std::io::Result<()> {
            OpenOptions::new().write(true).open(&passing)?.sync_all()?;
            boxes::check_whole(File::open(&passing)?, self.shape.frames as u64)
        };
        check().map_err(|error| Ending::io(whole, error))?;
        // A program that is killed from here on leaves a video that counts as not made, and its fragments.
        made.announce(&self.files.manifest)?;
        std::fs::rename(&passing, whole).map_err(|error| Ending::io(whole, error))?;
        made.note(&self.files.manifest)?;
        let _ = std::fs::remove_file(&part);
        Ok(())
    }

    fn begin_piece(&self) -> Result<Ffmpeg, Ending> {
        let mut list = self.shape.arguments();
        let [over, _] = ratio(self.shape.rate);
        let ticks = ticks_per_second(over).to_string();
        list.extend(arguments(["-movflags", "+empty_moov+delay_moov+default_base_moof", "-frag_size", FRAGMENT]));
        list.extend(arguments(["-video_track_timescale", &ticks, "-f", self.files.format()]));
        Ffmpeg::begin(&self.files.ffmpeg, &list, &self.files.passing(self.given), &self.running)
    }

    fn append_oldest(&mut self) -> Result<Vec<Done>, Ending> {
        let Some(piece) = self.behind.pop_front() else { return Ok(Vec::new()) };
        let appended = self.append(piece);
        if appended.is_err() {
            // The pieces behind it would take its place.
            self.failed = true;
            self.behind.clear();
        }
        appended
    }

    fn append(&mut self, mut piece: Piece) -> Result<Vec<Done>, Ending> {
        piece.ffmpeg.finish()?;
        let path = self.files.part();
        let broken = |error| Ending::io(&path, error);
        let mut video = File::open(piece.ffmpeg.file()).and_then(Video::read).map_err(broken)?;
        boxes::remove_dependencies(&mut video.header).map_err(broken)?;
        boxes::describe(&mut video.header, &self.shape.description).map_err(broken)?;
        if piece.begin != self.there.frames {
            return Err(Ending::io(&path, format!("its piece at frame {} is missing", self.there.frames)));
        }
        self.check_header(&video.header)?;
        let [over, under] = ratio(self.shape.rate);
        let ticks = u64::from(video.ticks_per_second().map_err(broken)?);
        let per_frame = ticks * u64::from(under) / u64::from(over);
        let frames = self.write(&mut video, per_frame).map_err(broken)?;
        if frames != piece.frames.len() as u64 || per_frame * u64::from(over) != ticks * u64::from(under) {
            let (given, other) = (piece.frames.len(), format!("{frames} frames at {ticks} ticks a second"));
            return Err(Ending::io(&path, format!("ffmpeg made {other} of {given} frames at {over}/{under} a second")));
        }
        let bytes = self.file.stream_position().map_err(broken)?;
        self.there = Part { frames: self.there.frames + piece.frames.len(), bytes };
        self.there.note(&path, &self.of, &self.files.manifest)?;
        let done = piece.frames.iter().map(|(frame, seconds)| Done {
            frame: *frame,
            file: self.files.whole.clone(),
            seconds: Some(*seconds),
        });
        Ok(done.collect())
    }

    /// Errors: frames of this piece are described in another way than those that are there.
    fn check_header(&mut self, header: &[u8]) -> Result<(), Ending> {
        if self.there.frames > 0 && self.header.is_none() {
            let path = self.files.part();
            let mut there = vec![0; header.len()];
            let read = self.file.seek(SeekFrom::Start(0)).and_then(|_| self.file.read_exact(&mut there));
            read.map_err(|error| Ending::io(&path, error))?;
            self.header = Some(there);
        }
        match &self.header {
            Some(there) if *there != header => Err(Ending::io(
                &self.files.part(),
                "a piece describes its frames in another way than those that are there, as of another ffmpeg; --again \
                 begins anew",
            )),
            _ => Ok(()),
        }
    }

    /// Writes a piece behind what is there, and makes sure that it is on disk.
    fn write(&mut self, video: &mut Video, ticks_per_frame: u64) -> std::io::Result<u64> {
        self.file.seek(SeekFrom::Start(self.there.bytes))?;
        if self.there.frames == 0 {
            std::io::Write::write_all(&mut self.file, &video.header)?;
            self.header = Some(video.header.clone());
        }
        let frames = video.append(&mut self.file, self.there.frames as u64, ticks_per_frame)?;
        self.file.sync_all()?;
        Ok(frames)
    }
}

/// A multiple of the frames of a second, fine enough for players that count in it.
fn ticks_per_second(over: u32) -> u32 {
    over.saturating_mul(10_000_u32.div_ceil(over.max(1)).max(1))
}
