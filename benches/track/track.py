#!/usr/bin/env python3
"""How fast, large and accurate palpate is, commit by commit.

    python benches/track/track.py COMMIT|A..B [--last N] [--halve] [--file target/track/track.jsonl] [--page target/track/track.html]
    python benches/track/track.py --page FILE.html --only-page
    python benches/track/track.py --self-check PROGRAM [--record benches/runs]
    cargo bench --bench counts | python benches/track/track.py --counts -

Each commit is built in a tree of its own, and one JSON line is appended for it: counts (`cargo bench --bench counts`), criterion's benches
(`--criterion hot_path`), processor seconds of compiling its crates, bytes of the program, errors where the truth is known, and the
processor time of a few commands beside its parent's, in turn. A commit that has a line on this machine already is left out. The page
draws them all.

`--halve` measures both ends, and of every stretch whose ends differ by more than noise the commit in the middle, until each change lies
between two neighbours: of fifty commits that change little a handful is compiled, and none twice whose sources are the same. A run that
is ended goes on where it was. What lies between two that are alike is taken to be like them, so that a change that is taken back again in
between stays unseen.

`--counts FILE` appends a line of the counts alone that were printed for the commit that is checked out, as `.ci/run` does.
`--built COMMIT=PROGRAM` takes a program that is there, and leaves out what needs a build. `--self-check` compares a program a hundred times
with itself, and with itself doing 2 and 5 % more.
"""

import argparse
import json
import pathlib
import platform

import measure
from changes import of_counts, of_pairs
from page import page

PAIRS = 30
NULL_COMPARISONS = 100
# work that can be had by the per cent: so many replicates take some 50 ms, a third of which every process takes
STUDY = ["study", "paper-table2", "--attribution", "0", "--json", "--replicates"]
REPLICATES = 2000


def machine():
    lines = pathlib.Path("/proc/cpuinfo").read_text().splitlines() if pathlib.Path("/proc/cpuinfo").exists() else []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return f"{names[0] if names else platform.processor() or platform.machine()}, {len(names) or 1} processors"


def read(file):
    return [json.loads(line) for line in file.read_text().splitlines() if line.strip()] if file.exists() else []


def line_of(commit, built, before, arguments):
    """The line of a commit; `before` is the program of the one before it, where there is one."""
    line = {**measure.describe(commit), "machine": machine()}
    line["program_bytes"] = built["program"].stat().st_size
    line["accuracy"] = measure.accuracy(built["program"])
    if "tree" in built:
        line["compile_seconds"] = built["compile_seconds"]
        line["counts"] = measure.counts(built)
        line["criterion"] = measure.criterion(built, arguments.criterion)
    if before is not None:
        line["seconds"] = seconds(before, built["program"], arguments.pairs)
    return line


def seconds(before, after, pairs):
    """What the commands take of one program over another."""
    timed = lambda words: of_pairs(measure.paired((before, words), (after, words), pairs)).__dict__
    return {name: timed(words) for name, words in measure.COMMANDS.items()}


def differ(before, after):
    """Whether a number of two lines differs by more than noise; `after` holds the seconds of both."""
    both = [(before.get(kind, {}), after.get(kind, {})) for kind in ("counts", "accuracy")]
    exact = [of_counts(old[name], new[name]).alarm for old, new in both for name in old.keys() & new.keys()]
    return any(exact) or any(change["alarm"] for change in after["seconds"].values())


def halved(commits, measured, compared):
    """Lines of some of these commits, in order, so that no change lies within a stretch.

    `measured(commit)` is the line of a commit without seconds, `compared(a, b)` the seconds of b over those of a.
    """
    lines = {commit: measured(commit) for commit in {commits[0]: None, commits[-1]: None}}
    stretches = [(0, len(commits) - 1)] if len(commits) > 1 else []
    while stretches:
        first, last = stretches.pop()
        after = lines[commits[last]]
        after["seconds"] = compared(commits[first], commits[last])
        if last - first > 1 and differ(lines[commits[first]], after):
            middle = (first + last) // 2
            lines[commits[middle]] = measured(commits[middle])
            stretches += [(middle, last), (first, middle)]
    return [lines[commit] for commit in commits if commit in lines]


def track_halving(arguments):
    room = measure.ROOT / "target" / "track"
    programs = {}

    def measured(commit):
        line = known_line(commit, read(arguments.file), measure.sources, lambda known: (room / "programs" / known).exists())
        if line is not None:
            programs[commit] = room / "programs" / line["commit"]
            return {**line, **measure.describe(commit)}
        programs[commit] = room / "programs" / commit
        own = measure.build(commit, room)
        line = line_of(commit, own, None, arguments)
        # a run that is ended goes on from here
        append(arguments.file, line)
        measure.drop(own["tree"])
        print(commit[:9], line["subject"], flush=True)
        return line

    commits = measure.commits(arguments.commits, arguments.last)
    lines = halved(commits, measured, lambda a, b: seconds(programs[a], programs[b], arguments.pairs))
    others = [line for line in read(arguments.file) if line["commit"] not in programs]
    arguments.file.write_text("".join(json.dumps(line) + "\n" for line in [*others, *lines]))
    print(f"{len(lines)} of {len(commits)} commits measured")


