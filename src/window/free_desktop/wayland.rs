// SPDX-License-Identifier: MIT OR Apache-2.0
//! When a window of Wayland takes its next frame: by wl_surface.frame ("a hint when it is a good time to start drawing
//! a new frame", Wayland protocol, wl_surface), on the host's connection, with an event queue of bhr's own. Drivers do
//! the same for VSYNC, some of them (Mesa's) without a limit: a compositor says nothing to a window that it does not
//! show, and the host hangs. Sends nothing else, and never reads or dispatches what is the host's.

use crate::error::{Error, ErrorKind, Result};
use crate::window::Pacer;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use std::ffi::c_void;
use std::fmt::Display;
use std::io;
use std::os::fd::OwnedFd;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr::NonNull;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use wayland_client::backend::protocol::Message;
use wayland_client::backend::{Backend, ObjectData, ObjectId, ReadEventsGuard, WaylandError};
use wayland_client::protocol::wl_surface::{self, WlSurface};
use wayland_client::{Connection, Proxy};
use wayland_sys::client::{is_lib_available, wayland_client_handle, wl_proxy};
use wayland_sys::ffi_dispatch;

/// How long a frame waits for the compositor, as the header says.
const PATIENCE: Duration = Duration::from_secs(1);

/// The compositor's word on when to draw, for one wl_surface.
pub struct FramePacer {
    /// Dropped first: its queue and the callback go with it.
    connection: Connection,
    surface: WlSurface,
    /// The memory that `surface` points to.
    _wrapper: Wrapper,
    /// `None`: the next frame waits for nothing.
    asked: Option<Callback>,
}

/// A wl_callback that was asked for, and whether it has come.
struct Callback {
    id: ObjectId,
    done: Arc<Done>,
}

#[derive(Default)]
struct Done(AtomicBool);

impl ObjectData for Done {
    fn event(self: Arc<Self>, _: &Backend, _: Message<ObjectId, OwnedFd>) -> Option<Arc<dyn ObjectData>> {
        self.0.store(true, Ordering::Release);
        None
    }

    fn destroyed(&self, _: ObjectId) {}
}

/// A stand-in for the host's wl_surface in the client's library. Its memory is bhr's: should the host, against the
/// header, destroy the wl_surface first, the compositor refuses the request, and nothing that was freed is read.
struct Wrapper(NonNull<wl_proxy>);

// SAFETY: libwayland-client locks its display around every use of a proxy; this one is used by one thread at a time.
unsafe impl Send for Wrapper {}

impl Wrapper {
    /// # Safety
    /// `surface` is a wl_proxy, and libwayland-client is there.
    unsafe fn new(surface: NonNull<c_void>) -> Option<Self> {
        // SAFETY: this function's contract.
        let made = unsafe {
            ffi_dispatch!(wayland_client_handle(), wl_proxy_create_wrapper, surface.cast::<wl_proxy>().as_ptr())
        };
        NonNull::new(made).map(Self)
    }
}

impl Drop for Wrapper {
    fn drop(&mut self) {
        // SAFETY: `new` made it; only the `FramePacer` around it, which ends, uses it.
        unsafe { ffi_dispatch!(wayland_client_handle(), wl_proxy_wrapper_destroy, self.0.as_ptr()) }
    }
}

fn unsupported(why: impl Display) -> Error {
    Error::unsupported(format!("no frame callbacks of the compositor's: {why}"))
}

fn lost(why: impl Display) -> Error {
    Error::new(ErrorKind::SurfaceLost, format!("the connection to the compositor failed: {why}"))
}

