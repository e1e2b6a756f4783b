"""A random sample of mutants per room: does any test notice a broken line?

    python tests/mutants/sample.py run --out FILE [--seed 1] [--each 10] [--room NAME] [--minutes M]
    python tests/mutants/sample.py table FILE
    python tests/mutants/sample.py changed [--base main] [--minutes 4]        mutants of changed lines, for .ci/run

One mutant costs a build of the crate and the tests of its room, so a room's score is that of a sample. FILE gets one JSON line
a mutant, and a run goes on where FILE ends: the sample is a function of the seed, the sources and the room. It needs cargo-mutants.
"""

import argparse
import json
import math
import pathlib
import random
import re
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
#: library tests that hold numbers of every fit
NUMBERS = ["hard_cases", "routes", "properties", "paper"]
#: room -> (files, filter of unit tests, library tests, program tests); the unit tests are those of the crate that the files stand in
ROOMS = {
    "certificate": (["src/fitting/fit/certificate/*.rs"], ["fit::"], NUMBERS + ["random_problems"], []),
    "solvers": (["src/numeric/solve/*.rs", "src/fitting/fit/linear/*.rs"], ["solve::", "fit::"], NUMBERS + ["random_problems"], []),
    "curvature": (["src/geometry/curvature/*.rs", "src/geometry/shape/maps.rs"], ["curvature::", "shape::"], NUMBERS, []),
    "noise": (["src/fitting/fit/noise/*.rs"], ["fit::"], NUMBERS + ["robust", "guide"], []),
    "intervals": (
        ["src/fitting/fit/describe/interval.rs", "src/fitting/fit/describe/uncertainty.rs"],
        ["fit::", "shape::"],
        NUMBERS + ["guide", "study"],
        [],
    ),
    "readers": (
        ["src/app/io/csv.rs", "src/app/io/np*.rs", "src/app/io/ply.rs", "src/app/io/columns.rs", "src/app/io/limits.rs", "src/app/io/clouds/*.rs"],
        ["io::"],
        [],
        ["readers", "files_as_they_come", "hostile", "npz", "fuzz_seeds", "cli_bad_input"],
    ),
}
#: the crates of the product
#: the build of a mutant takes the targets as well; their own code is compiled for speed of compiling, their dependencies as ever
CRATES = ["palpate", *(f"palpate-{name}" for name in ("numeric", "geometry", "world", "fitting", "inference", "studies", "app"))]
QUICK = [f"--cargo-arg=--config=profile.dev.package.{crate}.{what}" for crate in CRATES for what in ("opt-level=0", "debug=false")]
#: seconds for one mutant's build and tests; a mutant that never ends is caught by it
TIMEOUT = 300


def listed(files):
    """All mutants of these files, in the order of the sources."""
    command = ["cargo", "mutants", "--list", "--json"] + [word for f in files for word in ("-f", f)]
    return json.loads(subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout)


def crate(room):
    """The crate that the files of a room stand in."""
    return f"palpate-{ROOMS[room][0][0].split('/')[1]}"


def tests(room):
    """Targets that hold the room's tests, for the build too, and the filters that run them alone."""
    _, units, library, program = ROOMS[room]
    targets = ["--package=palpate", f"--package={crate(room)}", "--lib"] + (["--test=library"] if library else []) + (["--test=program"] if program else [])
    return [f"--cargo-arg={target}" for target in targets] + ["--", "--"] + units + [f"{name}::" for name in library + program]


def try_one(room, mutant):
    """`caught`, `missed`, `timeout` or `unviable`, and the seconds it took."""
    begin = time.monotonic()
    with tempfile.TemporaryDirectory() as out:
        command = ["cargo", "mutants", "--in-place", "--baseline", "skip", "--timeout", str(TIMEOUT), "--colors", "never",
                   "--output", out, "-f", mutant["file"], "--re", f"^{re.escape(mutant['name'])}$", *QUICK] + tests(room)
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
        path = pathlib.Path(out) / "mutants.out" / "outcomes.json"
        if not path.exists():
            sys.exit(f"cargo mutants failed:\n{done.stdout}\n{done.stderr}")
        outcomes = json.loads(path.read_text())
    words = {"caught": "caught", "missed": "missed", "timeout": "timeout", "unviable": "unviable"}
    for key, word in words.items():
        if outcomes.get(key):
            return word, time.monotonic() - begin
    sys.exit(f"no mutant of this name: {mutant['name']}\n{done.stdout}")


def sample(room, each, seed):
    """`each` mutants of the room in random order; a longer sample begins with the shorter one."""
    mutants = listed(ROOMS[room][0])
    random.Random(f"{seed} {room}").shuffle(mutants)
    return mutants[:each], len(mutants)


