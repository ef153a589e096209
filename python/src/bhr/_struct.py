# SPDX-License-Identifier: MIT OR Apache-2.0
"""What the dataclasses of _fields.py have in common: their values are converted as a struct of bhr.h has them, and go
into one and come out of one."""

from __future__ import annotations

import dataclasses
import enum
import operator
from collections.abc import Iterable, Sequence
from typing import Any, ClassVar, TypeVar, Union

import numpy as np
import numpy.typing as npt

from ._ffi import ffi
from ._names import flags as flags_of, member
from ._rays import dtype_of

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
VectorLike = Union[Sequence[float], npt.NDArray[Any]]

_Self = TypeVar("_Self", bound="Struct")


def doubles(values: VectorLike, count: int, name: str) -> tuple[float, ...]:
    """The numbers as floats; cffi would take too few of them, and leave the rest 0."""
    numbers = tuple(float(value) for value in values)
    if len(numbers) != count:
        raise ValueError(f"{name} has {len(numbers)} numbers instead of {count}")
    return numbers


def _constant(kind: type[enum.IntEnum] | type[enum.IntFlag], value: object, name: str) -> enum.IntEnum | enum.IntFlag:
    return flags_of(kind, value, name) if issubclass(kind, enum.IntFlag) else member(kind, value, name)


def new(name: str) -> Any:
    """A C struct, cleared but for its size."""
    struct = ffi.new(f"{name} *")
    struct.struct_size = ffi.sizeof(name)
    return struct


class Struct:
    """A dataclass whose fields are named as those of a C struct, and converted as that has them."""

    c_name: ClassVar[str]
    #: Fields that are enumerations.
    c_enums: ClassVar[dict[str, type[enum.IntEnum] | type[enum.IntFlag]]] = {}

    def __post_init__(self) -> None:
        types = dict(ffi.typeof(self.c_name).fields)
        for name in _names(type(self)):
            value = getattr(self, name)
            kind = types[name].type
            if name in self.c_enums:
                value = _constant(self.c_enums[name], value, name)
            elif kind.kind == "array" and kind.item.cname == "double":
                value = doubles(value, kind.length, name)
            elif kind.cname == "double":
                value = float(value)
            elif kind.kind == "primitive":
                value = operator.index(value)
            object.__setattr__(self, name, value)

    def replace(self: _Self, **changes: Any) -> _Self:
        """A copy with other values in these fields."""
        return dataclasses.replace(self, **changes)  # type: ignore[type-var]

    @classmethod
    def c_of(cls, value: object, name: str, or_none: bool = False) -> Any:
        """The C struct of an argument, which `name` is for messages; NULL of None where None is allowed."""
        if or_none and value is None:
            return ffi.NULL
        if not isinstance(value, cls):
            wanted = f"bhr.{cls.__name__}" + (" or None" if or_none else "")
            raise TypeError(f"{name} is a {wanted}, not {type(value).__name__}")
        return value.to_c()

    @classmethod
    def array_of(cls, values: object, name: str) -> Any:
        """The C array of an argument that is a sequence of these structs."""
        if isinstance(values, Struct) or not isinstance(values, Iterable):
            raise TypeError(f"{name} are a list of bhr.{cls.__name__}, not {type(values).__name__}")
        return ffi.new(f"{cls.c_name}[]", [cls.c_of(value, f"each of {name}")[0] for value in values])

    def to_c(self) -> Any:
        struct = new(self.c_name)
        for name in _names(type(self)):
            setattr(struct, name, getattr(self, name))
        return struct

    @classmethod
    def from_c(cls: type[_Self], struct: Any) -> _Self:
        types = dict(ffi.typeof(cls.c_name).fields)
        values = {}
        for name in _names(cls):
            value, kind = getattr(struct, name), types[name].type
            if kind.kind == "array":
                text = kind.item.cname == "char"
                value = ffi.string(value).decode("utf-8", "replace") if text else tuple(value)
            elif kind.kind == "struct":
                value = np.frombuffer(ffi.buffer(ffi.addressof(value)), dtype_of(kind))[0].copy()
            values[name] = value
        return cls(**values)


def _names(cls: type[Struct]) -> list[str]:
    return [field.name for field in dataclasses.fields(cls)]  # type: ignore[arg-type]
