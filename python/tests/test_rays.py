# SPDX-License-Identifier: MIT OR Apache-2.0
"""Rays: their ends against theory, their arrays, and what is refused."""

import math

import bhr
import numpy as np
import pytest


def carlson_rf(x, y, z):
    """Carlson's symmetric elliptic integral of the first kind, by his duplication theorem."""
    for _ in range(60):
        step = math.sqrt(x * y) + math.sqrt(y * z) + math.sqrt(z * x)
        x, y, z = (x + step) / 4.0, (y + step) / 4.0, (z + step) / 4.0
    return 1.0 / math.sqrt((x + y + z) / 3.0)


def elliptic_f(sine, k2):
    return sine * carlson_rf(1.0 - sine * sine, 1.0 - k2 * sine * sine, 1.0)


def darwin(periastron, distance):
    """The orbit angle of light from a distance, past its periastron, to infinity: Darwin 1959, for M = 1."""
    p = periastron
    q = math.sqrt((p - 2.0) * (p + 6.0))
    k2 = (q - p + 6.0) / (2.0 * q)
    half = elliptic_f(1.0, k2)

    def rest(r_inverse):
        return elliptic_f(math.sqrt((q - p + 2.0 + 4.0 * p * r_inverse) / (q - p + 6.0)), k2)

    return 2.0 * math.sqrt(p / q) * (2.0 * half - rest(1.0 / distance) - rest(0.0))


def ray_with_periastron(periastron, distance):
    impact = periastron**1.5 / math.sqrt(periastron - 2.0)
    sine = impact * math.sqrt(1.0 - 2.0 / distance) / distance
    return (-math.sqrt(1.0 - sine * sine), sine, 0.0)


@pytest.mark.parametrize("method", [bhr.Method.ADAPTIVE, bhr.Method.AUTO])
def test_deflection_is_darwins(ctx, method):
    ctx.quality = bhr.Quality(method=method, tolerance=1e-12)
    periastra = np.array([3.001, 3.01, 3.2, 4.0, 6.0, 10.0, 30.0, 90.0])
    rays = bhr.rays((100.0, 0.0, 0.0), [ray_with_periastron(p, 100.0) for p in periastra])
    hits = ctx.trace(rays)
    assert (hits["fate"] == bhr.Fate.ESCAPED).all()
    expected = np.array([darwin(p, 100.0) for p in periastra])
    # Rays near the photon sphere magnify every error.
    allowed = (1e-9 if method == bhr.Method.ADAPTIVE else 1e-6) * (1.0 + 1.0 / (periastra - 3.0))
    assert (np.abs(hits["swept_angle"] - expected) < allowed).all()
    directions = hits["sky_direction"]
    turned = np.arctan2(directions[:, 1], directions[:, 0]) % (2.0 * math.pi)
    assert (np.abs(turned - expected % (2.0 * math.pi)) < allowed).all()


def test_arrays_of_any_shape(any_ctx):
    rays = any_ctx.camera_rays(8, 6)
    assert rays.shape == (6, 8) and rays.dtype == bhr.RAY
    hits = any_ctx.trace(rays)
    assert hits.shape == (6, 8) and hits.dtype == bhr.HIT
    assert any_ctx.trace(rays[::2, ::-1]).tobytes() == hits[::2, ::-1].tobytes()
    out = np.zeros((6, 8), bhr.HIT)
    assert any_ctx.trace(rays, out=out) is out and out.tobytes() == hits.tobytes()
    one = any_ctx.camera_ray(8, 6, 3.5, 2.5)
    assert one.shape == () and np.allclose(one["direction"], rays[2, 3]["direction"], rtol=1e-12)
    assert any_ctx.trace(one).shape == any_ctx.trace(rays[2, 3]).shape == ()
    assert any_ctx.trace(rays[2, 3]).tobytes() == hits[2, 3].tobytes()
    assert any_ctx.trace(rays[:0]).shape == (0, 8)
    crossed = hits[hits["crossing_count"] > 0]
    assert crossed.size and (crossed["crossings"]["radius"][:, 0] > 0.0).all()


