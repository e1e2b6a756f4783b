"""A cluster gives the bits of one process, whatever happens to its workers."""

from __future__ import annotations

import os
import signal
import threading
import time

import numpy as np
import pytest

import palpate

distributed = pytest.importorskip("distributed")
import palpate.dask  # noqa: E402

SCENE = "paper-table2"


@pytest.fixture(scope="module")
def cluster():
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=50
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


@pytest.fixture(scope="module")
def alone() -> palpate.Study:
    return palpate.study(SCENE, 60_000, attribution=0)


def test_the_bits_of_one_process(cluster, alone: palpate.Study) -> None:
    told: list[tuple[int, int]] = []
    found = palpate.dask.study(SCENE, 60_000, cluster, attribution=0, progress=lambda *now: told.append(now))
    assert found == alone and told[-1] == (60_000, 60_000)


def test_a_worker_killed_in_the_middle(cluster) -> None:
    n = 400_000
    expected = palpate.study(SCENE, n, attribution=0)
    victims = list(cluster.run(os.getpid).values())
    parts: list[int] = []

    def progress(done: int, of: int) -> None:
        parts.append(done)
        if len(parts) == 3:
            os.kill(victims[0], signal.SIGKILL)

    found = palpate.dask.study(SCENE, n, cluster, parts=24, attribution=0, progress=progress)
    assert found == expected
    deadline = time.monotonic() + 60
    while len(cluster.scheduler_info()["workers"]) < 2 and time.monotonic() < deadline:
        time.sleep(0.2)
    assert victims[0] not in cluster.run(os.getpid).values()


def test_a_part_done_twice_is_the_same_part(cluster, alone: palpate.Study) -> None:
    line, span = palpate.dask.arguments(SCENE, {"replicates": 1000, "attribution": 0}), (10, 500)
    def body(part: bytes) -> bytes:
        # all but the seconds that it took, which stand in the header
        import re

        return re.sub(rb'"seconds":[-+0-9.e]+', b"", part)[:-8]

    one, two = palpate.dask.part(line, None, span), palpate.dask.part(line, None, span, 2)
    strip = (b"palpate study 1\n", 8)
    cut = len(strip[0]) + strip[1]
    assert body(one)[cut:] == body(two)[cut:]
    both = []
    threads = [
        threading.Thread(target=lambda: both.append(palpate.dask.study(SCENE, 60_000, cluster, attribution=0)))
        for _ in range(2)
    ]
    [thread.start() for thread in threads], [thread.join() for thread in threads]
    assert both == [alone, alone]


def test_what_does_not_belong_on_a_cluster_is_refused(cluster) -> None:
    with pytest.raises(palpate.StudyError, match="tolerance"):
        palpate.dask.study(SCENE, 100, cluster, tolerance=2)
    with pytest.raises(TypeError, match="nonsense"):
        palpate.dask.study(SCENE, 100, cluster, nonsense=2)
    with pytest.raises(palpate.StudyError):
        palpate.dask.study("nowhere", 100, cluster)


