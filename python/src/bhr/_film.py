# SPDX-License-Identifier: MIT OR Apache-2.0
"""Films of scene files: frames to files, in one process. Knows no scene beyond its text."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable
from pathlib import Path

from ._constants import BackendLike, Format
from ._context import Context


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
