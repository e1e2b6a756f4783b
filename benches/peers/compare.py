"""palpate and its peers in turn, in one session: ratios, spread, peak memory, agreement.

    python benches/peers/compare.py [--rounds 5] [--work w1,w2,...] [--threads 1,2] [--peers cpp,numpy] [--record benches/runs]

Builds `side_by_side` with cargo and the C++ peers with g++ (Eigen, OpenBLAS), writes the inputs once, then runs
palpate and one peer alternately, `--rounds` times, one process each. A ratio is palpate's best time of a round over the
peer's of the same round; the table shows its median and range over the rounds, so that a slow minute of the machine
hits both. A peer that cannot be built or started is named and left out.

What is best for one processor is slow on another. Each C++ peer is therefore built with every set of `FLAGS` and, where
it calls OpenBLAS, tried with every kernel of `KERNELS`; the quickest of them is the peer, and the table names it.
"""
import argparse
import datetime
import json
import os
import platform
import statistics
import subprocess
import sys
import tempfile

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
FLAGS = {
    "512": "-O3 -march=native -mprefer-vector-width=512 -ffast-math",
    "256": "-O3 -march=native -mprefer-vector-width=256 -ffast-math",
    "native": "-O3 -march=native -ffast-math",
    "O2": "-O2 -march=native -ffast-math",
    "v3": "-O3 -march=x86-64-v3 -ffast-math",
}
ALWAYS = "-fopenmp -I/usr/include/eigen3"
# OpenBLAS takes the kernels of the processor that it believes to run on; "" leaves that to it
KERNELS = ["", "Haswell", "Zen", "SkylakeX"]
CPP = {"paper": [], "scattered": ["-lopenblas"], "curvature": ["-lmvec", "-lm"]}

# workload: input, repetitions a round, C++ peer, NumPy peers (the first is the one of the goal)
WORK = {
    "w1": ("w1.bin", 15, ["paper", "{in}", "{out}", "{reps}"], ["w1_numpy", "w1_fitpack"]),
    "w2": ("w2.bin", 7, ["scattered", "{in}", "{out}", "{reps}", "64"], ["w2_scipy"]),
    "w2l": ("w2l.bin", 3, ["scattered", "{in}", "{out}", "{reps}", "128"], ["w2l_scipy"]),
    "w3_cold": ("w3.bin", 15, None, ["w3_cold"]),
    "w3_reused": ("w3.bin", 30, None, ["w3_reused"]),
    "w4": ("w4.bin", 5, ["curvature", "noise", "{in}", "{out}", "{reps}"], ["w4_numpy"]),
    "w5": ("w5.bin", 9, ["curvature", "map", "{in}", "{out}", "{reps}"], ["w5_numpy", "w5_scipy"]),
}
SLOW = {"w2_scipy": 1, "w2l_scipy": 1, "w4_numpy": 1, "w5_scipy": 2}

# best seconds recorded earlier on two cores of a Sapphire Rapids Xeon, by the scripts these peers are taken from
RECORDED = {
    ("w1", "cpp", 1): 3.36e-6, ("w1", "w1_numpy", 1): 6.46e-5, ("w1", "w1_fitpack", 1): 4.21e-5,
    ("w2", "cpp", 1): 0.0257, ("w2", "cpp", 2): 0.0216, ("w2", "w2_scipy", 1): 0.715,
    ("w2l", "cpp", 1): 0.228, ("w2l", "cpp", 2): 0.219, ("w2l", "w2l_scipy", 1): 3.58,
    ("w3_cold", "w3_cold", 1): 0.00584, ("w3_reused", "w3_reused", 1): 0.00165,
    ("w4", "cpp", 1): 0.132, ("w4", "cpp", 2): 0.081, ("w4", "w4_numpy", 1): 0.405,
    ("w5", "cpp", 1): 0.00981, ("w5", "cpp", 2): 0.00581, ("w5", "w5_numpy", 1): 0.0446, ("w5", "w5_scipy", 1): 0.078,
}


