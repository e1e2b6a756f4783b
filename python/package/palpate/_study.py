"""Studies: a scene touched and fitted again and again, and what its noise makes of S and R.

    study(scene)                     = merge of the parts study(scene, range=(a, b)) that make 0 .. replicates, to the bit
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import _native
from ._errors import StudyError, in_python
from ._line import FIT_WORDS, flag, source
from ._tables import html_table, number

if TYPE_CHECKING:
    import pandas
    import xarray

__all__ = ["Study", "StudyMeasure", "merge", "scene", "scenes", "simulate", "study"]

Progress = Callable[[int, int], object]

_STUDY_WORDS = (
    "replicates", "seed", "level", "tolerance", "rule", "budget", "quantity", "quantile", "path", "attribution",
)  # fmt: skip
# where the time went is no part of the numbers
_CLOCK = ("seconds", "replicates_per_second")


@dataclass(frozen=True)
class StudyMeasure:
    """One quantity over the replicates: mean, sd, interval (lo, hi) at the study's level; truth, and bias (mean less truth)."""

    mean: float | None
    sd: float | None
    bias: float | None
    lo: float | None
    hi: float | None
    shortest: tuple[float, float] | None
    standard_error: float | None
    truth: float | None

    @classmethod
    def _of(cls, part: dict[str, Any]) -> StudyMeasure:
        ends = part.get("shortest")
        return cls(
            mean=part.get("mean"),
            sd=part.get("sd"),
            bias=part.get("bias"),
            lo=part.get("lo"),
            hi=part.get("hi"),
            shortest=None if ends is None else (ends[0], ends[1]),
            standard_error=part.get("standard_error"),
            truth=part.get("truth"),
        )


class Study:
    """What replicates came to; the document palpate.study/1 behind names.

    `part` holds the bytes of the file that `palpate study --range A:B --part F` writes, for `merge`.
    """

    def __init__(
        self, document: dict[str, Any], part: bytes = b"", values: dict[str, npt.NDArray[np.float64]] | None = None
    ) -> None:
        self.document = document
        self.part = part
        self.values = values or {}

    @property
    def S(self) -> StudyMeasure:
        """Shape index."""
        return StudyMeasure._of(self.document["S"])

    @property
    def R(self) -> StudyMeasure:
        """Curvedness, 1/length."""
        return StudyMeasure._of(self.document["R"])

    @property
    def quantities(self) -> dict[str, StudyMeasure]:
        """S, R and those that were asked for beside them."""
        others = self.document.get("quantities") or {}
        return {"S": self.S, "R": self.R, **{name: StudyMeasure._of(part) for name, part in others.items()}}

    @property
    def replicates(self) -> int:
        """Replicates that were done."""
        return int(self.document["replicates"])

    @property
    def class_shares(self) -> dict[str, float]:
        """How often each class came out."""
        return dict(self.document["class"])

    @property
    def effects(self) -> list[dict[str, Any]]:
        """How much of the noise each effect causes."""
        return list(self.document["effects"])

    @property
    def notes(self) -> list[str]:
        """What the user should know, in whole sentences."""
        return [in_python(note) for note in self.document["notes"]]

    def to_dict(self) -> dict[str, Any]:
        """The document palpate.study/1: what `palpate study --json` prints."""
        return self.document

    def save_part(self, path: str | PathLike[str]) -> None:
        """Writes what the replicates came to, for `merge` and for `palpate merge`."""
        Path(path).write_bytes(self.part)

    def to_pandas(self) -> pandas.DataFrame:
        """One row a quantity; where the values were kept, `pandas.DataFrame(study.values)` has them."""
        import pandas

        rows = {name: (q.truth, q.mean, q.bias, q.sd, q.lo, q.hi) for name, q in self.quantities.items()}
        frame = pandas.DataFrame.from_dict(rows, orient="index", columns=["truth", "mean", "bias", "sd", "lo", "hi"])
        frame.attrs["palpate"] = json.dumps(self.document)
        return frame

    @classmethod
    def from_pandas(cls, frame: pandas.DataFrame) -> Study:
        """The study whose quantities a DataFrame of `to_pandas` holds."""
        return cls(json.loads(frame.attrs["palpate"]))

    def to_xarray(self) -> xarray.Dataset:
        """The kept values over `replicate`, with the document in the attributes; `from_xarray` goes back."""
        import xarray

        first = self.document["range"][0]
        count = len(next(iter(self.values.values()))) if self.values else 0
        variables = {name: ("replicate", column) for name, column in self.values.items()}
        attributes = {"palpate": json.dumps(self.document)}
        return xarray.Dataset(variables, coords={"replicate": np.arange(first, first + count)}, attrs=attributes)

    @classmethod
    def from_xarray(cls, dataset: xarray.Dataset) -> Study:
        """The study that a Dataset of `to_xarray` holds."""
        values = {str(name): np.asarray(column) for name, column in dataset.data_vars.items()}
        return cls(json.loads(dataset.attrs["palpate"]), b"", values)

    def __eq__(self, other: object) -> bool:
        """Whether two studies have the same numbers, wherever and however fast they were made."""
        if not isinstance(other, Study):
            return NotImplemented
        own, theirs = ({k: v for k, v in s.document.items() if k not in _CLOCK} for s in (self, other))
        return own == theirs

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        s, r = self.S, self.R
        return (
            f"Study({self.document['scene']}, {self.replicates} replicates, S = {number(s.mean)} (sd {number(s.sd, 2)}), "
            f"R = {number(r.mean)} (sd {number(r.sd, 2)}))"
        )

    def _repr_html_(self) -> str:
        head = ["", "mean", "sd", "bias", f"{100 * self.document['level']:g} % from", "to"]
        rows = [
            [name, *(number(value) for value in (q.mean, q.sd, q.bias, q.lo, q.hi))] for name, q in self.quantities.items()
        ]
        return html_table(f"{self.document['scene']}, {self.replicates} replicates", head, rows)


