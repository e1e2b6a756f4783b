"""SciPy's own tests of spline fitting, G+Smo's fits and NIST's polynomials, as problems for palpate: writes cases.json beside itself.

    python -m venv venv && venv/bin/pip install scipy==1.17.1 pygismo==26.9.0
    venv/bin/python tests/differential/make.py

Every case names the test that it was taken from (scipy/interpolate/tests, BSD licence) or the data set of NIST (public domain,
https://www.itl.nist.gov/div898/strd/lls/lls.shtml). Knots are those that SciPy took or chose; `values` is what SciPy finds at `at`.
A problem of one variable stands twice, at y = 0 and y = 1, of degree 1 in y. NIST's data are recognised by their certified values:
the exact solution of the decimals below has to have 13 digits of them, or nothing is written. G+Smo's cases are fits by its class
`gsFitting`, which its examples read parametrised points with (filedata/fitting): scattered heights, without and with lambda times the
integral of the squared second derivatives, which is palpate's roughness, too. G+Smo takes that integral by as many Gauss nodes
a side of a cell as the degree says, one too few to be exact: with its nodes the equations below have to give its answer to 1e-11,
or nothing is written, and `values` is what they give with the exact integral.
"""

import fractions
import json
import pathlib
import warnings

import numpy as np
import pygismo
import scipy
from scipy.interpolate import BSpline, LSQBivariateSpline, RectBivariateSpline, SmoothBivariateSpline, bisplev, bisplrep, make_lsq_spline

HERE = pathlib.Path(__file__).parent
NINE = ([1, 1, 1, 2, 2, 2, 3, 3, 3], [1, 2, 3, 1, 2, 3, 1, 2, 3])


def case(name, origin, points, degree, knots, at, values, **more):
    x, y, z = (np.asarray(v, float).tolist() for v in points)
    knots = [np.asarray(k, float).tolist() for k in knots]
    at = [np.asarray(v, float).tolist() for v in at]
    return {"name": name, "origin": origin, "x": x, "y": y, "z": z, "degree": list(degree), "knots": knots, "at": at,
            "values": np.asarray(values, float).tolist(), **more}


def lsq(name, test, points, tx, ty, degree, weights=None):
    x, y, z = points
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        spline = LSQBivariateSpline(x, y, z, tx, ty, w=weights, kx=degree[0], ky=degree[1])
    more = {} if weights is None else {"weights": list(weights)}
    return case(name, "test_fitpack2.py TestLSQBivariateSpline." + test, points, degree, spline.get_knots(), (x, y),
                spline.ev(x, y), **more)