def build(directory):
    """Paths of what could be built: {"palpate": .., "paper": .., ..}."""
    command = ["cargo", "bench", "--locked", "--no-run", "--bench", "side_by_side", "--message-format=json"]
    lines = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout.splitlines()
    made = {}
    for message in map(json.loads, lines):
        if message.get("executable") and message.get("target", {}).get("name") == "side_by_side":
            made["palpate"] = message["executable"]
    for name, libraries in CPP.items():
        source = os.path.join(HERE, "cpp", name + ".cpp")
        made[name] = []
        for flags, words in FLAGS.items():
            target = os.path.join(directory, f"{name}-{flags}")
            command = ["g++", *words.split(), *ALWAYS.split(), source, "-o", target, *libraries]
            result = subprocess.run(command, capture_output=True, text=True)
            if result.returncode == 0:
                kernels = KERNELS if "-lopenblas" in libraries else [""]
                made[name] += [(" ".join(filter(None, (flags, kernel))), target, kernel) for kernel in kernels]
            else:
                print(f"left out: {name}.cpp with {words}: {result.stderr.splitlines()[:1]}", file=sys.stderr)
    return made


def run(command, threads, kernel=""):
    """Times, peak megabytes, megabytes after reading the input."""
    environment = dict(os.environ)
    for name in ("OMP", "OPENBLAS", "MKL"):
        environment[name + "_NUM_THREADS"] = str(threads)
    if os.path.basename(command[0]).startswith("scattered"):
        environment["OPENBLAS_NUM_THREADS"] = "1"  # two threads make pbtrf slower
    environment.pop("OPENBLAS_CORETYPE", None)
    if kernel:
        environment["OPENBLAS_CORETYPE"] = kernel
    result = subprocess.run(command, env=environment, capture_output=True, text=True)
    if result.returncode:
        raise RuntimeError(f"{' '.join(command)}: {result.stderr.strip()[-300:]}")
    fields = [line.split() for line in result.stdout.splitlines()]
    pick = lambda word: [float(f[1]) for f in fields if f[0] == word]
    return pick("T"), max(pick("RSS"), default=float("nan")), max(pick("BASE"), default=float("nan"))


def agreement(work, ours, theirs):
    """Largest differences of coefficients, S, R, each in its own measure."""
    a, b = np.fromfile(ours), np.fromfile(theirs)
    coefficients = lambda a, b: float(np.max(np.abs(a - b)) / np.max(np.abs(b)))
    curved = lambda a, b: float(np.max(np.abs(a - b) / np.maximum(b, b.max() / 100)))
    plain = lambda a, b: float(np.max(np.abs(a - b)))
    if work == "w1":
        return {"c": coefficients(a[:9], b[:9]), "S": plain(a[9:73], b[9:73]), "R": curved(a[73:], b[73:])}
    if work == "w5":
        n = len(a) // 2
        # S has no digits where both curvatures nearly vanish
        firm = b[n:] > b[n:].max() / 100
        return {"S": plain(a[:n][firm], b[:n][firm]), "R": curved(a[n:], b[n:])}
    if work == "w4":
        return {"six numbers": plain(a, b)}
    return {"c": coefficients(a, b)}


def filled(command, source, out, repetitions):
    """The command with its places for files and repetitions taken."""
    places = {"{in}": source, "{out}": out, "{reps}": str(repetitions)}
    return [places.get(part, part) for part in command]


def quickest(work, builds, arguments, threads, directory):
    """The build and the kernels that a C++ peer answers soonest with: (name, command, kernel), or None."""
    source, repetitions = os.path.join(directory, WORK[work][0]), WORK[work][1]
    tried = []
    for name, program, kernel in builds:
        command = filled([program, *arguments], source, os.path.join(directory, "theirs.bin"), repetitions)
        try:
            seconds = min(min(run(command, threads, kernel)[0]) for _ in range(2))
        except RuntimeError as fault:
            print(f"left out: {fault}", file=sys.stderr)
            continue
        tried.append((seconds, name, [program, *arguments], kernel))
    return min(tried)[1:] if tried else None