/// `work` with the wayland crates, which panic where a connection or the memory ends.
fn guarded<T>(failed: fn(&'static str) -> Error, work: impl FnOnce() -> Result<T>) -> Result<T> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|_| Err(failed("the client library gave up")))
}

/// Whether it happened; what would have blocked is no error. Errors: SURFACE_LOST.
fn unless_blocked<T>(result: Result<T, WaylandError>) -> Result<()> {
    match result {
        Ok(_) => Ok(()),
        Err(WaylandError::Io(error)) if error.kind() == io::ErrorKind::WouldBlock => Ok(()),
        Err(error) => Err(lost(error)),
    }
}

impl FramePacer {
    /// For a `wl_surface *` on a `wl_display *`, both of the host's. Errors: UNSUPPORTED.
    pub fn new(display: NonNull<c_void>, surface: NonNull<c_void>) -> Result<Self> {
        if !is_lib_available() {
            return Err(unsupported("libwayland-client cannot be loaded"));
        }
        guarded(unsupported, || {
            // SAFETY: by the header both pointers are what their kind says, and outlive the surface, with which this
            // goes. The host's wl_surface is only read here.
            let (wrapper, backend) =
                unsafe { (Wrapper::new(surface), Backend::from_foreign_display(display.as_ptr().cast())) };
            let wrapper = wrapper.ok_or_else(|| unsupported("out of memory"))?;
            // SAFETY: a wrapper is a wl_proxy; it goes after what points to it.
            let id = unsafe { ObjectId::from_ptr(WlSurface::interface(), wrapper.0.as_ptr().cast()) };
            let connection = Connection::from_backend(backend);
            let surface = id.and_then(|id| WlSurface::from_id(&connection, id)).map_err(unsupported)?;
            Ok(Self { connection, surface, _wrapper: wrapper, asked: None })
        })
    }

    /// Whether the window takes a frame. Errors: SURFACE_LOST.
    fn is_free(&self) -> Result<bool> {
        // Events that another thread has read for this queue.
        unless_blocked(self.connection.backend().dispatch_inner_queue())?;
        Ok(self.asked.as_ref().is_none_or(|asked| asked.done.0.load(Ordering::Acquire)))
    }

    fn wait_until(&self, deadline: Instant) -> Result<bool> {
        while !self.is_free()? {
            // `None`: there are events for this queue.
            let Some(reading) = self.connection.prepare_read() else { continue };
            unless_blocked(self.connection.flush())?;
            if !is_readable(&reading, deadline)? {
                return Ok(false);
            }
            // For every queue of the connection: the other ones' owners find theirs there.
            unless_blocked(reading.read())?;
        }
        Ok(true)
    }

    fn ask_for_callback(&self) -> Result<Callback> {
        let done = Arc::new(Done::default());
        let data: Arc<dyn ObjectData> = done.clone();
        let id =
            self.connection.send_request(&self.surface, wl_surface::Request::Frame {}, Some(data)).map_err(lost)?;
        Ok(Callback { id, done })
    }
}

/// Whether the compositor has sent something before the deadline. Errors: SURFACE_LOST.
fn is_readable(reading: &ReadEventsGuard, deadline: Instant) -> Result<bool> {
    let fd = reading.connection_fd();
    loop {
        let left = deadline.saturating_duration_since(Instant::now());
        let left = Timespec::try_from(left).map_err(lost)?;
        match poll(&mut [PollFd::new(&fd, PollFlags::IN)], Some(&left)) {
            Ok(ready) => return Ok(ready > 0),
            Err(rustix::io::Errno::INTR) => {}
            Err(error) => return Err(lost(error)),
        }
    }
}

impl Pacer for FramePacer {
    /// A callback that is late is waited for again: the compositor sends it when it shows the window.
    fn wait(&mut self) -> Result<bool> {
        guarded(lost, || self.wait_until(Instant::now() + PATIENCE))
    }

    fn ask(&mut self) -> Result<()> {
        self.forget();
        self.asked = Some(guarded(lost, || self.ask_for_callback())?);
        Ok(())
    }

    fn forget(&mut self) {
        let Some(asked) = self.asked.take() else { return };
        // A callback that has come is gone already, which is no error here; after a panic the next use of the
        // connection says so.
        let _ = guarded(lost, || self.connection.backend().destroy_object(&asked.id).map_err(lost));
    }
}
