"""A live loop answers as `palpate live` does, whatever form its touches come in, and loses none."""

from __future__ import annotations

import json
import pickle
import subprocess
import warnings
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest
from conftest import bar
from test_fit import program

import palpate

Row = tuple[float, ...]


def touches(count: int = 40, radius: float = 9.0) -> list[Row]:
    """A bar along y, in an order that fills the patch."""
    random, k = np.random.default_rng(3), np.arange(count)
    x, y = (k * 0.754877666 % 1) * 8 - 4, (k * 0.569840291 % 1) * 8 - 4
    z = np.sqrt(radius**2 - x**2)
    rows = np.column_stack([x, y, z, x / radius, 0 * x, z / radius])
    return [tuple(row) for row in (rows + 0.01 * random.standard_normal(rows.shape)).tolist()]


def lines(rows: Iterable[Row]) -> str:
    return "x,y,z,nx,ny,nz\n" + "".join(",".join(map(repr, row)) + "\n" for row in rows)


def printed(text: str, *flags: str) -> list[dict]:
    """The answers that the program prints."""
    name = program()
    if name is None:
        pytest.skip("the program palpate is not built")
    done = subprocess.run([name, "live", "-", "--json", *flags], input=text.encode(), capture_output=True, check=True)
    found = [json.loads(line) for line in done.stdout.splitlines()]
    return [without_clock(line) for line in found if "answer" in line]


def without_clock(line: dict) -> dict:
    return {name: value for name, value in line.items() if name != "seconds"}


def told(answers: Iterable[palpate.LiveAnswer | None]) -> list[dict]:
    return [without_clock(answer.to_dict()) for answer in answers if answer is not None]


@pytest.mark.parametrize(
    ("flags", "words"),
    [
        ([], {}),
        (["--window=15", "--refresh=0.3"], {"window": 15, "refresh": 0.3}),
        (["--reach=-6,6,-5,5", "--viewpoint=0,0,50"], {"reach": (-6, 6, -5, 5), "viewpoint": np.array([0, 0, 50])}),
        (["--until-radius=0.5"], {"until_radius": 0.5}),
        (["--u-s=0.05", "--u-r=0.1"], {"u_s": 0.05, "u_r": 0.1}),
    ],
)
def test_it_says_what_the_program_prints(flags: list[str], words: dict) -> None:
    rows = touches()
    assert told(palpate.live(rows, **words)) == printed(lines(rows), *flags)


def test_every_form_of_touch_is_the_same_touch(tmp_path: Path) -> None:
    rows = touches(14)
    names = ("x", "y", "z", "nx", "ny", "nz")
    expected = told(palpate.live(rows))
    messages = [{"pose": {"position": dict(zip("xyz", row))}, "normal": np.array(row[3:]), "stamp": k} for k, row in enumerate(rows)]
    file = tmp_path / "touches.csv"
    file.write_text(lines(rows), encoding="utf-8")
    forms = [
        np.array(rows), [(row[:3], row[3:]) for row in rows], [dict(zip(names, row)) for row in rows], messages,
        lines(rows).splitlines(), dict(zip(names, np.array(rows).T)), file, str(file),
    ]  # fmt: skip
    for form in forms:
        assert told(palpate.live(form)) == expected
    loop = palpate.LiveLoop()
    answers = [loop.touch(*row[:3], row[3:]) for row in rows]
    last = loop.finish()
    assert told(answers) == expected[: len(rows)] and last is not None and without_clock(last.to_dict()) == expected[-1]


def test_an_answer_has_names() -> None:
    loop = palpate.LiveLoop(refresh=0)
    first = loop.touch(0, 0, 0)
    assert (first.answer, first.shape, first.radius, first.S, first.class_name) == ("none", None, None, None, None)
    assert first.why is not None and not loop.contacts["x"].any()
    with pytest.raises(palpate.LiveError):
        _ = loop.fit
    loop = palpate.LiveLoop()
    answers = [loop.hear(row) for row in touches()]
    last = loop.finish()
    assert last is loop.last and last is not None and last.answer == "fresh" and len(loop) == 40
    assert (last.class_name, last.kind, last.contacts, last.made_at, last.touch) == ("ridge", "cylinder", 40, 40, 40)
    assert last.radius_interval is not None and last.radius_interval[0] < 9 < last.radius_interval[1]
    assert last.R is not None and last.R.u is not None and last.next is not None and last.next.by == "shape"
    assert last.seconds > 0 and str(last).startswith("40  ridge") and last.kind_probability is not None
    moved = [answer for answer in answers if answer is not None and answer.answer == "moved"]
    assert moved and all(answer.contacts == answer.touch > answer.made_at for answer in moved) and loop.looks < 40
    assert pickle.loads(pickle.dumps(last)).to_dict() == last.to_dict() and "40 touches" in repr(loop)


