"""Faults from outside, tried many times: what happened, and what was lost.

    python tests/faults/faults.py PROGRAM [--tries N] [--only WORD] [--record benches/runs/faults.md]

full disk, killed at any write, interrupted, two processes on one `--out`, a file that changes while it is read, little memory,
threads from 1 to 64, a clock that goes backwards (no clock of the day is read: a test of the sources says so).
A fault is lost work or half a file: an output that is neither the old nor the new one, an answer that differs from the
undisturbed one, a process that ends by a signal which nobody sent. Exit 1 if there is any. Unix only.
"""

import argparse
import json
import os
import pathlib
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

#: what each fault came to: name -> [tries, {what happened: how often}, losses]
TABLE = {}


def note(fault, happened, lost=None):
    """One try of a fault."""
    row = TABLE.setdefault(fault, [0, {}, []])
    row[0] += 1
    row[1][happened] = row[1].get(happened, 0) + 1
    if lost:
        row[2].append(lost)
        print(f"LOST in {fault}: {lost}", flush=True)


def run(program, here, *arguments, limits=(), environment=None, timeout=120):
    """Ends with the exit code (negative: the signal), standard output and standard error."""

    def limit():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        for kind, value in limits:
            resource.setrlimit(kind, (value, value))

    done = subprocess.run([program, *arguments], cwd=here, capture_output=True, text=True, preexec_fn=limit, timeout=timeout,
                          env={**os.environ, **(environment or {})})
    return done.returncode, done.stdout, done.stderr


def how(code):
    """An exit code in words."""
    return f"signal {-code}" if code < 0 else f"exit {code}"


def contacts(path, count=400):
    """A bowl with normals."""
    rows = ["x,y,z,nx,ny,nz"]
    rng = random.Random(7)
    for _ in range(count):
        x, y = rng.uniform(-4, 4), rng.uniform(-4, 4)
        rows.append(f"{x},{y},{0.05 * (x * x + y * y) + rng.gauss(0, 0.01)},{-0.1 * x},{-0.1 * y},1")
    path.write_text("\n".join(rows) + "\n")


def files(folder):
    """Names and bytes of a folder; None where there is none."""
    return {p.name: p.read_bytes() for p in sorted(folder.iterdir()) if p.is_file()} if folder.is_dir() else None


def steady(found):
    """The same without what a clock changes: seconds in fit.json."""
    if found is None or "fit.json" not in found:
        return found
    document = json.loads(found["fit.json"])
    document.pop("seconds", None)
    return {**found, "fit.json": json.dumps(document)}


def full_disk(program, here, tries):
    """A limit on the size of a file, from nothing to all that is written: each write fails somewhere else."""
    contacts(here / "c.csv")
    run(program, here, "fit", "c.csv", "--out", "whole", "--quiet")
    whole = files(here / "whole")
    most = max(len(v) for v in whole.values())
    for k in range(tries):
        shutil.rmtree(here / "d", ignore_errors=True)
        run(program, here, "fit", "c.csv", "--out", "d", "--quiet", "--degree", "2")
        before = files(here / "d")
        size = most * k // max(tries - 1, 1)
        code, _, message = run(program, here, "fit", "c.csv", "--out", "d", "--quiet", "--degree", "3", limits=[(resource.RLIMIT_FSIZE, size)])
        after = files(here / "d")
        lost = None
        if code not in (0, 1):
            lost = f"{how(code)} at {size} bytes: {message[:200]}"
        elif code == 1 and after != before:
            lost = f"exit 1 at {size} bytes and the folder has changed: {sorted(after)}"
        note("no room for a file of --out", how(code), lost)
    for k in range(tries):
        size = 4096 * k // max(tries - 1, 1)
        (here / "s.json").write_text("old")
        code, _, message = run(program, here, "fit", "c.csv", "--save", "s.json", "--quiet", limits=[(resource.RLIMIT_FSIZE, size)])
        text = (here / "s.json").read_text()
        broken = code not in (0, 1) or (code == 1 and text != "old") or (code == 0 and json.loads(text) is None)
        note("no room for --save", how(code), f"{how(code)} at {size}: {message[:200]}" if broken else None)
    leftovers = [p.name for p in here.rglob(".palpate-*")]
    if leftovers:
        note("no room for a file of --out", "left", f"unfinished files are left: {leftovers[:3]}")


