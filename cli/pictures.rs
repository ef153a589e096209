// SPDX-License-Identifier: MIT OR Apache-2.0
//! Frames in files of their own. A frame's bytes depend on the scene and its number only; a file is there whole or not
//! at all; what is there is passed over. So the same command may be run again, on several machines at once, and be
//! killed at any time. Knows no video.

use crate::claim::Claim;
use crate::encode::{Done, Encoders, Frame, Written, lock, that_fit};
use crate::ending::Ending;
use crate::frames::Names;
use crate::manifest::{Made, Manifest};
use crate::open::Opener;
use crate::order::{Order, Place};
use crate::progress::Progress;
use crate::signals::Signals;
use bhr::image::{Alpha, Attribute, ColourSpace, Effort, Layer, save, save_layers};
use bhr::renderer::Renderer;
use bhr::scene_file::parameters;
use std::collections::VecDeque;
use std::panic::resume_unwind;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
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

/// The frames that no renderer has taken, and the renderers that take them.
#[derive(Default)]
struct Left {
    frames: VecDeque<u32>,
    at_work: usize,
    /// Renderers that ended for want of memory, and those of them that have not given theirs back yet.
    have_left: usize,
    leaving: usize,
}

impl Left {
    /// The next frame, if there is one. A renderer that is told that there is none has ended, unless it `waits` for
    /// frames that others are making.
    fn take(&mut self, waits: bool) -> Option<u32> {
        let frame = self.frames.pop_front();
        if frame.is_none() && !waits {
            self.at_work -= 1;
        }
        frame
    }

    /// Leaves a frame, and those that were `waited` for, to the renderers beside this one, which then ends; not if it
    /// is the last one at work.
    fn leave(&mut self, frame: u32, waited: &mut Vec<u32>) -> bool {
        let beside = self.at_work > 1;
        if beside {
            self.at_work -= 1;
            self.have_left += 1;
            self.leaving += 1;
            self.frames.push_front(frame);
            self.frames.extend(waited.drain(..));
        }
        beside
    }
}

/// Says that a renderer has failed, for the others to end, unless it ended well: also where it panicked.
struct Failing<'a> {
    failed: &'a AtomicBool,
    has_ended_well: bool,
}

impl Drop for Failing<'_> {
    fn drop(&mut self) {
        self.failed.fetch_or(!self.has_ended_well, Ordering::Relaxed);
    }
}

/// A picture that is to be written.
struct Picture {
    /// The light and what is beside it.
    places: Vec<Place>,
    transparent: bool,
    space: ColourSpace,
    attributes: Vec<(String, Attribute)>,
    effort: Effort,
    made: Made,
    manifest: PathBuf,
}

