# SPDX-License-Identifier: MIT OR Apache-2.0
"""Films of scene files, in one process: frames to files, and the light of each. Knows no scene beyond its text."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from ._constants import BackendLike, Format, Projection, View
from ._context import Context
from ._fields import Camera


def render_film(
    scene: str | os.PathLike[str],
    out: str | os.PathLike[str],
    frames: Iterable[int] | None = None,
    *,
    backend: BackendLike = "auto",
    size: tuple[int, int] | None = None,
    again: bool = False,
    progress: Callable[[int, Path], object] | None = None,
) -> list[Path]:
    """Renders frames of a scene file to .png or .exr files (16-bit floats), and returns their paths. The last run of #
    in the name `out` becomes the frame's number. `frames`: their numbers, from 0; None: all that the scene asks for.
    A file is there whole or not at all; one that is there is passed over, unless `again` is set. `progress` is told
    each frame's number and path when its file is there. The program `bhr render` is faster, and shares frames."""
    pattern = os.fspath(out)
    folder, name = os.path.split(pattern)
    marks = list(re.finditer("#+", name))
    format = Format.RGBA16F if name.lower().endswith(".exr") else Format.RGBA8_SRGB
    done = []
    with Context(backend) as ctx:
        ctx.load(scene)
        asked = ctx.pictures
        width, height = size or (asked.width, asked.height)
        numbers = list(range(asked.count) if frames is None else frames)
        if len(numbers) > 1 and not marks:
            raise ValueError(f"{pattern!r} has no # where the number of several frames goes")
        for number in numbers:
            path = Path(folder, name)
            if marks:
                begin, end = marks[-1].span()
                path = Path(folder, f"{name[:begin]}{number:0{end - begin}d}{name[end:]}")
            if again or not path.is_file():
                ctx.at(number / asked.rate)
                ctx.render(width, height, format=format).save(path)
            done.append(path)
            if progress is not None:
                progress(number, path)
    return done


def _solid_angles(camera: Camera, width: int, height: int) -> npt.NDArray[np.float64]:
    """The solid angle of each pixel of a picture on a plane, in steradians: its area on the plane at distance 1, by the
    cube of the cosine of its angle to the plane's normal."""
    if camera.projection != Projection.PERSPECTIVE:
        raise ValueError(f"the camera's projection is {camera.projection.name}; a light curve needs PERSPECTIVE")
    side = 2.0 * np.tan(0.5 * camera.fov_y) / height
    x = (np.arange(width) + 0.5 - 0.5 * width) * side
    y = (np.arange(height) + 0.5 - 0.5 * height) * side
    return np.asarray(side**2 * (1.0 + x[np.newaxis, :] ** 2 + y[:, np.newaxis] ** 2) ** -1.5)


def light_curve(
    scene: str | os.PathLike[str],
    times: npt.ArrayLike,
    *,
    backend: BackendLike = "auto",
    size: tuple[int, int] | None = None,
    progress: Callable[[int, Any], object] | None = None,
) -> npt.NDArray[np.float64]:
    """The light of a scene file at each of `times`, which are the film's seconds, as `Context.at` takes them: the sum
    of the frame's linear light, each pixel times its solid angle in steradians. Its shape is (times, 3), red, green and
    blue by Rec. 709, before all film; of a scene whose view is not LIGHT it is (times,), the view's values. Where a
    view has no value (NaN), none is added. `size` is that of the frames, instead of the scene's; `progress` is told
    each time's number and sum. ValueError: the camera's projection is another than PERSPECTIVE."""
    sums = []
    with Context(backend) as ctx:
        ctx.load(scene)
        asked = ctx.pictures
        width, height = size or (asked.width, asked.height)
        for number, time in enumerate(np.asarray(times, dtype=np.float64).ravel().tolist()):
            ctx.at(time)
            is_light = ctx.view == View.LIGHT
            frame = ctx.render(width, height, format=Format.RGBA32F if is_light else Format.R32F).array
            light = np.asarray(frame, dtype=np.float64).reshape(height, width, -1)[:, :, : 3 if is_light else 1]
            angles = _solid_angles(ctx.camera, width, height)
            sums.append(np.nansum(light * angles[:, :, np.newaxis], axis=(0, 1)))
            if progress is not None:
                progress(number, sums[-1])
    values = np.array(sums, dtype=np.float64)
    return values[:, 0] if values.ndim == 2 and values.shape[1] == 1 else values
