"""What others answer on a patch: robust fits that are told the surface, and curvatures of tools that are told nothing.

Every function takes a Patch and returns an Answer. A tool that is told nothing answers with the median of its principal
curvatures over the inner contacts, where borders do not reach.
"""
import warnings
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np

import patch_data

# contacts that a tool works on; more would change medians by less than the noise does
ENOUGH = 2000
MESHED = 500
# neighbours of a local quadric as a share of the contacts: a few percent follow the noise of a depth camera, all of
# them the outline
SHARE = 0.2
# share of the contacts nearest to the middle over which medians are taken
INNER = 0.5
BLOCKS = 5
RESAMPLES = 60
# standard deviation of a gaussian over the median of its magnitude
MAD_TO_SD = 1 / NormalDist().inv_cdf(0.75)


@dataclass
class Answer:
    S: float | None
    radius: float | None
    interval: tuple | None = None
    word: str = ""


def of_curvatures(k1, k2, word=""):
    """Answer of principal curvatures that are positive where the surface is hollow."""
    good = np.isfinite(k1) & np.isfinite(k2)
    if not good.any():
        raise RuntimeError("no curvature was found")
    a, b = np.median(np.maximum(k1, k2)[good]), np.median(np.minimum(k1, k2)[good])
    S = float(-2 / np.pi * np.arctan2(a + b, a - b))
    R = np.hypot(a, b) / np.sqrt(2)
    divisor = {"cap": 1, "cup": 1, "ridge": np.sqrt(2), "rut": np.sqrt(2)}.get(patch_data.class_of(S))
    return Answer(S, float(1 / (R * divisor)) if divisor else None, word=word)


def inner(points):
    """Which points are nearer to the middle than the others."""
    far = np.linalg.norm(points - np.median(points, axis=0), axis=1)
    return far <= np.quantile(far, INNER)


# ---- told the surface


def robust(patch):
    """Least squares of soft_l1 distances from a sphere or a cylinder, whichever is true; 95 % by resampling blocks."""
    rows = patch_data.thinned(patch, 3 * ENOUGH)
    scale = patch.size
    points = (patch.points[rows] - patch.centre) / scale
    distance = sphere_distance if patch.told == "sphere" else cylinder_distance
    starts = sphere_starts(points) if patch.told == "sphere" else cylinder_starts(patch, points)
    best = min((descend(distance, points, start) for start in starts), key=lambda found: found[1])[0]
    draw = np.random.default_rng(0)
    blocks = blocks_of(points)
    radii = []
    for _ in range(RESAMPLES):
        chosen = np.concatenate([blocks[i] for i in draw.integers(len(blocks), size=len(blocks))])
        chosen = chosen if len(chosen) <= ENOUGH else draw.choice(chosen, ENOUGH, replace=False)
        radii.append(abs(descend(distance, points[chosen], best, rounds=1)[0][-1]))
    low, high = np.quantile(radii, [0.025, 0.975]) * scale
    return Answer(None, float(abs(best[-1]) * scale), (float(low), float(high)))


def descend(distance, points, start, rounds=3):
    """Parameters and cost; the scale of the loss is the median residual of the round before, made an sd."""
    from scipy.optimize import least_squares

    theta, width, cost = np.asarray(start, float), None, np.inf
    for _ in range(rounds):
        width = MAD_TO_SD * np.median(np.abs(distance(theta, points))) + 1e-9
        found = least_squares(distance, theta, args=(points,), loss="soft_l1", f_scale=width, max_nfev=60)
        theta = found.x
    cost = float(np.sum(np.abs(distance(theta, points))))
    return theta, cost


def sphere_distance(theta, points):
    return np.linalg.norm(points - theta[:3], axis=1) - theta[3]


def sphere_starts(points):
    """The algebraic sphere: |p|^2 = 2 c.p + (r^2 - c^2)."""
    rows = np.hstack([2 * points, np.ones((len(points), 1))])
    *c, rest = np.linalg.lstsq(rows, np.sum(points**2, axis=1), rcond=None)[0]
    c = np.array(c)
    return [np.append(c, np.sqrt(max(rest + c @ c, 1e-6)))]


def cylinder_distance(theta, points):
    """theta: direction of the axis by two angles, its foot by two lengths, the radius."""
    axis, first, second = axis_frame(theta)
    return np.hypot(points @ first - theta[2], points @ second - theta[3]) - theta[4]


def axis_frame(theta):
    ct, st, cp, sp = np.cos(theta[0]), np.sin(theta[0]), np.cos(theta[1]), np.sin(theta[1])
    return np.array([st * cp, st * sp, ct]), np.array([ct * cp, ct * sp, -st]), np.array([-sp, cp, 0.0])


def cylinder_starts(patch, points):
    """Axes along the principal directions, and across the normals where there are any."""
    axes = list(np.linalg.svd(points, full_matrices=False)[2])
    if patch.normals is not None:
        axes.append(np.linalg.svd(patch.normals[patch_data.thinned(patch, ENOUGH)])[2][2])
    starts = []
    for axis in axes:
        theta = [np.arccos(np.clip(axis[2], -1, 1)), np.arctan2(axis[1], axis[0])]
        _, first, second = axis_frame(theta)
        flat = np.column_stack([points @ first, points @ second])
        rows = np.hstack([2 * flat, np.ones((len(flat), 1))])
        a, b, rest = np.linalg.lstsq(rows, np.sum(flat**2, axis=1), rcond=None)[0]
        starts.append(theta + [a, b, np.sqrt(max(rest + a * a + b * b, 1e-6))])
    return starts