def run(arguments):
    """Tries the samples of all rooms in turn, one mutant of each room after another."""
    path, end = pathlib.Path(arguments.out), time.monotonic() + 60 * arguments.minutes
    done = {json.loads(line)["name"] for line in path.read_text().splitlines()} if path.exists() else set()
    rooms = [arguments.room] if arguments.room else list(ROOMS)
    samples = {room: sample(room, arguments.each, arguments.seed) for room in rooms}
    for turn in range(arguments.each):
        for room in rooms:
            mutants, of = samples[room]
            if turn >= len(mutants) or mutants[turn]["name"] in done:
                continue
            if time.monotonic() > end:
                return
            outcome, seconds = try_one(room, mutants[turn])
            line = {"room": room, "of": of, "seed": arguments.seed, "name": mutants[turn]["name"], "outcome": outcome,
                    "seconds": round(seconds, 1)}
            with path.open("a") as file:
                file.write(json.dumps(line) + "\n")
            print(room, outcome, f"{seconds:.0f} s", mutants[turn]["name"], flush=True)


def wilson(caught, tried):
    """Wilson's interval of 95 % for a share, in per cent."""
    if tried == 0:
        return 0.0, 100.0
    z, share = 1.96, caught / tried
    centre = (share + z * z / (2 * tried)) / (1 + z * z / tried)
    half = z / (1 + z * z / tried) * math.sqrt(share * (1 - share) / tried + z * z / (4 * tried * tried))
    return 100 * (centre - half), 100 * (centre + half)


def table(arguments):
    """One line a room, then the survivors."""
    lines = [json.loads(line) for line in pathlib.Path(arguments.file).read_text().splitlines()]
    print("| room | mutants | tried | unviable | caught | timed out | missed | score | interval of 95 % |\n|---|---|---|---|---|---|---|---|---|")
    for room in list(ROOMS) + ["all"]:
        of = [line for line in lines if room in (line["room"], "all")]
        count = {word: sum(line["outcome"] == word for line in of) for word in ("caught", "missed", "timeout", "unviable", "constant")}
        caught = count["caught"] + count["timeout"]
        viable = caught + count["missed"]
        whole = sum({line["room"]: line["of"] for line in of}.values())
        lo, hi = wilson(caught, viable)
        score = f"{100 * caught / viable:.0f} %" if viable else "-"
        print(f"| {room} | {whole} | {len(of)} | {count['unviable'] + count['constant']} | {count['caught']} | {count['timeout']} | {count['missed']} "
              f"| {score} | {lo:.0f} to {hi:.0f} % |")
    print("\nSurvivors:\n")
    for line in lines:
        if line["outcome"] == "missed":
            print(f"- `{line['name']}`")


def changed(arguments):
    """Mutants of the lines that differ from a branch; 1 if any survives."""
    diff = subprocess.run(["git", "diff", f"{arguments.base}...HEAD", "--", "src"], cwd=ROOT, capture_output=True, text=True)
    if diff.returncode or not diff.stdout.strip():
        return print(f"no line of src differs from {arguments.base}")
    with tempfile.NamedTemporaryFile("w", suffix=".diff") as file:
        file.write(diff.stdout)
        file.flush()
        command = ["cargo", "mutants", "--list", "--json", "--in-diff", file.name]
        mutants = json.loads(subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout or "[]")
    rooms = {room: [re.compile(f.replace(".", r"\.").replace("*", "[^/]*") + "$") for f in ROOMS[room][0]] for room in ROOMS}
    found = [(room, m) for m in mutants for room in rooms if any(f.match(m["file"]) for f in rooms[room])]
    random.Random(arguments.seed).shuffle(found)
    end, tried, missed = time.monotonic() + 60 * arguments.minutes, 0, []
    for room, mutant in found:
        if time.monotonic() > end:
            break
        outcome, _ = try_one(room, mutant)
        tried += 1
        missed += [mutant["name"]] if outcome == "missed" else []
    print(f"{len(found)} mutants of changed lines, {tried} tried, {len(missed)} missed")
    for name in missed:
        print(f"missed: {name}")
    sys.exit(1 if missed else 0)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    verbs = parser.add_subparsers(required=True)
    running = verbs.add_parser("run")
    running.add_argument("--out", required=True)
    running.add_argument("--each", type=int, default=10)
    running.add_argument("--room", choices=list(ROOMS))
    running.set_defaults(act=run)
    showing = verbs.add_parser("table")
    showing.add_argument("file")
    showing.set_defaults(act=table)
    changing = verbs.add_parser("changed")
    changing.add_argument("--base", default="main")
    changing.set_defaults(act=changed)
    for verb in (running, changing):
        verb.add_argument("--seed", type=int, default=1)
        verb.add_argument("--minutes", type=float, default=4.0)
    arguments = parser.parse_args()
    arguments.act(arguments)


if __name__ == "__main__":
    main()
