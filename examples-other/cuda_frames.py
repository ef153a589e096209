#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""cuda_frames.py -- frames of a black hole as tensors of PyTorch (or of anything that reads __cuda_array_interface__),
without a copy: bhr writes rows in the GPU's memory, CUDA reads the same bytes, and a timeline orders the two. Linux, an
NVIDIA GPU, bhr on that GPU through Vulkan. Needs the driver's libcuda.so.1 and nothing else; torch where tensors are
wanted.

    python3 cuda_frames.py [--library libbhr.so] [--device 0] [--size 1920x1080] [--frames 8]
    python3 cuda_frames.py --check          compares CUDA's bytes with those of bhr_render_image; needs no torch
    python3 cuda_frames.py --check torch    the same with the bytes of a tensor
    python3 cuda_frames.py --sizes          prints how the structs below lie in memory; needs neither CUDA nor bhr
"""

import argparse
import ctypes
import os
import sys
import time
from ctypes import POINTER, byref, c_char_p, c_int, c_int32, c_int64, c_size_t, c_uint, c_uint8, c_uint32, c_uint64
from ctypes import c_void_p

# ---- bhr.h and bhr_interop.h ----


class BhrContextOptions(ctypes.Structure):
    _fields_ = [("struct_size", c_uint32), ("flags", c_uint32), ("backend", c_int32), ("adapter_index", c_int32),
                ("cpu_threads", c_uint32), ("log_level", c_int32), ("log_fn", c_void_p), ("log_user", c_void_p),
                ("compatible_window", c_void_p)]


class BhrImage(ctypes.Structure):
    _fields_ = [("struct_size", c_uint32), ("format", c_int32), ("width", c_uint32), ("height", c_uint32),
                ("pixels", c_void_p), ("row_stride", c_int64), ("byte_size", c_uint64), ("flags", c_uint32),
                ("reserved", c_uint32), ("colour_space", c_int32), ("reserved2", c_uint32)]


class BhrTargetOptions(ctypes.Structure):
    _fields_ = [("struct_size", c_uint32), ("kind", c_int32), ("format", c_int32), ("width", c_uint32),
                ("height", c_uint32), ("flags", c_uint32), ("handle_type", c_uint32), ("layout", c_int32),
                ("row_stride", c_uint64)]


class BhrTargetInfo(ctypes.Structure):
    _fields_ = [("struct_size", c_uint32), ("kind", c_int32), ("width", c_uint32), ("height", c_uint32),
                ("vk_format", c_uint32), ("vk_usage", c_uint32), ("vk_flags", c_uint32), ("vk_tiling", c_uint32),
                ("layout", c_int32), ("dedicated", c_uint32), ("memory_type", c_uint32), ("reserved", c_uint32),
                ("allocation_size", c_uint64), ("offset", c_uint64), ("row_stride", c_uint64)]


class BhrHandle(ctypes.Structure):
    _fields_ = [("type", c_uint32), ("fd", c_int32), ("handle", c_void_p)]


class BhrSemaphoreValue(ctypes.Structure):
    _fields_ = [("semaphore", c_void_p), ("value", c_uint64)]


class BhrSync(ctypes.Structure):
    _fields_ = [("struct_size", c_uint32), ("wait_count", c_uint32), ("signal_count", c_uint32),
                ("reserved", c_uint32), ("waits", POINTER(BhrSemaphoreValue)),
                ("signals", POINTER(BhrSemaphoreValue))]


BHR_ABI_VERSION = 0
BHR_HANDLE_OPAQUE_FD = 1
BHR_TARGET_BUFFER = 1
BHR_SEMAPHORE_TIMELINE = 0
# BHR_FORMAT_*: the number, bytes of a pixel, and the type of a channel as __array_interface__ has it.
FORMATS = {"RGBA8": (1, 4, "|u1"), "BGRA8": (2, 4, "|u1"), "RGBA16F": (3, 8, "<f2"), "RGBA32F": (4, 16, "<f4")}

# ---- cuda.h ----


class Win32(ctypes.Structure):
    _fields_ = [("handle", c_void_p), ("name", c_void_p)]


class Handle(ctypes.Union):
    _fields_ = [("fd", c_int), ("win32", Win32)]


class CUDA_EXTERNAL_MEMORY_HANDLE_DESC(ctypes.Structure):
    _fields_ = [("type", c_int), ("handle", Handle), ("size", c_uint64), ("flags", c_uint), ("reserved", c_uint * 16)]


class CUDA_EXTERNAL_MEMORY_BUFFER_DESC(ctypes.Structure):
    _fields_ = [("offset", c_uint64), ("size", c_uint64), ("flags", c_uint), ("reserved", c_uint * 16)]


class CUDA_EXTERNAL_SEMAPHORE_HANDLE_DESC(ctypes.Structure):
    _fields_ = [("type", c_int), ("handle", Handle), ("flags", c_uint), ("reserved", c_uint * 16)]


class CUDA_EXTERNAL_SEMAPHORE_PARAMS(ctypes.Structure):
    """CUDA_EXTERNAL_SEMAPHORE_WAIT_PARAMS and _SIGNAL_PARAMS: a timeline's value, and 64 bytes for other kinds."""

    _fields_ = [("value", c_uint64), ("others", c_uint64 * 8), ("flags", c_uint), ("reserved", c_uint * 16)]


