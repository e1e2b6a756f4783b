"""Explorations as the program makes them, and next touches for a robot that has its own world."""

from __future__ import annotations

import json
import os
import pickle
import signal
import subprocess
import threading
import time

import numpy as np
import pytest
from conftest import Columns, normals
from test_fit import program

import palpate

SCENE = "paper-table2"


@pytest.fixture(scope="module")
def found() -> palpate.Exploration:
    return palpate.explore(SCENE, contacts=45, seed=3)


def test_steps_contacts_and_shape(found: palpate.Exploration) -> None:
    assert [step.contacts for step in found.steps] == [36, 39, 42, 45]
    assert all(column.shape == (45,) for column in found.contacts.values())
    first, last = found.steps[0], found.steps[-1]
    assert first.touched.shape == (36, 2) or first.touched.shape[1] == 2
    assert last.touched.shape == (3, 2) and last.touched.dtype == np.float64
    assert last.R.interval is not None and last.R.interval[0] < last.R.interval[1]
    assert found.shape is not None and found.shape.R.mean == last.R.mean
    again = palpate.fit(found.contacts)
    assert again.shape.S.mean == found.shape.S.mean and again.shape.R.u == found.shape.R.u
    assert found.stopped == "budget" and "45" in found.reason


def test_it_is_what_the_program_prints(found: palpate.Exploration) -> None:
    name = program()
    if name is None:
        pytest.skip("the program palpate is not built")
    line = [name, "explore", SCENE, "--contacts=45", "--seed=3", "--json"]
    done = subprocess.run(line, check=True, capture_output=True)
    assert json.loads(done.stdout) == found.to_dict()


def test_it_prints_and_pickles(found: palpate.Exploration) -> None:
    again = pickle.loads(pickle.dumps(found))
    assert again == found and np.array_equal(again.contacts["z"], found.contacts["z"])
    assert "45 contacts" in repr(found) and found._repr_html_().startswith("<table>")
    pytest.importorskip("pandas")
    frame = found.to_pandas()
    assert list(frame["contacts"]) == [36, 39, 42, 45] and frame["u_R"].notna().all()


def test_goals_strategies_models_and_reach() -> None:
    loose = palpate.explore(SCENE, u_s=0.5, u_r=0.9, contacts=60)
    assert loose.stopped == "goal" and loose.steps[-1].attainable is not None
    text = palpate.scene(SCENE)
    touched = palpate.explore(text, strategy="random", contacts=39, reach=np.array([-1, 1, -1, 1])).steps[-1].touched
    assert (np.abs(touched) <= 1).all()
    named = palpate.explore(SCENE, contacts=39, degree=(2, 2), sigma="auto")
    assert "degree 2" in named.document["model"]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ({"strategy": "shpae"}, "shape"),
        ({"contacts": 5}, "first sweep alone makes"),
        ({"contacts": 0}, "contacts"),
        ({"u_s": 0.1}, "u_r"),
        ({"u_s": -1, "u_r": 1}, "positive"),
        ({"per_round": 0}, "per_round"),
        ({"reach": [0, 1]}, "reach"),
        ({"surface": "parametric"}, "height field"),
        ({"level": 2}, "level"),
    ],
)
def test_faults_name_the_keyword(words: dict, said: str) -> None:
    with pytest.raises(palpate.ExploreError, match=said):
        palpate.explore(SCENE, **words)


def test_an_unknown_keyword_is_a_type_error() -> None:
    with pytest.raises(TypeError, match="colour"):
        palpate.explore(SCENE, colour="red")
    with pytest.raises(palpate.ExploreError, match="no such file"):
        palpate.explore("not-there")


def test_progress_counts_contacts() -> None:
    told: list[tuple[int, int]] = []
    palpate.explore(SCENE, contacts=42, progress=lambda done, of: told.append((done, of)))
    assert told == sorted(told) and set(of for _, of in told) == {42} and told[-1][0] == 42


@pytest.mark.skipif(os.name == "nt", reason="signals")
def test_ctrl_c_ends_an_exploration_soon() -> None:
    threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        palpate.explore(SCENE, contacts=10_000, per_round=1)
    assert time.monotonic() - began < 30


CANDIDATES = np.array([[0.0, 0.0], [2.5, 2.5], [1.0, 0.0], [-2.4, 0.3]])


