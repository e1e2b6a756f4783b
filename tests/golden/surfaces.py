"""References of every analytic surface to 50 digits: heights, normals, curvatures, S and R at 100 random points each.

Route independent of the crate: the surface's textbook implicit equation F(X, Y, Z) = 0 in the world frame (posed by
rotation matrices at 50 digits), the point by bracketing from above, gradient and Hessian by mpmath's numerical
differentiation, curvatures from Goldman's formulas for implicit surfaces (R. Goldman, CAGD 22 (2005) 632):

    mean  = (g H g' - |g|^2 tr H) / (2 |g|^3)      Gauss = g adj(H) g' / |g|^4      k = mean +- sqrt(mean^2 - Gauss)

    python3 -m venv venv && venv/bin/pip install mpmath==1.3.0 && venv/bin/python tests/golden/surfaces.py > tests/golden/surfaces.json
"""

import json
import random
import sys

from mpmath import mp, mpf

mp.dps = 60
random.seed(1997)
POINTS = 100


def rotation(degrees):
    ax, ay, az = (mpf(str(d)) * mp.pi / 180 for d in degrees)
    rx = mp.matrix([[1, 0, 0], [0, mp.cos(ax), -mp.sin(ax)], [0, mp.sin(ax), mp.cos(ax)]])
    ry = mp.matrix([[mp.cos(ay), 0, mp.sin(ay)], [0, 1, 0], [-mp.sin(ay), 0, mp.cos(ay)]])
    rz = mp.matrix([[mp.cos(az), -mp.sin(az), 0], [mp.sin(az), mp.cos(az), 0], [0, 0, 1]])
    return rz * ry * rx


def posed(f, axis=0, turn=(0, 0, 0), offset=(0, 0, 0), concave=False):
    """F of the body, in the world; grows towards the free side."""
    inverse = (rotation(turn) * rotation((0, 0, axis))).T

    def world(x, y, z):
        p = inverse * mp.matrix([x - mpf(str(offset[0])), y - mpf(str(offset[1])), z - mpf(str(offset[2]))])
        return -f(p[0], p[1], -p[2]) if concave else f(p[0], p[1], p[2])

    return world


def point(world, x, y, low, high, concave):
    """First zero from above (concave: from below, in the mirrored sense), by scan and bisection."""
    steps = 400
    heights = [low + (high - low) * mpf(i) / steps for i in range(steps + 1)]
    if not concave:
        heights.reverse()
    outside = 1 if not concave else -1
    last = None
    for z in heights:
        value = world(x, y, z) * outside
        if last is not None and value <= 0 < last[1]:
            return mp.findroot(lambda t: world(x, y, t), (last[0], z), solver="illinois", tol=mpf(10) ** -110, verify=False)
        last = (z, value)
    return None


def describe(world, x, y, z):
    def d(*order):
        return mp.diff(world, (x, y, z), order)

    g = [d(1, 0, 0), d(0, 1, 0), d(0, 0, 1)]
    xx, yy, zz, xy, xz, yz = d(2, 0, 0), d(0, 2, 0), d(0, 0, 2), d(1, 1, 0), d(1, 0, 1), d(0, 1, 1)
    h = mp.matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    adj = mp.matrix(
        [
            [yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy],
            [xz * yz - xy * zz, xx * zz - xz * xz, xy * xz - xx * yz],
            [xy * yz - xz * yy, xy * xz - xx * yz, xx * yy - xy * xy],
        ]
    )
    gv = mp.matrix(g)
    size = mp.sqrt(sum(c * c for c in g))
    mean = ((gv.T * h * gv)[0] - size**2 * (xx + yy + zz)) / (2 * size**3)
    gauss = (gv.T * adj * gv)[0] / size**4
    gap = mp.sqrt(max(mean * mean - gauss, mpf(0)))
    # the square root leaves half the digits at an umbilic; the rest is rounding
    gap = mpf(0) if gap < mpf(10) ** -18 * (abs(mean) + mpf(10) ** -30) else gap
    k1, k2 = mean + gap, mean - gap
    flat = abs(k1) + abs(k2) < mpf(10) ** -25
    shape = None if flat else -2 / mp.pi * mp.atan2(k1 + k2, k1 - k2)
    curved = mpf(0) if flat else mp.sqrt((k1 * k1 + k2 * k2) / 2)
    return [c / size for c in g], (mpf(0) if flat else k1), (mpf(0) if flat else k2), shape, curved


def number(value):
    return None if value is None else float(mp.nstr(value, 17))


