//! Frames in the background: a thread of its own for each renderer that takes orders, each with its own copy of the scene, and
//! keeps several under way, so that the GPU traces one while another is copied to the host. Knows no callbacks and nothing of C.

use crate::error::{Error, ErrorKind, Result};
use crate::gpu::{BegunFrame, Device, FrameTarget, Submitted};
use crate::image::ImageMut;
use crate::renderer::{FrameRequest, FrameStats, Progress, SharedTracer, StatsBoard, Tile, Tracer};
use crate::scene::Scene;
use parking_lot::{ArcMutexGuard, RawMutex};
use std::any::Any;
use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Jobs of one renderer that may be unfinished at a time.
pub const MAX_UNFINISHED: usize = 64;

/// Submissions under way on the GPU at most: one is copied to the host while two more keep the GPU busy.
const AHEAD: usize = 3;

/// What a worker's thread enters at its begin and leaves at its end: a scope of the caller's log.
pub type ThreadScope = Box<dyn FnOnce() -> Box<dyn Any> + Send>;

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // Nothing under these locks is left half done by a panic.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A frame that was ordered. Clones are the same job; dropping them all neither ends nor cancels it.
#[derive(Clone)]
pub struct Job {
    shared: Arc<Shared>,
}

#[derive(Default)]
struct Shared {
    outcome: Mutex<Option<Result<FrameStats>>>,
    /// At every step and at the end.
    changed: Condvar,
    cancelled: AtomicBool,
    /// Bits of the f64 that is done, 0 .. 1.
    fraction: AtomicU64,
}

impl Job {
    /// The part that is done, 0 .. 1.
    pub fn fraction(&self) -> f64 {
        f64::from_bits(self.shared.fraction.load(Ordering::Relaxed))
    }

    /// Asks it to stop: what is not yet begun is not done any more.
    pub fn cancel(&self) {
        self.shared.cancelled.store(true, Ordering::Relaxed);
    }

    /// What it ended with; `None` while it runs.
    pub fn outcome(&self) -> Option<Result<FrameStats>> {
        lock(&self.shared.outcome).clone()
    }

    /// Waits for its end, at most `timeout` (`None`: for ever), and calls `progress`, which cancels it by returning false, on this
    /// thread whenever more is done. What it ended with; `None` while it runs.
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
                // Not under the lock: the caller's code may take its time, or ask this job.
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

/// A frame to be made, and the job that hears of it. Its target is written until the job has its outcome, and never after.
pub struct Order {
    pub scene: Scene,
    pub request: FrameRequest,
    pub target: ImageMut<'static>,
    pub tracer: SharedTracer,
    pub stats: StatsBoard,
    shared: Arc<Shared>,
    ordered: Instant,
}

impl Order {
    pub fn new(
        scene: Scene,
        request: FrameRequest,
        target: ImageMut<'static>,
        tracer: SharedTracer,
        stats: StatsBoard,
    ) -> Self {
        Self { scene, request, target, tracer, stats, shared: Arc::default(), ordered: Instant::now() }
    }

    fn check_cancelled(&self) -> Result<()> {
        match self.shared.cancelled.load(Ordering::Relaxed) {
            true => Err(Error::new(ErrorKind::Cancelled, "the job was cancelled")),
            false => Ok(()),
        }
    }

    fn report(&self, fraction: f64) {
        // Under the lock, lest a waiter miss it between looking and sleeping.
        let _outcome = lock(&self.shared.outcome);
        self.shared.fraction.store(fraction.to_bits(), Ordering::Relaxed);
        self.shared.changed.notify_all();
    }

    /// The job's end. The target is its owner's again.
    fn finish(self, outcome: Result<FrameStats>) {
        let touched = self.target.is_touched();
        let outcome = outcome.map(|stats| self.stats.publish(stats, self.ordered.elapsed())).map_err(|mut error| {
            if touched {
                error.message += "; part of the target has been written";
            }
            error
        });
        self.shared.fraction.store(f64::from(u8::from(outcome.is_ok())).to_bits(), Ordering::Relaxed);
        self.end(outcome);
    }

