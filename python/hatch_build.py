# SPDX-License-Identifier: MIT OR Apache-2.0
"""Puts into the wheel what pyproject.toml cannot name: the built library and the declarations of bhr.h and of
bhr_interop.h; and the program bhr, which pip puts where commands are.

The environment variable BHR_LIBRARY names a built library, BHR_PROGRAM a built program, without which the wheel has
none; without either, cargo builds both for release. For another machine than this one BHR_PLATFORM says the wheel's
platform (build-wheel --platform does). BHR_WEB_TREE names a folder that packaging/npm --tree has made, of which
bhr.widget needs two files; without it the wheel lacks them, and bhr.widget says so.

hatchling was chosen over maturin because it takes a library that is already there, built by whatever cross-compiler,
and because maturin would need cbindgen a second time for what include/bhr.h already says.
"""

from __future__ import annotations

import gzip
import os
import re
import runpy
import subprocess
import sys
import sysconfig
import tempfile
from pathlib import Path
from typing import Any

import cffi
from hatchling.builders.hooks.plugin.interface import BuildHookInterface

# The sys.platform of each platform that wheels are made for elsewhere.
SYSTEMS = {"win_amd64": "win32", "linux_x86_64": "linux", "linux_aarch64": "linux"}


def declarations(header: str) -> str:
    """The declarations of headers in the C that cffi understands: without comments and preprocessor."""
    text = re.sub(r"/\*.*?\*/|//[^\n]*", " ", header, flags=re.DOTALL).replace("\\\n", " ")
    text = re.sub(r"^#ifdef __cplusplus$.*?^#endif$", "", text, flags=re.DOTALL | re.MULTILINE)
    constants, attributes = [], []
    for name, value in re.findall(r"^[ \t]*#[ \t]*define[ \t]+(\w+\b(?:\([^)]*\))?)[ \t]*(.*)$", text, re.MULTILINE):
        number = re.fullmatch(r"(?:(\d+)u?|\(0 - (\d+)\))", value.strip())
        if number:
            constants.append(f"#define {name} {number[1] or '-' + number[2]}")
        elif name.startswith("BHR_") and not name.endswith("_H"):
            # A macro that stands before or behind functions, for the compiler's warnings.
            attributes.append(name.split("(")[0])
    text = re.sub(r"^[ \t]*#.*$", "", text, flags=re.MULTILINE)
    for name in set(attributes):
        text = re.sub(rf"\b{name}\b(\([^()]*\))?", "", text)
    lines = [line for line in text.splitlines() if line.strip()]
    return "\n".join(constants + lines) + "\n"


def platform() -> tuple[str, str]:
    """The platform of the wheel's name, and what sys.platform is there."""
    given = os.environ.get("BHR_PLATFORM")
    if not given:
        return re.sub(r"[^A-Za-z0-9]", "_", sysconfig.get_platform()), sys.platform
    if given not in SYSTEMS:
        raise ValueError(f"BHR_PLATFORM is {given}; wheels are made for {', '.join(SYSTEMS)}")
    if not os.environ.get("BHR_LIBRARY"):
        raise ValueError("BHR_PLATFORM needs BHR_LIBRARY, a library that is built for it")
    return given, SYSTEMS[given]


def platform_of(path: Path) -> str | None:
    """The platform that a library is for, if it is one of SYSTEMS."""
    head = path.read_bytes()[:4096]
    if head[:4] == b"\x7fELF":
        return {62: "linux_x86_64", 183: "linux_aarch64"}.get(int.from_bytes(head[18:20], "little"))
    if head[:2] == b"MZ":
        begin = int.from_bytes(head[60:64], "little")
        if head[begin : begin + 6] == b"PE\0\0" + (0x8664).to_bytes(2, "little"):
            return "win_amd64"
    return None


def library(root: Path, name: str) -> Path:
    """The library that goes into the wheel, under that name."""
    given = os.environ.get("BHR_LIBRARY")
    if given:
        path = Path(given).resolve()
    else:
        command = ["cargo", "build", "--release", "--lib", "--features", "cli", "--bin", "bhr", "--locked"]
        subprocess.run(command, cwd=root, check=True)
        path = root / os.environ.get("CARGO_TARGET_DIR", "target") / "release" / name
    if not path.is_file():
        raise FileNotFoundError(f"the library that the wheel is to hold is not there: {path}")
    return path


def program(library: Path) -> Path | None:
    """The program that goes into the wheel: the one that is named, or that was built with the library."""
    given = os.environ.get("BHR_PROGRAM")
    if given is None and os.environ.get("BHR_LIBRARY"):
        return None
    path = Path(given).resolve() if given else library.with_name("bhr.exe" if sys.platform == "win32" else "bhr")
    if not path.is_file():
        raise FileNotFoundError(f"the program that the wheel is to hold is not there: {path}")
    return path


def web_module(tree: Path, scratch: Path, names: dict[str, Any]) -> dict[str, str]:
    """The files that bhr.widget needs of a tree of the npm package, with their places in the wheel."""
    files = [tree / "notebook.js", tree / "wasm" / "bhr_bg.wasm"]
    for file in files:
        if not file.is_file():
            raise FileNotFoundError(f"BHR_WEB_TREE is no folder of packaging/npm --tree: {file} is not there")
    packed = scratch / names["MODULE"]
    # Without the time the same module gives the same wheel.
    packed.write_bytes(gzip.compress(files[1].read_bytes(), mtime=0))
    return {str(files[0]): f"bhr/web/{names['SCRIPT']}", str(packed): f"bhr/web/{names['MODULE']}"}


class CustomBuildHook(BuildHookInterface):  # type: ignore[type-arg]
    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        if version == "editable":
            raise RuntimeError("an editable install would lack the library: install the wheel")
        root = Path(self.root).parent
        headers = [root / "include" / name for name in ("bhr.h", "bhr_interop.h")]
        if not all(header.is_file() for header in headers):
            raise FileNotFoundError("the wheel is built within bhr's repository, because it holds the Rust library")
        self.scratch = tempfile.TemporaryDirectory(prefix="bhr-wheel-")
        module = Path(self.scratch.name) / "_ffi.py"
        ffi = cffi.FFI()
        ffi.set_source("bhr._ffi", None)
        ffi.cdef(declarations("\n".join(header.read_text(encoding="utf-8") for header in headers)))
        ffi.emit_python_code(str(module))
        given = os.environ.get("BHR_WEB_TREE")
        if given:
            names = runpy.run_path(str(Path(self.root) / "src" / "bhr" / "_web.py"))
            build_data["force_include"].update(web_module(Path(given).resolve(), Path(self.scratch.name), names))
        suffix, system = platform()
        library_file = runpy.run_path(str(Path(self.root) / "src" / "bhr" / "_platform.py"))["library_file"]
        file = library(root, library_file(system))
        if suffix in SYSTEMS and platform_of(file) != suffix:
            raise ValueError(f"{file} is a library for {platform_of(file)}, not for {suffix}")
        build_data["pure_python"] = False
        build_data["tag"] = f"py3-none-{suffix}"
        build_data["force_include"][str(module)] = "bhr/_ffi.py"
        build_data["force_include"][str(file)] = f"bhr/{library_file(system)}"
        command = program(file)
        if command is not None:
            if suffix in SYSTEMS and platform_of(command) != suffix:
                raise ValueError(f"{command} is a program for {platform_of(command)}, not for {suffix}")
            build_data["shared_scripts"][str(command)] = "bhr.exe" if system == "win32" else "bhr"

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:
        self.scratch.cleanup()
