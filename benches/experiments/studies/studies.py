"""Figures of `palpate study`: what two digits take, whether stated errors are true, whether parts are the whole.

    python benches/experiments/studies/studies.py digits [--runs 20]
    python benches/experiments/studies/studies.py endpoints [--seeds 1000] [--reference 100000000]
    python benches/experiments/studies/studies.py parts [--replicates 100000000] [--parts 100]
    python benches/experiments/studies/studies.py throughput [--runs 5]

All run `target/release/palpate` (`cargo build --release`), or the program that PALPATE names. `digits` and `throughput` need
NumPy, the latter SciPy and g++ too. `benches/runs/studies.md` keeps a run of each.
"""
import argparse
import json
import math
import os
import random
import resource
import statistics
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
PEERS = os.path.join(ROOT, "benches", "peers")
PALPATE = os.environ.get("PALPATE", os.path.join(ROOT, "target", "release", "palpate"))
W4 = os.path.join(HERE, "w4.toml")
MOVING = os.path.join(HERE, "moving.toml")
ENDS = [(q, end) for q in ("S", "R") for end in ("lo", "hi")]


def palpate(*words, threads=None):
    """The JSON document, seconds of the whole process, seconds of its processors."""
    environment = dict(os.environ, **({"RAYON_NUM_THREADS": str(threads)} if threads else {}))
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    out = subprocess.run([PALPATE, *map(str, words), "--json"], check=True, capture_output=True, env=environment).stdout
    wall, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    return json.loads(out), wall, after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def delta(u, digits):
    """The error that so many significant digits of u allow: JCGM 101, 7.9.2."""
    exponent = math.floor(math.log10(u)) - (digits - 1)
    if round(u / 10**exponent) >= 10**digits:
        exponent += 1
    return 0.5 * 10**exponent


def spread(name, seconds, processor):
    milli = [1e3 * s for s in seconds]
    print(f"{name:<28} least {min(milli):7.1f} ms   median {statistics.median(milli):7.1f} ms   processor {1e3 * statistics.median(processor):7.1f} ms")


def digits(options):
    """Time to two digits of both ends of S and R: with the control, by plain Monte Carlo, by NumPy."""
    study = ("study", W4, "--attribution", "0")
    document, _, _ = palpate(*study, "--tolerance", "2")
    # what Stein's rule wants on average without the control: t(9) and the spread of a quantile of a normal law
    end = math.sqrt(0.025 * 0.975) / (math.exp(-0.5 * 1.959964**2) / math.sqrt(2 * math.pi))
    plain = max((2.262157 * end * document[q]["sd"] / delta(document[q]["sd"], 2)) ** 2 for q in ("S", "R"))
    plain = 10_240 * math.ceil(plain / 10_240)
    print(f"two digits: {document['replicates']} replicates with the control, {plain} without (Stein's rule, mean of its first stage)")
    ways = {"with the control": ("--tolerance", "2"), "plain Monte Carlo": ("--replicates", plain), "start and end alone": ("--replicates", 1)}
    found = {name: [] for name in ways}
    for _ in range(options.runs):
        for name, words in ways.items():
            found[name].append(palpate(*study, *words)[1:])
    for name, pairs in found.items():
        spread(name, *zip(*pairs))
    sys.path.insert(0, PEERS)
    import numpy as np
    import numpy_peers

    angle, x = math.radians(30), np.repeat([-4.0, 0.0, 4.0], 12)
    y = np.tile(np.repeat(np.linspace(-4, 4, 6), 2), 3)
    across = -x * math.sin(angle) + y * math.cos(angle)
    depth = np.sqrt(6.6**2 - across**2)
    data = np.concatenate([x, y, depth - 6.6, across / depth * math.sin(angle), -across / depth * math.cos(angle)])
    run, _ = numpy_peers.w4_numpy(data, count=plain)
    times = []
    for _ in range(3):
        start, used = time.perf_counter(), time.process_time()
        run()
        times.append((time.perf_counter() - start, time.process_time() - used))
    spread("NumPy, plain, arrays only", *zip(*times))


