"""The same patch turned, scaled, shuffled, thinned and without normals: the answer should not change.

| variant | what | limits |
|---|---|---|
| turned | turned at random about its centre, three times, with its normals; a grid becomes contacts | S 0.02, radius 1 % |
| scaled | all lengths times 1000 | S 0.02, radius 1 % |
| shuffled | the rows in another order | S 0.02, radius 1 % |
| thinned | 300 contacts drawn at random, where there are more | S 0.02, radius 3 % |
| contacts | a grid as contacts, nothing else changed | S 0.02, radius 1 % |
| no normals | positions alone, where the file has normals | S 0.02, radius 1 % |

Where a patch has no normals, its free side is told by `--viewpoint`, because it is lost with the axes otherwise.
"""
import os
import tempfile

import numpy as np

import patch_data
from patch_run import palpate

TURNS = 3
SCALE = 1000.0
THIN = 300
LIMIT_S, LIMIT_RADIUS, LIMIT_THINNED = 0.02, 0.01, 0.03
# distance of the viewpoint from the patch, in its sizes
FAR = 10.0


def variants(patch):
    """Name, points, normals, scale and the direction of the free side of every variant that the patch can have."""
    draw = np.random.default_rng(2026)
    points, normals, up = patch.points, patch.normals, patch.free_side
    for turn in range(1, TURNS + 1):
        Q = rotation(draw)
        yield f"turned {turn}", (points - patch.centre) @ Q.T + patch.centre, turned(normals, Q), 1.0, Q @ up
    yield "scaled", points * SCALE, normals, SCALE, up
    order = draw.permutation(len(points))
    yield "shuffled", points[order], chosen(normals, order), 1.0, up
    if len(points) > THIN:
        rows = patch_data.thinned(patch, THIN, seed=7)
        yield "thinned", points[rows], chosen(normals, rows), 1.0, up
    if patch.grid is not None:
        yield "contacts", points, normals, 1.0, up
    if normals is not None:
        yield "no normals", points, None, 1.0, up


def rotation(draw):
    """Uniform over all rotations: a random orthogonal matrix of determinant 1."""
    Q, upper = np.linalg.qr(draw.normal(size=(3, 3)))
    Q = Q * np.sign(np.diag(upper))
    return Q if np.linalg.det(Q) > 0 else -Q


def turned(normals, Q):
    return None if normals is None else normals @ Q.T


def chosen(normals, rows):
    return None if normals is None else normals[rows]


def compare(program, patch, base, folder):
    """Lines of the table: variant, whether the class is the same, |dS|, change of radius, what broke a limit."""
    for name, points, normals, scale, up in variants(patch):
        path = os.path.join(folder, "variant.npz" if name == "scaled" and patch.grid is not None else "variant.csv")
        if path.endswith(".npz"):
            write_scaled_grid(path, patch.grid)
        else:
            patch_data.write_contacts(path, points, normals)
        eye = points.mean(axis=0) + FAR * scale * patch.size * up
        options = viewpoint(normals, eye) if path.endswith(".csv") else []
        yield name, change(base, palpate(program, path, *options), scale, name)


def viewpoint(normals, eye):
    """The option that tells the free side of contacts without normals."""
    return [] if normals is not None else ["--viewpoint=" + ",".join(f"{v:.17g}" for v in eye)]


def write_scaled_grid(path, grid):
    """Slopes have no unit and stay; gaps are not numbers and stay too."""
    lengths = {k: np.asarray(grid[k], float) * SCALE for k in ("x", "y", "z")}
    np.savez(path, **{k: v for k, v in grid.items() if k not in lengths}, **lengths)


def change(base, now, scale, name):
    """What changed, with the limits that it broke; radii are compared where both are given, else curvedness."""
    if base.refused or now.refused:
        word = now.refused or base.refused
        return {"same": None, "dS": None, "radius": None, "broke": [f"refused: {word}"]}
    limit = LIMIT_THINNED if name == "thinned" else LIMIT_RADIUS
    dS = abs(now.S - base.S) if now.S is not None and base.S is not None else None
    radius = None
    if now.radius and base.radius:
        radius = now.radius / scale / base.radius - 1
    elif now.R and base.R:
        radius = base.R / (now.R * scale) - 1
    broke = []
    if now.kind != base.kind:
        broke.append(f"{base.kind} became {now.kind}")
    if dS is None or dS > LIMIT_S:
        broke.append("S")
    if radius is None or abs(radius) > limit:
        broke.append("radius")
    return {"same": now.kind == base.kind, "dS": dS, "radius": radius, "broke": broke}


def table(program, patches, bases, out):
    """Prints a line a variant and the counts within the limits; returns the lines."""
    out("| patch | variant | class same | change of S | change of radius | outside of the limits |")
    out("|---|---|---|---|---|---|")
    kept, count = {}, {}
    with tempfile.TemporaryDirectory() as folder:
        for patch in patches:
            for name, found in compare(program, patch, bases[patch.name], folder):
                kind = name.split(" ")[0] if name.startswith("turned") else name
                count[kind] = count.get(kind, 0) + 1
                kept[kind] = kept.get(kind, 0) + (not found["broke"])
                same = {True: "yes", False: "no", None: "-"}[found["same"]]
                dS = "-" if found["dS"] is None else f"{found['dS']:.4f}"
                radius = "-" if found["radius"] is None else f"{100 * found['radius']:+.2f} %"
                out(f"| {patch.name} | {name} | {same} | {dS} | {radius} | {', '.join(found['broke'])} |")
    out("")
    for kind, number in count.items():
        out(f"- {kind}: {kept[kind]} of {number} within the limits")
