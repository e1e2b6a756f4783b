"""Patches that the tests share, and the count of random calls."""

from __future__ import annotations

import signal
from collections import Counter

import numpy as np
import pytest

Columns = dict[str, np.ndarray]

# a shell starts what it puts into the background deaf to Ctrl-C, which Python then leaves as it is; these tests are about it
signal.signal(signal.SIGINT, signal.default_int_handler)

# what test_fuzz.py has called, and how that ended
FUZZED: Counter[str] = Counter()


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """One line on the random calls, where there were any."""
    if calls := FUZZED.total():
        answered, refused = FUZZED["answered"], FUZZED["refused"]
        terminalreporter.write_line(f"{calls:,} random calls: {answered:,} answered, {refused:,} refused by name, no crash")


def bar(n: int = 6, radius: float = 6.0) -> Columns:
    """A ridge along y, touched at n x n places of a patch of 5 x 5, without noise."""
    x, y = (a.ravel() for a in np.meshgrid(np.linspace(-2.5, 2.5, n), np.linspace(-2.5, 2.5, n), indexing="ij"))
    z = np.sqrt(radius**2 - x**2) - radius
    return {"x": x, "y": y, "z": z, "nx": x, "ny": 0 * x, "nz": z + radius}


@pytest.fixture
def ridge() -> Columns:
    return bar()


@pytest.fixture
def noisy() -> Columns:
    """The same with errors of 0.01 and 1 degree."""
    random, found = np.random.default_rng(5), bar(8)
    found["z"] = found["z"] + 0.01 * random.standard_normal(64)
    for name in ("nx", "ny", "nz"):
        found[name] = found[name] / 6 + 0.017 * random.standard_normal(64)
    return found


def normals(contacts: Columns) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return contacts["nx"], contacts["ny"], contacts["nz"]
