# SPDX-License-Identifier: MIT OR Apache-2.0
"""The package's types, under mypy --strict: its own code, the README's, and what a host writes. In tests/run all, as
mypy takes long."""

import re
import subprocess
import sys
import textwrap
from pathlib import Path

from conftest import ROOT

HOST = """
from __future__ import annotations
import asyncio
import numpy as np
import numpy.typing as npt
import bhr
from bhr import interop

def share(ctx: bhr.Context) -> tuple[int, int]:
    can = interop.info(ctx)
    buffer = bool(can.export_buffers & interop.HandleType.OPAQUE_FD)
    with interop.Target(ctx, 4, 3, handle_type=interop.HandleType.OPAQUE_FD) as target, interop.Semaphore(ctx) as line:
        job: interop.TargetJob = interop.render(ctx, target, signals=[(line, 1)], background=not buffer)
        same: interop.Target = job.result()
        both = interop.render_outputs(ctx, [(bhr.OutputKind.LIGHT, target), ((bhr.OutputKind.DISK, 1), same)])
        print(len(both.result()), line.wait(1, timeout=2.0))
        interop.set_sky(ctx, None, bhr.Projection.CUBE)
        return target.export(), target.info.replace(offset=3).offset

def show(ctx: bhr.Context, out: npt.NDArray[np.float32]) -> bhr.Frame:
    ctx.camera = ctx.camera.replace(fov_y=0.5)
    ctx.disk = bhr.Disk(temperature=9000.0, flags=bhr.DiskFlags.PLUNGES | bhr.DiskFlags.RETROGRADE)
    ctx.disk = None
    ctx.set_preset("physical")
    ctx.view = "redshift"
    named: bhr.View = ctx.view
    ctx.camera = bhr.Camera(motion="free_fall").replace(projection="fisheye")
    motion: bhr.Motion = ctx.camera.motion
    ctx.sky = bhr.Sky("stars | grid")
    ctx.effects = "beaming"
    ctx.set_sky_map("sky.exr")
    ctx.set_film_lut("look.cube")
    ctx.render_outputs(4, 3, ["light", (bhr.OutputKind.DISK, 1), ("view", "order")], samples=4)
    print(named, motion, bhr.Frame.empty(4, 3, "rgba16f"), ctx.render(4, 3, format="rgba32f", samples=4))
    ctx.axis = (0.0, 0.0, 1.0)
    spin: float = ctx.spin
    camera, elapsed = ctx.advance(bhr.Camera.orbit(10.0, 0.0, spin, motion=bhr.Motion.FREE_FALL), 1.0)
    ctx.time += elapsed
    job: bhr.Job = ctx.render_async(out=out, progress=lambda fraction: fraction < 0.5)
    frame: bhr.Frame = job.result(timeout=1.0)
    pixels: npt.NDArray[np.float32] = np.asarray(frame, dtype=np.float32)
    hits = ctx.trace(bhr.rays((1.0, 2.0, 3.0), np.zeros((4, 3))))
    captured = hits["fate"] == bhr.Fate.CAPTURED
    print(captured.sum(), pixels.shape, np.from_dlpack(frame).shape)
    return frame

async def main() -> bytes | None:
    with bhr.Context(bhr.Backend.CPU, cpu_threads=1) as ctx:
        frame = await ctx.render_async(4, 3)
        return frame._repr_png_()

asyncio.run(main())
"""

#: Mistakes that a type checker finds, each in a line of its own.
MISTAKES = """
import bhr
ctx = bhr.Context("gpu")
ctx.set_preset("cinema")
ctx.view = "heat"
ctx.camera = bhr.Camera(motion="falling")
ctx.spn = 0.5
ctx.camera = bhr.Disk()
ctx.view = bhr.Preset.PHYSICAL
ctx.render(32, 18, format="png")
ctx.camera.fov_y = 1.0
bhr.Camera(motion=bhr.Projection.CUBE)
ctx.render(32, 18).save(3)
ctx.stats.rays.foo
bhr.interop.render(ctx, bhr.Frame.empty(4, 3))
"""


def mypy(*arguments, folder):
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", *arguments], cwd=folder, capture_output=True, text=True, check=False
    )
    return done.returncode, done.stdout + done.stderr


def test_the_package_is_typed(tmp_path):
    assert mypy("-p", "bhr", folder=tmp_path)[0] == 0, mypy("-p", "bhr", folder=tmp_path)[1]


def test_hosts_are_typed(tmp_path):
    (tmp_path / "host.py").write_text(HOST)
    readme = re.findall(r"```python\n(.*?)```", (ROOT / "python" / "README.md").read_text(), re.DOTALL)
    assert len(readme) == 5
    text = "import numpy as np\n" + "".join(readme)
    (tmp_path / "readme.py").write_text(text.replace("def frames():", "def frames() -> list[bhr.Frame]:"))
    status, said = mypy("host.py", "readme.py", folder=tmp_path)
    assert status == 0, said


def test_mistakes_are_found(tmp_path):
    (tmp_path / "wrong.py").write_text(MISTAKES)
    _, said = mypy("wrong.py", folder=tmp_path)
    found = {int(line) for line in re.findall(r"^wrong\.py:(\d+): error", said, re.MULTILINE)}
    assert found == set(range(3, 3 + len(textwrap.dedent(MISTAKES).strip().splitlines()) - 1)), said


def test_python_3_9_is_enough():
    folders = [str(ROOT / "python" / "src"), str(ROOT / "python" / "hatch_build.py")]
    done = subprocess.run(
        [Path(sys.executable).with_name("vermin"), "--target=3.9-", "--no-tips", "--eval-annotations", *folders],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout
