"""Other tools and palpate on the same contacts: error of S, error of R, time. COMPARE.md shows the table and the code.

    python benches/peers/tools/compare.py [--palpate target/release/palpate] [--seeds 5] [--record benches/runs]

Every tool gets the torus patch of torus.py and answers S and R. "Same spline" is degree 3
with the same uniform knots for everyone. Where a tool wants a neighbourhood or a width (and for palpate's "best spline"),
several are tried and the one nearest to the truth is shown, which nobody could do who does not know the truth. Errors are root mean squares over points and seeds; R's is relative. Times
are the least of the seeds' and repetitions', from arrays in memory to S and R, in one process without its start; two
threads at most. A tool that cannot be started is named and left out.
"""
import argparse
import csv
import datetime
import json
import os
import platform
import subprocess
import sys
import tempfile
import time

import numpy as np

import torus

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
DEGREE = 3
SEGMENTS = {64: 2, 1024: 4, 10000: 4}
NEIGHBOURS = (12, 24, 48, 96, 192, 384, 768)
SPLINES = ((2, 1), (3, 1), (4, 1), (2, 2), (3, 2), (4, 2), (3, 4))
WIDTHS = (1, 2, 4, 8, 16)
REPETITIONS = 3


class Task:
    """One draw of contacts, in arrays and in files for the tools that read them."""

    def __init__(self, count, seed, folder, palpate):
        self.count, self.seed, self.folder, self.palpate = count, seed, folder, palpate
        self.x, self.y, self.z, self.normals = torus.contacts(count, seed)
        self.tx, self.ty = torus.targets()
        self.knots = np.linspace(-torus.HALF, torus.HALF, SEGMENTS[count] + 1)
        self.contacts = self.write("contacts.csv", "x,y,z,nx,ny,nz", self.x, self.y, self.z, *self.normals.T)
        self.heights = self.write("heights.csv", "x,y,z", self.x, self.y, self.z)
        self.targets = self.write("targets.csv", "x,y,z", self.tx, self.ty, torus.derivatives(self.tx, self.ty)[0])

    def write(self, name, header, *columns):
        path = os.path.join(self.folder, name)
        np.savetxt(path, np.column_stack(columns), fmt="%.17g", delimiter=",", header=header, comments="")
        return path

    def errors(self, S, R, x=None, y=None):
        """Sums of squared errors and their number, against the truth at the points that were answered."""
        true_s, true_r = torus.truth(self.tx if x is None else x, self.ty if y is None else y)
        return float(np.mean((S - true_s) ** 2)), float(np.mean((R / true_r - 1) ** 2)) if R is not None else None


def clocked(work, task):
    """The answer and the least of a few times."""
    seconds, answer = [], None
    for _ in range(REPETITIONS):
        start = time.perf_counter()
        answer = work(task)
        seconds.append(time.perf_counter() - start)
    return answer, min(seconds)


def printed(command):
    """Lines of a program that prints its own times as T lines."""
    run = subprocess.run(command, capture_output=True, text=True)
    if run.returncode:
        raise RuntimeError(run.stderr.strip().splitlines()[-1])
    lines = run.stdout.splitlines()
    times = [float(line.split()[1]) for line in lines if line.startswith("T ")]
    return np.array([[float(v) for v in line.split(",")] for line in lines if not line.startswith("T ")]), min(times)


def palpate(task, source, *options):
    """palpate's own clock counts the fit and S and R alone, as the others give them; the maps are read back from its table."""
    # a folder takes results of one kind of input
    out = os.path.join(task.folder, "out of " + os.path.basename(source))
    grid = ["--grid", f"{torus.GRID}x{torus.GRID}", "--inset", str(torus.INSET)]
    seconds = []
    for _ in range(REPETITIONS):
        run = subprocess.run([task.palpate, "fit", source, *grid, *options, "--bare", "--json", "--out", out], capture_output=True, text=True)
        if run.returncode:
            raise RuntimeError(run.stderr.strip())
        clock = json.loads(run.stdout)["seconds"]
        seconds.append(clock["fit"] + clock["shape"])
    with open(os.path.join(out, "maps.csv")) as table:
        rows = list(csv.DictReader(table))
    # a point without S (or that the data do not support) counts as S = 0, R = 0: it is not left out
    column = lambda name: np.array([float(r[name] or 0) for r in rows])
    return task.errors(column("S"), column("R")), min(seconds)


