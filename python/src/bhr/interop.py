# SPDX-License-Identifier: MIT OR Apache-2.0
"""Frames that stay on the GPU, for programs that have one of their own: bhr_interop.h, without what needs a VkDevice of
the program's. Experimental: what is here may change in any release.

    can = interop.info(ctx)
    if can.export_buffers & interop.HandleType.OPAQUE_FD:
        rows, share = interop.TargetKind.BUFFER, interop.HandleType.OPAQUE_FD
        target = interop.Target(ctx, 1280, 720, kind=rows, handle_type=share)
        memory, descriptor = target.info, target.export()  # to cuImportExternalMemory, which takes it over
        interop.render(ctx, target).result()

A context makes targets and semaphores, which are used with it alone. Each ends when it is closed, at the end of `with`
or when nobody has it any more; its memory lives until the other side has let go of it, too. bhr_interop.h says at
length what each number means, in which order the GPU works, and which barriers a Vulkan host needs.
"""

from __future__ import annotations

import contextlib
import dataclasses
import enum
import operator
import time
from collections.abc import Iterator, Sequence
from types import TracebackType
from typing import Any, ClassVar, Literal, TypeVar, Union

import numpy as np
import numpy.typing as npt

from ._constants import Format, FormatLike, OutputKind, OutputKindLike, Projection, ProjectionLike, Status, ViewName
from ._context import Context
from ._ffi import ffi
from ._frame import Frame, output_of
from ._gate import Door
from ._job import AnyJob
from ._library import begin, check, lib
from ._names import Named, flags, member, named
from ._struct import Struct, new

__all__ = [
    "HandleType",
    "Info",
    "OutputsJob",
    "Semaphore",
    "SemaphoreKind",
    "Target",
    "TargetInfo",
    "TargetJob",
    "TargetKind",
    "find_adapter",
    "info",
    "render",
    "render_outputs",
    "set_occluder",
    "set_sky",
]


class HandleType(enum.IntFlag):
    """The kinds of handles that memory and semaphores are passed by. Those that this library cannot pass yet are in no
    bits of `Info`."""

    #: Linux: a file descriptor of the driver's, for the same driver only: Vulkan, CUDA, OpenGL.
    OPAQUE_FD = 1
    DMA_BUF = 2
    OPAQUE_WIN32 = 4
    D3D12 = 8
    D3D11_TEXTURE = 16
    APPLE = 32
    #: The program's own pixels, for Target.from_handle of buffers: the handle is their address.
    HOST_POINTER = 64


class TargetKind(enum.IntEnum):
    """The substance of a target."""

    #: Two-dimensional, tiled as the driver likes: for sampling and drawing.
    IMAGE = 0
    #: Rows in linear memory: for CUDA, tensors, video encoders.
    BUFFER = 1


class SemaphoreKind(enum.IntEnum):
    """A semaphore's kind."""

    #: It has a value, which grows.
    TIMELINE = 0
    #: Each signal is waited for exactly once, after it was submitted.
    BINARY = 1


TargetKindName = Literal["image", "buffer"]
SemaphoreKindName = Literal["timeline", "binary"]


@dataclasses.dataclass(frozen=True)
class Info:
    """The ways in which a context's device can share; none of them on the CPU tracer, OpenGL and Metal."""

    c_name: ClassVar[str] = "BhrInteropInfo"

    export_images: HandleType
    export_buffers: HandleType
    import_images: HandleType
    import_buffers: HandleType
    #: By SemaphoreKind.
    semaphores: tuple[HandleType, HandleType]
    #: Vulkan's deviceUUID, GL_DEVICE_UUID_EXT, what cuDeviceGetUuid gives: 16 bytes, all 0 if it is not known.
    device_uuid: bytes
    #: OPAQUE handles go between equal pairs of both UUIDs only.
    driver_uuid: bytes
    #: 8 bytes, on Windows.
    luid: bytes | None
    #: Numbers of the render node, /dev/dri/renderD*; -1: not known.
    drm_major: int
    drm_minor: int


def info(context: Context) -> Info:
    """The ways in which the context's device can share."""
    struct = context._read("BhrInteropInfo", lib.bhr_interop_info)
    bits = {name: HandleType(getattr(struct, name)) for name in ("export_images", "export_buffers")}
    bits.update({name: HandleType(getattr(struct, name)) for name in ("import_images", "import_buffers")})
    return Info(
        **bits,
        semaphores=(HandleType(struct.semaphores[0]), HandleType(struct.semaphores[1])),
        device_uuid=bytes(struct.device_uuid),
        driver_uuid=bytes(struct.driver_uuid),
        luid=bytes(struct.luid) if struct.luid_valid else None,
        drm_major=struct.drm_major,
        drm_minor=struct.drm_minor,
    )


