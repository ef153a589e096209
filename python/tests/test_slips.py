# SPDX-License-Identifier: MIT OR Apache-2.0
"""Slips of the pen: attributes that do not exist, names in the place of members, degrees, files in the place of
pictures. Each works or says what is meant."""

import enum
import logging
import math
import subprocess
import sys
import threading
import typing

import bhr
import numpy as np
import pytest
from bhr import _constants, interop

SETTINGS = ["spin", "mass", "axis", "camera", "disk", "volumes", "hot_spots", "sky", "film", "quality", "effects"]


@pytest.mark.parametrize("name", ["spn", "Spin", "dsk", "fov_y", "samples"])
def test_attributes_that_do_not_exist_cannot_be_set(ctx, name):
    with pytest.raises(AttributeError, match=name):
        setattr(ctx, name, 0.5)
    frame = bhr.Frame.empty(4, 3)
    with pytest.raises(AttributeError, match=name):
        setattr(frame, name, 0.5)
    for kind in bhr.Camera, bhr.Disk, bhr.Film, bhr.HotSpot, bhr.Quality, bhr.Sky, bhr.Volume:
        with pytest.raises(AttributeError):
            setattr(kind(), name, 0.5)
        with pytest.raises(TypeError, match="unexpected keyword argument 'fvo_y'"):
            kind(fvo_y=1.0)
        with pytest.raises(TypeError, match="unexpected keyword argument 'fvo_y'"):
            kind().replace(fvo_y=1.0)


def test_objects_on_the_gpu_have_no_other_attributes():
    with bhr.Context("vulkan") as ctx:
        with interop.Target(ctx, 8, 8, kind="buffer", format="rgba16f") as target, interop.Semaphore(ctx) as line:
            for shared in target, line:
                with pytest.raises(AttributeError, match="colour"):
                    shared.colour = 1
        with pytest.raises(bhr.InvalidArgument, match="'image', 'buffer'"):
            interop.Target(ctx, 8, 8, kind="bufer")


def test_every_setting_has_a_slot_or_a_property(ctx):
    # Were there a __dict__, a slip would go into it.
    assert not hasattr(ctx, "__dict__") and not hasattr(bhr.Frame.empty(4, 3), "__dict__")
    for name in SETTINGS:
        setattr(ctx, name, getattr(ctx, name))


def test_names_stand_for_members(ctx):
    ctx.set_preset("physical")
    by_name = ctx.disk, ctx.film, ctx.sky
    ctx.set_preset(bhr.Preset.PHYSICAL)
    assert (ctx.disk, ctx.film, ctx.sky) == by_name
    assert ctx.set_preset_with("Cinematic", "deep") is bhr.PresetMatter.DEEP
    ctx.view = "optical-depth"
    assert ctx.view is bhr.View.OPTICAL_DEPTH
    ctx.effects = "beaming | doppler_shift"
    assert ctx.effects == bhr.Effects.BEAMING | bhr.Effects.DOPPLER_SHIFT
    ctx.effects = ""
    assert ctx.effects == bhr.Effects(0)
    camera = bhr.Camera(motion="free fall", projection="FISHEYE")
    assert (camera.motion, camera.projection) == (bhr.Motion.FREE_FALL, bhr.Projection.FISHEYE)
    assert camera.replace(motion="static").motion is bhr.Motion.STATIC
    assert bhr.Camera.orbit(9.0, 0.0, 0.0, motion="orbit").motion is bhr.Motion.ORBIT
    assert bhr.Sky(flags="stars|grid").flags == bhr.SkyFlags.STARS | bhr.SkyFlags.GRID
    assert bhr.Volume(shape="torus", flow="outflow", flags="power_law").shape is bhr.VolumeShape.TORUS
    assert bhr.Frame.empty(4, 3, "rgba16f").format is bhr.Format.RGBA16F
    ctx.view = "light"
    assert ctx.render(4, 3, format="bgra8_srgb").format is bhr.Format.BGRA8_SRGB
    depth, redshift = ctx.render_outputs(4, 3, ["depth", ("view", "redshift")], format="rgba16f")
    values = ctx.render_views(4, 3, ["redshift", "order"])
    assert values.dtype.names == ("redshift", "order") and depth.array.shape == (3, 4)
    assert np.array_equal(redshift.array, values["redshift"], equal_nan=True)
    view, projection = bhr.Camera().matrices(4, 3, 0.1, flags="reversed | zero_to_one")
    assert projection[3, 2] == -1.0 and projection[2, 3] == pytest.approx(0.1)
    bhr.Camera.from_matrices(view, projection, "zero_to_one|reversed")


