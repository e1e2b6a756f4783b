"""A study of 10^11 replicates: what holds of its numbers, its sums, its parts and its words, without its core-days.

The last replicates of such a study are computed; the others stand in for by copies of them, in a part whose counts and
exact sums are those of so many replicates.
"""

from __future__ import annotations

import json
import struct
import subprocess
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from test_fit import program

import palpate
from palpate.dask import MOST_IN_A_PART, ranges, shared_out

WHOLE = 10**11
# one factor serves all replicates of the first, every replicate of the second is fitted for itself
WIDE = palpate.scene("paper-cylinder").replace("[fit]\n", "[fit]\ndomain = [-5.0, 5.0, -5.0, 5.0]\n")
STILL = WIDE + "\n[effects.row_noise]\nsigma_z = 0.02\nsigma_slope = 0.05\n"
MOVED = WIDE + "\n[effects.position_noise]\nsigma = 0.02\n"
LAST = 50_000
MAGIC = b"palpate study 1\n"


def study(scene: str, start: int, stop: int, **more: object) -> palpate.Study:
    return palpate.study(scene, WHOLE, seed=11, attribution=0, range=(start, stop), **more)


@pytest.mark.parametrize("scene", [STILL, MOVED], ids=["still", "moved"])
def test_replicates_at_the_far_end_do_not_know_how_they_were_split(scene: str) -> None:
    start = WHOLE - 3_000
    whole = study(scene, start, WHOLE, keep_values=True).values
    edges = [start, start + 1, start + 33, start + 1_024, WHOLE - 31, WHOLE]
    parts = [study(scene, a, b, keep_values=True, threads=1 + a % 2).values for a, b in zip(edges, edges[1:])]
    for name in ("S", "R"):
        np.testing.assert_array_equal(np.concatenate([part[name] for part in parts]), whole[name])
    near = study(scene, 0, 3_000, keep_values=True).values
    assert not np.isin(near["S"], whole["S"]).any()


@pytest.mark.parametrize("scene", [STILL, MOVED], ids=["still", "moved"])
def test_the_last_replicate_is_the_fit_of_the_last_contacts(scene: str) -> None:
    # the simulation draws its numbers one by one, the study in blocks of its own kernels
    values = study(scene, WHOLE - 5, WHOLE, keep_values=True).values
    for back in range(1, 6):
        contacts = palpate.simulate(scene, seed=11, replicate=WHOLE - back)
        found = palpate.fit(contacts, degree=2, weights="tangent", grid=8, domain=[-5, 5, -5, 5], bare=True).shape
        assert found.S.mean == pytest.approx(values["S"][-back], rel=1e-12)
        assert found.R.mean == pytest.approx(values["R"][-back], rel=1e-12)


def checksum(content: bytes) -> bytes:
    found = 0xCBF29CE484222325
    for byte in content:
        found = (found ^ byte) * 0x100000001B3 & 0xFFFFFFFFFFFFFFFF
    return struct.pack("<Q", found)


def copied(part: bytes, start: int, stop: int, times: int) -> bytes:
    """A part of replicates start to stop that holds those of `part` so many times."""
    assert part.startswith(MAGIC)
    (length,) = struct.unpack_from("<Q", part, len(MAGIC))
    begin = len(MAGIC) + 8
    header = json.loads(part[begin : begin + length])
    words = np.frombuffer(part[begin + length : -8], "<u8").copy()
    # a word for the bin and one for its count
    words[1::2] *= times
    header["range"] = header["seen"] = [start, stop]
    header["classes"] = [times * count for count in header["classes"]]
    for tally in header["tallies"]:
        assert tally["bins"] is not None
        tally["count"] *= times
        for name in ("sum", "squares"):
            total = times * sum(digit << 32 * k for k, digit in enumerate(tally[name]))
            low = [total >> 32 * k & 0xFFFFFFFF for k in range(len(tally[name]) - 1)]
            tally[name] = [*low, total >> 32 * len(low)]
    text = json.dumps(header, separators=(",", ":")).encode()
    made = MAGIC + struct.pack("<Q", len(text)) + text + words.tobytes()
    return made + checksum(made)


