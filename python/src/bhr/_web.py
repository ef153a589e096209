# SPDX-License-Identifier: MIT OR Apache-2.0
"""Where the wheel keeps what bhr.widget shows in pages: the script of notebooks, and the WebAssembly module, packed by
gzip. hatch_build.py puts them there, if it is told a tree of the npm package. Knows no Jupyter."""

from __future__ import annotations

from pathlib import Path

SCRIPT = "notebook.js"
MODULE = "bhr_bg.wasm.gz"

FOLDER = Path(__file__).with_name("web")


def script() -> str:
    """The script. Raises ImportError in a wheel that was built without it."""
    try:
        return (FOLDER / SCRIPT).read_text(encoding="utf-8")
    except FileNotFoundError:
        raise ImportError(
            "this wheel of bhr was built without its web module, which bhr.widget needs: build it with BHR_WEB_TREE, "
            "the folder that packaging/npm --tree of bhr's repository makes (python/README.md)"
        ) from None


def module() -> bytes:
    """The module, as it goes to pages."""
    return (FOLDER / MODULE).read_bytes()
