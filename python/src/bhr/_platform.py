# SPDX-License-Identifier: MIT OR Apache-2.0
"""The library's file inside the package, on each system. Knows nothing else: the wheel's build reads it, too, on
another system than the wheel is for."""

from __future__ import annotations

_FILES = {"darwin": "libbhr.dylib", "win32": "bhr.dll"}


def library_file(system: str) -> str:
    """The file's name where sys.platform is `system`."""
    return _FILES.get(system, "libbhr.so")
