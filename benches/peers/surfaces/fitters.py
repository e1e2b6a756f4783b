"""Other tools as an expert uses them: from contacts or pixels to zx, zy, zxx, zxy, zyy (or k1, k2) at given points.

Each takes a `Task` and one setting of its list, and is told the noise wherever it can use it. palpate is told nothing.
"""
import os
import subprocess
import tempfile

import families
import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
ORDERS = ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
H = 1e-2


class Task:
    """What was touched, and where answers are asked."""

    def __init__(self, x, y, z, normals, image, tx, ty):
        self.x, self.y, self.z, self.normals, self.image, self.tx, self.ty = x, y, z, normals, image, tx, ty

    def slopes(self):
        return -self.normals[:, 0] / self.normals[:, 2], -self.normals[:, 1] / self.normals[:, 2]


def design(x, y, degree, segments, dx=0, dy=0):
    """One row a point: products of the basis functions in x and in y, or of their derivatives."""
    from scipy.interpolate import BSpline

    knots = np.concatenate([np.full(degree, -6.0), np.linspace(-6, 6, segments + 1), np.full(degree, 6.0)])
    identity = np.eye(degree + segments)
    bx, by = (BSpline(knots, identity, degree)(np.clip(v, -6, 6), d) for v, d in ((x, dx), (y, dy)))
    return (bx[:, :, None] * by[:, None, :]).reshape(len(x), -1)


def solved(task, degree, segments, smoothing):
    """Tensor spline by least squares: heights, slopes where there are normals, a penalty on third differences."""
    rows, sides = [design(task.x, task.y, degree, segments) / families.NOISE_Z], [task.z / families.NOISE_Z]
    if task.normals is not None:
        for slope, order in zip(task.slopes(), ORDERS):
            rows.append(design(task.x, task.y, degree, segments, *order) / np.radians(families.NOISE_DEG))
            sides.append(slope / np.radians(families.NOISE_DEG))
    E, b = np.vstack(rows), np.concatenate(sides)
    N = E.T @ E
    if smoothing:
        n = degree + segments
        D = np.diff(np.eye(n), 3, axis=0)
        N = N + smoothing * (np.kron(D.T @ D, np.eye(n)) + np.kron(np.eye(n), D.T @ D))
    c = np.linalg.lstsq(N, E.T @ b, rcond=1e-12)[0]
    return [design(task.tx, task.ty, degree, segments, *order) @ c for order in ORDERS]


def scipy_splines(task, setting):
    return solved(task, *setting, 0)


def scipy_penalised(task, setting):
    return solved(task, 4, 8, setting)


def scipy_rbf(task, setting):
    from scipy.interpolate import RBFInterpolator

    kernel, smoothing = setting
    fit = RBFInterpolator(np.column_stack([task.x, task.y]), task.z, kernel=kernel, smoothing=smoothing)
    return differences(lambda x, y: fit(np.column_stack([x, y])), task)


def scipy_fitpack(task, setting):
    from scipy.interpolate import RectBivariateSpline, SmoothBivariateSpline

    s = setting * families.NOISE_Z**2 * len(task.x)
    if task.image is None:
        fit = SmoothBivariateSpline(task.x, task.y, task.z, kx=5, ky=5, s=s, bbox=[-6, 6, -6, 6])
    else:
        at = np.linspace(-6, 6, len(task.image))
        fit = RectBivariateSpline(at, at, task.image, kx=5, ky=5, s=s)
    return [fit.ev(task.tx, task.ty, *order) for order in ORDERS]


def differences(at, task):
    z = lambda a, b: at(task.tx + a * H, task.ty + b * H)
    zx, zy, zxx, zyy = ((z(1, 0) - z(-1, 0)) / (2 * H), (z(0, 1) - z(0, -1)) / (2 * H), *(
        (z(a, b) - 2 * z(0, 0) + z(-a, -b)) / H**2 for a, b in ((1, 0), (0, 1))))
    return zx, zy, zxx, (z(1, 1) - z(1, -1) - z(-1, 1) + z(-1, -1)) / (4 * H * H), zyy


def mgcv(task, basis):
    """Tensor P-splines of order 3 with REML, a smoothness for each direction."""
    with tempfile.TemporaryDirectory() as folder:
        files = [os.path.join(folder, name) for name in ("contacts.csv", "targets.csv")]
        np.savetxt(files[0], np.column_stack([task.x, task.y, task.z]), delimiter=",", header="x,y,z", comments="")
        np.savetxt(files[1], np.column_stack([task.tx, task.ty]), delimiter=",", header="x,y", comments="")
        script = os.path.join(os.path.dirname(HERE), "tools", "mgcv.R")
        run = subprocess.run(["Rscript", script, *files, str(basis), "1"], check=True, capture_output=True, text=True)
    return np.array([[float(v) for v in line.split(",")] for line in run.stdout.splitlines() if line[0] != "T"]).T


