"""Random lines and broken files, tried thousands of times from a seed.

    python tests/faults/attacks.py PROGRAM [--seed N] [--lines 2000] [--files 3000] [--only NUMBER]

A line is a command with options drawn from its help, each with a sound, odd or wrong value. A file is a seed of the fuzz targets
with bytes, numbers or lines changed. A fault is an exit code other than 0, 1, 2 and 130, more than 10 s of one processor, more than
2 GB of memory, an input that was changed, an unfinished file, and a directory of --out with files of two runs. Exit 1 if there is
any. Unix only.
"""

import argparse
import collections
import os
import pathlib
import random
import re
import resource
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
SEEDS = ROOT / "fuzz" / "seeds"
SECONDS, BYTES = 10, 2 << 30
CODES = (0, 1, 2, 130)

BAR = """name = "a bar"
seed = 4
[surface]
kind = "cylinder"
radius = 25.0
axis_deg = 30.0
[sweep]
fingers = [-6.0, -3.0, 0.0, 3.0, 6.0]
from = -6.0
to = 6.0
stations = 6
[effects.position_noise]
sigma = 0.05
[effects.normal_noise]
sigma_deg = 3.0
"""

#: lines that options are put behind; each bounds how much work is asked for
LINES = [
    "fit bar.csv", "fit bar.csv", "fit bare.csv", "fit grid.npz", "fit bar.csv bare.csv", "fit dent.csv --degree 2", "fit dent.csv",
    "fit bar.csv --surface parametric", "run bar.toml", "run bar.toml", "simulate bar.toml -o new.csv", "simulate bar.toml --explain",
    "parts box.csv", "parts bare.csv", "parts parts-box", "study bar.toml --replicates 20", "study bar.toml --replicates 3 --coverage",
    "study bar.toml --replicates 5 --sweep surface.radius=20,30", "explore bar.toml --contacts 36", "frontier bar.csv --seconds 0.1",
    "frontier bar.toml --seconds 0.1", "show s.json", "show s.json --at at.csv", "diff s.json t.json", "merge p0 p1",
    "scenes", "scenes paper-plane", "explain R", "help fit", "completions zsh", "man",
]

#: values of options: sound ones, odd ones, wrong ones
NUMBERS = ["0", "1", "2", "3", "0.5", "-1", "1e-300", "1e300", "nan", "inf", "", "x", "-0"]
PAIRS = ["1", "2", "3", "2,3", "4x5", "9", "12", "0", "x", "1,1,1"]
PATHS = ["new.csv", "new.json", "new.npz", "new.ply", "new.step", "new.parquet", "bar.csv", "s.json", "bar.toml", "no/such/place.csv", "D", "-", ".", "D/fit.json"]
VALUES = {
    "--surface": ["height", "parametric", "auto", "x"], "--closed": ["u", "v", "u,v", "w"], "--degree": PAIRS, "--segments": PAIRS + ["20", "512"],
    "--domain": ["-9,9,-9,9", "-1,1,-1,1", "9,-9,0,1", "-1e300,1e300,-1,1", "0,1e-300,0,1"], "--weights": ["auto", "tangent", "position", "equal", "1,1,1", "0,0,0", "1e300,1,1"],
    "--sigma": ["auto", "0.02,5", "1e-300,5", "1e300,89", "0,0"], "--method": ["auto", "qr", "cholesky", "x"], "--smooth": ["none", "auto", "0.1", "1e300", "1e-300", "-1"],
    "--robust": ["none", "huber", "tukey", "x"], "--grid": ["5x6", "40", "1", "2", "0", "200x200", "99999"], "--inset": ["0", "0.2", "0.49", "0.5", "nan"],
    "--frame": ["auto", "keep", "x"], "--unit": ["mm", "furlong", "", "<b>"], "--pictures": ["svg", "png", "pdf", "svg,svg,png", "gif"], "--out": ["D", "D", "E", "bar.csv", "E/deep/er"],
    "--near": ["0,0,0,5", "0,0,0,1e300", "9,9,9,1e-9", "0,0,0,0"], "--box": ["-5,5,-5,5,-50,50", "5,-5,0,0,0,0", "-1e300,1e300,-1e300,1e300,-1e300,1e300"],
    "--normals": ["estimate", "x"], "--viewpoint": ["0,0,90", "0,0,-90", "0,0,0", "1e300,1e300,1e300"], "--intrinsics": ["500,500,20,20", "0,0,0,0", "1,1"],
    "--replicates": ["2", "30", "0", "-1"], "--rule": ["stein", "adaptive", "x"], "--range": ["0:5", "3:9", "5:5", "x"], "--quantity": ["k1", "radius", "S@0,1.5", "S@1e300,0", "x"],
    "--quantile": ["0.2", "0.05,0.5", "2", "x"], "--path": ["auto", "refit", "whole", "x"], "--attribution": ["0", "20", "-1"], "--tolerance": ["0", "1", "2", "1e300", "-1"],
    "--sweep": ["surface.radius=20,30", "sweep.stations=4,5", "no.such=1,2", "surface.radius=0:1:log5", "x"], "--budget": ["0.2", "1", "2ms", "0", "-1"],
    "--strategy": ["shape", "variance", "random", "x"], "--contacts": ["33", "31", "2", "0"], "--per-round": ["1", "5", "0"], "--reach": ["-3,3,-3,3", "50,60,50,60", "3,-3,0,1"],
    "--seconds": ["0.1", "0", "-1"], "--seed": ["0", "7", "18446744073709551615", "-1", "x"], "--level": ["0.5", "0.999999", "1e-9", "1", "0"],
    "--at": ["at.csv", "bar.csv", "none.csv", "-"],
}
for name in ("--save", "--table", "--points", "--output", "--part", "--records", "--checkpoint", "--emit"):
    VALUES[name] = PATHS