def arguments(scene: str, options: dict[str, Any]) -> list[str]:
    """The arguments of `palpate study` that these options are."""
    repeated = ("quantity",)
    strange = [name for name in options if name not in FIT_WORDS and name not in _STUDY_WORDS]
    if strange:
        raise TypeError(f"study() got an unexpected keyword argument {strange[0]!r}")
    flags: list[str] = []
    for name, value in options.items():
        if name in repeated:
            entries = [value] if isinstance(value, str) else value or []
            flags += [word for entry in entries for word in flag(name, entry)]
        else:
            flags += flag(name, value)
    return [scene, *flags]


def study(
    scene: str | PathLike[str],
    replicates: int | None = None,
    *,
    seed: int | None = None,
    level: float | None = None,
    tolerance: int | None = None,
    rule: str | None = None,
    budget: float | None = None,
    range: tuple[int, int] | None = None,
    quantity: str | Sequence[str] = (),
    quantile: Sequence[float] | None = None,
    path: str | None = None,
    attribution: int | None = None,
    threads: int | None = None,
    keep_values: bool = False,
    progress: Progress | None = None,
    **fit: Any,
) -> Study:
    """Repeats a scene's fit for noise.

    scene: a built-in name, a file, or TOML text. The words are those of `palpate study`: tolerance is a number of
    significant digits, budget seconds, range=(a, b) does replicates a to b alone (b left out), of which `merge` makes the
    bits of one run. fit: degree, segments, weights, sigma and the like, over those of the scene. keep_values keeps every
    replicate's S, R and other quantities in `values`. progress(done, of) is called after chunks, as `tqdm` likes it:

        with tqdm() as bar:
            palpate.study("paper-table2", progress=lambda done, of: bar.update(done - bar.n))

    Ctrl-C ends the study with KeyboardInterrupt. Raises StudyError.

    >>> found = study("paper-table2", 2000, attribution=0)
    >>> found.replicates, found.S.lo < found.S.mean < found.S.hi
    (2000, True)
    """
    name, text = source(scene)
    options = {
        "replicates": replicates, "seed": seed, "level": level, "tolerance": tolerance, "rule": rule, "budget": budget,
        "quantity": quantity, "quantile": quantile, "path": path, "attribution": attribution, **fit,
    }  # fmt: skip
    plan = _native.StudyPlan(arguments(name, options), text)
    run = plan.run(range, threads, keep_values, True, progress)
    return Study(json.loads(run.document), run.part, run.values)


def merge(parts: Sequence[str | PathLike[str]]) -> Study:
    """Joins the files of parts, in any order, to the numbers of one run.

    Raises StudyError where a part is missing, stands twice, or is of another study, version or instruction set.
    """
    if not parts:
        raise StudyError("parts: there are none to join", "Parts")
    return Study(json.loads(_native.merge_parts([Path(part) for part in parts])))


def scenes() -> dict[str, str]:
    """The built-in scenes, each with a line on it.

    >>> "paper-table2" in scenes()
    True
    """
    return {name: line for name, (line, _) in sorted(_native.scene_texts().items())}


def scene(name: str) -> str:
    """A built-in scene as TOML, to start from.

    >>> "[surface]" in scene("paper-cylinder")
    True
    """
    try:
        return _native.scene_texts()[name][1]
    except KeyError:
        raise StudyError(f"{name!r} is no built-in scene; scenes() lists them", "Scene") from None


def simulate(
    scene: str | PathLike[str], *, seed: int | None = None, replicate: int = 0
) -> dict[str, npt.NDArray[Any]]:
    """The contacts of one replicate: columns x, y, z, nx, ny, nz, finger, station, as `fit` takes them."""
    name, text = source(scene)
    return _native.scene_contacts(name, text, seed, replicate)