WRONG = [
    (lambda ctx: ctx.set_preset("cinema"), "preset is 'cinema'", bhr.Preset),
    (lambda ctx: ctx.set_preset(77), "preset is 77", bhr.Preset),
    (lambda ctx: ctx.set_preset_with("physical", "thick"), "matter is 'thick'", bhr.PresetMatter),
    (lambda ctx: setattr(ctx, "view", "heat"), "view is 'heat'", bhr.View),
    (lambda ctx: setattr(ctx, "effects", "doppler"), "effects is 'doppler'", bhr.Effects),
    (lambda ctx: ctx.render(4, 3, format="png"), "format is 'png'", bhr.Format),
    (lambda ctx: ctx.prepare(4, 3, format="png"), "format is 'png'", bhr.Format),
    (lambda ctx: ctx.render_outputs(4, 3, ["distance"]), "output is 'distance'", bhr.OutputKind),
    (lambda ctx: ctx.render_outputs(4, 3, [("view", "heat")]), "view is 'heat'", bhr.View),
    (lambda ctx: ctx.render_views(4, 3, ["heat"]), "view is 'heat'", bhr.View),
    (lambda ctx: bhr.Context("gpu"), "backend is 'gpu'", bhr.Backend),
    (lambda ctx: bhr.Camera(motion="falling"), "motion is 'falling'", bhr.Motion),
    (lambda ctx: bhr.Sky(flags="stars|moon"), "flags is 'stars|moon'", bhr.SkyFlags),
    (lambda ctx: bhr.Camera().matrices(4, 3, 0.1, flags="upside_down"), "flags is 'upside_down'", bhr.MatrixFlags),
]


@pytest.mark.parametrize(("call", "begin", "kind"), WRONG, ids=[begin for _, begin, _ in WRONG])
def test_a_wrong_name_is_told_the_right_ones(ctx, call, begin, kind):
    with pytest.raises(bhr.InvalidArgument) as caught:
        call(ctx)
    assert caught.value.message.startswith(begin)
    assert all(repr(name.lower()) in caught.value.message for name in kind.__members__)


def test_members_of_other_enumerations_are_refused(ctx):
    for wrong in bhr.Preset.PHYSICAL, None, 1.5:
        with pytest.raises(TypeError, match=r"the names of bhr\.View are 'light'"):
            ctx.view = wrong
    with pytest.raises(TypeError, match=r"bhr\.Motion"):
        bhr.Camera(motion=bhr.Projection.CUBE)


def test_the_types_of_names_are_the_members():
    kinds = [kind for kind in vars(bhr).values() if isinstance(kind, type) and issubclass(kind, enum.IntEnum)]
    assert set(kinds) - {bhr.Status, bhr.Fate, bhr.WorldLineEnd} == set(_constants.NAMES)
    for kind, names in _constants.NAMES.items():
        assert list(typing.get_args(names)) == [name.lower() for name in kind.__members__]


def test_degrees_are_noticed():
    with pytest.raises(bhr.InvalidArgument, match=r"elevation is 20.*radians.*math\.radians\(20\)"):
        bhr.Camera.orbit(30, 0, 20)
    with pytest.raises(bhr.InvalidArgument, match=r"math\.radians\(-89\.5\)"):
        bhr.Camera.orbit(30, 0, -89.5)
    for elevation in math.radians(90), -math.pi / 2, np.float32(math.pi / 2):
        camera = bhr.Camera.orbit(30, 700.0, elevation)
        assert np.linalg.norm(camera.position) == pytest.approx(30.0)
    with pytest.raises(bhr.InvalidArgument, match="finite"):
        bhr.Camera.orbit(30, 0, math.nan)


