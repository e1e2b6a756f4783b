"""Patches with a truth, as patches.py reads them: contacts or height grids, one line of truth.jsonl each.

Signs are palpate's: curvatures are positive where the surface is hollow, S is +1 for a cap and -1 for a cup.
"""
import json
import math
import os
from dataclasses import dataclass, field

import numpy as np

CLASSES = ("cup", "trough", "rut", "saddle rut", "saddle", "saddle ridge", "ridge", "dome", "cap")


@dataclass
class Patch:
    """A file with its truth. `points` is n x 3; `normals` has unit rows or is None; `grid` keeps a grid's own arrays."""

    path: str
    truth: dict
    points: np.ndarray
    normals: np.ndarray | None = None
    grid: dict | None = field(default=None, repr=False)

    @property
    def name(self):
        return self.truth["file"]

    @property
    def told(self):
        """The surface that the robust fit is told."""
        return "sphere" if abs(self.truth["S"]) > 0.75 else "cylinder"

    @property
    def kind(self):
        return class_of(self.truth["S"])

    @property
    def radius(self):
        return float(self.truth["radius"])

    @property
    def curvedness(self):
        """R of the true surface: 1/r of a sphere, 1/(r sqrt 2) of a cylinder."""
        return 1 / self.radius if self.told == "sphere" else 1 / (self.radius * math.sqrt(2))

    @property
    def centre(self):
        return self.points.mean(axis=0)

    @property
    def size(self):
        return float(np.linalg.norm(self.points - self.centre, axis=1).max())

    @property
    def free_side(self):
        """The direction that is outside of the body on the whole: the mean normal, or +z as palpate takes it."""
        if self.normals is None:
            return np.array([0.0, 0.0, 1.0])
        mean = self.normals.mean(axis=0)
        return mean / max(np.linalg.norm(mean), 1e-300)


def class_of(S):
    """The nine bins centred at k/4; on an edge the class nearer 0."""
    if S is None:
        return "plane"
    k = math.ceil(4 * abs(S) - 0.5)
    return CLASSES[4 + int(math.copysign(k, S))]


def read_truth(folder):
    """Lines of truth.jsonl; a faulty one is an error that names its number."""
    path = os.path.join(folder, "truth.jsonl")
    truths = []
    with open(path) as lines:
        for number, line in enumerate(lines, 1):
            if not line.strip():
                continue
            try:
                truth = json.loads(line)
            except ValueError as fault:
                raise ValueError(f"{path}, line {number}: not JSON ({fault})") from None
            missing = [key for key in ("file", "radius", "S") if key not in truth]
            if missing:
                raise ValueError(f"{path}, line {number}: no key {', '.join(missing)}")
            if abs(truth["S"]) not in (0.5, 1):
                raise ValueError(f"{path}, line {number}: S is {truth['S']}; a sphere has 1 or -1, a cylinder 0.5 or -0.5")
            truths.append(truth)
    return truths


def read_patch(folder, truth):
    path = os.path.join(folder, truth["file"])
    if path.endswith(".npz"):
        return read_grid(path, truth)
    with open(path) as text:
        names = text.readline().strip().split(",")
    table = np.loadtxt(path, delimiter=",", skiprows=1, ndmin=2)
    column = {name: table[:, i] for i, name in enumerate(names)}
    points = np.column_stack([column[k] for k in "xyz"])
    normals = None
    if "nx" in column:
        normals = unit(np.column_stack([column[k] for k in ("nx", "ny", "nz")]))
    return Patch(path, truth, points, normals)


def read_grid(path, truth):
    with np.load(path) as arrays:
        grid = {name: arrays[name] for name in arrays.files}
    if grid["z"].ndim != 2:
        raise ValueError(f"{path}: z is not a grid, and contacts are read from CSV")
    z = grid["z"].astype(float)
    x, y = np.meshgrid(grid["x"], grid["y"], indexing="ij")
    known = np.isfinite(z)
    points = np.column_stack([x[known], y[known], z[known]])
    normals = None
    if "zx" in grid and "zy" in grid:
        slopes = np.column_stack([grid["zx"][known], grid["zy"][known]]).astype(float)
        measured = np.isfinite(slopes).all(axis=1)
        points, slopes = points[measured], slopes[measured]
        normals = unit(np.column_stack([-slopes, np.ones(len(slopes))]))
    return Patch(path, truth, points, normals, grid)


def write_contacts(path, points, normals=None):
    header = "x,y,z" if normals is None else "x,y,z,nx,ny,nz"
    table = points if normals is None else np.hstack([points, normals])
    np.savetxt(path, table, fmt="%.17g", delimiter=",", header=header, comments="")


def unit(rows):
    return rows / np.maximum(np.linalg.norm(rows, axis=1, keepdims=True), 1e-300)


def frame(patch):
    """Axes as rows, the last one along the free side where normals tell it and along the narrowest spread otherwise."""
    centred = patch.points - patch.centre
    axes = np.linalg.svd(centred[: 20000], full_matrices=False)[2]
    up = patch.free_side if patch.normals is not None else axes[2] * np.sign(axes[2] @ patch.free_side or 1.0)
    side = axes[0] - (axes[0] @ up) * up
    side /= np.linalg.norm(side)
    return np.vstack([side, np.cross(up, side), up])


def thinned(patch, most, seed=0):
    """Numbers of at most `most` contacts drawn at random."""
    if len(patch.points) <= most:
        return np.arange(len(patch.points))
    return np.sort(np.random.default_rng(seed).choice(len(patch.points), most, replace=False))