def peers_of(work, made, wanted, threads, directory):
    """(name, flags, command, kernel) of each peer."""
    _, _, cpp, numpy_peers = WORK[work]
    if cpp and "cpp" in wanted:
        best = quickest(work, made.get(cpp[0], []), cpp[1:], threads, directory)
        if best:
            yield ("cpp", *best)
    if "numpy" in wanted:
        for name in numpy_peers:
            yield name, "", [sys.executable, os.path.join(HERE, "numpy_peers.py"), name, "{in}", "{out}", "{reps}"], ""


def compare(work, peer, threads, made, directory, rounds):
    name, flags, command, kernel = peer
    source, repetitions = os.path.join(directory, WORK[work][0]), WORK[work][1]
    ours, theirs = os.path.join(directory, "ours.bin"), os.path.join(directory, "theirs.bin")
    palpate = [made["palpate"], work, "{in}", "{out}", "{reps}", str(threads), "--bench"]
    times, memory = {"palpate": [], "peer": []}, {}
    for _ in range(rounds):
        for who, parts, out, reps, kernels in (
            ("palpate", palpate, ours, repetitions, ""),
            ("peer", command, theirs, SLOW.get(name, repetitions), kernel),
        ):
            seconds, peak, base = run(filled(parts, source, out, reps), threads, kernels)
            times[who].append(seconds)
            memory[who] = (peak, peak - base)
    ratios = [min(p) / min(q) for p, q in zip(times["palpate"], times["peer"])]
    best = lambda who: min(map(min, times[who]))
    middle = lambda who: statistics.median(s for r in times[who] for s in r)
    return {
        "work": work, "peer": name, "flags": flags, "threads": threads, "rounds": rounds,
        "palpate": {"min": best("palpate"), "median": middle("palpate"), "peak_mb": memory["palpate"][0],
                    "above_input_mb": memory["palpate"][1]},
        "other": {"min": best("peer"), "median": middle("peer"), "peak_mb": memory["peer"][0],
                  "above_input_mb": memory["peer"][1], "recorded_min": RECORDED.get((work, name, threads))},
        "ratio": {"median": statistics.median(ratios), "min": min(ratios), "max": max(ratios)},
        "agreement": {} if name == "w1_fitpack" else agreement(work, ours, theirs),
        "raw": times,
    }


def seconds(value):
    if value is None:
        return ""
    for unit, size in (("s", 1), ("ms", 1e-3), ("us", 1e-6)):
        if value >= size:
            return f"{value / size:.3g} {unit}"
    return f"{value / 1e-9:.3g} ns"


HEADER = [
    "| work | peer | threads | palpate min (median) | peer min (median) | recorded | ratio | range | palpate above input | peer above input | differences |",
    "|---|---|---|---|---|---|---|---|---|---|---|",
]


def row(r):
    p, q, ratio = r["palpate"], r["other"], r["ratio"]
    size = lambda v: f"{v:.0f} MB" if v == v else ""
    return "| " + " | ".join([
        r["work"], " ".join(filter(None, (r["peer"], r["flags"]))), str(r["threads"]), f"{seconds(p['min'])} ({seconds(p['median'])})",
        f"{seconds(q['min'])} ({seconds(q['median'])})", seconds(q["recorded_min"]), f"**{ratio['median']:.2f}**",
        f"{ratio['min']:.2f} to {ratio['max']:.2f}", size(p["above_input_mb"]), size(q["above_input_mb"]),
        ", ".join(f"{k} {v:.0e}" for k, v in r["agreement"].items()),
    ]) + " |"


SCALING_HEADER = [
    "| work | one thread | two threads | times faster | range |",
    "|---|---|---|---|---|",
]


