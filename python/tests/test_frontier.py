"""Frontiers: points, picks that keep their request, progress, Ctrl-C, faults that name the keyword."""

from __future__ import annotations

import os
import pickle
import signal
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import palpate

SCENE = "paper-cylinder"
QUICK = {"bare": True, "seconds": 0.1, "keep_stations": True}


@pytest.fixture(scope="module")
def found() -> palpate.Frontier:
    return palpate.frontier(SCENE, error_s=0.05, error_r=0.03, **QUICK)


def test_points_are_a_table(found: palpate.Frontier) -> None:
    assert {point["frontier"] for point in found.points} == {"discretisation"}
    assert any(point["on_frontier"] for point in found.points)
    for point in found.points:
        assert point["failed"] or point["seconds_lo"] <= point["seconds"] <= point["seconds_hi"]
    pandas = pytest.importorskip("pandas")
    frame = found.to_pandas()
    assert len(frame) == len(found.points) and list(frame["error_S"].dropna() >= 0)
    assert palpate.Frontier.from_pandas(frame) == found
    assert 1 <= len(found.shortlist) <= 5 and found.recommended in {row["label"] for row in found.shortlist}
    assert "recognised" in {row["label"] for row in found.shortlist}
    pandas.testing.assert_frame_equal(frame, pandas.DataFrame(found.points))


def test_what_was_picked_keeps_the_request_and_is_a_scene(found: palpate.Frontier) -> None:
    pick = found.pick
    assert pick is not None and pick.met and pick.obstacle is None
    assert pick.error_S is not None and pick.error_S <= 0.05
    assert pick.error_R is not None and pick.error_R <= 0.03
    assert found.scene is not None
    study = palpate.study(found.scene, 100, attribution=0)
    assert study.R.mean is not None and study.R.mean > 0


def test_text_gives_what_the_name_gives(found: palpate.Frontier) -> None:
    by_text = palpate.frontier(palpate.scene(SCENE), **QUICK)
    errors = [(point["label"], point["error_S"], point["error_R"]) for point in by_text.points]
    assert errors == [(point["label"], point["error_S"], point["error_R"]) for point in found.points]
    assert by_text.pick is None and by_text.scene is None


def test_it_prints_and_pickles(found: palpate.Frontier) -> None:
    assert pickle.loads(pickle.dumps(found)) == found
    assert SCENE in repr(found) and "picked" in repr(found)
    assert found._repr_html_().startswith("<table>") and "us</th>" in found._repr_html_()
    assert found.to_dict()["schema"] == "palpate.frontier/1"


def test_a_budget_in_seconds_and_in_words() -> None:
    for budget in (0.01, "10ms"):
        found = palpate.frontier(SCENE, budget=budget, **QUICK)
        assert found.pick is not None and found.pick.met and found.pick.seconds < 0.01
        assert found.document["pick"]["asked"]["budget"] == pytest.approx(0.01)


def test_contacts_of_a_file_are_judged_by_those_left_out(tmp_path: Path) -> None:
    contacts = palpate.simulate("paper-table2")
    names = ["x", "y", "z", "nx", "ny", "nz"]
    rows = [",".join(names), *(",".join(repr(float(contacts[n][k])) for n in names) for k in range(len(contacts["x"])))]
    file = tmp_path / "contacts.csv"
    file.write_text("\n".join(rows) + "\n")
    found = palpate.frontier(file, seconds=0.1)
    assert "left out" in found.document["reference"] and found.points
    with pytest.raises(palpate.FrontierError, match="true S and R of measured contacts are unknown"):
        palpate.frontier(file, error_s=0.1)


def judged(found: palpate.Frontier) -> dict[str, tuple]:
    """What is no time: of a loaded machine in the same seconds fewer ways are judged."""
    return {point["label"]: (point["error"], point["degree"], point["segments"]) for point in found.points}


def assert_alike(one: palpate.Frontier, other: palpate.Frontier) -> None:
    """The ways that both have judged are judged alike, and most of them both have."""
    a, b = judged(one), judged(other)
    common = a.keys() & b.keys()
    assert 2 * len(common) > max(len(a), len(b)), f"{len(a)} and {len(b)} ways, {len(common)} in common"
    assert {label: a[label] for label in common} == {label: b[label] for label in common}


