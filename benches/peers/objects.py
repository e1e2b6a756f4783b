"""S and R at every point of a closed bumpy torus: palpate beside libigl's `principal_curvature`, one run, one machine.

    python benches/peers/objects.py PALPATE [--points 35000,1000000] [--record benches/runs/objects.md]

Needs numpy and libigl. Both get the same points. palpate gets their normals, which libigl does not take; libigl gets the true
triangles between them, which palpate does not take. Every program is a process of its own; processor seconds and memory are those
of the whole process, files read and written included.
"""
import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

RING, TUBE, BUMP, AROUND, ACROSS = 10.0, 4.0, 0.25, 6, 4
# sd of a point along the normal over the spacing, sd of a normal per tangent axis in degrees
NOISES = [(0.0, 0.0), (0.02, 1.0), (0.1, 4.0)]
# rings of neighbours of libigl; 5 is its default
RINGS = [3, 5, 8]
# places may lie this share of a cell off the lattice
JITTER = 0.25
SEED = 20


def torus(count, rng):
    """Points, unit normals, true k1 >= k2 (hollow positive), triangles."""
    n = int(round(np.sqrt(count * RING / TUBE)))
    m = int(round(count / n))
    i, j = (a.ravel() for a in np.meshgrid(np.arange(n), np.arange(m), indexing="ij"))
    u = 2 * np.pi * (i + JITTER * rng.uniform(-1, 1, i.size)) / n
    v = 2 * np.pi * (j + JITTER * rng.uniform(-1, 1, i.size)) / m
    p, q = AROUND, ACROSS
    cu, su, cv, sv = np.cos(u), np.sin(u), np.cos(v), np.sin(v)
    a, b, c, d = np.cos(p * u), np.sin(p * u), np.cos(q * v), np.sin(q * v)
    r, ru, rv = TUBE + BUMP * a * c, -BUMP * p * b * c, -BUMP * q * a * d
    ruu, ruv, rvv = -BUMP * p * p * a * c, BUMP * p * q * b * d, -BUMP * q * q * a * c
    # f: distance from the axis, g: height
    f, fu, fv = RING + r * cv, ru * cv, rv * cv - r * sv
    fuu, fuv, fvv = ruu * cv, ruv * cv - ru * sv, rvv * cv - 2 * rv * sv - r * cv
    g, gu, gv = r * sv, ru * sv, rv * sv + r * cv
    guu, guv, gvv = ruu * sv, ruv * sv + ru * cv, rvv * sv + 2 * rv * cv - r * sv
    along = lambda x, y, z: np.stack([x, y, z], axis=1)
    points = along(f * cu, f * su, g)
    du, dv = along(fu * cu - f * su, fu * su + f * cu, gu), along(fv * cu, fv * su, gv)
    duu = along(fuu * cu - 2 * fu * su - f * cu, fuu * su + 2 * fu * cu - f * su, guu)
    duv, dvv = along(fuv * cu - fv * su, fuv * su + fv * cu, guv), along(fvv * cu, fvv * su, gvv)
    normal = np.cross(du, dv)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    dot = lambda s, t: np.einsum("ij,ij->i", s, t)
    E, F, G = dot(du, du), dot(du, dv), dot(dv, dv)
    e, h, k = dot(duu, normal), dot(duv, normal), dot(dvv, normal)
    mean = (e * G - 2 * h * F + k * E) / (2 * (E * G - F * F))
    gap = np.sqrt(np.maximum(mean * mean - (e * k - h * h) / (E * G - F * F), 0))
    at = lambda s, t: (s % n) * m + t % m
    faces = np.concatenate([np.stack([at(i, j), at(i + 1, j), at(i + 1, j + 1)], 1), np.stack([at(i, j), at(i + 1, j + 1), at(i, j + 1)], 1)])
    return points, normal, np.stack([mean + gap, mean - gap], 1), faces


def shape(k1, k2):
    return -2 / np.pi * np.arctan2(k1 + k2, k1 - k2), np.sqrt((k1 * k1 + k2 * k2) / 2)


def libigl(source, target, rings):
    """In a process of its own."""
    import igl

    data = np.load(source)
    found = igl.principal_curvature(data["points"], data["faces"], rings, True)
    np.savez(target, k1=found[2], k2=found[3])


