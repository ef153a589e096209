# SPDX-License-Identifier: MIT OR Apache-2.0
"""Frames: the same bytes as C's, in whichever array, and what becomes of them."""

import math
import os
import subprocess

import bhr
import numpy as np
import pytest


def test_frames_are_those_of_the_c_program(tmp_path):
    arguments = "--backend cpu --size 96x54 --spin 0.9 --distance 20 --azimuth 30 --elevation 7 --fov 40 --samples 1"
    for name in "c.png", "c.ppm":
        subprocess.run(
            [os.environ["BHR_RENDER_FRAME"], *arguments.split(), "--output", str(tmp_path / name)],
            check=True,
            stdout=subprocess.DEVNULL,
        )
    with bhr.Context(bhr.Backend.CPU) as ctx:
        ctx.spin = 0.9
        ctx.camera = bhr.Camera.orbit(20.0, 30.0 * math.pi / 180.0, 7.0 * math.pi / 180.0, fov_y=40.0 * math.pi / 180.0)
        frame = ctx.render(96, 54)
        assert ctx.render_async(96, 54).result().array.tobytes() == frame.array.tobytes()
    frame.save(tmp_path / "python.png")
    assert (tmp_path / "python.png").read_bytes() == (tmp_path / "c.png").read_bytes() == frame.to_png()
    assert np.array_equal(bhr.load(tmp_path / "c.png").array, frame.array)
    assert (tmp_path / "c.ppm").read_bytes().endswith(frame.array[..., :3].tobytes())
    assert len(np.unique(frame.array.reshape(-1, 4), axis=0)) > 500


def test_a_frame_is_its_array(ctx):
    frame = ctx.render(32, 18)
    assert (frame.width, frame.height, frame.format) == (32, 18, bhr.Format.RGBA8_SRGB)
    assert repr(frame) == "<bhr.Frame 32 x 18, RGBA8_SRGB>"
    array = np.asarray(frame)
    assert array is frame.array and array.shape == (18, 32, 4) and array.dtype == np.uint8
    assert np.array(frame, copy=True) is not array
    assert np.asarray(frame, np.float32).dtype == np.float32
    assert np.shares_memory(np.from_dlpack(frame), array)
    assert frame.__dlpack_device__() == (1, 0)
    assert (array[..., 3] == 255).all()


@pytest.mark.parametrize(
    ("format", "dtype"), [("RGBA8_SRGB", "u1"), ("BGRA8_SRGB", "u1"), ("RGBA16F", "f2"), ("RGBA32F", "f4")]
)
def test_formats(ctx, format, dtype):
    frame = ctx.render(32, 18, format=bhr.Format[format])
    assert frame.array.dtype == np.dtype(dtype)
    if dtype == "u1":
        turned = frame.array if format == "RGBA8_SRGB" else frame.array[..., [2, 1, 0, 3]]
        assert np.array_equal(turned, ctx.render(32, 18).array)
    else:
        exact = ctx.render(32, 18, format=bhr.Format.RGBA32F).array
        assert np.allclose(frame.array.astype(np.float32), exact, rtol=1e-3, atol=1e-6)


@pytest.mark.parametrize("format", ["RGB10A2_PQ", "RGB10A2_HLG"])
def test_high_dynamic_range(ctx, format, tmp_path):
    frame = ctx.render(32, 18, format=format)
    assert frame.array.dtype == np.uint32 and frame.array.shape == (18, 32)
    assert (frame.array >> 30 == 3).all() and (frame.array & 1023).max() > 300
    again = ctx.render(out=np.zeros((18, 32), np.uint32), format=format)
    assert np.array_equal(again.array, frame.array)
    frame.save(tmp_path / "hdr.png")
    assert bhr.load(tmp_path / "hdr.png").format is bhr.Format.RGBA32F


