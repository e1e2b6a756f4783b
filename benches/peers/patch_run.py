"""palpate's default answer on a file: the command, its JSON, and what of it is compared."""
import json
import math
import subprocess
import time
from dataclasses import dataclass


@dataclass
class Found:
    """What palpate said. `refused` is its error instead; then the rest is None."""

    seconds: float
    kind: str | None = None
    S: float | None = None
    S_interval: tuple | None = None
    R: float | None = None
    R_interval: tuple | None = None
    radius: float | None = None
    why: str = ""
    lack_of_fit: str = ""
    notes: tuple = ()
    refused: str | None = None


def palpate(program, path, *options, limit=300):
    """Runs `palpate fit PATH --json` and reads it; a refusal, a crash and a run past the limit are answers too."""
    start = time.perf_counter()
    try:
        run = subprocess.run(
            [program, "fit", path, "--json", *options], capture_output=True, text=True, timeout=limit, check=False
        )
    except subprocess.TimeoutExpired:
        return Found(time.perf_counter() - start, refused=f"no answer within {limit} s")
    seconds = time.perf_counter() - start
    if run.returncode:
        return Found(seconds, refused=reason(run, path))
    try:
        return found(json.loads(run.stdout), seconds)
    except (ValueError, KeyError) as fault:
        return Found(seconds, refused=f"its JSON was not understood: {fault!r}")


def reason(run, path):
    """The first sentence of an error, without the program's and the file's name; remedies follow in later ones."""
    lines = run.stderr.strip().splitlines() or [f"exit code {run.returncode}"]
    return lines[0].removeprefix("palpate: ").removeprefix(f"{path}: ").split(". ")[0]


def found(document, seconds):
    shape, fit = document["shape"], document["fit"]
    S, R = shape.get("S") or {}, shape.get("R") or {}
    chosen, lack = fit.get("chosen") or {}, fit.get("lack_of_fit") or {}
    return Found(
        seconds,
        shape["class"] or "none",
        S.get("mean"),
        pair(S.get("interval")),
        R.get("mean"),
        pair(R.get("interval")),
        shape.get("radius"),
        chosen.get("why", ""),
        lack.get("words", ""),
        tuple(fit.get("notes") or ()),
    )


def pair(interval):
    """Both ends, or None where one is missing."""
    if not interval or any(end is None for end in interval):
        return None
    return tuple(interval)


def holds(interval, truth, margin=0.0):
    """Whether an interval holds the truth, its half width and the margin added in quadrature."""
    if interval is None:
        return False
    low, high = interval
    middle, half = (low + high) / 2, math.hypot((high - low) / 2, margin)
    # the middle of a narrow interval is rounded
    return low <= truth <= high or abs(truth - middle) <= half * (1 + 1e-12)
