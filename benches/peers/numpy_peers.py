"""NumPy and SciPy as an expert writes them, one workload a process.

    python numpy_peers.py PEER INPUT OUTPUT REPETITIONS

Prints `BASE megabytes` with the input read, `T seconds` per repetition and `RSS megabytes` at the peak; writes the answer as doubles. The driver sets the thread count.
"""
import sys
import time

import numpy as np
from inputs import knots

LO, HI = -4.5, 4.5
ROOTS = (1.0, 2.0, 2.0)
GRID = np.linspace(-3.5, 3.5, 8)
SD = (0.02, 0.05, 0.05)


def shape_of(p, q, xx, xy, yy):
    """S and R by mean and Gaussian curvature, as usually written."""
    g = 1 + p * p + q * q
    gauss = (xx * yy - xy * xy) / (g * g)
    mean = ((1 + q * q) * xx - 2 * p * q * xy + (1 + p * p) * yy) / (2 * g * np.sqrt(g))
    root = np.sqrt(np.maximum(mean * mean - gauss, 0))
    return -2 / np.pi * np.arctan2(mean, root), np.sqrt(np.maximum(2 * mean * mean - gauss, 0))


def bernstein(x):
    u = (x - LO) / (HI - LO)
    v = 1 - u
    return np.stack([v * v, 2 * u * v, u * u], 1), 2 / (HI - LO) * np.stack([-v, v - u, u], 1)


def grid_operator():
    b, d = bernstein(GRID)
    dd = np.tile(2 / (HI - LO) ** 2 * np.array([1.0, -2, 1]), (8, 1))
    return np.concatenate([np.kron(p, q) for p, q in ((d, b), (b, d), (dd, b), (d, d), (b, dd))])


def rows(x, y):
    (bx, dx), (by, dy) = bernstein(x), bernstein(y)
    kron = lambda p, q: (p[:, :, None] * q[:, None, :]).reshape(-1, 9)
    return np.concatenate([kron(bx, by), ROOTS[1] * kron(dx, by), ROOTS[2] * kron(bx, dy)])


def w1_numpy(data):
    x, y, z, zx, zy = data.reshape(5, -1)
    operator = grid_operator()

    def run():
        a = rows(x, y)
        b = np.concatenate([z, ROOTS[1] * zx, ROOTS[2] * zy])
        c = np.linalg.solve(a.T @ a, a.T @ b)
        s, r = shape_of(*(operator @ c).reshape(5, 64))
        return np.concatenate([c, s, r])

    return run, 200


def w1_fitpack(data):
    """Positions only: another fit, timed because it is what people call."""
    from scipy.interpolate import LSQBivariateSpline

    x, y, z, _, _ = data.reshape(5, -1)
    operator = grid_operator()

    def run():
        c = LSQBivariateSpline(x, y, z, [], [], bbox=[LO, HI, LO, HI], kx=2, ky=2).get_coeffs()
        s, r = shape_of(*(operator @ c).reshape(5, 64))
        return np.concatenate([c, s, r])

    return run, 100


def design(x, t, k, order=0):
    """Sparse design matrix of a derivative, from that of lower degree."""
    import scipy.sparse as sp
    from scipy.interpolate import BSpline

    if order == 0:
        return BSpline.design_matrix(x, t, k).tocsr()
    n = len(t) - k - 1
    h = k / (t[k + 1 : k + n] - t[1:n])
    difference = sp.diags([-h, h], [0, 1], shape=(n - 1, n))
    return (design(x, t[1:-1], k - 1, order - 1) @ difference).tocsr()


def w2_scipy(data, segments=64):
    """Contacts presorted by cell, sparse rows, LAPACK band Cholesky."""
    import scipy.sparse as sp
    from scipy.linalg import cho_solve_banded, cholesky_banded

    x, y, z, zx, zy = data.reshape(5, -1)
    t = knots(segments, 0, 1, 3)
    n = segments + 3

    def khatri_rao(a, b):
        width = 4
        values = (a.data.reshape(-1, width, 1) * b.data.reshape(-1, 1, width)).reshape(-1)
        columns = (a.indices.reshape(-1, width, 1) * n + b.indices.reshape(-1, 1, width)).reshape(-1)
        return sp.csr_matrix((values, columns, np.arange(len(x) + 1) * width * width), shape=(len(x), n * n))

    def full_rows(x, order):
        """Exactly four entries a row, zeros kept."""
        a = design(x, t, 3, order)
        first = np.minimum((x * segments).astype(np.int64), segments - 1)
        index = first[:, None] + np.arange(4)
        values = np.asarray(a[np.arange(len(x))[:, None], index].todense()) if a.nnz != 4 * len(x) else None
        if values is None:
            return a
        return sp.csr_matrix((values.ravel(), index.ravel(), np.arange(len(x) + 1) * 4), shape=a.shape)

    def run():
        cell = np.minimum((x * segments).astype(int), segments - 1) * segments
        cell += np.minimum((y * segments).astype(int), segments - 1)
        order = np.argsort(cell, kind="stable")
        xs, ys = x[order], y[order]
        bx, by = full_rows(xs, 0), full_rows(ys, 0)
        dx, dy = full_rows(xs, 1), full_rows(ys, 1)
        a = sp.vstack([khatri_rao(bx, by), khatri_rao(dx, by), khatri_rao(bx, dy)], format="csr")
        b = np.concatenate([z[order], zx[order], zy[order]])
        at = a.T.tocsr()
        lower = sp.tril(at @ a, format="coo")
        offset = lower.row - lower.col
        band = np.zeros((n * n, int(offset.max()) + 1))
        band[lower.col, offset] = lower.data
        factor = cholesky_banded(band.T, overwrite_ab=True, lower=True, check_finite=False)
        return cho_solve_banded((factor, True), at @ b, check_finite=False)

    return run, 1


