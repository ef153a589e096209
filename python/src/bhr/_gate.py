# SPDX-License-Identifier: MIT OR Apache-2.0
"""The way to a context of the library: it is open until the context is closed, which waits until nobody is inside any
more, because the library's context must not end under a call."""

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

#: Contexts, with what their log needs, that Python gave up within a callback, where the library ends none.
_orphans: list[tuple[Any, Any]] = []


def log_level(logger: logging.Logger) -> int:
    """The library's level that tells a logger all that it lets through."""
    wanted = logger.getEffectiveLevel()
    return int(max((ours for ours, theirs in _LEVELS.items() if theirs >= wanted), default=lib.BHR_LOG_OFF))


@ffi.callback("void(void *, int32_t, const char *)")  # type: ignore[untyped-decorator]
def on_log(user: Any, level: int, message: Any) -> None:
    with InsideCallback():
        logger: logging.Logger = ffi.from_handle(user)
        logger.log(_LEVELS.get(level, logging.ERROR), "%s", ffi.string(message).decode("utf-8", "replace"))


class Gate:
    """Owns a context of the library. `with gate as pointer:` stands around every call on it."""

    def __init__(self, options: Any, logger: logging.Logger) -> None:
        self._pointer = ffi.NULL
        end_orphans()
        #: The threads inside.
        self._inside: list[int] = []
        self._closed = False
        self._changed = threading.Condition(threading.Lock())
        self._logger = ffi.new_handle(logger)
        options.log_fn, options.log_user = on_log, self._logger
        pointer = ffi.new("BhrContext **")
        check(lib.bhr_context_create(lib.BHR_ABI_VERSION, options, pointer))
        self._pointer = pointer[0]
        check(lib.bhr_set_progress(self._pointer, on_progress, ffi.NULL))

    def __enter__(self) -> Any:
        refuse_fork()
        with self._changed:
            if self._closed:
                raise error(Status.INVALID_STATE, "the context is closed")
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
        """Ends the context, after refuse and empty, unless another thread has."""
        with self._changed:
            pointer, self._pointer = self._pointer, ffi.NULL
        lib.bhr_context_destroy(pointer)

    def __del__(self) -> None:
        # Nobody is inside, and no job is there: they all have the gate.
        if self._pointer == ffi.NULL or forked():
            return
        if inside_callback():
            _orphans.append((self._pointer, self._logger))
        else:
            self.destroy()


def end_orphans() -> None:
    """Ends the contexts that were given up within a callback."""
    while _orphans and not inside_callback():
        pointer, _logger = _orphans.pop()
        lib.bhr_context_destroy(pointer)