def patches() -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Forty bowls, touched at places of their own: x, y, z (40, 36) and normals (40, 36, 3)."""
    random = np.random.default_rng(5)
    x, y = random.uniform(-1, 1, (2, 40, 36))
    bend = np.linspace(0.1, 0.4, 40)[:, None]
    return x, y, bend * (x**2 + y**2), np.stack([-2 * bend * x, -2 * bend * y, 1 + 0 * x], axis=-1)


def same(found: palpate.FitMany, expected: palpate.FitMany) -> None:
    for name, column in expected.columns.items():
        np.testing.assert_array_equal(found.columns[name], column)
    assert found.class_name == expected.class_name and found.failed == expected.failed


def test_many_patches_over_blocks(cluster) -> None:
    array = pytest.importorskip("dask.array")
    x, y, z, normals = patches()
    words = {"degree": 2, "weights": "tangent"}
    expected = palpate.fit_many(x, y, z, normals=normals, **words)
    lazy = [array.from_array(a, chunks=(rows, 20)) for a, rows in ((x, 40), (y, 7), (z, 9))]
    slanted = array.from_array(normals, chunks=(13, 36, 1))
    same(palpate.dask.fit_many(*lazy, normals=slanted, **words), expected)
    same(palpate.dask.fit_many(x, y, lazy[2], cluster, normals=normals, **words), expected)
    shared = palpate.fit_many(x[0], y[0], z, **words | {"weights": "equal"})
    same(palpate.dask.fit_many(x[0].tolist(), y[0], lazy[2], **words | {"weights": "equal"}), shared)


def test_ragged_patches_begin_in_any_block(cluster) -> None:
    array = pytest.importorskip("dask.array")
    x, y, z, normals = (a.reshape(1440, *a.shape[2:]) for a in patches())
    offsets = [0, 0, 30, 36, 500, 501, 700, 1000, 1440]
    expected = palpate.fit_many(x, y, z, normals=normals, offsets=offsets, degree=2)
    assert sorted(expected.failed) == [0, 4]
    for rows in (100, 499, 501, 1440):
        lazy = [array.from_array(a, chunks=(rows, *a.shape[1:])) for a in (x, y, z, normals)]
        same(palpate.dask.fit_many(*lazy[:3], cluster, normals=lazy[3], offsets=offsets, degree=2), expected)


def test_tiles_of_an_image_that_is_nowhere_whole() -> None:
    array = pytest.importorskip("dask.array")
    image = 0.01 * (np.arange(64.0)[:, None] - 31.5) ** 2 + 0 * np.arange(50.0)
    lazy = palpate.tiles(array.from_array(image, chunks=(20, 30)), 16)
    assert isinstance(lazy, array.Array) and lazy.shape == (12, 16, 16)
    pixels, words = np.arange(16.0), {"weights": "equal", "bare": True}
    same(palpate.dask.fit_many(pixels, pixels, lazy, **words), palpate.fit_many(pixels, pixels, palpate.tiles(image, 16), **words))


@pytest.mark.parametrize(
    ("given", "fault", "words"),
    [
        ({"z": np.zeros((40, 36))}, TypeError, "z: a Dask array wanted"),
        ({"x": np.zeros((39, 36))}, ValueError, "x has 39 rows and z 40"),
        ({"offsets": [0, 39]}, ValueError, "offsets"),
        ({"offsets": [0.0, 40.0]}, ValueError, "offsets"),
        ({"progress": print}, TypeError, "progress"),
        ({"degree": "many"}, (TypeError, ValueError), "degree"),
    ],
)
def test_faults_of_a_batch_name_the_argument(given: dict, fault: type, words: str) -> None:
    array = pytest.importorskip("dask.array")
    x, y, z, _ = patches()
    with pytest.raises(fault, match=words):
        palpate.dask.fit_many(**{"x": x, "y": y, "z": array.from_array(z, chunks=(9, 36)), "degree": 2, **given})


def cloud(count: int = 40_000) -> np.ndarray:
    """A wave with two bumps, touched anywhere; one contact in a hundred far off."""
    random = np.random.default_rng(11)
    x, y = random.uniform(-1, 1, (2, count))
    z = 0.3 * np.sin(1.5 * x) * np.cos(y) + 0.002 * random.standard_normal(count)
    for u, v in ((0.1, 0.1), (-0.5, 0.4)):
        z += 0.05 * np.exp(-((x - u) ** 2 + (y - v) ** 2) / 0.003)
    z += np.where(random.uniform(size=count) < 0.01, random.uniform(size=count), 0)
    return np.stack([x, y, z], axis=1)


def same_fit(found: palpate.Fit, expected: palpate.Fit) -> None:
    one, two = found.to_dict(), expected.to_dict()
    for document in (one, two):
        document.pop("seconds", None), document.pop("provenance", None)
    assert one == two


@pytest.fixture(scope="module")
def whole() -> palpate.Fit:
    found = palpate.fit(cloud(), adaptive=True)
    adaptive = found.to_dict()["fit"]["adaptive"]
    assert adaptive["rounds"] > 2 and adaptive["left_out"] > 0
    return found


@pytest.mark.parametrize("tiles", [1, 4, 9])
def test_any_tiling_gives_the_bits_of_one_memory(cluster, whole: palpate.Fit, tiles: int) -> None:
    same_fit(palpate.dask.fit_adaptive(np.array_split(cloud(), tiles + 2), cluster, tiles=tiles), whole)


def test_frames_arrays_and_delayed_parts_are_fitted_where_they_lie(cluster, whole: palpate.Fit) -> None:
    dask = pytest.importorskip("dask")
    array = pytest.importorskip("dask.array")
    pandas = pytest.importorskip("pandas")
    chunked = array.from_array(cloud(), chunks=(7_000, 2))
    same_fit(palpate.dask.fit_adaptive(chunked, cluster), whole)
    lazy = [dask.delayed(lambda k: np.array_split(cloud(), 3)[k])(k) for k in range(3)]
    same_fit(palpate.dask.fit_adaptive(lazy, cluster), whole)
    frames = [pandas.DataFrame(part, columns=["x", "y", "z"]) for part in np.array_split(cloud(), 2)]
    same_fit(palpate.dask.fit_adaptive(frames, cluster), whole)


def test_a_worker_killed_while_tiles_are_asked(cluster, whole: palpate.Fit, monkeypatch: pytest.MonkeyPatch) -> None:
    victims = list(cluster.run(os.getpid).values())
    asked: list[int] = []
    results = palpate.dask._Workers.results

    def killing(self: palpate.dask._Workers, tasks: list) -> list:
        asked.append(len(tasks))
        # bounds, runs and extents come first: the tiles are held, and half of them are lost
        if len(asked) == 8:
            os.kill(victims[0], signal.SIGKILL)
        return results(self, tasks)

    monkeypatch.setattr(palpate.dask._Workers, "results", killing)
    same_fit(palpate.dask.fit_adaptive(np.array_split(cloud(), 5), cluster, tiles=6), whole)
    assert len(asked) > 12
    deadline = time.monotonic() + 60
    while len(cluster.scheduler_info()["workers"]) < 2 and time.monotonic() < deadline:
        time.sleep(0.2)
    assert victims[0] not in cluster.run(os.getpid).values()


def test_parts_that_do_not_belong_together_are_refused(cluster) -> None:
    bare, normals = cloud(500), np.hstack([cloud(500), np.tile([0.0, 0.0, 1.0], (500, 1))])
    with pytest.raises(palpate.FitError, match="columns that others lack"):
        palpate.dask.fit_adaptive([bare, normals], cluster)
    with pytest.raises(TypeError, match="parts"):
        palpate.dask.fit_adaptive(3, cluster)
    with pytest.raises(ValueError, match="at least one"):
        palpate.dask.fit_adaptive([], cluster)
    with pytest.raises(ValueError, match="smooth"):
        palpate.dask.fit_adaptive([bare], cluster, smooth="auto")
    bad = bare.copy()
    bad[7, 2] = np.nan
    with pytest.raises(palpate.FitError, match="contact 7"):
        palpate.dask.fit_adaptive([bare, bad], cluster)
    found = palpate.dask.fit_adaptive([bare], cluster)
    assert found.to_dict()["contacts"] == 500
    with pytest.raises(palpate.FitError, match="residuals"):
        found.residuals  # noqa: B018