def test_skies_come_from_files(ctx, tmp_path):
    stripes = np.zeros((32, 64, 4), np.uint8)
    stripes[:, ::2], stripes[..., 3] = 255, 255
    bhr.Frame(stripes).save(tmp_path / "sky.png")
    ctx.disk, ctx.sky = None, bhr.Sky("map")
    ctx.set_sky_map(stripes)
    expected = ctx.render(32, 18).array
    for path in tmp_path / "sky.png", str(tmp_path / "sky.png"):
        ctx.set_sky_map(None)
        assert not np.array_equal(ctx.render(32, 18).array, expected)
        ctx.set_sky_map(path)
        assert np.array_equal(ctx.render(32, 18).array, expected)
    # Blocks of two colours lie on one line, so that little is lost.
    ctx.save_sky_map(tmp_path / "sky.ktx2")
    ctx.set_sky_map(tmp_path / "sky.ktx2")
    assert np.abs(ctx.render(32, 18).array.astype(int) - expected).max() <= 6
    assert bhr.load(tmp_path / "sky.ktx2").array.shape == stripes.shape
    with pytest.raises(bhr.Error, match=r"\.ktx2 files"):
        ctx.save_sky_map(tmp_path / "sky.png")
    ctx.set_sky_map(stripes)
    with pytest.raises(bhr.FileError, match=r"missing\.jpg"):
        ctx.set_sky_map("missing.jpg")
    (tmp_path / "x.jpg").write_bytes(b"\xff\xd8\xff\xe0\0\x10JFIF\0" + bytes(100))
    with pytest.raises(bhr.FileError, match=r"x\.jpg.*no PNG, EXR, PNM or KTX2 file"):
        ctx.set_sky_map(tmp_path / "x.jpg")
    for wrong in [[0, 1]], 7, bhr.Sky():
        with pytest.raises(TypeError, match=f"a sky map is a path, .* not {type(wrong).__name__}"):
            ctx.set_sky_map(wrong)
    for ask in lambda: ctx.set_occluder("x.exr"), lambda: ctx.render(out="x.png"), lambda: bhr.Frame("x.png"):
        with pytest.raises(TypeError, match="numpy array, not str; bhr.load reads files"):
            ask()
    assert np.array_equal(ctx.render(32, 18).array, expected)


def test_structs_are_told_apart(ctx):
    for name, kind in ("camera", "Camera"), ("disk", "Disk"), ("film", "Film"), ("sky", "Sky"), ("quality", "Quality"):
        for wrong in "x", 1.0, bhr.Region(4, 3):
            with pytest.raises(TypeError, match=rf"{name} is a bhr\.{kind}.*, not (str|float|Region)"):
                setattr(ctx, name, wrong)
    for name, kind in ("volumes", "Volume"), ("hot_spots", "HotSpot"):
        for wrong in getattr(bhr, kind)(), [bhr.Disk()]:
            with pytest.raises(TypeError, match=rf"bhr\.{kind}"):
                setattr(ctx, name, wrong)


def test_repr_says_what_it_is():
    ctx = bhr.Context(bhr.Backend.CPU, cpu_threads=1)
    ctx.spin = 0.9
    ctx.volumes = [bhr.Volume()]
    assert repr(ctx) == f"<bhr.Context on {ctx.adapter.name} (CPU), mass 1, spin 0.9, a disk, 1 volume>"
    ctx.disk, ctx.hot_spots = None, [bhr.HotSpot(), bhr.HotSpot(azimuth=1.0)]
    assert repr(ctx).endswith("spin 0.9, no disk, 1 volume, 2 hot spots>")
    said = []
    ctx.render(8, 8, progress=lambda _: said.append(repr(ctx)))
    assert said and set(said) == {f"<bhr.Context on {ctx.adapter.name} (CPU)>"}  # a callback may not ask the library
    ctx.close()
    assert repr(ctx) == "<bhr.Context, closed>"


def test_samples_are_those_of_one_frame(ctx):
    ctx.quality = ctx.quality.replace(samples_per_pixel=2, max_steps=1500)
    two = ctx.render(32, 18).array.copy()
    ctx.quality = ctx.quality.replace(samples_per_pixel=4)
    four = ctx.render(32, 18).array.copy()
    ctx.quality = ctx.quality.replace(samples_per_pixel=2)
    before = ctx.quality
    assert np.array_equal(ctx.render(32, 18, samples=4).array, four) and not np.array_equal(two, four)
    assert ctx.stats.rays == 4 * 32 * 18
    assert np.array_equal(ctx.render_async(32, 18, samples=4).result().array, four)
    ctx.prepare(32, 18, samples=4)
    picture, _ = ctx.render_outputs(32, 18, ["light", "depth"], format="rgba8_srgb", samples=4)
    assert np.array_equal(picture.array, four)
    with pytest.raises(bhr.InvalidArgument, match="samples_per_pixel is 0"):
        ctx.render(32, 18, samples=0)
    with pytest.raises(bhr.Cancelled):
        ctx.render(32, 18, samples=4, progress=lambda _: False)
    assert ctx.quality == before and np.array_equal(ctx.render(32, 18).array, two)


