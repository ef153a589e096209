# SPDX-License-Identifier: MIT OR Apache-2.0
"""The part of a context that reads and writes its scene as text, sets what moves in it, and takes the sky's map and the
film's LUT."""

from __future__ import annotations

import os
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from ._constants import Status
from ._ffi import ffi
from ._frame import Frame, _path
from ._gate import Gate
from ._library import check, lib


class Pictures(NamedTuple):
    """The pictures that a scene's text asks for: picture n, from 0, shows the scene at n / rate seconds."""

    width: int
    height: int
    #: 1 for a scene that does not move.
    count: int  # type: ignore[assignment] # tuple's method of this name is not needed
    #: Pictures a second.
    rate: float


class SceneText:
    """The methods of Context for scenes as text."""

    __slots__ = ()

    _gate: Gate
    _targets: dict[str, Any]

    def _call(self, function: Any, value: Any) -> None:
        with self._gate as context:
            check(function(context, value))

    def load(self, path: str | os.PathLike[str]) -> None:
        """Sets the whole scene from a file, as `save` writes one or as docs/scenes.md describes it. After an error,
        which has line and column, the scene is as it was."""
        given = _path(path)
        with self._gate as context:
            check(lib.bhr_scene_load_file(context, given))
            self._targets.pop("sky", None)

    def load_text(self, text: str) -> None:
        """Sets the whole scene from text, as `load` does from a file. Its paths are relative to the current folder."""
        given = text.encode()
        with self._gate as context:
            check(lib.bhr_scene_load(context, given, len(given)))
            self._targets.pop("sky", None)

    def at(self, seconds: float) -> None:
        """Sets what moves in the scene that was loaded last to a time, in seconds of the film."""
        self._call(lib.bhr_scene_at, seconds)

    @property
    def pictures(self) -> Pictures:
        """The pictures that the scene that was loaded last asks for."""
        width, height, count = (ffi.new("uint32_t *") for _ in range(3))
        rate = ffi.new("double *")
        with self._gate as context:
            check(lib.bhr_scene_pictures(context, width, height, count, rate))
        return Pictures(width[0], height[0], count[0], rate[0])

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the scene as it is set, with what moves in it, to a file that `load` reads back bit by bit."""
        self._call(lib.bhr_scene_save_file, _path(path))

    def save_text(self) -> str:
        """The text that `save` writes; its paths are absolute."""
        size = ffi.new("size_t *")
        with self._gate as context:
            while True:
                check(lib.bhr_scene_save(context, ffi.NULL, 0, size))
                text = ffi.new("char[]", size[0] + 1)
                status = lib.bhr_scene_save(context, text, len(text), size)
                # Another thread may have set a scene in between whose text is longer: again.
                if status != Status.INVALID_ARGUMENT:
                    check(status)
                    saved: str = ffi.string(text).decode()
                    return saved

    def set_sky_map(self, picture: str | os.PathLike[str] | Frame | npt.NDArray[Any] | None) -> None:
        """Gives SkyFlags.MAP its all-round picture, which is copied, or read from a file as `load` does; None removes
        it. The north pole is at the top, right ascension 0 in the middle, and it grows to the left. A file's path is
        part of what `save` writes."""
        if isinstance(picture, (str, os.PathLike)):
            self._call(lib.bhr_set_sky_map_file, _path(picture))
            self._targets.pop("sky", None)
            return
        if isinstance(picture, np.ndarray):
            frame: Frame | None = Frame(picture)
        elif picture is None or isinstance(picture, Frame):
            frame = picture
        else:
            raise TypeError(f"a sky map is a path, a bhr.Frame or a numpy array, not {type(picture).__name__}")
        self._call(lib.bhr_set_sky_map, ffi.NULL if frame is None else frame.image())
        self._targets.pop("sky", None)

    def save_sky_map(self, path: str | os.PathLike[str]) -> None:
        """Writes the map that `set_sky_map` gave to a .ktx2 file in blocks of BC6H, which `set_sky_map` and GPUs take
        as they are: a quarter of the memory of texels. docs/maps.md says how exact they are."""
        self._call(lib.bhr_save_sky_map, _path(path))

    def set_film_lut(self, lut: str | os.PathLike[str] | npt.NDArray[Any] | None) -> None:
        """Gives the film a LUT, a table of colours that take the places of the picture's, which is copied: a .cube
        file, whose path is part of what `save` writes, or a numpy array of shape (side, side, side, 3) with side 2 to
        65, whose element [b, g, r] is what the sRGB-encoded colour (r, g, b) / (side - 1) becomes; None takes it
        away."""
        if isinstance(lut, (str, os.PathLike)):
            self._call(lib.bhr_set_film_lut_file, _path(lut))
            return
        nodes: npt.NDArray[np.float32] = np.zeros(0, np.float32)
        side = 0
        if isinstance(lut, np.ndarray):
            nodes, side = np.ascontiguousarray(lut, np.float32), len(lut) if lut.ndim > 0 else 0
            if nodes.shape != (side, side, side, 3):
                raise ValueError(f"a LUT has the shape (side, side, side, 3), not {lut.shape}")
        elif lut is not None:
            raise TypeError(f"a LUT is a path or a numpy array, not {type(lut).__name__}")
        with self._gate as context:
            check(lib.bhr_set_film_lut(context, ffi.from_buffer("float[]", nodes), nodes.size, side))
