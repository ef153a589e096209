// SPDX-License-Identifier: MIT OR Apache-2.0
//! The two threads that make a renderer's jobs. One prepares frames and submits them to the GPU; the other waits for
//! what it has made and copies that into the host's memory. So copying, which may take as long as tracing, delays no
//! submission. Frames end in the order in which they were requested. Only the first thread holds a tracer; the second
//! needs nothing that anybody holds for longer than a few instructions, so that it always gets on.

use super::{Job, JobRequest, Shared, lock};
use crate::allocate::{self, THREAD_ROOM};
use crate::error::{Error, ErrorKind, Result};
use crate::gpu::{BegunFrame, Device, FrameTarget, Submission};
use crate::thread_scope::{self, ThreadScope};
use crate::tracer::{FrameStats, Tile};
use crate::tracers::Tracer;
use parking_lot::{ArcMutexGuard, RawMutex};
use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::Ordering;
use std::sync::{Arc, Barrier, Condvar, Mutex, PoisonError};
use std::thread::JoinHandle;

/// Jobs of one renderer that may be unfinished at a time.
pub const MAX_UNFINISHED: usize = 64;

/// Submissions that are not finished, at most: one is copied to the host, one has run and waits for that, two keep the
/// GPU busy.
const AHEAD: usize = 4;

/// The messages of the submitting thread to the finishing one. For each frame they are `Begun`, then its steps, and
/// `Failed` if those are not all; or `Whole` alone.
enum Event {
    Begun(Box<RunningFrame>),
    Step(Box<Submission>),
    /// The frame ends with an error.
    Failed(Error),
    /// A frame that was made in one piece, or failed before its begin.
    Whole(Box<JobRequest>, Result<FrameStats>),
}

/// A frame of which steps are under way on the GPU.
struct RunningFrame {
    job_request: JobRequest,
    device: Arc<Device>,
    stats: FrameStats,
    done: u64,
    count: u64,
}

/// The state that host and threads share.
#[derive(Default)]
pub(super) struct JobQueue {
    state: Mutex<State>,
    /// Signalled when a request came, or room for a step, or the end.
    to_submit: Condvar,
    /// Signalled when an event came, or the end.
    to_finish: Condvar,
}

#[derive(Default)]
struct State {
    waiting: VecDeque<JobRequest>,
    /// Requests taken by the submitting thread and not yet finished.
    taken: usize,
    events: VecDeque<Event>,
    /// Steps that are submitted and not yet finished.
    steps: usize,
    /// No more requests will come.
    closed: bool,
    /// A thread panicked: requests that wait are not made any more.
    broken: bool,
    /// The submitting thread has ended: no more events will come.
    submitted: bool,
    /// The finishing thread has ended: nobody takes events any more.
    finished: bool,
}

/// A renderer's threads, which make its jobs in their order. Dropping it finishes them all first.
pub struct Worker {
    queue: Arc<JobQueue>,
    threads: Vec<JoinHandle<()>>,
}

impl Worker {
    /// Its threads are in the scope of the thread that calls this. Errors: OUT_OF_MEMORY when the system gives no
    /// threads.
    pub fn new() -> Result<Self> {
        let scope = thread_scope::of_caller();
        allocate::check_room(2 * THREAD_ROOM, "the threads that render in the background")?;
        let mut worker = Self { queue: Arc::default(), threads: Vec::new() };
        worker.spawn("bhr-jobs", scope.clone(), submit_all, |state| state.submitted = true)?;
        worker.spawn("bhr-finish", scope, finish_all, |state| state.finished = true)?;
        Ok(worker)
    }

    /// Runs `work`; `end` tells the others when it has ended.
    fn spawn(&mut self, name: &str, scope: ThreadScope, work: fn(&JobQueue), end: fn(&mut State)) -> Result<()> {
        let queue = self.queue.clone();
        let begun = Arc::new(Barrier::new(2));
        let begins = begun.clone();
        let body = move || {
            begins.wait();
            let _scope = scope();
            // Unwind safe: after a panic nothing is taken any more, and what was taken ends as it is dropped.
            let result = catch_unwind(AssertUnwindSafe(|| work(&queue)));
            queue.end(result.is_err(), end);
            if let Err(payload) = result {
                // Dropping an unknown payload may panic again.
                std::mem::forget(payload);
                log::error!("a thread that renders in the background panicked");
            }
        };
        let thread = std::thread::Builder::new().name(name.into()).spawn(body).map_err(|error| {
            Error::new(ErrorKind::OutOfMemory, format!("no thread to render in the background: {error}"))
        })?;
        // Once a thread runs, it has the memory that it takes at its start, which bhr cannot refuse.
        begun.wait();
        self.threads.push(thread);
        Ok(())
    }