    fn end(&self, outcome: Result<FrameStats>) {
        lock(&self.shared.outcome).get_or_insert(outcome);
        self.shared.changed.notify_all();
    }
}

impl Drop for Order {
    fn drop(&mut self) {
        self.end(Err(Error::internal("the thread that renders in the background failed")));
    }
}

#[derive(Default)]
struct Queue {
    orders: Mutex<Orders>,
    /// An order came, or the end.
    changed: Condvar,
}

#[derive(Default)]
struct Orders {
    waiting: VecDeque<Order>,
    /// Taken by the thread and not yet finished.
    taken: usize,
    /// No more will come, or will be taken.
    closed: bool,
}

/// The thread that makes a renderer's jobs, in their order. Dropping it finishes them all first.
pub struct Worker {
    queue: Arc<Queue>,
    thread: Option<JoinHandle<()>>,
}

impl Worker {
    /// Errors: OUT_OF_MEMORY when the system gives no thread.
    pub fn new(scope: ThreadScope) -> Result<Self> {
        let queue = Arc::<Queue>::default();
        let of_thread = queue.clone();
        let work = move || {
            let _scope = scope();
            // Unwind safe: after a panic nothing is taken any more, and what was taken ends as it is dropped.
            let result = catch_unwind(AssertUnwindSafe(|| run(&of_thread)));
            of_thread.close();
            if let Err(payload) = result {
                // Dropping an unknown payload may panic again.
                std::mem::forget(payload);
                log::error!("the thread that renders in the background panicked");
            }
        };
        let thread = std::thread::Builder::new().name("bhr-jobs".into()).spawn(work);
        let thread = thread.map_err(|error| {
            Error::new(ErrorKind::OutOfMemory, format!("no thread to render in the background: {error}"))
        })?;
        Ok(Self { queue, thread: Some(thread) })
    }

