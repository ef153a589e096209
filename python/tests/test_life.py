# SPDX-License-Identifier: MIT OR Apache-2.0
"""The lives of contexts and of the process: closing, threads, forks, the interpreter's end, memory, the log."""

import gc
import logging
import math
import os
import threading
import time

import bhr
import numpy as np
import pytest
from conftest import all_tests, resident

SIZE = 16, 9


def test_use_after_close():
    ctx = bhr.Context(bhr.Backend.CPU)
    ctx.set_preset(bhr.Preset.TEACHING)
    frame = ctx.render(*SIZE)
    ctx.close()
    ctx.close()
    assert ctx.closed and frame.array.any()
    for use in (
        lambda: ctx.render(*SIZE),
        lambda: ctx.render_async(*SIZE),
        lambda: ctx.camera,
        lambda: setattr(ctx, "spin", 0.5),
        lambda: ctx.camera_rays(4, 3),
        lambda: ctx.__enter__().mass,
        ctx.recover,
    ):
        with pytest.raises(bhr.Error, match="closed") as caught:
            use()
        assert caught.value.status == bhr.Status.INVALID_STATE


def test_threads_share_a_context():
    with bhr.Context(bhr.Backend.CPU) as ctx:
        ctx.set_preset(bhr.Preset.TEACHING)
        ctx.disk = None
        expected = ctx.render(*SIZE).array
        wrong = []

        def work():
            for _ in range(25):
                if not np.array_equal(ctx.render(*SIZE).array, expected):
                    wrong.append("frame")
                with pytest.raises(bhr.InvalidArgument, match="mass"):
                    ctx.mass = math.nan
                with pytest.raises(bhr.InvalidArgument, match="spin"):
                    ctx.spin = math.nan

        threads = [threading.Thread(target=work) for _ in range(6)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert wrong == []


def test_other_threads_run_meanwhile():
    """The library does not hold Python's lock: this thread counts while another one renders."""
    with bhr.Context(bhr.Backend.CPU, cpu_threads=1) as ctx:
        thread = threading.Thread(target=lambda: ctx.render(320, 180))
        thread.start()
        ticks, longest, last = 0, 0.0, time.monotonic()
        while thread.is_alive():
            time.sleep(0.001)
            now = time.monotonic()
            ticks, longest, last = ticks + 1, max(longest, now - last), now
    assert ticks > 20 and longest < 1.0


def test_closing_while_others_call():
    for _ in range(20):
        ctx = bhr.Context(bhr.Backend.CPU)
        ctx.set_preset(bhr.Preset.TEACHING)
        begun, failures = threading.Barrier(4), []

        def work():
            begun.wait()
            try:
                while True:
                    ctx.render(*SIZE)
                    ctx.render_async(*SIZE)
            except bhr.Error as error:
                if "closed" not in error.message and "64" not in error.message:
                    failures.append(error)

        threads = [threading.Thread(target=work) for _ in range(3)]
        for thread in threads:
            thread.start()
        begun.wait()
        time.sleep(0.005)
        ctx.close(cancel=True)
        for thread in threads:
            thread.join()
        assert failures == []


def test_contexts_that_nobody_keeps_end():
    for _ in range(5):  # warm
        bhr.Context(bhr.Backend.CPU).render(*SIZE)
    gc.collect()
    before = threads_of_process()
    for _ in range(20):
        bhr.Context(bhr.Backend.CPU).render(*SIZE)
    gc.collect()
    assert threads_of_process() <= before


def threads_of_process():
    return len(os.listdir("/proc/self/task"))


def test_contexts_given_up_within_a_callback_end(ctx):
    """The library ends no context inside a callback: Python's garbage collector may come there at any time."""
    bhr.Context(bhr.Backend.CPU).render(*SIZE)
    before = threads_of_process()
    held = [bhr.Context(bhr.Backend.CPU) for _ in range(4)]
    for other in held:
        other.render(*SIZE)
    del other

    def give_up(fraction):
        held.clear()
        gc.collect()

    assert threads_of_process() > before
    ctx.render(*SIZE, progress=give_up)
    bhr.Context(bhr.Backend.CPU).close()
    deadline = time.monotonic() + 10.0
    while threads_of_process() > before and time.monotonic() < deadline:
        time.sleep(0.01)
    assert threads_of_process() <= before


def test_many_frames_take_no_more_memory(ctx, caplog):
    # pytest keeps every record, a kilobyte for each refusal.
    caplog.set_level(logging.CRITICAL, "bhr")

    def frames(count):
        out = np.zeros((9, 16, 4), np.uint8)
        for i in range(count):
            ctx.time, ctx.disk = float(i), None if i % 10 else bhr.Disk()
            if i % 2:
                ctx.render(*SIZE, progress=lambda fraction: None)
            else:
                ctx.render_async(out=out).result()
            with pytest.raises(bhr.InvalidArgument):
                ctx.spin = 2.0
            ctx.trace(ctx.camera_rays(2, 1))
        gc.collect()
        return resident()

    # Threads come and go, and glibc's heaps for them fill up in the beginning.
    before = frames(2000 if all_tests() else 150)
    after = frames(10_000 if all_tests() else 400)
    assert after - before < (6 if all_tests() else 3) * 2**20, f"{(after - before) / 2**20:.1f} MiB"


def test_loaded_frames_give_their_memory_back(tmp_path):
    bhr.Frame(np.zeros((512, 512, 4), np.uint8)).save(tmp_path / "black.png")
    for _ in range(5):
        bhr.load(tmp_path / "black.png")
    before = resident()
    for _ in range(100):
        bhr.load(tmp_path / "black.png")
    assert resident() - before < 20 * 2**20


def test_a_forked_child_is_told(ctx):
    ctx.render(*SIZE)
    job = ctx.render_async(*SIZE)
    pid = os.fork()
    if pid == 0:
        status = 1
        try:
            refused = 0
            for use in (lambda: ctx.mass, lambda: bhr.Context(bhr.Backend.CPU), bhr.adapters):
                try:
                    use()
                except bhr.Error as error:
                    refused += error.status == bhr.Status.INVALID_STATE and "spawn" in error.message
            job.cancel()
            ctx.close()
            del ctx, job
            gc.collect()
            status = 0 if refused == 3 else 2
        finally:
            os._exit(status)
    assert os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]) == 0
    assert job.result(timeout=60).array.any() and ctx.render(*SIZE).array.any()