def test_next_touches_lower_u_as_refits_do(noisy: Columns) -> None:
    """Of all candidates the chosen one lets the criterion fall most where each is really touched and fitted."""
    words = {"degree": 2, "sigma": (0.01, 1.0), "domain": [-2.5, 2.5, -2.5, 2.5]}
    fit = palpate.fit(noisy["x"], noisy["y"], noisy["z"], normals=normals(noisy), **words)
    best = palpate.next_touches(fit, CANDIDATES)
    assert best.dtype == np.int64 and best.shape == (1,)

    def after(x: float, y: float) -> float:
        z, zx, zy = (float(fit.surface.ev(x, y, dx=a, dy=b)) for a, b in ((0, 0), (1, 0), (0, 1)))
        columns = [np.append(noisy[n], v) for n, v in zip(("x", "y", "z", "nx", "ny", "nz"), (x, y, z, -zx, -zy, 1.0))]
        more = palpate.fit(*columns[:3], normals=tuple(columns[3:]), **words).shape
        return (more.S.u_noise / fit.shape.S.u_noise) ** 2 + (more.R.u_noise / fit.shape.R.u_noise) ** 2

    falls = [after(x, y) for x, y in CANDIDATES]
    assert best[0] == int(np.argmin(falls))


def test_a_planner_answers_again_and_again(noisy: Columns) -> None:
    fit = palpate.fit(noisy["x"], noisy["y"], noisy["z"], normals=normals(noisy), degree=2)
    planner = palpate.TouchPlanner(fit)
    order = palpate.next_touches(planner, CANDIDATES, 9)
    assert sorted(order) == [0, 1, 2, 3] and order[0] == planner.next_touches(CANDIDATES, 1)[0]
    u_s, u_r = planner.expected_u
    planner.next_touches(CANDIDATES, 4)
    assert planner.expected_u[0] < u_s and planner.expected_u[1] < u_r
    # views of any layout, and lists
    np.testing.assert_array_equal(planner.next_touches(np.asfortranarray(CANDIDATES), 9), order)
    np.testing.assert_array_equal(planner.next_touches(CANDIDATES.tolist(), 9), order)
    assert len(palpate.TouchPlanner(fit, units=(0.01, 0.1)).next_touches(CANDIDATES, 2)) == 2


def test_recognised_contacts_plan_too(noisy: Columns) -> None:
    fit = palpate.fit(noisy["x"], noisy["y"], noisy["z"], normals=normals(noisy))
    assert len(palpate.next_touches(fit, CANDIDATES, 2)) == 2


def test_faults_of_planning(noisy: Columns) -> None:
    fit = palpate.fit(noisy["x"], noisy["y"], noisy["z"], normals=normals(noisy), degree=2)
    with pytest.raises(palpate.ExploreError, match="equations behind") as caught:
        palpate.next_touches(pickle.loads(pickle.dumps(fit)), CANDIDATES)
    assert caught.value.kind == "Saved"
    with pytest.raises(palpate.ExploreError) as caught:
        palpate.next_touches(fit, [[0.0, float("nan")]])
    assert caught.value.kind == "NotFinite" and caught.value.fields["index"] == 0
    with pytest.raises(palpate.ExploreError) as caught:
        palpate.next_touches(fit, np.empty((0, 2)))
    assert caught.value.kind == "NoCandidate"
    for wrong in ([1.0, 2.0], [[1.0, 2.0, 3.0]], []):
        with pytest.raises(ValueError, match="candidates"):
            palpate.next_touches(fit, wrong)
    with pytest.raises(ValueError, match="n is 0"):
        palpate.next_touches(fit, CANDIDATES, 0)
    with pytest.raises(ValueError, match="units"):
        palpate.TouchPlanner(fit, units=(0.0, 1.0))
    with pytest.raises(TypeError, match="fit"):
        palpate.next_touches("fit", CANDIDATES)
    weighed = palpate.fit(noisy["x"], noisy["y"], noisy["z"], normals=normals(noisy), degree=2, weights="tangent")
    with pytest.raises(palpate.ExploreError) as caught:
        palpate.next_touches(weighed, CANDIDATES)
    assert caught.value.kind == "Weights"
