# SPDX-License-Identifier: MIT OR Apache-2.0
"""The context: a scene and what traces it."""

from __future__ import annotations

import atexit
import contextlib
import logging
import operator
import os
import threading
import weakref
from collections.abc import Iterable, Iterator, Sequence
from types import TracebackType
from typing import Any

import numpy as np
import numpy.typing as npt

from ._constants import (
    AdapterFlags,
    Backend,
    BackendLike,
    Format,
    FormatLike,
    OutputKind,
    OutputKindLike,
    Preset,
    PresetLike,
    PresetMatter,
    PresetMatterLike,
    Status,
    View,
    ViewLike,
    ViewName,
)
from ._ffi import ffi
from ._frame import Frame, _path, output_of, target_of
from ._gate import Gate, end_orphans, log_level
from ._job import Job, Waiter
from ._library import Call, Error, Progress, begin, cancel_frames, check, error, forked, inside_callback, lib
from ._moment import Moment
from ._names import member
from ._scene_text import SceneText
from ._struct import Vector, VectorLike, doubles, new
from ._structs import (
    AdapterInfo,
    Camera,
    Disk,
    Film,
    FrameStats,
    HoleInfo,
    HotSpot,
    Quality,
    Region,
    Sky,
    Volume,
)
from ._tracing import Tracing

_LOGGER = logging.getLogger("bhr")
_LOGGER.addHandler(logging.NullHandler())

_contexts: weakref.WeakSet[Context] = weakref.WeakSet()


