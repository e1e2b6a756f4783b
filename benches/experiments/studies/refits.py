"""W4's scene with sites that move, by SciPy: design matrices by `BSpline`, one `lstsq` a replicate.

    python refits.py REPLICATES     prints fits a second, mean and sd of S, mean and sd of R
"""
import math
import os
import sys
import time

import numpy as np
from scipy.interpolate import BSpline
from scipy.linalg import lstsq

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "peers"))
from numpy_peers import ROOTS, grid_operator, shape_of

KNOTS = [-4.5] * 3 + [4.5] * 3
VALUES = BSpline(KNOTS, np.eye(3), 2)
SLOPES = VALUES.derivative()


def main():
    count = int(sys.argv[1])
    x, y = np.repeat([-4.0, 0.0, 4.0], 12), np.tile(np.repeat(np.linspace(-4, 4, 6), 2), 3)
    across = -x * math.sin(math.pi / 6) + y * math.cos(math.pi / 6)
    depth = np.sqrt(6.6**2 - across**2)
    z, zx, zy = depth - 6.6, across / depth * math.sin(math.pi / 6), -across / depth * math.cos(math.pi / 6)
    operator, generator = grid_operator(), np.random.default_rng(2026)
    khatri_rao = lambda p, q: (p[:, :, None] * q[:, None, :]).reshape(-1, 9)
    found = np.empty((2, count))
    start = time.perf_counter()
    for k in range(count):
        dx, dy, dz = 0.05 * generator.standard_normal((3, 36))
        bx, by, ex, ey = VALUES(x + dx), VALUES(y + dy), SLOPES(x + dx), SLOPES(y + dy)
        rows = np.concatenate([ROOTS[0] * khatri_rao(bx, by), ROOTS[1] * khatri_rao(ex, by), ROOTS[2] * khatri_rao(bx, ey)])
        right = np.concatenate([ROOTS[0] * (z + dz), ROOTS[1] * zx, ROOTS[2] * zy])
        c = lstsq(rows, right, check_finite=False)[0]
        s, r = shape_of(*(operator @ c).reshape(5, 64))
        found[:, k] = s.mean(), r.mean()
    seconds = time.perf_counter() - start
    (s, r), (ds, dr) = found.mean(axis=1), found.std(axis=1)
    print(f"{count / seconds:.1f} {s:.6f} {ds:.6f} {r:.6f} {dr:.6f}")


if __name__ == "__main__":
    main()
