# SPDX-License-Identifier: MIT OR Apache-2.0
"""bhr: physically right pictures of black holes, and the numbers behind them, in numpy arrays.

    import bhr

    with bhr.Context() as ctx:
        ctx.spin = 0.9
        ctx.camera = bhr.Camera.orbit(20.0, 0.0, 0.1)
        ctx.render(1280, 720).save("hole.png")

Units are geometric, G = c = 1: the mass is given in the scene's unit of length, and the lengths of the disk, of volumes
and of hot spots in units of M. Angles are in radians, temperatures in kelvin. The hole is at the origin, its spin axis
along +z.
"""

from . import interop
from ._constants import (
    AdapterFlags,
    Backend,
    Chart,
    ColourMap,
    ColourSpace,
    DiskFlags,
    DiskReference,
    Effects,
    EmissionLaw,
    Eye,
    Fate,
    Flow,
    Format,
    HotSpotFlags,
    MatrixFlags,
    Method,
    Motion,
    OutputKind,
    Preset,
    PresetMatter,
    Projection,
    SkyFlags,
    Status,
    ToneMap,
    Transport,
    View,
    VolumeFlags,
    VolumeResolution,
    VolumeShape,
    WorldLineEnd,
)
from ._context import Context
from ._ffi import ffi as _ffi
from ._film import light_curve, render_film
from ._frame import Frame, load
from ._job import Job
from ._library import Cancelled, DeviceLost, Error, FileError, InvalidArgument, OutOfMemory, lib as _lib
from ._rays import BODY, CROSSING, HIT, PROJECTED, RAY, TRANSFER, rays
from ._scene_text import Pictures
from ._structs import (
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
    adapters,
)

#: The version of the library in this package.
__version__: str = _ffi.string(_lib.bhr_version_string()).decode()

__all__ = [
    "AdapterFlags",
    "AdapterInfo",
    "BODY",
    "Backend",
    "CROSSING",
    "Camera",
    "Cancelled",
    "Chart",
    "ColourMap",
    "ColourSpace",
    "Context",
    "DeviceLost",
    "Disk",
    "DiskFlags",
    "DiskReference",
    "Effects",
    "EmissionLaw",
    "Eye",
    "Error",
    "Fate",
    "FileError",
    "Film",
    "Flow",
    "Format",
    "Frame",
    "FrameStats",
    "HIT",
    "HoleInfo",
    "HotSpot",
    "HotSpotFlags",
    "InvalidArgument",
    "Job",
    "MatrixFlags",
    "Method",
    "Motion",
    "OutOfMemory",
    "OutputKind",
    "Pictures",
    "Preset",
    "PresetMatter",
    "Projection",
    "PROJECTED",
    "ProjectedPoint",
    "Quality",
    "RAY",
    "Region",
    "Sky",
    "SkyFlags",
    "Status",
    "TRANSFER",
    "ToneMap",
    "Transport",
    "View",
    "Volume",
    "VolumeFlags",
    "VolumeResolution",
    "VolumeShape",
    "WorldLineEnd",
    "adapters",
    "interop",
    "light_curve",
    "load",
    "rays",
    "render_film",
]
