"""What Python costs beside Rust, and what SciPy takes for the nearest call: processor time, one run.

    python benches/overhead.py [--record ../benches/runs/python.md]

Rust's side of `fit` is `fit_contacts` on columns that are there already, called inside the extension (`_native.time_fit`). The calls take turns, so that what else the machine does falls on all alike; the median counts.
"""

from __future__ import annotations

import argparse
import platform
import statistics
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from scipy import interpolate

import palpate
from palpate import _native


def patch(g: int) -> dict[str, np.ndarray]:
    """A bar of radius 6 under a patch of 5 x 5, touched at g random places with errors."""
    random = np.random.default_rng(1)
    x, y = random.uniform(-2.5, 2.5, (2, g))
    z = np.sqrt(36 - x**2) - 6 + 1e-3 * random.standard_normal(g)
    return {"x": x, "y": y, "z": z, "normals": np.column_stack([x / 6, 0 * x, np.sqrt(1 - x**2 / 36)])}


def seconds(call: Callable[[], object], times: int = 1) -> float:
    """Processor time of one call, all threads; the mean over so many. What a call gave is let go before the next, as in Rust."""
    began = time.process_time()
    for _ in range(times):
        call()
    return (time.process_time() - began) / times


def medians(calls: dict[str, Callable[[], object]], rounds: int, times: int) -> dict[str, float]:
    """Median over rounds of the mean over `times` calls in a row."""
    taken: dict[str, list[float]] = {name: [] for name in calls}
    for name, call in calls.items():
        call()
    for _ in range(rounds):
        for name, call in calls.items():
            taken[name].append(seconds(call, times))
    return {name: statistics.median(times) for name, times in taken.items()}


