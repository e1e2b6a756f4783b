"""Frontiers: what accuracy costs in time on this machine, and the configuration that keeps a request.

    degree x segments x stations x weights x surface, each timed and judged on the same calls: against the scene's truth,
    or by contacts that were left out
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy.typing as npt

from . import _native
from ._columns import Columns, columns, is_grid
from ._errors import FrontierError, in_python
from ._line import flags, source
from ._tables import html_table, number

if TYPE_CHECKING:
    import pandas

__all__ = ["Frontier", "FrontierPick", "frontier"]

Progress = Callable[[int, int], object]

_AS_THEY_ARE = (
    "frontier", "case", "label", "method", "surface", "weights", "degree", "segments", "stations", "contacts",
    "replicates", "error_S", "error_R", "error", "condition", "digits",
)  # fmt: skip


@dataclass(frozen=True)
class FrontierPick:
    """What was picked: its errors, which at most 5 of 100 fresh replicates exceed, and the median seconds of a fit.

    error_S: rms error of S. error_R: of R, 1/length. met: whether the request is kept; otherwise this is the nearest, and
    obstacle says what stands in the way.
    """

    label: str
    error_S: float | None
    error_R: float | None
    seconds: float
    met: bool
    obstacle: str | None

    @classmethod
    def _of(cls, part: dict[str, Any]) -> FrontierPick:
        return cls(
            part["label"], part["error_S"], part["error_R"], part["seconds"], part["met"], part["obstacle"]
        )  # fmt: skip


class Frontier:
    """Every way of fitting that was measured; the document palpate.frontier/1 behind names."""

    def __init__(self, document: dict[str, Any]) -> None:
        self.document = document

    @property
    def points(self) -> list[dict[str, Any]]:
        """One row a point, flat, so that pandas.DataFrame(points) is the table.

        frontier ("discretisation", "solver" or "interval"), case, label, method, surface, weights, degree, segments,
        stations, contacts, replicates; error_S, error_R (1/length): rms over points and replicates; error: what the
        pictures show; condition, digits; seconds of a call with seconds_lo and seconds_hi at 95 %; seconds_interval: of a
        call with intervals; coverage_S, coverage_R; memory_bytes; support; on_frontier; failed: why there is no answer.
        """
        return [_row(point) for point in self.document["points"]]

    @property
    def pick(self) -> FrontierPick | None:
        """What was picked, where something was asked."""
        part = self.document["pick"]
        return None if part is None else FrontierPick._of(part)

    @property
    def scene(self) -> str | None:
        """The scene with what was picked, as TOML: `study` and the others take it."""
        part = self.document["pick"]
        return None if part is None else part["scene"]

    @property
    def shortlist(self) -> list[dict[str, Any]]:
        """The rows of `points` that `palpate frontier` prints first: five at most, the quickest first."""
        rows = self.points
        return [rows[place] for place in self.document["shortlist"]]

    @property
    def recommended(self) -> str | None:
        """The label of the way to take where nothing is asked for."""
        part = self.document["recommended"]
        return None if part is None else part["label"]

    @property
    def stages(self) -> list[dict[str, Any]]:
        """Where the time of a fit and of a replicate goes: of, stage, seconds, share, saved_by."""
        return list(self.document["stages"])

    @property
    def notes(self) -> list[str]:
        """What the user should know, in whole sentences."""
        return [in_python(note) for note in self.document["notes"]]

    def to_dict(self) -> dict[str, Any]:
        """The document palpate.frontier/1: what `palpate frontier --json` prints."""
        return self.document

    def to_pandas(self) -> pandas.DataFrame:
        """The points, one row each; `from_pandas` goes back."""
        import pandas

        frame = pandas.DataFrame(self.points)
        frame.attrs["palpate"] = json.dumps(self.document)
        return frame

    @classmethod
    def from_pandas(cls, frame: pandas.DataFrame) -> Frontier:
        """The frontier whose points a DataFrame of `to_pandas` holds."""
        return cls(json.loads(frame.attrs["palpate"]))

    def __eq__(self, other: object) -> bool:
        return self.document == other.document if isinstance(other, Frontier) else NotImplemented

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        pick = self.pick
        picked = "" if pick is None else f", picked {pick.label}{'' if pick.met else ' (the request is not met)'}"
        return f"Frontier({self.document['scene']}, {len(self.document['points'])} points{picked})"

    def _repr_html_(self) -> str:
        best = [row for row in self.points if row["on_frontier"] and row["frontier"] == "discretisation"]
        best.sort(key=lambda row: row["seconds"] or 0.0)
        rows = [
            [row["label"], number(row["error_S"], 2), number(row["error_R"], 2), _microseconds(row["seconds"])]
            for row in best
        ]
        return html_table(repr(self), ["not beaten by any other", "error of S", "error of R", "us"], rows)


def _microseconds(seconds: float | None) -> str:
    return number(None if seconds is None else 1e6 * seconds, 3)


def _row(point: dict[str, Any]) -> dict[str, Any]:
    row = {name: point[name] for name in _AS_THEY_ARE}
    row["degree"], row["segments"] = tuple(point["degree"]), tuple(point["segments"])
    seconds, interval = point["seconds"] or {}, point["seconds_interval"] or {}
    row.update({"seconds": seconds.get("median"), "seconds_lo": seconds.get("lo"), "seconds_hi": seconds.get("hi")})
    row["seconds_interval"] = interval.get("median")
    for name in ("S", "R"):
        row[f"coverage_{name}"] = (point["coverage"][name] or {}).get("share")
    return {**row, **{name: point[name] for name in ("memory_bytes", "support", "on_frontier", "failed")}}


def frontier(
    scene: Any,
    y: npt.ArrayLike | None = None,
    z: npt.ArrayLike | None = None,
    *,
    normals: Any = None,
    slopes: Any = None,
    wz: npt.ArrayLike | None = None,
    wx: npt.ArrayLike | None = None,
    wy: npt.ArrayLike | None = None,
    flip_normals: bool = False,
    error_s: float | None = None,
    error_r: float | None = None,
    budget: float | str | None = None,
    keep_stations: bool = False,
    seed: int | None = None,
    seconds: float | None = None,
    bare: bool = False,
    progress: Progress | None = None,
) -> Frontier:
    """Measures what accuracy costs in time here, and picks the configuration that keeps a request.

    scene: a built-in name, a file, or TOML text; its ways of fitting are judged by its truth. The words are those of
    `palpate frontier`: error_s, error_r (1/length) ask for the cheapest fit whose rms error stays below in 95 of 100 runs;
    budget, in seconds or as "50us", asks for the most accurate within it. keep_stations leaves the number of stations as
    the scene has it; seconds is the time for timing the ways of fitting (18 where nothing is said); bare=True times them
    alone, without intervals, solvers and stages.

    Contacts instead of a scene: frontier(x, y, z, normals=...) as for `fit`, each (g,), or a table, or a file; 30 or more.
    They have no truth, and are judged by those that were left out, a fifth at a time: `error` is that of their heights,
    the noise included, and no error of S or R can be asked for; budget can. keep_stations, seed and bare say nothing then.

    progress(done, of) is called meanwhile, as `tqdm` likes it. Ctrl-C ends it with KeyboardInterrupt, between two timed
    calls, or within some seconds where a reference or stages are made. Instructions are counted by `palpate frontier`
    alone. Times are those of one thread of a machine that should have nothing else to do.

    Raises FrontierError; FitError where contacts are none, with kind and fields; TypeError and ValueError that name the
    argument.

    >>> found = frontier("paper-cylinder", error_s=0.05, keep_stations=True, bare=True, seconds=0.1)
    >>> found.pick.met, "[fit]" in found.scene
    (True, True)
    >>> import palpate
    >>> contacts = palpate.simulate("paper-table2")
    >>> measured = frontier(contacts, budget="10ms", seconds=0.1)
    >>> measured.pick.label in {point["label"] for point in measured.points}
    True
    """
    within = f"{budget}s" if isinstance(budget, (int, float)) else budget
    options = {
        "error_s": error_s, "error_r": error_r, "budget": within, "keep_stations": bool(keep_stations), "seed": seed,
        "seconds": seconds, "all": not bare, "stages": not bare, "quiet": True,
    }  # fmt: skip
    words = flags("frontier", options, {})
    if isinstance(scene, (str, PathLike)):
        arrays = {"y": y, "z": z, "normals": normals, "slopes": slopes, "wz": wz, "wx": wx, "wy": wy}
        strange = [name for name, given in arrays.items() if given is not None] or ["flip_normals"] * flip_normals
        if strange:
            raise TypeError(f"{strange[0]}: a scene, or a file, has its own contacts; arrays are for frontier(x, y, z)")
        name, text = source(scene)
        return _read(_native.frontier([*words, "--", name], text, progress))
    given = columns("frontier", Columns(scene, y, z, normals, slopes, (wz, wx, wy)))
    if is_grid(given.z):
        raise ValueError("z: a grid cannot be judged by pixels that were left out, which its neighbours nearly repeat")
    x, y, z, normals, slopes, weights, _ = given
    line = [*words, "--", "contacts"]
    return _read(
        _native.frontier_of_contacts(x, y, z, normals, slopes, weights, flip_normals, line, progress)
    )


def _read(document: bytes) -> Frontier:
    found: dict[str, Any] = json.loads(document)
    if found.get("schema") != "palpate.frontier/1":
        raise FrontierError("this is no document of a frontier: its schema is not palpate.frontier/1", "Schema")
    return Frontier(found)
