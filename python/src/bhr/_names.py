# SPDX-License-Identifier: MIT OR Apache-2.0
"""Members of enumerations by their names, as text: "cinematic" where Preset.CINEMATIC is meant. The types are for
checkers and editors; `member` is what the library's own code reads arguments with."""

from __future__ import annotations

import enum
from typing import Any, Generic, TypeVar

from ._constants import Status
from ._library import error

_Member = TypeVar("_Member")
_Name = TypeVar("_Name")
_Enum = TypeVar("_Enum", bound=enum.IntEnum)
_Flag = TypeVar("_Flag", bound=enum.IntFlag)


class Named(Generic[_Member, _Name]):
    """For type checkers: a field that holds a member, and that takes its name as well. No such object exists."""

    def __get__(self, instance: object, owner: object) -> _Member:
        raise NotImplementedError

    def __set__(self, instance: object, value: _Member | _Name) -> None:
        raise NotImplementedError


def named(default: Any) -> Any:
    """The default of a field that is annotated as Named."""
    return default


def _wrong(kind: type[enum.Enum], value: object, what: str) -> Exception:
    names = ", ".join(repr(name.lower()) for name in kind.__members__)
    message = f"{what} is {value!r}; the names of bhr.{kind.__name__} are {names}"
    if issubclass(kind, enum.Flag):
        message += ", several joined by |"
    if isinstance(value, (str, int)) and not isinstance(value, enum.Enum):
        return error(Status.INVALID_ARGUMENT, message)
    return TypeError(message)


def _key(name: str) -> str:
    return name.strip().upper().replace("-", "_").replace(" ", "_")


def member(kind: type[_Enum], value: Any, what: str) -> _Enum:
    """The member of an enumeration that is meant by a member, by its number, or by its name in any case. `what` is the
    argument's name, for messages."""
    if isinstance(value, str):
        found = kind.__members__.get(_key(value))
        if found is not None:
            return found
    elif not isinstance(value, enum.Enum) or isinstance(value, kind):
        try:
            return kind(value)
        except ValueError:
            pass
    raise _wrong(kind, value, what)


def flags(kind: type[_Flag], value: Any, what: str) -> _Flag:
    """The flags that are meant by members, by their number, or by names that are joined by |; "" means none."""
    if isinstance(value, str):
        made = kind(0)
        for name in value.split("|") if value.strip() else []:
            found = kind.__members__.get(_key(name))
            if found is None:
                raise _wrong(kind, value, what)
            made |= found
        return made
    if not isinstance(value, enum.Enum) or isinstance(value, kind):
        try:
            return kind(value)
        except ValueError:
            pass
    raise _wrong(kind, value, what)