def blocks_of(points):
    """Numbers of the points in each occupied block of the plane of largest spread."""
    flat = points @ np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[2][:2].T
    cell = (BLOCKS * (flat - flat.min(axis=0)) / (np.ptp(flat, axis=0) * (1 + 1e-9))).astype(int)
    key = cell[:, 0] * BLOCKS + cell[:, 1]
    return [np.flatnonzero(key == k) for k in np.unique(key)]


# ---- told nothing


def local_quadrics(patch):
    """z = a + b x + c y + (d x^2 + 2 e x y + f y^2)/2 through the neighbours of a contact, in their principal axes."""
    from scipy.spatial import cKDTree

    points = patch.points[patch_data.thinned(patch, ENOUGH)]
    count = min(len(points), max(12, round(SHARE * len(points))))
    tree = cKDTree(points)
    centres = points[inner(points)]
    centres = centres[:: max(1, len(centres) // 200)]
    shapes = []
    for centre in centres:
        near = points[tree.query(centre, count)[1]] - centre
        axes = np.linalg.svd(near - near.mean(axis=0), full_matrices=False)[2]
        axes[2] *= np.sign(axes[2] @ patch.free_side) or 1.0
        x, y, z = (near @ axes.T).T
        rows = np.column_stack([np.ones_like(x), x, y, x * x / 2, x * y, y * y / 2])
        _, zx, zy, zxx, zxy, zyy = np.linalg.lstsq(rows, z, rcond=None)[0]
        shapes.append(principal(zx, zy, zxx, zxy, zyy))
    return of_curvatures(*np.array(shapes).T, f"{count} neighbours")


def principal(zx, zy, zxx, zxy, zyy):
    w2 = 1 + zx**2 + zy**2
    mean = ((1 + zy**2) * zxx - 2 * zx * zy * zxy + (1 + zx**2) * zyy) / (2 * w2**1.5)
    half = np.sqrt(np.maximum(mean**2 - (zxx * zyy - zxy**2) / w2**2, 0))
    return mean + half, mean - half


def spline_field(patch):
    """FITPACK's smoothing spline over the plane across the free side, its noise from differences of neighbours."""
    from scipy.interpolate import SmoothBivariateSpline
    from scipy.spatial import cKDTree

    axes = patch_data.frame(patch)
    points = (patch.points[patch_data.thinned(patch, ENOUGH)] - patch.centre) @ axes.T / patch.size
    x, y, z = points.T
    near = points[cKDTree(points[:, :2]).query(points[:, :2], min(9, len(points)))[1]]
    noise = MAD_TO_SD * np.median(np.abs(near[:, 0, 2] - near[:, 1:, 2].mean(axis=1))) + 1e-9
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        fit = SmoothBivariateSpline(x, y, z, w=np.full(len(x), 1 / noise))
    here = inner(points)
    at = lambda dx, dy: fit.ev(x[here], y[here], dx=dx, dy=dy)
    k1, k2 = principal(at(1, 0), at(0, 1), at(2, 0), at(1, 1), at(0, 2))
    return of_curvatures(k1 / patch.size, k2 / patch.size, f"{len(fit.get_coeffs())} coefficients")


def mesh(patch):
    """Delaunay triangles over the plane across the free side, without the long ones; faces turn towards the free side."""
    from scipy.spatial import Delaunay

    axes = patch_data.frame(patch)
    points = (patch.points[patch_data.thinned(patch, MESHED)] - patch.centre) @ axes.T / patch.size
    _, first = np.unique(points[:, :2], axis=0, return_index=True)
    points = points[np.sort(first)]
    faces = Delaunay(points[:, :2]).simplices
    a, b, c = (points[faces[:, i], :2] for i in range(3))
    turned = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0] < 0
    faces[turned] = faces[turned][:, ::-1]
    edges = np.linalg.norm(points[faces] - points[np.roll(faces, 1, axis=1)], axis=2).max(axis=1)
    faces = faces[edges < 4 * np.median(edges)]
    used, faces = np.unique(faces, return_inverse=True)
    return points[used], faces.reshape(-1, 3).astype(np.int64)


def libigl(patch):
    """Quadrics over five rings of a mesh (Panozzo and others 2010)."""
    import igl

    points, faces = mesh(patch)
    found = igl.principal_curvature(np.ascontiguousarray(points), np.ascontiguousarray(faces))
    here = inner(points)
    # libigl counts a hollow as negative where faces turn towards the free side
    return of_curvatures(-found[2][here] / patch.size, -found[3][here] / patch.size, f"mesh of {len(points)}")


def trimesh_measures(patch):
    """Mean and Gaussian curvature measures over balls (Cohen-Steiner and Morvan 2003), away from the mesh's border."""
    import trimesh

    points, faces = mesh(patch)
    body = trimesh.Trimesh(points, faces, process=False)
    edges = np.sort(body.edges, axis=1)
    pairs, counts = np.unique(edges, axis=0, return_counts=True)
    border = points[np.unique(pairs[counts == 1])]
    far = np.linalg.norm(points[:, None] - border[None], axis=2).min(axis=1)
    radius = 0.5 * far.max()
    here = far > 1.05 * radius
    area = np.pi * radius**2
    mean = trimesh.curvature.discrete_mean_curvature_measure(body, points[here], radius) / area
    gauss = trimesh.curvature.discrete_gaussian_curvature_measure(body, points[here], radius) / area
    half = np.sqrt(np.maximum(mean**2 - gauss, 0))
    return of_curvatures((half - mean) / patch.size, (-half - mean) / patch.size, f"mesh of {len(points)}")


PEERS = {
    "robust fit": (robust, ("scipy",)),
    "local quadrics": (local_quadrics, ("scipy",)),
    "SciPy spline": (spline_field, ("scipy",)),
    "libigl": (libigl, ("igl", "scipy")),
    "trimesh": (trimesh_measures, ("trimesh", "scipy")),
}