CU_EXTERNAL_MEMORY_HANDLE_TYPE_OPAQUE_FD = 1
CUDA_EXTERNAL_MEMORY_DEDICATED = 1
CU_EXTERNAL_SEMAPHORE_HANDLE_TYPE_TIMELINE_SEMAPHORE_FD = 9

STRUCTS = [BhrContextOptions, BhrImage, BhrTargetOptions, BhrTargetInfo, BhrHandle, BhrSemaphoreValue, BhrSync,
           CUDA_EXTERNAL_MEMORY_HANDLE_DESC, CUDA_EXTERNAL_MEMORY_BUFFER_DESC, CUDA_EXTERNAL_SEMAPHORE_HANDLE_DESC,
           CUDA_EXTERNAL_SEMAPHORE_PARAMS]


class Failure(Exception):
    """Something is missing, or a call failed; the text says what."""


def loaded(name, why):
    try:
        return ctypes.CDLL(name)
    except OSError as error:
        raise Failure("%s: %s" % (why, error)) from None


class Cuda:
    """The driver's API, on the primary context of a device, which torch uses as well."""

    def __init__(self, device):
        self.lib = loaded("libcuda.so.1", "CUDA is missing (the NVIDIA driver brings it)")
        self.call("cuInit", c_uint(0))
        self.device, number, self.context = device, c_int(), c_void_p()
        self.call("cuDeviceGet", byref(number), c_int(device))
        self.uuid = (c_uint8 * 16)()
        self.call("cuDeviceGetUuid", byref(self.uuid), number)
        self.call("cuDevicePrimaryCtxRetain", byref(self.context), number)
        self.call("cuCtxSetCurrent", self.context)

    def call(self, name, *arguments):
        status = getattr(self.lib, name)(*arguments)
        if status != 0:
            text = c_char_p()
            self.lib.cuGetErrorString(c_int(status), byref(text))
            raise Failure("%s: %s (%d)" % (name, (text.value or b"an unknown error").decode(), status))


class Bhr:
    """The library, and a context on the GPU that has a UUID."""

    def __init__(self, path, uuid):
        self.lib = loaded(path, "bhr is missing (--library, or BHR_LIBRARY, names it)")
        self.lib.bhr_error_message.restype = c_char_p
        for name in ("bhr_target_destroy", "bhr_semaphore_destroy", "bhr_context_destroy"):
            getattr(self.lib, name).restype = None
        index, options, self.context = c_int32(), BhrContextOptions(), c_void_p()
        self.call("bhr_adapter_find", uuid, None, byref(index))
        self.call("bhr_context_options_init", byref(options), c_size_t(ctypes.sizeof(options)))
        options.adapter_index = index
        self.call("bhr_context_create", c_uint32(BHR_ABI_VERSION), byref(options), byref(self.context))

    def call(self, name, *arguments):
        if getattr(self.lib, name)(*arguments) < 0:
            raise Failure(self.lib.bhr_error_message().decode())

    def image(self, width, height, number, pixel_bytes):
        """The bytes that bhr_render_image gives."""
        image, pixels = BhrImage(), ctypes.create_string_buffer(width * height * pixel_bytes)
        self.call("bhr_image_init", byref(image), c_size_t(ctypes.sizeof(image)))
        image.format, image.width, image.height = number, width, height
        image.pixels, image.byte_size = ctypes.addressof(pixels), len(pixels)
        self.call("bhr_render_image", self.context, byref(image))
        return pixels.raw

    def close(self):
        self.lib.bhr_context_destroy(self.context)


