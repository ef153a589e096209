// SPDX-License-Identifier: MIT OR Apache-2.0
//! Frames in a video. It is there whole or not at all; until then what is there of it plays, and the next run goes on
//! with it. Knows no codec.

use crate::claim::Claim;
use crate::encode::{Done, Encoders, Frame, Pixels, lock};
use crate::ending::Ending;
use crate::frames::Names;
use crate::manifest::{Fingerprint, Made, Manifest};
use crate::order::Order;
use crate::pictures::PATIENCE;
use crate::progress::Progress;
use crate::signals::Signals;
use crate::video::codec::Codec;
use crate::video::{Files, Running, Shape, Writer, spherical, try_ffmpeg};
use bhr::renderer::Renderer;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

pub struct Film<'a> {
    pub order: &'a Order,
    pub codec: &'a Codec,
    pub names: &'a Names,
    pub again: bool,
    /// The program.
    pub ffmpeg: PathBuf,
    pub keyframes: Option<u32>,
    pub signals: &'a Signals,
}

/// How long pieces may take after a signal that have got all of their frames.
const GRACE: Duration = Duration::from_secs(20);

/// How often it is looked whether a signal has come.
const GLANCE: Duration = Duration::from_millis(50);

/// Ends all processes some time after a signal, unless `over` comes first: one that hangs would hold this program up.
fn watch(running: &Running, signals: &Signals, over: &AtomicBool) {
    let mut since = None;
    while !over.load(Ordering::Relaxed) {
        if signals.has_come() && since.get_or_insert_with(Instant::now).elapsed() > GRACE {
            running.kill();
        }
        std::thread::sleep(GLANCE);
    }
}

impl Film<'_> {
    /// Renders the frames of `list` into one video, in this order. Errors: the first mistake; of a video that is not
    /// whole all pieces stay that were.
    pub fn render(&self, list: &[u32], renderer: &mut Renderer, progress: &Progress) -> Result<(), Ending> {
        let whole = self.names.of(0);
        let first = *list.first().ok_or_else(|| Ending::usage("--frames: a video needs one frame at least"))?;
        if whole.is_dir() {
            return Err(Ending::usage(format!("--out {}: it is a folder", whole.display())));
        }
        let _claim = self.claim(&whole)?;
        let shape = self.shape(list.len(), first, renderer)?;
        let of = self.order.fingerprint_of_video(list, &shape.words());
        let files = self.files();
        files.tidy();
        let manifest = Manifest::read(&files.manifest);
        let was_there = |frame: &u32| Done { frame: *frame, file: whole.clone(), seconds: None };
        let foreign = |file: &Path, knows: bool| {
            let is_there = std::fs::metadata(file).is_ok_and(|found| found.len() > 0);
            let what =
                "it is there, and no manifest beside it says that bhr has made it; remove it, or take another name";
            if is_there && !knows { Err(Ending::usage(format!("--out: {}: {what}", file.display()))) } else { Ok(()) }
        };
        foreign(&whole, manifest.knows(&whole))?;
        foreign(&files.part(), manifest.knows(&files.part()))?;
        if !self.again && manifest.has(&whole, &of) {
            // A program that made it whole was killed before it had removed the pieces.
            if manifest.part_of(&files.part(), &of).is_some() {
                let _ = std::fs::remove_file(files.part());
            }
            progress.frames(&list.iter().map(was_there).collect::<Vec<_>>());
            return Ok(());
        }
        let there = manifest.part_of(&files.part(), &of).filter(|_| !self.again);
        try_ffmpeg(&shape, &files)?;
        let running = Running::default();
        let writer = Writer::open(shape, files, of.clone(), there, running.clone())?;
        let (there, left) = list.split_at_checked(writer.frames()).unwrap_or((&[], list));
        progress.frames(&there.iter().map(was_there).collect::<Vec<_>>());
        let writer = Arc::new(Mutex::new(writer));
        // One thread gives ffmpeg its frames, in their order; the threads that encode are ffmpeg's.
        let (_, bytes) = self.order.places()?;
        let encoders = Encoders::new(1, 1, left.len() + 1, bytes)?;
        let over = AtomicBool::new(false);
        std::thread::scope(|scope| {
            scope.spawn(|| watch(&running, self.signals, &over));
            let ended = self.render_all(left, of, &writer, &encoders, renderer, progress);
            let ended = progress.finish(encoders, ended);
            // After a signal, or where the scene has a mistake, pieces may be left that have got all of their frames.
            if ended.is_err()
                && let Ok(done) = lock(&writer).settle()
            {
                progress.frames(&done);
            }
            over.store(true, Ordering::Relaxed);
            ended
        })
    }

    fn files(&self) -> Files {
        Files { ffmpeg: self.ffmpeg.clone(), whole: self.names.of(0), manifest: self.names.manifest() }
    }

    /// Encodes some frames into nothing. Errors: ffmpeg is not there, or cannot make such a video.
    pub fn try_encoder(&self, list: &[u32], renderer: &mut Renderer) -> Result<(), Ending> {
        let first = list.first().copied().unwrap_or(0);
        try_ffmpeg(&self.shape(list.len(), first, renderer)?, &self.files())
    }

    /// Waits for the claim on the video, which one program at a time makes.
    fn claim(&self, whole: &Path) -> Result<Claim, Ending> {
        loop {
            self.signals.check()?;
            if let Some(claim) = Claim::on(whole, true)? {
                return Ok(claim);
            }
            std::thread::sleep(PATIENCE);
        }
    }

    fn shape(&self, frames: usize, first: u32, renderer: &mut Renderer) -> Result<Shape, Ending> {
        let layout = self.order.layout();
        let margins = self.order.panorama(first, renderer)?;
        // QuickTime's .mov files have no place for these boxes.
        let mp4 = self.names.of(0).extension().is_some_and(|ending| ending.eq_ignore_ascii_case("mp4"));
        let description = margins.filter(|_| mp4).map(|margins| spherical::equirect(self.order.stereo, margins));
        Ok(Shape {
            size: [layout.width, layout.height],
            rate: self.order.rate,
            frames,
            codec: *self.codec,
            transparent: self.order.transparent,
            keyframes: self.keyframes,
            description: description.unwrap_or_default(),
        })
    }

    fn render_all(
        &self,
        list: &[u32],
        of: Fingerprint,
        writer: &Arc<Mutex<Writer>>,
        encoders: &Encoders,
        renderer: &mut Renderer,
        progress: &Progress,
    ) -> Result<(), Ending> {
        let mut lost = 0;
        let begin = Instant::now();
        for frame in list {
            self.signals.check()?;
            for written in encoders.written() {
                progress.frames(&written?);
            }
            let frame = *frame;
            let mut pixels = encoders.pixels()?;
            let begin = Instant::now();
            self.order.render(frame, &mut pixels, renderer, &mut lost, self.signals)?;
            let seconds = begin.elapsed().as_secs_f64();
            let writer = writer.clone();
            let write = move |pixels: &[u32]| lock(&writer).add(frame, seconds, bytemuck::cast_slice(pixels));
            encoders.order(Frame { pixels, write: Box::new(write) })?;
        }
        let adapter = renderer.adapter();
        let made = Made {
            file: self.names.of(0),
            of,
            adapter: adapter.name.clone(),
            backend: adapter.backend.to_string(),
            seconds: begin.elapsed().as_secs_f64(),
        };
        let (writer, signals) = (writer.clone(), self.signals.clone());
        let end = move |_: &[u32]| lock(&writer).end(&made, &signals);
        encoders.order(Frame { pixels: Pixels::default(), write: Box::new(end) })
    }
}
