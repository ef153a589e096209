# SPDX-License-Identifier: MIT OR Apache-2.0
"""The scene: what is set is what is read, and what is refused says why and changes nothing."""

import dataclasses
import math
import pickle

import bhr
import numpy as np
import pytest


def test_the_hole(ctx):
    assert (ctx.mass, ctx.spin, ctx.axis) == (1.0, 0.0, (0.0, 0.0, 1.0))
    ctx.mass, ctx.spin, ctx.axis = 2.0, np.float64(0.5), np.array([0.0, 3.0, 0.0])
    assert (ctx.mass, ctx.spin, ctx.axis) == (2.0, 0.5, (0.0, 1.0, 0.0))
    info = ctx.hole_info
    assert info.horizon_radius == pytest.approx(2.0 * (1.0 + math.sqrt(0.75)))
    assert math.isnan(info.shadow_angular_radius)


def test_metric():
    with bhr.Context(bhr.Backend.CPU) as ctx:
        metric = ctx.metric_at((3.0, 4.0, 0.0))
        assert metric.shape == (4, 4) and np.allclose(np.diag(metric), [-0.6, 1.0 / 0.6, 25.0, 25.0])
        gamma = ctx.christoffel_at((3.0, 4.0, 0.0))
        assert gamma.shape == (4, 4, 4) and gamma[0, 0, 1] == pytest.approx(1.0 / 25.0 / 0.6)
        with pytest.raises(bhr.InvalidArgument):
            ctx.metric_at((0.0, 0.0, 0.0))


CHANGED = {
    "camera": bhr.Camera.look_at((9, 1, 2), (0, 1, 0), (0, 1, 1), fov_y=1.0, motion=bhr.Motion.ORBIT),
    "disk": bhr.Disk(
        3.0, 20.0, 9000.0, 0.5, 2.0, 0.25, 2**64 - 1, bhr.DiskFlags.RETROGRADE | bhr.DiskFlags.PLUNGES,
        bhr.DiskReference.AT_HOTTEST, bhr.EmissionLaw.LIMB_DARKENED, 0.125,
    ),
    "sky": bhr.Sky(bhr.SkyFlags.GRID | bhr.SkyFlags.MAP, 2.0, 3.0, (0.0, 1.0, 0.0, 0.0), 5),
    "film": bhr.Film(bhr.ToneMap.AGX, -1.5, 0.5, 0.25, bhr.ColourMap.AFMHOT),
    "quality": bhr.Quality(bhr.Method.RK4, 4, 500, 0.05, 1e-9, 5, 0.5, bhr.VolumeResolution.HALF),
    "effects": bhr.Effects.BEAMING | bhr.Effects.LIGHT_DELAY,
    "time": -3.5,
    "view": bhr.View.ORDER,
    "region": bhr.Region(100, 50, 10, 20),
    "mass": 3.0,
    "spin": -0.5,
}  # fmt: skip


@pytest.mark.parametrize("name", CHANGED)
def test_what_is_set_is_read(ctx, name):
    before = getattr(ctx, name)
    assert before != CHANGED[name]
    setattr(ctx, name, CHANGED[name])
    assert getattr(ctx, name) == CHANGED[name]


def test_a_scene_is_text(ctx, tmp_path):
    for name, value in CHANGED.items():
        setattr(ctx, name, value)
    ctx.volumes, ctx.hot_spots = [bhr.Volume(seed=2**64 - 1)], [bhr.HotSpot()]
    text, changed = ctx.save_text(), {name: getattr(ctx, name) for name in CHANGED}
    ctx.save(tmp_path / "scene.toml")
    ctx.load_text("disk = false")
    assert ctx.disk is None and ctx.mass == 1.0 and ctx.volumes == ()
    ctx.load(tmp_path / "scene.toml")
    assert ctx.save_text() == text and {name: getattr(ctx, name) for name in CHANGED} == changed
    assert ctx.volumes[0].seed == 2**64 - 1
    with pytest.raises(bhr.InvalidArgument, match="line 2, column 8"):
        ctx.load_text("[hole]\nspin = 'fast'")
    with pytest.raises(bhr.FileError, match="nowhere"):
        ctx.load(tmp_path / "nowhere.toml")
    assert ctx.save_text() == text


def test_what_moves_in_a_scene(ctx):
    with pytest.raises(bhr.Error, match="no scene was loaded"):
        ctx.at(1.0)
    ctx.load_text("time = { keys = [[0, 0], [4, 10]] }\n[render]\nduration = 4\nwidth = 640")
    assert ctx.pictures == bhr.Pictures(640, 1080, 96, 24.0)
    ctx.at(2.0)
    assert ctx.time == 5.0
    ctx.shutter = 0.5
    assert ctx.shutter == 0.5
    with pytest.raises(bhr.Error, match="shutter"):
        ctx.shutter = -1.0