    /// Errors: INVALID_STATE when too many are unfinished; INTERNAL when a job panicked before.
    pub fn order(&self, order: Order) -> Result<Job> {
        let job = Job { shared: order.shared.clone() };
        let mut orders = lock(&self.queue.orders);
        if orders.closed {
            return Err(Error::internal("the thread that renders in the background failed before"));
        }
        let unfinished = orders.waiting.len() + orders.taken;
        if unfinished >= MAX_UNFINISHED {
            return Err(Error::state(format!(
                "{unfinished} jobs are unfinished, as many as a context takes; wait for one or cancel it"
            )));
        }
        orders.waiting.push_back(order);
        self.queue.changed.notify_all();
        Ok(job)
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        lock(&self.queue.orders).closed = true;
        self.queue.changed.notify_all();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

impl Queue {
    /// The next order. `wait`: until one comes; `None` then means the end.
    fn take(&self, wait: bool) -> Option<Order> {
        let mut orders = lock(&self.orders);
        loop {
            if let Some(order) = orders.waiting.pop_front() {
                orders.taken += 1;
                return Some(order);
            }
            if !wait || orders.closed {
                return None;
            }
            orders = self.changed.wait(orders).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn finish(&self, order: Order, outcome: Result<FrameStats>) {
        // First, so that a host that has seen the end may order again.
        lock(&self.orders).taken -= 1;
        order.finish(outcome);
    }

    fn close(&self) {
        let waiting = {
            let mut orders = lock(&self.orders);
            orders.closed = true;
            std::mem::take(&mut orders.waiting)
        };
        drop(waiting);
    }
}

/// A frame of which steps are under way on the GPU.
struct Running {
    order: Order,
    device: Arc<Device>,
    /// The steps that are left, and the tracer, which no other frame may use before they are submitted.
    left: Option<(ArcMutexGuard<RawMutex, Tracer>, BegunFrame)>,
    steps: VecDeque<Submitted>,
    stats: FrameStats,
    done: u64,
    count: u64,
}

/// Makes the queue's frames until its end.
fn run(queue: &Queue) {
    let mut running = VecDeque::<Running>::new();
    loop {
        let under_way = running.iter().map(|frame| frame.steps.len()).sum::<usize>();
        let has_left = running.back().is_some_and(|frame| frame.left.is_some());
        if under_way < AHEAD && has_left {
            if let Some(frame) = running.back_mut()
                && let Err(error) = frame.submit()
                && let Some(mut frame) = running.pop_back()
            {
                frame.forget_tables();
                frame.fail(queue, error);
            }
            continue;
        }
        if under_way < AHEAD
            && let Some(order) = queue.take(under_way == 0)
        {
            begin(queue, &mut running, order);
            continue;
        }
        let Some(mut first) = running.pop_front() else { return };
        match first.finish_step() {
            Err(error) => {
                // Left before its last step was submitted; or that of a device that went wrong, whose tables no frame can use.
                first.forget_tables();
                first.fail(queue, error);
            }
            Ok(()) if first.done < first.count => running.push_front(first),
            Ok(()) => first.succeed(queue),
        }
    }
}

/// Begins a frame on the GPU; on the CPU, makes it.
fn begin(queue: &Queue, running: &mut VecDeque<Running>, mut order: Order) {
    if let Err(error) = order.check_cancelled() {
        return queue.finish(order, Err(error));
    }
    let mut guard = order.tracer.lock_arc();
    let begun = match &mut *guard {
        Tracer::Gpu(tracer) => {
            tracer.begin(&order.scene, &order.request, FrameTarget::Host).map(|f| (f, tracer.device()))
        }
        Tracer::Cpu(_) => {
            let rendered = render_on_cpu(&mut guard, &mut order);
            // Whoever waits for the tracer gets it before the next job does.
            ArcMutexGuard::unlock_fair(guard);
            return queue.finish(order, rendered);
        }
    };
    match begun {
        Err(error) => queue.finish(order, Err(error)),
        Ok((frame, device)) => {
            let (stats, count) = (frame.stats(), frame.count());
            let left = Some((guard, frame));
            running.push_back(Running { order, device, left, steps: VecDeque::new(), stats, done: 0, count });
        }
    }
}

fn render_on_cpu(tracer: &mut Tracer, order: &mut Order) -> Result<FrameStats> {
    let (scene, request, target, shared) = (&order.scene, &order.request, &mut order.target, order.shared.clone());
    let mut sink = |tile: Tile, pixels: &[u8], row_bytes: usize| {
        target.write_tile(tile.x, tile.y, tile.width, tile.height, pixels, row_bytes)
    };
    let mut progress = |fraction: f64| {
        let _outcome = lock(&shared.outcome);
        shared.fraction.store(fraction.to_bits(), Ordering::Relaxed);
        shared.changed.notify_all();
        !shared.cancelled.load(Ordering::Relaxed)
    };
    let rendered = tracer.render(scene, request, &mut sink, &mut progress);
    rendered.map_err(|error| match error.kind {
        ErrorKind::Cancelled => Error::new(ErrorKind::Cancelled, "the job was cancelled"),
        _ => error,
    })
}

impl Running {
    /// Submits the next of the steps that are left.
    fn submit(&mut self) -> Result<()> {
        let Some((guard, frame)) = &mut self.left else { return Ok(()) };
        let Tracer::Gpu(tracer) = &mut **guard else {
            return Err(Error::internal("a frame of the GPU on another tracer"));
        };
        self.order.check_cancelled()?;
        let step = tracer.submit(frame)?;
        self.steps.extend(step);
        if frame.is_submitted()
            && let Some((guard, _)) = self.left.take()
        {
            // Whoever waits for the tracer gets it before the next job does.
            ArcMutexGuard::unlock_fair(guard);
        }
        Ok(())
    }

    /// Waits for the oldest step and takes its pixels.
    fn finish_step(&mut self) -> Result<()> {
        self.order.check_cancelled()?;
        let Some(step) = self.steps.pop_front() else { return Err(Error::internal("a frame without steps")) };
        let target = &mut self.order.target;
        let mut sink = |tile: Tile, pixels: &[u8], row_bytes: usize| {
            target.write_tile(tile.x, tile.y, tile.width, tile.height, pixels, row_bytes)
        };
        step.finish(&self.device, &mut self.stats, &mut sink)?;
        self.done += 1;
        self.order.report(self.done as f64 / self.count as f64);
        Ok(())
    }

    fn succeed(mut self, queue: &Queue) {
        self.stats.device_bytes = self.device.bytes();
        queue.finish(self.order, Ok(self.stats));
    }

    fn fail(self, queue: &Queue, error: Error) {
        queue.finish(self.order, Err(error));
    }

    /// Takes back what the GPU tracer believes of its tables of lenses.
    fn forget_tables(&mut self) {
        if let Some((guard, _)) = &mut self.left
            && let Tracer::Gpu(tracer) = &mut **guard
        {
            tracer.forget();
        }
    }
}
