"""Dense data on the command line: processor and wall seconds of two palpate binaries, in turn on the same files.

    python benches/experiments/dense.py OLD NEW [--rounds 3] [--only WORDS] [--record benches/runs/dense.md]

The data are made by NumPy: a ridge of radius 10 with a wave along it, 8 x 6 units, as height maps and as contacts. Best
of the rounds counts. A dash: the binary does not know the option, or was stopped after two minutes.
"""

import argparse
import os
import pathlib
import platform
import resource
import subprocess
import sys
import tempfile
import time

import numpy as np

LIMIT = 120
RADIUS = 10.0

CASES = [
    # words, file, options
    ("640 x 480, slopes, 80 x 60 segments", "image", "--degree 3 --segments 80x60 --weights equal"),
    ("the same, --bare", "image", "--degree 3 --segments 80x60 --weights equal --bare"),
    ("640 x 480, slopes, noise estimated", "image", "--degree 3 --segments 80x60"),
    ("640 x 480, heights alone", "heights", "--degree 3 --segments 80x60"),
    ("map of 1000 x 1000 points", "image", "--degree 3 --segments 20 --weights 1,1,1 --grid 1000x1000"),
    ("the same, --bare", "image", "--degree 3 --segments 20 --weights 1,1,1 --grid 1000x1000 --bare"),
    ("robust (huber), 600 x 500, slopes", "outliers", "--robust huber --degree 2"),
    ("robust (tukey), 600 x 500, slopes", "outliers", "--robust tukey --degree 2"),
    ("robust (huber), 600 x 500, heights", "outliers_heights", "--robust huber --degree 2"),
    ("10^6 contacts with normals, degree 2", "million", "--degree 2"),
    ("10^6 contacts, 64 x 64 segments", "million", "--degree 3 --segments 64 --weights 1,1,1"),
    ("surface in space, 36 contacts", "touches", "--surface parametric"),
    ("surface in space, 20,000 contacts", "twenty", "--surface parametric"),
    ("surface in space, 20,000 contacts, 160 degrees", "bent", "--surface parametric"),
    ("no model named, 20,000 contacts", "twenty", ""),
    ("no model named, 640 x 480 with slopes", "image", ""),
    ("no model named, 10^6 contacts", "million", ""),
]


def grid(n, m, rng, slopes=True, slips=False):
    x, y = np.linspace(-4, 4, n), np.linspace(-3, 3, m)
    a, b = np.meshgrid(x, y, indexing="ij")
    noise = lambda: 0.002 * rng.standard_normal(a.shape)
    root = np.sqrt(RADIUS**2 - a * a)
    made = {"x": x, "y": y, "z": root - RADIUS + 0.05 * np.sin(0.8 * b) + noise()}
    if slips:
        where = rng.random(a.shape) < 0.02
        made["z"][where] += 0.3 * rng.standard_normal(where.sum())
    if slopes:
        made["zx"], made["zy"] = -a / root + noise(), 0.04 * np.cos(0.8 * b) + noise()
    return made


def cloud(count, rng, half=0.5):
    angle, y = rng.uniform(-half, half, count), rng.uniform(-4, 4, count)
    normal = np.c_[np.sin(angle), np.zeros(count), np.cos(angle)]
    point = RADIUS * normal + np.c_[np.zeros(count), y, np.full(count, -RADIUS)]
    point += 0.01 * rng.standard_normal(point.shape)
    normal += np.radians(3.0) * rng.standard_normal(point.shape)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    return dict(zip(("x", "y", "z", "nx", "ny", "nz"), np.c_[point, normal].T))


def write_data(directory):
    rng = np.random.default_rng(7)
    makers = {
        "image": lambda: grid(640, 480, rng),
        "heights": lambda: grid(640, 480, rng, slopes=False),
        "outliers": lambda: grid(600, 500, rng, slips=True),
        "outliers_heights": lambda: grid(600, 500, rng, slopes=False, slips=True),
        "million": lambda: cloud(1_000_000, rng),
        "touches": lambda: cloud(36, rng),
        "twenty": lambda: cloud(20_000, rng),
        "bent": lambda: cloud(20_000, rng, half=1.4),
    }
    for name, make in makers.items():
        np.savez(directory / f"{name}.npz", **make())


def run(binary, file, options):
    """Processor and wall seconds of one run; None where it fails or takes too long."""
    before, clock = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    try:
        done = subprocess.run([binary, "fit", file, *options.split(), "--json"], capture_output=True, timeout=LIMIT)
    except subprocess.TimeoutExpired:
        return None
    wall, after = time.monotonic() - clock, resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        return None
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, wall


def measure(binaries, file, options, rounds):
    found = [[] for _ in binaries]
    for _ in range(rounds):
        for k, binary in enumerate(binaries):
            if not found[k] or found[k][-1] is not None:
                found[k].append(run(binary, file, options))
    return [tuple(map(min, zip(*times))) if None not in times else None for times in found]


def shown(times, part):
    return "-" if times is None else f"{times[part]:.3f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old")
    parser.add_argument("new")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--only", default="", help="cases whose words contain this")
    parser.add_argument("--record", type=pathlib.Path)
    args = parser.parse_args()
    lines = [
        "| data and options of `palpate fit` | processor, old | new | wall, old | new |",
        "|---|---|---|---|---|",
    ]
    print("\n".join(lines))
    with tempfile.TemporaryDirectory() as directory:
        directory = pathlib.Path(directory)
        write_data(directory)
        for words, file, options in CASES:
            if args.only not in words:
                continue
            old, new = measure([args.old, args.new], directory / f"{file}.npz", options, args.rounds)
            parts = [shown(old, 0), shown(new, 0), shown(old, 1), shown(new, 1)]
            lines.append(f"| {words}: `{options}` | " + " | ".join(parts) + " |")
            print(lines[-1], flush=True)
    if args.record:
        head = [
            "# Dense data: seconds of two binaries",
            "",
            "`python benches/experiments/dense.py OLD NEW --record benches/runs/dense.md`: one run, best of "
            f"{args.rounds} rounds in turn, on {os.cpu_count()} threads of one {platform.machine()} machine with a load of "
            f"{os.getloadavg()[0]:.1f}. Processor seconds are of all threads together, system time included.",
            "",
        ]
        args.record.write_text("\n".join(head + lines) + "\n")


if __name__ == "__main__":
    sys.exit(main())