def of_fitpack2():
    x, y = NINE
    yield lsq("lsq_constant", "test_linear_constant", (x, y, [3] * 9), [1.1, 2.9], [1.1, 2.9], (1, 1))
    yield lsq("lsq_bilinear", "test_bilinearity", (x, y, [0, 7, 8, 3, 4, 7, 1, 3, 4]), [1.1, 2.9], [1.1, 2.9], (1, 1))
    line = np.linspace(1, 10)
    yield lsq("lsq_line", "test_array_like_input", (line, line, line), [1.1, 2.9], [1.1, 2.9], (3, 3), line)
    u, v = (a.ravel() for a in np.mgrid[0:100, 0:100])
    yield lsq("lsq_unequal_knots", "test_unequal_length_of_knots", (u, v, 3.0 * np.ones(u.size)), np.linspace(0.1, 98, 29),
              np.linspace(0.1, 98, 33), (3, 3)) | {"x": [], "y": [], "z": [], "at": [[], []], "values": [], "constant": [100, 100, 3.0]}
    for name, z in [("smooth_constant", [3] * 9), ("smooth_linear", [0, 0, 0, 2, 2, 2, 4, 4, 4])]:
        spline = SmoothBivariateSpline(x, y, z, kx=1, ky=1)
        yield case(name, "test_fitpack2.py TestSmoothBivariateSpline.test_linear_" + ("constant" if name[7] == "c" else "1d"),
                   (x, y, z), (1, 1), spline.get_knots(), ([1, 1.5, 2, 1, 1.5, 2], [1, 1, 1, 1.5, 1.5, 1.5]),
                   spline.ev([1, 1.5, 2, 1, 1.5, 2], [1, 1, 1, 1.5, 1.5, 1.5]))
    x = [1, 1, 1, 2, 2, 2, 4, 4, 4]
    z = [0, 7, 8, 3, 4, 7, 1, 3, 4]
    # s = 0 interpolates: the knots of degree 1 are the places themselves (SciPy ends early there, ier = 1), of degree 2 none inside
    yield case("smooth_bilinear", "test_fitpack2.py TestSmoothBivariateSpline.test_integral", (x, y, z), (1, 1),
               ([1, 1, 2, 4, 4], [1, 1, 2, 3, 3]), (x, y), z)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        spline = SmoothBivariateSpline(x, y, z, kx=2, ky=2, s=0)
    yield case("smooth_biquadratic", "test_fitpack2.py TestSmoothBivariateSpline.test_integral", (x, y, z), (2, 2),
               spline.get_knots(), ([1, 1.3, 2.5, 3.9], [1.2, 2.9, 1.7, 2.2]), spline.ev([1, 1.3, 2.5, 3.9], [1.2, 2.9, 1.7, 2.2]))
    z = np.array([[1, 2, 1, 2, 1], [1, 2, 1, 2, 1], [1, 2, 3, 2, 1], [1, 2, 2, 2, 1], [1, 2, 1, 2, 1]], float)
    five = np.arange(1.0, 6.0)
    spline = RectBivariateSpline(five, five, z)
    u, v = (a.ravel() for a in np.meshgrid(five, five, indexing="ij"))
    dx = np.array([[0, 0, -20, 0, 0], [0, 0, 13, 0, 0], [0, 0, 4, 0, 0], [0, 0, -11, 0, 0], [0, 0, 4, 0, 0]]) / 6.0
    dy = np.array([[4, -1, 0, 1, -4], [4, -1, 0, 1, -4], [0, 1.5, 0, -1.5, 0], [2, 0.25, 0, -0.25, -2], [4, -1, 0, 1, -4]])
    yield case("rect_derivatives", "test_fitpack2.py TestRectBivariateSpline.test_defaults, test_derivatives_grid",
               (u, v, z.ravel()), (3, 3), spline.get_knots(), (u, v), z.ravel(), slopes=[dx.ravel().tolist(), dy.ravel().tolist()])
    yield case("rect_between", "test_fitpack2.py TestRectBivariateSpline.test_evaluate", (u, v, z.ravel()), (3, 3),
               spline.get_knots(), ([1, 2.3, 3.3, 1.2, 3], [1, 3.3, 5.0, 1.0, 3]), spline.ev([1, 2.3, 3.3, 1.2, 3], [1, 3.3, 5.0, 1.0, 3]))
    # test_spline_large_2d, a tenth of each side
    large = np.random.default_rng(1).integers(0, 100, (35, 85)).astype(float)
    spline = RectBivariateSpline(np.arange(35.0), np.arange(85.0), large, s=0)
    u, v = (a.ravel() for a in np.meshgrid(np.arange(35.0), np.arange(85.0), indexing="ij"))
    yield case("rect_large", "test_fitpack2.py TestRectBivariateSpline.test_spline_large_2d, 35 x 85 of it", (u, v, large.ravel()),
               (3, 3), spline.get_knots(), (u[::7] * 0.99, v[::7] * 0.98), spline.ev(u[::7] * 0.99, v[::7] * 0.98))


def of_fitpack():
    side = np.linspace(0, 2 * np.pi, 21)
    x, y = (a.ravel() for a in np.meshgrid(side, side, indexing="ij"))
    z = np.sin(x + y)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        tck = bisplrep(x, y, z, s=0, kx=3, ky=3)
    spline = LSQBivariateSpline(x, y, z, tck[0][4:-4], tck[1][4:-4], kx=3, ky=3)
    yield case("bisplrep_sine", "test_fitpack.py TestSplrepSplev.test_smoke_bisplrep_bisplev", (x, y, z), (3, 3),
               spline.get_knots(), (x[::5] * 0.97, y[::5] * 0.99), spline.ev(x[::5] * 0.97, y[::5] * 0.99))
    data = np.load(pathlib.Path(scipy.__file__).parent / "interpolate/tests/data/bug-1310.npz")["data"]
    x, y, z = data[:, 0], data[:, 1], data[:, 2]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        tck, _, ier, _ = bisplrep(x, y, z, kx=3, ky=3, s=0, full_output=True)
    yield case("bisplrep_1310", f"test_fitpack.py TestBisplrep.test_regression_1310 (data/bug-1310.npz; SciPy's ier = {ier})",
               (x, y, z), (3, 3), tck[:2], (x, y), [float(np.ravel(bisplev(a, b, tck))[0]) for a, b in zip(x, y)])


def doubled(x, z):
    return np.r_[x, x], np.r_[np.zeros(len(x)), np.ones(len(x))], np.r_[z, z]


