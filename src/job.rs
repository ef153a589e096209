// SPDX-License-Identifier: MIT OR Apache-2.0
//! Frames in the background: requests, each with its own copy of the scene, and all that their host knows of them. The
//! threads of worker.rs make them. Knows no callbacks and nothing of C.

mod outputs;
mod worker;

pub use outputs::{OutputFrame, OutputTarget};
pub use worker::{MAX_UNFINISHED, Worker};

use crate::error::{Error, ErrorKind, PARTLY_WRITTEN, Result};
use crate::gpu::{FrameSync, GpuTarget};
use crate::image::ImageMut;
use crate::scene::{RayOutput, Scene};
use crate::tracer::{FrameRequest, FrameStats, Progress, StatsBoard, Tile};
use crate::tracers::SharedTracer;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError, Weak};
use std::time::{Duration, Instant};
use worker::JobQueue;

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // A panic under these locks leaves nothing half done, so poison says nothing.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A frame that was requested. Clones are the same job; dropping them all neither ends nor cancels it.
#[derive(Clone)]
pub struct Job {
    shared: Arc<Shared>,
    /// The queue in which the job may still wait for its turn.
    queue: Weak<JobQueue>,
}

#[derive(Default)]
struct Shared {
    outcome: Mutex<Option<Result<FrameStats>>>,
    /// Signalled at every step and at the end.
    changed: Condvar,
    cancelled: AtomicBool,
    /// The host's memory that a frame for targets writes as well; none once the job has ended, or the host has it back.
    images: Mutex<Vec<ImageMut<'static>>>,
    /// The bits of the part that is done, an f64 in 0 .. 1.
    fraction: AtomicU64,
    /// Steps that were submitted, and once more those that are done.
    half_steps: AtomicU64,
}

impl Job {
    /// The part that is done, 0 .. 1.
    pub fn fraction(&self) -> f64 {
        f64::from_bits(self.shared.fraction.load(Ordering::Relaxed))
    }

    /// Asks the job to stop: work that is not yet begun is not done any more. The job ends at once if its turn has not
    /// come; but one with a target on the GPU waits for its turn, as its signals come after those of the jobs before.
    pub fn cancel(&self) {
        self.shared.cancelled.store(true, Ordering::Relaxed);
        if let Some(job_request) = self.queue.upgrade().and_then(|queue| queue.withdraw(&self.shared))
            && let Err(cancelled) = self.shared.check_cancelled()
        {
            job_request.finish(Err(cancelled));
        }
    }

    /// Gives the images of a frame for targets back to the host, which goes on without them. Does not wait for the GPU.
    pub fn leave_images(&self) {
        self.shared.leave_images();
    }

    /// The outcome of the job; `None` while it runs.
    pub fn outcome(&self) -> Option<Result<FrameStats>> {
        lock(&self.shared.outcome).clone()
    }

    /// Waits for its end, at most `timeout` (`None`: for ever), and calls `progress`, which cancels it by returning
    /// false, on this thread whenever more is done. The result is the job's outcome; `None` while it runs.
    pub fn wait(&self, timeout: Option<Duration>, progress: &mut Progress<'_>) -> Option<Result<FrameStats>> {
        let deadline = timeout.and_then(|timeout| Instant::now().checked_add(timeout));
        let mut told = f64::NAN;
        let mut outcome = lock(&self.shared.outcome);
        loop {
            if outcome.is_some() {
                return outcome.clone();
            }
            let fraction = self.fraction();
            if fraction != told {
                told = fraction;
                // The lock is not held here: the caller's code may take its time, or ask this job.
                drop(outcome);
                if !progress(fraction) {
                    self.cancel();
                }
                outcome = lock(&self.shared.outcome);
                continue;
            }
            outcome = match deadline.map(|deadline| deadline.saturating_duration_since(Instant::now())) {
                Some(Duration::ZERO) => return None,
                Some(left) => self.shared.changed.wait_timeout(outcome, left).unwrap_or_else(PoisonError::into_inner).0,
                None => self.shared.changed.wait(outcome).unwrap_or_else(PoisonError::into_inner),
            };
        }
    }
}

impl Shared {
    fn check_cancelled(&self) -> Result<()> {
        match self.cancelled.load(Ordering::Relaxed) {
            true => Err(Error::new(ErrorKind::Cancelled, "the job was cancelled")),
            false => Ok(()),
        }
    }

    /// Errors: that of a step, with which the job has ended.
    fn check_failed(&self) -> Result<()> {
        match &*lock(&self.outcome) {
            Some(Err(error)) => Err(error.clone()),
            Some(Ok(_)) | None => Ok(()),
        }
    }

    /// Waits while one of them is written. Whether one has been.
    fn leave_images(&self) -> bool {
        let images = std::mem::take(&mut *lock(&self.images));
        images.iter().any(ImageMut::is_touched)
    }

    /// Writes rows of a tile, unless the host has the images back. Errors: as [`ImageMut::write_tile`].
    fn write_image(&self, number: usize, tile: Tile, pixels: &[u8], row_bytes: usize) -> Result<()> {
        match lock(&self.images).get_mut(number) {
            Some(image) => image.write_tile(tile.x, tile.y, tile.width, tile.height, pixels, row_bytes),
            None => Ok(()),
        }
    }