def test_the_last_look_is_a_fit_with_maps() -> None:
    loop = palpate.LiveLoop()
    for row in touches():
        loop.hear(row)
    loop.finish()
    own = palpate.fit(loop.contacts)
    assert loop.fit.shape == own.shape and loop.fit.diff(own).same is True
    maps, theirs = loop.maps((7, 9)), own.maps((7, 9))
    assert maps.keys() == theirs.keys() and all(np.array_equal(maps[k], theirs[k], equal_nan=True) for k in maps)
    mesh = palpate.surface_mesh(maps)
    assert len(mesh.points) <= 63 and mesh.triangles.max() < len(mesh.points) and len(mesh.triangles) > 60
    assert np.nanmax(mesh.doubt) <= 1 and np.nanmin(mesh.doubt) >= 0 and 6 < mesh.size < 10


def test_what_is_no_touch_is_said_and_nothing_is_lost() -> None:
    rows, said = touches(12), list[str]()
    loop = palpate.LiveLoop(say=said.append)
    faults = [None, (1, 2), "words", {"x": 1}, {"x": 1, "y": float("inf"), "z": 2}, (1, 2, float("nan")), 7, b"\xff", object()]
    for row, fault in zip(rows, [*faults, *[""] * 3]):
        assert loop.hear(fault) is None
        assert loop.hear(row) is not None
    assert len(said) == loop.left_out == len(faults) and all("no touch, left out" in line and "\n" not in line for line in said)
    last = loop.finish()
    assert last is not None and last.shape == list(palpate.live(rows))[-1].shape
    with pytest.warns(UserWarning, match="no touch, left out"):
        palpate.LiveLoop().hear((1, 2))


def test_late_touches_and_a_sensor_that_starts_anew_are_said_and_count() -> None:
    said = list[str]()
    loop = palpate.LiveLoop(say=said.append)
    for time in (1.0, 2.0, 1.5, 3.0):
        loop.touch(time, 0, 0, time=time)
    for line in ("x,y,z,t", "1,2,3,9", "x,y,z,t", "2,2,3,1"):
        loop.hear(line)
    assert len(loop) == 6 and len(said) == 2
    assert "touch 3: a touch of time 1.5 comes after one of 2" in said[0] and "started anew" in said[1]


def test_a_refused_touch_changes_nothing() -> None:
    loop = palpate.LiveLoop()
    with pytest.raises(palpate.FitError) as caught:
        loop.touch(0, float("nan"), 0)
    assert caught.value.kind == "NotFinite" and caught.value.fields["column"] == "y"
    for wrong in ({"normal": (0, 1)}, {"normal": (0, 0, np.inf)}, {"finger": -1}, {"finger": "a"}):
        with pytest.raises((ValueError, TypeError, OverflowError)):
            loop.touch(0, 0, 0, **wrong)  # type: ignore[arg-type]
    assert len(loop) == 0 and loop.finish() is None
    for words in ({"window": 2}, {"refresh": -1}, {"until_radius": 0}, {"u_s": 1}, {"resume": "nowhere"}, {"reach": (1, 0, 0, 1)}):
        with pytest.raises(palpate.LiveError):
            palpate.LiveLoop(**words)
    with pytest.raises(TypeError):
        list(palpate.live([], loop, window=5))


def test_a_state_goes_from_here_to_the_program_and_back(tmp_path: Path) -> None:
    rows, state = touches(30), tmp_path / "state.json"
    whole = told(palpate.live(rows))
    loop = palpate.LiveLoop()
    for row in rows[:18]:
        loop.hear(row)
    loop.save(state)
    again = told(palpate.live(rows[18:], palpate.LiveLoop(resume=state)))
    assert again[-1] == whole[-1] and again[0]["touch"] == 19
    assert printed(lines(rows[18:]), f"--resume={state}") == again
    printed(lines(rows[:18]), f"--save={state}")
    assert told(palpate.live(rows[18:], palpate.LiveLoop(resume=state))) == again
    for text in ("{}", "x,y,z\n"):
        state.write_text(text, encoding="utf-8")
        with pytest.raises(palpate.LiveError, match="resume"):
            palpate.LiveLoop(resume=state)


def test_fingers_and_tables_are_heard() -> None:
    contacts = bar()
    expected = told(palpate.live([dict(zip(contacts, row)) for row in zip(*contacts.values())]))
    pandas = pytest.importorskip("pandas")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert told(palpate.live(pandas.DataFrame(contacts))) == expected
    loop = palpate.LiveLoop()
    for k, row in enumerate(touches(6)):
        loop.touch(*row[:3], row[3:], finger=k % 2, station=k)
    assert loop.contacts["finger"].tolist() == [0, 1] * 3 and loop.contacts["station"].tolist() == list(range(6))
