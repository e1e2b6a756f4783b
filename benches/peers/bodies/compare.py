"""Whole bodies of no primitive, touched 50 and 150 times (500 by --counts): palpate as it comes beside a gaussian-process implicit surface.

    python benches/peers/bodies/compare.py [--palpate target/release/palpate] [--only banana,pear] [--counts 50,150] [--record benches/runs]

Distance and errors of S and R are root mean squares over the body: of palpate at the points of its map (24 x 24 of its chart, by their
area), of the other at 400 points even over the body. `inside`: per cent of palpate's points whose 95 % intervals hold place, S and R; of the
other the place alone, for it says no more. Both have the same contacts and normals; the other is told the noise, palpate nothing.
"""
import argparse
import multiprocessing
import os
import sys
import time

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(os.path.dirname(HERE), "surfaces"))
import answers
import bodies
import families
import implicit

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
K = 1.96


def rms(values, weights):
    return float(np.sqrt(np.sum(weights * values**2) / np.sum(weights)))


def share(held, weights):
    return 100 * float(np.sum(weights * held) / np.sum(weights))


def area(points):
    """Of the cells of a map about its points."""
    u, v = (np.gradient(points, axis=k) for k in (0, 1))
    return np.linalg.norm(np.cross(u, v), axis=-1).ravel()


def of_palpate(program, name, p, normals):
    document, rows = answers.of_contacts(program, *p.T, normals, grid=24, inset=0.0)
    q = np.stack([rows[c] for c in "xyz"], -1)
    weights = area(q.reshape(24, 24, 3))
    there = np.isfinite(rows["R"]) & np.all(np.isfinite(q), axis=1)
    rows, q, weights = {c: v[there] for c, v in rows.items()}, q[there], weights[there]
    true, away, _ = bodies.foot(bodies.BODIES[name], q)
    S, R = families.shape(*bodies.curvatures(bodies.gradient(bodies.BODIES[name], true), bodies.hessian(bodies.BODIES[name], true)))
    errors = [away, np.nan_to_num(rows["S"]) - S, rows["R"] - R]
    held = [abs(e) <= K * np.nan_to_num(rows[u]) for e, u in zip(errors, ("u_position", "u_S", "u_R"))]
    word = (document["fit"].get("chosen") or {}).get("hypothesis") or (document["fit"].get("chosen") or {}).get("surface", "?")
    return [rms(e, weights) for e in errors], [share(h, weights) for h in held], document["seconds"]["total"], f"{word}, {100 * np.mean(there):.0f} %"


def of_process(name, p, normals):
    start = time.perf_counter()
    found = implicit.Implicit(p, normals)
    body = bodies.BODIES[name]
    q, n = bodies.surface_points(name, 400, np.random.default_rng(7))
    t, k1, k2, sd = found.feet(q, n)
    took = time.perf_counter() - start
    truth = families.shape(*bodies.curvatures(bodies.gradient(body, q), bodies.hessian(body, q)))
    S, R = families.shape(k1, k2)
    even = np.ones(len(q))
    return [rms(e, even) for e in (t, S - truth[0], R - truth[1])], share(abs(t) <= K * sd, even), took


def one(job):
    program, name, count, seed = job
    p, normals = bodies.touched(name, count, seed)
    try:
        ours = of_palpate(program, name, p, normals)
    except RuntimeError as fault:
        ours = str(fault).split(": ", 2)[-1][:60].replace("\n", " ")
    return name, count, ours, of_process(name, p, normals)


def row(name, count, ours, theirs):
    errors, inside, took = theirs
    other = " / ".join(f"{e:.3f}" for e in errors)
    if isinstance(ours, str):
        return f"| {name} | {count} | no answer: {ours} | {other} | - | - , {inside:.0f} | - / {took:.1f} |"
    own = " / ".join(f"{e:.3f}" for e in ours[0])
    held = " ".join(f"{h:.0f}" for h in ours[1])
    ratios = " ".join(f"{a / b:.2f}" for a, b in zip(ours[0], errors))
    return f"| {name} | {count} | {own} ({ours[3]}) | {other} | {ratios} | {held}, {inside:.0f} | {ours[2]:.2f} / {took:.1f} |"


def summary(found):
    for count in sorted({f[1] for f in found}):
        own = [f for f in found if f[1] == count]
        good = [f for f in own if not isinstance(f[2], str)]
        nearer = sum(f[2][0][0] < f[3][0][0] for f in good)
        inside = np.mean([f[2][1] for f in good], axis=0) if good else [np.nan] * 3
        as_long = np.median([f[2][2] / f[3][2] for f in good]) if good else np.nan
        held = " ".join(f"{h:.0f}" for h in inside)
        yield f"{count} touches: {len(good)} of {len(own)} answered, nearer in {nearer}; inside (place, S, R) {held} %, the other's places {np.mean([f[3][1] for f in own]):.0f} %; it takes {as_long:.1f} times as long"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--palpate", default=os.path.join(ROOT, "target/release/palpate"))
    parser.add_argument("--only", default=",".join(bodies.BODIES))
    parser.add_argument("--counts", default="50,150")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--record", help="directory that takes bodies.md")
    options = parser.parse_args()
    jobs = [(options.palpate, name, int(count), options.seed) for count in options.counts.split(",") for name in options.only.split(",")]
    lines = ["| body | touches | palpate: distance / S / R (what, answered) | process: distance / S / R | ratios | inside: place S R, process | s |", "|---|---|---|---|---|---|---|"]
    print("\n".join(lines), flush=True)
    found = []
    with multiprocessing.Pool(options.processes) as pool:
        for answer in pool.imap(one, jobs):
            found.append(answer)
            lines.append(row(*answer))
            print(lines[-1], flush=True)
    words = list(summary(found))
    print("\n".join(words))
    if options.record:
        from importlib.util import module_from_spec, spec_from_file_location

        spec = spec_from_file_location("surfaces_compare", os.path.join(os.path.dirname(HERE), "surfaces", "compare.py"))
        about = module_from_spec(spec)
        spec.loader.exec_module(about)
        head = ["# Whole bodies of no primitive", "", f"`python benches/peers/bodies/compare.py --counts {options.counts} --record benches/runs`", ""]
        facts = [f"{k}: {v}  " for k, v in about.about().items()] + [""]
        with open(os.path.join(options.record, "bodies.md"), "w") as out:
            out.write("\n".join(head + facts + words + [""] + lines) + "\n")


if __name__ == "__main__":
    main()
