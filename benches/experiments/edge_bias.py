"""How much a smoothed departure bends too little at the edge of a wave, by the surface that it is smoothed about.

    python benches/experiments/edge_bias.py [--sd 0.0016] [--fits 20]

One profile z = 0.6 (cos(2 pi x / 12) - 1), touched at 14 stations from -4 to 4 by 14 fingers, heights alone. The departure from a circle of
curvature k0 is what the recognition's smooth departures are along one side: splines of degree 4 whose values at the Greville sites have the
covariance exp(-(u - v)^2 / 2 l^2), l half of the chart's length, without their terms of second degree, which are free; its size is the one of
largest evidence among the powers of ten. Printed is the mean relative error of the curvature at both ends. That is why departures are tried
over a plane, too (src/inference/recognition/evidence/discrepancy_over_plane.rs).
"""

import argparse

import numpy as np
from scipy.interpolate import BSpline

AMPLITUDE, PITCH, HALF = 0.6, 2 * np.pi / 12, 4.0
STATIONS, FINGERS, DEGREE, MARGIN = 14, 14, 4, 0.02


def height(x):
    return AMPLITUDE * (np.cos(PITCH * x) - 1)


def curvature(x):
    slope = -AMPLITUDE * PITCH * np.sin(PITCH * x)
    return -AMPLITUDE * PITCH**2 * np.cos(PITCH * x) / (1 + slope**2) ** 1.5


def basis(knots, x, derivative=0):
    columns = np.eye(len(knots) - DEGREE - 1)
    return np.array([BSpline(knots, c, DEGREE).derivative(derivative)(x) if derivative else BSpline(knots, c, DEGREE)(x) for c in columns]).T


def process(knots, length):
    """Coefficients of the process' directions, without their terms of second degree."""
    count = len(knots) - DEGREE - 1
    sites = np.array([knots[i + 1 : i + DEGREE + 1].mean() for i in range(count)])
    at_sites = basis(knots, sites)
    values, vectors = np.linalg.eigh(np.exp(-((sites[:, None] - sites) ** 2) / (2 * length**2)))
    factor = np.linalg.solve(at_sites, vectors * np.sqrt(np.maximum(values, 0)))
    square = np.linalg.qr(np.linalg.solve(at_sites, np.vander(sites, 3)))[0]
    return factor - square @ (square.T @ factor)


def errors(about, segments, sd, rng):
    """Errors of the curvature at both ends, of one fit; `about` is the curvature of a circle that lies below."""
    radius = 1 / about
    x = np.linspace(-HALF, HALF, STATIONS)
    z = height(x) + sd * rng.standard_normal(STATIONS)
    u, d = radius * np.arctan2(x, radius + z), np.hypot(x, radius + z) - radius
    margin = MARGIN * np.ptp(u)
    lo, hi = u.min() - margin, u.max() + margin
    knots = np.r_[[lo] * DEGREE, np.linspace(lo, hi, segments + 1), [hi] * DEGREE]
    columns = process(knots, 0.5 * (hi - lo))
    at_stations = basis(knots, u) @ columns
    columns /= np.sqrt((at_stations**2).sum() / STATIONS)
    at_stations = basis(knots, u) @ columns
    free, prior = np.vander(u, 3, increasing=True), np.diag(np.r_[np.zeros(3), np.ones(columns.shape[1])])
    best = None
    for power in range(13):
        size = 10 ** (power / 2) * sd
        rows = np.hstack([free, size * at_stations]) / sd
        precision = rows.T @ rows + prior
        mean = np.linalg.solve(precision, rows.T @ (d / sd))
        evidence = 0.5 * mean @ (rows.T @ (d / sd)) - 0.5 * np.linalg.slogdet(precision)[1]
        if best is None or evidence > best[0]:
            best = evidence, mean[:3], size * columns @ mean[3:]
    _, (h, a, b), coefficients = best
    ends = np.array([-HALF, HALF])
    at = radius * np.arctan2(ends, radius + height(ends))
    f, fu, fuu = (basis(knots, at, k) @ coefficients for k in range(3))
    # the curve in polar coordinates about the circle's centre
    r, r1, r2 = radius + h + a * at + b * at**2 + f, radius * (a + 2 * b * at + fu), radius**2 * (2 * b + fuu)
    found = -(r**2 + 2 * r1**2 - r * r2) / (r**2 + r1**2) ** 1.5
    return found / curvature(ends) - 1


def main():
    asked = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    asked.add_argument("--sd", type=float, default=0.0016)
    asked.add_argument("--fits", type=int, default=20)
    asked = asked.parse_args()
    print("error of the curvature at both ends, %")
    print("radius of the circle" + "".join(f"{segments:4d} segments" for segments in (5, 7)))
    for radius in (10000.0, 50.0, 20.0, 10.0):
        means = []
        for segments in (5, 7):
            rng = np.random.default_rng(1)
            sd = asked.sd / np.sqrt(FINGERS)
            means.append(100 * np.mean([errors(1 / radius, segments, sd, rng) for _ in range(asked.fits)]))
        print(f"{radius:20.0f}" + "".join(f"{mean:13.1f}" for mean in means))


if __name__ == "__main__":
    main()