def spline_options(task):
    half = torus.HALF
    return ["--degree", str(DEGREE), "--segments", str(SEGMENTS[task.count]), f"--domain={-half},{half},{-half},{half}"]


def palpate_normals(task):
    return palpate(task, task.contacts, *spline_options(task))


def palpate_heights(task):
    return palpate(task, task.heights, *spline_options(task))


def of_all_sizes(task, source):
    tries = []
    for degree, segments in SPLINES:
        options = ["--degree", str(degree), "--segments", str(segments), *spline_options(task)[4:]]
        tries.append((*palpate(task, source, *options), f"degree {degree}, {segments} segments"))
    return best(tries)


def palpate_normals_best(task):
    return of_all_sizes(task, task.contacts)


def palpate_heights_best(task):
    return of_all_sizes(task, task.heights)


def palpate_smooth(task):
    options = spline_options(task)
    options[3] = "5"
    return palpate(task, task.heights, *options, "--smooth", "auto")


def scipy_heights(task):
    from scipy.interpolate import LSQBivariateSpline

    def work(t):
        fit = LSQBivariateSpline(t.x, t.y, t.z, t.knots[1:-1], t.knots[1:-1], bbox=[-6, 6, -6, 6], kx=3, ky=3)
        at = lambda dx, dy: fit.ev(t.tx, t.ty, dx=dx, dy=dy)
        return torus.shape(at(1, 0), at(0, 1), at(2, 0), at(1, 1), at(0, 2))

    answer, seconds = clocked(work, task)
    return task.errors(*answer), seconds


def scipy_slopes(task):
    from scipy.interpolate import BSpline

    def rows(x, y, knots, dx, dy):
        """One row a point: products of the basis functions in x and in y, or of their derivatives."""
        identity = np.eye(len(knots) - DEGREE - 1)
        bx, by = BSpline(knots, identity, DEGREE)(x, dx), BSpline(knots, identity, DEGREE)(y, dy)
        return (bx[:, :, None] * by[:, None, :]).reshape(len(x), -1)

    def work(t):
        knots = np.concatenate([np.full(DEGREE, -torus.HALF), t.knots, np.full(DEGREE, torus.HALF)])
        zx, zy = -t.normals[:, 0] / t.normals[:, 2], -t.normals[:, 1] / t.normals[:, 2]
        wz, ws = 1 / torus.NOISE_Z, 1 / np.radians(torus.NOISE_DEG)
        E = np.vstack([wz * rows(t.x, t.y, knots, 0, 0), ws * rows(t.x, t.y, knots, 1, 0), ws * rows(t.x, t.y, knots, 0, 1)])
        c = np.linalg.solve(E.T @ E, E.T @ np.concatenate([wz * t.z, ws * zx, ws * zy]))
        at = lambda dx, dy: rows(t.tx, t.ty, knots, dx, dy) @ c
        return torus.shape(at(1, 0), at(0, 1), at(2, 0), at(1, 1), at(0, 2))

    answer, seconds = clocked(work, task)
    return task.errors(*answer), seconds


def mgcv(task):
    command = ["Rscript", os.path.join(HERE, "mgcv.R"), task.heights, task.targets, "8", "2"]
    answer, seconds = printed(command)
    return task.errors(*torus.shape(*answer.T)), seconds


def gismo(task):
    from pygismo import modelling, nurbs

    def work(t):
        inner = list(t.knots[1:-1])
        knots = nurbs.gsKnotVector(np.concatenate([[-6.0] * 4, inner, [6.0] * 4]), 3)
        basis = nurbs.gsTensorBSplineBasis2(knots, knots)
        fit = modelling.gsFitting(np.array([t.x, t.y]), t.z[None, :], basis)
        fit.compute(0.0)
        at = np.array([t.tx, t.ty])
        zx, zy = fit.result().deriv(at)
        zxx, zyy, zxy = fit.result().deriv2(at)
        return torus.shape(zx, zy, zxx, zxy, zyy)

    answer, seconds = clocked(work, task)
    return task.errors(*answer), seconds