class Context(SceneText, Moment, Tracing):
    """A scene and what traces it. A new one shows a hole of mass 1 without spin, with a golden disk, before the stars.

    Setting an attribute changes the scene; an attribute that is read is a copy, which can be set again after `replace`.
    Any thread may call; calls on one context wait for each other, and other Python threads run meanwhile. Names stand
    for members of enumerations: `ctx.set_preset("physical")`.
    """

    # A slip in an attribute's name is an AttributeError instead of a setting that nobody reads.
    __slots__ = ("__weakref__", "_adapter_name", "_quality_lock", "_targets", "_waiter")

    def __init__(
        self,
        backend: BackendLike = Backend.AUTO,
        *,
        adapter_index: int | None = None,
        cpu_threads: int = 0,
        validation: bool = False,
        logger: logging.Logger = _LOGGER,
    ) -> None:
        """Opens the best adapter of a backend, or the one at this index of `adapters()`. AUTO takes a GPU, and without
        one the CPU tracer, whose first frame of 640 x 360 pixels is there in a fifth of the time that a software driver
        needs, as that compiles its programs first; Backend.VULKAN takes such a driver, which traces a ray in a third
        of the time, for long films. `logger` is told what its level of this moment lets through."""
        begin()
        options = ffi.new("BhrContextOptions *")
        check(lib.bhr_context_options_init(options, ffi.sizeof("BhrContextOptions")))
        options.flags = lib.BHR_CONTEXT_VALIDATION if validation else 0
        options.backend = member(Backend, backend, "backend")
        if adapter_index is not None:
            options.adapter_index = operator.index(adapter_index)
        options.cpu_threads = operator.index(cpu_threads)
        options.log_level = log_level(logger)
        self._gate = Gate(options, logger)
        if options.backend == Backend.AUTO and adapter_index is None and self._on_a_software_driver():
            logger.info("no GPU was usable: the CPU tracer takes the place of %s", self.adapter.name)
            self._gate.close()
            options.backend = Backend.CPU
            self._gate = Gate(options, logger)
        self._name_adapter()
        self._quality_lock = threading.RLock()
        self._waiter = Waiter()
        #: What frames read from targets (interop.py), which must not end while it is set.
        self._targets: dict[str, Any] = {}
        _contexts.add(self)

    def _on_a_software_driver(self) -> bool:
        adapter = self.adapter
        return adapter.backend != Backend.CPU and bool(adapter.flags & AdapterFlags.SOFTWARE)

    def _name_adapter(self) -> None:
        adapter = self.adapter
        self._adapter_name = f"{adapter.name} ({adapter.backend.name})"

    def __repr__(self) -> str:
        if self.closed:
            return "<bhr.Context, closed>"
        parts = [f"<bhr.Context on {self._adapter_name}"]
        if not (inside_callback() or forked()):  # where the library answers nothing
            with contextlib.suppress(Error):
                mass, spin, _ = self._hole()
                scene = [f"mass {mass:g}", f"spin {spin:g}", "no disk" if self.disk is None else "a disk"]
                for found, name in (self.volumes, "volume"), (self.hot_spots, "hot spot"):
                    scene += [f"{len(found)} {name}" + ("s" if len(found) > 1 else "")] if found else []
                parts += scene
        return ", ".join(parts) + ">"

    # ---- life ----

    def __enter__(self) -> Context:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, exception: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self.close(cancel=kind is not None)

    def close(self, cancel: bool = False) -> None:
        """Ends the context, after its jobs, which `cancel` stops. Calls afterwards are errors; closing again is not."""
        if inside_callback() or self._waiter.is_this_thread():
            raise error(Status.INVALID_STATE, "a context cannot be closed from inside a callback")
        self._close(cancel)

    def _close(self, cancel: bool) -> None:
        if forked():
            return
        self._gate.refuse()
        if cancel:
            self._waiter.cancel()
        self._gate.wait_until_empty()
        self._waiter.end(cancel)
        self._gate.destroy()

    @property
    def closed(self) -> bool:
        return self._gate.closed

    def recover(self) -> None:
        """Opens the device anew after DeviceLost; the scene stays."""
        with self._gate as context:
            check(lib.bhr_context_recover(context))
        self._name_adapter()

    @property
    def adapter(self) -> AdapterInfo:
        """The adapter that the context runs on."""
        return AdapterInfo.from_c(self._read("BhrAdapterInfo", lib.bhr_context_adapter))

    @property
    def stats(self) -> FrameStats:
        """Numbers about the last finished frame; all 0 before the first."""
        return FrameStats.from_c(self._read("BhrFrameStats", lib.bhr_frame_stats))

    def _read(self, name: str, function: Any) -> Any:
        struct = new(name)
        with self._gate as context:
            check(function(context, struct))
        return struct

    def _set(self, function: Any, value: Any) -> None:
        with self._gate as context:
            check(function(context, value))

    # ---- the hole ----

    def _hole(self) -> tuple[float, float, Vector]:
        mass, spin, axis = ffi.new("double *"), ffi.new("double *"), ffi.new("double[3]")
        with self._gate as context:
            check(lib.bhr_get_hole(context, mass, spin, axis))
        return mass[0], spin[0], (axis[0], axis[1], axis[2])

    @property
    def mass(self) -> float:
        """The mass M in scene lengths (G = c = 1). Default 1."""
        return self._hole()[0]

    @mass.setter
    def mass(self, mass: float) -> None:
        self._set(lib.bhr_set_mass, mass)

    @property
    def spin(self) -> float:
        """The spin a / M, -1 .. 1; in frames -0.9999 .. 0.9999. Default 0."""
        return self._hole()[1]

    @spin.setter
    def spin(self, spin: float) -> None:
        self._set(lib.bhr_set_spin, spin)

    @property
    def axis(self) -> Vector:
        """The spin axis, which is also the disk's normal: a unit vector. It may be set to any length. Default +z."""
        return self._hole()[2]

    @axis.setter
    def axis(self, axis: VectorLike) -> None:
        self._set(lib.bhr_set_axis, doubles(axis, 3, "axis"))

    @property
    def hole_info(self) -> HoleInfo:
        """Numbers about the hole and the camera's observer."""
        return HoleInfo.from_c(self._read("BhrHoleInfo", lib.bhr_hole_info))

    def metric_at(self, position: VectorLike) -> npt.NDArray[np.float64]:
        """The metric g_ab at a place, 4 x 4, in Boyer-Lindquist (t, r, th, ph), signature - + + +."""
        return self._tensor(lib.bhr_metric_at, position, (4, 4))

    def christoffel_at(self, position: VectorLike) -> npt.NDArray[np.float64]:
        """The Christoffel symbols Gamma^a_bc at a place, 4 x 4 x 4, in Boyer-Lindquist (t, r, th, ph)."""
        return self._tensor(lib.bhr_christoffel_at, position, (4, 4, 4))

    def _tensor(self, function: Any, position: VectorLike, shape: tuple[int, ...]) -> npt.NDArray[np.float64]:
        tensor = np.empty(shape)
        at = doubles(position, 3, "position")
        with self._gate as context:
            check(function(context, at, ffi.from_buffer("double[]", tensor)))
        return tensor

    # ---- the camera ----

    @property
    def camera(self) -> Camera:
        return Camera.from_c(self._read("BhrCamera", lib.bhr_get_camera))

    @camera.setter
    def camera(self, camera: Camera) -> None:
        self._set(lib.bhr_set_camera, Camera.c_of(camera, "camera"))

    def advance(self, camera: Camera, proper_time: float) -> tuple[Camera, float]:
        """A camera moved along its world line about this hole by a proper time, and the scene time that went by. The
        context's own camera stays where it is."""
        struct, elapsed = camera.to_c(), ffi.new("double *")
        with self._gate as context:
            check(lib.bhr_camera_advance(context, struct, proper_time, elapsed))
        return Camera.from_c(struct), elapsed[0]

    # ---- the scene ----

    @property
    def disk(self) -> Disk | None:
        """The accretion disk; None: there is none."""
        struct, present = new("BhrDisk"), ffi.new("int32_t *")
        with self._gate as context:
            check(lib.bhr_get_disk(context, struct, present))
        return Disk.from_c(struct) if present[0] else None

    @disk.setter
    def disk(self, disk: Disk | None) -> None:
        self._set(lib.bhr_set_disk, Disk.c_of(disk, "disk", or_none=True))

    @property
    def volumes(self) -> tuple[Volume, ...]:
        """Matter with depth, at most four volumes; none by default."""
        found, count = ffi.new("BhrVolume[]", lib.BHR_MAX_VOLUMES), ffi.new("uint32_t *")
        with self._gate as context:
            check(lib.bhr_get_volumes(context, found, ffi.sizeof("BhrVolume"), len(found), count))
        return tuple(Volume.from_c(found[i]) for i in range(count[0]))

    @volumes.setter
    def volumes(self, volumes: Sequence[Volume]) -> None:
        given = Volume.array_of(volumes, "volumes")
        with self._gate as context:
            check(lib.bhr_set_volumes(context, given, ffi.sizeof("BhrVolume"), len(given)))

    @property
    def hot_spots(self) -> tuple[HotSpot, ...]:
        """Blobs on circular orbits, at most eight; none by default."""
        found, count = ffi.new("BhrHotSpot[]", lib.BHR_MAX_HOT_SPOTS), ffi.new("uint32_t *")
        with self._gate as context:
            check(lib.bhr_get_hot_spots(context, found, ffi.sizeof("BhrHotSpot"), len(found), count))
        return tuple(HotSpot.from_c(found[i]) for i in range(count[0]))

    @hot_spots.setter
    def hot_spots(self, hot_spots: Sequence[HotSpot]) -> None:
        given = HotSpot.array_of(hot_spots, "hot_spots")
        with self._gate as context:
            check(lib.bhr_set_hot_spots(context, given, ffi.sizeof("BhrHotSpot"), len(given)))

    @property
    def sky(self) -> Sky:
        return Sky.from_c(self._read("BhrSky", lib.bhr_get_sky))

    @sky.setter
    def sky(self, sky: Sky | None) -> None:
        """None: black."""
        self._set(lib.bhr_set_sky, Sky.c_of(sky, "sky", or_none=True))

    @property
    def film(self) -> Film:
        return Film.from_c(self._read("BhrFilm", lib.bhr_get_film))

    @film.setter
    def film(self, film: Film) -> None:
        self._set(lib.bhr_set_film, Film.c_of(film, "film"))

    @property
    def quality(self) -> Quality:
        return Quality.from_c(self._read("BhrQuality", lib.bhr_get_quality))

    @quality.setter
    def quality(self, quality: Quality) -> None:
        given = Quality.c_of(quality, "quality")
        with self._quality_kept():
            self._set(lib.bhr_set_quality, given)

    def set_preset(self, preset: PresetLike) -> None:
        """Gives disk, sky, film and effects the values of a named look."""
        self._set(lib.bhr_set_preset, member(Preset, preset, "preset"))

    def set_preset_with(
        self,
        preset: PresetLike,
        matter: PresetMatterLike = PresetMatter.AUTO,
        *,
        size: tuple[int, int] = (0, 0),
        frame_ms: float = 0.0,
        measure_anew: bool = False,
        may_halve: bool = False,
    ) -> PresetMatter:
        """Gives the scene a named look and decides its volumes: THIN, none and the disk; DEEP, one in place of the
        disk; AUTO, whichever a frame of `size` in `frame_ms` allows, which is measured once, or again where
        `measure_anew`. Returns which it is. 0 stands for the defaults, (1920, 1080) and 16. Where it `may_halve`, AUTO
        takes half resolution (`quality.volume_resolution`) before it leaves volumes out."""
        options = new("BhrPresetOptions")
        look = member(Preset, preset, "preset")
        options.matter = member(PresetMatter, matter, "matter")
        options.width, options.height = size
        options.frame_ms = frame_ms
        options.measure_anew, options.may_halve = measure_anew, may_halve
        chosen = ffi.new("BhrPresetMatter *")
        with self._gate as context:
            check(lib.bhr_set_preset_with(context, look, options, chosen))
        return PresetMatter(chosen[0])

    @property
    def view(self) -> View:
        """The quantity that pixels show. Default LIGHT."""
        view = ffi.new("BhrView *")
        with self._gate as context:
            check(lib.bhr_get_view(context, view))
        return View(view[0])

    @view.setter
    def view(self, view: ViewLike) -> None:
        self._set(lib.bhr_set_view, member(View, view, "view"))

    @property
    def region(self) -> Region | None:
        """The part of a larger frame that images hold; None (default): all of it."""
        struct, present = new("BhrRegion"), ffi.new("int32_t *")
        with self._gate as context:
            check(lib.bhr_get_region(context, struct, present))
        return Region.from_c(struct) if present[0] else None

    @region.setter
    def region(self, region: Region | None) -> None:
        self._set(lib.bhr_set_region, Region.c_of(region, "region", or_none=True))

    def set_occluder(self, distances: Frame | npt.NDArray[Any] | None, *, lensed: bool = False) -> None:
        """Sets the program's own things before the camera: distances along the pixels' lines of sight, float32 of shape
        (height, width) as large as the frames to come, np.inf where there is nothing; None: none."""
        frame = distances if isinstance(distances, Frame) or distances is None else Frame(distances)
        flags = lib.BHR_IMAGE_LENSED if lensed else 0
        self._set(lib.bhr_set_occluder, ffi.NULL if frame is None else frame.image(flags=flags))
        self._targets.pop("occluder", None)

    # ---- frames ----

    def _quality_kept(self) -> contextlib.AbstractContextManager[Any]:
        """Within it no other thread sets the quality. Callbacks, to whom the library refuses that, must not wait for
        the frame that waits for them."""
        return contextlib.nullcontext() if inside_callback() else self._quality_lock

    @contextlib.contextmanager
    def _sampled(self, samples: int | None) -> Iterator[None]:
        """Within it frames have so many rays a pixel, and no other thread sets the quality; None: as it is."""
        if samples is None:
            yield
            return
        with self._quality_kept():
            before = self.quality
            self.quality = before.replace(samples_per_pixel=samples)
            try:
                yield
            finally:
                self.quality = before

    def render(
        self,
        width: int | None = None,
        height: int | None = None,
        *,
        format: FormatLike | None = None,
        transparent: bool = False,
        samples: int | None = None,
        out: Frame | npt.NDArray[Any] | None = None,
        progress: Progress | None = None,
    ) -> Frame:
        """Renders the scene as it is now, into `out` if that is given; width and height may then be left out. Default
        format: RGBA8_SRGB, or that of `out`. `transparent` leaves the sky out, and alpha says where it was. `samples`:
        rays of a pixel, for this frame in the place of Quality.samples_per_pixel."""
        frame, image = target_of(width, height, format, transparent, out)
        with self._sampled(samples), self._gate as context, Call(progress) as call:
            call.check(lib.bhr_render_image(context, image))
        return frame

    def accumulate(
        self,
        moments: Iterable[float],
        width: int | None = None,
        height: int | None = None,
        *,
        format: FormatLike | None = None,
        transparent: bool = False,
        out: Frame | npt.NDArray[Any] | None = None,
    ) -> Frame:
        """The mean of several frames, developed once, for motion blur or depth of field. `moments` sets the scene for
        each frame before it yields the frame's weight, as a generator does:

            def shutter():
                for i in range(16):
                    ctx.time = begin + i / 16 * span
                    yield 1.0

            frame = ctx.accumulate(shutter(), 1920, 1080)  # the rest is as for `render`
        """
        frame, image = target_of(width, height, format, transparent, out)
        with self._gate as context:
            check(lib.bhr_begin_accumulation(context, image.width, image.height, image.flags))
        try:
            for weight in moments:
                with self._gate as context:
                    check(lib.bhr_accumulate(context, weight))
            with self._gate as context:
                check(lib.bhr_end_accumulation(context, image))
        except BaseException:
            with self._gate as context:
                lib.bhr_end_accumulation(context, ffi.NULL)
            raise
        return frame

    def render_async(
        self,
        width: int | None = None,
        height: int | None = None,
        *,
        format: FormatLike | None = None,
        transparent: bool = False,
        samples: int | None = None,
        out: Frame | npt.NDArray[Any] | None = None,
        progress: Progress | None = None,
    ) -> Job:
        """Begins the same in the background and returns at once: a future of the frame. The scene is taken as it is
        now. At most 64 jobs of a context may be unfinished. `progress` is called on a thread of the package."""
        frame, image = target_of(width, height, format, transparent, out)
        pointer = ffi.new("BhrJob **")
        with self._sampled(samples), self._gate as context:
            check(lib.bhr_render_image_async(context, image, pointer))
            job = Job(self, pointer[0], frame, progress)
            self._waiter.add(job)
        return job

    def render_views(self, width: int, height: int, views: Sequence[ViewLike]) -> npt.NDArray[Any]:
        """The values of several views as a structured array of shape (height, width), a float32 field for each, named
        "redshift", "order" and so on. Frames that other threads ask for meanwhile may show these views."""
        chosen = [member(View, view, "view") for view in views]
        values = np.empty((height, width), [(view.name.lower(), np.float32) for view in chosen])
        plane = Frame.empty(width, height, Format.R32F)
        before = self.view
        try:
            for view in chosen:
                self.view = view
                values[view.name.lower()] = self.render(out=plane).array
        finally:
            self.view = before
        return values

    def render_outputs(
        self,
        width: int,
        height: int,
        outputs: Sequence[OutputKindLike | tuple[OutputKindLike, int | ViewName]],
        *,
        format: FormatLike = Format.RGBA32F,
        transparent: bool = False,
        samples: int | None = None,
        save: str | os.PathLike[str] | None = None,
        progress: Progress | None = None,
    ) -> list[Frame]:
        """The picture, and what belongs to it: distances, the sky's directions, places on the disk and so on, a frame
        for each of `outputs`. POSITION, DISK and VIEW may be pairs with the number of a crossing, or the view. `format`
        and `transparent` are the picture's, as `samples`, for which `render` says more. `save`: an .exr file that gets
        them all as layers."""
        single = {OutputKind.DEPTH, OutputKind.TRANSMISSION, OutputKind.VIEW}
        array = ffi.new("BhrOutput[]", len(outputs))
        frames, images = [], []
        format = member(Format, format, "format")
        for output, c in zip(outputs, array):
            kind, index = output_of(output)
            other = Format.R32F if kind in single else Format.RGBA32F
            frame = Frame.empty(width, height, format if kind == OutputKind.LIGHT else other)
            frame.transparent = transparent and kind == OutputKind.LIGHT
            frames.append(frame)
            images.append(frame.image(writable=True, flags=lib.BHR_IMAGE_TRANSPARENT if transparent else 0))
            c.struct_size = ffi.sizeof("BhrOutput")
            c.kind, c.index, c.image = kind, index, images[-1]
        arguments = (array, ffi.sizeof("BhrOutput"), len(array))
        with self._sampled(samples), self._gate as context, Call(progress) as call:
            call.check(lib.bhr_render_outputs(context, *arguments, ffi.NULL))
            if save is not None:
                check(lib.bhr_save_outputs(context, *arguments, _path(save)))
        return frames

    def prepare(
        self,
        width: int,
        height: int,
        *,
        format: FormatLike = Format.RGBA8_SRGB,
        transparent: bool = False,
        samples: int | None = None,
        progress: Progress | None = None,
    ) -> None:
        """Makes everything that frames of the present scene need, so that the next one is no slower than later ones."""
        image = new("BhrImage")
        image.format, image.width, image.height = member(Format, format, "format"), width, height
        image.flags = lib.BHR_IMAGE_TRANSPARENT if transparent else 0
        with self._sampled(samples), self._gate as context, Call(progress) as call:
            call.check(lib.bhr_prepare(context, image))


@atexit.register
def _close_all() -> None:
    """No callback may reach an interpreter that has ended: it ends the thread, and so the process if Rust is on it."""
    cancel_frames()
    for context in list(_contexts):
        context._close(cancel=True)
    end_orphans()
