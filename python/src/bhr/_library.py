# SPDX-License-Identifier: MIT OR Apache-2.0
"""The loaded library, its errors, and the rules for calling it: what a failed call raises, which calls are refused
after a fork, and what runs inside a callback of the library. Knows nothing of contexts and frames."""

from __future__ import annotations

import os
import sys
import threading
from pathlib import Path
from typing import Any, Callable, Optional

from ._constants import Status
from ._ffi import ffi
from ._platform import library_file

# By its full path, with which Windows asks no list of folders for it. The DLL needs none but Windows' own.
lib: Any = ffi.dlopen(str(Path(__file__).resolve().with_name(library_file(sys.platform))))

if lib.bhr_abi_version() != lib.BHR_ABI_VERSION:
    raise ImportError("the library inside the package bhr is not the one that the package was built with")

#: The function that is told how much of a frame is done; it returns False to cancel the frame.
Progress = Callable[[float], Optional[bool]]


class Error(Exception):
    """A call of the library failed. `message` names the argument, its value and the limit."""

    status: Status
    message: str

    def __init__(self, status: Status, message: str) -> None:
        super().__init__(message)
        self.status = status
        self.message = message

    def __str__(self) -> str:
        return self.message

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.status, self.message)


class InvalidArgument(Error, ValueError):
    """An argument is not finite, out of its range, or unknown."""


class OutOfMemory(Error, MemoryError):
    """Host or device memory ran out."""


class FileError(Error, OSError):
    """A file could not be read or written."""


class Cancelled(Error):
    """The progress function, or Job.cancel, stopped the work."""


class DeviceLost(Error):
    """The GPU device is gone: call Context.recover."""


_CLASSES: dict[Status, type[Error]] = {
    Status.INVALID_ARGUMENT: InvalidArgument,
    Status.OUT_OF_MEMORY: OutOfMemory,
    Status.IO: FileError,
    Status.CANCELLED: Cancelled,
    Status.DEVICE_LOST: DeviceLost,
}


def error(status: Status, message: str) -> Error:
    return _CLASSES.get(status, Error)(status, message)


def failure(status: int) -> Error:
    """The error of a call that has just failed on this thread: its message is this thread's."""
    return error(Status(status), ffi.string(lib.bhr_error_message()).decode())


def check(status: int) -> None:
    if status < 0:
        raise failure(status)


class Call:
    """A call that may run a progress function, on the thread that makes it."""

    def __init__(self, progress: Progress | None) -> None:
        self.progress = progress
        self.exception: BaseException | None = None

    def __enter__(self) -> Call:
        self.outer, self.callbacks = _thread.call, _thread.callbacks
        _thread.call = self
        return self

    def __exit__(self, *_: object) -> None:
        # An interrupt may have come between a callback's begin and its mark.
        _thread.call, _thread.callbacks = self.outer, self.callbacks

    def check(self, status: int) -> None:
        """Raises what the progress function raised, else the call's failure."""
        if self.exception is not None:
            # Without the reference from the call, which the exception's own traceback leads back to.
            exception, self.exception = self.exception, None
            raise exception
        check(status)


class _Thread(threading.local):
    call: Call | None = None
    callbacks: int = 0


_thread = _Thread()


class InsideCallback:
    """Marks the thread while a callback of the library runs on it."""

    def __enter__(self) -> None:
        _thread.callbacks += 1

    def __exit__(self, *_: object) -> None:
        _thread.callbacks -= 1


def inside_callback() -> bool:
    return _thread.callbacks > 0


def _keep_exception(_type: object, exception: BaseException, _traceback: object) -> None:
    if _thread.call is not None:
        _thread.call.exception = exception


# Every context has this as its progress callback, also without a function of the host's: Python runs its signal
# handlers here, so that Ctrl-C raises KeyboardInterrupt, which cancels the frame as any exception does.
@ffi.callback("int32_t(void *, double)", error=0, onerror=_keep_exception)  # type: ignore[untyped-decorator]
def on_progress(_user: object, fraction: float) -> int:
    call = _thread.call
    if _ending:
        return 0
    if call is None or call.progress is None:
        return 1
    with InsideCallback():
        return 0 if call.progress(fraction) is False else 1


_ending = False


def cancel_frames() -> None:
    """Cancels all frames, those of daemon threads too, as the interpreter ends."""
    global _ending
    _ending = True


#: Whether the library has begun threads or opened drivers in this process, which a forked child inherits broken.
_begun = False
_forked = False


def begin() -> None:
    """Stands before every call that makes contexts or asks for adapters."""
    global _begun
    refuse_fork()
    _begun = True


def refuse_fork() -> None:
    if _forked:
        raise error(Status.INVALID_STATE, "the parent of this forked process has used bhr: start it by spawn, not fork")


def forked() -> bool:
    return _forked


def _after_fork() -> None:
    global _forked
    _forked = _begun


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_after_fork)