def jets(task, setting):
    """A polynomial over the nearest contacts (CGAL's jets, at the point itself), of heights and, where there are normals, slopes."""
    from scipy.spatial import cKDTree

    degree, count = setting
    far, near = cKDTree(np.column_stack([task.x, task.y])).query(np.column_stack([task.tx, task.ty]), min(count, len(task.x)))
    size = far[:, -1:]
    u, v = (task.x[near] - task.tx[:, None]) / size, (task.y[near] - task.ty[:, None]) / size
    powers = [(i, d - i) for d in range(degree + 1) for i in range(d + 1)]
    term = lambda i, j, a, b: falling(i, a) * falling(j, b) * u ** max(i - a, 0) * v ** max(j - b, 0)
    rows, sides = [np.stack([term(i, j, 0, 0) for i, j in powers], -1) / families.NOISE_Z], [task.z[near] / families.NOISE_Z]
    if task.normals is not None:
        for slope, order in zip(task.slopes(), ORDERS):
            weight = 1 / np.radians(families.NOISE_DEG)
            rows.append(np.stack([term(i, j, *order) for i, j in powers], -1) / size[:, :, None] * weight)
            sides.append(slope[near] * weight)
    E, b = np.concatenate(rows, 1), np.concatenate(sides, 1)
    if E.shape[1] < len(powers):
        raise ValueError("fewer rows than terms")
    N = np.einsum("tri,trj->tij", E, E)
    N += 1e-10 * np.trace(N, axis1=1, axis2=2)[:, None, None] * np.eye(len(powers))
    c = np.linalg.solve(N, np.einsum("tri,tr->ti", E, b)[..., None])[..., 0]
    at = {p: c[:, k] for k, p in enumerate(powers)}
    h = size[:, 0]
    return at[1, 0] / h, at[0, 1] / h, 2 * at[2, 0] / h**2, at[1, 1] / h**2, 2 * at[0, 2] / h**2


def falling(i, a):
    return np.prod([i - k for k in range(a)]) if a else 1


def neighbours(task, count):
    """The shape operator by hand over the neighbours that Open3D (here a k-d tree) gives: k1, k2."""
    from scipy.spatial import cKDTree

    points = np.column_stack([task.x, task.y, task.z])
    _, near = cKDTree(points[:, :2]).query(np.column_stack([task.tx, task.ty]), min(count, len(points)))
    answers = []
    for these in near:
        n = task.normals[these].mean(axis=0)
        frame = np.linalg.svd(n[None, :])[2][1:].T
        dp, dn = ((of[these] - of[these].mean(axis=0)) @ frame for of in (points, task.normals))
        W = np.linalg.lstsq(dp, -dn, rcond=None)[0]
        answers.append(np.linalg.eigvalsh((W + W.T) / 2)[::-1])
    return np.array(answers).T


def at_points(task, images):
    """Values of images at the points that are asked, cubic between pixels."""
    from scipy.ndimage import map_coordinates

    side = len(task.image)
    places = np.stack([(task.tx + 6) / 12 * (side - 1), (task.ty + 6) / 12 * (side - 1)])
    return [map_coordinates(image, places, order=3, mode="nearest") for image in images]


def skimage(task, sigma):
    """`shape_index`, and curvedness by the same filters (k1, k2 of level ground)."""
    from skimage.feature import hessian_matrix, hessian_matrix_eigvals

    pixel = 12 / (len(task.image) - 1)
    H = hessian_matrix(task.image, sigma=sigma, mode="nearest", order="rc", use_gaussian_derivatives=False)
    return at_points(task, hessian_matrix_eigvals(H) / pixel**2)


def filters(task, sigma):
    """Derivatives of a gaussian filter (SciPy) in the textbook's formulas."""
    from scipy.ndimage import gaussian_filter

    pixel = 12 / (len(task.image) - 1)
    return at_points(task, [gaussian_filter(task.image, sigma, order, mode="reflect") / pixel ** sum(order) for order in ORDERS])


SPLINES = [(d, s) for d in (2, 3, 4, 5) for s in (1, 2, 3, 4, 6)]
PENALTIES = [10.0**k for k in range(-3, 6)]
RBFS = [(kernel, s) for kernel in ("thin_plate_spline", "quintic") for s in (1e-3, 1e-2, 0.1, 1, 10, 100, 1000)]
FITPACK = [0.8, 0.9, 1.0, 1.1, 1.25, 1.5, 2.0, 4.0]
JETS = {27: (12, 16, 20, 27), 64: (12, 16, 24, 32, 48, 64), 800: (24, 48, 96, 192, 300, 450, 800), 4096: (96, 192, 384, 768, 1500, 3000)}
WIDTHS = (1, 2, 3, 4, 6, 8, 12, 16)


def fitters(kind, count):
    """Name, function and settings of all that serve this kind of input."""
    tools = [("SciPy BSpline", scipy_splines, SPLINES), ("SciPy P-spline", scipy_penalised, PENALTIES)]
    tools += [("jets", jets, [(d, k) for d in (2, 3, 4) for k in JETS[count]]), ("SciPy FITPACK", scipy_fitpack, FITPACK)]
    tools += [("mgcv", mgcv, [5] if count < 64 else [6, 8] if count < 800 else [8, 12])]
    if kind == "normals":
        tools += [("neighbours", neighbours, JETS[count])]
    if kind != "pixels":
        tools += [("SciPy RBF", scipy_rbf, RBFS)]
    else:
        tools += [("scikit-image", skimage, WIDTHS), ("SciPy filters", filters, WIDTHS)]
    return tools
