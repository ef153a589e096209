// SPDX-License-Identifier: MIT OR Apache-2.0
//! The two threads that make a renderer's jobs. One prepares frames and submits them to the GPU; the other waits for
//! what it has made and copies that into the host's memory. So copying, which may take as long as tracing, delays no
//! submission. Frames end in the order in which they were requested. Only the first thread holds a tracer; the second
//! needs nothing that anybody holds for longer than a few instructions, so that it always gets on.

use super::{Job, JobRequest, JobTarget, Shared, SharedFrame, SharedPlace, lock};
use crate::allocate::{self, THREAD_ROOM};
use crate::error::{Error, ErrorKind, Result};
use crate::gpu::{BegunFrame, Device, FrameTarget, GpuTracer, Handed, OutputTo, Submission, process_end};
use crate::interop;
use crate::thread_scope::{self, ThreadScope};
use crate::thread_state::begin_own_thread;
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

/// A device that is lost signals nothing.
const SIGNALS_LOST: &str = "the signals of a frame that failed cannot be given";

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

/// Submissions that a frame which is submitted on the host's thread may be ahead of those that are finished.
const MOST_AHEAD: usize = 32;

/// A request that counts as taken, until it is passed on or given up.
struct TakenRequest<'a> {
    queue: &'a JobQueue,
    job_request: Option<JobRequest>,
}

impl Drop for TakenRequest<'_> {
    fn drop(&mut self) {
        if self.job_request.take().is_some() {
            lock(&self.queue.state).taken -= 1;
        }
    }
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

impl State {
    /// Errors: INVALID_STATE when too many jobs are unfinished; INTERNAL when one panicked before.
    fn check_room(&self) -> Result<()> {
        if self.closed {
            return Err(Error::internal("a thread that renders in the background failed before"));
        }
        let unfinished = self.waiting.len() + self.taken;
        if unfinished >= MAX_UNFINISHED {
            return Err(Error::state(format!(
                "{unfinished} jobs are unfinished, as many as a context takes; wait for one or cancel it"
            )));
        }
        Ok(())
    }
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
            begin_own_thread();
            process_end::own_thread();
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
        state.check_room()?;
        state.waiting.push_back(job_request);
        self.queue.to_submit.notify_one();
        Ok(job)
    }

    /// Errors: INVALID_STATE when too many jobs are unfinished; INTERNAL when one panicked before.
    pub fn check_room(&self) -> Result<()> {
        lock(&self.queue.state).check_room()
    }

    /// Submits a frame for a target on the GPU on the calling thread, before the jobs that wait for their turn; the
    /// job that it is ends when the frame has run. After an error nothing was submitted, or its signals were.
    ///
    /// Errors: as [`Self::enqueue`]; UNSUPPORTED for other tracers; INVALID_ARGUMENT for a signal whose value does not
    /// grow; as [`GpuTracer::begin`] and [`GpuTracer::submit`].
    pub fn submit_now(&self, job_request: JobRequest) -> Result<Job> {
        let shared = job_request.shared.clone();
        let job = Job { shared: shared.clone(), queue: Arc::downgrade(&self.queue) };
        let mut guard = job_request.tracer.lock_arc();
        {
            let mut state = lock(&self.queue.state);
            state.check_room()?;
            state.taken += 1;
        }
        let mut taken = TakenRequest { queue: &self.queue, job_request: Some(job_request) };
        let begun = match (&mut *guard, &taken.job_request) {
            (Tracer::Gpu(tracer), Some(job_request)) => begin_asked(tracer, job_request),
            (tracer, _) => crate::gpu::shares_nothing(tracer.info().backend),
        };
        let (frame, device) = begun?;
        let Some(job_request) = taken.job_request.take() else {
            return Err(Error::internal("a frame without its request"));
        };
        self.queue.send(RunningFrame::event(job_request, &frame, &device));
        let submitted =
            FrameSubmitter { guard: Some(guard), frame, device, background: false }.submit(&self.queue, &shared);
        // The host has no job that would tell it when its images are its own again.
        submitted.inspect_err(|_| job.leave_images()).map(|()| job)
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
        let is_it = |job_request: &JobRequest| {
            Arc::ptr_eq(&job_request.shared, job) && !matches!(job_request.target, JobTarget::Shared(..))
        };
        let place = state.waiting.iter().position(is_it)?;
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
    fn wait_for_room(&self, ahead: usize) -> Result<()> {
        let mut state = lock(&self.state);
        while state.steps >= ahead && !state.broken {
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
        // A frame that has begun gives nothing to do before its first step, or its failure, which follows.
        let wakes = !matches!(event, Event::Begun(_));
        state.events.push_back(event);
        // To wake a thread takes this one as long as to record a good part of a frame; one that is woken while the
        // lock is held would fall asleep again.
        drop(state);
        if wakes {
            self.to_finish.notify_one();
        }
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
        for job_request in &left.1 {
            if let JobTarget::Shared(frame) = &job_request.target {
                frame.sync.withdraw();
            }
        }
        drop(left);
    }
}

/// The submitting thread.
fn submit_all(queue: &JobQueue) {
    while let Some(job_request) = queue.take() {
        submit(queue, job_request);
    }
}

/// Submits a frame to the GPU; on the CPU and with GL, and of outputs, makes it.
fn submit(queue: &JobQueue, mut job_request: JobRequest) {
    let cancelled = job_request.shared.check_cancelled();
    // The signals of a target on the GPU are given all the same.
    if let (Err(error), JobTarget::Memory(..) | JobTarget::Outputs(_)) = (&cancelled, &job_request.target) {
        return queue.send(Event::Whole(Box::new(job_request), Err(error.clone())));
    }
    let mut guard = job_request.tracer.lock_arc();
    // A picture that is seen from several places is made strip by strip, and outputs are several frames.
    let is_one = match &job_request.target {
        JobTarget::Memory(..) => !job_request.scene.camera.is_omnistereo(),
        JobTarget::Shared(..) => true,
        JobTarget::Outputs(_) => false,
    };
    let begun = match &mut *guard {
        Tracer::Gpu(tracer) if is_one => {
            let begun = cancelled.and_then(|()| begin(tracer, &job_request));
            if let (Err(_), JobTarget::Shared(shared)) = (&begun, &job_request.target)
                && let Err(error) = Handed::new(shared.targets(), shared.sync.clone()).end(&tracer.device())
            {
                log::warn!("{SIGNALS_LOST}: {error}");
            }
            begun
        }
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
            let shared = job_request.shared.clone();
            queue.send(RunningFrame::event(job_request, &frame, &device));
            // The job tells of a failure.
            let _ = FrameSubmitter { guard: Some(guard), frame, device, background: true }.submit(queue, &shared);
        }
    }
}