@pytest.fixture(scope="module")
def parts(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The part before the last replicates as `before`, and those as one and as three parts."""
    folder = tmp_path_factory.mktemp("parts")
    last = study(STILL, WHOLE - LAST, WHOLE)
    last.save_part(folder / "last")
    (folder / "before").write_bytes(copied(last.part, 0, WHOLE - LAST, WHOLE // LAST - 1))
    edges = [WHOLE - LAST, WHOLE - LAST + 7, WHOLE - 20_001, WHOLE]
    for k, (a, b) in enumerate(zip(edges, edges[1:])):
        study(STILL, a, b).save_part(folder / f"split-{k}")
    return folder


def test_parts_of_so_many_join_to_the_same_bits(parts: Path) -> None:
    whole = palpate.merge([parts / "before", parts / "last"])
    split = palpate.merge([parts / "split-2", parts / "before", parts / "split-0", parts / "split-1"])
    assert split == whole
    document = whole.document
    assert document["range"] == [0, WHOLE] and document["replicates"] == WHOLE and type(document["replicates"]) is int
    # two million copies have the mean of one, and its sd but for n - 1
    values = study(STILL, WHOLE - LAST, WHOLE, keep_values=True).values
    for name, measure in (("S", whole.S), ("R", whole.R)):
        assert measure.mean == pytest.approx(values[name].mean(), rel=1e-14)
        assert measure.sd == pytest.approx(values[name].std(), rel=1e-10)
        resolution = document[name]["resolution"]
        assert abs(measure.lo - np.quantile(values[name], 0.025)) < 2e-4 and 0 < resolution < 1e-5
        assert 0 < document[name]["standard_error"]["mean"] == pytest.approx(measure.sd / WHOLE**0.5, rel=1e-9)
    assert sum(whole.class_shares.values()) == pytest.approx(1.0, abs=1e-12)
    with pytest.raises(palpate.StudyError, match="99999950000"):
        palpate.merge([parts / "before", parts / "split-1", parts / "split-2"])


def test_the_program_joins_them_and_writes_whole_numbers(parts: Path) -> None:
    name = program()
    if name is None:
        pytest.skip("the program palpate is not built")
    line = [name, "merge", parts / "split-1", parts / "before", parts / "split-2", parts / "split-0", "--json"]
    text = subprocess.run(line, check=True, capture_output=True, text=True).stdout
    assert '"replicates": 100000000000,' in text and "e11" not in text
    assert palpate.Study(json.loads(text)) == palpate.merge([parts / "before", parts / "last"])
    said = subprocess.run(line[:-1], check=True, capture_output=True, text=True).stdout
    assert "100000000000 replicates" in said


def test_progress_counts_to_it() -> None:
    told: list[tuple[int, int]] = []

    def progress(done: int, of: int) -> None:
        told.append((done, of))
        raise InterruptedError

    with pytest.raises(InterruptedError):
        palpate.study(STILL, WHOLE, attribution=0, progress=progress)
    assert told[0][1] == WHOLE and 0 < told[0][0] < WHOLE


@given(st.integers(1, 1 << 40), st.integers(1, 5_000))
def test_ranges_are_the_whole_whatever_their_number(replicates: int, threads: int) -> None:
    spans = shared_out(replicates, threads)
    assert spans[0][0] == 0 and spans[-1][1] == replicates
    assert all(a[1] == b[0] for a, b in zip(spans, spans[1:]))
    lengths = [b - a for a, b in spans]
    assert 0 < min(lengths) and max(lengths) <= MOST_IN_A_PART and max(lengths) - min(lengths) <= 1


def test_ranges_of_so_many() -> None:
    assert ranges(WHOLE, 1000)[-1] == (99_900_000_000, WHOLE)
    assert len(shared_out(WHOLE, 16)) == 373


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ({"replicates": (1 << 40) + 1}, "2.40"),
        ({"replicates": WHOLE, "range": (WHOLE - 1, WHOLE + 1)}, "99999999999:100000000001"),
        ({"replicates": WHOLE, "range": (WHOLE, WHOLE)}, "100000000000:100000000000"),
    ],
)
def test_beyond_the_end(words: dict, said: str) -> None:
    with pytest.raises(palpate.StudyError, match=said):
        palpate.study(STILL, **words)
