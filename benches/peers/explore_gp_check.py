"""tinygp's process of `explore_gp.py` beside the same process in closed form, in NumPy.

    python benches/peers/explore_gp_check.py touched.csv

    cov(d^m f, d^n f') = (-1)^n s^2 H_(m+n)(x - x' / a) H(..) exp(..) / a^(m+n) ..      H: d^n exp(-t^2/2) = H_n exp(-t^2/2)
    mean = k K^-1 y,   variance = k(p, p) - k K^-1 k',   log likelihood = -(y' K^-1 y + log|2 pi K|) / 2

C. E. Rasmussen and C. K. I. Williams, *Gaussian Processes for Machine Learning*, MIT Press 2006, 2.2 and 9.4. Derivatives are
written out where tinygp has them from JAX, and nothing is filled up to a round number of contacts.
"""

import sys

import explore_gp as gp
import numpy as np

ORDERS = [(0, 0), (1, 0), (0, 1)]
SECOND = [(2, 0), (1, 1), (0, 2)]
# s^2, a, b: flat and bent, short and long, and what a search ends at
LENGTHS = [(7.0, 10.0, 10.0), (0.3, 3.0, 5.0), (400.0, 25.0, 8.0)]
WITHIN = 1e-8


def hermite(u, n):
    return [np.ones_like(u), -u, u * u - 1, 3 * u - u**3, u**4 - 6 * u * u + 3][n]


def plane(at, order):
    """1, x, y and their derivatives."""
    rows = np.zeros((len(at), 3))
    if order == (0, 0):
        rows[:, 0], rows[:, 1:] = 1, at
    elif order in ORDERS:
        rows[:, ORDERS.index(order)] = 1
    return rows


def covariance(p, q, theta, m, n):
    s2, a, b = theta
    u, v = (p[:, None, 0] - q[None, :, 0]) / a, (p[:, None, 1] - q[None, :, 1]) / b
    x, y = m[0] + n[0], m[1] + n[1]
    bell = (-1.0) ** sum(n) * s2 * hermite(u, x) * hermite(v, y) * np.exp(-0.5 * (u * u + v * v)) / (a**x * b**y)
    return bell + gp.WIDE**2 * plane(p, m) @ plane(q, n).T


def closed_form(theta, touched, places):
    """Slopes and second derivatives of the mean, variance of the height, log likelihood."""
    at, n = touched[:, :2], len(touched)
    room, rows = len(gp.contacts_of(touched)[3]) // 3, np.arange(n)
    rows = np.concatenate([rows, room + rows, 2 * room + rows])
    _, _, noise, values = gp.contacts_of(touched)
    y = values[rows]
    full = np.block([[covariance(at, at, theta, m, n) for n in ORDERS] for m in ORDERS]) + noise[np.ix_(rows, rows)]
    cross = lambda m: np.hstack([covariance(places, at, theta, m, n) for n in ORDERS])
    weights = np.linalg.solve(full, y)
    height = cross((0, 0))
    here = theta[0] + gp.WIDE**2 * (1 + (places**2).sum(axis=1))
    variance = here - (height * np.linalg.solve(full, height.T).T).sum(axis=1)
    likelihood = -0.5 * (y @ weights + np.linalg.slogdet(2 * np.pi * full)[1])
    return [cross(m) @ weights for m in ORDERS[1:] + SECOND] + [variance, likelihood]


def library(theta, touched, places):
    log, contacts = np.log(theta), gp.contacts_of(touched)
    slopes, second = gp.bends(log, contacts, places)
    filled = len(contacts[3]) - 3 * len(touched)
    # what fills up the contacts is independent and exactly zero: each row costs log(2 pi) / 2
    likelihood = gp.process(log, contacts).log_probability(contacts[3]) + 0.5 * filled * np.log(2 * np.pi)
    return [*slopes.T, *second[:, [0, 0, 1], [0, 1, 1]].T, gp.variance(log, contacts, places), likelihood]


def check(runs):
    names = ["slope x", "slope y", "xx", "xy", "yy", "variance", "log likelihood"]
    worst = dict.fromkeys(names, 0.0)
    cases = 0
    for (_, touched), count in zip(runs, [9, 12, 15, 27, 45, 60]):
        some = np.random.default_rng(count).permutation(len(touched))[:count]
        found = gp.learn(gp.contacts_of(touched[some]), [gp.START])
        for theta in [*LENGTHS, tuple(np.exp(found))]:
            one, other = (f(theta, touched[some], touched[:, :2]) for f in (closed_form, library))
            for name, a, b in zip(names, one, other):
                worst[name] = max(worst[name], np.max(np.abs(a - b)) / np.max(np.abs(a)))
            cases += 1
    print(f"tinygp with the closed form, {cases} cases, largest difference over the largest value:")
    print(", ".join(f"{name} {value:.1e}" for name, value in worst.items()))
    if max(worst.values()) > WITHIN:
        sys.exit(f"they differ by more than {WITHIN:g}")


if __name__ == "__main__":
    check(gp.read(sys.argv[1]))