def test_a_film(tmp_path):
    scene = tmp_path / "scene.toml"
    scene.write_text("[hole]\nspin = { keys = [[0, 0], [1, 0.9]] }\n[render]\nwidth = 32\nheight = 18\nduration = 1")
    told = []
    out = tmp_path / "f.##.png"
    files = bhr.render_film(scene, out, range(0, 24, 8), backend="cpu", progress=lambda n, path: told.append(n))
    assert told == [0, 8, 16] and [file.name for file in files] == ["f.00.png", "f.08.png", "f.16.png"]
    before = [file.stat().st_mtime_ns for file in files]
    assert bhr.render_film(scene, out, [0, 8, 16], backend="cpu") == files
    assert [file.stat().st_mtime_ns for file in files] == before
    with bhr.Context("cpu") as ctx:
        ctx.load(scene)
        ctx.at(8 / 24)
        assert ctx.spin == pytest.approx(0.3)
        assert np.array_equal(ctx.render(32, 18).array, bhr.load(files[1]).array)
    assert bhr.render_film(scene, tmp_path / "one.exr", [3], backend="cpu")[0].stat().st_size > 1000
    with pytest.raises(ValueError, match="no #"):
        bhr.render_film(scene, tmp_path / "f.png", backend="cpu")


def test_a_light_curve(tmp_path):
    # A hot spot at r = 7 M and spin 0.5, seen from above its plane: its period is 2 pi (r^1.5 + a).
    period = 2.0 * np.pi * (7.0**1.5 + 0.5)
    scene = tmp_path / "spot.toml"
    scene.write_text(
        f"""
        disk = false
        time = {{ keys = [[0, 0], [2, {2.0 * period!r}]] }}
        [hole]
        spin = 0.5
        [camera]
        orbit = {{ distance = 200, elevation = "30 deg" }}
        fov_y = "6 deg"
        [[hot_spots]]
        radius = 7
        [sky]
        flags = []
        [render]
        width = 40
        height = 40
        """
    )
    told = []
    times = np.arange(0.0, 2.0, 0.25)
    curve = bhr.light_curve(scene, times, backend="cpu", progress=lambda n, sum: told.append(n))
    assert curve.shape == (8, 3) and told == list(range(8)) and (curve > 0.0).all()
    # After an orbit the light is the same; in between beaming and lensing change it.
    assert np.allclose(curve[:4], curve[4:], rtol=1e-6)
    assert curve[:, 1].max() > 1.3 * curve[:, 1].min()
    with bhr.Context("cpu") as ctx:
        ctx.load(scene)
        ctx.at(0.25)
        light = ctx.render(40, 40, format=bhr.Format.RGBA32F).array.astype(float)[:, :, :3]
    # So narrow a field is flat to 0.3 %.
    assert np.allclose(curve[1], light.sum(axis=(0, 1)) * (2.0 * np.tan(np.radians(3.0)) / 40) ** 2, rtol=4e-3)
    # Any size is the same light, but for the pixels' width.
    finer = bhr.light_curve(scene, [0.25], backend="cpu", size=(64, 64))
    assert np.allclose(finer[0], curve[1], rtol=0.05)
    scene.write_text(scene.read_text().replace("disk = false", 'disk = false\nview = "order"'))
    assert bhr.light_curve(scene, [0.0, 1.0], backend="cpu").shape == (2,)
    scene.write_text(scene.read_text().replace('fov_y = "6 deg"', 'projection = "equirect"'))
    with pytest.raises(ValueError, match="EQUIRECT"):
        bhr.light_curve(scene, [0.0], backend="cpu")


def test_nothing_instead_of_disk_sky_region(ctx):
    ctx.disk = ctx.sky = ctx.region = None
    assert ctx.disk is None and ctx.sky.flags == 0 and ctx.region is None


def test_presets(ctx):
    ctx.set_preset(bhr.Preset.OBSERVATORY)
    assert ctx.film == bhr.Film(bhr.ToneMap.NONE, -0.5, 0.0, 0.15, bhr.ColourMap.AFMHOT)
    ctx.set_preset(bhr.Preset.CINEMATIC)
    assert (ctx.disk, ctx.film, ctx.sky) == (bhr.Disk(), bhr.Film(), bhr.Sky())
    with pytest.raises(ValueError):
        ctx.set_preset(17)


