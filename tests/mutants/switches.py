"""The same sample of mutants as sample.py, all of them in one build, each behind a switch.

    python tests/mutants/switches.py --out FILE [--seed 1] [--each 40] [--room NAME]... [--minutes M]
    python tests/mutants/sample.py table FILE

A build for every mutant takes minutes, its tests take seconds. So all mutants of the sample are written into one copy of the
sources, `a + b` as `(match palpate_numeric::switched() { 17 => a - b, _ => a + b })`, the tests are built once, and PALPATE_MUTANT=17 turns
one on. What does not compile that way is taken out again: `unviable`, or `constant` where only a switch is not allowed, because the
place is evaluated by the compiler; those, fields left out of structs, and conditions with `let` are not tried. cargo-mutants lists
the mutants, and operands/ says where operands end. FILE gets one JSON line a mutant, and a run goes on where FILE ends.
"""

import argparse
import collections
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import threading
import time

import sample

ROOT = sample.ROOT
#: read once by every process; children of a test inherit it
SWITCH = """
/// The number of the mutant that is turned on.
pub fn switched() -> u32 {
    static ON: std::sync::OnceLock<u32> = std::sync::OnceLock::new();
    *ON.get_or_init(|| std::env::var("PALPATE_MUTANT").ok().and_then(|n| n.parse().ok()).unwrap_or(0))
}
"""
#: the crates compiled for speed of compiling, their dependencies as ever; nothing else is built with 256 units, so that cargo does
#: not take what is built here for the same sources elsewhere
QUICK = [word for crate in sample.CRATES for what in ("opt-level=0", "debug=false", "codegen-units=256")
         for word in ("--config", f"profile.dev.package.{crate}.{what}")]
TARGETS = [*(f"--package={crate}" for crate in sample.CRATES), "--lib", "--test", "library", "--test", "program"]
#: a mutant's tests may take so many times as long as without it, and so many seconds more
PATIENCE = (4, 20)


class Text:
    """A file's text with places as offsets."""

    def __init__(self, path):
        self.text = path.read_text()
        self.starts = [0]
        for line in self.text.splitlines(keepends=True):
            self.starts.append(self.starts[-1] + len(line))

    def at(self, line, column):
        return self.starts[line - 1] + column - 1

    def word(self, place):
        return self.at(*map(int, place.split(":")))


def operands(root, files):
    """kind -> file -> offset of the operator (of the pattern) -> offsets of the operands."""
    tool = ["cargo", "run", "--quiet", "--manifest-path", str(ROOT / "tests/mutants/operands/Cargo.toml"), "--target-dir",
            str(ROOT / "target/operands"), "--"]
    printed = subprocess.run(tool + files, cwd=root, check=True, capture_output=True, text=True).stdout
    texts = {file: Text(root / file) for file in files}
    found = collections.defaultdict(dict)
    for line in printed.splitlines():
        kind, file, *places = line.split()
        offsets = [texts[file].word(place) for place in places]
        found[kind, file][offsets[0]] = offsets[1:]
    return texts, found


def edits(texts, found, mutants):
    """file -> place -> what is written there, and the numbers that no switch can stand for."""
    nodes, untried = collections.defaultdict(dict), []

    def node(file, begin, end, write):
        # what is inserted comes first, then the outer ones
        place = (begin, end > begin, -end, ("return", "arm", "guard", "match").index(write))
        nodes[file].setdefault(place, {"range": (begin, end), "write": write, "mutants": {}})
        return nodes[file][place]["mutants"]

    for number, mutant in mutants.items():
        file, genre, new = mutant["file"], mutant["genre"], mutant["replacement"]
        text = texts[file]
        begin, end = (text.at(mutant["span"][k]["line"], mutant["span"][k]["column"]) for k in ("start", "end"))
        if genre == "BinaryOperator" and begin in found["binary", file]:
            l0, l1, r0, r1 = found["binary", file][begin]
            if "let " in text.text[l0:r1] and text.text[begin:end] in ("&&", "||"):
                untried.append(number)
                continue
            node(file, l0, r1, "match")[number] = f"{text.text[l0:l1]} {new} {text.text[r0:r1]}"
        elif genre == "UnaryOperator" and begin in found["unary", file]:
            r0, r1 = found["unary", file][begin]
            node(file, begin, r1, "match")[number] = text.text[r0:r1]
        elif genre == "FnValue":
            node(file, begin, begin, "return")[number] = new
        elif genre == "MatchArmGuard":
            node(file, begin, end, "guard")[number] = new
        elif genre == "MatchArm" and begin in found["arm", file]:
            pattern_end, *guard = found["arm", file][begin]
            if guard:
                node(file, guard[0], guard[1], "guard")[number] = "false"
            else:
                node(file, pattern_end, pattern_end, "arm")[number] = ""
        else:
            untried.append(number)
    return nodes, untried


