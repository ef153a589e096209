// SPDX-License-Identifier: MIT OR Apache-2.0
//! Frames in files of their own. A frame's bytes depend on the scene and its number only; a file is there whole or not
//! at all; what is there is passed over. So the same command may be run again, on several machines at once, and be
//! killed at any time. Knows no video.

use crate::claim::Claim;
use crate::encode::{Done, Encoders, Frame, Written};
use crate::ending::Ending;
use crate::frames::Names;
use crate::manifest::{Made, Manifest};
use crate::order::{Order, Place};
use crate::progress::Progress;
use crate::signals::Signals;
use bhr::image::{Alpha, Attribute, Effort, Layer, save, save_layers};
use bhr::renderer::Renderer;
use bhr::scene_file::parameters;
use std::collections::VecDeque;
use std::panic::resume_unwind;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// How long other programs' frames are waited for before they are looked at again.
pub const PATIENCE: Duration = Duration::from_millis(200);

pub struct Pictures<'a> {
    pub order: &'a Order,
    pub names: &'a Names,
    pub again: bool,
    pub effort: Effort,
    pub signals: &'a Signals,
    /// Set where one of several renderers has failed, for the others to end.
    pub failed: AtomicBool,
}

/// The frames that no renderer has taken.
type Left = Mutex<VecDeque<u32>>;

fn lock(left: &Left) -> MutexGuard<'_, VecDeque<u32>> {
    left.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A picture that is to be written.
struct Picture {
    /// The light and what is beside it.
    places: Vec<Place>,
    transparent: bool,
    attributes: Vec<(String, Attribute)>,
    effort: Effort,
    made: Made,
    manifest: PathBuf,
}

impl Pictures<'_> {
    /// Renders frames by several renderers, which share the list as programs would; on as many threads as `encoders`
    /// they are written. Errors: the first mistake; frames that were rendered before it are written.
    pub fn render(
        &self,
        list: &[u32],
        encoders: usize,
        renderers: &mut [Renderer],
        progress: &Progress,
    ) -> Result<(), Ending> {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let encoders = (if encoders == 0 { cores } else { encoders }).div_ceil(renderers.len().max(1));
        let left = &Mutex::new(list.iter().copied().collect::<VecDeque<_>>());
        std::thread::scope(|scope| {
            let threads = renderers.iter_mut().map(|renderer| {
                scope.spawn(move || {
                    let result = self.render_by(renderer, left, encoders, progress);
                    self.failed.fetch_or(result.is_err(), Ordering::Relaxed);
                    result
                })
            });
            let threads = threads.collect::<Vec<_>>();
            let ended = threads.into_iter().map(|thread| thread.join().unwrap_or_else(|panic| resume_unwind(panic)));
            ended.fold(Ok(()), Result::and)
        })
    }

    fn render_by(
        &self,
        renderer: &mut Renderer,
        left: &Left,
        encoders: usize,
        progress: &Progress,
    ) -> Result<(), Ending> {
        let (_, bytes) = self.order.places()?;
        let mut encoders = Encoders::new(encoders, lock(left).len(), bytes)?;
        let ended = self.render_all(left, &mut encoders, renderer, progress);
        progress.finish(encoders, ended)
    }

    fn render_all(
        &self,
        left: &Left,
        encoders: &mut Encoders,
        renderer: &mut Renderer,
        progress: &Progress,
    ) -> Result<(), Ending> {
        let mut lost = 0;
        let mut manifest = Manifest::read(&self.names.manifest());
        // Frames that other programs are making.
        let mut others = Vec::new();
        loop {
            self.signals.check()?;
            if self.failed.load(Ordering::Relaxed) {
                return Ok(());
            }
            for written in encoders.written() {
                progress.frames(&written?);
            }
            let Some(frame) = lock(left).pop_front() else {
                if others.is_empty() {
                    return Ok(());
                }
                // They are there in a while, or their programs are gone.
                std::thread::sleep(PATIENCE);
                manifest.refresh();
                lock(left).extend(others.drain(..));
                continue;
            };
            let file = self.names.of(frame);
            if self.is_there(frame, &file, &manifest) {
                progress.frame(&Done { frame, file, seconds: None });
                continue;
            }
            let Some(claim) = Claim::on(&file, false)? else {
                others.push(frame);
                continue;
            };
            // Another program may have finished the frame between the two questions.
            manifest.refresh();
            if self.is_there(frame, &file, &manifest) {
                progress.frame(&Done { frame, file, seconds: None });
                continue;
            }
            let made = self.frame(frame, file, claim, encoders, renderer, &mut lost)?;
            encoders.order(made)?;
        }
    }

    /// Whether a frame's file is there, whole, and of this scene as far as that is known. A tile that nobody has noted
    /// could not be joined.
    fn is_there(&self, frame: u32, file: &Path, manifest: &Manifest) -> bool {
        !self.again && manifest.has(file, &self.order.fingerprint(frame))
    }

    fn attributes(&self, made: &bhr::scene::Made) -> Vec<(String, Attribute)> {
        let mut list = parameters(made);
        if let Some(stereo) = self.order.stereo {
            list.push(("bhr.stereo".into(), Attribute::Text(stereo.name().into())));
        }
        list
    }

    fn frame(
        &self,
        frame: u32,
        file: PathBuf,
        claim: Claim,
        encoders: &mut Encoders,
        renderer: &mut Renderer,
        lost: &mut u32,
    ) -> Result<Frame, Ending> {
        let mut pixels = encoders.pixels()?;
        let begin = Instant::now();
        let made = self.order.render(frame, &mut pixels, renderer, lost, self.signals)?;
        let (places, _) = self.order.places()?;
        let developed = places.iter().all(|place| place.layout.format.is_developed());
        let adapter = renderer.adapter();
        let picture = Picture {
            places,
            transparent: self.order.transparent,
            effort: self.effort,
            attributes: if developed { Vec::new() } else { self.attributes(&made) },
            manifest: self.names.manifest(),
            made: Made {
                file,
                of: self.order.fingerprint(frame),
                adapter: adapter.name.clone(),
                backend: adapter.backend.to_string(),
                seconds: begin.elapsed().as_secs_f64(),
            },
        };
        let write = move |pixels: &[u32]| {
            let written = picture.write(pixels);
            drop(claim);
            written
        };
        Ok(Frame { pixels, write: Box::new(write) })
    }
}

impl Picture {
    fn write(&self, pixels: &[u32]) -> Written {
        let made = &self.made;
        made.announce(&self.manifest)?;
        let images = self.places.iter().map(|place| Ok((place.output.channels(), place.image(pixels)?)));
        let images = images.collect::<bhr::error::Result<Vec<_>>>()?;
        match &images[..] {
            [(_, image)] if image.format().is_developed() => {
                save(image, if self.transparent { Alpha::Premultiplied } else { Alpha::AsInFile }, &made.file)?;
            }
            _ => {
                let layers = images.into_iter().map(|(channels, image)| Layer { channels, image });
                save_layers(&layers.collect::<Vec<_>>(), &self.attributes, self.effort, &made.file)?;
            }
        }
        made.note(&self.manifest)?;
        Ok(vec![Done { frame: made.of.frame, file: made.file.clone(), seconds: Some(made.seconds) }])
    }
}
