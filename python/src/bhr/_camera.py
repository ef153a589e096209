# SPDX-License-Identifier: MIT OR Apache-2.0
"""The methods of Camera, whose fields are generated (_fields.py)."""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from ._constants import MatrixFlags, Status
from ._ffi import ffi
from ._library import check, error, lib
from ._names import flags as flags_of
from ._struct import Struct, VectorLike, doubles

_Self = TypeVar("_Self", bound="CameraMethods")

#: The largest elevation of an orbit, with room for the rounding of single precision.
_POLE = 0.5 * np.pi + 1e-6


class CameraMethods(Struct):
    """Cameras that look at something, and those of rasterisers."""

    @classmethod
    def orbit(cls: type[_Self], distance: float, azimuth: float, elevation: float, **fields: Any) -> _Self:
        """A camera that looks at the hole, at this distance from it, azimuth from +x towards +y, and elevation from the
        xy plane towards +z, -pi/2 .. pi/2. Angles are in radians: math.radians(20) makes them of degrees."""
        if abs(elevation) > _POLE:
            raise error(
                Status.INVALID_ARGUMENT,
                f"elevation is {elevation:g}, outside -pi/2 .. pi/2; angles are in radians: for degrees,"
                f" math.radians({elevation:g})",
            )
        struct = cls(**fields).to_c()
        check(lib.bhr_camera_orbit(struct, distance, azimuth, elevation))
        return cls.from_c(struct)

    @classmethod
    def look_at(
        cls: type[_Self],
        position: VectorLike,
        target: VectorLike = (0.0, 0.0, 0.0),
        up: VectorLike = (0.0, 0.0, 1.0),
        **fields: Any,
    ) -> _Self:
        """A camera at a position that looks towards a target, by default the hole."""
        struct = cls(**fields).to_c()
        vectors = doubles(position, 3, "position"), doubles(target, 3, "target"), doubles(up, 3, "up")
        check(lib.bhr_camera_look_at(struct, *vectors))
        return cls.from_c(struct)

    @classmethod
    def from_matrices(
        cls: type[_Self],
        view: npt.ArrayLike,
        projection: npt.ArrayLike,
        flags: int | str = MatrixFlags(0),
        **fields: Any,
    ) -> _Self:
        """A camera from the matrices of a rasteriser, 4 x 4, as they multiply column vectors."""
        struct = cls(**fields).to_c()
        matrices = [doubles(np.asarray(m, float).ravel(), 16, "a matrix") for m in (view, projection)]
        layout = flags_of(MatrixFlags, flags, "flags") | MatrixFlags.ROW_MAJOR
        check(lib.bhr_camera_from_matrices(struct, *matrices, layout))
        return cls.from_c(struct)

    def through_lens(self: _Self, aperture: float, focus: float, aspect: float, index: int, count: int) -> _Self:
        """For depth of field: the camera moved to place index (from 0) of count on a round thin lens around it. The
        lens has the diameter aperture, and what lies at the distance focus ahead keeps its place in the picture. aspect
        is the frame's width over its height. The frames from all places add up to the lens's picture
        (Context.accumulate)."""
        struct = self.to_c()
        check(lib.bhr_camera_through_lens(struct, aperture, focus, aspect, index, count))
        return type(self).from_c(struct)

    def matrices(
        self, width: int, height: int, near_z: float, far_z: float = np.inf, flags: int | str = MatrixFlags(0)
    ) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        """View and projection, 4 x 4, as they multiply column vectors, for frames of this size."""
        view, projection = np.zeros((4, 4)), np.zeros((4, 4))
        outs = [ffi.cast("double *", m.ctypes.data) for m in (view, projection)]
        layout = flags_of(MatrixFlags, flags, "flags") | MatrixFlags.ROW_MAJOR
        check(lib.bhr_camera_matrices(self.to_c(), width, height, near_z, far_z, layout, *outs))
        return view, projection
