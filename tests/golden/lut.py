#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""lut.py > lut.json: colours through three-dimensional lookup tables by tetrahedral interpolation, with numpy in f64.

Shares no formula with bhr's: of the six tetrahedra of a cell, each by the order in which a path along its edges leaves
its first corner for the opposite one, the one is found that holds the place, by its barycentric coordinates, for which
a linear system is solved; bhr sorts the parts of the place instead. Both are what Kasson, Nin, Plouffe and Hafner
(1995) call tetrahedral interpolation."""
import itertools
import json

import numpy as np


def table(side):
    """Nodes [b, g, r], numbers of f32 from -0.25 to 1.25 without any order, which tests make anew."""
    n = np.arange(3 * side**3, dtype=np.uint64)
    n = (n * np.uint64(2654435761) + np.uint64(12345)) % np.uint64(2**32)
    n = ((n ^ (n >> np.uint64(15))) * np.uint64(2246822519)) % np.uint64(2**32)
    return (((n >> np.uint64(20)).astype(np.float64) / 4096.0) * 1.5 - 0.25).reshape(side, side, side, 3)


def through(nodes, low, high, strength, colour):
    side = nodes.shape[0]
    place = np.clip((np.array(colour) - low) / (np.array(high) - low), 0.0, 1.0) * (side - 1)
    corner = np.minimum(np.floor(place), side - 2).astype(int)
    part = place - corner
    for order in itertools.permutations(range(3)):
        corners = [np.zeros(3)]
        for axis in order:
            corners.append(corners[-1] + np.eye(3)[axis])
        system = np.vstack([np.array(corners).T, np.ones(4)])
        weights = np.linalg.solve(system, np.append(part, 1.0))
        if np.all(weights >= -1e-12):
            break
    else:
        raise ValueError(colour)
    found = np.zeros(3)
    for weight, at in zip(weights, corners):
        r, g, b = corner + at.astype(int)
        found += weight * nodes[b, g, r]
    return (1.0 - strength) * np.array(colour) + strength * np.clip(found, 0.0, 1.0)


def main():
    random = np.random.default_rng(7)
    cases = []
    for side, low, high, strength in [
        (17, [0.0] * 3, [1.0] * 3, 1.0),
        (65, [0.0] * 3, [1.0] * 3, 1.0),
        (17, [-0.5, 0.25, 0.0], [1.5, 0.75, 2.0], 1.0),
        (2, [0.0] * 3, [1.0] * 3, 0.75),
    ]:
        nodes = table(side)
        # Multiples of 2^-16, which f32 has; and greys, faces, edges and nodes.
        points = (random.integers(0, 65537, (60, 3)) / 65536.0).tolist()
        points += [[v, v, v] for v in (random.integers(0, 65537, 6) / 65536.0).tolist()]
        points += [[a, a, b] for a, b in (random.integers(0, 65537, (4, 2)) / 65536.0).tolist()]
        points += [[b, a, a] for a, b in (random.integers(0, 65537, (4, 2)) / 65536.0).tolist()]
        points += [[a, b, a] for a, b in (random.integers(0, 65537, (4, 2)) / 65536.0).tolist()]
        points += [list(map(float, p)) for p in itertools.product([0, 1], repeat=3)]
        points += [[0.5, 0.25, 0.75], [0.0625, 0.9375, 0.5], [1.0, 0.5, 0.0]]
        results = [through(nodes, low, high, strength, point).tolist() for point in points]
        case = {"side": side, "low": low, "high": high, "strength": strength}
        cases.append(case | {"colours": points, "become": results})
    header = {
        "file": "lut.json",
        "source": "tests/golden/lut.py, numpy, f64",
        "nodes": "number n of the table, red of the first node being 0: m = (2654435761 n + 12345) mod 2^32, "
        "m = 2246822519 (m xor (m >> 15)) mod 2^32, value 1.5 (m >> 20) / 4096 - 0.25",
    }
    print(json.dumps({"header": header, "cases": cases}, separators=(",", ":")))


main()
