"""Real patches with a truth: palpate's default answer beside what others answer, one table from one run.

    python benches/peers/patches.py DIR [--palpate PATH] [--variants] [--markdown OUT]
        [--crops N] [--truth-u KIND=PERCENT ...] [--only WORD] [--peers NAME,... | none]

DIR holds contact files and a `truth.jsonl`; the README beside this script says what stands in them. palpate gets the
file and nothing else: `palpate fit FILE --json`. Only the robust fit is told whether the truth is a sphere or a cylinder.
An interval of R "with the truth's" is widened by the truth's own uncertainty: 1.96 u of R is added in quadrature.

Seconds of palpate are wall time of the whole process, reading included; those of a peer are from arrays in memory.
A missing radius counts as an infinite error, a refusal as a wrong class and as intervals that do not hold.
"""
import argparse
import importlib.util
import os
import statistics
import sys
import time

import patch_crops
import patch_data
import patch_peers
import patch_run
import patch_variants

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
WIDENED = "R with the truth's"


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("directory", metavar="DIR")
    target = os.environ.get("CARGO_TARGET_DIR", os.path.join(ROOT, "target"))
    parser.add_argument("--palpate", default=os.path.join(target, "release", "palpate"))
    parser.add_argument("--variants", action="store_true", help="each patch turned, scaled, shuffled, thinned")
    parser.add_argument("--crops", type=int, default=0, metavar="N", help="N parts of each size of each patch")
    parser.add_argument("--markdown", metavar="OUT", help="file that takes what is printed")
    parser.add_argument("--truth-u", action="append", default=[], metavar="KIND=PERCENT",
                        help="standard uncertainty of the true radius of all patches of a class")
    parser.add_argument("--only", help="a word in the file's name")
    parser.add_argument("--peers", help="names of peers, by commas, or none")
    return parser.parse_args()


class Printer:
    """Prints lines at once and keeps them for a file."""

    def __init__(self):
        self.lines = []

    def __call__(self, line=""):
        self.lines.append(line)
        print(line, flush=True)


def said(word):
    print(f"left out: {word}", file=sys.stderr, flush=True)


def patches_of(options):
    """The patches that are there; a missing or unreadable file is named and left out."""
    patches = []
    for truth in patch_data.read_truth(options.directory):
        if options.only and options.only not in truth["file"]:
            continue
        try:
            patches.append(patch_data.read_patch(options.directory, truth))
        except (OSError, ValueError, KeyError) as fault:
            said(f"{truth['file']}: {fault}")
    return patches


def peers_of(options):
    """The peers asked for whose modules are here; the others are named and left out."""
    wanted = patch_peers.PEERS
    if options.peers:
        names = [] if options.peers == "none" else options.peers.split(",")
        for name in set(names) - set(wanted):
            sys.exit(f"patches.py: no peer {name!r}; there are {', '.join(wanted)}")
        wanted = {name: wanted[name] for name in names}
    peers = {}
    for name, (work, modules) in wanted.items():
        missing = [module for module in modules if importlib.util.find_spec(module) is None]
        if missing:
            said(f"{name}: no Python module {', '.join(missing)}")
        else:
            peers[name] = work
    return peers


def uncertainties(options):
    """Relative standard uncertainties of the true radius by class, from --truth-u."""
    found = {}
    for word in options.truth_u:
        kind, _, percent = word.partition("=")
        try:
            found[kind] = float(percent) / 100
        except ValueError:
            sys.exit(f"patches.py: --truth-u {word}: expected KIND=PERCENT, as in rut=3")
        if kind not in patch_data.CLASSES:
            sys.exit(f"patches.py: --truth-u {word}: no class {kind!r}; there are {', '.join(patch_data.CLASSES)}")
    return found


def truth_u(patch, by_kind):
    """Relative standard uncertainty of the true radius: of the file's line, else of its class, else of its scatter.

    The scatter of the whole body about its best sphere or cylinder says how far that body has one radius at all.
    """
    if "radius_u" in patch.truth:
        return float(patch.truth["radius_u"]) / patch.radius
    return by_kind.get(patch.kind, float(patch.truth.get("scatter", 0.0)) / patch.radius)


def judge(patch, found, relative_u):
    """What the summary counts of palpate's answer."""
    margin = 1.96 * relative_u * patch.curvedness
    return {
        "class": found.kind == patch.kind,
        "error": abs(found.radius / patch.radius - 1) if found.radius else float("inf"),
        "S": patch_run.holds(found.S_interval, patch.truth["S"]),
        "R": patch_run.holds(found.R_interval, patch.curvedness),
        WIDENED: patch_run.holds(found.R_interval, patch.curvedness, margin),
        "seconds": found.seconds,
    }


def number(value, digits=4):
    return "-" if value is None else f"{value:.{digits}g}"


def span(interval):
    return "-" if interval is None else f"{interval[0]:.4g} to {interval[1]:.4g}"


def percent(radius, truth):
    return "-" if not radius else f"{100 * (radius / truth - 1):+.1f} %"


def yes(value):
    return "yes" if value else "no"