def scaling(work, made, directory, rounds):
    """Two threads against one: palpate alternates with itself; the ratio of the medians of a round, as above."""
    source, repetitions = os.path.join(directory, WORK[work][0]), 2 * WORK[work][1]
    answers = [os.path.join(directory, f"threads{t}.bin") for t in (1, 2)]
    times = {1: [], 2: []}
    for _ in range(rounds):
        for t in (1, 2):
            command = [made["palpate"], work, source, answers[t - 1], str(repetitions), str(t), "--bench"]
            times[t].append(run(command, t)[0])
    with open(answers[0], "rb") as one, open(answers[1], "rb") as two:
        same = one.read() == two.read()
    ratios = [statistics.median(a) / statistics.median(b) for a, b in zip(times[1], times[2])]
    middle = {t: statistics.median(s for r in times[t] for s in r) for t in times}
    return {"work": work, "rounds": rounds, "median": middle, "same_bits": same, "raw": times,
            "ratio": {"median": statistics.median(ratios), "min": min(ratios), "max": max(ratios)}}


def scaling_row(r):
    ratio = r["ratio"]
    return (f"| {r['work']} | {seconds(r['median'][1])} | {seconds(r['median'][2])} | **{ratio['median']:.2f}** "
            f"| {ratio['min']:.2f} to {ratio['max']:.2f}{'' if r['same_bits'] else ', BITS DIFFER'} |")


def machine():
    with open("/proc/cpuinfo") as info:
        model = next((line.split(":")[1].strip() for line in info if line.startswith("model name")), "unknown")
    say = lambda *c: subprocess.run(c, cwd=ROOT, capture_output=True, text=True).stdout.strip().splitlines()[:1]
    return {
        "date": datetime.date.today().isoformat(), "cpu": model, "cores": os.cpu_count(),
        "commit": "".join(say("git", "rev-parse", "--short", "HEAD")), "rustc": "".join(say("rustc", "--version")),
        "gxx": "".join(say("g++", "--version")), "gxx_flags": f"the quickest of {'; '.join(f'{k}: {v}' for k, v in FLAGS.items())}; all {ALWAYS.split()[0]}", "numpy": np.__version__,
        "system": platform.platform(), "load": os.getloadavg()[0],
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--work", default=",".join(WORK))
    parser.add_argument("--threads", default="1,2")
    parser.add_argument("--peers", default="cpp,numpy")
    parser.add_argument("--data", default=os.path.join(tempfile.gettempdir(), "palpate-peers"), help="inputs and C++ builds")
    parser.add_argument("--record", help="directory that takes DATE-cpu.json and .md")
    options = parser.parse_args()
    os.makedirs(options.data, exist_ok=True)
    made = build(options.data)
    if not os.path.exists(os.path.join(options.data, "w5.bin")):
        subprocess.run([sys.executable, os.path.join(HERE, "inputs.py"), options.data], check=True)
    about = machine()
    results, lines = [], [f"{k}: {v}  " for k, v in about.items()] + [""] + HEADER
    print("\n".join(lines), flush=True)
    for work in options.work.split(","):
        for threads in map(int, options.threads.split(",")):
            if threads > 1 and work.startswith("w3"):
                continue  # one thread's work
            for peer in peers_of(work, made, options.peers.split(","), threads, options.data):
                if threads > 1 and peer[0] != "cpp":
                    continue
                try:
                    results.append(compare(work, peer, threads, made, options.data, options.rounds))
                except RuntimeError as fault:
                    print(f"left out: {fault}", file=sys.stderr)
                    continue
                lines.append(row(results[-1]))
                print(lines[-1], flush=True)
    lines += ["", *SCALING_HEADER]
    print("\n".join(["", *SCALING_HEADER]), flush=True)
    scales = []
    for work in options.work.split(",") if "2" in options.threads.split(",") else []:
        if not work.startswith("w3"):
            scales.append(scaling(work, made, options.data, options.rounds))
            lines.append(scaling_row(scales[-1]))
            print(lines[-1], flush=True)
    if options.record:
        stem = os.path.join(options.record, f"{about['date']}-{'-'.join(about['cpu'].split()[:2]).lower().replace('(r)', '')}")
        with open(stem + ".json", "w") as out:
            json.dump({"about": about, "results": results, "scaling": scales}, out, indent=1)
        with open(stem + ".md", "w") as out:
            out.write("\n".join(["# Side by side", "", *lines]) + "\n")
        print("recorded", stem + ".json", stem + ".md")


if __name__ == "__main__":
    main()