BODIES = {
    "plane": ('kind = "plane"', lambda x, y, z: z),
    "sphere": ('kind = "sphere"\nradius = 6.0', lambda x, y, z: x * x + y * y + (z + 6) ** 2 - 36),
    "sphere_5_7": ('kind = "sphere"\nradius = 5.7', lambda x, y, z: x * x + y * y + (z + mpf(5.7)) ** 2 - mpf(5.7) ** 2),
    "sphere_1e9": ('kind = "sphere"\nradius = 1e9', lambda x, y, z: x * x + y * y + z * z + 2 * mpf(10) ** 9 * z),
    "cylinder": ('kind = "cylinder"\nradius = 6.6', lambda x, y, z: y * y + (z + mpf(6.6)) ** 2 - mpf(6.6) ** 2),
    "ellipsoid": (
        'kind = "ellipsoid"\nsemi_axes = [9.0, 7.0, 5.0]',
        lambda x, y, z: x * x / 81 + y * y / 49 + (z + 5) ** 2 / 25 - 1,
    ),
    "torus": (
        'kind = "torus"\nmajor = 12.0\nminor = 6.0',
        lambda x, y, z: (mp.sqrt((x + 12) ** 2 + y * y) - 12) ** 2 + (z + 6) ** 2 - 36,
    ),
    "paraboloid": ('kind = "paraboloid"\nradii = [5.0, 9.0]', lambda x, y, z: z + x * x / 10 + y * y / 18),
    "saddle": ('kind = "saddle"\nradii = [6.0, 8.0]', lambda x, y, z: z - x * x / 12 + y * y / 16),
    "monkey_saddle": ('kind = "monkey_saddle"\nlength = 6.0', lambda x, y, z: z - (x**3 - 3 * x * y * y) / 36),
    "gaussian": (
        'kind = "gaussian"\nheight = 2.0\nwidth = 3.0',
        lambda x, y, z: z - 2 * (mp.exp(-(x * x + y * y) / 18) - 1),
    ),
    "sinusoid": (
        'kind = "sinusoid"\namplitude = 0.5\nwavelength = 7.0\nwavelength_y = 11.0',
        lambda x, y, z: z - (mp.cos(2 * mp.pi * x / 7) - 1) / 2 - (mp.cos(2 * mp.pi * y / 11) - 1) / 2,
    ),
    "superquadric": (
        'kind = "superquadric"\nsemi_axes = [7.0, 6.0, 5.0]\nexponents = [0.7, 0.6]',
        lambda x, y, z: (abs(x / 7) ** (2 / mpf(0.6)) + abs(y / 6) ** (2 / mpf(0.6))) ** (mpf(0.6) / mpf(0.7))
        + abs((z + 5) / 5) ** (2 / mpf(0.7))
        - 1,
    ),
}
# union: plane lowered by 1.5 and a ball shifted; F is the smaller (outside both means above the higher)
BALL = posed(BODIES["sphere"][1], offset=(1.0, -0.5, 0.25))
UNION = (
    'kind = "union"\n[[surface.parts]]\nkind = "plane"\noffset = [0.0, 0.0, -1.5]\n'
    '[[surface.parts]]\nkind = "sphere"\nradius = 6.0\noffset = [1.0, -0.5, 0.25]',
    lambda x, y, z: min(z + mpf(1.5), BALL(x, y, z)),
)

POSES = {
    "as it is": ("", {}),
    "posed": (
        "axis_deg = 33.0\nrotation_deg = [12.0, -7.0, 21.0]\noffset = [0.5, -0.25, 1.5]",
        dict(axis=33.0, turn=(12.0, -7.0, 21.0), offset=(0.5, -0.25, 1.5)),
    ),
    "concave": ("concave = true\naxis_deg = -20.0", dict(concave=True, axis=-20.0)),
    "concave posed": (
        "concave = true\nrotation_deg = [-8.0, 5.0, 40.0]\noffset = [0.1, 0.2, -0.7]",
        dict(concave=True, turn=(-8.0, 5.0, 40.0), offset=(0.1, 0.2, -0.7)),
    ),
}


def sample(name, toml, f, pose, extra, options):
    world = posed(f, **options)
    rows = []
    half = 4.0
    while len(rows) < POINTS:
        x, y = random.uniform(-half, half), random.uniform(-half, half)
        z = point(world, mpf(x), mpf(y), mpf(-14), mpf(14), options.get("concave", False))
        if z is None:
            continue
        if name == "union" and abs(mp.diff(world, (mpf(x), mpf(y), z), (0, 0, 1))) == 0:
            continue
        n, k1, k2, s, r = describe(world, mpf(x), mpf(y), z)
        if n[2] < 0.02:
            continue
        rows.append([x, y] + [number(v) for v in (z, *n, k1, k2, s, r)])
    head, _, tail = toml.partition("\n[[")
    text = "\n".join(filter(None, ["[surface]", head, extra])) + ("\n[[" + tail if tail else "")
    return {"name": f"{name}, {pose}", "surface": text, "columns": "x y z nx ny nz k1 k2 S R", "points": rows}


def main():
    cases = []
    for name, (toml, f) in BODIES.items():
        for pose, (extra, options) in POSES.items():
            if name == "sphere_1e9" and "posed" in pose:
                continue
            print(name, pose, file=sys.stderr)
            cases.append(sample(name, toml, f, pose, extra, options))
    toml, f = UNION
    cases.append(sample("union", toml, f, "as it is", "", {}))
    extra, options = POSES["posed"]
    cases.append(sample("union", toml, f, "posed", extra, options))
    lines = ",\n".join(json.dumps(case) for case in cases)
    print("[\n" + lines + "\n]")


main()