def known_line(commit, lines, sources, has_program):
    """The line of this commit, or of another with the same sources, whose program is kept; None where there is none."""
    whole = [line for line in lines if is_whole(line) and has_program(line["commit"])]
    own = [line for line in whole if line["commit"] == commit]
    return next(iter(own), None) or next((line for line in whole if sources(line["commit"]) == sources(commit)), None)


def is_whole(line):
    """Whether a line is of this machine and more than counts, as the checks append them."""
    return line["machine"] == machine() and "program_bytes" in line


def track(arguments):
    room = measure.ROOT / "target" / "track"
    given = dict(word.split("=", 1) for word in arguments.built)
    given = {measure.said("git", "rev-parse", name).strip(): pathlib.Path(path) for name, path in given.items()}
    done = {line["commit"]: line for line in read(arguments.file) if is_whole(line)}
    programs = {}

    def built(commit):
        if commit in given:
            return {"program": given[commit]}
        return measure.build(commit, room)

    for commit in measure.commits(arguments.commits, arguments.last):
        if commit in done:
            continue
        own = built(commit)
        programs[commit] = own["program"]
        parent = measure.describe(commit)["parent"]
        before = programs.get(parent) or given.get(parent) or next(iter(room.glob(f"programs/{parent}")), None) if parent else None
        line = line_of(commit, own, before, arguments)
        append(arguments.file, line)
        if "tree" in own:
            measure.drop(own["tree"])
        print(commit[:9], line["subject"], flush=True)


def append(file, line):
    file.parent.mkdir(parents=True, exist_ok=True)
    with file.open("a") as out:
        out.write(json.dumps(line) + "\n")


def counted(counts):
    """The line of these counts, of what is checked out; edits that are not committed are said, for no commit has them."""
    commit = measure.said("git", "rev-parse", "HEAD").strip()
    line = {**measure.describe(commit), "machine": machine(), "counts": counts}
    return {**line, "edited": True} if measure.said("git", "status", "--porcelain", "--untracked-files=no").strip() else line


def self_check(program, pairs):
    """The program beside itself, and beside itself with 2 and 5 % more replicates; as lines of words."""
    call = lambda count: (program, [*STUDY, str(count)])
    alarms = sum(of_pairs(measure.paired(call(REPLICATES), call(REPLICATES), pairs)).alarm for _ in range(NULL_COMPARISONS))
    yield f"{NULL_COMPARISONS} comparisons of the program with itself, {pairs} pairs each: {alarms} alarms"
    # what a process does besides its replicates is no part of what grows
    rest = min(measure.processor_seconds(*call(1)) for _ in range(5))
    whole = min(measure.processor_seconds(*call(REPLICATES)) for _ in range(5))
    for more in (0.05, 0.02):
        count = round(REPLICATES * (1 + more * whole / (whole - rest)))
        found = of_pairs(measure.paired(call(REPLICATES), call(count), pairs))
        words = f"{100 * (found.ratio - 1):+.1f} % [{100 * (found.lo - 1):+.1f}, {100 * (found.hi - 1):+.1f}]"
        yield f"{100 * more:.0f} % more work planted: {words}, {'alarmed' if found.alarm else 'not alarmed'}"
    yield f"2 % more instructions planted: {'alarmed' if of_counts(1_000_000, 1_020_000).alarm else 'not alarmed'}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("commits", nargs="?", default="HEAD")
    parser.add_argument("--last", type=int, default=1, help="commits up to the one that is named")
    parser.add_argument("--halve", action="store_true", help="leave out what lies between two commits that are alike")
    parser.add_argument("--file", type=pathlib.Path, default=measure.ROOT / "target" / "track" / "track.jsonl")
    parser.add_argument("--page", type=pathlib.Path, default=measure.ROOT / "target" / "track" / "track.html")
    parser.add_argument("--only-page", action="store_true")
    parser.add_argument("--pairs", type=int, default=PAIRS)
    parser.add_argument("--criterion", nargs="*", default=["hot_path"])
    parser.add_argument("--built", nargs="*", default=[], metavar="COMMIT=PROGRAM")
    parser.add_argument("--counts", type=argparse.FileType())
    parser.add_argument("--self-check", type=pathlib.Path, metavar="PROGRAM")
    parser.add_argument("--record", type=pathlib.Path)
    arguments = parser.parse_args()
    if arguments.self_check:
        lines = [f"on {machine()}"]
        for line in self_check(arguments.self_check, arguments.pairs):
            print(line, flush=True)
            lines.append(line)
        if arguments.record:
            command = "python benches/track/track.py --self-check target/release/palpate --record benches/runs"
            text = f"# Does the tracking tell a change from noise?\n\n`{command}`\n\n```text\n" + "\n".join(lines) + "\n```\n"
            (arguments.record / "track.md").write_text(text)
        return
    if arguments.counts:
        append(arguments.file, counted(measure.read_counts(arguments.counts.read())))
    elif not arguments.only_page:
        (track_halving if arguments.halve else track)(arguments)
    lines = read(arguments.file)
    if lines:
        arguments.page.parent.mkdir(parents=True, exist_ok=True)
        arguments.page.write_text(page(lines))
        print(f"{len(lines)} commits in {arguments.page}")


if __name__ == "__main__":
    main()