def test_presets_with_depth(ctx):
    assert ctx.set_preset_with(bhr.Preset.PHYSICAL, bhr.PresetMatter.DEEP) is bhr.PresetMatter.DEEP
    assert ctx.disk is None and len(ctx.volumes) == 1
    assert ctx.set_preset_with(bhr.Preset.TEACHING, bhr.PresetMatter.DEEP) is bhr.PresetMatter.THIN
    assert ctx.disk is not None and len(ctx.volumes) == 0
    assert ctx.set_preset_with(bhr.Preset.PHYSICAL, size=(8, 8), frame_ms=1e9) is bhr.PresetMatter.DEEP
    assert ctx.set_preset_with(bhr.Preset.PHYSICAL, size=(8192, 8192), frame_ms=0.001) is bhr.PresetMatter.THIN
    assert ctx.set_preset_with(
        bhr.Preset.PHYSICAL, size=(8, 8), frame_ms=1e9, measure_anew=True, may_halve=True
    ) is bhr.PresetMatter.DEEP
    assert ctx.quality.volume_resolution is bhr.VolumeResolution.FULL
    with pytest.raises(bhr.InvalidArgument, match="frame_ms"):
        ctx.set_preset_with(bhr.Preset.PHYSICAL, frame_ms=-1.0)


def test_structs_are_values(ctx):
    camera = ctx.camera
    with pytest.raises(dataclasses.FrozenInstanceError):
        ctx.camera.fov_y = 1.0
    ctx.camera = camera.replace(fov_y=1, position=np.array([0, 10, 0]))
    assert ctx.camera.fov_y == 1.0 and ctx.camera.position == (0.0, 10.0, 0.0)
    assert pickle.loads(pickle.dumps(camera)) == camera and hash(camera) == hash(bhr.Camera())
    assert camera.motion is bhr.Motion.STATIC


def test_cameras():
    camera = bhr.Camera.orbit(20.0, 0.0, 0.1, fov_y=0.5)
    assert camera.fov_y == 0.5
    assert camera.position == pytest.approx((20.0 * math.cos(0.1), 0.0, 20.0 * math.sin(0.1)))
    assert np.allclose(np.cross(camera.position, camera.forward), 0.0)
    with pytest.raises(bhr.InvalidArgument):
        bhr.Camera.orbit(0.0, 0.0, 0.0)
    with pytest.raises(bhr.InvalidArgument):
        bhr.Camera.look_at((1.0, 0.0, 0.0), (1.0, 0.0, 0.0))


def test_a_camera_falls(ctx):
    camera = bhr.Camera.orbit(10.0, 0.0, 0.0, motion=bhr.Motion.FREE_FALL)
    fallen, elapsed = ctx.advance(camera, 1.0)
    # r^(3/2) falls evenly in the proper time of one who fell from rest at infinity.
    radius = (10.0**1.5 - 1.5 * math.sqrt(2.0)) ** (2.0 / 3.0)
    assert np.linalg.norm(fallen.position) == pytest.approx(radius) and elapsed > 1.0
    with pytest.raises(bhr.Error) as caught:
        ctx.advance(camera.replace(motion=bhr.Motion.STATIC, transport=bhr.Transport.PARALLEL), 1.0)
    assert caught.value.status == bhr.Status.UNSUPPORTED
    # A body in free fall.
    thrown = camera.replace(motion=bhr.Motion.VELOCITY, velocity=(0.0, 0.3, 0.0))
    moved, elapsed = ctx.advance(thrown, 1.0)
    assert elapsed > 1.0 and moved.velocity != thrown.velocity


def test_inside_a_spinning_hole(any_ctx):
    """Falling in the chart RAIN, through the horizon to the inner one."""
    ctx = any_ctx
    ctx.spin = 0.9
    camera = bhr.Camera.orbit(1.6, 0.0, 0.3, motion=bhr.Motion.FREE_FALL, chart=bhr.Chart.RAIN)
    ctx.camera, elapsed = ctx.advance(camera, 0.2)
    info = ctx.hole_info
    assert info.inner_horizon_radius < info.camera_radius < info.horizon_radius
    assert abs(elapsed - 0.2) < 1e-12 and info.camera_time_rate == 1.0
    light = ctx.render(32, 18, format=bhr.Format.RGBA32F).array
    assert light.shape == (18, 32, 4) and np.isfinite(light).all() and light[:, :, :3].max() > 0.0
    with pytest.raises(bhr.Error, match="inner horizon"):
        ctx.advance(camera, 9.0)


REFUSED = [
    ("mass", 0.0),
    ("mass", math.nan),
    ("mass", -math.inf),
    ("spin", 1.5),
    ("spin", math.nan),
    ("axis", (0.0, 0.0, 0.0)),
    ("axis", (math.nan, 0.0, 1.0)),
    ("time", math.inf),
    ("camera", bhr.Camera(position=(0.0, 0.0, 0.0))),
    ("camera", bhr.Camera(fov_y=math.nan)),
    ("camera", bhr.Camera(velocity=(1.0, 0.0, 0.0))),
    ("disk", bhr.Disk(outer_radius=math.nan)),
    ("disk", bhr.Disk(opacity=1.5)),
    ("sky", bhr.Sky(orientation=(0.0, 0.0, 0.0, 0.0))),
    ("film", bhr.Film(exposure_ev=99.0)),
    ("quality", bhr.Quality(samples_per_pixel=0)),
    ("region", bhr.Region(0, 10)),
]


