"""TouchStream: S and R after every touch, and quickly."""

from __future__ import annotations

import time

import numpy as np
import pytest
from conftest import Columns

import palpate


def stream() -> palpate.TouchStream:
    return palpate.TouchStream((-2.5, 2.5, -2.5, 2.5), sigma=(0.01, 0.02, 0.02), degree=(4, 2))


def test_touch_by_touch_becomes_a_ridge(ridge: Columns) -> None:
    live = stream()
    rows = np.column_stack(list(ridge.values()))
    found = [live.touch(x, y, z, (nx, ny, nz)) for x, y, z, nx, ny, nz in rows.tolist()]
    assert found[0] is None and len(live) == 36
    last = found[-1]
    assert last is not None and last.class_name == "ridge" and abs(last.shape_index - 0.5) < 0.01
    assert 0 < last.u_curvedness < 0.01 and last.contacts == 36 and "ridge" in repr(last)
    known = [now.u_curvedness for now in found if now is not None]
    assert known[-1] < known[0]


def test_a_refused_touch_changes_nothing(ridge: Columns) -> None:
    live = stream()
    with pytest.raises(palpate.PlanError) as caught:
        live.push(9.0, 0.0, 0.0, (0, 0, 1))
    assert caught.value.kind == "Outside" and caught.value.fields["axis"] == "x" and len(live) == 0
    for wrong in ({"normal": (0, 0, -1)}, {"normal": (0, 0, 1), "slopes": (0, 0)}, {}, {"slopes": (np.nan, 0)}):
        with pytest.raises(ValueError):
            live.push(0.0, 0.0, 0.0, **wrong)
    with pytest.raises(palpate.PlanError):
        live.shape()
    with pytest.raises(TypeError):
        live.push("a", 0, 0, (0, 0, 1))  # type: ignore[arg-type]


@pytest.mark.parametrize("words", [{"sigma": (0, 1, 1)}, {"sigma": 1}, {"degree": 12}, {"grid": 0}, {"inset": 0.5}])
def test_a_stream_that_cannot_be(words: dict) -> None:
    with pytest.raises((ValueError, TypeError)):
        palpate.TouchStream((0, 1, 0, 1), **{"sigma": (1, 1, 1), **words})
    with pytest.raises(ValueError):
        palpate.TouchStream((1, 0, 0, 1), sigma=(1, 1, 1))


def test_a_touch_takes_tens_of_microseconds(ridge: Columns) -> None:
    live = palpate.TouchStream((-2.5, 2.5, -2.5, 2.5), sigma=(0.01, 0.02, 0.02))
    rows = np.column_stack(list(ridge.values())).tolist()
    for x, y, z, *normal in rows:
        live.touch(x, y, z, normal)
    began = time.process_time()
    for x, y, z, *normal in rows * 100:
        live.touch(x, y, z, normal)
    # held loosely here, on a machine that may be busy; benches/python.py measures it
    assert (time.process_time() - began) / 3600 < 1e-3
