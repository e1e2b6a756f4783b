"""What SciPy's least squares spline says inside the disc-shaped gap of `disc_gap_heights`.

    python tests/golden/disc_gap_scipy.py

Same contacts, knots and degree as the hard case.  Prints the worst error inside the hole and at the contacts (against the hill
without noise), and the warning SciPy gave.
"""
import warnings

import numpy
import scipy
from scipy.interpolate import LSQBivariateSpline

from cases import gap
from inputs import linspace


def main():
    case = gap()[0]
    inner = linspace(-1.0, 1.0, case.segments[0] + 1)[1:-1]
    axis = numpy.linspace(-1.0, 1.0, 201)
    x, y = numpy.meshgrid(axis, axis, indexing="ij")
    truth = 1.0 / (1.0 + x**2 + 2.0 * y**2)
    inside = x**2 + y**2 < 0.36
    print("scipy %s, %d contacts with heights in [%.3f, %.3f]" % (scipy.__version__, len(case.x), min(case.z), max(case.z)))
    for eps in (1e-16, 1e-13, 1e-8, 1e-4):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            spline = LSQBivariateSpline(case.x, case.y, case.z, inner, inner, bbox=[-1, 1, -1, 1], kx=3, ky=3, eps=eps)
        found = spline(axis, axis)
        error = numpy.abs(found - truth)
        hill = 1.0 / (1.0 + numpy.square(case.x) + 2.0 * numpy.square(case.y))
        outside = numpy.abs(spline.ev(case.x, case.y) - hill).max()
        print("eps %.0e: worst error inside the hole %.3g, at the contacts %.3g; values inside %.3g to %.3g; %s" % (
            eps, error[inside].max(), outside, found[inside].min(), found[inside].max(),
            " ".join(str(w.message).split(".")[0].replace("\n", " ") for w in caught) or "no warning"))  # fmt: skip


if __name__ == "__main__":
    main()
