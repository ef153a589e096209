# SPDX-License-Identifier: MIT OR Apache-2.0
"""Frames in the background: a Job is a future of its frame. A thread for each context waits for its jobs while there
are any, in the library and without Python's lock."""

from __future__ import annotations

import asyncio
import logging
import threading
from collections import deque
from collections.abc import Generator
from concurrent.futures import Future
from typing import TYPE_CHECKING, Any, TypeVar

from ._constants import Status
from ._ffi import ffi
from ._frame import Frame
from ._library import Call, Progress, failure, forked, lib
from ._struct import new
from ._structs import FrameStats

if TYPE_CHECKING:
    from ._context import Context

_FOREVER = 2**64 - 1


_Made = TypeVar("_Made")


class AnyJob(Future[_Made]):
    """Work in the background: a concurrent.futures.Future of what is made, which a coroutine can await as well.

    Callbacks of add_done_callback run on the thread that waits for the context's jobs, and hold the next ones up.
    """

    #: The part that is done, 0 .. 1. It is brought up to date when this job is the oldest of its context.
    fraction: float
    #: Numbers about the frame, once it is there.
    stats: FrameStats | None

    def __init__(self, context: Context, pointer: Any, made: _Made, progress: Progress | None) -> None:
        super().__init__()
        self.fraction = 0.0
        self.stats = None
        self._pointer = pointer
        self._pointer_lock = threading.Lock()
        self._made = made
        self._progress = progress
        # A context whose jobs are not done must not end.
        self._context: Context | None = context

    def cancel(self) -> bool:
        """Asks the job to stop, and does not wait; False if it is done already. The job is done, and its array free,
        when `result` returns or raises; a job that was nearly done may still have its frame."""
        with self._pointer_lock:
            if self._pointer is None or forked():
                return self.cancelled()
            lib.bhr_job_cancel(self._pointer)
            return True

    def running(self) -> bool:
        return not self.done()

    def __await__(self) -> Generator[Any, None, _Made]:
        return asyncio.wrap_future(self).__await__()

    def _tell(self, fraction: float) -> bool | None:
        self.fraction = fraction
        return None if self._progress is None else self._progress(fraction)

    def _wait(self) -> None:
        """Waits for the job's end and tells those who wait for the future."""
        raised: BaseException | None = None
        with Call(self._tell) as call:
            status = lib.bhr_job_wait(self._pointer, _FOREVER, ffi.NULL)
            if status != Status.OK:
                raised = failure(status)
        if status == Status.OK:
            stats = new("BhrFrameStats")
            if lib.bhr_job_stats(self._pointer, stats) == Status.OK:
                self.stats = FrameStats.from_c(stats)
                self.fraction = 1.0
        self._end()
        if call.exception is not None:
            raised, call.exception = call.exception, None
            self.set_exception(raised)
        elif status == Status.OK:
            self.set_result(self._made)
        elif status == Status.CANCELLED:
            super().cancel()
            self.set_running_or_notify_cancel()
        else:
            self.set_exception(raised)

    def _end(self) -> None:
        """Frees what the library has of the job; the array is free from here on."""
        with self._pointer_lock:
            pointer, self._pointer = self._pointer, None
        lib.bhr_job_destroy(pointer)
        self._context = None


class Job(AnyJob[Frame]):
    """A frame that is rendered in the background: a concurrent.futures.Future, which a coroutine can await as well.

    Until it is done, nobody else may use the array that it renders into. Callbacks of add_done_callback run on the
    thread that waits for the context's jobs, and hold the next ones up.
    """


class Waiter:
    """Waits for the jobs of a context, one after the other."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._jobs: deque[AnyJob[Any]] = deque()
        self._thread: threading.Thread | None = None

    def add(self, job: AnyJob[Any]) -> None:
        with self._lock:
            self._jobs.append(job)
            if self._thread is None:
                # A daemon, because the interpreter's end cancels jobs instead of waiting for them (_context.py).
                self._thread = threading.Thread(target=self._run, name="bhr jobs", daemon=True)
                try:
                    self._thread.start()
                except RuntimeError:
                    self._thread = None
                    self._jobs.pop()
                    job._end()
                    raise

    def _run(self) -> None:
        while True:
            with self._lock:
                if not self._jobs:
                    self._thread = None
                    return
                job = self._jobs[0]
            try:
                job._wait()
            except BaseException:
                # Future leaves to its caller what is no Exception in a function of add_done_callback.
                logging.getLogger("bhr").exception("a function that was to be told of a job's end failed")
            with self._lock:
                self._jobs.popleft()
            del job

    def is_this_thread(self) -> bool:
        return threading.current_thread() is self._thread

    def cancel(self) -> None:
        with self._lock:
            jobs = list(self._jobs)
        for job in jobs:
            job.cancel()

    def end(self, cancel: bool) -> None:
        """Waits until all jobs are done. No new one may come."""
        if cancel:
            self.cancel()
        with self._lock:
            thread = self._thread
        if thread is not None:
            thread.join()