def find_adapter(uuid: bytes | None = None, luid: bytes | None = None) -> int:
    """The adapter of this deviceUUID (16 bytes), of this LUID (8 bytes), or of both, for Context's adapter_index."""
    begin()
    for name, given, length in ("uuid", uuid, 16), ("luid", luid, 8):
        if given is not None and len(given) != length:
            raise ValueError(f"{name} has {len(given)} bytes instead of {length}")
    index = ffi.new("int32_t *")
    check(lib.bhr_adapter_find(*(ffi.NULL if given is None else bytes(given) for given in (uuid, luid)), index))
    return int(index[0])


@dataclasses.dataclass(frozen=True)
class TargetInfo(Struct):
    """The numbers with which the other side imports a target, or bhr the other side's memory."""

    c_name: ClassVar[str] = "BhrTargetInfo"
    c_enums = {"kind": TargetKind}

    kind: Named[TargetKind, TargetKindName] = named(TargetKind.IMAGE)
    width: int = 0
    height: int = 0
    #: VkFormat of an image; 0 of a buffer.
    vk_format: int = 0
    #: VkImageUsageFlags or VkBufferUsageFlags.
    vk_usage: int = 0
    #: VkImageCreateFlags.
    vk_flags: int = 0
    vk_tiling: int = 0
    #: VkImageLayout after a frame.
    layout: int = 0
    #: 1: the memory is a dedicated allocation and must be imported as one.
    dedicated: int = 0
    #: Index of the memory type in the device's list.
    memory_type: int = 0
    #: Bytes of the whole allocation.
    allocation_size: int = 0
    #: Bytes from its begin to the target's.
    offset: int = 0
    #: Bytes from row to row of a buffer.
    row_stride: int = 0


_Self = TypeVar("_Self", bound="_Shared")


class _Shared:
    """An object that both sides reach."""

    # A slip in an attribute's name is an AttributeError.
    __slots__ = ("__weakref__", "_door")

    _door: Door

    def close(self) -> None:
        """Ends the object, after other threads' calls on it. Calls afterwards are errors; closing again is not. Frames
        that use it already go on."""
        self._door.close()

    @property
    def closed(self) -> bool:
        return self._door.closed

    def __enter__(self: _Self) -> _Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, exception: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self.close()

    def _open(self, door: Door, context: Context, made: Any, function: Any, *arguments: Any) -> None:
        """Calls a function of the library that makes the object, with the place for it, `made`, as last argument."""
        self._door = door
        with context._gate as pointer:
            check(function(pointer, *arguments, made))
        door._pointer = made[0]

    def _export(self, function: Any) -> int:
        handle = ffi.new("BhrHandle *")
        with self._door as pointer:
            check(function(pointer, handle))
        return int(handle.fd)


def _handle(handle: int, handle_type: HandleType | str) -> Any:
    """A handle on its way into the library."""
    struct = ffi.new("BhrHandle *")
    struct.type, struct.fd = flags(HandleType, handle_type, "handle_type"), -1
    if struct.type == HandleType.HOST_POINTER:
        struct.handle = ffi.cast("void *", handle)
    else:
        struct.fd = operator.index(handle)
    return struct


class Target(_Shared):
    """A picture on the GPU that both sides reach."""

    __slots__ = ()

    def __init__(
        self,
        context: Context,
        width: int,
        height: int,
        *,
        kind: TargetKind | TargetKindName = TargetKind.IMAGE,
        format: FormatLike = Format.RGBA8_SRGB,
        transparent: bool = False,
        handle_type: HandleType | str = HandleType(0),
        layout: int = 0,
        row_stride: int = 0,
    ) -> None:
        """Makes one in memory of bhr's, which is passed by the one kind of handle that `handle_type` says. `layout` is
        the VkImageLayout that frames leave an image in; 0: VK_IMAGE_LAYOUT_GENERAL. `row_stride`: bytes from row to row
        of a buffer, a multiple of 4; 0: packed."""
        options = _options(width, height, kind, format, transparent, handle_type, layout, row_stride)
        door, made = Door("target", lib.bhr_target_destroy), ffi.new("BhrTarget **")
        self._open(door, context, made, lib.bhr_target_create, options)

    @classmethod
    def from_handle(
        cls,
        context: Context,
        width: int,
        height: int,
        memory: TargetInfo,
        handle: int,
        handle_type: HandleType | str = HandleType.OPAQUE_FD,
        *,
        kind: TargetKind | TargetKindName = TargetKind.IMAGE,
        format: FormatLike = Format.RGBA8_SRGB,
        transparent: bool = False,
        layout: int = 0,
        row_stride: int = 0,
    ) -> Target:
        """Makes one in memory of the program's. A file descriptor is the library's afterwards, and the caller's after
        an error. `memory` says what is behind it: allocation_size, offset, memory_type, dedicated, and for images
        vk_usage, vk_flags and vk_tiling. HOST_POINTER: the handle is an address; its pixels must stay until the target
        is closed and its frames are done."""
        self = cls.__new__(cls)
        options = _options(width, height, kind, format, transparent, handle_type, layout, row_stride)
        given = memory.to_c(), _handle(handle, handle_type)
        door, made = Door("target", lib.bhr_target_destroy), ffi.new("BhrTarget **")
        self._open(door, context, made, lib.bhr_target_import, options, *given)
        return self

    @property
    def info(self) -> TargetInfo:
        """The numbers with which the other side imports it."""
        struct = new("BhrTargetInfo")
        with self._door as pointer:
            check(lib.bhr_target_info(pointer, struct))
        return TargetInfo.from_c(struct)

    def export(self) -> int:
        """A new file descriptor of its memory, which is the caller's: to be passed to what takes it over, or closed."""
        return self._export(lib.bhr_target_export)


