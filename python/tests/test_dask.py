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


def test_many_patches_over_blocks(cluster) -> None:
    array = pytest.importorskip("dask.array")
    x, y = (a.ravel() for a in np.meshgrid(np.linspace(-1, 1, 6), np.linspace(-1, 1, 6)))
    z = np.linspace(0.1, 0.4, 40)[:, None] * (x**2 + y**2)
    expected = palpate.fit_many(x, y, z, degree=2, weights="equal")
    found = palpate.dask.fit_many(x, y, array.from_array(z, chunks=(9, 20)), degree=2, weights="equal")
    np.testing.assert_array_equal(found.curvedness, expected.curvedness)
    assert found.class_name == expected.class_name