def test_a_child_of_a_parent_that_has_not_used_bhr_may(python):
    program = """
import os, bhr
pid = os.fork()
if pid == 0:
    with bhr.Context(bhr.Backend.CPU) as ctx:
        ctx.set_preset(bhr.Preset.TEACHING)
        os._exit(0 if ctx.render(32, 18).array.any() else 1)
print(os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]))
"""
    assert python(program) == "0\n"


@pytest.mark.parametrize("backend", ["CPU", "VULKAN"])
def test_the_interpreter_ends_with_jobs_running(python, backend):
    program = f"""
import logging, threading, time, bhr
logging.basicConfig(level=logging.DEBUG, filename="/dev/null")
ctx = bhr.Context(bhr.Backend.{backend})
ctx.quality = bhr.Quality(samples_per_pixel=16)
jobs = [ctx.render_async(320, 180, progress=lambda fraction: None) for _ in range(40)]
jobs[-1].add_done_callback(lambda job: print(job.cancelled()))
other = bhr.Context(bhr.Backend.{backend})
def use():
    try:
        while True:
            other.render(64, 36, progress=lambda fraction: None)
    except bhr.Error:
        pass
threading.Thread(target=use, daemon=True).start()
time.sleep(0.3)
print("end")
"""
    assert python(program) == "end\nTrue\n"


def test_the_interpreter_ends_by_an_exception(python):
    program = """
import bhr, sys
ctx = bhr.Context(bhr.Backend.CPU)
job = ctx.render_async(1280, 720)
sys.exit(7)
"""
    assert python(program, status=7) == ""


def test_control_c_stops_a_frame(python):
    program = """
import bhr, signal, threading, time
# A shell's background jobs, and what they start, ignore it.
signal.signal(signal.SIGINT, signal.default_int_handler)
ctx = bhr.Context(bhr.Backend.CPU)
ctx.quality = bhr.Quality(method=bhr.Method.ADAPTIVE, samples_per_pixel=4)
threading.Timer(0.5, lambda: signal.raise_signal(signal.SIGINT)).start()
begin = time.monotonic()
try:
    ctx.render(1280, 720)
except KeyboardInterrupt:
    print("interrupted", time.monotonic() - begin < 60.0)
ctx.quality = bhr.Quality()
print(ctx.render(32, 18).array.any())
ctx.close()
"""
    assert python(program) == "interrupted True\nTrue\n"


def test_the_log(caplog):
    caplog.set_level(logging.INFO, logger="bhr")
    with bhr.Context(bhr.Backend.CPU) as ctx:
        with pytest.raises(bhr.Error):
            ctx.mass = -1.0
    levels = {record.levelno for record in caplog.records if record.name == "bhr"}
    assert logging.ERROR in levels and logging.INFO in levels
    assert any("mass" in record.getMessage() for record in caplog.records)


def test_another_logger_at_its_level(caplog):
    logger = logging.getLogger("of.the.host")
    for level, told in [(logging.ERROR, 1), (logging.CRITICAL, 0)]:
        caplog.clear()
        logger.setLevel(level)
        with bhr.Context(bhr.Backend.CPU, logger=logger) as ctx, pytest.raises(bhr.Error):
            ctx.mass = -1.0
        assert len([record for record in caplog.records if record.name == "of.the.host"]) == told


def test_nothing_is_printed(python):
    program = """
import bhr
with bhr.Context() as ctx:
    try:
        ctx.mass = -1.0
    except bhr.InvalidArgument:
        print("refused")
"""
    assert python(program) == "refused\n"