def best(tries):
    """The try whose S is nearest to the truth, with what was tried."""
    found = [(errors, seconds, word) for errors, seconds, word in tries if np.isfinite(errors[0])]
    return min(found, key=lambda t: t[0][0])


def cgal(task):
    program = os.path.join(tempfile.gettempdir(), "palpate-jet")
    source = os.path.join(HERE, "jet.cpp")
    if not os.path.exists(program) or os.path.getmtime(program) < os.path.getmtime(source):
        flags = ["-O3", "-march=native", "-std=c++17", "-I/usr/include/eigen3", "-DCGAL_EIGEN3_ENABLED", "-frounding-math"]
        subprocess.run(["g++", *flags, source, "-o", program, "-lgmp", "-lmpfr"], check=True, capture_output=True)
    tries = []
    for k in (k for k in NEIGHBOURS if k <= task.count):
        answer, seconds = printed([program, task.contacts, task.targets, str(k), str(REPETITIONS)])
        x, y, k1, k2 = answer.T
        tries.append((task.errors(*torus.from_principal(k1, k2), x, y), seconds, f"{k} neighbours"))
    return best(tries)


def open3d(task):
    import open3d as o3d

    def work(t):
        cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(np.column_stack([t.x, t.y, t.z])))
        cloud.normals = o3d.utility.Vector3dVector(t.normals)
        tree = o3d.geometry.KDTreeFlann(cloud)
        points, normals = np.asarray(cloud.points), np.asarray(cloud.normals)
        answers = []
        for target in np.column_stack([t.tx, t.ty, torus.derivatives(t.tx, t.ty)[0]]):
            _, near, _ = tree.search_knn_vector_3d(target, t.k)
            n = normals[near].mean(axis=0)
            u, v = np.linalg.svd(n[None, :])[2][1:]
            frame = np.column_stack([u, v])
            dp = (points[near] - points[near].mean(axis=0)) @ frame
            dn = (normals[near] - n) @ frame
            W = np.linalg.lstsq(dp, -dn, rcond=None)[0]
            answers.append(np.linalg.eigvalsh((W + W.T) / 2)[::-1])
        return torus.from_principal(*np.array(answers).T)

    tries = []
    for k in (k for k in NEIGHBOURS if k <= task.count):
        task.k = k
        answer, seconds = clocked(work, task)
        tries.append((task.errors(*answer), seconds, f"{k} neighbours"))
    return best(tries)


def skimage(task):
    from skimage.feature import shape_index

    side = int(round(task.count**0.5))
    at, image = torus.pixels(side, task.seed)
    x, y = (v.ravel() for v in np.meshgrid(at, at, indexing="ij"))
    inner = np.maximum(abs(x), abs(y)) <= torus.HALF * (1 - 2 * torus.INSET) + 1e-9
    tries = []
    for sigma in WIDTHS:
        answer, seconds = clocked(lambda t: shape_index(image, sigma=sigma, mode="nearest"), task)
        S = answer.ravel()[inner]
        tries.append((task.errors(S, None, x[inner], y[inner]), seconds, f"sigma {sigma} pixels"))
    return best(tries)


def palpate_pixels(task):
    at, image = torus.pixels(int(round(task.count**0.5)), task.seed)
    source = os.path.join(task.folder, "image.npz")
    np.savez(source, x=at, y=at, z=image)
    return palpate(task, source, *spline_options(task))


