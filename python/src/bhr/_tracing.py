# SPDX-License-Identifier: MIT OR Apache-2.0
"""The part of a context that follows single rays, those of a picture, of arrays, and to points, and bodies in free
fall. Knows no frames."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from ._constants import Chart, ChartLike
from ._ffi import ffi
from ._gate import Gate
from ._library import check, lib
from ._names import member
from ._rays import BODY, HIT, PROJECTED, RAY, TRANSFER
from ._struct import VectorLike, doubles, new
from ._structs import ProjectedPoint


class Tracing:
    """The methods of Context for rays and bodies."""

    __slots__ = ("_gate",)

    _gate: Gate

    def camera_rays(self, width: int, height: int) -> npt.NDArray[np.void]:
        """The rays of a frame through the centres of its pixels: dtype RAY, shape (height, width)."""
        rays = np.zeros((height, width), RAY)
        with self._gate as context:
            check(lib.bhr_camera_rays(context, width, height, _pointer("BhrRay *", rays)))
        return rays

    def camera_ray(self, width: int, height: int, x: float, y: float) -> npt.NDArray[np.void]:
        """One of those rays, at a pixel position; (0, 0) is the frame's top-left corner. Its shape is ()."""
        ray = np.zeros((), RAY)
        with self._gate as context:
            check(lib.bhr_camera_ray(context, width, height, x, y, _pointer("BhrRay *", ray)))
        return ray

    def project_point(self, width: int, height: int, point: VectorLike, order: int = 0) -> ProjectedPoint:
        """Where in a frame a point of the scene appears: by light that went half round the hole `order` times."""
        struct = new("BhrProjectedPoint")
        with self._gate as context:
            check(lib.bhr_project_point(context, width, height, doubles(point, 3, "point"), order, struct))
        return ProjectedPoint.from_c(struct)

    def project_points(
        self, width: int, height: int, points: npt.ArrayLike, order: int = 0
    ) -> npt.NDArray[np.void]:
        """project_point for many points, of the shape (..., 3), on several threads: dtype PROJECTED, of the shape
        (...). `apparent` is where a rasteriser draws a vertex so that it appears where light shows it."""
        places = np.ascontiguousarray(points, np.float64)
        if places.ndim < 1 or places.shape[-1] != 3:
            raise ValueError(f"points have the shape {places.shape}; the last side must be 3")
        found = np.zeros(places.shape[:-1], PROJECTED)
        with self._gate as context:
            begin, out = _pointer("double *", places), _pointer("BhrProjectedPoint *", found)
            check(lib.bhr_project_points(context, width, height, begin, found.size, order, out, PROJECTED.itemsize))
        return found

    def trace(
        self, rays: npt.NDArray[np.void] | np.void, *, out: npt.NDArray[np.void] | None = None
    ) -> npt.NDArray[np.void]:
        """Traces an array of rays of any shape, and returns their ends, dtype HIT, in an array of that shape, or in
        `out`. Rays that are contiguous in memory are not copied; `out` must be."""
        packed = _rays(rays)
        if out is None:
            out = np.zeros(packed.shape, HIT)
        elif out.dtype != HIT or out.shape != packed.shape:
            raise ValueError(f"out has dtype {out.dtype} and shape {out.shape} instead of HIT and {packed.shape}")
        elif not (out.flags.c_contiguous and out.flags.writeable):
            raise ValueError("out is not contiguous, or read-only")
        with self._gate as context:
            ray, hit = _pointer("BhrRay *", packed), _pointer("BhrHit *", out)
            check(lib.bhr_trace_rays(context, ray, RAY.itemsize, packed.size, hit, HIT.itemsize))
        return out

    def transfer(self, rays: npt.NDArray[np.void] | np.void) -> npt.NDArray[np.void]:
        """The matter with depth along an array of rays of any shape, thin disk and sky left out: intensities, optical
        depths and light, dtype TRANSFER, in an array of that shape. In double precision on the CPU, whatever the
        backend."""
        packed = _rays(rays)
        found = np.zeros(packed.shape, TRANSFER)
        with self._gate as context:
            ray, out = _pointer("BhrRay *", packed), _pointer("BhrTransfer *", found)
            check(lib.bhr_transfer_rays(context, ray, RAY.itemsize, packed.size, out, TRANSFER.itemsize))
        return found

    def trace_path(self, ray: npt.NDArray[np.void] | np.void, capacity: int = 65536) -> npt.NDArray[np.float64]:
        """The curve that a ray follows, at most `capacity` points of x, y, z and t: shape (points, 4)."""
        packed = _rays(ray)
        if packed.size != 1:
            raise ValueError(f"{packed.size} rays instead of one")
        points, count = np.empty((min(capacity, 65536), 4)), ffi.new("uint32_t *")
        with self._gate as context:
            check(
                lib.bhr_trace_path(
                    context, _pointer("BhrRay *", packed), len(points), _pointer("double *", points), count
                )
            )
        return points[: count[0]].copy()

    def world_line(
        self,
        position: VectorLike,
        velocity: VectorLike,
        proper_times: npt.ArrayLike,
        *,
        chart: ChartLike = Chart.STATIC,
        time: float = 0.0,
    ) -> npt.NDArray[np.void]:
        """Where a body in free fall is after each of the proper times, of any sign, order and shape: dtype BODY, of
        that shape. `velocity`, in units of c, is what the observer of the chart's triad measures. A line that ends
        before a time gives its end, which `end` and `proper_time` tell."""
        body = new("BhrBody")
        body.chart = member(Chart, chart, "chart")
        body.position, body.velocity = doubles(position, 3, "position"), doubles(velocity, 3, "velocity")
        body.time = time
        times = np.asarray(proper_times, np.float64, order="C")
        found = np.zeros(times.shape, BODY)
        with self._gate as context:
            begin, out = _pointer("double *", times), _pointer("BhrBody *", found)
            check(lib.bhr_world_line(context, body, begin, times.size, out, BODY.itemsize))
        return found


def _pointer(kind: str, array: npt.NDArray[Any]) -> Any:
    return ffi.cast(kind, array.__array_interface__["data"][0])


def _rays(rays: npt.NDArray[np.void] | np.void) -> npt.NDArray[np.void]:
    """Rays as the library reads them."""
    if isinstance(rays, np.void):
        rays = np.asarray(rays)
    if not isinstance(rays, np.ndarray) or rays.dtype != RAY:
        raise TypeError("rays are a numpy array of the dtype RAY: bhr.rays and Context.camera_rays make one")
    return np.asarray(rays, order="C")