def test_rays_are_made_by_broadcasting():
    made = bhr.rays(np.zeros((4, 1, 3)) + 9.0, np.ones((5, 3)), np.arange(1.0, 6.0))
    assert made.shape == (4, 5) and (made["frequency_ratio"][2] == np.arange(1.0, 6.0)).all()
    for position, direction in [(1.0, (1, 0, 0)), ((1, 2), (1, 0, 0)), (np.zeros((4, 3)), np.zeros((3, 3)))]:
        with pytest.raises(ValueError):
            bhr.rays(position, direction)


def test_a_bad_ray_is_no_error(ctx):
    rays = bhr.rays((20.0, 0.0, 0.0), [(-1.0, 0.0, 0.0), (0.0, 0.0, 0.0), (math.nan, 0.0, 0.0), (1.0, 0.0, 0.0)])
    fates = [bhr.Fate.CAPTURED, bhr.Fate.INVALID, bhr.Fate.INVALID, bhr.Fate.ESCAPED]
    assert ctx.trace(rays)["fate"].tolist() == fates


def test_arrays_that_are_no_rays(ctx):
    rays = ctx.camera_rays(4, 3)
    for bad in [[1.0]], np.zeros((4, 7)), np.zeros(3, bhr.HIT), None:
        with pytest.raises(TypeError, match="RAY"):
            ctx.trace(bad)
    read_only = np.zeros((3, 4), bhr.HIT)
    read_only.flags.writeable = False
    for out in np.zeros((4, 3), bhr.HIT), np.zeros((3, 4)), np.zeros((3, 8), bhr.HIT)[:, ::2], read_only:
        with pytest.raises(ValueError, match="out"):
            ctx.trace(rays, out=out)


def test_a_path_is_the_rays(ctx):
    ray = bhr.rays((30.0, 0.0, 0.0), ray_with_periastron(5.0, 30.0))
    path = ctx.trace_path(ray)
    assert path.ndim == 2 and path.shape[1] == 4 and len(path) > 20
    assert path[0].tolist() == [30.0, 0.0, 0.0, 0.0] and (np.diff(path[:, 3]) <= 0.0).all()
    radius = np.linalg.norm(path[:, :3], axis=1)
    assert 4.999 < radius.min() < 5.1 and radius[-1] > 999.0
    assert len(ctx.trace_path(ctx.camera_rays(4, 3)[1, 2], capacity=9)) <= 9
    with pytest.raises(ValueError, match="12 rays"):
        ctx.trace_path(ctx.camera_rays(4, 3))
    with pytest.raises(bhr.InvalidArgument):
        ctx.trace_path(bhr.rays((30.0, 0.0, 0.0), (0.0, 0.0, 0.0)))
    with pytest.raises(bhr.InvalidArgument):
        ctx.trace_path(ray, capacity=1)


def test_matter_along_rays_is_summed(ctx):
    """Far from the hole rays are chords of a Gaussian cloud: its depth is kappa sqrt(2 pi) R e^(-b^2 / 2 R^2)."""
    cloud = bhr.Volume(
        shape=bhr.VolumeShape.HALO,
        flow=bhr.Flow.ANGULAR_MOMENTUM,
        flags=bhr.VolumeFlags.POWER_LAW,
        angular_momentum=0.0,
        radius=1000.0,
        outer_radius=9000.0,
        thickness=1e6,
        absorption=1e-4,
        spectral_index=-2.5,
        turbulence=0.0,
    )
    ctx.volumes = [cloud]
    assert ctx.volumes == (cloud,)
    impact = np.array([[400.0, 800.0], [1200.0, 1600.0]])
    position = np.stack([np.full_like(impact, 1e4), impact, np.zeros_like(impact)], axis=-1)
    found = ctx.transfer(bhr.rays(position, (-1.0, 0.0, 0.0)))
    depth = 0.1 * math.sqrt(2.0 * math.pi) * np.exp(-0.5 * (impact / 1000.0) ** 2)
    assert found.shape == (2, 2) and np.all(found["fate"] == bhr.Fate.ESCAPED)
    assert np.allclose(found["optical_depth"], depth, rtol=5e-3)
    assert np.allclose(found["intensity"], 1e4 * (1.0 - np.exp(-depth)), rtol=1e-2)
    with pytest.raises(bhr.InvalidArgument, match="volume count is 5"):
        ctx.volumes = [cloud] * 5
    spots = [bhr.HotSpot(azimuth=float(i), flags=bhr.HotSpotFlags.THERMAL) for i in range(8)]
    ctx.hot_spots = spots
    assert ctx.hot_spots == tuple(spots)
    ctx.volumes, ctx.hot_spots = [], []
    assert ctx.volumes == () and ctx.transfer(bhr.rays((20.0, 0.0, 0.0), (-1.0, 1.0, 0.0)))["intensity"] == 0.0


