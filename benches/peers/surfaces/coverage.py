"""Do the intervals of palpate's maps hold the truth across the patch? Eight surfaces, several numbers of contacts, default options.

    python benches/peers/surfaces/coverage.py [--palpate target/release/palpate] [--seeds 10] [--only bump] [--record benches/runs]

Per cent of the points of a map whose 95 % interval (value +- 1.96 u) holds the truth, averaged over fits: z (along the normal), S and R.
Means: per cent of fits whose interval of mean S and of mean R, as `fit --json` says them, hold the mean of the truth over the same points.
S of points where R is less than a twentieth of the patch's largest R means nothing and is left out. `width` is the median of u over the
root mean square error: 1 where intervals are as wide as they need to be.
"""
import argparse
import multiprocessing
import os

import answers
import compare
import families
import numpy as np

CASES = (("normals", 12), ("normals", 27), ("normals", 64), ("positions", 800))
K = 1.96


def one(job):
    program, name, kind, count, seed = job
    x, y, z, normals = families.contacts(name, count, 1000 + seed)
    try:
        # without normals nothing else tells the free side
        given = (normals,) if kind == "normals" else (None, "--viewpoint", "0,0,100")
        document, rows = answers.of_contacts(program, x, y, z, *given, inset=0.0)
    except RuntimeError as fault:
        return name, kind, count, str(fault)
    height = families.FAMILIES[name]
    there = np.isfinite(rows["R"])
    rows = {key: values[there] for key, values in rows.items()}
    zx, zy = families.derivatives(height, rows["x"], rows["y"])[:2]
    k1, k2, S, R = families.truth(height, rows["x"], rows["y"])
    away = (rows["z"] - height(rows["x"], rows["y"])) / np.sqrt(1 + zx**2 + zy**2)
    found = {"z": (away, rows["u_position"]), "R": (rows["R"] - R, rows["u_R"])}
    for letter, true in (("k1", k1), ("k2", k2)):
        if f"u_{letter}" in rows:
            found[letter] = (rows[letter] - true, rows[f"u_{letter}"])
    bent = (R > 0.05 * R.max()) & np.isfinite(rows["S"])
    found["S"] = ((rows["S"] - S)[bent], rows["u_S"][bent])
    shares = {letter: (np.mean(abs(e) <= K * u), np.mean(e**2), np.nanmedian(u)) for letter, (e, u) in found.items() if len(e) and np.isfinite(u).any()}
    means = {}
    for letter, true in (("S", S), ("R", R)):
        interval = document["shape"][letter].get("interval")
        if interval:
            means[letter] = interval[0] <= np.mean(true) <= interval[1]
    return name, kind, count, (shares, means)


def table(found):
    letters = ("z", "k1", "k2", "S", "R")
    yield "| surface | contacts | " + " | ".join(f"{letter} inside, width" for letter in letters) + " | mean S | mean R | no answer |"
    yield "|---" * (len(letters) + 5) + "|"
    for (name, kind, count), answers_of in found.items():
        good = [a for a in answers_of if not isinstance(a, str)]
        cells = []
        for letter in letters:
            own = [a[0][letter] for a in good if letter in a[0]]
            if not own:
                cells.append("-")
                continue
            rms = np.sqrt(np.mean([o[1] for o in own]))
            cells.append(f"{100 * np.mean([o[0] for o in own]):.0f}, {np.median([o[2] for o in own]) / rms:.2f}")
        for letter in "SR":
            own = [a[1][letter] for a in good if letter in a[1]]
            cells.append(f"{100 * np.mean(own):.0f}" if own else "-")
        yield f"| {name} | {count} {kind} | " + " | ".join(cells) + f" | {len(answers_of) - len(good)} |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--palpate", default=os.path.join(compare.ROOT, "target/release/palpate"))
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--only", default=",".join(families.FAMILIES))
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--record", help="directory that takes surface-maps.md")
    options = parser.parse_args()
    cells = [(name, kind, count) for kind, count in CASES for name in options.only.split(",")]
    jobs = [(options.palpate, *cell, seed) for cell in cells for seed in range(options.seeds)]
    found = {cell: [] for cell in cells}
    with multiprocessing.Pool(options.processes) as pool:
        for name, kind, count, answer in pool.imap_unordered(one, jobs):
            found[name, kind, count].append(answer)
    lines = list(table(found))
    print("\n".join(lines))
    if options.record:
        head = ["# Do maps hold the truth across the patch?", "", f"`python benches/peers/surfaces/coverage.py --seeds {options.seeds} --record benches/runs`", ""]
        facts = [f"{k}: {v}  " for k, v in compare.about().items()] + [""]
        with open(os.path.join(options.record, "surface-maps.md"), "w") as out:
            out.write("\n".join(head + facts + lines) + "\n")


if __name__ == "__main__":
    main()