def endpoints(options):
    """Over many seeds: is each stated error of an end true?"""
    study = ("study", W4, "--attribution", "0")
    reference = palpate(*study, "--replicates", options.reference, "--seed", 0)[0]
    held = {end: [0, 0] for end in ENDS}
    every, replicates = 0, []
    for seed in range(1, options.seeds + 1):
        document = palpate(*study, "--tolerance", "2", "--seed", seed)[0]
        replicates.append(document["replicates"])
        true = True
        for q, end in ENDS:
            off = abs(document[q][end] - reference[q][end])
            within = off <= delta(document[q]["sd"], 2)
            held[q, end][0] += within
            held[q, end][1] += off <= 1.96 * document[q]["standard_error"][end]
            true &= within
        every += true
    print(f"{options.seeds} seeds, reference of {options.reference} replicates; replicates a seed: "
          f"median {statistics.median(replicates):.0f}, {min(replicates)} to {max(replicates)}")
    for (q, end), (within, errors) in held.items():
        print(f"{q} {end}: within the tolerance {within} of {options.seeds}, within 1.96 standard errors {errors}")
    print(f"all four within the tolerance: {every} of {options.seeds}")


def parts(options):
    """One thread, two threads and parts merged in random order: the same document but for the clock."""
    study = ("study", W4, "--attribution", "0", "--replicates", options.replicates)
    bare = lambda document: {k: v for k, v in document.items() if k not in ("seconds", "replicates_per_second")}
    whole, wall, _ = palpate(*study)
    print(f"{options.replicates} replicates, all threads: {wall:.1f} s")
    one, wall, _ = palpate(*study, threads=1)
    print(f"one thread: {wall:.1f} s, the same document: {bare(one) == bare(whole)}")
    with tempfile.TemporaryDirectory() as folder:
        cuts = sorted({0, options.replicates, *random.Random(17).sample(range(1, options.replicates), options.parts - 1)})
        files = []
        for k, (a, b) in enumerate(zip(cuts, cuts[1:])):
            files.append(os.path.join(folder, f"part{k}"))
            palpate(*study, "--range", f"{a}:{b}", "--part", files[-1])
        random.Random(18).shuffle(files)
        merged, wall, _ = palpate("merge", *files)
        size = sum(map(os.path.getsize, files)) / 1e6
    print(f"{options.parts} parts ({size:.0f} MB) merged in {wall:.1f} s, the same document: {bare(merged) == bare(whole)}")
    print(f"largest process: {resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024:.1f} MB")


def throughput(options):
    """Fits a second where sites move: palpate, a plain C++ loop, NumPy with SciPy's splines; one thread each."""
    with tempfile.TemporaryDirectory() as folder:
        loop = os.path.join(folder, "refits")
        flags = "-O3 -march=native -ffast-math -I/usr/include/eigen3".split()
        subprocess.run(["g++", *flags, os.path.join(HERE, "refits.cpp"), "-o", loop], check=True)
        found = {"palpate": [], "C++ loop": [], "SciPy": []}
        answers = {}
        for _ in range(options.runs):
            document, _, _ = palpate("study", MOVING, "--attribution", "0", "--replicates", 50_000, threads=1)
            found["palpate"].append(document["replicates_per_second"])
            answers["palpate"] = [document[q][k] for q in ("S", "R") for k in ("mean", "sd")]
            for name, line in (("C++ loop", [loop, "50000"]), ("SciPy", [sys.executable, os.path.join(HERE, "refits.py"), "2000"])):
                environment = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
                words = subprocess.run(line, check=True, capture_output=True, text=True, env=environment).stdout.split()
                found[name].append(float(words[0]))
                answers[name] = [float(word) for word in words[1:]]
        for name, rates in found.items():
            mean_s, sd_s, mean_r, sd_r = answers[name]
            print(f"{name:<10} {statistics.median(rates):>10.0f} fits a second ({min(rates):.0f} to {max(rates):.0f})   "
                  f"S {mean_s:.4f} +- {sd_s:.4f}   R {mean_r:.5f} +- {sd_r:.5f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["digits", "endpoints", "parts", "throughput"])
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--seeds", type=int, default=1000)
    parser.add_argument("--reference", type=int, default=100_000_000)
    parser.add_argument("--replicates", type=int, default=100_000_000)
    parser.add_argument("--parts", type=int, default=100)
    options = parser.parse_args()
    print(f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors")
    globals()[options.what](options)


if __name__ == "__main__":
    main()
