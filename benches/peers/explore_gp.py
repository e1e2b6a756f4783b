"""Contacts until S and R are right, by a Gaussian process that touches where its height is least certain.

    f(x, y) ~ GP(0, c^2 (1 + x x' + y y') + s^2 exp(-(x - x')^2 / 2 a^2 - (y - y')^2 / 2 b^2))

Every contact gives three observations: height, and both slopes with the covariance that an error of the normal has there
(derivatives of the kernel, C. E. Rasmussen and C. K. I. Williams, *Gaussian Processes for Machine Learning*, 9.4). The
noise sds are given; s, a, b maximise the marginal likelihood before every round (SciPy's L-BFGS; SciPy's Cholesky does the
linear algebra). The next touches are the candidates of the largest posterior variance of the height, one after the other.
S and R are means over 8 x 8 points of the patch, from the posterior mean's first and second derivatives.

    cargo bench --bench explore -- export OBJECTS NOISES FIRST > touched.csv
    python benches/peers/explore_gp.py touched.csv
"""

import sys
from multiprocessing import Pool

import numpy as np
from scipy.linalg import cho_factor, cho_solve, solve_triangular
from scipy.optimize import minimize

BUDGET, PER_ROUND, HALF = 60, 3, 4.0
SIGMA_Z, SIGMA_N = 0.02, 0.03
RIGHT = (0.01, 0.02)
KINDS = ["sphere", "cylinder", "saddle", "torus", "bump", "superquadric"]
FIRST = [0, 10, 20, 210, 220, 230, 420, 430, 440]  # 3 x 3 of 21 x 21
STEPS = 10  # of L-BFGS in every round, from where the last round ended
WIDE = 10.0  # c: next to no prior on height and tilt


def hermite(u, n):
    """d^n/dt^n exp(-t^2/2) / exp(-t^2/2) at u."""
    return [np.ones_like(u), -u, u * u - 1, 3 * u - u**3, u**4 - 6 * u * u + 3][n]


def block(p, q, theta, dp, dq):
    """Covariance of d^dp f at p and d^dq f at q, dp and dq being orders in x and y."""
    s2, a, b = theta
    u = (p[:, None, 0] - q[None, :, 0]) / a
    v = (p[:, None, 1] - q[None, :, 1]) / b
    sign = (-1.0) ** (dq[0] + dq[1])
    scale = a ** -(dp[0] + dq[0]) * b ** -(dp[1] + dq[1])
    k = sign * scale * s2 * hermite(u, dp[0] + dq[0]) * hermite(v, dp[1] + dq[1]) * np.exp(-0.5 * (u * u + v * v))
    # the plane: 1, x, y with their derivatives
    basis = lambda z, d: {(0, 0): np.column_stack([np.ones(len(z)), z]), (1, 0): np.array([[0, 1, 0]] * len(z)),
                          (0, 1): np.array([[0, 0, 1]] * len(z))}.get(d, np.zeros((len(z), 3)))
    return k + WIDE**2 * basis(p, dp) @ basis(q, dq).T


DATA = [(0, 0), (1, 0), (0, 1)]