def of_bsplines():
    rng = np.random.RandomState(1234)
    x = np.sort(rng.random(13))
    z = rng.random(13)
    inner = np.linspace(x[0], x[-1], 7)
    t = np.r_[[x[0]] * 3, inner, [x[-1]] * 3]
    at = np.linspace(x[0], x[-1], 23)
    for name, test, w in [("lsq_curve", "test_lstsq", None),
                          ("lsq_curve_weights", "test_weights_same", np.random.default_rng(1234).uniform(size=13))]:
        spline = make_lsq_spline(x, z, t, 3, w=w)
        more = {} if w is None else {"weights": np.r_[w, w].tolist()}
        yield case(name, "test_bsplines.py TestLSQ." + test, doubled(x, z), (3, 1), (t, [0, 0, 1, 1]), (at, np.full(23, 0.25)),
                   spline(at), **more)


def franke(x, y):
    """R. Franke, Math. Comp. 38 (1982) 181: the test function of scattered heights."""
    x, y = 9 * x, 9 * y
    return (0.75 * np.exp(-((x - 2) ** 2 + (y - 2) ** 2) / 4) + 0.75 * np.exp(-((x + 1) ** 2) / 49 - (y + 1) / 10)
            + 0.5 * np.exp(-((x - 7) ** 2 + (y - 3) ** 2) / 4) - 0.2 * np.exp(-((x - 4) ** 2) - (y - 7) ** 2))


def basis_at(knots, degree, at, derivative):
    unit = np.eye(len(knots) - degree - 1)
    return BSpline(knots, unit, degree)(at, nu=derivative)


def gram(knots, degree, derivative, nodes):
    """Products of the basis functions' derivatives, integrated by so many Gauss nodes a cell."""
    places, weights = np.polynomial.legendre.leggauss(nodes)
    total = 0.0
    for a, b in zip(np.unique(knots)[:-1], np.unique(knots)[1:]):
        rows = basis_at(knots, degree, (a + b) / 2 + (b - a) / 2 * places, derivative)
        total = total + rows.T @ (rows * (weights * (b - a) / 2)[:, None])
    return total


def smoothed(points, degree, knots, weight, at, nodes):
    """Heights at `at` of the least squares surface with `weight` times its roughness."""
    rows = lambda u, v: np.einsum("ri,rj->rij", basis_at(knots[0], degree[0], u, 0), basis_at(knots[1], degree[1], v, 0)).reshape(len(u), -1)
    kinds = [[gram(k, p, d, n) for d in range(3)] for k, p, n in zip(knots, degree, nodes)]
    rough = np.kron(kinds[0][2], kinds[1][0]) + 2 * np.kron(kinds[0][1], kinds[1][1]) + np.kron(kinds[0][0], kinds[1][2])
    data = rows(points[0], points[1])
    return rows(*at) @ np.linalg.solve(data.T @ data + weight * rough, data.T @ points[2])


def of_gismo():
    random = np.random.default_rng(26)
    everywhere = random.uniform(0, 1, (2, 300))
    # an L: nothing was measured over one quarter, where the roughness alone says what the surface does
    bent = everywhere[:, ~((everywhere[0] > 0.5) & (everywhere[1] > 0.5))]
    for name, places, degree, segments, weight in [
        ("gismo_biquadratic", everywhere, (2, 2), (6, 6), 0.0),
        ("gismo_bicubic", everywhere, (3, 3), (8, 5), 0.0),
        ("gismo_unequal", everywhere, (4, 2), (3, 7), 0.0),
        ("gismo_smoothed", everywhere, (3, 3), (10, 10), 1e-6),
        ("gismo_smoothed_over_a_gap", bent, (3, 3), (6, 6), 1e-5),
    ]:
        knots = [np.r_[[0.0] * p, np.linspace(0, 1, n + 1), [1.0] * p] for p, n in zip(degree, segments)]
        basis = pygismo.nurbs.gsTensorBSplineBasis2(*(pygismo.nurbs.gsKnotVector(k.tolist(), p) for k, p in zip(knots, degree)))
        z = franke(*places)
        fit = pygismo.modelling.gsFitting(places, z[None, :], basis)
        fit.compute(weight)
        at = np.stack([a.ravel() for a in np.meshgrid(np.linspace(0, 1, 8), np.linspace(0, 1, 8), indexing="ij")])
        values, origin = np.ravel(fit.result().eval(at)), f"G+Smo {pygismo.__version__} gsFitting::compute({weight:g})"
        if weight:
            again, exact = (smoothed((*places, z), degree, knots, weight, at, nodes) for nodes in (degree, [p + 1 for p in degree]))
            off = np.abs([again - values, exact - values]).max(axis=1) / np.abs(exact).max()
            assert off[0] < 1e-11, (name, off)
            print(f"{name}: {off[0]:.1e} from G+Smo with its nodes, {off[1]:.1e} with the exact integral")
            yield case(name, origin + ", the integral exact", (*places, z), degree, knots, at, exact, **{"lambda": weight})
        else:
            yield case(name, origin, (*places, z), degree, knots, at, values)