    /// Errors: INVALID_STATE when too many are unfinished; INTERNAL when a job panicked before.
    pub fn enqueue(&self, job_request: JobRequest) -> Result<Job> {
        let job = Job { shared: job_request.shared.clone(), queue: Arc::downgrade(&self.queue) };
        let mut state = lock(&self.queue.state);
        if state.closed {
            return Err(Error::internal("a thread that renders in the background failed before"));
        }
        let unfinished = state.waiting.len() + state.taken;
        if unfinished >= MAX_UNFINISHED {
            return Err(Error::state(format!(
                "{unfinished} jobs are unfinished, as many as a context takes; wait for one or cancel it"
            )));
        }
        state.waiting.push_back(job_request);
        self.queue.to_submit.notify_one();
        Ok(job)
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        lock(&self.queue.state).closed = true;
        self.queue.to_submit.notify_one();
        for thread in self.threads.drain(..) {
            let _ = thread.join();
        }
    }
}

impl JobQueue {
    /// The request of a job whose turn has not come.
    pub(super) fn withdraw(&self, job: &Arc<Shared>) -> Option<JobRequest> {
        let mut state = lock(&self.state);
        let place = state.waiting.iter().position(|job_request| Arc::ptr_eq(&job_request.shared, job))?;
        state.waiting.remove(place)
    }