def switch_of(file):
    """How the sources of a crate call the switch, which stands in the lowest one."""
    return "crate::switched()" if file.startswith("src/numeric/") else "palpate_numeric::switched()"


def rendered(text, nodes, switch):
    """The text with its switches, each mutant between marks that errors are found by."""
    places = [nodes[place] for place in sorted(nodes)]

    def piece(begin, end, k):
        """From begin to end with the nodes from number k on that lie inside; the next node's number."""
        out, at = [], begin
        while k < len(places) and places[k]["range"][0] < end:
            b, e = places[k]["range"]
            out.append(text[at:b])
            written, k = written_node(k)
            out.append(written)
            at = max(at, e)
        return "".join(out) + text[at:end], k

    def written_node(k):
        node = places[k]
        begin, end = node["range"]
        inner, after = piece(begin, end, k + 1) if end > begin else ("", k + 1)
        marked = {n: f"/*<{n}*/ {new} /*{n}>*/" for n, new in node["mutants"].items()}
        if node["write"] == "match":
            arms = "".join(f"{n} => {new}, " for n, new in marked.items())
            return f"(match {switch} {{ {arms}_ => {inner} }})", after
        if node["write"] == "return":
            return "".join(f"if {switch} == {n} {{ return {new}; }} " for n, new in marked.items()), after
        if node["write"] == "guard":
            for n, new in node["mutants"].items():
                on = f"{switch} == {n}"
                inner = f"/*<{n}*/ ({on} || ({inner})) /*{n}>*/" if new == "true" else f"/*<{n}*/ (!({on}) && ({inner})) /*{n}>*/"
            return inner, after
        return " if " + " && ".join(f"/*<{n}*/ {switch} != {n} /*{n}>*/" for n in node["mutants"]), after

    return piece(0, len(text) + 1, 0)[0]


def write(root, texts, found, mutants):
    nodes, untried = edits(texts, found, mutants)
    for file, text in texts.items():
        changed = rendered(text.text, nodes[file], switch_of(file)) if nodes[file] else text.text
        (root / file).write_text(changed)
    return untried


def to_blame(root, messages):
    """number -> `unviable` or `constant`: the mutants that the errors stand in or next to."""
    blamed = {}
    for message in messages:
        code = (message.get("code") or {}).get("code")
        for span in message["spans"]:
            path = root / span["file_name"]
            if not span["is_primary"] or not path.exists():
                continue
            text = path.read_bytes().decode()
            offset = len(path.read_bytes()[: span["byte_start"]].decode())
            marks = [(m.start(), text.index(f"/*{m[1]}>*/", m.start()), int(m[1])) for m in re.finditer(r"/\*<(\d+)\*/", text)]
            if not marks:
                continue
            far = lambda mark: max(mark[0] - offset, offset - mark[1], 0)
            least = min(map(far, marks))
            for mark in marks:
                if far(mark) == least:
                    blamed[mark[2]] = "constant" if code in ("E0015", "E0658") else "unviable"
    return blamed


def build(root, texts, found, mutants):
    """Binaries of the tests, and what became of the mutants that are not in them."""
    left, out = dict(mutants), {}
    environment = {**os.environ, "CARGO_TARGET_DIR": str(ROOT / "target"), "RUSTFLAGS": os.environ.get("RUSTFLAGS", "")}
    if not environment["RUSTFLAGS"]:
        del environment["RUSTFLAGS"]
    while True:
        for number in write(root, texts, found, left):
            out[number] = "constant"
            left.pop(number)
        command = ["cargo", "test", "--no-run", "--message-format=json", *QUICK, *TARGETS]
        done = subprocess.run(command, cwd=root, capture_output=True, text=True, env=environment)
        lines = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]
        if done.returncode == 0:
            names = {line["target"]["name"]: line["executable"] for line in lines if line.get("executable") and line["profile"]["test"]}
            names = {name.replace("_", "-"): path for name, path in names.items()}
            return names, left, out
        errors = [line["message"] for line in lines if line["reason"] == "compiler-message" and line["message"]["level"] == "error"]
        blamed = {n: word for n, word in to_blame(root, errors).items() if n in left}
        if not blamed:
            sys.exit("the switches do not compile:\n" + "\n".join(e["rendered"] for e in errors)[:4000] + done.stderr[-2000:])
        print(f"{len(errors)} errors, {len(blamed)} mutants taken out", flush=True)
        out.update(blamed)
        for number in blamed:
            left.pop(number)


