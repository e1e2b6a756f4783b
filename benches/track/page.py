"""The page: a curve for each number, over the commits; what changed by more than noise is marked and listed."""

import html
import math

from changes import of_counts

STYLE = """body{font:15px/1.5 system-ui,sans-serif;max-width:64rem;margin:2rem auto;padding:0 1rem;color:#1b1f24;background:#fff}
h2{margin:2rem 0 .3rem;font-size:1.1rem}h3{margin:.8rem 0 0;font-size:.95rem;font-weight:600}
.grid{display:grid;grid-template-columns:repeat(auto-fill,minmax(19rem,1fr));gap:.4rem 1.2rem}
svg{width:100%;height:auto}text{font:10px system-ui,sans-serif;fill:#59636e}.line{fill:none;stroke:#0072b2;stroke-width:1.6}
.band{stroke:#0072b2;stroke-width:1}.dot{fill:#0072b2}.more{fill:#d55e00}.less{fill:#009e73}
table{border-collapse:collapse}td,th{padding:.15rem .8rem .15rem 0;text-align:left}
@media(prefers-color-scheme:dark){body{color:#e6edf3;background:#0d1117}text{fill:#9aa4af}.line,.band{stroke:#56b4e9}.dot{fill:#56b4e9}}"""
WIDTH, HEIGHT, LEFT, TOP = 320, 120, 46, 8
KINDS = {
    "seconds": "Processor time of a command, over the parent's (paired runs, 99 % interval)",
    "counts": "Counts",
    "criterion": "Criterion, nanoseconds",
    "build": "Compiling (processor seconds) and size (bytes)",
    "accuracy": "Errors where the truth is known",
}


def series(lines):
    """Of each kind and name: points (place of the commit, value, lo, hi, change or None)."""
    found = {}
    last = {}
    for place, line in enumerate(lines):
        for name, change in line.get("seconds", {}).items():
            # from the first commit on, multiplied up, so that slow growth shows as well
            level = last.get(("seconds", name), 1.0) * change["ratio"]
            last["seconds", name] = level
            lo, hi = (level * change[end] / change["ratio"] for end in ("lo", "hi"))
            found.setdefault(("seconds", name), []).append((place, level, lo, hi, change["ratio"] if change["alarm"] else None))
        build = {key: line[key] for key in ("compile_seconds", "program_bytes") if key in line}
        for kind, values in (("counts", line.get("counts")), ("criterion", line.get("criterion")), ("build", build), ("accuracy", line.get("accuracy"))):
            for name, value in (values or {}).items():
                before = last.get((kind, name))
                last[kind, name] = value
                # compile seconds and criterion's means have a clock in them and no partner: they are drawn, and alarm nobody
                exact = kind == "counts" or kind == "accuracy" or name == "program_bytes"
                change = of_counts(before, value) if exact and before is not None else None
                mark = change.ratio if change and change.alarm else None
                found.setdefault((kind, name), []).append((place, value, value, value, mark))
    return found


def shown(value):
    return f"{value:.4g}"


def curve(points, commits):
    lo, hi = min(p[2] for p in points), max(p[3] for p in points)
    middle = 0.5 * (lo + hi)
    # a flat line in the middle, and changes of a few per cent as such
    half = max(0.55 * (hi - lo), 0.05 * abs(middle), 1e-300)
    x = lambda place: LEFT + 8 + (WIDTH - LEFT - 20) * place / max(commits - 1, 1)
    y = lambda value: TOP + (HEIGHT - TOP - 16) * (0.5 - 0.5 * (value - middle) / half)
    out = [f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img">']
    for value in (middle - half, middle, middle + half):
        out.append(f'<line x1="{LEFT}" x2="{WIDTH - 6}" y1="{y(value):.1f}" y2="{y(value):.1f}" stroke="#8884" />')
        out.append(f'<text x="{LEFT - 4}" y="{y(value) + 3:.1f}" text-anchor="end">{shown(value)}</text>')
    path = " ".join(f"{x(p[0]):.1f},{y(p[1]):.1f}" for p in points)
    out.append(f'<polyline class="line" points="{path}" />')
    for place, value, low, high, change in points:
        if high > low:
            out.append(f'<line class="band" x1="{x(place):.1f}" x2="{x(place):.1f}" y1="{y(low):.1f}" y2="{y(high):.1f}" />')
        kind, radius = ("dot", 2) if change is None else ("more" if change > 1 else "less", 5)
        words = f"commit {place + 1}: {shown(value)}" + ("" if change is None else f", {100 * (change - 1):+.1f} %")
        out.append(f'<circle class="{kind}" cx="{x(place):.1f}" cy="{y(value):.1f}" r="{radius}"><title>{words}</title></circle>')
    return "".join(out) + "</svg>"


def page(lines):
    """The whole page as text."""
    all_series = series(lines)
    alarms = [(place, kind, name, change) for (kind, name), points in all_series.items() for place, _, _, _, change in points if change]
    out = ["<!doctype html><meta charset=utf-8><meta name=viewport content='width=device-width'><title>palpate over its commits</title>"]
    machines = sorted({line["machine"] for line in lines})
    out.append(f"<style>{STYLE}</style><h1>palpate over its commits</h1>")
    out.append(f"<p>{len(lines)} commits on {html.escape('; '.join(machines))}. Orange is more, green is less, than before by more than noise.</p>")
    out.append("<h2>What changed</h2>")
    rows = []
    for place, kind, name, change in sorted(alarms, key=lambda alarm: (-alarm[0], -abs(math.log(alarm[3] or 1e-9)))):
        line = lines[place]
        cells = (line["commit"][:9], f"{100 * (change - 1):+.1f} %", name, KINDS[kind].split(",")[0], line["subject"])
        rows.append("<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in cells) + "</tr>")
    out.append(f"<table>{''.join(rows)}</table>" if rows else "<p>Nothing, beyond noise.</p>")
    for kind, title in KINDS.items():
        of_kind = {name: points for (other, name), points in all_series.items() if other == kind}
        if of_kind:
            out.append(f"<h2>{title}</h2><div class=grid>")
            out += [f"<div><h3>{html.escape(name)}</h3>{curve(points, len(lines))}</div>" for name, points in of_kind.items()]
            out.append("</div>")
    out.append("<h2>Commits</h2><table>")
    out += [f"<tr><td>{k + 1}<td>{line['commit'][:9]}<td>{line['date'][:10]}<td>{html.escape(line['subject'])}" for k, line in enumerate(lines)]
    return "\n".join(out) + "</table>\n"
