# SPDX-License-Identifier: MIT OR Apache-2.0
"""Frames: pixels in numpy arrays, which the library writes and reads in place."""

from __future__ import annotations

import operator
import os
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from ._constants import ColourSpace, ColourSpaceLike, Format, FormatLike, OutputKind, View
from ._ffi import ffi
from ._library import check, lib
from ._names import member
from ._struct import new

_DTYPES: dict[Format, type[np.generic]] = {
    Format.RGBA8_SRGB: np.uint8,
    Format.BGRA8_SRGB: np.uint8,
    Format.RGBA16F: np.float16,
    Format.RGBA32F: np.float32,
    Format.R32F: np.float32,
    Format.RGB10A2_PQ: np.uint32,
    Format.RGB10A2_HLG: np.uint32,
}
#: Formats whose pixels are one number each.
_FLAT = (Format.R32F, Format.RGB10A2_PQ, Format.RGB10A2_HLG)


class Frame:
    """A picture, or the values of a view. `array` is its memory; np.asarray(frame) is the same array."""

    # A slip in an attribute's name is an AttributeError.
    __slots__ = ("__weakref__", "array", "colour_space", "format", "transparent")

    array: npt.NDArray[Any]
    format: Format
    #: Colours are premultiplied by alpha: a rendered frame's, where `transparent` was asked for. PNG files have
    #: straight colours, which `save` and `to_png` then make. False for a new frame.
    transparent: bool
    #: The primaries of linear light. Rendered frames have REC709; `convert` makes others.
    colour_space: ColourSpace

    def __init__(self, array: npt.NDArray[Any], format: FormatLike | None = None) -> None:
        """Wraps an array, without a copy: uint8 (RGBA8_SRGB, or BGRA8_SRGB if `format` says so), float16 or float32 of
        shape (height, width, 4), or of shape (height, width) float32, or uint32 (RGB10A2_PQ, or RGB10A2_HLG if `format`
        says so). Rows may have any stride; pixels are packed."""
        self.format = _format(array, format)
        self.array = array
        self.transparent = False
        self.colour_space = ColourSpace.REC709
        self.image()

    @classmethod
    def empty(cls, width: int, height: int, format: FormatLike = Format.RGBA8_SRGB) -> Frame:
        """A frame with memory of its own, not yet filled."""
        format = member(Format, format, "format")
        shape = (height, width) if format in _FLAT else (height, width, 4)
        return cls(np.empty(shape, _DTYPES[format]), format)

    @property
    def width(self) -> int:
        return int(self.array.shape[1])

    @property
    def height(self) -> int:
        return int(self.array.shape[0])

    def image(self, writable: bool = False, flags: int = 0) -> Any:
        """The C struct that describes the array, which must outlive it."""
        array = self.array
        if writable and not array.flags.writeable:
            raise ValueError("the array is read-only")
        image = new("BhrImage")
        image.format, image.width, image.height, image.flags = self.format, self.width, self.height, flags
        image.colour_space = self.colour_space
        pixel = array.itemsize * (4 if array.ndim == 3 else 1)
        row, between = pixel * self.width, array.strides[0]
        packed = self.width <= 1 or array.strides[1] == pixel
        packed = packed and (array.ndim == 2 or array.strides[2] == array.itemsize)
        if array.size and not packed:
            raise ValueError(f"the pixels of a row are not packed: strides {array.strides}")
        if self.height > 1:
            if abs(between) < row:
                raise ValueError(f"rows of {row} bytes overlap: strides {array.strides}")
            image.row_stride = between
            image.byte_size = (self.height - 1) * abs(between) + row
        else:
            image.byte_size = row
        image.pixels = ffi.cast("void *", array.__array_interface__["data"][0])
        return image

    def convert(self, colour_space: ColourSpaceLike) -> None:
        """Converts linear light (RGBA16F or RGBA32F) in place to other primaries: "ACESCG", "REC2020", "P3_D65"."""
        image = self.image(writable=True)
        check(lib.bhr_image_convert(image, member(ColourSpace, colour_space, "colour_space")))
        self.colour_space = ColourSpace(image.colour_space)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes 8-bit frames to .png or .ppm, those of high dynamic range to .png, float frames to .exr."""
        flags = lib.BHR_IMAGE_TRANSPARENT if self.transparent else 0
        check(lib.bhr_image_save(self.image(flags=flags), _path(path)))

    def to_png(self) -> bytes:
        """The PNG file of an 8-bit frame, or of one of high dynamic range."""
        with tempfile.TemporaryDirectory(prefix="bhr-") as folder:
            file = Path(folder, "frame.png")
            self.save(file)
            return file.read_bytes()

    def _repr_png_(self) -> bytes | None:
        return self.to_png() if self.array.dtype == np.uint8 else None

    def __array__(self, dtype: npt.DTypeLike | None = None, copy: bool | None = None) -> npt.NDArray[Any]:
        if dtype is not None and np.dtype(dtype) != self.array.dtype:
            if copy is False:
                raise ValueError(f"a frame of {self.array.dtype} becomes {np.dtype(dtype)} only by a copy")
            return self.array.astype(dtype)
        return self.array.copy() if copy else self.array

    def __dlpack__(self, **options: Any) -> Any:
        return self.array.__dlpack__(**options)

    def __dlpack_device__(self) -> tuple[int, int]:
        """The CPU's memory, always."""
        kind, index = self.array.__dlpack_device__()
        return int(kind), int(index)

    def __repr__(self) -> str:
        return f"<bhr.Frame {self.width} x {self.height}, {self.format.name}>"


