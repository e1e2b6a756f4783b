"""Eight surfaces, three kinds of input, S and R: palpate as it comes over the best other tool, tuned with the truth in sight.

    python benches/peers/surfaces/compare.py [--palpate target/release/palpate] [--only torus,wave] [--kinds normals] [--record benches/runs]

    normals     27 and 64 contacts with normals           positions    800 contacts without          pixels    64 x 64 heights

Errors are root mean squares over the seeds at those points of palpate's map (20 x 20 of the inner four fifths of its patch) that it answers
for: inside the outline of the contacts. A flat point, which has no S, counts as S = 0. For every cell the tool and the one setting that come nearest to the truth are taken
from `fitters.py`, for S and for R apart, which nobody could do who does not know the truth. Times: the fit and its map, files apart.
"""
import argparse
import datetime
import multiprocessing
import os
import platform
import subprocess
import time
import warnings

import answers
import families
import fitters
import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))))
KINDS = {"normals": [(27, seed) for seed in range(1, 5)] + [(64, seed) for seed in range(1, 5)],
         "positions": [(800, seed) for seed in range(1, 4)],
         "pixels": [(4096, seed) for seed in range(1, 3)]}


def asked(program, name, kind, count, seed):
    """palpate's answer, its seconds, its words, the task for the others, and the share of points that are answered."""
    image = None
    if kind == "pixels":
        at, image = families.pixels(name, int(count**0.5), seed)
        document, rows = answers.of_image(program, at, image)
        x, y = (v.ravel() for v in np.meshgrid(at, at, indexing="ij"))
        z, normals = image.ravel(), None
    else:
        x, y, z, normals = families.contacts(name, count, seed)
        normals = normals if kind == "normals" else None
        document, rows = answers.of_contacts(program, x, y, z, normals)
    seconds = document["seconds"]["fit"] + document["seconds"]["shape"]
    answered = np.isfinite(rows["R"])
    task = fitters.Task(x, y, z, normals, image, rows["x"][answered], rows["y"][answered])
    said = [np.nan_to_num(rows[c][answered]) for c in ("S", "R")]
    chosen = (document["fit"].get("chosen") or {}).get("hypothesis") or (document["fit"].get("chosen") or {}).get("surface", "?")
    return said, seconds, chosen, task, float(np.mean(answered))


def squares(said, true):
    return [float(np.mean((a - b) ** 2)) for a, b in zip(said, true)]


def one(job):
    """Mean squared errors and seconds of every tool and setting on one draw."""
    program, name, kind, count, seed = job
    warnings.simplefilter("ignore")
    said, seconds, chosen, task, share = asked(program, name, kind, count, seed)
    true = families.truth(families.FAMILIES[name], task.tx, task.ty)[2:]
    found = {("palpate", "", count): (squares(said, true), seconds, chosen, share)}
    for tool, work, settings in fitters.fitters(kind, count):
        for setting in settings:
            start = time.perf_counter()
            try:
                answer = work(task, setting)
            except Exception:  # too few contacts for this setting
                continue
            took = time.perf_counter() - start
            k = answer if len(answer) == 2 else families.principal(*answer)
            error = squares(families.shape(*k), true)
            if np.all(np.isfinite(error)):
                found[tool, str(setting), count] = (error, took, "")
    return name, kind, found


def nearest(runs, which, count):
    """The tool and setting of least mean error over all draws of this number of contacts: error, tool, setting, seconds."""
    own = [{k[:2]: v for k, v in found.items() if k[2] == count and k[0] != "palpate"} for found in runs if ("palpate", "", count) in found]
    shared = set.intersection(*(set(o) for o in own))
    mean = {key: np.mean([o[key][0][which] for o in own]) for key in shared}
    best = min(mean, key=mean.get)
    return mean[best], *best, min(o[best][1] for o in own)


def rows_of(name, kind, runs):
    counts = sorted({count for found in runs for tool, _, count in found if tool == "palpate"})
    mine = [found["palpate", "", count] for found in runs for count in counts if ("palpate", "", count) in found]
    lines, ratios = [], []
    for which, letter in enumerate("SR"):
        ours = np.sqrt(np.mean([m[0][which] for m in mine]))
        peers = [nearest(runs, which, count) for count in counts]
        theirs = np.sqrt(np.mean([p[0] for p in peers]))
        ratios.append(ours / theirs)
        tools = ", ".join(f"{p[1]} {p[2]}" for p in peers)
        times = f"{1e3 * min(m[1] for m in mine):.1f} / {1e3 * max(p[3] for p in peers):.1f}"
        chosen = [m[2] for m in mine]
        word = max(set(chosen), key=chosen.count)
        lines.append(f"| {name} | {kind} | {letter} | {ours:.4f} | {theirs:.4f} | {ours / theirs:.2f} | {tools} | {times} | {word} {chosen.count(word)}/{len(chosen)} | {100 * np.mean([m[3] for m in mine]):.0f} % |")
    return lines, ratios


def about():
    run = lambda *line: subprocess.run(line, capture_output=True, text=True).stdout.strip()
    facts = {"date": datetime.date.today().isoformat(), "commit": run("git", "-C", ROOT, "rev-parse", "--short", "HEAD"), "python": platform.python_version()}
    for module in ("numpy", "scipy", "skimage"):
        facts[module] = __import__(module).__version__
    facts["mgcv"] = run("Rscript", "-e", 'cat(as.character(packageVersion("mgcv")))')
    return facts


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--palpate", default=os.path.join(ROOT, "target/release/palpate"))
    parser.add_argument("--only", default=",".join(families.FAMILIES))
    parser.add_argument("--kinds", default=",".join(KINDS))
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--record", help="directory that takes surfaces.md")
    options = parser.parse_args()
    cells = [(name, kind) for kind in options.kinds.split(",") for name in options.only.split(",")]
    jobs = [(options.palpate, name, kind, *draw) for name, kind in cells for draw in KINDS[kind]]
    lines = ["| surface | input | of | palpate's error | best other | ratio | which, with what setting | ms, palpate / other | palpate took | points |", "|---|---|---|---|---|---|---|---|---|---|"]
    print("\n".join(lines), flush=True)
    runs, ratios = {cell: [] for cell in cells}, []
    with multiprocessing.Pool(options.processes) as pool:
        for name, kind, found in pool.imap(one, jobs):
            runs[name, kind].append(found)
            if len(runs[name, kind]) == len(KINDS[kind]):
                more, two = rows_of(name, kind, runs[name, kind])
                print("\n".join(more), flush=True)
                lines, ratios = lines + more, ratios + two
    ratios = np.array(ratios)
    summary = f"{np.sum(ratios <= 0.9)} of {len(ratios)} cells at most 0.9, {np.sum(ratios > 1.1)} above 1.1; median {np.median(ratios):.2f}, worst {ratios.max():.2f}"
    print(summary)
    if options.record:
        head = ["# Eight surfaces beside other tools", "", "`python benches/peers/surfaces/compare.py --record benches/runs`", ""]
        facts = [f"{k}: {v}  " for k, v in about().items()] + [""]
        with open(os.path.join(options.record, "surfaces.md"), "w") as out:
            out.write("\n".join(head + facts + [summary, ""] + lines) + "\n")


if __name__ == "__main__":
    main()
