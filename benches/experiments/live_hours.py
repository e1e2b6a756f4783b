#!/usr/bin/env python3
"""Ten hours of touches, one a second, as quickly as they are answered: does `palpate live` keep its memory and its pace?

    python benches/experiments/live_hours.py [--palpate target/release/palpate] [--hours 10] [--window 200] [--record benches/runs]

A finger slides along a bar of radius 25, half of its way round; places err by 0.05 and normals by 0.02 rad. Resident memory is read at every
tenth of the touches (Linux). The last answer is held against `palpate fit` of the touches that count at the last look. No library is needed.
"""
import argparse
import collections
import json
import math
import pathlib
import random
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
RADIUS, NOISE, NOISE_OF_NORMAL = 25.0, 0.05, 0.02
TENTHS = 10


def touches(count):
    """Lines x,y,z,nx,ny,nz."""
    draw = random.Random(7)
    for k in range(count):
        along, around = 20 * math.sin(0.013 * k), 0.5 * math.pi * math.sin(0.0031 * k)
        normal = [math.sin(around), 0.0, math.cos(around)]
        place = [RADIUS * normal[0], along, RADIUS * normal[2]]
        place = [v + draw.gauss(0, NOISE) for v in place]
        normal = [v + draw.gauss(0, NOISE_OF_NORMAL) for v in normal]
        size = math.hypot(*normal)
        yield ",".join(f"{v:.6g}" for v in [*place, *(v / size for v in normal)])


def resident(process):
    """Megabytes that a process holds."""
    words = pathlib.Path(f"/proc/{process}/status").read_text().split("VmRSS:")[1].split()
    return int(words[0]) / 1024


def lived(program, source, count, window):
    """Memory at every tenth of the answers, and the last two lines: the last answer, and what is said of all."""
    line = [program, "live", "-", "--window", str(window), "--json"]
    memory, last = [], collections.deque(maxlen=2)
    with source.open() as lines, subprocess.Popen(line, stdin=lines, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as live:
        for number, answer in enumerate(live.stdout, 1):
            if number % (count // TENTHS) == 0 and live.poll() is None:
                memory.append(resident(live.pid))
            last.append(json.loads(answer))
    return memory, *last


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--palpate", default=str(ROOT / "target" / "release" / "palpate"))
    parser.add_argument("--hours", type=float, default=10)
    parser.add_argument("--window", type=int, default=200)
    parser.add_argument("--record", type=pathlib.Path)
    options = parser.parse_args()
    count = round(3600 * options.hours)
    names = "x,y,z,nx,ny,nz"
    with tempfile.TemporaryDirectory() as folder:
        all_of, last_of = (pathlib.Path(folder) / name for name in ("touches.csv", "last.csv"))
        made = list(touches(count))
        all_of.write_text("\n".join([names, *made]) + "\n")
        memory, last, said = lived(options.palpate, all_of, count, options.window)
        last_of.write_text("\n".join([names, *made[-options.window :]]) + "\n")
        run = subprocess.run([options.palpate, "fit", str(last_of), "--json"], capture_output=True, text=True, check=True)
    shape = json.loads(run.stdout)["shape"]
    lines = [f"{count} touches, the last {options.window} count", "resident memory, MB, at every tenth: " + ", ".join(f"{m:.1f}" for m in memory)]
    lines += [f"{key}: {said[key]}" for key in ("answers_per_second", "p50_ms", "p99_ms", "fresh", "left_out")]
    lines += ["last answer: " + json.dumps(last), f"palpate fit of the last {options.window}: S {shape['S']['mean']}, R {shape['R']['mean']}"]
    print("\n".join(lines))
    if options.record:
        commit = subprocess.run(["git", "-C", ROOT, "rev-parse", "--short", "HEAD"], capture_output=True, text=True).stdout.strip()
        command = "python benches/experiments/live_hours.py --record benches/runs"
        text = f"# Ten hours of touches\n\n`{command}`, at commit {commit}\n\n```text\n" + "\n".join(lines) + "\n```\n"
        (options.record / "live-hours.md").write_text(text)


if __name__ == "__main__":
    main()
