// SPDX-License-Identifier: MIT OR Apache-2.0
//! Threads that write frames while the next ones are rendered, by one renderer or several. Frames that wait hold their
//! pixels: there are only so many of these, which bounds the memory. Knows no files and no tracer.

use crate::ending::Ending;
use std::ops::{Deref, DerefMut};
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

/// The most bytes of pixels that are being rendered, or wait to be written.
const MOST_BYTES: u64 = 4 << 30;

/// Larger frames are a slip, and no machine's memory.
const MOST_OF_A_FRAME: u64 = 64 << 30;

/// Pixels of a frame, aligned to every format's channels. Wherever they are dropped, another frame gets them.
#[derive(Default)]
pub struct Pixels {
    words: Vec<u32>,
    give_back: Option<Sender<Vec<u32>>>,
}

impl Deref for Pixels {
    type Target = [u32];
    fn deref(&self) -> &[u32] {
        &self.words
    }
}

impl DerefMut for Pixels {
    fn deref_mut(&mut self) -> &mut [u32] {
        &mut self.words
    }
}

impl Drop for Pixels {
    fn drop(&mut self) {
        if let Some(give_back) = &self.give_back {
            // Where nobody waits for them any more the program is ending.
            let _ = give_back.send(std::mem::take(&mut self.words));
        }
    }
}

/// Writes the pixels of a frame.
type Write = Box<dyn FnOnce(&[u32]) -> Written + Send>;

/// A frame that is to be written, and how.
pub struct Frame {
    pub pixels: Pixels,
    pub write: Write,
}

/// A frame that is there.
pub struct Done {
    pub frame: u32,
    pub file: PathBuf,
    /// How long it took; `None`: it was there before.
    pub seconds: Option<f64>,
}

/// Frames that writing one has finished, or what is wrong with it.
pub type Written = Result<Vec<Done>, Ending>;

pub struct Encoders {
    threads: Vec<JoinHandle<()>>,
    orders: Option<SyncSender<Frame>>,
    written: Mutex<Receiver<Written>>,
    give_back: Sender<Vec<u32>>,
    pool: Mutex<Pool>,
    frame_bytes: usize,
}

/// The pixels that there are.
struct Pool {
    /// Pixels that no frame needs now.
    free: Receiver<Vec<u32>>,
    /// The buffers that there are, and may be.
    buffers: usize,
    most_buffers: usize,
}

/// A lock that somebody may have panicked with: what it guards is whole between any two statements.
pub fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// How many frames of so many bytes may be rendered, or wait to be written, at a time: one at least.
pub fn that_fit(frame_bytes: usize) -> usize {
    usize::try_from(MOST_BYTES / frame_bytes.max(1) as u64).unwrap_or(usize::MAX).max(1)
}

fn no_memory(message: impl Into<String>) -> Ending {
    bhr::error::Error::new(bhr::error::ErrorKind::OutOfMemory, message).into()
}

impl Encoders {
    /// Threads for so many frames of so many bytes; 0 threads: one a core. `renderers` are those that make frames at a
    /// time.
    pub fn new(threads: usize, renderers: usize, frames: usize, frame_bytes: usize) -> Result<Self, Ending> {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let threads = (if threads == 0 { cores } else { threads }).clamp(1, frames.max(1));
        let most_buffers = that_fit(frame_bytes).clamp(1, threads + renderers + 1).min(frames.max(1));
        let (give_back, free) = channel();
        let (orders, taken) = sync_channel::<Frame>(most_buffers);
        let taken = Arc::new(Mutex::new(taken));
        let (tell, written) = channel();
        let threads = (0..threads.min(most_buffers)).map(|_| {
            let (taken, tell) = (taken.clone(), tell.clone());
            let thread = std::thread::Builder::new().name("bhr encoder".into());
            let started = thread.spawn(move || work(&taken, &tell));
            started.map_err(|error| no_memory(format!("a thread cannot be started: {error}")))
        });
        let threads = threads.collect::<Result<Vec<_>, _>>()?;
        let pool = Mutex::new(Pool { free, buffers: 0, most_buffers });
        Ok(Self { threads, orders: Some(orders), written: Mutex::new(written), give_back, pool, frame_bytes })
    }

    /// Pixels for a frame, when there are some. Errors: there is no memory for one frame.
    pub fn pixels(&self) -> Result<Pixels, Ending> {
        let words = lock(&self.pool).take(self.frame_bytes)?;
        Ok(Pixels { words, give_back: Some(self.give_back.clone()) })
    }

    pub fn order(&self, frame: Frame) -> Result<(), Ending> {
        let gone = || Ending::from(bhr::error::Error::internal("the threads that write files have ended"));
        self.orders.as_ref().ok_or_else(gone)?.send(frame).map_err(|_| gone())
    }

    /// The frames that have been written since this was asked last.
    pub fn written(&self) -> Vec<Written> {
        lock(&self.written).try_iter().collect()
    }

    /// Waits for all frames that were ordered; those that have been written since the last question.
    pub fn finish(mut self) -> Vec<Written> {
        self.orders = None;
        let panicked = self.threads.drain(..).filter_map(|thread| thread.join().err()).count();
        let lost = (panicked > 0).then(|| bhr::error::Error::internal("writing a file panicked"));
        lock(&self.written).try_iter().chain(lost.map(|error| Err(error.into()))).collect()
    }
}

impl Pool {
    fn take(&mut self, frame_bytes: usize) -> Result<Vec<u32>, Ending> {
        if let Ok(pixels) = self.free.try_recv() {
            return Ok(pixels);
        }
        if self.buffers < self.most_buffers {
            let made = match frame_bytes as u64 {
                // Zeros take no memory until they are written, so that a system may promise any number of them.
                0..=MOST_OF_A_FRAME => bytemuck::allocation::try_zeroed_vec(frame_bytes.div_ceil(4)),
                _ => Err(()),
            };
            match (made, self.buffers) {
                (Ok(pixels), _) => {
                    self.buffers += 1;
                    return Ok(pixels);
                }
                (Err(()), 0) => {
                    return Err(no_memory(format!("there are no {frame_bytes} bytes for the pixels of a frame")));
                }
                // The buffers that there are have to do.
                (Err(()), there) => self.most_buffers = there,
            }
        }
        // Pixels come back even where they could not be rendered or written.
        self.free.recv().map_err(|_| bhr::error::Error::internal("the threads that write files have ended").into())
    }
}

/// Added to the niceness (nice(2)) of threads that write.
#[cfg(target_os = "linux")]
const STEPS_BEHIND: i32 = 5;

/// Lets the threads that render go first: as many threads write as there are processors, and while those that render
/// wait for one they run out of frames. Linux has a niceness for each thread; elsewhere it is the process's.
fn step_behind() {
    #[cfg(target_os = "linux")]
    let _ = rustix::process::nice(STEPS_BEHIND);
}

fn work(orders: &Mutex<Receiver<Frame>>, tell: &Sender<Written>) {
    step_behind();
    loop {
        // The lock ends with this statement: the others get the next frames while this one is written.
        let order = lock(orders).recv();
        let Ok(Frame { pixels, write }) = order else { return };
        let written = write(&pixels);
        drop(pixels);
        // Where nobody listens any more the program is ending.
        let _ = tell.send(written);
    }
}
