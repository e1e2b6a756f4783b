"""640 x 480 heights and slopes: milliseconds until S and R stand at every pixel, by palpate, scikit-image and NumPy.

    python benches/peers/surfaces/images.py [--palpate target/release/palpate] [--record benches/runs]

palpate: the clocks of `fit --json` (fit, and shape with its intervals), the program's start and files apart; `--bare` leaves out u. The
others: least of five. A plan at hand is timed by `benches/peers/compare.py --work w3`.
"""
import argparse
import os
import tempfile
import time

import answers
import compare
import families
import numpy as np

NAMED = ("--degree", "3", "--segments", "80,60")


def image(x, y):
    return families.bump(x, y) + 0.1 * np.sin(x) * np.cos(1.3 * y)


def least(work):
    seconds = []
    for _ in range(5):
        start = time.perf_counter()
        work()
        seconds.append(time.perf_counter() - start)
    return 1e3 * min(seconds)


def by_numpy(z, px, py):
    zx, zy = np.gradient(z, px, py)
    zxx, zxy = np.gradient(zx, px, py)
    return families.shape(*families.principal(zx, zy, zxx, zxy, np.gradient(zy, py, axis=1)))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--palpate", default=os.path.join(compare.ROOT, "target/release/palpate"))
    parser.add_argument("--record", help="directory that takes surface-images.md")
    options = parser.parse_args()
    from skimage.feature import shape_index

    draw = np.random.default_rng(1)
    x, y = np.linspace(-6, 6, 640), np.linspace(-4.5, 4.5, 480)
    X, Y = np.meshgrid(x, y, indexing="ij")
    z = image(X, Y) + draw.normal(0, 0.01, X.shape)
    zx, zy = (d + draw.normal(0, 0.02, X.shape) for d in families.derivatives(image, X, Y)[:2])
    lines = ["| who | ms | rms error of S | of R, relative |", "|---|---|---|---|"]
    true = families.truth(image, X, Y)[2:]
    errors = lambda S, R, to: f"{np.sqrt(np.nanmean((S - to[0]) ** 2)):.3f} | {np.sqrt(np.nanmean((R - to[1]) ** 2)) / to[1].mean():.3f}"
    with tempfile.TemporaryDirectory() as folder:
        source = os.path.join(folder, "image.npz")
        np.savez(source, x=x, y=y, z=z, zx=zx, zy=zy)
        for words, more in (("palpate, 83 x 63 unknowns, S and R at every pixel, means with u", NAMED), ("the same without u (`--bare`)", (*NAMED, "--bare")), ("palpate, nothing named", ())):
            lines_of = ["--grid", "640x480", *more]
            runs = []
            for _ in range(3):
                try:
                    document, rows = fitted(options.palpate, source, lines_of, folder)
                except RuntimeError as fault:
                    runs, rows = [], str(fault)[:80]
                    break
                runs.append(document["seconds"]["fit"] + document["seconds"]["shape"])
            if not runs:
                lines.append(f"| {words} | no answer: {rows} | - | - |")
                continue
            lines.append(f"| {words} | {1e3 * min(runs):.1f} | {errors(rows['S'], rows['R'], families.truth(image, rows['x'], rows['y'])[2:])} |")
    lines.append(f"| scikit-image `shape_index`, sigma 8 | {least(lambda: shape_index(z, sigma=8)):.1f} | {np.sqrt(np.mean((shape_index(z, sigma=8) - true[0]) ** 2)):.3f} | - |")
    lines.append(f"| NumPy `gradient` of the heights | {least(lambda: by_numpy(z, x, y)):.1f} | {errors(*by_numpy(z, x, y), true)} |")
    print("\n".join(lines))
    if options.record:
        head = ["# 640 x 480 heights and slopes", "", "`python benches/peers/surfaces/images.py --record benches/runs`", ""]
        facts = [f"{k}: {v}  " for k, v in compare.about().items()] + [""]
        with open(os.path.join(options.record, "surface-images.md"), "w") as out:
            out.write("\n".join(head + facts + lines) + "\n")


def fitted(program, source, more, folder):
    import json
    import subprocess

    out = os.path.join(folder, "out")
    run = subprocess.run([program, "fit", source, *more, "--json", "--out", out], capture_output=True, text=True)
    if run.returncode:
        raise RuntimeError((run.stderr or run.stdout).strip())
    return json.loads(run.stdout), answers.table(os.path.join(out, "maps.csv"))


if __name__ == "__main__":
    main()
