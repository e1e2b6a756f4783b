"""What accuracy costs elsewhere: the points of other programs in palpate's frontier.

    python benches/peers/frontier.py [--palpate target/release/palpate] [--record benches/runs] [--beside target/peers.json]

    scene -> contacts of 32 seeds by `palpate simulate` -> S and R by every fitter, timed; the same answer judged by the truth
    scene -> `palpate frontier SCENE --keep-stations`   -> palpate's own points, of its own replicates of the scene

Records have the keys of `palpate.frontier/1`, flattened as in its frontier.csv. Times are from arrays in memory to S and R on
the grid, one thread; the median over the calls, with a bootstrap interval. Errors are root mean squares over the grid and
the seeds. Those of palpate's points that stand on its frontier are fitted once more to the very contacts that the others got,
so that nobody is judged by luckier contacts (column "same contacts"). `palpate frontier SCENE --beside target/peers.json` draws them.
"""

import argparse
import csv
import io
import json
import os
import platform
import subprocess
import sys
import tempfile
import time
from pathlib import Path

# before NumPy is loaded: one thread for everyone
os.environ.update({name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")})
HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE / "frontier"), str(HERE / "tools")]

import numpy as np
import scipy
import skimage

import fitters
import frontier_page
import torus

ROOT = HERE.parent.parent
SEEDS = 32
# calls in a row on each seed's contacts: the first meets cold caches, the least is kept
IN_A_ROW = 3
GRID, INSET = 8, 0.1
NOISE = {"bar": (0.05, 3.0), "ring": (0.01, 0.5)}


class Contacts:
    """Contacts of one seed, and the points of the grid over their bounding box less its inset."""

    def __init__(self, text, name):
        table = np.genfromtxt(io.StringIO(text), delimiter=",", names=True)
        self.x, self.y, self.z = (np.ascontiguousarray(table[k]) for k in "xyz")
        self.normals = np.column_stack([table[k] for k in ("nx", "ny", "nz")])
        self.sigma_z, degrees = NOISE[name]
        self.sigma_slope = np.radians(degrees)
        side = lambda v: np.linspace(v.min() + INSET * np.ptp(v), v.max() - INSET * np.ptp(v), GRID)
        gx, gy = np.meshgrid(side(self.x), side(self.y), indexing="ij")
        self.px, self.py = gx.ravel(), gy.ravel()
        self.truth = true_shape(name, self.px, self.py)


def true_shape(name, x, y):
    """S and R of the scene's surface above x, y."""
    if name == "bar":
        return np.full_like(x, 0.5), np.full_like(x, 1 / (25.0 * np.sqrt(2)))
    return torus.truth(x, y)


def call(program, *arguments, text=None):
    run = subprocess.run([program, *map(str, arguments)], input=text, capture_output=True, text=True)
    if run.returncode:
        raise RuntimeError(f"palpate {' '.join(map(str, arguments))}: {run.stderr.strip()}")
    return run.stdout


def draws(program, scene, folder):
    """The scene touched with 32 seeds of its own; each file stays for palpate."""
    source = scene.read_text()
    found = []
    for seed in range(1, SEEDS + 1):
        text = call(
            program, "simulate", "-", "-o", "-", text=source.replace("seed = 1000001", f"seed = {2000000 + seed}")
        )
        (folder / f"{scene.stem}-{seed}.csv").write_text(text)
        found.append(Contacts(text, scene.stem))
    return found


def check_truth(program, scene):
    """The closed forms here and the truth that palpate knows are the same."""
    document = json.loads(call(program, "run", scene, "--json"))
    low, high = ([float(k[e]) for k in document["surface"]["knots"]] for e in (0, -1))
    sides = [np.linspace(a + INSET * (b - a), b - INSET * (b - a), GRID) for a, b in zip(low, high)]
    S, R = true_shape(scene.stem, *(v.ravel() for v in np.meshgrid(*sides, indexing="ij")))
    if document["shape"]["support"] == 1 and not np.allclose(
        [S.mean(), R.mean()], [document["truth"]["S"], document["truth"]["R"]], rtol=1e-3
    ):
        sys.exit(
            f"{scene.name}: true S, R are {S.mean()}, {R.mean()} here, {document['truth']['S']}, {document['truth']['R']} by palpate"
        )


def bootstrap(values, of, draw):
    """Interval of 95 % of a statistic, by drawing the values again."""
    again = [of(draw.choice(values, len(values))) for _ in range(200)]
    return np.quantile(again, [0.025, 0.975]).tolist()


def rms(squares):
    return float(np.sqrt(np.mean(squares)))


