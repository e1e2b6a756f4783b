"""Two fits compared as `palpate diff` compares them."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest
from conftest import Columns, bar, normals
from test_fit import program

import palpate


def moved(contacts: Columns, up: float) -> palpate.Fit:
    found = {**contacts, "z": contacts["z"] + up}
    return palpate.fit(found["x"], found["y"], found["z"], normals=normals(found))


def without_files(document: dict) -> dict:
    return {**document, "a": {**document["a"], "file": ""}, "b": {**document["b"], "file": ""}}


def test_it_is_what_the_program_prints(noisy: Columns, tmp_path: Path) -> None:
    name = program()
    if name is None:
        pytest.skip("the program palpate is not built")
    a, b = moved(noisy, 0.0), moved(noisy, 0.3)
    files = [tmp_path / "a.json", tmp_path / "b.json"]
    a.save(files[0]), b.save(files[1])
    for flags, words in (([], {}), (["--grid=5x7"], {"grid": (5, 7)})):
        done = subprocess.run([name, "diff", *map(str, files), "--json", *flags], capture_output=True, check=True)
        expected = without_files(json.loads(done.stdout))
        found = a.diff(b, **words)
        assert without_files(found.to_dict()) == expected
        loaded = palpate.Fit.load(files[1])
        for other in (loaded.to_dict(), files[1], str(files[1]), loaded):
            assert without_files(a.diff(other, **words).to_dict()) == expected


def test_the_verdict_has_names(noisy: Columns) -> None:
    fit = moved(noisy, 0.0)
    same, other = fit.diff(fit), fit.diff(moved(noisy, 1.0))
    assert same.same is True and other.same is False and other.compared > 100 and other.threshold > 1
    height = next(iter(other.differences.values()))
    assert abs(height["mean"]) == pytest.approx(1.0, abs=0.05) and set(other.differences) >= {"S", "R"}
    assert "not the same" in repr(other) and "the same" in repr(same) and "threshold" not in repr(same)
    assert len(str(other).splitlines()) > 4 and isinstance(other.notes, list)
    assert fit.diff(fit.to_dict()).same is not False
    bare = palpate.fit(**{k: noisy[k] for k in "xyz"}, degree=2, bare=True)
    assert bare.diff(bare).same is None and "no verdict" in repr(bare.diff(bare))


def test_what_cannot_be_compared_is_refused(ridge: Columns) -> None:
    fit = moved(ridge, 0.0)
    far = palpate.fit(ridge["x"] + 99, ridge["y"], ridge["z"], normals=normals(ridge))
    with pytest.raises(palpate.SurfaceError, match="no part in common") as caught:
        fit.diff(far)
    assert caught.value.kind == "NotComparable"
    in_mm, in_m = (palpate.fit(ridge, unit=unit) for unit in ("mm", "m"))
    with pytest.raises(palpate.SurfaceError, match="unit"):
        in_mm.diff(in_m)
    with pytest.raises(palpate.SurfaceError):
        fit.diff({"schema": "other"})
    with pytest.raises(palpate.SurfaceError):
        fit.diff(fit, grid=1)
    for wrong in (7, None, np.zeros(3)):
        with pytest.raises(TypeError):
            fit.diff(wrong)  # type: ignore[arg-type]
    assert moved(bar(8), 0.0).diff(fit).same is not None