/// Prepares a frame for its target. Errors: as [`GpuTracer::begin`].
fn begin(tracer: &mut GpuTracer, job_request: &JobRequest) -> Result<(BegunFrame, Arc<Device>)> {
    let frame = match &job_request.target {
        JobTarget::Memory(request, _) => tracer.begin(&job_request.scene, request, FrameTarget::Host)?,
        JobTarget::Shared(shared) => {
            let light = match &shared.light {
                None => FrameTarget::Nowhere,
                Some(SharedPlace::Target(target)) => FrameTarget::shared(target)?,
                Some(SharedPlace::Image(_)) => FrameTarget::Host,
            };
            let outputs = shared.outputs.iter().map(|(output, place)| match place {
                SharedPlace::Target(target) => (*output, OutputTo::Target(target)),
                SharedPlace::Image(number) => (*output, OutputTo::Host(*number)),
            });
            let outputs = outputs.collect::<Vec<_>>();
            let mut frame = tracer.begin_with(&job_request.scene, &shared.request, light, &outputs)?;
            frame.hand_over(shared.targets(), shared.sync.clone());
            frame
        }
        JobTarget::Outputs(_) => return Err(Error::internal("outputs are several frames")),
    };
    Ok((frame, tracer.device()))
}

/// Begins the frame, once its signals are known to grow. Errors: INVALID_ARGUMENT.
fn begin_asked(tracer: &mut GpuTracer, job_request: &JobRequest) -> Result<(BegunFrame, Arc<Device>)> {
    let JobTarget::Shared(SharedFrame { sync, .. }) = &job_request.target else {
        return Err(Error::internal("a frame for the host's memory on the host's thread"));
    };
    interop::check_signals(sync)?;
    let begun = begin(tracer, job_request)?;
    if let Err(error) = interop::ask_signals(sync) {
        tracer.forget();
        return Err(error);
    }
    Ok(begun)
}

