"""The list of hard cases; the same names, numbers and order of operations as in `tests/laboratory/hard_cases/`."""
import math

import nist
from inputs import FULL, Case, Lcg, cylinder45, linspace, paraboloid, sites, sphere, sweep, touched

EQUAL = ("slopes", 1.0, 1.0, 1.0)
TANGENT = ("tangent",)


def all_cases():
    families = [umbilics, radii, rim, fingers, gap, duplicates, knots, degrees, clusters, weights, scales]
    families += [slopes_only, contradictions, outliers, hilbert, extremes, nist_cases]
    return [case for family in families for case in family()]


def umbilics():
    def lemon(x, y):
        return (
            -(x * x + y * y) / 16.0 + (x * x * x + x * y * y) / 512.0,
            -x / 8.0 + (3.0 * x * x + y * y) / 512.0,
            -y / 8.0 + x * y / 256.0,
        )

    def monkey(x, y):
        return (x * x * x - 3.0 * x * y * y) / 128.0, 3.0 * (x * x - y * y) / 128.0, -x * y * 6.0 / 128.0

    pixels = linspace(-10.0, 10.0, 21)
    return [
        Case("umbilic_paraboloid", (2, 2), EQUAL, **touched(paraboloid, *sweep(9)), domain=FULL, grid=(9, 9)),
        Case("umbilic_cup_pixels", (2, 2), EQUAL, x=pixels, y=pixels, z=[a * a + b * b for a in pixels for b in pixels],
             domain=[-10.0, 10.0, -10.0, 10.0], grid=(20, 20), is_grid=True),
        Case("umbilic_lemon", (3, 3), EQUAL, **touched(lemon, *sweep(9)), domain=FULL, grid=(9, 9)),
        Case("umbilic_monkey_saddle", (3, 3), EQUAL, **touched(monkey, *sweep(9)), domain=FULL, grid=(9, 9)),
        Case("umbilic_sphere_quartic", (4, 4), TANGENT, **touched(sphere(10.0), *sweep(5)), domain=FULL),
    ]  # fmt: skip


def radii():
    out = []
    for name, radius in (("1e3", 1e3), ("1e5", 1e5), ("1e7", 1e7), ("1e9", 1e9)):
        out.append(Case("sphere_r" + name, (3, 3), TANGENT, **touched(sphere(radius), *sweep(5)), domain=FULL))
    for name, radius, degree in (("10", 10.0, 4), ("1e3", 1e3, 3), ("1e6", 1e6, 3), ("1e9", 1e9, 3)):
        out.append(
            Case("cylinder45_r" + name, (degree, degree), TANGENT, **touched(cylinder45(radius), *sweep(5)), domain=FULL)
        )
    out.append(Case("plane_level", (2, 2), TANGENT, **touched(lambda x, y: (0.0, 0.0, 0.0), *sweep(3)), domain=FULL))
    tilted = touched(lambda x, y: (0.5 * x - 0.25 * y + 3.0, 0.5, -0.25), *sweep(3))
    out.append(Case("plane_tilted", (2, 2), TANGENT, **tilted, domain=FULL))
    return out


def rim():
    x, y = sweep(3)
    quarter = sites([-4.0, -2.0, 0.0, 2.0, 4.0], linspace(-4.0, 4.0, 9))
    heights = [math.sqrt(16.0 - v * v) for v in quarter[0]]
    level = ([v / 4.0 for v in quarter[0]], [0.0] * 45, [h / 4.0 for h in heights])
    rim_normals = touched(sphere(5.7), x, y, "normals")
    return [
        Case("rim_slopes_degree2", (2, 2), TANGENT, **touched(sphere(5.7), x, y), domain=FULL),
        Case("rim_slopes_degree4", (4, 4), TANGENT, **touched(sphere(5.7), x, y), domain=FULL),
        Case("rim_normals_degree2", (2, 2), ("normals", 1.0, 15.0), **rim_normals, domain=FULL),
        Case("rim_normals_degree4", (4, 4), ("normals", 0.02, 2.0), **rim_normals, domain=FULL),
        Case("horizontal_normals", (2, 2), ("normals", 1.0, 15.0), x=quarter[0], y=quarter[1], z=heights, normals=level,
             domain=FULL),
    ]  # fmt: skip