EXTREMES = [b"0", b"-0", b"1", b"1e308", b"-1e308", b"1e-308", b"nan", b"inf", b"99999999999999999999", b"4294967296", b"-1", b"1e9", b"0.5"]


class Attack:
    """One program, one folder of inputs, and what was found."""

    def __init__(self, program, here):
        self.program, self.here = program, here
        self.codes, self.faults, self.slowest, self.largest = collections.Counter(), [], (0.0, ""), (0, "")
        self.old = {}

    def run(self, arguments, folder):
        """Exit code (negative: the signal), seconds of processor and bytes of memory."""

        def limit():
            resource.setrlimit(resource.RLIMIT_CPU, (SECONDS + 2, SECONDS + 3))
            resource.setrlimit(resource.RLIMIT_AS, (4 * BYTES, 4 * BYTES))

        with open(folder / ".said", "wb") as said:
            child = subprocess.Popen([self.program, *arguments], cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=said, preexec_fn=limit,
                                     env={**os.environ, "RAYON_NUM_THREADS": "1"})
            _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        return child.returncode, usage.ru_utime + usage.ru_stime, usage.ru_maxrss << 10

    def judge(self, number, arguments, folder):
        """Runs the line in the folder and notes every fault but those of files."""
        code, seconds, size = self.run(arguments, folder)
        line = f"{number}: {' '.join(arguments)}"
        self.codes[code] += 1
        self.slowest, self.largest = max(self.slowest, (seconds, line)), max(self.largest, (size, line))
        if code not in CODES:
            said = (folder / ".said").read_text(errors="replace").strip()[-300:]
            self.fault(f"exit {code} after {seconds:.1f} s: {line}\n    {said}")
        elif seconds > SECONDS:
            self.fault(f"{seconds:.1f} s: {line}")
        if size > BYTES:
            self.fault(f"{size >> 20} MB: {line}")
        return code

    def fault(self, what):
        self.faults.append(what)
        print(f"FAULT {what}", flush=True)

    def options(self, verb):
        """Long names of the options that the help of a command shows."""
        said = subprocess.run([self.program, verb, "--help"], capture_output=True, text=True).stdout
        return re.findall(r"^ +(?:-[a-zA-Z], )?(--[a-z-]+)(?: |\[|$)", said, re.MULTILINE), set(re.findall(r"(--[a-z-]+) <", said))

    def of_an_earlier_run(self, line, folder):
        """Fills the directories of --out with files of the plain line, as an earlier run leaves them."""
        if line not in self.old:
            with tempfile.TemporaryDirectory() as room:
                fill(self.here, pathlib.Path(room))
                self.run([*line.split(), "--out", "D"], pathlib.Path(room))
                directory = pathlib.Path(room) / "D"
                self.old[line] = {p.name: p.read_bytes() for p in directory.iterdir()} if directory.is_dir() else {}
        if not self.old[line]:
            return
        (folder / "D").mkdir()
        for name, content in self.old[line].items():
            (folder / "D" / name).write_bytes(content)
            os.utime(folder / "D" / name, (1, 1))

    def line(self, number, rng):
        """One random line."""
        base = rng.choice(LINES)
        known, valued = self.options(base.split()[0]) if base.split()[0] not in self.known else self.known[base.split()[0]]
        self.known[base.split()[0]] = (known, valued)
        arguments = base.split()
        for option in rng.sample(known, min(len(known), rng.choice([1, 1, 2, 2, 3, 4, 6]))):
            if option not in ("--help",):
                arguments += [option, rng.choice(VALUES.get(option, NUMBERS))] if option in valued else [option]
        with tempfile.TemporaryDirectory() as room:
            folder = pathlib.Path(room)
            fill(self.here, folder)
            self.of_an_earlier_run(base, folder)
            code = self.judge(number, arguments, folder)
            # an output may replace what is no input of its line
            self.check_files(f"{number}: {' '.join(arguments)}", folder, (set(base.split()), code))

    def check_files(self, line, folder, ended):
        named, code = ended
        for path in self.here.iterdir():
            if path.name in named and (folder / path.name).read_bytes() != path.read_bytes():
                self.fault(f"the input {path.name} was changed: {line}")
        if code >= 0 and any(folder.rglob(".palpate-*")):
            self.fault(f"an unfinished file was left: {line}")
        if (folder / "D").is_dir():
            ages = {p.name: p.stat().st_mtime == 1 for p in (folder / "D").iterdir() if p.is_file()}
            kept, new = [n for n in ages if ages[n]], [n for n in ages if not ages[n]]
            # one output may be named into the directory
            if kept and len(new) > 1:
                self.fault(f"{sorted(kept)} of an earlier run beside {sorted(new)}: {line}")

    def broken(self, number, rng):
        """One broken file, given to a command that reads its kind."""
        kind = rng.choice(["contacts", "contacts", "clouds", "clouds", "scene", "surface", "cad"])
        seed = rng.choice(sorted((SEEDS / kind).iterdir()))
        # the first byte of a seed of clouds is the fuzz target's own
        content = seed.read_bytes()[1 if kind == "clouds" else 0:]
        content = mutated(content, rng)
        name = f"a{seed.suffix}"
        verbs = {
            "contacts": [f"fit {name}", f"fit {name} --skip-invalid", f"parts {name}", f"fit {name} --degree 2", f"parts {name} --points q.csv"],
            "clouds": [f"fit {name}", f"fit {name} --skip-invalid --intrinsics 600,600,320,240", f"parts {name}"],
            "scene": [f"run {name}", f"simulate {name} --out D", f"parts {name}", f"study {name} --replicates 3 --attribution 0"],
            "surface": [f"show {name}", f"show {name} --at at.csv", f"show {name} --save new.stl", f"diff {name} s.json"],
            "cad": [f"show {name}", f"show {name} --save new.json", f"diff {name} s.json"],
        }
        with tempfile.TemporaryDirectory() as room:
            folder = pathlib.Path(room)
            fill(self.here, folder)
            (folder / name).write_bytes(content)
            before = len(self.faults)
            self.judge(number, [*rng.choice(verbs[kind]).split(), "--quiet"], folder)
            if len(self.faults) > before:
                print(f"    of {seed.name}", flush=True)
            if (folder / name).read_bytes() != content:
                self.fault(f"{number}: the input was changed")

    known = {}