def palpate_row(patch, found, judged):
    head = f"| {patch.name} | {len(patch.points)} | {patch.kind}, {number(patch.radius)} | palpate |"
    if found.refused:
        return f"{head} refused: {found.refused} | - | - | - | - | - | - | {found.seconds:.2f} |"
    R_held = yes(judged["R"]) + (" (with the truth's: yes)" if judged[WIDENED] and not judged["R"] else "")
    return (
        f"{head} {found.kind} | {number(found.S)} [{span(found.S_interval)}] | {yes(judged['S'])} "
        f"| {number(found.radius)} | {percent(found.radius, patch.radius)} "
        f"| {number(found.R)} [{span(found.R_interval)}] | {R_held} | {found.seconds:.2f} |"
    )


def peer_row(patch, name, work):
    """A peer's line, and what the summary counts; one that does not answer says so in its line."""
    head = f"| | | | {name} |"
    start = time.perf_counter()
    try:
        answer = work(patch)
    except Exception as fault:  # whatever a library throws is its answer to this patch
        seconds = time.perf_counter() - start
        row = f"{head} no answer: {fault} | - | - | - | - | - | - | {seconds:.2f} |"
        return row, {"class": False, "error": float("inf"), "R": None, "seconds": seconds}
    seconds = time.perf_counter() - start
    kind = "told" if answer.S is None else patch_data.class_of(answer.S)
    ends = R_of(patch, answer.interval)
    held = patch_run.holds(ends, patch.curvedness) if ends else None
    row = (
        f"{head} {kind} | {number(answer.S)} | - | {number(answer.radius)} | {percent(answer.radius, patch.radius)} "
        f"| {'[' + span(ends) + ']' if ends else '-'} | {yes(held) if ends else '-'} | {seconds:.2f} |"
    )
    right = answer.S is None or kind == patch.kind
    error = abs(answer.radius / patch.radius - 1) if answer.radius else float("inf")
    return row, {"class": right, "told": answer.S is None, "error": error, "R": held, "seconds": seconds}


def R_of(patch, interval):
    """An interval of the radius as one of R."""
    if interval is None:
        return None
    factor = patch.radius * patch.curvedness
    return factor / interval[1], factor / interval[0]


def median(errors):
    value = statistics.median(errors)
    return "infinite" if value == float("inf") else f"{100 * value:.2f} %"


def summary(name, judged, out):
    count = len(judged)
    if not count:
        return
    of = lambda key: f"{sum(bool(j[key]) for j in judged)} of {count}"
    answered = [j["error"] for j in judged if j["error"] < float("inf")]
    slowest = max(j["seconds"] for j in judged)
    words = ["told the surface" if any(j.get("told") for j in judged) else f"class right {of('class')}"]
    words.append(f"median error of the radius {median([j['error'] for j in judged])}")
    if len(answered) < count:
        words.append(f"a radius in {len(answered)} of {count}" + (f", median {median(answered)}" if answered else ""))
    if "S" in judged[0]:
        words += [f"R held {of('R')}", f"with the truth's {of(WIDENED)}", f"S held {of('S')}"]
        words += [f"turned alike {of('turned')}"] if "turned" in judged[0] else []
    elif any(j["R"] is not None for j in judged):
        words.append(f"R held {of('R')}")
    out(f"- {name}: {'; '.join(words)}; slowest {slowest:.2f} s")


def compare(options, patches, peers, by_kind, out):
    """The table; returns palpate's answers by file."""
    out("| patch | contacts | truth | tool | class | S [interval] | S held | radius | error | R [interval] | R held | s |")
    out("|---|---|---|---|---|---|---|---|---|---|---|---|")
    found, tally = {}, {name: [] for name in ("palpate", *peers)}
    words = []
    for patch in patches:
        answer = patch_run.palpate(options.palpate, patch.path)
        found[patch.name] = answer
        judged = judge(patch, answer, truth_u(patch, by_kind))
        tally["palpate"].append(judged)
        out(palpate_row(patch, answer, judged))
        words += [f"- {patch.name}: {w}" for w in (answer.why, answer.lack_of_fit, *answer.notes) if w]
        for name, work in peers.items():
            row, judged = peer_row(patch, name, work)
            tally[name].append(judged)
            out(row)
    out()
    for name, judged in tally.items():
        summary(name, judged, out)
    out()
    for line in words:
        out(line)
    return found


def work(options):
    out = Printer()
    if not os.path.isfile(options.palpate):
        sys.exit(f"patches.py: no program at {options.palpate}; build it by cargo build --release, or name it by --palpate")
    by_kind = uncertainties(options)
    try:
        patches = patches_of(options)
    except (OSError, ValueError) as fault:
        sys.exit(f"patches.py: {fault}")
    if not patches:
        sys.exit(f"patches.py: no patch of {options.directory}/truth.jsonl is here")
    found = compare(options, patches, peers_of(options), by_kind, out)
    if options.variants:
        out()
        patch_variants.table(options.palpate, patches, found, out)
    if options.crops:
        out()
        by_share = patch_crops.table(
            options.palpate, patches, options.crops, lambda crop, found: judge(crop, found, truth_u(crop, by_kind)), out
        )
        for share, judged in by_share.items():
            summary(f"share {share}", judged, out)
    if options.markdown:
        with open(options.markdown, "w") as target:
            target.write("\n".join(out.lines) + "\n")


if __name__ == "__main__":
    try:
        work(arguments())
    except KeyboardInterrupt:
        print("patches.py: interrupted", file=sys.stderr)
        sys.exit(130)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
