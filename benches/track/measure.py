"""What is measured of a commit: counts, criterion's benches, compile seconds, size, accuracy, and processor time beside its parent."""

import json
import os
import pathlib
import resource
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
# what a user types, from the shortest call to the longest; each is a fraction of a second
COMMANDS = {
    "named fit": ["run", "paper-cylinder", "--json"],
    "recognised": ["run", "bar", "--json"],
    "study": ["study", "paper-table2", "--replicates", "4000", "--attribution", "0", "--json"],
}
# scenes whose truth is known
ACCURACY = ["bar", "paper-cylinder", "paper-fig6-r8-degree3", "poor-normals"]


def said(*words, folder=ROOT, **more):
    """What a program prints; its failure is one of ours."""
    done = subprocess.run([str(word) for word in words], cwd=folder, capture_output=True, text=True, **more)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, words))}: {done.stderr.strip()[-2000:]}")
    return done.stdout


def commits(range_or_commit, last):
    """Full names, the oldest first; of a name without two dots the `last` ones up to it."""
    several = [range_or_commit] if ".." in range_or_commit else [f"-{last}", range_or_commit]
    return said("git", "rev-list", "--first-parent", "--reverse", *several).split()


def describe(commit):
    date, parent, subject = said("git", "show", "-s", "--format=%cI%x00%P%x00%s", commit).strip().split("\0")
    return {"commit": commit, "parent": (parent.split() or [""])[0], "date": date, "subject": subject}


def sources(commit):
    """Names by content of all that a program is compiled from: two commits that share them have the same one."""
    return said("git", "rev-parse", *(f"{commit}:{path}" for path in ("src", "Cargo.toml", "Cargo.lock")))


def build(commit, room):
    """The release program of a commit with the processor seconds of compiling its own crates. What is below them is compiled once."""
    tree, target = room / "trees" / commit, room / "target"
    if not tree.exists():
        said("git", "worktree", "add", "--detach", "--force", tree, commit)
    own = dict(os.environ, CARGO_TARGET_DIR=str(target), CARGO_INCREMENTAL="0")
    members = [path.parent for path in tree.glob("src/*/Cargo.toml")]
    names = ["palpate", *(f"palpate-{folder.name}" for folder in members)]
    seconds, compiled = timed_build(tree, own)
    # a tree of its own has all of its crates compiled; what else was compiled came with a new dependency, and is no part of the time
    if compiled != set(names):
        said("cargo", "clean", "--release", *(word for name in names for word in ("-p", name)), folder=tree, env=own)
        seconds, _ = timed_build(tree, own)
    program = room / "programs" / commit
    program.parent.mkdir(parents=True, exist_ok=True)
    program.write_bytes((target / "release" / "palpate").read_bytes())
    program.chmod(0o755)
    return {"program": program, "tree": tree, "env": own, "compile_seconds": round(seconds, 1)}


def timed_build(tree, own):
    """Processor seconds of a build, and the names of what was compiled in it: what else a machine does meanwhile is no part of them."""
    began = children_seconds()
    done = subprocess.run(
        ["cargo", "build", "--release", "--locked"], cwd=tree, env=own, capture_output=True, text=True
    )
    if done.returncode != 0:
        sys.exit(f"cargo build of {tree.name}: {done.stderr.strip()[-2000:]}")
    words = [line.split() for line in done.stderr.splitlines()]
    return children_seconds() - began, {line[1] for line in words if len(line) > 1 and line[0] == "Compiling"}


def children_seconds():
    """Processor seconds of all programs that were called and have ended."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def drop(tree):
    """Takes a tree away again."""
    said("git", "worktree", "remove", "--force", tree)


def processor_seconds(program, words):
    """Seconds that one call keeps a processor busy: those that it waits for others are not its own."""
    with open(os.devnull, "w") as nothing:
        child = subprocess.Popen([str(program), *words], stdout=nothing, stderr=nothing)
        _, status, usage = os.wait4(child.pid, 0)
    # the pid is gone, and Popen is told so
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode != 0:
        sys.exit(f"{program} {' '.join(words)} ended with {child.returncode}")
    return usage.ru_utime + usage.ru_stime


def paired(before, after, pairs):
    """Processor times of two calls in turn, the first one first in every other pair."""
    processor_seconds(*before), processor_seconds(*after)
    found = []
    for number in range(pairs):
        order = [before, after] if number % 2 == 0 else [after, before]
        times = [processor_seconds(*call) for call in order]
        found.append(times if number % 2 == 0 else times[::-1])
    return found


def accuracy(program):
    """Errors of S and of R on scenes whose truth is known."""
    found = {}
    for scene in ACCURACY:
        truth = json.loads(said(program, "run", scene, "--json"))["truth"]
        found.update({f"{scene}, {q}": truth[f"error_{q}"] for q in "SR" if truth[f"error_{q}"] is not None})
    return found


def counts(built):
    """What `cargo bench --bench counts` prints, whether or not it has grown."""
    done = subprocess.run(
        ["cargo", "bench", "--locked", "--bench", "counts"], cwd=built["tree"], env=built["env"], capture_output=True, text=True
    )
    return read_counts(done.stdout)


def read_counts(text):
    """The numbers in what the bench prints: a name and its count a line."""
    rows = [line.rsplit(None, 1) for line in text.splitlines()]
    return {row[0].strip(): int(row[1]) for row in rows if len(row) == 2 and row[1].isdigit()}


def criterion(built, benches):
    """Criterion's own estimate of the slope or mean of each bench, nanoseconds."""
    home = built["tree"] / "criterion"
    own = dict(built["env"], CRITERION_HOME=str(home))
    for bench in benches:
        said("cargo", "bench", "--locked", "--bench", bench, folder=built["tree"], env=own)
    found = {}
    for path in sorted(home.glob("**/new/estimates.json")):
        estimates = json.loads(path.read_text())
        found["/".join(path.relative_to(home).parts[:-2])] = (estimates.get("slope") or estimates["mean"])["point_estimate"]
    return found
