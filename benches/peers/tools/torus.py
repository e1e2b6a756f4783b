"""The task that every tool is given: S and R of a torus patch from touched points with noise.

The torus has ring radius 30 and tube radius 10; the patch is 12 x 12 about the crest of its tube, so that S runs from
saddle-like (towards the hole) over ridge to dome-like. Heights are off by 0.03, normals by 2 degrees per tangent axis.
Answers are compared on 20 x 20 points of the inner 9.6 x 9.6, or at the contacts nearest to them.
"""
import numpy as np

RING, TUBE, HALF = 30.0, 10.0, 6.0
NOISE_Z, NOISE_DEG = 0.03, 2.0
INSET = 0.1
GRID = 20


def derivatives(x, y):
    """z, zx, zy, zxx, zxy, zyy of the torus at (x, y) from the crest, in closed form."""
    rho = np.hypot(x + RING, y)
    cx, cy = (x + RING) / rho, y / rho
    z = np.sqrt(TUBE**2 - (rho - RING) ** 2)
    f1 = -(rho - RING) / z
    f2 = -(TUBE**2) / z**3
    return z, f1 * cx, f1 * cy, f2 * cx**2 + f1 * cy**2 / rho, (f2 - f1 / rho) * cx * cy, f2 * cy**2 + f1 * cx**2 / rho


def shape(zx, zy, zxx, zxy, zyy):
    """S and R of a height field from its derivatives, signs as palpate's: cap +1, cup -1."""
    w2 = 1 + zx**2 + zy**2
    mean = ((1 + zy**2) * zxx - 2 * zx * zy * zxy + (1 + zx**2) * zyy) / (2 * w2**1.5)
    gauss = (zxx * zyy - zxy**2) / w2**2
    half = np.sqrt(np.maximum(mean**2 - gauss, 0))
    return from_principal(mean + half, mean - half)


def from_principal(k1, k2):
    """S and R of principal curvatures that are positive where the surface is hollow."""
    return -2 / np.pi * np.arctan2(k1 + k2, k1 - k2), np.sqrt((k1**2 + k2**2) / 2)


def truth(x, y):
    return shape(*derivatives(x, y)[1:])


def targets():
    """The 400 points at which answers are asked, x outermost."""
    side = np.linspace(-HALF * (1 - 2 * INSET), HALF * (1 - 2 * INSET), GRID)
    x, y = np.meshgrid(side, side, indexing="ij")
    return x.ravel(), y.ravel()


def contacts(count, seed):
    """x, y, z with noise, and unit normals with noise (count x 3)."""
    draw = np.random.default_rng(seed)
    x, y = draw.uniform(-HALF, HALF, (2, count))
    z, zx, zy = derivatives(x, y)[:3]
    normals = np.column_stack([-zx, -zy, np.ones(count)])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    error = draw.normal(0, np.radians(NOISE_DEG), (count, 3))
    error -= np.sum(error * normals, axis=1, keepdims=True) * normals
    normals = normals + error
    return x, y, z + draw.normal(0, NOISE_Z, count), normals / np.linalg.norm(normals, axis=1, keepdims=True)


def pixels(side, seed):
    """The same patch as an image: side x side heights with noise, and the pixels' places along one edge."""
    draw = np.random.default_rng(seed)
    at = np.linspace(-HALF, HALF, side)
    x, y = np.meshgrid(at, at, indexing="ij")
    return at, derivatives(x, y)[0] + draw.normal(0, NOISE_Z, x.shape)