def test_light_in_other_primaries(ctx, tmp_path):
    frame = ctx.render(32, 18, format="RGBA32F")
    light = frame.array.copy()
    frame.convert("ACESCG")
    assert frame.colour_space is bhr.ColourSpace.ACESCG
    rows = [[0.613097, 0.339523, 0.047379], [0.070194, 0.916354, 0.013452], [0.020616, 0.109570, 0.869815]]
    assert np.allclose(frame.array[..., :3], light[..., :3] @ np.array(rows).T, rtol=1e-5, atol=1e-6)
    frame.save(tmp_path / "acescg.exr")
    assert np.allclose(bhr.load(tmp_path / "acescg.exr").array, light, rtol=1e-4, atol=1e-5)
    with pytest.raises(bhr.InvalidArgument, match="colour_space"):
        ctx.render(out=frame)
    with pytest.raises(bhr.InvalidArgument, match="RGBA8_SRGB"):
        ctx.render(4, 3).convert("REC2020")


def test_out_with_any_stride(any_ctx):
    whole = any_ctx.render(32, 18).array
    wide = np.full((20, 40, 4), 7, np.uint8)
    inner = wide[1:19, 4:36]
    frame = any_ctx.render(out=inner)
    assert frame.array is inner and np.array_equal(inner, whole)
    border = np.ones(wide.shape[:2], bool)
    border[1:19, 4:36] = False
    assert (wide[border] == 7).all()
    upside_down = np.zeros((18, 32, 4), np.uint8)
    any_ctx.render(out=upside_down[::-1])
    assert np.array_equal(upside_down, whole[::-1])
    every_other = np.zeros((36, 32, 4), np.uint8)
    any_ctx.render_async(out=every_other[::2]).result()
    assert np.array_equal(every_other[::2], whole) and not every_other[1::2].any()
    again = any_ctx.render(32, 18, out=frame)
    assert again is frame


def test_one_row_and_one_column(ctx):
    assert ctx.render(out=np.zeros((1, 32, 4), np.uint8)[::-1]).array.any()
    column = np.zeros((18, 32, 4), np.uint8)
    ctx.render(out=column[:, 5:6])
    assert column[:, 5].any() and not column[:, 6:].any()


def test_arrays_that_cannot_be_frames(ctx):
    good = np.zeros((18, 32, 4), np.uint8)
    read_only = good.copy()
    read_only.flags.writeable = False
    bad = [
        (TypeError, "list", [[0]]),
        (TypeError, "bytearray", bytearray(18 * 32 * 4)),
        (TypeError, "float64", np.zeros((18, 32, 4))),
        (TypeError, "int8", np.zeros((18, 32, 4), np.int8)),
        (TypeError, "another machine", np.zeros((18, 32, 4), ">f4")),
        (TypeError, r"\(18, 32, 3\)", np.zeros((18, 32, 3), np.uint8)),
        (TypeError, r"\(18, 32\)", np.zeros((18, 32), np.uint8)),
        (TypeError, r"\(\)", np.zeros((), np.uint8)),
        (ValueError, "read-only", read_only),
        (ValueError, "not packed", good[:, ::2]),
        (ValueError, "not packed", good[:, ::-1]),
        (ValueError, "not packed", good[..., ::-1]),
        (ValueError, "not packed", np.zeros((4, 18, 32), np.uint8).transpose(1, 2, 0)),
        (ValueError, "overlap", np.lib.stride_tricks.as_strided(good, (18, 32, 4), (0, 4, 1))),
        (ValueError, "overlap", np.lib.stride_tricks.as_strided(good, (17, 32, 4), (127, 4, 1))),
        (bhr.InvalidArgument, "width", np.zeros((18, 0, 4), np.uint8)),
        (bhr.InvalidArgument, "height", np.zeros((0, 32, 4), np.uint8)),
        (
            bhr.InvalidArgument,
            "multiple of 4",
            np.zeros(18 * 32 * 16 + 1, np.uint8)[1:].view(np.float32).reshape(18, 32, 4),
        ),
        (bhr.InvalidArgument, "R32F", np.zeros((18, 32), np.float32)),
    ]
    for error, message, array in bad:
        for render in ctx.render, ctx.render_async:
            with pytest.raises(error, match=message):
                render(out=array)
    for arguments in {"width": 31}, {"height": 19}, {"format": bhr.Format.RGBA32F}, {"width": 32, "height": 17}:
        with pytest.raises((ValueError, TypeError)):
            ctx.render(out=good, **arguments)
    for missing in (), (32,):
        with pytest.raises(TypeError, match="width and height"):
            ctx.render(*missing)
    for size in (0, 18), (32, 0), (-1, 18), (2.5, 18), (2**40, 18), ("32", 18):
        with pytest.raises((ValueError, TypeError, OverflowError, MemoryError)):
            ctx.render(*size)
    assert not good.any()