    fn report(&self, fraction: f64) {
        self.report_with(|| fraction);
    }

    fn report_with(&self, fraction: impl FnOnce() -> f64) {
        // The lock is held, or a waiter could miss this between looking and sleeping.
        let outcome = lock(&self.outcome);
        // The outcome has the last word, whatever another thread had begun to say.
        if outcome.is_none() {
            self.fraction.store(fraction().to_bits(), Ordering::Relaxed);
            self.changed.notify_all();
        }
    }

    /// One of `count` steps was submitted, or is done. A frame of one step is at 1/2 while it is made.
    fn report_half_step(&self, count: u64) {
        self.report_with(|| (self.half_steps.fetch_add(1, Ordering::Relaxed) + 1) as f64 / (2 * count) as f64);
    }

    /// The job has ended, unless it had before.
    fn end(&self, ended: Result<FrameStats>) {
        let mut outcome = lock(&self.outcome);
        if outcome.is_none() {
            self.fraction.store(f64::from(u8::from(ended.is_ok())).to_bits(), Ordering::Relaxed);
            *outcome = Some(ended);
        }
        self.changed.notify_all();
    }
}

/// The place that a job's pixels go to.
pub enum JobTarget {
    /// The host's memory.
    Memory(FrameRequest, ImageMut<'static>),
    /// The outputs of a frame, in the host's memory.
    Outputs(OutputFrame<'static>),
    /// Targets on the GPU, and images in the host's memory that are made with them.
    Shared(SharedFrame),
}

/// The place of a picture, or of an output, of a frame that goes to targets.
pub enum SharedPlace {
    Target(Arc<GpuTarget>),
    /// The host's memory: the number of the frame's image.
    Image(usize),
}

/// A frame whose pixels stay on the GPU, but for those of its images.
pub struct SharedFrame {
    pub request: FrameRequest,
    /// The picture's; `None`: the frame has none.
    pub light: Option<SharedPlace>,
    /// Numbers of rays, beside the picture.
    pub outputs: Vec<(RayOutput, SharedPlace)>,
    /// The host's memory, in the order of its numbers; the job's once it is requested.
    pub images: Vec<ImageMut<'static>>,
    /// The semaphores, whose signals are given whatever becomes of the frame.
    pub sync: FrameSync,
}

impl SharedFrame {
    /// All targets.
    fn targets(&self) -> Vec<Arc<GpuTarget>> {
        let places = self.light.iter().chain(self.outputs.iter().map(|(_, place)| place));
        let target = |place: &SharedPlace| match place {
            SharedPlace::Target(target) => Some(target.clone()),
            SharedPlace::Image(_) => None,
        };
        places.filter_map(target).collect()
    }

    /// The number of the image of an output that comes to the host; `None`: of the picture.
    fn image_of(&self, output: Option<usize>) -> Option<usize> {
        match (output, &self.light) {
            (Some(number), _) => Some(number),
            (None, Some(SharedPlace::Image(number))) => Some(*number),
            (None, _) => None,
        }
    }
}

impl JobTarget {
    /// A pixel of the host's was written.
    fn is_touched(&self) -> bool {
        match self {
            Self::Memory(_, target) => target.is_touched(),
            Self::Outputs(outputs) => outputs.is_touched(),
            Self::Shared(..) => false,
        }
    }
}

/// A frame to be made, and the job that hears of it. Its target is written until the job has its outcome, and never
/// after.
pub struct JobRequest {
    pub scene: Scene,
    pub target: JobTarget,
    pub tracer: SharedTracer,
    pub stats: StatsBoard,
    shared: Arc<Shared>,
    requested: Instant,
}

impl JobRequest {
    pub fn new(scene: Scene, mut target: JobTarget, tracer: SharedTracer, stats: StatsBoard) -> Self {
        let images = match &mut target {
            JobTarget::Shared(frame) => std::mem::take(&mut frame.images),
            JobTarget::Memory(..) | JobTarget::Outputs(_) => Vec::new(),
        };
        let shared = Arc::new(Shared { images: Mutex::new(images), ..Shared::default() });
        Self { scene, target, tracer, stats, shared, requested: Instant::now() }
    }

    /// The job's end. The target is its owner's again.
    fn finish(mut self, outcome: Result<FrameStats>) {
        let touched = self.let_go() || self.target.is_touched();
        let outcome = outcome.map(|stats| self.stats.publish(stats, self.requested.elapsed())).map_err(|mut error| {
            if touched {
                error.message += PARTLY_WRITTEN;
            }
            error
        });
        self.shared.end(outcome);
    }

    /// Lets go of what the host shares: whoever has seen the job's end may destroy it. Whether an image that went with
    /// targets was written.
    fn let_go(&mut self) -> bool {
        self.scene.occluder = None;
        if let JobTarget::Shared(frame) = &mut self.target {
            frame.light = None;
            frame.outputs.clear();
            frame.sync = FrameSync::default();
        }
        self.shared.leave_images()
    }
}

impl Drop for JobRequest {
    fn drop(&mut self) {
        self.let_go();
        self.shared.end(Err(Error::internal("a thread that renders in the background failed")));
    }
}