def fingers():
    stations = linspace(-4.0, 4.0, 9)
    one, two, diagonal = sites([0.0], stations), sites([-2.0, 2.0], stations), (stations, stations)
    ball = sphere(10.0)
    return [
        Case("one_finger", (2, 2), EQUAL, **touched(ball, *one), domain=FULL),
        Case("one_finger_heights", (2, 2), EQUAL, **touched(ball, *one, "heights"), domain=FULL),
        Case("two_fingers", (2, 2), EQUAL, **touched(ball, *two), domain=FULL),
        Case("two_fingers_heights", (2, 2), EQUAL, **touched(ball, *two, "heights"), domain=FULL),
        Case("collinear", (2, 2), EQUAL, **touched(ball, *diagonal), domain=FULL),
        Case("collinear_heights", (2, 2), EQUAL, **touched(ball, *diagonal, "heights"), domain=FULL),
        Case("one_contact", (2, 2), EQUAL, **touched(ball, [1.0], [2.0]), domain=FULL),
    ]  # fmt: skip


def gap():
    lcg = Lcg(1997)
    x, y = [], []
    while len(x) < 600:
        a, b = 2.0 * lcg.uniform() - 1.0, 2.0 * lcg.uniform() - 1.0
        if a * a + b * b >= 0.36:
            x.append(a)
            y.append(b)

    def hill(a, b):
        """1 / (1 + a^2 + 2 b^2) with noise of sd 0.01 on heights."""
        q = 1.0 + a * a + 2.0 * b * b
        return 1.0 / q + 0.01 * lcg.normal(), -2.0 * a / (q * q), -4.0 * b / (q * q)

    def flank(a, b):
        return hill(a - 1.0, b)

    box = [-1.0, 1.0, -1.0, 1.0]
    return [
        Case("disc_gap_heights", (3, 3), EQUAL, **touched(hill, x, y, "heights"), segments=(10, 10), domain=box, grid=(21, 21)),
        Case("disc_gap_slopes", (3, 3), EQUAL, **touched(hill, x, y), segments=(10, 10), domain=box, grid=(21, 21)),
        Case("disc_gap_flank", (3, 3), EQUAL, **touched(flank, x, y, "heights"), segments=(10, 10), domain=box, grid=(21, 21)),
    ]


def duplicates():
    first = touched(sphere(10.0), *sweep(3))
    again = {k: v + v for k, v in first.items() if k != "slopes"}
    again["slopes"] = tuple(c + c for c in first["slopes"])
    apart = dict(again)
    apart["x"] = first["x"] + [math.nextafter(v, math.inf) for v in first["x"]]
    apart["z"] = first["z"] + [v + 0.001 for v in first["z"]]
    wide = [-4.0, math.nextafter(4.0, math.inf), -4.0, 4.0]
    return [
        Case("duplicated_exactly", (3, 3), TANGENT, **again, domain=FULL),
        Case("duplicated_one_ulp_apart", (3, 3), TANGENT, **apart, domain=wide),
    ]


def knots():
    def crease(x, y):
        """-|x| / 4 - y^2 / 16; at x = 0 the right limit of the slope."""
        return -abs(x) / 4.0 - y * y / 16.0, (0.25 if x < 0.0 else -0.25), -y / 8.0

    low, high = [-4.0] * 4, [4.0] * 4
    ball = touched(sphere(10.0), *sweep(9))
    return [
        Case("knots_coincident", (3, 3), EQUAL, **ball, knots=(low + [0.0, 0.0] + high, low + high), domain=FULL),
        Case("knots_nearly_coincident", (3, 3), EQUAL, **ball, knots=(low + [0.0, 1e-8] + high, low + high), domain=FULL),
        Case("crease_on_double_knot", (2, 2), EQUAL, **touched(crease, *sweep(9)),
             knots=(low[:3] + [0.0, 0.0] + high[:3], low[:3] + high[:3]), domain=FULL),
        Case("contacts_on_knots", (2, 2), EQUAL, **ball, segments=(4, 4), domain=FULL, grid=(9, 9)),
        Case("degree_one_slopes_on_knots", (1, 1), EQUAL, **ball, segments=(4, 4), domain=FULL, grid=(9, 9)),
    ]  # fmt: skip


