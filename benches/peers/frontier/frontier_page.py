"""The records of frontier.py as a table, as CSV and as a picture."""

import csv
import datetime

# one marker and one colour (Okabe and Ito) for each program: readable in black and white
LOOKS = {
    "palpate": ("o", "#0072B2"),
    "SciPy FITPACK, heights": ("s", "#D55E00"),
    "SciPy sparse, slopes": ("^", "#009E73"),
    "scikit-image shape_index": ("X", "#000000"),
    "local quadric, heights": ("v", "#E69F00"),
    "local quadric, with slopes": ("D", "#CC79A7"),
}
TITLES = {"bar": "bar: 60 contacts, 3 degrees of noise", "ring": "ring: 147 contacts, half a degree of noise"}


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
        "![error against time](peers-frontier.svg)",
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


def bars(point, key, value):
    """Distances down and up to the ends of an interval."""
    ends = [
        number(point, f"{key}.0") or number(point, f"{key}.lo"),
        number(point, f"{key}.1") or number(point, f"{key}.hi"),
    ]
    return [[max(value - (ends[0] or value), 0)], [max((ends[1] or value) - value, 0)]]


def picture(points, path):
    import matplotlib

    matplotlib.use("Agg")
    matplotlib.rcParams.update(
        {
            "svg.hashsalt": "palpate",
            "svg.fonttype": "none",
            "font.size": 9,
            "axes.spines.top": False,
            "axes.spines.right": False,
        }
    )
    import matplotlib.pyplot as plt

    figure, parts = plt.subplots(2, 2, figsize=(9, 7), layout="constrained", sharex="col")
    for column, scene in enumerate(TITLES):
        for line, (key, words) in enumerate((("error", "error of S and R together"), ("error_S", "error of S"))):
            axes = parts[line][column]
            for p in (p for p in points if p["case"] == scene and number(p, key)):
                marker, colour = LOOKS[p["program"]]
                time, error = number(p, "seconds.median"), number(p, key)
                both = bars(p, "error_interval", error) if key == "error" else None
                look = {
                    "marker": marker,
                    "color": colour,
                    "markerfacecolor": colour if p["program"] == "palpate" else "none",
                }
                axes.errorbar(
                    time, error, both, bars(p, "seconds", time), **look, markersize=6, linewidth=0.8, label=p["program"]
                )
            axes.set(xscale="log", yscale="log", ylabel=words)
            axes.grid(color="#dddddd")
            axes.set_axisbelow(True)
        parts[0][column].set_title(TITLES[scene])
        parts[1][column].set_xlabel("seconds for one fit with S and R on 64 points")
    named = {name: handle for axes in parts.flat for handle, name in zip(*axes.get_legend_handles_labels())}
    figure.legend(
        [named[k] for k in LOOKS if k in named],
        [k for k in LOOKS if k in named],
        loc="outside lower center",
        ncols=3,
        frameon=False,
    )
    figure.savefig(path, metadata={"Date": None} if path.suffix == ".svg" else None)


def write(folder, points, text):
    (folder / "peers-frontier.md").write_text(text)
    names = sorted({key for point in points for key, value in point.items() if value not in (None, "")} | {"failed"})
    with open(folder / "peers-frontier.csv", "w", newline="") as out:
        table = csv.DictWriter(out, names, extrasaction="ignore", lineterminator="\n")
        table.writeheader()
        table.writerows(points)
    picture(points, folder / "peers-frontier.svg")
