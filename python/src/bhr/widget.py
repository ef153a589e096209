# SPDX-License-Identifier: MIT OR Apache-2.0
"""Black holes to turn in notebooks: Jupyter, and all else that shows widgets of anywidget.

    from bhr.widget import Hole

    hole = Hole(spin=0.9, elevation="10 deg")
    hole

The page traces by itself, with WebGPU or on its processor: no frame goes through the kernel. Needs anywidget
(pip install bhr[widget]), and a wheel with the web module. This module is not imported by bhr itself.
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import Enum
from typing import Any

import numpy as np

from . import _web

try:
    import anywidget
    import traitlets
except ImportError as error:
    raise ImportError("bhr.widget needs anywidget: pip install 'bhr[widget]'") from error

__all__ = ["Hole"]


def _plain(value: Any) -> Any:
    """A value of a scene as JSON has it: constants are words, and arrays lists."""
    if isinstance(value, Enum):
        return str(value.name).lower()
    if isinstance(value, Mapping):
        return {str(name): _plain(part) for name, part in value.items()}
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    if isinstance(value, (list, tuple)):
        return [_plain(part) for part in value]
    return value


class _Word(traitlets.Unicode):  # type: ignore[type-arg, unused-ignore]
    """A word of a scene, or the constant of that name."""

    def validate(self, obj: Any, value: Any) -> Any:
        return super().validate(obj, _plain(value).lower() if isinstance(value, (str, Enum)) else value)


class _Scene(traitlets.Union):
    """A scene: a dict under the names of scene files, or a link."""

    def validate(self, obj: Any, value: Any) -> Any:
        return super().validate(obj, _plain(value))


def _number(**more: Any) -> Any:
    return traitlets.Float(None, allow_none=True, **more).tag(sync=True)


def _angle(**more: Any) -> Any:
    either = [traitlets.Float(allow_none=True), traitlets.Unicode()]
    return traitlets.Union(either, default_value=None, allow_none=True, **more).tag(sync=True)


def _word(text: str) -> Any:
    return _Word(None, allow_none=True, help=text).tag(sync=True)


class Hole(anywidget.AnyWidget):
    """A black hole in a notebook, which readers turn by dragging, by pinching and by keys.

    Each trait may be set, and observed: where it is turned in the notebook, `scene`, `distance`, `azimuth` and
    `elevation` follow. None leaves a value as it is in a new scene. The size is that of `layout`.
    """

    _esm = _web.script()

    scene = _Scene(
        [traitlets.Dict(), traitlets.Unicode()],
        default_value={},
        help="All of the scene: a dict under the names of scene files, such as {'hole': {'spin': 0.9}}, or a link, "
        "'v=1&hole.spin=0.9'. Follows in the kind that was set.",
    ).tag(sync=True)
    spin = _number(help="a / M, in [-0.9999, 0.9999].")
    distance = _number(help="Of the camera from the hole, in lengths of the scene: M, as long as the mass is 1.")
    azimuth = _angle(help="Of the camera, from +x towards +y: radians, or text such as '30 deg'.")
    elevation = _angle(help="Of the camera above the equatorial plane: radians, or text such as '30 deg'.")
    fov = _angle(help="Height of the view: radians, or text such as '45 deg'.")
    preset = _word("A named look, such as 'teaching' or bhr.Preset.TEACHING.")
    view = _word("What pixels show, such as 'redshift' or bhr.View.REDSHIFT.")
    time = _number(help="The time at which matter is seen, in lengths of the scene.")
    controls = traitlets.Bool(True, help="Whether readers may turn it.").tag(sync=True)
    playing = traitlets.Bool(False, help="Whether time runs, unless a reader wants little motion.").tag(sync=True)
    rate = _number(help="Scene time that goes by in a second; 10 by default.")
    alt = traitlets.Unicode("", help="A sentence for those who do not see it; one is made by default.").tag(sync=True)
    backend = traitlets.Enum(
        ["auto", "webgpu", "cpu"],
        default_value="auto",
        help="What traces in the page: WebGPU, its processor, or by default the one that is there.",
    ).tag(sync=True)
    max_pixels = traitlets.Int(2_000_000, min=1, help="Pixels of a picture at most.").tag(sync=True)
    error = traitlets.Unicode("", help="What the page found wrong with the scene; empty if it is shown.").tag(sync=True)

    def __init__(self, scene: Any = None, **traits: Any) -> None:
        unknown = sorted(set(traits) - set(self.trait_names()))
        if unknown:
            # anywidget ignores them.
            raise TypeError(f"Hole has no {unknown[0]!r}; it has {', '.join(_OWN)}; all else is part of scene")
        if scene is not None:
            traits["scene"] = scene
        super().__init__(**traits)
        self.on_msg(self._asked)

    def _asked(self, _: Any, content: Any, __: Any) -> None:
        # Sent as a message, the module is in no notebook's file, which keeps the traits of widgets.
        if isinstance(content, Mapping) and content.get("kind") == "module":
            self.send({"kind": "module"}, buffers=[_web.module()])


#: The traits that are not those of every widget.
_OWN = [name for name, trait in Hole.class_traits().items() if trait.this_class is Hole and not name.startswith("_")]
