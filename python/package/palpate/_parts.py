"""What a body is made of: planes, balls, bars, cones and rings, and how they adjoin.

    contacts  ->  regions  ->  a primitive for each, with the uncertainty of its size
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _native
from ._columns import Columns, columns, is_grid

__all__ = ["Parts", "parts"]


@dataclass(frozen=True)
class Parts:
    """The parts of a body. labels: the part of every contact, counted from 1; 0 is none. document: palpate.parts/1."""

    labels: npt.NDArray[np.uint32]
    document: dict[str, Any]

    @property
    def parts(self) -> list[dict[str, Any]]:
        """One dictionary a part: kind, contacts, size and place, with their uncertainties."""
        found: list[dict[str, Any]] = self.document["parts"]
        return found

    def __len__(self) -> int:
        return len(self.parts)

    def __repr__(self) -> str:
        kinds = ", ".join(str(part.get("kind")) for part in self.parts)
        return f"Parts({len(self)}: {kinds})"


def parts(
    x: Any,
    y: npt.ArrayLike | None = None,
    z: npt.ArrayLike | None = None,
    *,
    normals: Any = None,
    tolerance: float | None = None,
    viewpoint: tuple[float, float, float] | None = None,
) -> Parts:
    """Cuts contacts into parts, as `palpate parts` does. x, y, z, normals: as in `fit`, or what holds them alone.

    tolerance: departures from a primitive, along the normal, that make no part of their own. viewpoint: where the sensor stood.
    Raises PalpateError where the contacts are too few or faulty.
    """
    given = columns("parts", Columns(x, y, z, normals))
    if is_grid(given.z):
        raise ValueError("z: parts are cut from places in space, x, y and z of one length each")
    seen = None if viewpoint is None else tuple(float(v) for v in viewpoint)
    text, labels = _native.parts_of(given.x, given.y, given.z, given.normals, tolerance, seen)
    return Parts(labels, json.loads(text))