def run(command):
    """Processor seconds and peak memory in MB."""
    child = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, used = os.wait4(child.pid, 0)
    if status:
        sys.exit(f"{command} failed")
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 1024


def errors(found, truth, keep):
    s, r = shape(truth[:, 0], truth[:, 1])
    ds, dr = np.abs(found[0] - s)[keep], (np.abs(found[1] - r) / r)[keep]
    return [np.median(ds), np.quantile(ds, 0.95), np.median(dr), np.quantile(dr, 0.95)], ds, dr * r[keep]


def case(palpate, count, noise, folder, rings):
    rng = np.random.default_rng(SEED)
    points, normals, truth, faces = torus(count, rng)
    spacing = np.median(np.linalg.norm(points[faces[:, 0]] - points[faces[:, 1]], axis=1))
    points = points + (noise[0] * spacing * rng.standard_normal(len(points)))[:, None] * normals
    normals = normals + np.radians(noise[1]) * rng.standard_normal(normals.shape)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    cloud, mesh, answer = folder / "cloud.npz", folder / "mesh.npz", folder / "answer.npz"
    np.savez(cloud, **dict(zip(["x", "y", "z", "nx", "ny", "nz"], np.concatenate([points, normals], 1).T)))
    np.savez(mesh, points=points, faces=faces.astype(np.int64))
    label = f"{len(points):,} | {noise[0]:g}, {noise[1]:g}"
    used = run([palpate, "parts", str(cloud), "--points", str(answer), "--quiet"])
    got = np.load(answer)
    keep = np.isfinite(got["S"])
    figures, ds, dr = errors((got["S"], got["R"]), truth, keep)
    held = [np.mean(d <= 2 * got[u][keep]) for d, u in ((ds, "u_S"), (dr, "u_R"))]
    yield label, "palpate", figures, f"{held[0]:.3f}, {held[1]:.3f}", used, len(points) - keep.sum()
    for ring in rings:
        used = run([sys.executable, __file__, "--libigl", str(mesh), str(answer), str(ring)])
        got = np.load(answer)
        # libigl's signs follow the triangles' side, and hollow is negative there
        flip = -1 if np.median(got["k1"] + got["k2"]) * np.median(truth.sum(1)) < 0 else 1
        low, high = np.sort(flip * np.stack([got["k1"], got["k2"]]), axis=0)
        keep = np.isfinite(low + high)
        figures, _, _ = errors(shape(high, low), truth, keep)
        yield label, f"libigl, {ring} rings", figures, "-", used, len(points) - keep.sum()


def main():
    if sys.argv[1:2] == ["--libigl"]:
        return libigl(sys.argv[2], sys.argv[3], int(sys.argv[4]))
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("palpate")
    parser.add_argument("--points", default="35000,1000000")
    parser.add_argument("--rings", default=",".join(map(str, RINGS)))
    parser.add_argument("--record")
    args = parser.parse_args()
    head = "points | noise: spacings, degrees | program | S: median error | 95 % | R: median relative error | 95 % | S, R within 2 u | processor s | memory, MB | no answer"
    lines = [f"| {head} |", "|---" * 11 + "|"]
    print("\n".join(lines), flush=True)
    with tempfile.TemporaryDirectory() as folder:
        for count in map(int, args.points.split(",")):
            noises = NOISES if count < 200_000 else NOISES[1:2]
            rings = [int(r) for r in args.rings.split(",")] if count < 200_000 else [5]
            for noise in noises:
                for label, name, figures, held, used, none in case(args.palpate, count, noise, Path(folder), rings):
                    words = " | ".join(f"{x:.2g}" for x in figures)
                    lines.append(f"| {label} | {name} | {words} | {held} | {used[0]:.1f} | {used[1]:.0f} | {none} |")
                    print(lines[-1], flush=True)
    if args.record:
        about = __doc__.split("\n\n")[2].replace("\n", " ").replace("Needs numpy and libigl. ", "")
        text = f"# Shape at every point of a whole object\n\n`python benches/peers/objects.py PALPATE --points {args.points} --record benches/runs/objects.md`: a bumpy torus (radii {RING:g} and {TUBE:g}, bumps of {BUMP:g}). {about}\n\n"
        Path(args.record).write_text(text + "\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
