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


def numpy_peers():
    """The NumPy peers of benches/peers."""
    sys.path.insert(0, PEERS)
    import numpy_peers

    return numpy_peers


def w4_arrays():
    """x, y, z, zx, zy of w4's contacts without noise."""
    import numpy as np

    angle, x = math.radians(30), np.repeat([-4.0, 0.0, 4.0], 12)
    y = np.tile(np.repeat(np.linspace(-4, 4, 6), 2), 3)
    across = -x * math.sin(angle) + y * math.cos(angle)
    depth = np.sqrt(6.6**2 - across**2)
    return np.concatenate([x, y, depth - 6.6, across / depth * math.sin(angle), -across / depth * math.cos(angle)])


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
    run, _ = numpy_peers().w4_numpy(w4_arrays(), count=plain)
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
    """Replicates a second, one thread each. Fixed sites: palpate, the C++ and NumPy of benches/peers/compare.py, 100,000 at a
    time from the draws to intervals. Moving sites, one fit a replicate: palpate, a plain C++ loop, SciPy."""
    environment = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
    say = lambda *line: subprocess.run(line, check=True, capture_output=True, text=True, env=environment).stdout
    flags = "-O3 -march=native -mprefer-vector-width=512 -ffast-math -fopenmp -I/usr/include/eigen3".split()
    with tempfile.TemporaryDirectory() as folder:
        at = lambda name: os.path.join(folder, name)
        subprocess.run(["g++", *flags, os.path.join(PEERS, "cpp", "curvature.cpp"), "-o", at("noise"), "-lmvec", "-lm"], check=True)
        subprocess.run(["g++", *flags, os.path.join(HERE, "refits.cpp"), "-o", at("refits")], check=True)
        w4_arrays().tofile(at("w4.bin"))
        best = lambda text: 1e5 / min(float(line.split()[1]) for line in text.splitlines() if line.startswith("T "))
        peer = os.path.join(PEERS, "numpy_peers.py")

        def study(scene, replicates):
            words = ("study", scene, "--attribution", "0", "--replicates", replicates)
            document = palpate(*words, threads=1)[0]
            return document["replicates_per_second"], [document[q][k] for q in ("S", "R") for k in ("mean", "sd")]

        def refits(*line):
            words = [float(word) for word in say(*line).split()]
            return words[0], words[1:]

        ways = {
            "fixed sites, palpate": lambda: study(W4, 2_000_000),
            "fixed sites, C++": lambda: (best(say(at("noise"), "noise", at("w4.bin"), at("out"), "3")), []),
            "fixed sites, NumPy": lambda: (best(say(sys.executable, peer, "w4_numpy", at("w4.bin"), at("out"), "1")), []),
            "moving sites, palpate": lambda: study(MOVING, 50_000),
            "moving sites, C++ loop": lambda: refits(at("refits"), "50000"),
            "moving sites, SciPy": lambda: refits(sys.executable, os.path.join(HERE, "refits.py"), "2000"),
        }
        found = {name: [] for name in ways}
        for _ in range(options.runs):
            for name, run in ways.items():
                found[name].append(run())
    for name, runs in found.items():
        rates = [rate for rate, _ in runs]
        words = ""
        if runs[0][1]:
            words = "   S {:.4f} +- {:.4f}   R {:.5f} +- {:.5f}".format(*runs[0][1])
        print(f"{name:<24} {statistics.median(rates):>10.0f} a second ({min(rates):.0f} to {max(rates):.0f}){words}")


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
