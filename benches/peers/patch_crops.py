"""Parts of the patches: the same truth on less of the surface, where the errors of a sensor are more of the relief.

A crop is the share of a patch's contacts nearest to one drawn at random. It is asked twice, as it lies and turned at
random, because a choice that depends on the axes shows where a patch leaves it open. "Depth" is the extent of the crop
across its best plane over the radius; a robust fit that is told the surface says what the crop allows at all.
"""
import dataclasses
import os
import tempfile

import numpy as np

import patch_data
import patch_peers
import patch_run
import patch_variants

SHARES = (0.6, 0.35)
# contacts of a crop at least
FEWEST = 30


def crops(patch, count):
    """Share and crop, `count` for each share, those of a patch always the same ones."""
    draw = np.random.default_rng(2026)
    for share in SHARES:
        keep = round(share * len(patch.points))
        for _ in range(count if keep >= FEWEST else 0):
            middle = patch.points[draw.integers(len(patch.points))]
            rows = np.argsort(np.linalg.norm(patch.points - middle, axis=1))[:keep]
            normals = None if patch.normals is None else patch.normals[rows]
            yield share, dataclasses.replace(patch, points=patch.points[rows], normals=normals, grid=None), draw


def ask(program, crop, Q, folder):
    """palpate's answer on a crop turned by Q about its centre."""
    path = os.path.join(folder, "crop.csv")
    points = (crop.points - crop.centre) @ Q.T + crop.centre
    patch_data.write_contacts(path, points, patch_variants.turned(crop.normals, Q))
    eye = crop.centre + patch_variants.FAR * crop.size * (Q @ crop.free_side)
    return patch_run.palpate(program, path, *patch_variants.viewpoint(crop.normals, eye))


def told(crop):
    try:
        return patch_peers.robust(crop).radius / crop.radius - 1
    except Exception:  # without SciPy, or where the fit fails, the column stays empty
        return None


def signed(value):
    return "-" if value is None else f"{100 * value:+.1f} %"


def table(program, patches, count, judge, out):
    """Prints a line a crop and the counts of each share; `judge` is what the main table counts by."""
    out("| patch | share | contacts | depth | truth | class | S | S held | error | told | R held | turned |")
    out("|---|---|---|---|---|---|---|---|---|---|---|---|")
    tally = {share: [] for share in SHARES}
    with tempfile.TemporaryDirectory() as folder:
        for patch in patches:
            for share, crop, draw in crops(patch, count):
                found = ask(program, crop, np.eye(3), folder)
                turned = ask(program, crop, patch_variants.rotation(draw), folder)
                broke = patch_variants.change(found, turned, 1.0, "turned")["broke"]
                judged = judge(crop, found) | {"turned": not broke}
                tally[share].append(judged)
                out(row(share, crop, found, judged, broke))
    out()
    return tally


def row(share, crop, found, judged, broke):
    axes = patch_data.frame(crop)
    depth = np.ptp((crop.points - crop.centre) @ axes[2]) / crop.radius
    yes = lambda key: "yes" if judged[key] else "no"
    error = found.radius / crop.radius - 1 if found.radius else None
    S = "-" if found.S is None else f"{found.S:.3f}"
    head = f"| {crop.name} | {share} | {len(crop.points)} | {depth:.2f} | {crop.kind} "
    return (
        f"{head}| {found.refused or found.kind} | {S} | {yes('S')} | {signed(error)} | {signed(told(crop))} "
        f"| {yes('R')} | {', '.join(broke) or 'same'} |"
    )
