# SPDX-License-Identifier: MIT OR Apache-2.0
"""The installed wheel: its licences, its tag, its needs; and the programs of its README."""

import asyncio
import importlib.metadata
import importlib.util
import re
import sys
import types
from pathlib import Path

import bhr
import pytest
from bhr import _library, _platform
import numpy as np
from conftest import ROOT

WHEEL = importlib.metadata.distribution("bhr")


def text(name):
    (found,) = [file for file in WHEEL.files if file.name == name]
    return found.read_text()


def test_licences_are_inside():
    for name in "LICENSE-MIT", "LICENSE-APACHE", "THIRD-PARTY.txt":
        assert text(name) == (ROOT / name).read_text()
    assert WHEEL.metadata["License-Expression"] == "MIT OR Apache-2.0"
    assert len(WHEEL.metadata.get_all("License-File")) == 3


def test_any_python_takes_it():
    assert "Tag: py3-none-" in text("WHEEL") and "Root-Is-Purelib: false" in text("WHEEL")
    assert WHEEL.metadata["Requires-Python"] == ">=3.9"
    needs = [re.match("[a-z]+", need)[0] for need in WHEEL.requires if "extra" not in need]
    assert sorted(needs) == ["cffi", "numpy"]


def test_version():
    assert WHEEL.version == bhr.__version__


def test_it_holds_what_it_needs_and_no_more():
    # The folder web is there where BHR_WEB_TREE names one (tests/python/run).
    names = {file.name for file in WHEEL.files if file.parts[0] == "bhr" and not {"__pycache__", "web"} & {*file.parts}}
    sources = {file.name for file in (ROOT / "python" / "src" / "bhr").iterdir() if file.is_file()}
    assert names == sources | {"_ffi.py", "libbhr.so"}


@pytest.mark.parametrize(
    "system, file",
    [("linux", "libbhr.so"), ("android", "libbhr.so"), ("darwin", "libbhr.dylib"), ("win32", "bhr.dll")],
)
def test_each_system_loads_its_own_file(monkeypatch, system, file):
    """The loader, run once more where Python says that it is on that system: with a stand-in for cffi, as the file is
    not there."""
    asked = []

    class Ffi:
        def dlopen(self, path):
            asked.append(Path(path))
            return types.SimpleNamespace(bhr_abi_version=lambda: 1, BHR_ABI_VERSION=1)

        def callback(self, *_, **__):
            return lambda function: function

    loader = importlib.util.spec_from_file_location("bhr._library_elsewhere", _library.__file__)
    module = importlib.util.module_from_spec(loader)
    monkeypatch.setitem(sys.modules, loader.name, module)
    monkeypatch.setattr(sys.modules["bhr._ffi"], "ffi", Ffi())
    monkeypatch.setattr(sys, "platform", system)
    loader.loader.exec_module(module)
    assert asked == [Path(bhr.__file__).resolve().with_name(file)] and asked[0].is_absolute()
    assert _platform.library_file(system) == file


def test_the_programs_of_the_readme(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"```python\n(.*?)```", WHEEL.metadata.get_payload(), re.DOTALL)
    assert len(blocks) == 5 and "ctx.render(1280, 720)" in blocks[0]
    exec(blocks[0].replace("1280, 720", "96, 54"), {})
    assert bhr.load("hole.png").width == 96
    with bhr.Context(bhr.Backend.CPU) as ctx:
        names = {"bhr": bhr, "ctx": ctx, "np": np}
        for block in blocks[1:]:
            exec(block, names)
        assert np.isfinite(names["g"]).any() and (names["hits"]["fate"] == bhr.Fate.ESCAPED).any()
        ctx.view = bhr.View.LIGHT
        assert len(asyncio.run(names["frames"]())) == 3