class Frames:
    """Rows in the GPU's memory that bhr writes and CUDA reads; torch.as_tensor(frames, device="cuda") looks at them.

    A timeline has odd values when bhr has rendered, and even ones when CUDA has read. Only the GPU waits."""

    def __init__(self, bhr, cuda, width, height, format="RGBA16F"):
        number, self.pixel_bytes, self.channel = FORMATS[format]
        self.bhr, self.cuda, self.size, self.value = bhr, cuda, (width, height), 0
        self.target, self.timeline = c_void_p(), c_void_p()
        self.memory, self.pointer, self.semaphore = c_void_p(), c_uint64(), c_void_p()
        try:
            self.share_memory(number)
            self.share_timeline()
        except Failure:
            self.close()
            raise

    def exported(self, function, thing):
        handle = BhrHandle()
        self.bhr.call(function, thing, byref(handle))
        return handle.fd

    def imported(self, function, out, description, fd):
        description.handle.fd = fd
        try:
            self.cuda.call(function, byref(out), byref(description))
        except Failure:
            # CUDA takes the descriptor over only when it succeeds.
            os.close(fd)
            raise

    def share_memory(self, number):
        options, self.info = BhrTargetOptions(), BhrTargetInfo(struct_size=ctypes.sizeof(BhrTargetInfo))
        self.bhr.call("bhr_target_options_init", byref(options), c_size_t(ctypes.sizeof(options)))
        options.kind, options.format, options.handle_type = BHR_TARGET_BUFFER, number, BHR_HANDLE_OPAQUE_FD
        options.width, options.height = self.size
        self.bhr.call("bhr_target_create", self.bhr.context, byref(options), byref(self.target))
        self.bhr.call("bhr_target_info", self.target, byref(self.info))
        memory = CUDA_EXTERNAL_MEMORY_HANDLE_DESC(type=CU_EXTERNAL_MEMORY_HANDLE_TYPE_OPAQUE_FD)
        memory.size = self.info.allocation_size
        memory.flags = CUDA_EXTERNAL_MEMORY_DEDICATED if self.info.dedicated else 0
        fd = self.exported("bhr_target_export", self.target)
        self.imported("cuImportExternalMemory", self.memory, memory, fd)
        rows = CUDA_EXTERNAL_MEMORY_BUFFER_DESC(offset=self.info.offset, size=self.info.row_stride * self.size[1])
        self.cuda.call("cuExternalMemoryGetMappedBuffer", byref(self.pointer), self.memory, byref(rows))

    def share_timeline(self):
        kind = c_int32(BHR_SEMAPHORE_TIMELINE)
        self.bhr.call("bhr_semaphore_create", self.bhr.context, kind, c_uint32(BHR_HANDLE_OPAQUE_FD),
                      byref(self.timeline))
        fd = self.exported("bhr_semaphore_export", self.timeline)
        timeline = CUDA_EXTERNAL_SEMAPHORE_HANDLE_DESC(type=CU_EXTERNAL_SEMAPHORE_HANDLE_TYPE_TIMELINE_SEMAPHORE_FD)
        self.imported("cuImportExternalSemaphore", self.semaphore, timeline, fd)

    def render(self, stream):
        """Submits a frame; what `stream` does from now on sees it."""
        read = BhrSemaphoreValue(self.timeline, self.value)
        made = BhrSemaphoreValue(self.timeline, self.value + 1)
        sync = BhrSync(struct_size=ctypes.sizeof(BhrSync), wait_count=1 if self.value else 0, signal_count=1)
        sync.waits, sync.signals = ctypes.pointer(read), ctypes.pointer(made)
        self.bhr.call("bhr_render_target", self.bhr.context, self.target, byref(sync), None)
        self.value += 1
        self.order("cuWaitExternalSemaphoresAsync", stream)

    def done(self, stream):
        """`stream` has read the frame with all that it has been given so far: the next one may overwrite it."""
        self.value += 1
        self.order("cuSignalExternalSemaphoresAsync", stream)

    def order(self, function, stream):
        params = CUDA_EXTERNAL_SEMAPHORE_PARAMS(value=self.value)
        self.cuda.call(function, byref(self.semaphore), byref(params), c_uint(1), c_void_p(stream))

    @property
    def __cuda_array_interface__(self):
        width, height = self.size
        channel_bytes = self.pixel_bytes // 4
        return {"shape": (height, width, 4), "strides": (self.info.row_stride, self.pixel_bytes, channel_bytes),
                "typestr": self.channel, "data": (self.pointer.value, False), "version": 3}

    def bytes(self, stream):
        """A copy of the rows in the host's memory."""
        pixels = ctypes.create_string_buffer(self.info.row_stride * self.size[1])
        self.cuda.call("cuMemcpyDtoHAsync_v2", pixels, self.pointer, c_size_t(len(pixels)), c_void_p(stream))
        self.cuda.call("cuStreamSynchronize", c_void_p(stream))
        return pixels.raw

    def close(self):
        """No tensor may look at the memory any more."""
        if self.cuda.lib.cuCtxSynchronize() == 0:
            for function, handle in (("cuMemFree_v2", self.pointer), ("cuDestroyExternalMemory", self.memory),
                                     ("cuDestroyExternalSemaphore", self.semaphore)):
                if handle.value:
                    self.cuda.call(function, handle)
        self.bhr.lib.bhr_target_destroy(self.target)
        self.bhr.lib.bhr_semaphore_destroy(self.timeline)


