"""A gaussian-process implicit surface in NumPy, as an expert writes it: places and normals as data, hyperparameters by the evidence.

    f(p) = |p - c| - r + g(p),   g ~ GP(0, s^2 exp(-|p - q|^2 / (2 l^2)))      f = 0 and grad f = normal at every contact

Noise of places and normals is told. Contacts that the surface of the others misses by four standard deviations are taken out, twice.
(O. Williams, A. Fitzgibbon 2007; S. Dragiev, M. Toussaint, M. Gienger 2011.)
"""
import bodies
import numpy as np

LENGTHS = (0.25, 0.4, 0.6, 0.9, 1.4)
SIZES = (0.03, 0.1, 0.3)


def covariance(p, q, length, size):
    """Of values and gradients at p with those at q, values first: (4n) x (4m)."""
    d = p[:, None, :] - q[None, :, :]
    k = size**2 * np.exp(-0.5 * np.sum(d * d, axis=-1) / length**2)
    n, m = k.shape
    out = np.empty((4, n, 4, m))
    out[0, :, 0, :] = k
    for a in range(3):
        along = d[..., a] / length**2
        out[0, :, 1 + a, :] = k * along
        out[1 + a, :, 0, :] = -k * along
        for b in range(3):
            out[1 + a, :, 1 + b, :] = k * ((a == b) / length**2 - along * d[..., b] / length**2)
    return out.reshape(4 * n, 4 * m)


class Implicit:
    def __init__(self, points, normals):
        self.centre = points.mean(axis=0)
        self.radius = np.linalg.norm(points - self.centre, axis=1).mean()
        keep = np.ones(len(points), bool)
        for _ in range(3):
            self.points, self.normals = points[keep], normals[keep]
            tries = [self.fit(length * self.radius, size * self.radius) for length in LENGTHS for size in SIZES]
            best = max(tries, key=lambda t: t[0])
            _, self.length, self.size, self.lower, self.weights = best
            away = self.left_out()
            bad = away > 4
            if not bad.any():
                break
            keep[np.flatnonzero(keep)[bad]] = False

    def prior(self, p):
        d = p - self.centre
        far = np.linalg.norm(d, axis=-1)
        return far - self.radius, d / far[..., None]

    def noise(self, count):
        return np.concatenate([np.full(count, bodies.NOISE_Z**2), np.full(3 * count, np.radians(bodies.NOISE_DEG) ** 2)])

    def fit(self, length, size):
        value, slope = self.prior(self.points)
        self.data = np.concatenate([-value, (self.normals - slope).T.ravel()])
        K = covariance(self.points, self.points, length, size)
        K[np.diag_indices_from(K)] += self.noise(len(self.points))
        try:
            L = np.linalg.cholesky(K)
        except np.linalg.LinAlgError:
            return -np.inf, length, size, None, None
        half = np.linalg.solve(L, self.data)
        return -0.5 * half @ half - np.sum(np.log(np.diag(L))), length, size, L, np.linalg.solve(L.T, half)

    def left_out(self):
        """Residual of every contact's place, told by all others, over its standard deviation."""
        inverse = np.linalg.inv(self.lower)
        precision = np.sum(inverse**2, axis=0)
        n = len(self.points)
        return np.abs(self.weights[:n]) / np.sqrt(precision[:n])

    def at(self, p):
        """f and its gradient."""
        value, slope = self.prior(p)
        found = (covariance(p, self.points, self.length, self.size) @ self.weights).reshape(4, len(p))
        return value + found[0], slope + found[1:].T

    def gradient(self, p):
        return self.at(p)[1]

    def sd(self, p):
        k = covariance(p, self.points, self.length, self.size)[: len(p)]
        half = np.linalg.solve(self.lower, k.T)
        return np.sqrt(np.maximum(self.size**2 - np.sum(half**2, axis=0), 0))

    def feet(self, p, n):
        """Where the surface crosses the lines through p along n: distances, k1, k2 there, and the sd of the place."""
        t = np.zeros(len(p))
        for _ in range(8):
            value, slope = self.at(p + t[:, None] * n)
            t = np.clip(t - value / np.maximum(np.sum(slope * n, axis=1), 0.2), -8, 8)
        q, h = p + t[:, None] * n, 1e-2
        g = self.gradient(q)
        H = np.stack([(self.gradient(q + h * e) - self.gradient(q - h * e)) / (2 * h) for e in np.eye(3)], -1)
        return t, *bodies.curvatures(g, H), self.sd(q) / np.linalg.norm(g, axis=1)