def fits(g: int, words: dict, rounds: int, times: int) -> dict[str, float]:
    """fit of g contacts: in Rust, from Python, and with what is asked of it."""
    data = patch(g)
    found = medians(
        {
            # the arrays are read before the first of them, which the second takes away again
            "rust": lambda: _native.time_fit(**data, keywords=words, times=1),
            "read": lambda: _native.time_fit(**data, keywords=words, times=0),
            "python": lambda: palpate.fit(**data, **words),
        },
        rounds,
        times,
    )
    found["rust"] -= found["read"]
    # the doubt about a named model is a recognition, a thousand times as long as the fit
    shape = medians({"shape": lambda: palpate.fit(**data, **words).shape}, 3, max(1, times // 100))
    return {**found, **shape}


def against_scipy() -> list[tuple[str, float, float]]:
    """Name, palpate's seconds, SciPy's seconds."""
    rows = []
    data = patch(20_000)
    knots = np.linspace(-2.5, 2.5, 17)[1:-1]
    words = {"degree": 3, "segments": 16, "weights": "equal", "domain": [-2.5, 2.5, -2.5, 2.5]}
    x, y, z = data["x"], data["y"], data["z"]
    pair = medians(
        {
            "here": lambda: palpate.fit(x, y, z, **words),
            "there": lambda: interpolate.LSQBivariateSpline(x, y, z, knots, knots, bbox=words["domain"]),
        },
        7,
        1,
    )
    rows.append(("20,000 heights, 16 x 16 segments, degree 3: fit; LSQBivariateSpline", pair["here"], pair["there"]))
    there = interpolate.LSQBivariateSpline(x, y, z, knots, knots, bbox=words["domain"])
    here = palpate.Surface(there.tck[:2], there.tck[2], there.degrees)
    axis = np.linspace(-2.5, 2.5, 1000)
    np.testing.assert_allclose(here(axis, axis, 1), there(axis, axis, 1), atol=1e-9)
    pair = medians({"here": lambda: here(axis, axis, 1), "there": lambda: there(axis, axis, 1)}, 7, 3)
    rows.append(("slopes on 1000 x 1000 points; the same spline's __call__", pair["here"], pair["there"]))
    pair = medians({"here": lambda: here.ev(x, y), "there": lambda: there.ev(x, y)}, 7, 10)
    rows.append(("heights at 20,000 places; the same spline's ev", pair["here"], pair["there"]))
    pair = medians({"here": lambda: here.ev(0.1, 0.2), "there": lambda: there.ev(0.1, 0.2)}, 7, 2000)
    rows.append(("height at one place; the same spline's ev", pair["here"], pair["there"]))
    return rows


def touches() -> float:
    """Seconds of one touch with its answer, degree 2, S and R on 8 x 8."""
    data = patch(500)
    live = palpate.TouchStream((-2.5, 2.5, -2.5, 2.5), sigma=(1e-3, 1e-2, 1e-2))
    rows = [(x, y, z, tuple(n)) for x, y, z, n in zip(*(data[c].tolist() for c in "xyz"), data["normals"].tolist())]
    for row in rows:
        live.touch(*row)
    return statistics.median(seconds(lambda: [live.touch(*row) for row in rows]) / len(rows) for _ in range(15))


def batches() -> list[tuple[str, float]]:
    """Patches a second of processor time."""
    random = np.random.default_rng(2)
    x, y = (a.ravel() for a in np.meshgrid(np.linspace(-1, 1, 6), np.linspace(-1, 1, 6)))
    z = 0.2 * x**2 + 1e-3 * random.standard_normal((20_000, 36))
    n = np.stack(np.broadcast_arrays(-0.4 * x, 0 * x, 1 + 0 * z), axis=-1) + 1e-3 * random.standard_normal((*z.shape, 3))
    pixels = np.arange(16.0)
    images = 0.01 * (pixels[:, None] - 7.5) ** 2 + 1e-3 * random.standard_normal((20_000, 16, 16))
    calls = [
        ("36 contacts with normals, slope rows, S and R, no uncertainties", lambda: palpate.fit_many(x, y, z, normals=n, weights="tangent", bare=True)),
        ("the same with uncertainties", lambda: palpate.fit_many(x, y, z, normals=n, weights="tangent")),
        ("the same by normal rows, noise found", lambda: palpate.fit_many(x, y, z, normals=n, sigma="auto")),
        ("tiles of 16 x 16 pixels, no uncertainties", lambda: palpate.fit_many(pixels, pixels, images, weights="equal", bare=True)),
    ]
    return [(name, 20_000 / statistics.median(seconds(call) for _ in range(3))) for name, call in calls]


def table() -> str:
    """All of it as Markdown."""
    lines = [
        "| call | Rust alone | from Python | difference | reading the arrays | with `.shape` and certificate |",
        "|---|---|---|---|---|---|",
    ]
    for name, g, words, rounds, times in [
        ("36 contacts, slope rows, 9 unknowns", 36, {"weights": "tangent"}, 15, 500),
        ("36 contacts, normal rows, noise found", 36, {"sigma": "auto"}, 15, 100),
        ("200,000 contacts, slope rows, 64 x 64 segments", 200_000, {"weights": "tangent", "segments": 64}, 31, 1),
    ]:
        found = fits(g, words, rounds, times)
        over = found["python"] - found["rust"]
        sign = "-" if over < 0 else ""
        shown = f"{sign}{unit(abs(over))}, {100 * over / found['rust']:.1f} %"
        lines.append(
            f"| {name} | {unit(found['rust'])} | {unit(found['python'])} | {shown} "
            f"| {unit(found['read'])} | {unit(found['shape'])} |"
        )
    lines += ["", "| call; SciPy's nearest | palpate | SciPy | ratio |", "|---|---|---|---|"]
    lines += [f"| {name} | {unit(a)} | {unit(b)} | {a / b:.2f} |" for name, a, b in against_scipy()]
    lines += ["", f"A touch with its answer through `TouchStream.touch`: {unit(touches())}.", ""]
    lines += ["| `fit_many` | patches a second and core |", "|---|---|"]
    lines += [f"| {name} | {rate:,.0f} |" for name, rate in batches()]
    return "\n".join(lines)


def unit(s: float) -> str:
    """Seconds for people."""
    return f"{s * 1e6:.1f} us" if s < 1e-3 else f"{s * 1e3:.1f} ms"


def main() -> None:
    """Prints the tables; --record puts them between the marks of a file."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--record", type=Path)
    where = parser.parse_args().record
    text = table()
    print(text)
    if where:
        head, tail = "<!-- overhead -->", "<!-- /overhead -->"
        stand = where.read_text(encoding="utf-8") if where.exists() else f"{head}\n{tail}\n"
        before, after = stand.split(head)[0], stand.split(tail)[1]
        machine = f"{platform.machine()}, Python {platform.python_version()}, NumPy {np.__version__}"
        where.write_text(f"{before}{head}\n{text}\n\n({machine}, palpate {palpate.__version__})\n{tail}{after}", encoding="utf-8")


if __name__ == "__main__":
    main()
