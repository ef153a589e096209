# SPDX-License-Identifier: MIT OR Apache-2.0
"""The installed wheel: its licences, its tag, its needs; and the programs of its README."""

import asyncio
import importlib.metadata
import re

import bhr
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
    names = {file.name for file in WHEEL.files if file.parts[0] == "bhr" and "__pycache__" not in file.parts}
    sources = {file.name for file in (ROOT / "python" / "src" / "bhr").iterdir() if file.is_file()}
    assert names == sources | {"_ffi.py", "libbhr.so"}


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