def test_arrays_are_judged_as_a_file_of_them(tmp_path: Path) -> None:
    contacts = palpate.simulate("paper-table2")
    x, y, z = contacts["x"], contacts["y"], contacts["z"]
    normals = np.column_stack([contacts[n] for n in ("nx", "ny", "nz")])
    names = ["x", "y", "z", "nx", "ny", "nz"]
    table = np.column_stack([contacts[n] for n in names])
    file = tmp_path / "contacts.csv"
    np.savetxt(file, table, fmt="%.17g", delimiter=",", header=",".join(names), comments="")
    by_file = palpate.frontier(file, seconds=6.0)
    by_arrays = palpate.frontier(x, y, z, normals=normals, seconds=6.0, budget=0.01)
    assert_alike(by_arrays, by_file)
    assert by_arrays.document["reference"] == by_file.document["reference"]
    assert by_arrays.document["scene"] == "contacts"
    assert by_arrays.pick is not None and by_arrays.pick.met and by_arrays.scene is None
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame(contacts)
    assert_alike(palpate.frontier(frame, seconds=6.0), by_file)
    slanted = palpate.frontier(x, y, z, normals=-normals, flip_normals=True, seconds=6.0)
    assert_alike(slanted, by_file)
    bare = palpate.frontier(x.tolist(), y, z.astype("f4"), seconds=6.0)
    assert 0 < len(bare.points) < len(by_file.points)


@pytest.mark.parametrize(
    ("given", "fault", "said"),
    [
        ({"z": None}, TypeError, "z is missing: frontier"),
        ({"x": np.zeros(7)}, palpate.FitError, "y has 40"),
        ({"z": np.full(40, np.nan)}, palpate.FitError, "z"),
        ({"z": np.zeros((8, 5))}, ValueError, "grid"),
        ({"normals": np.zeros((40, 3))}, palpate.FitError, "normal"),
        ({"normals": np.ones((40, 3)), "slopes": np.ones((40, 2))}, ValueError, "not both"),
        ({"flip_normals": True}, ValueError, "flip_normals"),
        ({"x": np.zeros(9), "y": np.zeros(9), "z": np.zeros(9)}, palpate.FrontierError, "30"),
        ({"error_s": 0.1}, palpate.FrontierError, "true S and R of measured contacts are unknown"),
        ({"z": np.array(["a"] * 40)}, TypeError, "z"),
        ({"x": "paper-cylinder"}, TypeError, "y: a scene"),
        ({"x": {"x": [1.0]}, "y": None, "z": None}, ValueError, "y, z is missing"),
    ],
)
def test_contacts_that_are_none(given: dict, fault: type, said: str) -> None:
    x, y = np.meshgrid(np.arange(8.0), np.arange(5.0))
    contacts = {"x": x.ravel(), "y": y.ravel(), "z": 0.01 * (x**2).ravel(), "seconds": 0.1, **given}
    with pytest.raises(fault, match=said):
        palpate.frontier(contacts.pop("x"), contacts.pop("y"), contacts.pop("z"), **contacts)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ({"error_s": -1.0}, "error_s"),
        ({"error_r": float("nan")}, "error_r"),
        ({"budget": "soon"}, "50us"),
        ({"budget": -1.0}, "greater than 0"),
        ({"seconds": "x"}, "seconds"),
        ({"seed": -3}, "seed"),
    ],
)
def test_faults_name_the_keyword(words: dict, said: str) -> None:
    with pytest.raises(palpate.FrontierError, match=said) as caught:
        palpate.frontier(SCENE, **{**QUICK, **words})
    assert "--" not in str(caught.value).splitlines()[0]


def test_a_scene_that_is_not_there() -> None:
    with pytest.raises(palpate.FrontierError, match="paper-cylindre"):
        palpate.frontier("paper-cylindre")
    with pytest.raises(palpate.FrontierError):
        palpate.frontier("--orders")


def test_progress_only_grows_and_ends_at_the_end() -> None:
    told: list[tuple[int, int]] = []

    def progress(done: int, of: int) -> None:
        assert threading.current_thread() is threading.main_thread()
        told.append((done, of))

    palpate.frontier(SCENE, progress=progress, **QUICK)
    assert told == sorted(told) and told[-1][0] == told[-1][1]


def test_what_progress_raises_ends_it() -> None:
    def progress(done: int, of: int) -> None:
        raise RuntimeError("enough")

    began = time.monotonic()
    with pytest.raises(RuntimeError, match="enough"):
        palpate.frontier(SCENE, progress=progress, bare=True, seconds=600)
    assert time.monotonic() - began < 60


@pytest.mark.skipif(os.name == "nt", reason="signals")
def test_ctrl_c_ends_a_frontier_soon() -> None:
    threading.Timer(1.0, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        palpate.frontier("paper-table2", bare=True, seconds=600)
    assert time.monotonic() - began < 30