def test_samples_of_threads_do_not_mix(ctx):
    def ask(samples):
        for _ in range(8):
            frame = ctx.render_async(8, 6, samples=samples)
            frame.result()
            seen.append((samples, frame.stats.rays))

    seen = []
    threads = [threading.Thread(target=ask, args=(samples,)) for samples in (2, 3, 4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(seen) == 24 and all(rays == 48 * samples for samples, rays in seen)
    assert ctx.quality.samples_per_pixel == 1


def test_without_a_gpu_the_cpu_traces(caplog):
    software = all(adapter.flags & bhr.AdapterFlags.SOFTWARE for adapter in bhr.adapters())
    with caplog.at_level(logging.INFO, "bhr"), bhr.Context() as ctx:
        assert (ctx.adapter.backend is bhr.Backend.CPU) == software
    assert ("no GPU was usable" in caplog.text) == software
    with bhr.Context("vulkan") as asked:
        assert asked.adapter.backend is bhr.Backend.VULKAN
    with bhr.Context(adapter_index=0) as asked:
        assert asked.adapter == bhr.adapters()[0]


def test_a_traceback_names_the_slip():
    slip = "import bhr\nwith bhr.Context('cpu') as context:\n    context.spn = 0.5\n"
    done = subprocess.run([sys.executable, "-c", slip], capture_output=True, text=True, check=False)
    assert done.returncode == 1 and "'Context' object has no attribute 'spn'" in done.stderr


def test_luts_come_from_files_and_arrays(ctx, tmp_path):
    at = np.linspace(0.0, 1.0, 5)
    blue, green, red = np.meshgrid(at, at, at, indexing="ij")
    turned = np.stack([green, blue, red], axis=-1)
    plain = ctx.render(32, 18).array
    ctx.set_film_lut(turned)
    expected = ctx.render(32, 18).array
    assert np.abs(expected[..., :3].astype(int) - plain[..., [1, 2, 0]]).max() <= 1
    rows = "\n".join(" ".join(map(repr, map(float, node))) for node in turned.reshape(-1, 3))
    (tmp_path / "look.cube").write_text(f"LUT_3D_SIZE 5\n{rows}\n")
    for path in tmp_path / "look.cube", str(tmp_path / "look.cube"):
        ctx.set_film_lut(None)
        assert np.array_equal(ctx.render(32, 18).array, plain)
        ctx.set_film_lut(path)
        assert np.array_equal(ctx.render(32, 18).array, expected)
    ctx.film = ctx.film.replace(lut_strength=0.0)
    assert np.array_equal(ctx.render(32, 18).array, plain)
    ctx.film = ctx.film.replace(lut_strength=1.0)
    with pytest.raises(bhr.FileError, match=r"missing\.cube"):
        ctx.set_film_lut("missing.cube")
    for wrong in np.zeros((5, 5, 5)), np.zeros((2, 2, 3, 3)), np.zeros(()):
        with pytest.raises(ValueError, match="shape"):
            ctx.set_film_lut(wrong)
    with pytest.raises(bhr.InvalidArgument, match="side is 1"):
        ctx.set_film_lut(np.zeros((1, 1, 1, 3)))
    with pytest.raises(bhr.InvalidArgument, match="finite"):
        ctx.set_film_lut(np.full((2, 2, 2, 3), np.nan))
    with pytest.raises(TypeError, match="a LUT is a path or a numpy array, not list"):
        ctx.set_film_lut([0, 1])
    assert np.array_equal(ctx.render(32, 18).array, expected)


def test_effects_have_strengths(ctx):
    assert ctx.effect_strength("beaming") == 1.0
    ctx.set_effect_strength("beaming | doppler_shift", 0.25)
    assert ctx.effect_strength("beaming") == ctx.effect_strength(bhr.Effects.DOPPLER_SHIFT) == 0.25
    with pytest.raises(bhr.InvalidArgument, match="strength"):
        ctx.set_effect_strength("beaming", 2.0)
