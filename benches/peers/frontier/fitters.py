"""What a user of Python would run: every function takes contacts and points, and returns S and R there.

    contacts (x, y, z, normals)  ->  fit  ->  derivatives at the points  ->  S, R

Slopes are (-nx/nz, -ny/nz). FITPACK and the image know heights alone. Each fitter is told the noise where it can use it, which
palpate is not.
"""

import numpy as np
import scipy.sparse as sp
from scipy.interpolate import BSpline, LSQBivariateSpline, NdBSpline, SmoothBivariateSpline, griddata
from scipy.sparse.linalg import lsqr, spsolve
from scipy.spatial import cKDTree

ORDERS = ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
# pixels of the image along each side: finer ones show nothing more of some dozens of contacts
PIXELS = 48


def shape(zx, zy, zxx, zxy, zyy):
    """S and R of a height field from its derivatives; cap +1, cup -1."""
    w2 = 1 + zx**2 + zy**2
    mean = ((1 + zy**2) * zxx - 2 * zx * zy * zxy + (1 + zx**2) * zyy) / (2 * w2**1.5)
    gauss = (zxx * zyy - zxy**2) / w2**2
    return from_principal(mean, np.sqrt(np.maximum(mean**2 - gauss, 0)))


def from_principal(mean, half):
    """S and R of k1, k2 = mean +- half, positive where the surface is hollow."""
    return -2 / np.pi * np.arctan2(mean, half), np.sqrt(mean**2 + half**2)


def slopes(contacts):
    n = contacts.normals
    return -n[:, 0] / n[:, 2], -n[:, 1] / n[:, 2]


def shape_of_fitpack(fit, degree, px, py):
    """FITPACK's own derivatives stop one below the degree, so that parabolas need another evaluation."""
    if degree > 2:
        return shape(*(fit.ev(px, py, dx=i, dy=j) for i, j in ORDERS))
    tx, ty = fit.get_knots()
    spline = NdBSpline((tx, ty), fit.get_coeffs().reshape(len(tx) - degree - 1, -1), degree)
    at = np.column_stack([px, py])
    return shape(*(spline(at, nu=order) for order in ORDERS))


def fitpack_fixed(degree, segments):
    """`LSQBivariateSpline`: heights, knots given."""

    def run(c, px, py):
        inner = lambda v: np.linspace(v.min(), v.max(), segments + 1)[1:-1]
        fit = LSQBivariateSpline(c.x, c.y, c.z, inner(c.x), inner(c.y), kx=degree, ky=degree)
        return shape_of_fitpack(fit, degree, px, py)

    return run


def fitpack_smooth(degree):
    """`SmoothBivariateSpline`: heights, knots found; its smoothing is set by the noise, as FITPACK's manual says."""

    def run(c, px, py):
        fit = SmoothBivariateSpline(c.x, c.y, c.z, w=np.full(len(c.x), 1 / c.sigma_z), kx=degree, ky=degree, s=len(c.x))
        return shape_of_fitpack(fit, degree, px, py)

    return run


def knots(v, degree, segments):
    breaks = np.linspace(v.min(), v.max(), segments + 1)
    return np.concatenate([np.full(degree, breaks[0]), breaks, np.full(degree, breaks[-1])])


def bases(v, t, degree, most):
    """Design matrices of the derivatives 0 to `most`; ends of the domain take the last polynomial."""
    v = np.clip(v, t[0], t[-1])
    count = len(t) - degree - 1
    found = [BSpline.design_matrix(v, t, degree).tocsr()]
    for order in range(1, most + 1):
        coefficients = BSpline(t, np.eye(count), degree).derivative(order)
        found.append(sp.csr_matrix(coefficients(v)))
    return found


def products(a, b):
    """Row by row, every entry of a with every entry of b."""
    rows, n, m = a.shape[0], a.shape[1], b.shape[1]
    return sp.csr_matrix((a.toarray()[:, :, None] * b.toarray()[:, None, :]).reshape(rows, n * m))


