"""Twenty closed bodies that are no primitive, as the zeros of functions that grow outwards, and how each is touched.

Most are an ellipsoid, a ball or several in a space that is bent, tapered, twisted or joined smoothly. Lengths are in mm; bodies are some 40
to 70 long.
"""
import numpy as np
from skimage.measure import marching_cubes

BOX, CELLS, STEP = 45.0, 90, 1e-3
NOISE_Z, NOISE_DEG, FALSE = 0.1, 3.0, 0.05


def ellipsoid(p, half, power=2.0):
    return (np.sum(np.abs(p / np.array(half)) ** power, axis=-1) ** (1 / power) - 1) * min(half)


def ball(p, centre, radius):
    return np.linalg.norm(p - np.array(centre), axis=-1) - radius


def capsule(p, a, b, radius):
    a, b = np.array(a), np.array(b)
    t = np.clip((p - a) @ (b - a) / np.sum((b - a) ** 2), 0, 1)
    return np.linalg.norm(p - a - t[..., None] * (b - a), axis=-1) - radius


def joined(width, *parts):
    """The least of several, with roundings of this width where they meet."""
    least = np.min(parts, axis=0)
    return least - width * np.log(np.sum(np.exp(-(np.array(parts) - least) / width), axis=0))


def bent(p, radius):
    """Space bent about the y axis, so that x runs along a circle of this radius."""
    x, y, z = np.moveaxis(p, -1, 0)
    return np.stack([radius * np.arctan2(x, radius + z), y, np.hypot(x, radius + z) - radius], -1)


def tapered(p, per_mm):
    wide = np.exp(per_mm * p[..., :1])
    return np.concatenate([p[..., :1], p[..., 1:] * wide], -1)


def twisted(p, per_mm):
    x, y, z = np.moveaxis(p, -1, 0)
    c, s = np.cos(per_mm * x), np.sin(per_mm * x)
    return np.stack([x, c * y + s * z, c * z - s * y], -1)


def blob(seed, size):
    """A ball of radius 20 whose radius varies by terms of third and fourth degree in the direction."""
    draw = np.random.default_rng(seed)
    axes = draw.normal(size=(6, 3))
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    weights, powers = draw.normal(0, size, 6), (2, 3, 3, 4, 4, 3)

    def at(p):
        far = np.linalg.norm(p, axis=-1)
        way = p / np.maximum(far, 1e-9)[..., None]
        return far - 20 * (1 + sum(w * (way @ a) ** k for w, a, k in zip(weights, axes, powers)))

    return at


BODIES = {
    "banana": lambda p: ellipsoid(bent(p, 35.0), (32, 9, 9)),
    "bean": lambda p: ellipsoid(bent(p, 25.0), (24, 13, 11)),
    "pear": lambda p: ellipsoid(tapered(p, 0.022), (30, 15, 15)),
    "egg": lambda p: ellipsoid(tapered(p, 0.01), (26, 18, 18)),
    "drop": lambda p: ellipsoid(tapered(p, 0.04), (26, 13, 11)),
    "cushion": lambda p: ellipsoid(p, (25, 20, 12), 3.0),
    "soap": lambda p: ellipsoid(p, (26, 17, 11), 4.0),
    "twisted bar": lambda p: ellipsoid(twisted(p, 0.025), (30, 14, 9), 2.6),
    "dented ball": lambda p: ball(p, (0, 0, 0), 20) + 5 * np.exp(-np.sum((p - np.array([0, 8, 19])) ** 2, axis=-1) / 120),
    "peanut": lambda p: joined(3.0, ball(p, (-13, 0, 0), 14), ball(p, (13, 0, 0), 12)),
    "dumbbell": lambda p: joined(3.0, ball(p, (-20, 0, 0), 12), ball(p, (20, 0, 0), 12), capsule(p, (-20, 0, 0), (20, 0, 0), 6)),
    "drill": lambda p: joined(3.0, capsule(p, (-22, 0, 12), (22, 0, 12), 9), capsule(p, (-12, 0, 8), (-16, 0, -22), 7)),
    "mushroom": lambda p: joined(2.5, ellipsoid(p - np.array([0, 0, 10]), (24, 24, 11)), capsule(p, (0, 0, 5), (0, 0, -24), 8)),
    "gourd": lambda p: joined(4.0, ball(p, (-10, 0, 0), 17), ball(p, (16, 2, 3), 10)),
    "metaballs": lambda p: joined(3.5, ball(p, (0, 0, 0), 14), ball(p, (14, 6, 4), 9), ball(p, (-10, 10, -6), 10), ball(p, (2, -14, 8), 8)),
    "bottle": lambda p: joined(3.0, capsule(p, (-14, 0, 0), (6, 0, 0), 14), capsule(p, (6, 0, 0), (30, 0, 0), 6)),
    "blob 1": blob(1, 0.15),
    "blob 2": blob(2, 0.15),
    "blob 3": blob(3, 0.25),
    "blob 4": blob(4, 0.25),
}


