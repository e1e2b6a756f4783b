"""palpate parts beside CGAL's Efficient RANSAC and pyRANSAC-3D, and its --points beside libigl and CGAL's jets: times and errors.

    pip install numpy libigl pyransac3d; apt install libcgal-dev
    python benches/peers/parts_times.py PALPATE [--contacts 5000,35000,1000000] [--record benches/runs/parts.md]

The cloud is a drum (radius 3, length 10, two ends) beside a ball of radius 2, with noise of a tenth of the spacing along every axis and
of 3 degrees in the normals. CGAL is told the noise; palpate is told nothing. For `--points` it is a ring, 3 and 1, touched on a lattice,
so that libigl has a mesh; the error is that of R, the median over the points in per cent of the truth.
Every program runs on one core in a process of its own, one after another. Seconds are the processor's; those of palpate and CGAL count
reading the file (text and raw numbers), those of pyRANSAC-3D and libigl do not. A peer that cannot be built or started is named and left out.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile
import time

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
RADII = {"cylinder": 3.0, "sphere": 2.0}
RING, TUBE = 3.0, 1.0
ALONE = {**os.environ, "RAYON_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "IGL_NUM_THREADS": "1"}
MARK = "<!-- times -->"


def bodies(count, random):
    """Points, normals and spacing of the drum and the ball."""
    area = 2 * np.pi * 3 * 10 + 2 * np.pi * 9 + 4 * np.pi * 4
    spacing = np.sqrt(area / count)
    share = lambda part: int(round(count * part / area))
    turn = random.uniform(0, 2 * np.pi, share(2 * np.pi * 30))
    side = np.stack([np.cos(turn), np.sin(turn), 0 * turn], 1)
    points, normals = [side * 3 + np.stack([0 * turn, 0 * turn, random.uniform(0, 10, len(turn))], 1)], [side]
    for z in (0.0, 10.0):
        turn, rho = random.uniform(0, 2 * np.pi, share(9 * np.pi)), 3 * np.sqrt(random.uniform(0, 1, share(9 * np.pi)))
        points.append(np.stack([rho * np.cos(turn), rho * np.sin(turn), z + 0 * turn], 1))
        normals.append(np.tile([0, 0, 1.0 if z else -1.0], (len(turn), 1)))
    ball = random.normal(size=(share(16 * np.pi), 3))
    ball /= np.linalg.norm(ball, axis=1)[:, None]
    points.append(2 * ball + [8, 0, 5])
    normals.append(ball)
    points, normals = np.concatenate(points), np.concatenate(normals)
    points = points + random.normal(size=points.shape) * 0.1 * spacing
    normals = normals + random.normal(size=normals.shape) * np.radians(3)
    return points, normals / np.linalg.norm(normals, axis=1)[:, None], spacing


def ring(count, random):
    """Points and triangles of the ring with noise, and the true R."""
    n = int(np.sqrt(count / 3))
    u, v = (a.ravel() for a in np.meshgrid(np.arange(3 * n) * 2 * np.pi / (3 * n), np.arange(n) * 2 * np.pi / n, indexing="ij"))
    normal = np.stack([np.cos(v) * np.cos(u), np.cos(v) * np.sin(u), np.sin(v)], 1)
    points = np.stack([(RING + TUBE * np.cos(v)) * np.cos(u), (RING + TUBE * np.cos(v)) * np.sin(u), TUBE * np.sin(v)], 1)
    points = points + normal * (random.normal(size=len(u)) * 0.1 * 2 * np.pi * RING / (3 * n))[:, None]
    k1, k2 = 1 / TUBE, np.cos(v) / (RING + TUBE * np.cos(v))
    i, j = (a.ravel() for a in np.meshgrid(np.arange(3 * n), np.arange(n), indexing="ij"))
    at = lambda a, b: (a % (3 * n)) * n + b % n
    faces = np.concatenate([np.stack([at(i, j), at(i + 1, j), at(i + 1, j + 1)], 1), np.stack([at(i, j), at(i + 1, j + 1), at(i, j + 1)], 1)])
    return points, faces, np.sqrt((k1**2 + k2**2) / 2)


def run(command, where):
    """Seconds of the processor, largest memory in MB and output of one process on one core."""
    with open(where, "w") as out:
        process = subprocess.Popen(["taskset", "-c", "0", *command], stdout=out, stderr=subprocess.DEVNULL, env=ALONE)
        _, status, usage = os.wait4(process.pid, 0)
    if status:
        raise OSError(f"{command[0]} ended with {status}")
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024, open(where).read()


def error_of(found):
    """Largest error of the two radii in per cent, and the number of parts; found: (kind, radius, points), the largest of a kind counts."""
    errors = []
    for kind, truth in RADII.items():
        own = [f for f in found if f[0] == kind]
        errors.append(100 * abs(max(own, key=lambda f: f[2])[1] / truth - 1) if own else float("inf"))
    return f"{max(errors):.3f}", len(found)


def whole(name, count, seconds, memory, found):
    error, parts = error_of(found)
    return f"{name:<22} {count:>9} {seconds:>9.2f} {memory:>9} {parts:>7} {error:>12}"


def cut(palpate, cgal, count, folder, random):
    points, normals, spacing = bodies(count, random)
    text, raw, out = (os.path.join(folder, name) for name in ("parts.csv", "parts.bin", "out"))
    table = np.concatenate([points, normals], 1)
    np.savetxt(text, table, delimiter=",", header="x,y,z,nx,ny,nz", comments="", fmt="%.9g")
    table.astype("<f8").tofile(raw)
    seconds, memory, answer = run([palpate, "parts", text, "--json"], out)
    found = [(p["kind"], p["parameters"].get("radius") or 0.0, p["points"]) for p in json.loads(answer)["parts"]]
    yield whole("palpate parts", count, seconds, f"{memory:.0f}", found)
    if cgal:
        seconds, memory, answer = run([cgal, "ransac", raw, str(0.1 * spacing), str(spacing)], out)
        lines = answer.split("\n")
        shapes = [(w[0], float(w[1]), int(w[2])) for w in (line.split() for line in lines[1:]) if w]
        yield whole("CGAL Efficient RANSAC", count, seconds, f"{memory:.0f}", shapes)
    if count <= 35000:
        yield from with_pyransac(points, spacing, count)


def with_pyransac(points, spacing, count):
    """One shape at a time, from the whole cloud: it cuts nothing."""
    try:
        import pyransac3d
    except ImportError as missing:
        return print(missing, file=sys.stderr)
    start, found = time.process_time(), []
    for kind, shape in (("cylinder", pyransac3d.Cylinder()), ("sphere", pyransac3d.Sphere())):
        *_, radius, inliers = shape.fit(points, thresh=0.3 * spacing, maxIteration=1000)
        found.append((kind, radius, len(inliers)))
    yield whole("pyRANSAC-3D", count, time.process_time() - start, "", found)


def shapes(palpate, cgal, count, folder, random):
    points, faces, truth = ring(count, random)
    text, raw, out, told = (os.path.join(folder, name) for name in ("ring.csv", "ring.bin", "out", "points.csv"))
    np.savetxt(text, points, delimiter=",", header="x,y,z", comments="", fmt="%.9g")
    np.concatenate([points, 0 * points], 1).astype("<f8").tofile(raw)
    off = lambda r: f"{100 * np.median(np.abs(r / truth - 1)):.2f}"
    row = lambda name, seconds, memory, r: f"{name:<22} {len(points):>9} {seconds:>9.2f} {memory:>9} {'':>7} {off(r):>12}"
    seconds, memory, _ = run([palpate, "parts", text, "--points", told], out)
    columns = open(told).readline().strip().split(",")
    yield row("palpate --points", seconds, f"{memory:.0f}", np.genfromtxt(told, delimiter=",", skip_header=1, usecols=columns.index("R")))
    if cgal:
        seconds, memory, answer = run([cgal, "jets", raw], out)
        k = np.array([float(word) for word in answer.split()[1:]]).reshape(-1, 2)
        yield row("CGAL jets, 25 points", seconds, f"{memory:.0f}", np.sqrt((k**2).sum(1) / 2))
    try:
        import igl
    except ImportError as missing:
        return print(missing, file=sys.stderr)
    start = time.process_time()
    found = igl.principal_curvature(points, faces.astype(np.int64))
    yield row("libigl", time.process_time() - start, "", np.sqrt((np.asarray(found[2])**2 + np.asarray(found[3])**2) / 2))


def built(folder):
    """CGAL's program, if it can be made."""
    target = os.path.join(folder, "cgal_shapes")
    command = ["g++", "-O3", "-DNDEBUG", "-march=native", "-I/usr/include/eigen3", "-DCGAL_EIGEN3_ENABLED", os.path.join(HERE, "cpp", "cgal_shapes.cpp"), "-o", target, "-lgmp", "-lmpfr"]
    made = subprocess.run(command, capture_output=True, text=True)
    if made.returncode:
        print("CGAL is left out:", made.stderr[-300:], file=sys.stderr)
    return None if made.returncode else target


def main():
    words = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    words.add_argument("palpate")
    words.add_argument("--contacts", default="5000,35000,1000000")
    words.add_argument("--record")
    asked = words.parse_args()
    random = np.random.default_rng(1)
    lines = [f"{'program':<22} {'contacts':>9} {'seconds':>9} {'MB':>9} {'parts':>7} {'error, %':>12}"]
    with tempfile.TemporaryDirectory() as folder:
        cgal = built(folder)
        for count in (int(word) for word in asked.contacts.split(",")):
            for rows in (cut(asked.palpate, cgal, count, folder, random), shapes(asked.palpate, cgal, count, folder, random)):
                for line in rows:
                    lines.append(line)
                    print(line, flush=True)
    if asked.record:
        before, _, rest = open(asked.record).read().partition(MARK)
        _, _, after = rest.partition(MARK)
        open(asked.record, "w").write(before + MARK + "\n```text\n" + "\n".join(lines) + "\n```\n" + MARK + after)


if __name__ == "__main__":
    main()