def test_a_transparent_frame_leaves_the_sky_out(ctx):
    ctx.disk = None
    frame = ctx.render(32, 18, transparent=True)
    assert {0, 255} <= set(frame.array[..., 3].flat) and not frame.array[..., :3].any()


def test_a_transparent_frame_is_saved_with_straight_colours(ctx, tmp_path):
    frame = ctx.render(64, 36, transparent=True)
    frame.save(tmp_path / "frame.png")
    premultiplied, straight = frame.array.astype(int), bhr.load(tmp_path / "frame.png").array.astype(int)
    assert np.array_equal(straight[..., 3], premultiplied[..., 3])
    partly = (premultiplied[..., 3] > 50) & (premultiplied[..., 3] < 200) & (premultiplied[..., :3].max(axis=2) < 100)
    assert partly.any() and (straight > premultiplied)[partly].any() and (straight >= premultiplied)[partly].all()
    opaque = ctx.render(64, 36, out=frame)
    opaque.save(tmp_path / "frame.png")
    assert np.array_equal(bhr.load(tmp_path / "frame.png").array, frame.array)


def test_views(ctx):
    ctx.view = bhr.View.REDSHIFT
    g = np.zeros((18, 32), np.float32)
    ctx.render(out=g)
    assert np.isfinite(g).any() and np.nanmin(g) > 0.0
    assert ctx.render(32, 18).array.dtype == np.uint8
    both = ctx.render_views(32, 18, [bhr.View.REDSHIFT, bhr.View.ORDER])
    assert both.shape == (18, 32) and both.dtype.names == ("redshift", "order")
    assert np.array_equal(both["redshift"], g, equal_nan=True)
    assert set(np.unique(both["order"])) <= {-2, -1, 0, 1, 2, 3}
    assert ctx.view == bhr.View.REDSHIFT
    with pytest.raises(bhr.InvalidArgument):
        ctx.render_views(32, 18, [bhr.View.LIGHT])
    assert ctx.view == bhr.View.REDSHIFT


def test_files(ctx, tmp_path):
    light = ctx.render(32, 18, format=bhr.Format.RGBA32F)
    light.save(tmp_path / "light.exr")
    loaded = bhr.load(str(tmp_path / "light.exr"))
    assert loaded.format == bhr.Format.RGBA32F and np.array_equal(loaded.array, light.array)
    assert light._repr_png_() is None
    picture = ctx.render(32, 18, format=bhr.Format.BGRA8_SRGB)
    png = picture._repr_png_()
    assert png.startswith(b"\x89PNG") and png == ctx.render(32, 18).to_png()
    named = tmp_path / "näme.png"
    picture.save(named)
    array = bhr.load(named).array
    array[0, 0] = 1  # the memory is the frame's own, and outlives it
    assert array[0, 0, 0] == 1
    for path, error in [
        (tmp_path / "absent" / "a.png", bhr.FileError),
        (tmp_path / "a.jpeg", bhr.Error),
        (tmp_path / "a.exr", bhr.Error),
        ("a\0.png", ValueError),
        (3, TypeError),
    ]:
        with pytest.raises(error):
            picture.save(path)
    with pytest.raises(OSError, match=r"absent\.png") as caught:
        bhr.load(tmp_path / "absent.png")
    assert caught.value.status == bhr.Status.IO
    assert sorted(file.name for file in tmp_path.iterdir()) == ["light.exr", "näme.png"]