    /// The next request, once there is room for its first step; `None`: the end.
    fn take(&self) -> Option<JobRequest> {
        let mut state = lock(&self.state);
        loop {
            if state.broken {
                return None;
            }
            if state.steps < AHEAD
                && let Some(job_request) = state.waiting.pop_front()
            {
                state.taken += 1;
                return Some(job_request);
            }
            if state.closed && state.waiting.is_empty() {
                return None;
            }
            state = self.to_submit.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Waits until another step may be submitted. Errors: INTERNAL when the finishing thread has failed.
    fn wait_for_room(&self) -> Result<()> {
        let mut state = lock(&self.state);
        while state.steps >= AHEAD && !state.broken {
            state = self.to_submit.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        match state.broken {
            true => Err(Error::internal("the thread that finishes frames failed")),
            false => Ok(()),
        }
    }

    fn send(&self, event: Event) {
        let mut state = lock(&self.state);
        if state.finished {
            // A request in it ends as it is dropped, for which the lock is not needed.
            drop(state);
            return drop(event);
        }
        state.steps += usize::from(matches!(event, Event::Step(_)));
        state.events.push_back(event);
        self.to_finish.notify_one();
    }

    /// `None`: the end.
    fn next_event(&self) -> Option<Event> {
        let mut state = lock(&self.state);
        loop {
            if let Some(event) = state.events.pop_front() {
                return Some(event);
            }
            if state.submitted {
                return None;
            }
            state = self.to_finish.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn step_finished(&self) {
        lock(&self.state).steps -= 1;
        self.to_submit.notify_one();
    }

    fn finish(&self, job_request: JobRequest, outcome: Result<FrameStats>) {
        // This comes first, so that a host that has seen the end may request another.
        lock(&self.state).taken -= 1;
        job_request.finish(outcome);
    }

    /// Ends a thread; everything that it leaves behind is dropped.
    fn end(&self, panicked: bool, end: fn(&mut State)) {
        let left = {
            let mut state = lock(&self.state);
            end(&mut state);
            state.broken |= panicked;
            state.closed |= panicked;
            let events = if state.finished { std::mem::take(&mut state.events) } else { VecDeque::new() };
            let waiting = if state.broken { std::mem::take(&mut state.waiting) } else { VecDeque::new() };
            (events, waiting)
        };
        self.to_submit.notify_one();
        self.to_finish.notify_one();
        drop(left);
    }
}

/// The submitting thread.
fn submit_all(queue: &JobQueue) {
    while let Some(job_request) = queue.take() {
        submit(queue, job_request);
    }
}

/// Submits a frame to the GPU; on the CPU and with GL, makes it.
fn submit(queue: &JobQueue, mut job_request: JobRequest) {
    if let Err(error) = job_request.shared.check_cancelled() {
        return queue.send(Event::Whole(Box::new(job_request), Err(error)));
    }
    let mut guard = job_request.tracer.lock_arc();
    let begun = match &mut *guard {
        Tracer::Gpu(tracer) if !job_request.scene.camera.is_omnistereo() => tracer
            .begin(&job_request.scene, &job_request.request, FrameTarget::Host)
            .map(|frame| (frame, tracer.device())),
        _ => {
            let rendered = render_whole(&mut guard, &mut job_request);
            // Whoever waits for the tracer gets it before the next job does.
            ArcMutexGuard::unlock_fair(guard);
            return queue.send(Event::Whole(Box::new(job_request), rendered));
        }
    };
    match begun {
        Err(error) => queue.send(Event::Whole(Box::new(job_request), Err(error))),
        Ok((frame, device)) => {
            let (stats, count, shared, _device) =
                (frame.stats(), frame.count(), job_request.shared.clone(), device.clone());
            queue.send(Event::Begun(Box::new(RunningFrame { job_request, device, stats, done: 0, count })));
            let submitted = FrameSubmitter { guard: Some(guard), frame, _device }.submit(queue, &shared);
            if let Err(error) = submitted {
                queue.send(Event::Failed(error));
            }
        }
    }
}

/// Makes a frame without overlap with the next one: the CPU is busy, GL is one thread's, and a picture that is seen
/// from several places is made strip by strip.
fn render_whole(tracer: &mut Tracer, job_request: &mut JobRequest) -> Result<FrameStats> {
    let (scene, request, target, shared) =
        (&job_request.scene, &job_request.request, &mut job_request.target, job_request.shared.clone());
    let mut sink = |tile: Tile, pixels: &[u8], row_bytes: usize| {
        target.write_tile(tile.x, tile.y, tile.width, tile.height, pixels, row_bytes)
    };
    let mut progress = |fraction: f64| {
        shared.report(fraction);
        !shared.cancelled.load(Ordering::Relaxed)
    };
    let rendered = tracer.render(scene, request, &mut sink, &mut progress);
    rendered.map_err(|error| match error.kind {
        ErrorKind::Cancelled => Error::new(ErrorKind::Cancelled, "the job was cancelled"),
        _ => error,
    })
}

/// A frame of which steps are left, and the tracer, which no other frame may use before they are submitted.
struct FrameSubmitter {
    /// The lock of the tracer; `None` only while it is being dropped.
    guard: Option<ArcMutexGuard<RawMutex, Tracer>>,
    frame: BegunFrame,
    /// Dropped after the frame.
    _device: Arc<Device>,
}

impl FrameSubmitter {
    /// Submits the steps. Errors: CANCELLED; as [`crate::gpu::GpuTracer::submit`].
    fn submit(mut self, queue: &JobQueue, shared: &Shared) -> Result<()> {
        while !self.frame.is_submitted() {
            queue.wait_for_room()?;
            shared.check_cancelled()?;
            let Some(Tracer::Gpu(tracer)) = self.guard.as_deref_mut() else {
                return Err(Error::internal("a frame of the GPU on another tracer"));
            };
            if let Some(step) = tracer.submit(&mut self.frame)? {
                queue.send(Event::Step(Box::new(step)));
            }
        }
        Ok(())
    }
}

impl Drop for FrameSubmitter {
    fn drop(&mut self) {
        let Some(mut guard) = self.guard.take() else { return };
        if let Tracer::Gpu(tracer) = &mut *guard
            && !self.frame.is_submitted()
        {
            tracer.forget();
        }
        // Whoever waits for the tracer gets it before the next job does.
        ArcMutexGuard::unlock_fair(guard);
    }
}

/// The finishing thread.
fn finish_all(queue: &JobQueue) {
    // The frame that the steps are of; none if it has ended before its last.
    let mut current = None;
    while let Some(event) = queue.next_event() {
        match event {
            Event::Begun(frame) => current = Some(*frame),
            Event::Whole(job_request, outcome) => queue.finish(*job_request, outcome),
            Event::Failed(error) => {
                if let Some(frame) = current.take() {
                    queue.finish(frame.job_request, Err(error));
                }
            }
            Event::Step(step) => {
                current = current.take().and_then(|frame| frame.finish_step(queue, *step));
                queue.step_finished();
            }
        }
    }
}

impl RunningFrame {
    /// Waits for the oldest step and takes its pixels. `None`: the frame has ended.
    fn finish_step(mut self, queue: &JobQueue, step: Submission) -> Option<Self> {
        match self.take_pixels(step) {
            Err(error) => {
                // Steps that are left need not be submitted any more.
                self.job_request.shared.cancelled.store(true, Ordering::Relaxed);
                queue.finish(self.job_request, Err(error));
                None
            }
            Ok(()) if self.done < self.count => Some(self),
            Ok(()) => {
                self.stats.device_bytes = self.device.bytes();
                queue.finish(self.job_request, Ok(self.stats));
                None
            }
        }
    }

    fn take_pixels(&mut self, step: Submission) -> Result<()> {
        self.job_request.shared.check_cancelled()?;
        let target = &mut self.job_request.target;
        let mut sink = |tile: Tile, pixels: &[u8], row_bytes: usize| {
            target.write_tile(tile.x, tile.y, tile.width, tile.height, pixels, row_bytes)
        };
        step.finish(&self.device, &mut self.stats, &mut sink)?;
        self.done += 1;
        self.job_request.shared.report(self.done as f64 / self.count as f64);
        Ok(())
    }
}
