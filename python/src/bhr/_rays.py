# SPDX-License-Identifier: MIT OR Apache-2.0
"""Rays, their ends and bodies as structured arrays with the layouts of BhrRay, BhrHit and BhrBody, which the library
reads and writes in place."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from ._ffi import ffi


def dtype_of(kind: Any) -> np.dtype[Any]:
    """numpy's type for a C type."""
    if kind.kind == "array":
        return np.dtype((dtype_of(kind.item), (kind.length,)))
    if kind.kind == "struct":
        fields = [(name, dtype_of(field.type), field.offset) for name, field in kind.fields]
        names, formats, offsets = zip(*fields)
        return np.dtype({"names": names, "formats": formats, "offsets": offsets, "itemsize": ffi.sizeof(kind)})
    return np.dtype({"double": np.float64, "int32_t": np.int32, "uint32_t": np.uint32}[kind.cname])


#: A ray: `position`, `direction` (the way that the observer looks) and `frequency_ratio` (1 for an observer at rest).
RAY: np.dtype[Any] = dtype_of(ffi.typeof("BhrRay"))

#: A crossing of the equatorial plane: `radius`, `azimuth`, `redshift`, `delay`.
CROSSING: np.dtype[Any] = dtype_of(ffi.typeof("BhrCrossing"))

#: The end of a ray: `fate` (a Fate), `sky_direction`, `sky_redshift`, `swept_angle`, `steps`, and its crossings of the
#: equatorial plane, of which `crossing_count` are there.
HIT: np.dtype[Any] = dtype_of(ffi.typeof("BhrHit"))

#: The matter with depth along a ray: `fate`, `intensity`, `optical_depth` (NaN unless escaped) and `light`.
TRANSFER: np.dtype[Any] = dtype_of(ffi.typeof("BhrTransfer"))

#: A body in free fall: `position`, `velocity` and `time` in a `chart` (a Chart), `proper_time` since the start of its
#: world line, and whether that has come to an `end` (a WorldLineEnd).
BODY: np.dtype[Any] = dtype_of(ffi.typeof("BhrBody"))

#: The image of a point: the fields of ProjectedPoint.
PROJECTED: np.dtype[Any] = dtype_of(ffi.typeof("BhrProjectedPoint"))


def rays(
    position: npt.ArrayLike, direction: npt.ArrayLike, frequency_ratio: npt.ArrayLike = 1.0
) -> npt.NDArray[np.void]:
    """An array of rays, of the shape that numpy's broadcasting gives positions and directions (each with a last axis of
    3) and frequency ratios."""
    at, along = np.asarray(position, np.float64), np.asarray(direction, np.float64)
    for name, vectors in ("position", at), ("direction", along):
        if vectors.ndim == 0 or vectors.shape[-1] != 3:
            raise ValueError(f"{name} has the shape {vectors.shape}, whose last axis is not 3")
    ratio = np.asarray(frequency_ratio, np.float64)
    made = np.empty(np.broadcast_shapes(at.shape[:-1], along.shape[:-1], ratio.shape), RAY)
    made["position"], made["direction"], made["frequency_ratio"] = at, along, ratio
    return made
