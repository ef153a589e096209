// SPDX-License-Identifier: MIT OR Apache-2.0
//! X11 windows, through a connection of bhr's own to the server they are on. Errors of the X server then never reach
//! the host's connection, whose Xlib handler would end the process, and the host may destroy its window, or close its
//! connection, before the surface. From the host's connection only its server is read.

use crate::error::{Error, Result};
use crate::platform::library_function;
use crate::window::claim;
use crate::window::native::{Handles, NativeWindow};
use raw_window_handle as rwh;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use std::ffi::{CStr, CString, OsStr, c_char, c_int, c_void};
use std::num::NonZeroU32;
use std::os::fd::{AsFd, BorrowedFd};
use std::os::unix::ffi::OsStrExt;
use std::ptr::NonNull;
use x11rb::connection::Connection;
use x11rb::errors::ReplyError;
use x11rb::protocol::xproto::{ConnectionExt, GetGeometryReply};
use x11rb::xcb_ffi::{XCBConnection, load_libxcb};

/// A window on a server that bhr is connected to.
pub struct X11Window {
    connection: XCBConnection,
    screen: usize,
    id: NonZeroU32,
    /// The one name that every connection to it gives.
    server: String,
    depth: u8,
}

impl X11Window {
    /// `None` for windows that are not of X11. Errors: INVALID_ARGUMENT for a window that is not on the server of the
    /// host's connection, or for a connection that is broken; UNSUPPORTED when bhr gets no connection of its own.
    pub fn open(native: &NativeWindow) -> Result<Option<Self>> {
        let (server, id) = match *native {
            NativeWindow::Xlib { display, window, .. } => (server_of_xlib(display)?, window),
            NativeWindow::Xcb { connection, window, .. } => (server_of_xcb(connection)?, window.get().into()),
            _ => return Ok(None),
        };
        let name = server.to_string_lossy().into_owned();
        load_libxcb().map_err(|error| Error::unsupported(format!("libxcb cannot be loaded: {error}")))?;
        let (connection, screen) = XCBConnection::connect(Some(&server)).map_err(|error| {
            Error::unsupported(format!("no connection of bhr's own to the X server {name}: {error}"))
        })?;
        let absent =
            || Error::argument(format!("window id is {id:#x}; there is no such window on the X server {name}"));
        let id = u32::try_from(id).ok().and_then(NonZeroU32::new).ok_or_else(absent)?;
        // The host may just have asked for it: on a connection that is written out, and read by the server, later.
        let geometry = match geometry(&connection, id) {
            Some(geometry) => geometry,
            None => {
                sync(native)?;
                geometry(&connection, id).ok_or_else(absent)?
            }
        };
        if geometry.depth == 0 {
            return Err(Error::argument(format!(
                "window id is {id:#x}; that is a window for input only, which shows nothing"
            )));
        }
        // One server may go by several names: `:7`, `:7.0`, `host:7`.
        let server = server_of(connection.as_fd()).unwrap_or(name);
        Ok(Some(Self { connection, screen, id, server, depth: geometry.depth }))
    }

    pub fn connection(&self) -> &XCBConnection {
        &self.connection
    }

    pub fn id(&self) -> u32 {
        self.id.get()
    }

    /// The size in pixels; `None` once the window, or the server, is gone.
    pub fn size(&self) -> Option<[u32; 2]> {
        geometry(&self.connection, self.id).map(|g| [g.width.into(), g.height.into()])
    }

    /// Bits of a pixel that count.
    pub fn depth(&self) -> u8 {
        self.depth
    }

    /// The window as bhr's own connection knows it.
    pub fn handles(&self) -> Handles {
        let connection = NonNull::new(self.connection.get_raw_xcb_connection());
        let display = rwh::XcbDisplayHandle::new(connection, self.screen as c_int);
        Handles::Raw(display.into(), rwh::XcbWindowHandle::new(self.id).into())
    }

    pub fn claim_key(&self) -> claim::Key {
        (self.server.clone(), self.id.get().into())
    }

    /// Drops the server's complaints about requests that nobody waited for.
    pub fn drop_errors(&self) {
        while let Ok(Some(_)) = self.connection.poll_for_event() {}
    }
}

fn geometry(connection: &XCBConnection, id: NonZeroU32) -> Option<GetGeometryReply> {
    match connection.get_geometry(id.get()).map(|cookie| cookie.reply()) {
        Ok(Ok(reply)) => Some(reply),
        Ok(Err(ReplyError::X11Error(_) | ReplyError::ConnectionError(_))) | Err(_) => None,
    }
}

/// A function of a system library, which stays loaded. Errors: UNSUPPORTED.
///
/// # Safety
/// `F` is the type of that function.
unsafe fn function<F: Copy>(library: &CStr, name: &CStr) -> Result<F> {
    const { assert!(size_of::<F>() == size_of::<*mut c_void>()) };
    let found = library_function(library, name).map_err(|_| {
        Error::unsupported(format!("{} of {} is not there", name.to_string_lossy(), library.to_string_lossy()))
    })?;
    // SAFETY: a function's address, of the size checked above, of this type by the contract.
    Ok(unsafe { std::mem::transmute_copy(&found) })
}

type ConnectionNumber = unsafe extern "C" fn(*mut c_void) -> c_int;

/// Whether the other end of a socket has gone.
fn is_closed(socket: BorrowedFd<'_>) -> bool {
    let mut polled = [PollFd::from_borrowed_fd(socket, PollFlags::IN)];
    let gone = PollFlags::HUP | PollFlags::ERR | PollFlags::NVAL;
    poll(&mut polled, Some(&Timespec::default())).is_err() || polled[0].revents().intersects(gone)
}