def degrees():
    x = linspace(-4.0, 4.0, 12)
    ball = sphere(10.0)
    return [
        Case("degree_nine_single_segment", (9, 9), TANGENT, **touched(ball, *sites(x, x)), domain=FULL),
        Case("degree_nine_heights", (9, 9), EQUAL, **touched(ball, *sites(x, x), "heights"), domain=FULL),
    ]


def clusters():
    def crowd(count, spread, fingers):
        lcg = Lcg(24)
        x, y = sweep(fingers, fingers)
        for _ in range(count):
            x.append(1.0 + spread * (lcg.uniform() - 0.5))
            y.append(1.0 + spread * (lcg.uniform() - 0.5))
        return x, y

    ball = sphere(10.0)
    return [
        Case("clustered_ten_thousand_to_one", (2, 2), EQUAL, **touched(ball, *crowd(10000, 0.0008, 3)), domain=FULL),
        Case("clustered_heights", (2, 2), EQUAL, **touched(ball, *crowd(200, 0.0008, 4), "heights"), domain=FULL),
    ]


def weights():
    lcg = Lcg(7)
    noisy = touched(sphere(10.0), *sweep(5))
    noisy["z"] = [v + 0.01 * lcg.normal() for v in noisy["z"]]
    by_row = [(1e12, 1.0, 1e-12)[r % 3] for r in range(45)]
    return [
        Case("weights_heights_1e12", (3, 3), ("slopes", 1e12, 1.0, 1.0), **noisy, domain=FULL),
        Case("weights_slopes_1e12", (3, 3), ("slopes", 1e-12, 1.0, 1.0), **noisy, domain=FULL),
        Case("weights_rows_1e12", (3, 3), EQUAL, **noisy, weights=(by_row, None, None), domain=FULL),
        Case("weights_blocks_1e12", (3, 3), ("slopes", 1.0, 1e12, 1e-12), **noisy, domain=FULL),
    ]


def scales():
    ball = touched(sphere(10.0), *sweep(5))
    far = dict(ball, x=[v + 1e8 for v in ball["x"]], y=[v + 1e8 for v in ball["y"]], z=[v + 1e8 for v in ball["z"]])
    far_box = [1e8 - 4.0, 1e8 + 4.0, 1e8 - 4.0, 1e8 + 4.0]
    lcg = Lcg(108)
    x = [8.0 * lcg.uniform() - 4.0 for _ in range(60)]
    y = [8.0 * lcg.uniform() - 4.0 for _ in range(60)]
    scattered = touched(sphere(10.0), x, y)
    scattered.update(x=[v + 1e8 for v in x], y=[v + 1e8 for v in y])
    far_normals = touched(sphere(10.0), *sweep(5), "normals")
    far_normals.update(x=far["x"], y=far["y"], z=far["z"])

    def scaled(by):
        lengths = {k: [v * by for v in ball[k]] for k in "xyz"}
        return dict(ball, **lengths, domain=[v * by for v in FULL])

    sx, sy = sweep(5)
    thin = touched(sphere(10.0), sx, [v * 1e-6 for v in sy])
    return [
        Case("offset_1e8", (3, 3), EQUAL, **far, domain=far_box, grid=(9, 9)),
        Case("offset_1e8_scattered", (3, 3), EQUAL, **scattered, domain=far_box, grid=(9, 9)),
        Case("offset_1e8_normals", (3, 3), ("normals", 1.0, 15.0), **far_normals, domain=far_box, grid=(9, 9)),
        Case("offset_1e8_heights", (2, 2), EQUAL, x=ball["x"], y=ball["y"], z=far["z"], domain=FULL),
        Case("scale_1e_minus_9", (3, 3), TANGENT, **scaled(1e-9)),
        Case("scale_1e9", (3, 3), TANGENT, **scaled(1e9)),
        Case("aspect_1e6", (2, 2), EQUAL, **thin, domain=[-4.0, 4.0, -4.0 * 1e-6, 4.0 * 1e-6]),
    ]  # fmt: skip


