"""Two fits compared: what `palpate diff` tells."""

from __future__ import annotations

import json
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _native
from ._errors import in_python

if TYPE_CHECKING:
    from ._fit import Fit, Pair

__all__ = ["FitDiff", "diff"]


class FitDiff:
    """Two surfaces compared, each difference against its uncertainty; the document palpate.diff/1 behind names.

    str() gives the table that `palpate diff` prints.
    """

    __slots__ = ("_table", "document")

    def __init__(self, document: dict[str, Any], table: str) -> None:
        self.document = document
        self._table = table

    @property
    def same(self) -> bool | None:
        """Whether they are the same within what the data tell; None where neither carries uncertainties."""
        found: bool | None = self.document["same"]
        return found

    @property
    def differences(self) -> dict[str, dict[str, Any]]:
        """Of height or distance, normal_deg, S and R: mean of the other less this one, rms, largest and where, u, ratio ..."""
        found: dict[str, dict[str, Any]] = self.document["differences"]
        return found

    @property
    def compared(self) -> int:
        """Points at which both surfaces are and contacts support both."""
        return int(self.document["compared"])

    @property
    def threshold(self) -> float:
        """Ratio of a difference to its uncertainty that chance does not exceed."""
        return float(self.document["threshold"])

    @property
    def notes(self) -> list[str]:
        """What the user should know, in whole sentences."""
        return [in_python(note) for note in self.document["notes"]]

    def to_dict(self) -> dict[str, Any]:
        """The document palpate.diff/1: what `palpate diff --json` prints."""
        return self.document

    def __str__(self) -> str:
        return self._table

    def __repr__(self) -> str:
        verdict = {None: "no verdict", True: "the same", False: "not the same"}[self.same]
        ratios = [
            f"{name} {part['ratio']:.2g}" for name, part in self.differences.items() if part["ratio"] is not None
        ]
        largest = f", largest ratios {', '.join(ratios)}" if ratios else ""
        return f"FitDiff({verdict} at {self.compared} points{largest})"


def diff(a: Fit, b: Fit | dict[str, Any] | str | PathLike[str], grid: Pair | None) -> FitDiff:
    """Compares a fit with another, with a document of one, or with a file of a saved surface."""
    own, other = (a._name, a._saved()), _other(b)
    if own[0] == other[0]:
        # messages have to tell them apart
        own, other = (f"{own[0]} (a)", own[1]), (f"{other[0]} (b)", other[1])
    document, table = _native.diff_documents(own, other, grid)
    return FitDiff(json.loads(document), table)


def _other(b: Any) -> tuple[str, bytes]:
    if isinstance(b, (str, PathLike)):
        return fspath(b), Path(b).read_bytes()
    if isinstance(b, dict):
        return "document", json.dumps(b).encode()
    if not hasattr(b, "_saved"):
        raise TypeError("other: a Fit, its document or a path wanted")
    return b._name, b._saved()