def test_points_on_the_screen(ctx):
    ctx.camera = bhr.Camera.orbit(25.0, 0.3, 0.2)
    direct = ctx.project_point(320, 180, (2.0, -8.0, 1.0))
    assert direct.found and direct.on_screen and direct.magnification > 0.0 and direct.delay > 20.0
    ray = ctx.camera_ray(320, 180, direct.x, direct.y)
    assert np.allclose(ray["direction"], direct.ray["direction"], atol=1e-12)
    path = ctx.trace_path(direct.ray, 60000)
    assert np.linalg.norm(path[:, :3] - (2.0, -8.0, 1.0), axis=1).min() < 0.01
    other = ctx.project_point(320, 180, (2.0, -8.0, 1.0), order=1)
    assert other.found and other.magnification < 0.0 and other.delay > direct.delay
    assert not ctx.project_point(320, 180, (0.1, 0.0, 0.0)).found
    assert np.allclose(np.linalg.norm(np.subtract(direct.apparent, ctx.camera.position)), direct.distance)
    many = ctx.project_points(320, 180, [[(2.0, -8.0, 1.0), (0.1, 0.0, 0.0)]])
    assert many.shape == (1, 2) and list(many["found"][0]) == [1, 0] and many["x"][0, 0] == direct.x
    with pytest.raises(ValueError, match="last side"):
        ctx.project_points(320, 180, [[1.0, 2.0]])
    with pytest.raises(bhr.InvalidArgument):
        ctx.project_point(320, 180, (2.0, -8.0, 1.0), order=4)


def test_bodies_in_free_fall(ctx):
    # From rest at infinity, without spin: r^(3/2) falls evenly in proper time, which is the chart's.
    times = np.array([[0.0, -4.0], [5.0, 1000.0]])
    fall = ctx.world_line((0.0, 0.0, 12.0), (0.0, 0.0, 0.0), times, chart="rain", time=3.0)
    assert fall.shape == (2, 2) and fall.dtype == bhr.BODY
    assert np.all(fall["end"][times < 100.0] == bhr.WorldLineEnd.GOES_ON)
    assert fall["end"][1, 1] == bhr.WorldLineEnd.INNER_HORIZON and 0.0 < fall["proper_time"][1, 1] < 20.0
    before = times < 100.0
    radius = (12.0**1.5 - 1.5 * math.sqrt(2.0) * times[before]) ** (2.0 / 3.0)
    assert np.allclose(fall["position"][before], radius[:, np.newaxis] * (0.0, 0.0, 1.0), rtol=1e-10, atol=1e-10)
    assert np.allclose(fall["time"][before], 3.0 + times[before], rtol=1e-10)
    assert np.array_equal(fall["proper_time"][before], times[before])
    # Round a spinning hole and back, from where the line has come to.
    ctx.spin = 0.9
    there = ctx.world_line((10.0, 0.0, 0.0), (0.0, 0.3, 0.1), 80.0)
    assert there.shape == () and there["chart"] == bhr.Chart.STATIC
    back = ctx.world_line(there["position"], there["velocity"], [-80.0], time=there["time"])[0]
    assert np.allclose(back["position"], (10.0, 0.0, 0.0), atol=1e-9) and abs(back["time"]) < 1e-8
    assert ctx.world_line((10.0, 0.0, 0.0), (0.0, 0.0, 0.0), []).shape == (0,)
    with pytest.raises(bhr.InvalidArgument, match="velocity"):
        ctx.world_line((10.0, 0.0, 0.0), (0.0, 1.0, 0.0), [1.0])
    with pytest.raises(bhr.InvalidArgument, match=r"proper_times\[1\]"):
        ctx.world_line((10.0, 0.0, 0.0), (0.0, 0.0, 0.0), [1.0, math.nan])
    with pytest.raises(ValueError, match="position"):
        ctx.world_line((10.0, 0.0), (0.0, 0.0, 0.0), [1.0])
