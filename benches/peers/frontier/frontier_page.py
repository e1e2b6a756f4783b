"""The records of frontier.py as a table and as CSV; `notebooks/03-what-accuracy-costs` draws them."""

import csv
import datetime
import json


def spell(seconds):
    for unit, size in (("s", 1), ("ms", 1e-3), ("us", 1e-6)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds:.2g} s"


def number(point, key):
    value = point.get(key)
    return None if value in (None, "") else float(value)


def cell(value, digits=2):
    return "-" if value is None else f"{value:.{digits}g}"


def cpu():
    with open("/proc/cpuinfo") as info:
        return next((line.split(":")[1].strip() for line in info if line.startswith("model name")), "unknown")


def page(points, facts):
    head = [
        "# Frontiers of others beside palpate's",
        "",
        "`python benches/peers/frontier.py --record benches/runs`",
        "",
    ]
    known = {"date": datetime.date.today().isoformat(), "cpu": cpu(), **facts}
    head += [f"{key}: {value}  " for key, value in known.items()] + [
        "",
    ]
    head += [
        "Error is that of S and R together, sqrt(error_S^2 + (error_R / R)^2), root mean square over an 8 x 8 grid; *same contacts* is",
        "that of palpate's points on the contacts that the others were given. Of palpate's points those stand here that no other is",
        "certainly better than in error and time. The records are in `peers-frontier.csv`, with the keys of `palpate.frontier/1`.",
        "",
    ]
    return "\n".join(head + rows(points)) + "\n"


def rows(points):
    lines = [
        "| scene | program | what | error of S | error of R, 1/length | error | same contacts | time |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for p in points:
        if p.get("failed"):
            lines.append(f"| {p['case']} | {p['program']} | {p['label']} | failed: {p['failed']} | | | | |")
            continue
        errors = [cell(number(p, key)) for key in ("error_S", "error_R", "error", "error_same_contacts")]
        lines.append(
            f"| {p['case']} | {p['program']} | {p['label']} | {' | '.join(errors)} | {spell(number(p, 'seconds.median'))} |"
        )
    return lines


def nested(point):
    """A record with the keys that JSON has: `seconds.median` is the median of the seconds."""
    out = {}
    for key, value in point.items():
        *outer, last = key.split(".")
        inner = out
        for name in outer:
            inner = inner.setdefault(name, {})
        inner[last] = value
    return out


def beside(file, points):
    """The points of other programs, as `palpate frontier SCENE --beside FILE` takes them."""
    others = [nested(point) for point in points if point["program"] != "palpate"]
    file.write_text(json.dumps({"points": others}, indent=1) + "\n")


def write(folder, points, text):
    (folder / "peers-frontier.md").write_text(text)
    names = sorted({key for point in points for key, value in point.items() if value not in (None, "")} | {"failed"})
    with open(folder / "peers-frontier.csv", "w", newline="") as out:
        table = csv.DictWriter(out, names, extrasaction="ignore", lineterminator="\n")
        table.writeheader()
        table.writerows(points)
