# SPDX-License-Identifier: MIT OR Apache-2.0
"""The way to a context of the library, and to what belongs to one: it is open until that is closed, which waits until
nobody is inside any more, because no object of the library may end under a call."""

from __future__ import annotations

import logging
import threading
from typing import Any

from ._constants import Status
from ._ffi import ffi
from ._library import InsideCallback, check, error, forked, inside_callback, lib, on_progress, refuse_fork

_LEVELS = {
    lib.BHR_LOG_ERROR: logging.ERROR,
    lib.BHR_LOG_WARN: logging.WARNING,
    lib.BHR_LOG_INFO: logging.INFO,
    lib.BHR_LOG_DEBUG: logging.DEBUG,
    lib.BHR_LOG_TRACE: logging.DEBUG - 5,
}

#: The ends of objects, with what those need, that Python gave up within a callback, where the library ends none.
_orphans: list[tuple[Any, Any, Any]] = []


def log_level(logger: logging.Logger) -> int:
    """The library's level that tells a logger all that it lets through."""
    wanted = logger.getEffectiveLevel()
    return int(max((ours for ours, theirs in _LEVELS.items() if theirs >= wanted), default=lib.BHR_LOG_OFF))


@ffi.callback("void(void *, int32_t, const char *)")  # type: ignore[untyped-decorator]
def on_log(user: Any, level: int, message: Any) -> None:
    with InsideCallback():
        logger: logging.Logger = ffi.from_handle(user)
        logger.log(_LEVELS.get(level, logging.ERROR), "%s", ffi.string(message).decode("utf-8", "replace"))


class Door:
    """Owns an object of the library. `with door as pointer:` stands around every call on it."""

    def __init__(self, what: str, end: Any) -> None:
        """`what` it is, for messages, and the function that ends it; `_pointer` and `_kept`, which must live as long as
        the object does, are for derived classes to set."""
        self._pointer = ffi.NULL
        self._kept: Any = None
        self._what, self._end = what, end
        end_orphans()
        #: The threads inside.
        self._inside: list[int] = []
        self._closed = False
        self._changed = threading.Condition(threading.Lock())

    def __enter__(self) -> Any:
        refuse_fork()
        with self._changed:
            if self._closed:
                raise error(Status.INVALID_STATE, f"the {self._what} is closed")
            self._inside.append(threading.get_ident())
        return self._pointer

    def __exit__(self, *_: object) -> None:
        with self._changed:
            self._inside.remove(threading.get_ident())
            self._changed.notify_all()

    @property
    def closed(self) -> bool:
        return self._closed

    def refuse(self) -> None:
        """Lets nobody in any more."""
        with self._changed:
            self._closed = True

    def wait_until_empty(self) -> None:
        """Waits until no other thread is inside. This one is not, even if an interrupt came as it entered or left."""
        this = threading.get_ident()
        with self._changed:
            self._changed.wait_for(lambda: all(thread == this for thread in self._inside))

    def destroy(self) -> None:
        """Ends the object, after refuse and empty, unless another thread has."""
        with self._changed:
            pointer, self._pointer = self._pointer, ffi.NULL
        self._end(pointer)

    def close(self) -> None:
        """Ends the object when nobody is inside any more. Again is no error."""
        if inside_callback():
            raise error(Status.INVALID_STATE, f"a {self._what} cannot be closed from inside a callback")
        if not forked():
            self.refuse()
            self.wait_until_empty()
            self.destroy()

    def __del__(self) -> None:
        # Nobody is inside, and no job is there: they all have the door.
        if self._pointer == ffi.NULL or forked():
            return
        if inside_callback():
            _orphans.append((self._end, self._pointer, self._kept))
        else:
            self.destroy()


class Gate(Door):
    """Owns a context."""

    def __init__(self, options: Any, logger: logging.Logger) -> None:
        super().__init__("context", lib.bhr_context_destroy)
        self._kept = ffi.new_handle(logger)
        options.log_fn, options.log_user = on_log, self._kept
        pointer = ffi.new("BhrContext **")
        check(lib.bhr_context_create(lib.BHR_ABI_VERSION, options, pointer))
        self._pointer = pointer[0]
        check(lib.bhr_set_progress(self._pointer, on_progress, ffi.NULL))


def end_orphans() -> None:
    """Ends the objects that were given up within a callback."""
    while _orphans and not inside_callback():
        end, pointer, _kept = _orphans.pop()
        end(pointer)