def _format(array: Any, format: FormatLike | None) -> Format:
    """The format of an array, which `format` may choose where there are two."""
    if not isinstance(array, np.ndarray):
        advice = "np.asarray makes one of most memory"
        if isinstance(array, (str, os.PathLike)):
            advice = "bhr.load reads files, and Frame.save writes them"
        raise TypeError(f"a frame is a numpy array, not {type(array).__name__}; {advice}")
    given = None if format is None else member(Format, format, "format")
    if not array.dtype.isnative:
        raise TypeError("the array's bytes are in the order of another machine")
    for known, dtype in _DTYPES.items():
        shaped = array.ndim == 2 if known in _FLAT else array.ndim == 3 and array.shape[2] == 4
        if shaped and array.dtype == dtype and given in (None, known):
            return known
    wanted = "" if given is None else f" for {given.name}"
    raise TypeError(
        f"an array of {array.dtype} with shape {array.shape} does not do{wanted}: uint8, float16 or float32 with shape"
        " (height, width, 4), or with shape (height, width) float32 for the values of a view, uint32 for RGB10A2"
    )


def load(path: str | os.PathLike[str]) -> Frame:
    """Reads a PNG, EXR, PNM or KTX2 file: RGBA8_SRGB from files of 8 bits, else RGBA32F."""
    image = new("BhrImage")
    check(lib.bhr_image_load(_path(path), image))
    format = Format(image.format)
    # The array keeps the buffer, which keeps the pixels until nobody has the array any more.
    pixels = ffi.gc(ffi.cast("char *", image.pixels), lambda _: lib.bhr_image_release(image), image.byte_size)
    array = np.frombuffer(ffi.buffer(pixels, image.byte_size), _DTYPES[format])
    return Frame(array.reshape(image.height, image.width, 4), format)


def _path(path: str | os.PathLike[str]) -> bytes:
    name = os.fsencode(path)
    if b"\0" in name:
        raise ValueError("the path contains a null character")
    return name


def output_of(output: Any) -> tuple[OutputKind, int]:
    """The kind of an output, and the number of its crossing or its view."""
    named, index = output if isinstance(output, tuple) else (output, 0)
    kind = member(OutputKind, named, "output")
    return kind, member(View, index, "view") if kind == OutputKind.VIEW else operator.index(index)


def target_of(
    width: int | None,
    height: int | None,
    format: FormatLike | None,
    transparent: bool,
    out: Frame | npt.NDArray[Any] | None,
) -> tuple[Frame, Any]:
    """The frame to render into, and the struct that describes it."""
    format = None if format is None else member(Format, format, "format")
    if out is None:
        if width is None or height is None:
            raise TypeError("a frame needs width and height, or an array in `out`")
        frame = Frame.empty(operator.index(width), operator.index(height), format or Format.RGBA8_SRGB)
    else:
        frame = out if isinstance(out, Frame) else Frame(out, format)
        if format is not None and format != frame.format:
            raise ValueError(f"out has the format {frame.format.name}, not {format.name}")
        if width not in (None, frame.width) or height not in (None, frame.height):
            raise ValueError(f"out has {frame.width} x {frame.height} pixels, not {width} x {height}")
    image = frame.image(writable=True, flags=lib.BHR_IMAGE_TRANSPARENT if transparent else 0)
    frame.transparent = transparent
    return frame, image