class Process:
    def __init__(self, contacts):
        self.at = contacts[:, :2]
        normal = contacts[:, 3:] / np.linalg.norm(contacts[:, 3:], axis=1, keepdims=True)
        p, q = -normal[:, 0] / normal[:, 2], -normal[:, 1] / normal[:, 2]
        self.y = np.concatenate([contacts[:, 2], p, q])
        n = len(contacts)
        self.noise = np.zeros((3 * n, 3 * n))
        i = np.arange(n)
        # an error of x and y moves the height by the slope
        self.noise[i, i] = SIGMA_Z**2 * (1 + p * p + q * q)
        # J'J of d normal / d slope, inverted
        w2 = 1 + p * p + q * q
        for k in range(n):
            j = np.array([[1 + q[k] ** 2, -p[k] * q[k]], [-p[k] * q[k], 1 + p[k] ** 2]]) / w2[k] ** 2
            c = SIGMA_N**2 * np.linalg.inv(j)
            rows = [n + k, 2 * n + k]
            self.noise[np.ix_(rows, rows)] = c

    def gram(self, theta):
        """All nine blocks at once: they share one exponential."""
        s2, a, b = theta
        u = (self.at[:, None, 0] - self.at[None, :, 0]) / a
        v = (self.at[:, None, 1] - self.at[None, :, 1]) / b
        k = s2 * np.exp(-0.5 * (u * u + v * v))
        x, y, xx, xy, yy = u / a * k, v / b * k, (1 - u * u) / a**2 * k, -u * v / (a * b) * k, (1 - v * v) / b**2 * k
        full = np.block([[k, x, y], [-x, xx, xy], [-y, xy, yy]])
        n = len(self.at)
        plane = np.zeros((3 * n, 3))
        plane[:n, 0], plane[:n, 1:], plane[n : 2 * n, 1], plane[2 * n :, 2] = 1, self.at, 1, 1
        return full + WIDE**2 * plane @ plane.T + self.noise

    def cost(self, log):
        theta = np.exp(log)
        try:
            factor = cho_factor(self.gram(theta), lower=True)
        except np.linalg.LinAlgError:
            return 1e10
        # a weak prior on the lengths keeps the search inside what 8 by 8 can tell
        prior = 0.5 * np.sum(((log[1:] - np.log(10.0)) / 1.5) ** 2)
        return 0.5 * self.y @ cho_solve(factor, self.y) + np.log(np.diag(factor[0])).sum() + prior

    def learn(self, start):
        best = minimize(self.cost, start, method="L-BFGS-B", bounds=[(-8, 12), (0.0, 5.0), (0.0, 5.0)],
                        options={"maxiter": STEPS})
        self.theta = np.exp(best.x)
        self.factor = cho_factor(self.gram(self.theta), lower=True)
        self.weights = cho_solve(self.factor, self.y)
        return best.x

    def cross(self, at, d):
        return np.hstack([block(at, self.at, self.theta, d, e) for e in DATA])

    def shape(self):
        axis = np.linspace(-HALF, HALF, 8)
        at = np.array([(x, y) for x in axis for y in axis])
        p, q, r, t, u = (self.cross(at, d) @ self.weights for d in [(1, 0), (0, 1), (2, 0), (1, 1), (0, 2)])
        w2 = 1 + p * p + q * q
        gauss = (r * u - t * t) / w2**2
        mean = ((1 + q * q) * r - 2 * p * q * t + (1 + p * p) * u) / (2 * w2**1.5)
        gap = np.sqrt(np.maximum(mean * mean - gauss, 0))
        s = -2 / np.pi * np.arctan2(mean, gap)
        return s.mean(), np.sqrt(np.maximum(2 * mean * mean - gauss, 0)).mean()

    def next(self, places, n):
        """Places of the largest variance of the height; a chosen one counts as touched (height and slopes)."""
        rows = np.vstack([self.cross(places, d) for d in DATA])
        half = solve_triangular(self.factor[0], rows.T, lower=True)
        m = len(places)
        prior = np.block([[block(places, places, self.theta, d, e) for e in DATA] for d in DATA])
        cov = prior - half.T @ half
        noise = np.diag([SIGMA_Z**2, SIGMA_N**2, SIGMA_N**2])
        chosen = []
        for _ in range(n):
            variance = np.diag(cov)[:m].copy()
            variance[chosen] = -1
            k = int(np.argmax(variance))
            chosen.append(k)
            rows = [k, m + k, 2 * m + k]
            gain = cov[:, rows] @ np.linalg.inv(cov[np.ix_(rows, rows)] + noise)
            cov = cov - gain @ cov[rows, :]
        return chosen


def until(run):
    (seed, noise, s, r), touched = run
    done = list(FIRST)
    log, before = np.array([2.0, np.log(10.0), np.log(10.0)]), None
    while True:
        process = Process(touched[done])
        log = process.learn(log)
        found = process.shape()
        right = abs(found[0] - s) <= RIGHT[0] and abs(found[1] / r - 1) <= RIGHT[1]
        if right and before is not None:
            return seed, before
        before = len(done) if right else None
        left = [k for k in range(len(touched)) if k not in done]
        n = min(PER_ROUND, BUDGET - len(done))
        if n == 0:
            return seed, 10**9
        done += [left[k] for k in process.next(touched[left, :2], n)]


def read(path):
    lines = open(path).read().splitlines()
    for k in range(0, len(lines), 442):
        seed, noise, s, r = lines[k].split(",")
        touched = np.array([[float(v) for v in line.split(",")] for line in lines[k + 1 : k + 442]])
        yield (int(seed), int(noise), float(s), float(r)), touched


def quantile(counts, q):
    at = max(int(np.ceil(q * len(counts))), 1) - 1
    value = sorted(counts)[at]
    return f"> {BUDGET}" if value > BUDGET else str(value)


def main():
    with Pool(2) as pool:
        found = pool.map(until, read(sys.argv[1]), chunksize=4)
    counts = [c for _, c in found]
    never = 100 * np.mean([c > BUDGET for c in counts])
    kinds = ", ".join(f"{kind} {quantile([c for o, c in found if o % 6 == k], 0.5)}" for k, kind in enumerate(KINDS))
    print(f"{'strategy':<22} {'median':>7} {'90 %':>8} {'never, %':>10}   medians by kind")
    print(f"{'Gaussian process':<22} {quantile(counts, 0.5):>7} {quantile(counts, 0.9):>8} {never:>10.1f}   {kinds}")


if __name__ == "__main__":
    main()
