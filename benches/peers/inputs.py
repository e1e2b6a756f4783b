"""Inputs of the five workloads, the same for every peer: numpy default_rng(2026).

    python inputs.py DIRECTORY

Writes little-endian doubles: w1.bin, w2.bin, w2l.bin (columns x, y, z, zx, zy), w3.bin (axes x, y, images z, zx, zy,
row-major [x, y]), w4.bin (W1's sites with noise-free data), w5.bin (67 x 67 coefficients).
"""
import os
import sys

import numpy as np

SEED = 2026


def height(x, y):
    return 0.3 * np.sin(6 * x) * np.cos(5 * y) + 0.1 * x * y


def slope_x(x, y):
    return 1.8 * np.cos(6 * x) * np.cos(5 * y) + 0.1 * y


def slope_y(x, y):
    return -1.5 * np.sin(6 * x) * np.sin(5 * y) + 0.1 * x


def cylinder(x, y, radius=6.6, axis=np.deg2rad(30.0)):
    """Convex cylinder, apex at z = 0: heights and slopes."""
    u = -x * np.sin(axis) + y * np.cos(axis)
    r = np.sqrt(radius**2 - u * u)
    return r - radius, u / r * np.sin(axis), -u / r * np.cos(axis)


def paper():
    rng = np.random.default_rng(SEED)
    x = np.repeat([-4.0, 0.0, 4.0], 12) + rng.normal(0, 0.10, 36)
    y = np.tile(np.repeat(np.linspace(-4, 4, 6), 2), 3) + rng.normal(0, 0.10, 36)
    exact = cylinder(x, y)
    noisy = [v + rng.normal(0, sd, 36) for v, sd in zip(exact, (0.02, 0.05, 0.05))]
    return [x, y, *noisy], [x, y, *exact]


def scattered(count):
    rng = np.random.default_rng(SEED)
    x, y = rng.random(count), rng.random(count)
    return [
        x,
        y,
        height(x, y) + rng.normal(0, 1e-3, count),
        slope_x(x, y) + rng.normal(0, 1e-2, count),
        slope_y(x, y) + rng.normal(0, 1e-2, count),
    ]


def image(nx=640, ny=480):
    rng = np.random.default_rng(SEED)
    x, y = (np.arange(nx) + 0.5) / nx, 0.75 * (np.arange(ny) + 0.5) / ny
    gx, gy = np.meshgrid(x, y, indexing="ij")
    return [
        x,
        y,
        height(gx, gy) + rng.normal(0, 1e-3, gx.shape),
        slope_x(gx, gy) + rng.normal(0, 1e-2, gx.shape),
        slope_y(gx, gy) + rng.normal(0, 1e-2, gx.shape),
    ]


def knots(segments, lo, hi, degree):
    return np.r_[[lo] * degree, np.linspace(lo, hi, segments + 1), [hi] * degree].astype(float)


def interpolant(segments=64):
    """Coefficients of the bicubic that meets the height at the Greville points."""
    from scipy.interpolate import BSpline

    t = knots(segments, 0, 1, 3)
    greville = np.array([t[i + 1 : i + 4].mean() for i in range(segments + 3)])
    basis = BSpline.design_matrix(greville, t, 3).toarray()
    gx, gy = np.meshgrid(greville, greville, indexing="ij")
    return np.linalg.solve(basis, np.linalg.solve(basis, height(gx, gy)).T).T


def write_all(directory):
    os.makedirs(directory, exist_ok=True)

    def write(name, arrays):
        np.concatenate([np.ravel(a) for a in arrays]).astype("<f8").tofile(os.path.join(directory, name))

    noisy, exact = paper()
    write("w1.bin", noisy)
    write("w4.bin", exact)
    write("w2.bin", scattered(200_000))
    write("w2l.bin", scattered(1_000_000))
    write("w3.bin", image())
    write("w5.bin", [interpolant()])


if __name__ == "__main__":
    write_all(sys.argv[1])
