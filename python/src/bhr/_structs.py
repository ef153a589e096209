# SPDX-License-Identifier: MIT OR Apache-2.0
"""The structs of bhr.h as frozen dataclasses: a changed copy is made by `replace`, and takes effect when it is set.
Their fields are generated (_fields.py)."""

from __future__ import annotations

from ._ffi import ffi
from ._fields import (
    AdapterInfo,
    Camera,
    Disk,
    Film,
    FrameStats,
    HoleInfo,
    HotSpot,
    ProjectedPoint,
    Quality,
    Region,
    Sky,
    Volume,
)
from ._library import begin, check, lib
from ._struct import new

__all__ = [
    "AdapterInfo",
    "Camera",
    "Disk",
    "Film",
    "FrameStats",
    "HoleInfo",
    "HotSpot",
    "ProjectedPoint",
    "Quality",
    "Region",
    "Sky",
    "Volume",
    "adapters",
]


def adapters() -> list[AdapterInfo]:
    """The adapters of this machine; the position in the list is Context's adapter_index. The CPU tracer is the last."""
    begin()
    count = ffi.new("uint32_t *")
    check(lib.bhr_adapter_count(count))
    found = []
    for index in range(count[0]):
        info = new("BhrAdapterInfo")
        check(lib.bhr_adapter_info(index, info))
        found.append(AdapterInfo.from_c(info))
    return found
