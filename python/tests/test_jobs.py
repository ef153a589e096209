# SPDX-License-Identifier: MIT OR Apache-2.0
"""Frames in the background: futures, coroutines, cancelling, progress, and the exceptions of progress functions."""

import asyncio
import concurrent.futures
import gc
import threading
import time
import weakref

import bhr
import numpy as np
import pytest

SIZE = 48, 27
#: A frame that takes seconds, to be cancelled.
LONG = 1280, 720


def slow(context):
    context.quality = bhr.Quality(method=bhr.Method.ADAPTIVE, samples_per_pixel=16)


def test_a_job_is_a_future_of_its_frame(any_ctx):
    expected = any_ctx.render(*SIZE).array
    done = []
    job = any_ctx.render_async(*SIZE)
    job.add_done_callback(done.append)
    frame = job.result(timeout=60)
    assert isinstance(job, concurrent.futures.Future) and np.array_equal(frame.array, expected)
    assert job.done() and not job.running() and not job.cancelled() and job.fraction == 1.0
    assert job.stats.rays == SIZE[0] * SIZE[1] and job.stats.frame_index >= 2
    assert not job.cancel() and job.exception() is None
    any_ctx.close()
    assert done == [job]


def test_jobs_show_the_scene_of_their_beginning(ctx):
    jobs, expected = [], []
    for spin in np.linspace(-0.9, 0.9, 7):
        ctx.spin = spin
        jobs.append(ctx.render_async(*SIZE))
    for spin in np.linspace(-0.9, 0.9, 7):
        ctx.spin = spin
        expected.append(ctx.render(*SIZE).array)
    concurrent.futures.wait(jobs, timeout=60)
    for job, array in zip(jobs, expected):
        assert np.array_equal(job.result().array, array)


def test_jobs_can_be_awaited(ctx):
    async def film():
        jobs = [ctx.render_async(*SIZE) for _ in range(4)]
        first = await jobs[0]
        rest = await asyncio.gather(*jobs[1:])
        return [first, *rest]

    frames = asyncio.run(film())
    expected = ctx.render(*SIZE).array
    assert len(frames) == 4 and all(np.array_equal(frame.array, expected) for frame in frames)


def test_the_loop_runs_while_a_job_is_awaited(ctx):
    async def main():
        ticks = 0
        job = asyncio.ensure_future(_awaited(ctx.render_async(320, 180)))
        while not job.done():
            ticks += 1
            await asyncio.sleep(0.001)
        return ticks

    assert asyncio.run(main()) > 3


async def _awaited(job):
    return await job


def test_cancelled_tasks_cancel_their_jobs(ctx):
    slow(ctx)
    out = np.zeros((LONG[1], LONG[0], 4), np.uint8)

    async def main():
        job = ctx.render_async(out=out)
        task = asyncio.ensure_future(_awaited(job))
        await asyncio.sleep(0.05)
        task.cancel()
        with pytest.raises(asyncio.CancelledError):
            await task
        return job

    begin = time.monotonic()
    job = asyncio.run(main())
    with pytest.raises(concurrent.futures.CancelledError):
        job.result(timeout=90)
    assert time.monotonic() - begin < 60.0
    out[:] = 3
    time.sleep(0.05)
    assert (out == 3).all()  # the array is free


def test_cancel(ctx):
    slow(ctx)
    jobs = [ctx.render_async(*LONG) for _ in range(5)]
    begin = time.monotonic()
    for job in jobs:
        assert job.cancel() and job.cancel()
    assert concurrent.futures.wait(jobs, timeout=90).not_done == set()
    assert all(job.cancelled() for job in jobs) and time.monotonic() - begin < 60.0
    assert jobs[0].cancel()  # as Future has it: it is cancelled


def test_too_many_jobs(ctx):
    slow(ctx)
    with pytest.raises(bhr.Error) as caught:
        for _ in range(100):
            ctx.render_async(320, 180)
    assert caught.value.status == bhr.Status.INVALID_STATE
    ctx.close(cancel=True)


def test_a_job_that_fails(ctx):
    ctx.camera = bhr.Camera.orbit(1.5, 0.0, 0.0)
    with pytest.raises(bhr.Error) as caught:
        ctx.render_async(*SIZE).result(timeout=60)
    assert caught.value.status == bhr.Status.INVALID_STATE and "static" in caught.value.message.lower()
    with pytest.raises(bhr.Error):
        asyncio.run(_awaited(ctx.render_async(*SIZE)))


def test_progress(any_ctx):
    for render in any_ctx.render, lambda *a, **k: any_ctx.render_async(*a, **k).result():
        told = []
        render(*SIZE, progress=told.append)
        assert told and told[-1] == 1.0 and told == sorted(told)
        assert isinstance(told[0], float)
    told = []
    any_ctx.prepare(*SIZE, progress=told.append)
    assert told == sorted(told)


