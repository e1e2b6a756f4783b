"""Bad input raises ValueError or TypeError that names the argument, and never ends the interpreter."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest
from conftest import Columns

import palpate

NINE = np.array([0, 0, 0, 1, 1, 1, 2, 2, 2.0])
RUN = np.array([0, 1, 2] * 3, dtype=float)

CASES: list[tuple[dict[str, Any], type[Exception], str]] = [
    ({"x": NINE.reshape(3, 3, 1)}, ValueError, r"x has shape \[3, 3, 1\]"),
    ({"x": NINE[:4]}, ValueError, "column y has 9 entries where x has 4"),
    ({"x": np.array([None] * 9)}, TypeError, "x: an array of object"),
    ({"x": NINE + 1j}, TypeError, "x: an array of complex128"),
    ({"x": ["a"] * 9}, TypeError, "x: an array of <U1"),
    ({"x": [[1], [1, 2]]}, ValueError, "x: "),
    ({"x": np.ma.array(NINE, mask=NINE > 1)}, ValueError, "x has masked entries"),
    ({"x": np.array(["2020"] * 9, dtype="M8[Y]")}, TypeError, "x: an array of datetime64"),
    ({"z": np.full(9, np.nan)}, ValueError, "z of contact 0 is NaN"),
    ({"x": []}, ValueError, "there are no contacts"),
    ({"normals": NINE}, ValueError, r"normals has shape \[9\]"),
    ({"normals": np.zeros((9, 3))}, ValueError, "normal of contact 0 has length zero"),
    ({"normals": np.ones((9, 3)), "slopes": np.ones((9, 2))}, ValueError, "normals, slopes"),
    ({"flip_normals": True}, ValueError, "flip_normals"),
    ({"degree": 0}, ValueError, "degree"),
    ({"degree": 2.5}, ValueError, "degree"),
    ({"degree": 10**30}, ValueError, "degree"),
    ({"segments": 10**6}, ValueError, "segments"),
    ({"grid": (10**4, 10**4)}, ValueError, "grid"),
    ({"domain": [0, 1, 2]}, ValueError, "domain: 4 finite numbers"),
    ({"domain": [2, 0, 0, 2]}, ValueError, "domain"),
    ({"weights": "heavy"}, ValueError, "weights is .*auto, tangent"),
    ({"sigma": (0, 1)}, ValueError, "sigma"),
    ({"weights": "auto", "smooth": -1.0}, ValueError, "smooth"),
    ({"method": "lucky"}, ValueError, "method"),
    ({"surface": 3}, TypeError, "surface"),
    ({"inset": 0.7}, ValueError, "inset"),
    ({"level": 1.5}, ValueError, "level"),
    ({"finger": NINE - 5}, ValueError, "finger"),
    ({"station": NINE + 0.5}, ValueError, "station"),
    ({"wz": -NINE}, ValueError, "wz"),
    ({"bare": True}, ValueError, "bare"),
    ({"closed": "w"}, ValueError, "closed"),
    ({"knots": ([0, 1], [0, 1])}, ValueError, "x"),
    ({"z": None}, TypeError, "z is missing"),
]


@pytest.mark.parametrize(("given", "kind", "words"), CASES)
def test_the_argument_is_named(given: dict[str, Any], kind: type[Exception], words: str) -> None:
    named = {} if "bare" in given else {"degree": 1}
    arguments = {"x": NINE, "y": RUN, "z": NINE * RUN, **named, **given}
    with pytest.raises(kind, match=words):
        palpate.fit(**arguments)


def test_an_unknown_keyword_is_a_type_error() -> None:
    with pytest.raises(TypeError, match="degrees"):
        palpate.fit(NINE, RUN, NINE, degrees=2)  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="degrees"):
        palpate.fit_many(NINE[None], RUN[None], NINE[None], degrees=2)


def test_errors_have_fields_and_pickle(ridge: Columns) -> None:
    with pytest.raises(palpate.FitError) as caught:
        palpate.fit(ridge, degree=2, domain=[-1, 1, -1, 1])
    error = caught.value
    assert error.kind == "Outside" and error.fields["index"] == 0 and error.fields["domain"] == [-1, 1, -1, 1]
    again = pickle.loads(pickle.dumps(error))
    assert (str(again), again.kind, again.fields) == (str(error), error.kind, error.fields)
    with pytest.raises(palpate.FitError) as caught:
        palpate.fit(ridge, degree=2, flip_normals=True)
    assert caught.value.fields["remedies"] == {"flip_normals": "", "frame": "auto"}


def test_contacts_that_are_several_things_say_what_to_do() -> None:
    random = np.random.default_rng(3)
    cloud = random.standard_normal((400, 3))
    with pytest.raises(palpate.PalpateError) as caught:
        palpate.fit(*cloud.T)
    assert "--" not in str(caught.value), caught.value


@pytest.mark.parametrize("scene", ["nowhere", "", "[surface]\nkind = 'cube'\n", "x = 1\n"])
def test_a_scene_that_is_none(scene: str) -> None:
    with pytest.raises(palpate.StudyError):
        palpate.study(scene, 10)
    with pytest.raises(palpate.StudyError):
        palpate.simulate(scene)


def test_a_study_of_other_words() -> None:
    for words in ({"replicates": 0}, {"level": 2.0}, {"tolerance": 9}, {"degree": 99}, {"range": (5, 3)}):
        with pytest.raises(palpate.StudyError):
            palpate.study("paper-table2", **{"replicates": 10, **words})
    with pytest.raises(TypeError, match="nonsense"):
        palpate.study("paper-table2", 10, nonsense=1)
    with pytest.raises(ValueError, match="threads"):
        palpate.study("paper-table2", 10, threads=0)