def stages(room):
    """Binaries with their filters, the quickest first."""
    _, units, library, program = sample.ROOMS[room]
    named = [(sample.crate(room), units), ("library", [f"{m}::" for m in library]), ("program", [f"{m}::" for m in program])]
    return [(binary, filters) for binary, filters in named if filters]


def tried(root, binaries, room, number, limits):
    """Outcome, and the stage that noticed."""
    for k, (binary, filters) in enumerate(stages(room)):
        environment = {**os.environ, "PALPATE_MUTANT": str(number), "CARGO_MANIFEST_DIR": str(root)}
        running = subprocess.Popen([binaries[binary], *filters], cwd=root, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
                                   env=environment)
        alarm = threading.Timer(limits[room, k], running.kill)
        alarm.start()
        # the first failing test is enough
        failed = any("... FAILED" in line for line in running.stdout)
        if failed:
            running.kill()
        code = running.wait()
        late = not alarm.is_alive()
        alarm.cancel()
        if failed or (code and not late):
            return "caught", binary
        if late:
            return "timeout", binary
    return "missed", ""


def baseline(root, binaries, rooms):
    """Seconds that each stage of a room may take; ends where the tests fail without any mutant."""
    limits = {}
    for room in rooms:
        for k, (binary, filters) in enumerate(stages(room)):
            begin = time.monotonic()
            done = subprocess.run([binaries[binary], *filters], cwd=root, capture_output=True, text=True, env={**os.environ, "PALPATE_MUTANT": "0"})
            took = time.monotonic() - begin
            if done.returncode:
                sys.exit(f"{binary} {filters} fails without a mutant:\n{done.stdout[-3000:]}")
            limits[room, k] = PATIENCE[0] * took + PATIENCE[1]
            print(f"{room}: {binary} takes {took:.0f} s", flush=True)
    return limits


def run(arguments):
    path, end = pathlib.Path(arguments.out), time.monotonic() + 60 * arguments.minutes
    done = {json.loads(line)["name"] for line in path.read_text().splitlines()} if path.exists() else set()
    rooms = arguments.room or list(sample.ROOMS)
    samples = {room: sample.sample(room, arguments.each, arguments.seed) for room in rooms}
    # a mutant of every room in turn, so that a run that is cut short has tried as many of each
    order = [(room, samples[room][0][turn]) for turn in range(arguments.each) for room in rooms if turn < len(samples[room][0])]
    order = [(room, mutant) for room, mutant in order if mutant["name"] not in done]
    mutants = {number: mutant for number, (_, mutant) in enumerate(order, 1)}
    with tempfile.TemporaryDirectory() as holder:
        root = pathlib.Path(holder) / "copy"
        subprocess.run(["git", "worktree", "add", "--quiet", "--detach", str(root), "HEAD"], cwd=ROOT, check=True)
        try:
            attempt(arguments, root, path, end, rooms, samples, order, mutants)
        finally:
            subprocess.run(["git", "worktree", "remove", "--force", str(root)], cwd=ROOT, check=True)


def attempt(arguments, root, path, end, rooms, samples, order, mutants):
    texts, found = operands(root, sorted({mutant["file"] for mutant in mutants.values()}))
    library = root / "src/numeric/lib.rs"
    library.write_text(library.read_text() + SWITCH)
    begin = time.monotonic()
    binaries, left, out = build(root, texts, found, mutants)
    print(f"{len(left)} of {len(mutants)} mutants built in {time.monotonic() - begin:.0f} s", flush=True)
    limits = baseline(root, binaries, rooms)
    for number, (room, mutant) in enumerate(order, 1):
        if time.monotonic() > end:
            return
        begin = time.monotonic()
        outcome, noticed = tried(root, binaries, room, number, limits) if number in left else (out[number], "")
        line = {"room": room, "of": samples[room][1], "seed": arguments.seed, "name": mutant["name"], "outcome": outcome,
                "noticed": noticed, "seconds": round(time.monotonic() - begin, 1)}
        with path.open("a") as file:
            file.write(json.dumps(line) + "\n")
        print(room, outcome, noticed, f"{line['seconds']} s", mutant["name"], flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", required=True)
    parser.add_argument("--each", type=int, default=40)
    parser.add_argument("--room", choices=list(sample.ROOMS), action="append")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--minutes", type=float, default=60.0)
    run(parser.parse_args())


if __name__ == "__main__":
    main()
