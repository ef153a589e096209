# SPDX-License-Identifier: MIT OR Apache-2.0
"""Targets on the GPU. Their bytes are those of render, seen in memory of this process's own that bhr imports, and in
pictures of another context that imports bhr's; without a GPU lavapipe serves, which shares no semaphores."""

import asyncio
import os
import threading
import time

import bhr
import numpy as np
import pytest
from bhr import interop
from bhr._ffi import ffi

SIZE = 48, 27
FD, POINTER = interop.HandleType.OPAQUE_FD, interop.HandleType.HOST_POINTER
BUFFER, IMAGE = interop.TargetKind.BUFFER, interop.TargetKind.IMAGE

FORMATS = {
    bhr.Format.RGBA8_SRGB: (np.uint8, 4),
    bhr.Format.BGRA8_SRGB: (np.uint8, 4),
    bhr.Format.RGBA16F: (np.float16, 4),
    bhr.Format.RGBA32F: (np.float32, 4),
}


@pytest.fixture
def gpu():
    with bhr.Context(bhr.Backend.VULKAN) as context:
        context.set_preset(bhr.Preset.TEACHING)
        yield context


def descriptors():
    return len(os.listdir("/proc/self/fd"))


class Pixels:
    """A target in this process's own memory, and the array that shows it."""

    def __init__(self, context, format, gap=0):
        dtype, channels = FORMATS.get(format, (np.float32, 1))
        width, height = SIZE
        row = width * channels * np.dtype(dtype).itemsize
        bytes = -(-(row + gap) * height // 65536) * 65536
        self.room = np.full(bytes + 65536, 0x5A, np.uint8)
        begin = -self.room.__array_interface__["data"][0] % 65536
        rows = self.room[begin : begin + (row + gap) * height].reshape(height, row + gap)
        self.between = rows[:, row:]
        self.array = rows[:, :row].view(dtype)
        self.array = self.array.reshape(height, width, channels) if channels > 1 else self.array
        address = rows.__array_interface__["data"][0]
        self.target = interop.Target.from_handle(
            context, *SIZE, interop.TargetInfo(allocation_size=bytes), address, POINTER, kind=BUFFER, format=format,
            row_stride=row + gap,
        )


def test_info(gpu):
    can = interop.info(gpu)
    assert can.export_buffers & can.import_buffers & can.export_images & can.import_images & FD
    assert len(can.device_uuid) == len(can.driver_uuid) == 16 and any(can.device_uuid)
    assert can.luid is None and len(can.semaphores) == 2 and can.drm_major >= -1
    found = bhr.adapters()[interop.find_adapter(can.device_uuid)]
    assert found.backend == bhr.Backend.VULKAN and found.name == gpu.adapter.name


def test_the_cpu_shares_nothing(ctx):
    can = interop.info(ctx)
    assert can.export_buffers == can.import_images == 0 and can.semaphores == (0, 0) and not any(can.device_uuid)
    with pytest.raises(bhr.Error) as caught:
        interop.Target(ctx, *SIZE)
    assert caught.value.status == bhr.Status.UNSUPPORTED and "CPU" in caught.value.message


def test_no_such_adapter():
    with pytest.raises(bhr.Error) as caught:
        interop.find_adapter(b"no such device..")
    assert caught.value.status == bhr.Status.NO_ADAPTER
    with pytest.raises(bhr.InvalidArgument):
        interop.find_adapter()
    with pytest.raises(ValueError, match="3 bytes instead of 16"):
        interop.find_adapter(b"abc")


@pytest.mark.parametrize("format", FORMATS)
@pytest.mark.parametrize("background", [False, True])
def test_bytes_are_those_of_render(gpu, format, background):
    pixels = Pixels(gpu, format, gap=20)
    for spin in 0.0, 0.9:
        gpu.spin = spin
        expected = gpu.render(*SIZE, format=format).array
        job = interop.render(gpu, pixels.target, background=background)
        assert job.result(timeout=60) is pixels.target
        assert job.done() and job.fraction == 1.0 and job.stats.rays >= SIZE[0] * SIZE[1]
        assert np.array_equal(pixels.array, expected) and (pixels.between == 0x5A).all()


def test_a_timeline_orders_frames(gpu):
    pixels, line = Pixels(gpu, bhr.Format.RGBA16F), interop.Semaphore(gpu)
    expected = gpu.render(*SIZE, format=bhr.Format.RGBA16F).array
    job = interop.render(gpu, pixels.target, waits=[(line, 1)], signals=[(line, 2)])
    assert not line.wait(2, timeout=0.05) and not job.done()
    assert (pixels.room == 0x5A).all()
    line.signal(1)
    assert line.wait(2)
    assert np.array_equal(pixels.array, expected)
    job.result(timeout=60)
    for turn in range(3, 40, 2):
        interop.render(gpu, pixels.target, waits=[(line, turn - 1)], signals=[(line, turn)], background=turn % 4 == 1)
        line.wait(turn)
        line.signal(turn + 1)
    assert np.array_equal(pixels.array, expected)


def test_binary_semaphores(gpu):
    pixels, turn = Pixels(gpu, bhr.Format.RGBA8_SRGB), interop.Semaphore(gpu, interop.SemaphoreKind.BINARY)
    for _ in range(3):
        interop.render(gpu, pixels.target, signals=[(turn, 0)])
        interop.render(gpu, pixels.target, waits=[(turn, 0)]).result(timeout=60)
    assert np.array_equal(pixels.array, gpu.render(*SIZE).array)
    with pytest.raises(bhr.Error, match="BINARY") as caught:
        turn.wait(1)
    assert caught.value.status == bhr.Status.UNSUPPORTED
    with pytest.raises(bhr.InvalidArgument, match="BINARY"):
        interop.render(gpu, pixels.target, signals=[(turn, 0)], background=True)


def test_jobs_can_be_awaited(gpu):
    async def main():
        return await interop.render(gpu, target)

    target = interop.Target(gpu, *SIZE)
    assert asyncio.run(main()) is target


def outputs_of(context, kinds):
    return [frame.array for frame in context.render_outputs(*SIZE, kinds)]


@pytest.mark.parametrize("background", [False, True])
def test_outputs(gpu, background):
    kinds = [bhr.OutputKind.LIGHT, bhr.OutputKind.DEPTH, (bhr.OutputKind.DISK, 1), bhr.OutputKind.SKY]
    light, depth, disk = (Pixels(gpu, format) for format in (bhr.Format.RGBA32F, bhr.Format.R32F, bhr.Format.RGBA32F))
    sky, line = np.zeros((SIZE[1], SIZE[0], 4), np.float32), interop.Semaphore(gpu)
    places = [light.target, depth.target, disk.target, sky]
    job = interop.render_outputs(gpu, list(zip(kinds, places)), signals=[(line, 1)], background=background)
    line.wait(1)
    made = job.result(timeout=60)
    assert made[:3] == places[:3] and made[3].array is sky
    for seen, expected in zip((light.array, depth.array, disk.array, sky), outputs_of(gpu, kinds)):
        assert np.array_equal(seen, expected, equal_nan=True)


def passed_on(target, other, **options):
    """A target of another context's in the memory of this one."""
    memory = target.info
    format = options.pop("format")
    return interop.Target.from_handle(
        other, memory.width, memory.height, memory, target.export(), kind=memory.kind, format=format, **options
    )


@pytest.mark.parametrize("kind", interop.TargetKind)
def test_the_sky_and_the_things_from_another_context(gpu, kind):
    with bhr.Context(bhr.Backend.VULKAN) as other:
        # An all-round picture of one scene is the sky of another.
        width, height, format = 64, 32, bhr.Format.RGBA16F
        gpu.camera = bhr.Camera(projection=bhr.Projection.EQUIRECT)
        gpu.film = bhr.Film(bloom=0.0)
        surroundings = gpu.render(width, height, format=format)
        other.set_preset(bhr.Preset.TEACHING)
        other.sky = bhr.Sky(flags=bhr.SkyFlags.MAP)
        other.set_sky_map(surroundings)
        expected = other.render(*SIZE).array
        without = (other.set_sky_map(None), other.render(*SIZE).array)[1]
        target = interop.Target(gpu, width, height, kind=kind, format=format, handle_type=FD)
        interop.render(gpu, target).result(timeout=60)
        interop.set_sky(other, passed_on(target, other, format=format))
        # Nobody but the context has it any more.
        seen = other.render(*SIZE).array
        assert np.abs(seen.astype(int) - expected).max() <= 1 < np.abs(without.astype(int) - expected).max()
        interop.set_sky(other, None)
        assert np.array_equal(other.render(*SIZE).array, without)

        # How far the disk is for one camera, are the things of another.
        gpu.camera = bhr.Camera(position=(0.0, 25.0, 4.0))
        (distances,) = outputs_of(gpu, [bhr.OutputKind.DEPTH])
        target = interop.Target(gpu, *SIZE, kind=kind, format=bhr.Format.R32F, handle_type=FD)
        interop.render_outputs(gpu, [(bhr.OutputKind.DEPTH, target)]).result(timeout=60)
        for lensed in False, True:
            other.set_occluder(distances, lensed=lensed)
            expected = other.render(*SIZE, transparent=True).array
            interop.set_occluder(other, passed_on(target, other, format=bhr.Format.R32F), lensed=lensed)
            assert np.array_equal(other.render(*SIZE, transparent=True).array, expected)
        interop.set_occluder(other, None)
        assert not np.array_equal(other.render(*SIZE, transparent=True).array, expected)


def test_cubes(gpu):
    side = 16
    target = interop.Target(gpu, 6 * side, side, format=bhr.Format.RGBA16F)
    interop.set_sky(gpu, target, bhr.Projection.CUBE)
    with pytest.raises(bhr.InvalidArgument, match="layout"):
        interop.set_sky(gpu, target, bhr.Projection.FISHEYE)
    gpu.sky = bhr.Sky(flags=bhr.SkyFlags.MAP)
    gpu.render(*SIZE)


def test_what_frames_read_stays_while_it_is_set(gpu):
    target = interop.Target(gpu, *SIZE, format=bhr.Format.R32F)
    interop.set_occluder(gpu, target)
    with pytest.raises(bhr.InvalidArgument, match="occluder"):
        interop.render(gpu, target)
    target.close()
    with pytest.raises(bhr.Error) as caught:
        gpu.render(*SIZE)
    assert caught.value.status == bhr.Status.SURFACE_LOST
    gpu.set_occluder(None)
    gpu.render(*SIZE)


def test_numbers_of_a_target(gpu):
    with interop.Target(gpu, 40, 20, kind=BUFFER, format=bhr.Format.RGBA16F, handle_type=FD, row_stride=512) as rows:
        assert (rows.info.kind, rows.info.width, rows.info.height, rows.info.row_stride) == (BUFFER, 40, 20, 512)
        assert rows.info.allocation_size >= 512 * 19 + 320 and rows.info.vk_format == 0
    with interop.Target(gpu, 40, 20, handle_type=FD, layout=6) as image:
        assert (image.info.kind, image.info.vk_format, image.info.layout) == (IMAGE, 37, 6)
        assert interop.TargetInfo.from_c(image.info.to_c()) == image.info


def test_bad_arguments(gpu):
    target, line = interop.Target(gpu, *SIZE), interop.Semaphore(gpu)
    memory = interop.TargetInfo(allocation_size=65536)
    light, depth = bhr.OutputKind.LIGHT, bhr.OutputKind.DEPTH
    picture = np.zeros((SIZE[1], SIZE[0], 4), np.uint8)
    with bhr.Context(bhr.Backend.VULKAN) as other:
        foreign = interop.Target(other, *SIZE)
        wrong = {
            "width is 0": lambda: interop.Target(gpu, 0, 4),
            "row_stride is 3": lambda: interop.Target(gpu, 4, 4, kind=BUFFER, row_stride=3),
            "another context": lambda: interop.render(gpu, foreign),
            "by another": lambda: interop.set_sky(gpu, foreign),
            "twice": lambda: interop.render(gpu, target, waits=[(line, 1), (line, 2)]),
            "wait_count is 9": lambda: interop.render(gpu, target, waits=[(line, 1)] * 9),
            "not open": lambda: interop.Target.from_handle(gpu, *SIZE, memory, 9999, kind=BUFFER),
            "multiples of": lambda: interop.Target.from_handle(gpu, *SIZE, memory, 16, POINTER, kind=BUFFER),
            "takes R32F": lambda: interop.render_outputs(gpu, [(depth, target)]),
            "count is 0": lambda: interop.render_outputs(gpu, []),
            "second LIGHT": lambda: interop.render_outputs(gpu, [(light, target), (light, picture)]),
            "R32F": lambda: interop.set_occluder(gpu, target),
            "value": lambda: line.signal(0),
        }
        for words, call in wrong.items():
            with pytest.raises(bhr.InvalidArgument, match=words):
                call()
    with pytest.raises(bhr.Error) as caught:
        target.export()
    assert caught.value.status == bhr.Status.INVALID_STATE
    for call in (
        lambda: interop.Target(gpu, *SIZE, kind=7),
        lambda: interop.Target(gpu, *SIZE, format=99),
        lambda: interop.set_sky(gpu, target, 9),
        lambda: interop.render_outputs(gpu, [(depth, picture[::, ::2])]),
    ):
        with pytest.raises(ValueError):
            call()
    # The refused calls have left nothing behind: the target can be rendered into.
    assert interop.render(gpu, target).result(timeout=60) is target


def test_semaphores_are_exported_where_the_driver_can(gpu):
    for kind in interop.SemaphoreKind:
        if interop.info(gpu).semaphores[kind] & FD:
            exported = interop.Semaphore(gpu, kind, handle_type=FD)
            imported = interop.Semaphore.from_handle(gpu, exported.export(), kind=kind)
            target = interop.Target(gpu, *SIZE)
            interop.render(gpu, target, signals=[(exported, 1)])
            interop.render(gpu, target, waits=[(imported, 1)]).result(timeout=60)
        else:
            for refused in (
                lambda: interop.Semaphore(gpu, kind, handle_type=FD),
                lambda: interop.Semaphore.from_handle(gpu, 9999, kind=kind),
            ):
                with pytest.raises(bhr.Error, match="semaphore") as caught:
                    refused()
                assert caught.value.status == bhr.Status.UNSUPPORTED


def test_nothing_leaks(gpu):
    def once():
        for kind in interop.TargetKind:
            target = interop.Target(gpu, *SIZE, kind=kind, format=bhr.Format.RGBA16F, handle_type=FD)
            os.close(target.export())
            same = passed_on(target, gpu, format=bhr.Format.RGBA16F)
            interop.render(gpu, same)  # under way while all goes
            target.close()
            target.close()
            with pytest.raises(bhr.InvalidArgument):
                interop.Target(gpu, 2**21, 4, handle_type=FD)
            # Too few bytes: the descriptor is ours after the error.
            handle = interop.Target(gpu, 8, 8, kind=BUFFER, handle_type=FD).export()
            with pytest.raises(bhr.InvalidArgument):
                interop.Target.from_handle(gpu, *SIZE, interop.TargetInfo(allocation_size=64), handle, kind=BUFFER)
            os.close(handle)
        gpu.render(8, 8)

    once()
    before, bytes = descriptors(), gpu.stats.device_bytes
    for _ in range(20):
        once()
    interop.render(gpu, interop.Target(gpu, 8, 8)).result(timeout=60)
    gpu.render(8, 8)
    assert descriptors() == before
    assert gpu.stats.device_bytes <= bytes + 65536


def test_closing(gpu):
    target, line = interop.Target(gpu, *SIZE, handle_type=FD), interop.Semaphore(gpu)
    for thing, call in (target, lambda: target.info), (target, target.export), (line, lambda: line.signal(1)):
        thing.close()
        assert thing.closed
        with pytest.raises(bhr.Error, match="is closed") as caught:
            call()
        assert caught.value.status == bhr.Status.INVALID_STATE
    with pytest.raises(bhr.Error, match="the target is closed"):
        interop.render(gpu, target)
    # One that another thread waits for.
    line, said = interop.Semaphore(gpu), []

    def wait():
        try:
            line.wait(1)
        except bhr.Error as error:
            said.append(error.message)

    thread = threading.Thread(target=wait)
    thread.start()
    time.sleep(0.05)
    line.close()
    thread.join(10.0)
    assert said == ["the semaphore is closed"]
    # After its context.
    target = interop.Target(gpu, *SIZE)
    gpu.close()
    target.close()
    with pytest.raises(bhr.Error, match="the context is closed"):
        interop.Target(gpu, *SIZE)


def test_the_interpreters_end(python):
    said = python(
        "import bhr; from bhr import interop\n"
        "ctx = bhr.Context(bhr.Backend.VULKAN)\n"
        "target, line = interop.Target(ctx, 64, 36), interop.Semaphore(ctx)\n"
        "interop.render(ctx, target, signals=[(line, 1)])\n"
        "print(line.wait(1))"
    )
    assert said == "True\n"
    assert ffi.sizeof("BhrTargetOptions") == 40
