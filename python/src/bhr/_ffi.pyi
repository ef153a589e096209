# SPDX-License-Identifier: MIT OR Apache-2.0
# The declarations of bhr.h and bhr_interop.h, which the wheel's build writes as a module for cffi (hatch_build.py).
from typing import Any

ffi: Any
