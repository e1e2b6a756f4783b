#!/usr/bin/env python3
"""Two hundred requests on scenes drawn at random: is what `palpate frontier --emit` picks accurate, cheap and in time?

    python benches/experiments/frontier/requests.py [--requests N] [--first-seed K] [--palpate P] [--record FOLDER]

For every request a scene is drawn (kind of body, sizes, angle, fingers, stations, noise). Then

1. an exhaustive search measures every candidate, under seed A;
2. a request is drawn between the most and the least accurate (or the slowest and the fastest) of them;
3. `palpate frontier SCENE --seed B --emit F` answers the request from measurements of its own;
4. `palpate run F` under a fresh seed C says whether the errors asked for are kept;
5. the exhaustive search says what the picked candidate costs beside the cheapest candidate that it found to meet the request.

Even requests ask for errors of S and R, every fourth for one of them alone; odd requests ask for a budget. The recognised answer is a
candidate as all others are.
Seeds above 10^6 are those of the recorded run and were never used while the picking was built.
"""

import argparse
import json
import math
import pathlib
import random
import re
import subprocess
import tempfile

# of an answer, and of the search that it is held against
SECONDS = "3"
EXHAUSTIVE_SECONDS = "12"


def scene(draw, seed):
    """TOML of a random scene whose body reaches under all fingers."""
    kind = draw.choice(["sphere", "cylinder", "ellipsoid", "paraboloid", "saddle", "gaussian"])
    size = 4.0
    body = {
        "sphere": lambda: {"radius": draw.uniform(7.0, 60.0)},
        "cylinder": lambda: {"radius": draw.uniform(7.0, 60.0), "axis_deg": draw.uniform(0.0, 180.0)},
        "ellipsoid": lambda: {"semi_axes": [draw.uniform(7.0, 30.0) for _ in range(3)], "axis_deg": draw.uniform(0.0, 180.0)},
        "paraboloid": lambda: {"radii": [draw.uniform(8.0, 60.0) for _ in range(2)]},
        "saddle": lambda: {"radii": [draw.uniform(8.0, 60.0) for _ in range(2)]},
        "gaussian": lambda: {"height": draw.uniform(0.5, 3.0), "width": draw.uniform(3.0, 8.0)},
    }[kind]()
    fingers = draw.choice([3, 4, 5])
    lanes = [-size + 2.0 * size * k / (fingers - 1) for k in range(fingers)]
    lines = [f"seed = {seed}", "[surface]", f'kind = "{kind}"']
    lines += [f"{key} = {json.dumps(value)}" for key, value in body.items()]
    lines += ["[sweep]", f"fingers = {lanes}", f"from = {-size}", f"to = {size}", f"stations = {draw.choice([6, 9, 12])}"]
    # a third of the scenes has no noise, a third that of positions, a third that of normals as well
    noise = draw.choice([0, 1, 2])
    if noise > 0:
        lines += ["[effects.position_noise]", f"sigma = {10.0 ** draw.uniform(-3.5, -1.3)}"]
    if noise > 1:
        lines += ["[effects.normal_noise]", f"sigma_deg = {10.0 ** draw.uniform(-1.0, 0.7)}"]
    lines += ["[fit]", "degree = 2", 'weights = "tangent"', "grid = [6, 6]"]
    return "\n".join(lines) + "\n"


def palpate(program, *arguments):
    """A JSON document, or the message of a refusal."""
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"palpate {' '.join(map(str, arguments))}: {done.stderr.strip()}")
    return json.loads(done.stdout)


def logarithmic(draw, low, high):
    return low if high <= low else math.exp(draw.uniform(math.log(low), math.log(high)))