STUDY = ["study", "paper-cylinder", "--replicates", "400000", "--seed", "5", "--json", "--quiet", "--path", "refit"]


def without_seconds(text):
    """A study's document without what a clock changes."""
    document = json.loads(text)
    for key in ("seconds", "replicates_per_second"):
        document.pop(key, None)
    return document


def killed(program, here, tries):
    """kill -9 while a study keeps checkpoints, then the study to its end: the same document."""
    code, whole, message = run(program, here, *STUDY)
    assert code == 0, message
    rng = random.Random(3)
    for word, which in (("kill -9", signal.SIGKILL), ("interrupt", signal.SIGINT)):
        (here / "check").unlink(missing_ok=True)
        (here / "records.csv").unlink(missing_ok=True)
        ended = 0
        for _ in range(tries):
            process = subprocess.Popen([program, *STUDY, "--checkpoint", "check"], cwd=here, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(rng.uniform(0.02, 1.6))
            process.send_signal(which)
            code = process.wait()
            ended += code == 0
            expected = (0, -9) if which == signal.SIGKILL else (0, 130)
            note(f"{word} in a study with a checkpoint", how(code), None if code in expected else how(code))
            if code == 0:
                (here / "check").unlink(missing_ok=True)
        code, after, message = run(program, here, *STUDY, "--checkpoint", "check")
        same = code == 0 and without_seconds(after) == without_seconds(whole)
        note(f"the study to its end after these ({word})", how(code), None if same else f"another answer: {message[:200]}")
    for word, which in (("kill -9", signal.SIGKILL), ("interrupt", signal.SIGINT)):
        contacts(here / "c.csv")
        shutil.rmtree(here / "d", ignore_errors=True)
        run(program, here, "fit", "c.csv", "--out", "d", "--quiet", "--degree", "2")
        old = steady(files(here / "d"))
        run(program, here, "fit", "c.csv", "--out", "new", "--quiet", "--degree", "3")
        new = steady(files(here / "new"))
        begin = time.monotonic()
        run(program, here, "fit", "c.csv", "--out", "new", "--quiet", "--degree", "3")
        length = time.monotonic() - begin
        for _ in range(2 * tries):
            process = subprocess.Popen([program, "fit", "c.csv", "--out", "d", "--quiet", "--degree", "3"], cwd=here, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(rng.uniform(0, 1.2 * length))
            process.send_signal(which)
            code = process.wait()
            found = steady(files(here / "d"))
            named = {k: v for k, v in (found or {}).items() if not k.startswith(".palpate-")}
            whole = [name for name in named if named[name] in (old.get(name), new.get(name))]
            lost = None if len(whole) == len(named) == len(new) else f"neither old nor new: {sorted(set(named) - set(whole))} of {sorted(named)}"
            mixed = named not in (old, new)
            left = any(p.name.startswith(".palpate-") for p in here.rglob(".palpate-*"))
            happened = f"{how(code)}{', files of both runs' if mixed and not lost else ''}{', an unfinished file left' if left else ''}"
            note(f"{word} while --out is written", happened, lost or ("an interrupt leaves an unfinished file" if left and which == signal.SIGINT else None))
            for path in here.rglob(".palpate-*"):
                shutil.rmtree(path) if path.is_dir() else path.unlink()


def together(program, here, tries):
    """Two processes on one --out: in the end the folder is one run's."""
    contacts(here / "c.csv")
    for degree in ("2", "3"):
        run(program, here, "fit", "c.csv", "--out", f"alone{degree}", "--quiet", "--degree", degree)
    alone = [steady(files(here / f"alone{degree}")) for degree in ("2", "3")]
    for _ in range(tries):
        shutil.rmtree(here / "d", ignore_errors=True)
        both = [subprocess.Popen([program, "fit", "c.csv", "--out", "d", "--quiet", "--degree", degree], cwd=here, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
                for degree in ("2", "3")]
        codes = sorted(p.wait() for p in both)
        found = steady(files(here / "d"))
        lost = None
        if found not in alone:
            torn = [n for n, v in (found or {}).items() if v not in (alone[0].get(n), alone[1].get(n))]
            lost = f"torn: {torn}" if torn or not found else "files of both runs"
        note("two processes on one --out", f"exits {codes[0]} and {codes[1]}", lost)


def changing(program, here, tries):
    """A file that grows, shrinks or is replaced while it is read."""
    rng = random.Random(11)
    contacts(here / "whole.csv", 60000)
    text = (here / "whole.csv").read_bytes()
    for _ in range(tries):
        (here / "c.csv").write_bytes(text)
        process = subprocess.Popen([program, "fit", "c.csv", "--json", "--bare", "--degree", "2"], cwd=here, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        time.sleep(rng.uniform(0, 0.05))
        act = rng.choice(["cut", "grow", "replace", "remove"])
        if act == "cut":
            os.truncate(here / "c.csv", rng.randrange(len(text)))
        elif act == "grow":
            with (here / "c.csv").open("ab") as file:
                file.write(text[:1000])
        elif act == "replace":
            (here / "other.csv").write_text("x,y,z\n1,2,three\n")
            os.replace(here / "other.csv", here / "c.csv")
        else:
            (here / "c.csv").unlink()
        out, _ = process.communicate(timeout=60)
        code = process.returncode
        sound = (code == 0 and json.loads(out)) or (code in (1, 2) and not out)
        note("a file that changes while it is read", how(code), None if sound else f"{act}: {how(code)}")


def little_memory(program, here, tries):
    """A limit on the address space: an error, an answer, or an end; never half an output."""
    contacts(here / "c.csv", 4000)
    run(program, here, "fit", "c.csv", "--out", "d", "--quiet")
    before = steady(files(here / "d"))
    run(program, here, "fit", "c.csv", "--out", "new", "--quiet", "--segments", "8")
    new = steady(files(here / "new"))
    for k in range(tries):
        size = int(8e6 * (50 ** (k / max(tries - 1, 1))))
        code, _, _ = run(program, here, "fit", "c.csv", "--out", "d", "--quiet", "--segments", "8", limits=[(resource.RLIMIT_AS, size)],
                         environment={"RAYON_NUM_THREADS": "2"})
        found = steady({k: v for k, v in files(here / "d").items() if not k.startswith(".palpate-")})
        lost = None if found in (before, new) else "the folder is of neither run"
        note("little memory (8 to 400 MB of addresses)", how(code), lost)
        if found == new:
            before = new


def threads(program, here, tries):
    """The same bits from 1 to 64 threads."""
    study = ["study", "paper-cylinder", "--replicates", "20000", "--seed", "5", "--json", "--quiet"]
    _, alone, _ = run(program, here, *study, environment={"RAYON_NUM_THREADS": "1"})
    for count in sorted({1 + k * 63 // max(tries - 1, 1) for k in range(tries)}):
        code, found, message = run(program, here, *study, environment={"RAYON_NUM_THREADS": str(count)})
        same = code == 0 and without_seconds(found) == without_seconds(alone)
        note("threads from 1 to 64", how(code), None if same else f"{count} threads: {message[:200]}")


FAULTS = {"disk": full_disk, "killed": killed, "together": together, "changing": changing, "memory": little_memory, "threads": threads}


def table():
    """The table of benches/runs/faults.md."""
    lines = ["| fault | tried | what happened | lost |", "|---|---|---|---|"]
    for fault, (tries, happened, lost) in TABLE.items():
        words = "; ".join(f"{word}: {count}" for word, count in sorted(happened.items(), key=lambda pair: -pair[1]))
        lines.append(f"| {fault} | {tries} | {words} | {'nothing' if not lost else f'{len(lost)}: {lost[0]}'} |")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--tries", type=int, default=20)
    parser.add_argument("--only", choices=list(FAULTS))
    parser.add_argument("--record")
    arguments = parser.parse_args()
    program = str(pathlib.Path(arguments.program).resolve())
    for name, fault in FAULTS.items():
        if arguments.only in (None, name):
            with tempfile.TemporaryDirectory() as folder:
                fault(program, pathlib.Path(folder), arguments.tries)
    print(table())
    if arguments.record:
        pathlib.Path(arguments.record).write_text(
            "# Faults\n\n`python tests/faults/faults.py target/release/palpate --tries "
            f"{arguments.tries} --record benches/runs/faults.md`\n\n{table()}\n")
    sys.exit(any(lost for _, _, lost in TABLE.values()))


if __name__ == "__main__":
    main()
