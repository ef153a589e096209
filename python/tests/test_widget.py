# SPDX-License-Identifier: MIT OR Apache-2.0
"""bhr.widget without a notebook: traits, what goes to pages, and what a wheel without the web module says. Its other
half is tested by tests/web/embed.mjs."""

import gzip
import importlib
import sys

import bhr
import numpy as np
import pytest
import traitlets
from bhr import _web

MODULE = b"\0asm-stand-in"


@pytest.fixture
def widget(tmp_path, monkeypatch):
    """The module, with files of our own in the place of the wheel's, which may have none."""
    (tmp_path / _web.SCRIPT).write_text("export default { render() {} };", encoding="utf-8")
    (tmp_path / _web.MODULE).write_bytes(gzip.compress(MODULE))
    monkeypatch.setattr(_web, "FOLDER", tmp_path)
    monkeypatch.delitem(sys.modules, "bhr.widget", raising=False)
    yield importlib.import_module("bhr.widget")
    sys.modules.pop("bhr.widget", None)


def test_traits_go_to_the_page(widget):
    hole = widget.Hole(spin=0.9, elevation="10 deg", preset=bhr.Preset.TEACHING, view="Redshift")
    state = hole.get_state()
    expected = {"spin": 0.9, "elevation": "10 deg", "preset": "teaching", "view": "redshift", "scene": {}}
    assert {name: state[name] for name in expected} == expected
    assert state["distance"] is None and state["controls"] is True and "render" in state["_esm"]


def test_scenes_are_plain(widget):
    hole = widget.Hole({"hole": {"spin": np.float64(0.5)}, "disk": False})
    assert hole.scene == {"hole": {"spin": 0.5}, "disk": False}
    hole.scene = {"camera": {"position": np.array([0.0, 20.0, 2.0])}, "view": bhr.View.ORDER, "effects": ("beaming",)}
    assert hole.scene == {"camera": {"position": [0.0, 20.0, 2.0]}, "view": "order", "effects": ["beaming"]}
    hole.scene = "v=1&hole.spin=0.25"
    assert hole.get_state()["scene"] == "v=1&hole.spin=0.25"


def test_what_readers_do_comes_to_python(widget):
    hole = widget.Hole(distance=20.0)
    heard = []
    hole.observe(lambda change: heard.append((change["name"], change["new"])), ["azimuth", "scene"])
    scene = {"camera": {"orbit": {"distance": 20, "azimuth": 0.5, "elevation": 0.1}}}
    hole.set_state({"azimuth": 0.5, "scene": scene})
    assert sorted(heard) == [("azimuth", 0.5), ("scene", scene)] and hole.azimuth == 0.5


def test_bad_values_change_nothing(widget):
    hole = widget.Hole(spin=0.5)
    for name, value in {"spin": "fast", "scene": 7, "preset": 3, "backend": "gl", "max_pixels": 0}.items():
        before = getattr(hole, name)
        with pytest.raises(traitlets.TraitError):
            setattr(hole, name, value)
        assert getattr(hole, name) == before
    with pytest.raises(TypeError, match="Hole has no 'spni'; it has alt, azimuth, "):
        widget.Hole(spni=0.5)


def test_the_module_is_sent_when_a_page_asks(widget, monkeypatch):
    sent = []
    monkeypatch.setattr(widget.Hole, "send", lambda _, content, buffers=None: sent.append((content, buffers)))
    hole = widget.Hole()
    for content in {"kind": "other"}, "module", {"kind": "module"}:
        hole._handle_custom_msg(content, [])
    ((content, (packed,)),) = sent
    assert content == {"kind": "module"} and gzip.decompress(packed) == MODULE


def test_a_wheel_without_the_web_module_says_how_to_get_it(tmp_path, monkeypatch):
    monkeypatch.setattr(_web, "FOLDER", tmp_path)
    monkeypatch.delitem(sys.modules, "bhr.widget", raising=False)
    with pytest.raises(ImportError, match="BHR_WEB_TREE, the folder that packaging/npm --tree"):
        importlib.import_module("bhr.widget")


def test_without_anywidget_it_says_what_to_install(widget, monkeypatch):
    monkeypatch.setitem(sys.modules, "anywidget", None)
    monkeypatch.delitem(sys.modules, "bhr.widget")
    with pytest.raises(ImportError, match=r"pip install 'bhr\[widget\]'"):
        importlib.import_module("bhr.widget")
