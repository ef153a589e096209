# SPDX-License-Identifier: MIT OR Apache-2.0
"""Shared by the tests: contexts on the CPU tracer, whose frames are quick without the Milky Way."""

import os
import subprocess
import sys
from pathlib import Path

import bhr
import pytest

ROOT = Path(__file__).parents[2]
HEADER = (ROOT / "include" / "bhr.h").read_text(encoding="utf-8")
INTEROP_HEADER = (ROOT / "include" / "bhr_interop.h").read_text(encoding="utf-8")


def all_tests():
    return os.environ.get("BHR_TESTS_ALL") == "1"


#: Their tools are installed for tests/run all only.
collect_ignore = [] if all_tests() else ["test_tutorial.py", "test_types.py"]


@pytest.fixture
def ctx():
    with bhr.Context(bhr.Backend.CPU) as context:
        context.set_preset(bhr.Preset.TEACHING)
        yield context


@pytest.fixture(params=["CPU", "VULKAN"])
def any_ctx(request):
    with bhr.Context(bhr.Backend[request.param]) as context:
        context.set_preset(bhr.Preset.TEACHING)
        yield context


@pytest.fixture
def python():
    """Runs a Python program to its end and returns its output; it may not say anything on stderr."""

    def run(program, *, status=0, seconds=180):
        done = subprocess.run(
            [sys.executable, "-W", "error", "-c", program], capture_output=True, text=True, timeout=seconds, check=False
        )
        assert (done.returncode, done.stderr) == (status, ""), done
        return done.stdout

    return run


def resident():
    """Bytes of memory that this process has in use."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")