def new_stream(cuda):
    stream = c_void_p()
    # CU_STREAM_NON_BLOCKING
    cuda.call("cuStreamCreate", byref(stream), c_uint(1))
    return stream.value


def torch_with_cuda():
    try:
        import torch
    except ImportError as error:
        raise Failure("torch is missing (%s); --check alone needs none" % error) from None
    if not torch.cuda.is_available():
        raise Failure("torch %s sees no GPU; --check alone needs no torch" % torch.__version__)
    return torch


def different_in_cuda(frames, stream, expected):
    """How many bytes of the frame are others in CUDA's memory."""
    seen = frames.bytes(stream)
    return sum(a != b for a, b in zip(seen, expected)) if seen != expected else 0


def different_in_tensor(torch, frames, expected):
    """How many bytes of the frame are others in a tensor over its memory."""
    tensor = torch.as_tensor(frames, device="cuda")
    if tensor.data_ptr() != frames.pointer.value:
        raise Failure("torch.as_tensor has made a copy")
    wanted = torch.frombuffer(bytearray(expected), dtype=torch.uint8)
    return int((tensor.cpu().contiguous().view(torch.uint8).flatten() != wanted).sum())


def check(bhr, cuda, torch, width, height, count):
    """Whether CUDA, or torch unless it is None, sees the bytes of bhr_render_image, in every format, in each of some
    frames of a moving hole."""
    if torch:
        torch.cuda.set_device(cuda.device)
    stream = torch.cuda.current_stream().cuda_stream if torch else new_stream(cuda)
    whose, equal = "a tensor of torch %s" % torch.__version__ if torch else "CUDA's memory", True
    for name, (number, pixel_bytes, _) in FORMATS.items():
        frames, wrong = Frames(bhr, cuda, width, height, name), 0
        for frame in range(count):
            bhr.call("bhr_set_time", bhr.context, ctypes.c_double(10.0 * frame))
            expected = bhr.image(width, height, number, pixel_bytes)
            if len(set(expected)) < 2:
                raise Failure("the picture is empty, and nothing was compared")
            frames.render(stream)
            wrong += different_in_tensor(torch, frames, expected) if torch else different_in_cuda(
                frames, stream, expected)
            frames.done(stream)
        frames.close()
        equal = equal and wrong == 0
        said = "equal, byte for byte" if wrong == 0 else "%d bytes differ" % wrong
        print("%-8s %d x %d, %d frames in %s: %s" % (name, width, height, count, whose, said))
    return equal


def show(bhr, cuda, torch, width, height, count):
    """Each frame as a tensor: its mean radiance."""
    torch.cuda.set_device(cuda.device)
    frames = Frames(bhr, cuda, width, height)
    tensor = torch.as_tensor(frames, device="cuda")
    stream = torch.cuda.current_stream().cuda_stream
    for frame in range(count):
        bhr.call("bhr_set_time", bhr.context, ctypes.c_double(10.0 * frame))
        began = time.perf_counter()
        frames.render(stream)
        mean = tensor[..., :3].float().mean(dim=(0, 1))
        frames.done(stream)
        red, green, blue = mean.tolist()
        print("frame %d: %.5f %.5f %.5f, %.2f ms" % (frame, red, green, blue, 1e3 * (time.perf_counter() - began)))
    del tensor
    frames.close()
    return True


def size(text):
    width, _, height = text.partition("x")
    return int(width), int(height)


def main():
    parser = argparse.ArgumentParser(description="Frames of a black hole as tensors, without a copy.")
    parser.add_argument("--library", default=os.environ.get("BHR_LIBRARY", "libbhr.so"), help="the path of libbhr.so")
    parser.add_argument("--device", type=int, default=0, help="CUDA's number of the GPU")
    parser.add_argument("--size", type=size, default=(1920, 1080), metavar="WIDTHxHEIGHT")
    parser.add_argument("--frames", type=int, default=8)
    parser.add_argument("--check", nargs="?", const="cuda", choices=("cuda", "torch"),
                        help="compare CUDA's bytes, or those of a tensor, with those of bhr_render_image")
    parser.add_argument("--sizes", action="store_true", help="print how the structs lie in memory")
    arguments = parser.parse_args()
    if arguments.sizes:
        for struct in STRUCTS:
            places = ["%s %d" % (name, getattr(struct, name).offset) for name, _ in struct._fields_]
            print("%s %d: %s" % (struct.__name__, ctypes.sizeof(struct), ", ".join(places)))
        return 0
    try:
        torch = torch_with_cuda() if arguments.check != "cuda" else None
        cuda = Cuda(arguments.device)
        bhr = Bhr(arguments.library, cuda.uuid)
        work = check if arguments.check else show
        done = work(bhr, cuda, torch, *arguments.size, arguments.frames)
        bhr.close()
        return 0 if done else 1
    except Failure as failure:
        print("cuda_frames: %s" % failure, file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main())