def sparse_slopes(degree, segments, solve):
    """Heights and slopes by their noise as sparse rows, solved by LSQR or by the normal equations (`spsolve`)."""

    def run(c, px, py):
        tx, ty = knots(c.x, degree, segments), knots(c.y, degree, segments)
        (bx, dx), (by, dy) = bases(c.x, tx, degree, 1), bases(c.y, ty, degree, 1)
        zx, zy = slopes(c)
        wz, ws = 1 / c.sigma_z, 1 / c.sigma_slope
        E = sp.vstack([wz * products(bx, by), ws * products(dx, by), ws * products(bx, dy)], format="csr")
        b = np.concatenate([wz * c.z, ws * zx, ws * zy])
        if solve == "lsqr":
            found = lsqr(E, b, atol=1e-10, btol=1e-10)[0]
        else:
            found = spsolve((E.T @ E).tocsc(), E.T @ b)
        gx, gy = bases(px, tx, degree, 2), bases(py, ty, degree, 2)
        return shape(*(products(gx[i], gy[j]) @ found for i, j in ORDERS))

    return run


def image_hessian(sigma):
    """scikit-image's `shape_index` of an image that is interpolated from the contacts; it has no curvedness."""
    from skimage.feature import shape_index

    def run(c, px, py):
        gx, gy = (np.linspace(v.min(), v.max(), PIXELS) for v in (c.x, c.y))
        image = griddata((c.x, c.y), c.z, tuple(np.meshgrid(gx, gy, indexing="ij")), method="cubic")
        # the rim outside the contacts' hull takes the nearest height
        holes = np.isnan(image)
        if holes.any():
            at = np.argwhere(holes)
            image[holes] = griddata((c.x, c.y), c.z, (gx[at[:, 0]], gy[at[:, 1]]), method="nearest")
        # heights are in pixels, as lengths along the image are
        S = shape_index(image / (gx[1] - gx[0]), sigma=sigma, mode="nearest")
        pixel = lambda v, g: np.clip(np.rint((v - g[0]) / (g[1] - g[0])).astype(int), 0, PIXELS - 1)
        return S[pixel(px, gx), pixel(py, gy)], None

    return run


def quadric(neighbours, normals):
    """Local jets of order 2: at every point a quadric through its nearest contacts, with slopes if `normals`."""

    def run(c, px, py):
        near = cKDTree(np.column_stack([c.x, c.y])).query(np.column_stack([px, py]), k=neighbours)[1]
        x, y, z = c.x[near] - px[:, None], c.y[near] - py[:, None], c.z[near]
        one, none = np.ones_like(x), np.zeros_like(x)
        rows = [np.stack([one, x, y, x * x / 2, x * y, y * y / 2], 2) / c.sigma_z]
        right = [z / c.sigma_z]
        if normals:
            zx, zy = (s[near] for s in slopes(c))
            rows += [
                np.stack([none, one, none, x, y, none], 2) / c.sigma_slope,
                np.stack([none, none, one, none, x, y], 2) / c.sigma_slope,
            ]
            right += [zx / c.sigma_slope, zy / c.sigma_slope]
        A, b = np.concatenate(rows, 1), np.concatenate(right, 1)
        found = np.linalg.solve(A.transpose(0, 2, 1) @ A, (A.transpose(0, 2, 1) @ b[:, :, None]))[:, :, 0]
        return shape(*found.T[1:])

    return run


def fitters():
    """Program, label, method, degree, segments, and the function."""
    for degree, segments in ((2, 1), (3, 1), (4, 1), (3, 2)):
        yield "SciPy FITPACK, heights", f"degree {degree}, {segments}x{segments}", "LSQBivariateSpline", degree, segments, fitpack_fixed(
            degree, segments
        )
    for degree in (2, 3, 4):
        yield "SciPy FITPACK, heights", f"degree {degree}, smoothing by the noise", "SmoothBivariateSpline", degree, None, fitpack_smooth(
            degree
        )
    for solve in ("spsolve", "lsqr"):
        for degree, segments in ((2, 1), (3, 1), (4, 1), (3, 2)):
            yield "SciPy sparse, slopes", f"degree {degree}, {segments}x{segments}, {solve}", solve, degree, segments, sparse_slopes(
                degree, segments, solve
            )
    for sigma in (1, 2, 3, 4):
        yield "scikit-image shape_index", f"sigma {sigma} of {PIXELS} pixels", "shape_index", None, None, image_hessian(
            sigma
        )
    for normals in (False, True):
        for neighbours in (9, 15, 25, 45):
            what = "with slopes" if normals else "heights"
            yield f"local quadric, {what}", f"{neighbours} neighbours", "jet of order 2", 2, None, quadric(
                neighbours, normals
            )
