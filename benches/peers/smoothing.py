"""`palpate fit --smooth auto` beside mgcv's REML on random surfaces: root mean square errors of the height, S and R at 15 x 15 points.

    python benches/peers/smoothing.py [--palpate target/release/palpate] [--problems 100] [--seed 1] [--degree 4] [--mgcv-degree 4]

A surface is a quadric, up to three bumps and up to two waves; 64 to 1,500 contacts lie anywhere on [-5, 5]^2, with noise of 0.3 to 5 % of
the relief. Both fit splines of this degree with BASIS functions a direction (tools/mgcv.R), so that they have the same surfaces to choose
from; mgcv may be given another degree than palpate. Nothing is chosen knowing the truth. The ratio is palpate's error over mgcv's.
"""
import argparse
import csv
import os
import subprocess
import tempfile

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
BASIS, HALF, GRID = 8, 5.0, 15


def surface(rng):
    """Height as a function of x and y."""
    a, b, c = rng.normal(0, 0.03, 3)
    bumps = [(*rng.uniform(-4, 4, 2), rng.normal(0, 1), rng.uniform(1.5, 4)) for _ in range(rng.integers(0, 4))]
    waves = [(*rng.normal(0, 0.5, 2), rng.uniform(0, 6), rng.normal(0, 0.5)) for _ in range(rng.integers(0, 3))]

    def at(x, y):
        z = a * x**2 + b * x * y + c * y**2
        for p, q, height, width in bumps:
            z = z + height * np.exp(-((x - p) ** 2 + (y - q) ** 2) / (2 * width**2))
        for p, q, phase, height in waves:
            z = z + height * np.sin(p * x + q * y + phase)
        return z

    return at


def shape(zx, zy, zxx, zxy, zyy):
    w2 = 1 + zx**2 + zy**2
    mean = -((1 + zy**2) * zxx - 2 * zx * zy * zxy + (1 + zx**2) * zyy) / (2 * w2**1.5)
    half = np.sqrt(np.maximum(mean**2 - (zxx * zyy - zxy**2) / w2**2, 0))
    k1, k2 = mean + half, mean - half
    return 2 / np.pi * np.arctan2(k1 + k2, k1 - k2), np.sqrt((k1**2 + k2**2) / 2)


def by_differences(at, x, y, h=1e-3):
    zx, zy = (at(x + h, y) - at(x - h, y)) / (2 * h), (at(x, y + h) - at(x, y - h)) / (2 * h)
    zxx, zyy = (at(x + h, y) - 2 * at(x, y) + at(x - h, y)) / h**2, (at(x, y + h) - 2 * at(x, y) + at(x, y - h)) / h**2
    zxy = (at(x + h, y + h) - at(x + h, y - h) - at(x - h, y + h) + at(x - h, y - h)) / (4 * h * h)
    return shape(zx, zy, zxx, zxy, zyy)


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


def palpate(program, folder, degree):
    out = os.path.join(folder, "out")
    line = [program, "fit", os.path.join(folder, "contacts.csv"), "--degree", str(degree), "--segments", str(BASIS - degree), "--smooth", "auto"]
    line += [f"--domain=-{HALF},{HALF},-{HALF},{HALF}", "--grid", f"{GRID}x{GRID}", "--inset", "0.1", "--quiet", "--out", out]
    subprocess.run(line, check=True, capture_output=True)
    with open(os.path.join(out, "maps.csv")) as table:
        rows = list(csv.DictReader(table))
    column = lambda name: np.array([float(row[name] or 0) for row in rows])
    return column("x"), column("y"), column("S"), column("R")


def mgcv(folder, x, y, degree):
    with open(os.path.join(folder, "targets.csv"), "w") as target:
        target.write("x,y\n" + "".join(f"{a},{b}\n" for a, b in zip(x, y)))
    line = ["Rscript", os.path.join(HERE, "tools", "mgcv.R"), os.path.join(folder, "contacts.csv"), os.path.join(folder, "targets.csv")]
    run = subprocess.run([*line, str(BASIS), "1", str(degree)], check=True, capture_output=True, text=True)
    rows = [[float(v) for v in row.split(",")] for row in run.stdout.splitlines() if not row.startswith("T ")]
    return shape(*np.array(rows).T)


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--palpate", default="target/release/palpate")
    options.add_argument("--problems", type=int, default=100)
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--degree", type=int, default=4)
    options.add_argument("--mgcv-degree", type=int, choices=[3, 4])
    asked = options.parse_args()
    peer_degree = asked.mgcv_degree or asked.degree
    ratios = []
    for number in range(asked.problems):
        rng = np.random.default_rng([asked.seed, number])
        at, count = surface(rng), int(np.exp(rng.uniform(np.log(64), np.log(1500))))
        x, y = rng.uniform(-HALF, HALF, (2, count))
        z = at(x, y)
        noise = np.std(z) * np.exp(rng.uniform(np.log(0.003), np.log(0.05)))
        with tempfile.TemporaryDirectory() as folder:
            np.savetxt(os.path.join(folder, "contacts.csv"), np.c_[x, y, z + noise * rng.normal(size=count)], delimiter=",", header="x,y,z", comments="")
            gx, gy, *ours = palpate(asked.palpate, folder, asked.degree)
            theirs = mgcv(folder, gx, gy, peer_degree)
        truth = by_differences(at, gx, gy)
        errors = [[rms(found - true) for found, true in zip(tool, truth)] for tool in (ours, theirs)]
        ratios.append([a / b for a, b in zip(*errors)])
        print(f"{number:3} {count:5} contacts   S {errors[0][0]:.3f} {errors[1][0]:.3f}   R {errors[0][1]:.4f} {errors[1][1]:.4f}", flush=True)
    for name, column in zip("SR", np.array(ratios).T):
        low, middle, high = np.quantile(column, [0.1, 0.5, 0.9])
        print(f"error of {name}, palpate over mgcv: median {middle:.2f}, tenths {low:.2f} to {high:.2f}, worst {column.max():.2f}")


if __name__ == "__main__":
    main()
