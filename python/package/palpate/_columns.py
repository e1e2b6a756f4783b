"""Contacts and grids as arguments: columns, or one table or DataArray in their place.

    (x, y, z, ...)   |   table with columns x, y, z, ...   |   DataArray over x and y      ->      Columns
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

__all__ = ["Columns", "columns", "is_grid", "is_table"]


class Columns(NamedTuple):
    """What a fit is made of, each as it was given or None. weights: wz, wx, wy. labels: finger, station."""

    x: Any
    y: Any
    z: Any
    normals: Any = None
    slopes: Any = None
    weights: tuple[Any, Any, Any] = (None, None, None)
    labels: tuple[Any, Any] = (None, None)


def columns(verb: str, given: Columns) -> Columns:
    """What was given; with the columns of the table, or of the DataArray, that x is where it stands alone.

    What stands beside a table goes before its columns. Raises TypeError where y or z is missing, and ValueError where the
    table has no column x, y or z.

    >>> columns("fit", Columns({"x": [0.0], "y": [1.0], "z": [2.0], "finger": [7]}, None, None)).labels
    ([7], None)
    """
    x, y, z = given.x, given.y, given.z
    if y is not None and z is not None:
        return given
    if y is None and z is None:
        if hasattr(x, "coords") and hasattr(x, "dims"):
            array = x.transpose("x", "y")
            return given._replace(x=array.coords["x"].values, y=array.coords["y"].values, z=array.values)
        if is_table(x):
            return _of_table(x, given)
    raise TypeError(f"{'y' if y is None else 'z'} is missing: {verb}(x, y, z), or a table or a DataArray alone")


def is_grid(z: Any) -> bool:
    """Whether z has two dimensions."""
    dimensions = getattr(z, "ndim", None)
    return bool((np.ndim(z) if dimensions is None else dimensions) == 2)


def is_table(thing: Any) -> bool:
    """Whether it has columns by name: a DataFrame or a mapping."""
    return hasattr(thing, "keys") and hasattr(thing, "__getitem__")


def _of_table(table: Any, given: Columns) -> Columns:
    missing = [name for name in "xyz" if name not in table]
    if missing:
        raise ValueError(f"x: a table of contacts has columns x, y and z; {', '.join(missing)} is missing")
    normals, slopes = given.normals, given.slopes
    if normals is None and slopes is None:
        if all(name in table for name in ("nx", "ny", "nz")):
            normals = tuple(table[name] for name in ("nx", "ny", "nz"))
        elif all(name in table for name in ("zx", "zy")):
            slopes = tuple(table[name] for name in ("zx", "zy"))

    def beside(own: Any, name: str) -> Any:
        return table[name] if own is None and name in table else own

    wz, wx, wy = given.weights
    finger, station = given.labels
    return Columns(
        table["x"], table["y"], table["z"], normals, slopes,
        (beside(wz, "wz"), beside(wx, "wx"), beside(wy, "wy")), (beside(finger, "finger"), beside(station, "station")),
    )  # fmt: skip