impl Pictures<'_> {
    /// Renders frames by several renderers, which share the list as programs would; on as many threads as `encoders`
    /// they are written. Beside each renderer works what `more` opens, if it does: while a frame is copied from the GPU
    /// the next one is rendered. Errors: the first mistake; frames that were rendered before it are written.
    pub fn render(
        &self,
        list: &[u32],
        encoders: usize,
        renderers: Vec<Renderer>,
        more: impl Fn(usize, &Renderer) -> Vec<Opener>,
        progress: &Progress,
    ) -> Result<(), Ending> {
        let (_, bytes) = self.order.places()?;
        let more = renderers.iter().enumerate().flat_map(|(number, renderer)| more(number, renderer));
        // One without pixels would only take the GPU's memory.
        let more = more.take(that_fit(bytes).saturating_sub(renderers.len())).collect::<Vec<_>>();
        let count = renderers.len() + more.len();
        let encoders = Encoders::new(encoders, count, list.len(), bytes)?;
        let frames = list.iter().copied().collect();
        let left = &Mutex::new(Left { frames, at_work: renderers.len(), ..Left::default() });
        let render = |renderer: Renderer| {
            let mut failing = Failing { failed: &self.failed, has_ended_well: false };
            let result = self.render_by(renderer, left, &encoders, progress);
            failing.has_ended_well = result.is_ok();
            result
        };
        let render = &render;
        let ended = std::thread::scope(|scope| {
            let first = renderers.into_iter().map(|renderer| scope.spawn(move || render(renderer)));
            let mut threads = first.collect::<Vec<_>>();
            threads.extend(more.into_iter().map(|open| {
                scope.spawn(move || {
                    let is_over = self.failed.load(Ordering::Relaxed) || self.signals.has_come();
                    if is_over || lock(left).frames.is_empty() {
                        return Ok(());
                    }
                    // One more helps, and is not needed: the machine may have no room for it.
                    let Some(renderer) = open() else { return Ok(()) };
                    {
                        let mut left = lock(left);
                        if left.at_work == 0 {
                            return Ok(());
                        }
                        left.at_work += 1;
                    }
                    render(renderer)
                })
            }));
            let ended = threads.into_iter().map(|thread| thread.join().unwrap_or_else(|panic| resume_unwind(panic)));
            ended.fold(Ok(()), Result::and)
        });
        progress.finish(encoders, ended)
    }

    fn render_by(
        &self,
        mut renderer: Renderer,
        left: &Mutex<Left>,
        encoders: &Encoders,
        progress: &Progress,
    ) -> Result<(), Ending> {
        let (mut lost, mut is_alone) = (0, false);
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
            let taken = lock(left).take(!others.is_empty());
            let Some(frame) = taken else {
                if others.is_empty() {
                    return Ok(());
                }
                // They are there in a while, or their programs are gone.
                std::thread::sleep(PATIENCE);
                manifest.refresh();
                lock(left).frames.extend(others.drain(..));
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
            match self.frame(frame, file, claim, encoders, &mut renderer, &mut lost) {
                Ok(made) => encoders.order(made)?,
                // The others go on with the memory that this one has taken.
                Err(ending) if ending.no_memory && lock(left).leave(frame, &mut others) => {
                    drop(renderer);
                    lock(left).leaving -= 1;
                    return Ok(());
                }
                // The last one has the memory of those that left, once they have given it back.
                Err(ending) if ending.no_memory && !is_alone && lock(left).have_left > 0 => {
                    while lock(left).leaving > 0 {
                        std::thread::sleep(PATIENCE);
                    }
                    is_alone = true;
                    lock(left).frames.push_front(frame);
                }
                Err(ending) => return Err(ending),
            }
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
        encoders: &Encoders,
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
            space: self.order.space,
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
                save(
                    image,
                    if self.transparent { Alpha::Premultiplied } else { Alpha::AsInFile },
                    ColourSpace::Rec709,
                    &made.file,
                )?;
            }
            _ => {
                let layers = images.into_iter().map(|(channels, image)| Layer { channels, image });
                let about = (&self.attributes[..], self.space);
                save_layers(&layers.collect::<Vec<_>>(), about, self.effort, &made.file)?;
            }
        }
        made.note(&self.manifest)?;
        Ok(vec![Done { frame: made.of.frame, file: made.file.clone(), seconds: Some(made.seconds) }])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_is_left_to_others_only() {
        let mut left = Left { frames: [1, 2].into(), at_work: 2, ..Left::default() };
        assert_eq!(left.take(false), Some(1));
        assert!(left.leave(1, &mut vec![7]) && left.at_work == 1 && left.frames == [1, 2, 7]);
        assert_eq!((left.have_left, left.leaving), (1, 1));
        assert_eq!(left.take(false), Some(1));
        let mut waited = vec![8];
        assert!(!left.leave(1, &mut waited) && left.at_work == 1 && left.frames == [2, 7] && waited == [8]);
        // One that waits for frames of other programs is still at work.
        assert_eq!((left.take(true), left.take(true), left.take(true), left.at_work), (Some(2), Some(7), None, 1));
        assert_eq!((left.take(false), left.at_work), (None, 0));
    }
}