def _options(
    width: int,
    height: int,
    kind: TargetKind | TargetKindName,
    format: FormatLike,
    transparent: bool,
    handle_type: HandleType | str,
    layout: int,
    row_stride: int,
) -> Any:
    options = ffi.new("BhrTargetOptions *")
    check(lib.bhr_target_options_init(options, ffi.sizeof("BhrTargetOptions")))
    options.kind, options.format = member(TargetKind, kind, "kind"), member(Format, format, "format")
    options.width, options.height = width, height
    options.flags = lib.BHR_IMAGE_TRANSPARENT if transparent else 0
    options.handle_type = flags(HandleType, handle_type, "handle_type")
    options.layout, options.row_stride = layout, row_stride
    return options


class Semaphore(_Shared):
    """A semaphore that both sides reach: of value 0, or not signalled."""

    __slots__ = ()

    def __init__(
        self,
        context: Context,
        kind: SemaphoreKind | SemaphoreKindName = SemaphoreKind.TIMELINE,
        *,
        handle_type: HandleType | str = HandleType(0),
    ) -> None:
        """Makes one that is exported by the one kind of handle that `handle_type` says; 0: by none."""
        given = member(SemaphoreKind, kind, "kind"), flags(HandleType, handle_type, "handle_type")
        door, made = Door("semaphore", lib.bhr_semaphore_destroy), ffi.new("BhrSemaphore **")
        self._open(door, context, made, lib.bhr_semaphore_create, *given)

    @classmethod
    def from_handle(
        cls,
        context: Context,
        handle: int,
        handle_type: HandleType | str = HandleType.OPAQUE_FD,
        *,
        kind: SemaphoreKind | SemaphoreKindName = SemaphoreKind.TIMELINE,
    ) -> Semaphore:
        """Makes one of the program's semaphores, which is of this kind. A file descriptor is the library's afterwards,
        and the caller's after an error."""
        self = cls.__new__(cls)
        given = member(SemaphoreKind, kind, "kind"), _handle(handle, handle_type)
        door, made = Door("semaphore", lib.bhr_semaphore_destroy), ffi.new("BhrSemaphore **")
        self._open(door, context, made, lib.bhr_semaphore_import, *given)
        return self

    def export(self) -> int:
        """A new file descriptor of it, which is the caller's: to be passed to what takes it over, or closed."""
        return self._export(lib.bhr_semaphore_export)

    def wait(self, value: int, timeout: float | None = None) -> bool:
        """Waits on the CPU until a TIMELINE has reached a value; False: it has not within `timeout` seconds. None waits
        without limit."""
        end = None if timeout is None else time.monotonic() + timeout
        while True:
            left = _SLICE if end is None else min(max(end - time.monotonic(), 0.0), _SLICE)
            # In slices, so that Ctrl-C and `close` from another thread come through.
            with self._door as pointer:
                status = lib.bhr_semaphore_wait(pointer, value, int(left * 1e9))
                check(status)
            if status == Status.OK:
                return True
            if end is not None and time.monotonic() >= end:
                return False

    def signal(self, value: int) -> None:
        """Signals a TIMELINE on the CPU."""
        with self._door as pointer:
            check(lib.bhr_semaphore_signal(pointer, value))


_SLICE = 0.1

#: A semaphore and the value to wait for, or to signal, which counts for a TIMELINE only.
SemaphoreValue = tuple[Semaphore, int]


class TargetJob(AnyJob[Target]):
    """A frame on its way into a target: a future of that target."""


class OutputsJob(AnyJob[list[Union[Target, Frame]]]):
    """Outputs on their way: a future of the places that they go to, whose arrays are the library's until it is done."""


