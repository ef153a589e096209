# SPDX-License-Identifier: MIT OR Apache-2.0
"""Runs bhr's side of examples-other/cuda_frames.py where there is no CUDA: against a driver that takes descriptors, as
CUDA does, and lets the CPU wait where a stream would. Arguments: the example's folder, the library."""

import ctypes
import os
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, sys.argv[1])
import cuda_frames as example


class InteropInfo(ctypes.Structure):
    _fields_ = [("struct_size", ctypes.c_uint32), ("bits", ctypes.c_uint32 * 7), ("device_uuid", ctypes.c_uint8 * 16),
                ("rest", ctypes.c_uint8 * 40)]


class Driver:
    """Stands for `Cuda`: notes what it is asked for."""

    def __init__(self):
        self.lib, self.descriptors, self.calls = self, [], []

    def cuCtxSynchronize(self):
        return 0

    def call(self, name, *arguments):
        self.calls.append(name)
        if name == "cuImportExternalMemory":
            out, description = (argument._obj for argument in arguments)
            assert description.type == 1 and description.size >= WIDTH * HEIGHT * 4, description.size
            os.fstat(description.handle.fd)
            self.descriptors.append(description.handle.fd)
            out.value = 1
        elif name == "cuExternalMemoryGetMappedBuffer":
            pointer, memory, rows = arguments
            assert memory.value == 1 and rows._obj.size == WIDTH * HEIGHT * PIXEL, rows._obj.size
            pointer._obj.value = 1 << 40


class OwnTimeline(example.Frames):
    """A timeline that is not exported: Mesa's software driver shares none."""

    def share_timeline(self):
        self.bhr.call("bhr_semaphore_create", self.bhr.context, ctypes.c_int32(0), ctypes.c_uint32(0),
                      ctypes.byref(self.timeline))

    def order(self, function, stream):
        value = ctypes.c_uint64(self.value)
        if function == "cuWaitExternalSemaphoresAsync":
            self.bhr.call("bhr_semaphore_wait", self.timeline, value, ctypes.c_uint64(60 * 10**9))
        else:
            assert function == "cuSignalExternalSemaphoresAsync"
            self.bhr.call("bhr_semaphore_signal", self.timeline, value)


WIDTH, HEIGHT = 64, 36
lib = ctypes.CDLL(sys.argv[2])
made, info = ctypes.c_void_p(), InteropInfo(struct_size=ctypes.sizeof(InteropInfo))
options = example.BhrContextOptions()
assert lib.bhr_context_options_init(ctypes.byref(options), ctypes.c_size_t(ctypes.sizeof(options))) == 0
options.backend = 2  # BHR_BACKEND_VULKAN
assert lib.bhr_context_create(0, ctypes.byref(options), ctypes.byref(made)) == 0
assert lib.bhr_interop_info(made, ctypes.byref(info)) == 0
lib.bhr_context_destroy(made)

bhr = example.Bhr(sys.argv[2], info.device_uuid)
for name, (number, PIXEL, channel) in example.FORMATS.items():
    driver = Driver()
    frames = OwnTimeline(bhr, driver, WIDTH, HEIGHT, name)
    for frame in range(3):
        frames.render(0)
        assert frames.value == 2 * frame + 1
        frames.done(0)
    array = frames.__cuda_array_interface__
    assert array["shape"] == (HEIGHT, WIDTH, 4) and array["data"] == (1 << 40, False), array
    assert array["strides"] == (WIDTH * PIXEL, PIXEL, PIXEL // 4) and array["typestr"] == channel, array
    assert int(channel[2]) == PIXEL // 4
    picture = bhr.image(WIDTH, HEIGHT, number, PIXEL)
    assert len(picture) == WIDTH * HEIGHT * PIXEL and len(set(picture)) > 1
    frames.close()
    assert driver.calls[-2:] == ["cuMemFree_v2", "cuDestroyExternalMemory"], driver.calls
    for fd in driver.descriptors:
        os.close(fd)
# A timeline that the driver does not share ends with a message, not with an exception of ctypes'.
try:
    example.Frames(bhr, Driver(), WIDTH, HEIGHT, name).close()
except example.Failure as failure:
    assert "semaphore" in str(failure), failure
bhr.close()
try:
    example.Bhr("/nowhere/libbhr.so", info.device_uuid)
    raise AssertionError("a library that is not there")
except example.Failure as failure:
    assert "bhr is missing" in str(failure), failure