/// Waits until the server has read what the host has asked for.
fn sync(native: &NativeWindow) -> Result<()> {
    match *native {
        NativeWindow::Xlib { display, .. } => {
            type Sync = unsafe extern "C" fn(*mut c_void, c_int) -> c_int;
            // On a connection that the server has closed it would end the process. SAFETY: Xlib's `int
            // XConnectionNumber(Display *)`, which reads a field; the display keeps its socket open during this call.
            let socket = unsafe {
                let number = function::<ConnectionNumber>(c"libX11.so.6", c"XConnectionNumber")?;
                BorrowedFd::borrow_raw(number(display.as_ptr()))
            };
            if is_closed(socket) {
                return Ok(());
            }
            // SAFETY: Xlib's `int XSync(Display *, Bool)`, which keeps the host's events; the host vouches for its
            // `Display *`, and by the header calls on the thread that uses it, unless it has called XInitThreads.
            unsafe { function::<Sync>(c"libX11.so.6", c"XSync")?(display.as_ptr(), 0) };
        }
        NativeWindow::Xcb { connection, .. } => {
            // SAFETY: the host vouches for its connection, which stays open: it is not dropped here.
            let hosts = unsafe { XCBConnection::from_raw_xcb_connection(connection.as_ptr(), false) };
            let asked = hosts.map_err(|error| Error::argument(format!("window display: {error}")))?;
            // A round trip; what it says does not matter.
            let _ = asked.get_input_focus().map(|cookie| cookie.reply());
        }
        _ => {}
    }
    Ok(())
}

/// The name of the server that an Xlib connection leads to.
fn server_of_xlib(display: NonNull<c_void>) -> Result<CString> {
    type DisplayString = unsafe extern "C" fn(*mut c_void) -> *const c_char;
    // SAFETY: Xlib's `char *XDisplayString(Display *)`, which reads a field; the host vouches for its `Display *`.
    let name = unsafe { function::<DisplayString>(c"libX11.so.6", c"XDisplayString")?(display.as_ptr()) };
    if name.is_null() {
        return Err(Error::argument("window display names no X server"));
    }
    // SAFETY: a C string that the display keeps.
    Ok(unsafe { CStr::from_ptr(name) }.to_owned())
}

/// The name of the server that an XCB connection leads to, by the other end of its socket: XCB keeps no name.
fn server_of_xcb(connection: NonNull<c_void>) -> Result<CString> {
    type Ask = unsafe extern "C" fn(*mut c_void) -> c_int;
    // SAFETY: XCB's `int xcb_connection_has_error(xcb_connection_t *)` and `int xcb_get_file_descriptor(..)`, which
    // read fields; the host vouches for its connection.
    let (error, socket) = unsafe {
        let has_error = function::<Ask>(c"libxcb.so.1", c"xcb_connection_has_error")?;
        let descriptor = function::<Ask>(c"libxcb.so.1", c"xcb_get_file_descriptor")?;
        (has_error(connection.as_ptr()), descriptor(connection.as_ptr()))
    };
    if error != 0 || socket < 0 {
        return Err(Error::argument(format!("window display is an XCB connection in error {error}")));
    }
    // SAFETY: the host's connection keeps its socket open during this call.
    let socket = unsafe { BorrowedFd::borrow_raw(socket) };
    let name = server_of(socket);
    // A socket of an unknown kind: the environment's server, as for a host that named none.
    let name = name.or_else(|| std::env::var("DISPLAY").ok());
    let name = name.ok_or_else(|| Error::unsupported("window display leads to an X server that has no name"))?;
    CString::new(name).map_err(|_| Error::unsupported("window display leads to an X server whose name holds a NUL"))
}

/// The name of the server that a socket leads to.
fn server_of(socket: BorrowedFd<'_>) -> Option<String> {
    rustix::net::getpeername(socket).ok().flatten().and_then(|address| server_at(&address))
}

/// The name of the server behind the far end of a socket: `:N` for the local socket `../X<N>`, `host:N` for port 6000
/// + N.
fn server_at(address: &rustix::net::SocketAddrAny) -> Option<String> {
    if let Ok(unix) = rustix::net::SocketAddrUnix::try_from(address.clone()) {
        let path = unix.path_bytes().or(unix.abstract_name())?;
        let number = OsStr::from_bytes(path).to_str()?.rsplit_once("/X")?.1.parse::<u32>().ok()?;
        return Some(format!(":{number}"));
    }
    let internet = std::net::SocketAddr::try_from(address.clone()).ok()?;
    let number = internet.port().checked_sub(6000)?;
    Some(match internet.ip() {
        std::net::IpAddr::V4(ip) => format!("{ip}:{number}"),
        std::net::IpAddr::V6(ip) => format!("[{ip}]:{number}"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rustix::net::{SocketAddrAny, SocketAddrUnix};

    #[test]
    fn servers_are_named_by_the_far_end_of_a_socket() {
        let unix = |path: &str| SocketAddrAny::from(SocketAddrUnix::new(path).unwrap());
        assert_eq!(server_at(&unix("/tmp/.X11-unix/X99")).as_deref(), Some(":99"));
        assert_eq!(server_at(&unix("/run/something/else")), None);
        let hidden = SocketAddrUnix::new_abstract_name(b"/tmp/.X11-unix/X7").unwrap();
        assert_eq!(server_at(&hidden.into()).as_deref(), Some(":7"));
        let remote = "10.1.2.3:6010".parse::<std::net::SocketAddr>().unwrap();
        assert_eq!(server_at(&remote.into()).as_deref(), Some("10.1.2.3:10"));
    }
}
