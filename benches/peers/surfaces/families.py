"""Eight kinds of smooth surface as heights over x and y, their true S and R, and how each is touched.

    torus      crest of a tube of radius 10 in a ring of 30          bump       a gaussian of height 1.5 and width 3 on a plane
    wave       height 0.5, length 9, turned by 20 degrees            bottle     a shoulder: radius 14 to 8 within some 6 along y
    ellipsoid  semi-axes 20, 14, 10 beside its top                   face       |x/14|^2.8 + |y/14|^2.8 + |z/10|^2.8 = 1
    asphere    a conic of radius 20 with a scratch 0.1 deep          pipe       radius 10.675, with what a scanner does to it

Patches are 12 x 12. Heights err by 0.03 and normals by 2 degrees per tangent axis; those of the pipe err together over 1.5 as well, are
written in steps of 0.01, and one in fifty lies 0.5 off. Lengths are in mm.
"""
import numpy as np

HALF, NOISE_Z, NOISE_DEG = 6.0, 0.03, 2.0
STEP = 1e-3


def torus(x, y):
    return np.sqrt(100 - (np.hypot(x + 30, y) - 30) ** 2) - 10


def bump(x, y):
    return 1.5 * np.exp(-((x - 0.7) ** 2 + (y + 0.5) ** 2) / 18)


def wave(x, y):
    return 0.5 * np.sin(2 * np.pi / 9 * (np.cos(0.35) * x + np.sin(0.35) * y) + 0.4)


def bottle(x, y):
    return np.sqrt((11 - 3 * np.tanh((y - 0.5) / 3)) ** 2 - x**2) - 11


def ellipsoid(x, y):
    return 10 * np.sqrt(1 - ((x + 3) / 20) ** 2 - ((y - 2) / 14) ** 2) - 10


def face(x, y):
    return 10 * (1 - np.abs((x - 1.5) / 14) ** 2.8 - np.abs((y + 1) / 14) ** 2.8) ** (1 / 2.8) - 10


def asphere(x, y):
    square = x**2 + y**2
    form = -square / (20 + np.sqrt(400 - 0.2 * square)) - 1e-5 * square**2
    return form - 0.1 * np.exp(-((0.8 * x - 0.6 * y - 1) ** 2) / (2 * 0.6**2))


def pipe(x, y):
    return np.sqrt(10.675**2 - (0.9 * x + 0.19**0.5 * y) ** 2) - 10.675


FAMILIES = {f.__name__: f for f in (torus, bump, wave, bottle, ellipsoid, face, asphere, pipe)}


def derivatives(height, x, y, h=STEP):
    """zx, zy, zxx, zxy, zyy by central differences of fourth order."""
    at = lambda a, b: height(x + a * h, y + b * h)
    first = lambda f: (8 * (f(1) - f(-1)) - (f(2) - f(-2))) / (12 * h)
    second = lambda f: (16 * (f(1) + f(-1)) - (f(2) + f(-2)) - 30 * f(0)) / (12 * h * h)
    zxy = first(lambda b: first(lambda a: at(a, b)))
    return first(lambda a: at(a, 0)), first(lambda b: at(0, b)), second(lambda a: at(a, 0)), zxy, second(lambda b: at(0, b))


def principal(zx, zy, zxx, zxy, zyy):
    """k1 >= k2, negative where the surface is a cap, as palpate's."""
    w2 = 1 + zx**2 + zy**2
    mean = ((1 + zy**2) * zxx - 2 * zx * zy * zxy + (1 + zx**2) * zyy) / (2 * w2**1.5)
    half = np.sqrt(np.maximum(mean**2 - (zxx * zyy - zxy**2) / w2**2, 0))
    return mean + half, mean - half


def shape(k1, k2):
    return -2 / np.pi * np.arctan2(k1 + k2, k1 - k2), np.sqrt((k1**2 + k2**2) / 2)


def truth(height, x, y):
    """k1, k2, S, R."""
    k = principal(*derivatives(height, x, y))
    return *k, *shape(*k)


def scanner(draw, x, y, z):
    """Errors that neighbours share, heights in steps, and some far off."""
    waves = [(draw.normal(0, 1 / 1.5, 2), draw.uniform(0, 2 * np.pi)) for _ in range(64)]
    shared = sum(np.cos(w[0] * x + w[1] * y + phase) for w, phase in waves) * np.sqrt(2 / 64)
    z = z + 0.015 * shared + 0.5 * draw.choice([-1, 0, 1], z.shape, p=[0.01, 0.98, 0.01])
    return np.round(z, 2)


def measured(name, draw, x, y):
    """Heights with noise."""
    z = FAMILIES[name](x, y) + draw.normal(0, NOISE_Z, x.shape)
    return scanner(draw, x, y, z) if name == "pipe" else z


def contacts(name, count, seed):
    """x, y, z with noise, and unit normals with noise (count x 3)."""
    draw = np.random.default_rng([seed, count, list(FAMILIES).index(name)])
    x, y = draw.uniform(-HALF, HALF, (2, count))
    zx, zy = derivatives(FAMILIES[name], x, y)[:2]
    normals = np.column_stack([-zx, -zy, np.ones(count)])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    error = draw.normal(0, np.radians(NOISE_DEG), (count, 3))
    error -= np.sum(error * normals, axis=1, keepdims=True) * normals
    normals = normals + error
    return x, y, measured(name, draw, x, y), normals / np.linalg.norm(normals, axis=1, keepdims=True)


def pixels(name, side, seed):
    """An image of side x side heights with noise, x outermost, and the pixels' places along one edge."""
    draw = np.random.default_rng([seed, side, list(FAMILIES).index(name)])
    at = np.linspace(-HALF, HALF, side)
    return at, measured(name, draw, *np.meshgrid(at, at, indexing="ij"))