def mutated(content, rng):
    """The bytes with one to six changes."""
    data = bytearray(content)
    for _ in range(rng.choice([1, 1, 2, 3, 6])):
        at = rng.randrange(len(data) + 1)
        act = rng.randrange(7)
        if act == 0:
            data[at:at + 1] = bytes([rng.randrange(256)])
        elif act == 1:
            del data[at:at + rng.choice([1, 8, 100, len(data)])]
        elif act == 2:
            data[at:at] = bytes(rng.randrange(256) for _ in range(rng.choice([1, 4, 64])))
        elif act in (3, 4):
            numbers = list(re.finditer(rb"-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?", bytes(data)))
            if numbers:
                one = rng.choice(numbers)
                data[one.start():one.end()] = rng.choice(EXTREMES)
        else:
            lines = bytes(data).split(b"\n")
            k, m = rng.randrange(len(lines)), rng.randrange(len(lines))
            if act == 5:
                lines[k], lines[m] = lines[m], lines[k]
            else:
                lines.insert(m, lines[k])
            data = bytearray(b"\n".join(lines))
    return bytes(data)


def fill(here, folder):
    for path in here.iterdir():
        shutil.copyfile(path, folder / path.name)


def inputs(program, here):
    """What the lines name: a scene, contacts with and without normals, a grid, saved surfaces, parts of a study."""
    (here / "bar.toml").write_text(BAR)
    call = lambda *arguments: subprocess.run([program, *arguments], cwd=here, check=True, capture_output=True)
    call("simulate", "bar.toml", "-o", "bar.csv")
    rows = (here / "bar.csv").read_text().splitlines()
    (here / "bare.csv").write_text("".join(",".join(row.split(",")[:3]) + "\n" for row in rows))
    rng = random.Random(1)
    dent = [(rng.uniform(-4, 4), rng.uniform(-4, 4)) for _ in range(120)]
    (here / "dent.csv").write_text("x,y,z\n" + "".join(f"{x},{y},{0.05 * x * x - (x * x + y * y < 1)}\n" for x, y in dent))
    faces = [(u, v, 6, 0, 0, 1) for u in range(12) for v in range(12)] + [(12, v, 6 - u, 1, 0, 0) for u in range(12) for v in range(12)]
    (here / "box.csv").write_text("x,y,z,nx,ny,nz\n" + "".join(",".join(map(str, row)) + "\n" for row in faces))
    (here / "at.csv").write_text("x,y\n0.5,0.5\n")
    shutil.copyfile(SEEDS / "contacts" / "grid.npz", here / "grid.npz")
    call("fit", "bar.csv", "--degree", "2", "--save", "s.json")
    call("fit", "bare.csv", "--degree", "3", "--save", "t.json")
    for k in range(2):
        call("study", "bar.toml", "--replicates", "40", "--range", f"{20 * k}:{20 * k + 20}", "--part", f"p{k}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--lines", type=int, default=2000)
    parser.add_argument("--files", type=int, default=3000)
    parser.add_argument("--only", type=int, help="one number alone, of a line or of a file")
    arguments = parser.parse_args()
    program = str(pathlib.Path(arguments.program).resolve())
    failed = False
    for what, count, act in (("lines", arguments.lines, Attack.line), ("files", arguments.files, Attack.broken)):
        with tempfile.TemporaryDirectory() as room:
            here = pathlib.Path(room)
            inputs(program, here)
            attack = Attack(program, here)
            for number in range(count):
                if arguments.only in (None, number):
                    # every number has draws of its own, so that one of them can be tried again
                    act(attack, number, random.Random(f"{arguments.seed} {what} {number}"))
        codes = ", ".join(f"exit {code}: {n}" for code, n in sorted(attack.codes.items()))
        seconds, size = attack.slowest, attack.largest
        print(f"{what}: {sum(attack.codes.values())} tried; {codes}; {len(attack.faults)} faults")
        print(f"    slowest {seconds[0]:.1f} s of one processor ({seconds[1]}); largest {size[0] >> 20} MB ({size[1]})", flush=True)
        failed |= bool(attack.faults)
    sys.exit(failed)


if __name__ == "__main__":
    main()