def test_a_frame_of_an_array_of_ones_own(tmp_path):
    ramp = np.zeros((4, 8, 4), np.uint8)
    ramp[..., 0], ramp[..., 3] = np.arange(8) * 30, 255
    bhr.Frame(ramp[::-1]).save(tmp_path / "ramp.png")
    assert np.array_equal(bhr.load(tmp_path / "ramp.png").array, ramp[::-1])


def test_the_sky_may_be_a_picture(ctx):
    ctx.disk, ctx.sky = None, bhr.Sky(flags=bhr.SkyFlags.MAP)
    assert not ctx.render(32, 18).array[..., :3].any()
    red = np.zeros((8, 16, 4), np.float32)
    red[..., 0] = 1.0
    ctx.set_sky_map(red)
    colours = ctx.render(32, 18).array
    assert (colours[..., 0] > 0).any() and colours[..., 0].sum() > colours[..., 2].sum()
    ctx.set_sky_map(None)
    assert not ctx.render(32, 18).array[..., :3].any()
    with pytest.raises(bhr.InvalidArgument):
        ctx.set_sky_map(np.zeros((8, 16), np.float32))


def test_outputs_beside_the_picture(any_ctx, tmp_path):
    kinds = bhr.OutputKind
    wanted = [kinds.LIGHT, kinds.DEPTH, kinds.SKY, (kinds.POSITION, 1), (kinds.VIEW, bhr.View.ORDER)]
    file = tmp_path / "layers.exr"
    light, depth, sky, second, order = any_ctx.render_outputs(32, 18, wanted, save=file)
    assert np.array_equal(light.array, any_ctx.render(32, 18, format=bhr.Format.RGBA32F).array)
    assert depth.array.shape == order.array.shape == (18, 32) and second.array.shape == (18, 32, 4)
    escaped = (sky.array != 0).any(axis=2)
    assert np.allclose(np.linalg.norm(sky.array[escaped][:, :3], axis=1), 1.0, atol=1e-5)
    assert np.isinf(depth.array[order.array == -1]).all() and (depth.array[order.array == 0] < 60).all()
    assert np.array_equal(bhr.load(file).array, light.array)
    for bad, words in [([], "count"), ([kinds.SKY] * 9, "count"), ([(kinds.DEPTH, 1)], "index")]:
        with pytest.raises(bhr.InvalidArgument, match=words):
            any_ctx.render_outputs(32, 18, bad)


def test_things_before_the_camera(any_ctx):
    whole = any_ctx.render(32, 18, transparent=True).array.copy()
    distances = np.full((18, 32), np.inf, np.float32)
    distances[:, :16] = 0.5
    any_ctx.set_occluder(distances)
    half = any_ctx.render(32, 18, transparent=True).array
    # Glare adds light, and leaves alpha as it is. Rays go on behind the disk, so that a few more pixels are refined.
    assert not half[:, :16, 3].any() and half[:, 16:, 3].max() == 255
    assert (np.abs(half[:, 16:, 3] - whole[:, 16:, 3].astype(int)) > 2).sum() <= 8
    with pytest.raises(bhr.InvalidArgument, match="16 x 18"):
        any_ctx.render(16, 18)
    for bad in np.zeros((18, 32, 4), np.uint8), np.full((18, 32), np.nan, np.float32):
        with pytest.raises(bhr.InvalidArgument):
            any_ctx.set_occluder(bad)
    any_ctx.set_occluder(None)
    assert np.array_equal(any_ctx.render(32, 18, transparent=True).array, whole)


def test_a_lens_has_depth_of_field(ctx):
    pinhole = ctx.camera
    on_lens = pinhole.through_lens(1.0, 8.0, 32 / 18, 1, 4)
    assert on_lens.projection == bhr.Projection.FRUSTUM and not np.allclose(on_lens.position, pinhole.position)

    def places():
        for i in range(4):
            ctx.camera = pinhole.through_lens(1.0, 8.0, 32 / 18, i, 4)
            yield 1.0

    soft = ctx.accumulate(places(), 32, 18).array
    ctx.camera = pinhole
    assert (soft != ctx.render(32, 18).array).any()
    with pytest.raises(bhr.Error, match="focus is 0"):
        pinhole.through_lens(1.0, 0.0, 1.5, 0, 1)