TOOLS = {
    "heights and normals": {
        "palpate, same spline, noise unknown": palpate_normals,
        "palpate, best spline, noise unknown": palpate_normals_best,
        "SciPy `BSpline`, same spline, noise known": scipy_slopes,
        "Open3D's neighbours, shape operator by hand": open3d,
    },
    "heights alone": {
        "palpate, same spline": palpate_heights,
        "palpate, best spline": palpate_heights_best,
        "palpate, `--segments 5 --smooth auto`": palpate_smooth,
        "SciPy `LSQBivariateSpline`, same spline": scipy_heights,
        "mgcv `te`, P-splines of order 3, REML": mgcv,
        "G+Smo `gsFitting`, same spline": gismo,
        "CGAL `Monge_via_jet_fitting`": cgal,
    },
    "heights on pixels": {
        "palpate, same spline": palpate_pixels,
        "scikit-image `shape_index`": skimage,
    },
}


def measure(tool, count, options, folder):
    """Root mean square errors over the seeds, least seconds, and what was chosen with the truth in sight."""
    squares, times, words = [], [], []
    for seed in range(1, options.seeds + 1):
        errors, seconds, *word = tool(Task(count, seed, folder, options.palpate))
        squares.append(errors)
        times.append(seconds)
        words += word
    mean = lambda k: None if squares[0][k] is None else float(np.sqrt(np.mean([s[k] for s in squares])))
    return mean(0), mean(1), min(times), max(set(words), key=words.count) if words else ""


def spell(seconds):
    for unit, size in (("s", 1), ("ms", 1e-3), ("us", 1e-6)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds:.3g} s"


def about():
    versions = {"python": platform.python_version(), "numpy": np.__version__}
    for name in ("scipy", "skimage", "open3d", "pygismo"):
        try:
            module = __import__(name)
            versions[name] = str(getattr(module, "__version__", "")).strip()
        except Exception as fault:
            versions[name] = f"not here ({fault})"
    for name, command in {
        "mgcv": ["Rscript", "-e", 'cat(as.character(packageVersion("mgcv")))'],
        "cgal": ["sh", "-c", "sed -n 's/^#define CGAL_VERSION //p' /usr/include/CGAL/version.h"],
        "commit": ["git", "-C", ROOT, "rev-parse", "--short", "HEAD"],
    }.items():
        try:
            versions[name] = subprocess.run(command, capture_output=True, text=True).stdout.strip()
        except OSError as fault:
            versions[name] = f"not here ({fault})"
    with open("/proc/cpuinfo") as info:
        cpu = next((line.split(":")[1].strip() for line in info if line.startswith("model name")), "unknown")
    return {"date": datetime.date.today().isoformat(), "cpu": cpu, **versions, "load": f"{os.getloadavg()[0]:.2f}"}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--palpate", default=os.path.join(ROOT, "target/release/palpate"))
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--counts", default=",".join(map(str, SEGMENTS)))
    parser.add_argument("--only", help="a word in the tool's name")
    parser.add_argument("--record", help="directory that takes tools.md")
    options = parser.parse_args()
    lines = ["| input | tool | contacts | rms error of S | rms error of R | time | chosen knowing the truth |", "|---|---|---|---|---|---|---|"]
    print("\n".join(lines), flush=True)
    with tempfile.TemporaryDirectory() as folder:
        for task, tools in TOOLS.items():
            for name, tool in tools.items():
                for count in map(int, options.counts.split(",")):
                    if options.only and options.only.lower() not in name.lower():
                        continue
                    try:
                        s, r, seconds, word = measure(tool, count, options, folder)
                    except Exception as fault:
                        print(f"left out: {name}, {count}: {fault}", file=sys.stderr, flush=True)
                        continue
                    relative = "-" if r is None else f"{float(f'{100 * r:.2g}'):g} %"
                    lines.append(f"| {task} | {name} | {count} | {s:.3f} | {relative} | {spell(seconds)} | {word} |")
                    print(lines[-1], flush=True)
    if options.record:
        head = ["# Other tools beside palpate", "", "`python benches/peers/tools/compare.py --record benches/runs`", ""]
        facts = [f"{k}: {v}  " for k, v in about().items()] + [f"seeds: {options.seeds}  ", ""]
        with open(os.path.join(options.record, "tools.md"), "w") as out:
            out.write("\n".join(head + facts + lines) + "\n")


if __name__ == "__main__":
    main()