def measured(run, touched):
    """Errors squared, seed by seed, and seconds of every call; or why there is no answer."""
    squares, seconds = [], []
    for c in touched:
        times = []
        for _ in range(IN_A_ROW):
            start = time.perf_counter()
            S, R = run(c, c.px, c.py)
            times.append(time.perf_counter() - start)
        seconds.append(min(times))
        true_s, true_r = c.truth
        squares.append([np.mean((S - true_s) ** 2), np.nan if R is None else np.mean((R - true_r) ** 2)])
    return np.array(squares), np.array(seconds)


def record(scene, touched, program, label, method, degree, segments, run):
    """One point, with the keys of `palpate.frontier/1`."""
    point = {
        "frontier": "discretisation",
        "case": scene,
        "program": program,
        "label": label,
        "method": method,
        "surface": "height",
        "degree.0": degree,
        "degree.1": degree,
        "segments.0": segments,
        "segments.1": segments,
        "contacts": len(touched[0].x),
        "replicates": len(touched),
        "failed": None,
    }
    try:
        squares, seconds = measured(run, touched)
        if not np.isfinite(squares[:, 0]).all():
            raise ValueError("S is not a number somewhere on the grid")
    except Exception as fault:
        return {**point, "failed": f"{type(fault).__name__}: {fault}"}
    draw = np.random.default_rng(1)
    point["error_S"] = rms(squares[:, 0])
    point["seconds.median"] = float(np.median(seconds))
    point["seconds.lo"], point["seconds.hi"] = bootstrap(seconds, np.median, draw)
    if np.isfinite(squares[:, 1]).all():
        true_r = float(np.mean([c.truth[1].mean() for c in touched]))
        both = squares[:, 0] + squares[:, 1] / true_r**2
        point["error_R"], point["error"] = rms(squares[:, 1]), rms(both)
        point["error_interval.0"], point["error_interval.1"] = bootstrap(both, rms, draw)
    return point


def own_points(program, scene, seconds):
    """palpate's own frontier of the scene, flattened."""
    with tempfile.TemporaryDirectory() as folder:
        options = ["--keep-stations", "--seconds", seconds, "--out", folder, "--quiet"]
        call(program, "frontier", scene, *options)
        with open(Path(folder) / "frontier.csv") as table:
            points = list(csv.DictReader(table))
    return [p for p in points if p["on_frontier"] == "true" and not p.get("failed")]


def same_contacts(program, point, touched, folder):
    """The error of one of palpate's points on the contacts that the others got."""
    words = point["weights"].split()
    pair = lambda key: f"{point[key + '.0']},{point[key + '.1']}"
    options = ["--surface", point["surface"], "--degree", pair("degree"), "--segments", pair("segments")]
    options += [f"--{words[0]}", words[1]]
    options += ["--grid", f"{GRID}x{GRID}", "--inset", INSET, "--bare"]
    squares = []
    for seed, c in enumerate(touched, 1):
        call(program, "fit", folder / f"{point['case']}-{seed}.csv", *options, "--out", folder / "out", "--quiet")
        maps = np.genfromtxt(folder / "out" / "maps.csv", delimiter=",", names=True)
        known = ~np.isnan(maps["S"])
        true_s, true_r = true_shape(point["case"], maps["x"][known], maps["y"][known])
        squares.append(np.mean((maps["S"][known] - true_s) ** 2) + np.mean((maps["R"][known] / true_r - 1) ** 2))
    return rms(squares)


def of_scene(program, scene, seconds):
    check_truth(program, scene)
    with tempfile.TemporaryDirectory() as folder:
        touched = draws(program, scene, Path(folder))
        points = own_points(program, scene, seconds)
        for point in points:
            point["error_same_contacts"] = same_contacts(program, point, touched, Path(folder))
        for one in fitters.fitters():
            points.append(record(scene.stem, touched, *one))
            print(
                f"{scene.stem:6} {points[-1]['program']:26} {points[-1]['label']:34} {points[-1]['failed'] or ''}",
                file=sys.stderr,
                flush=True,
            )
    return points


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--palpate", default=str(ROOT / "target/release/palpate"))
    parser.add_argument("--seconds", type=float, default=30.0, help="for palpate's own frontier of each scene")
    parser.add_argument("--record", help="directory that takes peers-frontier.md and .csv")
    parser.add_argument("--beside", type=Path, help="file for `palpate frontier SCENE --beside`")
    options = parser.parse_args()
    points = [
        p
        for name in ("bar", "ring")
        for p in of_scene(options.palpate, HERE / "frontier" / f"{name}.toml", options.seconds)
    ]
    versions = {module.__name__: module.__version__ for module in (np, scipy, skimage)}
    facts = {"python": platform.python_version(), **versions, "load": f"{os.getloadavg()[0]:.2f}"}
    page = frontier_page.page(points, facts)
    print(page)
    if options.beside:
        frontier_page.beside(options.beside, points)
    if options.record:
        frontier_page.write(Path(options.record), points, page)


if __name__ == "__main__":
    main()