def image_bases(x, y):
    tx, ty = knots(80, 0, 1, 3), knots(60, 0, 0.75, 3)
    return design(x, tx, 3), design(x, tx, 3, 1), design(y, ty, 3), design(y, ty, 3, 1)


def eigenpairs(values, slopes, driver):
    from scipy.linalg import eigh

    return eigh((slopes.T @ slopes).toarray(), (values.T @ values).toarray(), driver=driver)


def w3(data, reused):
    x, y = data[:640], data[640:1120]
    z, zx, zy = data[1120:].reshape(3, 640, 480)

    def plan():
        bx, dx, by, dy = image_bases(x, y)
        lam, u = eigenpairs(bx, dx, "gvd")
        mu, v = eigenpairs(by, dy, "gvd")
        return bx.T.tocsr(), dx.T.tocsr(), by.T.tocsr(), dy.T.tocsr(), u, v, 1 / (1 + lam[:, None] + mu)

    held = plan() if reused else None

    def run():
        bx, dx, by, dy, u, v, g = held if reused else plan()
        right = (by @ (bx @ z + dx @ zx).T).T + (dy @ (bx @ zy).T).T
        return (u @ ((u.T @ right @ v) * g) @ v.T).ravel()

    return run, 1


def w4_numpy(data, count=100_000, chunk=256):
    x, y, z, zx, zy = data.reshape(5, -1)

    def run():
        a = rows(x, y)
        sd, roots = np.repeat(SD, 36), np.repeat(ROOTS, 36)
        response = (np.linalg.pinv(a) * roots).T
        nominal = np.concatenate([z, zx, zy]) @ response
        response = sd[:, None] * response
        operator = np.ascontiguousarray(grid_operator().T)
        rng = np.random.default_rng(2026)
        s, r = np.empty(count), np.empty(count)
        drawn = np.empty((chunk, 108))
        for i in range(0, count, chunk):
            k = min(chunk, count - i)
            rng.standard_normal(out=drawn[:k])
            g = ((nominal + drawn[:k] @ response) @ operator).reshape(k, 5, 64)
            index, curved = shape_of(*(g[:, q] for q in range(5)))
            s[i : i + k], r[i : i + k] = index.mean(1), curved.mean(1)
        return np.array([v for q in (s, r) for v in (q.mean(), *np.percentile(q, [2.5, 97.5]))])

    return run, 1


def w5_numpy(data, block=20):
    """Dense bases, blocks of rows that stay in cache."""
    c = data.reshape(67, 67)
    at = np.linspace(0, 1, 1000)
    t = knots(64, 0, 1, 3)

    def run():
        basis = [design(at, t, 3, k).toarray() for k in range(3)]
        left = [b @ c for b in basis]
        right = [np.ascontiguousarray(b.T) for b in basis]
        s, r = np.empty((1000, 1000)), np.empty((1000, 1000))
        for i in range(0, 1000, block):
            k = slice(i, i + block)
            pairs = ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
            s[k], r[k] = shape_of(*(left[p][k] @ right[q] for p, q in pairs))
        return np.concatenate([s.ravel(), r.ravel()])

    return run, 1


def w5_scipy(data):
    from scipy.interpolate import bisplev

    t = knots(64, 0, 1, 3)
    at = np.linspace(0, 1, 1000)

    def run():
        pairs = ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
        s, r = shape_of(*(bisplev(at, at, (t, t, data, 3, 3), *q) for q in pairs))
        return np.concatenate([s.ravel(), r.ravel()])

    return run, 1


PEERS = {
    "w1_numpy": w1_numpy,
    "w1_fitpack": w1_fitpack,
    "w2_scipy": w2_scipy,
    "w2l_scipy": lambda data: w2_scipy(data, 128),
    "w3_cold": lambda data: w3(data, False),
    "w3_reused": lambda data: w3(data, True),
    "w4_numpy": w4_numpy,
    "w5_numpy": w5_numpy,
    "w5_scipy": w5_scipy,
}


def peak_megabytes():
    with open("/proc/self/status") as status:
        peak = next(line for line in status if line.startswith("VmHWM"))
    return int(peak.split()[1]) / 1024


def main():
    peer, source, target, repetitions = sys.argv[1:5]
    run, inner = PEERS[peer](np.fromfile(source))
    print("BASE %.1f" % peak_megabytes())
    for k in range(int(repetitions) + 1):
        start = time.perf_counter()
        for _ in range(inner):
            answer = run()
        if k:
            print("T %.9f" % ((time.perf_counter() - start) / inner))
    np.asarray(answer, dtype="<f8").tofile(target)
    print("RSS %.1f" % peak_megabytes())


if __name__ == "__main__":
    main()
