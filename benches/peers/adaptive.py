"""Adaptive fits beside G+Smo's THB-splines, on the same contacts: seconds, unknowns, error.

    pip install pygismo numpy scipy palpate; adaptive.py [CONTACTS ...]

G+Smo: the loop of its fitting_example, through its Python module: fit, mark the cells of residuals beyond a tolerance (4.5 sd of the noise, which it
must be told), split them with their neighbours, until none is left or eight rounds are done. Uniform: SciPy's rows of a tensor spline of the size of the
smallest cells that palpate made, normal equations by its sparse solver, smoothed as little as keeps them definite.
"""

import sys
import time

import numpy as np
import palpate
import pygismo
import scipy.sparse
import scipy.sparse.linalg
from scipy.interpolate import BSpline

NOISE, RADIUS = 0.002, 0.02


def scene(count: int, features: int = 10) -> tuple[np.ndarray, np.ndarray, np.ndarray, object]:
    random = np.random.default_rng(7)
    places = random.uniform(-0.9, 0.9, (features, 2))
    heights = NOISE * random.uniform(3, 10, features) * random.choice([-1, 1], features)

    def truth(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        z = 0.3 * np.sin(1.5 * x) * np.cos(1.2 * y + 0.3)
        for (u, v), h in zip(places, heights):
            z = z + h * np.exp(-((x - u) ** 2 + (y - v) ** 2) / RADIUS**2)
        return z

    x, y = random.uniform(-1, 1, (2, count))
    return x, y, truth(x, y) + NOISE * random.standard_normal(count), truth


def gismo(x: np.ndarray, y: np.ndarray, z: np.ndarray, u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, int, int]:
    degree, segments = 3, 8
    knots = pygismo.nurbs.gsKnotVector([-1.0] * 4 + [-1 + 2 * k / segments for k in range(1, segments)] + [1.0] * 4, degree)
    basis = pygismo.hsplines.gsTHBSplineBasis2(pygismo.nurbs.gsTensorBSplineBasis2(knots, knots))
    at, heights = np.asfortranarray(np.stack([x, y])), np.asfortranarray(z[None, :])
    levels = np.zeros(len(x), dtype=int)
    for rounds in range(1, 9):
        fitting = pygismo.modelling.gsFitting(at, heights, basis)
        fitting.compute(1e-9)
        surface = fitting.result()
        off = np.abs(np.asarray(surface.eval(at)).ravel() - z)
        marked = off > 4.5 * NOISE
        if not marked.any() or rounds == 8:
            heights = np.asarray(surface.eval(np.asfortranarray(np.stack([u, v])))).ravel()
            return heights, basis.size(), rounds
        # a cell of the level that holds the contact, and one about it
        width = 2.0 / (segments << levels[marked])
        cells = np.unique(
            np.stack([levels[marked], (x[marked] + 1) // width, (y[marked] + 1) // width]).astype(int), axis=1
        ).T
        boxes = []
        for level, i, j in cells:
            last = segments << level
            ends = [max(i - 1, 0), max(j - 1, 0), min(i + 2, last), min(j + 2, last)]
            boxes += [int(level) + 1, *(2 * int(end) for end in ends)]
        basis.refineElements(boxes)
        for level, i, j in cells:
            side = 2.0 / (segments << level)
            inside = (np.abs((x + 1) / side - i - 0.5) < 1.5) & (np.abs((y + 1) / side - j - 0.5) < 1.5)
            levels[inside & (levels == level)] = level + 1
    raise AssertionError


def uniform(x: np.ndarray, y: np.ndarray, z: np.ndarray, segments: int) -> tuple[object, int]:
    knots = np.r_[[-1.0] * 3, np.linspace(-1, 1, segments + 1), [1.0] * 3]
    count = segments + 3
    order = np.argsort(np.minimum((x + 1) * segments / 2, segments - 1).astype(int), kind="stable")
    rows = [BSpline.design_matrix(t[order], knots, 3).tocsr() for t in (x, y)]
    values = (rows[0].data.reshape(-1, 4, 1) * rows[1].data.reshape(-1, 1, 4)).reshape(-1)
    columns = (rows[0].indices.reshape(-1, 4, 1) * count + rows[1].indices.reshape(-1, 1, 4)).reshape(-1)
    matrix = scipy.sparse.csr_matrix((values, columns, np.arange(0, 16 * len(x) + 1, 16)), shape=(len(x), count * count))
    second = scipy.sparse.csr_matrix(np.diff(np.eye(count), 2, axis=0))
    one = scipy.sparse.identity(count)
    rough = scipy.sparse.kron(second.T @ second, one) + scipy.sparse.kron(one, second.T @ second)
    solved = scipy.sparse.linalg.spsolve((matrix.T @ matrix + 1e-3 * rough).tocsc(), matrix.T @ z[order])
    table = solved.reshape(count, count)

    def at(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        return np.einsum("ri,ri->r", BSpline.design_matrix(u, knots, 3) @ table, BSpline.design_matrix(v, knots, 3).toarray())

    return at, count * count


def main(counts: list[int]) -> None:
    print("| contacts | fit | seconds | unknowns | rounds | error/sigma |\n|---|---|---|---|---|---|")
    for count in counts:
        x, y, z, truth = scene(count)
        u, v = np.random.default_rng(9).uniform(-1, 1, (2, 20_000))

        def told(name: str, seconds: float, unknowns: int, rounds: object, heights: np.ndarray, count: int = count) -> None:
            error = np.sqrt(np.mean((heights - truth(u, v)) ** 2)) / NOISE
            print(f"| {count} | {name} | {seconds:.2f} | {unknowns} | {rounds} | {error:.4f} |", flush=True)

        begun = time.perf_counter()
        fit = palpate.fit(x, y, z, adaptive=True, bare=True)
        seconds, about = time.perf_counter() - begun, fit.to_dict()["fit"]
        told("palpate", seconds, about["unknowns"], about["adaptive"]["rounds"], fit.surface.ev(u, v))
        smallest = 8 << about["adaptive"]["halvings"]
        begun = time.perf_counter()
        at, unknowns = uniform(x, y, z, smallest)
        told(f"uniform, {smallest} x {smallest} cells, SciPy", time.perf_counter() - begun, unknowns, 1, at(u, v))
        begun = time.perf_counter()
        heights, unknowns, rounds = gismo(x, y, z, u, v)
        told("G+Smo THB", time.perf_counter() - begun, unknowns, rounds, heights)


if __name__ == "__main__":
    main([int(word) for word in sys.argv[1:]] or [10_000, 100_000])