@contextlib.contextmanager
def _synced(waits: Sequence[SemaphoreValue], signals: Sequence[SemaphoreValue]) -> Iterator[Any]:
    """A BhrSync, whose semaphores do not end meanwhile."""
    with contextlib.ExitStack() as inside:
        arrays = []
        for values in waits, signals:
            arrays.append(ffi.new("BhrSemaphoreValue[]", len(values)))
            for c, (semaphore, value) in zip(arrays[-1], values):
                c.semaphore, c.value = inside.enter_context(semaphore._door), value
        sync = new("BhrSync")
        sync.wait_count, sync.signal_count = len(waits), len(signals)
        sync.waits, sync.signals = arrays
        yield sync


def render(
    context: Context,
    target: Target,
    *,
    waits: Sequence[SemaphoreValue] = (),
    signals: Sequence[SemaphoreValue] = (),
    background: bool = False,
) -> TargetJob:
    """Renders the scene as it is now into a target, after all of `waits` (8 at most), and then gives `signals`. The
    call returns when the frame is submitted, wholly; nobody waits on the CPU but who asks the job. `background`: it is
    submitted by the library's threads, in the order of the context's jobs, with timelines only. At most 64 frames of a
    context may be unfinished. The device is lost if a wait is not signalled within 60 s."""
    function = lib.bhr_render_target_async if background else lib.bhr_render_target
    out = ffi.new("BhrJob **")
    with _synced(waits, signals) as sync, target._door as pointer, context._gate as gate:
        check(function(gate, pointer, sync, out))
        job = TargetJob(context, out[0], target, None)
        context._waiter.add(job)
    return job


def render_outputs(
    context: Context,
    outputs: Sequence[tuple[OutputKindLike | tuple[OutputKindLike, int | ViewName], Target | Frame | npt.NDArray[Any]]],
    *,
    transparent: bool = False,
    waits: Sequence[SemaphoreValue] = (),
    signals: Sequence[SemaphoreValue] = (),
    background: bool = False,
) -> OutputsJob:
    """Renders outputs of one frame, each into a target or an array of its own, with one set of semaphores: pairs of a
    kind, or of a kind with the number of a crossing or the view, and the place. Targets are R32F or RGBA32F by kind,
    and of any format for LIGHT. An array is complete when the job is; `signals` tell of targets only. `transparent` is
    for LIGHT in an array. Otherwise as `render`."""
    function = lib.bhr_render_outputs_shared_async if background else lib.bhr_render_outputs_shared
    array, out = ffi.new("BhrOutput[]", len(outputs)), ffi.new("BhrJob **")
    images, places = [], []
    with contextlib.ExitStack() as inside:
        for (output, place), c in zip(outputs, array):
            kind, index = output_of(output)
            c.struct_size = ffi.sizeof("BhrOutput")
            c.kind, c.index = kind, index
            if isinstance(place, Target):
                c.target = inside.enter_context(place._door)
            else:
                place = Frame(place) if isinstance(place, np.ndarray) else place
                lit = transparent and kind == OutputKind.LIGHT
                images.append(place.image(writable=True, flags=lib.BHR_IMAGE_TRANSPARENT if lit else 0))
                c.image = images[-1]
            places.append(place)
        sync, gate = inside.enter_context(_synced(waits, signals)), inside.enter_context(context._gate)
        check(function(gate, array, ffi.sizeof("BhrOutput"), len(array), sync, out))
        job = OutputsJob(context, out[0], places, None)
        context._waiter.add(job)
    return job


def set_occluder(context: Context, target: Target | None, *, lensed: bool = False) -> None:
    """Context.set_occluder with distances on the GPU, in a target of R32F, which each frame reads anew, after its
    waits. None: none. The context keeps the target, which must not be closed before another is set."""
    flags = lib.BHR_IMAGE_LENSED if lensed else 0
    with _door_of(target) as pointer, context._gate as gate:
        check(lib.bhr_set_occluder_target(gate, pointer, flags))
        context._targets["occluder"] = target


def set_sky(context: Context, target: Target | None, layout: ProjectionLike = Projection.EQUIRECT) -> None:
    """Context.set_sky_map with a picture on the GPU, in a target of RGBA16F or RGBA32F, which each frame with
    SkyFlags.MAP reads anew, after its waits. `layout`: EQUIRECT, or CUBE, six faces side by side. None: none. The
    context keeps the target, which must not be closed before another is set."""
    layout = member(Projection, layout, "layout")
    with _door_of(target) as pointer, context._gate as gate:
        if layout == Projection.EQUIRECT:
            check(lib.bhr_set_sky_target(gate, pointer))
        else:
            check(lib.bhr_set_sky_target_as(gate, pointer, layout))
        context._targets["sky"] = target


def _door_of(target: Target | None) -> contextlib.AbstractContextManager[Any]:
    return contextlib.nullcontext(ffi.NULL) if target is None else target._door