def gradient(body, p, h=STEP):
    return np.stack([(body(p + h * e) - body(p - h * e)) / (2 * h) for e in np.eye(3)], -1)


def hessian(body, p, h=1e-2):
    return np.stack([(gradient(body, p + h * e) - gradient(body, p - h * e)) / (2 * h) for e in np.eye(3)], -1)


def curvatures(g, H):
    """k1 >= k2 of a level set from its gradient (outwards) and Hessian, negative where the body bulges, as palpate's."""
    size = np.linalg.norm(g, axis=-1)
    n = g / size[..., None]
    P = np.eye(3) - n[..., :, None] * n[..., None, :]
    W = -P @ H @ P / size[..., None, None]
    mean = 0.5 * np.trace(W, axis1=-2, axis2=-1)
    half = np.sqrt(np.maximum(0.5 * np.sum(W * np.swapaxes(W, -1, -2), axis=(-2, -1)) - mean**2, 0))
    return mean + half, mean - half


def foot(body, p, steps=8):
    """Points of the body near these, along its gradient, and the signed distances to them."""
    q = p.copy()
    for _ in range(steps):
        g = gradient(body, q)
        q = q - (body(q) / np.sum(g * g, axis=-1))[:, None] * g
    g = gradient(body, q)
    n = g / np.linalg.norm(g, axis=-1, keepdims=True)
    return q, np.sum((p - q) * n, axis=-1), n


def surface_points(name, count, draw):
    """Points even over the body's area, with outward normals."""
    body = BODIES[name]
    side = np.linspace(-BOX, BOX, CELLS)
    volume = body(np.stack(np.meshgrid(side, side, side, indexing="ij"), -1))
    vertices, faces, _, _ = marching_cubes(volume, 0.0)
    corners = (vertices * (side[1] - side[0]) - BOX)[faces]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    chosen = draw.choice(len(faces), count, p=area / area.sum())
    share = draw.dirichlet(np.ones(3), count)
    q, _, n = foot(body, np.einsum("nk,nkd->nd", share, corners[chosen]))
    return q, n


def touched(name, count, seed):
    """Contacts with normals: errors along and across, and one in twenty somewhere else."""
    draw = np.random.default_rng([seed, count, list(BODIES).index(name)])
    q, n = surface_points(name, count, draw)
    error = draw.normal(0, np.radians(NOISE_DEG), q.shape)
    m = n + error - np.sum(error * n, axis=1, keepdims=True) * n
    p = q + draw.normal(0, NOISE_Z, (count, 1)) * n
    false = draw.random(count) < FALSE
    p[false] += (draw.choice([-1, 1], false.sum()) * draw.uniform(2, 6, false.sum()))[:, None] * n[false]
    m[false] = draw.normal(size=(false.sum(), 3))
    return p, m / np.linalg.norm(m, axis=1, keepdims=True)