def ask(draw, number, points):
    """A request within what the exhaustive search found possible."""
    if number % 2:
        times = sorted(point["seconds"]["hi"] for point in points)
        # 1.1 is the spare that a budget is met with
        return {"budget": logarithmic(draw, 1.1 * times[0] * 1.1, times[len(times) * 9 // 10])}
    upper = {q: [p["errors"][q]["upper"] for p in points if p["errors"][q]["upper"] is not None] for q in "SR"}
    # rounding is no accuracy that anybody asks for
    request = {}
    for q in "SR":
        values = sorted(max(value, 1e-9) for value in upper[q])
        request[q] = logarithmic(draw, 1.2 * values[0], values[len(values) * 3 // 4])
    if number % 8 == 2:
        del request["R"]
    if number % 8 == 6:
        del request["S"]
    return request


def meets(point, request):
    """By the criterion of the picker, on the measurements of the exhaustive search."""
    if "budget" in request:
        return point["seconds"]["hi"] <= request["budget"]
    kept = {q: point["errors"][q]["upper"] for q in request}
    return all(value is not None and value <= request[q] for q, value in kept.items())


def one(program, number, seed):
    draw = random.Random(seed)
    with tempfile.TemporaryDirectory() as folder:
        file, emitted = pathlib.Path(folder, "scene.toml"), pathlib.Path(folder, "picked.toml")
        file.write_text(scene(draw, seed))
        common = ["frontier", file, "--json"]
        common += [] if draw.random() < 0.25 else ["--keep-stations"]
        # a budget that anything keeps, so that stations are varied as they are for a request
        all_ways = [*common, "--seconds", EXHAUSTIVE_SECONDS, "--budget", "1000s"]
        common += ["--seconds", SECONDS]
        found = palpate(program, *all_ways, "--seed", 3 * seed)["points"]
        sound = [p for p in found if p["failed"] is None and p["errors"]["S"] and p["errors"]["R"] and p["seconds"]]
        points = [p for p in sound if all(p["errors"][q]["upper"] is not None for q in "SR")]
        if not points:
            # so slow a scene, or so busy a machine, that the search judged fewer runs than a promise needs
            return None
        request = ask(draw, number, points)
        flags = {"S": "--error-s", "R": "--error-r"}
        asked = [word for q, value in request.items() for word in (
            ("--budget", f"{1e6 * value}us") if q == "budget" else (flags[q], repr(value)))]
        pick = palpate(program, *common, "--seed", 3 * seed + 1, *asked, "--emit", emitted)["pick"]
        text = re.sub(r"(?m)^seed = .*$", f"seed = {3 * seed + 2}", emitted.read_text())
        emitted.write_text(text)
        truth = palpate(program, "run", emitted, "--json")["truth"]
    own = next((p for p in points if p["label"] == pick["label"]), None)
    possible = [p for p in points if meets(p, request)]
    outcome = {"request": request, "label": pick["label"], "met": pick["met"], "possible": bool(possible)}
    if "budget" in request:
        outcome["kept"] = own is not None and own["seconds"]["median"] <= request["budget"]
    else:
        errors = {"S": truth["error_S"], "R": truth["error_R"]}
        outcome["kept"] = all(errors[q] is not None and errors[q] <= value for q, value in request.items())
        if possible and own is not None:
            cheapest = min(p["seconds"]["least"] for p in possible)
            outcome["ratio"] = own["seconds"]["least"] / cheapest
    return outcome


def share(part, whole):
    return f"{part} of {whole} ({100.0 * part / max(whole, 1):.1f} %)"


def report(outcomes, first, count):
    met = [o for o in outcomes if o["met"]]
    errors = [o for o in met if "budget" not in o["request"]]
    budgets = [o for o in met if "budget" in o["request"]]
    ratios = sorted(o["ratio"] for o in errors if "ratio" in o)
    lines = [f"{len(outcomes)} requests, seeds {first} to {first + count - 1}"]
    lines.append(f"met by the picker's own measurements       {share(len(met), len(outcomes))}")
    recognised = [o for o in met if o["label"].startswith("recognised")]
    lines.append(f"picks that are the recognised answer       {share(len(recognised), len(met))}")
    lines.append(f"  of these kept                            {share(sum(o['kept'] for o in recognised), len(recognised))}")
    unmet = [o for o in outcomes if not o["met"]]
    lines.append(f"not met, and the exhaustive search agrees  {share(sum(not o['possible'] for o in unmet), len(unmet))}")
    lines.append(f"errors kept by the emitted scene, afresh   {share(sum(o['kept'] for o in errors), len(errors))}")
    lines.append(f"budgets kept                               {share(sum(o['kept'] for o in budgets), len(budgets))}")
    if ratios:
        lines.append(f"cost at most 1.2 x the cheapest            {share(sum(r <= 1.2 for r in ratios), len(ratios))}")
        lines.append(f"cost over the cheapest: median {ratios[len(ratios) // 2]:.3f}, 95th of 100 {ratios[len(ratios) * 95 // 100]:.3f}, largest {ratios[-1]:.2f}")
    return lines


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--requests", type=int, default=200)
    parser.add_argument("--first-seed", type=int, default=1_000_001)
    parser.add_argument("--palpate", default="palpate")
    parser.add_argument("--record", type=pathlib.Path)
    parser.add_argument("--show", action="store_true", help="print every request")
    arguments = parser.parse_args()
    outcomes = []
    for number in range(arguments.requests):
        outcome = one(arguments.palpate, number, arguments.first_seed + number)
        if outcome is not None:
            outcomes.append(outcome)
        if arguments.show:
            print(number, outcome, flush=True)
    lines = report(outcomes, arguments.first_seed, arguments.requests)
    print("\n".join(lines))
    if arguments.record:
        command = f"python benches/experiments/frontier/requests.py --record {arguments.record}"
        text = f"# Requests to the frontier\n\n`{command}`\n\n```text\n" + "\n".join(lines) + "\n```\n"
        (arguments.record / "frontier.md").write_text(text)


if __name__ == "__main__":
    main()
