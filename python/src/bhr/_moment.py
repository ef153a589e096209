# SPDX-License-Identifier: MIT OR Apache-2.0
"""The part of a context that says when matter is seen, and which relativistic effects colour its light. Knows no
frames."""

from __future__ import annotations

from ._constants import Effects
from ._ffi import ffi
from ._gate import Gate
from ._library import check, lib
from ._names import flags


class Moment:
    """The scene's time, its shutter, and its effects, as methods of Context."""

    __slots__ = ()

    _gate: Gate

    @property
    def effects(self) -> Effects:
        """The relativistic effects that colour the light. Default: all."""
        effects = ffi.new("uint32_t *")
        with self._gate as context:
            check(lib.bhr_get_effects(context, effects))
        return Effects(effects[0])

    @effects.setter
    def effects(self, effects: Effects | str) -> None:
        given = flags(Effects, effects, "effects") & Effects.ALL
        with self._gate as context:
            check(lib.bhr_set_effects(context, given))

    def effect_strength(self, effect: Effects | str) -> float:
        """How strongly one effect shows, 0 to 1; 1 is physics (bhr_get_effect_strength)."""
        strength = ffi.new("double *")
        with self._gate as context:
            check(lib.bhr_get_effect_strength(context, flags(Effects, effect, "effect"), strength))
        return float(strength[0])

    def set_effect_strength(self, effects: Effects | str, strength: float) -> None:
        """Sets how strongly the Doppler shift, gravity's shift or beaming show, 0 to 1 (bhr_set_effect_strength)."""
        with self._gate as context:
            check(lib.bhr_set_effect_strength(context, flags(Effects, effects, "effects"), strength))

    @property
    def time(self) -> float:
        """The scene's time in scene lengths, which turns the disk. Default 0."""
        time = ffi.new("double *")
        with self._gate as context:
            check(lib.bhr_get_time(context, time))
        return float(time[0])

    @time.setter
    def time(self, time: float) -> None:
        with self._gate as context:
            check(lib.bhr_set_time(context, time))

    @property
    def shutter(self) -> float:
        """How long the shutter is open, in scene lengths of time: each sample of a pixel sees matter at a moment of its
        own. Default 0: one moment."""
        duration = ffi.new("double *")
        with self._gate as context:
            check(lib.bhr_get_shutter(context, duration))
        return float(duration[0])

    @shutter.setter
    def shutter(self, shutter: float) -> None:
        with self._gate as context:
            check(lib.bhr_set_shutter(context, shutter))
