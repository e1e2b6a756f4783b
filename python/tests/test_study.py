"""Studies: parts join to the bits of one run, progress is told, Ctrl-C ends them."""

from __future__ import annotations

import json
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from test_fit import program

import palpate
from palpate.dask import ranges

SCENE = "paper-table2"


def test_parts_join_to_the_bits_of_one_run(tmp_path: Path) -> None:
    whole = palpate.study(SCENE, 8_000, attribution=500, quantity="k1")
    files = []
    for k, span in enumerate(ranges(8_000, 3)):
        part = palpate.study(SCENE, 8_000, attribution=500, quantity="k1", range=span)
        part.save_part(tmp_path / f"part-{k}")
        files.append(tmp_path / f"part-{k}")
    assert palpate.merge(files[::-1]) == whole
    assert list(whole.quantities) == ["S", "R", "k1"]
    with pytest.raises(palpate.StudyError, match="in no part"):
        palpate.merge(files[1:])
    with pytest.raises(palpate.StudyError, match="two parts"):
        palpate.merge([*files, files[0]])


def test_the_program_joins_our_parts_and_we_join_its(tmp_path: Path) -> None:
    name = program()
    if name is None:
        pytest.skip("the program palpate is not built")
    whole = palpate.study(SCENE, 9_000, attribution=0)
    ours, theirs = tmp_path / "ours", tmp_path / "theirs"
    palpate.study(SCENE, 9_000, attribution=0, range=(0, 4_000)).save_part(ours)
    line = [name, "study", SCENE, "--replicates=9000", "--attribution=0", "--range=4000:9000", f"--part={theirs}", "-q"]
    subprocess.run(line, check=True)
    assert palpate.merge([theirs, ours]) == whole
    done = subprocess.run([name, "merge", str(ours), str(theirs), "--json"], check=True, capture_output=True)
    assert palpate.Study(json.loads(done.stdout)) == whole


def test_scenes_by_name_by_text_and_by_file(tmp_path: Path) -> None:
    text = palpate.scene(SCENE)
    file = tmp_path / "scene.toml"
    file.write_text(text)
    by_text, by_file = palpate.study(text, 500, attribution=0), palpate.study(file, 500, attribution=0)
    assert by_text == by_file == palpate.study(SCENE, 500, attribution=0)
    contacts = palpate.simulate(text)
    np.testing.assert_array_equal(contacts["z"], palpate.simulate(SCENE)["z"])
    assert not np.array_equal(contacts["z"], palpate.simulate(SCENE, replicate=1)["z"])


def test_threads_change_nothing_and_values_are_kept() -> None:
    one = palpate.study(SCENE, 3_000, attribution=0, threads=1, keep_values=True)
    two = palpate.study(SCENE, 3_000, attribution=0, threads=2)
    assert one == two and set(one.values) == {"S", "R"} and len(one.values["S"]) == 3_000
    assert abs(one.values["R"].mean() - one.R.mean) < 1e-12
    assert pickle.loads(pickle.dumps(one)) == one
    assert SCENE[:5] in repr(one) or "replicates" in repr(one)
    pytest.importorskip("pandas"), pytest.importorskip("xarray")
    assert palpate.Study.from_pandas(one.to_pandas()) == one
    back = palpate.Study.from_xarray(one.to_xarray())
    assert back == one and np.array_equal(back.values["R"], one.values["R"])


def test_progress_is_told_on_the_calling_thread() -> None:
    told: list[tuple[int, int]] = []

    def progress(done: int, of: int) -> None:
        assert threading.current_thread() is threading.main_thread()
        told.append((done, of))

    palpate.study(SCENE, 100_000, attribution=0, progress=progress)
    assert told == sorted(told) and told[-1] == (100_000, 100_000)


@pytest.mark.skipif(os.name == "nt", reason="signals")
def test_ctrl_c_ends_a_study_soon() -> None:
    threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        palpate.study(SCENE, 2_000_000_000, attribution=0)
    assert time.monotonic() - began < 20


def test_the_interpreter_goes_on_meanwhile() -> None:
    ticks = 0

    def tick() -> None:
        nonlocal ticks
        while worker.is_alive():
            ticks += 1
            time.sleep(0.001)

    worker = threading.Thread(target=lambda: palpate.study(SCENE, 200_000, attribution=0))
    worker.start()
    tick()
    assert ticks > 10


def test_import_without_what_is_optional() -> None:
    code = "import sys; sys.modules.update(dict.fromkeys(['dask', 'pandas', 'xarray', 'scipy', 'distributed'])); import palpate, palpate.dask"
    subprocess.run([sys.executable, "-c", code], check=True)
