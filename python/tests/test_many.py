"""fit_many gives every patch the numbers of fit."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from conftest import Columns, bar, normals

import palpate


@pytest.fixture
def batch() -> dict[str, np.ndarray]:
    patches = [bar(6, radius) for radius in (4.0, 6.0, 9.0, 30.0)]
    return {name: np.array([patch[name] for patch in patches]) for name in patches[0]}


def test_every_patch_has_the_numbers_of_its_own_fit(batch: Columns) -> None:
    n = np.stack(normals(batch), axis=-1)
    found = palpate.fit_many(batch["x"], batch["y"], batch["z"], normals=n, degree=(4, 2))
    for k in range(4):
        own = palpate.fit(batch["x"][k], batch["y"][k], batch["z"][k], normals=n[k], degree=(4, 2)).shape
        numbers = (own.S.mean, own.S.u_noise, own.R.mean, own.R.u_noise, own.radius, own.direction_deg)
        columns = (found.shape_index, found.shape_index_u, found.curvedness, found.curvedness_u, found.radius)
        assert numbers == (*(column[k] for column in columns), found.direction_deg[k])
    assert found.class_name == ["ridge"] * 4 and not found.failed
    shared = palpate.fit_many(batch["x"][0], batch["y"][0], batch["z"], normals=n, degree=(4, 2), threads=1)
    np.testing.assert_array_equal(shared.curvedness, found.curvedness)
    assert pickle.loads(pickle.dumps(found)).class_name == found.class_name
    assert "ridge" in found._repr_html_()


def test_ragged_patches_and_failures_do_not_touch_the_others(batch: Columns) -> None:
    good = bar(5)
    bad = {name: np.zeros(3) for name in good}
    bad["nz"] = np.ones(3)
    flat = {name: np.concatenate([good[name], bad[name], good[name]]) for name in good}
    n = np.stack(normals(flat), axis=-1)
    found = palpate.fit_many(flat["x"], flat["y"], flat["z"], normals=n, offsets=[0, 25, 28, 53], degree=3)
    own = palpate.fit(good, degree=3).shape
    assert found.curvedness[0] == found.curvedness[2] == own.R.mean
    assert np.isnan(found.curvedness[1]) and list(found.failed) == [1] and "line" in found.failed[1]
    assert found.class_name == ["ridge", None, "ridge"]


def test_tiles_of_an_image() -> None:
    x, y = np.arange(64.0), np.arange(48.0)
    image = 0.01 * (x[:, None] - 31.5) ** 2 + 0 * y
    cut = palpate.tiles(image, 16)
    assert cut.shape == (12, 16, 16)
    np.testing.assert_array_equal(cut[4], image[16:32, 16:32])
    found = palpate.fit_many(np.arange(16.0), np.arange(16.0), cut, weights="equal", bare=True)
    assert set(found.class_name) == {"rut"}
    own = palpate.fit(np.arange(16.0), np.arange(16.0), cut[5], weights="equal", bare=True).shape
    assert found.curvedness[5] == own.R.mean


def test_the_number_of_threads_changes_nothing_and_progress_is_told(batch: Columns) -> None:
    x, y, z = (np.tile(batch[name], (400, 1)) for name in "xyz")
    told: list[tuple[int, int]] = []
    one = palpate.fit_many(x, y, z, degree=2, weights="equal", threads=1, progress=lambda *now: told.append(now))
    two = palpate.fit_many(x, y, z, degree=2, weights="equal", threads=2)
    for name in one.columns:
        np.testing.assert_array_equal(one.columns[name], two.columns[name])
    assert told[-1] == (1600, 1600)


def test_an_exception_in_the_callback_comes_out(batch: Columns) -> None:
    def stop(done: int, of: int) -> None:
        raise RuntimeError("enough")

    z = np.tile(batch["z"], (2000, 1))
    with pytest.raises(RuntimeError, match="enough"):
        palpate.fit_many(batch["x"][0], batch["y"][0], z, degree=2, progress=stop)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"z": np.zeros(4)}, "z has shape"),
        ({"x": np.zeros(3)}, "do not go with z"),
        ({"normals": np.zeros((4, 36))}, "normals has shape"),
        ({"offsets": [0, 5]}, "with offsets"),
        ({"threads": 0}, "threads"),
        ({"x": np.zeros(0), "y": np.zeros(0), "z": np.zeros(0), "offsets": [1, 0]}, "offsets"),
    ],
)
def test_wrong_shapes_are_named(batch: Columns, given: dict, words: str) -> None:
    arguments = {"x": batch["x"], "y": batch["y"], "z": batch["z"], "degree": 2, **given}
    with pytest.raises(ValueError, match=words):
        palpate.fit_many(**arguments)


def test_no_patches_at_all() -> None:
    assert len(palpate.fit_many(np.zeros((0, 9)), np.zeros((0, 9)), np.zeros((0, 9)), degree=2)) == 0