/// The part that counts as done of a frame made in one piece, once its turn has come.
const BEGUN: f64 = 0.01;

/// Makes a frame without overlap with the next one: the CPU is busy, GL is one thread's, and outputs and strips are
/// several frames.
fn render_whole(tracer: &mut Tracer, job_request: &mut JobRequest) -> Result<FrameStats> {
    let (scene, shared) = (&job_request.scene, job_request.shared.clone());
    shared.report(BEGUN);
    let mut progress = |fraction: f64| {
        shared.report(BEGUN + (1.0 - BEGUN) * fraction);
        !shared.cancelled.load(Ordering::Relaxed)
    };
    let rendered = match &mut job_request.target {
        JobTarget::Memory(request, target) => {
            let mut sink = |tile: Tile, pixels: &[u8], row_bytes: usize| {
                target.write_tile(tile.x, tile.y, tile.width, tile.height, pixels, row_bytes)
            };
            tracer.render(scene, request, &mut sink, &mut progress)
        }
        JobTarget::Outputs(outputs) => outputs.render(tracer, scene, &mut progress),
        JobTarget::Shared(..) => Err(Error::internal("a target on the GPU for another tracer")),
    };
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
    device: Arc<Device>,
    /// Whether the submitting thread makes it, else one of the host's, which is not to wait for the GPU.
    background: bool,
}

impl FrameSubmitter {
    /// Submits the steps. After a failure the signals of a target are given all the same, but of a frame on the host's
    /// thread only once a step was submitted. Errors: CANCELLED; that of a step that failed; as
    /// [`GpuTracer::submit`]; the job ends with them too.
    fn submit(mut self, queue: &JobQueue, shared: &Shared) -> Result<()> {
        let submitted = self.submit_steps(queue, shared);
        if let Err(error) = &submitted {
            if let Err(error) = self.frame.give_signals(&self.device, self.background) {
                log::warn!("{SIGNALS_LOST}: {error}");
            }
            // While the tracer is held: after that another frame may begin.
            queue.send(Event::Failed(error.clone()));
        }
        submitted
    }

    fn submit_steps(&mut self, queue: &JobQueue, shared: &Shared) -> Result<()> {
        while !self.frame.is_submitted() {
            if self.background {
                queue.wait_for_room(AHEAD)?;
            } else if self.frame.submitted() >= MOST_AHEAD as u64 {
                queue.wait_for_room(MOST_AHEAD)?;
            }
            shared.check_failed()?;
            shared.check_cancelled()?;
            let Some(Tracer::Gpu(tracer)) = self.guard.as_deref_mut() else {
                return Err(Error::internal("a frame of the GPU on another tracer"));
            };
            if let Some(step) = tracer.submit(&mut self.frame)? {
                shared.report_half_step(self.frame.count());
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
    /// The first event of a frame.
    fn event(job_request: JobRequest, frame: &BegunFrame, device: &Arc<Device>) -> Event {
        let (stats, count) = (frame.stats(), frame.count());
        Event::Begun(Box::new(Self { job_request, device: device.clone(), stats, done: 0, count }))
    }

    /// Waits for the oldest step and takes its pixels. `None`: the frame has ended.
    fn finish_step(mut self, queue: &JobQueue, step: Submission) -> Option<Self> {
        match self.take_pixels(step) {
            Err(error) => {
                // Steps that are left are not submitted any more (`Shared::check_failed`).
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
        let shared = self.job_request.shared.clone();
        let target = &mut self.job_request.target;
        // On the GPU what is submitted is made.
        if let JobTarget::Memory(..) = target {
            shared.check_cancelled()?;
        }
        let mut sink = |output: Option<usize>, tile: Tile, pixels: &[u8], row_bytes: usize| match target {
            JobTarget::Memory(_, image) => image.write_tile(tile.x, tile.y, tile.width, tile.height, pixels, row_bytes),
            JobTarget::Shared(frame) => match frame.image_of(output) {
                Some(number) => shared.write_image(number, tile, pixels, row_bytes),
                None => Err(Error::internal("pixels of a target on the GPU came to the host")),
            },
            JobTarget::Outputs(_) => Err(Error::internal("a step of a frame without an image")),
        };
        step.finish_parts(&self.device, &mut self.stats, &mut sink)?;
        self.done += 1;
        self.job_request.shared.report_half_step(self.count);
        Ok(())
    }
}