@pytest.mark.parametrize(("name", "value"), REFUSED)
def test_what_is_refused_changes_nothing(ctx, name, value):
    before = getattr(ctx, name)
    with pytest.raises(bhr.InvalidArgument) as caught:
        setattr(ctx, name, value)
    assert isinstance(caught.value, ValueError) and caught.value.status == bhr.Status.INVALID_ARGUMENT
    assert str(caught.value) == caught.value.message and len(caught.value.message) > 20
    assert getattr(ctx, name) == before


def test_what_python_refuses(ctx):
    for wrong in [
        lambda: bhr.Camera(position=(1.0, 2.0)),
        lambda: bhr.Camera(position=(1.0, 2.0, 3.0, 4.0)),
        lambda: bhr.Camera(motion=9),
        lambda: bhr.Disk(seed=1.5),
        lambda: bhr.Disk(temperature="hot"),
        lambda: bhr.Context(backend=77),
        lambda: setattr(ctx, "spin", "fast"),
        lambda: setattr(ctx, "axis", (1.0, 2.0)),
        lambda: setattr(ctx, "view", 99),
        lambda: setattr(ctx, "disk", bhr.Disk(seed=-1)),
        lambda: setattr(ctx, "disk", bhr.Disk(seed=2**64)),
    ]:
        with pytest.raises((TypeError, ValueError, OverflowError)):
            wrong()


def test_errors_are_values():
    with pytest.raises(bhr.Error) as caught:
        bhr.Context(bhr.Backend.CPU, adapter_index=10_000)
    again = pickle.loads(pickle.dumps(caught.value))
    assert (type(again), again.status, again.message) == (type(caught.value), caught.value.status, str(caught.value))
    for kind, base in [(bhr.OutOfMemory, MemoryError), (bhr.FileError, OSError), (bhr.Cancelled, bhr.Error)]:
        assert issubclass(kind, bhr.Error) and issubclass(kind, base)
        assert str(kind(bhr.Status.IO, "why")) == "why"


def test_impossible_combinations_show_when_a_frame_is_asked_for(ctx):
    ctx.camera = bhr.Camera.orbit(1.5, 0.0, 0.0)
    for ask in (lambda: ctx.render(32, 18)), (lambda: ctx.camera_rays(32, 18)):
        with pytest.raises(bhr.Error) as caught:
            ask()
        assert caught.value.status == bhr.Status.INVALID_STATE


def test_tiles_make_the_frame(ctx):
    whole = ctx.render(32, 18).array
    tiles = np.zeros_like(whole)
    for y in 0, 9:
        for x in 0, 16:
            ctx.region = bhr.Region(32, 18, x, y)
            ctx.render(out=tiles[y : y + 9, x : x + 16])
    assert np.array_equal(tiles, whole)


def test_adapters():
    found = bhr.adapters()
    assert found[-1].backend == bhr.Backend.CPU and found[-1].flags == bhr.AdapterFlags.SOFTWARE
    assert any(adapter.backend == bhr.Backend.VULKAN for adapter in found)
    with bhr.Context(adapter_index=len(found) - 1, cpu_threads=1) as ctx:
        assert ctx.adapter == found[-1]
        assert ctx.stats.frame_index == 0
        ctx.set_preset(bhr.Preset.TEACHING)
        ctx.prepare(32, 18)
        ctx.render(32, 18)
        assert (ctx.stats.frame_index, ctx.stats.rays) == (1, 32 * 18)
        ctx.recover()
        ctx.render(32, 18)


def test_matrices():
    camera = bhr.Camera.orbit(20.0, 0.4, 0.3, fov_y=1.1)
    flags = bhr.MatrixFlags.ZERO_TO_ONE | bhr.MatrixFlags.REVERSED
    view, projection = camera.matrices(320, 180, 0.1, flags=flags)
    # Infinite, reversed depths, as they multiply column vectors.
    assert projection[3, 2] == -1.0 and projection[2, 3] == pytest.approx(0.1) and np.allclose(view[3], [0, 0, 0, 1])
    assert projection[1, 1] == pytest.approx(1.0 / math.tan(0.55))
    back = bhr.Camera.from_matrices(view, projection)
    assert back.projection == bhr.Projection.FRUSTUM and np.allclose(back.position, camera.position)
    assert back.tan_up == pytest.approx(math.tan(0.55)) and back.tan_left == pytest.approx(-math.tan(0.55) * 16 / 9)
    with pytest.raises(bhr.InvalidArgument, match="left-handed"):
        bhr.Camera.from_matrices(view @ np.diag([1.0, 1.0, -1.0, 1.0]), projection)
