# SPDX-License-Identifier: MIT OR Apache-2.0
"""Turns nested outlines of the Milky Way into milky_way.png, as README.md here describes it.

    python3 pack_milky_way.py milky_way_outlines.json milky_way.png

Needs numpy, scipy and Pillow. Between two outlines the height of a place is the outer one's number plus its share of the way to the
inner one, so that nested steps become a slope; outside the first it falls off with the distance.
"""

import json
import sys

import numpy as np
from PIL import Image
from scipy.ndimage import gaussian_filter1d
from scipy.spatial import cKDTree

WIDTH, HEIGHT = 1024, 512
LEVELS = 5
# Degrees: e-folding of the glow beyond the first outline, of its rise inside the last; radius of the final smoothing; steps along outlines.
FALL, RISE, SMOOTH, STEP = 5.0, 2.0, 0.45, 0.1


def unit(ra, dec):
    ra, dec = np.radians(ra), np.radians(dec)
    return np.stack([np.cos(dec) * np.cos(ra), np.cos(dec) * np.sin(ra), np.sin(dec)], axis=-1)


def edges(feature):
    """Both ends of each edge, degrees; closed rings."""
    rings = [np.array(ring) for polygon in feature["geometry"]["coordinates"] for ring in polygon]
    begin = np.concatenate([ring for ring in rings])
    end = np.concatenate([np.roll(ring, -1, axis=0) for ring in rings])
    return begin, end


def inside(begin, end, ra, dec):
    """Even-odd rule along each meridian from the north pole, which lies outside: columns x rows."""
    result = np.zeros((len(ra), len(dec)), dtype=bool)
    change = (end[:, 0] - begin[:, 0] + 180.0) % 360.0 - 180.0
    for column, meridian in enumerate(ra):
        # The meridian lies on the edge if it is at [0, change) or (change, 0] of its begin.
        along = (meridian - begin[:, 0] + 180.0) % 360.0 - 180.0
        crossed = ((along >= 0) & (along < change)) | ((along < 0) & (along >= change))
        share = along[crossed] / change[crossed]
        at = begin[crossed, 1] + (end[crossed, 1] - begin[crossed, 1]) * share
        result[column] = (at[None, :] > dec[:, None]).sum(axis=1) % 2 == 1
    return result


def distance(begin, end, places):
    """Degrees from the nearest edge."""
    parts = []
    for a, b in zip(unit(*begin.T), unit(*end.T)):
        count = max(1, int(np.degrees(np.linalg.norm(a - b)) / STEP))
        parts.append(a + (b - a) * np.arange(count)[:, None] / count)
    chord, _ = cKDTree(np.concatenate(parts)).query(places)
    return np.degrees(2.0 * np.arcsin(np.minimum(chord / 2.0, 1.0)))


def main(source, target):
    with open(source, encoding="utf-8") as file:
        features = sorted(json.load(file)["features"], key=lambda feature: feature["id"])
    ra = 360.0 * (0.5 - (np.arange(WIDTH) + 0.5) / WIDTH)
    dec = 180.0 * (0.5 - (np.arange(HEIGHT) + 0.5) / HEIGHT)
    places = unit(*np.broadcast_arrays(ra[None, :], dec[:, None]))
    outlines = [edges(feature) for feature in features]
    level = np.zeros((HEIGHT, WIDTH), dtype=int)
    for begin, end in outlines:
        level += inside(begin, end, ra, dec).T
    away = np.stack([distance(begin, end, places) for begin, end in outlines])
    height = np.where(level == 0, np.exp(-away[0] / FALL), 0.0)
    for i in range(1, LEVELS):
        outer, inner = away[i - 1], away[i]
        height = np.where(level == i, i + outer / np.maximum(outer + inner, 1e-9), height)
    height = np.where(level >= LEVELS, LEVELS + 1.0 - np.exp(-away[-1] / RISE), height)
    texel = 180.0 / HEIGHT
    height = gaussian_filter1d(height, SMOOTH / texel, axis=0, mode="nearest")
    for row in range(HEIGHT):
        height[row] = gaussian_filter1d(height[row], min(SMOOTH / texel / np.cos(np.radians(dec[row])), WIDTH / 6), mode="wrap")
    codes = np.round(height * 255.0 / (LEVELS + 1.0)).clip(0, 255).astype(np.uint8)
    Image.fromarray(codes).save(target, optimize=True)
    print(f"{WIDTH} x {HEIGHT}, heights {height.min():.2f} to {height.max():.2f}")


if __name__ == "__main__":
    main(*sys.argv[1:])