def slopes_only():
    ball = touched(sphere(10.0), *sweep(5))
    return [
        Case("slopes_only", (3, 3), ("slopes", 0.0, 1.0, 1.0), **ball, domain=FULL),
        Case("slopes_only_by_row_weights", (3, 3), EQUAL, **ball, weights=([0.0] * 45, None, None), domain=FULL),
    ]


def contradictions():
    first = touched(sphere(10.0), *sweep(5))
    both = {k: v + v for k, v in first.items() if k != "slopes"}
    opposed = ([1.0] * 45 + [-1.0] * 45, [-1.0] * 45 + [1.0] * 45)
    leaning = ([0.6] * 45 + [-0.6] * 45, [0.0] * 90, [0.8] * 90)
    lcg = Lcg(180)
    wild = [[lcg.uniform() - 0.5 for _ in range(45)] for _ in range(2)] + [[0.25 + lcg.uniform() for _ in range(45)]]
    alone = {k: v for k, v in first.items() if k != "slopes"}
    return [
        Case("contradictory_slopes", (2, 2), EQUAL, **both, slopes=opposed, domain=FULL),
        Case("contradictory_normals", (2, 2), ("normals", 1.0, 15.0), **both, normals=leaning, domain=FULL),
        Case("random_normals", (2, 2), ("normals", 0.1, 15.0), **alone, normals=tuple(wild), domain=FULL),
    ]


def outliers():
    heights, slopes = touched(sphere(10.0), *sweep(5)), touched(sphere(10.0), *sweep(5))
    heights["z"][7], heights["z"][31] = 1e6, -1e6
    slopes["slopes"][0][22] = 1e6
    return [
        Case("gross_outlier_heights", (3, 3), TANGENT, **heights, domain=FULL),
        Case("gross_outlier_slope", (3, 3), TANGENT, **slopes, domain=FULL),
    ]


def hilbert():
    reciprocal = [1.0 / float(13 - i) for i in range(1, 13)]
    even = linspace(0.0, 1.0, 12)

    def bowl(a, b):
        return 1.0 / (1.0 + a + b)

    def heights(axis):
        return dict(x=axis, y=axis, z=[bowl(a, b) for a in axis for b in axis], is_grid=True)

    return [
        Case("hilbert_axes", (5, 5), EQUAL, **heights(reciprocal), domain=[1.0 / 12.0, 1.0, 1.0 / 12.0, 1.0]),
        Case("hilbert_even_degree_nine", (9, 9), EQUAL, **heights(even), domain=[0.0, 1.0, 0.0, 1.0]),
    ]


def extremes():
    ball = touched(sphere(10.0), *sweep(5))

    def lengths(by):
        return dict(ball, **{k: [v * by for v in ball[k]] for k in "xyz"}, domain=[v * by for v in FULL])

    def heights(by):
        return dict(ball, z=[v * by for v in ball["z"]], slopes=tuple([v * by for v in c] for c in ball["slopes"]), domain=FULL)

    huge, tiny = 2.0**1000, 2.0**-1000
    return [
        Case("lengths_near_overflow", (2, 2), TANGENT, **lengths(huge)),
        Case("lengths_near_underflow", (2, 2), TANGENT, **lengths(tiny)),
        Case("heights_1e100", (2, 2), EQUAL, **heights(1e100)),
        Case("heights_1e_minus_200", (2, 2), EQUAL, **heights(1e-200)),
        Case("weights_1e200", (2, 2), ("slopes", 1e200, 1e200, 1e200), **ball, domain=FULL),
        Case("weights_1e_minus_200", (2, 2), ("slopes", 1e-200, 1e-200, 1e-200), **ball, domain=FULL),
    ]


def nist_cases():
    def dense(name, rows, rhs):
        return Case(name, (0, 0), ("rows",), rows=rows, rhs=rhs)

    hilbert_rows = [[1.0 / float(i + j + 1) for j in range(8)] for i in range(10)]
    return [
        dense("nist_longley", *nist.longley()),
        dense("nist_filippelli_raw", *nist.filippelli_raw()),
        dense("nist_filippelli_centred", *nist.filippelli_centred()),
        dense("hilbert_rows", hilbert_rows, [1.0] * 10),
    ]
