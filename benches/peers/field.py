"""Whole and partial things with a truth: what palpate says by default, beside a robust SciPy fit that is told the kind.

    python benches/peers/field.py DIR [--palpate PATH ...] [--markdown OUT]

DIR holds contact files and a `truth.jsonl`, one object a line: `file`, `kind` (sphere, cylinder, cone, or another word for what has no
one radius), `size` (a sphere's or cylinder's radius), `S` (null where there is none), and `note`, whose words behind `--` are options
that the file needs. Several programs, as a version and the one before it, stand beside each other.

right    the kind is the true one, and radius and |S| lie in their intervals; of another kind |S| alone; a refusal that names several
         things, the true one among them with its radius to 2 %
sure     a wrong kind, or an interval that misses, with the kind said above 95 %
SciPy    least_squares with soft_l1 distances from a sphere or cylinder, 95 % by resampling blocks; it does not tell the kind
"""
import argparse
import json
import os
import re
import subprocess
import types

import numpy as np
import patch_peers

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
LIMIT = 300
NEAR = 0.02


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("directory", metavar="DIR")
    target = os.environ.get("CARGO_TARGET_DIR", os.path.join(ROOT, "target"))
    parser.add_argument("--palpate", nargs="+", default=[os.path.join(target, "release", "palpate")])
    parser.add_argument("--markdown", metavar="OUT", help="file that takes the table")
    return parser.parse_args()


def said(program, path, options):
    """The document of a fit, or the first line of its refusal."""
    try:
        run = subprocess.run(
            [program, "fit", path, "--json", *options], capture_output=True, text=True, timeout=LIMIT, check=False
        )
    except subprocess.TimeoutExpired:
        return f"no answer within {LIMIT} s"
    return json.loads(run.stdout) if run.returncode == 0 else run.stderr.strip().split("\n")[0]


def holds(interval, truth):
    return interval is not None and None not in interval and interval[0] <= truth <= interval[1]


def of_answer(answer, case):
    """Words for the table, and whether the answer is right, or wrong and sure of it."""
    if isinstance(answer, str):
        return "refused: " + answer.split(": ")[-1][:60], names(answer, case), False
    shape, tried = answer["shape"], answer["fit"]["chosen"].get("tried") or [{"name": "none", "probability": 0.0}]
    kind, probability = tried[0]["name"], tried[0]["probability"] or 0.0
    words = f"{kind} {100 * probability:.0f} %"
    right = kind == case["kind"] or case["kind"] not in ("sphere", "cylinder", "cone")
    if shape.get("radius") is not None and case["kind"] in ("sphere", "cylinder"):
        low, high = shape.get("radius_interval") or (None, None)
        words += f", r {shape['radius']:.5g}" + (f" ({low:.5g} to {high:.5g})" if None not in (low, high) else "")
        right = right and holds((low, high), case["size"])
    elif case["kind"] in ("sphere", "cylinder"):
        right = False
    if case["S"] is not None:
        interval = (shape.get("S") or {}).get("interval")
        inside = interval is not None and (holds(interval, case["S"]) or holds(interval, -case["S"]))
        right = right and inside
    return words, right, not right and probability > 0.95


def names(refusal, case):
    """Whether a refusal names the thing among several."""
    if case["kind"] == "cone":
        return "a cone" in refusal
    word = {"sphere": "ball", "cylinder": "bar"}.get(case["kind"], "")
    radii = [float(r) for r in re.findall(word + r" of radius ([0-9]+(?:\.[0-9]+)?)", refusal)]
    return any(abs(radius - case["size"]) <= NEAR * case["size"] for radius in radii)


def robust(path, case):
    """Radius and interval of the fit that is told the kind; none for what it cannot read or has no radius."""
    if case["kind"] not in ("sphere", "cylinder") or not path.endswith((".csv", ".xyz")):
        return "-"
    with open(path) as file:
        heads = int(any(c.isalpha() for c in file.readline().replace("e", "")))
    rows = np.loadtxt(path, delimiter="," if path.endswith("csv") or "," in open(path).read(200) else None, skiprows=heads)
    points = rows[:, :3]
    centre = points.mean(axis=0)
    size = float(np.linalg.norm(points - centre, axis=1).max())
    normals = rows[:, 3:6] if rows.shape[1] >= 6 else None
    patch = types.SimpleNamespace(points=points, normals=normals, centre=centre, size=size, told=case["kind"])
    try:
        found = patch_peers.robust(patch)
    except (ValueError, np.linalg.LinAlgError) as fault:
        return f"fails: {str(fault)[:40]}"
    low, high = found.interval
    mark = "" if low <= case["size"] <= high else ", misses"
    return f"r {found.radius:.5g} ({low:.5g} to {high:.5g}){mark}"


def main():
    wishes = arguments()
    with open(os.path.join(wishes.directory, "truth.jsonl")) as file:
        cases = [json.loads(line) for line in file if line.strip()]
    programs = [os.path.basename(program) for program in wishes.palpate]
    lines = ["| file | truth | " + " | ".join(programs) + " | SciPy, told the kind |", "|---" * (3 + len(programs)) + "|"]
    counts = np.zeros((len(programs), 2), int)
    for case in cases:
        path = os.path.join(wishes.directory, case["file"])
        note = case.get("note") or ""
        options = note.split() if note.startswith("--") else []
        cells = []
        for k, program in enumerate(wishes.palpate):
            words, right, sure = of_answer(said(program, path, options), case)
            counts[k] += [right, sure]
            cells.append(("" if right else "WRONG AND SURE: " if sure else "not right: ") + words)
        truth = case["kind"] + ("" if case["size"] is None else f" {case['size']:g}")
        lines.append(f"| {case['file']} | {truth} | " + " | ".join(cells) + f" | {robust(path, case)} |")
        print(lines[-1], flush=True)
    for program, (right, sure) in zip(programs, counts):
        lines.append(f"\n{program}: {right} of {len(cases)} right, {sure} wrong and sure")
        print(lines[-1].strip(), flush=True)
    if wishes.markdown:
        with open(wishes.markdown, "w") as file:
            file.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