NORRIS = """0.1 0.2 338.8 337.4 118.1 118.2 888.0 884.6 9.2 10.1 228.1 226.5 668.5 666.3 998.5 996.3 449.1 448.6 778.9 777.0
559.2 558.2 0.3 0.4 0.1 0.6 778.1 775.5 668.8 666.9 339.3 338.0 448.9 447.5 10.8 11.6 557.7 556.0 228.3 228.1 998.0 995.8
888.8 887.6 119.6 120.2 0.3 0.3 0.6 0.3 557.6 556.8 339.3 339.1 888.0 887.2 998.5 999.0 778.9 779.0 10.2 11.1 117.6 118.3
228.9 229.2 668.4 669.1 449.2 448.9 0.2 0.5"""
PONTIUS = """.11019 .21956 .32949 .43899 .54803 .65694 .76562 .87487 .98292 1.09146 1.20001 1.30822 1.41599 1.52399 1.63194 1.73947
1.84646 1.95392 2.06128 2.16844 .11052 .22018 .32939 .43886 .54798 .65739 .76596 .87474 .98300 1.09150 1.20004 1.30818 1.41613
1.52408 1.63159 1.73965 1.84696 1.95445 2.06177 2.16829"""
WAMPLER3 = """760 -2042 2111 -1684 3888 1858 11379 17560 39287 64382 113159 175108 273291 400186 581243 811568 1121004 1506550
2002767 2611612 3369180"""


def nist():
    """name, degree, x and y as fractions of the decimals, certified coefficients."""
    exact = fractions.Fraction
    pairs = [exact(w) for w in NORRIS.split()]
    yield "norris", 1, pairs[1::2], pairs[::2], ["-0.262323073774029", "1.00211681802045"]
    load = [exact(150000 * k) for k in range(1, 21)] * 2
    yield "pontius", 2, load, [exact(w) for w in PONTIUS.split()], ["0.673565789473684E-03", "0.732059160401003E-06",
                                                                 "-0.316081871345029E-14"]
    x = [exact(k) for k in range(21)]
    powers = lambda b, x: sum(b ** k * x ** k for k in range(6))
    ones = [powers(1, v) for v in x]
    errors = [exact(w) - one for w, one in zip(WAMPLER3.split(), ones)]
    yield "wampler1", 5, x, ones, ["1"] * 6
    yield "wampler2", 5, x, [powers(exact(1, 10), v) for v in x], ["1", "0.1", "0.01", "0.001", "0.0001", "0.00001"]
    for k, factor in [(3, 1), (4, 100), (5, 10000)]:
        yield f"wampler{k}", 5, x, [one + factor * e for one, e in zip(ones, errors)], ["1"] * 6


def exact_solution(x, y, degree):
    """The least squares polynomial in fractions, by elimination of the normal equations."""
    sums = [sum(v**k for v in x) for k in range(2 * degree + 1)]
    rows = [[sums[i + j] for j in range(degree + 1)] + [sum(v**i * w for v, w in zip(x, y))] for i in range(degree + 1)]
    for k in range(degree + 1):
        rows[k] = [v / rows[k][k] for v in rows[k]]
        for i in range(degree + 1):
            if i != k:
                rows[i] = [a - rows[i][k] * b for a, b in zip(rows[i], rows[k])]
    return [row[-1] for row in rows]


def of_nist():
    for name, degree, x, y, certified in nist():
        found = exact_solution(x, y, degree)
        worst = max(abs(f / fractions.Fraction(c) - 1) for f, c in zip(found, certified))
        assert worst < 1e-13, (name, float(worst))
        print(f"{name}: {len(x)} points, {float(worst):.1e} from the certified values")
        lo, hi = float(min(x)), float(max(x))
        points = doubled([float(v) for v in x], [float(v) for v in y])
        knots = ([lo] * (degree + 1) + [hi] * (degree + 1), [0, 0, 1, 1])
        at = [float(min(x) + (max(x) - min(x)) * k / 8) for k in range(9)]
        values = [float(sum(f * fractions.Fraction(a) ** k for k, f in enumerate(found))) for a in at]
        yield case("nist_" + name, "NIST StRD " + name.capitalize(), points, (degree, 1), knots, (at, [0.5] * 9), values)


def main():
    groups = {"scipy": [*of_fitpack2(), *of_fitpack(), *of_bsplines()], "gismo": list(of_gismo()), "nist": list(of_nist())}
    cases = [c for group in groups.values() for c in group]
    with (HERE / "cases.json").open("w") as file:
        file.write('{"scipy": "%s", "cases": [\n' % scipy.__version__)
        file.write(",\n".join(json.dumps(c) for c in cases) + "\n]}\n")
    print(len(cases), "cases")


if __name__ == "__main__":
    main()