def test_progress_cancels(ctx):
    slow(ctx)
    with pytest.raises(bhr.Cancelled):
        ctx.render(*LONG, progress=lambda fraction: False)
    job = ctx.render_async(*LONG, progress=lambda fraction: False)
    with pytest.raises(concurrent.futures.CancelledError):
        job.result(timeout=90)
    ctx.quality = bhr.Quality()
    assert ctx.render(*SIZE, progress=lambda fraction: None).array.any()


class Mine(Exception):
    pass


class MineToo(BaseException):
    pass


@pytest.mark.parametrize("kind", [Mine, MineToo])
def test_exceptions_of_progress_come_out(ctx, capfd, kind):
    slow(ctx)

    def fail(fraction):
        raise kind(fraction)

    for ask in (
        lambda: ctx.render(*LONG, progress=fail),
        lambda: ctx.render_async(*LONG, progress=fail).result(timeout=90),
    ):
        with pytest.raises(kind) as caught:
            ask()
        assert 0.0 <= caught.value.args[0] < 1.0
    with pytest.raises(kind):
        asyncio.run(_awaited(ctx.render_async(*LONG, progress=fail)))
    assert capfd.readouterr().err == ""
    # The next call has nothing left of it.
    ctx.quality = bhr.Quality()
    assert ctx.render(*SIZE).array.any()


def test_calls_from_progress_are_refused(ctx):
    caught = []

    def call(fraction):
        for wrong in (lambda: ctx.mass, lambda: ctx.render(*SIZE), ctx.close, lambda: bhr.Context(bhr.Backend.CPU)):
            with pytest.raises(bhr.Error) as error:
                wrong()
            caught.append(error.value.status)

    ctx.render(*SIZE, progress=call)
    assert caught and set(caught) == {bhr.Status.INVALID_STATE}
    assert not ctx.closed and ctx.mass == 1.0


def test_done_callbacks_may_begin_jobs(ctx):
    finished = threading.Event()
    frames = []

    def then(job):
        frames.append(job.result())
        if len(frames) < 5:
            ctx.render_async(*SIZE).add_done_callback(then)
        else:
            finished.set()

    ctx.render_async(*SIZE).add_done_callback(then)
    assert finished.wait(60) and len(frames) == 5


def test_done_callbacks_that_fail_harm_nobody(ctx, caplog):
    def fail(job):
        raise MineToo

    first, second = ctx.render_async(320, 180), ctx.render_async(*SIZE)
    first.add_done_callback(fail)
    assert second.result(timeout=60).array.any() and first.result().array.any()
    ctx.close()


def test_close_from_a_done_callback_is_refused(ctx):
    statuses = []

    def close(job):
        try:
            ctx.close()
        except bhr.Error as error:
            statuses.append(error.status)

    first, second = ctx.render_async(320, 180), ctx.render_async(320, 180)
    first.add_done_callback(close)
    second.result(timeout=60)
    assert statuses == [bhr.Status.INVALID_STATE]


def test_close_waits_for_jobs_or_cancels_them():
    with bhr.Context(bhr.Backend.CPU) as ctx:
        job = ctx.render_async(*SIZE)
    assert job.done() and job.result().array.any()
    with pytest.raises(Mine), bhr.Context(bhr.Backend.CPU) as ctx:
        slow(ctx)
        job = ctx.render_async(*LONG)
        raise Mine
    assert job.cancelled()


def test_a_job_keeps_all_that_it_needs():
    ctx = bhr.Context(bhr.Backend.CPU)
    array = np.zeros((SIZE[1], SIZE[0], 4), np.uint8)
    job, gone = ctx.render_async(out=array), weakref.ref(ctx)
    address = array.__array_interface__["data"][0]
    del ctx, array
    gc.collect()
    frame = job.result(timeout=60)
    assert frame.array.__array_interface__["data"][0] == address and frame.array.any()
    deadline = time.monotonic() + 10.0
    while gone() is not None and time.monotonic() < deadline:
        time.sleep(0.01)
    assert gone() is None  # the context ended with its last job


def test_a_job_whose_future_nobody_keeps_is_rendered(ctx):
    array = np.zeros((SIZE[1], SIZE[0], 4), np.uint8)
    ctx.render_async(out=array)
    gc.collect()
    ctx.close()
    assert array.any()


def test_threads_end_with_the_jobs(ctx):
    ctx.render_async(*SIZE).result(timeout=60)
    deadline = time.monotonic() + 10.0
    while any(thread.name == "bhr jobs" for thread in threading.enumerate()) and time.monotonic() < deadline:
        time.sleep(0.01)
    assert not any(thread.name == "bhr jobs" for thread in threading.enumerate())
